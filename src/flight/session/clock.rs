//! A vehicle's own clock against that of the fleet.

/// How long the quickest message is remembered at least, milliseconds.
const WINDOW_MS: f64 = 10_000.0;
/// A stamp that is older than the one before it by more, or ahead of the quickest message by more, is of a
/// clock that jumped, or wrong, milliseconds.
const BACK_MS: f64 = 1000.0;
const AHEAD_MS: f64 = 2000.0;
/// A vehicle whose answers are this far from its stamps stamps them with another clock, milliseconds.
const OTHER_CLOCK_MS: f64 = 30_000.0;
/// This number of them in a row that go on from one another are of a clock that jumped.
const JUMPED: u8 = 3;

/// Where a vehicle's time since boot lies on the fleet's clock.
///
/// A position is stamped when it is measured and arrives later. The quickest of the
/// last messages shows the difference best: the others were only late. A link that gets slower looks
/// as a clock that runs slow: answers to `TIMESYNC`, stamped after they were asked for, tell them apart.
#[derive(Clone, Debug, Default)]
pub(crate) struct Offset {
    /// Least differences of this window and of the one before it, and when this one began. Messages that waited
    /// while nobody read them come at once, in one window.
    min_ms: [Option<f64>; 2],
    began_ms: f64,
    /// The difference that was used last, and when an answer said what it is at least.
    used_ms: Option<f64>,
    answered_ms: Option<f64>,
    /// How late the last message with a stamp came.
    late_ms: f64,
    /// The last stamp that was taken, and when it arrived.
    last_ms: Option<(f64, f64)>,
    /// The last of those that are off, and how many there are in a row.
    off_ms: Option<(f64, f64)>,
    off_count: u8,
}

/// A stamp on the fleet's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Aligned {
    /// Milliseconds of the fleet's clock.
    pub(crate) at_ms: f64,
    /// By how much the vehicle's clock jumped before it, seconds: positive forward.
    pub(crate) jump_s: Option<f64>,
}

impl Aligned {
    /// Whether it is later than another time on the fleet's clock in a record as well, whose times are whole milliseconds:
    /// answers that show a link to be quicker bring two stamps nearer to each other than that.
    pub(crate) fn is_after(&self, before_ms: f64) -> bool {
        /// A little more than one, for rounding.
        const APART_MS: f64 = 1.001;
        self.at_ms > before_ms + APART_MS
    }
}

impl Offset {
    /// The time on the fleet's clock of a stamp that arrived at `arrived_ms` of it; none for one
    /// that cannot be, unless others go on from it.
    pub(crate) fn align(&mut self, boot_ms: f64, arrived_ms: f64) -> Option<Aligned> {
        let jump_s = if self.is_off(boot_ms, arrived_ms) {
            let goes_on = self.off_ms.is_some_and(|(before_ms, at_ms)| {
                let went_ms = boot_ms - before_ms;
                went_ms > 0.0 && went_ms <= arrived_ms - at_ms + AHEAD_MS
            });
            self.off_count = if goes_on { self.off_count + 1 } else { 1 };
            self.off_ms = Some((boot_ms, arrived_ms));
            if self.off_count < JUMPED {
                return None;
            }
            (self.min_ms, self.began_ms) = ([None, None], arrived_ms);
            (self.used_ms, self.answered_ms) = (None, None);
            self.last_ms
                .map(|(before_ms, at_ms)| (boot_ms - before_ms - (arrived_ms - at_ms)) / 1000.0)
        } else {
            None
        };
        (self.off_ms, self.off_count) = (None, 0);
        self.last_ms = Some((boot_ms, arrived_ms));
        let at_ms = self.take(boot_ms, arrived_ms);
        self.late_ms = (arrived_ms - at_ms).max(0.0);
        Some(Aligned { at_ms, jump_s })
    }

    /// When a message without a stamp was sent that arrived at `arrived_ms`: as late as the last one with a stamp, and
    /// after it.
    pub(crate) fn sent_ms(&self, arrived_ms: f64) -> f64 {
        arrived_ms - self.late_ms
    }

    /// Takes in the vehicle's time in an answer to what was sent to it at `sent_ms` of the fleet's clock.
    pub(crate) fn answered(&mut self, boot_ms: f64, sent_ms: f64, arrived_ms: f64) {
        let Some(used_ms) = self.used_ms else { return };
        let is_same_clock = (arrived_ms - boot_ms - used_ms).abs() <= OTHER_CLOCK_MS;
        if is_same_clock && sent_ms <= arrived_ms {
            self.used_ms = Some(used_ms.max(sent_ms - boot_ms));
            self.answered_ms = Some(arrived_ms);
        }
    }

    fn is_off(&self, boot_ms: f64, arrived_ms: f64) -> bool {
        let is_back = self
            .last_ms
            .is_some_and(|(before_ms, _)| before_ms - boot_ms > BACK_MS);
        let is_ahead = |used_ms: f64| used_ms - (arrived_ms - boot_ms) > AHEAD_MS;
        is_back || self.used_ms.is_some_and(is_ahead)
    }

    fn take(&mut self, boot_ms: f64, arrived_ms: f64) -> f64 {
        if arrived_ms - self.began_ms >= WINDOW_MS {
            (self.min_ms, self.began_ms) = ([None, self.min_ms[0]], arrived_ms);
        }
        let found = arrived_ms - boot_ms;
        let least = self.min_ms[0].map_or(found, |least| least.min(found));
        self.min_ms[0] = Some(least);
        let is_answered = self
            .answered_ms
            .is_some_and(|at_ms| arrived_ms - at_ms < WINDOW_MS);
        let used = match self.used_ms.filter(|_| is_answered) {
            Some(used) => used.min(found),
            None => self.min_ms[1].map_or(least, |before| before.min(least)),
        };
        self.used_ms = Some(used);
        boot_ms + used
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{Aligned, Offset};

    fn at(offset: &mut Offset, boot_ms: f64, arrived_ms: f64) -> f64 {
        offset
            .align(boot_ms, arrived_ms)
            .map_or(f64::NAN, |aligned| aligned.at_ms)
    }

    #[test]
    fn late_messages_keep_the_time_at_which_they_were_measured() {
        let mut offset = Offset::default();
        assert!((at(&mut offset, 1000.0, 5000.0) - 5000.0).abs() < 1e-9);
        assert!((at(&mut offset, 1200.0, 5900.0) - 5200.0).abs() < 1e-9);
        // A clock that runs slow is followed, later.
        for step in 0..500 {
            let boot = 1400.0 + 200.0 * f64::from(step);
            at(&mut offset, boot, boot + 4100.0);
        }
        assert!((at(&mut offset, 101_400.0, 105_500.0) - 105_500.0).abs() < 1e-9);
    }

    /// Positions of a minute, 5 a second, each late by what `late_ms` says, and an answer every 2 s; the clock
    /// goes at `rate`. By how much the last is off, milliseconds.
    fn off_after_a_minute(
        late_ms: impl Fn(f64) -> f64,
        rate: f64,
        answer: impl Fn(f64) -> Option<f64>,
    ) -> f64 {
        let mut offset = Offset::default();
        let mut off_ms = f64::NAN;
        for step in 0..300 {
            let sent_ms = 200.0 * f64::from(step);
            let boot_ms = 1_000_000.0 + rate * sent_ms;
            let arrived_ms = sent_ms + late_ms(sent_ms);
            if let Some(answer_ms) = answer(boot_ms).filter(|_| step % 10 == 9) {
                offset.answered(answer_ms, sent_ms - 20.0, arrived_ms);
            }
            let aligned = offset.align(boot_ms, arrived_ms).expect("no jump");
            assert_eq!(aligned.jump_s, None);
            off_ms = aligned.at_ms - sent_ms;
        }
        off_ms
    }

    #[test]
    fn a_link_that_gets_slower_is_not_taken_for_a_slow_clock_by_one_that_answers() {
        // Later by up to 5 s from 10 s on, and in time again from 50 s on.
        let slower = |sent_ms: f64| match sent_ms {
            ..50_000.0 => 30.0 + ((sent_ms - 10_000.0) * 0.2).clamp(0.0, 5000.0),
            _ => 30.0,
        };
        let off_ms = off_after_a_minute(slower, 1.0, Some);
        assert!((off_ms - 30.0).abs() < 1.0, "{off_ms}");
        let stays = |sent_ms: f64| if sent_ms < 10_000.0 { 30.0 } else { 5000.0 };
        let off_ms = off_after_a_minute(stays, 1.0, Some);
        assert!((off_ms - 30.0).abs() < 1.0, "{off_ms}");
        // Without an answer, or with that of another clock, nobody can say which.
        for answer in [|_| None, |_| Some(1.7e12)] {
            let off_ms = off_after_a_minute(stays, 1.0, answer);
            assert!((off_ms - 5000.0).abs() < 1.0, "{off_ms}");
        }
        // Clocks that run slow and fast are followed all the same.
        for rate in [0.9, 0.999, 1.001, 1.1] {
            let off_ms = off_after_a_minute(|_| 30.0, rate, Some);
            assert!((-200.0..250.0).contains(&off_ms), "{rate} {off_ms}");
        }
    }

    proptest! {
        #[test]
        fn times_that_are_after_one_another_differ_in_a_record(
            t0_ms in 0.0..1e9_f64, before_ms in 0.0..1e8_f64, by_ms in -0.5..3.0_f64,
        ) {
            let (before_ms, jump_s) = (t0_ms + before_ms, None);
            let at_ms = before_ms + by_ms;
            if (Aligned { at_ms, jump_s }).is_after(before_ms) {
                let recorded = |at_ms: f64| ((at_ms - t0_ms) / 1000.0 * 1000.0).round();
                prop_assert!(recorded(at_ms) > recorded(before_ms), "{at_ms} {before_ms} {t0_ms}");
            }
        }
    }

    /// As a flight had them: 400 ms of the vehicle's clock apart, and a link that proved to be 399.8 ms quicker.
    #[test]
    fn two_stamps_in_one_millisecond_are_not_one_after_the_other() {
        let mut offset = Offset::default();
        assert!((at(&mut offset, 48_664.0, 49_464.2) - 49_464.2).abs() < 1e-9);
        offset.answered(48_700.0, 49_490.0, 49_500.2);
        let before = offset.align(48_864.0, 49_664.2).expect("no jump");
        let next = offset.align(49_264.0, 49_664.4).expect("no jump");
        assert!(next.at_ms > before.at_ms && !next.is_after(before.at_ms));
        assert!(
            offset
                .align(49_464.0, 49_864.4)
                .expect("no jump")
                .is_after(before.at_ms)
        );
    }

    #[test]
    fn messages_that_waited_for_long_keep_their_times() {
        let mut offset = Offset::default();
        assert!((at(&mut offset, 1000.0, 5000.0) - 5000.0).abs() < 1e-9);
        // Nobody read them for half a minute.
        for step in 0..150 {
            let boot_ms = 1200.0 + 200.0 * f64::from(step);
            let found_ms = at(&mut offset, boot_ms, 35_000.0);
            assert!((found_ms - boot_ms - 4000.0).abs() < 1e-9, "{step}");
        }
        assert!((at(&mut offset, 31_200.0, 35_200.0) - 35_200.0).abs() < 1e-9);
    }

    #[test]
    fn a_clock_that_jumps_is_followed_and_late_or_wrong_stamps_are_no_jump() {
        let mut offset = Offset::default();
        let mut step = |boot_ms: f64, arrived_ms: f64| {
            let aligned = offset.align(boot_ms, arrived_ms)?;
            Some((aligned.at_ms, aligned.jump_s))
        };
        assert_eq!(step(1000.0, 5000.0), Some((5000.0, None)));
        // Late by 3 s, in another order, and in time again.
        assert_eq!(step(1200.0, 8200.0), Some((5200.0, None)));
        assert_eq!(step(1100.0, 8300.0), Some((5100.0, None)));
        assert_eq!(step(4400.0, 8400.0), Some((8400.0, None)));
        // One wrong stamp, ahead and behind.
        assert_eq!(step(10_600.0, 8600.0), None);
        assert_eq!(step(4800.0, 8800.0), Some((8800.0, None)));
        assert_eq!(step(1000.0, 9000.0), None);
        assert_eq!(step(5200.0, 9200.0), Some((9200.0, None)));
        for (by_ms, by_s) in [(1_000_000.0, 1000.0), (994_000.0, -6.0), (0.0, -994.0)] {
            let from_ms = 9200.0
                + 1000.0 * f64::from(u8::from(by_s < 0.0))
                + f64::from(u8::from(by_ms < 1.0)) * 1000.0;
            assert_eq!(step(from_ms - 3800.0 + by_ms, from_ms + 200.0), None);
            assert_eq!(step(from_ms - 3600.0 + by_ms, from_ms + 400.0), None);
            let jumped = Some((from_ms + 600.0, Some(by_s)));
            assert_eq!(step(from_ms - 3400.0 + by_ms, from_ms + 600.0), jumped);
            let goes_on = Some((from_ms + 1000.0, None));
            assert_eq!(step(from_ms - 3000.0 + by_ms, from_ms + 1000.0), goes_on);
        }
    }
}

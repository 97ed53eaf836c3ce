//! A vehicle's own clock against that of the fleet.

/// How long the quickest message is remembered, milliseconds of the vehicle's time.
const WINDOW_MS: f64 = 10_000.0;
/// A clock that goes on by so much more than ours, or goes back by so much, has jumped, milliseconds: messages
/// come late, and in another order, by less.
const JUMP_MS: f64 = 10_000.0;

/// Where a vehicle's time since boot lies on the fleet's clock.
///
/// A position is stamped when it is measured and arrives later. The quickest of the
/// last messages shows the difference best: the others were only late.
#[derive(Clone, Debug, Default)]
pub(crate) struct Offset {
    /// Least differences of this window and of the one before it.
    least_ms: [Option<f64>; 2],
    window: f64,
    last_ms: Option<f64>,
}

impl Offset {
    /// By how much the vehicle's clock has jumped at a stamp since the one before it, seconds: positive
    /// forward. To be asked before [`Self::align`].
    pub(crate) fn jump_s(&mut self, boot_ms: f64, arrived_ms: f64) -> Option<f64> {
        let before_ms = self.last_ms.replace(boot_ms)?;
        let back_ms = before_ms - boot_ms;
        let least_ms = self.least_ms.iter().flatten().copied().reduce(f64::min)?;
        let on_ms = least_ms - (arrived_ms - boot_ms);
        if back_ms > JUMP_MS {
            Some(-back_ms / 1000.0)
        } else {
            (on_ms > JUMP_MS).then_some(on_ms / 1000.0)
        }
    }

    /// The time on the fleet's clock of a stamp that arrived at `arrived_ms` of it.
    pub(crate) fn align(&mut self, boot_ms: f64, arrived_ms: f64) -> f64 {
        let window = (boot_ms / WINDOW_MS).floor();
        let is_restarted = window < self.window;
        if is_restarted || window > self.window + 1.0 {
            self.least_ms = [None, None];
        } else if window > self.window {
            self.least_ms = [None, self.least_ms[0]];
        }
        self.window = window;
        let found = arrived_ms - boot_ms;
        let least = self.least_ms[0].map_or(found, |least| least.min(found));
        self.least_ms[0] = Some(least);
        boot_ms + self.least_ms[1].map_or(least, |before| before.min(least))
    }
}

#[cfg(test)]
mod tests {
    use super::Offset;

    #[test]
    fn late_messages_keep_the_time_at_which_they_were_measured() {
        let mut offset = Offset::default();
        assert!((offset.align(1000.0, 5000.0) - 5000.0).abs() < 1e-9);
        assert!((offset.align(1200.0, 5900.0) - 5200.0).abs() < 1e-9);
        // A clock that runs slow is followed, later.
        for step in 0..500 {
            let boot = 1400.0 + 200.0 * f64::from(step);
            offset.align(boot, boot + 4100.0);
        }
        assert!((offset.align(200_000.0, 204_100.0) - 204_100.0).abs() < 1e-9);
        // The vehicle was started again.
        assert!((offset.align(100.0, 300_000.0) - 300_000.0).abs() < 1e-9);
    }

    #[test]
    fn a_clock_that_jumps_is_told_from_messages_that_are_late() {
        let mut offset = Offset::default();
        let mut jump = |boot_ms: f64, arrived_ms: f64| {
            let found = offset.jump_s(boot_ms, arrived_ms);
            offset.align(boot_ms, arrived_ms);
            found
        };
        assert_eq!(jump(1000.0, 5000.0), None);
        // Late by 30 s, in another order, and in time again.
        assert_eq!(jump(1200.0, 35_200.0), None);
        assert_eq!(jump(900.0, 35_300.0), None);
        assert_eq!(jump(31_400.0, 35_400.0), None);
        let on_s = jump(1_031_600.0, 35_600.0);
        assert!(
            on_s.is_some_and(|on_s| (on_s - 1000.0).abs() < 1.0),
            "{on_s:?}"
        );
        assert_eq!(jump(1_031_800.0, 35_800.0), None);
        assert_eq!(jump(1_011_800.0, 36_000.0), Some(-20.0));
        assert_eq!(jump(1_012_000.0, 36_200.0), None);
    }
}

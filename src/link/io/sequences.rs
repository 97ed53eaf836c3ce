//! Whether the frames of one system id have two sequences of numbers, with positions of two vehicles in them.
//!
//! Two sequences alone show nothing: frames are lost, come twice or late, and one vehicle may be heard over two of its own
//! ports, each with its own numbers. But at one time by its clock a vehicle is at one place, whatever way it says so.

use std::collections::VecDeque;

use crate::link::message::flight::Position;

/// A number goes on in a sequence if it is at most this much later.
const WINDOW: u8 = 30;
/// This many frames in a row that go on from each other, and from none of the known sequences, are one of their own: a
/// single one came late.
const BEGINS: u8 = 3;
/// Positions of a sequence that are remembered, and those between which one is interpolated are no further apart,
/// milliseconds.
const MAX_POSITIONS: usize = 64;
const GAP_MS: u32 = 1200;
/// Two vehicles are apart by this, metres, and change that from one position to the next by less than this, metres, and
/// this share.
const APART_M: f64 = 2.0;
const STEADY_M: f64 = 1.0;
const STEADY_SHARE: f64 = 0.3;
/// This many positions in a row show that.
const IN_A_ROW: u8 = 12;
/// Where both sequences have the same numbers, positions that come in turns are off the way between those before and after
/// them, to one side and the other: by this, metres, at a time that is no further outside of that way, milliseconds.
const ZIGZAG_M: f64 = 3.0;
const OUTSIDE_MS: i64 = 300;
/// One degree of latitude, metres.
const DEGREE_M: f64 = 111_320.0;

/// One sequence of numbers, and the last positions in it.
#[derive(Clone, Debug, Default)]
struct Sequence {
    last: Option<u8>,
    /// Number of the frame that last went on in it, of all.
    used: u64,
    positions: VecDeque<Position>,
}

/// The sequences that the frames of one component have.
#[derive(Clone, Debug, Default)]
pub(super) struct Sequences {
    both: [Sequence; 2],
    frames: u64,
    /// The last frames that go on nowhere, how many such have gone on from each other, and when: two vehicles may send
    /// in turns.
    strays: [Option<Stray>; 2],
    /// How far one is from the other: to the north, the east and up, metres.
    apart_m: Option<[f64; 3]>,
    in_a_row: u8,
    zigzag: Zigzag,
}

/// Frames that go on in no sequence.
#[derive(Clone, Copy, Debug)]
struct Stray {
    last: u8,
    count: u8,
    /// Number of the last of them, of all frames.
    used: u64,
}

/// Whether positions, as they come, are those of two vehicles in turns.
#[derive(Clone, Debug, Default)]
struct Zigzag {
    last: [Option<Position>; 2],
    off_m: Option<[f64; 3]>,
    in_a_row: u8,
}

impl Zigzag {
    fn take(&mut self, next: &Position) {
        let [first, middle] = self.last;
        self.last = [middle, Some(*next)];
        let off_m = first.zip(middle).and_then(|(first, middle)| {
            let ms = |of: &Position| i64::from(of.boot_ms) - i64::from(first.boot_ms);
            let (at_ms, took_ms) = (ms(&middle), ms(next));
            let is_near = (1..=i64::from(GAP_MS)).contains(&took_ms)
                && (-OUTSIDE_MS..=took_ms + OUTSIDE_MS).contains(&at_ms);
            #[expect(clippy::cast_precision_loss, reason = "milliseconds of a second")]
            let share = at_ms as f64 / took_ms as f64;
            is_near.then(|| apart_m(&middle, (&first, next), share))
        });
        let before_m = std::mem::replace(&mut self.off_m, off_m);
        let turns = off_m.zip(before_m).is_some_and(|(now_m, before_m)| {
            let sum_m = [0, 1, 2].map(|axis| now_m[axis] + before_m[axis]);
            let length = length_m(now_m);
            length >= ZIGZAG_M && length_m(sum_m) <= STEADY_M.max(STEADY_SHARE * length)
        });
        self.in_a_row = match turns {
            true => self.in_a_row.saturating_add(1),
            false => 0,
        };
    }
}

impl Sequence {
    /// How much later a number is, if it goes on here.
    fn later(&self, number: u8) -> Option<u8> {
        let later = number.wrapping_sub(self.last?);
        (later <= WINDOW).then_some(later)
    }
}

impl Sequences {
    /// Takes in the number of a frame, and its position; whether positions come from two vehicles.
    pub(super) fn take(&mut self, number: u8, position: Option<&Position>) -> bool {
        if let Some(position) = position.filter(|position| position.is_known()) {
            self.zigzag.take(position);
        }
        self.sort(number, position);
        let in_a_row = self.in_a_row.max(self.zigzag.in_a_row);
        position.is_some() && in_a_row >= IN_A_ROW
    }

    /// Takes a frame into the sequence that it goes on in.
    fn sort(&mut self, number: u8, position: Option<&Position>) {
        self.frames += 1;
        let used = self.frames;
        let goes_on = (0..2).filter_map(|of| Some((self.both[of].later(number)?, of)));
        let own = goes_on.min().map(|(_, of)| of);
        let Some(own) = own.or_else(|| self.begin(number)) else {
            return;
        };
        (self.both[own].last, self.both[own].used) = (Some(number), used);
        if let Some(position) = position.filter(|position| position.is_known()) {
            self.compare(own, position);
            let positions = &mut self.both[own].positions;
            positions.push_back(*position);
            if positions.len() > MAX_POSITIONS {
                positions.pop_front();
            }
        }
    }

    /// A sequence of its own, in the place of the one that was not used for longer, if a frame is one of it.
    fn begin(&mut self, number: u8) -> Option<usize> {
        let is_next = |last: u8| number.wrapping_sub(last) <= WINDOW;
        let goes_on = |stray: &Option<Stray>| stray.is_some_and(|of| is_next(of.last));
        let own = self.strays.iter().position(goes_on);
        let used = |of: usize| self.strays[of].map_or(0, |stray| stray.used);
        let of = own.unwrap_or(usize::from(used(1) < used(0)));
        let before = self.strays[of].filter(|_| own.is_some());
        let count = before.map_or(0, |stray| stray.count) + 1;
        self.strays[of] = (count < BEGINS).then_some(Stray {
            last: number,
            count,
            used: self.frames,
        });
        let oldest = usize::from(self.both[1].used < self.both[0].used);
        (count >= BEGINS).then(|| {
            self.both[oldest] = Sequence::default();
            oldest
        })
    }

    /// Holds the positions of the other sequence against those on the way to the next one of this.
    fn compare(&mut self, own: usize, to: &Position) {
        let Some(from) = self.both[own].positions.back().copied() else {
            return;
        };
        let took_ms = to.boot_ms.checked_sub(from.boot_ms);
        let Some(took_ms) = took_ms.filter(|ms| (1..=GAP_MS).contains(ms)) else {
            return;
        };
        let sign = if own == 0 { 1.0 } else { -1.0 };
        let other = &self.both[1 - own].positions;
        let meanwhile = other.iter().filter_map(|of| {
            let since_ms = of.boot_ms.checked_sub(from.boot_ms)?;
            let share = f64::from(since_ms) / f64::from(took_ms);
            (share <= 1.0).then(|| apart_m(of, (&from, to), share).map(|off_m| sign * off_m))
        });
        for now_m in meanwhile.collect::<Vec<_>>() {
            let before_m = self.apart_m.replace(now_m);
            let is_steady = before_m.is_some_and(|before_m| {
                let change_m = length_m([0, 1, 2].map(|axis| now_m[axis] - before_m[axis]));
                change_m <= STEADY_M.max(STEADY_SHARE * length_m(now_m))
            });
            self.in_a_row = match is_steady && length_m(now_m) >= APART_M {
                true => self.in_a_row.saturating_add(1),
                false => 0,
            };
        }
    }
}

/// From a place on the way between two positions to another: to the north, the east and up, metres.
fn apart_m(of: &Position, (from, to): (&Position, &Position), share: f64) -> [f64; 3] {
    let mixed = |value: fn(&Position) -> i32| {
        let [from, to] = [value(from), value(to)].map(f64::from);
        f64::from(value(of)) - (from + share * (to - from))
    };
    let cos = from.place().lat_deg.to_radians().cos();
    [
        mixed(|of| of.x) * 1e-7 * DEGREE_M,
        mixed(|of| of.y) * 1e-7 * DEGREE_M * cos,
        mixed(|of| of.amsl_mm) * 1e-3,
    ]
}

fn length_m([north_m, east_m, up_m]: [f64; 3]) -> f64 {
    north_m.hypot(east_m).hypot(up_m)
}

#[cfg(test)]
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "metres and milliseconds of a minute"
)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A frame: when it was sent and arrives, milliseconds, its number, and its position.
    type Sent = (f64, u8, Option<Position>);

    /// A vehicle that stands, turns and flies, `east_m` beside another one; its clock is `clock_ms` ahead.
    fn position(ms: f64, (north_m, east_m): (f64, f64), clock_ms: f64) -> Position {
        let t_s = ms / 1000.0;
        let way_s = (t_s - 20.0).max(0.0);
        let (north, east) = (40.0 * (0.25 * way_s).sin(), 10.0 * way_s);
        let e7 = |m: f64| (m / DEGREE_M * 1e7) as i32;
        Position {
            boot_ms: (60_000.0 + ms + clock_ms) as u32,
            x: 360_000_000 + e7(north + north_m),
            y: -842_500_000 + e7((east + east_m) / 36_f64.to_radians().cos()),
            amsl_mm: 480_000 + (1000.0 * (3.0 * way_s).min(60.0)) as i32,
            ..Position::default()
        }
    }

    /// The frames that one port of a vehicle sends in a minute: five positions a second, and others between.
    fn port(first: u8, others: u8, at: impl Fn(f64) -> Position) -> Vec<Sent> {
        let mut number = first;
        let mut sent = Vec::new();
        for index in 0..300_u32 {
            let ms = 200.0 * f64::from(index);
            for other in 0..others {
                sent.push((ms + 3.0 * f64::from(other), number, None));
                number = number.wrapping_add(1);
            }
            sent.push((ms + 50.0, number, Some(at(ms + 50.0))));
            number = number.wrapping_add(1);
        }
        sent
    }

    /// Whether two are found when frames are lost, come twice, and late, by shares of them.
    fn are_two(sent: &[Sent], seed: u64, shares: [f64; 3]) -> bool {
        let mut state = seed | 1;
        let mut drawn = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let [lost, twice, late] = shares;
        let mut heard = Vec::new();
        for frame in sent {
            if drawn() < lost {
                continue;
            }
            let copies = if drawn() < twice { 2 } else { 1 };
            for _ in 0..copies {
                let after_ms = if drawn() < late {
                    3000.0 * drawn()
                } else {
                    0.0
                };
                heard.push((frame.0 + after_ms, *frame));
            }
        }
        heard.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut sequences = Sequences::default();
        heard
            .iter()
            .any(|(_, (_, number, position))| sequences.take(*number, position.as_ref()))
    }

    #[test]
    fn two_vehicles_that_send_in_turns_with_other_numbers_are_two_whatever_their_clocks() {
        for clock_ms in [-800.0, -338.0, 0.0, 338.0, 800.0] {
            let one = port(0, 1, |ms| position(ms, (0.0, 0.0), 0.0));
            let two = port(100, 1, |ms| position(ms, (4.0, 0.0), clock_ms));
            let both: Vec<Sent> = one.into_iter().zip(two).flat_map(|(a, b)| [a, b]).collect();
            assert!(are_two(&both, 1, [0.0; 3]), "{clock_ms}");
        }
    }

    proptest! {
        #[test]
        fn one_vehicle_is_one_over_one_port_or_two_whatever_becomes_of_its_frames(
            seed in 1_u64..u64::MAX, shares in [0.0..0.6, 0.0..0.6, 0.0..0.6],
            (first, second) in (0_u8..=255, 0_u8..=255), (others, fewer) in (0_u8..12, 0_u8..12),
            lag_ms in 0.0..2500.0, noise_m in 0.0..2.5, jumps_m in 0.0..70.0,
        ) {
            let noisy = |ms: f64| {
                let (sin, cos) = (ms * 12.9898 + seed as f64 * 1e-9).sin_cos();
                let wild = |of: f64| noise_m * (43_758.5 * of).fract();
                let jump_m = if ms > 30_000.0 { jumps_m } else { 0.0 };
                position(ms, (wild(sin) + jump_m, wild(cos)), 0.0)
            };
            let own = port(first, others, noisy);
            prop_assert!(!are_two(&own, seed, shares));
            // The numbers of its second port are others, and its frames come later.
            let second = port(second, fewer, |ms| noisy(ms + 100.0));
            let later = second.iter().map(|(ms, number, position)| (ms + lag_ms, *number, *position));
            let mut both: Vec<Sent> = own.iter().copied().chain(later).collect();
            both.sort_by(|a, b| a.0.total_cmp(&b.0));
            prop_assert!(!are_two(&both, seed, shares));
        }

        #[test]
        fn two_vehicles_whose_frames_have_the_same_numbers_are_two(
            first in 0_u8..=255, others in 0_u8..12,
            (north_m, east_m) in (5.0..60.0, -60.0..60.0), clock_ms in -240.0..240.0,
        ) {
            let one = port(first, others, |ms| position(ms, (0.0, 0.0), 0.0));
            let two = port(first, others, |ms| position(ms, (north_m, east_m), clock_ms));
            let both: Vec<Sent> = one.into_iter().zip(two).flat_map(|(a, b)| [a, b]).collect();
            prop_assert!(are_two(&both, 1, [0.0; 3]));
        }

        #[test]
        fn two_vehicles_near_each_other_with_equal_clocks_are_two(
            seed in 1_u64..u64::MAX, shares in [0.0..0.3, 0.0..0.2, 0.0..0.02],
            first in 0_u8..=255, others in 1_u8..12, more in 0_u8..4,
            (north_m, east_m) in (4.0..60.0, -60.0..60.0), clock_ms in -900.0..900.0,
        ) {
            let one = port(first, others, |ms| position(ms, (0.0, 0.0), 0.0));
            let two = port(first.wrapping_add(100), others + more, |ms| position(ms, (north_m, east_m), clock_ms));
            let mut both: Vec<Sent> = one.into_iter().chain(two).collect();
            both.sort_by(|a, b| a.0.total_cmp(&b.0));
            prop_assert!(are_two(&both, seed, shares));
        }
    }
}

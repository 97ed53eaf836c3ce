//! Whether two vehicles speak with one system id over one address.

use crate::geodesy::LatLon;
use crate::link::message::flight::Position;

/// A position goes on from one that is at most this much older, milliseconds of the vehicle's clock, and no farther
/// away than at this speed, m/s, and this error, metres.
const OLD_MS: u32 = 10_000;
const FASTEST_MPS: f64 = 100.0;
const ERROR_M: f64 = 20.0;
/// Two whose clocks differ by less may be one that is heard over two ways, unless they are apart.
const APART_M: f64 = 100.0;
/// So often positions change from one to the other before they count as those of two vehicles, with at most this many
/// positions between two changes.
const CHANGES: u8 = 6;
const BETWEEN: u8 = 20;

/// The positions that are sent with one system id.
#[derive(Clone, Debug, Default)]
pub(crate) struct SharedId {
    /// The last one, and the last of those that did not go on from it: time since boot, milliseconds, and place.
    last: [Option<(u32, LatLon)>; 2],
    changes: u8,
    since: u8,
}

impl SharedId {
    /// Takes in a position; whether they come from two vehicles in turn.
    pub(crate) fn take(&mut self, position: &Position) -> bool {
        if !position.is_known() {
            return false;
        }
        let now = (position.boot_ms, position.place());
        let goes_on = |last: Option<(u32, LatLon)>| last.is_some_and(|last| follows(last, now));
        let is_other = self.last[0].is_some() && !goes_on(self.last[0]);
        self.since = self.since.saturating_add(1);
        if self.since > BETWEEN {
            self.changes = 0;
        }
        if is_other {
            let is_known = goes_on(self.last[1]) && self.last[0].is_some_and(|of| apart(of, now));
            self.changes = if is_known {
                self.changes.saturating_add(1)
            } else {
                0
            };
            self.since = 0;
            self.last.swap(0, 1);
        }
        self.last[0] = Some(now);
        self.changes >= CHANGES
    }
}

fn follows(before: (u32, LatLon), now: (u32, LatLon)) -> bool {
    let Some(after_ms) = now.0.checked_sub(before.0).filter(|ms| *ms <= OLD_MS) else {
        return false;
    };
    let reach_m = ERROR_M + FASTEST_MPS * f64::from(after_ms) / 1000.0;
    before.1.chord_m(now.1) <= reach_m
}

fn apart(one: (u32, LatLon), two: (u32, LatLon)) -> bool {
    let between_ms = one.0.abs_diff(two.0);
    let reach_m = APART_M + FASTEST_MPS * f64::from(between_ms) / 1000.0;
    between_ms > OLD_MS || one.1.chord_m(two.1) > reach_m
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(boot_ms: u32, east_m: i32) -> Position {
        Position {
            boot_ms,
            x: 363_000_000,
            y: -842_500_000 + 111 * east_m,
            amsl_mm: 480_000,
            above_home_mm: 80_000,
            velocity_cmps: [0, 1500, 0],
        }
    }

    fn are_two(positions: impl IntoIterator<Item = Position>) -> bool {
        let mut shared_id = SharedId::default();
        positions
            .into_iter()
            .any(|position| shared_id.take(&position))
    }

    /// One at 15 m/s, four positions a second.
    fn one(boot_ms: u32, east_m: i32) -> impl Iterator<Item = Position> {
        (0..200_u32).map(move |n| {
            let flown_m = i32::try_from(n).expect("few") * 15 / 4;
            at(boot_ms + 250 * n, east_m + flown_m)
        })
    }

    #[test]
    fn two_that_are_apart_or_were_started_at_different_times_are_two() {
        for (boot_ms, east_m) in [(1000, 700), (60_000, 0), (60_000, 5000)] {
            let both = one(1000, 0).zip(one(boot_ms, east_m));
            assert!(
                are_two(both.flat_map(|(a, b)| [a, b])),
                "{boot_ms} {east_m}"
            );
        }
    }

    #[test]
    fn one_is_one_whatever_becomes_of_its_messages() {
        assert!(!are_two(one(1000, 0)));
        // Heard over two ways, the second of them two seconds slower.
        let late = one(1000, 0).skip(8).zip(one(1000, 0));
        assert!(!are_two(late.flat_map(|(a, b)| [a, b])));
        // Started again; and a jump of its position.
        assert!(!are_two(one(1_000_000, 0).chain(one(1000, 800))));
        // A position that is wrong at times.
        let wrong = one(1000, 0).enumerate();
        let wrong = wrong.map(|(n, position)| match n % 9 {
            0 => Position {
                x: position.x + 900_000 + 20_000 * i32::try_from(n).expect("few"),
                ..position
            },
            _ => position,
        });
        assert!(!are_two(wrong));
    }
}

//! Where tracks begin and end: nobody comes down where another one still stands, or has just come down.

use std::collections::HashMap;

/// A landing nearer than this to a vehicle is on it, metres: what a copter lands beside its place, and its arms.
pub(super) const CLEAR_M: f64 = 3.0;
/// Ends whose altitudes differ by more are not both on the ground, metres.
pub const LEVEL_M: f64 = 3.0;
/// A vehicle that has landed occupies its place for at least this long, seconds: 10 s until its motors stop (`DISARM_DELAY`),
/// and 20 s to carry it away.
pub const CLEARED_AFTER_S: f64 = 30.0;

/// How far a landing stays clear of others on the ground, metres, where vehicles keep a separation, metres.
#[must_use]
pub fn clear_m(separation_m: f64) -> f64 {
    CLEAR_M.min(separation_m)
}

/// A time, seconds, and a place: east, north and altitude, metres.
pub(crate) type At = (f64, [f64; 3]);

/// Where a vehicle stands until it departs, and where it is down from its landing on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ends {
    /// Its departure.
    pub begin: At,
    /// Its landing, if it lands.
    pub end: Option<At>,
}

impl Ends {
    /// The same some seconds later.
    #[must_use]
    pub fn later(&self, later_s: f64) -> Self {
        let later = |(t_s, at): At| (t_s + later_s, at);
        Self {
            begin: later(self.begin),
            end: self.end.map(later),
        }
    }

    /// Whether one of two lands nearer than `clear_m` to where the other one stands, or is down for less than
    /// [`CLEARED_AFTER_S`]; their times may be wrong by `slack_s` against each other.
    #[must_use]
    pub fn are_in_conflict(&self, other: &Self, clear_m: f64, slack_s: f64) -> bool {
        let is_one_place = |a: At, b: At| {
            (a.1[0] - b.1[0]).hypot(a.1[1] - b.1[1]) < clear_m && (a.1[2] - b.1[2]).abs() <= LEVEL_M
        };
        let lands_on = |lands: &Self, stands: &Self| {
            lands.end.is_some_and(|end| {
                end.0 <= stands.begin.0 + slack_s && is_one_place(end, stands.begin)
            })
        };
        let are_down = || {
            let ends = self.end.zip(other.end);
            ends.is_some_and(|(a, b)| {
                (a.0 - b.0).abs() < CLEARED_AFTER_S + slack_s && is_one_place(a, b)
            })
        };
        lands_on(self, other) || lands_on(other, self) || are_down()
    }
}

/// The numbers of tracks by where they begin and end.
#[derive(Clone, Debug, Default)]
pub(super) struct ByPlace {
    cells: HashMap<(i64, i64), Vec<usize>>,
}

impl ByPlace {
    pub(super) fn add(&mut self, number: usize, ends: &Ends) {
        for (_, at) in both(*ends) {
            self.cells.entry(cell(at)).or_default().push(number);
        }
    }

    /// The tracks that begin or end near to where one does, some of them twice.
    pub(super) fn near(&self, ends: Ends) -> impl Iterator<Item = usize> {
        let around = both(ends).flat_map(|(_, at)| {
            let (east, north) = cell(at);
            (-1..=1).flat_map(move |x| (-1..=1).map(move |y| (east + x, north + y)))
        });
        let found = around.filter_map(|cell| self.cells.get(&cell));
        found.flatten().copied()
    }
}

/// Both ends, as far as there are two.
fn both(ends: Ends) -> impl Iterator<Item = At> {
    [Some(ends.begin), ends.end].into_iter().flatten()
}

/// The cell of a place; no distance that is kept clear is greater than its side.
fn cell(at: [f64; 3]) -> (i64, i64) {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "places on a map, and casts saturate"
    )]
    let number = |metres: f64| (metres / CLEAR_M).floor() as i64;
    (number(at[0]), number(at[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From a place on a line to another one, metres.
    fn ends((from_m, from_s): (f64, f64), (to_m, to_s): (f64, f64)) -> Ends {
        Ends {
            begin: (from_s, [from_m, 0.0, 5.0]),
            end: Some((to_s, [to_m, 0.0, 5.0])),
        }
    }

    #[test]
    fn nobody_lands_on_who_stands_or_is_just_down() {
        let own = ends((0.0, 0.0), (500.0, 100.0));
        let high = Ends {
            begin: (120.0, [500.0, 0.0, 60.0]),
            end: None,
        };
        for (other, is_in_the_way) in [
            (ends((500.0, 90.0), (900.0, 300.0)), false),
            // Its departure may be later than it says.
            (ends((500.0, 98.0), (900.0, 300.0)), true),
            (ends((500.0, 120.0), (900.0, 300.0)), true),
            (ends((504.0, 120.0), (900.0, 300.0)), false),
            (ends((900.0, 0.0), (501.0, 125.0)), true),
            (ends((900.0, 0.0), (501.0, 140.0)), false),
            (ends((900.0, -90.0), (0.0, -5.0)), true),
            (high, false),
        ] {
            for (one, another) in [(own, other), (other, own)] {
                let found = one.are_in_conflict(&another, CLEAR_M, 5.0);
                assert_eq!(found, is_in_the_way, "{one:?} {another:?}");
            }
        }
    }
}

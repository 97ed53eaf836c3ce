//! The worst of many values against one limit.

use crate::verify::{Limit, Margin, Moment, Requirement, Sense};

/// A limit holds when it is missed by no more than this: the noise of float32
/// altitudes (half a millimetre at 8 km), in the unit of the limit.
const ROUNDING: f64 = 1e-3;

/// Keeps the value with the least room to its limit. NaN is worse than anything.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Worst {
    /// What is left to the limit; negative when it is violated.
    room: f64,
    value: f64,
    bound: f64,
    sense: Sense,
    at: Option<Moment>,
    note: String,
    /// Nobody asks where and when that is.
    is_room_alone: bool,
}

impl Default for Worst {
    fn default() -> Self {
        Self {
            room: f64::INFINITY,
            value: f64::INFINITY,
            bound: 0.0,
            sense: Sense::AtLeast,
            at: None,
            note: String::new(),
            is_room_alone: false,
        }
    }
}

impl Worst {
    /// What is left to the limit so far.
    pub(crate) fn room(&self) -> f64 {
        self.room
    }

    /// Takes a value that must be at least `bound`, if it is the worst.
    pub(crate) fn at_least(&mut self, value: f64, bound: f64, at: impl FnOnce() -> Moment) {
        self.offer(value - bound, value, bound, at);
    }

    /// Takes a value that must be at most `bound`, if it is the worst.
    pub(crate) fn at_most(&mut self, value: f64, bound: f64, at: impl FnOnce() -> Moment) {
        self.sense = Sense::AtMost;
        self.offer(bound - value, value, bound, at);
    }

    /// Takes a place where the value cannot be known, and why.
    pub(crate) fn unknown(&mut self, bound: f64, note: String, at: Moment) {
        if !self.room.is_nan() {
            self.note = note;
        }
        self.offer(f64::NAN, f64::NAN, bound, || at);
    }

    fn offer(&mut self, room: f64, value: f64, bound: f64, at: impl FnOnce() -> Moment) {
        // The first NaN stays.
        if !self.room.is_nan() && (room < self.room || room.is_nan()) {
            self.room = room;
            self.value = value;
            self.bound = bound;
            self.at = (!self.is_room_alone).then(at);
        }
    }

    /// The margin, if there was anything to judge.
    pub(crate) fn margin(self, vehicle: &str, limit: Limit, unit: &'static str) -> Option<Margin> {
        self.at?;
        let required = Requirement {
            limit,
            bound: self.bound,
            sense: self.sense,
            unit,
        };
        Some(Margin {
            ok: self.room >= -ROUNDING,
            note: self.note,
            ..required.margin(vehicle, self.value, self.at)
        })
    }
}

/// The worst value of many parts. Judges the part with the lowest bound first, then skips every part
/// whose bound exceeds the least room found. A bound above `silent` never exceeds the room of its part.
pub(crate) fn nearest_first<T>(
    parts: &[T],
    bound: impl Fn(&T) -> f64,
    silent: f64,
    judge: impl Fn(&T, &mut Worst),
) -> Worst {
    let room = |part: &T| {
        let mut alone = Worst {
            is_room_alone: true,
            ..Worst::default()
        };
        judge(part, &mut alone);
        alone.room
    };
    let bounds: Vec<f64> = parts.iter().map(bound).collect();
    let nearest = (0..parts.len()).min_by(|&a, &b| bounds[a].total_cmp(&bounds[b]));
    let known = nearest.map_or(f64::INFINITY, |index| room(&parts[index]));
    let (mut least, mut first) = (f64::INFINITY, None);
    for (part, bound) in parts.iter().zip(bounds) {
        if bound <= least.min(known).max(silent) {
            let room = room(part);
            if room < least || room.is_nan() {
                (least, first) = (room, Some(part));
            }
            if room.is_nan() {
                break;
            }
        }
    }
    let mut worst = Worst::default();
    if let Some(part) = first {
        judge(part, &mut worst);
    }
    worst
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{Worst, nearest_first};
    use crate::geodesy::{Amsl, LatLon};
    use crate::verify::{Limit, Moment};

    fn at(item: usize) -> Moment {
        Moment {
            place: LatLon {
                lat_deg: 0.0,
                lon_deg: 0.0,
            },
            amsl: Amsl(0.0),
            t_s: 0.0,
            item,
        }
    }

    proptest! {
        #[test]
        fn parts_left_out_for_their_bounds_change_nothing(
            rooms in proptest::collection::vec((-4..9_i32, 0..5_i32), 0..20),
            silent in -2..1_i32,
        ) {
            // A bound above `silent` is at most the room; few different rooms, so that some are equal.
            let bound = |&(room, less): &(i32, i32)| {
                f64::from(if room < silent { silent - less } else { room - less })
            };
            let rooms: Vec<(usize, (i32, i32))> = rooms.into_iter().enumerate().collect();
            let judge = |(item, (room, _)): &(usize, (i32, i32)), worst: &mut Worst| {
                worst.at_least(f64::from(*room), 0.0, || at(*item));
            };
            let mut all = Worst::default();
            for part in &rooms {
                judge(part, &mut all);
            }
            let found = nearest_first(&rooms, |(_, part)| bound(part), f64::from(silent), judge);
            prop_assert_eq!(found, all);
        }
    }

    #[test]
    fn a_value_that_is_not_a_number_is_the_worst_and_fails() {
        let mut worst = Worst::default();
        worst.at_least(5.0, 1.0, || at(1));
        worst.at_least(f64::NAN, 1.0, || at(2));
        worst.at_least(-5.0, 1.0, || at(3));
        let margin = worst
            .margin("alpha", Limit::TerrainClearance, "m")
            .expect("was judged");
        assert!(!margin.ok && margin.value.is_nan());
        assert_eq!(margin.at.map(|at| at.item), Some(2));
    }
}

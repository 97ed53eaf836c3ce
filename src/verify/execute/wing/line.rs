//! A straight leg in the plane, as the guidance of a wing sees it.

use crate::geodesy::EastNorth;

/// A straight leg.
#[derive(Clone, Copy)]
pub(crate) struct Line {
    pub(super) from: EastNorth,
    pub(super) to: EastNorth,
    pub(super) unit: [f64; 2],
    pub(super) length_m: f64,
}

impl Line {
    pub(super) fn new(from: EastNorth, to: EastNorth) -> Self {
        let length_m = from.distance_m(to).max(1e-3);
        Self {
            from,
            to,
            unit: [
                (to.east_m - from.east_m) / length_m,
                (to.north_m - from.north_m) / length_m,
            ],
            length_m,
        }
    }

    /// The place on it at a distance before its end.
    pub(super) fn before_end(&self, distance_m: f64) -> EastNorth {
        EastNorth {
            east_m: self.to.east_m - distance_m * self.unit[0],
            north_m: self.to.north_m - distance_m * self.unit[1],
        }
    }

    /// From its beginning to a place, metres.
    pub(super) fn gone(&self, at: [f64; 2]) -> [f64; 2] {
        [at[0] - self.from.east_m, at[1] - self.from.north_m]
    }

    /// What of a vector is along it.
    pub(super) fn ahead(&self, v: [f64; 2]) -> f64 {
        v[0] * self.unit[0] + v[1] * self.unit[1]
    }

    /// What of a vector is across it, to the right.
    pub(super) fn right(&self, v: [f64; 2]) -> f64 {
        v[0] * self.unit[1] - v[1] * self.unit[0]
    }

    /// How far along it a place is, as a share of its length; negative before it.
    pub(super) fn share(&self, at: EastNorth) -> f64 {
        self.along([at.east_m, at.north_m]) / self.length_m
    }

    /// How far along it a place is, metres.
    pub(super) fn along(&self, at: [f64; 2]) -> f64 {
        self.ahead(self.gone(at))
    }

    /// Distance from the leg, its ends included.
    pub(super) fn cross_track_m(&self, at: [f64; 2]) -> f64 {
        let gone = self.gone(at);
        let along_m = self.ahead(gone);
        let over_m = along_m - along_m.clamp(0.0, self.length_m);
        if over_m == 0.0 {
            self.right(gone).abs()
        } else {
            self.right(gone).hypot(over_m)
        }
    }

    /// That distance, or another one if that is less.
    pub(super) fn cross_track_or_less_m(&self, other_m: f64, at: [f64; 2]) -> f64 {
        let gone = self.gone(at);
        let along_m = self.ahead(gone);
        let over_m = along_m - along_m.clamp(0.0, self.length_m);
        // The root only where it may decide.
        if self.right(gone).abs().max(over_m.abs()) >= other_m {
            return other_m;
        }
        self.cross_track_m(at).min(other_m)
    }

    /// Whether its end is within a distance of a place.
    pub(super) fn ends_within(&self, distance_m: f64, at: [f64; 2]) -> bool {
        let (east_m, north_m) = (at[0] - self.to.east_m, at[1] - self.to.north_m);
        // The root only where it may decide.
        let is_far = east_m.abs().max(north_m.abs()) > distance_m + 1e-3;
        !is_far && east_m.hypot(north_m) <= distance_m
    }

    /// Change of course to the next leg, radians.
    pub(super) fn turn_rad(&self, next: &Self) -> f64 {
        self.right(next.unit).atan2(self.ahead(next.unit))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_distance_or_less_is_the_lesser_of_both(
            to in prop::array::uniform2(-9.0..9.0_f64), at in prop::array::uniform2(-9.0..9.0_f64), other_m in 0.0..9.0_f64
        ) {
            let place = |[east_m, north_m]: [f64; 2]| EastNorth { east_m, north_m };
            let line = Line::new(place([0.0, 0.0]), place(to));
            let lesser_m = line.cross_track_m(at).min(other_m);
            let found_m = line.cross_track_or_less_m(other_m, at);
            prop_assert_eq!(found_m.to_bits(), lesser_m.to_bits());
        }
    }
}

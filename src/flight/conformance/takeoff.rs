//! Where a QuadPlane may be between its climb and its first legs, and in its descent: the regions that
//! the verdict judges.

use super::COLUMN_M;
use super::reference::ReferenceTrajectory;
use crate::geodesy::EastNorth;
use crate::path::heading_rad;
use crate::spec::{TakeoffRegion, Vehicle};

/// Home and the top of a takeoff that leads straight up are no further apart, metres.
const UPRIGHT_M: f64 = 1.0;

/// How far from its landing a vehicle may be that is on its way to it, metres, where neither minimum height
/// nor legs count.
pub(crate) fn landing_column_m(vehicle: &Vehicle, plan: &ReferenceTrajectory) -> f64 {
    let mut legs = plan.waypoints.windows(2).rev();
    let leg = legs.find(|leg| leg[0].point.at.distance_m(leg[1].point.at) > UPRIGHT_M);
    let course_rad = leg.map(|leg| heading_rad(leg[0].point.at, leg[1].point.at));
    let drift_m = vehicle.landing_drift_m(course_rad);
    match drift_m > 0.0 {
        true => COLUMN_M.max(drift_m + vehicle.facts().buffer_m),
        false => COLUMN_M,
    }
}

/// The region of one plan.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TakeoffTube {
    region: TakeoffRegion,
    middle: EastNorth,
    /// Item of the takeoff.
    top_item: usize,
    /// The places that it may be on its way to, with their items.
    ahead: Vec<(usize, EastNorth)>,
    /// How far outside of it a position may be, metres: what keeps everything else away from it.
    buffer_m: f64,
}

impl TakeoffTube {
    /// None for a vehicle that keeps to its column, and for a plan that does not begin with one.
    pub(crate) fn of(vehicle: &Vehicle, plan: &ReferenceTrajectory) -> Option<Self> {
        let [home, top, rest @ ..] = plan.waypoints.as_slice() else {
            return None;
        };
        let middle = top.point.at;
        if home.point.at.distance_m(middle) > UPRIGHT_M {
            return None;
        }
        let climb_m = top.point.amsl.0 - home.point.amsl.0;
        let region = at_its_fastest(vehicle).takeoff_region(climb_m)?;
        let begins = std::iter::once(top).chain(rest);
        // The first leg, and further ones that begin within the region.
        let legs = begins.zip(rest).enumerate().take_while(|(leg, (from, _))| {
            *leg == 0 || from.point.at.distance_m(middle) < region.reach_m()
        });
        Some(Self {
            region,
            middle,
            top_item: top.item,
            ahead: legs.map(|(_, (_, to))| (to.item, to.point.at)).collect(),
            buffer_m: vehicle.facts().buffer_m,
        })
    }

    /// Whether the region holds a place on the way to an item.
    pub(crate) fn holds(&self, item: usize, at: EastNorth) -> bool {
        if self.climbs(item, at) {
            return true;
        }
        let mut ahead = self.ahead.iter().filter(|(to, _)| item <= *to);
        ahead.any(|(_, to)| self.outside_m(at, *to) <= self.buffer_m)
    }

    /// Whether a vehicle at a place passes a waypoint there, which lies in the region: abeam of it anywhere in that.
    pub(crate) fn passes(&self, (item, waypoint): (usize, EastNorth), at: EastNorth) -> bool {
        waypoint.distance_m(self.middle) < self.region.reach_m() && self.holds(item, at)
    }

    /// Whether it is in its climb, as far off as the wind may drive it.
    pub(crate) fn climbs(&self, item: usize, at: EastNorth) -> bool {
        item <= self.top_item && at.distance_m(self.middle) <= self.region.drift_m + self.buffer_m
    }

    fn outside_m(&self, at: EastNorth, to: EastNorth) -> f64 {
        let off_rad = heading_rad(self.middle, at) - heading_rad(self.middle, to);
        let (sin, cos) = off_rad.sin_cos();
        let away_m = at.distance_m(self.middle);
        let next_m = to.distance_m(self.middle);
        self.region.outside_m((away_m * cos, away_m * sin), next_m)
    }
}

/// A vehicle whose speed the spec leaves open, at the greatest that it may have.
pub(crate) fn at_its_fastest(vehicle: &Vehicle) -> Vehicle {
    Vehicle {
        speed_mps: vehicle.speeds().most,
        ..vehicle.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As a QuadPlane of ArduPlane 4.7.0-dev flew: it passed a place 93 m from home 173 m abeam, where its nose pointed.
    #[test]
    fn a_place_within_the_region_of_a_takeoff_is_passed_anywhere_in_that() {
        let north = |north_m: f64| EastNorth {
            east_m: 0.0,
            north_m,
        };
        let abeam = EastNorth {
            east_m: 173.0,
            north_m: 93.0,
        };
        let tube = TakeoffTube {
            region: TakeoffRegion {
                drift_m: 10.0,
                carried_m: 30.0,
                transition_m: 80.0,
                turn_m: 120.0,
                late_s: 20.0,
            },
            middle: north(0.0),
            top_item: 1,
            ahead: vec![(3, north(93.0)), (4, north(900.0))],
            buffer_m: 15.0,
        };
        assert!(tube.passes((3, north(93.0)), abeam));
        assert!(!tube.passes((4, north(900.0)), abeam));
        assert!(!tube.passes((3, north(93.0)), north(1200.0)));
    }
}

//! Which routes a vehicle flies, one after the other.

use super::wing::homeward_end;
use crate::geodesy::PlanPoint;
use crate::spec::{Finish, Vehicle};
use crate::world::FixedPoints;

/// A return that is shorter than this is none: the vehicle is over home, metres.
const MIN_RETURN_M: f64 = 10.0;

/// Where the routes of a vehicle begin and end: at start, stops and goal, and with
/// [`Finish::Return`] over home. Route `k` begins at stop `k - 1`.
#[must_use]
pub fn route_ends(vehicle: &Vehicle, fixed_points: &FixedPoints) -> Vec<(PlanPoint, PlanPoint)> {
    let mut ends = vec![fixed_points.start];
    ends.extend(&fixed_points.stops);
    ends.push(fixed_points.goal);
    if vehicle.finish == Finish::Return {
        let home = homeward_end(vehicle, fixed_points);
        let is_home = home.at.distance_m(fixed_points.goal.at) < MIN_RETURN_M;
        if fixed_points.stops.is_empty() || !is_home {
            ends.push(home);
        }
    }
    ends.windows(2).map(|pair| (pair[0], pair[1])).collect()
}

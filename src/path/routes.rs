//! Which routes a vehicle flies, one after the other.

use super::wing::homeward_end;
use crate::geodesy::PlanPoint;
use crate::spec::{Finish, Vehicle};
use crate::world::VehicleSites;

/// A return that is shorter than this is none: the vehicle is over home, metres.
const MIN_RETURN_M: f64 = 10.0;

/// Where the routes of a vehicle begin and end: at start, stops and goal, and with
/// [`Finish::Return`] over home. Route `k` begins at stop `k - 1`.
#[must_use]
pub fn route_ends(vehicle: &Vehicle, sites: &VehicleSites) -> Vec<(PlanPoint, PlanPoint)> {
    let mut ends = vec![sites.start];
    ends.extend(&sites.stops);
    ends.push(sites.goal);
    if vehicle.finish == Finish::Return {
        let home = homeward_end(vehicle, sites);
        let is_home = home.at.distance_m(sites.goal.at) < MIN_RETURN_M;
        if sites.stops.is_empty() || !is_home {
            ends.push(home);
        }
    }
    ends.windows(2).map(|pair| (pair[0], pair[1])).collect()
}

//! From control points to a sampled, timed path.

mod course;
mod dubins;
mod flyable;
mod join;
mod lateness;
mod limits;
mod routes;
mod timeline;
mod wing;

pub use course::{along, heading_rad};
pub use dubins::{Pose, Turns, all_turns, turns, turns_sampled};
pub use flyable::lean_note;
pub use join::{Among, IsFree, join};
pub use lateness::{
    COUNTS_AFTER_S, Departing, corner_late_s, landing_shift_s, late_share, leg_late_s,
    leg_late_share, longer_for_takeoff_s, max_shift_s, stop_late_s, takeoff_lateness_s,
    takeoff_shift_s, with_stops_s,
};
pub use limits::{POLYNOMIAL_TOP_M, SlopeLimit, VehicleLimits};
pub use routes::route_ends;
pub use timeline::{
    Flight, flight, flight_among, ramp_stops_m, route_start_s, time_route, time_route_from,
};
pub use wing::{Approach, ClimbOut, climb_out, homeward_end, landing, way_speed_mps};

pub use crate::world::Departure;

use crate::geodesy::PlanPoint;

/// A point of a path and when the vehicle is there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedPoint {
    /// Where.
    pub point: PlanPoint,
    /// Seconds after the fleet's T0.
    pub t_s: f64,
}

impl TimedPoint {
    /// Its time, seconds, and its east, north and altitude, metres.
    #[must_use]
    pub fn placed(&self) -> (f64, [f64; 3]) {
        (self.t_s, self.point.axes_m())
    }
}

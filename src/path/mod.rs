//! From control points to a sampled, timed path.

mod landing;
mod limits;
mod timeline;

pub use landing::{SLOW_LANDING_M, slow_landing_mps};
pub use limits::{GRAVITY_MPS2, POLYNOMIAL_TOP_M, SlopeLimit, VehicleLimits};
pub use timeline::{Flight, flight, ramp_stops_m, route_start_s, time_route};

use crate::geodesy::PlanPoint;

/// A point of a path and when the vehicle is there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedPoint {
    /// Where.
    pub point: PlanPoint,
    /// Seconds after the fleet's T0.
    pub t_s: f64,
}

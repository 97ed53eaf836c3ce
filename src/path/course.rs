//! Courses between places.

use crate::geodesy::EastNorth;

/// The course from a place to another, radians clockwise from north.
#[must_use]
pub fn heading_rad(from: EastNorth, to: EastNorth) -> f64 {
    (to.east_m - from.east_m).atan2(to.north_m - from.north_m)
}

/// The place so far along a course.
#[must_use]
pub fn along(from: EastNorth, heading_rad: f64, distance_m: f64) -> EastNorth {
    EastNorth {
        east_m: from.east_m + distance_m * heading_rad.sin(),
        north_m: from.north_m + distance_m * heading_rad.cos(),
    }
}

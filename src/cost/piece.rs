//! Pieces of a path, and what forbidden ones cost.

use crate::geodesy::PlanPoint;
use crate::numeric::geometry::Point;

/// Lengths outside the area and inside zones count this often (design, section 4).
pub(crate) const FORBIDDEN: f64 = 1.1;

/// A straight piece of a path: places and altitudes of its ends, metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub(crate) a: Point,
    pub(crate) b: Point,
    pub(crate) amsl_a_m: f64,
    pub(crate) amsl_b_m: f64,
}

/// A point without its altitude.
pub(crate) fn plane(point: PlanPoint) -> Point {
    [point.at.east_m, point.at.north_m]
}

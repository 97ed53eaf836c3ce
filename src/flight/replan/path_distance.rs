//! How near a path comes to a place.

use crate::geodesy::{EastNorth, PlanPoint};
use crate::numeric::geometry::point_segment_distance;

/// Whether a path comes nearer than a distance to a place.
pub(super) fn comes_near(path: &[PlanPoint], center: EastNorth, distance_m: f64) -> bool {
    let flat = |at: EastNorth| [at.east_m, at.north_m];
    let pairs = path.windows(2).map(|pair| (pair[0].at, pair[1].at));
    let alone = path.last().map(|last| (last.at, last.at));
    pairs
        .chain(alone)
        .any(|(a, b)| point_segment_distance(flat(center), flat(a), flat(b)) < distance_m)
}

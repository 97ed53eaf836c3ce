//! How near a path comes to a place.

use crate::geodesy::{EastNorth, PlanPoint};

/// Whether a path comes nearer than a distance to a place.
pub(super) fn comes_near(path: &[PlanPoint], center: EastNorth, distance_m: f64) -> bool {
    let pairs = path.windows(2).map(|pair| (pair[0].at, pair[1].at));
    let alone = path.last().map(|last| (last.at, last.at));
    pairs
        .chain(alone)
        .any(|(a, b)| away_m(center, a, b) < distance_m)
}

/// Distance of a point of the plane from a leg, metres.
fn away_m(from: EastNorth, a: EastNorth, b: EastNorth) -> f64 {
    let (east, north) = (b.east_m - a.east_m, b.north_m - a.north_m);
    let length_sq = east * east + north * north;
    let gone = (from.east_m - a.east_m) * east + (from.north_m - a.north_m) * north;
    let share = if length_sq > 0.0 {
        (gone / length_sq).clamp(0.0, 1.0)
    } else {
        0.0
    };
    from.distance_m(EastNorth {
        east_m: a.east_m + share * east,
        north_m: a.north_m + share * north,
    })
}

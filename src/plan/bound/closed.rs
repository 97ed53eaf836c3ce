//! What no path that passes may cross, at any altitude: polygons that lie inside of it.

use std::f64::consts::TAU;

use super::closed_ground::closed_ground;
use crate::numeric::geometry::{Point, Ring};
use crate::world::{Disc, World};

/// Corners of the polygon inside of a disc.
const CORNERS: u32 = 64;
/// Rounding of coordinates, metres.
const ROUNDING_M: f64 = 0.01;
/// The earth, rather too small, metres.
const EARTH_RADIUS_M: f64 = 6_300_000.0;

/// Closed polygons, counter-clockwise, holes in them clockwise.
pub(super) fn closed_rings(world: &World) -> Vec<Vec<Point>> {
    let mut rings: Vec<Vec<Point>> = world.threats.iter().filter_map(inscribed).collect();
    for zone in &world.zones {
        if zone.below.is_none_or(|below| below > world.max_amsl) {
            rings.push(Ring::around(&zone.outline).corners().to_vec());
        }
    }
    rings.extend(closed_ground(world));
    rings
}

/// A polygon inside of a disc, on the plane and on the earth.
fn inscribed(disc: &Disc) -> Option<Vec<Point>> {
    // The plane shows lengths far from its origin too short: a disc on the earth is smaller there.
    let far = (disc.center.east_m.hypot(disc.center.north_m) + disc.radius_m) / EARTH_RADIUS_M;
    let radius_m = disc.radius_m * (1.0 - far * far) - ROUNDING_M;
    let corner = |index: u32| {
        let (sin, cos) = (TAU * f64::from(index) / f64::from(CORNERS)).sin_cos();
        [
            disc.center.east_m + radius_m * cos,
            disc.center.north_m + radius_m * sin,
        ]
    };
    (radius_m > 0.0).then(|| (0..CORNERS).map(corner).collect())
}

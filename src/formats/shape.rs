//! Outlines for maps: closed rings of places, counter-clockwise.

use crate::geodesy::{EastNorth, LatLon};
use crate::world::{Disc, World};

/// Corners of a circle.
const CORNERS: u32 = 72;

/// A circle as the polygon around it: what is drawn is never smaller than what is judged.
pub(super) fn circle(world: &World, disc: &Disc) -> Vec<LatLon> {
    let step_rad = std::f64::consts::TAU / f64::from(CORNERS);
    let reach_m = disc.radius_m / (step_rad / 2.0).cos();
    let corners = (0..CORNERS)
        .map(|corner| {
            let (sin, cos) = (f64::from(corner) * step_rad).sin_cos();
            world.frame.from_plan(EastNorth {
                east_m: disc.center.east_m + reach_m * cos,
                north_m: disc.center.north_m + reach_m * sin,
            })
        })
        .collect();
    ring(corners)
}

/// Corners in the order of RFC 7946 section 3.1.6, the first repeated at the end.
pub(super) fn ring(mut corners: Vec<LatLon>) -> Vec<LatLon> {
    let double_area: f64 = corners
        .iter()
        .zip(corners.iter().cycle().skip(1))
        .map(|(a, b)| a.lon_deg * b.lat_deg - b.lon_deg * a.lat_deg)
        .sum();
    if double_area < 0.0 {
        corners.reverse();
    }
    corners.extend(corners.first().copied());
    corners
}

/// Degrees to 1e-7, metres to centimetres: finer than anything that is known.
pub(super) fn rounded(value: f64, per_unit: f64) -> f64 {
    (value * per_unit).round() / per_unit
}

//! Outlines for maps: closed rings, counter-clockwise.

use crate::geodesy::{EastNorth, LatLon, LocalFrame};
use crate::spec::Threat;
use crate::world::World;

/// Corners of a circle.
const CORNERS: u32 = 72;

/// The polygon circumscribed about a threat, so that no map draws it too small.
pub(crate) fn circle(world: &World, threat: &Threat) -> Vec<LatLon> {
    let center = world.frame.to_plan(threat.place);
    circumscribed(&world.frame, center, threat.radius_m)
}

/// The polygon circumscribed about a circle.
pub(crate) fn circumscribed(frame: &LocalFrame, center: EastNorth, radius_m: f64) -> Vec<LatLon> {
    let half_step_rad = std::f64::consts::PI / f64::from(CORNERS);
    inscribed(frame, center, radius_m / half_step_rad.cos())
}

/// The polygon inscribed in a circle.
pub(crate) fn inscribed(frame: &LocalFrame, center: EastNorth, radius_m: f64) -> Vec<LatLon> {
    let step_rad = std::f64::consts::TAU / f64::from(CORNERS);
    let corners = (0..CORNERS)
        .map(|corner| {
            let (sin, cos) = (f64::from(corner) * step_rad).sin_cos();
            frame.from_plan(EastNorth {
                east_m: center.east_m + radius_m * cos,
                north_m: center.north_m + radius_m * sin,
            })
        })
        .collect();
    ring(corners)
}

/// Corners in the order of RFC 7946 section 3.1.6, the first repeated at the end.
pub(crate) fn ring(mut corners: Vec<LatLon>) -> Vec<LatLon> {
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

/// A value rounded to one part in `per_unit`: 1e7 for degrees, 1e2 for metres.
pub(crate) fn rounded(value: f64, per_unit: f64) -> f64 {
    (value * per_unit).round() / per_unit
}

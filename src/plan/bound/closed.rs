//! What no path that passes may cross, at any altitude: polygons that lie inside of it.

use std::f64::consts::TAU;

use super::closed_ground::{MIN_EARTH_RADIUS_M, closed_ground};
use crate::numeric::geometry::{Point, Ring};
use crate::spec::{MissionSpec, Placement, Zone};
use crate::world::{Disc, PlanZone, World};

/// Corners of the polygon inside of a disc.
const CORNERS: u32 = 64;
/// Rounding of coordinates, metres.
const ROUNDING_M: f64 = 0.01;

/// Closed polygons, counter-clockwise, holes in them clockwise.
pub(super) fn closed_rings(spec: &MissionSpec, world: &World) -> Vec<Vec<Point>> {
    let mut rings: Vec<Vec<Point>> = world.threats.iter().filter_map(inscribed).collect();
    for (zone, given) in world.zones.iter().zip(&spec.no_fly) {
        if !is_closed_throughout(zone, world) {
            continue;
        }
        rings.extend(zone_ring(world, zone, given));
    }
    rings.extend(closed_ground(world));
    rings
}

/// A polygon inside of a zone.
pub(super) fn zone_ring(world: &World, zone: &PlanZone, given: &Zone) -> Option<Vec<Point>> {
    // The outline of a circle reaches beyond it.
    match given.circle {
        Some((center, radius_m)) => inscribed(&Disc {
            center: world.frame.to_plan(center),
            radius_m,
        }),
        None => Some(Ring::around(&zone.outline).corners().to_vec()),
    }
}

/// Whether a zone is closed at every time and every altitude that a path may have in it.
pub(super) fn is_closed_throughout(zone: &PlanZone, world: &World) -> bool {
    let to_above = match zone.ceiling {
        None => true,
        Some(Placement::Amsl(ceiling)) => ceiling > world.max_amsl,
        Some(Placement::Agl(_)) => false,
    };
    is_always_closed_from_below(zone, world) && to_above
}

/// Whether a zone is closed at every time, from below the least height that a path may have.
pub(super) fn is_always_closed_from_below(zone: &PlanZone, world: &World) -> bool {
    let is_from_below = match zone.floor {
        None => true,
        Some(Placement::Agl(floor)) => floor <= world.min_agl,
        Some(Placement::Amsl(_)) => false,
    };
    zone.active_s.is_none() && is_from_below
}

/// A polygon inside of a disc, on the plane and on the earth.
fn inscribed(disc: &Disc) -> Option<Vec<Point>> {
    let Disc { center, radius_m } = smaller(disc);
    let corner = |index: u32| {
        let (sin, cos) = (TAU * f64::from(index) / f64::from(CORNERS)).sin_cos();
        [
            center.east_m + radius_m * cos,
            center.north_m + radius_m * sin,
        ]
    };
    (radius_m > 0.0).then(|| (0..CORNERS).map(corner).collect())
}

/// A disc that lies in another one on the plane and on the earth.
pub(super) fn smaller(disc: &Disc) -> Disc {
    // The plane shows lengths far from its origin too short: a disc on the earth is smaller there.
    let far = (disc.center.east_m.hypot(disc.center.north_m) + disc.radius_m) / MIN_EARTH_RADIUS_M;
    Disc {
        radius_m: disc.radius_m * (1.0 - far * far) - ROUNDING_M,
        ..*disc
    }
}

//! Zones that close nothing, because their ceiling is under the ground or their floor over it.

use geo::{BoundingRect, Contains, Point};

use super::World;
use crate::geodesy::{Agl, Amsl, EastNorth};
use crate::numeric::digits::distinct_from;
use crate::spec::{MissionSpec, Placement, Zone};

/// Rows and columns of the points at which the ground is looked at.
const SIDE: u32 = 12;

/// A warning for each zone whose ceiling is not over the ground, or under its floor above
/// ground, wherever that is known.
pub(super) fn warnings(spec: &MissionSpec, world: &World) -> Vec<String> {
    let sunken = spec.no_fly.iter().filter_map(|zone| {
        if let Some(Placement::Agl(Agl(ceiling_m))) = zone.ceiling
            && ceiling_m <= 0.0
        {
            return Some(format!(
                "zone {} closes nothing: its ceiling of {ceiling_m} m above the ground is not over it",
                zone.id
            ));
        }
        let Some(Placement::Amsl(Amsl(ceiling_m))) = zone.ceiling else {
            return None;
        };
        if let Some(Placement::Agl(Agl(floor_m))) = zone.floor
            && let Some(ground_m) = min_ground_m(zone, world, ceiling_m - floor_m)
        {
            return Some(format!(
                "zone {} closes nothing: its floor of {floor_m} m above the ground, which is at {ground_m:.0} m or more \
                 there, is over its ceiling of {ceiling_m} m above mean sea level",
                zone.id
            ));
        }
        let ground_m = min_ground_m(zone, world, ceiling_m)?;
        Some(format!(
            "zone {} closes nothing: its ceiling of {} m above mean sea level is under the ground, which is at {} m or \
             more there; is it in feet, or above the ground (agl_m)?",
            zone.id,
            distinct_from(ceiling_m, ground_m, 0),
            distinct_from(ground_m, ceiling_m, 0)
        ))
    });
    sunken.collect()
}

/// The ground where it is least within a zone, metres; none if it is nowhere known, or anywhere not
/// above the ceiling.
fn min_ground_m(zone: &Zone, world: &World, ceiling_m: f64) -> Option<f64> {
    let outline = world.frame.outline(&zone.polygon);
    let bounds = outline.bounding_rect()?;
    let share = |index: u32| (f64::from(index) + 0.5) / f64::from(SIDE);
    let within = (0..SIDE * SIDE).filter_map(|index| {
        let east_m = bounds.min().x + share(index % SIDE) * bounds.width();
        let north_m = bounds.min().y + share(index / SIDE) * bounds.height();
        let is_in = outline.contains(&Point::new(east_m, north_m));
        is_in.then(|| world.frame.from_plan(EastNorth { east_m, north_m }))
    });
    let mut min_m = f64::INFINITY;
    for place in zone.polygon.iter().copied().chain(within) {
        if let Ok(Amsl(ground_m)) = world.terrain.height(place) {
            if ground_m <= ceiling_m {
                return None;
            }
            min_m = min_m.min(ground_m);
        }
    }
    min_m.is_finite().then_some(min_m)
}

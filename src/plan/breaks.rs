//! The limits that a path breaks, by the name and place of what stands in its way.

use geo::{Contains, Point};

use super::VehiclePlan;
use crate::geodesy::{EastNorth, PlanPoint};
use crate::path::VehicleLimits;
use crate::spec::{MissionSpec, Vehicle};
use crate::world::World;

/// Something a path goes through or does not manage, where it is worst.
#[derive(Clone, Debug, PartialEq)]
pub struct Break {
    /// What, in words: `threat radar-1`, `zone town`, `the ground`, `a turn`.
    pub what: String,
    /// By how much it is worst, in words.
    pub how: String,
    /// Where it is worst.
    pub at: PlanPoint,
}

/// Hair's breadths that are no violation, metres.
const HAIR_M: f64 = 0.01;

/// Everything that the path of a vehicle violates, and so what blocks it: the path is the
/// least bad that was found. Earlier vehicles are not among it. Empty if the path keeps
/// every limit.
#[must_use]
pub fn breaks(
    spec: &MissionSpec,
    world: &World,
    vehicle: &Vehicle,
    plan: &VehiclePlan,
) -> Vec<Break> {
    if plan.terms.is_clean() {
        return Vec::new();
    }
    let mut found = Vec::new();
    let routes = plan.points();
    let points = routes.concat();
    if plan.terms.threat > 0.0 {
        found.extend(entered(spec, world, &points));
    }
    if plan.terms.terrain > 0.0 {
        found.extend(too_low_or_high(world, &points));
    }
    let limits = VehicleLimits::of(vehicle);
    if plan.terms.turn > 0.0 {
        let tightest = triples(&routes).map(|[a, b, c]| (b, radius_m(a.at, b.at, c.at)));
        found.extend(least(tightest).map(|(at, radius_m)| Break {
            what: format!("a turn{}", beside(spec, world, at, limits.turn_radius_m)),
            how: format!(
                "radius {radius_m:.0} m, {:.0} m is what the vehicle can fly",
                limits.turn_radius_m
            ),
            at,
        }));
    }
    if plan.terms.climb > 0.0 {
        found.extend(steepest(&routes, &limits));
    }
    found
}

/// Threats, zones and the edge of the area, each where the path is deepest in it.
fn entered(spec: &MissionSpec, world: &World, points: &[PlanPoint]) -> Vec<Break> {
    let mut found = Vec::new();
    for (threat, disc) in spec.threats.iter().zip(&world.threats) {
        let depths = points
            .iter()
            .map(|at| (*at, at.at.distance_m(disc.center) - disc.radius_m));
        if let Some((at, outside_m)) = least(depths).filter(|worst| worst.1 < -HAIR_M) {
            found.push(Break {
                what: format!("threat {}", threat.id),
                how: format!("{:.0} m inside", -outside_m),
                at,
            });
        }
    }
    for (named, zone) in spec.no_fly.iter().zip(&world.zones) {
        let inside = points.iter().copied().filter(|point| {
            let place = Point::new(point.at.east_m, point.at.north_m);
            zone.below.is_none_or(|below| point.amsl.0 < below.0) && zone.outline.contains(&place)
        });
        let inside: Vec<PlanPoint> = inside.collect();
        if let Some(at) = inside.get(inside.len() / 2) {
            found.push(Break {
                what: format!("zone {}", named.id),
                how: "inside".to_owned(),
                at: *at,
            });
        }
    }
    let outside: Vec<&PlanPoint> = points.iter().filter(|at| !world.in_area(at.at)).collect();
    if let Some(at) = outside.get(outside.len() / 2) {
        found.push(Break {
            what: "the edge of the area".to_owned(),
            how: "outside".to_owned(),
            at: **at,
        });
    }
    found
}

/// Ground and ceiling, each where the path is worst.
fn too_low_or_high(world: &World, points: &[PlanPoint]) -> Vec<Break> {
    let mut found = Vec::new();
    let above = points
        .iter()
        .map(|point| (*point, point.amsl.0 - world.ground.height_m(point.at)));
    if let Some((at, agl_m)) = least(above).filter(|worst| worst.1 < world.min_agl.0 - HAIR_M) {
        found.push(Break {
            what: format!("the ground, {:.0} m high", at.amsl.0 - agl_m),
            how: format!("{agl_m:.0} m above it instead of {:.0} m", world.min_agl.0),
            at,
        });
    }
    let below = points
        .iter()
        .map(|point| (*point, world.max_amsl.0 - point.amsl.0));
    if let Some((at, room_m)) = least(below).filter(|worst| worst.1 < -HAIR_M) {
        found.push(Break {
            what: format!(
                "the ceiling over ground {:.0} m high",
                world.ground.height_m(at.at)
            ),
            how: format!("{:.0} m above it", -room_m),
            at,
        });
    }
    found
}

/// The steepest place, if it is steeper than the vehicle climbs or descends.
fn steepest(routes: &[Vec<PlanPoint>], limits: &VehicleLimits) -> Option<Break> {
    let slopes = routes
        .iter()
        .flat_map(|route| route.windows(2))
        .map(|pair| {
            let run_m = pair[0].at.distance_m(pair[1].at).max(1e-6);
            let slope = (pair[1].amsl.0 - pair[0].amsl.0) / run_m;
            let limit = if slope > 0.0 {
                limits.climb.at(pair[1].amsl)
            } else {
                limits.descent.at(pair[0].amsl)
            };
            (pair[0], limit - slope.abs(), slope, limit)
        });
    let worst = slopes.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (at, room, slope, limit) = worst;
    (room < 0.0).then(|| Break {
        what: format!("a {}", if slope > 0.0 { "climb" } else { "descent" }),
        how: format!(
            "{:.1} degrees, {:.1} is what the vehicle can fly",
            slope.abs().atan().to_degrees(),
            limit.atan().to_degrees()
        ),
        at,
    })
}

/// The threats near a place, in words: what leaves no room for a turn.
fn beside(spec: &MissionSpec, world: &World, at: PlanPoint, reach_m: f64) -> String {
    let near: Vec<&str> = spec
        .threats
        .iter()
        .zip(&world.threats)
        .filter(|(_, disc)| at.at.distance_m(disc.center) < disc.radius_m + reach_m)
        .map(|(threat, _)| threat.id.as_str())
        .collect();
    if near.is_empty() {
        String::new()
    } else {
        format!(" beside {}", near.join(" and "))
    }
}

/// Three points in a row of each route, far enough apart to have a radius.
fn triples(routes: &[Vec<PlanPoint>]) -> impl Iterator<Item = [PlanPoint; 3]> {
    routes
        .iter()
        .flat_map(|route| route.windows(3))
        .map(|three| [three[0], three[1], three[2]])
}

/// Radius of the circle through three places, metres; infinite on a line.
fn radius_m(a: EastNorth, b: EastNorth, c: EastNorth) -> f64 {
    let (u, v) = (
        (b.east_m - a.east_m, b.north_m - a.north_m),
        (c.east_m - b.east_m, c.north_m - b.north_m),
    );
    let twice_area = (u.0 * v.1 - u.1 * v.0).abs();
    a.distance_m(b) * b.distance_m(c) * c.distance_m(a) / (2.0 * twice_area).max(1e-12)
}

fn least(values: impl Iterator<Item = (PlanPoint, f64)>) -> Option<(PlanPoint, f64)> {
    values.min_by(|a, b| a.1.total_cmp(&b.1))
}

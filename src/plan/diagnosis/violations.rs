//! Violations: the limits that a path breaks, with the name of the obstacle and the position.

use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::numeric::Basis;
use crate::numeric::geometry::{Offset, Point, Ring, point_segment_distance};
use crate::path::VehicleLimits;
use crate::plan::search::JUDGED_SAMPLES;
use crate::plan::{Route, VehiclePlan};
use crate::spec::{MissionSpec, Vehicle};
use crate::world::{Layer, World};

/// A limit that a path breaks, where it is worst.
#[derive(Clone, Debug, PartialEq)]
pub struct Violation {
    /// What, in words: `threat radar-1`, `zone town`, `the ground`, `a turn`.
    pub what: String,
    /// By how much it is worst, in words.
    pub how: String,
    /// Where it is worst.
    pub at: PlanPoint,
}

/// Everything that the path of a vehicle violates, and so what blocks it: the path is the
/// least bad that was found. Earlier vehicles are not among it. Empty if the path keeps
/// every limit.
#[must_use]
pub fn violations(
    spec: &MissionSpec,
    world: &World,
    vehicle: &Vehicle,
    plan: &VehiclePlan,
) -> Vec<Violation> {
    if plan.terms.is_clean() {
        return Vec::new();
    }
    let mut found = Vec::new();
    let routes: Vec<Vec<PlanPoint>> = plan.routes.iter().map(judged).collect();
    if plan.terms.threat > 0.0 {
        found.extend(entered(spec, world, &routes));
    }
    if plan.terms.terrain > 0.0 {
        let index = (spec.vehicles.iter()).position(|other| other.id == vehicle.id);
        let layer = index.map_or(Layer::UNLIMITED, |index| world.layer(index));
        found.extend(too_low_or_high(world, &routes));
        found.extend(out_of_layer((world, layer), &routes));
    }
    let limits = VehicleLimits::of(vehicle);
    if plan.terms.turn > 0.0 {
        let tightest = triples(&routes).map(|[a, b, c]| (b, radius_m(a.at, b.at, c.at)));
        found.extend(least(tightest).map(|(at, radius_m)| Violation {
            what: format!(
                "a turn{}",
                near_threats(spec, world, at, limits.turn_radius_m)
            ),
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
    if found.is_empty() && plan.terms.collision <= 0.0 {
        found.extend(narrowly(plan, &routes));
    }
    found
}

/// That a limit is broken, where no place shows it: only by rounding.
fn narrowly(plan: &VehiclePlan, routes: &[Vec<PlanPoint>]) -> Option<Violation> {
    let kinds = [
        (
            "a threat, a zone or the edge of the area",
            plan.terms.threat,
        ),
        ("the ground or the ceiling", plan.terms.terrain),
    ];
    let (what, _) = kinds.into_iter().find(|(_, cost)| *cost > 0.0)?;
    Some(Violation {
        what: what.to_owned(),
        how: "by less than is measured".to_owned(),
        at: *routes.first()?.first()?,
    })
}

/// The points of a route as it is judged, ends included.
fn judged(route: &Route) -> Vec<PlanPoint> {
    if route.control_points.len() < 4 {
        return route.points();
    }
    let basis = Basis::uniform(route.control_points.len(), JUDGED_SAMPLES);
    let sampled = |of: fn(&PlanPoint) -> f64| {
        let values: Vec<f64> = route.control_points.iter().map(of).collect();
        basis.sampled(&values)
    };
    let (east_m, north_m) = (sampled(|p| p.at.east_m), sampled(|p| p.at.north_m));
    let positions = east_m.into_iter().zip(north_m);
    positions
        .zip(sampled(|p| p.amsl.0))
        .map(|((east_m, north_m), amsl_m)| PlanPoint::new(east_m, north_m, Amsl(amsl_m)))
        .collect()
}

/// The straight pieces of all routes.
fn pieces(routes: &[Vec<PlanPoint>]) -> impl Iterator<Item = (PlanPoint, PlanPoint)> {
    let pairs = routes.iter().flat_map(|route| route.windows(2));
    pairs.map(|pair| (pair[0], pair[1]))
}

fn plane(point: PlanPoint) -> Point {
    [point.at.east_m, point.at.north_m]
}

/// Threats, zones and the edge of the area, each where the path is deepest in it.
fn entered(spec: &MissionSpec, world: &World, routes: &[Vec<PlanPoint>]) -> Vec<Violation> {
    let mut found = Vec::new();
    for (threat, disc) in spec.threats.iter().zip(&world.threats) {
        let center = [disc.center.east_m, disc.center.north_m];
        let depths = pieces(routes).map(|(a, b)| {
            let nearest_m = point_segment_distance(center, plane(a), plane(b));
            (a, nearest_m - disc.radius_m)
        });
        if let Some((at, outside_m)) = least(depths).filter(|worst| worst.1 < 0.0) {
            found.push(Violation {
                what: format!("threat {}", threat.id),
                how: format!("{} inside", metres(-outside_m)),
                at,
            });
        }
    }
    for (named, zone) in spec.no_fly.iter().zip(&world.zones) {
        let closed = zone.offset();
        let lengths = pieces(routes).map(|piece| {
            let (from_m, below_m) = zone.closed_m(world.ground.height_m(piece.0.at));
            let inside_m = within_m(&closed, below_m, piece) - within_m(&closed, from_m, piece);
            (piece.0, inside_m)
        });
        found.extend(lengthy(lengths).map(|(at, length_m)| Violation {
            what: format!("zone {}", named.id),
            how: format!("{} of the path inside", metres(length_m)),
            at,
        }));
    }
    let area = Offset::new(Ring::around(&world.area), 0.0);
    let outside = pieces(routes).map(|(a, b)| {
        let length_m = a.at.distance_m(b.at);
        (a, length_m - within_m(&area, f64::INFINITY, (a, b)))
    });
    found.extend(lengthy(outside).map(|(at, length_m)| Violation {
        what: "the edge of the area".to_owned(),
        how: format!("{} of the path outside", metres(length_m)),
        at,
    }));
    found
}

/// The length of a piece that lies in a ring below an altitude, metres.
fn within_m(ring: &Offset, below_m: f64, (a, b): (PlanPoint, PlanPoint)) -> f64 {
    let (low, high) = (a.amsl.0.min(b.amsl.0), a.amsl.0.max(b.amsl.0));
    if low >= below_m || ring.is_far_from(plane(a), plane(b)) {
        return 0.0;
    }
    let share = match high < below_m {
        true => 1.0,
        false => (below_m - low) / (high - low),
    };
    let part = match a.amsl.0 <= b.amsl.0 {
        true => (0.0, share),
        false => (1.0 - share, 1.0),
    };
    let inside = ring.inside_fraction((plane(a), plane(b)), part, &mut Vec::new());
    inside * a.at.distance_m(b.at)
}

/// The middle of what has a length, and all of it, metres; none if it is nothing.
fn lengthy(lengths: impl Iterator<Item = (PlanPoint, f64)>) -> Option<(PlanPoint, f64)> {
    /// Less is rounding.
    const NOTHING_M: f64 = 1e-9;
    let some: Vec<(PlanPoint, f64)> = lengths
        .filter(|(_, length_m)| *length_m > NOTHING_M)
        .collect();
    let (at, _) = some.get(some.len() / 2)?;
    Some((*at, some.iter().map(|(_, length_m)| length_m).sum()))
}

/// Ground and ceiling, each where the path is worst.
fn too_low_or_high(world: &World, routes: &[Vec<PlanPoint>]) -> Vec<Violation> {
    let mut found = Vec::new();
    let points = || readings(routes);
    let agl_m = |point: PlanPoint| point.amsl.0 - world.ground.height_m(point.at);
    let unknown: Vec<PlanPoint> = points().filter(|point| agl_m(*point).is_nan()).collect();
    if let Some(at) = unknown.get(unknown.len() / 2) {
        found.push(Violation {
            what: "ground of unknown height".to_owned(),
            how: "the terrain has no data there".to_owned(),
            at: *at,
        });
    }
    let above = points().map(|point| (point, agl_m(point)));
    let known = above.filter(|(_, agl_m)| !agl_m.is_nan());
    if let Some((at, agl_m)) = least(known).filter(|worst| worst.1 < world.min_agl.0) {
        found.push(Violation {
            what: format!("the ground, {:.0} m high", at.amsl.0 - agl_m),
            how: format!(
                "{} less above it than {} m",
                metres(world.min_agl.0 - agl_m),
                world.min_agl.0
            ),
            at,
        });
    }
    let below = points().map(|point| (point, world.max_amsl.0 - point.amsl.0));
    if let Some((at, room_m)) = least(below).filter(|worst| worst.1 < 0.0) {
        found.push(Violation {
            what: format!(
                "the ceiling over ground {:.0} m high",
                world.ground.height_m(at.at)
            ),
            how: format!("{} above it", metres(-room_m)),
            at,
        });
    }
    found
}

/// Points as close as the objective reads the ground.
fn readings(routes: &[Vec<PlanPoint>]) -> impl Iterator<Item = PlanPoint> {
    let shares = [0.0, 0.25, 0.5, 0.75, 1.0];
    pieces(routes).flat_map(move |(a, b)| shares.map(|share| a.toward(b, share)))
}

/// The greatest height above ground and the least altitude, each where the path is worst.
fn out_of_layer(
    (world, layer): (&World, Layer),
    routes: &[Vec<PlanPoint>],
) -> impl Iterator<Item = Violation> {
    let ground_m = |point: PlanPoint| world.ground.height_m(point.at);
    let spare_m = |point: PlanPoint| layer.max_agl_m - (point.amsl.0 - ground_m(point));
    let below = readings(routes).map(|point| (point, spare_m(point)));
    let high = least(below.filter(|(_, spare_m)| !spare_m.is_nan()));
    let high = high.filter(|worst| worst.1 < 0.0);
    let high = high.map(|(at, spare_m)| Violation {
        what: format!(
            "the greatest height above ground, {} m, over ground {:.0} m high",
            layer.max_agl_m,
            ground_m(at)
        ),
        how: format!(
            "{} above it: min_agl_m and max_agl_m close the way where the ground is steeper than the vehicle climbs and descends",
            metres(-spare_m)
        ),
        at,
    });
    let above = readings(routes).map(|point| (point, point.amsl.0 - layer.min_amsl_m));
    let low = least(above).filter(|worst| worst.1 < 0.0);
    let low = low.map(|(at, over_m)| Violation {
        what: format!("the least altitude, {} m", layer.min_amsl_m),
        how: format!("{} below it", metres(-over_m)),
        at,
    });
    high.into_iter().chain(low)
}

/// A length with as many digits as it needs not to be nothing.
fn metres(length_m: f64) -> String {
    match length_m {
        10.0.. => format!("{length_m:.0} m"),
        0.1.. => format!("{length_m:.1} m"),
        0.001.. => format!("{:.0} mm", 1000.0 * length_m),
        _ => "less than 1 mm".to_owned(),
    }
}

/// The place that is steepest beyond what the vehicle climbs or descends.
fn steepest(routes: &[Vec<PlanPoint>], limits: &VehicleLimits) -> Option<Violation> {
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
    let (at, _, slope, limit) = slopes.min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(Violation {
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
fn near_threats(spec: &MissionSpec, world: &World, at: PlanPoint, reach_m: f64) -> String {
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

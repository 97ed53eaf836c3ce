//! How far a route is from its limits, and so how near to it its legs must stay.
//!
//! A plan may pass a limit nearer than `mission.tolerance_m`: legs that kept to it no nearer than that
//! would break the limit.

use crate::geodesy::PlanPoint;
use crate::numeric::geometry::{Point, Ring, box_misses, edge_distance};
use crate::path::TimedPoint;
use crate::world::{Layer, PlanZone, Terrain, World};

/// Share of the distance to a limit that legs may take: the rest is for rounding.
const SHARE: f64 = 0.9;
/// The same of the height above ground, which legs aside of the path lose on a slope as well.
const GROUND_SHARE: f64 = 0.75;
/// Nearer than this part of the tolerance is not asked for.
const MAX: f64 = 50.0;

/// The limits near a route.
struct Limits<'a> {
    world: &'a World,
    layer: Layer,
    zones: Vec<(&'a PlanZone, Ring)>,
    /// Edges of the area.
    area: Vec<(Point, Point)>,
}

/// How many times closer than a tolerance legs must stay to each point of a route, so that they
/// keep the limits that it keeps: 1 where these are further away.
pub(super) fn strictness(
    (world, layer): (&World, Layer),
    route: &[TimedPoint],
    tolerance_m: f64,
) -> Vec<f64> {
    let reach_m = tolerance_m / SHARE;
    let limits = Limits::near((world, layer), route, reach_m);
    let strictness = |timed: &TimedPoint| {
        let clear_m = limits.clearance_m(timed.point, reach_m);
        (tolerance_m / (SHARE * clear_m.max(1e-9))).clamp(1.0, MAX)
    };
    route.iter().map(strictness).collect()
}

impl<'a> Limits<'a> {
    fn near((world, layer): (&'a World, Layer), route: &[TimedPoint], reach_m: f64) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for timed in route {
            let at = plane(timed.point);
            for axis in 0..2 {
                low[axis] = low[axis].min(at[axis] - reach_m);
                high[axis] = high[axis].max(at[axis] + reach_m);
            }
        }
        let is_near = |zone: &&PlanZone| !zone.offset().is_far_from(low, high);
        let with_ring = |zone: &'a PlanZone| (zone, Ring::around(&zone.outline));
        Self {
            zones: (world.zones.iter().filter(is_near))
                .map(with_ring)
                .collect(),
            area: (Ring::around(&world.area).edges())
                .filter(|edge| !box_misses((low, high), *edge))
                .collect(),
            world,
            layer,
        }
    }

    /// Distance from a point to the nearest limit, at most `reach_m`; 0 where it is beyond one.
    fn clearance_m(&self, point: PlanPoint, reach_m: f64) -> f64 {
        let (at, amsl_m) = (plane(point), point.amsl.0);
        let world = self.world;
        let source = world.terrain.height_at(&world.frame, point.at);
        let ground_m = source.map_or(f64::NAN, |ground| ground.0);
        let floor_m = self.layer.floor_m(ground_m + world.min_agl.0);
        let roof_m = self.layer.ceiling_m(ground_m, world.max_amsl.0);
        // Over flat ground a path sags and a leg between two of its places is no lower.
        let over_m = match world.terrain {
            Terrain::Flat(_) => reach_m,
            _ => GROUND_SHARE / SHARE * (amsl_m - floor_m),
        };
        let mut clear_m = reach_m.min(over_m).min(roof_m - amsl_m);
        for threat in &world.threats {
            clear_m = clear_m.min(threat.center.distance_m(point.at) - threat.radius_m);
        }
        for (zone, ring) in &self.zones {
            let around = |sign: f64| at.map(|value| value + sign * (zone.buffer_m + reach_m));
            if ring.is_far_from(around(-1.0), around(1.0)) {
                continue;
            }
            let (from_m, below_m) = zone.closed_m(ground_m);
            let aside_m = match ring.contains(at) {
                true => 0.0,
                false => ring.boundary_distance(at) - zone.buffer_m,
            };
            clear_m = clear_m.min(aside_m.max(amsl_m - below_m).max(from_m - amsl_m));
        }
        clear_m
            .min(edge_distance(at, self.area.iter().copied()))
            .max(0.0)
    }
}

fn plane(point: PlanPoint) -> Point {
    [point.at.east_m, point.at.north_m]
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::geodesy::{Amsl, EastNorth};
    use crate::spec::SpecFile;

    #[test]
    fn legs_stay_the_nearer_to_a_route_the_nearer_its_limits_are() {
        const TOLERANCE_M: f64 = 5.0;
        let text = include_str!("../../../missions/first.yaml").to_owned();
        let file = SpecFile::parse(Path::new("first.yaml"), text).expect("a shipped mission");
        let base = Amsl(584.0);
        let hills = Vec::new();
        let world = World::new(&file.spec, Terrain::Analytic { base, hills }).expect("ground");
        let flat = World::new(&file.spec, Terrain::Flat(base)).expect("ground");
        let threat = world.threats[0];
        let floor_m = 584.0 + world.min_agl.0;
        let at = |from_threat_m: f64, over_floor_m: f64| TimedPoint {
            t_s: 0.0,
            point: PlanPoint {
                at: EastNorth {
                    east_m: threat.center.east_m + threat.radius_m + from_threat_m,
                    ..threat.center
                },
                amsl: Amsl(floor_m + over_floor_m),
            },
        };
        let route = [
            at(50.0, 50.0),
            at(2.0, 50.0),
            at(50.0, 2.0),
            at(2.0, 1.0),
            at(2.0, 0.0),
        ];
        let near = |clear_m: f64| TOLERANCE_M / clear_m;
        let aside = near(SHARE * 2.0);
        let over = [near(GROUND_SHARE * 2.0), near(GROUND_SHARE), MAX];
        let expected = [1.0, aside, over[0], over[1], over[2]];
        let over_flat = [1.0, aside, 1.0, aside, aside];
        for (world, expected) in [(&world, expected), (&flat, over_flat)] {
            let found = strictness((world, Layer::UNLIMITED), &route, TOLERANCE_M);
            for (found, expected) in found.iter().zip(expected) {
                assert!(
                    (found - expected).abs() < 1e-6 * expected,
                    "{found} {expected}"
                );
            }
        }
    }
}

//! How cheap a route can be at best: proven, and estimated.
//!
//! **Proven.** Threats, zones without a height, ground that leaves no room under the ceiling and
//! all outside of the area are closed at any altitude. [`closed`] approximates them from inside,
//! so that the rest of the plane holds every path that passes. The shortest path in it, bends
//! included but turns not limited, is no longer than any of them, and neither is its length in
//! three dimensions with the difference in altitude of its ends. No other term of the objective is
//! negative. Lengths are those of the objective: in planning coordinates.
//!
//! **Estimated.** [`estimate`] solves the relaxed problem on a grid. It errs upward.

mod closed;
mod closed_ground;
mod estimate;
mod level_set;
mod potential;

pub(super) use estimate::estimate;
pub use potential::RouteCertificate;
pub(super) use potential::certify;

use rayon::prelude::*;

use crate::geodesy::{EastNorth, PlanPoint};
use crate::numeric::free_space::{FreeSpace, Sights};
use crate::numeric::geometry::{Point, Ring};
use crate::spec::{MissionSpec, Objective};
use crate::world::World;

/// Most steps of the search for the shortest path.
const MAX_STEPS: usize = 2_000_000;
/// Taken off the length for rounding and for what the objective does not see between its
/// samples: a share, and metres.
const TOLERANCE: (f64, f64) = (1e-6, 0.1);

/// Start and goal of each route of a vehicle.
pub(super) type VehicleRoutes = Vec<(PlanPoint, PlanPoint)>;

/// Proven for each vehicle by the ends of its routes: no path that keeps its limits costs less.
pub(super) fn proven(spec: &MissionSpec, world: &World, routes: &[VehicleRoutes]) -> Vec<f64> {
    // The paper's objective reads threats at a few samples alone: its paths may cut them.
    let sights = match spec.planner.objective {
        Objective::Operational => sights(spec, world, routes),
        Objective::Paper => None,
    };
    let mut place = 0;
    routes
        .iter()
        .map(|routes| {
            let km = routes.iter().map(|&(from, to)| {
                place += 2;
                let plane_m = (sights.as_ref())
                    .and_then(|sights| sights.shortest(place - 2, place - 1, MAX_STEPS));
                let plane_m = plane_m.map_or(0.0, |found| found.length_m);
                let proven_m = plane_m * (1.0 - TOLERANCE.0) - TOLERANCE.1;
                let rise_m = to.amsl.0 - from.amsl.0;
                proven_m.max(0.0).hypot(rise_m).max(from.distance_m(to)) / 1000.0
            });
            spec.planner.weights.length * km.sum::<f64>()
        })
        .collect()
}

/// No path that keeps the limits is shorter: for each two of these places, metres, in three
/// dimensions.
pub(super) fn shortest_m(spec: &MissionSpec, world: &World, sites: &[PlanPoint]) -> Vec<Vec<f64>> {
    let ends: VehicleRoutes = sites
        .chunks(2)
        .map(|two| (two[0], two[two.len() - 1]))
        .collect();
    let sights = sights(spec, world, &[ends]);
    let between = |one: usize, other: usize| {
        let (from, to) = (sites[one], sites[other]);
        let plane_m = (sights.as_ref())
            .and_then(|sights| sights.shortest(one.min(other), one.max(other), MAX_STEPS))
            .map_or(0.0, |found| found.length_m);
        plane_m
            .hypot(to.amsl.0 - from.amsl.0)
            .max(from.distance_m(to))
    };
    let row = |one| (0..sites.len()).map(|other| between(one, other)).collect();
    (0..sites.len()).into_par_iter().map(row).collect()
}

/// Sights past all that is closed, with a place at each end of each route.
fn sights(spec: &MissionSpec, world: &World, routes: &[VehicleRoutes]) -> Option<Sights> {
    let ends = routes
        .iter()
        .flatten()
        .flat_map(|&(from, to)| [from.at, to.at]);
    let sites: Vec<Point> = ends.map(point).collect();
    let area = Ring::around(&world.area);
    let closed = closed::closed_rings(spec, world);
    FreeSpace::new(area.corners(), &closed, &sites).map(Sights::new)
}

fn point(at: EastNorth) -> Point {
    [at.east_m, at.north_m]
}

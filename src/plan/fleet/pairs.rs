//! What routes between two places cost, each as if its vehicle flew it alone.

use rayon::prelude::*;

use super::{Planning, Request};
use crate::cost::{EarlierFlights, RouteEnds};
use crate::geodesy::PlanPoint;
use crate::numeric::Seed;
use crate::plan::bound::{proven, shortest_m};
use crate::plan::search::{Run, search};
use crate::spec::MissionSpec;
use crate::world::World;

/// Proven for each route: no path that keeps the limits costs less.
#[must_use]
pub fn route_bounds(
    spec: &MissionSpec,
    world: &World,
    routes: &[(PlanPoint, PlanPoint)],
) -> Vec<f64> {
    let each: Vec<_> = routes.iter().map(|&ends| vec![ends]).collect();
    proven(spec, world, &each)
}

/// How long the route between each two of these places is at least, metres: past all that is closed
/// at every altitude.
#[must_use]
pub fn min_lengths_m(spec: &MissionSpec, world: &World, sites: &[PlanPoint]) -> Vec<Vec<f64>> {
    shortest_m(spec, world, sites)
}

/// The cost of each route of a vehicle, planned without other vehicles. The routes share its budget.
#[must_use]
pub fn route_costs(
    spec: &MissionSpec,
    world: &World,
    vehicle: usize,
    routes: &[(PlanPoint, PlanPoint)],
    seed: u64,
) -> Vec<f64> {
    let request = Request::new(seed);
    let planning = Planning::new(spec, world, &request);
    let budget = spec.planner.evaluations / (spec.vehicles[vehicle].stops.len() + 1);
    let cost = |&(from, to): &(PlanPoint, PlanPoint)| {
        let start_s = 0.0;
        let context = planning.route_context(
            vehicle,
            RouteEnds { from, to, start_s },
            EarlierFlights::none(),
        );
        let run = Run {
            classes: None,
            known: None,
            budget,
            seed: Seed(seed),
            stream: 0,
            watch: &|_| (),
        };
        search(&context, run).terms.total()
    };
    routes.par_iter().map(cost).collect()
}

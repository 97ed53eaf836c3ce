//! One vehicle's objective for any optimiser, the paper's encoding of a path.

use std::borrow::Cow;

use super::problem::{Sampled, Spatial};
use crate::cost::{EarlierFlights, Margins, RouteEnds};
use crate::optimize::Problem;
use crate::path::{route_ends, route_start_s, time_route, way_speed_mps};
use crate::plan::route_context::{RouteContext, on_route};
use crate::plan::search_options::SearchOptions;
use crate::spec::MissionSpec;
use crate::world::World;

/// A spec as it is on each route of a vehicle that [`objective`] sums up: from start to goal, and
/// with stops on to home.
#[must_use]
pub fn objective_specs<'a>(
    spec: &'a MissionSpec,
    world: &World,
    vehicle: usize,
) -> Vec<Cow<'a, MissionSpec>> {
    let own = &spec.vehicles[vehicle];
    let routes = match own.stops.is_empty() {
        true => 1,
        false => route_ends(own, &world.sites[vehicle]).len(),
    };
    let routes = 0..routes;
    routes
        .map(|number| on_route(spec, vehicle, number))
        .collect()
}

/// The objective of a vehicle's way from start to goal after `earlier` flights, as it is
/// judged, at `samples` samples (at least 2), over the unit cube: first the east of all free control
/// points in parts of the area's box, then the north, then the altitude in parts of the
/// range from the lowest ground to the ceiling (Eq. 33).
///
/// `specs` are those of [`objective_specs`]. Of a vehicle with stops the routes follow one another: all coordinates of the first, then those of
/// the second, and the sum of their costs. To other flights each begins as if those before it were
/// straight.
#[must_use]
pub fn objective<'a>(
    specs: &'a [Cow<'_, MissionSpec>],
    world: &'a World,
    vehicle: usize,
    earlier: &'a EarlierFlights,
    samples: usize,
) -> impl Problem + 'a {
    let (own, sites) = (&specs[0].vehicles[vehicle], &world.sites[vehicle]);
    let mut start_s = route_start_s(own, sites);
    let ends = route_ends(own, sites).into_iter().zip(specs);
    let routes = ends.enumerate().map(|(number, ((from, to), spec))| {
        let context = RouteContext {
            world,
            spec,
            index: vehicle,
            ends: RouteEnds { from, to, start_s },
            earlier,
            margins: Margins::default(),
            extra: &[],
            options: SearchOptions::default(),
            at_edges: false,
            cancel: None,
        };
        let flown = &spec.vehicles[vehicle];
        let speed_mps = way_speed_mps(flown, from, to);
        let straight = time_route(&[from, to], start_s, speed_mps, flown.accel_mps2);
        start_s = straight.last().map_or(start_s, |last| last.t_s) + own.rest_after_s(number);
        spatial(&context, &context.parameters(samples))
    });
    Routes(routes.collect())
}

/// Routes that follow one another, in one vector.
struct Routes<'a>(Vec<Spatial<'a>>);

impl Problem for Routes<'_> {
    fn dimension(&self) -> usize {
        self.0.iter().map(Problem::dimension).sum()
    }

    fn evaluate(&self, candidates: &[f64], costs: &mut [f64]) {
        if let [route] = self.0.as_slice() {
            return route.evaluate(candidates, costs);
        }
        let dimension = self.dimension();
        for (candidate, cost) in candidates.chunks_exact(dimension).zip(costs) {
            let (mut rest, mut own) = (candidate, [0.0]);
            *cost = 0.0;
            for route in &self.0 {
                let (first, after) = rest.split_at(route.dimension());
                route.evaluate(first, &mut own);
                *cost += own[0];
                rest = after;
            }
        }
    }
}

/// All three coordinates of a route, read at some parameters.
pub(crate) fn spatial<'a>(context: &RouteContext<'a>, parameters: &[f64]) -> Spatial<'a> {
    let ground_m = context
        .world
        .ground
        .heights_m
        .iter()
        .copied()
        .filter(|height| height.is_finite())
        .fold(f32::INFINITY, f32::min);
    let top_m = context.world.max_amsl.0;
    Spatial {
        sampled: Sampled::new(context, context.margins, parameters),
        frame: context.frame(),
        amsl_m: (f64::from(ground_m).min(top_m), top_m),
    }
}

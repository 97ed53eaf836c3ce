//! One vehicle's objective for any optimiser, the paper's encoding of a path.

use super::problem::{Sampled, Spatial};
use crate::cost::{Margins, RouteEnds};
use crate::optimize::Problem;
use crate::path::{Flight, route_start_s};
use crate::plan::route_context::RouteContext;
use crate::plan::search_options::SearchOptions;
use crate::spec::MissionSpec;
use crate::world::World;

/// The objective of a vehicle's way from start to goal after `earlier` flights, as it is
/// judged, at `samples` samples (at least 2), over the unit cube: first the east of all free control
/// points in parts of the area's box, then the north, then the altitude in parts of the
/// range from the lowest ground to the ceiling (Eq. 33).
#[must_use]
pub fn objective<'a>(
    spec: &'a MissionSpec,
    world: &'a World,
    vehicle: usize,
    earlier: &'a [Flight],
    samples: usize,
) -> impl Problem + 'a {
    let stations = &world.stations[vehicle];
    let context = RouteContext {
        world,
        spec,
        index: vehicle,
        ends: RouteEnds {
            from: stations.start,
            to: stations.goal,
            start_s: route_start_s(&spec.vehicles[vehicle], stations),
        },
        earlier,
        margins: Margins::default(),
        extra: &[],
        options: SearchOptions::default(),
    };
    spatial(&context, &context.parameters(samples))
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

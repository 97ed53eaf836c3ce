//! One vehicle's objective for any optimiser, the paper's encoding of a path.

use super::problem::{Sampled, Spatial};
use super::route_context::Course;
use crate::cost::{Leg, Margins};
use crate::optimize::Problem;
use crate::path::{Flight, route_start_s};
use crate::spec::MissionSpec;
use crate::world::World;

/// The objective of a vehicle's way from start to goal after `earlier` flights, as it is
/// judged, at so many samples (at least 2), over the unit cube: first the east of all free control
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
    let course = Course {
        world,
        spec,
        index: vehicle,
        leg: Leg {
            from: stations.start,
            to: stations.goal,
            start_s: route_start_s(&spec.vehicles[vehicle], stations),
        },
        earlier,
        margins: Margins::default(),
        extra: &[],
    };
    spatial(&course, &course.parameters(samples))
}

/// All three coordinates of a course, read at some parameters.
pub(crate) fn spatial<'a>(course: &Course<'a>, parameters: &[f64]) -> Spatial<'a> {
    let ground_m = course
        .world
        .ground
        .heights_m
        .iter()
        .copied()
        .filter(|height| height.is_finite())
        .fold(f32::INFINITY, f32::min);
    let top_m = course.world.max_amsl.0;
    Spatial {
        sampled: Sampled::new(course, course.margins, parameters),
        frame: course.frame(),
        amsl_m: (f64::from(ground_m).min(top_m), top_m),
    }
}

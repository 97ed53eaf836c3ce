//! What is left to gain over the line in the plane that was found: altitudes of least cost, with
//! as many control points as the ground needs.
//!
//! The search decodes the lowest altitudes of few control points, which follow rough ground only
//! so far. A found line keeps its place in the plane while its spans are halved and its altitudes
//! are solved for anew, as long as that pays.

use super::fit::Line;
use super::problem::Sampled;
use super::{Found, fine, judged};
use crate::cost::{CostTerms, Margins};
use crate::geodesy::EastNorth;
use crate::numeric::Basis;
use crate::numeric::bspline::halved;
use crate::path::route_ends;
use crate::plan::altitude::least_cost::AltitudePrices;
use crate::plan::route_context::{RouteContext, with_free_controls};
use crate::plan::spline::Spline;
use crate::spec::{Algorithm, Objective};

/// Most control points after spans were halved.
const MAX_CONTROLS: usize = 200;
/// How often spans are halved.
const HALVINGS: usize = 3;
/// Halving spans that gains less than this share of the cost is the last.
const GAIN: f64 = 1e-4;
/// Share of the mission items allowed that the bends of a vehicle's routes may need: takeoff, turns
/// and landing need others.
const ITEM_SHARE: f64 = 0.6;
/// Points of a path at which bends are looked for.
const BEND_SAMPLES: usize = 501;

/// A found route, or the same line in the plane at altitudes that cost less, where these keep all
/// limits.
pub(super) fn polished(context: &RouteContext<'_>, found: Found) -> Found {
    if !can_polish(context, &found) {
        return found;
    }
    let mut best = found;
    for _ in 0..HALVINGS {
        let finer = line(&best.spline).map(|values| halved(values));
        if finer[0].len() > MAX_CONTROLS || context.is_cancelled() {
            break;
        }
        let before = best.strict.total();
        let cheaper = at_least_cost(context, finer.each_ref().map(Vec::as_slice));
        let gains = cheaper.strict.is_clean() && cheaper.strict.total() < (1.0 - GAIN) * before;
        if !gains || !fits_items(context, &cheaper.spline) {
            break;
        }
        best = Found {
            evaluations: best.evaluations,
            ..cheaper
        };
    }
    best
}

/// A found route, or the same with the altitudes of its own control points at least cost.
pub(super) fn polished_as_is(context: &RouteContext<'_>, found: Found) -> Found {
    if !can_polish(context, &found) {
        return found;
    }
    let cheaper = at_least_cost(context, line(&found.spline));
    let gains = cheaper.strict.is_clean() && cheaper.strict.total() < found.strict.total();
    let evaluations = found.evaluations;
    Found {
        evaluations,
        ..if gains { cheaper } else { found }
    }
}

/// Only a clean route, and not the paper's sums over samples, which are no lengths.
fn can_polish(context: &RouteContext<'_>, found: &Found) -> bool {
    let planner = &context.spec.planner;
    planner.objective == Objective::Operational
        && planner.algorithm == Algorithm::Msfoa
        && context.options.polishing
        && found.strict.is_clean()
}

/// East and north of the control points.
fn line(spline: &Spline) -> [&[f64]; 2] {
    [&spline.east_m, &spline.north_m]
}

/// A line in the plane, east and north of its control points, at the altitudes of least cost.
fn at_least_cost(context: &RouteContext<'_>, [east_m, north_m]: [&[f64]; 2]) -> Found {
    let free = east_m.len() - 2;
    let spec = with_free_controls(context.spec, free);
    let context = &RouteContext {
        spec: &spec,
        ..*context
    };
    let prices = AltitudePrices {
        length: spec.planner.weights.length,
        altitude: spec.planner.weights.altitude,
    };
    let line = east_m.iter().zip(north_m).skip(1).take(free);
    let line = line.map(|(&east_m, &north_m)| EastNorth { east_m, north_m });
    let sampled: Sampled<'_> = fine(context);
    let spline = sampled.least_cost(line, prices);
    let splines = std::slice::from_ref(&spline);
    let first = |terms: Vec<CostTerms>| terms.first().copied().unwrap_or_default();
    let strict = first(judged(context, splines, context.margins));
    let terms = first(judged(context, splines, Margins::default()));
    Found {
        terms,
        strict,
        spline,
        evaluations: 0,
    }
}

/// Whether a route needs few enough mission items: no more than its bends in the plane and in its
/// profile.
fn fits_items(context: &RouteContext<'_>, spline: &Spline) -> bool {
    let basis = Basis::uniform(spline.east_m.len(), BEND_SAMPLES);
    let [east_m, north_m, amsl_m] =
        [&spline.east_m, &spline.north_m, &spline.amsl_m].map(|values| basis.sampled(values));
    let at = |(&east_m, &north_m): (&f64, &f64)| EastNorth { east_m, north_m };
    let plane: Vec<EastNorth> = east_m.iter().zip(&north_m).map(at).collect();
    let mut along_m = 0.0;
    let steps = plane.windows(2).map(|two| two[0].distance_m(two[1]));
    let along: Vec<f64> = (std::iter::once(0.0).chain(steps))
        .map(|step_m| {
            along_m += step_m;
            along_m
        })
        .collect();
    let profile: Vec<EastNorth> = along.iter().zip(&amsl_m).map(at).collect();
    let tolerance_m = context.spec.mission.tolerance_m;
    let bends = |points: Vec<EastNorth>| Line::new(points).corners(tolerance_m).len();
    #[expect(clippy::cast_precision_loss, reason = "thousands of items")]
    let items = (bends(plane) + bends(profile)) as f64;
    items <= allowed_items(context)
}

/// Items that the bends of a route may need: by its share of the way, start to goal and home.
fn allowed_items(context: &RouteContext<'_>) -> f64 {
    let vehicle = context.vehicle();
    let routes = route_ends(vehicle, &context.world.stations[context.index]);
    let all_m: f64 = routes.iter().map(|(from, to)| from.distance_m(*to)).sum();
    let share = 1000.0 * context.straight_km() / all_m.max(1.0);
    let most = (context.spec.mission.max_items).min(vehicle.facts().capacity.items);
    #[expect(clippy::cast_precision_loss, reason = "thousands of items")]
    let most = most as f64;
    ITEM_SHARE * share * most
}

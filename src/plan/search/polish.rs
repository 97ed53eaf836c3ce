//! What is left to gain over the line in the plane that was found: altitudes of least cost, with
//! as many control points as the ground needs.
//!
//! The search decodes the lowest altitudes of few control points, which follow rough ground only
//! so far. A found line keeps its place in the plane while its spans are halved and its altitudes
//! are solved for anew, as long as that pays.

use super::Found;
use super::fit::Line;
use super::judgement::{JUDGED_ABOVE_M, JUDGED_SAMPLES, judged};
use super::problem::UNDER_CEILING_M;
use crate::cost::Margins;
use crate::geodesy::EastNorth;
use crate::numeric::Basis;
use crate::path::{VehicleLimits, route_ends};
use crate::plan::altitude::floor::SampledLine;
use crate::plan::altitude::least_cost::{AltitudePrices, LeastCost};
use crate::plan::altitude::{Demand, Row};
use crate::plan::route_context::{RouteContext, with_free_controls};
use crate::plan::spline::Spline;
use crate::spec::{Algorithm, Objective};

/// Most control points after spans were halved, and how often that is.
const MAX_CONTROLS: usize = 200;
const HALVINGS: usize = 3;
/// Spans are no shorter than this, metres, than the turn radius, and than these cells of the
/// ground.
const MIN_SPAN_M: f64 = 25.0;
const SPAN_CELLS: f64 = 1.0;
/// Fewest evaluations of each route of a fleet of more vehicles than this.
const MIN_EVALUATIONS: usize = 10_000;
const FEW_VEHICLES: usize = 10;
/// Less than this share of the cost is not worth the work.
const GAIN: f64 = 1e-4;
/// Where climbs and altitude cost no more than this share, nothing is tried.
const MIN_SHARE: f64 = 1e-3;
/// Share of the mission items allowed that the bends of a vehicle's routes may need: takeoff, turns
/// and landing need others.
const ITEM_SHARE: f64 = 0.6;
/// Points of a path at which bends are looked for.
const BEND_SAMPLES: usize = 501;

/// A found route, or the same line in the plane at altitudes that cost less, where these keep all
/// limits: with spans as short as pays, or else with longer ones.
pub(super) fn polished(context: &RouteContext<'_>, found: Found) -> Found {
    if !can_polish(context, &found) || !is_worth_it(context, &found) {
        return found;
    }
    // The last that is tried is what was found: no spans of a short route can be halved.
    let mut finer: Vec<Spline> = vec![found.spline.clone()];
    for _ in 0..halvings(context, &found.spline) {
        finer.extend(finer.last().map(Spline::halved));
    }
    for spline in finer.into_iter().rev() {
        if context.is_cancelled() {
            break;
        }
        if let Some(cheaper) = cheaper(context, &found, spline, GAIN)
            && fits_items(context, &cheaper.spline)
        {
            return cheaper;
        }
    }
    found
}

/// A found route, or the same with the altitudes of its own control points at least cost.
pub(super) fn polished_as_is(context: &RouteContext<'_>, found: Found) -> Found {
    if !can_polish(context, &found) {
        return found;
    }
    cheaper(context, &found, found.spline.clone(), 0.0).unwrap_or(found)
}

/// Only a clean route, and not the paper's sums over samples, which are no lengths; and not where
/// the search itself is no more work, as in a large fleet.
pub(super) fn can_polish(context: &RouteContext<'_>, found: &Found) -> bool {
    is_for_polish(context) && found.strict.is_clean()
}

/// Whether routes that keep all limits are polished.
pub(super) fn is_for_polish(context: &RouteContext<'_>) -> bool {
    let planner = &context.spec.planner;
    let sites = &context.world.sites[context.index];
    let routes = route_ends(context.vehicle(), sites).len();
    let is_small = context.spec.vehicles.len() <= FEW_VEHICLES;
    (is_small || planner.evaluations >= MIN_EVALUATIONS * routes)
        && planner.objective == Objective::Operational
        && planner.algorithm == Algorithm::Msfoa
        && context.options.polishing
}

/// Whether climbs and altitude cost enough.
fn is_worth_it(context: &RouteContext<'_>, found: &Found) -> bool {
    let plane_km = length_m(&plane(&found.spline)) / 1000.0;
    let climbs = found.terms.length - context.spec.planner.weights.length * plane_km;
    climbs + found.terms.altitude > MIN_SHARE * found.terms.total()
}

/// How often the spans of a spline are halved. Lids of zones are not read from the grid of the
/// ground: over them spans may be shorter than its cells.
fn halvings(context: &RouteContext<'_>, spline: &Spline) -> usize {
    let cells_m = match context.at_edges {
        true => 0.0,
        false => SPAN_CELLS * context.world.ground.spacing_m,
    };
    let min_m = cells_m
        .max(VehicleLimits::of(context.vehicle()).turn_radius_m)
        .max(MIN_SPAN_M);
    let length_m = length_m(&plane(spline));
    let mut spans = spline.east_m.len() - 3;
    let mut halvings = 0;
    #[expect(clippy::cast_precision_loss, reason = "hundreds of spans")]
    while halvings < HALVINGS
        && 2 * spans + 3 <= MAX_CONTROLS
        && length_m >= min_m * (2 * spans) as f64
    {
        spans *= 2;
        halvings += 1;
    }
    halvings
}

/// A spline along the line that was found at the altitudes of least cost, where it keeps all limits
/// and costs less by a share.
fn cheaper(context: &RouteContext<'_>, found: &Found, spline: Spline, gain: f64) -> Option<Found> {
    let spec = with_free_controls(context.spec, spline.east_m.len() - 2);
    let context = &RouteContext {
        spec: &spec,
        ..*context
    };
    let splines = [at_least_cost(context, spline)?];
    let judged = |margins: Margins| judged(context, &splines, margins).first().copied();
    let strict = judged(context.margins)?;
    let gains = strict.is_clean() && strict.total() < (1.0 - gain) * found.strict.total();
    let terms = gains.then(|| judged(Margins::default()))??;
    let [spline] = splines;
    Some(Found {
        terms,
        strict,
        spline,
        evaluations: found.evaluations,
    })
}

/// A spline that keeps all limits, with its altitudes at least cost.
fn at_least_cost(context: &RouteContext<'_>, mut spline: Spline) -> Option<Spline> {
    let basis = Basis::new(context.controls(), &context.parameters(JUDGED_SAMPLES));
    let rows: Vec<Row> = (0..basis.samples()).map(|k| basis.row(k)).collect();
    let [east_m, north_m, amsl_m] = sampled(&basis, &spline);
    let floor = context.floor(JUDGED_ABOVE_M, context.margins.climb_fraction);
    let (from, to) = (context.ends.from, context.ends.to);
    let line = SampledLine {
        east_m: &east_m,
        north_m: &north_m,
        ends_m: (from.amsl.0, to.amsl.0),
    };
    let (mut demand, mut runs_m) = (Demand::default(), Vec::new());
    floor.fill(&line, &mut demand, &mut runs_m);
    let mut roof_m = floor.roofs_m((&east_m, &north_m), &amsl_m);
    for roof_m in &mut roof_m {
        *roof_m -= UNDER_CEILING_M;
    }
    let weights = &context.spec.planner.weights;
    let prices = AltitudePrices {
        length: weights.length,
        altitude: weights.altitude,
    };
    let least = LeastCost::new(&rows, (&demand, &runs_m), &roof_m, prices, &spline.amsl_m)?;
    least.improve(&mut spline.amsl_m);
    Some(spline)
}

/// East, north and altitude at samples.
fn sampled(basis: &Basis, spline: &Spline) -> [Vec<f64>; 3] {
    [&spline.east_m, &spline.north_m, &spline.amsl_m].map(|values| basis.sampled(values))
}

/// Points of a spline in the plane.
pub(super) fn plane(spline: &Spline) -> Vec<EastNorth> {
    let basis = Basis::uniform(spline.east_m.len(), BEND_SAMPLES);
    let [east_m, north_m, _] = sampled(&basis, spline);
    east_m.into_iter().zip(north_m).map(at).collect()
}

fn at((east_m, north_m): (f64, f64)) -> EastNorth {
    EastNorth { east_m, north_m }
}

fn length_m(line: &[EastNorth]) -> f64 {
    line.windows(2).map(|two| two[0].distance_m(two[1])).sum()
}

/// Whether a route needs few enough mission items: no more than its bends in the plane and in its
/// profile.
pub(super) fn fits_items(context: &RouteContext<'_>, spline: &Spline) -> bool {
    let plane = plane(spline);
    let amsl_m = Basis::uniform(spline.east_m.len(), BEND_SAMPLES).sampled(&spline.amsl_m);
    let mut along_m = 0.0;
    let steps = plane.windows(2).map(|two| two[0].distance_m(two[1]));
    let along = std::iter::once(0.0).chain(steps).map(|step_m| {
        along_m += step_m;
        along_m
    });
    let profile: Vec<EastNorth> = along.zip(amsl_m).map(at).collect();
    let tolerance_m = context.spec.mission.tolerance_m;
    let bends = |points: Vec<EastNorth>| Line::new(points).corners(tolerance_m).len();
    #[expect(clippy::cast_precision_loss, reason = "thousands of items")]
    let items = (bends(plane) + bends(profile)) as f64;
    items <= allowed_items(context)
}

/// Items that the bends of a route may need: by its share of the way, start to goal and home.
fn allowed_items(context: &RouteContext<'_>) -> f64 {
    let vehicle = context.vehicle();
    let routes = route_ends(vehicle, &context.world.sites[context.index]);
    let all_m: f64 = routes.iter().map(|(from, to)| from.distance_m(*to)).sum();
    let share = 1000.0 * context.straight_km() / all_m.max(1.0);
    let most = (context.spec.mission.max_items).min(vehicle.facts().capacity.items);
    #[expect(clippy::cast_precision_loss, reason = "thousands of items")]
    let most = most as f64;
    ITEM_SHARE * share * most
}

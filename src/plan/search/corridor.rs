//! Routes through corridors: what is searched where the default finds no path that keeps the
//! limits.
//!
//! The classes come from free space alone. Each is fitted with as many control points as its bends
//! need, drawn tight and judged; the fewest control points with a clean fit are searched. It runs
//! only after the default search, so the plans that this finds keep their bytes.

use std::cmp::Ordering;
use std::ops::Range;

use rayon::prelude::*;

use super::fit::{Fitter, Line, Warp};
use super::judgement::{fine, found_among};
use super::problem::Sampled;
use super::seeds::seed_at;
use super::swarms::swarms;
use super::taut::along_lines;
use super::tighten::{FieldCost, Tightener};
use super::{Found, Run, polished, search_classes};
use crate::cost::CostTerms;
use crate::optimize::SearchSeed;
use crate::path::VehicleLimits;
use crate::plan::bound::proven;
use crate::plan::classes::HomotopyClass;
use crate::plan::classes::corridors::{corridors, corridors_of_gaps};
use crate::plan::classes::free_space::Passing;
use crate::plan::classes::overflights::{AWAY_M, overflight_lines};
use crate::plan::classes::routes::HomotopyClasses;
use crate::plan::route_context::{RouteContext, with_free_controls};
use crate::plan::spline::Spline;
use crate::spec::{Algorithm, Objective};
use crate::world::World;

/// Control points for each corner of a corridor.
const PER_CORNER: usize = 2;
/// Control points that are gathered at each corner, and within how many turn radii of it.
const GATHERED: [(f64, f64); 2] = [(1.5, 4.0), (2.5, 2.0)];
/// How many more control points the next attempt has.
const MORE: f64 = 1.5;
/// Attempts after the first fit that keeps the limits, where that is no better than what is known: a
/// cheaper class may have more bends.
const FURTHER: usize = 2;
/// A fit that costs less than this many times the cheapest class in its field is one of that class, or as
/// good.
const OF_CHEAPEST: f64 = 1.03;
/// Fits with more control points are worth their time where they cost less by this share.
const CHEAPER: f64 = 0.02;
/// Most control points between the ends: the altitudes of more are slow to decode.
const MAX_CONTROLS: usize = 400;
/// The same where a layer over the ground is followed: there more seldom help.
const MAX_IN_LAYER: usize = 200;
/// Lines of each kind along which paths are drawn.
const DRAWN_LINES: usize = 8;
/// Classes with fits that are judged.
const JUDGED_CLASSES: usize = 6;
/// Evaluations times control points: decoding altitudes takes longer with more of these.
const MAX_WORK: usize = 1_000_000;

/// A path whose broken limits add less than this to its cost is searched from where no other is left.
const NEARLY_CLEAN: f64 = 1.01;

/// A path that costs less than this many times its bound is good enough.
const FAR: f64 = 1.05;
/// Evaluations of a small budget.
const FEW: usize = 2000;
/// Fewest evaluations of a route that is searched again because it is not.
pub(in crate::plan) const MIN_BUDGET: usize = 10_000;
/// A fit through corridors that costs less than this many times what was found is searched from,
/// and what that finds counts where it costs less by a share.
const NEAR: f64 = 1.05;
const GAIN: f64 = 5e-3;

/// What was found, or where that violates a limit that no other vehicle sets, what is drawn or found
/// through corridors, if it keeps all limits; and whether it was drawn.
pub(super) fn or_through_corridors(
    context: &RouteContext<'_>,
    run: Run<'_>,
    first: Found,
) -> (Found, bool) {
    if !has_corridors(context) || stands(context, &first) {
        return (first, false);
    }
    let spent = first.evaluations;
    let drawn = drawn_taut(context, f64::INFINITY).map(|drawn| Found {
        evaluations: spent,
        ..drawn
    });
    if let Some(drawn) = drawn.as_ref().filter(|drawn| drawn.strict.is_clean()) {
        return (drawn.clone(), true);
    }
    let Some(homotopy) = corridors(context) else {
        return (drawn.unwrap_or(first), false);
    };
    let any = f64::INFINITY;
    let from = (&homotopy, spent);
    let found = through((context, run), from, &(any..any), |_| run.budget);
    let found = found.or(drawn).unwrap_or(first);
    match stands(context, &found) {
        true => (found, false),
        false => (from_fewer_starts(context, run, found), false),
    }
}

/// The better of what was found and of what a small budget finds: from fewer starts it may come to
/// another valley.
fn from_fewer_starts(context: &RouteContext<'_>, run: Run<'_>, first: Found) -> Found {
    if run.budget <= FEW {
        return first;
    }
    let fewer = search_classes(context, Run { budget: FEW, ..run });
    let fewer = polished(context, fewer);
    let evaluations = first.evaluations + fewer.evaluations;
    let found = match fewer.by_limits(&first) {
        Ordering::Less => fewer,
        _ => first,
    };
    Found {
        evaluations,
        ..found
    }
}

/// The cheapest path drawn taut along a line that is exact in the plane and costs less than `most`; where
/// none keeps all limits, through free space in which every zone with a floor or a ceiling is open, or only
/// those that the lowest path passes under, or only the others.
fn drawn_taut(context: &RouteContext<'_>, most: f64) -> Option<Found> {
    let world = context.world;
    let lines = match world.zones.is_empty() {
        true => Vec::new(),
        false => overflight_lines(context, DRAWN_LINES, (most, AWAY_M)),
    };
    let mut best = along_lines(context, &lines);
    for passing in passings(world) {
        if best.as_ref().is_some_and(|best| best.strict.is_clean()) {
            break;
        }
        let Some(homotopy) = corridors_of_gaps(context, passing) else {
            continue;
        };
        let classes = homotopy.classes.into_iter().take(DRAWN_LINES);
        let lines: Vec<_> = classes.map(|class| class.line).collect();
        let drawn = along_lines(context, &lines);
        best = best.into_iter().chain(drawn).min_by(Found::by_limits);
    }
    best
}

/// Which zones with a floor or a ceiling lines through free space pass: all, those that the lowest path passes under,
/// and the others.
pub(super) fn passings(world: &World) -> impl Iterator<Item = Passing> {
    let has_lids = (world.zones.iter()).any(|zone| zone.is_open_below(world.max_amsl));
    let all = [Passing::Any, Passing::Under, Passing::Over];
    all.into_iter().take(if has_lids { 3 } else { 1 })
}

/// What a small budget finds, or what is drawn or found through corridors that the soft fields may have
/// missed, where what was found alone costs far more than any path has to, and where that costs less.
pub(super) fn nearer_to_bound(
    context: &RouteContext<'_>,
    run: Run<'_>,
    first: &Found,
) -> Option<Found> {
    let cost = first.strict.total();
    if context.is_cancelled()
        || run.budget < MIN_BUDGET
        || !has_corridors(context)
        || !context.earlier.is_empty()
        || !first.strict.is_clean()
        || !is_far_from_bound(context, cost)
    {
        return None;
    }
    let better = (1.0 - GAIN) * cost;
    let is_better = |found: &Found| found.strict.is_clean() && found.strict.total() < better;
    let fewer = from_fewer_starts(context, run, first.clone());
    let spent = fewer.evaluations;
    let drawn = drawn_taut(context, better).map(|drawn| Found {
        evaluations: spent,
        ..drawn
    });
    let ways = [drawn, Some(fewer)].into_iter().flatten().filter(is_better);
    ways.min_by(Found::by_limits).or_else(|| {
        let homotopy = corridors(context)?;
        let budget = |controls| as_much_work(context.controls(), controls, run.budget);
        let costs = better..NEAR * cost;
        let found = through((context, run), (&homotopy, spent), &costs, budget)?;
        is_better(&found).then(|| polished(context, found))
    })
}

/// Evaluations of paths with `controls` control points that take as long as `evaluations` of paths
/// with others: the time to decode altitudes grows with the square.
fn as_much_work(others: usize, controls: usize, evaluations: usize) -> usize {
    evaluations * others * others / (controls * controls).max(1)
}

/// Whether a cost is far above what any path of the route has to cost.
pub(in crate::plan) fn is_far_from_bound(context: &RouteContext<'_>, cost: f64) -> bool {
    cost > FAR * context.bound() && cost > FAR * bound_of(context)
}

/// Proven: no path of the route costs less.
fn bound_of(context: &RouteContext<'_>) -> f64 {
    let route = vec![(context.ends.from, context.ends.to)];
    let least = proven(context.spec, context.world, &[route]);
    least.into_iter().sum()
}

/// Whether routes are searched through corridors.
fn has_corridors(context: &RouteContext<'_>) -> bool {
    let planner = &context.spec.planner;
    (planner.algorithm, planner.objective) == (Algorithm::Msfoa, Objective::Operational)
        && context.options.classes
}

/// What is found through corridors with as few control points as have a fit that keeps the limits and
/// costs less than the lower of two `costs` and little more than the cheapest class; where none of the
/// next numbers has, with those of the cheapest fit. Where no fit keeps the limits, but the last breaks
/// them by little, with as many as that has. None where nothing that is found keeps the limits, or
/// where the fit costs as much as the higher one. Evaluations that were spent before are counted.
fn through(
    (context, run): (&RouteContext<'_>, Run<'_>),
    (homotopy, spent): (&HomotopyClasses, usize),
    costs: &Range<f64>,
    budget: impl Fn(usize) -> usize,
) -> Option<Found> {
    let cost = |fits: &Fits| fits.best.strict.alone().total();
    let least = homotopy.classes.first().map_or(0.0, |class| class.cost);
    let enough = costs.start.min(OF_CHEAPEST * least);
    let mut cheapest: Option<Fits> = None;
    let mut controls = needed_controls(context, homotopy);
    let max_controls = max_controls(context);
    let mut left = FURTHER;
    loop {
        let fits = Fits::of(context, homotopy, controls, spent);
        let is_last = controls >= max_controls;
        let counts =
            fits.are_clean() || is_last && cheapest.is_none() && is_nearly_clean(&fits.best.strict);
        if counts {
            let known =
                (cheapest.take()).filter(|known| (1.0 - CHEAPER) * cost(known) <= cost(&fits));
            cheapest = Some(known.unwrap_or(fits));
        }
        let found = cheapest.as_ref();
        if is_last || left == 0 || found.is_some_and(|found| cost(found) < enough) {
            break;
        }
        left -= usize::from(found.is_some());
        controls = times_more(controls).min(max_controls);
    }
    let fits = cheapest.filter(|fits| cost(fits) < costs.end)?;
    let spec = with_free_controls(context.spec, fits.controls);
    let context = &RouteContext {
        spec: &spec,
        ..*context
    };
    let run = Run {
        budget: budget(context.controls()),
        ..run
    };
    let is_clean = fits.are_clean();
    let found = searched_from(context, run, homotopy, (fits.seeds, fits.best));
    (is_clean || found.strict.keeps_static_limits()).then_some(found)
}

/// Fits with a number of control points, and the best of them.
struct Fits {
    controls: usize,
    seeds: Vec<SearchSeed>,
    best: Found,
}

impl Fits {
    fn of(
        context: &RouteContext<'_>,
        homotopy: &HomotopyClasses,
        controls: usize,
        spent: usize,
    ) -> Self {
        let spec = with_free_controls(context.spec, controls);
        let context = &RouteContext {
            spec: &spec,
            ..*context
        };
        let seeds = fits(context, homotopy);
        let best = found_among(context, splines(context, &seeds), spent);
        Self {
            controls,
            seeds,
            best,
        }
    }

    fn are_clean(&self) -> bool {
        self.best.strict.keeps_static_limits()
    }
}

/// Most control points that fits are tried with.
fn max_controls(context: &RouteContext<'_>) -> usize {
    match context.layer().max_agl_m.is_finite() {
        true => MAX_IN_LAYER,
        false => MAX_CONTROLS,
    }
}

/// Whether a route keeps all limits that no other vehicle sets.
pub(super) fn stands(context: &RouteContext<'_>, found: &Found) -> bool {
    // Within the limits the margins may be missed: verification judges, and says where it failed.
    let has_failed = !context.extra.is_empty();
    let judged = if has_failed {
        found.strict
    } else {
        found.terms
    };
    judged.keeps_static_limits()
}

/// The better of a fit that keeps the limits and of what is found from it and others.
fn searched_from(
    context: &RouteContext<'_>,
    run: Run<'_>,
    homotopy: &HomotopyClasses,
    (seeds, fitted): (Vec<SearchSeed>, Found),
) -> Found {
    let budget = run.budget.min(MAX_WORK / context.controls());
    let (mut splines, evaluations) = swarms(context, Run { budget, ..run }, homotopy, seeds);
    splines.push(fitted.spline);
    found_among(context, splines, fitted.evaluations + evaluations)
}

/// Seeds along the cheapest classes, drawn tight: with control points spread evenly, and gathered
/// where the class bends.
fn fits(context: &RouteContext<'_>, homotopy: &HomotopyClasses) -> Vec<SearchSeed> {
    let parameters = context.parameters(context.samples());
    let rows = Sampled::new(context, context.margins, &parameters).rows();
    let fitter = Fitter::new(rows, parameters, context.controls());
    let tightener = Tightener::new(&fitter, context.ends_at());
    let frame = context.frame();
    let fitted = |class: &HomotopyClass| {
        let field_cost = FieldCost {
            ground: &homotopy.grounds[class.field],
            threats: &[],
            wider_m: 0.0,
            price: (0.0, 0.0),
        };
        let line = Line::new(class.line.clone());
        let warps = warps(context, &line);
        let tight = |warp: &Warp| {
            let fitted = fitter.fit(&line, warp);
            // A line that follows the ground in a layer is no longer than need be.
            let free = match context.layer().max_agl_m.is_finite() {
                true => fitted,
                false => tightener.tighten(&field_cost, &fitted),
            };
            seed_at(&frame, frame.shares(free), line.length_m(), class.signature)
        };
        warps.iter().map(tight).collect::<Vec<_>>()
    };
    let classes = homotopy.classes.par_iter().take(JUDGED_CLASSES);
    classes.flat_map_iter(fitted).collect()
}

/// Ways to spread control points along a line.
fn warps(context: &RouteContext<'_>, line: &Line) -> Vec<Warp> {
    let radius_m = VehicleLimits::of(context.vehicle()).turn_radius_m;
    let corners = line.corners(0.5 * radius_m);
    let gathered = GATHERED.iter().map(|&(each, radii)| {
        let width = (radii * radius_m / line.length_m().max(1e-9)).min(0.25);
        Warp::at_corners(&corners, width, (each, context.controls()))
    });
    gathered.chain([Warp::even()]).collect()
}

/// The splines of seeds at the altitudes that are judged.
fn splines(context: &RouteContext<'_>, seeds: &[SearchSeed]) -> Vec<Spline> {
    let (frame, fine) = (context.frame(), fine(context));
    let spline = |seed: &SearchSeed| fine.spline(frame.positions(&seed.mean));
    seeds.par_iter().map(spline).collect()
}

/// Control points that the corners of the cheapest corridor need, at least those of the spec.
fn needed_controls(context: &RouteContext<'_>, homotopy: &HomotopyClasses) -> usize {
    let radius_m = VehicleLimits::of(context.vehicle()).turn_radius_m;
    let corners = homotopy.classes.first().map_or(0, |class| {
        Line::new(class.line.clone()).corners(0.5 * radius_m).len()
    });
    (PER_CORNER * corners + 4)
        .max(context.spec.planner.control_points)
        .min(MAX_CONTROLS)
}

/// Whether a path breaks limits by so little that a search may mend it.
fn is_nearly_clean(strict: &CostTerms) -> bool {
    strict.total() < NEARLY_CLEAN * (strict.length + strict.altitude)
}

fn times_more(controls: usize) -> usize {
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a few hundred"
    )]
    let more = (MORE * controls as f64).ceil() as usize;
    more
}

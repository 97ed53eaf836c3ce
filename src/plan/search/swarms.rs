//! The default search: swarms on the horizontal path from seeds of homotopy classes, altitude decoded.

mod valleys;

use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::Run;
use super::fit::{Fitter, Line, Warp};
use super::judgement::{fine, most_promising};
use super::problem::{Horizontal, Sampled};
use super::seeds::{Seeder, search_seed, summits};
use crate::cost::{EarlierFlights, Margins};
use crate::geodesy::EastNorth;
use crate::optimize::{
    Algorithm, Evaluator, MIN_RELAXED_BUDGET, MsfoaParameters, SearchSeed, SearchSeeds, TracePoint,
    minimise,
};
use crate::plan::classes::narrow_zones::narrowest_zone_m;
use crate::plan::classes::routes::HomotopyClasses;
use crate::plan::route_context::RouteContext;
use crate::plan::spline::Spline;
use crate::spec;

/// Ways in which the path of a tired swarm is drawn anew; it goes on from the best.
const REDRAWINGS: usize = 16;
/// Evaluations from which on fits are made twice, by what they cost and by what they cost while
/// limits are cheap to break: a good path may just not be clean yet.
const FIT_TWICE: usize = 4000;
/// First steps, in units of a start's scale: starts lie well, so that larger steps lose more
/// of what a start knows than they find.
const STEP: f64 = 0.08;
/// One part in this many of the budget is spent beyond it where another valley is searched.
const VALLEY_SHARE: usize = 5;
/// Flies of each sub-swarm of the default.
const FLIES: usize = 16;

/// The default: horizontal search from homotopy classes, altitude decoded. Fits of detours, beside those
/// of paths flown alone, may spend more than the budget: nothing is left then.
pub(super) fn swarms(
    context: &RouteContext<'_>,
    run: Run<'_>,
    homotopy: &HomotopyClasses,
    given: Vec<SearchSeed>,
) -> (Vec<Spline>, usize) {
    let (planner, options) = (&context.spec.planner, &context.options);
    let parameters = context.parameters(context.samples());
    let problem = horizontal(context, &parameters, run.budget);
    let alone = without_others(context, &parameters, run.budget);
    let fitter = Fitter::new(problem.sampled.rows(), parameters, context.controls());
    let mut rng = run.seed.stream("plan", run.stream);
    let mut among = Evaluator::new(&problem, run.budget, run.watch);
    let mut alone = (alone.as_ref()).map(|alone| Evaluator::new(alone, run.budget, &|_| ()));
    let seeder = Seeder {
        context,
        fitter: &fitter,
        homotopy,
        swarms: planner.swarms.unwrap_or(default_swarms(run.budget)),
    };
    let mut seeds = given;
    seeds.extend(twice_fitted(&seeder, &mut among, alone.as_mut(), &mut rng));
    let fitted = among.spent() + alone.map_or(0, |alone| alone.spent());
    if let Some(step) = planner.step {
        seeds.iter_mut().for_each(|seed| seed.scale.fill(step));
    }
    let redraw = |position: &[f64], rng: &mut ChaCha8Rng| redrawn(&seeder, position, rng);
    let mut searched = |given: &[SearchSeed], swarms: usize, budget: usize, spent: usize| {
        let watch = |point: TracePoint| {
            (run.watch)(TracePoint {
                evaluations: spent + point.evaluations,
                ..point
            });
        };
        let swarms = swarms.min(given.len()).max(1);
        let seeds = SearchSeeds {
            given,
            redraw: options.redrawing.then_some(&redraw),
        };
        let algorithm = Algorithm::Msfoa(msfoa(context, swarms));
        let outcome = minimise(&problem, &algorithm, seeds, budget, &mut rng, &watch);
        (outcome.finalists, spent + outcome.evaluations)
    };
    let left = run.budget.saturating_sub(fitted);
    let (mut finalists, mut spent) = searched(&seeds, seeder.swarms, left, fitted);
    finalists.extend(among.best().cloned());
    let others = valleys::other_valleys(context, &problem, &finalists, &seeds);
    if !others.is_empty() {
        let (more, all) = searched(&others, others.len(), run.budget / VALLEY_SHARE, spent);
        finalists.extend(more);
        spent = all;
    }
    let fine = fine(context);
    let splines = most_promising(finalists)
        .iter()
        .map(|candidate| fine.spline(problem.frame.positions(&candidate.position)))
        .collect();
    (splines, spent)
}

/// Seeds ranked by what they cost and, where the budget allows it, by what they cost in the
/// relaxed problem, by turns: a good path may just not be clean yet.
fn twice_fitted<'p>(
    seeder: &Seeder<'_>,
    among: &mut Evaluator<'_, Horizontal<'p>>,
    mut alone: Option<&mut Evaluator<'_, Horizontal<'p>>>,
    rng: &mut ChaCha8Rng,
) -> Vec<SearchSeed> {
    let mut fit = |among: &mut Evaluator<'_, _>, alone: Option<&mut Evaluator<'_, _>>| match alone {
        None => seeder.seeds(among, None, rng),
        Some(alone) => seeder.seeds(alone, Some(among), rng),
    };
    let first = fit(among, alone.as_deref_mut());
    if among.budget() < FIT_TWICE || !among.relax() {
        return first;
    }
    if let Some(alone) = &mut alone {
        alone.relax();
    }
    let relaxed = fit(among, alone);
    among.restore();
    by_turns(first, relaxed)
}

/// Seeds of two lists by turns.
fn by_turns(one: Vec<SearchSeed>, other: Vec<SearchSeed>) -> Vec<SearchSeed> {
    let longer = one.len().max(other.len());
    let (mut one, mut other) = (one.into_iter(), other.into_iter());
    let turns = (0..longer).flat_map(|_| [one.next(), other.next()]);
    turns.flatten().collect()
}

/// The horizontal problem of a route, with a relaxed one where the budget allows it.
fn horizontal<'a>(context: &RouteContext<'a>, parameters: &[f64], budget: usize) -> Horizontal<'a> {
    let with_penalty = |penalty: f64| {
        let sampled = Sampled::new(context, searched(context.margins), parameters);
        // Among others a detour makes the whole path behind it later, beyond any window.
        let windows = context.options.windows && context.earlier.is_empty();
        Horizontal::new(sampled.with_penalties(penalty), context.frame(), windows)
    };
    let (relaxed, penalty) = penalties(context);
    let can_relax = relaxed < penalty && budget >= MIN_RELAXED_BUDGET;
    with_penalty(penalty).after_relaxed(can_relax.then(|| with_penalty(relaxed)))
}

/// The same as if the vehicle were alone, where it gives way to others.
fn without_others<'a>(
    context: &RouteContext<'a>,
    parameters: &[f64],
    budget: usize,
) -> Option<Horizontal<'a>> {
    let alone = RouteContext {
        earlier: EarlierFlights::none(),
        ..*context
    };
    gives_way(context).then(|| horizontal(&alone, parameters, budget))
}

/// Whether seeds detour around earlier flights. Not in the paper's experiment, which has none.
fn gives_way(context: &RouteContext<'_>) -> bool {
    let is_paper = context.spec.planner.objective == spec::Objective::Paper;
    !context.earlier.is_empty() && !is_paper && context.options.detours
}

/// Prices of violated limits in the relaxed problem and in the problem itself, in units of the
/// judge's.
fn penalties(context: &RouteContext<'_>) -> (f64, f64) {
    if context.spec.planner.objective != spec::Objective::Operational {
        return (1.0, 1.0);
    }
    // Crossing the narrowest zone, with its margins, must cost more than a long way around.
    let whole = context.frame();
    let within = (whole.south_west, whole.north_east);
    let narrowest_m = narrowest_zone_m(context.world, within) + 2.0 * context.margins.threat_m;
    let around = 2.0 * context.straight_km() / (context.prices().closed * narrowest_m / 1000.0);
    let penalty = (context.options.penalty).map_or(1.0, |penalty| penalty.max(around));
    (penalty * context.options.relaxed_share, penalty)
}

/// A little stricter than the judgement: between coarse samples a spline is steeper and
/// bends more than its chords do.
fn searched(margins: Margins) -> Margins {
    Margins {
        separation_m: margins.separation_m + 1.0,
        turn_fraction: margins.turn_fraction + 0.03,
        climb_fraction: margins.climb_fraction + 0.03,
        ..margins
    }
}

/// Parameters of the default algorithm.
fn msfoa(context: &RouteContext<'_>, swarms: usize) -> MsfoaParameters {
    let (planner, options) = (&context.spec.planner, &context.options);
    MsfoaParameters {
        swarms,
        flies: planner.population.map_or(FLIES, |flies| flies / swarms),
        threshold: planner.threshold.unwrap_or(f64::INFINITY),
        step: if planner.step.is_some() { 1.0 } else { STEP },
        group: 2,
        racing: options.racing,
        offspring: options.offspring,
        restarts: options.restarts,
    }
}

/// Swarms that a budget can feed.
fn default_swarms(budget: usize) -> usize {
    match budget {
        20_000.. => 14,
        6_000.. => 10,
        2_000.. => 6,
        _ => 3,
    }
}

/// The path of a candidate fitted anew, with its control points bunched in other ways.
fn redrawn(seeder: &Seeder<'_>, position: &[f64], rng: &mut ChaCha8Rng) -> Vec<SearchSeed> {
    let (context, fitter, frame) = (seeder.context, seeder.fitter, seeder.context.frame());
    let free: Vec<EastNorth> = frame.positions(position).collect();
    let line = Line::new(fitter.samples(context.ends_at(), &free));
    let summits = summits(context, &line);
    let warps: Vec<Warp> = (0..REDRAWINGS)
        .map(|_| Warp::random(&summits, rng))
        .collect();
    warps
        .par_iter()
        .map(|warp| search_seed(&frame, fitter, &line, warp, 0))
        .collect()
}

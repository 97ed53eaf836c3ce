//! The search of one route: starts, swarms, and the judgement of the finalists.

pub(super) mod corridor;
pub(super) mod detour;
pub(super) mod fit;
pub(super) mod objective;
mod overflight;
pub(super) mod polish;
pub(super) mod problem;
pub(super) mod published;
pub(super) mod rests;
pub(super) mod seeds;
mod taut;
pub(super) mod tighten;
mod valleys;

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::classes::narrow_zones::narrowest_zone_m;
use super::classes::routes::{HomotopyClasses, homotopy_classes};
use super::route_context::{RouteContext, with_free_controls};
use super::spline::Spline;
use crate::cost::{Batch, CostTerms, EarlierFlights, Margins};
use crate::geodesy::{EastNorth, PlanPoint};
use crate::numeric::Seed;
use crate::optimize::{
    Algorithm, Candidate, Evaluator, MIN_RELAXED_BUDGET, MsfoaParameters, SearchSeed, SearchSeeds,
    TracePoint, minimise,
};
use crate::spec::{self, MAX_CONTROL_POINTS};
use crate::world::World;
use fit::{Fitter, Line, Warp};
use problem::{Horizontal, Sampled};
use published::published;
use seeds::{Seeder, search_seed, summits};

/// Samples at which results are judged.
pub(super) const JUDGED_SAMPLES: usize = 2001;
/// Metres over the floor in the altitudes of what is judged, where samples are so near to
/// each other that little can rise between them; the search keeps more.
const JUDGED_ABOVE_M: f64 = 0.1;
/// Ways in which the path of a tired swarm is drawn anew; it goes on from the best.
const REDRAWINGS: usize = 16;
/// Finalists that are judged.
const JUDGED: usize = 24;
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

/// Homotopy classes of one vehicle's routes: other flights do not change them, so that all its
/// plans share them.
#[derive(Default)]
pub(super) struct KnownClasses(Mutex<BTreeMap<(usize, usize), Arc<HomotopyClasses>>>);

impl KnownClasses {
    /// Those of a route, by its number and budget; made where they are not known.
    fn of(
        &self,
        route: (usize, usize),
        make: impl FnOnce() -> HomotopyClasses,
    ) -> Arc<HomotopyClasses> {
        let known = |classes: &BTreeMap<_, _>| classes.get(&route).cloned();
        if let Some(classes) = self.0.lock().ok().and_then(|classes| known(&classes)) {
            return classes;
        }
        let made = Arc::new(make());
        if let Ok(mut classes) = self.0.lock() {
            classes.insert(route, Arc::clone(&made));
        }
        made
    }
}

/// The means of one search.
#[derive(Clone, Copy)]
pub(super) struct Run<'a> {
    /// Evaluations allowed.
    pub budget: usize,
    pub seed: Seed,
    /// Number of the random stream.
    pub stream: u64,
    /// Classes that other plans of the vehicle share, and the number of the route.
    pub classes: Option<(&'a KnownClasses, usize)>,
    pub watch: &'a (dyn Fn(TracePoint) + Sync),
}

/// Result of the search of one route.
#[derive(Clone)]
pub(super) struct Found {
    pub spline: Spline,
    /// Judged finely, without margins.
    pub terms: CostTerms,
    /// The same with the margins that verification asked for.
    pub strict: CostTerms,
    /// Evaluations spent, those of seeds included.
    pub evaluations: usize,
}

impl Found {
    /// Routes that keep all limits first, then by their cost.
    fn by_limits(&self, other: &Self) -> Ordering {
        let is_broken = |found: &Self| !found.strict.is_clean();
        let by_cost = || self.strict.total().total_cmp(&other.strict.total());
        is_broken(self).cmp(&is_broken(other)).then_with(by_cost)
    }
}

/// Searches one route within a budget; where that finds no path that keeps the limits, once more
/// through the corridors of free space. What is found is polished.
pub(super) fn search(context: &RouteContext<'_>, run: Run<'_>) -> Found {
    if context.is_cancelled() {
        return found_among(context, Vec::new(), 0);
    }
    let first = search_classes(context, run);
    let (found, is_drawn) = corridor::or_through_corridors(context, run, first);
    let found = polished(context, found);
    if is_drawn {
        return found;
    }
    corridor::nearer_to_bound(context, run, &found).unwrap_or(found)
}

/// What was found drawn taut and polished, or a line over zones where that costs less.
fn polished(context: &RouteContext<'_>, found: Found) -> Found {
    overflight::polished_or_overflight(context, taut::taut(context, found))
}

/// Searches one route from the classes of the soft fields.
///
/// Ground without data has no rim that a few samples could feel, so the search keeps a cell of
/// the ground away from it. Only if that finds no path it searches once more up to the rim.
fn search_classes(context: &RouteContext<'_>, run: Run<'_>) -> Found {
    let up_to_voids = || found(context, context, run);
    let Some(wider) = &context.world.wider_voids else {
        return up_to_voids();
    };
    let world = World {
        ground: Arc::clone(wider),
        ..context.world.clone()
    };
    let away = RouteContext {
        world: &world,
        ..*context
    };
    let first = found(context, &away, run);
    if first.terms.is_clean() {
        return first;
    }
    let second = up_to_voids();
    let evaluations = first.evaluations + second.evaluations;
    let is_better = second.terms.is_clean() || second.terms.total() < first.terms.total();
    Found {
        evaluations,
        ..if is_better { second } else { first }
    }
}

/// The search of one route, judged on another context.
fn found(judged_on: &RouteContext<'_>, context: &RouteContext<'_>, run: Run<'_>) -> Found {
    let (splines, evaluations) = match context.spec.planner.algorithm {
        spec::Algorithm::Msfoa => {
            let make = || homotopy_classes(context, run.budget);
            // With wider voids the same route is searched in two worlds.
            let shared = (run.classes).filter(|_| context.world.wider_voids.is_none());
            let homotopy = match shared {
                Some((known, route)) => known.of((route, run.budget), make),
                None => Arc::new(make()),
            };
            swarms(context, run, &homotopy, Vec::new())
        }
        algorithm => published(context, algorithm, run),
    };
    found_among(judged_on, splines, evaluations)
}

/// The best of some splines, and the number of evaluations that were spent on them.
fn found_among(context: &RouteContext<'_>, splines: Vec<Spline>, evaluations: usize) -> Found {
    Found {
        evaluations,
        ..judge(context, splines)
    }
}

/// The default: horizontal search from homotopy classes, altitude decoded. Fits of detours, beside those
/// of paths flown alone, may spend more than the budget: nothing is left then.
fn swarms(
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

/// Whether seeds detour around earlier flights. Not in the paper's experiment, which has none.
fn gives_way(context: &RouteContext<'_>) -> bool {
    let is_paper = context.spec.planner.objective == spec::Objective::Paper;
    !context.earlier.is_empty() && !is_paper && context.options.detours
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

/// Swarms that a budget can feed.
fn default_swarms(budget: usize) -> usize {
    match budget {
        20_000.. => 14,
        6_000.. => 10,
        2_000.. => 6,
        _ => 3,
    }
}

/// The finalists worth a judgement, best first.
pub(super) fn most_promising(mut finalists: Vec<Candidate>) -> Vec<Candidate> {
    finalists.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    finalists.dedup_by(|a, b| a.position == b.position);
    finalists.truncate(JUDGED);
    finalists
}

/// The best of some splines at fine sampling. Chosen with the margins that verification
/// asked for, reported without.
fn judge(context: &RouteContext<'_>, splines: Vec<Spline>) -> Found {
    let strict = judged(context, &splines, context.margins);
    let (spline, strict) = splines
        .into_iter()
        .zip(strict)
        .min_by(|(_, a), (_, b)| {
            let broken = |terms: &CostTerms| u8::from(!terms.is_clean());
            (broken(a).cmp(&broken(b))).then(a.total().total_cmp(&b.total()))
        })
        .unwrap_or_else(|| (context.straight(), CostTerms::default()));
    let plain = judged(context, std::slice::from_ref(&spline), Margins::default());
    Found {
        spline,
        terms: plain.first().copied().unwrap_or_default(),
        strict,
        evaluations: 0,
    }
}

/// Terms of splines at fine sampling, with some margins.
fn judged(context: &RouteContext<'_>, splines: &[Spline], margins: Margins) -> Vec<CostTerms> {
    let mut batch = Batch::new(context.controls());
    for spline in splines {
        batch.push(&spline.controls());
    }
    context
        .model(margins, &context.parameters(JUDGED_SAMPLES))
        .judge(&batch)
}

/// The same way in the plane at the altitudes that the route's margins now ask for, if it
/// then keeps all of them: what is too low by a hand's breadth need not be searched again.
pub(super) fn lifted(context: &RouteContext<'_>, outline: &[EastNorth]) -> Option<Found> {
    let found = along(context, outline);
    (found.strict.is_clean()).then(|| polish::polished_as_is(context, found))
}

/// A planned route, given by its control points, judged anew.
pub(super) fn judged_route(context: &RouteContext<'_>, points: &[PlanPoint]) -> Found {
    let spec = with_free_controls(context.spec, points.len().saturating_sub(2));
    let context = &RouteContext {
        spec: &spec,
        ..*context
    };
    let spline = Spline {
        east_m: points.iter().map(|point| point.at.east_m).collect(),
        north_m: points.iter().map(|point| point.at.north_m).collect(),
        amsl_m: points.iter().map(|point| point.amsl.0).collect(),
    };
    judge(context, vec![spline])
}

/// The straight route between the ends at the altitudes that its margins ask for, whatever limits
/// that breaks.
pub(super) fn straight(context: &RouteContext<'_>) -> Found {
    /// Length of a straight route for each of its control points, metres.
    const EACH_M: f64 = 40.0;
    /// Fewest control points besides the ends.
    const FEWEST: usize = 4;
    let (from, to) = context.ends_at();
    let pieces = (from.distance_m(to) / EACH_M).clamp(0.0, 1000.0);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "limited to the range before"
    )]
    let free = (pieces as usize).clamp(FEWEST, MAX_CONTROL_POINTS);
    #[expect(clippy::cast_precision_loss, reason = "few control points")]
    let point = |number: usize| {
        let share = number as f64 / (free + 1) as f64;
        EastNorth {
            east_m: from.east_m + share * (to.east_m - from.east_m),
            north_m: from.north_m + share * (to.north_m - from.north_m),
        }
    };
    let outline: Vec<EastNorth> = (1..=free).map(point).collect();
    along(context, &outline)
}

/// The way of free control points at the altitudes that the route's margins ask for.
fn along(context: &RouteContext<'_>, outline: &[EastNorth]) -> Found {
    let spec = with_free_controls(context.spec, outline.len());
    let context = &RouteContext {
        spec: &spec,
        ..*context
    };
    let spline = fine(context).spline(outline.iter().copied());
    let splines = std::slice::from_ref(&spline);
    let first = |terms: Vec<CostTerms>| terms.first().copied().unwrap_or_default();
    let strict = first(judged(context, splines, context.margins));
    let terms = first(judged(context, splines, Margins::default()));
    Found {
        terms,
        strict,
        spline,
        evaluations: 1,
    }
}

/// The route as results are judged.
fn fine<'a>(context: &RouteContext<'a>) -> Sampled<'a> {
    Sampled::above(
        context,
        context.margins,
        &context.parameters(JUDGED_SAMPLES),
        JUDGED_ABOVE_M,
    )
}

//! The search of one course: starts, swarms, and the judgement of the finalists.

pub(super) mod detour;
pub(super) mod fit;
pub(super) mod objective;
pub(super) mod problem;
pub(super) mod published;
pub(super) mod route_context;
pub(super) mod seeds;
pub(super) mod tighten;

use std::sync::Arc;

use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::classes::narrow_zones::thinnest_m;
use super::classes::routes::routes;
use crate::cost::{Batch, CostTerms, Margins};
use crate::geodesy::EastNorth;
use crate::numeric::Seed;
use crate::optimize::{
    Algorithm, Candidate, Evaluator, LEAST_EASED, MsfoaParameters, Start, Starts, TracePoint,
    minimise,
};
use crate::spec::{self, Part};
use crate::world::World;
use fit::{Fitter, Line, Warp};
use problem::{Horizontal, Sampled, Spline};
use published::letter;
use route_context::Course;
use seeds::{start, starts, summits};

/// Samples at which results are judged.
pub(super) const JUDGED_SAMPLES: usize = 2001;
/// Metres over the floor in the altitudes of what is judged, where samples are so near to
/// each other that little can rise between them; the search keeps more.
const JUDGED_ABOVE_M: f64 = 0.1;
/// Ways in which the path of a tired swarm is drawn anew; it goes on from the best.
const REDRAWINGS: usize = 16;
/// Finalists that are judged.
const JUDGED: usize = 24;
/// How dear violated limits are to the default search, in units of the judge's: a short cut
/// through the rim of a threat can cost less than the way around it, and fails.
const PENALTIES: f64 = 4.0;
/// How much of that they are at first: on its way from one good path to another a swarm breaks
/// limits, and high walls hold it where it is.
const EASED: f64 = 0.05;
/// Evaluations from which on fits are made twice, by what they cost and by what they cost while
/// limits are cheap to break: a good path may just not be clean yet.
const FIT_TWICE: usize = 4000;
/// First steps, in units of a start's scale: starts lie well, so that larger steps lose more
/// of what a start knows than they find.
const STEP: f64 = 0.08;
/// Flies of each sub-swarm of the default.
const FLIES: usize = 16;

/// What the search of one course found.
pub(super) struct Found {
    pub spline: Spline,
    /// Judged finely, without margins.
    pub terms: CostTerms,
    /// Evaluations spent, those of starts included.
    pub evaluations: usize,
}

/// Searches one course within a budget.
///
/// Ground without data has no rim that a few samples could feel, so it is kept away from by a
/// cell of the ground; only if that finds no path the search is made once more up to its rim.
pub(super) fn search(
    course: &Course<'_>,
    budget: usize,
    seed: Seed,
    stream: u64,
    watch: &(dyn Fn(TracePoint) + Sync),
) -> Found {
    let as_it_is = || found(course, course, budget, seed, stream, watch);
    let Some(wider) = &course.world.wider_voids else {
        return as_it_is();
    };
    let world = World {
        ground: Arc::clone(wider),
        ..course.world.clone()
    };
    let away = Course {
        world: &world,
        ..*course
    };
    let first = found(course, &away, budget, seed, stream, watch);
    if first.terms.is_clean() {
        return first;
    }
    let second = as_it_is();
    let evaluations = first.evaluations + second.evaluations;
    let is_better = second.terms.is_clean() || second.terms.total() < first.terms.total();
    Found {
        evaluations,
        ..if is_better { second } else { first }
    }
}

/// What is found on one course, judged on another.
fn found(
    judged_on: &Course<'_>,
    course: &Course<'_>,
    budget: usize,
    seed: Seed,
    stream: u64,
    watch: &(dyn Fn(TracePoint) + Sync),
) -> Found {
    let (splines, evaluations) = match course.spec.planner.algorithm {
        spec::Algorithm::Msfoa => swarms(course, budget, seed, stream, watch),
        printed => letter(course, printed, budget, seed, stream, watch),
    };
    let (spline, terms) = judge(judged_on, splines);
    Found {
        spline,
        terms,
        evaluations,
    }
}

/// The default: horizontal search from route classes, altitude decoded.
fn swarms<'a>(
    course: &Course<'a>,
    budget: usize,
    seed: Seed,
    stream: u64,
    watch: &(dyn Fn(TracePoint) + Sync),
) -> (Vec<Spline>, usize) {
    let planner = &course.spec.planner;
    let parameters = course.parameters(course.samples());
    let (at_first, penalties) = factors(course);
    let with_penalties = |course: &Course<'a>, penalties: f64| {
        let sampled = Sampled::new(course, searched(course.margins), &parameters);
        let sampled = sampled.with_penalties(penalties);
        // Among others a detour makes the whole way behind it later, which no window tells.
        let windows = planner.has(Part::Windows) && course.earlier.is_empty();
        Horizontal::new(sampled, course.frame(), windows)
    };
    let can_ease = at_first < penalties && budget >= LEAST_EASED;
    let horizontal = |course: &Course<'a>| {
        let eased = can_ease.then(|| with_penalties(course, at_first));
        with_penalties(course, penalties).begun_with(eased)
    };
    let problem = horizontal(course);
    let alone = gives_way(course).then(|| {
        horizontal(&Course {
            earlier: &[],
            ..*course
        })
    });
    let rows = problem.sampled.rows();
    let fitter = Fitter::new(rows, parameters.clone(), course.controls());
    let mut rng = seed.stream("plan", stream);
    let wanted = planner.swarms.unwrap_or(default_swarms(budget));
    let mut among = Evaluator::new(&problem, budget, watch);
    let mut alone = alone
        .as_ref()
        .map(|alone| Evaluator::new(alone, budget, &|_| ()));
    let mut starts = twice_fitted(
        course,
        &fitter,
        (&mut among, alone.as_mut()),
        wanted,
        &mut rng,
    );
    let fitted = among.spent() + alone.map_or(0, |alone| alone.spent());
    let offset = move |point: TracePoint| {
        watch(TracePoint {
            evaluations: fitted + point.evaluations,
            ..point
        });
    };
    if let Some(step) = planner.step {
        for start in &mut starts {
            start.scale.fill(step);
        }
    }
    let swarms = wanted.min(starts.len()).max(1);
    let algorithm = Algorithm::Msfoa(MsfoaParameters {
        swarms,
        flies: planner.population.map_or(FLIES, |flies| flies / swarms),
        threshold: planner.threshold.unwrap_or(f64::INFINITY),
        step: if planner.step.is_some() { 1.0 } else { STEP },
        group: 2,
        racing: planner.has(Part::Racing),
        offspring: planner.has(Part::Offspring),
        restarts: planner.has(Part::Restarts),
    });
    let redraw =
        |place: &[f64], rng: &mut ChaCha8Rng| redrawn(course, &problem, &fitter, place, rng);
    let starts = Starts {
        given: &starts,
        redraw: planner.has(Part::Redrawing).then_some(&redraw),
    };
    let outcome = minimise(
        &problem,
        &algorithm,
        starts,
        budget - fitted,
        &mut rng,
        &offset,
    );
    let mut finalists = outcome.finalists;
    finalists.extend(among.best().cloned());
    let fine = fine(course);
    let splines = most_promising(finalists)
        .iter()
        .map(|candidate| fine.spline(problem.frame.places(&candidate.position)))
        .collect();
    (splines, fitted + outcome.evaluations)
}

/// How dear violated limits are to the search at first and later, in units of the judge's.
fn factors(course: &Course<'_>) -> (f64, f64) {
    let planner = &course.spec.planner;
    let operational = planner.objective == spec::Objective::Operational;
    let factor = |part, factor| match operational && planner.has(part) {
        true => factor,
        false => 1.0,
    };
    // To cross the thinnest zone, with its margins, is to cost more than a long way around.
    let thinnest_m = thinnest_m(course.world) + 2.0 * course.margins.threat_m;
    let around = 2.0 * course.straight_km() / (course.prices().closed * thinnest_m / 1000.0);
    let penalties = factor(Part::Penalties, PENALTIES.max(around));
    (penalties * factor(Part::Easing, EASED), penalties)
}

/// Starts by what they cost and, where there are evaluations for it, by what they cost while
/// limits are cheap to break, by turns: a good path may just not be clean yet.
fn twice_fitted(
    course: &Course<'_>,
    fitter: &Fitter,
    (among, mut alone): (
        &mut Evaluator<'_, Horizontal<'_>>,
        Option<&mut Evaluator<'_, Horizontal<'_>>>,
    ),
    wanted: usize,
    rng: &mut ChaCha8Rng,
) -> Vec<Start> {
    let budget = among.budget();
    let routes = routes(course, budget);
    let mut fit = |among: &mut Evaluator<'_, _>, alone: Option<&mut Evaluator<'_, _>>| match alone {
        None => starts(course, fitter, &routes, among, None, wanted, rng),
        Some(alone) => starts(course, fitter, &routes, alone, Some(among), wanted, rng),
    };
    let first = fit(among, alone.as_deref_mut());
    if budget < FIT_TWICE || !among.ease() {
        return first;
    }
    if let Some(alone) = &mut alone {
        alone.ease();
    }
    let eased = fit(among, alone);
    among.tighten();
    by_turns(first, eased)
}

/// Starts of two lists by turns.
fn by_turns(one: Vec<Start>, other: Vec<Start>) -> Vec<Start> {
    let longer = one.len().max(other.len());
    let (mut one, mut other) = (one.into_iter(), other.into_iter());
    let turns = (0..longer).flat_map(|_| [one.next(), other.next()]);
    turns.flatten().collect()
}

/// Whether starts give way to earlier flights. Not in the paper's experiment, whose rows
/// stay as they are.
fn gives_way(course: &Course<'_>) -> bool {
    let planner = &course.spec.planner;
    let is_paper = planner.objective == spec::Objective::Paper;
    !course.earlier.is_empty() && !is_paper && planner.has(Part::Detours)
}

/// The path of a candidate fitted anew, with its control points bunched in other ways.
fn redrawn(
    course: &Course<'_>,
    problem: &Horizontal<'_>,
    fitter: &Fitter,
    place: &[f64],
    rng: &mut ChaCha8Rng,
) -> Vec<Start> {
    let ends = (course.leg.from.at, course.leg.to.at);
    let free: Vec<EastNorth> = problem.frame.places(place).collect();
    let line = Line::new(fitter.samples(ends, &free));
    let summits = summits(course, &line);
    let warps: Vec<Warp> = (0..REDRAWINGS)
        .map(|_| Warp::random(&summits, rng))
        .collect();
    let frame = &problem.frame;
    warps
        .par_iter()
        .map(|warp| start(frame, fitter, &line, warp, 0))
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
fn judge(course: &Course<'_>, splines: Vec<Spline>) -> (Spline, CostTerms) {
    let strict = judged(course, &splines, course.margins);
    let best = splines
        .into_iter()
        .zip(&strict)
        .min_by(|(_, a), (_, b)| {
            let broken = |terms: &CostTerms| u8::from(!terms.is_clean());
            (broken(a).cmp(&broken(b))).then(a.total().total_cmp(&b.total()))
        })
        .map_or_else(|| course.straight(), |(spline, _)| spline);
    let plain = judged(course, std::slice::from_ref(&best), Margins::default());
    (best, plain.first().copied().unwrap_or_default())
}

/// Terms of splines at fine sampling, with some margins.
fn judged(course: &Course<'_>, splines: &[Spline], margins: Margins) -> Vec<CostTerms> {
    let mut batch = Batch::new(course.controls());
    for spline in splines {
        batch.push(&spline.controls());
    }
    course
        .model(margins, &course.parameters(JUDGED_SAMPLES))
        .judge(&batch)
}

/// The same way in the plane at the altitudes that the course's margins now ask for, if it
/// then keeps all of them: what is too low by a hand's breadth need not be searched again.
pub(super) fn lifted(course: &Course<'_>, outline: &[EastNorth]) -> Option<Found> {
    let spline = fine(course).spline(outline.iter().copied());
    let splines = std::slice::from_ref(&spline);
    let is_clean = judged(course, splines, course.margins)
        .iter()
        .all(CostTerms::is_clean);
    let terms = judged(course, splines, Margins::default());
    is_clean.then(|| Found {
        terms: terms.first().copied().unwrap_or_default(),
        spline,
        evaluations: 1,
    })
}

/// The course as results are judged.
fn fine<'a>(course: &Course<'a>) -> Sampled<'a> {
    Sampled::above(
        course,
        course.margins,
        &course.parameters(JUDGED_SAMPLES),
        JUDGED_ABOVE_M,
    )
}

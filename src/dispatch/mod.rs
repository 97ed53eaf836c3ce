//! Plan, encode, verify, and plan again where a limit is violated, in bounded rounds.

mod anytime;
mod assignment;
mod budgets;
mod crowd;
mod deconfliction;
mod degrees_of_freedom;
mod reasons;
mod remaining;
mod rests;
mod rounds;
mod tighten;
mod timed_zones;
mod together;

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use crate::mission::{self, VehicleMission};
use crate::path::TimedPoint;
use crate::plan::{self, FleetPlan, KnownSearches, Progress, Request};
use crate::spec::{MissionSpec, Stop};
use crate::tasks::{FleetTasks, FreeOrder, free_orders, in_order, orders_in_time};
use crate::verify::{Limit, Margin, Repair, Review, Reviewer};
use crate::world::World;

use assignment::{violated, with_tasks};
use reasons::Unexplained;
use rounds::{dispatch_closely, dispatch_in_rounds, mended_in_rounds};
use tighten::Strictness;
use together::planned_together;

pub use anytime::{Improved, Improving};

/// A fleet planned, encoded and judged.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Dispatched {
    /// The paths.
    pub plan: FleetPlan,
    /// The missions that could be encoded, with the index of their vehicle in the spec.
    pub missions: Vec<(usize, VehicleMission)>,
    /// The verdict on them.
    pub review: Review,
    /// How often the fleet was planned, at least once.
    pub rounds: usize,
    /// Who does which task; none where the spec has no tasks.
    pub tasks: Option<Box<FleetTasks>>,
    /// The stops of each vehicle with the waits of its departure, where that is later than its tasks
    /// were assigned for.
    delayed: Option<Vec<Vec<Stop>>>,
    /// The spec and world with the stops that nobody asked for, if there are any: rests where vehicles have no space to
    /// turn, or holds until others have passed.
    with_rests: Option<Box<(MissionSpec, World)>>,
    /// What a plan that fails was made from, until its reasons are known.
    unexplained: Option<Box<Unexplained>>,
}

/// The stage of a dispatch, for progress reports.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Stage {
    /// Searching, in this round (from 1).
    Planning(usize, Progress),
    /// Judging the encoded missions of this round.
    Verifying(usize),
}

/// What a fleet is planned from. The spec has stops, in their order, for the tasks that are done;
/// the verdict is given on the second one, which may have the tasks instead.
#[derive(Clone, Copy)]
struct Job<'a> {
    spec: &'a MissionSpec,
    world: &'a World,
    judged: (&'a MissionSpec, &'a World),
    run: Run<'a>,
}

/// How a fleet is dispatched.
#[derive(Clone, Copy)]
struct Run<'a> {
    seed: u64,
    watch: &'a (dyn Fn(Stage) + Sync),
    /// Once it is set, the dispatch ends at once, and its result is of no use.
    cancel: Option<&'a AtomicBool>,
    /// What searches have found for a small fleet.
    known: Option<&'a KnownSearches>,
    /// An earlier plan to begin with.
    earlier: Option<&'a FleetPlan>,
    /// Whether round budgets below that of the spec are tried as well.
    is_nested: bool,
}

impl Run<'_> {
    fn is_cancelled(&self) -> bool {
        (self.cancel).is_some_and(|cancel| cancel.load(Ordering::Relaxed))
    }
}

/// Vehicles whose plans cost less than this many times their bounds together hardly pay for each other.
const NEAR_BOUND: f64 = 1.005;
/// Where a plan with few evaluations costs more than this many times the bounds, holds are tried before the full search,
/// which takes long and seldom finds much cheaper detours. Elsewhere they come last, as the flight takes longer with them.
const FAR_ABOVE: f64 = 1.1;

/// Plans the fleet, and plans again the vehicles that fail, with stricter margins.
///
/// An infeasible mission is not an error: the review names the violated limits. It is that of the
/// best round, the earliest of those with the fewest violations.
///
/// Where the spec leaves the order of stops free, it is found first; the plan has it. Tasks are
/// assigned then, and become stops of their vehicles: [`Dispatched::planned_spec`].
#[must_use]
pub fn dispatch(
    spec: &MissionSpec,
    world: &World,
    seed: u64,
    watch: &(dyn Fn(Stage) + Sync),
) -> Dispatched {
    let run = Run {
        seed,
        watch,
        cancel: None,
        known: None,
        earlier: None,
        is_nested: true,
    };
    dispatch_as(spec, world, run)
}

fn dispatch_as(spec: &MissionSpec, world: &World, run: Run<'_>) -> Dispatched {
    let known = KnownSearches::default();
    let is_small = spec.vehicles.len() <= crowd::MAX_ONE_BY_ONE;
    let run = Run {
        known: is_small.then_some(&known),
        ..run
    };
    let mut done = with_free_orders(spec, world, run);
    done.explain(spec, run, dispatch_in_rounds);
    done
}

/// Dispatches a fleet whose stops are in an order that is given or found.
fn with_free_orders(spec: &MissionSpec, world: &World, run: Run<'_>) -> Dispatched {
    let Some(orders) = free_orders(spec, world, run.seed) else {
        return with_tasks(spec, world, run);
    };
    let run = Run {
        earlier: None,
        ..run
    };
    let mut done = with_orders(spec, world, &orders, run);
    if timed_zones::breaks_one(spec, &done.review) {
        for orders in orders_in_time(spec, world, (&orders, run.seed)) {
            let other = with_orders(spec, world, &orders, run);
            if violated(&other.review) < violated(&done.review) {
                done = other;
            }
            if done.review.passes() || run.is_cancelled() {
                break;
            }
        }
    }
    done
}

/// Dispatches a fleet with its stops in these orders.
fn with_orders(
    spec: &MissionSpec,
    world: &World,
    orders: &[FreeOrder],
    run: Run<'_>,
) -> Dispatched {
    let (ordered, moved) = in_order(spec, world, orders);
    let mut done = with_tasks(&ordered, &moved, run);
    if done.tasks.is_some() {
        // The spec that is flown has its stops in order, and more of them.
        return done;
    }
    // With rests it has, too.
    let is_in_order = done.with_rests.is_some();
    for (plan, found) in done.plan.vehicles.iter_mut().zip(orders) {
        if !found.order.is_empty() {
            plan.set_bound(found.bound);
            if !is_in_order {
                plan.order.clone_from(&found.order);
            }
        }
    }
    done
}

/// Dispatches a fleet whose stops are those that it makes, in their order.
fn dispatch_ordered(job: Job<'_>) -> Dispatched {
    let dispatch = |job: Job<'_>| timed_zones::with_times(job, dispatch_among_zones);
    let found = rests::or_with_rests(job, dispatch);
    rests::holds::or_with_holds(job, found)
}

/// Dispatches a fleet among zones that are always closed: a crowd as a whole, and others so only where
/// planning one after the other leaves vehicles too near, or a small fleet much dearer than it has to
/// be. A large crowd for which no plan as a whole is found is not planned one by one: it ends with who
/// is in whose way.
fn dispatch_among_zones(job: Job<'_>) -> Dispatched {
    if job.run.earlier.is_some() {
        return dispatch_in_rounds(job);
    }
    let count = job.spec.vehicles.len();
    let is_crowd = crowd::is_crowd(job.spec, job.world);
    if is_crowd && let Some(found) = planned_together(job) {
        let mut found = mended(job, found);
        if found.review.passes() || count > crowd::MAX_ONE_BY_ONE {
            found.name_those_too_near(job.spec);
            return found;
        }
    }
    let one_by_one = with_fewer_freedoms(job);
    let mut broken = (one_by_one.review.margins.iter()).filter(|margin| !margin.ok);
    let are_too_near = broken.any(|margin| margin.limit == Limit::Separation);
    let is_possible = !is_crowd && count <= crowd::MAX && !job.run.is_cancelled();
    let is_dear =
        || job.run.is_nested && crowd::pays_much(&one_by_one) && pays_for_others(job, &one_by_one);
    if !is_possible || !(are_too_near || is_dear()) {
        return one_by_one;
    }
    let together = planned_together(job).filter(|found| found.review.passes());
    let better = together.filter(|found| found.is_better_than(one_by_one.rank()));
    better.unwrap_or(one_by_one)
}

/// A crowd planned as a whole, with the vehicles that are left too near to each other planned again around all others.
fn mended(job: Job<'_>, found: Dispatched) -> Dispatched {
    // With more pairs than vehicles nobody has a way between the others.
    if !(1..=found.plan.vehicles.len()).contains(&found.violated()) || job.run.is_cancelled() {
        return found;
    }
    let mended = mended_in_rounds(job, &found.plan);
    if mended.is_better_than(found.rank()) {
        mended
    } else {
        found
    }
}

/// Dispatches a fleet one by one, and so that none pays for others but for want of a better way: also
/// without one or more of the freedoms of its spec.
fn with_fewer_freedoms(job: Job<'_>) -> Dispatched {
    let found = with_nested_budgets(job);
    let count = job.spec.vehicles.len();
    if count > crowd::MAX
        || count > degrees_of_freedom::ALWAYS && degrees_of_freedom::nobody_pays(job.spec, &found)
    {
        return found;
    }
    let mut best = found;
    for spec in degrees_of_freedom::with_fewer(job.spec).iter().skip(1) {
        if job.run.is_cancelled() {
            break;
        }
        let fewer = dispatch_in_rounds(Job { spec, ..job });
        if fewer.is_better_than(best.rank()) {
            best = fewer;
        }
    }
    best
}

/// Dispatches a fleet in rounds; where it fails by distances that another search may find, also with
/// parts of its evaluations, and of large budgets with smaller ones in any case: more evaluations are
/// never worse than those. Holds, which are found sooner than another way, are tried before where ways
/// around others fail, or cost much with few evaluations.
fn with_nested_budgets(job: Job<'_>) -> Dispatched {
    let with = |evaluations: usize| {
        let mut spec = job.spec.clone();
        spec.planner.evaluations = evaluations;
        dispatch_in_rounds(Job { spec: &spec, ..job })
    };
    let is_small = (2..=degrees_of_freedom::ALWAYS).contains(&job.spec.vehicles.len());
    let small = budgets::small(job.spec).filter(|_| is_small && job.run.is_nested);
    let mut small = small.map(with);
    if let Some(dear) = small.take_if(|found| pays(found, FAR_ABOVE)) {
        let found = rests::holds::or_with_holds(job, dear);
        if found.with_rests.is_some() && !pays(&found, NEAR_BOUND) {
            return found;
        }
        small = Some(found);
    }
    let mut best = dispatch_in_rounds(job);
    if job.spec.vehicles.len() > crowd::MAX {
        return best;
    }
    if !best.review.passes() {
        best = rests::holds::or_with_holds(job, best);
        if best.review.passes() {
            return best;
        }
    }
    let or_better = |best: &mut Dispatched, other: Dispatched| {
        if other.is_better_than(best.rank()) {
            *best = other;
        }
    };
    if let Some(small) = small.filter(|_| pays(&best, NEAR_BOUND)) {
        or_better(&mut best, small);
    }
    for evaluations in budgets::smaller(job.spec) {
        if job.run.is_nested && !job.run.is_cancelled() {
            or_better(&mut best, with(evaluations));
        }
    }
    if best.may_fly_closer() && !job.run.is_cancelled() {
        or_better(&mut best, dispatch_closely(job));
    }
    for evaluations in budgets::parts(job.spec) {
        let mut broken = best.review.margins.iter().filter(|margin| !margin.ok);
        let may_be_found =
            broken.any(|margin| margin.limit.repair().is_some() && margin.value.is_finite());
        if !may_be_found || job.run.is_cancelled() {
            break;
        }
        or_better(&mut best, with(evaluations));
    }
    best
}

/// Whether a plan costs more than this many times the bounds of its vehicles together.
fn pays(found: &Dispatched, times: f64) -> bool {
    found.plan.cost() > times * found.plan.bound()
}

/// Whether vehicles cost more than each would alone, by so much that another plan may be worth its
/// time: the bounds alone do not say it where they are loose.
fn pays_for_others(job: Job<'_>, found: &Dispatched) -> bool {
    let request = Request {
        margins: Strictness::first(job.spec).margins,
        cancel: job.run.cancel,
        known: job.run.known,
        ..Request::new(job.run.seed)
    };
    let paid = plan::paid_for_others(&found.plan, (job.spec, job.world), &request);
    paid > (NEAR_BOUND - 1.0) * found.plan.cost()
}

/// Encodes the missions of the plan of a round and judges them. Those of paths that are as they
/// were in the round before are as before.
fn judged(
    job: Job<'_>,
    reviewer: &mut Reviewer<'_>,
    (round, plan): (usize, FleetPlan),
    before: Option<&Dispatched>,
) -> Dispatched {
    (job.run.watch)(Stage::Verifying(round));
    let (missions, review) = encode_and_verify(job, reviewer, &plan, before);
    Dispatched {
        plan,
        missions,
        review,
        rounds: round,
        tasks: None,
        delayed: None,
        with_rests: None,
        unexplained: None,
    }
}

impl Dispatched {
    /// Violated limits, and the cost.
    fn rank(&self) -> (usize, f64) {
        (self.violated(), self.plan.cost())
    }

    /// Whether fewer limits are violated, or as many at less cost.
    fn is_better_than(&self, (violated, cost): (usize, f64)) -> bool {
        let own = self.rank();
        own.0 < violated || own.0 == violated && own.1 < cost
    }

    /// Whether the ground, a ceiling, a threat or a zone is too near to a path, and nothing proves that it
    /// always is.
    fn may_fly_closer(&self) -> bool {
        let mut broken = self.review.margins.iter().filter(|margin| !margin.ok);
        let mut plans = self.plan.vehicles.iter();
        broken.any(is_static) && plans.all(|plan| plan.blocking_set.is_empty())
    }

    fn violated(&self) -> usize {
        let margins = self.review.margins.iter();
        margins.filter(|margin| !margin.ok).count()
    }

    /// The spec and world that the plan is of: those given, or with tasks those whose vehicles
    /// have a stop for each task that they do, or those whose vehicles have a stop wherever they rest because
    /// they have no space to turn, or hold until others have passed.
    #[must_use]
    pub fn planned_spec<'a>(
        &'a self,
        spec: &'a MissionSpec,
        world: &'a World,
    ) -> (&'a MissionSpec, &'a World) {
        match (&self.tasks, &self.with_rests) {
            (Some(tasks), _) => (&tasks.spec, &tasks.world),
            (None, Some(rests)) => (&rests.0, &rests.1),
            (None, None) => (spec, world),
        }
    }
}

/// Whether a limit is one of the ground, a ceiling, a threat or a zone.
fn is_static(margin: &Margin) -> bool {
    matches!(
        margin.limit.repair(),
        Some(Repair::Clearance | Repair::Height | Repair::Obstacle)
    )
}

/// Encodes the routes of every vehicle and judges the missions. A mission that cannot be encoded
/// is absent from the list, and the review gives the reason.
fn encode_and_verify(
    job: Job<'_>,
    reviewer: &mut Reviewer<'_>,
    plan: &FleetPlan,
    before: Option<&Dispatched>,
) -> (Vec<(usize, VehicleMission)>, Review) {
    let Job { spec, world, .. } = job;
    let mut retimed = plan.retimed(spec);
    // A fence lists the zones that were left out of a plan for their times.
    retimed.no_fly.clone_from(&job.judged.0.no_fly);
    let mut unchanged: Vec<Option<&VehicleMission>> = vec![None; plan.vehicles.len()];
    if let Some(before) = before {
        for (index, mission) in &before.missions {
            let flown = &before.plan.vehicles[*index];
            unchanged[*index] = flown.flies_as(&plan.vehicles[*index]).then_some(mission);
        }
    }
    let encoded: Vec<_> = (plan.vehicles.par_iter().zip(unchanged).enumerate())
        .map(|(index, (vehicle, unchanged))| {
            if let Some(mission) = unchanged {
                return Ok(mission.clone());
            }
            let paths = vehicle.routes.iter().map(|route| route.path.clone());
            let routes: Vec<Vec<TimedPoint>> = paths.collect();
            mission::build(&retimed, world, index, &routes)
        })
        .collect();
    let mut missions = Vec::new();
    let mut problems = Vec::new();
    for (index, encoded) in encoded.into_iter().enumerate() {
        match encoded {
            Ok(mission) => missions.push((index, mission)),
            Err(error) => {
                let id = &spec.vehicles[index].id;
                problems.push(Margin::unjudged(id, Limit::Encoding, error.to_string()));
            }
        }
    }
    let all: Vec<(usize, &VehicleMission)> = missions
        .iter()
        .map(|(index, mission)| (*index, mission))
        .collect();
    let mut review = reviewer.review(&all);
    // The encoding error replaces "mission missing".
    let is_known = |margin: &Margin| {
        let mut known = problems.iter();
        margin.limit == Limit::Mission && known.any(|problem| problem.vehicle == margin.vehicle)
    };
    review.margins.retain(|margin| !is_known(margin));
    review.margins.extend(problems);
    (missions, review)
}

//! Plan, encode, verify, and plan again where a limit is violated, in bounded rounds.

mod tighten;

use rayon::prelude::*;

use crate::mission::{self, VehicleMission};
use crate::path::TimedPoint;
use crate::plan::{self, FleetPlan, Progress, Request};
use crate::spec::MissionSpec;
use crate::tasks::{Assigner, FleetTasks, free_orders, in_order};
use crate::verify::{self, Limit, Margin, Review};
use crate::world::World;

use tighten::Strictness;

/// A fleet planned, encoded and judged.
#[derive(Clone, Debug)]
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
}

/// The stage of a dispatch, for progress reports.
#[derive(Clone, Copy, Debug)]
pub enum Stage {
    /// Searching, in this round (from 1).
    Planning(usize, Progress),
    /// Judging the encoded missions of this round.
    Verifying(usize),
}

/// Rounds of planning that every fleet has. A violation that remains after them is a conflict in
/// the spec, and the operator should see it soon.
const ROUNDS: usize = 5;
/// Most rounds, as long as each has fewer violations than all before. In a large fleet a vehicle
/// that gives way to a repaired one may fail for the first time in a late round.
const MAX_ROUNDS: usize = 12;
/// Most assignments of tasks that are planned.
const ASSIGNMENTS: usize = 4;

/// Plans the fleet, and plans again the vehicles that fail, with stricter margins.
///
/// An infeasible mission is not an error: the review names the violated limits. It is that of the
/// best round, the earliest of those with the fewest violations.
///
/// Where the spec leaves the order of stops free, it is found first; the plan has it. Tasks are
/// assigned then, and become stops of their vehicles: [`Dispatched::flown`].
#[must_use]
pub fn dispatch(
    spec: &MissionSpec,
    world: &World,
    seed: u64,
    watch: &(dyn Fn(Stage) + Sync),
) -> Dispatched {
    let Some(orders) = free_orders(spec, world, seed) else {
        return with_tasks(spec, world, seed, watch);
    };
    let (ordered, moved) = in_order(spec, world, &orders);
    let mut done = with_tasks(&ordered, &moved, seed, watch);
    if done.tasks.is_some() {
        // The spec that is flown has its stops in order, and more of them.
        return done;
    }
    for (plan, found) in done.plan.vehicles.iter_mut().zip(orders) {
        if !found.order.is_empty() {
            plan.set_bound(found.bound);
            plan.order = found.order;
        }
    }
    done
}

/// Dispatches a fleet whose stops are in the order in which they are visited: assigns its tasks,
/// and assigns them again where a vehicle uses more on its way than was estimated.
fn with_tasks(
    spec: &MissionSpec,
    world: &World,
    seed: u64,
    watch: &(dyn Fn(Stage) + Sync),
) -> Dispatched {
    let Some(mut assigner) = Assigner::new(spec, world, seed) else {
        return dispatch_ordered((spec, world), (spec, world), seed, watch);
    };
    let mut best: Option<Dispatched> = None;
    for _ in 0..ASSIGNMENTS {
        let tasks = assigner.assign();
        let flown = (&tasks.spec, &tasks.world);
        let mut done = dispatch_ordered(flown, (spec, world), seed, watch);
        for left in &tasks.left {
            let limit = Limit::Task(left.id.clone());
            let mut margins = done.review.margins.iter_mut();
            if let Some(margin) = margins.find(|margin| !margin.ok && margin.limit == limit) {
                margin.note = format!("{}: {}", margin.note, left.why);
            }
        }
        let used = over_endurance(spec, &done.review);
        let late = missed_windows(spec, &done.review);
        assigner.hurry(&late);
        let learns = assigner.learn(&tasks, &used) || !late.is_empty();
        done.tasks = Some(Box::new(tasks));
        if best
            .as_ref()
            .is_none_or(|best| severity(&done) < severity(best))
        {
            best = Some(done);
        }
        if !learns {
            break;
        }
    }
    best.unwrap_or_else(|| dispatch_ordered((spec, world), (spec, world), seed, watch))
}

/// Violated limits of flights, then tasks that are not done.
fn severity(done: &Dispatched) -> (usize, usize) {
    let failed = done.review.margins.iter().filter(|margin| !margin.ok);
    let (tasks, others): (Vec<_>, Vec<_>) =
        failed.partition(|margin| matches!(margin.limit, Limit::Task(_)));
    (others.len(), tasks.len())
}

/// The vehicles that use more than they may, by their indices, and what they use as a share of it.
fn over_endurance(spec: &MissionSpec, review: &Review) -> Vec<(usize, f64)> {
    let fleet = spec.vehicles.iter().enumerate();
    fleet
        .filter_map(|(index, vehicle)| {
            let mut margins = review.margins.iter();
            let is_over = |margin: &&Margin| {
                margin.vehicle == vehicle.id && margin.limit == Limit::Endurance && !margin.ok
            };
            let margin = margins.find(is_over)?;
            let share = margin.value / margin.bound;
            (share.is_finite() && share > 1.0).then_some((index, share))
        })
        .collect()
}

/// The vehicles that come too late for a window.
fn missed_windows(spec: &MissionSpec, review: &Review) -> Vec<usize> {
    let is_missed = |margin: &&Margin| !margin.ok && matches!(margin.limit, Limit::TaskWindow(_));
    let fleet = spec.vehicles.iter().enumerate();
    let late = fleet.filter(|(_, vehicle)| {
        let mut missed = review.margins.iter().filter(is_missed);
        missed.any(|margin| margin.vehicle == vehicle.id)
    });
    late.map(|(index, _)| index).collect()
}

/// Dispatches a fleet whose stops are those that it makes, in their order. The verdict is given on
/// the second spec, which may have tasks instead.
fn dispatch_ordered(
    (spec, world): (&MissionSpec, &World),
    judged: (&MissionSpec, &World),
    seed: u64,
    watch: &(dyn Fn(Stage) + Sync),
) -> Dispatched {
    let mut strictness = Strictness::first(spec);
    let plan_again =
        |round: usize, strictness: &Strictness, previous: Option<(&FleetPlan, &[usize])>| {
            let progress = |at| watch(Stage::Planning(round, at));
            let request = Request {
                seed,
                margins: strictness.margins.clone(),
                extra_parameters: strictness.parameters.clone(),
                progress: &progress,
            };
            match previous {
                None => plan::plan_fleet(spec, world, &request),
                Some((plan, again)) => plan::replan(plan, again, spec, world, &request),
            }
        };
    let judge = |round: usize, plan: FleetPlan| {
        watch(Stage::Verifying(round));
        let (missions, review) = encode_and_verify(spec, world, judged, &plan);
        Dispatched {
            tasks: None,
            plan,
            missions,
            review,
            rounds: round,
        }
    };
    let mut latest = judge(1, plan_again(1, &strictness, None));
    let mut best = latest.clone();
    let mut improves = true;
    for round in 2..=MAX_ROUNDS {
        if latest.review.passes() || round > ROUNDS && !improves {
            break;
        }
        let again = strictness.tighten(spec, world, &latest.plan, &latest.review);
        if again.is_empty() {
            break;
        }
        latest = judge(
            round,
            plan_again(round, &strictness, Some((&latest.plan, &again))),
        );
        improves = failures(&latest) < failures(&best);
        if improves {
            best = latest.clone();
        }
        best.rounds = round;
    }
    if !best.review.passes() {
        best.add_blockers(spec, world, seed, strictness);
    }
    best
}

impl Dispatched {
    /// The spec and world that the plan is of: those given, or with tasks those whose vehicles
    /// have a stop for each task that they do.
    #[must_use]
    pub fn flown<'a>(
        &'a self,
        spec: &'a MissionSpec,
        world: &'a World,
    ) -> (&'a MissionSpec, &'a World) {
        match &self.tasks {
            Some(tasks) => (&tasks.spec, &tasks.world),
            None => (spec, world),
        }
    }

    /// Adds a margin for every vehicle without a path, if other vehicles are the reason.
    fn add_blockers(
        &mut self,
        spec: &MissionSpec,
        world: &World,
        seed: u64,
        strictness: Strictness,
    ) {
        let request = Request {
            seed,
            margins: strictness.margins,
            extra_parameters: strictness.parameters,
            progress: &|_| (),
        };
        let at_first = Strictness::first(spec).margins;
        self.plan.name_blockers(spec, world, &request, &at_first);
        for (vehicle, plan) in spec.vehicles.iter().zip(&self.plan.vehicles) {
            let others = plan.blocked_by.iter();
            let others = others.filter_map(|&other| spec.vehicles.get(other));
            let others: Vec<&str> = others.map(|other| other.id.as_str()).collect();
            if others.is_empty() || self.review.accepts(&vehicle.id) {
                continue;
            }
            let why = format!(
                "no path was found that keeps every limit; in its way: {}",
                others.join(", ")
            );
            let margin = Margin::unjudged(&vehicle.id, Limit::Path, why);
            self.review.margins.push(margin);
        }
    }
}

fn failures(dispatched: &Dispatched) -> usize {
    dispatched
        .review
        .margins
        .iter()
        .filter(|margin| !margin.ok)
        .count()
}

/// Encodes the routes of every vehicle and judges the missions. A mission that cannot be encoded
/// is absent from the list, and the review gives the reason.
fn encode_and_verify(
    spec: &MissionSpec,
    world: &World,
    judged_by: (&MissionSpec, &World),
    plan: &FleetPlan,
) -> (Vec<(usize, VehicleMission)>, Review) {
    let retimed = plan.retimed(spec);
    let encoded: Vec<_> = (plan.vehicles.par_iter().enumerate())
        .map(|(index, vehicle)| {
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
    let judged: Vec<(usize, &VehicleMission)> = missions
        .iter()
        .map(|(index, mission)| (*index, mission))
        .collect();
    let mut review = verify::review(judged_by.0, judged_by.1, &judged);
    // The encoding error replaces "mission missing".
    let is_known = |margin: &Margin| {
        let mut known = problems.iter();
        margin.limit == Limit::Mission && known.any(|problem| problem.vehicle == margin.vehicle)
    };
    review.margins.retain(|margin| !is_known(margin));
    review.margins.extend(problems);
    (missions, review)
}

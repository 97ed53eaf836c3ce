//! Plan, encode, verify, and plan again where a limit is violated, in bounded rounds.

mod crowd;
mod deconfliction;
mod tighten;

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use crate::mission::{self, VehicleMission};
use crate::path::TimedPoint;
use crate::plan::{self, FleetPlan, Progress, Request};
use crate::spec::MissionSpec;
use crate::tasks::{free_orders, in_order};
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

/// Plans the fleet, and plans again the vehicles that fail, with stricter margins.
///
/// An infeasible mission is not an error: the review names the violated limits. It is that of the
/// best round, the earliest of those with the fewest violations.
///
/// Where the spec leaves the order of stops free, it is found first; the plan has it.
#[must_use]
pub fn dispatch(
    spec: &MissionSpec,
    world: &World,
    seed: u64,
    watch: &(dyn Fn(Stage) + Sync),
) -> Dispatched {
    let Some(orders) = free_orders(spec, world, seed) else {
        return dispatch_ordered(spec, world, seed, watch);
    };
    let (ordered, moved) = in_order(spec, world, &orders);
    let mut done = dispatch_ordered(&ordered, &moved, seed, watch);
    for (plan, found) in done.plan.vehicles.iter_mut().zip(orders) {
        if !found.order.is_empty() {
            plan.set_bound(found.bound);
            plan.order = found.order;
        }
    }
    done
}

/// Dispatches a fleet whose stops are in the order in which they are visited: a crowd as a whole,
/// and others so only where planning one after the other leaves vehicles too near.
fn dispatch_ordered(
    spec: &MissionSpec,
    world: &World,
    seed: u64,
    watch: &(dyn Fn(Stage) + Sync),
) -> Dispatched {
    let is_crowd = crowd::is_crowd(spec, world);
    let together = || planned_together(spec, world, seed, watch);
    let passes = |found: &Dispatched| found.review.passes();
    if let Some(found) = is_crowd.then(together).flatten().filter(passes) {
        return found;
    }
    let one_by_one = dispatch_in_rounds(spec, world, seed, watch);
    let mut broken = (one_by_one.review.margins.iter()).filter(|margin| !margin.ok);
    let are_too_near = broken.any(|margin| margin.limit == Limit::Separation);
    let is_worth_it = !is_crowd && are_too_near && spec.vehicles.len() <= crowd::MOST;
    let found = is_worth_it.then(together).flatten().filter(passes);
    found.unwrap_or(one_by_one)
}

/// Dispatches a fleet one vehicle after the other, with those that fail planned again.
fn dispatch_in_rounds(
    spec: &MissionSpec,
    world: &World,
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
        let (missions, review) = encode_and_verify(spec, world, &plan);
        Dispatched {
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

/// Plans every vehicle alone, and then all of them on variants of these paths. None where paths
/// cannot be varied, or where one breaks a limit alone.
fn planned_together(
    spec: &MissionSpec,
    world: &World,
    seed: u64,
    watch: &(dyn Fn(Stage) + Sync),
) -> Option<Dispatched> {
    let progress = |at| watch(Stage::Planning(1, at));
    let request = Request {
        seed,
        margins: Strictness::first(spec).margins,
        extra_parameters: Vec::new(),
        progress: &progress,
    };
    let alone = plan::plan_each_alone(spec, world, &request).vehicles;
    if alone.iter().any(|plan| !plan.terms.is_clean()) {
        return None;
    }
    let plan = deconfliction::resolved(spec, world, seed, &alone)?;
    watch(Stage::Verifying(1));
    let (missions, review) = encode_and_verify(spec, world, &plan);
    Some(Dispatched {
        plan,
        missions,
        review,
        rounds: 1,
    })
}

impl Dispatched {
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
        self.name_those_too_near(spec);
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

    /// Those before a vehicle that its mission comes too near to are in its way, where nothing
    /// else is known to be.
    fn name_those_too_near(&mut self, spec: &MissionSpec) {
        let index = |id: &str| spec.vehicles.iter().position(|vehicle| vehicle.id == id);
        let broken = self.review.margins.iter().filter(|margin| !margin.ok);
        let near = broken.filter(|margin| margin.limit == Limit::Separation);
        let pairs = near.filter_map(|margin| {
            let (a, b) = (index(&margin.vehicle)?, index(margin.other.as_deref()?)?);
            Some((a.max(b), a.min(b)))
        });
        let mut in_the_way: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
        for (vehicle, other) in pairs {
            in_the_way.entry(vehicle).or_default().insert(other);
        }
        for (vehicle, others) in in_the_way {
            let blocked_by = &mut self.plan.vehicles[vehicle].blocked_by;
            if blocked_by.is_empty() {
                blocked_by.extend(others);
            }
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
    let mut review = verify::review(spec, world, &judged);
    // The encoding error replaces "mission missing".
    let is_known = |margin: &Margin| {
        let mut known = problems.iter();
        margin.limit == Limit::Mission && known.any(|problem| problem.vehicle == margin.vehicle)
    };
    review.margins.retain(|margin| !is_known(margin));
    review.margins.extend(problems);
    (missions, review)
}

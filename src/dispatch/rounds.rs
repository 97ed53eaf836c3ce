//! Vehicles planned one after the other, and those that fail planned again with stricter margins.

use std::collections::{BTreeMap, BTreeSet};

use crate::plan::{self, FleetPlan, Request};
use crate::spec::MissionSpec;
use crate::verify::{Limit, Margin};
use crate::world::World;

use super::tighten::Strictness;
use super::{Dispatched, Job, Stage, judged};

/// Rounds of planning that every fleet has. A violation that remains after them is a conflict in
/// the spec, and the operator should see it soon.
const ROUNDS: usize = 5;
/// Most rounds, as long as each has fewer violations than all before. In a large fleet a vehicle
/// that gives way to a repaired one may fail for the first time in a late round.
const MAX_ROUNDS: usize = 12;
/// Dispatches a fleet one vehicle after the other, with those that fail planned again.
pub(super) fn dispatch_in_rounds(job: Job<'_>) -> Dispatched {
    let Job {
        spec,
        world,
        seed,
        watch,
        ..
    } = job;
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
    let mut latest = judged(job, 1, plan_again(1, &strictness, None));
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
        latest = judged(
            job,
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

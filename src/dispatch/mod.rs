//! Plan, encode, verify, and plan again where a limit is violated, in bounded rounds.

mod tighten;

use rayon::prelude::*;

use crate::mission::{self, VehicleMission};
use crate::path::TimedPoint;
use crate::plan::{self, FleetPlan, Progress, Request};
use crate::spec::MissionSpec;
use crate::verify::{self, Margin, Review};
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

/// What is being done, for whoever watches.
#[derive(Clone, Copy, Debug)]
pub enum Stage {
    /// Searching, in this round (from 1).
    Planning(usize, Progress),
    /// Judging the encoded missions of this round.
    Verifying(usize),
}

/// Rounds of planning that every fleet has. What a few stricter rounds cannot mend is a
/// conflict in the spec, and an operator wants to hear of it soon.
const ROUNDS: usize = 5;
/// Most rounds while each leaves fewer failures than all before: in a large fleet one that
/// gives way to a mended vehicle may fail for the first time in a late round.
const MOST_ROUNDS: usize = 12;

/// Plans the fleet, and plans again what fails, with stricter margins where it failed.
///
/// An infeasible mission is not an error: the review of the best round (the one
/// with the fewest failures, the earliest of them) says what is violated.
#[must_use]
pub fn dispatch(
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
    let mut mends = true;
    for round in 2..=MOST_ROUNDS {
        if latest.review.passes() || round > ROUNDS && !mends {
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
        mends = failures(&latest) < failures(&best);
        if mends {
            best = latest.clone();
        }
        best.rounds = round;
    }
    if !best.review.passes() {
        let request = Request {
            seed,
            margins: strictness.margins,
            extra_parameters: strictness.parameters,
            progress: &|_| (),
        };
        let at_first = Strictness::first(spec).margins;
        best.plan.name_blockers(spec, world, &request, &at_first);
        best.tell_blockers(spec);
    }
    best
}

impl Dispatched {
    /// The verdict says of a vehicle that fails whether others are the reason.
    fn tell_blockers(&mut self, spec: &MissionSpec) {
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
            let margin = Margin::unjudged(&vehicle.id, "path", why);
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

/// Encodes every vehicle's routes and judges what was encoded. A mission that
/// cannot be encoded is missing from the list, and the review says why.
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
            Err(error) => problems.push(Margin::unjudged(
                &spec.vehicles[index].id,
                "encoding",
                error.to_string(),
            )),
        }
    }
    let judged: Vec<(usize, &VehicleMission)> = missions
        .iter()
        .map(|(index, mission)| (*index, mission))
        .collect();
    let mut review = verify::review(spec, world, &judged);
    // Why a mission is missing says that it is.
    let is_known = |margin: &Margin| {
        let mut known = problems.iter();
        margin.what == "mission" && known.any(|problem| problem.vehicle == margin.vehicle)
    };
    review.margins.retain(|margin| !is_known(margin));
    review.margins.extend(problems);
    (missions, review)
}

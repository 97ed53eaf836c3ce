//! Vehicles planned one after the other, and those that fail planned again with stricter margins.

use crate::plan::{self, FleetPlan, Request};
use crate::verify::Reviewer;

use super::reasons::Unexplained;
use super::remaining::moved_apart;
use super::tighten::Strictness;
use super::{Dispatched, Job, Stage, crowd, judged, timed_zones};

/// Rounds of planning that every fleet has. A violation that remains after them is a conflict in
/// the spec, and the operator should see it soon.
const ROUNDS: usize = 5;
/// Most rounds, as long as they have fewer violations than all before. In a large fleet a vehicle
/// that gives way to a repaired one may fail for the first time in a late round.
const MAX_ROUNDS: usize = 12;
/// Rounds one after the other without fewer violations, after which no other is made.
const FRUITLESS: usize = 2;
/// Most evaluations of a search around all others of a crowd: each evaluation looks at all of them.
const MENDING: usize = 1000;

/// Dispatches a fleet one vehicle after the other, with those that fail planned again.
pub(super) fn dispatch_in_rounds(job: Job<'_>) -> Dispatched {
    dispatch_from(job, Strictness::first(job.spec), None)
}

/// The same from margins that leave hardly more than the limits, for ways that are as narrow.
pub(super) fn dispatch_closely(job: Job<'_>) -> Dispatched {
    dispatch_from(job, Strictness::closest(job.spec), None)
}

/// Repairs a plan of a whole crowd: vehicles that come too near to others are planned again around all others as they
/// stand.
pub(super) fn mended_in_rounds(job: Job<'_>, plan: &FleetPlan) -> Dispatched {
    let mut spec = job.spec.clone();
    spec.planner.evaluations = spec.planner.evaluations.min(MENDING);
    let job = Job { spec: &spec, ..job };
    dispatch_from(job, Strictness::first(&spec), Some(plan))
}

/// Rounds that begin with a plan, or with none.
fn dispatch_from(
    job: Job<'_>,
    mut strictness: Strictness,
    known: Option<&FleetPlan>,
) -> Dispatched {
    let Job {
        spec, world, run, ..
    } = job;
    let plan_again =
        |round: usize, strictness: &Strictness, previous: Option<(&FleetPlan, &[usize])>| {
            planned_again(job, (round, strictness), previous, known.is_some())
        };
    let (judged_spec, judged_world) = job.judged;
    let mut reviewer = Reviewer::new(judged_spec, judged_world);
    // No stricter margin keeps a vehicle out of a zone that it is planned through.
    let is_entered = |found: &Dispatched| !timed_zones::entered_in_time(job, found).is_empty();
    let plan = known.map_or_else(|| plan_again(1, &strictness, None), FleetPlan::clone);
    let mut latest = judged(job, &mut reviewer, (1, plan), None);
    // The best round, where that is not the latest.
    let mut best: Option<Dispatched> = None;
    let mut violated = vec![latest.violated()];
    while is_worth_another(&violated) {
        if latest.review.passes() || is_entered(&latest) || run.is_cancelled() {
            break;
        }
        let again = strictness.tighten(spec, world, &latest.plan, &latest.review);
        if again.is_empty() {
            break;
        }
        let round = violated.len() + 1;
        let plan = plan_again(round, &strictness, Some((&latest.plan, &again)));
        let next = judged(job, &mut reviewer, (round, plan), Some(&latest));
        let improves = next.violated() < best.as_ref().unwrap_or(&latest).violated();
        violated.push(next.violated());
        let before = std::mem::replace(&mut latest, next);
        best = if improves {
            None
        } else {
            best.or(Some(before))
        };
    }
    let mut best = best.unwrap_or(latest);
    best.rounds = violated.len();
    // Smaller fleets are planned as a whole where pairs are left.
    let mut best = match known.is_some() || spec.vehicles.len() > crowd::MAX {
        true => without_remaining_pairs(job, &mut reviewer, best),
        false => best,
    };
    if !best.review.passes() && !is_entered(&best) && !run.is_cancelled() {
        best.plan.name_the_cut_off(world);
        best.unexplained = Some(Box::new(Unexplained {
            spec: spec.clone(),
            world: world.clone(),
            strictness,
        }));
    }
    best
}

/// The plan of a round: of some vehicles again after the plan before, in place or in their order.
fn planned_again(
    job: Job<'_>,
    (round, strictness): (usize, &Strictness),
    previous: Option<(&FleetPlan, &[usize])>,
    in_place: bool,
) -> FleetPlan {
    let Job {
        spec, world, run, ..
    } = job;
    let progress = |at| (run.watch)(Stage::Planning(round, at));
    let request = Request {
        seed: run.seed,
        cancel: run.cancel,
        known: run.known,
        margins: strictness.margins.clone(),
        extra_parameters: strictness.parameters.clone(),
        progress: &progress,
    };
    match (previous, run.earlier) {
        (Some((plan, again)), _) if in_place => {
            plan::replan_in_place(plan, again, spec, world, &request)
        }
        (Some((plan, again)), _) => plan::replan(plan, again, spec, world, &request),
        (None, Some(earlier)) => plan::plan_from(earlier, spec, world, &request),
        (None, None) => plan::plan_fleet(spec, world, &request),
    }
}

/// Whether another round may leave fewer violations than those before, by what each of them left.
fn is_worth_another(violated: &[usize]) -> bool {
    let least = violated.iter().min();
    let first_best = violated.iter().position(|count| Some(count) == least);
    let fruitless = first_best.map_or(0, |best| violated.len() - 1 - best);
    let made = violated.len();
    made < MAX_ROUNDS && (made < ROUNDS || fruitless < FRUITLESS)
}

/// A fleet with single vehicles of the pairs that are left moved apart, if that is better.
fn without_remaining_pairs(
    job: Job<'_>,
    reviewer: &mut Reviewer<'_>,
    best: Dispatched,
) -> Dispatched {
    if best.review.passes() || job.run.is_cancelled() {
        return best;
    }
    let Some(plan) = moved_apart(job, &best) else {
        return best;
    };
    let moved = judged(job, reviewer, (best.rounds + 1, plan), Some(&best));
    if moved.is_better_than(best.rank()) {
        moved
    } else {
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_late_round_that_is_no_better_does_not_end_the_repairs_and_two_do() {
        assert!(!is_worth_another(&[90, 80, 85, 85, 85]));
        assert!(is_worth_another(&[90, 80, 60, 40, 20]));
        assert!(is_worth_another(&[90, 80, 60, 13, 13]));
        assert!(is_worth_another(&[90, 80, 60, 20, 13, 17]));
        assert!(!is_worth_another(&[90, 80, 60, 20, 13, 17, 13]));
    }

    #[test]
    fn every_fleet_has_the_first_rounds_and_none_more_than_the_most() {
        assert!(is_worth_another(&[3, 9, 9, 9]));
        let falling: Vec<usize> = (0..MAX_ROUNDS).rev().collect();
        assert!(is_worth_another(&falling[..MAX_ROUNDS - 1]));
        assert!(!is_worth_another(&falling));
    }

    #[test]
    fn over_flat_ground_a_copter_flies_hardly_higher_and_nearer_to_a_threat_than_the_tolerance() {
        let path = std::path::Path::new("missions/first.yaml");
        let text = include_str!("../../missions/first.yaml").to_owned();
        let mut spec = crate::spec::SpecFile::parse(path, text)
            .expect("a shipped mission")
            .spec;
        spec.planner.evaluations = 2000;
        let flat = crate::world::Terrain::Flat(crate::geodesy::Amsl(584.0));
        let world = crate::world::World::new(&spec, flat).expect("ground");
        let done = crate::dispatch::dispatch(&spec, &world, 1, &|_| ());
        assert!(done.review.passes());
        assert!(spec.mission.tolerance_m > 4.0);
        let route = done.plan.vehicles[0].routes[0].points();
        let middle = route[route.len() / 2];
        let height_m = middle.amsl.0 - 584.0;
        assert!(
            (world.min_agl.0..world.min_agl.0 + 1.0).contains(&height_m),
            "{height_m}"
        );
        let threat = world.threats[0];
        let away_m = route.iter().map(|point| point.at.distance_m(threat.center));
        let nearest_m = away_m.fold(f64::INFINITY, f64::min) - threat.radius_m;
        assert!((0.0..1.0).contains(&nearest_m), "{nearest_m}");
    }
}

//! Fleets planned as a whole, on variants of the paths of the vehicles alone.

use crate::plan::{self, Request, VehiclePlan};
use crate::verify::Reviewer;

use super::tighten::Strictness;
use super::{Dispatched, Job, Stage, crowd, deconfliction, degrees_of_freedom, judged};

/// Plans every vehicle alone, and then all of them on variants of these paths: the first plan that
/// passes, and where none does the one with the fewest conflicts. None where a vehicle has no path
/// even alone, or paths have no variants.
pub(super) fn planned_together(job: Job<'_>) -> Option<Dispatched> {
    let Job {
        spec, world, run, ..
    } = job;
    let progress = |at| (run.watch)(Stage::Planning(1, at));
    let request = Request {
        seed: run.seed,
        cancel: run.cancel,
        known: run.known,
        margins: Strictness::first(spec).margins,
        extra_parameters: Vec::new(),
        progress: &progress,
    };
    let alone = plan::plan_each_alone(spec, world, &request).vehicles;
    if alone.iter().any(|plan| !plan.terms.is_clean()) {
        return None;
    }
    let best = resolved_together(job, &alone)?;
    if best.review.passes() || alone.len() > crowd::MAX_ONE_BY_ONE || run.is_cancelled() {
        return Some(best);
    }
    // With more control points a path leads aside for a part of its way.
    let finer: Vec<VehiclePlan> = alone.iter().map(VehiclePlan::refined).collect();
    let finer = resolved_together(job, &finer);
    finer
        .filter(|finer| finer.is_better_than(best.rank()))
        .or(Some(best))
}

/// The first plan on variants of the paths of the vehicles alone that passes, and where none does the
/// one with the fewest conflicts.
fn resolved_together(job: Job<'_>, alone: &[VehiclePlan]) -> Option<Dispatched> {
    let (judged_spec, judged_world) = job.judged;
    let mut reviewer = Reviewer::new(judged_spec, judged_world);
    let specs = degrees_of_freedom::with_fewer(job.spec);
    let plans = deconfliction::resolved(&specs, job.world, job.run.seed, alone).into_iter();
    let mut best: Option<Dispatched> = None;
    for plan in plans {
        let found = judged(job, &mut reviewer, (1, plan), None);
        if found.review.passes() {
            return Some(found);
        }
        if (best.as_ref()).is_none_or(|best| found.is_better_than(best.rank())) {
            best = Some(found);
        }
    }
    best
}

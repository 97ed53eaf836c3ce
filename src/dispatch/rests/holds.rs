//! Fleets whose copters hold in the air until others have passed, where that is better than ways around them.

use super::super::tighten::Strictness;
use super::super::{Dispatched, Job, judged};
use super::may_have_stops;
use crate::cost::Margins;
use crate::plan::{AloneWithHolds, Request};
use crate::spec::MissionSpec;
use crate::verify::{Limit, Reviewer};
use crate::world::World;

/// Choices of holds, each with what the verdict on the one before found.
const ROUNDS: usize = 8;
/// Most that a round adds to the separation, metres: with much more no holds may be left.
const MAX_M: f64 = 3.0;

/// A dispatched fleet, or where that is better the same with holds on the ways that the vehicles would fly alone.
pub(in crate::dispatch) fn or_with_holds(job: Job<'_>, found: Dispatched) -> Dispatched {
    let fails = shortfall_m(&found) > 0.0;
    let pays = found.plan.vehicles.iter().any(|plan| plan.is_detour);
    let is_static = job.spec.no_fly.iter().all(|zone| zone.active_s.is_none());
    let may_hold = may_have_stops(job) && job.spec.vehicles.len() > 1 && found.with_rests.is_none();
    if !may_hold || !is_static || !fails && !pays || job.run.is_cancelled() {
        return found;
    }
    match with_holds(job, &found, fails) {
        Some((held, other)) => other.on_stops_of(held, &found),
        None => found,
    }
}

/// The first plan with holds that passes and is better, and the spec and the world that have them.
fn with_holds(
    job: Job<'_>,
    found: &Dispatched,
    fails: bool,
) -> Option<((MissionSpec, World), Dispatched)> {
    let mut strictness = Strictness::first(job.spec);
    let mut margins = strictness.margins.clone();
    stricter(&mut margins, job, found);
    let alone = |margins: &[Margins]| {
        let request = Request {
            margins: margins.to_vec(),
            known: job.run.known,
            ..Request::new(found.plan.seed)
        };
        AloneWithHolds::new((job.spec, job.world), (&found.plan, fails), &request)
    };
    let mut fleet = alone(&margins)?;
    let mut reviewer = Reviewer::new(job.judged.0, job.judged.1);
    for round in 1..=ROUNDS {
        let Some(held) = fleet.held(&margins).filter(|_| !job.run.is_cancelled()) else {
            if round > 1 {
                return None;
            }
            // From the limit itself on: the verdict says how much more is needed.
            for margins in &mut margins {
                margins.separation_m = 0.0;
            }
            continue;
        };
        let (spec, world) = (&held.spec, &held.world);
        let own = Job { spec, world, ..job };
        let other = judged(own, &mut reviewer, (round, held.plan), None);
        if other.review.passes() {
            let saves = fails || other.plan.cost() + held.price < found.plan.cost();
            let is_better = saves && other.is_better_than(found.rank());
            return is_better.then_some(((held.spec, held.world), other));
        }
        let short_m = shortfall_m(&other);
        if short_m <= 0.0 {
            // A path in two parts is encoded with other legs, which may come nearer to a limit.
            let again = strictness.tighten(spec, world, &other.plan, &other.review);
            if again.is_empty() {
                return None;
            }
            for (margins, own) in margins.iter_mut().zip(&strictness.margins) {
                *margins = Margins {
                    separation_m: margins.separation_m,
                    shift_s: margins.shift_s,
                    ..*own
                };
            }
            fleet = alone(&margins)?;
        } else if !stricter(&mut margins, job, &other) {
            for margins in &mut margins {
                margins.separation_m += short_m.min(MAX_M) + 0.1;
            }
        }
    }
    None
}

/// By how much two vehicles are too near, metres; 0 where none are.
fn shortfall_m(found: &Dispatched) -> f64 {
    let broken = found.review.margins.iter().filter(|margin| !margin.ok);
    let near = broken.filter(|margin| margin.limit == Limit::Separation);
    let short_m = near.map(|margin| margin.bound - margin.value);
    // What could not be judged is no number.
    short_m.fold(0.0, f64::max)
}

/// Margins with what a verdict says that vehicles may be late, and whether that was more than before: who holds may be
/// later than who does not.
fn stricter(margins: &mut [Margins], job: Job<'_>, found: &Dispatched) -> bool {
    let slack_s = job.spec.separation.time_slack_s;
    let shifts = found
        .review
        .margins
        .iter()
        .filter_map(|margin| margin.shift);
    let shift_s = shifts.fold(0.0, |most: f64, shift| most.max(shift.max_s() - slack_s));
    let is_more = margins.iter().any(|margins| margins.shift_s < shift_s);
    for margins in margins {
        margins.shift_s = margins.shift_s.max(shift_s);
    }
    is_more
}

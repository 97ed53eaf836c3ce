//! Tasks assigned to vehicles, and assigned again by what the verdict on a plan teaches.

use super::{Dispatched, Job, Run, dispatch_ordered, timed_zones};
use crate::spec::MissionSpec;
use crate::tasks::{Assigner, FleetTasks};
use crate::verify::{Limit, Margin, Review};
use crate::world::World;

/// Dispatches a fleet whose stops are in the order in which they are visited: assigns its tasks,
/// and assigns them again where a vehicle uses more on its way than was estimated.
pub(super) fn with_tasks(spec: &MissionSpec, world: &World, run: Run<'_>) -> Dispatched {
    let whole = Job {
        spec,
        world,
        judged: (spec, world),
        run,
    };
    let Some(mut assigner) = Assigner::new(spec, world, run.seed) else {
        return dispatch_ordered(whole);
    };
    let run = Run {
        earlier: None,
        ..run
    };
    let mut best: Option<Dispatched> = None;
    let mut next = Some(assigner.assign());
    while let Some(mut tasks) = next.take() {
        let mut done = dispatch_ordered(Job {
            spec: &tasks.spec,
            world: &tasks.world,
            judged: (spec, world),
            run,
        });
        if let Some(held) = done.with_rests.take() {
            tasks.add_stops(*held);
        }
        let delayed = done.delayed.take().unwrap_or_default();
        for (own, stops) in tasks.spec.vehicles.iter_mut().zip(delayed) {
            own.stops = stops;
        }
        for left in &tasks.left {
            let is_of = |limit: &Limit| match limit {
                Limit::Task(id) | Limit::AreaCovered(id) => *id == left.id,
                _ => false,
            };
            let mut margins = done.review.margins.iter_mut();
            if let Some(margin) = margins.find(|margin| !margin.ok && is_of(&margin.limit)) {
                margin.note = format!("{}: {}", margin.note, left.why);
            }
        }
        if !run.is_cancelled() {
            next = assigned_again(&mut assigner, &tasks, &done.review);
        }
        done.tasks = Some(Box::new(tasks));
        if best
            .as_ref()
            .is_none_or(|best| violated(&done.review) < violated(&best.review))
        {
            best = Some(done);
        }
    }
    best.unwrap_or_else(|| dispatch_ordered(whole))
}

/// The tasks assigned by what the verdict on a plan teaches; none where that is nothing.
fn assigned_again(
    assigner: &mut Assigner<'_>,
    tasks: &FleetTasks,
    review: &Review,
) -> Option<FleetTasks> {
    let spec = assigner.spec();
    let late = missed_windows(spec, review);
    assigner.hurry(&late);
    let is_in_zone = timed_zones::breaks_one(spec, review) && assigner.minds_times();
    let learns = assigner.learn(tasks, &used_endurance(spec, review));
    let learns = learns || !late.is_empty() || is_in_zone;
    let (flights, undone) = violated(review);
    let goes_on = match (flights, undone) {
        (0, 0) => false,
        (0, _) => assigner.is_cautious(),
        _ => true,
    };
    (goes_on && (assigner.tries_again(learns) || assigner.tries_otherwise()))
        .then(|| assigner.assign())
}

/// Violated limits of flights, then tasks that are not done.
pub(super) fn violated(review: &Review) -> (usize, usize) {
    let failed = review.margins.iter().filter(|margin| !margin.ok);
    let (tasks, others): (Vec<_>, Vec<_>) =
        failed.partition(|margin| matches!(margin.limit, Limit::Task(_) | Limit::AreaCovered(_)));
    (others.len(), tasks.len())
}

/// What each vehicle uses as a share of what it may, by its index.
fn used_endurance(spec: &MissionSpec, review: &Review) -> Vec<(usize, f64)> {
    let fleet = spec.vehicles.iter().enumerate();
    fleet
        .filter_map(|(index, vehicle)| {
            let mut margins = review.margins.iter();
            let is_own =
                |margin: &&Margin| margin.vehicle == vehicle.id && margin.limit == Limit::Endurance;
            let margin = margins.find(is_own)?;
            let share = margin.value / margin.bound;
            share.is_finite().then_some((index, share))
        })
        .collect()
}

/// The vehicles that miss windows, and by how many seconds at most.
fn missed_windows(spec: &MissionSpec, review: &Review) -> Vec<(usize, f64)> {
    let is_missed = |margin: &&Margin| !margin.ok && matches!(margin.limit, Limit::TaskWindow(_));
    let fleet = spec.vehicles.iter().enumerate();
    let late = fleet.filter_map(|(index, vehicle)| {
        let missed = review.margins.iter().filter(is_missed);
        let own = missed.filter(|margin| margin.vehicle == vehicle.id);
        let missed_s = own.map(|margin| margin.value).reduce(f64::max)?;
        Some((index, missed_s))
    });
    late.collect()
}

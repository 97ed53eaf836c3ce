//! Fleets whose vehicles rest on their way where turns keep them from a path, or from a much cheaper one.

pub(super) mod holds;

use super::tighten::Strictness;
use super::{Dispatched, Job, is_static};
use crate::geodesy::PlanPoint;
use crate::plan::rests_of;
use crate::spec::{Algorithm, Arrival, MissionSpec, Objective, Stop, new_stop_ids};
use crate::verify::{Limit, Repair};
use crate::world::World;

/// Most vehicles of a fleet that is planned once more.
const MAX: usize = 14;
/// Most rests of one vehicle.
const MAX_RESTS: usize = 190;

/// A dispatched fleet, or where that is better the same with rests on its way.
pub(super) fn or_with_rests(job: Job<'_>, dispatch: impl Fn(Job<'_>) -> Dispatched) -> Dispatched {
    let found = dispatch(job);
    if !may_rest(job) || found.with_rests.is_some() || job.run.is_cancelled() {
        return found;
    }
    let Some((mut spec, world)) = with_rests(job, &found) else {
        return found;
    };
    let mut other = dispatch(Job {
        spec: &spec,
        world: &world,
        ..job
    });
    if !other.is_better_than(found.rank()) {
        return found;
    }
    if let Some(delayed) = other.delayed.take() {
        for (own, stops) in spec.vehicles.iter_mut().zip(delayed) {
            own.stops = stops;
        }
    }
    other.on_stops_of((spec, world), &found)
}

impl Dispatched {
    /// A plan with stops that nobody asked for: its bounds are those of the plan without.
    fn on_stops_of(mut self, with_stops: (MissionSpec, World), without: &Self) -> Self {
        for (plan, known) in self.plan.vehicles.iter_mut().zip(&without.plan.vehicles) {
            (plan.bound, plan.estimate) = (known.bound, known.estimate);
        }
        self.with_rests = Some(Box::new(with_stops));
        self
    }
}

/// Whether vehicles may rest where nobody asked for it: not those of tasks, whose stops are made already.
fn may_rest(job: Job<'_>) -> bool {
    job.judged.0.tasks.is_empty() && may_have_stops(job)
}

/// Whether vehicles may get stops that nobody asked for: those that have the stops of the spec, or of its tasks.
fn may_have_stops(job: Job<'_>) -> bool {
    let judged = job.judged.0;
    let planner = &job.spec.planner;
    (std::ptr::eq(job.spec, judged) || !judged.tasks.is_empty())
        && (planner.algorithm, planner.objective) == (Algorithm::Msfoa, Objective::Operational)
        && job.run.earlier.is_none()
        && job.spec.vehicles.len() <= MAX
}

/// The spec and the world with the rests that may help; none where nothing may.
fn with_rests(job: Job<'_>, found: &Dispatched) -> Option<(MissionSpec, World)> {
    let (mut spec, mut world) = (job.spec.clone(), job.world.clone());
    let margins = Strictness::first(job.spec).margins;
    let mut has_any = false;
    for (index, plan) in found.plan.vehicles.iter().enumerate() {
        if !plan.blocking_set.is_empty() {
            continue;
        }
        let fails = fails(found, &job.spec.vehicles[index].id);
        let rests = rests_of(
            (job.spec, job.world),
            (index, plan),
            (fails, margins[index]),
        );
        let Some(rests) = rests.filter(|rests| rests.iter().flatten().count() <= MAX_RESTS) else {
            continue;
        };
        has_any = true;
        let (stops, sites) = merged(job, index, &rests);
        (spec.vehicles[index].stops, world.sites[index].stops) = (stops, sites);
    }
    has_any.then_some((spec, world))
}

/// Whether a vehicle breaks a limit that another way may keep.
fn fails(found: &Dispatched, id: &str) -> bool {
    let mut broken = found.review.margins.iter().filter(|margin| !margin.ok);
    broken.any(|margin| {
        let may_be_flown = matches!(margin.limit.repair(), Some(Repair::Slope | Repair::Turn));
        margin.vehicle == id
            && (is_static(margin) || may_be_flown || margin.limit == Limit::Encoding)
    })
}

/// The stops of a vehicle with the rests of its routes between them.
fn merged(job: Job<'_>, index: usize, rests: &[Vec<PlanPoint>]) -> (Vec<Stop>, Vec<PlanPoint>) {
    let (own, sites) = (&job.spec.vehicles[index], &job.world.sites[index]);
    let (mut stops, mut points) = (Vec::new(), Vec::new());
    let mut ids = new_stop_ids(&own.stops, "rest");
    for (route, rests) in rests.iter().enumerate() {
        for &rest in rests {
            let id = ids.next().unwrap_or_default();
            stops.push(Stop {
                arrives: Arrival::Exact,
                ..Stop::passing(&id, job.world.end_point(rest))
            });
            points.push(rest);
        }
        if let (Some(stop), Some(&site)) = (own.stops.get(route), sites.stops.get(route)) {
            stops.push(stop.clone());
            points.push(site);
        }
    }
    (stops, points)
}

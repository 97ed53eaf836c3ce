//! Why a fleet has no plan that passes, and with which departures it would have one.

use std::collections::{BTreeMap, BTreeSet};

use super::tighten::Strictness;
use super::{Dispatched, Job, Run};
use crate::plan::Request;
use crate::spec::{MissionSpec, Span};
use crate::verify::{Limit, Margin};
use crate::world::World;

/// Shortest window of departures that is tried, seconds.
const MIN_WINDOW_S: f64 = 60.0;
/// Longest one, seconds.
const MAX_WINDOW_S: f64 = 3600.0;

/// What a plan that breaks limits was made from. The search for its reasons takes longer than the plan: it is made once, of
/// the best of all plans.
#[derive(Clone, Debug)]
pub(super) struct Unexplained {
    pub(super) spec: MissionSpec,
    pub(super) world: World,
    pub(super) strictness: Strictness,
}

impl Dispatched {
    /// Adds the reasons why a fleet breaks limits: who has no path and why, and the departures with which it
    /// would pass. `dispatch` plans it once more for those.
    pub(super) fn explain(
        &mut self,
        specified: &MissionSpec,
        run: Run<'_>,
        dispatch: impl Fn(Job<'_>) -> Dispatched,
    ) {
        let Some(from) = self.unexplained.take() else {
            return;
        };
        if self.review.passes() || run.is_cancelled() {
            return;
        }
        let Unexplained {
            spec,
            world,
            strictness,
        } = *from;
        // The flights of tasks are judged on another spec, and zones that were left out for their times may be closed
        // later.
        let mut zones = specified.no_fly.iter();
        let has_times = zones.any(|zone| zone.active_s.is_some());
        if self.tasks.is_none() && run.is_nested && !has_times {
            self.try_departures((&spec, &world), run, dispatch);
        }
        self.add_blockers(&spec, &world, run.seed, strictness);
    }

    /// Plans a fleet whose vehicles are too near to each other with windows of departures.
    fn try_departures(
        &mut self,
        (spec, world): (&MissionSpec, &World),
        run: Run<'_>,
        dispatch: impl Fn(Job<'_>) -> Dispatched,
    ) {
        let mut broken = self.review.margins.iter().filter(|margin| !margin.ok);
        if !broken.any(|margin| margin.limit == Limit::Separation) {
            return;
        }
        let Some(spec) = self.with_windows((spec, world)) else {
            return;
        };
        let found = dispatch(Job {
            spec: &spec,
            world,
            judged: (&spec, world),
            run,
        });
        if !found.review.passes() {
            return;
        }
        let fleet = spec.vehicles.iter().zip(&found.plan.vehicles);
        for (own, (vehicle, plan)) in self.plan.vehicles.iter_mut().zip(fleet) {
            let is_other = (plan.depart_s - vehicle.depart_s).abs() > 0.0;
            own.passes_departing_s = is_other.then_some(plan.depart_s);
        }
    }

    /// The spec with windows in which each may wait until all others have landed; none where no file
    /// could have another departure.
    fn with_windows(&self, (spec, world): (&MissionSpec, &World)) -> Option<MissionSpec> {
        let durations = self.plan.vehicles.iter().map(|plan| plan.duration_s());
        let window_s = durations
            .sum::<f64>()
            .clamp(MIN_WINDOW_S, MAX_WINDOW_S)
            .ceil();
        let mut spec = spec.clone();
        let mut has_any = false;
        for (vehicle, sites) in spec.vehicles.iter_mut().zip(&world.sites) {
            let waits = !vehicle.airframe.has_wing() && !sites.departure.is_airborne();
            if waits && vehicle.retiming.depart_s.is_none() {
                let least = vehicle.depart_s;
                let most = least + window_s;
                vehicle.retiming.depart_s = Some(Span { least, most });
                has_any = true;
            }
        }
        has_any.then_some(spec)
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
            margins: strictness.margins,
            extra_parameters: strictness.parameters,
            ..Request::new(seed)
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
    pub(super) fn name_those_too_near(&mut self, spec: &MissionSpec) {
        let index = |id: &str| spec.vehicles.iter().position(|vehicle| vehicle.id == id);
        let broken = self.review.margins.iter().filter(|margin| !margin.ok);
        let near = broken.filter(|margin| margin.limit == Limit::Separation);
        let pairs = near.filter_map(|margin| {
            let (a, b) = (index(&margin.vehicle)?, index(margin.other.as_deref()?)?);
            Some((a.max(b), a.min(b)))
        });
        let mut conflicting: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
        for (vehicle, other) in pairs {
            conflicting.entry(vehicle).or_default().insert(other);
        }
        for (vehicle, others) in conflicting {
            let blocked_by = &mut self.plan.vehicles[vehicle].blocked_by;
            if blocked_by.is_empty() {
                blocked_by.extend(others);
            }
        }
    }
}

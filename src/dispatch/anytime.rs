//! Plans of rising quality, each verified, until they are good enough or time is up.

use std::sync::atomic::{AtomicBool, Ordering};

use super::{Dispatched, Run, budgets, dispatch_as};
use crate::plan::FleetPlan;
use crate::spec::MissionSpec;
use crate::world::World;

/// Evaluations of each vehicle's first plan.
const FIRST: usize = 250;

/// A plan with its missions and the verdict on them.
#[derive(Clone, Debug)]
pub struct Improved {
    /// The plan.
    pub dispatched: Dispatched,
    /// Evaluations that each vehicle had: `planner.evaluations` of a spec with the same plan. Those
    /// of the first plan, where that was made from an earlier one.
    pub evaluations: usize,
}

/// Plans a fleet again and again, with more evaluations each time. Yields every result that is
/// better than all before: with fewer violated limits, or of as many at less cost. Results depend
/// on spec, seed and the earlier plan alone, not on time.
pub struct Improving<'a> {
    spec: &'a MissionSpec,
    world: &'a World,
    seed: u64,
    cancel: &'a AtomicBool,
    earlier: Option<&'a FleetPlan>,
    /// Evaluations of the next plan, and most that a plan gets.
    next: Option<usize>,
    most: usize,
    /// Violated limits and cost of the best plan.
    best: Option<(usize, f64)>,
}

impl<'a> Improving<'a> {
    /// From a first plan with few evaluations to one with those of the spec. Once `cancel` is set,
    /// the plan that is being made is given up, and none follows.
    #[must_use]
    pub fn new(spec: &'a MissionSpec, world: &'a World, seed: u64, cancel: &'a AtomicBool) -> Self {
        let most = spec.planner.evaluations;
        Self {
            spec,
            world,
            seed,
            cancel,
            earlier: None,
            next: Some(FIRST.min(most)),
            most,
            best: None,
        }
    }

    /// The same beginning with the paths of an earlier plan, of this spec or of one that differs a
    /// little: with its vehicles in the same order. Each path keeps its way in the plane as far as
    /// the limits allow it.
    #[must_use]
    pub fn from_earlier(self, plan: &'a FleetPlan) -> Self {
        Self {
            earlier: Some(plan),
            ..self
        }
    }

    /// The same with more and more evaluations, until it is cancelled.
    #[must_use]
    pub fn without_end(self) -> Self {
        Self {
            next: Some(FIRST),
            most: usize::MAX,
            ..self
        }
    }

    /// A plan with this number of evaluations for each vehicle, from an earlier one if there is one. None
    /// if it was cancelled.
    fn planned(&self, evaluations: usize, earlier: Option<&FleetPlan>) -> Option<Improved> {
        let mut spec = self.spec.clone();
        spec.planner.evaluations = evaluations;
        let run = Run {
            seed: self.seed,
            watch: &|_| (),
            cancel: Some(self.cancel),
            known: None,
            earlier,
            is_nested: false,
        };
        let dispatched = dispatch_as(&spec, self.world, run);
        (!self.is_cancelled()).then_some(Improved {
            dispatched,
            evaluations,
        })
    }

    fn is_cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }
}

impl Iterator for Improving<'_> {
    type Item = Improved;

    fn next(&mut self) -> Option<Improved> {
        while !self.is_cancelled() {
            let earlier = self.earlier.take();
            let evaluations = self.next?;
            if earlier.is_none() {
                let more = budgets::after(evaluations).min(self.most);
                self.next = (evaluations < self.most).then_some(more);
            }
            let found = self.planned(evaluations, earlier)?;
            if (self.best).is_none_or(|best| found.dispatched.is_better_than(best)) {
                self.best = Some(found.dispatched.rank());
                return Some(found);
            }
        }
        None
    }
}

//! What plans teach about the next assignment.
//!
//! First the estimates of vehicles that use more than they may are raised by what their plans used. Such
//! a factor holds for all ways of a vehicle, also where other tasks than those of the plan need less. So
//! if no plan passes, estimates are made with what autopilots are late instead. Then vehicles get less than
//! they may use: an assignment that passes with less endurance passes with more, but costs more than one
//! that has vehicles in each other's way, and so is not found before.

use super::{Assigner, BUDGET, FleetTasks};
use crate::spec::MissionSpec;

/// A vehicle that missed a window is expected later by this more, seconds.
const LATER_S: f64 = 1.0;
/// Raised estimates are raised by this more.
const SURPLUS: f64 = 1.01;
/// Most plans of each trial: the first with estimates by the flight model, the second with the lateness of
/// autopilots in them, each of the others with less of the endurance.
const PLANS: [usize; 5] = [4, 2, 2, 2, 2];
/// The first trial with less endurance.
const FIRST_WITH_LESS: u8 = 2;
/// How much less each has.
const LESS: f64 = 0.975;

/// How tasks are assigned.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Trial {
    /// Its number.
    number: u8,
    /// Plans that were made in it.
    plans: usize,
}

impl Trial {
    /// Whether estimates have in them what autopilots are late.
    pub(super) fn counts_lateness(self) -> bool {
        self.number == 1
    }

    /// The part of what vehicles may use that they get.
    pub(super) fn share(self) -> f64 {
        LESS.powi(i32::from(self.number.saturating_sub(FIRST_WITH_LESS - 1)))
    }
}

impl<'a> Assigner<'a> {
    /// The spec whose tasks are assigned.
    #[must_use]
    pub fn spec(&self) -> &'a MissionSpec {
        self.spec
    }

    /// Raises the estimates of vehicles whose plans use more than they get: each by its index, and
    /// what its plan uses as a share of what it may. Whether a vehicle with tasks is among them.
    pub fn learn(&mut self, tasks: &FleetTasks, used: &[(usize, f64)]) -> bool {
        let mut learns = false;
        for &(index, share) in used {
            let (on_ways, in_all) = tasks.estimated[index];
            let is_over = share > self.trial.share();
            if is_over && on_ways > 0.0 && !tasks.done[index].is_empty() {
                let on_rests = in_all - on_ways;
                let planned = share * BUDGET - self.overhead(index) - on_rests;
                self.factors[index] *= (planned / on_ways).max(1.0) * SURPLUS;
                learns = true;
            }
        }
        learns
    }

    /// Expects these vehicles later, whose plans miss windows by some seconds.
    pub fn hurry(&mut self, late: &[(usize, f64)]) {
        for &(vehicle, missed_s) in late {
            self.later_s[vehicle] += missed_s + LATER_S;
        }
    }

    /// Whether estimates were raised by a factor, which may be too much for what is left.
    #[must_use]
    pub fn is_cautious(&self) -> bool {
        self.trial.number == 0 && self.factors.iter().any(|factor| *factor > 1.0)
    }

    /// Whether what was learned is worth another plan.
    pub fn tries_again(&mut self, learns: bool) -> bool {
        self.trial.plans += 1;
        learns && self.trial.plans < PLANS[usize::from(self.trial.number)]
    }

    /// Goes on to the next trial; false after the last one, or where no endurance is limited.
    pub fn tries_otherwise(&mut self) -> bool {
        let mut fleet = self.spec.vehicles.iter();
        let number = self.trial.number + 1;
        if usize::from(number) == PLANS.len() || fleet.all(|vehicle| vehicle.endurance.is_none()) {
            return false;
        }
        self.trial = Trial { number, plans: 0 };
        self.factors.fill(1.0);
        true
    }
}

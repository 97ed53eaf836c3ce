//! Tasks of a fleet.

use super::Sweep;
use crate::spec::{Autopilot, Stop, Vehicle};

/// Most tasks of one spec.
pub const MAX_TASKS: usize = 200;

/// A task for whichever copter can do it.
#[derive(Clone, Debug, PartialEq)]
pub struct Task {
    /// Unique among the tasks.
    pub id: String,
    /// Its places in the order in which one vehicle visits them: one of a visit, whose id is that
    /// of the task; of a delivery `ID.from` and `ID.to`.
    pub stops: Vec<Stop>,
    /// Lines that are flown, by several vehicles where that is possible; then it has no stops.
    pub sweep: Option<Sweep>,
}

impl Task {
    /// Whether a vehicle has a stop for it: those of its places and of its lines are named after it.
    #[must_use]
    pub fn has_stop(&self, stop: &Stop) -> bool {
        let rest = stop.id.strip_prefix(&self.id);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    }

    /// Whether a vehicle may be given it: a copter whose autopilot runs its actions, and which takes
    /// no pictures at a distance of its own where the task does.
    #[must_use]
    pub fn is_for(&self, vehicle: &Vehicle) -> bool {
        let has_distance = vehicle.on_way.trigger_m.is_some() && self.takes_pictures();
        !vehicle.airframe.has_wing() && self.is_run_by(vehicle.autopilot) && !has_distance
    }

    /// Whether pictures are taken at a distance on its lines.
    #[must_use]
    pub fn takes_pictures(&self) -> bool {
        let sensor = self.sweep.as_ref().and_then(|sweep| sweep.sensor);
        sensor.is_some_and(|sensor| sensor.along.is_some())
    }

    /// Whether an autopilot runs all of its actions.
    #[must_use]
    pub fn is_run_by(&self, autopilot: Autopilot) -> bool {
        let mut actions = self.stops.iter().flat_map(|stop| &stop.actions);
        actions.all(|action| action.is_run_by(autopilot))
    }
}

//! Vehicles that keep their present path, or their position, in the joint plan.

use super::JointPlan;
use crate::flight::replan::activity::Doing;
use crate::flight::replan::state::VehicleState;
use crate::geodesy::PlanPoint;
use crate::mission::{Item, VehicleMission, command};
use crate::spec::{Autopilot, Vehicle};

impl JointPlan<'_> {
    /// Adds a vehicle in the air that goes on as it does.
    pub(super) fn add_unaffected(&mut self, state: &VehicleState) {
        let points = match state.doing {
            Doing::Mission => state.points(),
            Doing::Returns(_) => vec![state.here, state.doing.stays_at(state.here)],
            Doing::Holds | Doing::Lands | Doing::Other => vec![state.here],
        };
        let last = points.last().copied().unwrap_or(state.here);
        let lands = state.lands && state.in_mission();
        let departure = state.departure(self.given.now_s);
        self.add(state, (state.here, last), lands, departure);
        let (rows, items) = state.items_ahead(&self.world.frame).into_iter().unzip();
        self.commit(state, &points, held(state, items), rows);
    }

    /// Adds a vehicle that stands on the ground and takes off at its time.
    pub(super) fn add_standing(&mut self, state: &VehicleState) {
        let vehicle = self.vehicle(state);
        let depart_s = vehicle.depart_s.max(self.given.now_s);
        let items = (1..).zip(state.held.items.iter().copied());
        let (mut rows, mut items): (Vec<usize>, Vec<Item>) = items
            .filter(|(_, item)| item.command != command::NAV_DELAY)
            .unzip();
        // ArduPlane does not wait by itself: it departs when it is launched.
        let is_launched = vehicle.airframe.has_wing() && vehicle.autopilot == Autopilot::ArduPilot;
        if !is_launched {
            #[expect(clippy::cast_possible_truncation, reason = "parameters are float32")]
            let delay_s = depart_s as f32;
            let wait = Item::without_place(command::NAV_DELAY, [delay_s, -1.0, -1.0, -1.0]);
            items.insert(0, wait);
            rows.insert(0, 1);
        }
        self.spec.vehicles.push(Vehicle {
            depart_s,
            ..vehicle.clone()
        });
        let sites = self.given.plan.world.sites[state.vehicle].clone();
        self.world.sites.push(sites);
        let path: Vec<PlanPoint> = state.ahead.iter().map(|(_, point)| *point).collect();
        self.commit(state, &path, held(state, items), rows);
    }
}

/// The mission on board with other items. Its fence does not have to hold a new threat.
fn held(state: &VehicleState, items: Vec<Item>) -> VehicleMission {
    VehicleMission {
        items,
        is_fence_known: false,
        ..state.held.clone()
    }
}

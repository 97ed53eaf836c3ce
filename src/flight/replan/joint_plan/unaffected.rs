//! Those who keep their state, or their place, as the verdict on the new paths sees them.

use super::{Present, ground};
use crate::flight::replan::item_rows::Origin;
use crate::flight::replan::state::VehicleState;
use crate::geodesy::{Amsl, PlanPoint};
use crate::mission::{self, Item, VehicleMission, command};
use crate::path::route_start_s;
use crate::spec::{Autopilot, Vehicle};

/// With less way than this before it a vehicle is at its end, metres.
const AT_END_M: f64 = 4.0;
/// A way to a circle begins so many radii before its middle.
const OUTSIDE: f64 = 3.0;

impl Present<'_> {
    /// A vehicle that is not concerned goes on as it does.
    pub(super) fn keep(&mut self, state: &VehicleState) {
        let at_its_end;
        let state = if state.path_m() < AT_END_M.max(OUTSIDE * state.circle_m) {
            at_its_end = self.at_its_end(state);
            &at_its_end
        } else {
            state
        };
        let points = state.points();
        let last = points.last().copied().unwrap_or(state.here);
        let at_s = self.now_s + state.rises_s;
        self.add(self.vehicle(state), (state.here, last), state.lands, at_s);
        let straight = self.route(state, &[state.here, last], at_s).path;
        let head = self.head(&[straight]);
        self.settle_kept(state, (&points, at_s), state.items_ahead(), head);
    }

    /// Takes the last vehicle that was added into the fleet with its way, with what begins its
    /// mission and the items of its own that follow, each with its row.
    fn settle_kept(
        &mut self,
        state: &VehicleState,
        (way, at_s): (&[PlanPoint], f64),
        own: Vec<(usize, Item)>,
        begun: Result<VehicleMission, mission::MissionError>,
    ) {
        match begun {
            Ok(mut mission) => {
                hold_fence(&mut mission, state);
                let mut rows = vec![state.at + 1; mission.items.len()];
                for (row, item) in own {
                    rows.push(row);
                    mission.items.push(item);
                }
                let route = self.route(state, way, at_s);
                self.settle(vec![route], mission, Origin::new(state, at_s, rows));
            }
            Err(error) => {
                self.drop_last();
                self.problem(state, "encoding", error.to_string());
            }
        }
    }

    /// A vehicle that does not fly its mission stays where it is: what else it does nobody knows.
    pub(super) fn keep_place(&mut self, state: &VehicleState) {
        let staying = VehicleState {
            ahead: vec![(state.at, state.here)],
            circle_m: self
                .vehicle(state)
                .wing
                .map_or(0.0, |wing| wing.loiter_radius_m),
            ..state.clone()
        };
        let beside = self.at_its_end(&staying);
        let place = PlanPoint {
            amsl: beside.here.amsl,
            ..state.here
        };
        let (way, at_s) = ([beside.here, place], self.now_s);
        self.add(self.vehicle(state), way.into(), false, at_s);
        let index = self.spec.vehicles.len() - 1;
        let path = self.route(state, &way, at_s).path;
        let built = mission::build_course(&self.spec, &self.world, index, &[path], 1);
        self.settle_kept(state, (&way, at_s), Vec::new(), built);
    }

    /// A vehicle that stays at its end, or comes down there: for the verdict it begins a few
    /// metres beside, a wing outside of its circle, no lower than may be flown, so that there is a way to be judged and
    /// its whole column counts.
    fn at_its_end(&self, state: &VehicleState) -> VehicleState {
        let place = state.ahead.last().map_or(state.here, |(_, place)| *place);
        let least_m = ground(&self.world, place).0 + self.spec.area.min_agl.0;
        let amsl = Amsl(place.amsl.0.max(least_m + self.spec.mission.tolerance_m));
        let beside_m = AT_END_M.max(OUTSIDE * state.circle_m);
        let here = PlanPoint::new(place.at.east_m, place.at.north_m - beside_m, amsl);
        VehicleState {
            here,
            ..state.clone()
        }
    }

    /// A vehicle that has not taken off will do so at its time.
    pub(super) fn keep_standing(&mut self, state: &VehicleState) {
        let (spec, world) = (self.given.plan.spec(), &self.given.plan.world);
        let (Some(vehicle), Some(stations)) = (
            spec.vehicles.get(state.vehicle),
            world.stations.get(state.vehicle),
        ) else {
            return;
        };
        let waits_s = (vehicle.depart_s - self.given.now_s).max(0.0);
        let depart_s = self.now_s + waits_s;
        let mut mission = state.held.clone();
        hold_fence(&mut mission, state);
        let (mut rows, items): (Vec<usize>, Vec<Item>) = (1..)
            .zip(mission.items)
            .filter(|(_, item)| item.command != command::NAV_DELAY)
            .unzip();
        mission.items = items;
        // ArduPlane does not wait by itself: the verdict knows when it is launched.
        let is_launched = vehicle.airframe.has_wing() && vehicle.autopilot == Autopilot::ArduPilot;
        if !is_launched {
            #[expect(clippy::cast_possible_truncation, reason = "parameters are float32")]
            let delay_s = depart_s as f32;
            let wait = Item::without_place(command::NAV_DELAY, [delay_s, -1.0, -1.0, -1.0]);
            mission.items.insert(0, wait);
            rows.insert(0, 1);
        }
        let vehicle = Vehicle {
            depart_s,
            ..vehicle.clone()
        };
        let route_s = route_start_s(&vehicle, stations);
        self.spec.vehicles.push(vehicle);
        self.world.stations.push(*stations);
        let route = self.route(state, &state.points(), route_s);
        self.settle(vec![route], mission, Origin::new(state, 0.0, rows));
    }
}

/// Who keeps its state keeps its fence: nothing of what came up since is in it, nor has to be.
fn hold_fence(mission: &mut VehicleMission, state: &VehicleState) {
    mission.fence.clone_from(&state.held.fence);
    mission.is_fence_known = false;
}

//! Vehicles that get a new path in the joint plan: searched, encoded as items, and added.

use super::JointPlan;
use super::stays::{drop_last_trigger, keep_stays, on_way_ahead, rest_s};
use crate::cost::Margins;
use crate::flight::replan::new_mission::{NewMission, head_len};
use crate::flight::replan::state::{Branch, VehicleState, Via};
use crate::geodesy::PlanPoint;
use crate::mission::{self, Item, MissionError, VehicleMission};
use crate::path::{Departure, TimedPoint, heading_rad};
use crate::plan::{Request, VehiclePlan, replan_from};
use crate::spec::Finish;
use crate::verify::Limit;

impl JointPlan<'_> {
    /// Adds a vehicle with a new path from where it branches off its present one.
    pub(super) fn add_diverted(
        &mut self,
        state: &VehicleState,
        branch: &Branch,
        buffer: f64,
    ) -> Option<NewMission> {
        let retained: Vec<PlanPoint> = state
            .points()
            .into_iter()
            .take(branch.retained + 1)
            .collect();
        let turn = retained.last().copied().unwrap_or(state.here);
        let mut routes = self.search(state, branch, (turn, buffer));
        let last = routes.last().and_then(|route| route.last()).copied()?;
        routes.first_mut()?.insert(0, turn);
        let built = match self.encode(state, &routes) {
            Ok(mut built) => {
                if self.vehicle(state).finish == Finish::Return {
                    drop_last_trigger(&mut built.items);
                }
                keep_stays(&mut built.items, state.vias_after(branch));
                // They are on board already, as the stops ahead need them.
                built.params.clone_from(&state.held.params);
                built
            }
            Err(error) => {
                self.problem(state, Limit::Encoding, error.to_string());
                return None;
            }
        };
        let head = head_len(&built.items);
        let mut new: Vec<Item> = built.items[head..].to_vec();
        let found = NewMission::new(state, branch, &built, &mut new, &self.world);
        let mut items = built.items[..head].to_vec();
        items.extend(state.retained_items(branch));
        items.extend(new);
        let first = found.as_ref().map_or(0, |found| found.ahead);
        let rows = (first + 1..).take(items.len() - head);
        let rows = std::iter::repeat_n(state.at + 1, head)
            .chain(rows)
            .collect();
        let path: Vec<PlanPoint> = retained
            .into_iter()
            .chain(routes.concat().into_iter().skip(1))
            .collect();
        let departure = state.departure(self.given.now_s);
        self.add_with_stops(state, (state.here, last), departure);
        self.commit(state, &path, VehicleMission { items, ..built }, rows);
        let from_s = self.given.now_s + branch.distance_m / self.vehicle(state).speed_mps;
        self.check_returns(state, from_s);
        if found.is_none() {
            let why = "its items ahead are not one after the other";
            self.problem(state, Limit::ItemsAhead, why);
        }
        found
    }

    /// Searches new routes, one after the other, around the vehicles that were added before.
    fn search(
        &mut self,
        state: &VehicleState,
        branch: &Branch,
        (turn, buffer): (PlanPoint, f64),
    ) -> Vec<Vec<PlanPoint>> {
        let buffer_m = buffer * self.spec.mission.tolerance_m;
        let margins = Margins {
            clearance_m: buffer_m,
            line_m: 0.0,
            under_m: buffer_m,
            threat_m: buffer_m,
            separation_m: 2.0 * buffer_m,
            shift_s: 0.0,
            turn_fraction: 0.1,
            climb_fraction: 0.05,
        };
        let cruise_mps = self.vehicle(state).speed_mps;
        let mut at_s = self.given.now_s + branch.distance_m / cruise_mps;
        // It passes the branch, and rests where it turns back.
        let mut speed_mps = cruise_mps;
        let ends = state.routes(branch);
        let vias: Vec<&Via> = state.vias_after(branch).collect();
        let mut paths = Vec::new();
        for (number, (from, to)) in ends.iter().copied().enumerate() {
            let is_last = number + 1 == ends.len();
            let departure = Departure::Airborne {
                point: from,
                course_rad: heading_rad(turn.at, from.at),
                speed_mps,
                at_s,
            };
            self.add(state, (from, to), is_last && state.lands, departure);
            let request = Request {
                cancel: None,
                seed: self.plan.seed,
                margins: vec![margins; self.spec.vehicles.len()],
                extra_parameters: Vec::new(),
                progress: &|_| {},
            };
            let first = self.plan.vehicles.len();
            let found = replan_from(&self.plan, first, &self.spec, &self.world, &request);
            self.drop_last();
            let timed: Vec<TimedPoint> = found
                .vehicles
                .get(first)
                .map(VehiclePlan::path)
                .unwrap_or_default();
            let own = self.vehicle(state);
            let rest_s = vias.get(number).map_or(0.0, |via| rest_s(&via.items, own));
            (at_s, speed_mps) = (timed.last().map_or(at_s, |last| last.t_s) + rest_s, 0.0);
            paths.push(timed.iter().map(|timed| timed.point).collect());
        }
        paths
    }

    /// The items of new routes: they begin where the last item that is retained lies.
    fn encode(
        &mut self,
        state: &VehicleState,
        routes: &[Vec<PlanPoint>],
    ) -> Result<VehicleMission, MissionError> {
        let mut points = routes.iter().flatten();
        let from = points.next().copied().unwrap_or(state.here);
        let to = points.next_back().copied().unwrap_or(from);
        let departure = Departure::Airborne {
            point: from,
            course_rad: 0.0,
            speed_mps: 0.0,
            at_s: self.given.now_s,
        };
        self.add(state, (from, to), state.lands, departure);
        let (vehicle, sites) = (self.vehicle(state), self.sites(state));
        let index = self.spec.vehicles.len() - 1;
        if let Some(own) = self.spec.vehicles.last_mut() {
            own.on_way = on_way_ahead(state, vehicle, sites);
            if vehicle.finish == Finish::Return {
                // What is done at the goal stays as it is on board.
                own.on_way.goal.clear();
            }
        }
        let routes: Vec<Vec<TimedPoint>> = routes
            .iter()
            .map(|route| self.route(state, route).path)
            .collect();
        let built = mission::build_course(&self.spec, &self.world, index, &routes, routes.len());
        self.drop_last();
        built
    }
}

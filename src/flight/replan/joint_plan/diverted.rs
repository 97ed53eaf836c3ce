//! Vehicles that get a new path in the joint plan: searched, encoded as items, and added.

use super::JointPlan;
use super::stays::{drop_last_trigger, keep_stays, on_way_ahead, rest_s, speed_after_mps};
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
        let (from_s, _) = self.at_branch(state, branch);
        self.check_returns(state, from_s);
        if found.is_none() {
            let why = "its items ahead are not one after the other";
            self.problem(state, Limit::ItemsAhead, why);
        }
        found
    }

    /// When it comes to its branch, seconds after T0, and the speed that it flies with there, m/s:
    /// it rests at the stops before that, and takes their speeds.
    fn at_branch(&self, state: &VehicleState, branch: &Branch) -> (f64, f64) {
        let own = self.vehicle(state);
        let mut speed_mps = state.speed_now_mps(own, self.sites(state));
        let (mut at_s, mut left_m) = (self.given.now_s, branch.distance_m);
        let points = state.points();
        for (number, leg) in points.windows(2).take(branch.retained).enumerate() {
            let length_m = leg[0].distance_m(leg[1]);
            at_s += length_m / speed_mps;
            left_m -= length_m;
            if let Some(via) = state.vias.iter().find(|via| via.first == number) {
                at_s += rest_s(&via.items, own);
                speed_mps = speed_after_mps(&via.items).unwrap_or(speed_mps);
            }
        }
        (at_s + left_m.max(0.0) / speed_mps, speed_mps)
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
        let (mut at_s, mut cruise_mps) = self.at_branch(state, branch);
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
            if let Some(own) = self.spec.vehicles.last_mut() {
                own.speed_mps = cruise_mps;
            }
            let request = Request {
                margins: vec![margins; self.spec.vehicles.len()],
                ..Request::new(self.plan.seed)
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
            let done = vias.get(number).map_or(&[][..], |via| &via.items);
            let rest_s = rest_s(done, own);
            cruise_mps = speed_after_mps(done).unwrap_or(cruise_mps);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::launch::plan::FlightPlan;
    use crate::flight::replan::assessment::Assessment;
    use crate::flight::replan::observation::ObservedVehicle;
    use crate::flight::replan::state::ThreatTime;
    use crate::link::{Address, Heartbeat, Onboard, Position};
    use crate::mission::command;
    use crate::path::{route_ends, time_route};
    use crate::spec::SpecFile;
    use crate::{verify, world};

    const NOW_S: f64 = 500.0;

    /// The plan of a copter that flies 10 m/s to its stop and 4 m/s from there, straight to the east.
    fn plan() -> FlightPlan {
        let text = "
sortie: 1
name: slower
area: {south_west: {lat: 36.28, lon: -84.30}, north_east: {lat: 36.32, lon: -84.22}, min_agl_m: 30, max_amsl_m: 900}
terrain: {flat: {amsl_m: 400}}
vehicles:
  - {id: alpha, sysid: 1, autopilot: ardupilot, link: sim, speed_mps: 10, finish: land,
     start: {lat: 36.30, lon: -84.28, agl_m: 80}, goal: {lat: 36.30, lon: -84.23, agl_m: 80},
     stops: [{id: s1, lat: 36.30, lon: -84.27, agl_m: 80, hold_s: 3, speed_mps: 4}]}
";
        let path = std::path::Path::new("slower.yaml");
        let file = SpecFile::parse(path, text.to_owned()).expect("a spec");
        let world = world::load(&file).expect("a world");
        let ends = route_ends(&file.spec.vehicles[0], &world.sites[0]);
        let straight =
            |(from, to): &(PlanPoint, PlanPoint)| time_route(&[*from, *to], 0.0, 10.0, 2.0);
        let routes: Vec<_> = ends.iter().map(straight).collect();
        let mission = mission::build(&file.spec, &world, 0, &routes).expect("a mission");
        let review = verify::review(&file.spec, &world, &[(0, &mission)]);
        FlightPlan {
            file,
            folder: std::path::PathBuf::new(),
            world,
            missions: vec![(0, mission)],
            itineraries: Vec::new(),
            review,
        }
    }

    /// The copter at a longitude on its way to one of its waypoints, counted from its goal.
    fn observed(mission: &VehicleMission, before_goal: usize, y: i32) -> ObservedVehicle {
        let is_waypoint = |item: &Item| item.command == command::NAV_WAYPOINT;
        let rows = mission.items.iter().zip(1_u16..);
        let waypoints = rows.filter(|(item, _)| is_waypoint(item));
        let rows: Vec<u16> = waypoints.map(|(_, row)| row).collect();
        let row = rows[rows.len() - 1 - before_goal];
        ObservedVehicle {
            address: Address {
                system: 1,
                component: 1,
            },
            heartbeat: Heartbeat {
                kind: 2,
                autopilot: 3,
                base_mode: 0x81,
                // AUTO.
                custom_mode: 3,
                system_status: 4,
            },
            position: Position {
                x: 363_000_000,
                y,
                amsl_mm: 480_000,
                above_home_mm: 80_000,
                velocity_cmps: [0, 400, 0],
                ..Position::default()
            },
            flown: Vec::new(),
            seq: row,
            total: u16::try_from(mission.items.len() + 1).expect("few items"),
            onboard: Onboard {
                sysid: 1,
                autopilot: Some(mission.autopilot),
                description: String::new(),
                home: Some(mission.home),
                mission: mission.items.clone(),
                fence: Vec::new(),
                rally: Vec::new(),
                unknown: Vec::new(),
            },
        }
    }

    #[test]
    fn times_count_with_the_speed_that_a_stop_behind_the_vehicle_has_set() {
        let plan = plan();
        let mission = &plan.missions[0].1;
        let since = ThreatTime {
            steady_ms: 0,
            speedup: 1.0,
        };
        let state = |before_goal, y| {
            let observed = observed(mission, before_goal, y);
            VehicleState::new(&plan, 0, mission, &observed, &since).expect("its path is known")
        };
        let before_stop = state(1, -842_720_000);
        let state = state(0, -842_650_000);
        let given = Assessment {
            plan: &plan,
            popups: &[],
            others: Vec::new(),
            concerned: Vec::new(),
            unavoidable: Vec::new(),
            now_s: NOW_S,
            seed: None,
        };
        let mut joint = JointPlan::of(&given);
        let branch = state.branch_after(200.0).expect("it has 3 km ahead");
        let (branch_s, speed_mps) = joint.at_branch(&state, &branch);
        assert!((branch_s - NOW_S - 50.0).abs() < 1e-6, "{branch_s}");
        assert!((speed_mps - 4.0).abs() < 1e-6, "{speed_mps}");
        // It has 180 m to its stop, rests there for 3 s, and flies on with its speed.
        let behind_stop = before_stop.branch_after(380.0).expect("it has 4 km ahead");
        assert_eq!(behind_stop.retained, 1);
        let (at_s, speed_mps) = joint.at_branch(&before_stop, &behind_stop);
        assert!((at_s - NOW_S - 71.0).abs() < 1.0, "{at_s}");
        assert!((speed_mps - 4.0).abs() < 1e-6, "{speed_mps}");
        joint.add_unaffected(&state);
        let (path, points) = (joint.plan.vehicles[0].path(), state.points());
        let length_m = points[0].distance_m(points[1]);
        assert!((3000.0..3300.0).contains(&length_m), "{length_m}");
        let lasts_s = path.last().expect("a path").t_s - NOW_S;
        let slack_s = lasts_s - length_m / 4.0;
        assert!(
            (0.0..5.0).contains(&slack_s),
            "{lasts_s} s for {length_m} m"
        );
        let change =
            |mps: f32| Item::without_place(command::DO_CHANGE_SPEED, [1.0, mps, -1.0, 0.0]);
        assert_eq!(speed_after_mps(&[change(6.0), change(4.0)]), Some(4.0));
        assert_eq!(speed_after_mps(&mission.items[..1]), None);
    }
}

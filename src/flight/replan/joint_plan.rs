//! New paths for the vehicles that meet a threat, and the verdict on the whole fleet together.
//!
//! The spec and the world of a joint plan hold the fleet as it is now: every vehicle in the air
//! departs from where it is. The verdict judges the items that a vehicle has ahead: those that it
//! retains and the new ones.

mod returns;
mod stays;
mod unaffected;

use self::stays::{drop_last_trigger, keep_stays, on_way_ahead, rest_s};
use super::assessment::{Assessment, NoPath};
use super::new_mission::{NewMission, head_len};
use super::state::{Branch, VehicleState, Via};
use crate::cost::Margins;
use crate::flight::conformance::reference::ReferenceTrajectory;
use crate::geodesy::{Amsl, PlanPoint};
use crate::mission::{self, Item, MissionError, VehicleMission};
use crate::path::{Departure, TimedPoint, heading_rad, time_route_from};
use crate::plan::{FleetPlan, Request, Route, VehiclePlan, replan_from};
use crate::spec::{AltitudeReference, Buffers, Finish, MissionSpec, Order, Vehicle};
use crate::verify::{self, Limit, Margin, Review};
use crate::world::{VehicleSites, World};

/// Evaluations for each route: a new path must come soon.
const EVALUATIONS: usize = 6000;
/// Buffers of every distance, in tolerances of the mission: waypoint legs may leave the path by
/// one. A plan that fails is made again with the next.
const BUFFERS: [f64; 3] = [1.5, 3.0, 6.0];

/// New missions, the verdict on the whole fleet, and whether that has the buffers of the spec.
pub(super) struct Replanned {
    pub(super) missions: Vec<NewMission>,
    pub(super) review: Review,
    pub(super) has_buffers: bool,
    /// Whether a new path comes near a way on which another vehicle returns.
    meets_return: bool,
}

/// Plans the concerned vehicles around the threat and around all others, and judges everything.
/// Where no path keeps the buffers of the spec, the limits alone count, as they do for a flight. A
/// vehicle without a path keeps its present one, so that the others have one.
pub(super) fn replan(given: &mut Assessment<'_>, no_path: &mut NoPath) -> Replanned {
    let is_buffered = given.plan.spec().buffers != Buffers::NONE;
    loop {
        // Around ways of return with much time to spare, if that can be.
        let slack_s = JointPlan::of(given).return_slack_s();
        let mut found = attempt(given, true, slack_s);
        if slack_s.is_some() && !given.is_sound(&found.review) {
            found = attempt(given, true, None);
        }
        if is_buffered && !given.is_sound(&found.review) {
            let limits_alone = attempt(given, false, None);
            // That it comes near a way of return says more than what else is broken.
            if given.is_sound(&limits_alone.review) || !found.meets_return {
                found = limits_alone;
            }
        }
        if given.is_sound(&found.review) || !given.give_up(&found.review, no_path) {
            given.drop_verified_limits(&mut found.review);
            given.correct_unavoidable(&found.review);
            return found;
        }
    }
}

/// One plan after the other, each with wider distances, until one is sound.
fn attempt(given: &Assessment<'_>, has_buffers: bool, slack_s: Option<f64>) -> Replanned {
    let plan = |distance: f64| {
        let mut joint = JointPlan::of(given);
        let min_s = &mut joint.spec.separation.time_slack_s;
        *min_s = min_s.max(slack_s.unwrap_or(0.0));
        let joint = if has_buffers {
            joint
        } else {
            joint.of_limits_alone()
        };
        joint.replan(distance)
    };
    let [first, wider @ ..] = BUFFERS;
    let mut found = plan(first);
    for distance in wider {
        if given.is_sound(&found.review) || found.meets_return {
            break;
        }
        found = plan(distance);
    }
    Replanned {
        has_buffers,
        ..found
    }
}

/// The fleet as it is now, vehicle by vehicle: spec, world, paths and missions have one order.
struct JointPlan<'a> {
    given: &'a Assessment<'a>,
    spec: MissionSpec,
    world: World,
    plan: FleetPlan,
    missions: Vec<VehicleMission>,
    /// Of each vehicle the row that it flies to, and the row on board of each judged item.
    rows: Vec<(usize, Vec<usize>)>,
    problems: Vec<Margin>,
    /// Those of new paths that come near a way on which another vehicle returns.
    returns_met: Vec<Margin>,
}

impl<'a> JointPlan<'a> {
    fn of(given: &'a Assessment<'a>) -> Self {
        let (spec, world) = (given.plan.spec(), &given.plan.world);
        let mut joint = Self {
            given,
            // What is left of tasks stays in the missions as it is on board.
            spec: MissionSpec {
                vehicles: Vec::new(),
                tasks: Vec::new(),
                ..spec.clone()
            },
            world: world.clone(),
            plan: FleetPlan {
                seed: given.seed.unwrap_or(spec.planner.seed),
                vehicles: Vec::new(),
            },
            missions: Vec::new(),
            rows: Vec::new(),
            problems: Vec::new(),
            returns_met: Vec::new(),
        };
        joint.world.sites.clear();
        joint.world.tasks.clear();
        // An altitude AMSL is the same whatever home the autopilot has taken.
        joint.spec.mission.altitude = AltitudeReference::Amsl;
        joint.spec.planner.evaluations = EVALUATIONS.min(spec.planner.evaluations);
        joint
    }

    /// The same without the buffers of the spec.
    fn of_limits_alone(mut self) -> Self {
        self.world = self.world.without_buffers(&self.spec);
        self.spec.buffers = Buffers::NONE;
        for zone in &mut self.spec.no_fly {
            zone.buffer_m = 0.0;
        }
        self
    }

    fn replan(mut self, buffer: f64) -> Replanned {
        let given = self.given;
        for state in &given.others {
            if state.stands {
                self.add_standing(state);
            } else {
                self.add_unaffected(state);
            }
        }
        let mut new = Vec::new();
        for (state, branch) in &given.concerned {
            new.extend(self.add_diverted(state, branch, buffer));
        }
        self.judge(new)
    }

    fn vehicle(&self, state: &VehicleState) -> &'a Vehicle {
        self.given.plan.vehicle(state.vehicle)
    }

    fn problem(&mut self, state: &VehicleState, limit: Limit, why: impl Into<String>) {
        let id = &self.vehicle(state).id;
        self.problems.push(Margin::unjudged(id, limit, why));
    }

    /// Adds a vehicle that flies from where it departs to another point.
    fn add(
        &mut self,
        state: &VehicleState,
        (from, to): (PlanPoint, PlanPoint),
        lands: bool,
        departure: Departure,
    ) {
        let (vehicle, sites) = (self.vehicle(state), self.sites(state));
        self.spec.vehicles.push(Vehicle {
            finish: if lands { Finish::Land } else { Finish::Loiter },
            stops: Vec::new(),
            order: Order::Fixed,
            speed_mps: state.speed_now_mps(vehicle, sites),
            ..vehicle.clone()
        });
        self.world.sites.push(VehicleSites {
            departure,
            start: from,
            goal: to,
            landing: to.at,
            // On a new path a vehicle lands from anywhere.
            landing_rad: None,
            goal_ground: ground(&self.world, to),
            stops: Vec::new(),
            ..sites.clone()
        });
    }

    /// Adds one that has its stops ahead still to visit.
    fn add_with_stops(
        &mut self,
        state: &VehicleState,
        ends: (PlanPoint, PlanPoint),
        departure: Departure,
    ) {
        let (vehicle, sites) = (self.vehicle(state), self.sites(state));
        self.add(state, ends, state.lands, departure);
        let ahead = state.stops_ahead(vehicle, sites);
        if let (Some(own), Some(at)) = (self.spec.vehicles.last_mut(), self.world.sites.last_mut())
        {
            own.stops = ahead
                .iter()
                .map(|&stop| vehicle.stops[stop].clone())
                .collect();
            at.stops = ahead.iter().map(|&stop| sites.stops[stop]).collect();
            if state.returns_from(vehicle, sites.goal) && vehicle.wing.is_none() {
                own.finish = Finish::Return;
                (at.goal, at.goal_ground) = (sites.goal, sites.goal_ground);
            }
            own.on_way = on_way_ahead(state, vehicle, sites);
        }
    }

    fn sites(&self, state: &VehicleState) -> &'a VehicleSites {
        &self.given.plan.world.sites[state.vehicle]
    }

    fn drop_last(&mut self) {
        self.spec.vehicles.pop();
        self.world.sites.pop();
    }

    /// Commits the path and the items of the last vehicle that was added; `rows` are the rows on
    /// board of the items.
    fn commit(
        &mut self,
        state: &VehicleState,
        path: &[PlanPoint],
        mission: VehicleMission,
        rows: Vec<usize>,
    ) {
        let Some(added) = self.spec.vehicles.last() else {
            return;
        };
        self.plan.vehicles.push(VehiclePlan {
            depart_s: added.depart_s,
            speed_mps: added.speed_mps,
            routes: self.routes(state, path),
            ..VehiclePlan::default()
        });
        self.missions.push(mission);
        self.rows.push((state.at + 1, rows));
    }

    /// The routes of the last vehicle that was added: its path from stop to stop.
    fn routes(&self, state: &VehicleState, path: &[PlanPoint]) -> Vec<Route> {
        let (Some(own), Some(at)) = (self.spec.vehicles.last(), self.world.sites.last()) else {
            return Vec::new();
        };
        let mut pieces = Vec::new();
        let mut rest = path;
        for point in &at.stops {
            let is_there = |of: &PlanPoint| of.distance_m(*point) < self.spec.mission.tolerance_m;
            let Some(end) = rest.iter().position(is_there) else {
                return vec![self.route(state, path)];
            };
            pieces.push(&rest[..=end]);
            rest = &rest[end..];
        }
        pieces.push(rest);
        let mut routes: Vec<Route> = Vec::new();
        for (number, piece) in pieces.into_iter().enumerate() {
            let mut route = self.route(state, piece);
            if let Some(before) = routes.last() {
                let begin = (before.end_s() + own.rest_after_s(number - 1), 0.0);
                route.path = time_route_from(piece, begin, own.speed_mps, own.accel_mps2);
            }
            routes.push(route);
        }
        routes
    }

    /// A path of the last vehicle that was added, timed from its departure.
    fn route(&self, state: &VehicleState, path: &[PlanPoint]) -> Route {
        let vehicle = self.vehicle(state);
        let departure = self.world.sites.last().map(|of| of.departure);
        let begin = match departure.unwrap_or_default() {
            Departure::Airborne {
                at_s, speed_mps, ..
            } => (at_s, speed_mps),
            Departure::Ground => (vehicle.depart_s, 0.0),
        };
        Route {
            control_points: Vec::new(),
            path: time_route_from(path, begin, vehicle.speed_mps, vehicle.accel_mps2),
        }
    }

    /// Adds a vehicle with a new path from where it branches off its present one.
    fn add_diverted(
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

    /// Judges the whole fleet, and takes the times of the new plans from the verdict.
    fn judge(self, mut new: Vec<NewMission>) -> Replanned {
        let judged: Vec<(usize, &VehicleMission)> = self.missions.iter().enumerate().collect();
        let mut review = verify::review(&self.spec, &self.world, &judged);
        // Off its place is better than through a threat; the flight is judged by where it lands.
        let fleet = &self.spec.vehicles;
        review
            .margins
            .retain(|margin| !is_driven_off(margin, fleet));
        let meets_return = !self.returns_met.is_empty();
        review.margins.splice(0..0, self.returns_met);
        review.margins.extend(self.problems);
        let others = self.missions.len() - new.len().min(self.missions.len());
        for (new, index) in new.iter_mut().zip(others..) {
            if let (Some(mission), Some(track)) =
                (self.missions.get(index), review.tracks.get(index))
            {
                let judged = ReferenceTrajectory::new(mission, track, &self.world);
                new.time(&judged, head_len(&mission.items), self.given.now_s);
            }
        }
        for margin in &mut review.margins {
            let Some(at) = &mut margin.at else { continue };
            let mut vehicles = self.spec.vehicles.iter();
            let of = vehicles.position(|vehicle| vehicle.id == margin.vehicle);
            if let Some((current, rows)) = of.and_then(|of| self.rows.get(of)) {
                let row = at.item.checked_sub(1).and_then(|row| rows.get(row));
                at.item = *row.unwrap_or(current);
            }
        }
        Replanned {
            missions: new,
            review,
            has_buffers: true,
            meets_return,
        }
    }
}

/// Whether a vehicle misses the place of its landing because the wind from behind may drive it off alone.
fn is_driven_off(margin: &Margin, fleet: &[Vehicle]) -> bool {
    let vehicle = fleet.iter().find(|vehicle| vehicle.id == margin.vehicle);
    let drift_m = vehicle.map_or(0.0, |vehicle| vehicle.landing_drift_m(None));
    let is_finish = margin.limit == Limit::Finish && !margin.ok;
    is_finish && margin.value - drift_m <= margin.bound
}

/// The ground below a point; where there is no data it is not a number, and nothing passes.
fn ground(world: &World, point: PlanPoint) -> Amsl {
    let place = world.frame.from_plan(point.at);
    world.terrain.height(place).unwrap_or(Amsl(f64::NAN))
}

//! New paths for the vehicles that meet a threat, and the verdict on the whole fleet together.
//!
//! The spec and the world of a joint plan hold the fleet as it is now: every vehicle in the air
//! departs from where it is. The verdict judges the items that a vehicle has ahead: those that it
//! retains and the new ones.

mod diverted;
mod returns;
mod stays;
mod unaffected;
mod verdict;

use self::stays::on_way_ahead;
use super::assessment::{Assessment, NoPath};
use super::new_mission::NewMission;
use super::state::VehicleState;
use crate::geodesy::{Amsl, PlanPoint};
use crate::mission::VehicleMission;
use crate::path::{Departure, time_route_from};
use crate::plan::{FleetPlan, Route, VehiclePlan};
use crate::spec::{AltitudeReference, Buffers, Finish, MissionSpec, Order, Vehicle};
use crate::verify::{Limit, Margin, Review};
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
                let speed_mps = own.on_route(number).speed_mps;
                route.path = time_route_from(piece, begin, speed_mps, own.accel_mps2);
            }
            routes.push(route);
        }
        routes
    }

    /// A path of the last vehicle that was added, timed from its departure at the speed that it has
    /// by then: a stop behind it may have set another one than the spec.
    fn route(&self, state: &VehicleState, path: &[PlanPoint]) -> Route {
        let added = self.spec.vehicles.last();
        let vehicle = added.unwrap_or_else(|| self.vehicle(state));
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
}

/// The ground below a point; where there is no data it is not a number, and nothing passes.
fn ground(world: &World, point: PlanPoint) -> Amsl {
    let place = world.frame.from_plan(point.at);
    world.terrain.height(place).unwrap_or(Amsl(f64::NAN))
}

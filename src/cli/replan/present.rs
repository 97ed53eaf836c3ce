//! New paths for those who meet the threat, and the verdict on all of them together.
//!
//! Planning and verdict know flights from the ground up. A vehicle in the air is given to
//! them as one that takes off right below where it is, so early that it is there now: from
//! there on everything is as it will be flown. What is verified of a vehicle are the items
//! that it has before it, those that it keeps and the new ones.

mod kept;
mod origin;

use super::course::{Course, Parting};
use super::renewed::{Renewed, Replanned, head_len};
use super::situation::{GivenUp, Situation};
use crate::cost::Margins;
use crate::flight::Reference;
use crate::geodesy::{Amsl, PlanPoint};
use crate::mission::{self, Item, VehicleMission};
use crate::path::{TimedPoint, route_start_s, time_route};
use crate::plan::{FleetPlan, Request, Route, VehiclePlan, replan_from};
use crate::spec::{AltitudeReference, EndPoint, Finish, MissionSpec, Placement, Vehicle};
use crate::verify::{self, Limit, Margin};
use crate::world::{Stations, World};
use origin::Origin;

/// Evaluations for each leg: a new path is wanted now.
const EVALUATIONS: usize = 6000;
/// What is kept in hand of every distance, in tolerances of the mission: waypoint legs may
/// leave the path by one. What fails is planned again with more.
const HANDS: [f64; 3] = [1.5, 3.0, 6.0];

/// Plans the concerned around the threat and around everyone else, and judges all of it. Those
/// for whom there is no path keep their course, so that the others have one.
pub(super) fn replan(situation: &mut Situation<'_>, given_up: &mut GivenUp) -> Replanned {
    loop {
        let mut hands = HANDS.into_iter();
        let mut found = Present::of(situation).replan(hands.next().unwrap_or(1.0));
        for hand in hands {
            if situation.is_sound(&found.review) {
                break;
            }
            found = Present::of(situation).replan(hand);
        }
        if situation.is_sound(&found.review) || !situation.give_up(&found.review, given_up) {
            situation.leave_to_the_plan(&mut found.review);
            situation.name_what_is_broken(&found.review);
            return found;
        }
    }
}

/// The spec and the world as they are now, vehicle by vehicle.
struct Present<'a> {
    given: &'a Situation<'a>,
    spec: MissionSpec,
    world: World,
    plan: FleetPlan,
    missions: Vec<VehicleMission>,
    origins: Vec<Origin>,
    problems: Vec<Margin>,
    /// Now, on the clock of the verdict: everyone has had the time to rise.
    now_s: f64,
}

impl<'a> Present<'a> {
    fn of(given: &'a Situation<'a>) -> Self {
        let (spec, world) = (&given.sorties.file.spec, &given.sorties.world);
        let mut present = Self {
            given,
            spec: MissionSpec {
                vehicles: Vec::new(),
                ..spec.clone()
            },
            world: world.clone(),
            plan: FleetPlan {
                seed: given.seed.unwrap_or(spec.planner.seed),
                vehicles: Vec::new(),
            },
            missions: Vec::new(),
            origins: Vec::new(),
            problems: Vec::new(),
            now_s: 0.0,
        };
        present.world.stations.clear();
        // Altitudes above home would be above a home that is none.
        present.spec.mission.altitude = AltitudeReference::Amsl;
        present.spec.planner.evaluations = EVALUATIONS.min(spec.planner.evaluations);
        let climb_s = |course: &Course| {
            let height_m = course.here.amsl.0 - ground(world, course.here).0;
            height_m.max(0.0) / spec.vehicles[course.vehicle].climb_mps
        };
        let all = given
            .others
            .iter()
            .chain(given.concerned.iter().map(|of| &of.0));
        let longest_s = all.map(climb_s).fold(0.0, f64::max);
        present.now_s = longest_s.ceil() + 1.0;
        present
    }

    fn replan(mut self, hand: f64) -> Replanned {
        let given = self.given;
        for course in &given.others {
            if course.stands {
                self.keep_standing(course);
            } else if course.in_mission {
                self.keep(course);
            } else {
                self.keep_place(course);
            }
        }
        let mut renewed = Vec::new();
        for (course, parting) in &given.concerned {
            renewed.extend(self.renew(course, parting, hand));
        }
        self.judge(renewed)
    }

    fn vehicle(&self, course: &Course) -> &'a Vehicle {
        &self.given.sorties.file.spec.vehicles[course.vehicle]
    }

    fn problem(&mut self, course: &Course, limit: Limit, why: impl Into<String>) {
        let id = &self.vehicle(course).id;
        self.problems.push(Margin::unjudged(id, limit, why));
    }

    /// A vehicle that flies from one point to another, and is at the first at a time.
    fn add(
        &mut self,
        vehicle: &Vehicle,
        (from, to): (PlanPoint, PlanPoint),
        lands: bool,
        at_s: f64,
    ) {
        let end = |point: PlanPoint| EndPoint {
            place: self.world.frame.from_plan(point.at),
            altitude: Placement::Amsl(point.amsl),
        };
        let stations = Stations {
            home: PlanPoint {
                amsl: ground(&self.world, from),
                ..from
            },
            start: from,
            goal: to,
            landing: to.at,
            goal_ground: ground(&self.world, to),
        };
        let mut added = Vehicle {
            home: self.world.frame.from_plan(from.at),
            start: end(from),
            goal: end(to),
            finish: if lands { Finish::Land } else { Finish::Loiter },
            depart_s: 0.0,
            ..vehicle.clone()
        };
        added.depart_s = (at_s - route_start_s(&added, &stations)).max(0.0);
        self.spec.vehicles.push(added);
        self.world.stations.push(stations);
    }

    fn drop_last(&mut self) {
        self.spec.vehicles.pop();
        self.world.stations.pop();
    }

    /// Takes the last vehicle that was added into the fleet, with its way and its items.
    fn settle(&mut self, routes: Vec<Route>, mission: VehicleMission, origin: Origin) {
        let (depart_s, speed_mps) = self
            .spec
            .vehicles
            .last()
            .map_or((0.0, 0.0), |added| (added.depart_s, added.speed_mps));
        self.plan.vehicles.push(VehiclePlan {
            depart_s,
            speed_mps,
            routes,
            ..VehiclePlan::default()
        });
        self.missions.push(mission);
        self.origins.push(origin);
    }

    fn route(&self, course: &Course, path: &[PlanPoint], at_s: f64) -> Route {
        let vehicle = self.vehicle(course);
        Route {
            control_points: Vec::new(),
            path: time_route(path, at_s, vehicle.speed_mps, vehicle.accel_mps2),
        }
    }

    /// The last vehicle that was added as it takes off: delay, takeoff, speed. The items
    /// that follow are another's.
    fn head(&self, routes: &[Vec<TimedPoint>]) -> Result<VehicleMission, mission::MissionError> {
        let index = self.spec.vehicles.len().saturating_sub(1);
        let mut built =
            mission::build_course(&self.spec, &self.world, index, routes, routes.len())?;
        built.items.truncate(head_len(&built.items));
        Ok(built)
    }

    /// A new path from where a concerned vehicle parts from its course.
    fn renew(&mut self, course: &Course, parting: &Parting, hand: f64) -> Option<Renewed> {
        let vehicle = self.vehicle(course);
        let now_s = self.now_s;
        let at_s = now_s + parting.way_m / vehicle.speed_mps;
        let mut legs = self.search(course, parting, at_s, hand);
        let kept: Vec<PlanPoint> = course.points().into_iter().take(parting.kept + 1).collect();
        let turn = kept.last().copied().unwrap_or(course.here);
        let last = legs.last().and_then(|leg| leg.last()).copied()?;
        legs.first_mut()?.insert(0, turn);
        // The new items begin where the last one that is kept lies.
        self.add(vehicle, (turn, last), course.lands, at_s);
        let index = self.spec.vehicles.len() - 1;
        let routes: Vec<Vec<TimedPoint>> = legs
            .iter()
            .map(|leg| self.route(course, leg, at_s).path)
            .collect();
        let built = mission::build_course(&self.spec, &self.world, index, &routes, routes.len());
        self.drop_last();
        self.add(vehicle, (course.here, last), course.lands, now_s);
        let straight = self.route(course, &[course.here, last], now_s).path;
        let (built, head) = match built.and_then(|built| Ok((built, self.head(&[straight])?))) {
            Ok(found) => found,
            Err(error) => {
                self.drop_last();
                self.problem(course, Limit::Encoding, error.to_string());
                return None;
            }
        };
        let mut new: Vec<Item> = built.items[head_len(&built.items)..].to_vec();
        let renewed = Renewed::new(course, parting, &head, &mut new, &self.world);
        let mut judged = head;
        let mut rows = vec![course.at + 1; judged.items.len()];
        judged.items.extend(course.items_kept(parting));
        judged.items.extend(new);
        let first = renewed.as_ref().map_or(0, |renewed| renewed.ahead);
        rows.extend((first + 1..).take(judged.items.len() - rows.len()));
        let whole: Vec<PlanPoint> = kept
            .into_iter()
            .chain(legs.concat().into_iter().skip(1))
            .collect();
        let route = self.route(course, &whole, now_s);
        self.settle(vec![route], judged, Origin::new(course, now_s, rows));
        if renewed.is_none() {
            let why = "its items ahead are not one after the other";
            self.problem(course, Limit::ItemsAhead, why);
        }
        renewed
    }

    /// New paths, leg by leg, around those that are in the fleet already.
    fn search(
        &mut self,
        course: &Course,
        parting: &Parting,
        mut at_s: f64,
        hand: f64,
    ) -> Vec<Vec<PlanPoint>> {
        let hand_m = hand * self.spec.mission.tolerance_m;
        let margins = Margins {
            clearance_m: hand_m,
            threat_m: hand_m,
            separation_m: 2.0 * hand_m,
            shift_s: 0.0,
            turn_fraction: 0.1,
            climb_fraction: 0.05,
        };
        let legs = course.legs(parting);
        let mut paths = Vec::new();
        for (number, leg) in legs.iter().enumerate() {
            let is_last = number + 1 == legs.len();
            self.add(self.vehicle(course), *leg, is_last && course.lands, at_s);
            let request = Request {
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
            at_s = timed.last().map_or(at_s, |last| last.t_s);
            paths.push(timed.iter().map(|timed| timed.point).collect());
        }
        paths
    }

    /// Judges everyone together, and times the new plans by that.
    fn judge(self, mut renewed: Vec<Renewed>) -> Replanned {
        let judged: Vec<(usize, &VehicleMission)> = self.missions.iter().enumerate().collect();
        let mut review = verify::review(&self.spec, &self.world, &judged);
        review.margins.extend(self.problems);
        let others = self.missions.len() - renewed.len().min(self.missions.len());
        let shift_s = self.given.now_s - self.now_s;
        for (renewed, index) in renewed.iter_mut().zip(others..) {
            if let (Some(mission), Some(track)) =
                (self.missions.get(index), review.tracks.get(index))
            {
                let judged = Reference::new(mission, track, &self.world);
                let head = head_len(&mission.items);
                renewed.time(&judged, head, (self.given.now_s, shift_s), &self.world);
            }
        }
        // From here on items, places and times are those of the flight.
        for margin in &mut review.margins {
            let Some(at) = &mut margin.at else { continue };
            let mut vehicles = self.spec.vehicles.iter();
            let of = vehicles.position(|vehicle| vehicle.id == margin.vehicle);
            if let Some(origin) = of.and_then(|of| self.origins.get(of)) {
                origin.moment(at);
            }
            at.t_s += shift_s;
        }
        Replanned { renewed, review }
    }
}

/// The ground below a point; no data is not a number, and then nothing passes.
fn ground(world: &World, point: PlanPoint) -> Amsl {
    let place = world.frame.from_plan(point.at);
    world.terrain.height(place).unwrap_or(Amsl(f64::NAN))
}

//! What a vehicle in flight has before it, and its new path.
//!
//! Planning and verdict know flights from the ground up. A vehicle in the air is given to
//! them as one that takes off right below where it will be, so early that it is there at
//! that time: from there on everything is as it will be flown.

use crate::cli::fly::Sorties;
use crate::cost::Margins;
use crate::flight::Reference;
use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::link::Onboard;
use crate::mission::{self, VehicleMission, command};
use crate::path::{TimedPoint, route_start_s, time_route};
use crate::plan::{FleetPlan, Request, Route, VehiclePlan, replan_from};
use crate::spec::{
    AltitudeReference, Autopilot, EndPoint, Finish, MissionSpec, Placement, Threat, Vehicle,
};
use crate::verify::{self, Margin, Review, Track};
use crate::world::{Disc, Stations, World};

/// Evaluations for each leg: a new path is wanted now.
const EVALUATIONS: usize = 6000;
/// Less way than this before it, and a vehicle is at its end, metres.
const LEAST_WAY_M: f64 = 100.0;

/// What one vehicle has before it.
pub(super) struct Course {
    /// Its index in the spec.
    pub(super) vehicle: usize,
    /// Where the new path may begin, and every place after it, in the air.
    points: Vec<PlanPoint>,
    /// Whether it lands at the last of them.
    lands: bool,
    /// Index into `points` of the goal of the spec, if it must be passed on the way.
    via: Option<usize>,
    /// Whether it would meet the threat.
    pub(super) is_concerned: bool,
}

/// The new missions of those concerned, by the index of their vehicle.
pub(super) struct Replanned {
    pub(super) missions: Vec<(usize, VehicleMission)>,
    pub(super) review: Review,
}

impl Course {
    /// From what a vehicle holds, the item it flies to, and where it is.
    /// `None` when it has no way before it.
    pub(super) fn new(
        sorties: &Sorties,
        vehicle: usize,
        planned: &VehicleMission,
        (onboard, seq): (&Onboard, u16),
        here: PlanPoint,
        lead_s: f64,
        (center, radius_m): (EastNorth, f64),
    ) -> Option<Self> {
        let held = VehicleMission {
            items: onboard.mission.clone(),
            ..planned.clone()
        };
        let first = usize::from(planned.autopilot == Autopilot::Px4);
        let row = usize::from(seq) + first;
        let nowhen = Track {
            vehicle: String::new(),
            moments: Vec::new(),
        };
        let reference = Reference::new(&held, &nowhen, &sorties.world);
        let ahead = reference.waypoints.iter().filter(|w| w.item >= row);
        let mut points: Vec<PlanPoint> = std::iter::once(here)
            .chain(ahead.map(|waypoint| waypoint.point))
            .collect();
        if reference.lands && points.len() > 1 {
            // The last one is on the ground.
            let ground = points.pop()?;
            let last = *points.last()?;
            if last.at.distance_m(ground.at) > 1.0 {
                points.push(PlanPoint {
                    at: ground.at,
                    ..last
                });
            }
        }
        let meets = points
            .windows(2)
            .any(|pair| away_m(center, pair[0].at, pair[1].at) < radius_m);
        let spec = &sorties.file.spec.vehicles[vehicle];
        let points = after(points, lead_s * spec.speed_mps);
        let way_m: f64 = points.windows(2).map(|p| p[0].distance_m(p[1])).sum();
        if way_m < LEAST_WAY_M {
            return None;
        }
        let goal = sorties.world.stations.get(vehicle)?.goal;
        let via = points.iter().position(|point| point.distance_m(goal) < 2.0);
        let via = via.filter(|index| {
            spec.finish == Finish::Return && *index > 0 && index + 1 < points.len()
        });
        Some(Self {
            vehicle,
            points,
            lands: reference.lands,
            via,
            is_concerned: meets,
        })
    }

    /// The legs that are planned anew, end to end.
    fn legs(&self) -> Vec<(PlanPoint, PlanPoint)> {
        let (Some(&first), Some(&last)) = (self.points.first(), self.points.last()) else {
            return Vec::new();
        };
        match self.via.and_then(|index| self.points.get(index)) {
            Some(&via) => vec![(first, via), (via, last)],
            None => vec![(first, last)],
        }
    }
}

/// What is left of a way after some metres of it.
fn after(points: Vec<PlanPoint>, mut gone_m: f64) -> Vec<PlanPoint> {
    for (index, pair) in points.windows(2).enumerate() {
        let length_m = pair[0].distance_m(pair[1]);
        if gone_m < length_m {
            let share = gone_m / length_m;
            let mix = |a: f64, b: f64| a + (b - a) * share;
            let first = PlanPoint::new(
                mix(pair[0].at.east_m, pair[1].at.east_m),
                mix(pair[0].at.north_m, pair[1].at.north_m),
                Amsl(mix(pair[0].amsl.0, pair[1].amsl.0)),
            );
            let rest = points.iter().skip(index + 1).copied();
            return std::iter::once(first).chain(rest).collect();
        }
        gone_m -= length_m;
    }
    points.last().copied().into_iter().collect()
}

/// Distance of a point of the plane from a way, metres.
fn away_m(from: EastNorth, a: EastNorth, b: EastNorth) -> f64 {
    let (east, north) = (b.east_m - a.east_m, b.north_m - a.north_m);
    let length_sq = east * east + north * north;
    let gone = (from.east_m - a.east_m) * east + (from.north_m - a.north_m) * north;
    let share = if length_sq > 0.0 {
        (gone / length_sq).clamp(0.0, 1.0)
    } else {
        0.0
    };
    from.distance_m(EastNorth {
        east_m: a.east_m + share * east,
        north_m: a.north_m + share * north,
    })
}

/// The spec and the world as they are now, vehicle by vehicle.
struct Present {
    spec: MissionSpec,
    world: World,
    plan: FleetPlan,
}

/// What is kept in hand of every distance, in tolerances of the mission: waypoint legs may
/// leave the path by one. What fails is planned again with more.
const HANDS: [f64; 3] = [1.5, 3.0, 6.0];

/// Plans the concerned around the threat and around everyone else, and judges all of it.
pub(super) fn replan(
    sorties: &Sorties,
    threat: &Threat,
    courses: &[Course],
    seed: Option<u64>,
) -> Replanned {
    let mut hands = HANDS.into_iter();
    let mut found = replan_with(sorties, threat, courses, seed, hands.next().unwrap_or(1.0));
    for hand in hands {
        if found.review.passes() {
            break;
        }
        found = replan_with(sorties, threat, courses, seed, hand);
    }
    found
}

fn replan_with(
    sorties: &Sorties,
    threat: &Threat,
    courses: &[Course],
    seed: Option<u64>,
    hand: f64,
) -> Replanned {
    let (spec, world) = (&sorties.file.spec, &sorties.world);
    let mut present = Present {
        spec: MissionSpec {
            vehicles: Vec::new(),
            ..spec.clone()
        },
        world: world.clone(),
        plan: FleetPlan {
            seed: seed.unwrap_or(spec.planner.seed),
            vehicles: Vec::new(),
        },
    };
    present.spec.threats.push(threat.clone());
    present.world.threats.push(Disc {
        center: world.frame.to_plan(threat.place),
        radius_m: threat.radius_m,
    });
    present.world.stations.clear();
    // Altitudes above home would be above a home that is none.
    present.spec.mission.altitude = AltitudeReference::Amsl;
    present.spec.planner.evaluations = EVALUATIONS.min(spec.planner.evaluations);
    let climbs_s = courses.iter().map(|course| climb_s(sorties, course));
    let now_s = climbs_s.fold(0.0, f64::max);
    let (concerned, others): (Vec<&Course>, Vec<&Course>) =
        courses.iter().partition(|course| course.is_concerned);
    for course in &others {
        let path = course.points.clone();
        present.keep(sorties, course, &path, now_s);
    }
    for course in &concerned {
        let path = present.search(sorties, course, now_s, hand);
        present.keep(sorties, course, &path, now_s);
    }
    present.judge(&others, &concerned)
}

/// How long a takeoff to the first point of a course takes, seconds.
fn climb_s(sorties: &Sorties, course: &Course) -> f64 {
    let vehicle = &sorties.file.spec.vehicles[course.vehicle];
    let height_m = course
        .points
        .first()
        .map_or(0.0, |first| first.amsl.0 - ground(&sorties.world, *first).0);
    height_m.max(0.0) / vehicle.climb_mps
}

/// The ground below a point; no data is not a number, and then nothing passes.
fn ground(world: &World, point: PlanPoint) -> Amsl {
    let place = world.frame.from_plan(point.at);
    world.terrain.height(place).unwrap_or(Amsl(f64::NAN))
}

impl Present {
    /// A vehicle that flies from one point to another, and is at the first at a time.
    fn add(
        &mut self,
        vehicle: &Vehicle,
        (from, to): (PlanPoint, PlanPoint),
        finish: Finish,
        at_s: f64,
    ) {
        let end = |point: PlanPoint| EndPoint {
            place: self.world.frame.from_plan(point.at),
            altitude: Placement::Amsl(point.amsl),
        };
        let home = PlanPoint {
            amsl: ground(&self.world, from),
            ..from
        };
        let stations = Stations {
            home,
            start: from,
            goal: to,
            landing: to.at,
            goal_ground: ground(&self.world, to),
        };
        let mut added = Vehicle {
            home: self.world.frame.from_plan(from.at),
            start: end(from),
            goal: end(to),
            finish,
            depart_s: 0.0,
            ..vehicle.clone()
        };
        added.depart_s = (at_s - route_start_s(&added, &stations)).max(0.0);
        self.spec.vehicles.push(added);
        self.world.stations.push(stations);
    }

    /// Takes a vehicle with its path into the fleet.
    fn keep(&mut self, sorties: &Sorties, course: &Course, path: &[PlanPoint], now_s: f64) {
        let (Some(&from), Some(&to)) = (path.first(), path.last()) else {
            return;
        };
        let vehicle = &sorties.file.spec.vehicles[course.vehicle];
        let finish = if course.lands {
            Finish::Land
        } else {
            Finish::Loiter
        };
        self.add(vehicle, (from, to), finish, now_s);
        self.plan.vehicles.push(VehiclePlan {
            routes: vec![Route {
                control_points: Vec::new(),
                path: time_route(path, now_s, vehicle.speed_mps, vehicle.accel_mps2),
            }],
            ..VehiclePlan::default()
        });
    }

    /// A new path for the next vehicle, around those that are in the fleet already.
    fn search(
        &mut self,
        sorties: &Sorties,
        course: &Course,
        now_s: f64,
        hand: f64,
    ) -> Vec<PlanPoint> {
        let hand_m = hand * self.spec.mission.tolerance_m;
        let margins = Margins {
            clearance_m: hand_m,
            threat_m: hand_m,
            separation_m: 2.0 * hand_m,
            turn_fraction: 0.1,
            climb_fraction: 0.05,
        };
        let vehicle = &sorties.file.spec.vehicles[course.vehicle];
        let mut path: Vec<PlanPoint> = Vec::new();
        let mut at_s = now_s;
        let legs = course.legs();
        for (number, leg) in legs.iter().enumerate() {
            let is_last = number + 1 == legs.len();
            let finish = if is_last && course.lands {
                Finish::Land
            } else {
                Finish::Loiter
            };
            self.add(vehicle, *leg, finish, at_s);
            let request = Request {
                seed: self.plan.seed,
                margins: vec![margins; self.spec.vehicles.len()],
                extra_parameters: Vec::new(),
                progress: &|_| {},
            };
            let first = self.plan.vehicles.len();
            let found = replan_from(&self.plan, first, &self.spec, &self.world, &request);
            self.spec.vehicles.pop();
            self.world.stations.pop();
            let routes = found.vehicles.get(first).map(VehiclePlan::path);
            let timed: Vec<TimedPoint> = routes.unwrap_or_default();
            at_s = timed.last().map_or(at_s, |last| last.t_s);
            path.extend(timed.iter().skip(usize::from(number > 0)).map(|t| t.point));
        }
        path
    }

    /// Encodes everyone's path, judges all of them together, and makes of the missions of
    /// the concerned what a vehicle in the air goes on with.
    fn judge(self, others: &[&Course], concerned: &[&Course]) -> Replanned {
        let mut missions = Vec::new();
        let mut problems = Vec::new();
        for (index, plan) in self.plan.vehicles.iter().enumerate() {
            let routes: Vec<Vec<TimedPoint>> =
                plan.routes.iter().map(|route| route.path.clone()).collect();
            match mission::build(&self.spec, &self.world, index, &routes) {
                Ok(mission) => missions.push((index, mission)),
                Err(error) => problems.push(Margin::unjudged(
                    &self.spec.vehicles[index].id,
                    "encoding",
                    error.to_string(),
                )),
            }
        }
        let judged: Vec<(usize, &VehicleMission)> = missions.iter().map(|(i, m)| (*i, m)).collect();
        let mut review = verify::review(&self.spec, &self.world, &judged);
        review.margins.extend(problems);
        let order: Vec<usize> = others.iter().chain(concerned).map(|c| c.vehicle).collect();
        let missions = missions
            .into_iter()
            .filter(|(index, _)| *index >= others.len())
            .filter_map(|(index, mission)| Some((*order.get(index)?, airborne(mission))))
            .collect();
        Replanned { missions, review }
    }
}

/// The mission for a vehicle that is in the air: its takeoff is a waypoint, and there is
/// no delay before it.
fn airborne(mut mission: VehicleMission) -> VehicleMission {
    mission
        .items
        .retain(|item| item.command != command::NAV_DELAY);
    for item in &mut mission.items {
        if item.command == command::NAV_TAKEOFF {
            item.command = command::NAV_WAYPOINT;
        }
    }
    mission
}

//! One vehicle: its routes, one after the other, among given flights.

use super::{Progress, Request};
use crate::cost::{CostTerms, Leg};
use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::numeric::{Basis, Seed};
use crate::path::{Flight, homeward_end, route_start_s, time_route_from, way_speed_mps};
use crate::plan::bound::estimate;
use crate::plan::search::route_context::Course;
use crate::plan::search::{Found, lifted, search};
use crate::plan::{Route, VehiclePlan};
use crate::spec::{Finish, MissionSpec, Vehicle};
use crate::world::{Stations, World};

/// Points of a planned path, spread evenly over the spline's parameter.
const PATH_POINTS: usize = 1001;

/// Where the routes of a vehicle begin and end.
fn legs(vehicle: &Vehicle, stations: &Stations) -> Vec<(PlanPoint, PlanPoint)> {
    let out = (stations.start, stations.goal);
    match vehicle.finish {
        Finish::Land | Finish::Loiter => vec![out],
        Finish::Return => vec![out, (stations.goal, homeward_end(vehicle, stations))],
    }
}

/// Plans the routes of one vehicle, one after the other; they share its budget.
///
/// `earlier` are the flights it has to keep apart from, those of the vehicles `avoids`.
/// The plan depends on what is given here and on nothing else: not on when or on which
/// thread it is made. `estimated` is the estimate of an earlier plan of the same vehicle:
/// other flights do not change it.
pub(crate) fn plan_vehicle(
    spec: &MissionSpec,
    world: &World,
    request: &Request<'_>,
    index: usize,
    avoids: Vec<usize>,
    earlier: &[Flight],
    estimated: Option<f64>,
) -> VehiclePlan {
    let legs = legs(&spec.vehicles[index], &world.stations[index]);
    let mut plan = empty(spec, index, avoids);
    for (stream, (from, to)) in (2 * to_u64(index)..).zip(legs.iter().copied()) {
        let leg = Leg {
            from,
            to,
            start_s: plan.ends_s(spec, world, index),
        };
        let course = course(spec, world, request, index, leg, earlier);
        let budget =
            (spec.planner.evaluations - plan.evaluations) / (legs.len() - plan.routes.len());
        let spent = plan.evaluations;
        let watch = |point: crate::optimize::TracePoint| {
            (request.progress)(Progress {
                vehicle: index,
                vehicles: spec.vehicles.len(),
                evaluations: spent + point.evaluations,
                budget: spec.planner.evaluations,
                best: point.best,
            });
        };
        let (found, estimate) = rayon::join(
            || search(&course, budget, Seed(request.seed), stream, &watch),
            || estimated.map_or_else(|| estimate(&course, budget), |_| 0.0),
        );
        plan.estimate += estimate;
        plan.add(&course, &found);
    }
    plan.estimate = estimated.unwrap_or(plan.estimate);
    plan
}

/// An old plan's ways in the plane at the altitudes that are now asked for, if they keep every
/// margin among the `earlier` flights.
pub(crate) fn lift_vehicle(
    spec: &MissionSpec,
    world: &World,
    request: &Request<'_>,
    index: usize,
    old: &VehiclePlan,
    earlier: &[Flight],
) -> Option<VehiclePlan> {
    let legs = legs(&spec.vehicles[index], &world.stations[index]);
    let mut plan = empty(spec, index, old.avoids.clone());
    for ((from, to), route) in legs.into_iter().zip(&old.routes) {
        let leg = Leg {
            from,
            to,
            start_s: plan.ends_s(spec, world, index),
        };
        let course = course(spec, world, request, index, leg, earlier);
        let inner = route.control_points.len().saturating_sub(1);
        let outline: Vec<EastNorth> = route
            .control_points
            .get(1..inner)?
            .iter()
            .map(|p| p.at)
            .collect();
        plan.add(&course, &lifted(&course, &outline)?);
    }
    plan.estimate = old.estimate;
    Some(plan)
}

/// A plan without routes.
fn empty(spec: &MissionSpec, index: usize, avoids: Vec<usize>) -> VehiclePlan {
    let vehicle = &spec.vehicles[index];
    VehiclePlan {
        depart_s: vehicle.depart_s,
        speed_mps: vehicle.speed_mps,
        routes: Vec::new(),
        terms: CostTerms::default(),
        bound: 0.0,
        estimate: 0.0,
        evaluations: 0,
        plans: 1,
        avoids,
        blocked_by: Vec::new(),
        cut_off_by: Vec::new(),
        remedies: None,
    }
}

fn course<'a>(
    spec: &'a MissionSpec,
    world: &'a World,
    request: &'a Request<'_>,
    index: usize,
    leg: Leg,
    earlier: &'a [Flight],
) -> Course<'a> {
    Course {
        world,
        spec,
        index,
        leg,
        earlier,
        margins: request.margins_of(index),
        extra: request.extra_parameters_of(index),
    }
}

impl VehiclePlan {
    /// When the last of its routes ends, or the first may begin, seconds after T0.
    fn ends_s(&self, spec: &MissionSpec, world: &World, index: usize) -> f64 {
        let last = self.routes.last().and_then(|route| route.path.last());
        last.map_or_else(
            || route_start_s(&spec.vehicles[index], &world.stations[index]),
            |last| last.t_s,
        )
    }

    /// Adds what was found for its next leg.
    fn add(&mut self, course: &Course<'_>, found: &Found) {
        self.bound += course.bound();
        self.terms = sum(&self.terms, &found.terms);
        self.evaluations += found.evaluations;
        self.routes.push(route(course, found));
    }
}

fn to_u64(index: usize) -> u64 {
    u64::try_from(index).unwrap_or(u64::MAX / 4)
}

/// A found spline as a timed path.
fn route(course: &Course<'_>, found: &Found) -> Route {
    let basis = Basis::new(course.controls(), &course.parameters(PATH_POINTS));
    let east_m = basis.sampled(&found.spline.east_m);
    let north_m = basis.sampled(&found.spline.north_m);
    let amsl_m = basis.sampled(&found.spline.amsl_m);
    let mut points: Vec<PlanPoint> = east_m
        .into_iter()
        .zip(north_m)
        .zip(amsl_m)
        .map(|((east, north), amsl)| PlanPoint::new(east, north, Amsl(amsl)))
        .collect();
    if let Some(first) = points.first_mut() {
        *first = course.leg.from;
    }
    if let Some(last) = points.last_mut() {
        *last = course.leg.to;
    }
    let departure = course.world.stations[course.index].departure;
    Route {
        control_points: found.spline.points(),
        path: time_route_from(
            &points,
            (course.leg.start_s, departure.speed_at_mps(course.leg.from)),
            way_speed_mps(course.vehicle(), course.leg.from, course.leg.to),
            course.vehicle().accel_mps2,
        ),
    }
}

/// Term by term.
pub(crate) fn sum(a: &CostTerms, b: &CostTerms) -> CostTerms {
    CostTerms {
        length: a.length + b.length,
        altitude: a.altitude + b.altitude,
        threat: a.threat + b.threat,
        terrain: a.terrain + b.terrain,
        turn: a.turn + b.turn,
        climb: a.climb + b.climb,
        collision: a.collision + b.collision,
    }
}

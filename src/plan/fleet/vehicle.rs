//! One vehicle: its routes, one after the other, among given flights.

use super::{Planning, Progress};
use crate::cost::{CostTerms, EarlierFlights, RouteEnds};
use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::numeric::{Basis, Seed};
use crate::optimize::TracePoint;
use crate::path::{route_ends, route_start_s, time_route_from, way_speed_mps};
use crate::plan::bound::estimate;
use crate::plan::route_context::{RouteContext, on_route};
use crate::plan::search::{Found, Run, lifted, search, straight};
use crate::plan::spline::Spline;
use crate::plan::{Route, VehiclePlan};
use crate::spec::{Arrival, MissionSpec};

/// Points of a planned path, spread evenly over the spline's parameter.
const PATH_POINTS: usize = 1001;
/// Points for each control point, where that makes more.
const POINTS_PER_CONTROL: usize = 24;

/// The random stream of a route. A vehicle has two to itself; further routes have their own far
/// behind those.
fn stream(index: usize, route: usize) -> u64 {
    const FURTHER: u64 = 1 << 40;
    const EACH: u64 = 1 << 10;
    match route {
        0 | 1 => 2 * to_u64(index) + to_u64(route),
        _ => FURTHER + EACH * to_u64(index) + to_u64(route),
    }
}

impl<'a> Planning<'a> {
    /// Plans the routes of one vehicle, one after the other; they share its budget.
    ///
    /// `earlier` are the flights to keep apart from, those of the vehicles `avoids`. The plan is a
    /// function of what is given here: not of when or on which thread it is made. `estimated` is
    /// the estimate of an earlier plan of the same vehicle: other flights do not change it.
    pub(crate) fn plan_vehicle(
        &self,
        index: usize,
        avoids: Vec<usize>,
        earlier: &EarlierFlights,
        estimated: Option<f64>,
    ) -> VehiclePlan {
        let (spec, request) = (self.spec, self.request);
        let routes = route_ends(&spec.vehicles[index], &self.world.sites[index]);
        let mut plan = self.empty_plan(index, avoids);
        plan.is_detour = !earlier.is_empty();
        let arrivals = spec.vehicles[index].arrivals(routes.len());
        // Those that are straight by their nature take none of the budget.
        let is_searched = |arrival: &Arrival| *arrival == Arrival::Planned;
        let searched = arrivals
            .iter()
            .filter(|arrival| is_searched(arrival))
            .count();
        let mut begun = 0;
        for (number, &(from, to)) in routes.iter().enumerate() {
            let spec = &*on_route(spec, index, number);
            let context = self.context(spec, index, (from, to), &plan, earlier);
            if let Some(found) = unsearched(&context, arrivals[number]) {
                plan.add(&context, &found);
                continue;
            }
            // A route through corridors may take more than its share.
            let share = spec.planner.evaluations / searched.max(1) * begun;
            let spent = plan.evaluations.min(share).min(spec.planner.evaluations);
            let left = searched.saturating_sub(begun).max(1);
            let budget = (spec.planner.evaluations - spent) / left;
            begun += usize::from(is_searched(&arrivals[number]));
            let watch = |point: TracePoint| {
                (request.progress)(Progress {
                    vehicle: index,
                    vehicles: spec.vehicles.len(),
                    evaluations: spent + point.evaluations,
                    budget: spec.planner.evaluations,
                    best: point.best,
                });
            };
            let run = Run {
                budget,
                seed: Seed(request.seed),
                stream: stream(index, number),
                classes: self.classes.map(|known| (known, number)),
                known: request.known,
                watch: &watch,
            };
            let (found, estimate) = rayon::join(
                || search(&context, run),
                || estimated.map_or_else(|| estimate(&context, budget), |_| 0.0),
            );
            plan.estimate += estimate;
            plan.add(&context, &found);
        }
        plan.estimate = estimated.unwrap_or(plan.estimate);
        self.meet(index, &mut plan);
        plan
    }

    /// The plan of one vehicle without any other.
    pub(crate) fn plan_alone(&self, index: usize, estimate: f64) -> VehiclePlan {
        self.plan_vehicle(index, Vec::new(), EarlierFlights::none(), Some(estimate))
    }

    /// The lines of an old plan in the plane at the altitudes now required, if they keep every
    /// margin among the `earlier` flights.
    pub(crate) fn lift_vehicle(
        &self,
        index: usize,
        old: &VehiclePlan,
        earlier: &EarlierFlights,
    ) -> Option<VehiclePlan> {
        let routes = route_ends(&self.spec.vehicles[index], &self.world.sites[index]);
        if old.routes.len() != routes.len() {
            return None;
        }
        let mut plan = VehiclePlan {
            is_detour: old.is_detour,
            ..self.empty_plan(index, old.avoids.clone())
        };
        for (number, (ends, route)) in routes.into_iter().zip(&old.routes).enumerate() {
            let spec = &*on_route(self.spec, index, number);
            let context = self.context(spec, index, ends, &plan, earlier);
            let inner = route.control_points.len().saturating_sub(1);
            let free = route.control_points.get(1..inner)?.iter();
            let outline: Vec<EastNorth> = free.map(|point| point.at).collect();
            plan.add(&context, &lifted(&context, &outline)?);
        }
        plan.estimate = old.estimate;
        self.meet(index, &mut plan);
        Some(plan)
    }

    /// A plan without routes.
    pub(super) fn empty_plan(&self, index: usize, avoids: Vec<usize>) -> VehiclePlan {
        let vehicle = &self.spec.vehicles[index];
        VehiclePlan {
            depart_s: self.depart_s.unwrap_or(vehicle.depart_s),
            speed_mps: vehicle.speed_mps,
            plans: 1,
            avoids,
            ..VehiclePlan::default()
        }
    }

    /// The context of the next route of a plan, at the speed that a spec has for it.
    pub(super) fn context<'c>(
        &'c self,
        spec: &'c MissionSpec,
        index: usize,
        (from, to): (PlanPoint, PlanPoint),
        plan: &VehiclePlan,
        earlier: &'c EarlierFlights,
    ) -> RouteContext<'c> {
        let (vehicle, sites) = (&self.spec.vehicles[index], &self.world.sites[index]);
        let start_s = match plan.routes.as_slice() {
            [] => match self.depart_s {
                None => route_start_s(vehicle, sites),
                Some(depart_s) => {
                    let mut vehicle = vehicle.clone();
                    vehicle.depart_s = depart_s;
                    route_start_s(&vehicle, sites)
                }
            },
            [before @ .., last] => last.end_s() + vehicle.rest_after_s(before.len()),
        };
        let mut context = RouteContext {
            spec,
            ..self.route_context(index, RouteEnds { from, to, start_s }, earlier)
        };
        if let Some(Arrival::OnLine(agl)) = vehicle
            .stops
            .get(plan.routes.len())
            .map(|stop| stop.arrives)
        {
            let above_m = agl.0 - self.world.min_agl.0;
            context.margins.clearance_m = context.margins.clearance_m.max(above_m);
            context.margins.line_m = above_m.max(0.0);
        }
        context
    }
}

impl VehiclePlan {
    /// Adds what was found for its next leg.
    pub(super) fn add(&mut self, context: &RouteContext<'_>, found: &Found) {
        self.terms = sum(&self.terms, &found.terms);
        self.evaluations += found.evaluations;
        let basis = path_basis(context, found.spline.east_m.len());
        self.routes.push(route(context, &found.spline, &basis));
    }
}

/// A route that need not be searched: a line over the ground, and a straight route where nothing
/// is in its way.
fn unsearched(context: &RouteContext<'_>, arrival: Arrival) -> Option<Found> {
    match arrival {
        Arrival::Planned => None,
        Arrival::Straight => Some(straight(context)).filter(|found| found.strict.is_clean()),
        Arrival::Exact => Some(straight(&context.as_exact())),
        Arrival::OnLine(_) => Some(straight(context)),
    }
}

fn to_u64(index: usize) -> u64 {
    u64::try_from(index).unwrap_or(u64::MAX / 4)
}

/// At the points of a path of some control points.
pub(super) fn path_basis(context: &RouteContext<'_>, controls: usize) -> Basis {
    let points = PATH_POINTS.max(POINTS_PER_CONTROL * controls + 1);
    Basis::new(controls, &context.parameters(points))
}

/// A spline as a timed path.
pub(super) fn route(context: &RouteContext<'_>, spline: &Spline, basis: &Basis) -> Route {
    let east_m = basis.sampled(&spline.east_m);
    let north_m = basis.sampled(&spline.north_m);
    let amsl_m = basis.sampled(&spline.amsl_m);
    let mut points: Vec<PlanPoint> = east_m
        .into_iter()
        .zip(north_m)
        .zip(amsl_m)
        .map(|((east, north), amsl)| PlanPoint::new(east, north, Amsl(amsl)))
        .collect();
    if let Some(first) = points.first_mut() {
        *first = context.ends.from;
    }
    if let Some(last) = points.last_mut() {
        *last = context.ends.to;
    }
    let departure = context.world.sites[context.index].departure;
    Route {
        control_points: spline.points(),
        path: time_route_from(
            &points,
            (
                context.ends.start_s,
                departure.speed_at_mps(context.ends.from),
            ),
            way_speed_mps(context.vehicle(), context.ends.from, context.ends.to),
            context.vehicle().accel_mps2,
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

//! Where a vehicle rests on its way so that it need not turn.

use super::{Planning, Request};
use crate::cost::{CostTerms, EarlierFlights, Margins, RouteEnds};
use crate::geodesy::PlanPoint;
use crate::numeric::as_f64;
use crate::path::route_ends;
use crate::plan::VehiclePlan;
use crate::plan::route_context::{RouteContext, on_route};
use crate::plan::search::corridor::{MIN_BUDGET, is_far_from_bound};
use crate::plan::search::judged_route;
use crate::plan::search::rests::{Rests, rests};
use crate::spec::{MissionSpec, Vehicle};
use crate::world::World;

/// A way with rests counts where it costs less than this share of one without.
const WORTH: f64 = 0.98;
/// And where it takes less than this many times as long.
const LONGER: f64 = 1.2;

/// How far a copter flies in the time that a rest takes, metres: to come to rest, the rest itself, and to be at its speed
/// again.
fn rest_m(vehicle: &Vehicle) -> f64 {
    const REST_S: f64 = 1.0;
    let speed_mps = vehicle.speed_mps;
    speed_mps * (REST_S + speed_mps / vehicle.accel_mps2)
}

/// Places at which a vehicle rests on each of its routes, where its plan breaks limits or costs far more than it has
/// to; none where that makes nothing better. `fails` says that the verdict on its plan does not hold.
pub(crate) fn rests_of(
    (spec, world): (&MissionSpec, &World),
    (index, plan): (usize, &VehiclePlan),
    (fails, margins): (bool, Margins),
) -> Option<Vec<Vec<PlanPoint>>> {
    let request = Request {
        margins: vec![margins; spec.vehicles.len()],
        ..Request::new(spec.planner.seed)
    };
    let planning = Planning::new(spec, world, &request).of(index);
    let ends = route_ends(&spec.vehicles[index], &world.sites[index]);
    // What it pays for others is no want of space to turn; and more evaluations may find a way without rests.
    let is_enough = plan.is_detour || spec.planner.evaluations < MIN_BUDGET;
    if plan.routes.len() != ends.len() || !fails && is_enough {
        return None;
    }
    let specs: Vec<_> = (0..ends.len())
        .map(|number| on_route(planning.spec, index, number))
        .collect();
    let contexts: Vec<RouteContext<'_>> = (ends.into_iter().zip(&specs))
        .map(|((from, to), spec)| {
            let start_s = 0.0;
            let ends = RouteEnds { from, to, start_s };
            let context = planning.route_context(index, ends, EarlierFlights::none());
            RouteContext { spec, ..context }
        })
        .collect();
    let judged: Vec<CostTerms> = (contexts.iter().zip(&plan.routes))
        .map(|(context, route)| judged_route(context, &route.control_points).terms)
        .collect();
    let are_clean = judged.iter().all(CostTerms::keeps_static_limits);
    let all: Vec<Vec<PlanPoint>> = (contexts.iter().zip(&judged))
        .map(|(context, terms)| {
            let has_failed = fails && (are_clean || !terms.keeps_static_limits());
            let most = if has_failed {
                f64::INFINITY
            } else {
                worth(context, terms)
            };
            way(context, most).map_or_else(Vec::new, |way| way.at)
        })
        .collect();
    all.iter().any(|route| !route.is_empty()).then_some(all)
}

/// What a way with rests must cost less than instead of a route that passes; nothing where that keeps the limits of the
/// objective as well, near its bound.
fn worth(context: &RouteContext<'_>, terms: &CostTerms) -> f64 {
    let cost = terms.total();
    match !terms.keeps_static_limits() || is_far_from_bound(context, cost) {
        true => WORTH * cost,
        false => 0.0,
    }
}

/// A way with rests that costs less than `most` and takes little longer: of two that keep the limits the one that is much
/// slower is not worth a few metres.
fn way(context: &RouteContext<'_>, most: f64) -> Option<Rests> {
    if most <= 0.0 {
        return None;
    }
    let each = rest_m(context.vehicle()) / 1000.0 * context.spec.planner.weights.length;
    let length = |way: &Rests| way.cost + as_f64(way.at.len()) * each;
    rests(context, most).filter(|way| way.cost < most && length(way) < LONGER * most)
}

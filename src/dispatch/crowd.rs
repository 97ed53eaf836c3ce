//! Which fleets are planned as a whole: those in which nearly everybody meets everybody, and small ones
//! that pay much for priority order.

use super::Dispatched;
use crate::geodesy::PlanPoint;
use crate::path::route_ends;
use crate::spec::{MissionSpec, Objective, Vehicle};
use crate::world::World;

/// Fewest vehicles of a crowd. Fewer are planned one after the other soon enough.
const FEWEST: usize = 8;
/// Most vehicles: the work grows with their square.
pub(super) const MAX: usize = 60;
/// Most vehicles of a crowd that are planned one by one where no plan as a whole is found: each is
/// then planned around nearly all others, round after round.
pub(super) const MAX_ONE_BY_ONE: usize = 14;
/// Others that each vehicle of a crowd meets, on average.
const MET: usize = 5;
/// A fleet whose plan costs more than this many times its bound pays much.
const PAID: f64 = 1.01;

/// A straight flight at constant speed, from one time on.
struct Straight {
    from: PlanPoint,
    to: PlanPoint,
    start_s: f64,
    end_s: f64,
}

/// Whether straight flights of the vehicles would meet that often.
pub(super) fn is_crowd(spec: &MissionSpec, world: &World) -> bool {
    let count = spec.vehicles.len();
    if !(FEWEST..=MAX).contains(&count) || spec.planner.objective == Objective::Paper {
        return false;
    }
    let flights: Vec<Vec<Straight>> = (spec.vehicles.iter().zip(&world.sites))
        .map(|(vehicle, sites)| straight(vehicle, route_ends(vehicle, sites)))
        .collect();
    let slack_s = spec.separation.time_slack_s;
    let distance_m = spec.buffered_separation().distance_m;
    let meets = |a: &[Straight], b: &[Straight]| {
        let mut pairs = a.iter().flat_map(|a| b.iter().map(move |b| (a, b)));
        pairs.any(|(a, b)| nearest_m(a, b) < distance_m + slack_s * speed_mps(a))
    };
    let met = (0..count).flat_map(|first| (first + 1..count).map(move |other| (first, other)));
    let met = met.filter(|&(a, b)| meets(&flights[a], &flights[b]));
    2 * met.count() >= MET * count
}

/// Whether a small fleet keeps all limits, but by detours around each other that cost much.
pub(super) fn pays_much(found: &Dispatched) -> bool {
    let plan = &found.plan;
    let gives_way = || plan.vehicles.iter().any(|plan| !plan.avoids.is_empty());
    (2..=MAX_ONE_BY_ONE).contains(&plan.vehicles.len())
        && found.review.passes()
        && gives_way()
        && plan.cost() > PAID * plan.bound()
}

fn straight(vehicle: &Vehicle, ends: Vec<(PlanPoint, PlanPoint)>) -> Vec<Straight> {
    let mut at_s = vehicle.depart_s;
    let flown = ends.into_iter().map(|(from, to)| {
        let start_s = at_s;
        at_s += from.at.distance_m(to.at) / vehicle.speed_mps.max(0.1);
        Straight {
            from,
            to,
            start_s,
            end_s: at_s,
        }
    });
    flown.collect()
}

fn speed_mps(flight: &Straight) -> f64 {
    flight.from.at.distance_m(flight.to.at) / (flight.end_s - flight.start_s).max(0.1)
}

/// Least distance in the plane while both fly; infinite if they never do.
fn nearest_m(a: &Straight, b: &Straight) -> f64 {
    let (from_s, to_s) = (a.start_s.max(b.start_s), a.end_s.min(b.end_s));
    if from_s >= to_s {
        return f64::INFINITY;
    }
    let apart = |t_s: f64| {
        let (p, q) = (at(a, t_s), at(b, t_s));
        (p.0 - q.0, p.1 - q.1)
    };
    let (first, last) = (apart(from_s), apart(to_s));
    let moved = (last.0 - first.0, last.1 - first.1);
    let square = moved.0 * moved.0 + moved.1 * moved.1;
    let share = if square > 0.0 {
        (-(first.0 * moved.0 + first.1 * moved.1) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (first.0 + share * moved.0).hypot(first.1 + share * moved.1)
}

fn at(flight: &Straight, t_s: f64) -> (f64, f64) {
    let share = (t_s - flight.start_s) / (flight.end_s - flight.start_s).max(1e-9);
    let (from, to) = (flight.from.at, flight.to.at);
    (
        from.east_m + share * (to.east_m - from.east_m),
        from.north_m + share * (to.north_m - from.north_m),
    )
}

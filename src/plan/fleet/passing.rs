//! Stops that a wing flies past: the routes before and after meet there on one course.

use std::f64::consts::TAU;

use super::Planning;
use crate::cost::Margins;
use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::path::{
    Pose, VehicleLimits, along, heading_rad, route_start_s, time_route, turns_sampled,
    way_speed_mps,
};
use crate::plan::VehiclePlan;
use crate::spec::ACTION_S;
use crate::world::{Layer, PlanZone, World};

/// Courses over a stop that are tried.
const COURSES: u32 = 72;
/// Turns are planned this much wider than the turn radius, so that encoding leaves them wide enough.
const WIDER: f64 = 1.1;
/// Straight before a stop, in turn radii: a wing overshoots the turn before it.
const LEAD_IN: f64 = 3.0;
/// Straight after it, in turn radii: its autopilot turns early onto the next leg.
const LEAD_OUT: f64 = 1.0;
/// How much of a route is flown otherwise at most, in turn radii beyond the straight part.
const REACHES: [f64; 6] = [1.0, 2.0, 4.0, 6.0, 9.0, 14.0];
/// Most of a route that is flown otherwise, of its length.
const MAX_SHARE: f64 = 0.45;
/// Between places that are looked at, metres.
const STEP_M: f64 = 10.0;
/// What a metre costs where it breaks a limit, in metres.
const BROKEN: f64 = 1000.0;

/// The end of a route up to a stop, or in reverse the begin of one from it.
struct Side<'a> {
    points: &'a [PlanPoint],
    /// Whether the wing comes to the stop, and does not leave it.
    arrives: bool,
    lead_m: f64,
}

/// A new end of a route.
struct Ending {
    points: Vec<PlanPoint>,
    cost_m: f64,
}

impl Planning<'_> {
    /// Lets the routes of a wing meet on one course at each stop that it flies past, with turns
    /// that it can fly, past what is closed if that is possible.
    pub(super) fn meet(&self, index: usize, plan: &mut VehiclePlan) {
        let vehicle = &self.spec.vehicles[index];
        let count = plan.routes.len();
        let passed: Vec<usize> = (0..count.saturating_sub(1))
            .filter(|&number| vehicle.passes_after(number))
            .collect();
        if passed.is_empty() {
            return;
        }
        let mut routes = plan.points();
        for number in passed {
            let after: Vec<PlanPoint> = routes[number + 1].iter().rev().copied().collect();
            let (before, after) = self.met(index, number, &routes[number], &after);
            routes[number] = before;
            routes[number + 1] = after.into_iter().rev().collect();
        }
        let mut start_s = route_start_s(vehicle, &self.world.sites[index]);
        for (number, (route, points)) in plan.routes.iter_mut().zip(routes).enumerate() {
            if let [first, .., last] = points.as_slice() {
                let own = vehicle.on_route(number);
                let speed_mps = way_speed_mps(&own, *first, *last);
                route.path = time_route(&points, start_s, speed_mps, own.accel_mps2);
            }
            start_s = route.end_s() + vehicle.rest_after_s(number);
        }
    }

    /// The routes up to a stop and, in reverse, from it, that meet on the course that costs least.
    fn met(
        &self,
        index: usize,
        number: usize,
        before: &[PlanPoint],
        after: &[PlanPoint],
    ) -> (Vec<PlanPoint>, Vec<PlanPoint>) {
        let vehicle = &self.spec.vehicles[index];
        let radius_m = WIDER * VehicleLimits::of(vehicle).turn_radius_m;
        let actions = vehicle
            .stops
            .get(number)
            .map_or(0, |stop| stop.actions.len());
        let acting_s = match u32::try_from(actions).unwrap_or(u32::MAX) {
            0 => 0.0,
            count => 1.0 + ACTION_S * f64::from(count),
        };
        let sides = [
            Side {
                points: before,
                arrives: true,
                lead_m: LEAD_IN * radius_m,
            },
            Side {
                points: after,
                arrives: false,
                lead_m: (LEAD_OUT * radius_m).max(acting_s * vehicle.fastest_mps()),
            },
        ];
        let mut courses: Vec<f64> = (0..COURSES)
            .map(|step| f64::from(step) * TAU / f64::from(COURSES))
            .collect();
        if let ([.., a, stop], [.., b, _]) = (before, after) {
            let (come, go) = (heading_rad(a.at, stop.at), heading_rad(stop.at, b.at));
            let half = 0.5 * (go - come).sin().atan2((go - come).cos());
            courses.extend([come, go, come + half]);
        }
        let best = courses
            .into_iter()
            .filter_map(|course_rad| {
                let ends =
                    [0, 1].map(|side| self.ending(index, &sides[side], (course_rad, radius_m)));
                let [Some(come), Some(go)] = ends else {
                    return None;
                };
                Some((come.cost_m + go.cost_m, come, go))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0));
        match best {
            Some((_, come, go)) => (come.points, go.points),
            None => (before.to_vec(), after.to_vec()),
        }
    }

    /// The cheapest way from somewhere on a route to its end on a course.
    fn ending(
        &self,
        index: usize,
        side: &Side<'_>,
        (course_rad, radius_m): (f64, f64),
    ) -> Option<Ending> {
        let limits = VehicleLimits::of(&self.spec.vehicles[index]);
        let stop = *side.points.last()?;
        let length_m = length_m(side.points);
        let mut best: Option<Ending> = None;
        for reach in REACHES {
            let cut_m = (side.lead_m + reach * radius_m).min(MAX_SHARE * length_m);
            let (mut points, from_rad) = cut(side.points, cut_m)?;
            let from = *points.last()?;
            // Of a route from the stop all courses are those of the way back.
            let course_rad = if side.arrives {
                course_rad
            } else {
                course_rad + 0.5 * TAU
            };
            let pose = |at, heading_rad| Pose { at, heading_rad };
            let lead_m = side.lead_m.min(MAX_SHARE * length_m);
            let mut turns = turns_sampled(
                pose(from.at, from_rad),
                pose(along(stop.at, course_rad, -lead_m), course_rad),
                radius_m,
                STEP_M,
            );
            turns.push(stop.at);
            let flown = sloped(&turns, from.amsl, stop.amsl);
            let flown_m: f64 = turns
                .windows(2)
                .map(|pair| pair[0].distance_m(pair[1]))
                .sum();
            let rise_m = match side.arrives {
                true => stop.amsl.0 - from.amsl.0,
                false => from.amsl.0 - stop.amsl.0,
            };
            let limit = if rise_m > 0.0 {
                limits.climb
            } else {
                limits.descent
            };
            let steep_m = (rise_m.abs() - limit.at(stop.amsl) * flown_m).max(0.0);
            let broken_m = self.broken_m(index, &flown);
            let cost_m = flown_m - cut_m + BROKEN * (broken_m + steep_m);
            if best.as_ref().is_none_or(|best| cost_m < best.cost_m) {
                points.extend(&flown[1..]);
                best = Some(Ending { points, cost_m });
            }
        }
        best
    }

    /// How much of a way breaks a limit in space, metres.
    fn broken_m(&self, index: usize, points: &[PlanPoint]) -> f64 {
        let world = self.world;
        let layer = world.layer(index);
        let limits = (layer, self.request.margins_of(index));
        let mut broken_m = 0.0;
        for pair in points.windows(2) {
            let length_m = pair[0].at.distance_m(pair[1].at);
            let mut gone_m = 0.0;
            while gone_m < length_m {
                let here = pair[0].toward(pair[1], gone_m / length_m);
                if is_broken(world, limits, here) {
                    broken_m += STEP_M.min(length_m - gone_m);
                }
                gone_m += STEP_M;
            }
        }
        broken_m
    }
}

/// Whether a vehicle with limits of its own must not be there, at any time, or is nearer to it than
/// the margins.
fn is_broken(world: &World, (layer, margins): (Layer, Margins), point: PlanPoint) -> bool {
    let ground_m = world.ground.height_m(point.at);
    let floor_m = layer.floor_m(ground_m + world.min_agl.0) + margins.clearance_m;
    let ceiling_m = layer.ceiling_m(ground_m, world.max_amsl.0) - margins.under_m;
    let amsl_m = point.amsl.0;
    let is_level = amsl_m >= floor_m && amsl_m <= ceiling_m;
    let is_closed = |point: PlanPoint| {
        let in_zone = |zone: &PlanZone| zone.is_closed_at(point, ground_m, f64::NAN);
        !world.in_area(point.at)
            || world.threats.iter().any(|threat| threat.contains(point.at))
            || world.zones.iter().any(in_zone)
    };
    let aside = [0.0, 0.25, 0.5, 0.75].map(|turn| PlanPoint {
        at: along(point.at, turn * TAU, margins.threat_m),
        ..point
    });
    !is_level || is_closed(point) || aside.into_iter().any(is_closed)
}

fn length_m(points: &[PlanPoint]) -> f64 {
    let pairs = points.windows(2);
    pairs.map(|pair| pair[0].at.distance_m(pair[1].at)).sum()
}

/// The points without the last metres, and the course there.
fn cut(points: &[PlanPoint], cut_m: f64) -> Option<(Vec<PlanPoint>, f64)> {
    let mut left_m = cut_m;
    for last in (1..points.len()).rev() {
        let (from, to) = (points[last - 1], points[last]);
        let leg_m = from.at.distance_m(to.at);
        if leg_m > left_m {
            let mut shortened = points[..last].to_vec();
            shortened.push(from.toward(to, 1.0 - left_m / leg_m));
            return Some((shortened, heading_rad(from.at, to.at)));
        }
        left_m -= leg_m;
    }
    None
}

/// Places on one slope between two altitudes.
fn sloped(line: &[EastNorth], from: Amsl, to: Amsl) -> Vec<PlanPoint> {
    let mut along_m = vec![0.0];
    for pair in line.windows(2) {
        let before_m = along_m.last().copied().unwrap_or(0.0);
        along_m.push(before_m + pair[0].distance_m(pair[1]));
    }
    let whole_m = along_m.last().copied().unwrap_or(0.0).max(1e-9);
    let at = |(place, gone_m): (&EastNorth, f64)| PlanPoint {
        at: *place,
        amsl: Amsl(from.0 + (to.0 - from.0) * gone_m / whole_m),
    };
    line.iter().zip(along_m).map(at).collect()
}

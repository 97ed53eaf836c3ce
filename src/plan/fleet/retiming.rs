//! Retiming: other departures and speeds, for a vehicle with a conflict.
//!
//! The path is the one it would fly alone, so no path around others costs less: time is no term
//! of the objective. Among the departures and speeds that the spec allows, and at which the whole
//! flight keeps apart from all earlier ones, retiming takes the one that changes the times of the
//! flight least: the change of departure, and how much longer or shorter the path takes.

use rayon::prelude::*;

use super::vehicle::sum;
use super::{MAX_IN_ORDER, Planning};
use crate::cost::{Batch, CostTerms, EarlierFlights, Margins, RouteEnds};
use crate::numeric::tracks::{Track, Tracks};
use crate::path::{TimedPoint, route_start_s, time_route, way_speed_mps};
use crate::plan::route_context::{RouteContext, with_free_controls};
use crate::plan::search::JUDGED_SAMPLES;
use crate::plan::spline::Spline;
use crate::plan::{Route, VehiclePlan};
use crate::spec::{Span, Vehicle};

/// Departures to try, a whole number of seconds apart.
const DEPARTURES: f64 = 200.0;
/// The same in a large fleet where those are all taken: a search around others takes longer.
const MORE_DEPARTURES: f64 = 1000.0;
/// The same for a path that is planned around others.
const AROUND: f64 = 40.0;
/// Speeds to try, at least this share of the specified one apart.
const SPEED_STEP: f64 = 0.05;
const SPEEDS: f64 = 8.0;
/// Costs that differ by less are the same.
const TOLERANCE: f64 = 1e-9;

/// Finds the vehicles that come near a track at each of some delays, seconds.
type Met<'m> = dyn Fn(&Track, &[f64]) -> Vec<Vec<usize>> + 'm;

/// Whether the track of a number is in the way.
pub(crate) type Counts<'c> = dyn Fn(usize) -> bool + Sync + 'c;

/// A departure and a speed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Choice {
    depart_s: f64,
    speed_mps: f64,
    /// Number of the speed.
    speed: usize,
    terms: CostTerms,
    /// How much it changes the times of the flight, seconds.
    change_s: f64,
}

impl Planning<'_> {
    /// The path that a vehicle would fly alone, at the departure and speed nearest to the
    /// specified ones at which it is apart from others; none if there is no such time and speed.
    /// Of the others only tracks whose number counts are in its way.
    pub(crate) fn at_another_time(
        &self,
        index: usize,
        alone: &VehiclePlan,
        others: (&Tracks, &Counts<'_>),
    ) -> Option<VehiclePlan> {
        let vehicle = &self.spec.vehicles[index];
        let nearness = self.nearness(index);
        let (mut ways, mut tracks) = (Vec::new(), Vec::new());
        for (speed, (speed_mps, terms)) in self.speeds(index, alone).into_iter().enumerate() {
            let choice = Choice {
                depart_s: vehicle.depart_s,
                speed_mps,
                speed,
                terms,
                change_s: 0.0,
            };
            let plan = self.retimed(index, alone, choice);
            tracks.push(self.flight(index, &plan).track());
            ways.push(Choice {
                change_s: (plan.duration_s() - alone.duration_s()).abs(),
                ..choice
            });
        }
        let (others, counts) = others;
        let is_apart =
            |track: &Track, later_s: f64| !others.is_any_near((track, later_s), &nearness, counts);
        // A vehicle in the air has its times, whatever its departure.
        let is_airborne = self.world.sites[index].departure.is_airborne();
        let free = |choice: &Choice| {
            let later_s = choice.depart_s - vehicle.depart_s;
            if !is_airborne && !is_apart(&tracks[choice.speed], later_s) {
                return None;
            }
            // The same again but for rounding.
            let plan = self.retimed(index, alone, *choice);
            is_apart(&self.flight(index, &plan).track(), 0.0).then_some(plan)
        };
        let first = |count: f64| {
            let choices = choices(vehicle, &ways, count);
            choices.par_iter().find_map_first(free)
        };
        let is_large = self.spec.vehicles.len() > MAX_IN_ORDER;
        first(DEPARTURES).or_else(|| is_large.then(|| first(MORE_DEPARTURES)).flatten())
    }

    /// Departures of a path, and the vehicles that it then meets: first those at which its takeoff
    /// and landing are free, because the search cannot move them, then by the number of vehicles,
    /// then by the change of departure. `met` finds the vehicles that come near a track at each of
    /// some delays.
    pub(crate) fn departures_by_conflicts(
        &self,
        index: usize,
        path: &VehiclePlan,
        met: &Met<'_>,
    ) -> Vec<(f64, Vec<usize>)> {
        let vehicle = &self.spec.vehicles[index];
        let path = self.departing(index, path, vehicle.depart_s);
        let (whole, columns) = (
            self.flight(index, &path).track(),
            self.columns(index, &path),
        );
        let all = departures(vehicle, AROUND);
        let later_s: Vec<f64> = all.iter().map(|at_s| at_s - vehicle.depart_s).collect();
        let (of_whole, of_columns) = (met(&whole, &later_s), met(&columns, &later_s));
        let each = all.into_iter().zip(of_whole).zip(of_columns);
        let mut found: Vec<(bool, f64, Vec<usize>)> = each
            .map(|((depart_s, others), blocking)| (!blocking.is_empty(), depart_s, others))
            .collect();
        found.sort_by_key(|(is_blocked, _, others)| (*is_blocked, others.len()));
        let found = found.into_iter();
        found
            .map(|(_, depart_s, others)| (depart_s, others))
            .collect()
    }

    /// The same path at the specified speed and another departure.
    pub(crate) fn departing(&self, index: usize, path: &VehiclePlan, depart_s: f64) -> VehiclePlan {
        let choice = Choice {
            depart_s,
            speed_mps: self.spec.vehicles[index].speed_mps,
            speed: 0,
            terms: path.terms,
            change_s: 0.0,
        };
        self.retimed(index, path, choice)
    }

    /// The flight before and after the routes.
    fn columns(&self, index: usize, plan: &VehiclePlan) -> Track {
        let ends = |pick: fn(&[TimedPoint]) -> Option<&TimedPoint>| {
            move |route: &Route| pick(&route.path).map(|point| point.t_s)
        };
        let first_s = plan.routes.first().and_then(ends(|path| path.first()));
        let last_s = plan.routes.last().and_then(ends(|path| path.last()));
        let flight = self.flight(index, plan);
        let outside = flight.segments().filter(|segment| {
            first_s.is_none_or(|first_s| segment.t1_s <= first_s)
                || last_s.is_none_or(|last_s| segment.t0_s >= last_s)
        });
        Track::new(outside.collect()).standing_at(flight.ends())
    }

    /// Speeds to try, the specified one first, and what the path costs at them. At a higher speed
    /// it may be too bent or too steep, and then it is left out. They are whole decimetres a
    /// second, but for the specified one and the ends of the range.
    fn speeds(&self, index: usize, alone: &VehiclePlan) -> Vec<(f64, CostTerms)> {
        let vehicle = &self.spec.vehicles[index];
        let span = vehicle.speeds();
        let mut good = vec![(vehicle.speed_mps, alone.terms)];
        if vehicle.retiming.speed_mps.is_none() {
            return good;
        }
        let min_mps = SPEED_STEP * vehicle.speed_mps;
        let step_mps = ((span.most - span.least) / SPEEDS).max(min_mps).max(0.1);
        let mut spec = self.spec.clone();
        let mut judged = |speed_mps: f64| {
            spec.vehicles[index].speed_mps = speed_mps;
            let planning = Planning {
                spec: &spec,
                ..*self
            };
            planning.judged(index, alone)
        };
        let [_, specified] = judged(vehicle.speed_mps);
        let others = around(vehicle.speed_mps, span, (step_mps * 10.0).ceil() / 10.0);
        let is_given = |speed: &f64| [span.least, span.most].contains(speed);
        for speed_mps in others.into_iter().skip(1) {
            let speed_mps = if is_given(&speed_mps) {
                speed_mps
            } else {
                (speed_mps * 10.0).round() / 10.0
            };
            let [plain, strict] = judged(speed_mps);
            let is_as_good = plain.is_clean() || !alone.terms.is_clean();
            if is_as_good && strict.total() <= specified.total() + TOLERANCE {
                good.push((speed_mps, plain));
            }
        }
        good
    }

    /// The same path at another time and speed.
    fn retimed(&self, index: usize, plan: &VehiclePlan, choice: Choice) -> VehiclePlan {
        let mut plan = VehiclePlan {
            depart_s: choice.depart_s,
            speed_mps: choice.speed_mps,
            terms: choice.terms,
            ..plan.clone()
        };
        let mut vehicle = self.spec.vehicles[index].clone();
        plan.apply_to(&mut vehicle);
        let mut start_s = route_start_s(&vehicle, &self.world.sites[index]);
        for (number, route) in plan.routes.iter_mut().enumerate() {
            let points = route.points();
            let (Some(first), Some(last)) = (points.first(), points.last()) else {
                continue;
            };
            let speed_mps = way_speed_mps(&vehicle.on_route(number), *first, *last);
            route.path = time_route(&points, start_s, speed_mps, vehicle.accel_mps2);
            start_s = route.end_s() + vehicle.rest_after_s(number);
        }
        plan
    }

    /// What a path costs alone: without margins, and with those of the request.
    pub(super) fn judged(&self, index: usize, plan: &VehiclePlan) -> [CostTerms; 2] {
        let mut sums = [CostTerms::default(); 2];
        for route in &plan.routes {
            let (Some(first), Some(last)) = (route.path.first(), route.path.last()) else {
                continue;
            };
            let ends = RouteEnds {
                from: first.point,
                to: last.point,
                start_s: first.t_s,
            };
            let free = route.control_points.len().saturating_sub(2);
            let spec = with_free_controls(self.spec, free);
            let context = RouteContext {
                spec: &spec,
                ..self.route_context(index, ends, EarlierFlights::none())
            };
            let parameters = context.parameters(JUDGED_SAMPLES);
            let mut batch = Batch::new(context.controls());
            batch.push(&Spline::through(&route.control_points).controls());
            for (total, margins) in sums.iter_mut().zip([Margins::default(), context.margins]) {
                let terms = context.model(margins, &parameters).judge(&batch);
                *total = sum(total, &terms.first().copied().unwrap_or_default());
            }
        }
        sums
    }
}

/// About this number of departures at each speed, those that change the times least first.
fn choices(vehicle: &Vehicle, speeds: &[Choice], count: f64) -> Vec<Choice> {
    let departures = departures(vehicle, count);
    let at = |speed: &Choice, depart_s: f64| Choice {
        depart_s,
        change_s: speed.change_s + (depart_s - vehicle.depart_s).abs(),
        ..*speed
    };
    let each = speeds.iter().flat_map(|speed| {
        let departures = departures.iter();
        departures.map(move |&depart_s| at(speed, depart_s))
    });
    let mut choices: Vec<Choice> = each.collect();
    choices.sort_by(|a, b| a.change_s.total_cmp(&b.change_s));
    choices
}

/// Departures to try, about this number: the specified one first.
fn departures(vehicle: &Vehicle, count: f64) -> Vec<f64> {
    let span = vehicle.departures();
    let step_s = ((span.most - span.least) / count).ceil().max(1.0);
    around(vehicle.depart_s, span, step_s)
}

/// A number, others in steps on both sides of it as far as a span goes, and its ends.
fn around(specified: f64, span: Span, step: f64) -> Vec<f64> {
    let mut all = vec![specified];
    for side in [-1.0, 1.0] {
        let mut next = specified + side * step;
        while span.miss(next) <= 0.0 {
            all.push(next);
            next += side * step;
        }
    }
    all.extend([span.least, span.most]);
    let miss = |value: f64| (value - specified).abs();
    all.sort_by(|a, b| miss(*a).total_cmp(&miss(*b)).then(a.total_cmp(b)));
    all.dedup();
    all
}

#[cfg(test)]
mod tests {
    use super::{Span, around};

    #[test]
    fn the_specified_number_comes_first_and_nothing_lies_outside() {
        let span = Span {
            least: 0.0,
            most: 10.5,
        };
        let all = around(4.0, span, 2.0);
        assert_eq!(all, [4.0, 2.0, 6.0, 0.0, 8.0, 10.0, 10.5]);
        let one = Span {
            least: 4.0,
            most: 4.0,
        };
        assert_eq!(around(4.0, one, 1.0), [4.0]);
    }
}

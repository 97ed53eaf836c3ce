//! Retiming: other departures and speeds, for a vehicle with a conflict.
//!
//! The path is the one it would fly alone, so no path around others costs less: time is no term
//! of the objective. Among the departures and speeds that the spec allows, and at which the whole
//! flight keeps apart from all earlier ones, retiming takes the one that changes the times of the
//! flight least: the change of departure, and how much longer or shorter the path takes.

use rayon::prelude::*;

use super::Planning;
use super::vehicle::sum;
use crate::cost::{Batch, CostTerms, Margins, RouteEnds};
use crate::numeric::tracks::Track;
use crate::path::{TimedPoint, route_start_s, time_route, way_speed_mps};
use crate::plan::route_context::{RouteContext, with_free_controls};
use crate::plan::search::JUDGED_SAMPLES;
use crate::plan::spline::Spline;
use crate::plan::{Route, VehiclePlan};
use crate::spec::{Span, Vehicle};

/// Departures to try, a whole number of seconds apart.
const DEPARTURES: f64 = 200.0;
/// Speeds to try, at least this share of the specified one apart.
const SPEED_STEP: f64 = 0.05;
const SPEEDS: f64 = 8.0;
/// Costs that differ by less are the same.
const TOLERANCE: f64 = 1e-9;

/// A departure and a speed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Choice {
    depart_s: f64,
    speed_mps: f64,
    terms: CostTerms,
    /// How much it changes the times of the flight, seconds.
    change_s: f64,
}

/// Whether the spec leaves anything open.
pub(crate) fn can_retime(vehicle: &Vehicle) -> bool {
    vehicle.retiming.depart_s.is_some() || vehicle.retiming.speed_mps.is_some()
}

impl Planning<'_> {
    /// The path that a vehicle would fly alone, at the departure and speed nearest to the
    /// specified ones at which it is apart from others; none if there is no such time and speed.
    pub(crate) fn at_another_time(
        &self,
        index: usize,
        alone: &VehiclePlan,
        is_apart: &(dyn Fn(&VehiclePlan) -> bool + Sync),
    ) -> Option<VehiclePlan> {
        let vehicle = &self.spec.vehicles[index];
        let mut choices = Vec::new();
        for (speed_mps, terms) in self.speeds(index, alone) {
            let choice = Choice {
                depart_s: vehicle.depart_s,
                speed_mps,
                terms,
                change_s: 0.0,
            };
            let plan = self.retimed(index, alone, choice);
            let longer_s = (plan.duration_s() - alone.duration_s()).abs();
            choices.extend(departures(vehicle).into_iter().map(|depart_s| Choice {
                depart_s,
                change_s: longer_s + (depart_s - vehicle.depart_s).abs(),
                ..choice
            }));
        }
        choices.sort_by(|a, b| a.change_s.total_cmp(&b.change_s));
        let plans = choices
            .par_iter()
            .map(|choice| self.retimed(index, alone, *choice));
        plans.find_first(|plan| is_apart(plan))
    }

    /// The departure nearest to the specified one at which takeoff and landing of a path are
    /// apart from others; the specified one, if there is none. A path around others begins then,
    /// because the search cannot move takeoff and landing.
    pub(crate) fn free_departure_s(
        &self,
        index: usize,
        path: &VehiclePlan,
        is_apart: &(dyn Fn(&Track) -> bool + Sync),
    ) -> f64 {
        let vehicle = &self.spec.vehicles[index];
        let all = departures(vehicle);
        let found = all.par_iter().find_first(|&&depart_s| {
            let choice = Choice {
                depart_s,
                speed_mps: vehicle.speed_mps,
                terms: path.terms,
                change_s: 0.0,
            };
            is_apart(&self.columns(index, &self.retimed(index, path, choice)))
        });
        found.copied().unwrap_or(vehicle.depart_s)
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
        Track::new(outside.collect())
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
        let least_mps = SPEED_STEP * vehicle.speed_mps;
        let step_mps = ((span.most - span.least) / SPEEDS).max(least_mps).max(0.1);
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
        let mut start_s = route_start_s(&vehicle, &self.world.stations[index]);
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
    fn judged(&self, index: usize, plan: &VehiclePlan) -> [CostTerms; 2] {
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
                ..self.route_context(index, ends, &[])
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

/// Departures to try: the specified one first.
fn departures(vehicle: &Vehicle) -> Vec<f64> {
    let span = vehicle.departures();
    let step_s = ((span.most - span.least) / DEPARTURES).ceil().max(1.0);
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

//! Stops: each is visited, in order, for its time, and what the spec wants is done there.

use super::Contract;
use crate::mission;
use crate::spec::{Order, Stop};
use crate::verify::execute::flight::Rest;
use crate::verify::measure::worst::Worst;
use crate::verify::{Limit, Margin};

/// A rest may be shorter than planned by this, seconds: rounding of sums.
pub(super) const REST_S: f64 = 1e-6;

/// A stop and where the vehicle rests for it.
struct Visit<'a> {
    stop: &'a Stop,
    rest: Option<&'a Rest>,
    away_m: f64,
}

impl Contract<'_> {
    /// Distance, time and headings of all stops.
    pub(crate) fn stops(&self) -> Vec<Margin> {
        let visits = self.visits();
        let margins = visits.iter().flat_map(|visit| self.visit(visit));
        margins.collect()
    }

    /// The speed to be commanded at a time: that of the last stop before it that has one.
    pub(crate) fn speed_since_stop(&self, t_s: f64) -> Option<f64> {
        if self
            .vehicle
            .stops
            .iter()
            .all(|stop| stop.speed_mps.is_none())
        {
            return None;
        }
        let visits = self.visits();
        let before = visits.iter().rev().filter(|visit| {
            let rest = visit.rest;
            rest.is_some_and(|rest| rest.until_s <= t_s + REST_S)
        });
        before.filter_map(|visit| visit.stop.speed_mps).next()
    }

    /// Each stop with the nearest rest; in a fixed order after that of the stop before, in a free
    /// order one that no other stop has.
    fn visits(&self) -> Vec<Visit<'_>> {
        let rests = &self.flight.rests;
        let mut is_taken = vec![false; rests.len()];
        let mut next = 0;
        let is_fixed = self.vehicle.order == Order::Fixed;
        let mut visits = Vec::with_capacity(self.vehicle.stops.len());
        for (stop, point) in self.vehicle.stops.iter().zip(&self.stations.stops) {
            let best = rests
                .iter()
                .enumerate()
                .skip(if is_fixed { next } else { 0 })
                .filter(|(index, _)| !is_taken[*index])
                .map(|(index, rest)| (index, rest, rest.point.distance_m(*point)))
                .min_by(|a, b| a.2.total_cmp(&b.2));
            if let Some((index, ..)) = best {
                is_taken[index] = true;
                next = index + 1;
            }
            visits.push(Visit {
                stop,
                rest: best.map(|(_, rest, _)| rest),
                away_m: best.map_or(f64::INFINITY, |(.., away_m)| away_m),
            });
        }
        visits
    }

    fn visit(&self, visit: &Visit<'_>) -> Vec<Margin> {
        let id = &visit.stop.id;
        let Some(rest) = visit.rest else {
            let why = match self.vehicle.order {
                Order::Fixed => "the mission does not stop after the stop before it",
                Order::Free => "the mission stops too seldom",
            };
            return vec![Margin::unjudged(self.id(), Limit::Stop(id.clone()), why)];
        };
        self.visited(visit.stop, rest, visit.away_m)
    }

    /// The rests that its own stops are made in, by their indices.
    pub(super) fn own_rests(&self) -> Vec<usize> {
        let rests = &self.flight.rests;
        let own = self.visits();
        let is_own = |rest: &Rest| own.iter().any(|visit| visit.rest == Some(rest));
        (0..rests.len())
            .filter(|&index| is_own(&rests[index]))
            .collect()
    }

    /// Distance, time and actions of a stop in a rest.
    pub(super) fn visited(&self, stop: &Stop, rest: &Rest, away_m: f64) -> Vec<Margin> {
        let id = &stop.id;
        let at = || self.moment(rest.point, rest.from_s, rest.rows.0);
        let usual_m = mission::corner_cut_m(&self.spec.mission).max(self.spec.mission.tolerance_m);
        let radius_m = stop.acceptance_radius_m.unwrap_or(usual_m);
        // A rest may begin anywhere within the radius of the autopilot.
        let accept_m = mission::acceptance_m(self.mission, rest.rows.0);
        let mut near = Worst::default();
        near.at_most(away_m.max(accept_m), radius_m, at);
        let mut held = Worst::default();
        held.at_least(rest.until_s - rest.from_s + REST_S, stop.hold_s, at);
        let mut margins: Vec<Margin> = [
            near.margin(self.id(), Limit::Stop(id.clone()), "m"),
            held.margin(self.id(), Limit::StopHold(id.clone()), "s"),
        ]
        .into_iter()
        .flatten()
        .collect();
        margins.extend(self.done(stop, rest));
        margins
    }
}

//! Stops: each is visited, in order, for its time, and what the spec wants is done there.

use super::MissionCheck;
use crate::geodesy::PlanPoint;
use crate::mission::{self, command};
use crate::spec::{Order, Stop};
use crate::verify::execute::flight::{End, Mark, Rest};
use crate::verify::measure::worst::Worst;
use crate::verify::{Limit, Margin};

/// A rest may be shorter than planned by this, seconds: rounding of sums.
pub(super) const REST_S: f64 = 1e-6;

/// The waypoint of a stop is reached this near to the time when the vehicle is nearest, seconds.
const NEAR_S: f64 = 5.0;

/// Waypoints nearer to each other than this are at one place, metres.
const SAME_M: f64 = 0.5;

/// How far a wing may be from a stop, where and when it is nearest, and the row that it flies to then.
type Nearest = (f64, PlanPoint, f64, usize);

/// A stop and where the vehicle rests for it, or flies past it.
struct Visit {
    stop: Stop,
    rest: Option<Rest>,
    away_m: f64,
}

impl MissionCheck<'_> {
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
        let before = visits
            .iter()
            .rev()
            .filter(|visit| visit.rest.is_some_and(|rest| rest.until_s <= t_s + REST_S));
        before.filter_map(|visit| visit.stop.speed_mps).next()
    }

    /// Each stop with the nearest rest, or where it is passed; in a fixed order after the stop
    /// before, in a free order a rest that no other stop has.
    fn visits(&self) -> Vec<Visit> {
        let rests = &self.flight.rests;
        let mut is_taken = vec![false; rests.len()];
        let mut since_s = f64::NEG_INFINITY;
        let is_fixed = self.vehicle.order == Order::Fixed;
        let stops = self.with_ends();
        let goal = stops.len() - usize::from(self.vehicle.goal_stop().is_some());
        let mut visits = Vec::with_capacity(stops.len());
        for (index, (stop, point)) in stops.into_iter().enumerate() {
            let after_s = if is_fixed { since_s } else { f64::NEG_INFINITY };
            let passes = self.vehicle.wing.is_some() && stop.hold_s <= 0.0;
            let best = if passes && index == goal {
                self.goal_on_wing(&stop, since_s)
            } else if passes {
                self.pass(&stop, point, after_s)
            } else {
                let best = rests
                    .iter()
                    .enumerate()
                    .filter(|(index, rest)| !is_taken[*index] && rest.until_s > after_s)
                    .map(|(index, rest)| (index, rest, rest.point.distance_m(point)))
                    .min_by(|a, b| a.2.total_cmp(&b.2));
                best.map(|(index, rest, away_m)| {
                    is_taken[index] = true;
                    (*rest, away_m)
                })
            };
            if let Some((rest, _)) = best {
                since_s = rest.until_s;
            }
            visits.push(Visit {
                stop,
                rest: best.map(|(rest, _)| rest),
                away_m: best.map_or(f64::INFINITY, |(_, away_m)| away_m),
            });
        }
        visits
    }

    /// The stops, and start and goal where something is done there.
    pub(super) fn with_ends(&self) -> Vec<(Stop, PlanPoint)> {
        let (vehicle, sites) = (self.vehicle, self.sites);
        let is_on_ground = !sites.departure.is_airborne();
        let start = vehicle.start_stop().filter(|_| is_on_ground);
        let stops = vehicle
            .stops
            .iter()
            .cloned()
            .zip(sites.stops.iter().copied())
            .map(|(stop, end)| (stop.clone(), stop.below(end)));
        let goal = vehicle.goal_stop().map(|stop| (stop, sites.goal));
        let start = start.map(|stop| (stop, sites.start));
        start.into_iter().chain(stops).chain(goal).collect()
    }

    /// Where a wing flies past a stop after another one: as a rest of no length, and how far from the stop
    /// it may be there. The first time, unless what is done there is done at a later one: a plane that has
    /// taken off may cross its start before it comes to it on its path.
    fn pass(&self, stop: &Stop, point: PlanPoint, after_s: f64) -> Option<(Rest, f64)> {
        let passes = self.passes_of(stop, point, after_s);
        let acts = |pass: &&(Rest, f64)| stop.actions.is_empty() || self.does_all(stop, &pass.0);
        let acting = passes.iter().find(acts);
        acting.or_else(|| passes.first()).copied()
    }

    /// Each time that a wing flies past a stop; the nearest one where none is near enough.
    fn passes_of(&self, stop: &Stop, point: PlanPoint, after_s: f64) -> Vec<(Rest, f64)> {
        let radius_m = self.radius_m(stop);
        let mut found = Vec::new();
        let mut best: Option<Nearest> = None;
        let segments = self.flight.segments.iter();
        for segment in segments.filter(|segment| segment.flown && segment.to_s > after_s) {
            let u = segment.nearest(point);
            let there = segment.at(u);
            let away_m = there.distance_m(point) + segment.error_m + segment.wide_m;
            if best.is_some_and(|best| best.0 <= radius_m) && away_m > radius_m {
                found.extend(best.take());
            }
            if best.is_none_or(|best| away_m < best.0) {
                best = Some((away_m, there, segment.time_s(u), segment.row));
            }
        }
        let is_pass = |best: &Nearest| best.0 <= radius_m || found.is_empty();
        found.extend(best.filter(is_pass));
        let passes = found.into_iter();
        passes
            .map(|nearest| self.as_rest(nearest, point, radius_m))
            .collect()
    }

    /// A pass as a rest of no length, and how far from the stop it may be.
    fn as_rest(
        &self,
        (away_m, there, t_s, row): Nearest,
        point: PlanPoint,
        radius_m: f64,
    ) -> (Rest, f64) {
        // The waypoint of the stop, if there is one.
        let marks = self.flight.route.iter();
        let marked = marks
            .filter(|mark| (mark.t_s - t_s).abs() <= NEAR_S)
            .map(|mark| (mark.point.distance_m(point), mark.row))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let first = marked.filter(|of| of.0 <= radius_m).map_or(row, |of| of.1);
        let items = self.mission.items.iter().enumerate();
        let next = items
            .skip(first)
            .find(|(_, item)| item.command <= command::NAV_LAST)
            .map_or(self.mission.items.len(), |(index, _)| index + 1);
        let rest = Rest {
            point: there,
            from_s: t_s,
            until_s: t_s,
            late_s: 0.0,
            early_s: 0.0,
            rows: (first, next),
        };
        (rest, away_m)
    }

    /// Where a wing acts at its goal, and how far from it the vehicle comes: the route to it ends at
    /// the last waypoint before its landing or its circle.
    fn goal_on_wing(&self, stop: &Stop, after_s: f64) -> Option<(Rest, f64)> {
        let goal = self.goal();
        let items = &self.mission.items;
        let is_waypoint = |row: usize| {
            let item = row.checked_sub(1).and_then(|index| items.get(index));
            item.is_some_and(|item| item.command == command::NAV_WAYPOINT)
        };
        let marks = self.flight.route.iter();
        let marks = marks.filter(|mark| mark.t_s > after_s && is_waypoint(mark.row));
        let away = |mark: &Mark| mark.point.distance_m(goal);
        let nearest_m = marks.clone().map(away).fold(f64::INFINITY, f64::min);
        let end = marks
            .clone()
            .find(|mark| away(mark) <= nearest_m + SAME_M)?;
        let away_m = match self.flight.end {
            Some(End::Stays(at)) => at.distance_m(goal.at),
            _ => self.pass(stop, goal, after_s)?.1,
        };
        let later = items.iter().enumerate().skip(end.row);
        let mut onward = later.filter(|(_, item)| item.command <= command::NAV_LAST);
        let next = onward.next().map_or(items.len(), |(index, _)| index + 1);
        let rest = Rest {
            point: end.point,
            from_s: end.t_s,
            until_s: end.t_s,
            late_s: 0.0,
            early_s: 0.0,
            rows: (end.row, next),
        };
        Some((rest, away_m))
    }

    /// How near the vehicle must come to a stop, metres.
    fn radius_m(&self, stop: &Stop) -> f64 {
        let options = &self.spec.mission;
        let usual_m = mission::corner_cut_m(options).max(options.tolerance_m);
        self.vehicle.radius_at_m(stop, usual_m)
    }

    fn visit(&self, visit: &Visit) -> Vec<Margin> {
        let id = &visit.stop.id;
        let Some(rest) = &visit.rest else {
            let why = match self.vehicle.order {
                Order::Fixed => "the mission does not stop after the stop before it",
                Order::Free => "the mission stops too seldom",
            };
            return vec![Margin::unjudged(self.id(), Limit::Stop(id.clone()), why)];
        };
        self.visited(&visit.stop, rest, visit.away_m)
    }

    /// The rests that its own stops are made in, by their indices.
    pub(super) fn own_rests(&self) -> Vec<usize> {
        let rests = &self.flight.rests;
        let own = self.visits();
        let is_own = |rest: &Rest| own.iter().any(|visit| visit.rest.as_ref() == Some(rest));
        (0..rests.len())
            .filter(|&index| is_own(&rests[index]))
            .collect()
    }

    /// Distance, time and actions of a stop in a rest.
    pub(super) fn visited(&self, stop: &Stop, rest: &Rest, away_m: f64) -> Vec<Margin> {
        let id = &stop.id;
        let at = || self.moment(rest.point, rest.from_s, rest.rows.0);
        let radius_m = self.radius_m(stop);
        // The rest of a copter may begin anywhere within the radius of the autopilot.
        let accept_m = match self.vehicle.wing {
            None => mission::acceptance_m(self.mission, rest.rows.0),
            Some(_) => 0.0,
        };
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

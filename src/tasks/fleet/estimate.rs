//! What ways between places are estimated to take and to use.

use std::borrow::Cow;

use super::{Assigner, BUDGET, PER_SECOND, SLOWEST, whole};
use crate::geodesy::{Amsl, PlanPoint};
use crate::numeric::SpeedProfile;
use crate::path::{
    TimedPoint, flight, late_share, leg_late_s, longer_for_takeoff_s, route_ends, route_start_s,
    stop_late_s, takeoff_lateness_s, way_speed_mps,
};
use crate::spec::{MAX_STOPS, Stop, Vehicle};
use crate::tasks::assignment::{Carrier, Way};

/// Nearer than this there is no route between two places, metres.
pub(super) const MIN_ROUTE_M: f64 = 10.0;
/// Nor between the ends of two lines, which are joined by a straight one.
const MIN_TURN_M: f64 = 0.5;

impl Assigner<'_> {
    /// The ways of a vehicle between the places of tasks, and its own start, stops and goal.
    pub(super) fn ways(&self, vehicle: usize) -> Vec<Vec<Option<Way>>> {
        let lines = self.line_speeds(vehicle);
        let sites = self.sites(vehicle);
        let way = |from: usize, to: usize| self.way(vehicle, (sites[from], sites[to]), &lines);
        let row = |from| (0..sites.len()).map(|to| way(from, to)).collect();
        (0..sites.len()).map(row).collect()
    }

    /// The places of tasks, and its own start, stops and goal.
    pub(super) fn sites(&self, vehicle: usize) -> Vec<usize> {
        let first = self.starts[vehicle];
        let stops = self.spec.vehicles[vehicle].stops.len();
        (0..self.own_first())
            .chain(first..first + stops + 2)
            .collect()
    }

    /// Number of the line of each place of a task and the vehicle on it; none where there is none.
    fn line_speeds(&self, vehicle: usize) -> Vec<Option<(usize, Cow<'_, Vehicle>)>> {
        let mut lines = vec![None; self.own_first()];
        for (number, unit) in self.units.iter().enumerate() {
            let Some(sweep) = self.spec.tasks[unit.task].sweep.as_ref() else {
                continue;
            };
            let own = &self.spec.vehicles[vehicle];
            let own = match sweep.speed_mps {
                Some(speed_mps) => Cow::Owned(Vehicle {
                    speed_mps,
                    ..own.clone()
                }),
                None => Cow::Borrowed(own),
            };
            for &site in &unit.sites {
                lines[site] = Some((number, own.clone()));
            }
        }
        lines
    }

    fn way(
        &self,
        vehicle: usize,
        (from, to): (usize, usize),
        lines: &[Option<(usize, Cow<'_, Vehicle>)>],
    ) -> Option<Way> {
        if from == to {
            return Some(Way { time: 0, uses: 0 });
        }
        let ends = (self.points[from], self.points[to]);
        let line = |site: usize| lines.get(site).and_then(Option::as_ref);
        let min_m = match (line(from), line(to)) {
            (Some(_), Some(_)) => MIN_TURN_M,
            _ if from < lines.len() || to < lines.len() => MIN_ROUTE_M,
            _ => 0.0,
        };
        if ends.0.at.distance_m(ends.1.at) < min_m {
            return None;
        }
        let own = match (line(from), line(to)) {
            (Some((one, own)), Some((other, _))) if one == other => own,
            _ => &self.spec.vehicles[vehicle],
        };
        let duration_s = duration_s(own, ends, self.lengths_m[from][to]);
        let flies = &self.spec.vehicles[vehicle];
        let late_s = stop_late_s(flies) + leg_late_s(flies) + duration_s * late_share(flies);
        let used = self.used(vehicle, duration_s, ends) + self.used_late(flies, late_s);
        let used = used * self.factors[vehicle];
        Some(Way {
            time: whole(duration_s * PER_SECOND),
            uses: whole(used),
        })
    }

    /// What a way uses, as parts of what its vehicle may.
    fn used(&self, vehicle: usize, duration_s: f64, (from, to): (PlanPoint, PlanPoint)) -> f64 {
        let Some(endurance) = &self.spec.vehicles[vehicle].endurance else {
            return 0.0;
        };
        if duration_s <= 0.0 {
            return 0.0;
        }
        let [east_mps, north_mps] = self.wind_mps();
        let air_mps = ((to.at.east_m - from.at.east_m) / duration_s - east_mps)
            .hypot((to.at.north_m - from.at.north_m) / duration_s - north_mps);
        let up_mps = (to.amsl.0 - from.amsl.0) / duration_s;
        let used = endurance.capacity.used(duration_s, air_mps, up_mps);
        BUDGET * used / endurance.usable()
    }

    /// What the verdict adds where autopilots are later than the flight model, in the trial that counts it.
    fn used_late(&self, own: &Vehicle, late_s: f64) -> f64 {
        let counts = self.trial.counts_lateness();
        let Some(endurance) = own.endurance.as_ref().filter(|_| counts) else {
            return 0.0;
        };
        let [east_mps, north_mps] = self.wind_mps();
        let altitudes = self.points.iter().map(|point| point.amsl.0);
        let top_m = altitudes.fold(f64::NEG_INFINITY, f64::max);
        let used = own.used_waiting(late_s, east_mps.hypot(north_mps), Amsl(top_m));
        BUDGET * used / endurance.usable()
    }

    fn wind_mps(&self) -> [f64; 2] {
        self.spec.wind.map_or([0.0; 2], |wind| wind.velocity_mps())
    }

    pub(super) fn carrier<'w>(
        &self,
        vehicle: usize,
        ways: &'w [Vec<Option<Way>>],
        closed: &'w [Vec<(u64, u64)>],
    ) -> Carrier<'w> {
        let own = &self.spec.vehicles[vehicle];
        let [east_mps, north_mps] = self.wind_mps();
        let rest = own.endurance.as_ref().map_or(0.0, |endurance| {
            let used = (endurance.capacity).used(1.0 / PER_SECOND, east_mps.hypot(north_mps), 0.0);
            BUDGET * used / endurance.usable()
        });
        Carrier {
            ways,
            start: self.own_first(),
            goal: self.own_first() + own.stops.len() + 1,
            own: Some(self.units.len() + vehicle),
            budget: match own.endurance {
                Some(_) => u64::from(whole(BUDGET * self.trial.share() - self.overhead(vehicle))),
                None => u64::MAX,
            },
            rest_uses: whole(rest).into(),
            max_visits: MAX_STOPS,
            begins: self.begins(vehicle),
            slowest: SLOWEST,
            late_after_way: whole((stop_late_s(own) + leg_late_s(own)) * PER_SECOND).into(),
            wait_step: 10,
            closed,
        }
    }

    /// When a vehicle is at its start, at the earliest and at the latest: its takeoff may be early or late.
    fn begins(&self, vehicle: usize) -> (u64, u64) {
        let own = &self.spec.vehicles[vehicle];
        let (planned_s, takeoff_s) = (
            route_start_s(own, &self.world.sites[vehicle]),
            takeoff_lateness_s(own),
        );
        let early_s = (planned_s + takeoff_s.least).max(0.0);
        let late_s = planned_s + takeoff_s.most + self.later_s[vehicle];
        let units = |s: f64| whole(s * PER_SECOND).into();
        // Rounded down, as late times are rounded up.
        (units((early_s - 1.0 / PER_SECOND).max(0.0)), units(late_s))
    }

    /// What takeoff, landing and return use, as parts of what a vehicle may use.
    pub(super) fn overhead(&self, vehicle: usize) -> f64 {
        let (own, sites) = (&self.spec.vehicles[vehicle], &self.world.sites[vehicle]);
        let stops: Vec<Stop> = Vec::new();
        let (own, mut sites) = (
            Vehicle {
                stops,
                ..own.clone()
            },
            sites.clone(),
        );
        sites.stops.clear();
        let ends = route_ends(&own, &sites);
        let routes: Vec<Vec<PlanPoint>> = ends.iter().map(|ends| vec![ends.0, ends.1]).collect();
        let flown = flight(&own, &sites, &routes);
        let used = |pair: &[TimedPoint]| {
            let duration_s = pair[1].t_s - pair[0].t_s;
            match duration_s.is_finite() {
                true => self.used(vehicle, duration_s, (pair[0].point, pair[1].point)),
                false => 0.0,
            }
        };
        let moving = flown.points.windows(2);
        let moving = moving.skip_while(|pair| pair[0].point == pair[1].point);
        let whole: f64 = moving.map(used).sum();
        let straight = (sites.start, sites.goal);
        let straight_m = straight.0.distance_m(straight.1);
        let route = self.used(vehicle, duration_s(&own, straight, straight_m), straight);
        let takeoff_s = longer_for_takeoff_s(&own, sites.departure);
        (whole - route).max(0.0) + self.used_late(&own, takeoff_s)
    }
}

/// How long a vehicle flies from rest to rest over a length.
fn duration_s(vehicle: &Vehicle, (from, to): (PlanPoint, PlanPoint), length_m: f64) -> f64 {
    let speed_mps = way_speed_mps(vehicle, from, to);
    let level_s = SpeedProfile::new(length_m, speed_mps, vehicle.accel_mps2).duration_s();
    let rise_m = to.amsl.0 - from.amsl.0;
    let upright_s = (rise_m / vehicle.climb_mps).max(-rise_m / vehicle.descent_mps);
    level_s.max(upright_s)
}

//! Distances of vehicles: measured, and predicted from what each of them flies now.

use super::breach::{Depth, error_m};
use super::corridor::assumed_late_s;
use super::{Alarms, Here, Watched};
use crate::numeric::approach::{Segment, closest_approach, min_ratio};
use crate::path::{Departing, takeoff_shift_s, with_stops_s};
use crate::spec::{AlarmKind, Separation};

/// Positions of two vehicles are compared at one time if they are not further apart than this,
/// seconds.
const TOGETHER_S: f64 = 2.0;
/// Lower above the ground than this a vehicle need not keep its distance, metres.
const GROUNDED_M: f64 = 1.0;
/// A vehicle that is not on its plan flies straight on for this long, seconds.
const AHEAD_S: f64 = 15.0;
/// A vehicle that holds or circles stays for this long, seconds.
const STAYS_S: f64 = 600.0;
/// Slower than this it stays, m/s.
pub(super) const SLOW_MPS: f64 = 1.5;
/// Who is slower than planned is looked at for this long, seconds: it may get faster.
const SLOWLY_S: f64 = 120.0;
/// Error of a shift of one vehicle against another, seconds.
const SHIFT_ERROR_S: f64 = 3.0;

/// Where a vehicle will be.
pub(super) struct Future {
    pub(super) segments: Vec<Segment>,
    /// How late it is; none for one that is not on its plan.
    late_s: Option<f64>,
    /// Whether it goes on as slowly as now, and not as planned.
    is_slow: bool,
}

/// How a vehicle that is late goes on.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Pace {
    AsPlanned,
    AsNow,
}

impl Alarms<'_> {
    /// The limit less what positions are off.
    fn distance_limit(&self) -> Separation {
        let limit = self.spec.separation;
        Separation {
            distance_m: limit.distance_m - error_m(limit.distance_m),
            vertical_m: limit.vertical_m.map(|limit_m| limit_m - error_m(limit_m)),
            ..limit
        }
    }

    /// The distances to the other vehicles at a position.
    pub(super) fn look_at_distances(&mut self, vehicle: usize, here: &Here) {
        let (limit, far_past) = (self.spec.separation, self.distance_limit());
        let distance_m = limit.distance_m;
        let is_apart = |of: &Watched<'_>, at: &Here| {
            !of.duty.flies || !of.duty.is_up || at.agl_m <= GROUNDED_M
        };
        for other in 0..self.vehicles.len() {
            let (one, two) = (&self.vehicles[vehicle], &self.vehicles[other]);
            let Some(there) = two.here.filter(|_| other != vehicle) else {
                continue;
            };
            let later_s = here.fix.t_s - there.fix.t_s;
            if later_s.abs() > TOGETHER_S {
                continue;
            }
            let off = |axis: usize, gone_m: f64| gone_m - there.velocity_mps[axis] * later_s;
            let east_m = off(0, here.point.at.east_m - there.point.at.east_m);
            let north_m = off(1, here.point.at.north_m - there.point.at.north_m);
            let up_m = off(2, here.point.amsl.0 - there.point.amsl.0);
            let across_m = east_m.hypot(north_m);
            let is_due = !is_apart(one, here) && !is_apart(two, &there);
            let is_past = |of: &Separation| is_due && of.is_conflict(across_m, up_m.abs());
            let depth = Depth::of(is_past(&limit), is_past(&far_past));
            let (first, second) = (vehicle.min(other), vehicle.max(other));
            let key = (AlarmKind::Separation, first, Some(second), "measured");
            let near = self.breaches.take(here.fix.t_s, key, depth);
            let id = &self.vehicles[second].vehicle.id;
            let text = near.then(|| {
                let away_m = across_m.hypot(up_m);
                format!("{id} is {away_m:.0} m away (at least {distance_m:.0} m)")
            });
            self.set(here.fix.t_s, key, text);
        }
    }

    /// Conflicts that will be, by what the vehicles fly now.
    pub(super) fn look_ahead(&mut self, t_s: f64) {
        let is_slow = self.vehicles.iter().any(|of| of.tube.pace() < 1.0);
        let paces = [Pace::AsPlanned, Pace::AsNow].into_iter();
        let futures: Vec<Vec<Option<Future>>> = paces
            .take(1 + usize::from(is_slow))
            .map(|pace| {
                let all = 0..self.vehicles.len();
                all.map(|index| self.future_at(t_s, index, pace)).collect()
            })
            .collect();
        for first in 0..self.vehicles.len() {
            for second in first + 1..self.vehicles.len() {
                let text = futures.iter().find_map(|of| {
                    let (a, b) = of[first].as_ref().zip(of[second].as_ref())?;
                    self.conflict((first, a), (second, b), t_s)
                });
                let key = (AlarmKind::Separation, first, Some(second), "predicted");
                self.set(t_s, key, text);
            }
        }
    }

    /// Where a vehicle will be: on its plan as late as it is now, or straight on.
    pub(super) fn future(&self, t_s: f64, index: usize) -> Option<Future> {
        self.future_at(t_s, index, Pace::AsPlanned)
    }

    fn future_at(&self, t_s: f64, index: usize, pace: Pace) -> Option<Future> {
        let of = &self.vehicles[index];
        if of.duty.is_over {
            return None;
        }
        let here = of.here?;
        let at = (here.fix.t_s, here.point.axes_m());
        let stands = !of.duty.flies || !of.duty.is_up;
        if of.duty.flies && !stands && (of.has_left_plan(t_s) || of.tube.is_off) {
            return Some(straight_on(at, here.velocity_mps));
        }
        let first = of.plan.waypoints.first()?;
        let late_s = if stands {
            (t_s - first.t_s).max(0.0)
        } else {
            of.tube.late_s.unwrap_or(0.0)
        };
        let planned_s = here.fix.t_s - late_s;
        let share = match pace {
            Pace::AsNow if !stands => of.tube.pace(),
            _ => 1.0,
        };
        let ahead = of.plan.waypoints.iter();
        let item = here.fix.item;
        let ahead = ahead.filter(|w| (stands || w.item >= item) && w.t_s > planned_s);
        let mut segments = Vec::new();
        let mut from = at;
        for waypoint in ahead {
            let after_s = (waypoint.t_s - planned_s) / share;
            let to = (here.fix.t_s + after_s, waypoint.point.axes_m());
            segments.push(Segment::between(from, to));
            from = to;
        }
        if !of.plan.lands {
            segments.push(Segment::between(from, (from.0 + STAYS_S, from.1)));
        }
        Some(Future {
            segments,
            // Before it flies it is as late as it was let go.
            late_s: Some(late_s),
            is_slow: share < 1.0,
        })
    }

    fn departing(&self, index: usize) -> Departing<'_> {
        let sites = self.world.sites.get(index);
        Departing {
            vehicle: self.vehicles[index].vehicle,
            is_airborne: sites.is_some_and(|sites| sites.departure.is_airborne()),
        }
    }

    /// What two vehicles come to, in words, where the verdict did not look at it.
    fn conflict(
        &self,
        (first, a): (usize, &Future),
        (second, b): (usize, &Future),
        t_s: f64,
    ) -> Option<String> {
        let (one, two) = (&self.vehicles[first], &self.vehicles[second]);
        if !one.duty.flies && !two.duty.flies {
            return None;
        }
        let are_slow = a.is_slow || b.is_slow;
        if let (Some(late_s), Some(other_s), false) = (a.late_s, b.late_s, are_slow) {
            let late = |of: &Watched<'_>| {
                let item = of.here.map_or(0, |here| here.fix.item);
                let all_s = assumed_late_s(of, item);
                let behaviour = &of.vehicle.facts().behaviour;
                all_s - behaviour.takeoff_late_s.value(of.vehicle.autopilot_version)
            };
            let alone = takeoff_shift_s(self.departing(first), self.departing(second));
            let span = with_stops_s(alone, late(one), late(two));
            let slack_s = self.spec.separation.time_slack_s + SHIFT_ERROR_S;
            let shift_s = late_s - other_s;
            if (span.least - slack_s..=span.most + slack_s).contains(&shift_s) {
                return None;
            }
        }
        let limit = self.distance_limit();
        let (value, at_s) = nearest(&a.segments, &b.segments, &limit, 0.0)?;
        if value >= limit.distance_m || at_s < t_s || are_slow && at_s > t_s + SLOWLY_S {
            return None;
        }
        let id = &two.vehicle.id;
        let min_m = self.spec.separation.distance_m;
        let why = [(one, a), (two, b)].map(|(of, future)| {
            let id = &of.vehicle.id;
            match future.late_s {
                Some(late_s) if future.is_slow => {
                    format!("{id} {late_s:.0} s late and slower than planned")
                }
                Some(late_s) if late_s >= 0.5 => format!("{id} {late_s:.0} s late"),
                Some(late_s) if late_s <= -0.5 => format!("{id} {:.0} s early", -late_s),
                Some(_) => format!("{id} on time"),
                None => format!("{id} not on its plan"),
            }
        });
        Some(format!(
            "{id} will be {value:.0} m away at T0+{at_s:.0} s (at least {min_m:.0} m; {}, {})",
            why[0], why[1]
        ))
    }
}

/// As it flies now for some seconds; who is slow stays.
fn straight_on((t_s, at_m): (f64, [f64; 3]), velocity_mps: [f64; 3]) -> Future {
    let [east, north, up] = velocity_mps;
    let is_slow = east.hypot(north).hypot(up) < SLOW_MPS;
    let (for_s, speed) = if is_slow {
        (STAYS_S, 0.0)
    } else {
        (AHEAD_S, 1.0)
    };
    let gone = |axis: usize| at_m[axis] + speed * velocity_mps[axis] * for_s;
    let to = (t_s + for_s, [gone(0), gone(1), gone(2)]);
    Future {
        segments: vec![Segment::between((t_s, at_m), to)],
        late_s: None,
        is_slow: false,
    }
}

/// The least distance of two at times no further apart than `apart_s`, and when; with a vertical limit
/// that of where they are nearest by both.
pub(super) fn nearest(
    a: &[Segment],
    b: &[Segment],
    limit: &Separation,
    apart_s: f64,
) -> Option<(f64, f64)> {
    let mut best: Option<(f64, f64)> = None;
    for one in a {
        let together = b
            .iter()
            .filter(|two| two.t0_s <= one.t1_s + apart_s && two.t1_s >= one.t0_s - apart_s);
        for two in together {
            let found = match limit.vertical_m {
                None => closest_approach(one, two, apart_s).map(|near| (near.value, near.t_s)),
                Some(vertical_m) => min_ratio(one, two, apart_s, limit.distance_m, vertical_m)
                    .map(|near| (near.value * limit.distance_m, near.t_s)),
            };
            if let Some(found) = found.filter(|of| best.is_none_or(|least| of.0 < least.0)) {
                best = Some(found);
            }
        }
    }
    best
}

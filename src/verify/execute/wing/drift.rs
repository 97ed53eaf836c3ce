//! The wind drives wings off in their climb, and a QuadPlane leaves it where its nose points.

use std::f64::consts::{FRAC_1_PI, TAU};

use crate::geodesy::{EastNorth, PlanPoint};
use crate::mission::VehicleMission;
use crate::path::along;

use super::loiter::steps;
use crate::verify::execute::executor::Pilot;
use crate::verify::execute::flight::{EarlyTop, Hull};
use crate::verify::measure::segment::{Column, Segment};

/// Directions in which a QuadPlane may be driven off on its rotors.
const SIDES: u32 = 12;
/// The least deceleration that a transition is taken to have, m/s^2 (the range of `Q_TRANS_DECEL` begins there), and how
/// fast one flies back on its rotors at least, m/s.
const MIN_DECEL_MPS2: f64 = 0.2;
const BACK_MPS: f64 = 2.0;

/// The place where a plane may have its height as far off as the wind may carry it, and those in
/// between.
pub(super) fn carried_points(early: EarlyTop) -> impl Iterator<Item = PlanPoint> {
    let EarlyTop { point, off } = early;
    let steps = steps(off.east_m.hypot(off.north_m));
    (0..=steps).map(move |step| moved(point, off, f64::from(step) / f64::from(steps)))
}

impl Pilot<'_> {
    /// Lays the climb of a QuadPlane to every side too, to be judged in space: on its rotors it leans
    /// little as long as it climbs, and the wind on its wing takes it anywhere. From the top it flies on
    /// where its nose points, and turns onto its first leg: until then it is within a hull.
    pub(crate) fn drift_up(&mut self, row: usize, top: PlanPoint) {
        let behaviour = &self.vehicle.facts().behaviour;
        let transition_lag_s = behaviour.transition_lag_s;
        self.transition_lag_s = transition_lag_s.value(self.vehicle.autopilot_version);
        let rise_m = top.amsl.0 - self.home.amsl.0;
        let Some(region) = self.rotors.takeoff_region(rise_m) else {
            return;
        };
        let climb_s = rise_m / self.rotors.climb_mps;
        let end_s = self.trajectory.t_s;
        if region.drift_m > 0.0 {
            self.widen_from(0, region.drift_m);
            for side in 0..SIDES {
                let course_rad = TAU * f64::from(side) / f64::from(SIDES);
                let aside = PlanPoint {
                    at: along(top.at, course_rad, region.drift_m),
                    ..top
                };
                self.trajectory.segments.push(Segment {
                    column: Some(Column::Ground),
                    ..Segment::unflown(
                        (row, self.phase),
                        (end_s - climb_s, end_s),
                        (self.home, aside),
                    )
                });
            }
        }
        self.trajectory.late_s += region.late_s;
        self.hull = Some(Hull {
            middle: top,
            reach_m: region.reach_m(),
            from_s: end_s,
            until_s: end_s,
            any_course: true,
        });
    }

    /// How far from the place that it headed for a QuadPlane may land that lands where it is, metres. It goes back to where
    /// the landing began (`Plane::set_next_WP`), which is where it accepted its waypoint, up to the distance of its turns
    /// (`AP_L1_Control::turn_distance`) before that, and flies on first until it has slowed down. No flight was measured.
    pub(crate) fn lands_around_m(&mut self, mission: &VehicleMission) -> f64 {
        let hull_m = self.hull.as_ref().filter(|_| self.knots.len() == 1);
        let hull_m = hull_m.map(|hull| hull.reach_m);
        if hull_m.is_none() && self.knots.len() == 1 && self.moving_mps <= 0.0 {
            return 0.0;
        }
        let held = |name: &str| mission.param_or_default_si(name).unwrap_or(0.0);
        let mps = self.vehicle.top_speed_mps();
        let turn_m = FRAC_1_PI * held("NAVL1_DAMPING") * held("NAVL1_PERIOD") * mps;
        let slows_m = 0.5 * mps * mps / held("Q_TRANS_DECEL").max(MIN_DECEL_MPS2);
        self.trajectory.late_s += slows_m / BACK_MPS;
        hull_m.unwrap_or(0.0) + turn_m + slows_m
    }

    /// Lays a disc where a QuadPlane overshoots the place that it lands at, before it descends; for the separation, widens
    /// the segments from one on.
    pub(crate) fn overshoot_landing(&mut self, row: usize, (first, top): (usize, PlanPoint)) {
        let figure = self.vehicle.facts().behaviour.landing_overshoot_m;
        let overshoot_m = figure.value(self.vehicle.autopilot_version);
        if overshoot_m > 0.0 {
            let descent = self.trajectory.segments.get(first);
            let t_s = descent.map_or(self.trajectory.t_s, |descent| descent.from_s);
            self.widen_from(first, overshoot_m);
            self.lay_disc(row, top, overshoot_m, (t_s, t_s));
        }
    }

    /// Lays a descent to every side too, as far as a vehicle may be driven off or come down beside its place, to be judged
    /// in space; for the separation, widens the segments from one on.
    pub(crate) fn drift_down(
        &mut self,
        row: usize,
        (first, top): (usize, PlanPoint),
        drift_m: f64,
    ) {
        let down = self.here();
        let begun = self.trajectory.segments.get(first);
        let times_s = (
            begun.map_or(0.0, |segment| segment.from_s),
            self.trajectory.t_s,
        );
        if drift_m <= 0.0 {
            return;
        }
        self.flight.landing_drift_m = drift_m;
        self.widen_from(first, drift_m);
        let disc = self.trajectory.segments.len();
        self.lay_disc(row, top, drift_m, times_s);
        let rings = steps(drift_m);
        for ring in 1..=rings {
            let ring_m = drift_m * f64::from(ring) / f64::from(rings);
            let count = steps(TAU * ring_m);
            for step in 0..count {
                let at = along(down.at, TAU * f64::from(step) / f64::from(count), ring_m);
                let ends = (PlanPoint { at, ..top }, PlanPoint { at, ..down });
                let segment = Segment::unflown((row, self.phase), times_s, ends);
                self.trajectory.segments.push(segment);
            }
        }
        // As in the column itself no height is asked for.
        for segment in &mut self.trajectory.segments[disc..] {
            segment.column = Some(Column::Ground);
        }
    }

    /// How far the wind carries a plane in a climb-out that is planned to take so long: it holds its
    /// heading, not its course.
    pub(crate) fn carried_off(&self, climb_s: f64) -> EastNorth {
        let behaviour = &self.vehicle.facts().behaviour;
        let share = behaviour.drift_share.value(self.vehicle.autopilot_version);
        let wind = self.vehicle.carried_by();
        let [east_mps, north_mps] = wind.map_or([0.0; 2], |wind| wind.velocity_mps());
        EastNorth {
            east_m: share * climb_s * east_mps,
            north_m: share * climb_s * north_mps,
        }
    }
}

/// A point moved by a share of a way.
fn moved(point: PlanPoint, by: EastNorth, share: f64) -> PlanPoint {
    PlanPoint {
        at: EastNorth {
            east_m: point.at.east_m + share * by.east_m,
            north_m: point.at.north_m + share * by.north_m,
        },
        ..point
    }
}

//! The wind drives wings off in their climb, and a QuadPlane leaves it where its nose points.

use std::f64::consts::TAU;

use crate::geodesy::{EastNorth, PlanPoint};
use crate::path::{VehicleLimits, along};

use super::loiter::steps;
use crate::verify::execute::executor::Pilot;
use crate::verify::execute::flight::{EarlyTop, Hull};
use crate::verify::measure::segment::Chord;

/// Directions in which a QuadPlane may be driven off on its rotors.
const SIDES: u32 = 12;

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
        let version = self.vehicle.autopilot_version;
        let transition_m = behaviour.transition_m.value(version);
        if transition_m <= 0.0 {
            return;
        }
        let climb_s = (top.amsl.0 - self.home.amsl.0) / self.vehicle.climb_mps;
        let (off_m, onto_leg_m) = self.driven_m(climb_s);
        let end_s = self.trajectory.t_s;
        if off_m > 0.0 {
            self.widen_from(0, off_m);
            for side in 0..SIDES {
                let course_rad = TAU * f64::from(side) / f64::from(SIDES);
                let aside = PlanPoint {
                    at: along(top.at, course_rad, off_m),
                    ..top
                };
                self.trajectory.chords.push(Chord {
                    grounded: true,
                    ..Chord::unflown(
                        (row, self.phase),
                        (end_s - climb_s, end_s),
                        (self.home, aside),
                    )
                });
            }
        }
        let turn_m = 2.0 * VehicleLimits::of(self.vehicle).turn_radius_m;
        // Half a turn more than along its first leg.
        self.trajectory.late_s += turn_m / self.vehicle.speed_mps;
        self.hull = Some(Hull {
            middle: top,
            reach_m: off_m + onto_leg_m + transition_m + turn_m,
            from_s: end_s,
            until_s: end_s,
        });
    }

    /// How far the wind drives a vehicle off in a climb that is planned to take so long, and after it
    /// until it steers for its first leg, metres.
    fn driven_m(&self, climb_s: f64) -> (f64, f64) {
        let behaviour = &self.vehicle.facts().behaviour;
        let version = self.vehicle.autopilot_version;
        let wind_mps = self.vehicle.carried_by().map_or(0.0, |wind| wind.speed_mps);
        let share = behaviour.drift_share.value(version);
        let onto_leg_s = behaviour.drift_s.value(version);
        (wind_mps * share * climb_s, wind_mps * onto_leg_s)
    }

    /// How far the wind carries a plane in a climb-out that is planned to take so long: it holds its
    /// heading, not its course.
    pub(crate) fn carried_off(&self, climb_s: f64) -> EastNorth {
        let (off_m, _) = self.driven_m(climb_s);
        let wind = self.vehicle.carried_by();
        let [east_mps, north_mps] = wind.map_or([0.0; 2], |wind| wind.velocity_mps());
        let speed_mps = east_mps.hypot(north_mps);
        if speed_mps <= 0.0 {
            return EastNorth {
                east_m: 0.0,
                north_m: 0.0,
            };
        }
        EastNorth {
            east_m: off_m * east_mps / speed_mps,
            north_m: off_m * north_mps / speed_mps,
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

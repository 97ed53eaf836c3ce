//! When a vehicle has come to the end of its plan: live as it is watched, and from a record.

use std::f64::consts::TAU;

use super::orbit::Orbit;
use crate::flight::conformance::reference::ReferenceTrajectory;
use crate::flight::launch::readiness::STANDS_M;
use crate::flight::record::Fix;
use crate::geodesy::{LatLon, LocalFrame};
use crate::spec::Airframe;

/// A vehicle that stays for ever has come to its place this near, metres.
pub(crate) const ARRIVED_M: f64 = 5.0;
/// One that is farther from there than this does not stay there any more, metres.
pub(crate) const LEFT_M: f64 = 15.0;
/// A plane that rolled out stands this near the place of its landing, metres.
const RUNS_OUT_M: f64 = 150.0;
/// Slower than this a vehicle stays where it is, m/s.
pub(crate) const STILL_MPS: f64 = 0.5;
/// A wing that stays on its circle has turned this far, radians: live monitoring of a whole orbit
/// does not see every position.
pub(crate) const TURNED_RAD: f64 = 0.95 * TAU;

/// A copter that holds is compared with where it was this long before, seconds.
pub(crate) const REST_S: f64 = 2.0;
/// It holds when it moved less than this since then, metres: means of positions, so that their
/// noise does not count.
const REST_M: f64 = 2.0;

/// The mean of the positions of the last [`REST_S`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mean {
    /// East, north, altitude AMSL, metres.
    at_m: [f64; 3],
    /// Whether that of the positions before them is near.
    pub(crate) is_still: bool,
}

impl Mean {
    /// Distance of two, metres.
    pub(crate) fn distance_m(&self, other: Self) -> f64 {
        distance_m(self.at_m, other.at_m)
    }
}

fn distance_m(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1]).hypot(a[2] - b[2])
}

/// The mean of the last of these positions, compared with those before them.
pub(crate) fn mean(frame: &LocalFrame, fixes: &[Fix]) -> Mean {
    let last_s = fixes.last().map_or(0.0, |fix| fix.t_s);
    let mut sums = [([0.0; 3], 0.0); 2];
    for fix in fixes.iter().rev() {
        let age_s = last_s - fix.t_s;
        if age_s >= 2.0 * REST_S {
            break;
        }
        let at = frame.to_plan(fix.place);
        let (sum, count) = &mut sums[usize::from(age_s >= REST_S)];
        for (sum, value) in sum.iter_mut().zip([at.east_m, at.north_m, fix.amsl.0]) {
            *sum += value;
        }
        *count += 1.0;
    }
    let [at_m, before_m] = sums.map(|(sum, count)| sum.map(|value| value / count));
    Mean {
        at_m,
        // Without positions there the distance is not a number.
        is_still: distance_m(at_m, before_m) <= REST_M,
    }
}

/// How near the place of its landing a vehicle stands that landed there, metres.
pub(crate) fn landing_m(airframe: Airframe) -> f64 {
    match airframe {
        Airframe::Plane => RUNS_OUT_M,
        Airframe::Copter | Airframe::Vtol => STANDS_M,
    }
}

/// How far a place is from where a plan ends, metres across.
pub(crate) fn away_m(reference: &ReferenceTrajectory, place: LatLon) -> f64 {
    let last = reference.waypoints.last();
    let at = reference.frame().to_plan(place);
    last.map_or(f64::INFINITY, |last| last.point.at.distance_m(at))
}

/// Whether it stands still in the air where the plan ends.
pub(crate) fn hovers(reference: &ReferenceTrajectory, fix: &Fix) -> bool {
    fix.speed_mps <= STILL_MPS && away_m(reference, fix.place) <= ARRIVED_M
}

/// How far a wing has turned on the circle that its plan ends with, radians: in the
/// positions up to the last that are all on it.
pub(crate) fn circled_rad(reference: &ReferenceTrajectory, fixes: &[Fix]) -> f64 {
    let at = |fix: &Fix| reference.frame().to_plan(fix.place);
    let off = fixes
        .iter()
        .rposition(|fix| !reference.is_on_circle(at(fix)));
    let on = &fixes[off.map_or(0, |off| off + 1)..];
    let mut orbit = Orbit::default();
    on.iter().for_each(|fix| orbit.take(at(fix)));
    orbit.max_rad()
}

/// Whether the positions of a flight that shall not land end with a stay at the end of the plan.
pub(crate) fn stays(reference: &ReferenceTrajectory, airframe: Airframe, fixes: &[Fix]) -> bool {
    if airframe.has_wing() {
        circled_rad(reference, fixes) >= TURNED_RAD
    } else {
        fixes.last().is_some_and(|fix| hovers(reference, fix))
    }
}

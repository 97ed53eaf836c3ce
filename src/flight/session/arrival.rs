//! When a vehicle has come to the end of its plan: live as it is watched, and from a record.

use std::f64::consts::TAU;

use super::orbit::Orbit;
use crate::flight::conformance::reference::Reference;
use crate::flight::launch::readiness::STANDS_M;
use crate::flight::record::Fix;
use crate::geodesy::LatLon;
use crate::spec::Airframe;

/// A vehicle that stays for ever has come to its place this near, metres.
pub(crate) const ARRIVED_M: f64 = 5.0;
/// A plane that rolled out stands this near the place of its landing, metres.
const RUNS_OUT_M: f64 = 150.0;
/// Slower than this a vehicle stays where it is, m/s.
pub(crate) const STILL_MPS: f64 = 0.5;
/// A wing that stays on its circle has turned this far, radians: live monitoring of a whole orbit
/// does not see every position.
pub(crate) const TURNED_RAD: f64 = 0.95 * TAU;

/// How near the place of its landing a vehicle stands that landed there, metres.
pub(crate) fn landing_m(airframe: Airframe) -> f64 {
    match airframe {
        Airframe::Plane => RUNS_OUT_M,
        Airframe::Copter | Airframe::Vtol => STANDS_M,
    }
}

/// How far a place is from where a plan ends, metres across.
pub(crate) fn away_m(reference: &Reference, place: LatLon) -> f64 {
    let last = reference.waypoints.last();
    let at = reference.frame().to_plan(place);
    last.map_or(f64::INFINITY, |last| last.point.at.distance_m(at))
}

/// Whether it stands still in the air where the plan ends.
pub(crate) fn hovers(reference: &Reference, fix: &Fix) -> bool {
    fix.speed_mps <= STILL_MPS && away_m(reference, fix.place) <= ARRIVED_M
}

/// How far a wing has turned on the circle that its plan ends with, radians: in the
/// positions up to the last that are all on it.
pub(crate) fn circled_rad(reference: &Reference, fixes: &[Fix]) -> f64 {
    let at = |fix: &Fix| reference.frame().to_plan(fix.place);
    let off = fixes
        .iter()
        .rposition(|fix| !reference.is_on_circle(at(fix)));
    let on = &fixes[off.map_or(0, |off| off + 1)..];
    let mut orbit = Orbit::default();
    on.iter().for_each(|fix| orbit.take(at(fix)));
    orbit.most_rad()
}

/// Whether the positions of a flight that shall not land end with a stay at the end of the plan.
pub(crate) fn stays(reference: &Reference, airframe: Airframe, fixes: &[Fix]) -> bool {
    if airframe.has_wing() {
        circled_rad(reference, fixes) >= TURNED_RAD
    } else {
        fixes.last().is_some_and(|fix| hovers(reference, fix))
    }
}

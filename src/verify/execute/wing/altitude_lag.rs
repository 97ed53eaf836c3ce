//! How late and how early vehicles follow a commanded altitude; the figures are in
//! [`crate::autopilot::Behaviour`].

use crate::autopilot::{Autopilot, SLOPE_MIN};
use crate::mission::VehicleMission;
use crate::spec::Vehicle;

use super::items;

/// Changes of altitude from one waypoint to the next that are smaller than this are flown at once
/// (`Plane::set_offset_altitude_location`), metres; 0 except on a wing of ArduPilot.
pub(crate) fn threshold_m(mission: &VehicleMission) -> f64 {
    let Some(row) = mission.facts().parameter(SLOPE_MIN[0]) else {
        return 0.0;
    };
    let held = mission.param(SLOPE_MIN[0]);
    // Stored as a whole number. With 0 there is no slope at all.
    match held.map_or(row.default_si(), f64::trunc) {
        metres if metres > 0.0 => metres,
        _ => f64::INFINITY,
    }
}

/// Lag behind a slope, seconds of the climb rate; 0 except on a wing.
pub(crate) fn lag_s(mission: &VehicleMission) -> f64 {
    let figure = mission.facts().behaviour.altitude_lag_s;
    figure.value(mission.autopilot_version)
}

/// Distance before a waypoint at which PX4 has its altitude, metres: on a wing (`FixedWingPositionControl`, the
/// altitude of a leg; assumed, not measured), and all the way on a copter with its heights at once; else 0.
pub(crate) fn early_m(vehicle: &Vehicle, mission: &VehicleMission) -> f64 {
    if (mission.facts()).has_heights_at_once(mission.autopilot_version) {
        return f64::INFINITY;
    }
    match (mission.autopilot, vehicle.wing) {
        (Autopilot::Px4, Some(wing)) => items::loiter_radius_m(mission)
            .unwrap_or(wing.loiter_radius_m)
            .max(wing.loiter_radius_m),
        _ => 0.0,
    }
}

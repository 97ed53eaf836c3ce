//! How late and how early wings follow a commanded altitude: what autopilots were measured to do.

use crate::mission::{ALTITUDE_SLOPE_MIN, VehicleMission};
use crate::spec::{Autopilot, Vehicle};

use super::items;

/// Default of `ALT_SLOPE_MIN` (`ArduPlane/Parameters.cpp`, 4.7.0-dev of December 2025), metres.
pub const SLOPE_MIN_M: f64 = 15.0;

/// Lag below an upward slope and above a downward one, seconds of the climb rate
/// (`TECS_HDEM_TCONST` is 3): measured on one plane and one QuadPlane, ArduPlane 4.7.0-dev of
/// December 2025, simulated, 3.1 to 3.7 m at 1.15 m/s, 5.2 m at 1.6 m/s, 10.9 m at 2.9 m/s,
/// and most of it still on the next leg.
const LAG_S: f64 = 3.3;
/// The same with PX4: `(1 - FW_T_HRATE_FF) * FW_T_ALT_TC`, by its sources (`TECS.cpp`) and the
/// defaults 0.3 and 5 s; assumed, not measured.
pub const MAX_LAG_S: f64 = 3.5;

/// Changes of altitude from one waypoint to the next that are smaller than this are flown at once
/// (`Plane::set_offset_altitude_location`), metres; 0 except on a wing of ArduPilot.
pub(crate) fn threshold_m(mission: &VehicleMission) -> f64 {
    if mission.autopilot != Autopilot::ArduPilot || !mission.airframe.has_wing() {
        return 0.0;
    }
    let held = mission
        .params
        .iter()
        .find(|param| ALTITUDE_SLOPE_MIN.contains(&param.name.as_str()));
    // Kept as a whole number. With 0 there is no slope at all.
    match held.map_or(SLOPE_MIN_M, |param| f64::from(param.value).trunc()) {
        metres if metres > 0.0 => metres,
        _ => f64::INFINITY,
    }
}

/// Lag behind a slope, seconds of the climb rate; 0 except on a wing.
pub(crate) fn lag_s(mission: &VehicleMission) -> f64 {
    match mission.autopilot {
        _ if !mission.airframe.has_wing() => 0.0,
        Autopilot::ArduPilot => LAG_S,
        Autopilot::Px4 => MAX_LAG_S,
    }
}

/// Distance before a waypoint at which PX4 has its altitude, metres (`FixedWingPositionControl`, the
/// altitude of a leg; assumed, not measured); 0 except on a wing of PX4.
pub(crate) fn early_m(vehicle: &Vehicle, mission: &VehicleMission) -> f64 {
    match (mission.autopilot, vehicle.wing) {
        (Autopilot::Px4, Some(wing)) => items::loiter_radius_m(mission)
            .unwrap_or(wing.loiter_radius_m)
            .max(wing.loiter_radius_m),
        _ => 0.0,
    }
}

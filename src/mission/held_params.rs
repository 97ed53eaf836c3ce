//! What a vehicle does with the parameters that its mission has.

use super::item::VehicleMission;
use crate::autopilot::{Autopilot, COPTER_LEAN, PX4_LEAN, ParameterRow, command, facts, parameter};

/// The greatest lean angle that the mission's parameters allow a copter, degrees.
#[must_use]
pub fn lean_limit_deg(mission: &VehicleMission) -> Option<f64> {
    let mut names = COPTER_LEAN.into_iter().chain([PX4_LEAN]);
    names.find_map(|name| mission.param_si(name))
}

/// Whether a parameter is the greatest lean angle of a copter: a vehicle that may lean more than
/// the plan needs is as good.
#[must_use]
pub fn is_lean_limit(name: &str) -> bool {
    name == PX4_LEAN || COPTER_LEAN.contains(&name)
}

/// The cruise speed that the mission's parameters set, m/s.
#[must_use]
pub fn cruise_speed_mps(mission: &VehicleMission) -> Option<f64> {
    let name = facts(mission.autopilot, mission.airframe)
        .defaults
        .cruise_parameter;
    let held = mission.param_si(name).filter(|mps| *mps > 0.0)?;
    Some(within_speeds_mps(mission, held))
}

/// The speed at which a mission begins, m/s: its own cruise speed, or the planned one where the parameters of PX4 keep
/// that down. None where no parameter says.
#[must_use]
pub fn first_speed_mps(mission: &VehicleMission, planned_mps: f64) -> Option<f64> {
    let within_mps = within_speeds_mps(mission, planned_mps);
    let is_limited = mission.autopilot == Autopilot::Px4 && within_mps < planned_mps;
    cruise_speed_mps(mission).or(is_limited.then_some(within_mps))
}

/// The speed that a vehicle flies where one is commanded, m/s: it keeps it within the least and the
/// greatest of its parameters, where the mission has them.
#[must_use]
pub fn within_speeds_mps(mission: &VehicleMission, speed_mps: f64) -> f64 {
    let names = mission.facts().defaults.speed_parameters;
    let held = names.map(|name| mission.param_si(name?).filter(|mps| *mps > 0.0));
    let min_mps = held[0].unwrap_or(0.0);
    speed_mps.min(held[1].unwrap_or(f64::INFINITY)).max(min_mps)
}

/// The radius within which a copter accepts the place of a row (0 for home), metres: PX4's own of
/// the item, that of the mission's parameters, or the default.
#[must_use]
pub fn acceptance_m(mission: &VehicleMission, row: usize) -> f64 {
    let is_usable = |radius_m: &f64| radius_m.is_finite() && *radius_m > 0.0;
    let name = match mission.autopilot {
        Autopilot::ArduPilot => "WPNAV_RADIUS",
        Autopilot::Px4 => "NAV_ACC_RAD",
    };
    let item = row
        .checked_sub(1)
        .and_then(|index| mission.items.get(index));
    let own_m = item
        .filter(|item| mission.autopilot == Autopilot::Px4 && item.command == command::NAV_WAYPOINT)
        .map(|item| f64::from(item.params[1]))
        .filter(is_usable);
    let held_m = mission.param_si(name).filter(is_usable);
    let row = mission.facts().parameter(name).or(parameter(name));
    let default_m = row.map_or(0.0, ParameterRow::default_si);
    own_m.or(held_m).unwrap_or(default_m)
}

/// The acceleration within which `ArduCopter` begins a corner, m/s^2: `WPNAV_ACCEL_C`, 0 for twice
/// `WPNAV_ACCEL`, the default.
#[must_use]
pub fn corner_accel_mps2(accel_mps2: f64, mission: Option<&VehicleMission>) -> f64 {
    let held = mission.and_then(|of| of.param_si("WPNAV_ACCEL_C"));
    held.filter(|held| *held > 0.0).unwrap_or(2.0 * accel_mps2)
}

/// How fast `ArduCopter` changes its acceleration, m/s^3: `WPNAV_JERK`.
#[must_use]
pub fn jerk_mps3(mission: &VehicleMission) -> f64 {
    let name = "WPNAV_JERK";
    let held = mission.param_si(name).filter(|held| *held > 0.0);
    held.unwrap_or_else(|| parameter(name).map_or(1.0, ParameterRow::default_si))
}

/// The parameter of `ArduCopter` that has how fast it comes down to place a load.
pub(super) const PLACING: &str = "PLDP_SPEED_DN";

/// How fast the parameters of a mission let a copter come down to place a load, m/s; 0: as at the end of a
/// landing. None where they do not say.
#[must_use]
pub fn placing_mps(mission: &VehicleMission) -> Option<f64> {
    mission.param_si(PLACING)
}

//! Whether a copter can fly its speed at the lean angle that it comes with.

use crate::spec::{Airframe, Autopilot, Vehicle, Wind};

/// Why a copter may not reach a ground speed in a wind, in words; none where no figure is known
/// of its autopilot ([`crate::autopilot::Behaviour::lean_speed_mps`]), or it was flown.
#[must_use]
pub fn lean_problem(vehicle: &Vehicle, ground_mps: f64, wind: Option<Wind>) -> Option<String> {
    if vehicle.airframe != Airframe::Copter {
        return None;
    }
    let facts = vehicle.facts();
    let reached = facts
        .behaviour
        .lean_speed_mps
        .of(vehicle.autopilot_version)?;
    let lean = match vehicle.autopilot {
        Autopilot::ArduPilot => "ANGLE_MAX",
        Autopilot::Px4 => "MPC_TILTMAX_AIR",
    };
    let air_mps = ground_mps + wind.map_or(0.0, |wind| wind.speed_mps);
    (air_mps > reached.value).then(|| {
        format!(
            "{}: {air_mps:.1} m/s through the air (against the wind) is faster than the {reached} that a stock {} \
             {} reached at its lean limit: it may be later than the verdict assumes; raise {lean} as far as its \
             thrust allows, or lower speed_mps",
            vehicle.id, facts.firmware, reached.version
        )
    })
}

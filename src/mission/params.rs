//! Autopilot parameters that the verdict assumes.
//!
//! Names as in ArduCopter 4.6 (centimetres) and PX4 1.16 to 1.18 (metres).

use super::item::Parameter;
use crate::path::{SLOW_LANDING_M, VehicleLimits, slow_landing_mps};
use crate::spec::{Autopilot, MissionOptions, Vehicle};

/// Turn radius of a vehicle at its planned speed, metres.
#[must_use]
pub fn turn_radius_m(vehicle: &Vehicle) -> f64 {
    VehicleLimits::of(vehicle).turn_radius_m
}

/// The acceleration across the path that makes the planned turn radius, m/s^2.
fn corner_accel_mps2(vehicle: &Vehicle) -> f64 {
    vehicle.speed_mps * vehicle.speed_mps / turn_radius_m(vehicle)
}

/// The parameters for one vehicle.
pub(super) fn parameters(
    vehicle: &Vehicle,
    options: &MissionOptions,
    home_amsl_m: f64,
    has_fence: bool,
) -> Vec<Parameter> {
    match vehicle.autopilot {
        Autopilot::ArduPilot => ardupilot(vehicle, options, home_amsl_m, has_fence),
        Autopilot::Px4 => px4(vehicle, options, home_amsl_m, has_fence),
    }
}

fn ardupilot(
    vehicle: &Vehicle,
    options: &MissionOptions,
    home_amsl_m: f64,
    has_fence: bool,
) -> Vec<Parameter> {
    let mut list = List::default();
    list.add(
        "WPNAV_SPEED",
        vehicle.speed_mps * 100.0,
        "planned ground speed, cm/s",
    );
    list.add(
        "WPNAV_ACCEL",
        vehicle.accel_mps2 * 100.0,
        "planned acceleration, cm/s^2",
    );
    list.add(
        "WPNAV_ACCEL_C",
        corner_accel_mps2(vehicle) * 100.0,
        "acceleration in corners that gives the planned turn radius, cm/s^2",
    );
    list.add(
        "WPNAV_SPEED_UP",
        vehicle.climb_mps * 100.0,
        "planned climb, cm/s",
    );
    list.add(
        "WPNAV_SPEED_DN",
        vehicle.descent_mps * 100.0,
        "planned descent, cm/s",
    );
    list.add(
        "WPNAV_RADIUS",
        corner_cut_m(options) * 100.0,
        "how far a corner may be cut, cm: mission.tolerance_m",
    );
    list.add(
        "LAND_SPEED_HIGH",
        0.0,
        "land at WPNAV_SPEED_DN until LAND_ALT_LOW",
    );
    list.add(
        "LAND_ALT_LOW",
        SLOW_LANDING_M * 100.0,
        "height of the slow end of a landing, cm",
    );
    list.add(
        "LAND_SPEED",
        slow_landing_mps(vehicle.autopilot) * 100.0,
        "speed of the slow end of a landing, cm/s",
    );
    if vehicle.depart_s > 0.0 {
        list.add(
            "DISARM_DELAY",
            0.0,
            "stay armed on the ground until the departure",
        );
    }
    if let Some(amsl) = vehicle.return_amsl {
        list.add(
            "RTL_ALT",
            (amsl.0 - home_amsl_m) * 100.0,
            "altitude of a return to launch above home, cm: return_amsl_m",
        );
        list.add("RTL_CONE_SLOPE", 0.0, "climb so high however near home");
        list.add("RTL_CLIMB_MIN", 0.0, "and no higher");
        list.add("RTL_LOIT_TIME", 0.0, "do not wait over home");
        list.add("RTL_ALT_FINAL", 0.0, "land there");
    }
    if has_fence {
        list.add("FENCE_ENABLE", 1.0, "the fence that was written is watched");
        list.add(
            "FENCE_TYPE",
            4.0,
            "polygons and circles; altitudes are judged beforehand",
        );
        list.add(
            "FENCE_ACTION",
            4.0,
            "brake, or land: a return would fly a leg nobody judged",
        );
    }
    list.parameters
}

fn px4(
    vehicle: &Vehicle,
    options: &MissionOptions,
    home_amsl_m: f64,
    has_fence: bool,
) -> Vec<Parameter> {
    let mut list = List::default();
    list.add(
        "MPC_XY_CRUISE",
        vehicle.speed_mps,
        "planned ground speed; here and not DO_CHANGE_SPEED, with which a copter was seen to drift off",
    );
    list.add(
        "MPC_XY_VEL_MAX",
        vehicle.speed_mps.max(12.0),
        "must not be below MPC_XY_CRUISE",
    );
    list.add("MPC_ACC_HOR", vehicle.accel_mps2, "planned acceleration");
    list.add("MPC_Z_V_AUTO_UP", vehicle.climb_mps, "planned climb");
    list.add("MPC_Z_V_AUTO_DN", vehicle.descent_mps, "planned descent");
    list.add(
        "MPC_Z_VEL_MAX_UP",
        vehicle.climb_mps.max(3.0),
        "must not be below MPC_Z_V_AUTO_UP",
    );
    list.add(
        "MPC_Z_VEL_MAX_DN",
        vehicle.descent_mps.max(1.5),
        "must not be below MPC_Z_V_AUTO_DN",
    );
    list.add(
        "MPC_TKO_SPEED",
        vehicle.climb_mps,
        "planned climb at takeoff",
    );
    list.add(
        "MPC_LAND_SPEED",
        slow_landing_mps(vehicle.autopilot),
        "speed of the slow end of a landing",
    );
    list.add(
        ACCEPTANCE_RADIUS,
        corner_cut_m(options),
        "how far a corner may be cut: mission.tolerance_m",
    );
    if vehicle.depart_s > 0.0 {
        list.add(
            "COM_DISARM_PRFLT",
            -1.0,
            "stay armed on the ground until the departure",
        );
    }
    if let Some(amsl) = vehicle.return_amsl {
        list.add(
            "RTL_RETURN_ALT",
            amsl.0 - home_amsl_m,
            "altitude of a return above home: return_amsl_m",
        );
        list.add("RTL_CONE_ANG", 0.0, "climb so high however near home");
        list.add("RTL_LAND_DELAY", 0.0, "do not wait over home, land there");
    }
    if has_fence {
        list.add(
            "GF_ACTION",
            2.0,
            "hold at the fence: a return would fly a leg nobody judged",
        );
    }
    list.parameters
}

/// PX4's acceptance radius; the takeoff altitude must be above it.
pub(super) const ACCEPTANCE_RADIUS: &str = "NAV_ACC_RAD";

/// How far a corner may be cut: the tolerance, within what both autopilots take, metres.
/// `WPNAV_RADIUS` and `NAV_ACC_RAD` are set to it.
#[must_use]
pub fn corner_cut_m(options: &MissionOptions) -> f64 {
    options.tolerance_m.clamp(1.0, 10.0)
}

#[derive(Default)]
struct List {
    parameters: Vec<Parameter>,
}

impl List {
    fn add(&mut self, name: &str, value: f64, why: &str) {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "parameters are float32 on the wire"
        )]
        let value = value as f32;
        self.parameters.push(Parameter {
            name: name.to_owned(),
            value,
            why: why.to_owned(),
        });
    }
}

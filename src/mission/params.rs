//! Autopilot parameters that the verdict assumes.
//!
//! Names as in ArduCopter 4.6 (centimetres), ArduPlane 4.6 (metres) and PX4 1.16 to 1.18 (metres).
//! Where a later firmware has another name, both are written, and a vehicle knows one of them.

use super::item::{Parameter, VehicleMission};
use crate::geodesy::Amsl;
use crate::path::{SLOW_LANDING_M, VehicleLimits, slow_landing_mps};
use crate::spec::{Airframe, Autopilot, MissionOptions, Vehicle, Wing, turn_radius_by_load_m};

/// Turn radius of a vehicle at its planned speed, metres.
#[must_use]
pub fn turn_radius_m(vehicle: &Vehicle) -> f64 {
    VehicleLimits::of(vehicle).turn_radius_m
}

/// The acceleration across the path that makes the planned turn radius, m/s^2.
fn corner_accel_mps2(vehicle: &Vehicle) -> f64 {
    vehicle.speed_mps * vehicle.speed_mps / turn_radius_m(vehicle)
}

/// The parameters for one vehicle whose home is so high above the sea, with or without a fence.
#[must_use]
pub fn parameters(
    vehicle: &Vehicle,
    options: &MissionOptions,
    home_amsl_m: f64,
    has_fence: bool,
) -> Vec<Parameter> {
    match (vehicle.autopilot, vehicle.wing) {
        (Autopilot::ArduPilot, None) => ardupilot(vehicle, options, home_amsl_m, has_fence),
        (Autopilot::Px4, None) => px4(vehicle, options, home_amsl_m, has_fence),
        (Autopilot::ArduPilot, Some(wing)) => arduplane(vehicle, &wing, has_fence),
        (Autopilot::Px4, Some(wing)) => px4_wing(vehicle, &wing, options, has_fence),
    }
}

/// The cruise speed that the mission's parameters set, m/s.
#[must_use]
pub fn cruise_speed_mps(mission: &VehicleMission) -> Option<f64> {
    let of = |name: &str| {
        let found = mission.params.iter().find(|param| param.name == name)?;
        Some(f64::from(found.value))
    };
    match (mission.autopilot, mission.airframe.has_wing()) {
        (Autopilot::ArduPilot, false) => of("WPNAV_SPEED").map(|cm| cm / 100.0),
        (Autopilot::Px4, false) => of("MPC_XY_CRUISE"),
        (Autopilot::ArduPilot, true) => of("AIRSPEED_CRUISE"),
        (Autopilot::Px4, true) => of("FW_AIRSPD_TRIM"),
    }
    .filter(|speed| speed.is_finite() && *speed > 0.0)
}

/// The radius within which a copter accepts the place of a row (0 for home), metres: PX4's own of
/// the item, that of the mission's parameters, or the default.
#[must_use]
pub fn acceptance_m(mission: &VehicleMission, row: usize) -> f64 {
    let is_usable = |radius_m: &f64| radius_m.is_finite() && *radius_m > 0.0;
    let of = |name: &str, unit_m: f64| {
        let found = mission.params.iter().find(|param| param.name == name)?;
        Some(f64::from(found.value) * unit_m).filter(is_usable)
    };
    let held = match mission.autopilot {
        Autopilot::ArduPilot => of("WPNAV_RADIUS", 0.01),
        Autopilot::Px4 => {
            let item = row.checked_sub(1).and_then(|index| mission.items.get(index));
            item.filter(|item| item.command == command::NAV_WAYPOINT)
                .map(|item| f64::from(item.params[1]))
                .filter(is_usable)
                .or_else(|| of(ACCEPTANCE_RADIUS, 1.0))
        }
    };
    held.unwrap_or_else(|| default_acceptance_m(mission.autopilot))
}

/// The smallest change of altitude that ArduPlane spreads along a leg, whole metres: its name since
/// 4.7, and before that.
pub const ALTITUDE_SLOPE_MIN: [&str; 2] = ["ALT_SLOPE_MIN", "GLIDE_SLOPE_MIN"];

/// The other name of a parameter that has two.
#[must_use]
pub fn other_name(name: &str) -> Option<&'static str> {
    let [new, old] = ALTITUDE_SLOPE_MIN;
    match name {
        _ if name == new => Some(old),
        _ if name == old => Some(new),
        _ => None,
    }
}

/// Share of the planned airspeed below which a QuadPlane's rotors may help. With 18 at a planned
/// 18 m/s they did some 40 times on one way, and it sank 36 m under its line (ArduPlane 4.7.0-dev of
/// December 2025, simulated).
const ASSIST_SHARE: f64 = 0.7;

/// Bank at which the planned load factor is reached, degrees.
fn bank_deg(vehicle: &Vehicle) -> f64 {
    (1.0 / vehicle.max_load_factor).acos().to_degrees()
}

/// ArduPlane 4.6, and its QuadPlane.
fn arduplane(vehicle: &Vehicle, wing: &Wing, has_fence: bool) -> Vec<Parameter> {
    let mut list = List::default();
    let (climb, descent) = ("planned climb, m/s", "planned descent, m/s");
    list.add(
        "AIRSPEED_CRUISE",
        vehicle.speed_mps,
        "planned speed, m/s, indicated airspeed",
    );
    list.add(
        "ROLL_LIMIT_DEG",
        bank_deg(vehicle),
        "bank of max_load_factor",
    );
    list.add("TECS_CLMB_MAX", vehicle.climb_mps, climb);
    list.add("TECS_SINK_MAX", vehicle.descent_mps, descent);
    list.add(
        "WP_RADIUS",
        turn_radius_by_load_m(
            vehicle.fastest_at_mps(vehicle.speed_mps, Amsl(0.0)),
            vehicle.max_load_factor,
        )
        .ceil(),
        "turns onto the next leg begin no further before a waypoint than this, at sea level",
    );
    let [new, old] = ALTITUDE_SLOPE_MIN;
    list.add(new, 1.0, "smaller changes of altitude are flown at once, m");
    list.add(old, 1.0, "the same before ArduPlane 4.7");
    list.add(
        "WP_LOITER_RAD",
        wing.loiter_radius_m,
        "radius of circles where no item states one",
    );
    if vehicle.airframe == Airframe::Vtol {
        list.add(
            "Q_ASSIST_SPEED",
            (ASSIST_SHARE * vehicle.speed_mps).floor(),
            "airspeed below which the rotors help, not at the planned one, m/s",
        );
        list.add(
            "Q_WP_SPEED_UP",
            vehicle.climb_mps * 100.0,
            "planned climb on rotors, cm/s",
        );
        list.add(
            "Q_WP_SPEED_DN",
            vehicle.descent_mps * 100.0,
            "planned descent on rotors, cm/s",
        );
        list.add(
            "Q_LAND_FINAL_ALT",
            SLOW_LANDING_M,
            "height of the slow end of a landing, m",
        );
        list.add(
            "Q_LAND_FINAL_SPD",
            slow_landing_mps(vehicle.autopilot),
            "speed of the slow end of a landing, m/s",
        );
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
            0.0,
            "report only: a return would fly a leg nobody judged",
        );
    }
    list.parameters
}

/// PX4 fixed wing and VTOL.
fn px4_wing(
    vehicle: &Vehicle,
    wing: &Wing,
    options: &MissionOptions,
    has_fence: bool,
) -> Vec<Parameter> {
    let mut list = List::default();
    let (climb, descent) = ("planned climb, m/s", "planned descent, m/s");
    list.add(
        "FW_AIRSPD_TRIM",
        vehicle.speed_mps,
        "planned speed, m/s, indicated airspeed",
    );
    list.add("FW_R_LIM", bank_deg(vehicle), "bank of max_load_factor");
    list.add("FW_T_CLMB_MAX", vehicle.climb_mps, climb);
    list.add("FW_T_CLMB_R_SP", vehicle.climb_mps, climb);
    list.add("FW_T_SINK_MAX", vehicle.descent_mps, descent);
    list.add("FW_T_SINK_R_SP", vehicle.descent_mps, descent);
    list.add(
        "NAV_LOITER_RAD",
        wing.loiter_radius_m,
        "radius of circles where no item states one",
    );
    list.add(
        ACCEPTANCE_RADIUS,
        corner_cut_m(options),
        "a waypoint is reached within this: mission.tolerance_m",
    );
    list.add(
        "NAV_FW_ALT_RAD",
        ANY_HEIGHT_M,
        "a waypoint is passed so far off its altitude, m: PX4 would circle there, on a way nobody judged",
    );
    if let (Airframe::Plane, Some(landing)) = (vehicle.airframe, wing.landing) {
        list.add(
            STEEPEST_GLIDE,
            landing.glide_rad.to_degrees(),
            "steepest glide that is not refused: landing.glide_deg",
        );
    }
    if vehicle.airframe == Airframe::Vtol {
        px4_vertical_speeds(
            &mut list,
            vehicle,
            ["planned climb on rotors", "planned descent on rotors"],
        );
    }
    if vehicle.depart_s > 0.0 {
        list.add(
            "COM_DISARM_PRFLT",
            -1.0,
            "stay armed on the ground until the departure",
        );
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

/// PX4's widest acceptance of altitudes (`NAV_FW_ALT_RAD`), metres.
const ANY_HEIGHT_M: f64 = 200.0;

/// PX4's steepest glide, degrees; a landing on a steeper one is refused.
pub(super) const STEEPEST_GLIDE: &str = "FW_LND_ANG";

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

/// What PX4 climbs and descends with on rotors, and how planned climb and descent are called.
fn px4_vertical_speeds(list: &mut List, vehicle: &Vehicle, [climb, descent]: [&str; 2]) {
    list.add("MPC_Z_V_AUTO_UP", vehicle.climb_mps, climb);
    list.add("MPC_Z_V_AUTO_DN", vehicle.descent_mps, descent);
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
    px4_vertical_speeds(&mut list, vehicle, ["planned climb", "planned descent"]);
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

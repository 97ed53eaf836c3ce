//! Autopilot parameters that Sortie writes, assumes or simulates: names, defaults, units.
//!
//! Names and defaults as in ArduCopter and ArduPlane 4.6 and PX4 1.16 to 1.18. A parameter that a
//! version renamed has a row for each name.

mod judged;

use super::command;
use super::version::{Version, VersionRange, version};
pub use judged::Judged;
pub(super) use judged::{COPTER_JUDGED, PLANE_JUDGED, PX4_JUDGED, QUADPLANE_JUDGED, WING_JUDGED};

/// Unit of the number that an autopilot stores.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A number, a bit field or a choice.
    Number,
    /// m.
    M,
    /// cm.
    Cm,
    /// m/s.
    Mps,
    /// cm/s.
    CmPs,
    /// m/s^2.
    Mps2,
    /// cm/s^2.
    CmPs2,
    /// s.
    S,
    /// ms.
    Ms,
    /// Degrees.
    Deg,
    /// Hundredths of a degree.
    CDeg,
}

impl Unit {
    /// How many of it make one SI unit; degrees stay degrees.
    #[must_use]
    pub const fn per_si(self) -> f64 {
        match self {
            Self::Cm | Self::CmPs | Self::CmPs2 | Self::CDeg => 100.0,
            Self::Ms => 1000.0,
            Self::Number | Self::M | Self::Mps | Self::Mps2 | Self::S | Self::Deg => 1.0,
        }
    }
}

/// One parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterRow {
    /// Name in the autopilot.
    pub name: &'static str,
    /// The value that a vehicle comes with, in `unit`.
    pub default: f32,
    /// Unit of its values.
    pub unit: Unit,
    /// Whether PX4 stores it as `int32`.
    pub is_int32: bool,
    /// The versions that have it.
    pub versions: VersionRange,
}

impl ParameterRow {
    /// The default in SI units; degrees stay degrees.
    #[must_use]
    pub fn default_si(&self) -> f64 {
        f64::from(self.default) / self.unit.per_si()
    }
}

const fn p(name: &'static str, default: f32, unit: Unit) -> ParameterRow {
    ParameterRow {
        name,
        default,
        unit,
        is_int32: false,
        versions: VersionRange::ALL,
    }
}

const fn int32(row: ParameterRow) -> ParameterRow {
    ParameterRow {
        is_int32: true,
        ..row
    }
}

const fn of(versions: VersionRange, row: ParameterRow) -> ParameterRow {
    ParameterRow { versions, ..row }
}

/// A name that 4.7 replaced, or that it began to have.
const fn until_4_7(row: ParameterRow) -> ParameterRow {
    of(VersionRange::before(version(4, 7)), row)
}

const fn since_4_7(row: ParameterRow) -> ParameterRow {
    of(VersionRange::since(version(4, 7)), row)
}

/// A name of ArduPlane until 4.4.
const fn until_4_5(row: ParameterRow) -> ParameterRow {
    of(VersionRange::before(version(4, 5)), row)
}

use Unit::{CDeg, Cm, CmPs, CmPs2, Deg, M, Mps, Mps2, Ms, Number, S};

/// ArduCopter.
pub(super) const ARDUCOPTER: &[ParameterRow] = &[
    until_4_7(p("WPNAV_SPEED", 1000.0, CmPs)),
    since_4_7(p("WP_SPD", 10.0, Mps)),
    until_4_7(p("WPNAV_ACCEL", 250.0, CmPs2)),
    since_4_7(p("WP_ACC", 2.5, Mps2)),
    // 0: twice WPNAV_ACCEL.
    until_4_7(p("WPNAV_ACCEL_C", 0.0, CmPs2)),
    since_4_7(p("WP_ACC_CNR", 0.0, Mps2)),
    // m/s^3.
    until_4_7(p("WPNAV_JERK", 1.0, Number)),
    since_4_7(p("WP_JERK", 1.0, Number)),
    until_4_7(p("WPNAV_ACCEL_Z", 100.0, CmPs2)),
    since_4_7(p("WP_ACC_Z", 1.0, Mps2)),
    until_4_7(p("WPNAV_SPEED_UP", 250.0, CmPs)),
    since_4_7(p("WP_SPD_UP", 2.5, Mps)),
    until_4_7(p("WPNAV_SPEED_DN", 150.0, CmPs)),
    since_4_7(p("WP_SPD_DN", 1.5, Mps)),
    until_4_7(p("WPNAV_RADIUS", 200.0, Cm)),
    since_4_7(p("WP_RADIUS_M", 2.0, M)),
    until_4_7(p("CIRCLE_RADIUS", 1000.0, Cm)),
    since_4_7(p("CIRCLE_RADIUS_M", 10.0, M)),
    p("CIRCLE_RATE", 20.0, Deg),
    p("TERRAIN_ENABLE", 1.0, Number),
    p("TERRAIN_SPACING", 100.0, M),
    until_4_7(p("LAND_SPEED_HIGH", 0.0, CmPs)),
    since_4_7(p("LAND_SPD_HIGH_MS", 0.0, Mps)),
    until_4_7(p("LAND_ALT_LOW", 1000.0, Cm)),
    since_4_7(p("LAND_ALT_LOW_M", 10.0, M)),
    until_4_7(p("LAND_SPEED", 50.0, CmPs)),
    since_4_7(p("LAND_SPD_MS", 0.5, Mps)),
    // 0: LAND_SPEED.
    p("PLDP_SPEED_DN", 0.0, Mps),
    p("DISARM_DELAY", 10.0, S),
    until_4_7(p("RTL_ALT", 1500.0, Cm)),
    since_4_7(p("RTL_ALT_M", 15.0, M)),
    p("RTL_ALT_TYPE", 0.0, Number),
    p("RTL_CONE_SLOPE", 3.0, Number),
    until_4_7(p("RTL_CLIMB_MIN", 0.0, Cm)),
    since_4_7(p("RTL_CLIMB_MIN_M", 0.0, M)),
    p("RTL_LOIT_TIME", 5000.0, Ms),
    until_4_7(p("RTL_ALT_FINAL", 0.0, Cm)),
    since_4_7(p("RTL_ALT_FINAL_M", 0.0, M)),
    // 0: WPNAV_SPEED.
    until_4_7(p("RTL_SPEED", 0.0, CmPs)),
    since_4_7(p("RTL_SPEED_MS", 0.0, Mps)),
    p("FENCE_ENABLE", 0.0, Number),
    p("FENCE_AUTOENABLE", 0.0, Number),
    p("FENCE_TYPE", 7.0, Number),
    p("FENCE_ACTION", 1.0, Number),
    p("FENCE_ALT_MAX", 100.0, M),
    p("FENCE_ALT_MIN", -10.0, M),
    p("FENCE_RADIUS", 300.0, M),
    p("FENCE_MARGIN", 2.0, M),
    until_4_7(p(COPTER_LEAN[1], 3000.0, CDeg)),
    since_4_7(p(COPTER_LEAN[0], 30.0, Deg)),
    // 0: the greatest lean angle.
    p("PSC_ANGLE_MAX", 0.0, Deg),
    p("OA_TYPE", 0.0, Number),
];

/// ArduPlane (defaults of L1 and slope also in `AP_L1_Control.cpp`, `ArduPlane/Parameters.cpp`).
pub(super) const ARDUPLANE: &[ParameterRow] = &[
    p("AIRSPEED_CRUISE", 12.0, Mps),
    until_4_5(p("TRIM_ARSPD_CM", 1200.0, CmPs)),
    p("AIRSPEED_MIN", 9.0, Mps),
    p("TERRAIN_ENABLE", 1.0, Number),
    p("TERRAIN_SPACING", 100.0, M),
    until_4_5(p("ARSPD_FBW_MIN", 9.0, Mps)),
    p("AIRSPEED_MAX", 22.0, Mps),
    until_4_5(p("ARSPD_FBW_MAX", 22.0, Mps)),
    p("ROLL_LIMIT_DEG", 45.0, Deg),
    until_4_5(p("LIM_ROLL_CD", 4500.0, CDeg)),
    p("NAVL1_PERIOD", 17.0, S),
    p("NAVL1_DAMPING", 0.75, Number),
    // 0: circles are wider the higher, by the square of true over equivalent airspeed.
    p("NAVL1_LIM_BANK", 0.0, Deg),
    p("WP_RADIUS", 90.0, M),
    p("WP_LOITER_RAD", 60.0, M),
    // Whole metres; the smallest change of altitude that is spread along a leg.
    until_4_7(p(SLOPE_MIN[1], 15.0, M)),
    since_4_7(p(SLOPE_MIN[0], 15.0, M)),
    p("TECS_CLMB_MAX", 5.0, Mps),
    p("TECS_SINK_MAX", 5.0, Mps),
    p("TECS_HDEM_TCONST", 3.0, S),
    p("TECS_TIME_CONST", 5.0, S),
    p("TECS_LAND_SINK", 0.25, Mps),
    p("LAND_FLARE_ALT", 3.0, M),
    p("LAND_FLARE_SEC", 2.0, S),
    p("LAND_DISARMDELAY", 20.0, S),
    p("RTL_ALTITUDE", 100.0, M),
    until_4_5(p("ALT_HOLD_RTL", 10_000.0, Cm)),
    // 0: WP_LOITER_RAD.
    p("RTL_RADIUS", 0.0, M),
    p("RTL_AUTOLAND", 0.0, Number),
    // Above 0 a waypoint that is missed by more is circled.
    p("WP_MAX_RADIUS", 0.0, M),
    p("FLIGHT_OPTIONS", 0.0, Number),
    p("MIN_GROUNDSPEED", 0.0, Mps),
    until_4_5(p("MIN_GNDSPD_CM", 0.0, CmPs)),
    p("SOAR_ENABLE", 0.0, Number),
    // As its simulators have them; a vehicle comes with 0, 0 and 0.
    p("ARSPD_ENABLE", 1.0, Number),
    p("ARSPD_TYPE", 2.0, Number),
    p("ARSPD_USE", 1.0, Number),
    p("FENCE_ENABLE", 0.0, Number),
    p("FENCE_TYPE", 4.0, Number),
    p("FENCE_ACTION", 1.0, Number),
    p("FENCE_MARGIN", 2.0, M),
];

/// The smallest change of altitude that ArduPlane spreads along a leg: its name since 4.7, and
/// before that.
pub const SLOPE_MIN: [&str; 2] = ["ALT_SLOPE_MIN", "GLIDE_SLOPE_MIN"];

/// The greatest lean angle of ArduCopter: its name since 4.7, and before that.
pub const COPTER_LEAN: [&str; 2] = ["ATC_ANGLE_MAX", "ANGLE_MAX"];

/// The greatest lean angle of PX4 on rotors.
pub const PX4_LEAN: &str = "MPC_TILTMAX_AIR";

/// A QuadPlane, besides those of ArduPlane.
pub(super) const QUADPLANE: &[ParameterRow] = &[
    p("Q_ENABLE", 1.0, Number),
    p("Q_OPTIONS", 0.0, Number),
    p("Q_ASSIST_SPEED", 0.0, Mps),
    p("Q_TRANS_DECEL", 2.0, Mps2),
    until_4_7(p("Q_WP_SPEED_UP", 250.0, CmPs)),
    since_4_7(p("Q_WP_SPD_UP", 2.5, Mps)),
    until_4_7(p("Q_WP_SPEED_DN", 150.0, CmPs)),
    since_4_7(p("Q_WP_SPD_DN", 1.5, Mps)),
    p("Q_RTL_MODE", 0.0, Number),
    p("Q_LAND_FINAL_ALT", 6.0, M),
    p("Q_LAND_FINAL_SPD", 0.5, Mps),
];

/// PX4 on rotors.
pub(super) const PX4_ROTORS: &[ParameterRow] = &[
    p("MPC_XY_CRUISE", 5.0, Mps),
    p("MPC_XY_VEL_MAX", 12.0, Mps),
    // Below 0: none of the parameters that they would set are set.
    p("MPC_XY_VEL_ALL", -10.0, Mps),
    p("MPC_Z_VEL_ALL", -3.0, Mps),
    p("SYS_VEHICLE_RESP", -0.4, Number),
    p("MPC_ACC_HOR", 3.0, Mps2),
    p("MPC_ACC_UP_MAX", 4.0, Mps2),
    p("MPC_Z_V_AUTO_UP", 3.0, Mps),
    p("MPC_Z_V_AUTO_DN", 1.5, Mps),
    p("MPC_Z_VEL_MAX_UP", 3.0, Mps),
    p("MPC_Z_VEL_MAX_DN", 1.5, Mps),
    p("MPC_TKO_SPEED", 1.5, Mps),
    p(PX4_LEAN, 45.0, Deg),
    p("MPC_LAND_SPEED", 0.7, Mps),
    p("MPC_LAND_ALT1", 10.0, M),
    p("MPC_LAND_ALT2", 5.0, M),
    // A waypoint is reached only within this of its altitude.
    p("NAV_MC_ALT_RAD", 0.8, M),
    p("COM_DISARM_PRFLT", 10.0, S),
    // `rc.mc_defaults`; a VTOL has 60.
    p("RTL_RETURN_ALT", 30.0, M),
    int32(p("RTL_TYPE", 0.0, Number)),
    // 0: none.
    p("GF_MAX_HOR_DIST", 0.0, M),
    p("GF_MAX_VER_DIST", 0.0, M),
    int32(p("RTL_CONE_ANG", 45.0, Deg)),
    p("RTL_MIN_DIST", 10.0, M),
    p("RTL_LAND_DELAY", 0.0, S),
    int32(p("GF_ACTION", 2.0, Number)),
];

/// PX4 on a wing.
pub(super) const PX4_WING: &[ParameterRow] = &[
    p("FW_AIRSPD_TRIM", 15.0, Mps),
    p("FW_AIRSPD_MIN", 10.0, Mps),
    p("FW_AIRSPD_MAX", 20.0, Mps),
    p("FW_GND_SPD_MIN", 5.0, Mps),
    p("FW_R_LIM", 50.0, Deg),
    p("FW_T_CLMB_MAX", 5.0, Mps),
    p("FW_T_CLMB_R_SP", 3.0, Mps),
    p("FW_T_SINK_MAX", 5.0, Mps),
    p("FW_T_SINK_R_SP", 2.0, Mps),
    p("FW_T_ALT_TC", 5.0, S),
    p("FW_T_HRATE_FF", 0.3, Number),
    p("FW_TKO_PITCH_MIN", 10.0, Deg),
    p("FW_LND_ANG", 5.0, Deg),
    p("FW_LND_FLALT", 0.5, M),
    p("FW_LND_FL_TIME", 1.0, S),
    p("FW_LND_FL_SINK", 0.25, Mps),
    p("NPFG_PERIOD", 10.0, S),
    p("NPFG_DAMPING", 0.7, Number),
    p("NPFG_SW_DST_MLT", 0.32, Number),
    p("NAV_ACC_RAD", 10.0, M),
    p("NAV_FW_ALT_RAD", 10.0, M),
    p("NAV_FW_ALTL_RAD", 5.0, M),
    p("NAV_LOITER_RAD", 80.0, M),
    p("COM_DISARM_LAND", 2.0, S),
    p("COM_DISARM_PRFLT", 10.0, S),
    p("RTL_RETURN_ALT", 60.0, M),
    int32(p("GF_ACTION", 2.0, Number)),
];

/// A copter of PX4, besides those on rotors.
pub(super) const PX4_COPTER: &[ParameterRow] = &[
    // `rc.mc_defaults` of every multicopter; `navigator_params.c`, `rc.fw_defaults` and VTOLs have 10.
    p("NAV_ACC_RAD", 2.0, M),
];

/// A VTOL of PX4, besides those of rotors and wing.
pub(super) const PX4_VTOL: &[ParameterRow] = &[p("VT_B_DEC_MSS", 2.0, Mps2)];

/// The row of a parameter, of whichever autopilot.
#[must_use]
pub fn parameter(name: &str) -> Option<&'static ParameterRow> {
    let tables = [
        ARDUCOPTER, ARDUPLANE, QUADPLANE, PX4_ROTORS, PX4_WING, PX4_VTOL, PX4_COPTER,
    ];
    tables.into_iter().flatten().find(|row| row.name == name)
}

/// Parameters that a version renamed, the new name first. ArduPilot 4.7 left centimetres for metres
/// (its wiki, `common-param-name-changes`), ArduPlane 4.5 hundredths (`Plane::load_parameters`).
const RENAMED: &[[&str; 2]] = &[
    SLOPE_MIN,
    COPTER_LEAN,
    ["WP_SPD", "WPNAV_SPEED"],
    ["WP_SPD_UP", "WPNAV_SPEED_UP"],
    ["WP_SPD_DN", "WPNAV_SPEED_DN"],
    ["WP_ACC", "WPNAV_ACCEL"],
    ["WP_ACC_CNR", "WPNAV_ACCEL_C"],
    ["WP_JERK", "WPNAV_JERK"],
    ["WP_ACC_Z", "WPNAV_ACCEL_Z"],
    ["WP_RADIUS_M", "WPNAV_RADIUS"],
    ["CIRCLE_RADIUS_M", "CIRCLE_RADIUS"],
    ["LAND_SPD_MS", "LAND_SPEED"],
    ["LAND_SPD_HIGH_MS", "LAND_SPEED_HIGH"],
    ["LAND_ALT_LOW_M", "LAND_ALT_LOW"],
    ["RTL_ALT_M", "RTL_ALT"],
    ["RTL_ALT_FINAL_M", "RTL_ALT_FINAL"],
    ["RTL_CLIMB_MIN_M", "RTL_CLIMB_MIN"],
    ["RTL_SPEED_MS", "RTL_SPEED"],
    ["Q_WP_SPD_UP", "Q_WP_SPEED_UP"],
    ["Q_WP_SPD_DN", "Q_WP_SPEED_DN"],
    ["AIRSPEED_CRUISE", "TRIM_ARSPD_CM"],
    ["AIRSPEED_MIN", "ARSPD_FBW_MIN"],
    ["AIRSPEED_MAX", "ARSPD_FBW_MAX"],
    ["ROLL_LIMIT_DEG", "LIM_ROLL_CD"],
    ["RTL_ALTITUDE", "ALT_HOLD_RTL"],
    ["MIN_GROUNDSPEED", "MIN_GNDSPD_CM"],
];

/// The other name of a parameter that a version renamed.
#[must_use]
pub fn other_name(name: &str) -> Option<&'static str> {
    RENAMED.iter().find_map(|[new, old]| match name {
        _ if name == *new => Some(*old),
        _ if name == *old => Some(*new),
        _ => None,
    })
}

/// What a value of one parameter is as a value of another: both names may be of one parameter, in
/// different units.
#[must_use]
pub fn in_unit_of(value: f64, from: &str, to: &str) -> f64 {
    let per_si = |name: &str| parameter(name).map_or(1.0, |row| row.unit.per_si());
    value / per_si(from) * per_si(to)
}

/// The name of a parameter in a version, where that is known and renamed it.
#[must_use]
pub fn name_in(name: &'static str, version: Option<Version>) -> &'static str {
    let has = |name: &str| {
        let range = parameter(name).map(|row| row.versions);
        version.is_none_or(|version| range.is_none_or(|range| range.contains(version)))
    };
    match other_name(name) {
        Some(other) if !has(name) && has(other) => other,
        _ => name,
    }
}

/// A fence that is no list of items: a ceiling, a floor and a circle around home, by parameters.
#[derive(Clone, Copy, Debug)]
pub struct ParamFence {
    /// Parameters that switch it on, each by itself; empty: it is on.
    pub switches: &'static [&'static str],
    /// The command of a mission that switches it on, and its `param1` then.
    pub command: Option<(u16, f32)>,
    /// The parameter of what it does; 0: nothing.
    pub action: &'static str,
    /// The parameter with a bit for each kind, and its default.
    pub kinds: Option<(&'static str, u8)>,
    /// Bit of the ceiling, and the parameter of its height above home.
    pub ceiling: (u8, &'static str),
    /// Bit of the circle, and the parameter of its radius.
    pub circle: (u8, &'static str),
    /// Bit of the floor, and the parameter of its height above home, if there is one.
    pub floor: Option<(u8, &'static str)>,
}

/// `AC_Fence`.
pub(super) const ARDUCOPTER_FENCE: ParamFence = ParamFence {
    switches: &["FENCE_ENABLE", "FENCE_AUTOENABLE"],
    // `AP_Mission::start_command_fence`.
    command: Some((command::DO_FENCE_ENABLE, 1.0)),
    action: "FENCE_ACTION",
    kinds: Some(("FENCE_TYPE", 7)),
    ceiling: (1, "FENCE_ALT_MAX"),
    circle: (2, "FENCE_RADIUS"),
    floor: Some((8, "FENCE_ALT_MIN")),
};
pub(super) const ARDUPLANE_FENCE: ParamFence = ParamFence {
    kinds: Some(("FENCE_TYPE", 4)),
    ..ARDUCOPTER_FENCE
};
/// `Geofence::isCloserThanMaxDistToHome`, `Geofence::isBelowMaxAltitude`.
pub(super) const PX4_FENCE: ParamFence = ParamFence {
    switches: &[],
    command: None,
    action: "GF_ACTION",
    kinds: None,
    ceiling: (1, "GF_MAX_VER_DIST"),
    circle: (2, "GF_MAX_HOR_DIST"),
    floor: None,
};

/// Parameters of a landing on rotors.
#[derive(Clone, Copy, Debug)]
pub struct LandingParameters {
    /// Its speed down to the slow end, above 0 instead of that of other descents.
    pub fast: Option<&'static str>,
    /// What none of its speeds exceeds.
    pub most: Option<&'static str>,
    /// Speed of the slow end.
    pub slow: &'static str,
    /// Whether it is at least as fast before the slow end.
    pub slow_is_least: bool,
    /// Height of the slow end.
    pub slow_below: &'static str,
    /// Another height that the slow end has at least.
    pub slow_below_too: Option<&'static str>,
    /// The least height of the slow end, metres.
    pub min_m: f64,
}

/// `Mode::land_run_vertical_control`.
pub(super) const ARDUCOPTER_LANDING: LandingParameters = LandingParameters {
    fast: Some("LAND_SPEED_HIGH"),
    most: None,
    slow: "LAND_SPEED",
    slow_is_least: true,
    slow_below: "LAND_ALT_LOW",
    slow_below_too: None,
    min_m: 1.0,
};
/// `QuadPlane::landing_descent_rate_ms`, whose speed changes over the 6 m above that.
pub(super) const QUADPLANE_LANDING: LandingParameters = LandingParameters {
    fast: None,
    most: None,
    slow: "Q_LAND_FINAL_SPD",
    slow_is_least: false,
    slow_below: "Q_LAND_FINAL_ALT",
    slow_below_too: None,
    min_m: 0.0,
};
/// `FlightTaskAuto::_prepareLandSetpoints`, whose speed changes from `MPC_LAND_ALT1` to `MPC_LAND_ALT2`: slow from the
/// first on, it is not late.
pub(super) const PX4_LANDING: LandingParameters = LandingParameters {
    fast: None,
    most: Some("MPC_Z_VEL_MAX_DN"),
    slow: "MPC_LAND_SPEED",
    slow_is_least: false,
    slow_below: "MPC_LAND_ALT1",
    slow_below_too: Some("MPC_LAND_ALT2"),
    min_m: 0.0,
};

/// Parameters that lead a return elsewhere than the verdict flies it, with the value of those that
/// do not: where a mission comes with another value, its return is not known.
pub(super) const COPTER_RETURNS: &[(&str, f64)] = &[("RTL_ALT_TYPE", 0.0)];
pub(super) const PLANE_RETURNS: &[(&str, f64)] = &[
    ("RTL_AUTOLAND", 0.0),
    ("RTL_CLIMB_MIN", 0.0),
    ("Q_RTL_MODE", 0.0),
    ("TERRAIN_FOLLOW", 0.0),
];
/// `RTL_LAND_DELAY` below 0 stays over home, and is read as such.
pub(super) const PX4_RETURNS: &[(&str, f64)] = &[("RTL_TYPE", 0.0)];

#[cfg(test)]
mod tests {
    use super::*;

    /// `parameter` finds the first row of a name: another one must have the same unit and type.
    #[test]
    fn a_name_means_the_same_in_every_table() {
        let tables = [
            ARDUCOPTER, ARDUPLANE, QUADPLANE, PX4_ROTORS, PX4_WING, PX4_VTOL,
        ];
        for row in tables.into_iter().flatten() {
            let found = parameter(row.name).expect("it is in a table");
            assert_eq!(
                (found.unit, found.is_int32),
                (row.unit, row.is_int32),
                "{}",
                row.name
            );
        }
    }

    #[test]
    fn both_names_of_a_parameter_have_one_default_and_no_version() {
        for [new, old] in RENAMED {
            let [new_row, old_row] = [new, old].map(|name| parameter(name).expect("a row"));
            assert!(
                (new_row.default_si() - old_row.default_si()).abs() < 1e-6,
                "{new} {old}"
            );
            for minor in 0..9 {
                let at = version(4, minor);
                assert!(
                    !(old_row.versions.contains(at) && new_row.versions.contains(at)) || minor < 5,
                    "{new} {old} {at}"
                );
                assert_eq!(other_name(new), Some(*old));
                assert_eq!(other_name(old), Some(*new));
            }
        }
        assert_eq!(name_in("WPNAV_SPEED", Some(version(4, 7))), "WP_SPD");
        assert_eq!(name_in("WPNAV_SPEED", Some(version(4, 6))), "WPNAV_SPEED");
        assert_eq!(name_in("WPNAV_SPEED", None), "WPNAV_SPEED");
        assert!((in_unit_of(12.5, "WP_SPD", "WPNAV_SPEED") - 1250.0).abs() < 1e-9);
    }
}

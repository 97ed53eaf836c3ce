//! Parameters of ArduCopter, ArduPlane and its QuadPlane, with their defaults.
//!
//! As in ArduCopter and ArduPlane 4.6. A parameter that a version renamed has a row for each name.

use super::Unit::{CDeg, Cm, CmPs, CmPs2, Deg, M, Mps, Mps2, Ms, Number, S};
use super::{ParameterRow, of, p};
use crate::autopilot::version::{VersionRange, version};

/// The smallest change of altitude that ArduPlane spreads along a leg: its name since 4.7, and
/// before that.
pub const SLOPE_MIN: [&str; 2] = ["ALT_SLOPE_MIN", "GLIDE_SLOPE_MIN"];

/// The greatest lean angle of ArduCopter: its name since 4.7, and before that.
pub const COPTER_LEAN: [&str; 2] = ["ATC_ANGLE_MAX", "ANGLE_MAX"];

/// ArduCopter.
pub(in crate::autopilot) const ARDUCOPTER: &[ParameterRow] = &[
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
pub(in crate::autopilot) const ARDUPLANE: &[ParameterRow] = &[
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

/// A QuadPlane, besides those of ArduPlane.
pub(in crate::autopilot) const QUADPLANE: &[ParameterRow] = &[
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

/// A name that 4.7 replaced.
const fn until_4_7(row: ParameterRow) -> ParameterRow {
    of(VersionRange::before(version(4, 7)), row)
}

/// A name that 4.7 began to have.
const fn since_4_7(row: ParameterRow) -> ParameterRow {
    of(VersionRange::since(version(4, 7)), row)
}

/// A name of ArduPlane until 4.4.
const fn until_4_5(row: ParameterRow) -> ParameterRow {
    of(VersionRange::before(version(4, 5)), row)
}

//! Parameters of PX4 on rotors and on a wing, with their defaults, as in 1.16 to 1.18.

use super::Unit::{Deg, M, Mps, Mps2, Number, S};
use super::{ParameterRow, int32, p};

/// The greatest lean angle of PX4 on rotors.
pub const PX4_LEAN: &str = "MPC_TILTMAX_AIR";

/// PX4 on rotors.
pub(in crate::autopilot) const PX4_ROTORS: &[ParameterRow] = &[
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
pub(in crate::autopilot) const PX4_WING: &[ParameterRow] = &[
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
pub(in crate::autopilot) const PX4_COPTER: &[ParameterRow] = &[
    // `rc.mc_defaults` of every multicopter; `navigator_params.c`, `rc.fw_defaults` and VTOLs have 10.
    p("NAV_ACC_RAD", 2.0, M),
];

/// A VTOL of PX4, besides those of rotors and wing.
pub(in crate::autopilot) const PX4_VTOL: &[ParameterRow] = &[p("VT_B_DEC_MSS", 2.0, Mps2)];

//! ArduCopter.

use super::{COMMANDS_IN_A_ROW, DEV, JUMPS_IN_A_ROW};
use crate::autopilot::acceptance::{AcceptanceRules, Capacity};
use crate::autopilot::behaviour::{Behaviour, Figure, NONE, measured};
use crate::autopilot::corner::{CornerLaw, Skips, Stops};
use crate::autopilot::modes::{Modes, mode};
use crate::autopilot::support::{Evidence, Support};
use crate::autopilot::version::version;
use crate::autopilot::{Defaults, Facts, command, parameters, stored_form};

pub(in crate::autopilot) static ARDUCOPTER: Facts = Facts {
    firmware: "ArduCopter",
    support: Support::all(Evidence::Measured("4.6.3")),
    // 650 with home; read from the vehicle where `FENCE_TOTAL` and SD storage allow more. Boards
    // under 500 kB of memory store 15 DO_JUMPs, others 100.
    capacity: Capacity {
        items: 649,
        fence: 70,
        rally: 46,
        jumps: 15,
        jumps_in_a_row: JUMPS_IN_A_ROW,
        commands_in_a_row: Some(COMMANDS_IN_A_ROW),
    },
    acceptance: COPTER_ACCEPTANCE,
    stored: &[stored_form::ARDUPILOT],
    modes: Modes {
        initial: mode("STABILIZE", 0),
        // It does not arm in AUTO.
        arming: mode("GUIDED", 4),
        mission: mode("AUTO", 3),
        hold: mode("BRAKE", 17),
        loiter: mode("LOITER", 5),
        land: Some(mode("LAND", 9)),
        return_to_launch: mode("RTL", 6),
    },
    parameters: &[parameters::ARDUCOPTER],
    param_fence: parameters::ARDUCOPTER_FENCE,
    landing: Some(parameters::ARDUCOPTER_LANDING),
    returns_with: parameters::COPTER_RETURNS,
    judged_with: &[parameters::COPTER_JUDGED],
    defaults: Defaults {
        cruise_parameter: "WPNAV_SPEED",
        speed_parameters: [None; 2],
        rate_parameters: None,
        motion_parameters: Some(["WPNAV_SPEED_UP", "WPNAV_SPEED_DN", "WPNAV_ACCEL"]),
        rotor_parameters: None,
        max_rotor_parameters: None,
        bank_parameter: None,
        climb_mps: 2.5,
        descent_mps: 1.5,
        accel_mps2: 2.5,
    },
    corners: Some(CornerLaw::Overlap),
    stops: Stops::ARDUCOPTER,
    skips: SKIPS,
    heights_at_once: None,
    rises_from_boot: None,
    behaviour: COPTER_BEHAVIOUR,
    buffer_m: COPTER_BUFFER_M,
};

pub(super) const COPTER_ACCEPTANCE: AcceptanceRules = AcceptanceRules {
    location_frames: &[0, 3, 5, 6, 10, 11],
    command_frames: None,
    // `ModeAuto::loc_from_cmd`.
    zero_is_here: &[
        command::NAV_WAYPOINT,
        command::NAV_LOITER_UNLIM,
        command::NAV_LOITER_TIME,
        command::NAV_LAND,
        command::NAV_TAKEOFF,
        command::NAV_LOITER_TO_ALT,
        command::NAV_LOITER_TURNS,
        command::NAV_SPLINE_WAYPOINT,
        command::NAV_PAYLOAD_PLACE,
        command::NAV_VTOL_TAKEOFF,
    ],
    // `AP_Mission::get_landing_sequence_start`, `Location::initialised`.
    zero_is_no_place: &[
        command::DO_RETURN_PATH_START,
        command::DO_LAND_START,
        command::DO_SET_ROI_LOCATION,
        command::DO_SET_ROI,
    ],
    any_nan: false,
    reads: None,
    // Altitudes are 24 bit centimetres.
    max_altitude_m: 83_000.0,
    max_hold_s: 65_535.0,
    precision_landing: false,
    takeoffs: &[command::NAV_TAKEOFF, command::NAV_VTOL_TAKEOFF],
    // On the ground; in the air it continues without one.
    needs_takeoff: true,
    before_takeoff: None,
    one_land_start: false,
    landings: &[command::NAV_LAND, command::NAV_VTOL_LAND],
    never_waits: false,
    whole_numbers: false,
    takeoff_above_home: false,
    needs_approach: false,
};

/// `ModeAuto::start_command` goes on to the next command; before one that navigates elsewhere it cannot
/// look ahead (`ModeAuto::set_next_wp`).
const SKIPS: Skips = Skips {
    passing: &[
        command::DO_GO_AROUND,
        command::DO_PAUSE_CONTINUE,
        command::DO_SET_REVERSE,
        command::DO_INVERTED_FLIGHT,
        command::DO_GUIDED_LIMITS,
    ],
    at_rest: &[
        command::NAV_CONTINUE_AND_CHANGE_ALT,
        command::NAV_ALTITUDE_WAIT,
        command::NAV_SET_YAW_SPEED,
    ],
};

/// ArduCopter 4.7.0-dev of December 2025 under `sortie fly`, still air, 10 m/s. Three on the level
/// `missions/sitl-ardupilot.yaml`: 5.5 to 6.0 s late over their homes (motors that spin up, jerk
/// upwards), 6.1 to 8.5 s at waypoints. Two over the ridge of Jacksboro: 8.3 s and, where slopes
/// change by 7 degrees, 11.6 s at waypoints. ArduCopter 4.6.0-dev was 6 s late on the first.
const TAKEOFF_LATE_S: Figure = Figure::greatest(&[measured(
    (12.0, "s"),
    DEV,
    5,
    "ArduCopter 4.7.0-dev, simulated: at most 11.6 s late at waypoints over a ridge",
)]);

/// On the same flights a stop with a turn back took 4.4 s more on level ground (`WPNAV_JERK`),
/// 4.2 s over the ridge. Assumed of all other vehicles; on PX4 4.6 s together with the leg to it.
const STOP_LATE_S: Figure = Figure::greatest(&[measured(
    (4.5, "s"),
    DEV,
    5,
    "ArduCopter 4.7.0-dev, simulated: 4.4 s after a stop with a turn back",
)]);

pub(in crate::autopilot) const COPTER_BEHAVIOUR: Behaviour = Behaviour {
    takeoff_early_s: NONE,
    early_share: NONE,
    takeoff_late_s: TAKEOFF_LATE_S,
    climb_late_s: NONE,
    faster_share: NONE,
    slower_share: NONE,
    stop_late_s: STOP_LATE_S,
    // Lateness that grows with the legs was not measured.
    leg_late_s: NONE,
    late_share: NONE,
    corner_late_s: Figure::greatest(&[measured(
        (0.2, "s"),
        version(4, 6),
        31,
        "ArduCopter 4.6.3, simulated: what zigzags of 10 to 150 degrees at 5 and 10 m/s took beyond the model",
    )]),
    altitude_lag_s: NONE,
    transition_lag_s: NONE,
    climb_out_share: NONE,
    climb_out_last_share: NONE,
    climb_out_overshoot_m: NONE,
    drift_share: NONE,
    drift_s: NONE,
    landing_drift_s: NONE,
    landing_overshoot_m: NONE,
    transition_m: NONE,
    max_wind_mps: NONE,
    circle_wide_share: NONE,
    circle_level_m: NONE,
    turning_share: NONE,
    bank_lag_s: NONE,
    // Through the air, whatever WPNAV_SPEED says; in 5 m/s of wind copters at 8 to 10 m/s were 106
    // to 133 s late against it.
    lean_speed_mps: Figure::least(&[measured(
        (9.5, "m/s"),
        version(4, 6),
        2,
        "ArduCopter 4.6.3, simulated: 9.5 to 11.8 m/s at ANGLE_MAX 30 degrees",
    )]),
    lean_deg: 30.0,
    slow_landing_mps: 0.5,
};

/// Four times the 2.5 m by which a position from satellites is off (one sigma). Simulated copters
/// were at most 2.2 m off their legs beyond that.
pub(in crate::autopilot) const COPTER_BUFFER_M: f64 = 10.0;

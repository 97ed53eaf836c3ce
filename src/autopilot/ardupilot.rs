//! ArduCopter, ArduPlane and its QuadPlane: one file for each, with what all have in common here.

mod copter;
mod plane;
mod quadplane;

use super::version::version;
use super::{Conventions, Version};
pub(super) use copter::{ARDUCOPTER, COPTER_BEHAVIOUR, COPTER_BUFFER_M};
pub(super) use plane::{
    ARDUPLANE, CLIMB_OUT_LAST_SHARE, CLIMB_OUT_OVERSHOOT_M, CLIMB_OUT_SHARE, PLANE_MAX_WIND_MPS,
    TAKEOFF_EARLY_S, WING_BUFFER_M,
};
pub(super) use quadplane::{QUADPLANE, QUADPLANE_MAX_WIND_MPS};

/// ArduPilot on every airframe. Version 4.7 is the newest stable one (November 2026).
pub(super) static CONVENTIONS: Conventions = Conventions {
    name: "ArduPilot",
    key: "ardupilot",
    mav_autopilot: 3,
    versions: &[version(4, 6), version(4, 7)],
    measured: version(4, 6),
    counts_home: true,
    packs_items: true,
    param_tolerance: 0.0,
    max_system_id: 255,
    no_heading: 0.0,
    speed_in_mission: true,
    waits_without_autocontinue: false,
    reads_takeoff_location: false,
    zero_is_unset: true,
    bytewise_parameters: false,
    gives_any_order: true,
    request_ms: 1000,
    give_up_ms: 8000,
    silence_ms: 5000,
    rejects_after_ack: false,
};

/// `AP_Mission::get_next_cmd` makes 64 jumps. `AP_Mission::advance_current_nav_cmd` looks at 254 items; with one more its
/// mission is complete, with two it begins them again and again.
const JUMPS_IN_A_ROW: usize = 64;
const COMMANDS_IN_A_ROW: usize = 253;

/// Version of most simulated vehicles that were measured.
const DEV: Version = version(4, 7);

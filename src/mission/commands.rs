//! The commands each autopilot takes in a mission, and their names.

/// Whether a command goes somewhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// Latitude, longitude and altitude are read.
    Needed,
    /// They are read if the frame has them.
    Optional,
    /// They are parameters like others.
    None,
}

/// How one autopilot takes one command.
#[derive(Debug)]
pub(super) struct CommandRule {
    /// `MAV_CMD`.
    pub command: u16,
    /// Whether it goes somewhere.
    pub place: Place,
    /// Which of `param1` to `param4` may be NaN.
    pub nan: [bool; 4],
}

const fn goes(command: u16, nan: [bool; 4]) -> CommandRule {
    CommandRule {
        command,
        place: Place::Needed,
        nan,
    }
}

const fn may_go(command: u16) -> CommandRule {
    CommandRule {
        command,
        place: Place::Optional,
        nan: NEVER,
    }
}

const fn acts(command: u16) -> CommandRule {
    CommandRule {
        command,
        place: Place::None,
        nan: NEVER,
    }
}

const NEVER: [bool; 4] = [false; 4];
const YAW: [bool; 4] = [false, false, false, true];
const RADIUS_AND_YAW: [bool; 4] = [false, false, true, true];

/// ArduPilot (`AP_Mission`): NaN in the heading of a waypoint, land or takeoff only.
pub(super) static ARDUPILOT: &[CommandRule] = &[
    goes(16, YAW),
    goes(17, NEVER),
    goes(18, NEVER),
    goes(19, NEVER),
    acts(20),
    goes(21, YAW),
    goes(22, YAW),
    goes(31, NEVER),
    goes(82, NEVER),
    goes(84, YAW),
    goes(85, RADIUS_AND_YAW),
    acts(92),
    acts(93),
    goes(94, NEVER),
    acts(112),
    acts(114),
    acts(115),
    acts(177),
    acts(178),
    may_go(179),
    acts(181),
    acts(182),
    acts(183),
    acts(184),
    may_go(189),
    goes(195, NEVER),
    acts(197),
    may_go(201),
    acts(203),
    acts(205),
    acts(206),
    acts(207),
    acts(208),
    acts(211),
    acts(222),
    acts(223),
    acts(3000),
];

/// PX4 (`FeasibilityChecker::checkMissionItemValidity`).
pub(super) static PX4: &[CommandRule] = &[
    acts(0),
    goes(16, YAW),
    goes(17, YAW),
    goes(19, YAW),
    acts(20),
    goes(21, YAW),
    goes(22, YAW),
    goes(31, YAW),
    goes(84, YAW),
    goes(85, YAW),
    acts(93),
    acts(177),
    acts(178),
    may_go(179),
    acts(187),
    may_go(189),
    goes(195, NEVER),
    acts(196),
    acts(197),
    acts(200),
    may_go(201),
    acts(203),
    acts(204),
    acts(205),
    acts(206),
    acts(211),
    acts(260),
    acts(530),
    acts(531),
    acts(532),
    acts(1000),
    acts(2000),
    acts(2001),
    acts(2003),
    acts(2500),
    acts(2501),
    acts(3000),
    goes(4501, NEVER),
    acts(42600),
];

/// Names (`MAV_CMD_` left out) that a mission file may have instead of numbers.
static NAMES: &[(&str, u16)] = &[
    ("NAV_WAYPOINT", 16),
    ("NAV_LOITER_UNLIM", 17),
    ("NAV_LOITER_TURNS", 18),
    ("NAV_LOITER_TIME", 19),
    ("NAV_RETURN_TO_LAUNCH", 20),
    ("NAV_LAND", 21),
    ("NAV_TAKEOFF", 22),
    ("NAV_LOITER_TO_ALT", 31),
    ("NAV_SPLINE_WAYPOINT", 82),
    ("NAV_VTOL_TAKEOFF", 84),
    ("NAV_VTOL_LAND", 85),
    ("NAV_GUIDED_ENABLE", 92),
    ("NAV_DELAY", 93),
    ("NAV_PAYLOAD_PLACE", 94),
    ("CONDITION_DELAY", 112),
    ("CONDITION_DISTANCE", 114),
    ("CONDITION_YAW", 115),
    ("DO_JUMP", 177),
    ("DO_CHANGE_SPEED", 178),
    ("DO_SET_HOME", 179),
    ("DO_SET_RELAY", 181),
    ("DO_REPEAT_RELAY", 182),
    ("DO_SET_SERVO", 183),
    ("DO_REPEAT_SERVO", 184),
    ("DO_LAND_START", 189),
    ("DO_SET_ROI_LOCATION", 195),
    ("DO_SET_ROI_NONE", 197),
    ("DO_SET_ROI", 201),
    ("DO_DIGICAM_CONTROL", 203),
    ("DO_MOUNT_CONTROL", 205),
    ("DO_SET_CAM_TRIGG_DIST", 206),
    ("DO_FENCE_ENABLE", 207),
    ("DO_PARACHUTE", 208),
    ("DO_GRIPPER", 211),
];

/// The number of a command's name, with or without `MAV_CMD_`.
#[must_use]
pub fn command_named(name: &str) -> Option<u16> {
    let short = name.strip_prefix("MAV_CMD_").unwrap_or(name);
    NAMES
        .iter()
        .find(|(known, _)| *known == short)
        .map(|&(_, command)| command)
}

/// The name of a command, without `MAV_CMD_`, if it has one here.
#[must_use]
pub fn command_name(command: u16) -> Option<&'static str> {
    NAMES
        .iter()
        .find(|&&(_, known)| known == command)
        .map(|&(name, _)| name)
}

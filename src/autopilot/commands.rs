//! The rule of acceptance for each mission command: [`COMMANDS`] has one row per `MAV_CMD`.
//!
//! Unless a row names another source, ArduPilot's column is from
//! `AP_Mission::mavlink_int_to_mission_cmd` and `sanity_check_params`, PX4's from
//! `mavlink_mission.cpp` and `FeasibilityChecker::checkMissionItemValidity`.
//! Rules that hold for every command (frames, ranges, counts) are in [`super::AcceptanceRules`]; the parameters that PX4
//! reads of each are in [`ReadParameters`].

pub(super) mod read_parameters;

pub use read_parameters::ReadParameters;

use Motion::{Moves, NoMotion, Unknown};

use super::version::{VersionRange, version};
use super::{Autopilot, Version, frame};

/// Whether a command reads latitude, longitude and altitude.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Location {
    /// It always does.
    Needed,
    /// It does where the frame of the item has them.
    Optional,
    /// As `Optional`, but the autopilot stores and checks them in every frame.
    Stored,
    /// They are parameters like others.
    None,
}

/// What the verdict knows about the motion that a command causes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// The vehicle may move, stop or jump. The verdict computes most of these motions.
    Moves,
    /// The vehicle continues as if the item were absent.
    NoMotion,
    /// The motion cannot be computed, for this reason.
    Unknown(&'static str),
}

/// Values of a parameter that an autopilot rejects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rejected {
    /// NaN.
    NaN,
    /// This number.
    Equal(u8),
    /// What is no whole number from the first to the second.
    Beyond(i16, i16),
}

impl Rejected {
    /// Whether the value is one of them.
    #[must_use]
    pub fn holds(self, value: f32) -> bool {
        match self {
            Self::NaN => value.is_nan(),
            Self::Equal(number) => (value - f32::from(number)).abs() <= 0.0,
            Self::Beyond(first, last) => {
                let range = f32::from(first)..=f32::from(last);
                !range.contains(&value) || value.fract() != 0.0
            }
        }
    }

    /// The values that are accepted instead.
    #[must_use]
    pub fn allowed(self) -> String {
        match self {
            Self::NaN => "a number".to_owned(),
            Self::Equal(number) => format!("any number except {number}"),
            Self::Beyond(first, last) => format!("a whole number from {first} to {last}"),
        }
    }
}

/// One parameter whose value makes an autopilot reject the item.
#[derive(Clone, Copy, Debug)]
pub struct ParamRule {
    /// From 1; 7 is the altitude.
    pub param: u8,
    /// The values that are rejected.
    pub rejected: Rejected,
    /// Only in this frame; absent: in every frame.
    pub frame: Option<u8>,
    /// The versions that reject them.
    pub versions: VersionRange,
    /// Where the rule is from.
    pub source: &'static str,
}

/// How one autopilot accepts one command.
#[derive(Clone, Copy, Debug)]
pub struct CommandRule {
    /// The versions that accept it.
    pub versions: VersionRange,
    /// Whether it has a location.
    pub location: Location,
    /// Whether `param1` to `param4` may be NaN; not read where [`super::AcceptanceRules::any_nan`] is set.
    pub nan: [bool; 4],
    /// Values that it must not have.
    pub params: &'static [ParamRule],
}

impl CommandRule {
    /// Whether a frame means that the item has a location.
    #[must_use]
    pub fn has_location(&self, frame: u8) -> bool {
        match self.location {
            Location::Needed => true,
            Location::Optional | Location::Stored => frame != frame::MISSION,
            Location::None => false,
        }
    }

    /// Whether latitude, longitude and altitude are checked in a frame, a location or not.
    #[must_use]
    pub fn checks_location(&self, frame: u8) -> bool {
        self.location == Location::Stored || self.has_location(frame)
    }

    const fn but(self, params: &'static [ParamRule]) -> Self {
        Self { params, ..self }
    }

    const fn since(self, version: Version) -> Self {
        Self {
            versions: VersionRange::since(version),
            ..self
        }
    }
}

/// One mission command, as both autopilots accept it.
#[derive(Clone, Copy, Debug)]
pub struct CommandRow {
    /// `MAV_CMD`.
    pub command: u16,
    /// Its name, without `MAV_CMD_`.
    pub name: &'static str,
    /// The motion that it causes.
    pub motion: Motion,
    ardupilot: Option<CommandRule>,
    px4: Option<CommandRule>,
}

impl CommandRow {
    /// The rule of one autopilot; none if it rejects the command.
    #[must_use]
    pub fn rule(&self, autopilot: Autopilot) -> Option<&CommandRule> {
        match autopilot {
            Autopilot::ArduPilot => self.ardupilot.as_ref(),
            Autopilot::Px4 => self.px4.as_ref(),
        }
    }
}

const NEVER: [bool; 4] = [false; 4];
const YAW: [bool; 4] = [false, false, false, true];
const RADIUS_AND_YAW: [bool; 4] = [false, false, true, true];
const ALL_BUT_FIRST: [bool; 4] = [false, true, true, true];

const fn rule(location: Location, nan: [bool; 4]) -> CommandRule {
    CommandRule {
        versions: VersionRange::ALL,
        location,
        nan,
        params: &[],
    }
}

/// A location, and NaN in these parameters.
const fn at(nan: [bool; 4]) -> CommandRule {
    rule(Location::Needed, nan)
}

/// No location, no NaN.
const ACTION: CommandRule = rule(Location::None, NEVER);
/// A location if the frame has one.
const OPTIONAL: CommandRule = rule(Location::Optional, NEVER);
/// ArduPilot, `AP_Mission::stored_in_location`: a location in every frame.
const STORED: CommandRule = rule(Location::Stored, NEVER);

/// `DO_SET_ROI` in the frame of commands cannot be the mode `MAV_ROI_LOCATION`.
const NO_ROI_LOCATION: &[ParamRule] = &[ParamRule {
    param: 1,
    rejected: Rejected::Equal(3),
    frame: Some(frame::MISSION),
    versions: VersionRange::ALL,
    source: "PX4 mavlink_mission.cpp",
}];

/// Ids of systems and components are bytes: PX4 cuts others down, and another one takes the gimbal.
/// -1 leaves who controls it, -2 takes it for the autopilot, -3 releases it.
const fn gimbal_id(param: u8) -> ParamRule {
    ParamRule {
        param,
        rejected: Rejected::Beyond(-3, 255),
        frame: None,
        versions: VersionRange::ALL,
        source: "MAVLink MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE, PX4 input_mavlink.cpp",
    }
}

/// `DO_GIMBAL_MANAGER_CONFIGURE`: system and component of the primary and the secondary control.
const GIMBAL_IDS: &[ParamRule] = &[gimbal_id(1), gimbal_id(2), gimbal_id(3), gimbal_id(4)];

const fn row(
    (command, name): (u16, &'static str),
    motion: Motion,
    ardupilot: Option<CommandRule>,
    px4: Option<CommandRule>,
) -> CommandRow {
    CommandRow {
        command,
        name,
        motion,
        ardupilot,
        px4,
    }
}

/// Accepted by both without a location.
const fn both(command: (u16, &'static str), motion: Motion) -> CommandRow {
    row(command, motion, Some(ACTION), Some(ACTION))
}

/// Accepted by ArduPilot alone, without a location.
const fn ardupilot(command: (u16, &'static str), motion: Motion) -> CommandRow {
    row(command, motion, Some(ACTION), None)
}

/// Accepted by PX4 alone, without a location.
const fn px4(command: (u16, &'static str), motion: Motion) -> CommandRow {
    row(command, motion, None, Some(ACTION))
}

/// Every command that one of the autopilots accepts in a mission, by number.
#[rustfmt::skip]
pub static COMMANDS: &[CommandRow] = &[
    row((16, "NAV_WAYPOINT"), Moves, Some(at(YAW)), Some(at(YAW))),
    row((17, "NAV_LOITER_UNLIM"), Moves, Some(at(NEVER)), Some(at(YAW))),
    row((18, "NAV_LOITER_TURNS"), Moves, Some(at(NEVER)), None),
    row((19, "NAV_LOITER_TIME"), Moves, Some(at(NEVER)), Some(at(YAW))),
    both((20, "NAV_RETURN_TO_LAUNCH"), Moves),
    row((21, "NAV_LAND"), Moves, Some(at(YAW)), Some(at(YAW))),
    row((22, "NAV_TAKEOFF"), Moves, Some(at(YAW)), Some(at(YAW))),
    row((30, "NAV_CONTINUE_AND_CHANGE_ALT"), Moves, Some(at(NEVER)), None),
    row((31, "NAV_LOITER_TO_ALT"), Moves, Some(at(NEVER)), Some(at(YAW))),
    row((36, "NAV_ARC_WAYPOINT"), Moves, Some(at(ALL_BUT_FIRST).since(version(4, 7))), None),
    row((82, "NAV_SPLINE_WAYPOINT"), Moves, Some(at(NEVER)), None),
    ardupilot((83, "NAV_ALTITUDE_WAIT"), Moves),
    row((84, "NAV_VTOL_TAKEOFF"), Moves, Some(at(YAW)), Some(at(YAW))),
    row((85, "NAV_VTOL_LAND"), Moves, Some(at(RADIUS_AND_YAW)), Some(at(YAW))),
    ardupilot((92, "NAV_GUIDED_ENABLE"),
        Unknown("NAV_GUIDED_ENABLE hands over to another computer")),
    both((93, "NAV_DELAY"), Moves),
    row((94, "NAV_PAYLOAD_PLACE"), Moves, Some(at(NEVER)), None),
    // PX4 receives 112 and 114 in frame 2, and flies no mission with them (`checkMissionItemValidity`, as of January 2026).
    ardupilot((112, "CONDITION_DELAY"), NoMotion),
    ardupilot((114, "CONDITION_DISTANCE"), NoMotion),
    ardupilot((115, "CONDITION_YAW"), NoMotion),
    both((177, "DO_JUMP"), Moves),
    both((178, "DO_CHANGE_SPEED"), Moves),
    row((179, "DO_SET_HOME"), Unknown("DO_SET_HOME moves home, and altitudes above it"),
        Some(STORED), Some(ACTION)),
    ardupilot((181, "DO_SET_RELAY"), NoMotion),
    ardupilot((182, "DO_REPEAT_RELAY"), NoMotion),
    ardupilot((183, "DO_SET_SERVO"), NoMotion),
    ardupilot((184, "DO_REPEAT_SERVO"), NoMotion),
    px4((187, "DO_SET_ACTUATOR"), Moves),
    row((188, "DO_RETURN_PATH_START"), NoMotion, Some(STORED), None),
    // PX4: frame 2 alone (`command_frames` in px4.rs). ArduPilot: 2 and those of places. Of the whole mission: `one_land_start`,
    // `zero_is_no_place` and `before_takeoff` of `AcceptanceRules`, and for wings `mission/accept/wing.rs`. Its parameters: `read_parameters.rs`.
    row((189, "DO_LAND_START"), NoMotion, Some(STORED), Some(ACTION)),
    ardupilot((191, "DO_GO_AROUND"), Moves),
    ardupilot((193, "DO_PAUSE_CONTINUE"), Moves),
    ardupilot((194, "DO_SET_REVERSE"), Moves),
    row((195, "DO_SET_ROI_LOCATION"), NoMotion, Some(at(NEVER)), Some(at(NEVER))),
    px4((196, "DO_SET_ROI_WPNEXT_OFFSET"), NoMotion),
    both((197, "DO_SET_ROI_NONE"), NoMotion),
    px4((200, "DO_CONTROL_VIDEO"), NoMotion),
    row((201, "DO_SET_ROI"), NoMotion, Some(STORED),
        Some(OPTIONAL.but(NO_ROI_LOCATION))),
    ardupilot((202, "DO_DIGICAM_CONFIGURE"), NoMotion),
    both((203, "DO_DIGICAM_CONTROL"), NoMotion),
    px4((204, "DO_MOUNT_CONFIGURE"), NoMotion),
    both((205, "DO_MOUNT_CONTROL"), NoMotion),
    both((206, "DO_SET_CAM_TRIGG_DIST"), NoMotion),
    ardupilot((207, "DO_FENCE_ENABLE"), NoMotion),
    ardupilot((208, "DO_PARACHUTE"), Unknown("DO_PARACHUTE releases the parachute")),
    ardupilot((210, "DO_INVERTED_FLIGHT"), Moves),
    both((211, "DO_GRIPPER"), NoMotion),
    both((212, "DO_AUTOTUNE_ENABLE"), NoMotion),
    ardupilot((213, "NAV_SET_YAW_SPEED"), Moves),
    px4((214, "DO_SET_CAM_TRIGG_INTERVAL"), NoMotion),
    ardupilot((215, "DO_SET_RESUME_REPEAT_DIST"), NoMotion),
    ardupilot((216, "DO_SPRAYER"), NoMotion),
    ardupilot((217, "DO_SEND_SCRIPT_MESSAGE"), NoMotion),
    ardupilot((218, "DO_AUX_FUNCTION"), NoMotion),
    ardupilot((222, "DO_GUIDED_LIMITS"), Moves),
    ardupilot((223, "DO_ENGINE_CONTROL"), Unknown("DO_ENGINE_CONTROL stops the engine")),
    px4((260, "OBLIQUE_SURVEY"), Moves),
    px4((400, "COMPONENT_ARM_DISARM"), Moves),
    px4((530, "SET_CAMERA_MODE"), NoMotion),
    ardupilot((531, "SET_CAMERA_ZOOM"), NoMotion),
    both((532, "SET_CAMERA_FOCUS"), NoMotion),
    both((534, "SET_CAMERA_SOURCE"), NoMotion),
    ardupilot((600, "JUMP_TAG"), NoMotion),
    ardupilot((601, "DO_JUMP_TAG"), Moves),
    both((1000, "DO_GIMBAL_MANAGER_PITCHYAW"), NoMotion),
    row((1001, "DO_GIMBAL_MANAGER_CONFIGURE"), NoMotion, None, Some(ACTION.but(GIMBAL_IDS))),
    both((2000, "IMAGE_START_CAPTURE"), NoMotion),
    both((2001, "IMAGE_STOP_CAPTURE"), NoMotion),
    px4((2003, "DO_TRIGGER_CONTROL"), Moves),
    both((2500, "VIDEO_START_CAPTURE"), NoMotion),
    both((2501, "VIDEO_STOP_CAPTURE"), NoMotion),
    both((3000, "DO_VTOL_TRANSITION"), Moves),
    row((4501, "CONDITION_GATE"), Moves, None, Some(at(NEVER))),
    both((42600, "DO_WINCH"), NoMotion),
    ardupilot((42702, "NAV_SCRIPT_TIME"), Moves),
    ardupilot((42703, "NAV_ATTITUDE_TIME"), Moves),
];

/// The row of a command.
#[must_use]
pub fn command_row(command: u16) -> Option<&'static CommandRow> {
    let index = COMMANDS.binary_search_by_key(&command, |row| row.command);
    index.ok().map(|index| &COMMANDS[index])
}

/// The number of a command's name, with or without `MAV_CMD_`.
#[must_use]
pub fn command_named(name: &str) -> Option<u16> {
    let short = name.strip_prefix("MAV_CMD_").unwrap_or(name);
    let row = COMMANDS.iter().find(|row| row.name == short);
    row.map(|row| row.command)
}

/// The name of a command, without `MAV_CMD_`, if it is in the table.
#[must_use]
pub fn command_name(command: u16) -> Option<&'static str> {
    command_row(command).map(|row| row.name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_in_ascending_order() {
        assert!(COMMANDS.is_sorted_by(|a, b| a.command < b.command));
    }
}

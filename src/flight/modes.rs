//! How each autopilot is told what to do.

use crate::link::Command;
use crate::spec::Autopilot;

/// `MAV_MODE_FLAG_CUSTOM_MODE_ENABLED`.
const CUSTOM: f32 = 1.0;
/// ArduCopter's modes: `AUTO`, `GUIDED`, `LAND`, `BRAKE`.
const AUTO: u32 = 3;
const GUIDED: f32 = 4.0;
const LAND: f32 = 9.0;
/// It stops and stays without a pilot's sticks, which `LOITER` does not.
const BRAKE: f32 = 17.0;
/// PX4's main mode `AUTO`, and its sub modes.
const PX4_AUTO: f32 = 4.0;
const PX4_LOITER: f32 = 3.0;
const PX4_MISSION: f32 = 4.0;
const PX4_LAND: f32 = 6.0;
const PX4_MISSION_MODE: u32 = 4 << 16 | 4 << 24;

fn px4(sub: f32) -> Command {
    Command::new(Command::SET_MODE, [CUSTOM, PX4_AUTO, sub])
}

fn ardupilot(mode: f32) -> Command {
    Command::new(Command::SET_MODE, [CUSTOM, mode])
}

/// What arms a vehicle on the ground, one after the other. ArduCopter does not arm in `AUTO`.
pub(super) fn arm(autopilot: Autopilot) -> Vec<Command> {
    let first = match autopilot {
        Autopilot::ArduPilot => ardupilot(GUIDED),
        Autopilot::Px4 => px4(PX4_LOITER),
    };
    vec![first, Command::new(Command::ARM_DISARM, [1.0])]
}

/// What stops the motors of a vehicle that has not taken off.
pub(super) fn disarm() -> Command {
    Command::new(Command::ARM_DISARM, [0.0])
}

/// What starts the mission of an armed vehicle.
pub(super) fn start(autopilot: Autopilot) -> Command {
    match autopilot {
        // Changes to AUTO itself, and takes off without a throttle that was raised.
        Autopilot::ArduPilot => Command::new(Command::MISSION_START, [0.0, 0.0]),
        Autopilot::Px4 => px4(PX4_MISSION),
    }
}

/// What makes it stay where it is.
pub(super) fn hold(autopilot: Autopilot) -> Command {
    match autopilot {
        Autopilot::ArduPilot => ardupilot(BRAKE),
        Autopilot::Px4 => px4(PX4_LOITER),
    }
}

/// What makes it land where it is.
pub(super) fn land(autopilot: Autopilot) -> Command {
    match autopilot {
        Autopilot::ArduPilot => ardupilot(LAND),
        Autopilot::Px4 => px4(PX4_LAND),
    }
}

/// Whether a vehicle in this mode flies its mission.
pub(super) fn is_mission(autopilot: Autopilot, custom_mode: u32) -> bool {
    match autopilot {
        Autopilot::ArduPilot => custom_mode == AUTO,
        Autopilot::Px4 => custom_mode == PX4_MISSION_MODE,
    }
}

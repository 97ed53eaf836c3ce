//! Commands and modes of each autopilot.

use crate::link::Command;
use crate::mission::VehicleMission;
use crate::spec::{Airframe, Autopilot};

/// `MAV_MODE_FLAG_CUSTOM_MODE_ENABLED`.
const CUSTOM: f32 = 1.0;
/// ArduCopter's modes: `AUTO`, `GUIDED`, `LAND`, `BRAKE`.
const AUTO: u32 = 3;
const GUIDED: f32 = 4.0;
const LAND: f32 = 9.0;
/// It stops and stays without a pilot's sticks, which `LOITER` does not.
const BRAKE: u32 = 17;
/// ArduPlane's modes: `FBWA`, `AUTO`, `LOITER` (circles), and `QLOITER`, `QLAND` of a
/// `QuadPlane`.
const PLANE_FBWA: f32 = 5.0;
const PLANE_AUTO: u32 = 10;
const PLANE_LOITER: u32 = 12;
const PLANE_QLOITER: f32 = 19.0;
const PLANE_QLAND: f32 = 20.0;
/// PX4's main mode `AUTO`, and its sub modes. `LOITER` circles on a wing.
const PX4_AUTO: f32 = 4.0;
const PX4_LOITER: f32 = 3.0;
const PX4_MISSION: f32 = 4.0;
const PX4_LAND: f32 = 6.0;
const PX4_MISSION_MODE: u32 = 4 << 16 | 4 << 24;
const PX4_LOITER_MODE: u32 = 4 << 16 | 3 << 24;

#[expect(clippy::cast_precision_loss, reason = "a small number")]
fn number(mode: u32) -> f32 {
    mode as f32
}

fn px4(sub: f32) -> Command {
    Command::new(Command::SET_MODE, [CUSTOM, PX4_AUTO, sub])
}

fn ardupilot(mode: f32) -> Command {
    Command::new(Command::SET_MODE, [CUSTOM, mode])
}

/// What arms a vehicle on the ground, one after the other, in a mode in which it stands. ArduCopter
/// does not arm in `AUTO`; ArduPlane does, and goes at once.
pub(crate) fn arm(of: &VehicleMission) -> Vec<Command> {
    let first = match (of.autopilot, of.airframe) {
        (Autopilot::ArduPilot, Airframe::Copter) => ardupilot(GUIDED),
        (Autopilot::ArduPilot, Airframe::Plane) => ardupilot(PLANE_FBWA),
        (Autopilot::ArduPilot, Airframe::Vtol) => ardupilot(PLANE_QLOITER),
        (Autopilot::Px4, _) => px4(PX4_LOITER),
    };
    vec![first, Command::new(Command::ARM_DISARM, [1.0])]
}

/// What stops the motors of a vehicle that has not taken off.
pub(crate) fn disarm() -> Command {
    Command::new(Command::ARM_DISARM, [0.0])
}

/// What starts the mission of an armed vehicle, or takes it up again.
pub(crate) fn start(of: &VehicleMission) -> Command {
    match of.autopilot {
        // Changes to AUTO itself, and takes off without a throttle that was raised.
        Autopilot::ArduPilot => Command::new(Command::MISSION_START, [0.0, 0.0]),
        Autopilot::Px4 => px4(PX4_MISSION),
    }
}

/// What makes it stay where it is; a wing circles there.
pub(crate) fn hold(of: &VehicleMission) -> Command {
    match (of.autopilot, of.airframe.has_wing()) {
        (Autopilot::ArduPilot, false) => ardupilot(number(BRAKE)),
        (Autopilot::ArduPilot, true) => ardupilot(number(PLANE_LOITER)),
        (Autopilot::Px4, _) => px4(PX4_LOITER),
    }
}

/// What makes it land where it is; none for a plane, which needs its approach.
pub(crate) fn land(of: &VehicleMission) -> Option<Command> {
    match (of.autopilot, of.airframe) {
        (_, Airframe::Plane) => None,
        (Autopilot::ArduPilot, Airframe::Copter) => Some(ardupilot(LAND)),
        (Autopilot::ArduPilot, Airframe::Vtol) => Some(ardupilot(PLANE_QLAND)),
        (Autopilot::Px4, _) => Some(px4(PX4_LAND)),
    }
}

/// Whether a vehicle in this mode flies its mission.
pub(crate) fn is_mission(of: &VehicleMission, custom_mode: u32) -> bool {
    match (of.autopilot, of.airframe.has_wing()) {
        (Autopilot::ArduPilot, false) => custom_mode == AUTO,
        (Autopilot::ArduPilot, true) => custom_mode == PLANE_AUTO,
        (Autopilot::Px4, _) => custom_mode == PX4_MISSION_MODE,
    }
}

/// Whether a vehicle in this mode stays where it is as ordered; a wing circles there.
pub(crate) fn is_hold(of: &VehicleMission, custom_mode: u32) -> bool {
    match (of.autopilot, of.airframe.has_wing()) {
        (Autopilot::ArduPilot, false) => custom_mode == BRAKE,
        (Autopilot::ArduPilot, true) => custom_mode == PLANE_LOITER,
        (Autopilot::Px4, _) => custom_mode == PX4_LOITER_MODE,
    }
}

//! Commands that change what a vehicle does.

use crate::autopilot::{Airframe, Autopilot, Mode, Modes, facts, mode_name};
use crate::link::Command;
use crate::mission::VehicleMission;

/// `MAV_MODE_FLAG_CUSTOM_MODE_ENABLED`.
const CUSTOM: f32 = 1.0;

fn modes(of: &VehicleMission) -> &'static Modes {
    &facts(of.autopilot, of.airframe).modes
}

/// Changes to a mode: of PX4 `param2` is the main mode and `param3` the sub mode.
fn change(of: &VehicleMission, mode: Mode) -> Command {
    let [sub, main, high, low] = mode.custom_mode.to_be_bytes();
    let (main, sub) = match of.autopilot {
        Autopilot::ArduPilot => (u16::from_be_bytes([high, low]), 0),
        Autopilot::Px4 => (u16::from(main), sub),
    };
    Command::new(
        Command::DO_SET_MODE,
        [CUSTOM, f32::from(main), f32::from(sub)],
    )
}

/// Commands that arm a vehicle on the ground, in this order, in a mode in which it stands.
pub(crate) fn arm(of: &VehicleMission) -> Vec<Command> {
    let arm = Command::new(Command::COMPONENT_ARM_DISARM, [1.0]);
    vec![change(of, modes(of).arming), arm]
}

/// Stops the motors of a vehicle that has not taken off.
pub(crate) fn disarm() -> Command {
    Command::new(Command::COMPONENT_ARM_DISARM, [0.0])
}

/// Starts the mission of an armed vehicle, or continues it.
pub(crate) fn start(of: &VehicleMission) -> Command {
    match of.autopilot {
        // Changes to AUTO itself, and takes off without a raised throttle.
        Autopilot::ArduPilot => Command::new(Command::MISSION_START, [0.0, 0.0]),
        Autopilot::Px4 => change(of, modes(of).mission),
    }
}

/// Makes it stay at its place; a wing circles there.
pub(crate) fn hold(of: &VehicleMission) -> Command {
    change(of, modes(of).hold)
}

/// Makes it land at its place; none for a plane, which needs its approach.
pub(crate) fn land(of: &VehicleMission) -> Option<Command> {
    let land = modes(of).land.filter(|_| of.airframe != Airframe::Plane);
    land.map(|mode| change(of, mode))
}

/// Makes it return to launch.
pub(crate) fn return_to_launch(of: &VehicleMission) -> Command {
    change(of, modes(of).return_to_launch)
}

/// Whether a vehicle in this mode returns to launch.
pub(crate) fn is_return(of: &VehicleMission, custom_mode: u32) -> bool {
    custom_mode == modes(of).return_to_launch.custom_mode
}

/// Whether a vehicle in this mode lands at its place.
pub(crate) fn is_land(of: &VehicleMission, custom_mode: u32) -> bool {
    let land = modes(of).land;
    land.is_some_and(|land| land.custom_mode == custom_mode)
}

/// Whether a vehicle in this mode flies its mission.
pub(crate) fn is_mission(of: &VehicleMission, custom_mode: u32) -> bool {
    custom_mode == modes(of).mission.custom_mode
}

/// Whether a vehicle in this mode stays at its place as ordered; a wing circles there.
pub(crate) fn is_hold(of: &VehicleMission, custom_mode: u32) -> bool {
    custom_mode == modes(of).hold.custom_mode
}

/// The name of a mode; its number where it is not known.
pub(crate) fn name(of: &VehicleMission, custom_mode: u32) -> String {
    mode_name(of.autopilot, of.airframe, custom_mode)
        .map_or_else(|| format!("mode {custom_mode}"), str::to_owned)
}

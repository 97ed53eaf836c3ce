//! Flight modes, as `HEARTBEAT.custom_mode` numbers them.

/// One flight mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mode {
    /// Its name in the autopilot.
    pub name: &'static str,
    /// `HEARTBEAT.custom_mode`.
    pub custom_mode: u32,
}

/// Shorthand for tables.
pub(super) const fn mode(name: &'static str, custom_mode: u32) -> Mode {
    Mode { name, custom_mode }
}

/// A sub mode of PX4's main mode `AUTO`: `custom_mode` has the main mode in its third byte
/// and the sub mode in its fourth.
pub(super) const fn px4_auto(name: &'static str, sub: u32) -> Mode {
    mode(name, 4 << 16 | sub << 24)
}

/// The modes of one airframe that a fleet is flown with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Modes {
    /// The mode after power-up.
    pub initial: Mode,
    /// The vehicle can be armed on the ground in this mode, and stays there.
    pub arming: Mode,
    /// Flies the mission.
    pub mission: Mode,
    /// Stops without a pilot's sticks; a wing circles.
    pub hold: Mode,
    /// `MAV_CMD_NAV_LOITER_UNLIM` as a command changes to this mode.
    pub loiter: Mode,
    /// Lands at the place; none for a plane of ArduPilot, which needs an approach.
    pub land: Option<Mode>,
    /// Returns to launch.
    pub return_to_launch: Mode,
}

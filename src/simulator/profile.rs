//! Which autopilot a simulated vehicle plays.

use crate::link::{AUTOPILOT_ARDUPILOT, AUTOPILOT_GENERIC, AUTOPILOT_PX4, List};
use crate::spec::{Airframe, Autopilot};

/// The autopilot that a simulated vehicle plays. What each does was measured on
/// ArduCopter and ArduPlane 4.6.3, PX4 1.18 (both software in the loop) and MAVSDK 4.1.0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Profile {
    /// ArduPilot: ArduCopter, or ArduPlane on a wing.
    ArduPilot,
    /// PX4.
    Px4,
    /// An autopilot that does not say which it is, as MAVSDK's mission server.
    Generic,
}

impl From<Autopilot> for Profile {
    fn from(autopilot: Autopilot) -> Self {
        match autopilot {
            Autopilot::ArduPilot => Self::ArduPilot,
            Autopilot::Px4 => Self::Px4,
        }
    }
}

impl Profile {
    /// `MAV_AUTOPILOT` of its heartbeat.
    #[must_use]
    pub fn autopilot(self) -> u8 {
        match self {
            Self::ArduPilot => AUTOPILOT_ARDUPILOT,
            Self::Px4 => AUTOPILOT_PX4,
            Self::Generic => AUTOPILOT_GENERIC,
        }
    }

    /// `MAV_TYPE` of its heartbeat: quadrotor, fixed wing or quad-VTOL. A QuadPlane says that
    /// it is a fixed wing unless `Q_MAV_TYPE` is set.
    pub(crate) fn kind(self, airframe: Airframe) -> u8 {
        match (self, airframe) {
            (Self::Generic, _) => 0,
            (_, Airframe::Copter) => 2,
            (_, Airframe::Plane) | (Self::ArduPilot, Airframe::Vtol) => 1,
            (Self::Px4, Airframe::Vtol) => 20,
        }
    }

    /// `AUTOPILOT_VERSION.flight_sw_version`: the one whose behaviour was measured.
    pub(crate) fn flight_software(self) -> u32 {
        match self {
            Self::ArduPilot => u32::from_be_bytes([4, 6, 3, 255]),
            Self::Px4 => u32::from_be_bytes([1, 18, 0, 0]),
            Self::Generic => 0,
        }
    }

    /// `AUTOPILOT_VERSION.capabilities`: what the simulated vehicle can do.
    pub(crate) fn capabilities(self) -> u64 {
        // MISSION_INT, COMMAND_INT, MAVLINK2, MISSION_FENCE, MISSION_RALLY.
        let all = 4 | 8 | 8192 | 16384 | 32768;
        match self {
            // PARAM_ENCODE_BYTEWISE.
            Self::Px4 => all | 16,
            Self::ArduPilot | Self::Generic => all,
        }
    }

    /// By which rules it stores items; none means bit by bit.
    pub(crate) fn keeps(self) -> Option<Autopilot> {
        match self {
            Self::ArduPilot => Some(Autopilot::ArduPilot),
            Self::Px4 => Some(Autopilot::Px4),
            Self::Generic => None,
        }
    }

    /// Between two requests for the same item, milliseconds.
    pub(crate) fn repeat_ms(self) -> u64 {
        match self {
            Self::ArduPilot => 1000,
            Self::Px4 => 270,
            Self::Generic => 500,
        }
    }

    /// Without the item until the transfer is given up, milliseconds.
    pub(crate) fn give_up_ms(self) -> u64 {
        match self {
            Self::ArduPilot => 8000,
            Self::Px4 => 5000,
            Self::Generic => 2500,
        }
    }

    /// Most items in a list, home included where there is one.
    pub(crate) fn capacity(self, list: List, airframe: Airframe) -> usize {
        match (self, list) {
            (Self::ArduPilot, List::Mission) if airframe.has_wing() => 655,
            (Self::ArduPilot, List::Mission) => 650,
            (Self::ArduPilot, List::Fence) => 70,
            (Self::ArduPilot, List::Rally) => 46,
            (Self::Px4 | Self::Generic, _) => 10_000,
        }
    }
}

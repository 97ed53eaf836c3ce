//! The autopilot that a simulated vehicle plays.

use crate::autopilot::{Airframe, Autopilot, Facts, Version, facts};
use crate::link::{AUTOPILOT_GENERIC, MissionType};

/// The autopilot that a simulated vehicle plays. Its behaviour was measured on ArduCopter and
/// ArduPlane 4.6.3, PX4 1.18 (both software in the loop) and MAVSDK 4.1.0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Profile {
    /// ArduPilot: ArduCopter, or ArduPlane on a wing.
    ArduPilot,
    /// PX4.
    Px4,
    /// An autopilot that does not name itself, as MAVSDK's mission server.
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
    /// The autopilot whose tables apply; none for the generic one, which stores every item bit
    /// by bit.
    pub(crate) fn known(self) -> Option<Autopilot> {
        match self {
            Self::ArduPilot => Some(Autopilot::ArduPilot),
            Self::Px4 => Some(Autopilot::Px4),
            Self::Generic => None,
        }
    }

    /// The table by which it flies: the generic one flies as ArduPilot.
    pub(crate) fn facts(self, airframe: Airframe) -> &'static Facts {
        facts(self.known().unwrap_or(Autopilot::ArduPilot), airframe)
    }

    /// `MAV_AUTOPILOT` of its heartbeat.
    #[must_use]
    pub fn autopilot(self) -> u8 {
        let known = self.known();
        known.map_or(AUTOPILOT_GENERIC, |known| known.conventions().mav_autopilot)
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

    /// The version whose behaviour was measured.
    pub(crate) fn version(self) -> Option<Version> {
        self.known().map(|known| known.conventions().measured)
    }

    /// `AUTOPILOT_VERSION.flight_sw_version` of that version.
    pub(crate) fn flight_software(self) -> u32 {
        match self {
            Self::ArduPilot => u32::from_be_bytes([4, 6, 3, 255]),
            Self::Px4 => u32::from_be_bytes([1, 17, 0, 255]),
            Self::Generic => 0,
        }
    }

    /// `AUTOPILOT_VERSION.capabilities`.
    pub(crate) fn capabilities(self) -> u64 {
        // MISSION_INT, COMMAND_INT, MAVLINK2, MISSION_FENCE, MISSION_RALLY.
        let all = 4 | 8 | 8192 | 16384 | 32768;
        match self {
            // PARAM_ENCODE_BYTEWISE.
            Self::Px4 => all | 16,
            Self::ArduPilot | Self::Generic => all,
        }
    }

    /// Time between two requests for the same item, milliseconds.
    pub(crate) fn repeat_ms(self) -> u64 {
        self.known()
            .map_or(500, |known| known.conventions().request_ms)
    }

    /// Time without the item until it gives up the transfer, milliseconds.
    pub(crate) fn give_up_ms(self) -> u64 {
        self.known()
            .map_or(2500, |known| known.conventions().give_up_ms)
    }

    /// Greatest number of items in a list, home included where there is one.
    pub(crate) fn capacity(self, list: MissionType, airframe: Airframe) -> usize {
        let Some(known) = self.known() else {
            return 10_000;
        };
        let capacity = facts(known, airframe).capacity;
        match list {
            MissionType::Mission => capacity.items + usize::from(known.conventions().counts_home),
            MissionType::Fence => capacity.fence,
            MissionType::Rally => capacity.rally,
        }
    }
}

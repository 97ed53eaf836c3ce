//! Flight modes as the autopilots number them.

use super::profile::Profile;
use crate::spec::Airframe;

/// What a mode makes the vehicle do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mode {
    /// Flies its mission.
    Mission,
    /// Stays where it is.
    Hold,
    /// Lands where it is.
    Land,
    /// Returns to launch.
    Return,
}

/// ArduCopter's `AUTO`.
const ARDUPILOT_AUTO: u32 = 3;
/// ArduCopter's `LOITER`.
const ARDUPILOT_LOITER: u32 = 5;
/// ArduCopter's `RTL`.
const ARDUPILOT_RTL: u32 = 6;
/// ArduCopter's `LAND`.
const ARDUPILOT_LAND: u32 = 9;

/// PX4's main mode `AUTO`, with a sub mode.
const fn px4_auto(sub: u32) -> u32 {
    4 << 16 | sub << 24
}

/// ArduPlane's `AUTO`.
const ARDUPLANE_AUTO: u32 = 10;
/// ArduPlane's `RTL`.
const ARDUPLANE_RTL: u32 = 11;
/// ArduPlane's `LOITER`: circles.
const ARDUPLANE_LOITER: u32 = 12;
/// ArduPlane's `QLAND`, of a `QuadPlane`.
const ARDUPLANE_QLAND: u32 = 20;

impl Mode {
    /// What the number of a mode means. A mode that a pilot with sticks would fly is a hold.
    pub(crate) fn of(profile: Profile, airframe: Airframe, custom_mode: u32) -> Self {
        match (profile, custom_mode) {
            (Profile::Px4, mode) if mode == px4_auto(4) => Self::Mission,
            (Profile::Px4, mode) if mode == px4_auto(5) => Self::Return,
            (Profile::Px4, mode) if mode == px4_auto(6) => Self::Land,
            (Profile::ArduPilot, mode) if airframe.has_wing() => match mode {
                ARDUPLANE_AUTO => Self::Mission,
                ARDUPLANE_RTL => Self::Return,
                ARDUPLANE_QLAND if airframe == Airframe::Vtol => Self::Land,
                _ => Self::Hold,
            },
            (Profile::ArduPilot, ARDUPILOT_AUTO) => Self::Mission,
            (Profile::ArduPilot, ARDUPILOT_LAND) => Self::Land,
            (Profile::ArduPilot, ARDUPILOT_RTL) => Self::Return,
            _ => Self::Hold,
        }
    }

    /// The number of a mode. An `ArduPlane` without rotors has none that lands where it is.
    pub(crate) fn number(self, profile: Profile, airframe: Airframe) -> u32 {
        match (profile, self) {
            (Profile::Px4, Self::Mission) => px4_auto(4),
            (Profile::Px4, Self::Hold) => px4_auto(3),
            (Profile::Px4, Self::Return) => px4_auto(5),
            (Profile::Px4, Self::Land) => px4_auto(6),
            (_, Self::Mission) if airframe.has_wing() => ARDUPLANE_AUTO,
            (_, Self::Return) if airframe.has_wing() => ARDUPLANE_RTL,
            (_, Self::Land) if airframe == Airframe::Vtol => ARDUPLANE_QLAND,
            (_, Self::Hold | Self::Land) if airframe.has_wing() => ARDUPLANE_LOITER,
            (_, Self::Mission) => ARDUPILOT_AUTO,
            (_, Self::Hold) => ARDUPILOT_LOITER,
            (_, Self::Return) => ARDUPILOT_RTL,
            (_, Self::Land) => ARDUPILOT_LAND,
        }
    }

    /// The mode after a start: `STABILIZE` of ArduCopter and `MANUAL` of ArduPlane, PX4's
    /// `AUTO.LOITER`.
    pub(crate) fn first(profile: Profile) -> u32 {
        match profile {
            Profile::Px4 => Self::Hold.number(profile, Airframe::Copter),
            Profile::ArduPilot | Profile::Generic => 0,
        }
    }
}

//! Effects of flight modes.

use super::profile::Profile;
use crate::autopilot::Airframe;

/// The effect of a mode on the vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mode {
    /// Flies its mission.
    Mission,
    /// Stays at its place.
    Hold,
    /// Lands at its place.
    Land,
    /// Returns to launch.
    Return,
}

impl Mode {
    /// The effect of a `custom_mode`. A mode that a pilot with sticks would fly is a hold.
    pub(crate) fn of(profile: Profile, airframe: Airframe, custom_mode: u32) -> Self {
        let modes = profile.facts(airframe).modes;
        let is = |mode: crate::autopilot::Mode| mode.custom_mode == custom_mode;
        match profile {
            Profile::Generic => Self::Hold,
            _ if is(modes.mission) => Self::Mission,
            _ if is(modes.return_to_launch) => Self::Return,
            _ if modes.land.is_some_and(is) => Self::Land,
            _ => Self::Hold,
        }
    }

    /// The `custom_mode` with this effect. An `ArduPlane` without rotors cannot land at its place.
    pub(crate) fn number(self, profile: Profile, airframe: Airframe) -> u32 {
        let modes = profile.facts(airframe).modes;
        let mode = match self {
            Self::Mission => modes.mission,
            Self::Hold => modes.loiter,
            Self::Land => modes.land.unwrap_or(modes.loiter),
            Self::Return => modes.return_to_launch,
        };
        mode.custom_mode
    }

    /// The `custom_mode` after power-up.
    pub(crate) fn first(profile: Profile) -> u32 {
        profile.facts(Airframe::Copter).modes.initial.custom_mode
    }
}

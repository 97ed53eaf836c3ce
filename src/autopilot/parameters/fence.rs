//! Fences that are no lists of items: a ceiling, a floor and a circle around home, by parameters.

use crate::autopilot::command;

/// A fence that is no list of items: a ceiling, a floor and a circle around home, by parameters.
#[derive(Clone, Copy, Debug)]
pub struct ParamFence {
    /// Parameters that switch it on, each by itself; empty: it is on.
    pub switches: &'static [&'static str],
    /// The command of a mission that switches it on, and its `param1` then.
    pub command: Option<(u16, f32)>,
    /// The parameter of what it does; 0: nothing.
    pub action: &'static str,
    /// The parameter with a bit for each kind, and its default.
    pub kinds: Option<(&'static str, u8)>,
    /// Bit of the ceiling, and the parameter of its height above home.
    pub ceiling: (u8, &'static str),
    /// Bit of the circle, and the parameter of its radius.
    pub circle: (u8, &'static str),
    /// Bit of the floor, and the parameter of its height above home, if there is one.
    pub floor: Option<(u8, &'static str)>,
}

/// `AC_Fence`.
pub(in crate::autopilot) const ARDUCOPTER_FENCE: ParamFence = ParamFence {
    switches: &["FENCE_ENABLE", "FENCE_AUTOENABLE"],
    // `AP_Mission::start_command_fence`.
    command: Some((command::DO_FENCE_ENABLE, 1.0)),
    action: "FENCE_ACTION",
    kinds: Some(("FENCE_TYPE", 7)),
    ceiling: (1, "FENCE_ALT_MAX"),
    circle: (2, "FENCE_RADIUS"),
    floor: Some((8, "FENCE_ALT_MIN")),
};
pub(in crate::autopilot) const ARDUPLANE_FENCE: ParamFence = ParamFence {
    kinds: Some(("FENCE_TYPE", 4)),
    ..ARDUCOPTER_FENCE
};
/// `Geofence::isCloserThanMaxDistToHome`, `Geofence::isBelowMaxAltitude`.
pub(in crate::autopilot) const PX4_FENCE: ParamFence = ParamFence {
    switches: &[],
    command: None,
    action: "GF_ACTION",
    kinds: None,
    ceiling: (1, "GF_MAX_VER_DIST"),
    circle: (2, "GF_MAX_HOR_DIST"),
    floor: None,
};

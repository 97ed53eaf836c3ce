//! Parameter values with which the verdict knows how a mission is flown, and how a vehicle returns.

use std::fmt;

/// The values of a parameter with which the verdict knows how a mission is flown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Judged {
    /// This whole number.
    Is(i32),
    /// 0 to this.
    UpTo(f64),
    /// At least this.
    AtLeast(f64),
    /// 0, or at least this.
    ZeroOr(f64),
    /// Below 0.
    Negative,
    /// Any but this whole number.
    IsNot(i32),
    /// Any in which none of these bits is set.
    Without(u32),
}

impl Judged {
    /// Whether the value of a file is one of them.
    #[must_use]
    pub fn knows(self, value: f64) -> bool {
        match self {
            Self::Is(whole) => (value - f64::from(whole)).abs() < 1e-6,
            Self::IsNot(whole) => (value - f64::from(whole)).abs() >= 0.5,
            Self::UpTo(most) => (0.0..=most).contains(&value),
            Self::AtLeast(least) => value >= least,
            Self::ZeroOr(least) => value.abs() < 1e-6 || value >= least,
            Self::Negative => value < 0.0,
            Self::Without(bits) => (0..32).all(|bit| {
                let weight = f64::from(1_u32 << bit);
                bits >> bit & 1 == 0 || value.rem_euclid(2.0 * weight) < weight
            }),
        }
    }
}

impl fmt::Display for Judged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Is(whole) => write!(f, "{whole}"),
            Self::IsNot(whole) => write!(f, "not {whole}"),
            Self::UpTo(most) => write!(f, "0 to {most}"),
            Self::AtLeast(least) => write!(f, "at least {least}"),
            Self::ZeroOr(least) => write!(f, "0, or at least {least}"),
            Self::Negative => f.write_str("below 0"),
            Self::Without(bits) => write!(f, "without the bits of {bits}"),
        }
    }
}

const OFF: Judged = Judged::Is(0);
const ON: Judged = Judged::Is(1);
/// Below 0 PX4 leaves the parameters alone that these set.
const UNSET: Judged = Judged::Negative;

/// `PSC_ANGLE_MAX` limits the lean below `ANGLE_MAX`; with `OA_TYPE` it stops at waypoints and goes around.
pub(in crate::autopilot) const COPTER_JUDGED: &[(&str, Judged)] =
    &[("PSC_ANGLE_MAX", OFF), ("OA_TYPE", OFF)];
/// Pitch of `TECS_PITCH_MAX`, 0 for that of `PTCH_LIM_MAX_DEG`: with 8 a plane did not hold the climb of `TECS_CLMB_MAX` and
/// flew 100 m below its line (ArduPlane 4.7.0-beta1, simulated).
const CLIMB_PITCH: Judged = Judged::ZeroOr(15.0);
const PITCH_LIMIT: Judged = Judged::AtLeast(15.0);
/// Of `THR_MAX`, percent: with 50 it held its slope.
const CLIMB_THROTTLE: Judged = Judged::AtLeast(50.0);
/// `IMMEDIATE_CLIMB_IN_AUTO` (bit 14); in wind a ground speed that is held, up and down in thermals. Without an airspeed
/// sensor, or with one that counts only at zero throttle (`ARSPD_USE` 2), `AP_TECS::_update_speed` takes its speed to be
/// the one that it should have, and the throttle alone decides how fast it flies.
pub(in crate::autopilot) const WING_JUDGED: &[(&str, Judged)] = &[
    ("FLIGHT_OPTIONS", Judged::Without(1 << 14)),
    ("MIN_GROUNDSPEED", OFF),
    ("MIN_GNDSPD_CM", OFF),
    ("SOAR_ENABLE", OFF),
    ("ARSPD_ENABLE", ON),
    ("ARSPD_TYPE", Judged::IsNot(0)),
    ("ARSPD_USE", ON),
    ("TECS_PITCH_MAX", CLIMB_PITCH),
    ("PTCH_LIM_MAX_DEG", PITCH_LIMIT),
    ("THR_MAX", CLIMB_THROTTLE),
];
pub(in crate::autopilot) const PLANE_JUDGED: &[(&str, Judged)] = &[("Q_ENABLE", OFF)];
/// Those of `Q_OPTIONS` for an approach on the wing (bit 4) and altitudes of takeoffs (bit 3).
pub(in crate::autopilot) const QUADPLANE_JUDGED: &[(&str, Judged)] = &[
    ("Q_OPTIONS", Judged::Without(1 << 3 | 1 << 4)),
    ("Q_ENABLE", ON),
];
/// The first three set others (`MulticopterPositionControl::parameters_update`): speeds, accelerations,
/// lean; a wing goes faster in wind than planned for the last.
pub(in crate::autopilot) const PX4_JUDGED: &[(&str, Judged)] = &[
    ("MPC_XY_VEL_ALL", UNSET),
    ("MPC_Z_VEL_ALL", UNSET),
    ("SYS_VEHICLE_RESP", UNSET),
    ("FW_GND_SPD_MIN", Judged::UpTo(5.0)),
];

/// Parameters that lead a return elsewhere than the verdict flies it, with the value of those that
/// do not: where a mission comes with another value, its return is not known.
pub(in crate::autopilot) const COPTER_RETURNS: &[(&str, f64)] = &[("RTL_ALT_TYPE", 0.0)];
pub(in crate::autopilot) const PLANE_RETURNS: &[(&str, f64)] = &[
    ("RTL_AUTOLAND", 0.0),
    ("RTL_CLIMB_MIN", 0.0),
    ("Q_RTL_MODE", 0.0),
    ("TERRAIN_FOLLOW", 0.0),
];
/// `RTL_LAND_DELAY` below 0 stays over home, and is read as such.
pub(in crate::autopilot) const PX4_RETURNS: &[(&str, f64)] = &[("RTL_TYPE", 0.0)];

#[cfg(test)]
mod tests {
    use super::{Judged, OFF, UNSET};

    #[test]
    fn other_values_than_the_judged_ones_are_found() {
        let bits = Judged::Without(1 << 3 | 1 << 4);
        for (judged, value, is_known) in [
            (bits, 0.0, true),
            (bits, 7.0, true),
            (bits, 8.0, false),
            (bits, 16.0, false),
            (bits, 32.0 + 16.0, false),
            (bits, 32.0, true),
            (OFF, 0.0, true),
            (OFF, 5.0, false),
            (UNSET, -10.0, true),
            (UNSET, 0.0, false),
            (UNSET, 6.1, false),
            (Judged::IsNot(0), 1.0, true),
            (Judged::IsNot(0), 0.0, false),
            (Judged::IsNot(0), f64::NAN, false),
        ] {
            assert_eq!(judged.knows(value), is_known, "{judged} {value}");
        }
    }
}

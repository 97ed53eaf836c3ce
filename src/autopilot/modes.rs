//! Flight modes, as `HEARTBEAT.custom_mode` numbers them.

use super::{Airframe, Autopilot};

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
    /// Holds its position without input of a pilot; a plane loiters.
    pub hold: Mode,
    /// `MAV_CMD_NAV_LOITER_UNLIM` as a command changes to this mode.
    pub loiter: Mode,
    /// Lands at the place; none for a plane of ArduPilot, which needs an approach.
    pub land: Option<Mode>,
    /// Returns to launch.
    pub return_to_launch: Mode,
}

/// `mode.h` of ArduCopter 4.7.
const ARDUCOPTER: &[(u32, &str)] = &[
    (0, "STABILIZE"),
    (1, "ACRO"),
    (2, "ALT_HOLD"),
    (3, "AUTO"),
    (4, "GUIDED"),
    (5, "LOITER"),
    (6, "RTL"),
    (7, "CIRCLE"),
    (9, "LAND"),
    (11, "DRIFT"),
    (13, "SPORT"),
    (14, "FLIP"),
    (15, "AUTOTUNE"),
    (16, "POSHOLD"),
    (17, "BRAKE"),
    (18, "THROW"),
    (19, "AVOID_ADSB"),
    (20, "GUIDED_NOGPS"),
    (21, "SMART_RTL"),
    (22, "FLOWHOLD"),
    (23, "FOLLOW"),
    (24, "ZIGZAG"),
    (25, "SYSTEMID"),
    (26, "AUTOROTATE"),
    (27, "AUTO_RTL"),
];

/// `mode.h` of ArduPlane 4.7.
const ARDUPLANE: &[(u32, &str)] = &[
    (0, "MANUAL"),
    (1, "CIRCLE"),
    (2, "STABILIZE"),
    (3, "TRAINING"),
    (4, "ACRO"),
    (5, "FBWA"),
    (6, "FBWB"),
    (7, "CRUISE"),
    (8, "AUTOTUNE"),
    (10, "AUTO"),
    (11, "RTL"),
    (12, "LOITER"),
    (13, "TAKEOFF"),
    (14, "AVOID_ADSB"),
    (15, "GUIDED"),
    (17, "QSTABILIZE"),
    (18, "QHOVER"),
    (19, "QLOITER"),
    (20, "QLAND"),
    (21, "QRTL"),
    (22, "QAUTOTUNE"),
    (23, "QACRO"),
    (24, "THERMAL"),
    (25, "LOITER_ALT_QLAND"),
    (26, "AUTOLAND"),
];

/// Main mode and sub mode of PX4 1.18 (`px4_custom_mode.h`); sub mode 0 where there is none.
const PX4: &[(u8, u8, &str)] = &[
    (1, 0, "MANUAL"),
    (2, 0, "ALTCTL"),
    (3, 0, "POSCTL"),
    (4, 1, "AUTO.READY"),
    (4, 2, "AUTO.TAKEOFF"),
    (4, 3, "AUTO.LOITER"),
    (4, 4, "AUTO.MISSION"),
    (4, 5, "AUTO.RTL"),
    (4, 6, "AUTO.LAND"),
    (4, 8, "AUTO.FOLLOW_TARGET"),
    (4, 9, "AUTO.PRECLAND"),
    (4, 10, "AUTO.VTOL_TAKEOFF"),
    (5, 0, "ACRO"),
    (6, 0, "OFFBOARD"),
    (7, 0, "STABILIZED"),
    (10, 0, "TERMINATION"),
    (11, 0, "ALTITUDE_CRUISE"),
];

/// The name of a `HEARTBEAT.custom_mode` in its autopilot, if it is known.
#[must_use]
pub fn mode_name(
    autopilot: Autopilot,
    airframe: Airframe,
    custom_mode: u32,
) -> Option<&'static str> {
    let [sub, main, _, _] = custom_mode.to_be_bytes();
    let numbered = |names: &[(u32, &'static str)]| {
        let found = names.iter().find(|(number, _)| *number == custom_mode);
        found.map(|(_, name)| *name)
    };
    match (autopilot, airframe) {
        (Autopilot::ArduPilot, Airframe::Copter) => numbered(ARDUCOPTER),
        (Autopilot::ArduPilot, Airframe::Plane | Airframe::Vtol) => numbered(ARDUPLANE),
        (Autopilot::Px4, _) => {
            let mut names = PX4.iter();
            let found = names.find(|(of, part, _)| *of == main && (*part == sub || *part == 0));
            found.map(|(_, _, name)| *name)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::autopilot::facts;

    #[test]
    fn every_mode_of_the_tables_has_the_name_of_the_table_of_all() {
        for autopilot in Autopilot::ALL {
            for airframe in Airframe::ALL {
                let Modes {
                    initial,
                    arming,
                    mission,
                    hold,
                    loiter,
                    land,
                    return_to_launch,
                } = facts(autopilot, airframe).modes;
                let all = [initial, arming, mission, hold, loiter, return_to_launch];
                for mode in all.into_iter().chain(land) {
                    let name = mode_name(autopilot, airframe, mode.custom_mode);
                    assert_eq!(name, Some(mode.name), "{autopilot:?} {airframe:?}");
                }
            }
        }
        assert_eq!(mode_name(Autopilot::Px4, Airframe::Copter, 9 << 16), None);
    }
}

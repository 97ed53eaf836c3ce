//! Parameters that a version renamed: the other name, and a value in the unit of the other one.

use super::ardupilot::{COPTER_LEAN, SLOPE_MIN};
use super::parameter;
use crate::autopilot::version::Version;

/// The other name of a parameter that a version renamed.
#[must_use]
pub fn other_name(name: &str) -> Option<&'static str> {
    RENAMED.iter().find_map(|[new, old]| match name {
        _ if name == *new => Some(*old),
        _ if name == *old => Some(*new),
        _ => None,
    })
}

/// What a value of one parameter is as a value of another: both names may be of one parameter, in
/// different units.
#[must_use]
pub fn in_unit_of(value: f64, from: &str, to: &str) -> f64 {
    let per_si = |name: &str| parameter(name).map_or(1.0, |row| row.unit.per_si());
    value / per_si(from) * per_si(to)
}

/// The name of a parameter in a version, where that is known and renamed it.
#[must_use]
pub fn name_in(name: &'static str, version: Option<Version>) -> &'static str {
    let has = |name: &str| {
        let range = parameter(name).map(|row| row.versions);
        version.is_none_or(|version| range.is_none_or(|range| range.contains(version)))
    };
    match other_name(name) {
        Some(other) if !has(name) && has(other) => other,
        _ => name,
    }
}

/// Parameters that a version renamed, the new name first. ArduPilot 4.7 left centimetres for metres
/// (its wiki, `common-param-name-changes`), ArduPlane 4.5 hundredths (`Plane::load_parameters`).
const RENAMED: &[[&str; 2]] = &[
    SLOPE_MIN,
    COPTER_LEAN,
    ["WP_SPD", "WPNAV_SPEED"],
    ["WP_SPD_UP", "WPNAV_SPEED_UP"],
    ["WP_SPD_DN", "WPNAV_SPEED_DN"],
    ["WP_ACC", "WPNAV_ACCEL"],
    ["WP_ACC_CNR", "WPNAV_ACCEL_C"],
    ["WP_JERK", "WPNAV_JERK"],
    ["WP_ACC_Z", "WPNAV_ACCEL_Z"],
    ["WP_RADIUS_M", "WPNAV_RADIUS"],
    ["CIRCLE_RADIUS_M", "CIRCLE_RADIUS"],
    ["LAND_SPD_MS", "LAND_SPEED"],
    ["LAND_SPD_HIGH_MS", "LAND_SPEED_HIGH"],
    ["LAND_ALT_LOW_M", "LAND_ALT_LOW"],
    ["RTL_ALT_M", "RTL_ALT"],
    ["RTL_ALT_FINAL_M", "RTL_ALT_FINAL"],
    ["RTL_CLIMB_MIN_M", "RTL_CLIMB_MIN"],
    ["RTL_SPEED_MS", "RTL_SPEED"],
    ["Q_WP_SPD_UP", "Q_WP_SPEED_UP"],
    ["Q_WP_SPD_DN", "Q_WP_SPEED_DN"],
    ["AIRSPEED_CRUISE", "TRIM_ARSPD_CM"],
    ["AIRSPEED_MIN", "ARSPD_FBW_MIN"],
    ["AIRSPEED_MAX", "ARSPD_FBW_MAX"],
    ["ROLL_LIMIT_DEG", "LIM_ROLL_CD"],
    ["RTL_ALTITUDE", "ALT_HOLD_RTL"],
    ["MIN_GROUNDSPEED", "MIN_GNDSPD_CM"],
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::autopilot::version::version;

    #[test]
    fn both_names_of_a_parameter_have_one_default_and_no_version() {
        for [new, old] in RENAMED {
            let [new_row, old_row] = [new, old].map(|name| parameter(name).expect("a row"));
            assert!(
                (new_row.default_si() - old_row.default_si()).abs() < 1e-6,
                "{new} {old}"
            );
            for minor in 0..9 {
                let at = version(4, minor);
                assert!(
                    !(old_row.versions.contains(at) && new_row.versions.contains(at)) || minor < 5,
                    "{new} {old} {at}"
                );
                assert_eq!(other_name(new), Some(*old));
                assert_eq!(other_name(old), Some(*new));
            }
        }
        assert_eq!(name_in("WPNAV_SPEED", Some(version(4, 7))), "WP_SPD");
        assert_eq!(name_in("WPNAV_SPEED", Some(version(4, 6))), "WPNAV_SPEED");
        assert_eq!(name_in("WPNAV_SPEED", None), "WPNAV_SPEED");
        assert!((in_unit_of(12.5, "WP_SPD", "WPNAV_SPEED") - 1250.0).abs() < 1e-9);
    }
}

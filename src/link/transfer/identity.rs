//! Identification: whether a vehicle is the one of the spec.

use super::report::Refusal;
use crate::autopilot::{Airframe, Autopilot};
use crate::link::message::{AUTOPILOT_GENERIC, AUTOPILOT_INVALID, Address, Heartbeat};

/// `MAV_TYPE`s that fly like a multicopter: quadrotor, coaxial, helicopter,
/// hexarotor, octorotor, tricopter, dodecarotor, decarotor, generic multirotor.
const COPTER_TYPES: [u8; 9] = [2, 3, 4, 13, 14, 15, 29, 35, 43];

/// `MAV_TYPE_FIXED_WING`.
const PLANE_TYPES: [u8; 1] = [1];

/// `MAV_TYPE`s of VTOL, and fixed wing, as which ArduPlane reports a QuadPlane (`Q_MAV_TYPE` 0).
const VTOL_TYPES: [u8; 8] = [1, 19, 20, 21, 22, 23, 24, 25];

/// `MAV_TYPE`s that are no vehicle: ground station, antenna tracker, onboard controller,
/// gimbal, ADS-B receiver, camera, charging station, FLARM, servo, remote id.
const PAYLOAD_TYPES: [u8; 10] = [6, 5, 18, 26, 27, 30, 31, 32, 33, 34];

/// `MAV_COMP_ID_AUTOPILOT1`.
const AUTOPILOT_COMPONENT: u8 = 1;

/// Whether a heartbeat comes from an autopilot and not from a ground station, a payload or
/// a companion computer. Companions may claim a generic autopilot, but have an own component.
pub(crate) fn is_autopilot(from: Address, heartbeat: &Heartbeat) -> bool {
    let is_companion =
        from.component != AUTOPILOT_COMPONENT && heartbeat.autopilot == AUTOPILOT_GENERIC;
    !PAYLOAD_TYPES.contains(&heartbeat.kind)
        && heartbeat.autopilot != AUTOPILOT_INVALID
        && !is_companion
}

/// Whether this is the component of an autopilot. Another component that claims to be one may be
/// a companion computer that repeats what its autopilot says.
pub(crate) fn is_first_choice(from: Address) -> bool {
    from.component == AUTOPILOT_COMPONENT
}

/// Refuses a vehicle that is not the one of the spec, or that is armed.
/// An autopilot or type 0 (generic) is no mismatch.
pub(crate) fn check(
    heartbeat: &Heartbeat,
    autopilot: Autopilot,
    airframe: Airframe,
) -> Result<(), Refusal> {
    if heartbeat.is_armed() {
        return Err(Refusal::Armed);
    }
    check_kind(heartbeat, autopilot, airframe)
}

/// Refuses a vehicle of another autopilot or airframe than in the spec.
pub(crate) fn check_kind(
    heartbeat: &Heartbeat,
    autopilot: Autopilot,
    airframe: Airframe,
) -> Result<(), Refusal> {
    if Autopilot::of_mavlink(heartbeat.autopilot).is_none_or(|found| found != autopilot)
        && heartbeat.autopilot != AUTOPILOT_GENERIC
    {
        return Err(Refusal::Autopilot {
            expected: autopilot.name(),
            found: describe_autopilot(heartbeat.autopilot),
        });
    }
    let (expected, types) = match airframe {
        Airframe::Copter => ("copter", COPTER_TYPES.as_slice()),
        Airframe::Plane => ("plane", PLANE_TYPES.as_slice()),
        Airframe::Vtol if autopilot == Autopilot::Px4 => ("VTOL", &VTOL_TYPES[1..]),
        Airframe::Vtol => ("VTOL", VTOL_TYPES.as_slice()),
    };
    if heartbeat.kind != 0 && !types.contains(&heartbeat.kind) {
        return Err(Refusal::Type {
            expected,
            found: describe_type(heartbeat.kind),
        });
    }
    Ok(())
}

/// `AUTOPILOT_VERSION.flight_sw_version` in words, such as `4.6.3` or `1.18.0-beta`;
/// empty if unknown.
pub(crate) fn version(flight_software: u32) -> String {
    let [major, minor, patch, kind] = flight_software.to_be_bytes();
    if flight_software == 0 {
        return String::new();
    }
    // FIRMWARE_VERSION_TYPE, whose values are the least of each kind.
    let kind = match kind {
        255 => "",
        192.. => "-rc",
        128.. => "-beta",
        64.. => "-alpha",
        _ => "-dev",
    };
    format!("{major}.{minor}.{patch}{kind}")
}

/// Autopilot and type in words.
pub(crate) fn describe(heartbeat: &Heartbeat) -> String {
    format!(
        "{} {}",
        describe_autopilot(heartbeat.autopilot),
        describe_type(heartbeat.kind)
    )
}

fn describe_autopilot(autopilot: u8) -> String {
    match (autopilot, Autopilot::of_mavlink(autopilot)) {
        (AUTOPILOT_GENERIC, _) => "generic autopilot".to_owned(),
        (_, Some(known)) => known.name().to_owned(),
        (number, None) => format!("autopilot {number}"),
    }
}

fn describe_type(kind: u8) -> String {
    let name = match kind {
        0 => "vehicle",
        1 => "fixed wing",
        2 => "quadrotor",
        3 => "coaxial helicopter",
        4 => "helicopter",
        10 => "rover",
        11 => "boat",
        12 => "submarine",
        13 => "hexarotor",
        14 => "octorotor",
        15 => "tricopter",
        19..=25 => "VTOL",
        29 => "dodecarotor",
        35 => "decarotor",
        other => return format!("type {other}"),
    };
    name.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heartbeat(kind: u8, autopilot: u8, base_mode: u8) -> Heartbeat {
        Heartbeat {
            kind,
            autopilot,
            base_mode,
            custom_mode: 0,
            system_status: 3,
        }
    }

    #[test]
    fn a_version_is_written_as_its_project_writes_it() {
        assert_eq!(version(0), "");
        assert_eq!(version(0x0406_03ff), "4.6.3");
        assert_eq!(version(0x0406_0000), "4.6.0-dev");
        assert_eq!(version(0x0112_0080), "1.18.0-beta");
        assert_eq!(version(0x0112_00c1), "1.18.0-rc");
    }

    #[test]
    fn a_companion_that_claims_a_generic_autopilot_is_none() {
        let from = |component| Address {
            system: 1,
            component,
        };
        assert!(is_autopilot(from(1), &heartbeat(2, AUTOPILOT_GENERIC, 0)));
        assert!(is_autopilot(
            from(2),
            &heartbeat(2, Autopilot::Px4.conventions().mav_autopilot, 0)
        ));
        assert!(!is_autopilot(
            from(191),
            &heartbeat(0, AUTOPILOT_GENERIC, 0)
        ));
        assert!(!is_autopilot(
            from(1),
            &heartbeat(18, Autopilot::Px4.conventions().mav_autopilot, 0)
        ));
    }

    #[test]
    fn generic_is_no_mismatch_and_everything_else_is() {
        let check = |heartbeat| check(&heartbeat, Autopilot::Px4, Airframe::Copter);
        assert_eq!(check(heartbeat(0, 0, 0)), Ok(()));
        assert_eq!(check(heartbeat(2, 12, 0)), Ok(()));
        assert_eq!(check(heartbeat(2, 12, 128)), Err(Refusal::Armed));
        let text = |heartbeat| check(heartbeat).expect_err("a mismatch").to_string();
        assert_eq!(
            text(heartbeat(2, 3, 0)),
            "the spec says PX4, the vehicle says ArduPilot"
        );
        assert_eq!(
            text(heartbeat(2, 13, 0)),
            "the spec says PX4, the vehicle says autopilot 13"
        );
        assert_eq!(
            text(heartbeat(1, 12, 0)),
            "the spec says copter, the vehicle says fixed wing"
        );
    }
}

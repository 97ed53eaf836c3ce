//! How much later than the flight model real autopilots are.
//!
//! Measured on ArduCopter 4.7.0-dev of December 2025 in ArduPilot's simulator, still air, under
//! `sortie fly`, at 10 m/s. Three on the level `missions/sitl-ardupilot.yaml`: 5.5 to 6.0 s late over
//! their homes (motors that spin up, jerk upwards), 6.1 to 8.5 s at waypoints, 10.5 s after a stop
//! with a turn back, 4.4 s more than before it (`WPNAV_JERK`). Two over the ridge of Jacksboro: 8.3 s
//! and, where slopes change by 7 degrees, 11.6 s at waypoints, 16.4 s after a stop, 4.2 s more than
//! before it. ArduCopter 4.6.0-dev was 6 s late on the first of these.
//!
//! ArduPlane (4.7.0-dev, simulated): a plane was 7 to 8 s early at its start, as it runs and climbs
//! faster than planned; a QuadPlane was 1 s late over its home.

use crate::spec::{Airframe, Span, Vehicle};

/// A stop on the way takes up to so much longer than the model has it, seconds: measured on
/// ArduCopter, assumed of all others.
pub const STOP_LATE_S: f64 = 4.5;

/// By how much a vehicle may be late from its takeoff on, seconds. Any lateness in the span may
/// be: a vehicle with lighter propellers, or a simulated one, is less late than those measured.
/// It is taken to be the same for two vehicles of one autopilot and airframe: those measured were
/// within 5.5 s of each other, which is for `time_slack_s` to cover.
///
/// Measured on ArduCopter, assumed of PX4 and of rotors under a wing.
fn takeoff_lateness_s(vehicle: &Vehicle) -> Span {
    match vehicle.airframe {
        Airframe::Copter | Airframe::Vtol => Span {
            least: 0.0,
            most: 12.0,
        },
        Airframe::Plane => Span {
            least: -9.0,
            most: 0.0,
        },
    }
}

/// Whether two vehicles are late alike: of one autopilot and airframe.
fn are_late_alike(one: &Vehicle, other: &Vehicle) -> bool {
    (one.autopilot, one.airframe) == (other.autopilot, other.airframe)
}

/// By how much the second of two vehicles may be shifted against the first without any shift of
/// departures, seconds: by the lateness of both where they are not late alike.
#[must_use]
pub fn takeoff_shift_s(a: &Vehicle, b: &Vehicle) -> Span {
    if are_late_alike(a, b) {
        return Span {
            least: 0.0,
            most: 0.0,
        };
    }
    let (late, other) = (takeoff_lateness_s(a), takeoff_lateness_s(b));
    Span {
        least: late.least - other.most,
        most: late.most - other.least,
    }
}

/// That, with the stops behind each of them.
#[must_use]
pub fn with_stops_s(shift_s: Span, late_s: f64, other_late_s: f64) -> Span {
    Span {
        least: shift_s.least - other_late_s,
        most: shift_s.most + late_s,
    }
}

/// The most that two of these may be shifted against each other by what autopilots are late,
/// seconds; each comes with what its stops make it late by.
#[must_use]
pub fn most_shift_s<'a>(fleet: impl Iterator<Item = (&'a Vehicle, f64)>) -> f64 {
    let (mut least_s, mut most_s, mut stops_s) = (0.0_f64, 0.0_f64, 0.0_f64);
    let (mut first, mut are_alike) = (None, true);
    for (vehicle, late_s) in fleet {
        let late = takeoff_lateness_s(vehicle);
        (least_s, most_s) = (least_s.min(late.least), most_s.max(late.most));
        stops_s = stops_s.max(late_s);
        are_alike &= are_late_alike(first.get_or_insert(vehicle), vehicle);
    }
    if are_alike {
        stops_s
    } else {
        stops_s + most_s - least_s
    }
}

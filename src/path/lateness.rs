//! How much later than the flight model real autopilots are.
//!
//! Measured on ArduCopter 4.7.0-dev of December 2025 in ArduPilot's simulator, still air, under
//! `sortie fly`, at 10 m/s. Three on the level `missions/sitl-ardupilot.yaml`: 5.5 to 6.0 s late over
//! their homes (motors that spin up, jerk upwards), 6.1 to 8.5 s at waypoints, 10.5 s after a stop
//! with a turn back, 4.4 s more than before it (`WPNAV_JERK`). Two over the ridge of Jacksboro: 8.3 s
//! and, where slopes change by 7 degrees, 11.6 s at waypoints, 16.4 s after a stop, 4.2 s more than
//! before it. ArduCopter 4.6.0-dev was 6 s late on the first of these.
//!
//! PX4 (1.16 alpha of December 2024, its own simulated quadrotor, still air, positions 0.3 m off; on
//! the clock of the vehicle), three at once under `sortie fly`: on flat ground at 7 and 8 m/s, over
//! the ridge of Jacksboro at 8 and at 12 m/s (there with less drag). 6.0 to 10.1 s late over their
//! homes, up to 12.3 s at the end of the first leg. Then it slows down for corners and changes of
//! slope, by itself and unlike `ArduCopter`: at 8 m/s by up to 2.1 s a leg (slopes that change by 14
//! degrees), 12.5 s more after twelve legs; at 12 m/s 1.7 s a corner of 20 degrees, 6.0 s after four
//! such legs in a row, 20.7 s after 23 legs. A stop with a turn back took 4.6 s more.
//!
//! ArduPlane (4.7.0-dev, simulated): a plane was 7 to 8 s early at its start, as it runs and climbs
//! faster than planned; a QuadPlane was 1 s late over its home.

use crate::spec::{Airframe, Autopilot, Span, Vehicle};

/// A stop on the way takes up to so much longer than the model has it, seconds: measured on
/// `ArduCopter` and, together with the leg to it, on PX4; assumed of all others.
pub const STOP_LATE_S: f64 = 4.5;

/// So much a PX4 copter may lose on every leg, seconds: what was measured over a few legs in a row,
/// at 8 and 12 m/s.
const PX4_LEG_LATE_S: f64 = 1.5;

/// By how much a vehicle may be later at the end of a leg than at its beginning, seconds. None was
/// measured to be on `ArduCopter`; wings have a model of their own.
#[must_use]
pub fn leg_late_s(vehicle: &Vehicle) -> f64 {
    match (vehicle.autopilot, vehicle.airframe) {
        (Autopilot::Px4, Airframe::Copter) => PX4_LEG_LATE_S,
        _ => 0.0,
    }
}

/// By how much a vehicle may be late from its takeoff on, seconds. Any lateness in the span may
/// be: a vehicle with lighter propellers, or a simulated one, is less late than those measured.
/// It is taken to be the same for two vehicles of one autopilot and airframe: those measured were
/// within 5.5 s of each other, which is for `time_slack_s` to cover.
///
/// Measured on `ArduCopter` and PX4 copters, assumed of rotors under a wing.
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

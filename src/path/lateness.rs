//! How much later than the flight model real autopilots are.
//!
//! Measured on three ArduCopters in ArduPilot's simulator, still air, under `sortie fly` on
//! `missions/sitl-ardupilot.yaml` at 10 m/s: the takeoff was over 5.5 to 6.0 s late (motors that
//! spin up, jerk upwards), waypoints were passed 6.1 to 8.5 s late (4.7.0-dev; 6 s with 4.6.0-dev),
//! and after the one stop with a turn back the vehicle was 10.5 s late, 4.4 s more than before it:
//! the jerk of `WPNAV_JERK` at either side of a stop.

use crate::spec::{Airframe, Span, Vehicle};

/// A stop on the way takes up to so much longer than the model has it, seconds: measured on
/// ArduCopter, assumed of all others.
pub const STOP_LATE_S: f64 = 4.5;

/// By how much a vehicle may be late from its takeoff on, seconds. Any lateness in the span may
/// be: a vehicle with lighter propellers, or a simulated one, is less late than those measured.
/// It is the same for two vehicles of one autopilot and airframe.
///
/// Measured on ArduCopter, assumed of PX4 and of rotors under a wing.
#[must_use]
pub fn takeoff_lateness_s(vehicle: &Vehicle) -> Span {
    match vehicle.airframe {
        Airframe::Copter | Airframe::Vtol => Span {
            least: 0.0,
            most: 8.0,
        },
        Airframe::Plane => Span {
            least: -9.0,
            most: 0.0,
        },
    }
}

/// Whether two vehicles are late alike: of one autopilot and airframe.
#[must_use]
pub fn are_late_alike(one: &Vehicle, other: &Vehicle) -> bool {
    (one.autopilot, one.airframe) == (other.autopilot, other.airframe)
}

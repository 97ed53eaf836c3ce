//! QGroundControl's `.plan`: JSON with mission, fence and rally points; and its `.mission`.

mod dropped;
mod landing_pattern;
mod mission_alone;
mod node;
mod read;
mod unique_keys;
mod write;

pub use read::read;
pub(super) use write::corner_count;
pub use write::write;

use crate::spec::{Airframe, Autopilot};

/// `MAV_AUTOPILOT` of `firmwareType`.
const FIRMWARE: [(u64, Autopilot); 2] = [(3, Autopilot::ArduPilot), (12, Autopilot::Px4)];

/// The airframe of a `vehicleType` (`MAV_TYPE`): fixed wing; quadrotor, coaxial, hexarotor,
/// octorotor, tricopter, dodecarotor, decarotor; the kinds of VTOL.
fn airframe(vehicle_type: u64) -> Option<Airframe> {
    match vehicle_type {
        1 => Some(Airframe::Plane),
        2 | 3 | 13 | 14 | 15 | 29 | 35 => Some(Airframe::Copter),
        19..=25 => Some(Airframe::Vtol),
        _ => None,
    }
}

/// `AltitudeMode` of a simple item.
mod altitude_mode {
    /// Mixed, or none.
    pub(super) const NONE: u64 = 0;
    /// Above home, frame 3.
    pub(super) const RELATIVE: u64 = 1;
    /// Above mean sea level, frame 0.
    pub(super) const ABSOLUTE: u64 = 2;
    /// Above the ground station's terrain; flown as frame 0.
    pub(super) const CALCULATED: u64 = 3;
    /// Above the vehicle's terrain, frame 10.
    pub(super) const TERRAIN: u64 = 4;
}

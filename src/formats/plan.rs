//! QGroundControl's `.plan`: JSON with mission, fence and rally points.

mod read;
mod unambiguous;
mod write;

pub use read::read;
pub use write::write;

use crate::spec::Autopilot;

/// `MAV_AUTOPILOT` of `firmwareType`.
const FIRMWARE: [(u64, Autopilot); 2] = [(3, Autopilot::ArduPilot), (12, Autopilot::Px4)];

/// `MAV_TYPE` of `vehicleType`: quadrotor, coaxial, hexarotor, octorotor, tricopter, dodecarotor, decarotor.
const MULTICOPTERS: [u64; 7] = [2, 3, 13, 14, 15, 29, 35];

/// `AltitudeMode` of a simple item.
mod altitude_mode {
    /// Mixed, or none.
    pub(super) const NONE: u64 = 0;
    /// Above home, frame 3.
    pub(super) const RELATIVE: u64 = 1;
    /// Above mean sea level, frame 0.
    pub(super) const ABSOLUTE: u64 = 2;
    /// Above terrain as the ground station knows it; flown as frame 0.
    pub(super) const CALCULATED: u64 = 3;
    /// Above terrain as the vehicle knows it, frame 10.
    pub(super) const TERRAIN: u64 = 4;
}

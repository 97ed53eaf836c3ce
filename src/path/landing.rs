//! How the last metres of a landing are flown: slowly, as the parameters that go
//! with every mission set it.

use crate::spec::Autopilot;

/// Below this height a landing is slow, metres: `LAND_ALT_LOW` of ArduPilot,
/// `MPC_LAND_ALT2` of PX4.
pub const SLOW_LANDING_M: f64 = 10.0;

/// The slow speed, m/s: `LAND_SPEED` of ArduPilot, `MPC_LAND_SPEED` of PX4.
#[must_use]
pub fn slow_landing_mps(autopilot: Autopilot) -> f64 {
    match autopilot {
        Autopilot::ArduPilot => 0.5,
        Autopilot::Px4 => 0.7,
    }
}

//! How a vehicle descends to land by the parameters of its mission.

use super::item::VehicleMission;
use crate::autopilot::SLOW_LANDING_M;
use crate::spec::Vehicle;

/// The descent of a landing on rotors: fast, and slow at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Descent {
    /// Down to the slow end, m/s.
    pub fast_mps: f64,
    /// At the slow end, m/s.
    pub slow_mps: f64,
    /// Height of the slow end above ground, metres.
    pub slow_below_m: f64,
}

impl Descent {
    /// By the parameters of a mission; that of a plan where it has none.
    #[must_use]
    pub fn of(vehicle: &Vehicle, mission: &VehicleMission) -> Self {
        let mut descent = Self {
            fast_mps: vehicle.descent_mps,
            slow_mps: vehicle.slow_descent_mps(),
            slow_below_m: SLOW_LANDING_M,
        };
        let Some(names) = mission.facts().landing else {
            return descent;
        };
        let held = |name: &str| mission.param_si(name).map(f64::abs);
        let some = |name: &str| held(name).filter(|value| *value > 0.0);
        if let Some(fast_mps) = names.fast.and_then(some) {
            descent.fast_mps = fast_mps;
        }
        let max_mps = names.most.and_then(some).unwrap_or(f64::INFINITY);
        descent.fast_mps = descent.fast_mps.min(max_mps);
        match some(names.slow) {
            Some(slow_mps) if names.slow_is_least => {
                descent.slow_mps = slow_mps;
                descent.fast_mps = descent.fast_mps.max(slow_mps);
            }
            own => {
                let slow_mps = own.unwrap_or(descent.slow_mps);
                descent.slow_mps = slow_mps.min(descent.fast_mps);
            }
        }
        let below_m = held(names.slow_below).unwrap_or(SLOW_LANDING_M);
        let at_least_m = names.slow_below_too.and_then(held).unwrap_or(0.0);
        descent.slow_below_m = below_m.max(at_least_m).max(names.min_m);
        descent
    }
}

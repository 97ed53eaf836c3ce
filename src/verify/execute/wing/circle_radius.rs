//! The radius of the circles that ArduPlane flies: wider the higher, unless `NAVL1_LIM_BANK` says how steeply
//! it may bank (`AP_L1_Control::loiter_radius`).

use crate::autopilot::Autopilot;
use crate::geodesy::{Amsl, true_airspeed_ratio};
use crate::mission::VehicleMission;
use crate::spec::{GRAVITY_MPS2, Vehicle};

/// How a wing widens its circles with altitude.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Widening {
    /// The bank that circles may have at sea level, radians; 0 for none.
    limit_rad: f64,
}

impl Widening {
    /// That of a mission's vehicle; only a wing of ArduPilot has one.
    pub(crate) fn of(vehicle: &Vehicle, mission: &VehicleMission) -> Option<Self> {
        let widens = vehicle.airframe.has_wing() && mission.autopilot == Autopilot::ArduPilot;
        let limit_deg = mission.param_si("NAVL1_LIM_BANK").unwrap_or(0.0);
        widens.then(|| Self {
            limit_rad: limit_deg.clamp(0.0, 89.0).to_radians(),
        })
    }

    /// The radius that is flown at an altitude and an indicated airspeed, metres; its sign is the direction.
    pub(crate) fn radius_m(self, stated_m: f64, at: Amsl, airspeed_mps: f64) -> f64 {
        let dense = true_airspeed_ratio(at).powi(2);
        let at_sea_m = airspeed_mps * airspeed_mps / (GRAVITY_MPS2 * self.limit_rad.tan());
        // Not finite without a limit.
        if at_sea_m <= stated_m.abs() {
            stated_m.abs().max(at_sea_m * dense).copysign(stated_m)
        } else {
            stated_m * dense
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Widening;
    use crate::geodesy::Amsl;

    fn widening(limit_deg: f64) -> Widening {
        Widening {
            limit_rad: f64::to_radians(limit_deg),
        }
    }

    #[test]
    fn circles_are_as_wide_as_arduplane_flew_them() {
        // ArduPlane 4.7.0-beta1, simulated, still air: 400 m at 4450 m above the sea, 628 to 629 m.
        let radius_m = widening(0.0).radius_m(-400.0, Amsl(4450.0), 16.0);
        assert!((radius_m + 628.5).abs() < 3.0, "{radius_m}");
    }

    #[test]
    fn with_a_limit_of_the_bank_a_circle_keeps_its_radius_where_the_wing_can() {
        // 16 m/s at 29.59 degrees: 46 m at the sea, 73 m at 4450 m.
        for (stated_m, flown_m) in [(400.0, 400.0), (-80.0, -80.0), (60.0, 72.3), (40.0, 62.9)] {
            let radius_m = widening(29.59).radius_m(stated_m, Amsl(4450.0), 16.0);
            assert!((radius_m - flown_m).abs() < 0.5, "{stated_m}: {radius_m}");
        }
    }
}

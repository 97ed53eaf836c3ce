//! How tightly a vehicle may turn and how steeply it may climb.

use crate::geodesy::Amsl;
use crate::spec::{Airframe, Vehicle, turn_radius_by_load_m};

/// What one vehicle can fly at its planned speed, whichever way the wind carries it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VehicleLimits {
    /// Greatest speed over the ground, m/s: the planned one, on a wing and the wind's.
    pub fastest_mps: f64,
    /// Horizontal acceleration when starting and stopping.
    pub accel_mps2: f64,
    /// Smallest turn radius R_min at that speed, metres: `v^2 / (g sqrt(n^2 - 1))`, and for a
    /// copter not below `v^2 / accel`, because it turns by tilting as it accelerates.
    pub turn_radius_m: f64,
    /// Steepest way up.
    pub climb: SlopeLimit,
    /// Steepest way down.
    pub descent: SlopeLimit,
}

/// The steepest slope, rise over run, always positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlopeLimit {
    shape: Shape,
    /// Vertical speed over the greatest ground speed.
    by_speed: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    /// Tangent of the greatest angle.
    Angle(f64),
    /// Coefficients of z^2, z and 1, z in metres (Eq. 27).
    Polynomial([f64; 3]),
}

/// Eq. 27, alpha: greatest slope of a climb.
const CLIMB: [f64; 3] = [-1.5377e-10, -2.6997e-5, 0.4211];
/// Eq. 27, beta with its sign turned: greatest slope of a descent.
const DESCENT: [f64; 3] = [-2.5063e-9, 6.3014e-6, 0.3257];
/// The polynomials of Eq. 27 make sense up to here, metres.
pub const POLYNOMIAL_TOP_M: f64 = 12_000.0;

impl VehicleLimits {
    /// The limits of a vehicle of the spec.
    #[must_use]
    pub fn of(vehicle: &Vehicle) -> Self {
        let speed_mps = vehicle.fastest_mps();
        let by_load_m = turn_radius_by_load_m(speed_mps, vehicle.max_load_factor);
        let turn_radius_m = match vehicle.airframe {
            Airframe::Copter => by_load_m.max(speed_mps * speed_mps / vehicle.accel_mps2),
            Airframe::Plane | Airframe::Vtol => by_load_m,
        };
        let slope = |angle_rad: Option<f64>, polynomial, vertical_mps: f64| SlopeLimit {
            shape: angle_rad.map_or(Shape::Polynomial(polynomial), |rad| Shape::Angle(rad.tan())),
            by_speed: vertical_mps / speed_mps,
        };
        Self {
            fastest_mps: speed_mps,
            accel_mps2: vehicle.accel_mps2,
            turn_radius_m,
            climb: slope(vehicle.max_climb_rad, CLIMB, vehicle.climb_mps),
            descent: slope(vehicle.max_descent_rad, DESCENT, vehicle.descent_mps),
        }
    }
}

impl VehicleLimits {
    /// Whether the slope limits are the same at every altitude.
    #[must_use]
    pub fn are_even(&self) -> bool {
        [self.climb, self.descent]
            .iter()
            .all(|limit| matches!(limit.shape, Shape::Angle(_)))
    }
}

impl SlopeLimit {
    /// The limit by angle or polynomial: coefficients of z^2, z and 1, z in metres
    /// between 0 and [`POLYNOMIAL_TOP_M`].
    #[must_use]
    pub fn polynomial(&self) -> [f64; 3] {
        match self.shape {
            Shape::Angle(slope) => [0.0, 0.0, slope],
            Shape::Polynomial(coefficients) => coefficients,
        }
    }

    /// The limit by vertical speed.
    #[must_use]
    pub fn by_speed(&self) -> f64 {
        self.by_speed
    }

    /// The limit at an altitude, rise over run: by angle and by vertical speed.
    #[must_use]
    pub fn at(&self, amsl: Amsl) -> f64 {
        self.by_shape(amsl).min(self.by_speed)
    }

    /// The limit by angle or polynomial alone, as the paper has it.
    #[must_use]
    pub fn by_shape(&self, amsl: Amsl) -> f64 {
        match self.shape {
            Shape::Angle(slope) => slope,
            Shape::Polynomial([square, linear, constant]) => {
                let z_m = amsl.0.clamp(0.0, POLYNOMIAL_TOP_M);
                ((square * z_m + linear) * z_m + constant).max(0.0)
            }
        }
    }

    /// No less than [`Self::by_shape`] at any altitude up to one, metres above mean sea level.
    #[must_use]
    pub fn max_by_shape(&self, up_to_amsl_m: f64) -> f64 {
        let [square, linear, _] = self.polynomial();
        // Where the polynomial is greatest, if it bends down.
        let max_m = if square < 0.0 {
            (-0.5 * linear / square).min(up_to_amsl_m)
        } else {
            0.0
        };
        let at = |amsl_m: f64| self.by_shape(Amsl(amsl_m));
        at(0.0).max(at(up_to_amsl_m)).max(at(max_m)) + 1e-12
    }

    /// No more than [`Self::by_shape`] at any altitude up to one, metres above mean sea level.
    #[must_use]
    pub fn min_by_shape(&self, up_to_amsl_m: f64) -> f64 {
        let [square, linear, _] = self.polynomial();
        // Where the polynomial is least, if it bends up.
        let min_m = if square > 0.0 {
            -0.5 * linear / square
        } else {
            0.0
        };
        let at = |amsl_m: f64| self.by_shape(Amsl(amsl_m));
        let least = at(0.0).min(at(up_to_amsl_m)).min(at(min_m));
        // Far more than rounding.
        (least - 1e-12).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::{CLIMB, DESCENT, Shape, SlopeLimit};
    use crate::geodesy::Amsl;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_altitude_up_to_one_has_a_limit_below_the_least(
            square in -1e-8..1e-8_f64, linear in -1e-4..1e-4_f64, constant in 0.0..1.0_f64,
            up_to_amsl_m in -500.0..20_000.0_f64, below_m in 0.0..20_000.0_f64,
        ) {
            let own = Shape::Polynomial([square, linear, constant]);
            for shape in [own, Shape::Polynomial(CLIMB), Shape::Polynomial(DESCENT), Shape::Angle(constant)] {
                let limit = SlopeLimit { shape, by_speed: 10.0 };
                let least = limit.min_by_shape(up_to_amsl_m);
                let most = limit.max_by_shape(up_to_amsl_m);
                prop_assert!(limit.by_shape(Amsl(up_to_amsl_m - below_m)) <= most);
                prop_assert!(limit.by_shape(Amsl(up_to_amsl_m)) >= least);
                prop_assert!(limit.by_shape(Amsl(up_to_amsl_m - below_m)) >= least);
            }
        }
    }

    #[test]
    fn the_polynomials_start_at_22_8_and_18_degrees_and_end_near_14_and_12_km() {
        let limit = |polynomial| SlopeLimit {
            shape: Shape::Polynomial(polynomial),
            by_speed: 10.0,
        };
        let degrees = |slope: f64| slope.atan().to_degrees();
        assert!((degrees(limit(CLIMB).at(Amsl(0.0))) - 22.8).abs() < 0.1);
        assert!((degrees(limit(DESCENT).at(Amsl(0.0))) - 18.0).abs() < 0.1);
        // Still positive at 12 km, where both are held.
        assert!(limit(CLIMB).at(Amsl(12_000.0)) > 0.07);
        assert!(limit(DESCENT).at(Amsl(12_000.0)) > 0.03);
        assert_eq!(
            limit(CLIMB).at(Amsl(20_000.0)).to_bits(),
            limit(CLIMB).at(Amsl(12_000.0)).to_bits()
        );
    }

    #[test]
    fn vertical_speed_limits_the_slope_too() {
        let limit = SlopeLimit {
            shape: Shape::Angle(0.5),
            by_speed: 0.2,
        };
        assert!((limit.at(Amsl(100.0)) - 0.2).abs() < 1e-15);
        assert!((limit.by_shape(Amsl(100.0)) - 0.5).abs() < 1e-15);
    }
}

//! The International Standard Atmosphere (ISO 2533) up to 11 km.

use super::Amsl;

/// How much faster a wing moves through the air than its indicated airspeed: the square root of
/// the density at sea level over that at an altitude, `(1 - 2.25577e-5 z)^-2.12794`.
#[must_use]
pub fn true_airspeed_ratio(at: Amsl) -> f64 {
    const TROPOPAUSE_M: f64 = 11_000.0;
    (1.0 - 2.255_77e-5 * at.0.min(TROPOPAUSE_M)).powf(-2.127_94)
}

#[cfg(test)]
mod tests {
    use super::true_airspeed_ratio;
    use crate::geodesy::Amsl;

    #[test]
    fn densities_are_those_of_the_tables_of_the_standard_atmosphere() {
        // ISO 2533, table 2: density, kg/m^3, at geopotential altitudes.
        for (amsl_m, density) in [
            (0.0, 1.225),
            (500.0, 1.1673),
            (1000.0, 1.1117),
            (3000.0, 0.909_12),
            (10_000.0, 0.412_71),
        ] {
            let ratio = true_airspeed_ratio(Amsl(amsl_m));
            let expected = (1.225_f64 / density).sqrt();
            assert!(
                (ratio / expected - 1.0).abs() < 3e-4,
                "{ratio} at {amsl_m} m, not {expected}"
            );
        }
    }
}

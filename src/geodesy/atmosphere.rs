//! The International Standard Atmosphere (ISO 2533) up to 11 km.

use super::Amsl;

/// How much faster a wing moves through the air than its indicated airspeed: the square root of
/// the density at sea level over that at an altitude, `(1 - 2.25577e-5 z)^-2.12794`.
#[must_use]
pub fn true_airspeed_ratio(at: Amsl) -> f64 {
    const TROPOPAUSE_M: f64 = 11_000.0;
    (1.0 - 2.255_77e-5 * at.0.min(TROPOPAUSE_M)).powf(-2.127_94)
}

/// The altitude of a flight level (hundreds of feet of pressure altitude) in the standard
/// atmosphere above a pressure at sea level, hectopascal: its altitude on a standard day less
/// the pressure altitude of the sea, `44 330.8 m (1 - (QNH / 1013.25)^0.190263)`.
#[must_use]
pub fn flight_level(level: f64, qnh_hpa: f64) -> Amsl {
    const FEET_M: f64 = 0.3048;
    let sea_m = 44_330.8 * (1.0 - (qnh_hpa / 1013.25).powf(0.190_263));
    Amsl(100.0 * FEET_M * level - sea_m)
}

#[cfg(test)]
mod tests {
    use super::{flight_level, true_airspeed_ratio};
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

    #[test]
    fn a_flight_level_moves_with_the_pressure_as_the_manual_of_the_standard_atmosphere_says() {
        // ICAO Doc 7488/3: pressures at geopotential altitudes of the standard atmosphere.
        for (qnh_hpa, altitude_m) in [(1013.25, 0.0), (954.61, 500.0), (898.74, 1000.0)] {
            let Amsl(amsl_m) = flight_level(100.0, qnh_hpa);
            assert!(
                (amsl_m - (3048.0 - altitude_m)).abs() < 0.5,
                "{amsl_m} at {qnh_hpa}"
            );
        }
    }
}

//! Units and references of heights.

use super::{Geometry, Height};
use crate::geodesy::Geoid;

/// A foot, metres.
pub(super) const FOOT_M: f64 = 0.3048;
/// A nautical mile, metres.
pub(super) const NAUTICAL_MILE_M: f64 = 1852.0;

/// Which limit a height is: one above the ellipsoid becomes the widest that it can be anywhere
/// over the shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Floor,
    Ceiling,
}

/// Metres of a value in a unit.
///
/// # Errors
/// A unit that is none of metres and feet.
pub(super) fn metres(value: f64, unit: &str) -> Result<f64, String> {
    match unit.to_lowercase().as_str() {
        "m" | "meter" | "meters" | "metre" | "metres" => Ok(value),
        "ft" | "f" | "feet" | "foot" => Ok(value * FOOT_M),
        _ => Err(format!("unknown unit `{}`", unit.escape_debug())),
    }
}

/// A height over a shape: a value in a unit, measured from a reference by its name.
///
/// # Errors
/// A unit or a reference that is unknown, and a flight level in metres or feet: whether its value is
/// a level or a length is open.
pub(super) fn height(
    (value, unit): (f64, &str),
    reference: &str,
    side: Side,
    over: &Geometry,
) -> Result<Height, String> {
    let is_level = reference.eq_ignore_ascii_case("FL");
    if unit.eq_ignore_ascii_case("FL") && value.is_finite() {
        return match is_level || reference.eq_ignore_ascii_case("STD") {
            true => Ok(Height::FlightLevel(value)),
            false => Err(format!(
                "a flight level measured from `{}`, not from STD",
                reference.escape_debug()
            )),
        };
    }
    let metres = metres(value, unit)?;
    if is_level {
        return Err(format!(
            "a flight level {value} in `{}`, not in FL",
            unit.escape_debug()
        ));
    }
    if !metres.is_finite() {
        return Err(format!("a height of {metres} m"));
    }
    match reference.to_uppercase().as_str() {
        "AMSL" | "MSL" => Ok(Height::Amsl(metres)),
        "AGL" | "GND" | "SFC" => Ok(Height::Agl(metres)),
        "WGS84" | "W84" | "HAE" => Ok(above_ellipsoid(metres, side, over)),
        "STD" => Ok(Height::FlightLevel(metres / FOOT_M / 100.0)),
        _ => Err(format!(
            "unknown reference `{}` of a height",
            reference.escape_debug()
        )),
    }
}

fn above_ellipsoid(metres: f64, side: Side, over: &Geometry) -> Height {
    let (south_west, north_east) = over.bounds();
    let [min_m, max_m] = Geoid::egm96().undulations_m(south_west, north_east);
    Height::Amsl(match side {
        Side::Floor => metres - max_m,
        Side::Ceiling => metres - min_m,
    })
}

/// A floor that is the ground is none.
pub(super) fn floor(of: Option<Height>) -> Option<Height> {
    of.filter(|height| !matches!(height, Height::Agl(metres) if *metres <= 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geodesy::LatLon;

    #[test]
    fn heights_keep_their_reference_and_the_ellipsoid_is_converted_by_the_geoid() {
        // ArduPilot's field at Canberra: EGM96 19.44 m above the ellipsoid.
        let at = LatLon {
            lat_deg: -35.363_262,
            lon_deg: 149.165_237,
        };
        let over = Geometry::Point(at);
        let of = |reference| height((603.44, "m"), reference, Side::Ceiling, &over);
        assert_eq!(of("AMSL"), Ok(Height::Amsl(603.44)));
        assert_eq!(of("agl"), Ok(Height::Agl(603.44)));
        let Ok(Height::Amsl(amsl_m)) = of("WGS84") else {
            panic!("{:?}", of("WGS84"));
        };
        assert!((amsl_m - 584.0).abs() < 0.05, "{amsl_m}");
        assert!(of("QFE").is_err());
    }

    #[test]
    fn a_flight_level_is_never_a_length() {
        let over = Geometry::Point(LatLon {
            lat_deg: 47.0,
            lon_deg: 8.0,
        });
        let of = |value, unit, reference| height((value, unit), reference, Side::Ceiling, &over);
        for unit in ["m", "FT"] {
            let why = format!("a flight level 55 in `{unit}`, not in FL");
            assert_eq!(of(55.0, unit, "fl"), Err(why));
        }
        assert_eq!(of(55.0, "FL", "FL"), Ok(Height::FlightLevel(55.0)));
        assert_eq!(of(55.0, "fl", "STD"), Ok(Height::FlightLevel(55.0)));
        assert_eq!(of(5500.0, "ft", "STD"), Ok(Height::FlightLevel(55.0)));
        assert!(of(55.0, "FL", "AGL").is_err());
    }

    #[test]
    fn units_are_metres_or_feet() {
        assert_eq!(metres(1000.0, "FT"), Ok(304.8));
        assert_eq!(metres(1000.0, "M"), Ok(1000.0));
        assert!(metres(1.0, "NM").is_err());
    }
}

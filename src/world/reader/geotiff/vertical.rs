//! Vertical coordinate systems of GeoTIFFs.

use std::ops::RangeInclusive;

use geotiff_reader::crs::VerticalCrs;

use super::super::TerrainError;

/// `VerticalUnitsGeoKey`: metre.
const METRE: u16 = 9001;

/// Codes of `VerticalGeoKey` whose heights are metres upwards: those of EPSG 12 (its
/// others are depths, or in feet), and 5101 to 5106 of GeoTIFF 1.0.
#[rustfmt::skip]
const METRES_UP: &[RangeInclusive<u16>] = &[
    3855..=3855, 3886..=3886, 3900..=3900, 4440..=4440, 4458..=4458, 5101..=5106, 5193..=5193,
    5195..=5195, 5214..=5214, 5237..=5237, 5317..=5317, 5597..=5597, 5600..=5611, 5613..=5613,
    5615..=5621, 5701..=5701, 5703..=5705, 5709..=5714, 5716..=5733, 5735..=5738, 5740..=5753,
    5755..=5788, 5790..=5799, 5829..=5829, 5843..=5843, 5868..=5872, 5874..=5874, 5941..=5941,
    6178..=6187, 6638..=6644, 6647..=6647, 6693..=6695, 6916..=6916, 7446..=7447, 7651..=7652,
    7699..=7700, 7707..=7707, 7832..=7832, 7837..=7837, 7839..=7839, 7841..=7841, 7888..=7890,
    7962..=7962, 7968..=7968, 7979..=7979, 8089..=8089, 8266..=8267, 8357..=8357, 8434..=8434,
    8675..=8675, 8690..=8691, 8841..=8841, 8881..=8881, 8904..=8904, 8911..=8911, 9130..=9130,
    9245..=9245, 9255..=9255, 9274..=9274, 9279..=9279, 9303..=9303, 9335..=9335, 9351..=9351,
    9389..=9390, 9392..=9402, 9451..=9451, 9458..=9458, 9471..=9471, 9650..=9651, 9663..=9663,
    9666..=9666, 9669..=9669, 9675..=9675, 9681..=9681, 9721..=9722, 9923..=9923, 9927..=9927,
    10190..=10190, 10352..=10354, 10482..=10485, 10565..=10565, 10588..=10588, 20000..=20000,
    20034..=20036,
];

/// Refuses feet, depths, and heights over the ellipsoid: `VerticalGeoKey` 5001 to 5033 of
/// GeoTIFF 1.0, 4979 (three-dimensional WGS84).
pub(super) fn check_heights(vertical: &VerticalCrs) -> Result<(), TerrainError> {
    if let Some(unit) = vertical.units.filter(|unit| *unit != METRE) {
        return Err(TerrainError::Heights(format!("unit EPSG:{unit}")));
    }
    match vertical.epsg {
        Some(code @ (5001..=5033 | 4979)) => Err(TerrainError::Heights(format!(
            "metres above an ellipsoid (EPSG:{code})"
        ))),
        None | Some(0 | 32767) => check_citation(vertical),
        Some(code) if METRES_UP.iter().any(|codes| codes.contains(&code)) => Ok(()),
        Some(code) => Err(TerrainError::Heights(format!(
            "EPSG:{code}, which is in feet, a depth, or unknown"
        ))),
    }
}

/// Refuses what a system without a code says of itself in words.
fn check_citation(vertical: &VerticalCrs) -> Result<(), TerrainError> {
    let citation = vertical.citation.as_deref().unwrap_or_default();
    let words = citation.to_ascii_lowercase();
    let mut words = words.split(|letter: char| !letter.is_ascii_alphabetic());
    let other = |word: &str| {
        matches!(word, "ft" | "ftus" | "usft" | "feet" | "foot" | "depth")
            || word.starts_with("ellipsoid")
    };
    match words.any(other) {
        true => Err(TerrainError::Heights(format!("`{citation}`"))),
        false => Ok(()),
    }
}

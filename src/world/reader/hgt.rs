//! SRTM tiles: big-endian `i16` metres above EGM96, row by row from the north;
//! nodes lie on the edges, which neighbouring tiles share; -32768 is a void.
//! The name gives the south-west corner (SRTM topography, `Quickstart.pdf`).

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use super::{Bounds, Lattice, TerrainError, ground_m};
use crate::geodesy::LatLon;
use crate::world::TerrainGrid;

/// What stands for no data. [`ground_m`] drops it with everything below the lowest land.
#[cfg(test)]
const VOID: i16 = -32768;

pub(super) fn read(path: &Path, bounds: Option<Bounds>) -> Result<TerrainGrid, TerrainError> {
    let name = path
        .file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default();
    let corner = corner(&name).ok_or(TerrainError::Name(name))?;
    let mut file = File::open(path)?;
    let bytes = file.metadata()?.len();
    let side: u16 = match bytes {
        2_884_802 => 1201,
        25_934_402 => 3601,
        _ => return Err(TerrainError::Size(bytes)),
    };
    let step_deg = 1.0 / f64::from(side - 1);
    let lattice = Lattice {
        north_west: LatLon {
            lat_deg: corner.lat_deg + 1.0,
            lon_deg: corner.lon_deg,
        },
        row_step_deg: step_deg,
        column_step_deg: step_deg,
        rows: usize::from(side),
        columns: usize::from(side),
    };
    let window = lattice.window(bounds)?;
    let mut heights_m = Vec::with_capacity(window.rows * window.columns);
    let mut row_bytes = vec![0; window.columns * 2];
    for row in window.first_row..window.first_row + window.rows {
        let offset = 2 * (row * lattice.columns + window.first_column) as u64;
        file.seek(SeekFrom::Start(offset))?;
        file.read_exact(&mut row_bytes)?;
        let samples = row_bytes
            .chunks_exact(2)
            .map(|pair| i16::from_be_bytes([pair[0], pair[1]]));
        heights_m.extend(samples.map(|sample| ground_m(f64::from(sample))));
    }
    Ok(lattice.grid(window, heights_m))
}

/// The south-west corner from a name such as `N36W085.hgt` or `s01e010.SRTMGL1.hgt`.
fn corner(name: &str) -> Option<LatLon> {
    let tile = name.split('.').next()?.to_ascii_uppercase();
    let tile = tile.as_bytes();
    let number = |digits: &[u8]| -> Option<f64> {
        if digits.iter().all(u8::is_ascii_digit) {
            std::str::from_utf8(digits).ok()?.parse().ok()
        } else {
            None
        }
    };
    let [north, lat @ .., east, _, _, _] = tile else {
        return None;
    };
    let (&[lat_1, lat_2], &[.., lon_1, lon_2, lon_3]) = (lat, tile) else {
        return None;
    };
    let sign = |letter: u8, plus: u8, minus: u8| match letter {
        letter if letter == plus => Some(1.0),
        letter if letter == minus => Some(-1.0),
        _ => None,
    };
    let lat_deg = sign(*north, b'N', b'S')? * number(&[lat_1, lat_2])?;
    let lon_deg = sign(*east, b'E', b'W')? * number(&[lon_1, lon_2, lon_3])?;
    let on_earth = (-90.0..=89.0).contains(&lat_deg) && (-180.0..=179.0).contains(&lon_deg);
    on_earth.then_some(LatLon { lat_deg, lon_deg })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_of_a_tile_gives_its_south_west_corner() {
        let at = |name: &str| corner(name).map(|corner| (corner.lat_deg, corner.lon_deg));
        assert_eq!(at("N36W085.hgt"), Some((36.0, -85.0)));
        assert_eq!(at("s01e010.SRTMGL1.hgt"), Some((-1.0, 10.0)));
        for name in [
            "N36W85.hgt",
            "X36W085.hgt",
            "N3aW085.hgt",
            "N91W085.hgt",
            "N36E180.hgt",
            ".hgt",
            "N36W0855.hgt",
            "N+6W085.hgt",
            "Ñ6W085.hgt",
        ] {
            assert_eq!(at(name), None, "{name}");
        }
    }

    #[test]
    fn a_void_is_no_ground() {
        assert!(ground_m(f64::from(VOID)).is_nan());
        assert_eq!(ground_m(0.0).to_bits(), 0.0_f32.to_bits());
    }
}

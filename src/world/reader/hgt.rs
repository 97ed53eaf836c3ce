//! SRTM tiles: big-endian `i16` metres above EGM96, row by row from the north;
//! nodes lie on the edges, which neighbouring tiles share; -32768 is a void.
//! The name gives the south-west corner (SRTM topography, `Quickstart.pdf`).
//!
//! Packed tiles are unpacked as a stream, a row at a time and never further than one
//! byte beyond the end of a tile, whatever they claim to hold.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use flate2::read::GzDecoder;
use zip::ZipArchive;

use super::{Lattice, TerrainError, Window, ground_m};
use crate::geodesy::LatLon;
use crate::numeric::text::open_regular;

/// What stands for no data. [`ground_m`] drops it with everything below the lowest land.
#[cfg(test)]
const VOID: i16 = -32768;

/// How a tile is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Packing {
    Plain,
    Gzip,
    /// The number of the file within the archive.
    Zip(usize),
}

/// A tile before its heights are read.
#[derive(Debug)]
pub(super) struct Hgt {
    path: PathBuf,
    pub(super) packing: Packing,
    pub(super) lattice: Lattice,
}

/// Whether a file is a tile by its name, in lower case.
pub(super) fn is_tile(name: &str) -> bool {
    [".hgt", ".hgt.gz", ".hgt.zip"]
        .iter()
        .any(|ending| name.ends_with(ending))
}

impl Hgt {
    pub(super) fn open(path: &Path) -> Result<Self, TerrainError> {
        let name = super::name_of(path);
        let corner = corner(&name).ok_or_else(|| TerrainError::Name(name.clone()))?;
        let mut file = open_regular(path)?;
        let ending = name.rsplit('.').next().unwrap_or_default();
        let (packing, bytes) = match ending.to_ascii_lowercase().as_str() {
            "gz" => (Packing::Gzip, unpacked_bytes(&mut file)?),
            "zip" => {
                let mut archive = ZipArchive::new(BufReader::new(file)).map_err(packed)?;
                let (entry, bytes) = tile_within(&mut archive, corner)?;
                (Packing::Zip(entry), bytes)
            }
            _ => (Packing::Plain, file.metadata()?.len()),
        };
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
        Ok(Self {
            path: path.to_owned(),
            packing,
            lattice,
        })
    }

    pub(super) fn read(&self, window: Window) -> Result<Vec<f32>, TerrainError> {
        let mut file = BufReader::new(File::open(&self.path)?);
        match self.packing {
            Packing::Plain => self.rows(file, window),
            Packing::Gzip => self.rows(GzDecoder::new(file), window),
            Packing::Zip(entry) => {
                file.rewind()?;
                let mut archive = ZipArchive::new(file).map_err(packed)?;
                self.rows(archive.by_index(entry).map_err(packed)?, window)
            }
        }
    }

    /// Reads to the very end, since only there a checksum is compared.
    fn rows(&self, mut reader: impl Read, window: Window) -> Result<Vec<f32>, TerrainError> {
        let rows = window.first_row..window.first_row + window.rows;
        let columns = 2 * window.first_column..2 * (window.first_column + window.columns);
        let mut heights_m = Vec::with_capacity(window.rows * window.columns);
        let mut bytes = vec![0; 2 * self.lattice.columns];
        for row in 0..self.lattice.rows {
            reader.read_exact(&mut bytes).map_err(packed)?;
            if rows.contains(&row) {
                let samples = bytes[columns.clone()]
                    .chunks_exact(2)
                    .map(|pair| i16::from_be_bytes([pair[0], pair[1]]));
                heights_m.extend(samples.map(|sample| ground_m(f64::from(sample))));
            }
        }
        match reader.read(&mut [0]).map_err(packed)? {
            0 => Ok(heights_m),
            _ => Err(packed("there is more in it than it says")),
        }
    }
}

fn packed(error: impl std::fmt::Display) -> TerrainError {
    TerrainError::Packed(error.to_string())
}

/// What a gzip file says to hold, in its last four bytes (RFC 1952 section 2.3.1).
fn unpacked_bytes(file: &mut File) -> Result<u64, TerrainError> {
    let mut size = [0; 4];
    file.seek(SeekFrom::End(-4)).map_err(packed)?;
    file.read_exact(&mut size).map_err(packed)?;
    Ok(u64::from(u32::from_le_bytes(size)))
}

/// The only tile of an archive and its size. Other files, such as a licence, may be in it too.
fn tile_within(
    archive: &mut ZipArchive<BufReader<File>>,
    place: LatLon,
) -> Result<(usize, u64), TerrainError> {
    let mut tiles = Vec::new();
    for index in 0..archive.len() {
        let entry = archive.by_index_raw(index).map_err(packed)?;
        let path = entry.name().map_err(packed)?;
        let name = path.rsplit(['/', '\\']).next().unwrap_or_default();
        if name.to_ascii_lowercase().ends_with(".hgt") {
            tiles.push((index, entry.size(), corner(name)));
        }
    }
    match tiles.as_slice() {
        [(index, bytes, corner)] if *corner == Some(place) => Ok((*index, *bytes)),
        [_] => Err(TerrainError::Archive("a tile of another name".to_owned())),
        _ => Err(TerrainError::Archive(format!("{} tiles", tiles.len()))),
    }
}

/// The south-west corner from a name such as `N36W085.hgt` or `s01e010.SRTMGL1.hgt`.
pub(super) fn corner(name: &str) -> Option<LatLon> {
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

//! Elevation files: SRTM `.hgt` and GeoTIFF, cut to the part a mission needs.

mod geotiff;
mod hgt;

use std::ops::RangeInclusive;
use std::path::Path;

use super::TerrainGrid;
use crate::geodesy::LatLon;
use crate::spec::Area;

/// Heights of ground that exist, metres above the sea: the shore of the Dead Sea
/// lies at -430, Everest at 8849. Anything else in a file is a filler or the sea
/// floor, and counts as no data.
const GROUND_M: RangeInclusive<f64> = -500.0..=9000.0;
/// Most nodes kept in memory (256 MiB).
const MAX_NODES: usize = 1 << 26;

/// Why an elevation file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum TerrainError {
    /// It cannot be opened or read.
    #[error("cannot be read: {0}")]
    Unreadable(#[from] std::io::Error),
    /// The ending says neither `.hgt` nor `.tif`.
    #[error("unknown kind of elevation file (allowed: .hgt, .tif, .tiff)")]
    UnknownKind,
    /// The name of an `.hgt` file gives its south-west corner.
    #[error("`{0}` does not name a corner (allowed: such as N36W085.hgt)")]
    Name(String),
    /// An `.hgt` file has 1201 or 3601 rows and columns of two bytes.
    #[error("{0} bytes (allowed: 2884802 for 1201 x 1201, 25934402 for 3601 x 3601)")]
    Size(u64),
    /// The decoder refuses the GeoTIFF.
    #[error("not a readable GeoTIFF: {0}")]
    Decode(String),
    /// The coordinates are not degrees of WGS84.
    #[error("coordinates in {0} (allowed: EPSG:4326, degrees of WGS84)")]
    Crs(String),
    /// The heights are not metres above the sea.
    #[error("heights in {0} (allowed: metres above mean sea level)")]
    Heights(String),
    /// Rows do not go south or columns do not go east in even steps.
    #[error("{0} (allowed: rows from north to south, columns from west to east)")]
    Layout(String),
    /// Samples of an unknown kind.
    #[error("samples of {0} (allowed: one band of 8 to 32 bit integers or 32 or 64 bit floats)")]
    Samples(String),
    /// The file is of another part of the earth.
    #[error(
        "covers latitude {south:.4} to {north:.4}, longitude {west:.4} to {east:.4}: nothing of the area"
    )]
    Elsewhere {
        /// Southernmost latitude, degrees.
        south: f64,
        /// Northernmost latitude, degrees.
        north: f64,
        /// Westernmost longitude, degrees.
        west: f64,
        /// Easternmost longitude, degrees.
        east: f64,
    },
    /// The area has too many nodes.
    #[error("{0} nodes within the area (allowed: {MAX_NODES})")]
    TooLarge(usize),
}

/// The part of the earth that is wanted, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// South-west corner.
    pub south_west: LatLon,
    /// North-east corner.
    pub north_east: LatLon,
}

impl Bounds {
    /// An area and 5 km and a twentieth of it around, so that the rectangle around
    /// it in planning coordinates has its ground too.
    #[must_use]
    pub fn around(area: &Area) -> Self {
        let (south_west, north_east) = (area.south_west, area.north_east);
        let margin_deg = |span_deg: f64| 0.05 * span_deg + 0.05;
        let lat_deg = margin_deg(north_east.lat_deg - south_west.lat_deg);
        let steepest = south_west.lat_deg.abs().max(north_east.lat_deg.abs());
        let parallel = steepest.to_radians().cos().max(0.05);
        let lon_deg = margin_deg(north_east.lon_deg - south_west.lon_deg) / parallel;
        Self {
            south_west: LatLon {
                lat_deg: south_west.lat_deg - lat_deg,
                lon_deg: south_west.lon_deg - lon_deg,
            },
            north_east: LatLon {
                lat_deg: north_east.lat_deg + lat_deg,
                lon_deg: north_east.lon_deg + lon_deg,
            },
        }
    }
}

/// Reads what an elevation file holds within `bounds`; all of it without.
///
/// # Errors
/// [`TerrainError`], which says what is wrong and what is allowed.
pub fn read_terrain(path: &Path, bounds: Option<Bounds>) -> Result<TerrainGrid, TerrainError> {
    let ending = path.extension().and_then(|ending| ending.to_str());
    match ending.map(str::to_ascii_lowercase).as_deref() {
        Some("hgt") => hgt::read(path, bounds),
        Some("tif" | "tiff") => geotiff::read(path, bounds),
        _ => Err(TerrainError::UnknownKind),
    }
}

/// The nodes of a file: where they are, before any height is read.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Lattice {
    north_west: LatLon,
    row_step_deg: f64,
    column_step_deg: f64,
    rows: usize,
    columns: usize,
}

/// A part of a [`Lattice`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Window {
    first_row: usize,
    rows: usize,
    first_column: usize,
    columns: usize,
}

impl Lattice {
    /// The nodes within `bounds` and the next one outside on each side.
    fn window(&self, bounds: Option<Bounds>) -> Result<Window, TerrainError> {
        let (mut rows, mut columns) = ((0, self.rows), (0, self.columns));
        if let Some(Bounds {
            south_west,
            north_east,
        }) = bounds
        {
            let row = |lat_deg: f64| (self.north_west.lat_deg - lat_deg) / self.row_step_deg;
            let column = |lon_deg: f64| (lon_deg - self.north_west.lon_deg) / self.column_step_deg;
            let elsewhere = || self.elsewhere();
            rows = cut(row(north_east.lat_deg), row(south_west.lat_deg), self.rows)
                .ok_or_else(elsewhere)?;
            columns = cut(
                column(south_west.lon_deg),
                column(north_east.lon_deg),
                self.columns,
            )
            .ok_or_else(elsewhere)?;
        }
        let window = Window {
            first_row: rows.0,
            rows: rows.1 - rows.0,
            first_column: columns.0,
            columns: columns.1 - columns.0,
        };
        match window.rows.saturating_mul(window.columns) {
            nodes if nodes > MAX_NODES => Err(TerrainError::TooLarge(nodes)),
            _ => Ok(window),
        }
    }

    fn elsewhere(&self) -> TerrainError {
        let LatLon { lat_deg, lon_deg } = self.node(self.rows - 1, self.columns - 1);
        TerrainError::Elsewhere {
            south: lat_deg,
            north: self.north_west.lat_deg,
            west: self.north_west.lon_deg,
            east: lon_deg,
        }
    }

    #[expect(
        clippy::cast_precision_loss,
        reason = "grids have far fewer than 2^52 rows"
    )]
    fn node(&self, row: usize, column: usize) -> LatLon {
        LatLon {
            lat_deg: self.north_west.lat_deg - row as f64 * self.row_step_deg,
            lon_deg: self.north_west.lon_deg + column as f64 * self.column_step_deg,
        }
    }

    /// The grid of a window of which the heights were read, row by row.
    fn grid(&self, window: Window, heights_m: Vec<f32>) -> TerrainGrid {
        TerrainGrid {
            north_west: self.node(window.first_row, window.first_column),
            row_step_deg: self.row_step_deg,
            column_step_deg: self.column_step_deg,
            rows: window.rows,
            columns: window.columns,
            heights_m,
        }
    }
}

/// First and one past the last of `nodes` around `from..to`; `None` if there are not two.
fn cut(from: f64, to: f64, nodes: usize) -> Option<(usize, usize)> {
    let last = f64::from(u32::try_from(nodes.checked_sub(1)?).ok()?);
    if from > last || to < 0.0 || nodes < 2 {
        return None;
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped"
    )]
    let (from, to) = (
        from.floor().clamp(0.0, last) as usize,
        to.ceil().clamp(0.0, last) as usize,
    );
    let from = from.min(nodes - 2);
    Some((from, to.max(from + 1) + 1))
}

/// A height as the grid keeps it: NaN for what is no ground.
fn ground_m(height_m: f64) -> f32 {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "heights need no more than f32"
    )]
    let kept = if GROUND_M.contains(&height_m) {
        height_m as f32
    } else {
        f32::NAN
    };
    kept
}

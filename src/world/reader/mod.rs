//! Elevation files: SRTM tiles, GeoTIFF, ASCII grids and Terrarium tiles, one or a folder of them, cut to the part a
//! mission needs. Only that part is ever in memory.

mod ascii;
mod blend;
mod geotiff;
mod hgt;
mod info;
mod lattice;
mod mosaic;
mod plane;
mod prj;
mod remedy;
mod terrarium;

pub use info::{TerrainInfo, inspect};

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use ascii::AsciiGrid;
use blend::Nodes;
use geotiff::GeoTiff;
use hgt::{Hgt, Packing};
use lattice::{Lattice, Window};
use mosaic::Mosaic;
use terrarium::Terrarium;

use super::TerrainGrid;
use crate::geodesy::{LatLon, Projection};
use crate::spec::{Area, ELEVATION_ENDINGS};

/// Heights of ground that exist, metres above the sea: the shore of the Dead Sea
/// lies at -430, Everest at 8849. Anything else in a file is a filler or the sea
/// floor, and counts as no data.
const GROUND_M: RangeInclusive<f64> = -500.0..=9000.0;
/// Most nodes in memory (256 MiB).
const MAX_NODES: usize = 1 << 26;

/// By how much heights may be wrong whose zero no file states, metres.
const UNSTATED_M: f64 = 2.0;

/// Why an elevation file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum TerrainError {
    /// It cannot be opened or read.
    #[error("cannot be read: {0}")]
    Unreadable(#[from] std::io::Error),
    /// The ending is of no elevation file.
    #[error("unknown kind of elevation file (allowed: {})", ELEVATION_ENDINGS.join(", "))]
    UnknownKind,
    /// A packed tile is damaged, or not what it says.
    #[error("cannot be unpacked: {0}")]
    Packed(String),
    /// An archive does not hold the one tile that its name promises.
    #[error("holds {0} (allowed: one .hgt named as the archive is)")]
    Archive(String),
    /// One file of a folder cannot be used.
    #[error("{name}: {error}")]
    InFile {
        /// Its name.
        name: String,
        /// Why not.
        error: Box<TerrainError>,
    },
    /// Two files of a folder hold the same nodes.
    #[error("{first} and {second} hold the same tile (allowed: one of them)")]
    Twice {
        /// Name of the first.
        first: String,
        /// Name of the second.
        second: String,
    },
    /// Two files of a folder do not fit together.
    #[error(
        "{first} and {second} have different rows or columns (allowed: one spacing in a folder)"
    )]
    Mixed {
        /// Name of the first.
        first: String,
        /// Name of the second.
        second: String,
    },
    /// No file of a folder is of the right part of the earth.
    #[error("none of the {0} elevation files in it holds anything of the area")]
    NoneHere(usize),
    /// The name of an `.hgt` file gives its south-west corner.
    #[error("`{0}` does not name a corner (allowed: such as N36W085.hgt)")]
    Name(String),
    /// An `.hgt` file has 1201 or 3601 rows and columns of two bytes.
    #[error("{0} bytes (allowed: 2884802 for 1201 x 1201, 25934402 for 3601 x 3601)")]
    Size(u64),
    /// A file that a command of GDAL or PDAL turns into one that can be used.
    #[error("{error}; {command}")]
    Convertible {
        /// Why it cannot be used.
        error: Box<TerrainError>,
        /// The command with what it does.
        command: String,
    },
    /// An ASCII grid is damaged.
    #[error("not a readable ASCII grid: {0}")]
    Ascii(String),
    /// An ASCII grid has no coordinate system.
    #[error(
        "no {0} next to it, so that its coordinates have no system (allowed: well-known text in it, or the one line \
         EPSG:4326 for degrees of WGS84, or the code of another system, such as EPSG:2056)"
    )]
    NoPrj(String),
    /// A PNG holds no heights.
    #[error("not a readable Terrarium tile: {0}")]
    Png(String),
    /// The path of a PNG does not say where it lies.
    #[error(
        "`{0}` does not say where it lies (allowed: a Terrarium tile by zoom, column and row, such as \
         12/2145/1434.png or 12_2145_1434.png)"
    )]
    Unplaced(String),
    /// The decoder refuses the GeoTIFF.
    #[error("not a readable GeoTIFF: {0}")]
    Decode(String),
    /// The coordinates are not degrees of WGS84.
    #[error(
        "coordinates in {0} (allowed: EPSG:4326, or an EPSG code with a way to WGS84 that needs no grid of shifts)"
    )]
    Crs(String),
    /// The heights are not metres above the sea.
    #[error("heights in {0} (allowed: metres above mean sea level)")]
    Heights(String),
    /// A tag or a file next to it changes what its samples mean.
    #[error("{0} (allowed: heights in metres, with at most a scale and an offset that GDAL wrote)")]
    Meaning(String),
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
    ReturnTargets {
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

impl TerrainError {
    /// What is wrong with the only file, without its name.
    fn of_file(self) -> Self {
        match self {
            Self::InFile { error, .. } => *error,
            error => error,
        }
    }
}

/// The part of the earth to read, degrees.
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

/// Reads what an elevation file, or a folder of them, holds within `bounds`; all of it without.
///
/// In a folder neighbours meet at the nodes that both have, or at nodes next to each other. Nodes
/// that no file has are without data. Files in a projection, and folders of several spacings, become
/// one grid that is no lower than any of their nodes; [`TerrainGrid::raised_m`] bounds the rest.
///
/// # Errors
/// [`TerrainError`], which says what is wrong and what is allowed.
pub fn read_terrain(path: &Path, bounds: Option<Bounds>) -> Result<TerrainGrid, TerrainError> {
    let grid = match path.is_dir() {
        true => read_folder(path, bounds),
        false => read_file(path, bounds),
    };
    grid.map_err(|error| remedy::with_command(path, error))
}

fn read_folder(path: &Path, bounds: Option<Bounds>) -> Result<TerrainGrid, TerrainError> {
    match Mosaic::open(path, bounds) {
        Err(TerrainError::Mixed { .. }) => blend::read(blend::open_folder(path, bounds)?, bounds),
        Err(TerrainError::NoneHere(0)) => {
            let tiles = Terrarium::open_folder(path, bounds)?;
            let tiles = tiles.ok_or(TerrainError::NoneHere(0))?;
            blend::read(vec![(name_of(path), Source::Terrarium(tiles))], bounds)
        }
        mosaic => mosaic?.read(bounds),
    }
}

fn read_file(path: &Path, bounds: Option<Bounds>) -> Result<TerrainGrid, TerrainError> {
    let source = Source::open(path)?;
    let Some(lattice) = source.lattice() else {
        let grid = blend::read(vec![(name_of(path), source)], bounds);
        return grid.map_err(TerrainError::of_file);
    };
    let window = lattice.window(bounds)?;
    Ok(lattice.grid(window, source.read(window)?))
}

/// The files that [`read_terrain`] would read, in the order of their names.
///
/// # Errors
/// A folder that cannot be used.
pub fn terrain_files(path: &Path, bounds: Option<Bounds>) -> Result<Vec<PathBuf>, TerrainError> {
    if !path.is_dir() {
        return Ok(with_systems(vec![path.to_owned()]));
    }
    let mosaic = match Mosaic::open(path, bounds) {
        Err(TerrainError::Mixed { .. }) => {
            let files = blend::open_folder(path, bounds)?.into_iter();
            return Ok(with_systems(
                files.map(|(name, _)| path.join(name)).collect(),
            ));
        }
        Err(TerrainError::NoneHere(0)) => {
            let tiles = Terrarium::open_folder(path, bounds)?;
            let tiles = tiles.ok_or(TerrainError::NoneHere(0))?;
            return Ok(tiles.paths().map(Path::to_owned).collect());
        }
        mosaic => mosaic?,
    };
    Ok(with_systems(
        mosaic.names().map(|name| path.join(name)).collect(),
    ))
}

/// Adds the `.prj` of each ASCII grid.
fn with_systems(files: Vec<PathBuf>) -> Vec<PathBuf> {
    let files = files.into_iter().flat_map(|path| {
        let system = prj_path(&path).filter(|path| path.exists());
        [Some(path), system]
    });
    files.flatten().collect()
}

/// The `.prj` of an ASCII grid, which names its coordinate system.
#[must_use]
pub fn prj_path(grid: &Path) -> Option<PathBuf> {
    is_ascii(&name_of(grid)).then(|| prj::path_of(grid))
}

fn is_ascii(name: &str) -> bool {
    name.to_ascii_lowercase().ends_with(".asc")
}

/// Whether a file holds elevation by its name.
#[must_use]
pub fn is_elevation(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    let mut endings = ELEVATION_ENDINGS.iter();
    endings.any(|ending| name.ends_with(ending))
}

/// The elevation files within a folder, in the order of their names.
///
/// # Errors
/// A folder that cannot be read.
pub fn elevation_files(folder: &Path) -> Result<Vec<PathBuf>, TerrainError> {
    let names = mosaic::names(folder)?;
    if names.is_empty() {
        return terrarium::paths(folder);
    }
    Ok(names.into_iter().map(|name| folder.join(name)).collect())
}

fn name_of(path: &Path) -> String {
    path.file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default()
}

/// One elevation file before its heights are read.
enum Source {
    Hgt(Hgt),
    GeoTiff(Box<GeoTiff>),
    Ascii(Box<AsciiGrid>),
    Terrarium(Terrarium),
}

impl Source {
    fn open(path: &Path) -> Result<Self, TerrainError> {
        let name = name_of(path);
        if hgt::is_tile(&name.to_ascii_lowercase()) {
            Hgt::open(path).map(Self::Hgt)
        } else if is_ascii(&name) {
            AsciiGrid::open(path).map(|file| Self::Ascii(Box::new(file)))
        } else if name.to_ascii_lowercase().ends_with(".png") {
            Terrarium::open(path).map(Self::Terrarium)
        } else if is_elevation(&name) {
            GeoTiff::open(path).map(|file| Self::GeoTiff(Box::new(file)))
        } else {
            Err(TerrainError::UnknownKind)
        }
    }

    /// Its nodes, if they lie on parallels and meridians of WGS84.
    fn lattice(&self) -> Option<Lattice> {
        match self.nodes() {
            Nodes::Degrees(lattice) => Some(lattice),
            Nodes::Plane(_) => None,
        }
    }

    fn nodes(&self) -> Nodes {
        match self {
            Self::Hgt(file) => Nodes::Degrees(file.lattice),
            Self::GeoTiff(file) => file.nodes.clone(),
            Self::Ascii(file) => file.nodes.clone(),
            Self::Terrarium(tiles) => tiles.nodes.clone(),
        }
    }

    /// By how much heights may be wrong for what they are measured from, metres.
    fn datum_error_m(&self) -> f64 {
        match self {
            Self::Hgt(_) => 0.0,
            Self::GeoTiff(file) => file.datum_error_m(),
            Self::Ascii(file) => match file.nodes {
                Nodes::Degrees(_) => 0.0,
                Nodes::Plane(_) => UNSTATED_M,
            },
            Self::Terrarium(_) => UNSTATED_M,
        }
    }

    fn read(&self, window: Window) -> Result<Vec<f32>, TerrainError> {
        match self {
            Self::Hgt(file) => file.read(window),
            Self::GeoTiff(file) => file.read(window),
            Self::Ascii(file) => file.read(window),
            Self::Terrarium(tiles) => tiles.read(window),
        }
    }

    fn format(&self) -> &'static str {
        match self {
            Self::Hgt(file) => match file.packing {
                Packing::Plain => "SRTM tile",
                Packing::Gzip => "SRTM tile, gzip",
                Packing::Zip(_) => "SRTM tile, zip",
            },
            Self::GeoTiff(_) => "GeoTIFF",
            Self::Ascii(_) => "ESRI ASCII grid",
            Self::Terrarium(_) => "Terrarium tile",
        }
    }

    fn datum(&self) -> String {
        match self {
            Self::Hgt(_) => "WGS84, metres above EGM96, as every SRTM tile".to_owned(),
            Self::GeoTiff(file) => file.datum(),
            Self::Ascii(file) => file.datum(),
            Self::Terrarium(_) => {
                "EPSG:3857, metres taken for above mean sea level, as every Terrarium tile"
                    .to_owned()
            }
        }
    }
}

/// Refuses a system of EPSG whose heights are above its ellipsoid.
fn above_the_sea(code: u16) -> Result<(), TerrainError> {
    match Projection::has_ellipsoidal_heights(code) {
        true => Err(TerrainError::Heights(format!(
            "metres above an ellipsoid (EPSG:{code})"
        ))),
        false => Ok(()),
    }
}

/// A height as the grid keeps it: NaN for what is no ground.
fn ground_m(height_m: f64) -> f32 {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "heights need no more than f32"
    )]
    let ground = if GROUND_M.contains(&height_m) {
        height_m as f32
    } else {
        f32::NAN
    };
    ground
}

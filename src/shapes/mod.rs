//! Shapes from files: bytes of GeoJSON, ED-318, ED-269, KML and KMZ, OpenAir and fences become
//! polygons, circles, lines and points with floors, ceilings and times.
//!
//! Units and references are converted, or the shape is refused by name: a [`Height`] says what
//! it is measured from. A height that a file leaves out is none, so the shape reaches from the
//! ground or without end. Where a file is less exact than a shape can be, the shape is larger:
//! a weekly schedule counts as always, several periods as one.

mod crs;
mod ed269;
mod fence;
mod geojson;
mod heights;
mod kml;
mod openair;
mod periods;
mod wkt;
mod write;

#[cfg(test)]
mod tests;

pub use wkt::{geojson_of_wkt, is_wkt};
pub use write::{Format, Rewritten, write, write_as};

use jiff::Timestamp;

use crate::geodesy::{LatLon, LocalFrame};
use crate::numeric::text::shell_word;

/// One shape of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// Its identifier or name in the file, else its place there, such as `feature 3`.
    pub name: String,
    /// Classes and types, as the file writes them: `C`, `CTR`, `PROHIBITED`.
    pub classes: Vec<String>,
    /// Outline.
    pub geometry: Geometry,
    /// From where it reaches up; absent: from the ground.
    pub floor: Option<Height>,
    /// To where it reaches; absent: without end.
    pub ceiling: Option<Height>,
    /// From and to when it is active; absent: without end.
    pub active: (Option<Timestamp>, Option<Timestamp>),
    /// Whether one should stay inside instead of outside: an inclusion fence.
    pub keep_in: bool,
    /// Its properties that are numbers, such as the height of a mast.
    pub numbers: Vec<(String, f64)>,
    /// Its properties that are lists of numbers, such as the heights of the masts of a line.
    pub lists: Vec<(String, Vec<f64>)>,
}

/// The outline of a shape. Edges are straight in latitude and longitude.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// At least three corners, the last not the first, and holes in the same form.
    Polygon {
        /// Outer boundary.
        outer: Vec<LatLon>,
        /// Parts that do not belong to it.
        holes: Vec<Vec<LatLon>>,
    },
    /// A circle.
    Circle {
        /// Centre.
        center: LatLon,
        /// Radius, metres.
        radius_m: f64,
    },
    /// At least two positions in a row.
    Line(Vec<LatLon>),
    /// One place.
    Point(LatLon),
}

/// A height with what it is measured from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Height {
    /// Metres above mean sea level.
    Amsl(f64),
    /// Metres above the ground at the same place.
    Agl(f64),
    /// Hundreds of feet of pressure altitude.
    FlightLevel(f64),
}

/// A shape that was not read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    /// Its name, as [`Shape::name`].
    pub name: String,
    /// Why.
    pub why: String,
}

/// What a file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Collection {
    /// Shapes that were read, in file order.
    pub shapes: Vec<Shape>,
    /// Shapes that were not.
    pub refused: Vec<Refused>,
    /// Shapes that forbid nothing: `NO_RESTRICTION`, and class G without a type.
    pub unrestricted: usize,
    /// Shapes that were read without the heights of their corners.
    pub without_heights: usize,
}

/// A file that holds no shapes that can be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ShapesError {
    /// The ending of the name is none of [`ENDINGS`].
    #[error("`{0}` is no file of shapes: allowed are {list}", list = ENDINGS.join(", "))]
    Ending(String),
    /// The coordinates are in a system that does not lead to WGS84.
    #[error(
        "coordinates in {0} (allowed: WGS84, or an EPSG code with a way to it that needs no grid of shifts)"
    )]
    Crs(String),
    /// A file that a command turns into one that can be read.
    #[error("{error}; `{command}` converts it")]
    Convertible {
        /// Why it cannot be read.
        error: Box<ShapesError>,
        /// The command.
        command: String,
    },
    /// The bytes are not what the name says.
    #[error("not a {format} file: {why}")]
    Malformed {
        /// Format that was expected.
        format: &'static str,
        /// What is wrong with it.
        why: String,
    },
}

/// How the names of files of shapes end.
pub const ENDINGS: [&str; 8] = [
    ".geojson",
    ".json",
    ".kml",
    ".kmz",
    ".txt",
    ".openair",
    ".plan",
    ".waypoints",
];

/// Reads a file by the ending of its name. `.json` is ED-269 or GeoJSON (ED-318 is that), `.txt`
/// is OpenAir.
///
/// # Errors
/// A file of another kind, or one whose format is broken; single shapes are
/// [`Collection::refused`].
pub fn read(name: &str, bytes: &[u8]) -> Result<Collection, ShapesError> {
    let lowercase = name.to_lowercase();
    let ends = |ending: &str| lowercase.ends_with(ending);
    if ends(".kmz") {
        kml::read_zipped(bytes)
    } else if ends(".kml") {
        kml::read(&text("KML", bytes)?)
    } else if ends(".txt") || ends(".openair") {
        openair::read(bytes)
    } else if ends(".plan") {
        fence::read_plan(&text("plan", bytes)?)
    } else if ends(".waypoints") {
        fence::read_rows(&text("waypoints", bytes)?)
    } else if ends(".geojson") || ends(".json") {
        let text = text("JSON", bytes)?;
        match ed269::read(&text)? {
            Some(collection) => Ok(collection),
            None => geojson::read(&text).map_err(|error| with_command(name, error)),
        }
    } else {
        Err(ShapesError::Ending(name.to_owned()))
    }
}

/// The error with the command that helps, if one does.
fn with_command(name: &str, error: ShapesError) -> ShapesError {
    if !matches!(error, ShapesError::Crs(_)) {
        return error;
    }
    let new = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let (old, new) = (shell_word(name), shell_word(&format!("{new}.new.geojson")));
    ShapesError::Convertible {
        error: Box::new(error),
        command: format!("ogr2ogr -f GeoJSON -lco RFC7946=YES -t_srs EPSG:4326 {new} {old}"),
    }
}

fn text(format: &'static str, bytes: &[u8]) -> Result<String, ShapesError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    String::from_utf8(bytes.to_vec()).map_err(|error| malformed(format, error))
}

fn malformed(format: &'static str, why: impl ToString) -> ShapesError {
    ShapesError::Malformed {
        format,
        why: why.to_string(),
    }
}

/// A ring without a last corner that repeats the first; why it is none otherwise.
fn ring(mut corners: Vec<LatLon>) -> Result<Vec<LatLon>, String> {
    corners.dedup();
    if corners.len() > 1 && corners.first() == corners.last() {
        corners.pop();
    }
    match corners.len() {
        0..3 => Err(format!("a ring of {} corners", corners.len())),
        _ => Ok(corners),
    }
}

/// A place of degrees; why it is none otherwise.
fn place(lat_deg: f64, lon_deg: f64) -> Result<LatLon, String> {
    LatLon::new(lat_deg, lon_deg).map_err(|error| error.to_string())
}

/// A circle no wider than a quarter of the earth.
fn circle(center: LatLon, radius_m: f64) -> Result<Geometry, String> {
    /// From the equator to a pole, metres.
    const MAX_RADIUS_M: f64 = 10_002_000.0;
    match radius_m > 0.0 && radius_m <= MAX_RADIUS_M {
        true => Ok(Geometry::Circle { center, radius_m }),
        false => Err(format!(
            "a radius of {radius_m} m (allowed: up to {MAX_RADIUS_M} m)"
        )),
    }
}

impl Geometry {
    /// Its corners, its ends, or its centre.
    #[must_use]
    pub fn positions(&self) -> Vec<LatLon> {
        match self {
            Self::Polygon { outer, .. } => outer.clone(),
            Self::Circle { center, .. } => vec![*center],
            Self::Line(line) => line.clone(),
            Self::Point(place) => vec![*place],
        }
    }

    /// The south-western and north-eastern corner of a box around it; the eastern longitude may be above 180 degrees.
    fn bounds(&self) -> (LatLon, LatLon) {
        let positions = match self {
            Self::Circle { center, radius_m } => LocalFrame::new(*center).circumscribed(*radius_m),
            _ => self.positions(),
        };
        // The short way around from the first.
        let first_deg = positions.first().map_or(0.0, |at| at.lon_deg);
        let lon =
            |at: &LatLon| first_deg + (at.lon_deg - first_deg + 180.0).rem_euclid(360.0) - 180.0;
        let range = |values: &mut dyn Iterator<Item = f64>| {
            values.fold(
                [f64::INFINITY, f64::NEG_INFINITY],
                |[least, most], value| [least.min(value), most.max(value)],
            )
        };
        let [west, east] = range(&mut positions.iter().map(lon));
        let [south, north] = range(&mut positions.iter().map(|at| at.lat_deg));
        let corner = |lat_deg, lon_deg| LatLon { lat_deg, lon_deg };
        (corner(south, west), corner(north, east))
    }
}

//! GeoTIFF in degrees of WGS84.

mod meaning;
mod vertical;

use std::path::Path;

use geotiff_reader::GeoTiffFile;
use geotiff_reader::crs::{CrsInfo, ModelType};
use geotiff_reader::geokeys;

use meaning::SampleMeaning;
use vertical::check_heights;

use super::{Lattice, TerrainError, Window, ground_m};
use crate::geodesy::LatLon;
use crate::numeric::text::open_regular;

const EPSG_WGS84: u16 = 4326;
/// `GeogAngularUnitsGeoKey`: degree.
const DEGREE: u16 = 9102;
/// Least nodes in each direction.
const MIN_NODES: u32 = 2;

/// A GeoTIFF before its heights are read.
pub(super) struct GeoTiff {
    file: GeoTiffFile,
    pub(super) lattice: Lattice,
    no_data: Option<f64>,
    meaning: SampleMeaning,
}

impl GeoTiff {
    pub(super) fn open(path: &Path) -> Result<Self, TerrainError> {
        // The reader's own message for a missing file names it twice.
        open_regular(path)?;
        let file =
            GeoTiffFile::open(path).map_err(|error| TerrainError::Decode(error.to_string()))?;
        check_coordinates(&file)?;
        if let Some(vertical) = file.crs().vertical() {
            check_heights(vertical)?;
        }
        let no_data = match file.nodata() {
            None => None,
            Some(text) => {
                let text = text.trim_matches(['\0', ' ']);
                let value = text.parse::<f64>();
                Some(value.map_err(|_| TerrainError::Decode(format!("no-data value `{text}`")))?)
            }
        };
        Ok(Self {
            lattice: lattice(&file)?,
            meaning: SampleMeaning::read(&file, path)?,
            file,
            no_data,
        })
    }

    pub(super) fn read(&self, window: Window) -> Result<Vec<f32>, TerrainError> {
        // A no-data value is stored exactly as the samples are.
        samples(&self.file, window, |sample| {
            match self.no_data.filter(|no_data| is_same(sample, *no_data)) {
                Some(_) => f32::NAN,
                None => ground_m(self.meaning.height_m(sample)),
            }
        })
    }

    /// What the heights are measured from, as far as the file says it.
    pub(super) fn datum(&self) -> String {
        let vertical = self.file.crs().vertical();
        let citation = vertical.and_then(|vertical| vertical.citation.clone());
        match (vertical.and_then(|vertical| vertical.epsg), citation) {
            (Some(5773), _) => "WGS84, metres above EGM96 (EPSG:5773)".to_owned(),
            (Some(3855), _) => {
                "WGS84, metres above EGM2008 (EPSG:3855), mostly within 1 m of EGM96".to_owned()
            }
            (Some(code), _) if code != 0 && code != 32767 => {
                format!("WGS84, metres above EPSG:{code}, taken for mean sea level")
            }
            (_, Some(citation)) => {
                format!("WGS84, metres above `{citation}`, taken for mean sea level")
            }
            _ => "WGS84, metres taken for above mean sea level: the file does not say".to_owned(),
        }
    }
}

/// Equal within the precision of `f32` samples.
fn is_same(sample: f64, no_data: f64) -> bool {
    (sample - no_data).abs() <= no_data.abs() * 1e-6
}

fn check_coordinates(file: &GeoTiffFile) -> Result<(), TerrainError> {
    let crs: &CrsInfo = file.crs();
    let name = |code: Option<u16>, citation: Option<&String>| match (code, citation) {
        (Some(code), _) if code != 32767 && code != 0 => format!("EPSG:{code}"),
        (_, Some(citation)) => citation.clone(),
        _ => "no EPSG code".to_owned(),
    };
    let Some(horizontal) = crs.horizontal() else {
        return Err(TerrainError::Crs("no coordinate system at all".to_owned()));
    };
    match crs.model_type_enum() {
        ModelType::Geographic => {}
        ModelType::Projected => {
            let name = name(
                horizontal.projected_epsg,
                horizontal.projection_citation.as_ref(),
            );
            return Err(TerrainError::Crs(format!("projection {name}")));
        }
        ModelType::Geocentric => return Err(TerrainError::Crs("a geocentric system".to_owned())),
        ModelType::Unknown(code) => return Err(TerrainError::Crs(format!("model type {code}"))),
    }
    if horizontal.geodetic_epsg != Some(EPSG_WGS84) {
        return Err(TerrainError::Crs(name(
            horizontal.geodetic_epsg,
            horizontal.geodetic_citation.as_ref(),
        )));
    }
    match file.geokeys().get_short(geokeys::GEOG_ANGULAR_UNITS) {
        None | Some(DEGREE) => Ok(()),
        Some(unit) => Err(TerrainError::Crs(format!("angular unit EPSG:{unit}"))),
    }
}

/// Where the nodes are: pixel centres, whether pixels are areas or points (the
/// reader's transform is of pixel corners in both cases).
fn lattice(file: &GeoTiffFile) -> Result<Lattice, TerrainError> {
    let transform = file
        .transform()
        .ok_or_else(|| TerrainError::Layout("no place and scale of its pixels".to_owned()))?;
    if transform.skew_x.abs() > 0.0 || transform.skew_y.abs() > 0.0 {
        return Err(TerrainError::Layout("rotated".to_owned()));
    }
    let (column_step_deg, row_step_deg) = (transform.pixel_width, -transform.pixel_height);
    let positive = |step: f64| step.is_finite() && step > 0.0;
    if !positive(column_step_deg) || !positive(row_step_deg) {
        return Err(TerrainError::Layout("mirrored".to_owned()));
    }
    if file.width() < MIN_NODES || file.height() < MIN_NODES {
        return Err(TerrainError::Layout(format!(
            "{} x {} pixels",
            file.width(),
            file.height()
        )));
    }
    let (mut lon_deg, lat_deg) = transform.pixel_to_geo(0.5, 0.5);
    if lon_deg >= 180.0 {
        lon_deg -= 360.0;
    }
    let (rows, columns) = (file.height(), file.width());
    let south_deg = lat_deg - f64::from(rows - 1) * row_step_deg;
    let width_deg = f64::from(columns - 1) * column_step_deg;
    // Half a pixel beyond the poles and the date line is usual for grids of the whole earth.
    let on_earth = lat_deg <= 90.0 + row_step_deg
        && south_deg >= -90.0 - row_step_deg
        && lon_deg >= -180.0 - column_step_deg
        && width_deg <= 360.0 + column_step_deg;
    if !on_earth {
        let found = format!(
            "pixels at {lat_deg}, {lon_deg}, of {row_step_deg} x {column_step_deg} degrees"
        );
        return Err(TerrainError::Layout(found));
    }
    let size =
        |pixels: u32| usize::try_from(pixels).map_err(|_| TerrainError::TooLarge(usize::MAX));
    Ok(Lattice {
        north_west: LatLon { lat_deg, lon_deg },
        row_step_deg,
        column_step_deg,
        rows: size(rows)?,
        columns: size(columns)?,
    })
}

/// The heights of a window, row by row, from samples of whatever type.
fn samples(
    file: &GeoTiffFile,
    window: Window,
    height_m: impl Fn(f64) -> f32,
) -> Result<Vec<f32>, TerrainError> {
    let decode = |error: &dyn std::fmt::Display| TerrainError::Decode(error.to_string());
    let ifd = file
        .tiff()
        .ifd(file.base_ifd_index())
        .map_err(|error| decode(&error))?;
    let bits = ifd.bits_per_sample().map_err(|error| decode(&error))?;
    let formats = ifd.sample_format().map_err(|error| decode(&error))?;
    if ifd.samples_per_pixel() != 1 {
        return Err(TerrainError::Samples(format!(
            "{} bands",
            ifd.samples_per_pixel()
        )));
    }
    macro_rules! read {
        ($sample:ty) => {
            file.read_window::<$sample>(
                window.first_row,
                window.first_column,
                window.rows,
                window.columns,
            )
            .map_err(|error| decode(&error))?
            .iter()
            .map(|sample| height_m(f64::from(*sample)))
            .collect()
        };
    }
    // SampleFormat of TIFF 6.0: 1 unsigned, 2 signed, 3 float.
    let heights: Vec<f32> = match (formats.first(), bits.first()) {
        (Some(1), Some(8)) => read!(u8),
        (Some(1), Some(16)) => read!(u16),
        (Some(1), Some(32)) => read!(u32),
        (Some(2), Some(8)) => read!(i8),
        (Some(2), Some(16)) => read!(i16),
        (Some(2), Some(32)) => read!(i32),
        (Some(3), Some(32)) => read!(f32),
        (Some(3), Some(64)) => read!(f64),
        (format, bits) => {
            let found = format!("format {format:?} and {bits:?} bits");
            return Err(TerrainError::Samples(found));
        }
    };
    if heights.len() == window.rows * window.columns {
        Ok(heights)
    } else {
        Err(TerrainError::Decode(format!("{} samples", heights.len())))
    }
}

//! GeoTIFF in degrees or in a map projection.

mod meaning;
mod vertical;

use std::path::Path;

use geotiff_reader::GeoTiffFile;
use geotiff_reader::crs::{CrsInfo, ModelType};
use geotiff_reader::geokeys;

use meaning::SampleMeaning;
pub(super) use meaning::check_sidecar;
use vertical::check_heights;

use super::blend::Nodes;
use super::lattice::Raster;
use super::{TerrainError, UNSTATED_M, Window, ground_m};
use crate::geodesy::Projection;
use crate::numeric::text::open_regular;

const EPSG_WGS84: u16 = 4326;
/// `GeogAngularUnitsGeoKey`: degree.
const DEGREE: u16 = 9102;
/// Least nodes in each direction.
const MIN_NODES: u32 = 2;

/// A GeoTIFF before its heights are read.
pub(super) struct GeoTiff {
    file: GeoTiffFile,
    pub(super) nodes: Nodes,
    no_data: Option<f64>,
    meaning: SampleMeaning,
}

impl GeoTiff {
    pub(super) fn open(path: &Path) -> Result<Self, TerrainError> {
        // The reader's own message for a missing file names it twice.
        open_regular(path)?;
        let file =
            GeoTiffFile::open(path).map_err(|error| TerrainError::Decode(error.to_string()))?;
        let projection = projection(&file)?;
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
            nodes: {
                let (first, step) = steps(&file)?;
                let raster = Raster {
                    first,
                    step,
                    rows: size(file.height())?,
                    columns: size(file.width())?,
                };
                Nodes::of(projection, raster)?
            },
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

    /// By how much heights may be wrong for what they are measured from, metres. In degrees of WGS84
    /// what a file does not say is taken for mean sea level.
    pub(super) fn datum_error_m(&self) -> f64 {
        let vertical = self.file.crs().vertical();
        match (&self.nodes, vertical.and_then(|vertical| vertical.epsg)) {
            (Nodes::Degrees(_), _) | (_, Some(5773)) => 0.0,
            (_, Some(3855)) => 1.0,
            _ => UNSTATED_M,
        }
    }

    /// What the heights are measured from, as far as the file says it.
    pub(super) fn datum(&self) -> String {
        let vertical = self.file.crs().vertical();
        let citation = vertical.and_then(|vertical| vertical.citation.clone());
        let name = match &self.nodes {
            Nodes::Degrees(_) => "WGS84".to_owned(),
            Nodes::Plane(lattice) => lattice.projection.name(),
        };
        let text = match (vertical.and_then(|vertical| vertical.epsg), citation) {
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
        };
        text.replacen("WGS84", &name, 1)
    }
}

/// Equal within the precision of `f32` samples.
fn is_same(sample: f64, no_data: f64) -> bool {
    (sample - no_data).abs() <= no_data.abs() * 1e-6
}

/// The system of its coordinates; none for degrees of WGS84.
fn projection(file: &GeoTiffFile) -> Result<Option<Projection>, TerrainError> {
    let crs: &CrsInfo = file.crs();
    let name = |code: Option<u16>, citation: Option<&String>| match (code, citation) {
        (Some(code), _) if code != 32767 && code != 0 => format!("EPSG:{code}"),
        (_, Some(citation)) => citation.clone(),
        _ => "no EPSG code".to_owned(),
    };
    let known = |code: Option<u16>, name: String| {
        code.map_or(Ok(()), super::above_the_sea)?;
        let projection = code.and_then(Projection::of_epsg);
        projection.map(Some).ok_or(TerrainError::Crs(name))
    };
    let Some(horizontal) = crs.horizontal() else {
        return Err(TerrainError::Crs("no coordinate system at all".to_owned()));
    };
    match crs.model_type_enum() {
        ModelType::Geographic => {}
        ModelType::Projected => {
            let code = horizontal.projected_epsg;
            let name = name(code, horizontal.projection_citation.as_ref());
            return known(code, format!("projection {name}"));
        }
        ModelType::Geocentric => return Err(TerrainError::Crs("a geocentric system".to_owned())),
        ModelType::Unknown(code) => return Err(TerrainError::Crs(format!("model type {code}"))),
    }
    match file.geokeys().get_short(geokeys::GEOG_ANGULAR_UNITS) {
        None | Some(DEGREE) => {}
        Some(unit) => return Err(TerrainError::Crs(format!("angular unit EPSG:{unit}"))),
    }
    match horizontal.geodetic_epsg {
        Some(EPSG_WGS84) => Ok(None),
        code => known(code, name(code, horizontal.geodetic_citation.as_ref())),
    }
}

/// The first node, and the steps between columns and rows.
type Steps = ((f64, f64), (f64, f64));

/// Where the nodes are: pixel centres, whether pixels are areas or points (the
/// reader's transform is of pixel corners in both cases).
fn steps(file: &GeoTiffFile) -> Result<Steps, TerrainError> {
    let transform = file
        .transform()
        .ok_or_else(|| TerrainError::Layout("no place and scale of its pixels".to_owned()))?;
    if transform.skew_x.abs() > 0.0 || transform.skew_y.abs() > 0.0 {
        return Err(TerrainError::Layout("rotated".to_owned()));
    }
    let (column_step, row_step) = (transform.pixel_width, -transform.pixel_height);
    let positive = |step: f64| step.is_finite() && step > 0.0;
    if !positive(column_step) || !positive(row_step) {
        return Err(TerrainError::Layout("mirrored".to_owned()));
    }
    if file.width() < MIN_NODES || file.height() < MIN_NODES {
        return Err(TerrainError::Layout(format!(
            "{} x {} pixels",
            file.width(),
            file.height()
        )));
    }
    Ok((transform.pixel_to_geo(0.5, 0.5), (column_step, row_step)))
}

fn size(pixels: u32) -> Result<usize, TerrainError> {
    usize::try_from(pixels).map_err(|_| TerrainError::TooLarge(usize::MAX))
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

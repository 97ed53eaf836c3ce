//! What the samples of a GeoTIFF mean: tags and sidecars that change a number.
//!
//! Source: the "Metadata" and "Georeferencing" sections of GDAL's GTiff driver, TIFF 6.0,
//! and OGC GeoTIFF 1.1. What is not understood is refused.

use std::path::Path;

use geotiff_reader::GeoTiffFile;
use geotiff_reader::crs::RasterType;
use roxmltree::{Document, Node};

use super::super::TerrainError;

/// `NewSubfileType` of TIFF 6.0: a transparency mask.
const MASK: u64 = 4;
const NEW_SUBFILE_TYPE: u16 = 254;
const PHOTOMETRIC_INTERPRETATION: u16 = 262;
const ORIENTATION: u16 = 274;
const MODEL_PIXEL_SCALE: u16 = 33550;
const MODEL_TIE_POINT: u16 = 33922;
const MODEL_TRANSFORMATION: u16 = 34264;
const GDAL_METADATA: u16 = 42112;

/// How a sample becomes a height: `sample * scale + offset`, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SampleMeaning {
    scale: f64,
    offset_m: f64,
}

impl SampleMeaning {
    /// Reads every tag that changes what a sample means, and the `.aux.xml` next to the file.
    ///
    /// # Errors
    /// A tag that is not understood, or that says something else than metres upwards.
    pub(super) fn read(file: &GeoTiffFile, path: &Path) -> Result<Self, TerrainError> {
        check_image(file)?;
        check_vertical_scale(file)?;
        let meaning = match metadata(file)? {
            None => Self::default(),
            Some(text) => Self::of_metadata(text)?,
        };
        check_sidecar(path, file.nodata())?;
        Ok(meaning)
    }

    /// The height of a sample, metres.
    pub(super) fn height_m(self, sample: f64) -> f64 {
        sample * self.scale + self.offset_m
    }

    /// `GDAL_METADATA`: items with the role `scale`, `offset` or `unittype` of band 0.
    fn of_metadata(text: &str) -> Result<Self, TerrainError> {
        let document = Document::parse(text)
            .map_err(|error| unclear(format!("GDAL_METADATA that is no XML ({error})")))?;
        let root = document.root_element();
        if root.tag_name().name() != "GDALMetadata" {
            return Err(unclear("GDAL_METADATA of an unknown form"));
        }
        let mut meaning = Self::default();
        for item in root.children().filter(Node::is_element) {
            meaning.apply(item)?;
        }
        // Other programs keep them as plain items; GDAL does not apply those.
        for item in root.children().filter(Node::is_element) {
            meaning.check_plain(item)?;
        }
        Ok(meaning)
    }

    fn apply(&mut self, item: Node<'_, '_>) -> Result<(), TerrainError> {
        let Some(role) = item.attribute("role") else {
            return Ok(());
        };
        let text = item.text().unwrap_or_default().trim();
        let role = role.to_ascii_lowercase();
        if !matches!(role.as_str(), "scale" | "offset" | "unittype") {
            return Ok(());
        }
        if item.attribute("sample") != Some("0") {
            return Err(unclear(format!("GDAL_METADATA with a {role} of no band")));
        }
        match role.as_str() {
            "scale" => self.scale = number(&role, text)?,
            "offset" => self.offset_m = number(&role, text)?,
            _ => check_unit(text)?,
        }
        if self.scale == 0.0 {
            return Err(unclear("GDAL_METADATA with a scale of 0"));
        }
        Ok(())
    }

    fn check_plain(self, item: Node<'_, '_>) -> Result<(), TerrainError> {
        if item.attribute("role").is_some() {
            return Ok(());
        }
        let name = item.attribute("name").unwrap_or_default();
        let text = item.text().unwrap_or_default().trim();
        let last = name.rsplit('#').next().unwrap_or_default();
        let contradicts = match last.to_ascii_lowercase().as_str() {
            "scale" | "scale_factor" => !is_number(text, self.scale),
            "offset" | "add_offset" => !is_number(text, self.offset_m),
            "unit" | "units" | "unittype" | "unit_type" => is_other_unit(text),
            _ => false,
        };
        match contradicts {
            true => Err(unclear(format!(
                "GDAL_METADATA with {name} `{text}`, which GDAL does not apply"
            ))),
            false => Ok(()),
        }
    }
}

impl Default for SampleMeaning {
    fn default() -> Self {
        Self {
            scale: 1.0,
            offset_m: 0.0,
        }
    }
}

fn unclear(what: impl Into<String>) -> TerrainError {
    TerrainError::Meaning(what.into())
}

/// The values of a tag of numbers; none if it is absent.
fn numbers(file: &GeoTiffFile, code: u16) -> Result<Vec<f64>, TerrainError> {
    let ifd = file.tiff().ifd(file.base_ifd_index());
    let ifd = ifd.map_err(|error| TerrainError::Decode(error.to_string()))?;
    match ifd.tag(code) {
        None => Ok(Vec::new()),
        Some(tag) => {
            let whole = |value: u16| vec![f64::from(value)];
            let values = tag.value.as_f64_vec();
            let values = values.or_else(|| tag.value.as_u16().map(whole));
            values.ok_or_else(|| unclear(format!("tag {code} that is no number")))
        }
    }
}

/// The text of `GDAL_METADATA`.
fn metadata(file: &GeoTiffFile) -> Result<Option<&str>, TerrainError> {
    let ifd = file.tiff().ifd(file.base_ifd_index());
    let ifd = ifd.map_err(|error| TerrainError::Decode(error.to_string()))?;
    match ifd.tag(GDAL_METADATA) {
        None => Ok(None),
        Some(tag) => {
            let text = tag.value.as_str().map(|text| text.trim_end_matches('\0'));
            let text = text.ok_or_else(|| unclear("GDAL_METADATA that is no text"))?;
            Ok(Some(text))
        }
    }
}

/// Refuses what is no plain grid of numbers: inverted or indexed grey, a turned image, a mask.
fn check_image(file: &GeoTiffFile) -> Result<(), TerrainError> {
    for (code, what) in [
        (PHOTOMETRIC_INTERPRETATION, "photometric interpretation"),
        (ORIENTATION, "orientation"),
    ] {
        let values = numbers(file, code)?;
        if let Some(other) = values.iter().find(|value| (**value - 1.0).abs() > 0.0) {
            return Err(unclear(format!("{what} {other}")));
        }
    }
    if let RasterType::Unknown(other) = file.crs().raster_type_enum() {
        return Err(unclear(format!("raster type {other}")));
    }
    let mut kinds = file.tiff().ifds().iter().filter_map(|ifd| {
        let kind = ifd.tag(NEW_SUBFILE_TYPE)?;
        kind.value.as_u64()
    });
    match kinds.any(|kind| kind & MASK != 0) {
        true => Err(unclear("a mask of its pixels")),
        false => Ok(()),
    }
}

/// Refuses a vertical scale or offset of the model tags; 0 and 1 mean none.
fn check_vertical_scale(file: &GeoTiffFile) -> Result<(), TerrainError> {
    let is_none = |scale: f64| scale == 0.0 || (scale - 1.0).abs() == 0.0;
    let scale = numbers(file, MODEL_PIXEL_SCALE)?;
    let scaled = scale.get(2).is_some_and(|scale| !is_none(*scale));
    let tie = numbers(file, MODEL_TIE_POINT)?;
    let heights = tie.chunks(6).flat_map(|point| [point.get(2), point.get(5)]);
    let raised = heights.flatten().any(|height| *height != 0.0);
    let matrix = numbers(file, MODEL_TRANSFORMATION)?;
    let row = matrix.get(8..12).unwrap_or_default();
    let sheared =
        matches!(row, [a, b, c, d] if *a != 0.0 || *b != 0.0 || *d != 0.0 || !is_none(*c));
    match scaled || raised || sheared {
        true => Err(unclear("a scale or offset of height in its model tags")),
        false => Ok(()),
    }
}

/// Refuses an `.aux.xml` of GDAL that changes a number or its place.
pub(in super::super) fn check_sidecar(
    path: &Path,
    no_data: Option<&str>,
) -> Result<(), TerrainError> {
    let mut name = path.as_os_str().to_owned();
    name.push(".aux.xml");
    let text = match std::fs::read_to_string(&name) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        text => text?,
    };
    let name = super::super::name_of(Path::new(&name));
    let document = Document::parse(&text)
        .map_err(|error| unclear(format!("{name} that is no XML ({error})")))?;
    let is_same = |text: &str| match no_data.map(|no_data| no_data.trim_matches(['\0', ' '])) {
        Some(no_data) => match no_data.parse() {
            Ok(value) => is_number(text, value),
            Err(_) => no_data == text,
        },
        None => false,
    };
    for node in document.descendants().filter(Node::is_element) {
        let text = node.text().unwrap_or_default().trim();
        let kind = node.tag_name().name();
        let changes = match kind {
            "Scale" => !is_number(text, 1.0),
            "Offset" => !is_number(text, 0.0),
            "UnitType" => check_unit(text).is_err(),
            "NoDataValue" => !is_same(text),
            "SRS" | "GeoTransform" | "GCPList" | "MaskBand" => true,
            _ => false,
        };
        if changes {
            return Err(unclear(format!("{name} with {kind} `{text}`")));
        }
    }
    Ok(())
}

fn number(role: &str, text: &str) -> Result<f64, TerrainError> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(unclear(format!("GDAL_METADATA with {role} `{text}`"))),
    }
}

/// Whether a text is a number, as exact as it is written.
fn is_number(text: &str, value: f64) -> bool {
    let tolerance = 1e-9 * value.abs();
    text.parse::<f64>()
        .is_ok_and(|found| (found - value).abs() <= tolerance)
}

fn is_metre(unit: &str) -> bool {
    let unit = unit.to_ascii_lowercase();
    matches!(
        unit.as_str(),
        "" | "m" | "metre" | "metres" | "meter" | "meters"
    )
}

fn check_unit(unit: &str) -> Result<(), TerrainError> {
    match is_metre(unit) {
        true => Ok(()),
        false => Err(TerrainError::Heights(format!("unit `{unit}`"))),
    }
}

/// Whether a plain item names a length that is no metre; other units are of other axes.
fn is_other_unit(unit: &str) -> bool {
    let unit = unit.to_ascii_lowercase();
    let mut words = unit.split(|letter: char| !letter.is_ascii_alphabetic());
    words.any(|word| {
        matches!(
            word,
            "ft" | "feet" | "foot" | "km" | "dm" | "cm" | "mm" | "in" | "yd" | "fathom" | "fathoms"
        ) || ["kilomet", "decimet", "centimet", "millimet", "inch", "yard"]
            .iter()
            .any(|start| word.starts_with(start))
    })
}

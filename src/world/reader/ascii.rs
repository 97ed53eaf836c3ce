//! ESRI ASCII grids (`.asc`): a header of words and numbers, then heights row by row from the north.
//!
//! Source: "ESRI ASCII raster format" of ArcGIS, and GDAL's AAIGrid driver for `dx`, `dy`. The file
//! itself names no coordinate system: its `.prj` does.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use super::blend::Nodes;
use super::geotiff::check_sidecar;
use super::lattice::Raster;
use super::{TerrainError, Window, ground_m, prj};
use crate::geodesy::Projection;
use crate::numeric::text::open_regular;

/// What stands for no data where the header does not say.
const NO_DATA: f64 = -9999.0;
/// Most rows or columns: more of them are no grid of heights.
const MAX_SIDE: f64 = 1e6;
/// Longest word of a number.
const MAX_WORD: usize = 64;

/// A grid before its heights are read.
pub(super) struct AsciiGrid {
    path: PathBuf,
    pub(super) nodes: Nodes,
    header: Header,
    /// Name of its coordinate system.
    system: String,
}

#[derive(Clone, Copy, Debug)]
struct Header {
    rows: usize,
    columns: usize,
    /// East and north of the middle of the south-western cell.
    south_west: (f64, f64),
    /// Between columns and between rows.
    step: (f64, f64),
    no_data: f64,
    /// Words before the first height.
    words: usize,
}

impl AsciiGrid {
    pub(super) fn open(path: &Path) -> Result<Self, TerrainError> {
        let header = Header::read(&mut words(path)?)?;
        let projection = prj::read(path)?;
        check_sidecar(path, Some(&header.no_data.to_string()))?;
        let (east, north) = header.south_west;
        let above = count(header.rows - 1) * header.step.1;
        let raster = Raster {
            first: (east, north + above),
            step: header.step,
            rows: header.rows,
            columns: header.columns,
        };
        let system = projection.as_ref().map(Projection::name);
        Ok(Self {
            path: path.to_owned(),
            nodes: Nodes::of(projection, raster)?,
            header,
            system: system.unwrap_or_else(|| "WGS84".to_owned()),
        })
    }

    pub(super) fn datum(&self) -> String {
        let system = &self.system;
        format!("{system}, metres taken for above mean sea level: the file does not say")
    }

    /// Reads to the end: a grid with too few or too many heights is damaged.
    pub(super) fn read(&self, window: Window) -> Result<Vec<f32>, TerrainError> {
        let header = self.header;
        let mut words = words(&self.path)?;
        for _ in 0..header.words {
            words.next()?;
        }
        let rows = window.first_row..window.first_row + window.rows;
        let columns = window.first_column..window.first_column + window.columns;
        let mut heights_m = Vec::with_capacity(window.rows.saturating_mul(window.columns));
        for row in 0..header.rows {
            for column in 0..header.columns {
                let Some(word) = words.next()? else {
                    let (rows, columns) = (header.rows, header.columns);
                    return Err(damaged(format!(
                        "it ends before {rows} x {columns} heights"
                    )));
                };
                // Words outside of the window are only counted.
                if rows.contains(&row) && columns.contains(&column) {
                    let height_m = number(&word, || format!("row {}", row + 1))?;
                    let is_none = (height_m - header.no_data).abs() <= 1e-6 * header.no_data.abs();
                    heights_m.push(if is_none {
                        f32::NAN
                    } else {
                        ground_m(height_m)
                    });
                }
            }
        }
        match words.next()? {
            None => Ok(heights_m),
            Some(_) => {
                let (rows, columns) = (header.rows, header.columns);
                Err(damaged(format!("more than {rows} x {columns} heights")))
            }
        }
    }
}

impl Header {
    fn read(words: &mut Words) -> Result<Self, TerrainError> {
        let mut keys: Vec<(String, f64)> = Vec::new();
        while let Some(word) = words.next()? {
            if !word.starts_with(|sign: char| sign.is_ascii_alphabetic()) || is_nan(&word) {
                break;
            }
            let key = word.to_ascii_lowercase();
            let value = words.next()?.unwrap_or_default();
            let value = number(&value, || format!("{word} of the header"))?;
            if keys.iter().any(|(known, _)| *known == key) {
                return Err(damaged(format!("{word} twice in the header")));
            }
            keys.push((key, value));
        }
        let words = 2 * keys.len();
        let mut take = |name: &str| {
            let at = keys.iter().position(|(key, _)| key == name)?;
            Some(keys.swap_remove(at).1)
        };
        let missing = |name: &str| damaged(format!("no {name} in the header"));
        let side = |name: &str, value: Option<f64>| side(name, value.ok_or_else(|| missing(name))?);
        let columns = side("ncols", take("ncols"))?;
        let rows = side("nrows", take("nrows"))?;
        let (cell, dx, dy) = (take("cellsize"), take("dx"), take("dy"));
        let step = match (cell, dx, dy) {
            (Some(cell), None, None) => (cell, cell),
            (None, Some(dx), Some(dy)) => (dx, dy),
            _ => return Err(missing("cellsize")),
        };
        if !(step.0 > 0.0 && step.1 > 0.0) {
            return Err(damaged("a cell size that is not positive".to_owned()));
        }
        let mut axis = |corner: &str, center: &str, step: f64| match (take(corner), take(center)) {
            (Some(corner), None) => Ok(corner + 0.5 * step),
            (None, Some(center)) => Ok(center),
            _ => Err(missing(&format!("{corner} or {center}, or both are"))),
        };
        let south_west = (
            axis("xllcorner", "xllcenter", step.0)?,
            axis("yllcorner", "yllcenter", step.1)?,
        );
        let no_data = take("nodata_value").unwrap_or(NO_DATA);
        match keys.first() {
            Some((key, _)) => Err(damaged(format!("`{key}` in the header"))),
            None => Ok(Self {
                rows,
                columns,
                south_west,
                step,
                no_data,
                words,
            }),
        }
    }
}

/// Rows or columns from the header.
fn side(name: &str, value: f64) -> Result<usize, TerrainError> {
    if !(2.0..=MAX_SIDE).contains(&value) || value.fract() != 0.0 {
        return Err(damaged(format!("{name} {value}")));
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "whole and small"
    )]
    let side = value as usize;
    Ok(side)
}

fn damaged(why: String) -> TerrainError {
    TerrainError::Ascii(why)
}

fn is_nan(word: &str) -> bool {
    word.eq_ignore_ascii_case("nan")
}

fn number(word: &str, of: impl Fn() -> String) -> Result<f64, TerrainError> {
    match word.parse::<f64>() {
        Ok(value) if value.is_finite() || is_nan(word) => Ok(value),
        _ => Err(damaged(format!("`{word}` as {}", of()))),
    }
}

/// The words of a file, one at a time.
struct Words {
    reader: BufReader<std::fs::File>,
}

fn words(path: &Path) -> Result<Words, TerrainError> {
    let reader = BufReader::with_capacity(1 << 16, open_regular(path)?);
    Ok(Words { reader })
}

impl Words {
    fn next(&mut self) -> Result<Option<String>, TerrainError> {
        let mut word = Vec::new();
        loop {
            let part = self.reader.fill_buf()?;
            if part.is_empty() {
                break;
            }
            let is_space = u8::is_ascii_whitespace;
            if word.is_empty() {
                let spaces = part.iter().take_while(|byte| is_space(byte)).count();
                if spaces > 0 {
                    self.reader.consume(spaces);
                    continue;
                }
            }
            let length = part.iter().take_while(|byte| !is_space(byte)).count();
            let is_whole = length < part.len();
            word.extend_from_slice(&part[..length]);
            self.reader.consume(length);
            if word.len() > MAX_WORD {
                return Err(damaged("words that are no numbers".to_owned()));
            }
            if is_whole {
                break;
            }
        }
        match String::from_utf8(word) {
            Ok(word) if word.is_empty() => Ok(None),
            Ok(word) => Ok(Some(word)),
            Err(_) => Err(damaged("bytes that are no text".to_owned())),
        }
    }
}

#[expect(clippy::cast_precision_loss, reason = "at most MAX_SIDE")]
fn count(nodes: usize) -> f64 {
    nodes as f64
}

//! Terrarium tiles: PNG in Web Mercator, a height `red * 256 + green + blue / 256 - 32768` metres.
//!
//! Source: "Terrain Tiles" of Mapzen and AWS (`formats.md`, Terrarium). Where a tile lies is said by
//! its path: `ZOOM/COLUMN/ROW.png`, from the north-west.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use super::blend::Nodes;
use super::plane::PlaneLattice;
use super::{Bounds, TerrainError, Window, ground_m, mosaic, name_of};
use crate::geodesy::Projection;
use crate::numeric::text::open_regular;

/// Half the width of the square of Web Mercator, metres.
const HALF_M: f64 = 20_037_508.342_789_244;
/// Largest zoom: 4 cm at the equator.
const MAX_ZOOM: u32 = 22;
/// Pixels on a side.
const SIDES: [u32; 2] = [256, 512];
/// Nothing on earth is deeper: other encodings of heights in colours come out far below it.
const DEEPEST_M: f64 = -12_000.0;

/// Zoom, column and row of a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    zoom: u32,
    column: u32,
    row: u32,
}

/// Tiles of one zoom before their heights are read.
pub(super) struct Terrarium {
    tiles: BTreeMap<Place, PathBuf>,
    first: Place,
    side: u32,
    pub(super) nodes: Nodes,
}

impl Terrarium {
    pub(super) fn open(path: &Path) -> Result<Self, TerrainError> {
        // A missing file is the first thing to say of it.
        open_regular(path)?;
        let place = place_of(path).ok_or_else(|| TerrainError::Unplaced(name_of(path)))?;
        Self::of(BTreeMap::from([(place, path.to_owned())]))
    }

    /// The tiles of a folder and the folders in it that hold something of the bounds, of the greatest
    /// zoom that does; none without any tile.
    pub(super) fn open_folder(
        folder: &Path,
        bounds: Option<Bounds>,
    ) -> Result<Option<Self>, TerrainError> {
        let mut tiles = BTreeMap::new();
        let mut found = 0;
        for path in paths(folder)? {
            let Some(place) = place_of(&path) else {
                continue;
            };
            found += 1;
            if place.lattice(SIDES[0])?.window(bounds).is_ok() {
                let name = |path: &Path| path.to_string_lossy().into_owned();
                if let Some(other) = tiles.insert(place, path.clone()) {
                    let (first, second) = (name(&other), name(&path));
                    return Err(TerrainError::Twice { first, second });
                }
            }
        }
        let Some(zoom) = tiles.keys().map(|place| place.zoom).max() else {
            return match found {
                0 => Ok(None),
                found => Err(TerrainError::NoneHere(found)),
            };
        };
        tiles.retain(|place, _| place.zoom == zoom);
        Self::of(tiles).map(Some)
    }

    fn of(tiles: BTreeMap<Place, PathBuf>) -> Result<Self, TerrainError> {
        let none = || TerrainError::NoneHere(0);
        let (any, path) = tiles.first_key_value().ok_or_else(none)?;
        let side = png(path)?.info().width;
        let corner = |of: fn(u32, u32) -> u32| {
            let all = tiles.keys().copied();
            let both = all.reduce(|a, b| Place {
                zoom: a.zoom,
                column: of(a.column, b.column),
                row: of(a.row, b.row),
            });
            both.unwrap_or(*any)
        };
        let (first, last) = (corner(u32::min), corner(u32::max));
        let mut lattice = first.lattice(side)?;
        lattice.rows = pixels((last.row - first.row + 1).saturating_mul(side))?;
        lattice.columns = pixels((last.column - first.column + 1).saturating_mul(side))?;
        let nodes = Nodes::Plane(Box::new(lattice));
        Ok(Self {
            tiles,
            first,
            side,
            nodes,
        })
    }

    /// The files, in the order of their places.
    pub(super) fn paths(&self) -> impl Iterator<Item = &Path> {
        self.tiles.values().map(PathBuf::as_path)
    }

    /// Reads a window; where no tile is there is no data.
    pub(super) fn read(&self, window: Window) -> Result<Vec<f32>, TerrainError> {
        let mut heights_m = vec![f32::NAN; window.rows.saturating_mul(window.columns)];
        let side = pixels(self.side)?;
        for (place, path) in &self.tiles {
            let top = pixels(place.row - self.first.row)? * side;
            let left = pixels(place.column - self.first.column)? * side;
            let rows = top.max(window.first_row)..(top + side).min(window.first_row + window.rows);
            let columns = left.max(window.first_column)
                ..(left + side).min(window.first_column + window.columns);
            if rows.is_empty() || columns.is_empty() {
                continue;
            }
            let own = heights(path, self.side).map_err(|error| match self.tiles.len() {
                1 => error,
                _ => mosaic::in_file(
                    &format!("{}/{}/{}.png", place.zoom, place.column, place.row),
                    error,
                ),
            })?;
            for row in rows {
                let from = (row - top) * side + columns.start - left;
                let to =
                    (row - window.first_row) * window.columns + columns.start - window.first_column;
                let length = columns.len();
                heights_m[to..to + length].copy_from_slice(&own[from..from + length]);
            }
        }
        Ok(heights_m)
    }
}

impl Place {
    /// The middles of the pixels of this tile.
    fn lattice(self, side: u32) -> Result<PlaneLattice, TerrainError> {
        let projection = Projection::of_epsg(3857);
        let projection = projection.ok_or_else(|| TerrainError::Crs("EPSG:3857".to_owned()))?;
        let step = 2.0 * HALF_M / (f64::from(side) * f64::from(1_u32 << self.zoom));
        let middle = |tile: u32| (f64::from(tile) * f64::from(side) + 0.5) * step;
        Ok(PlaneLattice {
            projection,
            first: (middle(self.column) - HALF_M, HALF_M - middle(self.row)),
            step: (step, step),
            rows: pixels(side)?,
            columns: pixels(side)?,
        })
    }
}

/// The place of a tile by its path, such as `12/2145/1434.png`, or by its name, `12_2145_1434.png`.
fn place_of(path: &Path) -> Option<Place> {
    let whole = path.to_string_lossy().replace('\\', "/");
    let stem = whole.get(..whole.len().checked_sub(4)?)?;
    let is_png = whole.to_ascii_lowercase().ends_with(".png");
    let name = stem.rsplit('/').next()?;
    let parts: Vec<&str> = match name.contains(['_', '-']) {
        true => name.split(['_', '-']).collect(),
        false => stem
            .rsplit('/')
            .take(3)
            .collect::<Vec<_>>()
            .into_iter()
            .rev()
            .collect(),
    };
    let number = |text: &str| {
        let is_plain = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
        is_plain.then(|| text.parse::<u32>().ok()).flatten()
    };
    let [zoom, column, row] = parts[..] else {
        return None;
    };
    let place = Place {
        zoom: number(zoom)?,
        column: number(column)?,
        row: number(row)?,
    };
    let is_there =
        place.zoom <= MAX_ZOOM && place.column < 1 << place.zoom && place.row < 1 << place.zoom;
    (is_png && is_there).then_some(place)
}

/// The PNG files of a folder, of the folders in it and of those in them, in the order of their paths.
pub(super) fn paths(folder: &Path) -> Result<Vec<PathBuf>, TerrainError> {
    let mut paths = Vec::new();
    let mut folders = vec![(folder.to_owned(), 0)];
    while let Some((folder, depth)) = folders.pop() {
        for entry in std::fs::read_dir(&folder)? {
            let path = entry?.path();
            if path.is_dir() && depth < 2 {
                folders.push((path, depth + 1));
            } else if path
                .extension()
                .is_some_and(|end| end.eq_ignore_ascii_case("png"))
            {
                paths.push(path);
            }
        }
    }
    paths.sort();
    Ok(paths)
}

type Reader = png::Reader<BufReader<File>>;

fn unreadable(error: &png::DecodingError) -> TerrainError {
    TerrainError::Png(error.to_string())
}

/// A tile of the right size and colours, before its pixels are read.
fn png(path: &Path) -> Result<Reader, TerrainError> {
    let file = BufReader::new(open_regular(path)?);
    let reader = png::Decoder::new(file)
        .read_info()
        .map_err(|error| unreadable(&error))?;
    let info = reader.info();
    if info.width != info.height || !SIDES.contains(&info.width) {
        let found = format!(
            "{} x {} pixels, and a tile has 256 x 256 or 512 x 512",
            info.width, info.height
        );
        return Err(TerrainError::Png(found));
    }
    let is_colour = matches!(info.color_type, png::ColorType::Rgb | png::ColorType::Rgba);
    if !is_colour || info.bit_depth != png::BitDepth::Eight {
        let found = format!(
            "{:?} of {:?} bits, and a tile has red, green and blue of 8",
            info.color_type, info.bit_depth
        );
        return Err(TerrainError::Png(found));
    }
    Ok(reader)
}

/// The heights of a tile, row by row from the north.
fn heights(path: &Path, side: u32) -> Result<Vec<f32>, TerrainError> {
    let mut reader = png(path)?;
    if reader.info().width != side {
        let found = format!(
            "{} pixels a side, and another tile has {side}",
            reader.info().width
        );
        return Err(TerrainError::Png(found));
    }
    let size = reader.output_buffer_size().unwrap_or_default();
    let mut bytes = vec![0; size];
    let frame = reader
        .next_frame(&mut bytes)
        .map_err(|error| unreadable(&error))?;
    let samples = frame.color_type.samples();
    let (mut opaque, mut deep) = (0, 0);
    let mut heights_m = Vec::with_capacity(size / samples);
    for pixel in bytes.chunks_exact(samples) {
        let height_m =
            256.0 * f64::from(pixel[0]) + f64::from(pixel[1]) + f64::from(pixel[2]) / 256.0
                - 32_768.0;
        let is_opaque = pixel.get(3).is_none_or(|opacity| *opacity == u8::MAX);
        opaque += usize::from(is_opaque);
        deep += usize::from(is_opaque && height_m < DEEPEST_M);
        heights_m.push(if is_opaque {
            ground_m(height_m)
        } else {
            f32::NAN
        });
    }
    match opaque > 0 && deep == opaque {
        true => Err(TerrainError::Png(
            "colours that are no Terrarium heights (Mapbox terrain-RGB?)".to_owned(),
        )),
        false => Ok(heights_m),
    }
}

fn pixels(count: u32) -> Result<usize, TerrainError> {
    usize::try_from(count).map_err(|_| TerrainError::TooLarge(usize::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_path_or_the_name_of_a_tile_gives_its_place() {
        let at = |path: &str| place_of(Path::new(path)).map(|at| (at.zoom, at.column, at.row));
        assert_eq!(at("tiles/12/2145/1434.png"), Some((12, 2145, 1434)));
        assert_eq!(at("tiles/12_2145_1434.PNG"), Some((12, 2145, 1434)));
        assert_eq!(at("12-2145-1434.png"), Some((12, 2145, 1434)));
        for path in [
            "dem.png",
            "12/1434.png",
            "3/8/1.png",
            "30/1/1.png",
            "12/2145/+1.png",
            "1/2/3.tif",
            "ñ.png",
            "x",
        ] {
            assert_eq!(at(path), None, "{path}");
        }
    }
}

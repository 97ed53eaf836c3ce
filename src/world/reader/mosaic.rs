//! A folder of elevation files as one.

use std::path::Path;

use super::{Bounds, Lattice, Source, TerrainError, hgt, is_elevation};
use crate::geodesy::LatLon;
use crate::world::TerrainGrid;

/// How far nodes of two files may be apart and still count as one, in steps of the grid.
const SAME_NODE: f64 = 1e-3;

/// The files of a folder that hold something of an area, on common rows and columns.
pub(super) struct Mosaic {
    /// In the order of their names.
    tiles: Vec<Tile>,
    lattice: Lattice,
}

/// A file with its name, its nodes, and its row and column from those of another.
type Placed = (String, (Source, Lattice), (i64, i64));

struct Tile {
    name: String,
    source: Source,
    lattice: Lattice,
    /// Row and column of its first node.
    row: usize,
    column: usize,
}

impl Mosaic {
    /// Looks at the files of a folder, not at those of folders within it. Tiles that
    /// lie elsewhere by their name are not even opened.
    pub(super) fn open(folder: &Path, bounds: Option<Bounds>) -> Result<Self, TerrainError> {
        let mut sources = Vec::new();
        let names = names(folder)?;
        for name in &names {
            if hgt::corner(name).is_some_and(|corner| !touches(corner, bounds)) {
                continue;
            }
            let source = Source::open(&folder.join(name)).map_err(|error| in_file(name, error))?;
            let Some(lattice) = source.lattice() else {
                return Err(TerrainError::Mixed {
                    first: name.clone(),
                    second: name.clone(),
                });
            };
            if lattice.cut(bounds).is_some() {
                sources.push((name.clone(), lattice, source));
            }
        }
        let Some((first, reference, _)) = sources.first() else {
            return Err(TerrainError::NoneHere(names.len()));
        };
        let (first, reference) = (first.clone(), *reference);
        let mut placed = Vec::new();
        for (name, lattice, source) in sources {
            let place = offset(&reference, &lattice).ok_or_else(|| TerrainError::Mixed {
                first: first.clone(),
                second: name.clone(),
            })?;
            placed.push((name, (source, lattice), place));
        }
        Self::join(&reference, placed)
    }

    /// The smallest lattice that holds all, each at its row and column from `reference`.
    fn join(reference: &Lattice, placed: Vec<Placed>) -> Result<Self, TerrainError> {
        let mut north_west = (i64::MAX, i64::MAX);
        let mut south_east = (i64::MIN, i64::MIN);
        for (_, (_, lattice), (row, column)) in &placed {
            let size = |nodes: usize| i64::try_from(nodes).unwrap_or(i64::MAX);
            north_west = (north_west.0.min(*row), north_west.1.min(*column));
            south_east = (
                south_east.0.max(row.saturating_add(size(lattice.rows))),
                south_east
                    .1
                    .max(column.saturating_add(size(lattice.columns))),
            );
        }
        let count = |from: i64, to: i64| {
            usize::try_from(to.saturating_sub(from)).map_err(|_| TerrainError::TooLarge(usize::MAX))
        };
        let mut tiles: Vec<Tile> = Vec::new();
        for (name, (source, lattice), (row, column)) in placed {
            let tile = Tile {
                row: count(north_west.0, row)?,
                column: count(north_west.1, column)?,
                name,
                source,
                lattice,
            };
            let same = |other: &&Tile| {
                let (a, b) = (other.lattice, tile.lattice);
                let place = |tile: &Tile| (tile.row, tile.column);
                place(other) == place(&tile) && (a.rows, a.columns) == (b.rows, b.columns)
            };
            if let Some(other) = tiles.iter().find(same) {
                return Err(TerrainError::Twice {
                    first: other.name.clone(),
                    second: tile.name,
                });
            }
            tiles.push(tile);
        }
        #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 rows")]
        let lattice = Lattice {
            north_west: LatLon {
                lat_deg: reference.north_west.lat_deg
                    - north_west.0 as f64 * reference.row_step_deg,
                lon_deg: reference.north_west.lon_deg
                    + north_west.1 as f64 * reference.column_step_deg,
            },
            rows: count(north_west.0, south_east.0)?,
            columns: count(north_west.1, south_east.1)?,
            ..*reference
        };
        Ok(Self { tiles, lattice })
    }

    /// The names of its files.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.tiles.iter().map(|tile| tile.name.as_str())
    }

    /// Reads what lies within `bounds`. Where no file has a node, there is no data; where
    /// several have it, as along seams, the highest counts.
    pub(super) fn read(&self, bounds: Option<Bounds>) -> Result<TerrainGrid, TerrainError> {
        let window = self.lattice.window(bounds)?;
        let mut heights_m = vec![f32::NAN; window.rows * window.columns];
        for tile in &self.tiles {
            let lattice = tile.lattice;
            let rows = overlap(window.first_row, window.rows, tile.row, lattice.rows);
            let columns = overlap(
                window.first_column,
                window.columns,
                tile.column,
                lattice.columns,
            );
            let (Some(rows), Some(columns)) = (rows, columns) else {
                continue;
            };
            let part = super::Window {
                first_row: rows.start - tile.row,
                rows: rows.len(),
                first_column: columns.start - tile.column,
                columns: columns.len(),
            };
            let read = tile.source.read(part);
            let read = read.map_err(|error| in_file(&tile.name, error))?;
            let target = rows.map(|row| (row - window.first_row) * window.columns);
            for (start, from) in target.zip(read.chunks_exact(part.columns)) {
                let start = start + columns.start - window.first_column;
                for (height_m, read_m) in heights_m[start..].iter_mut().zip(from) {
                    // `max` takes the number where one of both is none.
                    *height_m = height_m.max(*read_m);
                }
            }
        }
        Ok(self.lattice.grid(window, heights_m))
    }
}

pub(super) fn in_file(name: &str, error: TerrainError) -> TerrainError {
    TerrainError::InFile {
        name: name.to_owned(),
        error: Box::new(error),
    }
}

/// The elevation files of a folder, by their names, in order.
pub(super) fn names(folder: &Path) -> Result<Vec<String>, TerrainError> {
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        // A picture in a folder of tiles is no elevation; Terrarium tiles have folders of their own.
        if is_elevation(&name) && !name.to_ascii_lowercase().ends_with(".png") {
            names.push(name);
        }
    }
    names.sort();
    Ok(names)
}

/// Whether the degree of a tile touches the bounds.
fn touches(corner: LatLon, bounds: Option<Bounds>) -> bool {
    bounds.is_none_or(|bounds| {
        let (south_west, north_east) = (bounds.south_west, bounds.north_east);
        corner.lat_deg <= north_east.lat_deg
            && corner.lat_deg + 1.0 >= south_west.lat_deg
            && corner.lon_deg <= north_east.lon_deg
            && corner.lon_deg + 1.0 >= south_west.lon_deg
    })
}

/// Rows and columns of a lattice's first node from that of another, if their nodes fall together.
fn offset(reference: &Lattice, other: &Lattice) -> Option<(i64, i64)> {
    let whole = |steps: f64| {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "a cast of a float saturates"
        )]
        let rounded = steps.round() as i64;
        ((steps - steps.round()).abs() < SAME_NODE).then_some(rounded)
    };
    let drift = |ours: f64, theirs: f64, nodes: usize| {
        let nodes = u32::try_from(nodes).map_or(f64::INFINITY, f64::from);
        (theirs / ours - 1.0).abs() * nodes
    };
    let apart = drift(reference.row_step_deg, other.row_step_deg, other.rows).max(drift(
        reference.column_step_deg,
        other.column_step_deg,
        other.columns,
    ));
    if apart > SAME_NODE {
        return None;
    }
    let (from, to) = (reference.north_west, other.north_west);
    Some((
        whole((from.lat_deg - to.lat_deg) / reference.row_step_deg)?,
        whole((to.lon_deg - from.lon_deg) / reference.column_step_deg)?,
    ))
}

/// What two ranges, each a start and a length, have in common.
fn overlap(
    start: usize,
    length: usize,
    other: usize,
    others: usize,
) -> Option<std::ops::Range<usize>> {
    let common = start.max(other)..(start + length).min(other + others);
    (!common.is_empty()).then_some(common)
}

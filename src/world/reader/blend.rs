//! Grids of other projections and spacings as one grid of latitude and longitude.
//!
//! Each node of the new grid has the bilinear height of the file, the highest of several. Then every
//! node of a file that lies above the new ground raises the cell around it: what is flown over is no
//! lower than any node of the source. What is still uncertain is added everywhere.

use std::path::Path;

use super::lattice::{Raster, Window};
use super::plane::PlaneLattice;
use super::{Bounds, Lattice, MAX_NODES, Source, TerrainError, mosaic, name_of};
use crate::geodesy::{LatLon, Projection};
use crate::world::TerrainGrid;

/// Spacing of the new grid in that of the finest file.
const FINER: f64 = 0.7;
/// Metres in a degree of latitude, at most.
const DEGREE_M: f64 = 111_700.0;

/// The nodes of a file.
#[derive(Clone, Debug)]
pub(super) enum Nodes {
    /// On parallels and meridians.
    Degrees(Lattice),
    /// In a projection.
    Plane(Box<PlaneLattice>),
}

impl Nodes {
    /// The nodes of a raster in a projection, in degrees of WGS84 without one.
    ///
    /// # Errors
    /// Nodes that are nowhere on earth.
    pub(super) fn of(projection: Option<Projection>, raster: Raster) -> Result<Self, TerrainError> {
        let Some(projection) = projection else {
            return Lattice::on_earth(raster).map(Self::Degrees);
        };
        let lattice = PlaneLattice {
            projection,
            first: raster.first,
            step: raster.step,
            rows: raster.rows,
            columns: raster.columns,
        };
        match lattice.extent() {
            Some(_) => Ok(Self::Plane(Box::new(lattice))),
            None => Err(TerrainError::Layout(format!(
                "pixels at {}, {}, which are nowhere on earth",
                raster.first.0, raster.first.1
            ))),
        }
    }

    fn window(&self, bounds: Option<Bounds>) -> Result<Window, TerrainError> {
        match self {
            Self::Degrees(lattice) => lattice.window(bounds),
            Self::Plane(lattice) => lattice.window(bounds),
        }
    }

    pub(super) fn extent(&self) -> Option<Bounds> {
        match self {
            Self::Degrees(lattice) => {
                let last = lattice.node(lattice.rows - 1, lattice.columns - 1);
                let first = lattice.north_west;
                let corner = |lat_deg, lon_deg| LatLon { lat_deg, lon_deg };
                Some(Bounds {
                    south_west: corner(last.lat_deg, first.lon_deg),
                    north_east: corner(first.lat_deg, last.lon_deg),
                })
            }
            Self::Plane(lattice) => lattice.extent(),
        }
    }

    /// Rows and columns.
    pub(super) fn size(&self) -> (usize, usize) {
        match self {
            Self::Degrees(lattice) => (lattice.rows, lattice.columns),
            Self::Plane(lattice) => (lattice.rows, lattice.columns),
        }
    }

    fn row_column(&self, place: LatLon) -> Option<(f64, f64)> {
        match self {
            Self::Degrees(lattice) => Some((
                (lattice.north_west.lat_deg - place.lat_deg) / lattice.row_step_deg,
                (place.lon_deg - lattice.north_west.lon_deg) / lattice.column_step_deg,
            )),
            Self::Plane(lattice) => lattice.row_column(place),
        }
    }

    fn place(&self, row: usize, column: usize) -> Option<LatLon> {
        match self {
            Self::Degrees(lattice) => Some(lattice.node(row, column)),
            Self::Plane(lattice) => lattice.place(count(row), count(column)),
        }
    }

    /// Degrees of latitude and longitude between nodes about the middle of an extent.
    pub(super) fn steps_deg(&self, extent: Bounds) -> Option<(f64, f64)> {
        match self {
            Self::Degrees(lattice) => Some((lattice.row_step_deg, lattice.column_step_deg)),
            Self::Plane(_) => {
                let middle = |a: f64, b: f64| 0.5 * (a + b);
                let (low, high) = (extent.south_west, extent.north_east);
                let at = LatLon {
                    lat_deg: middle(low.lat_deg, high.lat_deg),
                    lon_deg: middle(low.lon_deg, high.lon_deg),
                };
                let (row, column) = self.row_column(at)?;
                let next = |rows: f64, columns: f64| match self {
                    Self::Plane(lattice) => lattice.place(row + rows, column + columns),
                    Self::Degrees(_) => None,
                };
                let (down, right) = (next(1.0, 0.0)?, next(0.0, 1.0)?);
                let step = |a: f64, b: f64, of: f64| (a - of).abs().max((b - of).abs());
                Some((
                    step(down.lat_deg, right.lat_deg, at.lat_deg),
                    step(down.lon_deg, right.lon_deg, at.lon_deg),
                ))
            }
        }
    }

    /// How far a place may be from where the file says, metres.
    fn error_m(&self) -> f64 {
        match self {
            Self::Degrees(_) => 0.0,
            Self::Plane(lattice) => lattice.projection.error_m,
        }
    }
}

/// One file, read as far as it is needed.
struct Part {
    nodes: Nodes,
    window: Window,
    heights_m: Vec<f32>,
    datum_error_m: f64,
}

impl Part {
    fn node_m(&self, row: usize, column: usize) -> Option<f64> {
        let row = row.checked_sub(self.window.first_row)?;
        let column = column.checked_sub(self.window.first_column)?;
        if row >= self.window.rows || column >= self.window.columns {
            return None;
        }
        let height_m = f64::from(self.heights_m[row * self.window.columns + column]);
        height_m.is_finite().then_some(height_m)
    }

    /// Bilinear height; none outside and next to a void.
    fn height_m(&self, place: LatLon) -> Option<f64> {
        let (row, column) = self.nodes.row_column(place)?;
        // Half a pixel beyond the outermost nodes the ground is theirs: files meet there.
        let (rows, columns) = self.nodes.size();
        let ((top, down), (left, right)) =
            (cell(within(row, rows))?, cell(within(column, columns))?);
        let mix = |row: usize| {
            let west_m = self.node_m(row, left)?;
            match right > 0.0 {
                true => Some(west_m + (self.node_m(row, left + 1)? - west_m) * right),
                false => Some(west_m),
            }
        };
        let north_m = mix(top)?;
        match down > 0.0 {
            true => Some(north_m + (mix(top + 1)? - north_m) * down),
            false => Some(north_m),
        }
    }

    /// Every node with its place.
    fn each(&self, mut act: impl FnMut(LatLon, f64)) {
        let (rows, columns) = (self.window.rows, self.window.columns);
        for index in 0..rows * columns {
            let row = self.window.first_row + index / columns;
            let column = self.window.first_column + index % columns;
            if let (Some(height_m), Some(place)) =
                (self.node_m(row, column), self.nodes.place(row, column))
            {
                act(place, height_m);
            }
        }
    }

    /// How much higher the ground may be than the file says, metres: where it lies by its steepest
    /// slope, and what its heights are measured from.
    fn error_m(&self, step_m: f64) -> f64 {
        let columns = self.window.columns;
        let heights_m = &self.heights_m;
        let rise_m = |by: usize| {
            let pairs = heights_m.iter().zip(heights_m.iter().skip(by)).enumerate();
            pairs
                .filter(move |(index, _)| by != 1 || (index + 1) % columns != 0)
                .map(|(_, (a, b))| f64::from((a - b).abs()))
                .filter(|metres| metres.is_finite())
                .fold(0.0, f64::max)
        };
        let steepest = rise_m(1).hypot(rise_m(columns)) / step_m;
        self.nodes.error_m() * steepest + self.datum_error_m
    }
}

/// Reads files of one or of several kinds within bounds as one grid.
pub(super) fn read(
    sources: Vec<(String, Source)>,
    bounds: Option<Bounds>,
) -> Result<TerrainGrid, TerrainError> {
    let mut parts = Vec::new();
    let mut elsewhere = None;
    let files = sources.len();
    for (name, source) in sources {
        let nodes = source.nodes();
        match nodes.window(bounds) {
            Ok(window) if window.rows.saturating_mul(window.columns) > MAX_NODES => {
                return Err(TerrainError::TooLarge(
                    window.rows.saturating_mul(window.columns),
                ));
            }
            Ok(window) => {
                let heights_m = source
                    .read(window)
                    .map_err(|error| mosaic::in_file(&name, error))?;
                let datum_error_m = source.datum_error_m();
                parts.push(Part {
                    nodes,
                    window,
                    heights_m,
                    datum_error_m,
                });
            }
            Err(error) => elsewhere = Some(error),
        }
    }
    if parts.is_empty() {
        return Err(match elsewhere {
            Some(error) if files == 1 => error,
            _ => TerrainError::NoneHere(files),
        });
    }
    blend(&parts, bounds)
}

fn blend(parts: &[Part], bounds: Option<Bounds>) -> Result<TerrainGrid, TerrainError> {
    let mut grid = empty(parts, bounds)?;
    for row in 0..grid.rows {
        for column in 0..grid.columns {
            let place = LatLon {
                lat_deg: grid.row_lat_deg(row),
                lon_deg: grid.column_lon_deg(column),
            };
            let found = parts.iter().filter_map(|part| part.height_m(place));
            grid.heights_m[row * grid.columns + column] = single(found.fold(f64::NAN, f64::max));
        }
    }
    let before = grid.heights_m.clone();
    for part in parts {
        part.each(|place, height_m| {
            if let Some(short_m) = grid.height_m(place).map(|ground_m| height_m - ground_m)
                && short_m > 0.0
            {
                raise(&mut grid, place, short_m);
            }
        });
    }
    let raised = grid.heights_m.iter().zip(&before);
    let raised = raised.map(|(now, before)| f64::from(now - before));
    let raised_m = raised.filter(|by_m| by_m.is_finite()).fold(0.0, f64::max);
    let step_m = grid.row_step_deg * DEGREE_M;
    let error_m = parts.iter().map(|part| part.error_m(step_m / FINER));
    let error_m = error_m.fold(0.0, f64::max);
    for height_m in &mut grid.heights_m {
        *height_m += single(error_m);
    }
    grid.raised_m = raised_m + 2.0 * error_m;
    Ok(grid)
}

/// Raises the corners of the cell around a place.
fn raise(grid: &mut TerrainGrid, place: LatLon, by_m: f64) {
    let (row, column) = grid.row_column(place);
    let (Some((top, down)), Some((left, right))) = (cell(row), cell(column)) else {
        return;
    };
    for (row, share) in [(top, 1.0 - down), (top + 1, down)] {
        for (column, other) in [(left, 1.0 - right), (left + 1, right)] {
            if share * other > 0.0 && row < grid.rows && column < grid.columns {
                grid.heights_m[row * grid.columns + column] += single(by_m);
            }
        }
    }
}

/// A grid without heights over what the parts and the bounds have in common.
fn empty(parts: &[Part], bounds: Option<Bounds>) -> Result<TerrainGrid, TerrainError> {
    let nowhere = || TerrainError::Layout("pixels that are nowhere on earth".to_owned());
    let (mut extent, mut steps): (Option<Bounds>, _) = (None, (f64::INFINITY, f64::INFINITY));
    for part in parts {
        let own = part.nodes.extent().ok_or_else(nowhere)?;
        let within = bounds.map_or(own, |bounds| common(own, bounds));
        let (lat, lon) = part.nodes.steps_deg(within).ok_or_else(nowhere)?;
        steps = (steps.0.min(lat), steps.1.min(lon));
        extent = Some(extent.map_or(within, |known| both(known, within)));
    }
    let extent = extent.ok_or_else(nowhere)?;
    let (row_step_deg, column_step_deg) = (FINER * steps.0, FINER * steps.1);
    let (low, high) = (extent.south_west, extent.north_east);
    let nodes = |span_deg: f64, step_deg: f64| {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a cast of a float saturates"
        )]
        let count = (span_deg / step_deg).ceil() as usize;
        count.saturating_add(1).max(2)
    };
    let rows = nodes(high.lat_deg - low.lat_deg, row_step_deg);
    let columns = nodes(high.lon_deg - low.lon_deg, column_step_deg);
    match rows.saturating_mul(columns) {
        all if all > MAX_NODES => Err(TerrainError::TooLarge(all)),
        all => Ok(TerrainGrid {
            north_west: LatLon {
                lat_deg: high.lat_deg,
                lon_deg: low.lon_deg,
            },
            row_step_deg,
            column_step_deg,
            rows,
            columns,
            heights_m: vec![f32::NAN; all],
            raised_m: 0.0,
        }),
    }
}

fn common(one: Bounds, other: Bounds) -> Bounds {
    let pick = |a: LatLon, b: LatLon, of: fn(f64, f64) -> f64| LatLon {
        lat_deg: of(a.lat_deg, b.lat_deg),
        lon_deg: of(a.lon_deg, b.lon_deg),
    };
    Bounds {
        south_west: pick(one.south_west, other.south_west, f64::max),
        north_east: pick(one.north_east, other.north_east, f64::min),
    }
}

fn both(one: Bounds, other: Bounds) -> Bounds {
    let pick = |a: LatLon, b: LatLon, of: fn(f64, f64) -> f64| LatLon {
        lat_deg: of(a.lat_deg, b.lat_deg),
        lon_deg: of(a.lon_deg, b.lon_deg),
    };
    Bounds {
        south_west: pick(one.south_west, other.south_west, f64::min),
        north_east: pick(one.north_east, other.north_east, f64::max),
    }
}

/// Opens the elevation files of a folder that touch bounds.
pub(super) fn open_folder(
    folder: &Path,
    bounds: Option<Bounds>,
) -> Result<Vec<(String, Source)>, TerrainError> {
    let mut found = Vec::new();
    for name in mosaic::names(folder)? {
        let path = folder.join(&name);
        let source =
            Source::open(&path).map_err(|error| mosaic::in_file(&name_of(&path), error))?;
        if source.nodes().window(bounds).is_ok() {
            found.push((name, source));
        }
    }
    Ok(found)
}

/// A position no more than half a pixel outside, at the edge.
fn within(at: f64, nodes: usize) -> f64 {
    const HALF: f64 = 0.501;
    let last = count(nodes.saturating_sub(1));
    match at {
        _ if (-HALF..0.0).contains(&at) => 0.0,
        _ if at > last && at <= last + HALF => last,
        _ => at,
    }
}

/// The node before a position and the fraction after it; none before the first.
fn cell(at: f64) -> Option<(usize, f64)> {
    let near = at.round();
    let at = if (at - near).abs() < 1e-6 { near } else { at };
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "not negative; a cast of a float saturates"
    )]
    (at >= 0.0).then(|| (at.floor() as usize, at - at.floor()))
}

fn single(height_m: f64) -> f32 {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "heights need no more than f32"
    )]
    let height_m = height_m as f32;
    height_m
}

#[expect(
    clippy::cast_precision_loss,
    reason = "grids have far fewer than 2^52 rows"
)]
fn count(nodes: usize) -> f64 {
    nodes as f64
}

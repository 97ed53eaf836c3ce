//! Where the nodes of elevation files are.

use super::{Bounds, MAX_NODES, TerrainError};
use crate::geodesy::LatLon;
use crate::world::TerrainGrid;

/// Rows from north to south and columns from west to east, in the units of some system.
#[derive(Clone, Copy, Debug)]
pub(super) struct Raster {
    /// East and north of the first node.
    pub(super) first: (f64, f64),
    /// Between columns and rows, both positive.
    pub(super) step: (f64, f64),
    pub(super) rows: usize,
    pub(super) columns: usize,
}

/// The nodes of a file: where they are, before any height is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lattice {
    pub(super) north_west: LatLon,
    pub(super) row_step_deg: f64,
    pub(super) column_step_deg: f64,
    pub(super) rows: usize,
    pub(super) columns: usize,
}

/// A part of a [`Lattice`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Window {
    pub(super) first_row: usize,
    pub(super) rows: usize,
    pub(super) first_column: usize,
    pub(super) columns: usize,
}

impl Lattice {
    /// The nodes of a raster in degrees.
    ///
    /// # Errors
    /// Nodes that are nowhere on earth.
    pub(super) fn on_earth(raster: Raster) -> Result<Self, TerrainError> {
        let Raster { rows, columns, .. } = raster;
        let (mut lon_deg, lat_deg) = raster.first;
        let (column_step_deg, row_step_deg) = raster.step;
        if lon_deg >= 180.0 {
            lon_deg -= 360.0;
        }
        let south_deg = lat_deg - count(rows - 1) * row_step_deg;
        let width_deg = count(columns - 1) * column_step_deg;
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
        Ok(Self {
            north_west: LatLon { lat_deg, lon_deg },
            row_step_deg,
            column_step_deg,
            rows,
            columns,
        })
    }

    /// All nodes.
    pub(super) fn whole(&self) -> Window {
        Window {
            first_row: 0,
            rows: self.rows,
            first_column: 0,
            columns: self.columns,
        }
    }

    /// The nodes within `bounds` and the next one outside on each side; all of them
    /// without; `None` if there are not two in each direction.
    pub(super) fn cut(&self, bounds: Option<Bounds>) -> Option<Window> {
        let Some(Bounds {
            south_west,
            north_east,
        }) = bounds
        else {
            return Some(self.whole());
        };
        let row = |lat_deg: f64| (self.north_west.lat_deg - lat_deg) / self.row_step_deg;
        let column = |lon_deg: f64| (lon_deg - self.north_west.lon_deg) / self.column_step_deg;
        let rows = cut(row(north_east.lat_deg), row(south_west.lat_deg), self.rows)?;
        let (west, east) = (column(south_west.lon_deg), column(north_east.lon_deg));
        let columns = cut(west, east, self.columns)?;
        Some(Window {
            first_row: rows.0,
            rows: rows.1 - rows.0,
            first_column: columns.0,
            columns: columns.1 - columns.0,
        })
    }

    /// The same, as far as memory allows.
    pub(super) fn window(&self, bounds: Option<Bounds>) -> Result<Window, TerrainError> {
        let window = self.cut(bounds).ok_or_else(|| {
            let south_east = self.node(self.rows - 1, self.columns - 1);
            TerrainError::ReturnTargets {
                south: south_east.lat_deg,
                north: self.north_west.lat_deg,
                west: self.north_west.lon_deg,
                east: south_east.lon_deg,
            }
        })?;
        match window.rows.saturating_mul(window.columns) {
            nodes if nodes > MAX_NODES => Err(TerrainError::TooLarge(nodes)),
            _ => Ok(window),
        }
    }

    pub(super) fn node(&self, row: usize, column: usize) -> LatLon {
        LatLon {
            lat_deg: self.north_west.lat_deg - count(row) * self.row_step_deg,
            lon_deg: self.north_west.lon_deg + count(column) * self.column_step_deg,
        }
    }

    /// The grid of a window and its heights, row by row.
    pub(super) fn grid(&self, window: Window, heights_m: Vec<f32>) -> TerrainGrid {
        TerrainGrid {
            north_west: self.node(window.first_row, window.first_column),
            row_step_deg: self.row_step_deg,
            column_step_deg: self.column_step_deg,
            rows: window.rows,
            columns: window.columns,
            heights_m,
            raised_m: 0.0,
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

#[expect(
    clippy::cast_precision_loss,
    reason = "grids have far fewer than 2^52 rows"
)]
fn count(nodes: usize) -> f64 {
    nodes as f64
}

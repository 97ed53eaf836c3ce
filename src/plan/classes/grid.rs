//! A grid over part of the plane.

use crate::geodesy::EastNorth;

/// A regular grid of square cells over part of the plane.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Grid {
    pub south_west: EastNorth,
    pub spacing_m: f64,
    pub columns: usize,
    pub rows: usize,
}

impl Grid {
    /// A grid over a box with `nodes` along its longer side; along the other it ends within half a cell of the rim.
    pub(crate) fn over(south_west: EastNorth, north_east: EastNorth, nodes: usize) -> Self {
        let width_m = north_east.east_m - south_west.east_m;
        let height_m = north_east.north_m - south_west.north_m;
        #[expect(clippy::cast_precision_loss, reason = "hundreds of nodes")]
        let spacing_m = (width_m.max(height_m) / (nodes - 1) as f64).max(1e-3);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "at most nodes, by the choice of the spacing"
        )]
        let count = |length_m: f64| ((length_m / spacing_m).round() as usize).max(1) + 1;
        Self {
            south_west,
            spacing_m,
            columns: count(width_m),
            rows: count(height_m),
        }
    }

    /// Number of nodes.
    pub(crate) fn len(&self) -> usize {
        self.columns * self.rows
    }

    /// Column and row of a node.
    pub(crate) fn column_row(&self, node: usize) -> (usize, usize) {
        (node % self.columns, node / self.columns)
    }

    /// Where a node lies.
    pub(crate) fn at(&self, node: usize) -> EastNorth {
        let (column, row) = self.column_row(node);
        #[expect(clippy::cast_precision_loss, reason = "hundreds of nodes")]
        let (column, row) = (column as f64, row as f64);
        EastNorth {
            east_m: self.south_west.east_m + column * self.spacing_m,
            north_m: self.south_west.north_m + row * self.spacing_m,
        }
    }

    /// The node nearest to a place; places outside take the edge.
    pub(crate) fn nearest(&self, at: EastNorth) -> usize {
        let index = |offset_m: f64, count: usize| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                clippy::cast_precision_loss,
                reason = "clamped to the grid"
            )]
            let index = (offset_m / self.spacing_m)
                .round()
                .clamp(0.0, (count - 1) as f64) as usize;
            index
        };
        index(at.north_m - self.south_west.north_m, self.rows) * self.columns
            + index(at.east_m - self.south_west.east_m, self.columns)
    }

    /// Whether the edge is nearer than `nodes` nodes in some direction.
    pub(crate) fn is_near_edge(&self, node: usize, nodes: usize) -> bool {
        let (column, row) = self.column_row(node);
        column.min(row) < nodes || column + nodes >= self.columns || row + nodes >= self.rows
    }

    /// The node some columns and rows away, if there is one.
    pub(crate) fn step(&self, node: usize, (columns, rows): (isize, isize)) -> Option<usize> {
        let (column, row) = self.column_row(node);
        let column = column.checked_add_signed(columns)?;
        let row = row.checked_add_signed(rows)?;
        (column < self.columns && row < self.rows).then_some(row * self.columns + column)
    }
}

//! Grids in the plane of a map projection.

use super::{Bounds, TerrainError, Window};
use crate::geodesy::{LatLon, Projection};

/// Points on each side of an outline that is projected.
const OUTLINE_POINTS: u32 = 24;

/// The nodes of a file in a plane: rows go south, columns east.
#[derive(Clone, Debug)]
pub(super) struct PlaneLattice {
    pub(super) projection: Projection,
    /// East and north of the first node, in the units of the system.
    pub(super) first: (f64, f64),
    /// Between columns and rows, both positive.
    pub(super) step: (f64, f64),
    pub(super) rows: usize,
    pub(super) columns: usize,
}

impl PlaneLattice {
    /// The place of a node, or of a point between nodes.
    pub(super) fn place(&self, row: f64, column: f64) -> Option<LatLon> {
        let (east, north) = (
            self.first.0 + column * self.step.0,
            self.first.1 - row * self.step.1,
        );
        self.projection.to_lat_lon(east, north)
    }

    /// Row and column of a place, with fractions.
    pub(super) fn row_column(&self, place: LatLon) -> Option<(f64, f64)> {
        let (east, north) = self.projection.from_lat_lon(place)?;
        Some((
            (self.first.1 - north) / self.step.1,
            (east - self.first.0) / self.step.0,
        ))
    }

    /// The part of the earth that it covers.
    pub(super) fn extent(&self) -> Option<Bounds> {
        let (last_row, last_column) = (count(self.rows - 1), count(self.columns - 1));
        around(outline().filter_map(|(x, y)| {
            self.place(y * last_row, x * last_column)
                .map(|place| (place.lat_deg, place.lon_deg))
        }))
        .map(|(south, north, west, east)| Bounds {
            south_west: LatLon {
                lat_deg: south,
                lon_deg: west,
            },
            north_east: LatLon {
                lat_deg: north,
                lon_deg: east,
            },
        })
    }

    /// The nodes within bounds and two more on each side; all of them without bounds.
    pub(super) fn window(&self, bounds: Option<Bounds>) -> Result<Window, TerrainError> {
        let whole = Window {
            first_row: 0,
            rows: self.rows,
            first_column: 0,
            columns: self.columns,
        };
        let Some(Bounds {
            south_west,
            north_east,
        }) = bounds
        else {
            return Ok(whole);
        };
        let corners = outline().filter_map(|(x, y)| {
            let mix = |from: f64, to: f64, share: f64| from + (to - from) * share;
            self.row_column(LatLon {
                lat_deg: mix(south_west.lat_deg, north_east.lat_deg, y),
                lon_deg: mix(south_west.lon_deg, north_east.lon_deg, x),
            })
        });
        let cut = around(corners).and_then(|(top, bottom, left, right)| {
            let (first_row, rows) = span(top, bottom, self.rows)?;
            let (first_column, columns) = span(left, right, self.columns)?;
            Some(Window {
                first_row,
                rows,
                first_column,
                columns,
            })
        });
        cut.ok_or_else(|| match self.extent() {
            Some(extent) => TerrainError::ReturnTargets {
                south: extent.south_west.lat_deg,
                north: extent.north_east.lat_deg,
                west: extent.south_west.lon_deg,
                east: extent.north_east.lon_deg,
            },
            None => TerrainError::Layout("pixels that are nowhere on earth".to_owned()),
        })
    }
}

/// Points along the edge of the unit square.
fn outline() -> impl Iterator<Item = (f64, f64)> {
    (0..OUTLINE_POINTS).flat_map(|index| {
        let share = f64::from(index) / f64::from(OUTLINE_POINTS);
        [
            (share, 0.0),
            (1.0, share),
            (1.0 - share, 1.0),
            (0.0, 1.0 - share),
        ]
    })
}

/// Least and greatest of the first and of the second numbers.
fn around(points: impl Iterator<Item = (f64, f64)>) -> Option<(f64, f64, f64, f64)> {
    let none = (
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::INFINITY,
        f64::NEG_INFINITY,
    );
    let all = points.fold(none, |all, (a, b)| {
        (all.0.min(a), all.1.max(a), all.2.min(b), all.3.max(b))
    });
    all.0.is_finite().then_some(all)
}

/// First and number of the nodes from one to another, two more on each side.
fn span(from: f64, to: f64, nodes: usize) -> Option<(usize, usize)> {
    let last = count(nodes.checked_sub(1)?);
    if from > last || to < 0.0 || nodes < 2 {
        return None;
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped"
    )]
    let (first, end) = (
        (from.floor() - 2.0).clamp(0.0, last - 1.0) as usize,
        (to.ceil() + 2.0).clamp(1.0, last) as usize,
    );
    Some((first, end.max(first + 1) + 1 - first))
}

#[expect(
    clippy::cast_precision_loss,
    reason = "grids have far fewer than 2^52 rows"
)]
fn count(nodes: usize) -> f64 {
    nodes as f64
}

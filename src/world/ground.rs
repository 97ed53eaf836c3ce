//! The ground as the search reads it: a regular grid in planning coordinates.

use geo::{BoundingRect, Polygon};
use rayon::prelude::*;

use super::Terrain;
use super::mounds::Mounds;
use crate::geodesy::{EastNorth, LocalFrame, METRES_PER_DEG};

/// Heights at the nodes of a square grid, row by row from the south-west.
///
/// Resampled once from the [`Terrain`], so that the search neither converts
/// coordinates nor misses the cache; the verdict never reads it. Where the
/// source has no data the height is NaN.
#[derive(Clone, Debug, PartialEq)]
pub struct Ground {
    /// The first node.
    pub south_west: EastNorth,
    /// Distance between nodes, metres.
    pub spacing_m: f64,
    /// Nodes from west to east.
    pub columns: usize,
    /// Nodes from south to north.
    pub rows: usize,
    /// Heights above mean sea level, metres.
    pub heights_m: Vec<f32>,
}

/// How much finer than its source a grid is that has voids.
const VOID_FINER: f64 = 4.0;
/// Spacings of a hill that is not too narrow for a grid, and how much coarser than its source
/// a grid may be.
const SHOWN: f64 = 2.0;
/// Most nodes along one side; keeps the grid within 4 MiB.
const MAX_NODES: f64 = 1024.0;

impl Ground {
    /// Samples the terrain over the bounding box of the area.
    #[must_use]
    pub fn sample(terrain: &Terrain, frame: &LocalFrame, area: &Polygon<f64>) -> Self {
        let desired_m = source_spacing_m(terrain);
        let mounds = Mounds::new(terrain, frame, grid_spacing_m(area, desired_m));
        let terrain = mounds.as_ref().map_or(terrain, |mounds| &mounds.wide);
        let mut ground = Self::sample_by(area, desired_m, |at| node_m(terrain, frame, at));
        if let Some(mounds) = &mounds {
            mounds.raise(&mut ground);
        }
        ground
    }

    /// Samples a height (metres) over the bounding box of an area, at about a spacing
    /// as far as the grid allows.
    #[must_use]
    pub fn sample_by(
        area: &Polygon<f64>,
        spacing_m: f64,
        node_m: impl Fn(EastNorth) -> f32 + Sync,
    ) -> Self {
        let (min, max) = corners(area);
        let (width_m, height_m) = (max.0 - min.0, max.1 - min.1);
        let spacing_m = grid_spacing_m(area, spacing_m);
        let nodes = |length_m: f64| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "at most MAX_NODES + 1"
            )]
            let count = (length_m / spacing_m).ceil().clamp(1.0, MAX_NODES) as usize + 1;
            count
        };
        let (columns, rows) = (nodes(width_m), nodes(height_m));
        let south_west = EastNorth {
            east_m: min.0,
            north_m: min.1,
        };
        // In parallel by rows, collected in order: the same grid on any number of threads.
        let heights_m: Vec<Vec<f32>> = (0..rows)
            .into_par_iter()
            .map(|row| {
                (0..columns)
                    .map(|column| {
                        let at = EastNorth {
                            east_m: south_west.east_m + count(column) * spacing_m,
                            north_m: south_west.north_m + count(row) * spacing_m,
                        };
                        node_m(at)
                    })
                    .collect()
            })
            .collect();
        Self {
            south_west,
            spacing_m,
            columns,
            rows,
            heights_m: heights_m.concat(),
        }
    }

    /// The same with each void wider by a node on all sides; none if there are no voids.
    #[must_use]
    pub fn with_wider_voids(&self) -> Option<Self> {
        let is_void = |node: &usize| self.heights_m[*node].is_nan();
        let voids: Vec<usize> = (0..self.heights_m.len()).filter(is_void).collect();
        if voids.is_empty() {
            return None;
        }
        let mut wider = self.clone();
        let near = |at: usize, count: usize| at.saturating_sub(1)..(at + 2).min(count);
        for node in voids {
            for row in near(node / self.columns, self.rows) {
                for column in near(node % self.columns, self.columns) {
                    wider.heights_m[row * self.columns + column] = f32::NAN;
                }
            }
        }
        Some(wider)
    }

    /// Whether it resolves its source: no feature of that is narrower than its cells.
    #[must_use]
    pub fn shows(&self, terrain: &Terrain) -> bool {
        match terrain {
            Terrain::Flat(_) | Terrain::Unknown => true,
            Terrain::Analytic { hills, .. } => hills
                .iter()
                .all(|hill| hill.radius_m >= SHOWN * self.spacing_m),
            Terrain::Grid(_) => self.spacing_m < SHOWN * source_spacing_m(terrain),
        }
    }

    /// Where a node is.
    pub(super) fn node(&self, row: usize, column: usize) -> EastNorth {
        EastNorth {
            east_m: self.south_west.east_m + count(column) * self.spacing_m,
            north_m: self.south_west.north_m + count(row) * self.spacing_m,
        }
    }

    /// The least and the greatest height in a box, metres; infinite where there is a void in it.
    pub(super) fn range_m(&self, south_west: EastNorth, north_east: EastNorth) -> (f64, f64) {
        let cells = |from: f64, count: usize| cell(from / self.spacing_m, count).0;
        let columns = |at: EastNorth| cells(at.east_m - self.south_west.east_m, self.columns);
        let rows = |at: EastNorth| cells(at.north_m - self.south_west.north_m, self.rows);
        let mut range_m = (f64::INFINITY, f64::NEG_INFINITY);
        for row in rows(south_west)..=rows(north_east) + 1 {
            for column in columns(south_west)..=columns(north_east) + 1 {
                let height_m = f64::from(self.heights_m[row * self.columns + column]);
                if height_m.is_nan() {
                    return (f64::NEG_INFINITY, f64::INFINITY);
                }
                range_m = (range_m.0.min(height_m), range_m.1.max(height_m));
            }
        }
        range_m
    }

    /// Bilinear height above mean sea level, metres; places outside take the
    /// edge; NaN in a cell with a void.
    #[must_use]
    pub fn height_m(&self, at: EastNorth) -> f64 {
        let (column, right) = cell(
            (at.east_m - self.south_west.east_m) / self.spacing_m,
            self.columns,
        );
        let (row, up) = cell(
            (at.north_m - self.south_west.north_m) / self.spacing_m,
            self.rows,
        );
        let corner = row * self.columns + column;
        let node = |index: usize| f64::from(self.heights_m[index]);
        let south = node(corner) + (node(corner + 1) - node(corner)) * right;
        let north = node(corner + self.columns)
            + (node(corner + self.columns + 1) - node(corner + self.columns)) * right;
        south + (north - south) * up
    }
}

/// South-west and north-east corner of the bounding box of an area, metres.
fn corners(area: &Polygon<f64>) -> ((f64, f64), (f64, f64)) {
    area.bounding_rect()
        .map_or(((0.0, 0.0), (1.0, 1.0)), |rect| {
            (rect.min().x_y(), rect.max().x_y())
        })
}

/// The spacing of a grid over an area, nearest to a desired one, metres.
fn grid_spacing_m(area: &Polygon<f64>, desired_m: f64) -> f64 {
    let (min, max) = corners(area);
    let side_m = (max.0 - min.0).max(max.1 - min.1);
    let finest_m = side_m / (MAX_NODES - 1.0);
    desired_m.min(side_m).max(finest_m).max(1.0)
}

/// The height that the source has at a node; NaN where it has none.
fn node_m(terrain: &Terrain, frame: &LocalFrame, at: EastNorth) -> f32 {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "heights need no more than f32"
    )]
    terrain
        .height_at(frame, at)
        .map_or(f32::NAN, |amsl| amsl.0 as f32)
}

/// A number of nodes as a number.
#[expect(clippy::cast_precision_loss, reason = "at most MAX_NODES + 1")]
fn count(nodes: usize) -> f64 {
    nodes as f64
}

/// The cell index and the fraction within it, clamped to the grid.
fn cell(at: f64, nodes: usize) -> (usize, f64) {
    let at = at.clamp(0.0, count(nodes - 1));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the grid"
    )]
    let index = (at.floor() as usize).min(nodes - 2);
    (index, at - count(index))
}

/// The spacing of the source: a finer grid holds no more information, metres.
fn source_spacing_m(terrain: &Terrain) -> f64 {
    match terrain {
        Terrain::Flat(_) | Terrain::Unknown => f64::INFINITY,
        Terrain::Analytic { hills, .. } => hills
            .iter()
            .map(|hill| hill.radius_m / 16.0)
            .fold(f64::INFINITY, f64::min),
        Terrain::Grid(grid) => {
            let parallel = grid.north_west.lat_deg.to_radians().cos().max(0.01);
            let step_m = grid.row_step_deg.min(grid.column_step_deg * parallel) * METRES_PER_DEG;
            // A node in a void leaves all cells around it without data: smaller ones, less.
            match grid.heights_m.iter().any(|height_m| height_m.is_nan()) {
                true => step_m / VOID_FINER,
                false => step_m,
            }
        }
    }
}

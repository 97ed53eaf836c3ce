//! Terrain as its source has it, in geodetic coordinates.

use crate::geodesy::{Amsl, EastNorth, LatLon, LocalFrame, METRES_PER_DEG};
use crate::spec::Hill;

/// There is no elevation at a place: never taken for 0.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("no elevation data at {:.6}, {:.6}", place.lat_deg, place.lon_deg)]
pub struct NoData {
    /// Where.
    pub place: LatLon,
}

/// The ground.
#[derive(Clone, Debug, PartialEq)]
pub enum Terrain {
    /// The same height everywhere.
    Flat(Amsl),
    /// Gaussian hills over a base.
    Analytic {
        /// Height far from every hill.
        base: Amsl,
        /// The hills.
        hills: Vec<Hill>,
    },
    /// A grid of latitude and longitude.
    Grid(TerrainGrid),
    /// No elevation at all: whatever needs the ground cannot be known.
    Unknown,
}

/// Heights at the nodes of a regular grid of latitude and longitude.
#[derive(Clone, Debug, PartialEq)]
pub struct TerrainGrid {
    /// The first node: the north-west corner.
    pub north_west: LatLon,
    /// Degrees of latitude between rows, positive; rows go south.
    pub row_step_deg: f64,
    /// Degrees of longitude between columns, positive; columns go east.
    pub column_step_deg: f64,
    /// Number of rows, at least 2.
    pub rows: usize,
    /// Number of columns, at least 2.
    pub columns: usize,
    /// Heights above mean sea level, metres, row by row; NaN where there is no data.
    pub heights_m: Vec<f32>,
    /// How far a height may be above the ground, metres: what files of other projections or spacings
    /// were raised by, and what is uncertain of them; 0 for nodes as a file has them.
    pub raised_m: f64,
}

impl Terrain {
    /// How far a height may be above the ground, metres: see [`TerrainGrid::raised_m`].
    #[must_use]
    pub fn raised_m(&self) -> f64 {
        match self {
            Self::Grid(grid) => grid.raised_m,
            Self::Flat(_) | Self::Analytic { .. } | Self::Unknown => 0.0,
        }
    }

    /// The height of the ground at a place.
    ///
    /// # Errors
    /// [`NoData`] outside of the grid and in a cell with a void corner.
    pub fn height(&self, place: LatLon) -> Result<Amsl, NoData> {
        match self {
            Self::Flat(amsl) => Ok(*amsl),
            Self::Analytic { base, hills } => Ok(Amsl(
                base.0
                    + hills
                        .iter()
                        .map(|hill| hill_height_m(hill, place))
                        .sum::<f64>(),
            )),
            Self::Grid(grid) => grid.height_m(place).map(Amsl).ok_or(NoData { place }),
            Self::Unknown => Err(NoData { place }),
        }
    }

    /// The height of the ground at planning coordinates. Over flat ground no latitude and longitude is computed.
    ///
    /// # Errors
    /// Those of [`height`](Self::height).
    pub fn height_at(&self, frame: &LocalFrame, at: EastNorth) -> Result<Amsl, NoData> {
        match self {
            Self::Flat(amsl) => Ok(*amsl),
            _ => self.height(frame.from_plan(at)),
        }
    }
}

/// Height of a Gaussian hill; distances on the sphere of mean radius are good enough for a shape.
fn hill_height_m(hill: &Hill, place: LatLon) -> f64 {
    // From here on `exp` is 0 itself: most of a thousand hills need no more than this.
    const NOTHING_SQ: f64 = 746.0;
    let north_m = (place.lat_deg - hill.place.lat_deg) * METRES_PER_DEG;
    if north_m * north_m > NOTHING_SQ * hill.radius_m * hill.radius_m {
        return 0.0;
    }
    let east_m = (place.lon_deg - hill.place.lon_deg)
        * METRES_PER_DEG
        * hill.place.lat_deg.to_radians().cos();
    let distance_sq = (north_m * north_m + east_m * east_m) / (hill.radius_m * hill.radius_m);
    hill.height_m * (-distance_sq).exp()
}

impl TerrainGrid {
    /// Latitude of a row of nodes, degrees.
    #[must_use]
    pub fn row_lat_deg(&self, row: usize) -> f64 {
        self.north_west.lat_deg - count(row) * self.row_step_deg
    }

    /// Longitude of a column of nodes, degrees.
    #[must_use]
    pub fn column_lon_deg(&self, column: usize) -> f64 {
        self.north_west.lon_deg + count(column) * self.column_step_deg
    }

    /// Row and column of a place, both with a fraction, 0 at the north-west node;
    /// beyond the grid they go on below 0 and above the last node.
    #[must_use]
    pub fn row_column(&self, place: LatLon) -> (f64, f64) {
        (
            (self.north_west.lat_deg - place.lat_deg) / self.row_step_deg,
            (place.lon_deg - self.north_west.lon_deg) / self.column_step_deg,
        )
    }

    /// Height at a node, metres; `None` outside and where there is no data.
    #[must_use]
    pub fn node_m(&self, row: usize, column: usize) -> Option<f64> {
        if column >= self.columns {
            return None;
        }
        let height_m = f64::from(*self.heights_m.get(row * self.columns + column)?);
        height_m.is_finite().then_some(height_m)
    }

    /// Heights at the corners of the cell south and east of a node, metres:
    /// north-west, north-east, south-west, south-east. Within the cell the height is
    /// bilinear, so it lies between the least and the greatest of them.
    #[must_use]
    pub fn cell_m(&self, row: usize, column: usize) -> Option<[f64; 4]> {
        Some([
            self.node_m(row, column)?,
            self.node_m(row, column + 1)?,
            self.node_m(row + 1, column)?,
            self.node_m(row + 1, column + 1)?,
        ])
    }

    /// Bilinear height at a place, metres; `None` outside and in a cell with a void.
    #[must_use]
    pub fn height_m(&self, place: LatLon) -> Option<f64> {
        let (row, column) = self.row_column(place);
        let (top, down) = cell(row, self.rows)?;
        let (left, right) = cell(column, self.columns)?;
        let node = |r: usize, c: usize| f64::from(self.heights_m[r * self.columns + c]);
        // A neighbour of weight 0 is not read, so that a node next to a void still counts.
        let mix = |r: usize| {
            if right > 0.0 {
                node(r, left) * (1.0 - right) + node(r, left + 1) * right
            } else {
                node(r, left)
            }
        };
        let height = if down > 0.0 {
            mix(top) * (1.0 - down) + mix(top + 1) * down
        } else {
            mix(top)
        };
        height.is_finite().then_some(height)
    }
}

/// The cell index and the fraction within it; `None` outside of `nodes` nodes.
fn cell(at: f64, nodes: usize) -> Option<(usize, f64)> {
    // Rounding: a position on the edge is inside.
    let last = f64::from(u32::try_from(nodes.checked_sub(1)?).ok()?);
    if !(-1e-9..=last + 1e-9).contains(&at) {
        return None;
    }
    // A position this near to a node is on it, so that rounding reads no void.
    let near = at.round();
    let at = if (at - near).abs() < 1e-9 { near } else { at };
    let at = at.clamp(0.0, last);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the grid"
    )]
    let index = (at.floor() as usize).min(nodes - 1);
    Some((index, at - count(index)))
}

/// A row or column as a number.
#[expect(
    clippy::cast_precision_loss,
    reason = "grids have far fewer than 2^52 rows"
)]
fn count(index: usize) -> f64 {
    index as f64
}

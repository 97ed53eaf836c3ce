//! The ground as the objective reads it.

use std::sync::Arc;

use fearless_simd::{Level, dispatch, prelude::*};

use super::kernel::lanes::{V, Wide, load, splat};
use crate::numeric::order::{larger, smaller};
use crate::world::Ground;

/// The ground grid with what a lookup needs at hand.
#[derive(Clone, Debug)]
pub struct Relief {
    west_m: f64,
    south_m: f64,
    per_metre: f64,
    last_column: f64,
    last_row: f64,
    columns: u32,
    ground: Arc<Ground>,
    /// Taken for the height where there is no data.
    wall_m: f64,
}

impl Relief {
    /// The ground with a height that stands for missing data.
    #[must_use]
    pub fn new(ground: &Arc<Ground>, wall_m: f64) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "a grid has few rows")]
        let last = |nodes: usize| nodes.saturating_sub(1) as f64;
        Self {
            west_m: ground.south_west.east_m,
            south_m: ground.south_west.north_m,
            per_metre: 1.0 / ground.spacing_m,
            last_column: last(ground.columns),
            last_row: last(ground.rows),
            // A grid has far fewer than 2^32 columns.
            columns: u32::try_from(ground.columns).unwrap_or(u32::MAX),
            ground: Arc::clone(ground),
            wall_m,
        }
    }

    /// Nodes in a metre.
    pub(crate) fn per_metre(&self) -> f64 {
        self.per_metre
    }

    /// Heights above mean sea level at many places, metres: as [`Ground::height_m`] but
    /// for voids.
    pub fn read(&self, east_m: &[f64], north_m: &[f64], heights_m: &mut Vec<f64>) {
        heights_m.resize(east_m.len().min(north_m.len()), 0.0);
        dispatch!(Level::new(), simd => self.read_by(simd, east_m, north_m, heights_m));
    }

    #[inline(always)]
    fn read_by<S: Simd>(&self, simd: S, east_m: &[f64], north_m: &[f64], heights_m: &mut [f64]) {
        let (lanes, wide) = (V::<S>::LEN, self.lanes(simd));
        let positions = east_m.chunks(lanes).zip(north_m.chunks(lanes));
        for ((east_m, north_m), heights_m) in positions.zip(heights_m.chunks_mut(lanes)) {
            if heights_m.len() == lanes {
                let (east_m, north_m) = (
                    V::<S>::from_slice(simd, east_m),
                    V::<S>::from_slice(simd, north_m),
                );
                wide.heights_m(east_m, north_m).store_slice(heights_m);
            } else {
                let positions = east_m.iter().zip(north_m);
                for (height_m, (east_m, north_m)) in heights_m.iter_mut().zip(positions) {
                    *height_m = self.height_m(*east_m, *north_m);
                }
            }
        }
    }

    /// Bilinear height above mean sea level, metres, as [`Ground::height_m`],
    /// but the wall beside voids.
    #[inline]
    pub(crate) fn height_m(&self, east_m: f64, north_m: f64) -> f64 {
        let (column, right) = cell((east_m - self.west_m) * self.per_metre, self.last_column);
        let (row, up) = cell((north_m - self.south_m) * self.per_metre, self.last_row);
        let columns = self.columns as usize;
        let corner = row * columns + column;
        let node = |index: usize| f64::from(self.ground.heights_m[index]);
        let (south_west, south_east) = (node(corner), node(corner + 1));
        let (north_west, north_east) = (node(corner + columns), node(corner + columns + 1));
        let south = south_west + (south_east - south_west) * right;
        let north = north_west + (north_east - north_west) * right;
        let height_m = south + (north - south) * up;
        if height_m.is_nan() {
            self.wall_m
        } else {
            height_m
        }
    }
}

/// [`Relief`] with its numbers in every lane, at hand for a loop.
#[derive(Clone, Copy)]
pub(crate) struct ReliefLanes<'a, S: Simd> {
    simd: S,
    west_m: V<S>,
    south_m: V<S>,
    per_metre: V<S>,
    /// Last column and row, and one less.
    last: [V<S>; 2],
    last_cell: [V<S>; 2],
    wide: V<S>,
    wall_m: V<S>,
    /// The heights but for the last row, and but for the first: as many, so that bounds are
    /// looked at once for both.
    south: &'a [f32],
    north: &'a [f32],
}

impl Relief {
    /// The same in every lane.
    #[inline(always)]
    pub(crate) fn lanes<S: Simd>(&self, simd: S) -> ReliefLanes<'_, S> {
        let last = [self.last_column, self.last_row];
        let (_, north) = self.ground.heights_m.split_at(self.columns as usize);
        ReliefLanes {
            simd,
            west_m: splat(simd, self.west_m),
            south_m: splat(simd, self.south_m),
            per_metre: splat(simd, self.per_metre),
            last: [splat(simd, last[0]), splat(simd, last[1])],
            last_cell: [splat(simd, last[0] - 1.0), splat(simd, last[1] - 1.0)],
            wide: splat(simd, f64::from(self.columns)),
            wall_m: splat(simd, self.wall_m),
            south: &self.ground.heights_m[..north.len()],
            north,
        }
    }
}

/// Where in the grid places lie: the node in the south-west of the cell of every lane, to
/// whose index [`ROUND`] is added, and the fractions within the cell.
#[derive(Clone, Copy)]
pub(crate) struct CellLanes<S: Simd> {
    node: V<S>,
    right: V<S>,
    up: V<S>,
}

impl<S: Simd> CellLanes<S> {
    /// The first cell of the grid.
    #[inline(always)]
    pub(crate) fn first(simd: S) -> Self {
        Self {
            node: splat(simd, ROUND),
            right: splat(simd, 0.0),
            up: splat(simd, 0.0),
        }
    }
}

impl<S: Simd> ReliefLanes<'_, S> {
    /// [`Relief::height_m`] in every lane.
    #[inline(always)]
    pub(crate) fn heights_m(&self, east_m: V<S>, north_m: V<S>) -> V<S> {
        let cell = self.cell(east_m, north_m);
        let mut corners = Corners::default();
        self.fetch(&cell, &mut corners);
        self.heights_in(&cell, &corners)
    }

    /// The cells of places.
    #[inline(always)]
    pub(crate) fn cell(&self, east_m: V<S>, north_m: V<S>) -> CellLanes<S> {
        let (column, right) = self.cells((east_m - self.west_m) * self.per_metre, 0);
        let (row, up) = self.cells((north_m - self.south_m) * self.per_metre, 1);
        // Whole numbers far below 2^52: exact, and the low bits are the index.
        let node = (row - ROUND) * self.wide + column;
        CellLanes { node, right, up }
    }

    /// Reads the heights at the corners of cells.
    #[inline(always)]
    pub(crate) fn fetch(&self, cell: &CellLanes<S>, to: &mut Corners) {
        for (lane, node) in cell.node.as_slice().iter().enumerate() {
            let west = low_bits(*node);
            let (south, north) = (&self.south[west..west + 2], &self.north[west..west + 2]);
            to.south[lane] = side_by_side(south[0], south[1]);
            to.north[lane] = side_by_side(north[0], north[1]);
        }
    }

    /// The heights at places in cells with these corners, metres.
    #[inline(always)]
    pub(crate) fn heights_in(&self, cell: &CellLanes<S>, corners: &Corners) -> V<S> {
        let row = |row: &Wide| load(self.simd, row).bitcast::<S::f32s>();
        let (west, east) = row(&corners.south).deinterleave(row(&corners.north));
        let ((south_west, north_west), (south_east, north_east)) = (west.widen(), east.widen());
        let south = south_west + (south_east - south_west) * cell.right;
        let north = north_west + (north_east - north_west) * cell.right;
        let height_m = south + (north - south) * cell.up;
        height_m.is_nan().select(self.wall_m, height_m)
    }

    /// [`cell`] along an axis, the index with [`ROUND`] added.
    #[inline(always)]
    fn cells(&self, at: V<S>, axis: usize) -> (V<S>, V<S>) {
        let at = at.max(0.0).min(self.last[axis]);
        let shifted = (at - 0.5).min(self.last_cell[axis]) + ROUND;
        (shifted, at - (shifted - ROUND))
    }
}

/// Heights at the corners of a cell of every lane, south-west beside south-east, and
/// north-west beside north-east: two in the bits of one number.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Corners {
    south: Wide,
    north: Wide,
}

/// Two numbers in the bits of one, which is how both are loaded at once.
#[inline(always)]
fn side_by_side(west: f32, east: f32) -> f64 {
    f64::from_bits(u64::from(west.to_bits()) | u64::from(east.to_bits()) << 32)
}

/// The whole number that was added to [`ROUND`].
#[inline(always)]
fn low_bits(shifted: f64) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the low bits are the index, far below 2^32"
    )]
    let index = shifted.to_bits() as u32;
    index as usize
}

/// 1.5 * 2^52. Added to a number between -1/2 and 2^32, it leaves the nearest
/// integer in the low bits.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// The cell index and the fraction within it, clamped to the grid.
///
/// Rounds `at - 1/2` instead of taking the floor of `at`: the cell may be the
/// lower neighbour of a node, with fraction 1, where both give the same height.
#[inline]
fn cell(at: f64, last: f64) -> (usize, f64) {
    let at = smaller(larger(at, 0.0), last);
    let shifted = smaller(at - 0.5, last - 1.0) + ROUND;
    (low_bits(shifted), at - (shifted - ROUND))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::Relief;
    use crate::geodesy::EastNorth;
    use crate::world::Ground;
    use proptest::prelude::*;

    fn ground(heights_m: Vec<f32>) -> Arc<Ground> {
        Arc::new(Ground {
            south_west: EastNorth {
                east_m: -100.0,
                north_m: 50.0,
            },
            spacing_m: 80.0,
            columns: 5,
            rows: 4,
            heights_m,
        })
    }

    proptest! {
        #[test]
        fn heights_are_those_of_the_ground_also_on_nodes_and_outside(
            heights in prop::collection::vec(0.0..3000.0_f32, 20),
            east_m in prop_oneof![-200.0..400.0_f64, (0..6_i32).prop_map(|i| f64::from(i) * 80.0 - 100.0)],
            north_m in prop_oneof![-100.0..400.0_f64, (0..5_i32).prop_map(|i| f64::from(i) * 80.0 + 50.0)],
        ) {
            let ground = ground(heights);
            let relief = Relief::new(&ground, 6000.0);
            let expected = ground.height_m(EastNorth { east_m, north_m });
            prop_assert!((relief.height_m(east_m, north_m) - expected).abs() < 1e-6);
        }
    }

    #[test]
    fn next_to_a_void_the_ground_is_a_wall() {
        let mut heights = vec![10.0; 20];
        heights[6] = f32::NAN;
        let relief = Relief::new(&ground(heights), 6000.0);
        assert!(relief.height_m(-60.0, 90.0) > 5000.0);
        assert!((relief.height_m(200.0, 280.0) - 10.0).abs() < 1e-9);
    }
}

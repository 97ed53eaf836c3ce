//! The ground as the objective reads it.

use crate::world::Ground;

/// A copy of the ground grid with what a lookup needs at hand.
#[derive(Clone, Debug)]
pub(super) struct Relief {
    west_m: f64,
    south_m: f64,
    per_metre: f64,
    last_column: f64,
    last_row: f64,
    columns: usize,
    heights_m: Vec<f32>,
    /// Taken for the height where there is no data.
    wall_m: f64,
}

/// How far above the ceiling a void reaches, metres: no altitude is allowed over it.
const WALL_OVER_CEILING_M: f64 = 1000.0;

impl Relief {
    pub(super) fn new(ground: &Ground, max_amsl_m: f64) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "a grid has few rows")]
        let last = |nodes: usize| nodes.saturating_sub(1) as f64;
        Self {
            west_m: ground.south_west.east_m,
            south_m: ground.south_west.north_m,
            per_metre: 1.0 / ground.spacing_m,
            last_column: last(ground.columns),
            last_row: last(ground.rows),
            columns: ground.columns,
            heights_m: ground.heights_m.clone(),
            wall_m: max_amsl_m + WALL_OVER_CEILING_M,
        }
    }

    /// Bilinear height above mean sea level, metres, as [`Ground::height_m`],
    /// but a wall beyond the ceiling beside voids.
    #[inline]
    pub(super) fn height_m(&self, east_m: f64, north_m: f64) -> f64 {
        let (column, right) = cell((east_m - self.west_m) * self.per_metre, self.last_column);
        let (row, up) = cell((north_m - self.south_m) * self.per_metre, self.last_row);
        let corner = row * self.columns + column;
        let node = |index: usize| f64::from(self.heights_m[index]);
        let (south_west, south_east) = (node(corner), node(corner + 1));
        let (north_west, north_east) =
            (node(corner + self.columns), node(corner + self.columns + 1));
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

/// The cell index and the fraction within it, clamped to the grid.
#[inline]
fn cell(at: f64, last: f64) -> (usize, f64) {
    let at = at.clamp(0.0, last);
    let floor = at.min(last - 1.0);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the grid; truncation is the floor of what is not negative"
    )]
    let index = floor as u32;
    (index as usize, at - f64::from(index))
}

//! Which zones a piece of a path may meet.

use crate::cost::closed_zone::ClosedZone;
use crate::numeric::geometry::Point;

/// Cells on each side.
const SIDE: usize = 24;
/// Fewer zones are looked at one by one.
const MIN_ZONES: usize = 12;
/// A box of more cells on a side is held against all zones.
const MAX_CELLS: usize = 8;

/// A raster over the zones. Each cell lists the zones in it and its neighbours to the east and
/// north, in order: all that a piece no longer than a cell may meet whose south-west corner it holds.
#[derive(Clone, Debug)]
pub(super) struct ZoneCells {
    low: Point,
    /// Metres of a cell east and north.
    cell_m: Point,
    /// Row by row.
    zones: Vec<Vec<u32>>,
}

impl ZoneCells {
    /// The raster; none where there are few zones.
    pub(super) fn new(zones: &[ClosedZone]) -> Option<Self> {
        let boxes: Vec<(Point, Point)> = zones.iter().map(ClosedZone::bounds).collect();
        Self::around(&boxes)
    }

    /// The raster over the boxes of zones.
    fn around(boxes: &[(Point, Point)]) -> Option<Self> {
        if boxes.len() < MIN_ZONES {
            return None;
        }
        let none = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let (low, high) = boxes
            .iter()
            .fold(none, |(low, high), (zone_low, zone_high)| {
                let axis = |axis: usize| {
                    (
                        low[axis].min(zone_low[axis]),
                        high[axis].max(zone_high[axis]),
                    )
                };
                let (x, y) = (axis(0), axis(1));
                ([x.0, y.0], [x.1, y.1])
            });
        #[expect(clippy::cast_precision_loss, reason = "a small constant")]
        let side = SIDE as f64;
        let cell_m = [(high[0] - low[0]) / side, (high[1] - low[1]) / side];
        if !cell_m
            .iter()
            .all(|metres| metres.is_finite() && *metres > 0.0)
        {
            return None;
        }
        let mut cells = Self {
            low,
            cell_m,
            zones: vec![Vec::new(); SIDE * SIDE],
        };
        for (index, &(zone_low, zone_high)) in (0..).zip(boxes) {
            let ((east, north), (last_east, last_north)) =
                (cells.at(zone_low), cells.at(zone_high));
            for row in north.saturating_sub(1)..=last_north {
                for column in east.saturating_sub(1)..=last_east {
                    cells.zones[row * SIDE + column].push(index);
                }
            }
        }
        Some(cells)
    }

    /// Column and row of the cell of a point, or of the nearest.
    fn at(&self, point: Point) -> (usize, usize) {
        let index = |axis: usize| {
            let cells = (point[axis] - self.low[axis]) / self.cell_m[axis];
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "negative numbers and those that are none become 0"
            )]
            let index = cells as usize;
            index.min(SIDE - 1)
        };
        (index(0), index(1))
    }

    /// The zones that a segment may meet, in order; none where it is longer than a cell.
    #[inline]
    pub(super) fn near(&self, a: Point, b: Point) -> Option<&[u32]> {
        let low = [a[0].min(b[0]), a[1].min(b[1])];
        let is_short = |axis: usize| (a[axis] - b[axis]).abs() < 0.999 * self.cell_m[axis];
        let (column, row) = self.at(low);
        (is_short(0) && is_short(1)).then(|| self.zones[row * SIDE + column].as_slice())
    }

    /// The zones that a box may meet, some of them more than once; none where it is too wide for
    /// that to be worth a look.
    #[inline]
    pub(super) fn in_box(&self, low: Point, high: Point) -> Option<impl Iterator<Item = u32>> {
        let ((west, south), (east, north)) = (self.at(low), self.at(high));
        let is_small = east - west < MAX_CELLS && north - south < MAX_CELLS;
        // A cell lists those of its neighbours to the east and north.
        let rows = (south..=north).step_by(2);
        let cells = rows.flat_map(move |row| {
            (west..=east)
                .step_by(2)
                .map(move |column| row * SIDE + column)
        });
        is_small.then(|| cells.flat_map(|cell| self.zones[cell].iter().copied()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Boxes with equal sides, from south-west corner and side.
    fn squares(corners: &[(f64, f64, f64)]) -> Vec<(Point, Point)> {
        corners
            .iter()
            .map(|&(east, north, side)| ([east, north], [east + side, north + side]))
            .collect()
    }

    proptest! {
        #[test]
        fn a_cell_lists_every_zone_that_a_short_piece_meets(
            corners in prop::collection::vec((-900.0..900.0_f64, -900.0..900.0_f64, 5.0..300.0_f64), 12..40),
            a in (-1500.0..1500.0_f64, -1500.0..1500.0_f64),
            by in (-60.0..60.0_f64, -60.0..60.0_f64),
        ) {
            let boxes = squares(&corners);
            let Some(cells) = ZoneCells::around(&boxes) else {
                return Ok(());
            };
            let (a, b) = ([a.0, a.1], [a.0 + by.0, a.1 + by.1]);
            let Some(near) = cells.near(a, b) else {
                return Ok(());
            };
            prop_assert!(near.is_sorted());
            for (index, (low, high)) in (0..).zip(&boxes) {
                let meets = (0..2).all(|axis| {
                    a[axis].min(b[axis]) <= high[axis] && a[axis].max(b[axis]) >= low[axis]
                });
                prop_assert!(!meets || near.contains(&index), "{index}");
            }
        }

        #[test]
        fn the_cells_of_a_box_list_every_zone_that_meets_it(
            corners in prop::collection::vec((-900.0..900.0_f64, -900.0..900.0_f64, 5.0..300.0_f64), 12..40),
            low in (-1500.0..1500.0_f64, -1500.0..1500.0_f64),
            by in (0.0..600.0_f64, 0.0..600.0_f64),
        ) {
            let boxes = squares(&corners);
            let cells = ZoneCells::around(&boxes).expect("twelve at least");
            let (low, high) = ([low.0, low.1], [low.0 + by.0, low.1 + by.1]);
            let Some(near) = cells.in_box(low, high) else {
                prop_assert!(by.0.max(by.1) > 300.0);
                return Ok(());
            };
            let near: Vec<u32> = near.collect();
            for (index, (zone_low, zone_high)) in (0..).zip(&boxes) {
                let meets = (0..2).all(|axis| low[axis] <= zone_high[axis] && high[axis] >= zone_low[axis]);
                prop_assert!(!meets || near.contains(&index), "{index}");
            }
        }
    }
}

//! Where a grid of values is positive, as polygons that never reach beyond it.

use std::collections::{BTreeMap, BTreeSet};

use crate::numeric::geometry::Point;

/// Values at the nodes of a grid, row by row. Between nodes the value is at least that of the
/// two triangles of each cell that lie lower; it is positive all over a cell with a NaN.
pub(super) struct LevelGrid<'a> {
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) values: &'a [f64],
    /// Whether the first row is the southernmost.
    pub(super) rises_north: bool,
}

/// A corner of a polygon: a node (twice the same), or where the value is 0 between two nodes.
type Key = (usize, usize);

impl LevelGrid<'_> {
    /// The polygons, counter-clockwise around what is positive; `place` gives the place of a
    /// row and column.
    pub(super) fn rings(&self, place: impl Fn(f64, f64) -> Point) -> Vec<Vec<Point>> {
        let mut edges = BTreeSet::new();
        for row in 0..self.rows.saturating_sub(1) {
            for column in 0..self.columns.saturating_sub(1) {
                self.add_cell(row, column, &mut edges);
            }
        }
        let border: Vec<(Key, Key)> = edges
            .iter()
            .copied()
            .filter(|&(from, to)| !edges.contains(&(to, from)))
            .collect();
        linked(&border)
            .into_iter()
            .map(|ring| ring.into_iter().map(|key| self.at(key, &place)).collect())
            .collect()
    }

    fn value(&self, node: usize) -> f64 {
        self.values[node]
    }

    /// Corners of a cell, counter-clockwise in space.
    fn corners(&self, row: usize, column: usize) -> [usize; 4] {
        let first = row * self.columns + column;
        let (next, over) = (first + 1, first + self.columns);
        if self.rises_north {
            [first, next, over + 1, over]
        } else {
            [over, over + 1, next, first]
        }
    }

    fn is_full(&self, row: Option<usize>, column: Option<usize>) -> bool {
        let (Some(row), Some(column)) = (row, column) else {
            return false;
        };
        if row + 1 >= self.rows || column + 1 >= self.columns {
            return false;
        }
        let values = self.corners(row, column).map(|node| self.value(node));
        values.iter().any(|value| value.is_nan()) || values.iter().all(|value| *value > 0.0)
    }

    /// The edges of what is positive in a cell, as far as its neighbours are not all positive.
    fn add_cell(&self, row: usize, column: usize, edges: &mut BTreeSet<(Key, Key)>) {
        let corners = self.corners(row, column);
        if !self.is_full(Some(row), Some(column)) {
            return self.add_part(corners, edges);
        }
        let (before, after) = (row.checked_sub(1), Some(row + 1));
        let (south, north) = if self.rises_north {
            (before, after)
        } else {
            (after, before)
        };
        let neighbours = [
            (south, Some(column)),
            (Some(row), Some(column + 1)),
            (north, Some(column)),
            (Some(row), column.checked_sub(1)),
        ];
        for (side, (row, column)) in neighbours.into_iter().enumerate() {
            if !self.is_full(row, column) {
                let (from, to) = (corners[side], corners[(side + 1) % 4]);
                edges.insert(((from, from), (to, to)));
            }
        }
    }

    /// The edges of the positive part of a cell: of its two lower triangles.
    fn add_part(&self, corners: [usize; 4], edges: &mut BTreeSet<(Key, Key)>) {
        let [a, b, c, d] = corners.map(|node| self.value(node));
        if a <= 0.0 && b <= 0.0 && c <= 0.0 && d <= 0.0 {
            return;
        }
        let split = if a + c <= b + d {
            [0, 1, 2, 0, 2, 3]
        } else {
            [0, 1, 3, 1, 2, 3]
        };
        for triangle in split.chunks(3) {
            let nodes = [
                corners[triangle[0]],
                corners[triangle[1]],
                corners[triangle[2]],
            ];
            let mut part: Vec<Key> = Vec::with_capacity(4);
            for side in 0..3 {
                let (from, to) = (nodes[side], nodes[(side + 1) % 3]);
                let (is_in, is_next_in) = (self.value(from) > 0.0, self.value(to) > 0.0);
                if is_in {
                    part.push((from, from));
                }
                if is_in != is_next_in {
                    part.push((from.min(to), from.max(to)));
                }
            }
            let next = part.iter().cycle().skip(1);
            edges.extend(part.iter().copied().zip(next.copied()));
        }
    }

    fn at(&self, (from, to): Key, place: &impl Fn(f64, f64) -> Point) -> Point {
        #[expect(
            clippy::cast_precision_loss,
            reason = "grids have far fewer than 2^52 nodes"
        )]
        let position = |node: usize| ((node / self.columns) as f64, (node % self.columns) as f64);
        let ((row, column), (other_row, other_column)) = (position(from), position(to));
        if from == to {
            return place(row, column);
        }
        let (value, other) = (self.value(from), self.value(to));
        let share = (value / (value - other)).clamp(0.0, 1.0);
        place(
            row + share * (other_row - row),
            column + share * (other_column - column),
        )
    }
}

/// Edges in a row, until each row is closed.
fn linked(edges: &[(Key, Key)]) -> Vec<Vec<Key>> {
    let mut after: BTreeMap<Key, Vec<Key>> = BTreeMap::new();
    for &(from, to) in edges {
        after.entry(from).or_default().push(to);
    }
    let mut rings = Vec::new();
    for &(first, _) in edges {
        let mut ring = Vec::new();
        let mut at = first;
        while let Some(to) = after.get_mut(&at).and_then(Vec::pop) {
            ring.push(at);
            at = to;
            if at == first {
                break;
            }
        }
        if ring.len() > 2 {
            rings.push(ring);
        }
    }
    rings
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::LevelGrid;
    use crate::numeric::geometry::Point;

    const SIDE: usize = 6;

    /// How often the rings run around a point.
    fn winding(rings: &[Vec<Point>], at: Point) -> i32 {
        let edges = rings
            .iter()
            .flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
        edges
            .filter(|(a, b)| (a[1] > at[1]) != (b[1] > at[1]))
            .map(|(a, b)| {
                let left = (b[0] - a[0]) * (at[1] - a[1]) - (b[1] - a[1]) * (at[0] - a[0]);
                match (b[1] > a[1], left > 0.0) {
                    (true, true) => 1,
                    (false, false) => -1,
                    _ => 0,
                }
            })
            .sum()
    }

    fn bilinear(values: &[f64], [x, y]: Point) -> f64 {
        let cell = |at: f64| {
            (0..SIDE - 1)
                .rfind(|index| count(*index) <= at)
                .unwrap_or(0)
        };
        let (column, row) = (cell(x), cell(y));
        let (right, up) = (x - count(column), y - count(row));
        let node = |row: usize, column: usize| values[row * SIDE + column];
        (node(row, column) * (1.0 - right) + node(row, column + 1) * right) * (1.0 - up)
            + (node(row + 1, column) * (1.0 - right) + node(row + 1, column + 1) * right) * up
    }

    fn count(index: usize) -> f64 {
        f64::from(u32::try_from(index).expect("small"))
    }

    proptest! {
        /// Where the rings close, the bilinear surface is positive, and where all four corners
        /// of a cell are, it is closed: in both orders of the rows.
        #[test]
        fn the_rings_lie_where_the_surface_is_positive(
            values in prop::collection::vec(-1.0..1.0_f64, SIDE * SIDE),
            sites in prop::collection::vec((0.001..4.999_f64, 0.001..4.999_f64), 40),
        ) {
            let grid = |rises_north| LevelGrid { columns: SIDE, rows: SIDE, values: &values, rises_north };
            let up = grid(true).rings(|row, column| [column, row]);
            let down = grid(false).rings(|row, column| [column, -row]);
            for (x, y) in sites {
                let (around, mirrored) = (winding(&up, [x, y]), winding(&down, [x, -y]));
                prop_assert!((0..=1).contains(&around), "{around}");
                prop_assert!((0..=1).contains(&mirrored), "{mirrored}");
                if around + mirrored > 0 {
                    prop_assert!(bilinear(&values, [x, y]) > -1e-9);
                }
                let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
                let is_full = corners.iter().all(|(right, over)| {
                    bilinear(&values, [x.floor() + right, y.floor() + over]) > 0.0
                });
                prop_assert!(!is_full || around == 1 && mirrored == 1);
            }
        }
    }
}

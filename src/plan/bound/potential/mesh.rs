//! The mesh of a potential: a grid along the line from start to goal, bent to the rims of threats.

use crate::numeric::geometry::{Point, distance, doubled_area};
use crate::world::Disc;

/// A node moves to a rim that is nearer than this share of the spacing.
const SNAP: f64 = 0.4;
/// A node on a rim lies inside by this, metres.
const INSIDE_M: f64 = 0.01;
/// Rows and columns beyond the ellipse.
const BEYOND: usize = 3;

/// Triangles over every place from which a path of a limited length can come.
///
/// Nodes lie row by row; a row runs from start towards goal. Every cell of four nodes is two
/// triangles, with diagonals that alternate.
#[derive(Clone, Debug)]
pub(super) struct Mesh {
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// Of start and goal.
    pub(super) ends: [usize; 2],
    /// Planning coordinates, metres.
    pub(super) nodes: Vec<Point>,
    pub(super) triangles: Vec<[usize; 3]>,
}

impl Mesh {
    /// With `pieces` cells from start to goal, over the ellipse of paths up to a length.
    pub(super) fn new(ends: [Point; 2], longest_m: f64, pieces: usize, rims: &[Disc]) -> Self {
        let straight_m = distance(ends[0], ends[1]);
        let spacing_m = straight_m / count(pieces);
        let cells = |length_m: f64| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "few cells, not negative"
            )]
            let whole = (length_m / spacing_m).ceil().max(0.0) as usize;
            whole + BEYOND
        };
        let before = cells(0.5 * (longest_m - straight_m));
        let aside = cells(
            0.5 * (longest_m * longest_m - straight_m * straight_m)
                .max(0.0)
                .sqrt(),
        );
        let (rows, columns) = (2 * aside + 1, pieces + 2 * before + 1);
        let along = [0, 1].map(|axis| (ends[1][axis] - ends[0][axis]) / straight_m * spacing_m);
        let node = |index: usize| {
            let across = count(index / columns) - count(aside);
            let ahead = count(index % columns) - count(before);
            [
                ends[0][0] + ahead * along[0] - across * along[1],
                ends[0][1] + ahead * along[1] + across * along[0],
            ]
        };
        let start = aside * columns + before;
        let mut mesh = Self {
            rows,
            columns,
            ends: [start, start + pieces],
            nodes: (0..rows * columns).map(node).collect(),
            triangles: triangles(rows, columns),
        };
        mesh.nodes[start] = ends[0];
        mesh.nodes[start + pieces] = ends[1];
        mesh.snap(rims, SNAP * spacing_m);
        mesh
    }

    /// Moves nodes to the rims, where every triangle stays the right way around.
    fn snap(&mut self, rims: &[Disc], reach_m: f64) {
        let given = self.nodes.clone();
        for row in 1..self.rows - 1 {
            for column in 1..self.columns - 1 {
                let index = row * self.columns + column;
                if !self.ends.contains(&index) {
                    self.nodes[index] = snapped(given[index], rims, reach_m);
                }
            }
        }
        // Each pass puts back at least one node.
        loop {
            let wrong: Vec<[usize; 3]> = (self.triangles.iter().copied())
                .filter(|corners| doubled_area(&corners.map(|node| self.nodes[node])) <= 0.0)
                .collect();
            if wrong.is_empty() {
                return;
            }
            for node in wrong.into_iter().flatten() {
                self.nodes[node] = given[node];
            }
        }
    }

    /// The triangle in which a point lies as long as no node is moved: row and column with
    /// fractions.
    pub(super) fn triangle_at(&self, row: f64, column: f64) -> usize {
        let (low, left) = self.cell_at(row, column);
        let (up, right) = (row - count(low), column - count(left));
        let first = 2 * (low * (self.columns - 1) + left);
        let is_second = match (low + left) % 2 {
            0 => up > right,
            _ => up + right > 1.0,
        };
        first + usize::from(is_second)
    }

    /// The cell at a row and column with fractions, at the edge for what lies beyond it.
    fn cell_at(&self, row: f64, column: f64) -> (usize, usize) {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "within the grid"
        )]
        let cell = |at: f64, cells: usize| (at.max(0.0) as usize).min(cells - 1);
        (cell(row, self.rows - 1), cell(column, self.columns - 1))
    }

    /// Cells from start to goal.
    pub(super) fn cells(&self) -> usize {
        self.ends[1] - self.ends[0]
    }

    /// Between four values at nodes; at the edge beyond it.
    pub(super) fn bilinear(&self, values: &[f64], (row, column): (f64, f64)) -> f64 {
        let (low, left) = self.cell_at(row, column);
        let up = (row - count(low)).clamp(0.0, 1.0);
        let right = (column - count(left)).clamp(0.0, 1.0);
        let value = |row: usize, column: usize| values[row * self.columns + column];
        let side = |row: usize| value(row, left) * (1.0 - right) + value(row, left + 1) * right;
        side(low) * (1.0 - up) + side(low + 1) * up
    }

    /// Row and column of the middle of a triangle of `self` in a mesh with other spacing.
    pub(super) fn middle_in(&self, other: &Self, triangle: usize) -> (f64, f64) {
        let corners = self.triangles[triangle].map(|node| self.place_in(other, node));
        let mean = |axis: fn((f64, f64)) -> f64| corners.into_iter().map(axis).sum::<f64>() / 3.0;
        (mean(|place| place.0), mean(|place| place.1))
    }

    /// Row and column of a node of `self` in a mesh with other spacing.
    pub(super) fn place_in(&self, other: &Self, node: usize) -> (f64, f64) {
        let share = count(other.cells()) / count(self.cells());
        let from = |mesh: &Self| {
            let start = mesh.ends[0];
            (count(start / mesh.columns), count(start % mesh.columns))
        };
        let (own, others) = (from(self), from(other));
        (
            others.0 + share * (count(node / self.columns) - own.0),
            others.1 + share * (count(node % self.columns) - own.1),
        )
    }
}

/// On the nearest rim within reach, else as it is.
fn snapped(at: Point, rims: &[Disc], reach_m: f64) -> Point {
    let from_rim = |disc: &Disc| {
        let center = [disc.center.east_m, disc.center.north_m];
        let from_m = distance(at, center);
        (center, from_m, disc.radius_m - INSIDE_M)
    };
    let rims = rims.iter().map(from_rim);
    let near = rims.filter(|(_, from_m, radius_m)| {
        *radius_m > 0.0 && *from_m > 0.0 && (from_m - radius_m).abs() < reach_m
    });
    let gap_m = |(_, from_m, radius_m): &(Point, f64, f64)| (from_m - radius_m).abs();
    let nearest = near.min_by(|a, b| gap_m(a).total_cmp(&gap_m(b)));
    nearest.map_or(at, |(center, from_m, radius_m)| {
        [0, 1].map(|axis| center[axis] + (at[axis] - center[axis]) * radius_m / from_m)
    })
}

/// Two triangles for each cell, counter-clockwise.
fn triangles(rows: usize, columns: usize) -> Vec<[usize; 3]> {
    let cells = (0..rows - 1).flat_map(|row| (0..columns - 1).map(move |column| (row, column)));
    let halves = |(row, column): (usize, usize)| {
        let a = row * columns + column;
        let (b, c, d) = (a + 1, a + columns + 1, a + columns);
        match (row + column) % 2 {
            0 => [[a, b, c], [a, c, d]],
            _ => [[a, b, d], [b, c, d]],
        }
    };
    cells.flat_map(halves).collect()
}

/// A number of cells as a float.
#[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52")]
pub(super) fn count(cells: usize) -> f64 {
    cells as f64
}

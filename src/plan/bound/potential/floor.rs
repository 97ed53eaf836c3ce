//! A floor under the lowest altitudes of paths: flat over each triangle, and how far below them.

use rayon::prelude::*;

use super::mesh::Mesh;
use crate::geodesy::{EastNorth, LatLon};
use crate::numeric::geometry::{Point, distance, doubled_area};
use crate::spec::Hill;
use crate::world::{Terrain, TerrainGrid, World};

/// What lines that are straight in latitude and longitude and not in the plane may change the
/// height of a cell by, and rounding, metres.
const BEND_M: f64 = 0.02;
/// Floors are whole centimetres.
const PER_METRE: f64 = 100.0;
/// How often the floor is lowered node by node.
const PASSES: usize = 4;
/// How far beyond a triangle a plane may rise by the rounding of its corners, metres.
const ROUNDING_M: f64 = 0.05;
/// Analytic ground is read at the corners of this many pieces along each side.
const PIECES: u32 = 8;
/// How much planning coordinates and the sphere of analytic hills may differ in scale.
const SCALE: f64 = 1.05;

/// The floor of a mesh.
#[derive(Clone, Debug)]
pub(super) struct Floor {
    /// Of each node, metres above the sea.
    pub(super) nodes_m: Vec<f64>,
    /// How far the lowest altitude may lie above it in each triangle, metres.
    pub(super) below_m: Vec<f64>,
}

/// Where the lowest altitude of a path is known: no data outside.
trait Ground: Sync {
    /// Least and greatest difference to a plane over a triangle, at least so far out.
    fn differences_m(&self, corners: [Point; 3], plane_m: [f64; 3]) -> Option<(f64, f64)>;
    /// At a node.
    fn at_m(&self, at: Point) -> Option<f64>;
}

impl Floor {
    /// The floor over the triangles in `used`; none where the ground does not vary.
    pub(super) fn new(world: &World, mesh: &Mesh, used: &[bool]) -> Option<Self> {
        match &world.terrain {
            Terrain::Flat(_) | Terrain::Unknown => None,
            Terrain::Analytic { hills, .. } => {
                let hills = (hills.iter()).map(|hill| (world.frame.to_plan(hill.place), *hill));
                let ground = Hills {
                    world,
                    hills: hills.collect(),
                };
                Some(Self::under(&ground, mesh, used))
            }
            Terrain::Grid(grid) => {
                let ground = Nodes::under(world, grid, mesh);
                Some(Self::under(&ground, mesh, used))
            }
        }
    }

    fn under(ground: &impl Ground, mesh: &Mesh, used: &[bool]) -> Self {
        let mut nodes_m: Vec<f64> = (mesh.nodes.iter())
            .map(|&at| ground.at_m(at).unwrap_or(0.0))
            .collect();
        let over = |triangle: usize, nodes_m: &[f64]| {
            let corners = mesh.triangles[triangle];
            let plane_m = corners.map(|node| nodes_m[node]);
            ground.differences_m(corners.map(|node| mesh.nodes[node]), plane_m)
        };
        let triangles: Vec<usize> = (0..mesh.triangles.len()).filter(|&at| used[at]).collect();
        let over_each = |nodes_m: &[f64]| -> Vec<Option<(f64, f64)>> {
            let triangles = triangles.par_iter().with_min_len(256);
            triangles.map(|&triangle| over(triangle, nodes_m)).collect()
        };
        // Nodes that are lowered apart tilt the planes anew: a few passes, then all by the same.
        for pass in 0..=PASSES {
            let mut down_m = vec![0.0_f64; nodes_m.len()];
            for (&triangle, over) in triangles.iter().zip(over_each(&nodes_m)) {
                let min_m = over.map_or(0.0, |(min_m, _)| min_m);
                for node in mesh.triangles[triangle] {
                    down_m[node] = down_m[node].max(-min_m);
                }
            }
            if pass == PASSES {
                let max_m = down_m.iter().copied().fold(0.0, f64::max);
                down_m.fill(max_m);
            }
            for (at_m, down_m) in nodes_m.iter_mut().zip(down_m) {
                *at_m -= down_m;
            }
        }
        // Rounding down apart tilts them too, by less than this.
        for at_m in &mut nodes_m {
            *at_m = ((*at_m - ROUNDING_M) * PER_METRE).floor() / PER_METRE;
        }
        let mut below_m = vec![0.0; mesh.triangles.len()];
        for (&triangle, over) in triangles.iter().zip(over_each(&nodes_m)) {
            let max_m = over.map_or(0.0, |(_, max_m)| max_m);
            below_m[triangle] = max_m.max(0.0);
        }
        Self { nodes_m, below_m }
    }
}

/// Barycentric coordinates of a point.
fn shares([a, b, c]: [Point; 3], at: Point) -> [f64; 3] {
    let whole = doubled_area(&[a, b, c]);
    let first = doubled_area(&[at, b, c]) / whole;
    let second = doubled_area(&[a, at, c]) / whole;
    [first, second, 1.0 - first - second]
}

fn mixed(shares: [f64; 3], values: [f64; 3]) -> f64 {
    shares.iter().zip(values).map(|(a, b)| a * b).sum()
}

/// The nodes of a grid of latitude and longitude.
struct Nodes<'a> {
    world: &'a World,
    grid: &'a TerrainGrid,
    /// The first row and column that are held, and how many.
    first: [usize; 2],
    size: [usize; 2],
    /// Place and lowest altitude of each; none without data.
    sampled: Vec<Option<(Point, f64)>>,
    /// Longest diagonal of a cell.
    cell_m: f64,
}

impl<'a> Nodes<'a> {
    fn under(world: &'a World, grid: &'a TerrainGrid, mesh: &Mesh) -> Self {
        let corner = |row: usize, column: usize| {
            let at = mesh.nodes[row * mesh.columns + column];
            row_column(world, grid, at)
        };
        let (last, end) = (mesh.rows - 1, mesh.columns - 1);
        let corners = [
            corner(0, 0),
            corner(0, end),
            corner(last, 0),
            corner(last, end),
        ];
        let all = [grid.rows, grid.columns];
        let range = |axis: usize| {
            let of = |value: [f64; 2]| value[axis];
            let low = corners.into_iter().map(of).fold(f64::INFINITY, f64::min);
            let high = corners
                .into_iter()
                .map(of)
                .fold(f64::NEG_INFINITY, f64::max);
            let low = index(low - 3.0, all[axis]);
            (low, index(high + 4.0, all[axis]) - low)
        };
        let (rows, columns) = (range(0), range(1));
        let nodes = (rows.0..rows.0 + rows.1)
            .flat_map(|row| (columns.0..columns.0 + columns.1).map(move |column| (row, column)));
        let sampled = nodes.map(|(row, column)| {
            let place = LatLon {
                lat_deg: grid.row_lat_deg(row),
                lon_deg: grid.column_lon_deg(column),
            };
            let at = world.frame.to_plan(place);
            let height_m = grid.node_m(row, column)?;
            Some(([at.east_m, at.north_m], height_m + world.min_agl.0))
        });
        let sampled: Vec<_> = sampled.collect();
        let mut nodes = Self {
            world,
            grid,
            first: [rows.0, columns.0],
            size: [rows.1, columns.1],
            sampled,
            cell_m: 0.0,
        };
        nodes.cell_m = diagonal_m(grid);
        nodes
    }

    fn of_row_column(&self, row: usize, column: usize) -> Option<(Point, f64)> {
        *self.sampled.get(row * self.size[1] + column)?
    }
}

/// No cell of a grid has a longer diagonal, metres.
pub(super) fn diagonal_m(grid: &TerrainGrid) -> f64 {
    // A degree is nowhere longer than this.
    const MAX_METRES_PER_DEG: f64 = 111_700.0;
    MAX_METRES_PER_DEG * grid.row_step_deg.hypot(grid.column_step_deg)
}

/// A position among nodes, not beyond them.
fn index(at: f64, nodes: usize) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "negative numbers become 0"
    )]
    let node = at.max(0.0) as usize;
    node.min(nodes)
}

fn row_column(world: &World, grid: &TerrainGrid, [east_m, north_m]: Point) -> [f64; 2] {
    let place = world.frame.from_plan(EastNorth { east_m, north_m });
    let (row, column) = grid.row_column(place);
    [row, column]
}

impl Ground for Nodes<'_> {
    fn differences_m(&self, corners: [Point; 3], plane_m: [f64; 3]) -> Option<(f64, f64)> {
        let cells = corners.map(|corner| row_column(self.world, self.grid, corner));
        let range = |axis: usize| {
            let low = cells
                .iter()
                .map(|cell| cell[axis])
                .fold(f64::INFINITY, f64::min);
            let high = cells.iter().map(|cell| cell[axis]).fold(0.0, f64::max);
            let first = self.first[axis];
            let from = index(low - 0.01, usize::MAX).saturating_sub(first);
            let to = index(high + 0.01, usize::MAX).saturating_sub(first) + 1;
            from..(to + 1).min(self.size[axis])
        };
        // A node farther out than a cell belongs to none that touches the triangle.
        let area_m2 = doubled_area(&corners);
        let [a, b, c] = corners;
        let sides_m = [distance(b, c), distance(c, a), distance(a, b)];
        let out = sides_m.map(|side_m| -self.cell_m * side_m / area_m2);
        let (mut min_m, mut max_m) = (f64::INFINITY, f64::NEG_INFINITY);
        for row in range(0) {
            for column in range(1) {
                let Some((at, height_m)) = self.of_row_column(row, column) else {
                    continue;
                };
                let shares = shares(corners, at);
                if shares.iter().zip(out).all(|(share, out)| *share >= out) {
                    let over_m = height_m - mixed(shares, plane_m);
                    (min_m, max_m) = (min_m.min(over_m), max_m.max(over_m));
                }
            }
        }
        (min_m <= max_m).then_some((min_m - BEND_M, max_m + BEND_M))
    }

    fn at_m(&self, at: Point) -> Option<f64> {
        let [row, column] = row_column(self.world, self.grid, at);
        let (low, left) = (index(row, self.grid.rows), index(column, self.grid.columns));
        let [a, b, c, d] = self.grid.cell_m(low, left)?;
        let (down, right) = (
            row - super::mesh::count(low),
            column - super::mesh::count(left),
        );
        let (north, south) = (a + (b - a) * right, c + (d - c) * right);
        Some(north + (south - north) * down + self.world.min_agl.0)
    }
}

/// Analytic ground.
struct Hills<'a> {
    world: &'a World,
    hills: Vec<(EastNorth, Hill)>,
}

impl Hills<'_> {
    /// No less than the second derivative of the ground in any direction in a triangle, 1/m.
    fn bend(&self, corners: [Point; 3]) -> f64 {
        let [a, b, c] = corners;
        let reach_m = distance(a, b).max(distance(b, c)).max(distance(c, a));
        let of_hill = |(center, hill): &(EastNorth, Hill)| {
            let radius_m = hill.radius_m / SCALE;
            let away_m = distance(a, [center.east_m, center.north_m]) - reach_m;
            let away = (away_m.max(0.0) / (hill.radius_m * SCALE)).powi(2);
            let share = ((1.0 + 2.0 * away) * (-away).exp()).min(1.0);
            2.0 * hill.height_m.abs() / (radius_m * radius_m) * share
        };
        self.hills.iter().map(of_hill).sum()
    }
}

impl Ground for Hills<'_> {
    fn differences_m(&self, corners: [Point; 3], plane_m: [f64; 3]) -> Option<(f64, f64)> {
        let [a, b, c] = corners;
        let side_m = distance(a, b).max(distance(b, c)).max(distance(c, a)) / f64::from(PIECES);
        // Between the corners of a triangle of that side, at most.
        let bend_m = side_m * side_m / 6.0 * self.bend(corners) + BEND_M;
        let (mut min_m, mut max_m) = (f64::INFINITY, f64::NEG_INFINITY);
        for first in 0..=PIECES {
            for second in 0..=PIECES - first {
                let share = |pieces: u32| f64::from(pieces) / f64::from(PIECES);
                let shares = [share(first), share(second), share(PIECES - first - second)];
                let at = [0, 1].map(|axis| mixed(shares, corners.map(|corner| corner[axis])));
                let over_m = self.at_m(at)? - mixed(shares, plane_m);
                (min_m, max_m) = (min_m.min(over_m), max_m.max(over_m));
            }
        }
        Some((min_m - bend_m, max_m + bend_m))
    }

    fn at_m(&self, [east_m, north_m]: Point) -> Option<f64> {
        let place = self.world.frame.from_plan(EastNorth { east_m, north_m });
        let ground = self.world.terrain.height(place).ok()?;
        Some(ground.0 + self.world.min_agl.0)
    }
}

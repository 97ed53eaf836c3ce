//! Ground over which no altitude is allowed, approximated from inside.

use geo::{BoundingRect, Polygon};

use super::level_set::LevelGrid;
use crate::geodesy::{EastNorth, LatLon, METRES_PER_DEG};
use crate::numeric::geometry::Point;
use crate::spec::Hill;
use crate::world::{Ground, Terrain, TerrainGrid, World};

/// Rounding of the grid of the search and of coordinates, metres of height.
const ROUNDING_M: f64 = 0.002;
/// Less than any radius of the earth, metres.
pub(super) const MIN_EARTH_RADIUS_M: f64 = 6_300_000.0;
/// How much planning coordinates and that sphere may differ in scale, both ways.
const SCALE: f64 = 1.05;

/// Polygons in which the ground and the minimum height above it reach beyond the ceiling, or in
/// which there are no data.
pub(super) fn closed_ground(world: &World) -> Vec<Vec<Point>> {
    match &world.terrain {
        Terrain::Flat(_) | Terrain::Unknown => Vec::new(),
        Terrain::Analytic { hills, .. } => analytic(world, hills),
        Terrain::Grid(grid) => of_grid(world, grid),
    }
}

/// Ground higher than this is closed, metres above the sea.
fn highest_m(world: &World) -> f64 {
    world.max_amsl.0 - world.min_agl.0
}

/// Bilinear ground of a grid of latitude and longitude, where it is flown over.
fn of_grid(world: &World, grid: &TerrainGrid) -> Vec<Vec<Point>> {
    let Some(part) = Part::under(world, grid) else {
        return Vec::new();
    };
    let edge_m = part.bend_m(grid);
    let level_m = highest_m(world) + edge_m + ROUNDING_M;
    let values: Vec<f64> = (part.rows.clone())
        .flat_map(|row| part.columns.clone().map(move |column| (row, column)))
        .map(|(row, column)| {
            grid.node_m(row, column)
                .map_or(f64::NAN, |at_m| at_m - level_m)
        })
        .collect();
    let level = LevelGrid {
        columns: part.columns.len(),
        rows: part.rows.len(),
        values: &values,
        rises_north: false,
    };
    let north = grid.row_lat_deg(part.rows.start);
    let west = grid.column_lon_deg(part.columns.start);
    level.rings(|row, column| {
        let at = world.frame.to_plan(LatLon {
            lat_deg: north - row * grid.row_step_deg,
            lon_deg: west + column * grid.column_step_deg,
        });
        [at.east_m, at.north_m]
    })
}

/// The rows and columns of a grid that lie under the area.
struct Part {
    rows: std::ops::Range<usize>,
    columns: std::ops::Range<usize>,
}

impl Part {
    fn under(world: &World, grid: &TerrainGrid) -> Option<Self> {
        let sites = world.area.exterior().coords().map(|corner| {
            let (east_m, north_m) = corner.x_y();
            world.frame.from_plan(EastNorth { east_m, north_m })
        });
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for place in sites {
            let (row, column) = grid.row_column(place);
            for (axis, at) in [row, column].into_iter().enumerate() {
                low[axis] = low[axis].min(at);
                high[axis] = high[axis].max(at);
            }
        }
        let range = |axis: usize, nodes: usize| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "negative numbers become 0, and large ones the last"
            )]
            let node = |at: f64| (at.max(0.0) as usize).min(nodes);
            node(low[axis].floor() - 1.0)..node(high[axis].ceil() + 2.0)
        };
        let (rows, columns) = (range(0, grid.rows), range(1, grid.columns));
        (rows.len() > 1 && columns.len() > 1).then_some(Self { rows, columns })
    }

    /// A line that is straight in latitude and longitude across a cell bends in the plane: how
    /// much the height may change over as much, metres.
    fn bend_m(&self, grid: &TerrainGrid) -> f64 {
        let lat = grid.row_lat_deg(self.rows.start).abs();
        let lat = lat
            .max(grid.row_lat_deg(self.rows.end).abs())
            .min(89.0)
            .to_radians();
        let high_m = grid.row_step_deg * METRES_PER_DEG;
        let wide_m = grid.column_step_deg * METRES_PER_DEG;
        let narrow_m = wide_m * lat.cos();
        let across_sq = high_m * high_m + wide_m * wide_m;
        let bend_m = across_sq * (1.0 + lat.tan()) / (4.0 * MIN_EARTH_RADIUS_M);
        let mut steepest = 0.0_f64;
        for row in self.rows.clone() {
            for column in self.columns.clone() {
                let Some([a, b, c, d]) = grid.cell_m(row, column) else {
                    continue;
                };
                let east = (b - a).abs().max((d - c).abs()) / narrow_m;
                let north = (c - a).abs().max((d - b).abs()) / high_m;
                steepest = steepest.max(east + north);
            }
        }
        SCALE * bend_m * steepest
    }
}

/// Smooth ground: the grid of the search between whose nodes it bends by a known amount.
fn analytic(world: &World, hills: &[Hill]) -> Vec<Vec<Point>> {
    let sampled;
    let ground: &Ground = if world.ground.shows(&world.terrain) {
        &world.ground
    } else {
        let Some(wide) = without_narrow(world, hills) else {
            return Vec::new();
        };
        sampled = wide;
        &sampled
    };
    let highest_m = highest_m(world);
    let over_m = |node: usize| f64::from(ground.heights_m[node]) - highest_m;
    if (0..ground.heights_m.len()).all(|node| over_m(node) <= 0.0) {
        return Vec::new();
    }
    let bends = Bends::new(world, hills, ground);
    let values: Vec<f64> = (0..ground.heights_m.len())
        .map(|node| {
            let value = over_m(node);
            let max_m = bends.block_m(node);
            // Every node of a cell that the rim may cross.
            let is_near = bends.around(node).any(|other| {
                let other_m = over_m(other);
                other_m.abs() <= max_m || (other_m > 0.0) != (value > 0.0)
            });
            value - ROUNDING_M - if is_near { bends.node_m(node) } else { 0.0 }
        })
        .collect();
    let level = LevelGrid {
        columns: ground.columns,
        rows: ground.rows,
        values: &values,
        rises_north: true,
    };
    let (south_west, spacing_m) = (ground.south_west, ground.spacing_m);
    level.rings(|row, column| {
        [
            south_west.east_m + column * spacing_m,
            south_west.north_m + row * spacing_m,
        ]
    })
}

/// The ground without the hills that its grid is too coarse for: it is only lower. None if one
/// of them is a pit.
fn without_narrow(world: &World, hills: &[Hill]) -> Option<Ground> {
    let spacing_m = world.ground.spacing_m;
    let (wide, narrow): (Vec<Hill>, Vec<Hill>) = hills
        .iter()
        .copied()
        .partition(|hill| hill.radius_m >= 2.0 * spacing_m);
    if narrow.iter().any(|hill| hill.height_m < 0.0) {
        return None;
    }
    let Terrain::Analytic { base, .. } = world.terrain else {
        return None;
    };
    let terrain = Terrain::Analytic { base, hills: wide };
    Some(Ground::sample(
        &terrain,
        &world.frame,
        &bounding(&world.area)?,
    ))
}

fn bounding(area: &Polygon<f64>) -> Option<Polygon<f64>> {
    Some(area.bounding_rect()?.to_polygon())
}

/// Nodes of a block along each side.
const BLOCK: usize = 16;

/// How far smooth ground may lie below the triangles between the nodes of a grid.
struct Bends<'a> {
    ground: &'a Ground,
    /// Places and shapes of the hills: height times 2 over radius squared, and the radius.
    hills: Vec<(EastNorth, f64, f64)>,
    /// A bound for all nodes of a block and those next to it, metres, row by row.
    blocks_m: Vec<f64>,
}

impl<'a> Bends<'a> {
    fn new(world: &World, hills: &[Hill], ground: &'a Ground) -> Self {
        let hills = hills.iter().map(|hill| {
            let radius_m = hill.radius_m / SCALE;
            let bend = 2.0 * hill.height_m.abs() / (radius_m * radius_m);
            (world.frame.to_plan(hill.place), bend, hill.radius_m * SCALE)
        });
        let mut bends = Self {
            ground,
            hills: hills.collect(),
            blocks_m: Vec::new(),
        };
        for row in 0..=ground.rows / BLOCK {
            for column in 0..=ground.columns / BLOCK {
                let middle = (
                    half(2 * row * BLOCK + BLOCK),
                    half(2 * column * BLOCK + BLOCK),
                );
                // Half the diagonal of the block, and four nodes more.
                let reach = 0.71 * half(2 * BLOCK) + 4.0;
                bends.blocks_m.push(bends.within_m(middle, reach));
            }
        }
        bends
    }

    /// The nodes around a node, itself among them.
    fn around(&self, node: usize) -> impl Iterator<Item = usize> + Clone {
        let (columns, rows) = (self.ground.columns, self.ground.rows);
        let (row, column) = (node / columns, node % columns);
        let near = |at: usize, last: usize| at.saturating_sub(1)..=(at + 1).min(last - 1);
        let across = near(column, columns);
        near(row, rows)
            .flat_map(move |row| across.clone().map(move |column| row * columns + column))
    }

    /// A bound of the error around a node that holds for its neighbours too, metres.
    fn block_m(&self, node: usize) -> f64 {
        let (row, column) = (node / self.ground.columns, node % self.ground.columns);
        self.blocks_m[row / BLOCK * (self.ground.columns / BLOCK + 1) + column / BLOCK]
    }

    /// The error in the cells around a node, metres.
    fn node_m(&self, node: usize) -> f64 {
        let (row, column) = (node / self.ground.columns, node % self.ground.columns);
        self.within_m((half(2 * row), half(2 * column)), 1.5)
    }

    /// The error within some spacings of a row and column, metres.
    fn within_m(&self, (row, column): (f64, f64), reach: f64) -> f64 {
        let spacing_m = self.ground.spacing_m;
        let at = EastNorth {
            east_m: self.ground.south_west.east_m + column * spacing_m,
            north_m: self.ground.south_west.north_m + row * spacing_m,
        };
        let bends = self.hills.iter().map(|&(center, bend, radius_m)| {
            let away_m = (at.distance_m(center) / SCALE - reach * spacing_m).max(0.0);
            bend * steepness(away_m / radius_m)
        });
        // Linear interpolation over a right triangle is off by a quarter of the second
        // derivative times the square of its legs.
        0.25 * bends.sum::<f64>() * spacing_m * spacing_m
    }
}

/// Half a count, as a number.
#[expect(clippy::cast_precision_loss, reason = "a grid has few rows")]
fn half(count: usize) -> f64 {
    0.5 * count as f64
}

/// A bound of the second derivative of `exp(-t^2)` beyond `t` in any direction, over its value 2
/// at 0.
fn steepness(radii: f64) -> f64 {
    let square = radii * radii;
    let bell = (-square).exp();
    // Along the radius (2 t^2 - 1) exp(-t^2) is greatest at t^2 = 1.5, where it is 0.4463.
    let outward = if square < 1.5 {
        0.4463
    } else {
        (2.0 * square - 1.0) * bell
    };
    bell.max(outward)
}

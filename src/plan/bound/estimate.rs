use crate::geodesy::EastNorth;
use crate::plan::classes::field::{Field, Reading, Relief};
use crate::plan::classes::grid::Grid;
use crate::plan::route_context::RouteContext;

/// Rounds of four sweeps; a path that bends more often is not believed.
const MAX_ROUNDS: usize = 12;
/// Change of the solution that ends the sweeps, kilometres.
const SETTLED_KM: f64 = 1e-6;

/// The estimate for a route: the solution on a grid, extrapolated downward by what
/// halving its cells has changed, and never below the proven bound.
pub(in crate::plan) fn estimate(context: &RouteContext<'_>, budget: usize) -> f64 {
    let (start, goal) = (context.ends.from.at, context.ends.to.at);
    let prices = context.prices();
    let solve = |nodes: usize, near: bool| {
        let part = if near {
            context.near_box()
        } else {
            context.frame()
        };
        let grid = Grid::over(part.south_west, part.north_east, nodes);
        let relief = Relief::new(
            (context.world, context.layer()),
            grid,
            &prices,
            Reading::Optimistic,
        );
        arrival(&relief.field(f64::INFINITY, &prices), start, goal)
    };
    let nodes = if budget >= 20_000 { 101 } else { 51 };
    let (mut coarse, mut fine) = rayon::join(|| solve(nodes, true), || solve(2 * nodes - 1, true));
    if coarse > 2.0 * context.bound().max(1e-3) {
        (coarse, fine) = rayon::join(|| solve(nodes, false), || solve(2 * nodes - 1, false));
    }
    (fine - 2.0 * (coarse - fine).max(0.0)).max(context.bound())
}

/// Cost of the cheapest way through a field, kilometres times cost.
pub(super) fn arrival(field: &Field, start: EastNorth, goal: EastNorth) -> f64 {
    let least = field.cost.iter().copied().fold(f64::INFINITY, f64::min);
    let mut front = Front::new(field, start, least);
    for _ in 0..MAX_ROUNDS {
        let mut change = 0.0_f64;
        for (flip_rows, flip_columns) in
            [(false, false), (false, true), (true, true), (true, false)]
        {
            change = change.max(front.sweep(flip_rows, flip_columns));
        }
        if change < SETTLED_KM {
            break;
        }
    }
    least * start.distance_m(goal) / 1000.0 + bilinear(&field.grid, &front.excess(), goal)
}

/// The solution as far as it is known: the excess over the straight distance from the start.
/// Around the nodes of the grid stands one more of infinite cost on each side.
struct Front {
    columns: usize,
    rows: usize,
    nodes: Vec<FrontNode>,
}

#[derive(Clone, Copy)]
struct FrontNode {
    excess: f64,
    /// By how much the straight distance at the least cost grows over a cell eastward and
    /// northward.
    grows: [f64; 2],
    /// Cost of crossing a cell.
    reach: f64,
    /// Whether the excess is given.
    is_fixed: bool,
}

impl Front {
    fn new(field: &Field, start: EastNorth, least: f64) -> Self {
        let grid = &field.grid;
        let outside = FrontNode {
            excess: f64::INFINITY,
            grows: [0.0; 2],
            reach: 0.0,
            is_fixed: true,
        };
        let mut nodes = vec![outside; (grid.columns + 2) * (grid.rows + 2)];
        let cell_km = grid.spacing_m / 1000.0;
        for row in 0..grid.rows {
            for column in 0..grid.columns {
                let node = row * grid.columns + column;
                let at = grid.at(node);
                let distance_m = at.distance_m(start);
                let grows = |offset_m: f64| least * cell_km * (offset_m / distance_m.max(1e-9));
                // Around the start the way is straight, and its cost that of the node it
                // leads to.
                let is_fixed = distance_m <= 1.5 * grid.spacing_m;
                let excess = match is_fixed {
                    true => distance_m / 1000.0 * (field.cost[node] - least),
                    false => f64::INFINITY,
                };
                nodes[(row + 1) * (grid.columns + 2) + column + 1] = FrontNode {
                    excess,
                    grows: [
                        grows(at.east_m - start.east_m),
                        grows(at.north_m - start.north_m),
                    ],
                    reach: cell_km * field.cost[node],
                    is_fixed: excess.is_finite(),
                };
            }
        }
        Self {
            columns: grid.columns,
            rows: grid.rows,
            nodes,
        }
    }

    /// Goes over all nodes once, each after its neighbours on two sides; the greatest change.
    fn sweep(&mut self, flip_rows: bool, flip_columns: bool) -> f64 {
        let mut change = 0.0_f64;
        for row in 1..=self.rows {
            let row = if flip_rows { self.rows + 1 - row } else { row };
            for column in 1..=self.columns {
                let column = if flip_columns {
                    self.columns + 1 - column
                } else {
                    column
                };
                let node = row * (self.columns + 2) + column;
                if self.nodes[node].is_fixed {
                    continue;
                }
                let (value, known) = (self.upwind(node), self.nodes[node].excess);
                if value < known {
                    change = change.max((known - value).min(1e9));
                    self.nodes[node].excess = value;
                }
            }
        }
        change
    }

    /// The excess at a node, from its neighbours.
    fn upwind(&self, node: usize) -> f64 {
        let FrontNode { grows, reach, .. } = self.nodes[node];
        // Least value that an axis would give alone.
        let axis = |grows: f64, back: usize, ahead: usize| {
            (self.nodes[back].excess - grows).min(self.nodes[ahead].excess + grows)
        };
        let a = axis(grows[0], node - 1, node + 1);
        let b = axis(grows[1], node - self.columns - 2, node + self.columns + 2);
        if (a - b).abs() < reach {
            0.5 * (a + b + (2.0 * reach * reach - (a - b) * (a - b)).sqrt())
        } else {
            a.min(b) + reach
        }
    }

    /// The excess at the nodes of the grid.
    fn excess(&self) -> Vec<f64> {
        let rows = self.nodes.chunks(self.columns + 2).skip(1).take(self.rows);
        let nodes = rows.flat_map(|row| &row[1..=self.columns]);
        nodes.map(|node| node.excess).collect()
    }
}

fn bilinear(grid: &Grid, values: &[f64], at: EastNorth) -> f64 {
    let node = grid.nearest(at);
    let position = grid.at(node);
    let east = (at.east_m - position.east_m) / grid.spacing_m;
    let north = (at.north_m - position.north_m) / grid.spacing_m;
    let side = |offset: f64| if offset < 0.0 { -1 } else { 1 };
    let value = |step| grid.step(node, step).map_or(values[node], |n| values[n]);
    let (dx, dy) = (side(east), side(north));
    let (x, y) = (east.abs().min(1.0), north.abs().min(1.0));
    (1.0 - y) * ((1.0 - x) * values[node] + x * value((dx, 0)))
        + y * ((1.0 - x) * value((0, dy)) + x * value((dx, dy)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn around(walls: &[(f64, f64, f64)], nodes: usize) -> f64 {
        let at = |east_m, north_m| EastNorth { east_m, north_m };
        let grid = Grid::over(at(0.0, 0.0), at(20_000.0, 20_000.0), nodes);
        let cost = (0..grid.len())
            .map(|node| {
                let inside = walls
                    .iter()
                    .any(|&(e, n, r)| grid.at(node).distance_m(at(e, n)) < r);
                if inside { 100.0 } else { 1.0 }
            })
            .collect();
        arrival(
            &Field {
                grid,
                cost,
                rises: None,
                climbs: None,
            },
            at(1000.0, 10_130.0),
            at(19_000.0, 10_130.0),
        )
    }

    #[test]
    fn in_the_open_it_is_the_straight_distance() {
        assert!((around(&[], 101) - 18.0).abs() < 1e-6);
    }

    #[test]
    fn around_a_disc_it_comes_near_tangent_arc_tangent() {
        // Axis on the straight line: two tangents and an arc, by hand.
        let (half, radius) = (9.0_f64, 3.0_f64);
        let tangent = (half * half - radius * radius).sqrt();
        let arc = radius * (std::f64::consts::PI - 2.0 * (radius / half).acos());
        let exact = 2.0 * tangent + arc;
        let found = around(&[(10_000.0, 10_130.0, 3000.0)], 201);
        assert!(
            (found / exact - 1.0).abs() < 0.01,
            "{found} against {exact}"
        );
    }
}

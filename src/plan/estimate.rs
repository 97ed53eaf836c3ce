//! What the relaxed problem suggests the best path costs.
//!
//! Turns, slopes and separation are dropped, altitude is free down to the floor, and
//! length is taken in the plane: then the best cost is the solution of the eikonal
//! equation `|grad u| = c` at the goal, found here by first-order fast sweeping (Zhao
//! 2005) of
//! `u = c_least |x - start| + psi`, which takes the singularity at the start out of the
//! scheme. Grid marching errs upward, so this proves nothing: an estimate.

use super::course::Course;
use super::field::{Field, Grid, Reading, Relief};
use crate::geodesy::EastNorth;

/// Rounds of four sweeps; a path that bends more often is not believed.
const MAX_ROUNDS: usize = 12;
/// Change of the solution that ends the sweeps, kilometres.
const SETTLED_KM: f64 = 1e-6;

/// The estimate for a course: the solution on a grid, extrapolated downward by what
/// halving its cells has changed, and never below the proven bound.
pub(super) fn estimate(course: &Course<'_>, budget: usize) -> f64 {
    let (start, goal) = (course.leg.from.at, course.leg.to.at);
    let prices = course.prices();
    let solve = |nodes: usize, near: bool| {
        let part = if near {
            course.near_box()
        } else {
            course.frame()
        };
        let grid = Grid::over(part.south_west, part.north_east, nodes);
        let relief = Relief::new(course.world, grid, &prices, Reading::Relaxed);
        arrival(&relief.field(f64::INFINITY, &prices), start, goal)
    };
    let nodes = if budget >= 20_000 { 101 } else { 51 };
    let (mut coarse, mut fine) = rayon::join(|| solve(nodes, true), || solve(2 * nodes - 1, true));
    if coarse > 2.0 * course.bound().max(1e-3) {
        (coarse, fine) = rayon::join(|| solve(nodes, false), || solve(2 * nodes - 1, false));
    }
    (fine - 2.0 * (coarse - fine).max(0.0)).max(course.bound())
}

/// Cost of the cheapest way through a field, kilometres times cost.
pub(super) fn arrival(field: &Field, start: EastNorth, goal: EastNorth) -> f64 {
    let grid = &field.grid;
    let least = field.cost.iter().copied().fold(f64::INFINITY, f64::min);
    let mut excess = vec![f64::INFINITY; grid.len()];
    // Around the start the way is straight, and its cost that of the node it leads to.
    for (node, excess) in excess.iter_mut().enumerate() {
        let distance_m = grid.at(node).distance_m(start);
        if distance_m <= 1.5 * grid.spacing_m {
            *excess = distance_m / 1000.0 * (field.cost[node] - least);
        }
    }
    let fixed: Vec<bool> = excess.iter().map(|e| e.is_finite()).collect();
    for _ in 0..MAX_ROUNDS {
        let mut change = 0.0_f64;
        for (flip_rows, flip_columns) in
            [(false, false), (false, true), (true, true), (true, false)]
        {
            for row in 0..grid.rows {
                let row = if flip_rows { grid.rows - 1 - row } else { row };
                for column in 0..grid.columns {
                    let column = if flip_columns {
                        grid.columns - 1 - column
                    } else {
                        column
                    };
                    let node = row * grid.columns + column;
                    if fixed[node] {
                        continue;
                    }
                    let value = upwind(field, &excess, node, start, least);
                    if value < excess[node] {
                        change = change.max((excess[node] - value).min(1e9));
                        excess[node] = value;
                    }
                }
            }
        }
        if change < SETTLED_KM {
            break;
        }
    }
    let at_goal = bilinear(field, &excess, goal);
    least * start.distance_m(goal) / 1000.0 + at_goal
}

/// The excess over the straight distance at a node, from its neighbours.
fn upwind(field: &Field, excess: &[f64], node: usize, start: EastNorth, least: f64) -> f64 {
    let grid = &field.grid;
    let cell_km = grid.spacing_m / 1000.0;
    let at = grid.at(node);
    let distance_m = at.distance_m(start).max(1e-9);
    let slope = (
        (at.east_m - start.east_m) / distance_m,
        (at.north_m - start.north_m) / distance_m,
    );
    // Least value each axis would give alone; `slope` is the derivative of the straight
    // distance towards growing east or north.
    let axis = |slope: f64, back: Option<usize>, ahead: Option<usize>| {
        let from = |other: Option<usize>, slope: f64| {
            other.map_or(f64::INFINITY, |other| {
                excess[other] - least * cell_km * slope
            })
        };
        from(back, slope).min(from(ahead, -slope))
    };
    let a = axis(slope.0, grid.step(node, (-1, 0)), grid.step(node, (1, 0)));
    let b = axis(slope.1, grid.step(node, (0, -1)), grid.step(node, (0, 1)));
    let reach = cell_km * field.cost[node];
    if (a - b).abs() < reach {
        0.5 * (a + b + (2.0 * reach * reach - (a - b) * (a - b)).sqrt())
    } else {
        a.min(b) + reach
    }
}

fn bilinear(field: &Field, values: &[f64], at: EastNorth) -> f64 {
    let grid = &field.grid;
    let node = grid.nearest(at);
    let place = grid.at(node);
    let east = (at.east_m - place.east_m) / grid.spacing_m;
    let north = (at.north_m - place.north_m) / grid.spacing_m;
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
            &Field { grid, cost },
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

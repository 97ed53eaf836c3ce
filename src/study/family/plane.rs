//! Problems that are hard in the plane.

use std::f64::consts::TAU;

use rand::RngExt;

use super::{At, Problem, Rng, Round, Zone};
use crate::numeric::as_f64;

/// Three to nine walls 30 to 80 m thick across 6 km, with gaps of 250 to 600 m.
pub(super) fn walls(rng: &mut Rng) -> Problem {
    const SIDE_M: f64 = 6000.0;
    const HALF_M: f64 = 0.5 * SIDE_M;
    /// Walls end beyond the area.
    const BEYOND_M: f64 = 300.0;
    let count = rng.random_range(3..=9_usize);
    let ends = [60.0, SIDE_M - 60.0].map(|north_m| (rng.random_range(-2000.0..2000.0), north_m));
    let mut problem = Problem::new(((-HALF_M, -100.0), (HALF_M, SIDE_M + 100.0)), ends.into());
    for wall in 0..count {
        let at_m = SIDE_M * as_f64(wall + 1) / as_f64(count + 1) + rng.random_range(-60.0..60.0);
        let to_m = at_m + rng.random_range(30.0..80.0);
        let gap_m = rng.random_range(250.0..600.0);
        problem.zones.push(match wall % 2 {
            0 => Zone::block((-HALF_M + gap_m, at_m), (HALF_M + BEYOND_M, to_m)),
            _ => Zone::block((-HALF_M - BEYOND_M, at_m), (HALF_M - gap_m, to_m)),
        });
    }
    problem
}

/// A tree of corridors, 5 by 5 to 7 by 7 cells of 160 to 260 m, from one corner to the opposite.
pub(super) fn maze(rng: &mut Rng) -> Problem {
    const HALF_WALL_M: f64 = 10.0;
    let (count, cell_m) = (
        rng.random_range(5..=7_usize),
        rng.random_range(160.0..260.0),
    );
    let far_m = as_f64(count) * cell_m;
    let (first, last) = (0.5 * cell_m, far_m - 0.5 * cell_m);
    let mut problem = Problem::new(((0.0, 0.0), (far_m, far_m)), ((first, first), (last, last)));
    problem.speed_mps = 5.0;
    let doors = doors(rng, count);
    let wall = |from: (usize, usize), to: (usize, usize)| {
        let at = |cell: usize| as_f64(cell) * cell_m;
        Zone::block(
            (at(from.0) - HALF_WALL_M, at(from.1) - HALF_WALL_M),
            (at(to.0) + HALF_WALL_M, at(to.1) + HALF_WALL_M),
        )
    };
    let cells = (0..count).flat_map(|row| (0..count).map(move |column| (column, row)));
    for (column, row) in cells {
        let closed = |to: (usize, usize)| !doors.contains(&((column, row), to));
        if row + 1 < count && closed((column, row + 1)) {
            problem
                .zones
                .push(wall((column, row + 1), (column + 1, row + 1)));
        }
        if column + 1 < count && closed((column + 1, row)) {
            problem
                .zones
                .push(wall((column + 1, row), (column + 1, row + 1)));
        }
    }
    problem
}

/// Pairs of cells, column and row, that are joined, the lower first: a tree by depth-first search.
fn doors(rng: &mut Rng, count: usize) -> Vec<((usize, usize), (usize, usize))> {
    let first: (usize, usize) = (0, 0);
    let (mut doors, mut seen, mut path) = (Vec::new(), vec![first], vec![first]);
    while let Some(&(column, row)) = path.last() {
        let around = [
            (column + 1, row),
            (column.wrapping_sub(1), row),
            (column, row + 1),
            (column, row.wrapping_sub(1)),
        ];
        let fresh = around
            .into_iter()
            .filter(|cell| cell.0 < count && cell.1 < count && !seen.contains(cell));
        let fresh: Vec<(usize, usize)> = fresh.collect();
        if fresh.is_empty() {
            path.pop();
            continue;
        }
        let next = fresh[rng.random_range(0..fresh.len())];
        let here = (column, row);
        doors.push(if here < next {
            (here, next)
        } else {
            (next, here)
        });
        seen.push(next);
        path.push(next);
    }
    doors
}

/// Blocks of 250 m with streets of 60 to 120 m, 60 to 150 m high or closed, a tenth left out.
pub(super) fn city(rng: &mut Rng) -> Problem {
    const BLOCK_M: f64 = 250.0;
    const STEP_M: f64 = 310.0;
    const COUNT: usize = 14;
    let far_m = as_f64(COUNT) * STEP_M;
    let ends = [-150.0, far_m + 100.0].map(|east_m| (east_m, rng.random_range(0.0..far_m)));
    let area = ((-300.0, -300.0), (far_m + 300.0, far_m + 300.0));
    let mut problem = Problem::new(area, ends.into());
    problem.max_amsl_m = 420.0;
    problem.speed_mps = 7.0;
    let cells = (0..COUNT).flat_map(|column| (0..COUNT).map(move |row| (column, row)));
    for (column, row) in cells {
        if rng.random_bool(0.1) {
            continue;
        }
        let from = (as_f64(column) * STEP_M, as_f64(row) * STEP_M);
        let mut side_m = || BLOCK_M - rng.random_range(0.0..60.0);
        let block = Zone::block(from, (from.0 + side_m(), from.1 + side_m()));
        let heights = [Some(360.0), Some(390.0), Some(450.0), None];
        problem
            .zones
            .push(match heights[rng.random_range(0..heights.len())] {
                Some(amsl_m) => block.below(amsl_m),
                None => block,
            });
    }
    problem
}

/// Three rows of threats across 10 km, each with a gap of 180 to 260 m.
pub(super) fn gaps(rng: &mut Rng) -> Problem {
    const LENGTH_M: f64 = 12_000.0;
    const HALF_M: f64 = 5000.0;
    /// Neighbours of a row overlap by this, metres.
    const OVERLAP_M: f64 = 40.0;
    let ends = [0.0, LENGTH_M].map(|east_m| (east_m, rng.random_range(-2000.0..2000.0)));
    let area = ((-1000.0, -HALF_M), (LENGTH_M + 1000.0, HALF_M));
    let mut problem = Problem::new(area, ends.into());
    for row in 1..=3 {
        let east_m = 0.25 * LENGTH_M * f64::from(row);
        let (middle_m, gap_m) = (
            rng.random_range(-2500.0..2500.0),
            rng.random_range(180.0..260.0),
        );
        for side in [1.0, -1.0] {
            let mut away_m = 0.5 * gap_m;
            while side * middle_m + away_m < HALF_M + 600.0 {
                let radius_m = rng.random_range(300.0..600.0);
                let at = (east_m, middle_m + side * (away_m + radius_m));
                problem.threats.push(Round {
                    at,
                    radius_m,
                    height_m: 0.0,
                });
                away_m += 2.0 * radius_m - OVERLAP_M;
            }
        }
    }
    problem
}

/// 94 km among 1000 threats and 500 polygons over gentle ground.
pub(super) fn far(rng: &mut Rng) -> Problem {
    const SIDE_M: f64 = 100_000.0;
    let ends: [At; 2] =
        [3000.0, SIDE_M - 3000.0].map(|east_m| (east_m, rng.random_range(20_000.0..80_000.0)));
    let mut problem = Problem::new(((0.0, 0.0), (SIDE_M, SIDE_M)), ends.into());
    problem.max_amsl_m = 1500.0;
    problem.speed_mps = 13.0;
    let anywhere = |rng: &mut Rng| (rng.random_range(0.0..SIDE_M), rng.random_range(0.0..SIDE_M));
    let open = |rng: &mut Rng| loop {
        let (at, radius_m) = (anywhere(rng), rng.random_range(300.0..1500.0));
        let is_free = |end: &At| (end.0 - at.0).hypot(end.1 - at.1) > radius_m + 800.0;
        if ends.iter().all(is_free) {
            break Round {
                at,
                radius_m,
                height_m: 0.0,
            };
        }
    };
    problem.threats = (0..1000).map(|_| open(rng)).collect();
    for _ in 0..500 {
        let Round { at, radius_m, .. } = open(rng);
        let (turn, count) = (rng.random_range(0.0..TAU), rng.random_range(3..=7_usize));
        let corner = |corner: usize| {
            let (sin, cos) = (turn + TAU * as_f64(corner) / as_f64(count)).sin_cos();
            (at.0 + radius_m * cos, at.1 + radius_m * sin)
        };
        problem.zones.push(Zone {
            corners: (0..count).map(corner).collect(),
            below_amsl_m: None,
        });
    }
    let hill = |rng: &mut Rng| Round {
        at: anywhere(rng),
        radius_m: rng.random_range(3000.0..9000.0),
        height_m: rng.random_range(50.0..300.0),
    };
    problem.hills = (0..60).map(|_| hill(rng)).collect();
    problem
}

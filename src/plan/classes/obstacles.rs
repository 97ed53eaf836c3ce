//! Obstacles: what stands out of the cost fields, and on which side a path passes it.

use std::cmp::Reverse;

use rayon::prelude::*;

use super::field::Field;
use crate::geodesy::EastNorth;

/// A maximum is an obstacle if it stands out by so much cost per kilometre.
const PERSISTENCE: f64 = 0.1;
/// Costs above this are all the same to an obstacle: walls merge to one.
const WALL: f64 = 6.0;
/// Obstacles nearer than this many cells are the same one.
const SAME_CELLS: f64 = 3.0;
/// Most obstacles: those that stand out least are dropped first.
const MAX_OBSTACLES: usize = 24;

/// Obstacles with rays across the straight line from start to goal.
#[derive(Clone, Debug)]
pub(crate) struct Obstacles {
    start: EastNorth,
    /// Unit vector from start to goal.
    along: (f64, f64),
    /// Distance along, distance across, and number of each obstacle.
    rays: Vec<(f64, f64, u64)>,
}

impl Obstacles {
    /// Obstacles of several fields over the same grid, as seen from `start` to `goal`.
    pub(crate) fn of(fields: &[Field], start: EastNorth, goal: EastNorth) -> Self {
        let of_field = |field: &Field| -> Vec<(f64, EastNorth, f64)> {
            let position =
                |(prominence, node)| (prominence, field.grid.at(node), field.grid.spacing_m);
            maxima(field).into_iter().map(position).collect()
        };
        let mut found = fields.par_iter().map(of_field).collect::<Vec<_>>().concat();
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut positions: Vec<EastNorth> = Vec::new();
        for (_, at, spacing_m) in found {
            let known = positions
                .iter()
                .any(|position| position.distance_m(at) < SAME_CELLS * spacing_m);
            if !known && positions.len() < MAX_OBSTACLES {
                positions.push(at);
            }
        }
        Self::at(positions, start, goal)
    }

    /// Obstacles at some positions.
    pub(crate) fn at(
        positions: impl IntoIterator<Item = EastNorth>,
        start: EastNorth,
        goal: EastNorth,
    ) -> Self {
        let length_m = start.distance_m(goal).max(1e-9);
        let along = (
            (goal.east_m - start.east_m) / length_m,
            (goal.north_m - start.north_m) / length_m,
        );
        let mut obstacles = Self {
            start,
            along,
            rays: Vec::new(),
        };
        for (index, position) in (0_u64..).zip(positions) {
            let (t, s) = obstacles.aligned(position);
            obstacles.rays.push((t, s, scramble(index)));
        }
        obstacles
    }

    /// Distances along and across the straight line.
    fn aligned(&self, at: EastNorth) -> (f64, f64) {
        let (east, north) = (
            at.east_m - self.start.east_m,
            at.north_m - self.start.north_m,
        );
        (
            east * self.along.0 + north * self.along.1,
            north * self.along.0 - east * self.along.1,
        )
    }

    /// What a straight step adds to the signature.
    pub(crate) fn crossing(&self, from: EastNorth, to: EastNorth) -> u64 {
        let ((t0, s0), (t1, s1)) = (self.aligned(from), self.aligned(to));
        let mut sum = 0_u64;
        for &(t, s, number) in &self.rays {
            if (t0 < t) == (t1 < t) {
                continue;
            }
            let across = s0 + (s1 - s0) * (t - t0) / (t1 - t0);
            if across > s {
                sum = if t0 < t {
                    sum.wrapping_add(number)
                } else {
                    sum.wrapping_sub(number)
                };
            }
        }
        sum
    }

    /// The signature of a path.
    pub(crate) fn signature(&self, line: &[EastNorth]) -> u64 {
        line.windows(2).fold(0, |sum, step| {
            sum.wrapping_add(self.crossing(step[0], step[1]))
        })
    }
}

/// A number for each index, unlike any other (splitmix64).
pub(crate) fn scramble(index: u64) -> u64 {
    let mut z = index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Local maxima that stand out, with their persistence: cells are flooded from the
/// dearest down, and a summit ends where its island meets a higher one.
fn maxima(field: &Field) -> Vec<(f64, usize)> {
    let height = |node: usize| field.cost[node].min(WALL);
    let mut order: Vec<usize> = (0..field.grid.len()).collect();
    order.sort_by(|&a, &b| height(b).total_cmp(&height(a)).then(a.cmp(&b)));
    let Some(&cheapest) = order.last() else {
        return Vec::new();
    };
    let mut island = vec![usize::MAX; field.grid.len()];
    let mut found = Vec::new();
    for &node in &order {
        island[node] = node;
        for rows in -1..=1 {
            for columns in -1..=1 {
                let Some(other) = field.grid.step(node, (columns, rows)) else {
                    continue;
                };
                if island[other] == usize::MAX {
                    continue;
                }
                let (a, b) = (summit(&mut island, node), summit(&mut island, other));
                if a == b {
                    continue;
                }
                let (high, low) = if (height(a), Reverse(a)) > (height(b), Reverse(b)) {
                    (a, b)
                } else {
                    (b, a)
                };
                let prominence = height(low) - height(node);
                if prominence > PERSISTENCE {
                    found.push((prominence, low));
                }
                island[low] = high;
            }
        }
    }
    let highest = order[0];
    let prominence = height(highest) - height(cheapest);
    if prominence > PERSISTENCE {
        found.push((prominence, highest));
    }
    found
}

/// The summit of a node's island, with the way to it shortened.
fn summit(island: &mut [usize], mut node: usize) -> usize {
    while island[node] != node {
        island[node] = island[island[node]];
        node = island[node];
    }
    node
}

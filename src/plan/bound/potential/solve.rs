//! The steepest potential that every price allows, by the primal-dual method of Chambolle and
//! Pock (2011) with diagonal steps (Pock and Chambolle 2011).

use rayon::prelude::*;

use super::gauge::{Slopes, project, rate};
use super::mesh::Mesh;

/// A triangle.
#[derive(Clone, Debug)]
struct Face {
    nodes: [usize; 3],
    /// Slope of the function that is 1 at one corner and 0 at the others, 1/km.
    gradients: [[f64; 2]; 3],
    /// Slope of the floor.
    tilt: [f64; 2],
    /// How far the lowest altitude may lie above the floor, km.
    below_km: f64,
}

/// Where a potential is limited.
pub(super) struct Prices<'a> {
    pub(super) mesh: &'a Mesh,
    /// Heights over the floor between which a potential is linear, km, ascending from 0.
    pub(super) levels_km: &'a [f64],
    /// The floor at each node, km.
    pub(super) floor_km: Vec<f64>,
    /// How far the lowest altitude may lie above the floor in each triangle, km.
    pub(super) below_km: Vec<f64>,
    /// Whether a path may be in a triangle above a level: level by level.
    pub(super) is_open: Vec<bool>,
    pub(super) slopes: Slopes,
    /// Of a km, and of a km at a km above the lowest altitude.
    pub(super) price: (f64, f64),
    /// Node and height over the floor of start and goal, km.
    pub(super) ends: [(usize, f64); 2],
}

/// Dual of the six slopes in a prism: east, north and up at each corner, below and above. Above
/// the last level only the first six are used.
pub(super) type Flow = [f64; 18];

/// A potential and its dual on one mesh.
pub(super) struct Solver<'a> {
    of: &'a Prices<'a>,
    faces: Vec<Face>,
    /// Triangle and level of each prism; the last level is open to the top.
    pub(super) prisms: Vec<(usize, usize)>,
    /// The prisms at each value, and at which of their six corners it is.
    around: Vec<Vec<(u32, u8)>>,
    /// Level by level, km.
    pub(super) potential: Vec<f64>,
    ahead: Vec<f64>,
    pub(super) flows: Vec<Flow>,
    steps: (Vec<f64>, Vec<f64>),
    weights: Vec<(usize, f64)>,
}

impl<'a> Solver<'a> {
    /// From a potential of 0.
    pub(super) fn new(of: &'a Prices<'a>) -> Self {
        let faces: Vec<Face> = (0..of.mesh.triangles.len())
            .map(|at| face(of, at))
            .collect();
        let prisms: Vec<(usize, usize)> = (0..of.levels_km.len())
            .flat_map(|level| (0..faces.len()).map(move |triangle| (triangle, level)))
            .filter(|(triangle, level)| of.is_open[level * faces.len() + triangle])
            .collect();
        let nodes = of.mesh.nodes.len();
        let size = nodes * of.levels_km.len();
        let mut around = vec![Vec::new(); size];
        for (rank, &(triangle, level)) in prisms.iter().enumerate() {
            let rank = u32::try_from(rank).unwrap_or(u32::MAX);
            for (corner, node) in (0_u8..).zip(faces[triangle].nodes) {
                around[level * nodes + node].push((rank, corner));
                if level + 1 < of.levels_km.len() {
                    around[(level + 1) * nodes + node].push((rank, corner + 3));
                }
            }
        }
        let weights = [-1.0, 1.0]
            .into_iter()
            .zip(of.ends)
            .flat_map(|(sign, end)| {
                let shares = shares(of.levels_km, end.1);
                shares.map(|(level, share)| (level * nodes + end.0, sign * share))
            });
        let mut solver = Self {
            of,
            weights: weights.collect(),
            steps: (Vec::new(), Vec::new()),
            potential: vec![0.0; size],
            ahead: vec![0.0; size],
            flows: vec![[0.0; 18]; prisms.len()],
            faces,
            prisms,
            around,
        };
        solver.steps = solver.diagonal_steps();
        solver
    }

    /// The mesh.
    pub(super) fn mesh(&self) -> &'a Mesh {
        self.of.mesh
    }

    /// How many levels there are.
    pub(super) fn levels(&self) -> usize {
        self.of.levels_km.len()
    }

    /// The prism of each triangle at each level, level by level; none where it is closed.
    pub(super) fn rank_of_prisms(&self) -> Vec<Option<usize>> {
        let mut ranks = vec![None; self.faces.len() * self.levels()];
        for (rank, &(triangle, level)) in self.prisms.iter().enumerate() {
            ranks[level * self.faces.len() + triangle] = Some(rank);
        }
        ranks
    }

    /// Begins at a potential.
    pub(super) fn start_at(&mut self, potential: Vec<f64>) {
        self.ahead.clone_from(&potential);
        self.potential = potential;
    }

    /// Steps of the potential and of the flows.
    fn diagonal_steps(&self) -> (Vec<f64>, Vec<f64>) {
        let mut columns = vec![0.0_f64; self.potential.len()];
        let rows = self.prisms.iter().map(|&(triangle, level)| {
            let face = &self.faces[triangle];
            let per_km = self.per_km(level);
            let row = (0..2).map(|axis| {
                let flat: f64 = face.gradients.iter().map(|slope| slope[axis].abs()).sum();
                flat + 2.0 * face.tilt[axis].abs() * per_km
            });
            row.fold(2.0 * per_km, f64::max).recip()
        });
        let rows = rows.collect();
        for (at, prisms) in self.around.iter().enumerate() {
            columns[at] = prisms
                .iter()
                .map(|&(rank, corner)| {
                    let (triangle, level) = self.prisms[rank as usize];
                    let face = &self.faces[triangle];
                    let flat: f64 = face.gradients[usize::from(corner) % 3]
                        .iter()
                        .map(|v| v.abs())
                        .sum();
                    let tilted = 1.0 + face.tilt[0].abs() + face.tilt[1].abs();
                    let sides = if self.per_km(level) > 0.0 { 3.0 } else { 6.0 };
                    sides * flat + 2.0 * tilted * self.per_km(level)
                })
                .sum();
        }
        let inverse = |sum: &f64| if *sum > 0.0 { sum.recip() } else { 0.0 };
        (columns.iter().map(inverse).collect(), rows)
    }

    /// One over the height of a level, 1/km; 0 above the last.
    fn per_km(&self, level: usize) -> f64 {
        let levels = self.of.levels_km;
        levels
            .get(level + 1)
            .map_or(0.0, |top| (top - levels[level]).recip())
    }

    /// The slopes of a potential in a prism: at each corner, below and above.
    fn slopes(&self, potential: &[f64], (triangle, level): (usize, usize)) -> Flow {
        let face = &self.faces[triangle];
        let nodes = self.of.mesh.nodes.len();
        let per_km = self.per_km(level);
        let below = face.nodes.map(|node| potential[level * nodes + node]);
        let above = match per_km > 0.0 {
            true => face.nodes.map(|node| potential[(level + 1) * nodes + node]),
            false => below,
        };
        let flat = |values: [f64; 3], axis: usize| {
            let [a, b, c] = face.gradients;
            a[axis] * values[0] + b[axis] * values[1] + c[axis] * values[2]
        };
        let sides = [below, above].map(|values| [flat(values, 0), flat(values, 1)]);
        let mut slopes = [0.0; 18];
        for corner in 0..3 {
            let up = (above[corner] - below[corner]) * per_km;
            for (side, flat) in sides.iter().enumerate() {
                let at = 6 * corner + 3 * side;
                slopes[at] = flat[0] - up * face.tilt[0];
                slopes[at + 1] = flat[1] - up * face.tilt[1];
                slopes[at + 2] = up;
            }
        }
        slopes
    }

    /// Least prices at the bottom and the top of a prism: linear in between, and never above the
    /// true one.
    fn prices(&self, (triangle, level): (usize, usize)) -> [f64; 2] {
        let (least, per_km) = self.of.price;
        let levels = self.of.levels_km;
        let below_km = self.faces[triangle].below_km;
        let bottom_km = levels[level];
        let top_km = *levels.get(level + 1).unwrap_or(&bottom_km);
        if bottom_km < below_km {
            return [least; 2];
        }
        [bottom_km, top_km].map(|height_km| least + per_km * (height_km - below_km))
    }

    /// One step; `balance` weighs flows against the potential.
    pub(super) fn step(&mut self, balance: f64) {
        let mut flows = std::mem::take(&mut self.flows);
        let ranks = flows.par_iter_mut().enumerate().with_min_len(256);
        let parts: Vec<[f64; 6]> = ranks
            .map(|(rank, flow)| self.flow_step(rank, flow, self.steps.1[rank] * balance))
            .collect();
        self.flows = flows;
        let mut sums: Vec<f64> = (self.around.par_iter().with_min_len(256))
            .map(|prisms| {
                prisms
                    .iter()
                    .map(|&(rank, corner)| parts[rank as usize][usize::from(corner)])
                    .sum()
            })
            .collect();
        for &(at, weight) in &self.weights {
            sums[at] -= weight;
        }
        for (at, sum) in sums.into_iter().enumerate() {
            let next = self.potential[at] - self.steps.0[at] / balance * sum;
            self.ahead[at] = 2.0 * next - self.potential[at];
            self.potential[at] = next;
        }
    }

    /// Moves the flow of a prism, and gives what it does to the values at its corners.
    fn flow_step(&self, rank: usize, flow: &mut Flow, step: f64) -> [f64; 6] {
        let prism = self.prisms[rank];
        let slopes = self.slopes(&self.ahead, prism);
        let prices = self.prices(prism);
        let face = &self.faces[prism.0];
        let per_km = self.per_km(prism.1);
        let (mut flat, mut up) = ([[0.0; 2]; 2], [0.0; 3]);
        for (corner, up) in up.iter_mut().enumerate() {
            for side in 0..2 {
                let at = 6 * corner + 3 * side;
                let target = [0, 1, 2].map(|axis| flow[at + axis] / step + slopes[at + axis]);
                let allowed = project(target, prices[side], &self.of.slopes);
                for axis in 0..3 {
                    flow[at + axis] = step * (target[axis] - allowed[axis]);
                }
                flat[side][0] += flow[at];
                flat[side][1] += flow[at + 1];
                *up += flow[at + 2] - flow[at] * face.tilt[0] - flow[at + 1] * face.tilt[1];
            }
        }
        let mut parts = [0.0; 6];
        for (corner, up) in up.into_iter().enumerate() {
            let along = |side: [f64; 2]| {
                face.gradients[corner][0] * side[0] + face.gradients[corner][1] * side[1]
            };
            parts[corner] = along(flat[0]) - up * per_km;
            parts[corner + 3] = along(flat[1]) + up * per_km;
        }
        if per_km <= 0.0 {
            for corner in 0..3 {
                parts[corner] += parts[corner + 3];
            }
        }
        parts
    }

    /// The potential at the goal less that at the start.
    fn rise(&self) -> f64 {
        self.weights
            .iter()
            .map(|&(at, weight)| weight * self.potential[at])
            .sum()
    }

    /// What the potential proves: its rise over how far it is beyond a price at most, as a share of
    /// it; 0 if that is no number.
    pub(super) fn proven(&self) -> f64 {
        let proven = self.rise() / self.most();
        if proven.is_finite() {
            proven.max(0.0)
        } else {
            0.0
        }
    }

    /// How far the potential is beyond a price at most, as a share of it.
    fn most(&self) -> f64 {
        let of_prism = |prism: &(usize, usize)| {
            let slopes = self.slopes(&self.potential, *prism);
            let prices = self.prices(*prism);
            let shares = slopes.chunks(3).zip(prices.into_iter().cycle());
            let share = |(slope, price): (&[f64], f64)| {
                rate(slope[0].hypot(slope[1]), slope[2], &self.of.slopes) / price
            };
            shares.map(share).fold(0.0, greatest)
        };
        self.prisms
            .par_iter()
            .with_min_len(256)
            .map(of_prism)
            .reduce(|| 0.0, greatest)
    }
}

/// The greater of two numbers; NaN if one of them is.
fn greatest(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// The levels around a height, and how much of each it is.
pub(super) fn shares(levels_km: &[f64], height_km: f64) -> [(usize, f64); 2] {
    let last = levels_km.len() - 1;
    let low = levels_km
        .iter()
        .rposition(|level| *level <= height_km)
        .unwrap_or(0);
    if low == last {
        return [(last, 1.0), (last, 0.0)];
    }
    let share = (height_km - levels_km[low]) / (levels_km[low + 1] - levels_km[low]);
    let share = share.clamp(0.0, 1.0);
    [(low, 1.0 - share), (low + 1, share)]
}

fn face(of: &Prices<'_>, triangle: usize) -> Face {
    let nodes = of.mesh.triangles[triangle];
    let [a, b, c] = nodes.map(|node| of.mesh.nodes[node].map(|metres| metres / 1000.0));
    let whole = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    let across =
        |from: [f64; 2], to: [f64; 2]| [(from[1] - to[1]) / whole, (to[0] - from[0]) / whole];
    let gradients = [across(b, c), across(c, a), across(a, b)];
    let floor = nodes.map(|node| of.floor_km[node]);
    let tilt = [0, 1].map(|axis| {
        (0..3)
            .map(|corner| gradients[corner][axis] * floor[corner])
            .sum()
    });
    Face {
        nodes,
        gradients,
        tilt,
        below_km: of.below_km[triangle],
    }
}

//! The altitudes of least cost over a fixed line in the plane.
//!
//! The altitude LP finds the lowest path, which dives into every dip. Over a fixed line the length
//! and the altitude of the objective are convex in the altitudes of the control points, and the
//! limits are linear: Newton's method with a logarithmic barrier (Boyd and Vandenberghe 2004,
//! chapter 11) finds the path of least cost from the one of the LP. Only neighbouring control
//! points meet in a sample, so the systems are banded.

use super::{Demand, Row};

/// Off-diagonals of the band: two neighbouring samples share five control points.
const BAND: usize = 5;
/// Limits are this much wider than those of the LP, so that its path lies inside: metres, and a
/// share of the steepest rise. The LP keeps more than that in reserve.
const WIDER_M: f64 = 0.05;
const STEEPER: f64 = 5e-4;
/// A path of no more than this above the LP's rise is inside its limits, metres.
const RISE_M: f64 = 1e-4;
/// Weights of the objective against the barrier, as gaps that they leave, in shares of the cost.
const GAPS: [f64; 2] = [2e-3, 1e-4];
/// Most Newton steps for each of them, and the decrease that ends them.
const STEPS: usize = 30;
const DECREASE: f64 = 0.05;
/// Share of the way to the nearest limit that a step may go.
const WITHIN: f64 = 0.95;
/// Tries with ever shorter steps.
const TRIES: usize = 12;

/// What altitude and length cost, in units of the objective.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AltitudePrices {
    /// A kilometre of path.
    pub length: f64,
    /// A kilometre of path a kilometre higher.
    pub altitude: f64,
}

/// A path over a fixed line, and the limits of its altitudes.
pub(crate) struct LeastCost<'a> {
    rows: &'a [Row],
    /// Horizontal length from each sample to the next, metres.
    runs_m: &'a [f64],
    /// Cost of a metre of altitude at each sample, and of a metre of length.
    altitude: Vec<f64>,
    length: f64,
    limits: Limits,
}

/// Limits that the first path keeps: of altitudes at samples and of rises between them, metres.
struct Limits {
    low_m: Vec<f64>,
    high_m: Vec<f64>,
    up_m: Vec<f64>,
    down_m: Vec<f64>,
}

/// Altitudes at the samples and rises between them, metres.
struct Profile {
    amsl_m: Vec<f64>,
    rise_m: Vec<f64>,
}

/// Slope and curvature of the barrier problem in the free control points; the band of row `j`
/// begins at its diagonal.
struct Newton {
    slope: Vec<f64>,
    band: Vec<[f64; BAND]>,
}

impl<'a> LeastCost<'a> {
    /// Around a path with the altitudes `amsl_m` of its control points that keeps a demand, as that
    /// of the LP does; no sample may be higher than `roof_m`. None where samples are too few for the band.
    pub(crate) fn new(
        rows: &'a [Row],
        (demand, runs_m): (&Demand, &'a [f64]),
        roof_m: &[f64],
        prices: AltitudePrices,
        amsl_m: &[f64],
    ) -> Option<Self> {
        let is_banded = rows.windows(2).all(|two| two[1].0 <= two[0].0 + 1);
        if !is_banded || amsl_m.len() < 5 {
            return None;
        }
        let first = Profile::of(rows, amsl_m);
        let last = rows.len() - 1;
        let sides = |k: usize| {
            let before = if k > 0 {
                first.length_m(runs_m, k - 1)
            } else {
                0.0
            };
            let after = if k < last {
                first.length_m(runs_m, k)
            } else {
                0.0
            };
            0.5 * (before + after)
        };
        let per_m = prices.altitude * 1e-6;
        Some(Self {
            altitude: (0..rows.len()).map(|k| per_m * sides(k)).collect(),
            length: prices.length * 1e-3,
            limits: Limits::around(&first, demand, roof_m),
            rows,
            runs_m,
        })
    }

    /// Lowers the cost of the altitudes of the control points, the ends apart, as far as the
    /// limits allow.
    pub(crate) fn improve(&self, amsl_m: &mut [f64]) {
        let mut here = Profile::of(self.rows, amsl_m);
        #[expect(clippy::cast_precision_loss, reason = "thousands of limits")]
        let count = (4 * self.rows.len()) as f64;
        let cost = self.cost(&here).max(1e-9);
        for gap in GAPS {
            let weight = count / (gap * cost);
            for _ in 0..STEPS {
                match self.step(weight, &here, amsl_m) {
                    Some((there, decrease)) => {
                        here = there;
                        if decrease < DECREASE {
                            break;
                        }
                    }
                    None => break,
                }
            }
        }
    }

    /// One Newton step; its profile and how much it was to gain. None without any gain.
    fn step(&self, weight: f64, here: &Profile, amsl_m: &mut [f64]) -> Option<(Profile, f64)> {
        let free = amsl_m.len() - 2;
        let newton = self.newton(weight, here, free);
        let step = newton.solve()?;
        let gain: f64 = step.iter().zip(&newton.slope).map(|(d, g)| -d * g).sum();
        if !gain.is_finite() || gain <= 0.0 {
            return None;
        }
        let mut moves_m = vec![0.0; amsl_m.len()];
        moves_m[1..=free].copy_from_slice(&step);
        let moved = Profile::of(self.rows, &moves_m);
        let mut share = (WITHIN * self.limits.reach(here, &moved)).min(1.0);
        let before = self.total(weight, here);
        for _ in 0..TRIES {
            let there = here.plus(&moved, share);
            let after = self.total(weight, &there);
            if after < before - 0.1 * share * gain {
                for (amsl_m, move_m) in amsl_m.iter_mut().zip(&moves_m) {
                    *amsl_m += share * move_m;
                }
                return Some((there, 0.5 * gain));
            }
            share *= 0.5;
        }
        None
    }

    /// Cost of the profile, but for a constant.
    fn cost(&self, at: &Profile) -> f64 {
        let pieces = at.rise_m.iter().zip(self.runs_m);
        let length_m: f64 = pieces
            .map(|(rise_m, run_m)| length_m(*rise_m, *run_m))
            .sum();
        let heights = at.amsl_m.iter().zip(&self.altitude).zip(&self.limits.low_m);
        let altitude: f64 = heights
            .map(|((amsl_m, price), low_m)| price * (amsl_m - low_m))
            .sum();
        self.length * length_m + altitude
    }

    /// The cost with its weight and the barrier.
    fn total(&self, weight: f64, at: &Profile) -> f64 {
        weight * self.cost(at) + self.limits.barrier(at)
    }

    fn newton(&self, weight: f64, at: &Profile, free: usize) -> Newton {
        let mut newton = Newton {
            slope: vec![0.0; free],
            band: vec![[0.0; BAND]; free],
        };
        let limits = &self.limits;
        for (k, (first, weights)) in self.rows.iter().enumerate() {
            let amsl_m = at.amsl_m[k];
            let (above, below) = (
                1.0 / (amsl_m - limits.low_m[k]),
                1.0 / (limits.high_m[k] - amsl_m),
            );
            let slope = weight * self.altitude[k] - above + below;
            let [a, b, c, d] = *weights;
            newton.add(
                *first,
                [a, b, c, d, 0.0],
                slope,
                above * above + below * below,
            );
        }
        let pairs = self.rows.windows(2).zip(self.runs_m).enumerate();
        for (k, (two, run_m)) in pairs {
            let rise_m = at.rise_m[k];
            let (up, down) = (
                1.0 / (limits.up_m[k] - rise_m),
                1.0 / (limits.down_m[k] + rise_m),
            );
            let length_m = length_m(rise_m, *run_m).max(1e-9);
            let price = weight * self.length / length_m;
            let slope = price * rise_m + up - down;
            let flat = run_m / length_m;
            let curvature = price * flat * flat + up * up + down * down;
            newton.add(two[0].0, difference(&two[0], &two[1]), slope, curvature);
        }
        newton
    }
}

/// Weights of five control points in the rise from one sample to the next.
fn difference((first, from): &Row, (next, to): &Row) -> [f64; BAND] {
    let mut weights = [0.0; BAND];
    for i in 0..4 {
        weights[i] -= from[i];
        weights[i + next - first] += to[i];
    }
    weights
}

impl Newton {
    /// Adds what depends on one sum of control points from number `first` on, ends included.
    fn add(&mut self, first: usize, weights: [f64; BAND], slope: f64, curvature: f64) {
        let free = self.slope.len();
        for (i, weight) in weights.iter().enumerate() {
            let Some(row) = (first + i).checked_sub(1).filter(|row| *row < free) else {
                continue;
            };
            self.slope[row] += slope * weight;
            let scaled = curvature * weight;
            for (entry, other) in self.band[row].iter_mut().zip(&weights[i..]) {
                *entry += scaled * other;
            }
        }
    }

    /// The step to the minimum of the quadratic, by a banded Cholesky factorisation; none where
    /// it is not positive definite.
    fn solve(&self) -> Option<Vec<f64>> {
        let free = self.slope.len();
        // Row j of the factor, transposed: its entries from the diagonal to the right.
        let mut upper = self.band.clone();
        for j in 0..free {
            for i in j.saturating_sub(BAND - 1)..j {
                let factor = upper[i][j - i];
                for m in 0..BAND - (j - i) {
                    upper[j][m] -= factor * upper[i][j - i + m];
                }
            }
            let root = upper[j][0].sqrt();
            if root.is_nan() || root <= 0.0 {
                return None;
            }
            for entry in &mut upper[j] {
                *entry /= root;
            }
        }
        let mut step: Vec<f64> = self.slope.iter().map(|slope| -slope).collect();
        for j in 0..free {
            for i in j.saturating_sub(BAND - 1)..j {
                step[j] -= upper[i][j - i] * step[i];
            }
            step[j] /= upper[j][0];
        }
        for j in (0..free).rev() {
            for m in 1..BAND.min(free - j) {
                step[j] -= upper[j][m] * step[j + m];
            }
            step[j] /= upper[j][0];
        }
        Some(step)
    }
}

impl Profile {
    fn of(rows: &[Row], controls: &[f64]) -> Self {
        let sum = |(first, weights): &Row| {
            let four = controls[*first..].iter().zip(weights);
            four.map(|(value, weight)| value * weight).sum::<f64>()
        };
        let amsl_m: Vec<f64> = rows.iter().map(sum).collect();
        let rise_m = amsl_m.windows(2).map(|two| two[1] - two[0]).collect();
        Self { amsl_m, rise_m }
    }

    fn plus(&self, other: &Self, share: f64) -> Self {
        let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + share * b).collect();
        Self {
            amsl_m: sum(&self.amsl_m, &other.amsl_m),
            rise_m: sum(&self.rise_m, &other.rise_m),
        }
    }

    /// Length of a piece in three dimensions, metres.
    fn length_m(&self, runs_m: &[f64], piece: usize) -> f64 {
        length_m(self.rise_m[piece], runs_m[piece])
    }
}

impl Limits {
    /// Those of a demand, but where a path misses them, what it keeps.
    fn around(path: &Profile, demand: &Demand, roof_m: &[f64]) -> Self {
        let heights = || path.amsl_m.iter().enumerate();
        let low = |(k, amsl_m): (usize, &f64)| demand.floor_m[k].min(*amsl_m) - WIDER_M;
        let high = |(k, amsl_m): (usize, &f64)| {
            let ceiling_m = demand.ceiling_m.get(k).copied().unwrap_or(f64::INFINITY);
            ceiling_m.min(roof_m[k]).max(amsl_m + WIDER_M)
        };
        let rises = |max_m: &[f64], sign: f64| {
            let rises = path.rise_m.iter().zip(max_m);
            let widened = |(rise_m, max_m): (&f64, &f64)| {
                (max_m * (1.0 + STEEPER)).max(sign * rise_m + RISE_M)
            };
            rises.map(widened).collect()
        };
        Self {
            low_m: heights().map(low).collect(),
            high_m: heights().map(high).collect(),
            up_m: rises(&demand.up_m, 1.0),
            down_m: rises(&demand.down_m, -1.0),
        }
    }

    /// How many times a move leads to the nearest limit.
    fn reach(&self, here: &Profile, moved: &Profile) -> f64 {
        let mut reach = f64::INFINITY;
        let mut bound = |space: f64, move_m: f64| {
            if move_m > 0.0 && space < reach * move_m {
                reach = space / move_m;
            }
        };
        for (k, (amsl_m, move_m)) in here.amsl_m.iter().zip(&moved.amsl_m).enumerate() {
            bound(amsl_m - self.low_m[k], -move_m);
            bound(self.high_m[k] - amsl_m, *move_m);
        }
        for (k, (rise_m, move_m)) in here.rise_m.iter().zip(&moved.rise_m).enumerate() {
            bound(self.up_m[k] - rise_m, *move_m);
            bound(self.down_m[k] + rise_m, -move_m);
        }
        reach
    }

    fn barrier(&self, at: &Profile) -> f64 {
        let mut sum = 0.0;
        for (k, amsl_m) in at.amsl_m.iter().enumerate() {
            sum -= space_ln(amsl_m - self.low_m[k], self.high_m[k] - amsl_m);
        }
        for (k, rise_m) in at.rise_m.iter().enumerate() {
            sum -= space_ln(self.up_m[k] - rise_m, self.down_m[k] + rise_m);
        }
        sum
    }
}

/// Length of a piece; `f64::hypot` guards against overflow and is many times slower.
fn length_m(rise_m: f64, run_m: f64) -> f64 {
    (rise_m * rise_m + run_m * run_m).sqrt()
}

/// The logarithm of both spaces; where there is no roof, of one.
fn space_ln(one: f64, other: f64) -> f64 {
    if one <= 0.0 || other <= 0.0 {
        return f64::NEG_INFINITY;
    }
    if other.is_finite() {
        (one * other).ln()
    } else {
        one.ln()
    }
}

#[cfg(test)]
mod tests;

//! The distribution a swarm draws its steps from, learnt from its best flies.
//!
//! CMA-ES (Hansen, "The CMA Evolution Strategy: A Tutorial", 2016, with its default
//! parameters) with positive weights only, in Cholesky form: the factor is taken
//! anew after each generation, which for the few dimensions of a path costs less
//! than one evaluation.

use fearless_simd::{Level, dispatch};
use nalgebra::{DMatrix, DVector};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::numeric::as_f64;

/// A normal distribution around a mean, scaled per variable.
pub(super) struct Adapted {
    mean: DVector<f64>,
    /// Unit of each variable.
    scale: DVector<f64>,
    sigma: f64,
    /// Its lower triangle: the upper one is not kept.
    covariance: DMatrix<f64>,
    /// Lower Cholesky factor of the covariance.
    factor: DMatrix<f64>,
    /// Evolution path of the covariance, p_c.
    path: DVector<f64>,
    /// Evolution path of the step size, p_sigma, in the factor's coordinates.
    step_path: DVector<f64>,
    generations: i32,
    rates: Rates,
}

/// A drawn step. Until it is taken it holds what was drawn for it.
pub(super) struct Draw {
    /// In standard normal coordinates.
    normal: DVector<f64>,
    /// In units of the step size and of each variable.
    step: DVector<f64>,
}

/// Weights and learning rates; they depend on the dimension and the flies alone.
struct Rates {
    weights: Vec<f64>,
    mu_eff: f64,
    path: f64,
    step: f64,
    damping: f64,
    rank_one: f64,
    rank_mu: f64,
    /// Expected length of a standard normal vector.
    expected_norm: f64,
}

impl Rates {
    fn new(dimension: usize, flies: usize) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "counts of flies and variables")]
        let (n, half) = (dimension as f64, flies as f64 / 2.0);
        let mut weights: Vec<f64> = (1..=flies / 2)
            .map(|rank| {
                #[expect(clippy::cast_precision_loss, reason = "counts of flies")]
                let rank = rank as f64;
                (half + 0.5).ln() - rank.ln()
            })
            .collect();
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= sum);
        let mu_eff = 1.0 / weights.iter().map(|w| w * w).sum::<f64>();
        let step = (mu_eff + 2.0) / (n + mu_eff + 5.0);
        let rank_one = 2.0 / ((n + 1.3).powi(2) + mu_eff);
        Self {
            weights,
            mu_eff,
            path: (4.0 + mu_eff / n) / (n + 4.0 + 2.0 * mu_eff / n),
            step,
            damping: 1.0 + 2.0 * (((mu_eff - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0) + step,
            rank_one,
            rank_mu: (2.0 * (mu_eff - 2.0 + 1.0 / mu_eff) / ((n + 2.0).powi(2) + mu_eff))
                .min(1.0 - rank_one),
            expected_norm: n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n)),
        }
    }
}

/// A standard normal number from one coordinate of a point drawn in the unit disc, and the square
/// of its distance from the centre (Marsaglia's polar method).
fn normal(u: f64, s: f64) -> f64 {
    u * (-2.0 * s.ln() / s).sqrt()
}

impl Adapted {
    /// Isotropic in units of `scale`, of standard deviation `sigma`, for swarms of
    /// `flies` (at least 4).
    pub(super) fn new(mean: &[f64], scale: &[f64], sigma: f64, flies: usize) -> Self {
        let n = mean.len();
        Self {
            mean: DVector::from_column_slice(mean),
            scale: DVector::from_column_slice(scale),
            sigma,
            covariance: DMatrix::identity(n, n),
            factor: DMatrix::identity(n, n),
            path: DVector::zeros(n),
            step_path: DVector::zeros(n),
            generations: 0,
            rates: Rates::new(n, flies),
        }
    }

    /// Its centre.
    pub(super) fn mean(&self) -> &[f64] {
        self.mean.as_slice()
    }

    /// Moves the centre and forgets where it came from, but keeps the shape.
    pub(super) fn move_to(&mut self, mean: &[f64]) {
        self.mean.copy_from_slice(mean);
        self.path.fill(0.0);
        self.step_path.fill(0.0);
    }

    /// Draws a step, which is not yet taken.
    pub(super) fn draw(&self, rng: &mut ChaCha8Rng) -> Draw {
        let n = self.mean.len();
        let mut draw = Draw {
            normal: DVector::zeros(n),
            step: DVector::zeros(n),
        };
        let mut count = 0;
        while count < n {
            let (u, v): (f64, f64) = (rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0));
            let s = u * u + v * v;
            (draw.normal[count], draw.step[count]) = (u, s);
            // What lies beyond the disc is written over: cheaper than a guess at a branch.
            count += usize::from((s > 0.0) & (s < 1.0));
        }
        draw
    }

    /// Takes a drawn step: the point that it leads to, kept in the unit cube.
    pub(super) fn take(&self, draw: &mut Draw, point: &mut [f64]) {
        let step = draw.step.as_mut_slice();
        for (number, s) in draw.normal.iter_mut().zip(step.iter_mut()) {
            *number = normal(*number, *s);
            *s = 0.0;
        }
        dispatch!(Level::new(), _simd => self.step_to(draw, point));
    }

    #[inline(always)]
    fn step_to(&self, draw: &mut Draw, point: &mut [f64]) {
        let step = draw.step.as_mut_slice();
        // The factor times the normal vector.
        let columns = self.factor.as_slice().chunks_exact(step.len());
        for (j, (&share, column)) in draw.normal.iter().zip(columns).enumerate() {
            let below = step[j..].iter_mut().zip(&column[j..]);
            below.for_each(|(step, factor)| *step += share * factor);
        }
        let steps = step.iter().zip(&self.scale);
        for (point, (mean, (step, scale))) in point.iter_mut().zip(self.mean.iter().zip(steps)) {
            *point = (mean + step * scale * self.sigma).clamp(0.0, 1.0);
        }
    }

    /// Learns from the draws of one generation. `orders` are their indices, best first, for each
    /// group of variables: the steps that are learnt from are put together, the first of what is
    /// first in each order, and so on, as many as half the draws.
    pub(super) fn learn(&mut self, draws: &[&Draw], orders: &[Vec<usize>]) {
        let n = self.mean.len();
        let size = n / orders.len();
        let step = |rank: usize| {
            DVector::from_fn(n, |variable, _| {
                draws[orders[variable / size][rank]].step[variable]
            })
        };
        let steps: Vec<DVector<f64>> = (0..self.rates.weights.len()).map(step).collect();
        let mut step_mean = DVector::zeros(n);
        for (step, &weight) in steps.iter().zip(&self.rates.weights) {
            step_mean.axpy(weight, step, 1.0);
        }
        let draw_mean = self.draw_mean(draws, orders, &step_mean);
        self.mean += step_mean.component_mul(&self.scale) * self.sigma;
        self.mean.apply(|x| *x = x.clamp(0.0, 1.0));
        self.generations += 1;
        self.adapt(&steps, &step_mean, &draw_mean);
    }

    /// Mean of the standard normal draws behind the mean step.
    fn draw_mean(
        &self,
        draws: &[&Draw],
        orders: &[Vec<usize>],
        step_mean: &DVector<f64>,
    ) -> DVector<f64> {
        let mut draw_mean = DVector::zeros(step_mean.len());
        match orders {
            [order] => {
                for (&draw, &weight) in order.iter().zip(&self.rates.weights) {
                    draw_mean.axpy(weight, &draws[draw].normal, 1.0);
                }
                draw_mean
            }
            // The factor has no zeros on its diagonal.
            _ => {
                let solved = self.factor.solve_lower_triangular(step_mean);
                solved.unwrap_or(draw_mean)
            }
        }
    }

    /// Adapts paths, covariance, its factor and the step size to the chosen steps.
    fn adapt(
        &mut self,
        steps: &[DVector<f64>],
        step_mean: &DVector<f64>,
        draw_mean: &DVector<f64>,
    ) {
        let (n, rates) = (self.mean.len(), &self.rates);
        let keep = 1.0 - rates.step;
        self.step_path.axpy(
            (rates.step * (2.0 - rates.step) * rates.mu_eff).sqrt(),
            draw_mean,
            keep,
        );
        let length = self.step_path.norm();
        let settled = (1.0 - keep.powi(2 * self.generations)).sqrt();
        let stalled = length / settled / rates.expected_norm > 1.4 + 2.0 / (as_f64(n) + 1.0);
        let gain = if stalled { 0.0 } else { 1.0 };
        self.path.axpy(
            gain * (rates.path * (2.0 - rates.path) * rates.mu_eff).sqrt(),
            step_mean,
            1.0 - rates.path,
        );
        let old = 1.0 - rates.rank_one - rates.rank_mu
            + (1.0 - gain) * rates.rank_one * rates.path * (2.0 - rates.path);
        self.covariance
            .syger(rates.rank_one, &self.path, &self.path, old);
        for (step, &weight) in steps.iter().zip(&rates.weights) {
            self.covariance
                .syger(rates.rank_mu * weight, step, step, 1.0);
        }
        let growth = (rates.step / rates.damping) * (length / rates.expected_norm - 1.0);
        self.sigma = (self.sigma * growth.clamp(-1.0, 1.0).exp()).clamp(1e-9, 1e3);
        match self.covariance.clone().cholesky() {
            Some(cholesky) => self.factor = cholesky.unpack(),
            None => self.forget_shape(),
        }
    }

    /// Back to a ball: the covariance has lost its definiteness.
    fn forget_shape(&mut self) {
        self.covariance.fill_with_identity();
        self.factor.fill_with_identity();
        self.path.fill(0.0);
        self.step_path.fill(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::Seed;

    #[test]
    fn normal_numbers_have_mean_zero_and_variance_one() {
        let mut rng = Seed(1).stream("test", 0);
        let adapted = Adapted::new(&[0.5; 50], &[1.0; 50], 0.1, 8);
        let numbers = |draw: Draw| {
            let polar = draw.normal.iter().zip(&draw.step);
            polar.map(|(&u, &s)| normal(u, s)).collect::<Vec<_>>()
        };
        let draws: Vec<f64> = (0..400)
            .flat_map(|_| numbers(adapted.draw(&mut rng)))
            .collect();
        let mean = draws.iter().sum::<f64>() / 20_000.0;
        let variance = draws.iter().map(|x| x * x).sum::<f64>() / 20_000.0;
        assert!(mean.abs() < 0.03, "{mean}");
        assert!((variance - 1.0).abs() < 0.05, "{variance}");
    }

    #[test]
    fn it_learns_the_shape_of_a_narrow_valley() {
        let mut rng = Seed(2).stream("test", 0);
        let valley = |p: &[f64]| (p[0] - p[1]).powi(2) * 1e4 + (p[0] + p[1] - 1.2).powi(2);
        let mut adapted = Adapted::new(&[0.2, 0.1], &[1.0, 1.0], 0.1, 12);
        for _ in 0..120 {
            let mut draws: Vec<Draw> = (0..12).map(|_| adapted.draw(&mut rng)).collect();
            let mut costs = [0.0; 12];
            for (draw, cost) in draws.iter_mut().zip(&mut costs) {
                let mut point = [0.0; 2];
                adapted.take(draw, &mut point);
                *cost = valley(&point);
            }
            let mut order: Vec<usize> = (0..12).collect();
            order.sort_by(|&a, &b| costs[a].total_cmp(&costs[b]));
            adapted.learn(&draws.iter().collect::<Vec<_>>(), &[order]);
        }
        assert!(adapted.mean.iter().all(|x| (x - 0.6).abs() < 1e-6));
    }
}

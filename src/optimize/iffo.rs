//! IFFO: improved fruit fly optimisation (Pan, Sang, Duan, Gao 2014; Table 1: radius
//! from 0.5 to 0.01).
//!
//! What is left open, and how it is read here:
//!
//! - Variables are coordinates in the unit cube, not distances of pairs (X, Y).
//! - `lambda = lmax exp(ln(lmin / lmax) it / NC)`, it from 1 to NC.
//! - Each fly takes the swarm's place and changes one random variable by
//!   `U(-1, 1) lambda`, clipped to the map.
//! - The swarm's place, uniform at first, is evaluated once, and moves to the best fly
//!   if that is better.
//! - One iteration evaluates M flies; NC follows from the budget.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::fly::keenest;
use super::{Evaluator, Problem, population};

/// Parameters of Table 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IffoParameters {
    /// Flies, M.
    pub population: usize,
    /// Search radius at the beginning and at the end, both above 0.
    pub radius: [f64; 2],
}

impl Default for IffoParameters {
    fn default() -> Self {
        Self {
            population: 100,
            radius: [0.5, 0.01],
        }
    }
}

/// Runs until the budget is spent.
pub(super) fn search<P: Problem + ?Sized>(
    evaluator: &mut Evaluator<'_, P>,
    parameters: &IffoParameters,
    rng: &mut ChaCha8Rng,
) {
    let flies = parameters.population.max(1);
    let iterations = evaluator.budget().saturating_sub(1).div_ceil(flies);
    let [largest, smallest] = parameters.radius;
    let mut location = population::uniform(evaluator.dimension(), rng);
    let mut smell = evaluator
        .evaluate(&location)
        .first()
        .copied()
        .unwrap_or(f64::INFINITY);
    for iteration in 1..=iterations {
        let radius =
            largest * ((smallest / largest).ln() * population::share(iteration, iterations)).exp();
        let swarm: Vec<Vec<f64>> = (0..flies)
            .map(|_| {
                let mut fly = location.clone();
                let j = rng.random_range(0..fly.len());
                fly[j] = (fly[j] + radius * rng.random_range(-1.0..1.0)).clamp(0.0, 1.0);
                fly
            })
            .collect();
        let found = evaluator.evaluate(&swarm.concat());
        let best = keenest(&found);
        if found[best] < smell {
            location.clone_from(&swarm[best]);
            smell = found[best];
        }
    }
}

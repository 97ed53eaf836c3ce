//! MFOA: multi-swarm fruit fly optimisation (Yuan, Dai, Zhao, He 2014; Table 1: 5 swarms).
//!
//! Its equations are not at hand, only its abstract: sub-swarms that move
//! independently, a local behaviour between sub-swarms, a shrinking radius. All of the
//! following is therefore an assumption:
//!
//! - Each fly is its swarm's place plus `R U(-1, 1)` in all variables, clipped;
//!   `R = 0.5 ((NC - it) / NC)^theta` with theta = 6, it from 0.
//! - A swarm moves to its best fly if that is better.
//! - Then the mean of the swarms' places is evaluated; if it beats the best of them,
//!   the worst swarm moves there.
//! - Places are uniform at first and evaluated once. One iteration evaluates M + 1; NC
//!   follows from the budget.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::fly::keenest;
use super::{Candidate, Evaluator, Problem, population};

/// Parameters of Table 1, and those assumed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MfoaParameters {
    /// Flies in all, M.
    pub population: usize,
    /// Swarms.
    pub swarms: usize,
    /// Radius at the beginning.
    pub radius: f64,
    /// Power with which the radius shrinks, theta.
    pub power: f64,
}

impl Default for MfoaParameters {
    fn default() -> Self {
        Self {
            population: 100,
            swarms: 5,
            radius: 0.5,
            power: 6.0,
        }
    }
}

/// Runs until the budget is spent; returns the swarms' places.
pub(super) fn search<P: Problem + ?Sized>(
    evaluator: &mut Evaluator<'_, P>,
    parameters: &MfoaParameters,
    rng: &mut ChaCha8Rng,
) -> Vec<Candidate> {
    let count = parameters.swarms.max(1);
    let flies = (parameters.population / count).max(1);
    let rows_each = count * flies + 1;
    let iterations = evaluator.budget().saturating_sub(count).div_ceil(rows_each);
    let positions: Vec<Vec<f64>> = (0..count)
        .map(|_| population::uniform(evaluator.dimension(), rng))
        .collect();
    let costs = evaluator.evaluate(&positions.concat());
    let mut swarms: Vec<Candidate> = positions
        .into_iter()
        .zip(costs)
        .map(|(position, cost)| Candidate { position, cost })
        .collect();
    for iteration in 0..iterations {
        let left = 1.0 - population::share(iteration, iterations);
        let radius = parameters.radius * left.powf(parameters.power);
        disperse(evaluator, &mut swarms, flies, radius, rng);
        meet(evaluator, &mut swarms);
    }
    swarms.retain(|swarm| swarm.cost.is_finite());
    swarms
}

/// Every swarm searches around its place.
fn disperse<P: Problem + ?Sized>(
    evaluator: &mut Evaluator<'_, P>,
    swarms: &mut [Candidate],
    flies: usize,
    radius: f64,
    rng: &mut ChaCha8Rng,
) {
    let all: Vec<Vec<f64>> = swarms
        .iter()
        .flat_map(|swarm| std::iter::repeat_n(&swarm.position, flies))
        .map(|position| {
            let near = |x: &f64| (x + radius * rng.random_range(-1.0..1.0)).clamp(0.0, 1.0);
            position.iter().map(near).collect()
        })
        .collect();
    let costs = evaluator.evaluate(&all.concat());
    for (swarm, (all, costs)) in swarms
        .iter_mut()
        .zip(all.chunks(flies).zip(costs.chunks(flies)))
    {
        let best = keenest(costs);
        if costs[best] < swarm.cost {
            *swarm = Candidate {
                position: all[best].clone(),
                cost: costs[best],
            };
        }
    }
}

/// The local behaviour between swarms: the worst moves to their mean if that is better
/// than the best.
fn meet<P: Problem + ?Sized>(evaluator: &mut Evaluator<'_, P>, swarms: &mut [Candidate]) {
    let mean: Vec<f64> = (0..evaluator.dimension())
        .map(|j| {
            let sum: f64 = swarms.iter().map(|swarm| swarm.position[j]).sum();
            sum * population::share(1, swarms.len())
        })
        .map(|x| x.min(1.0))
        .collect();
    let cost = evaluator.evaluate(&mean)[0];
    let best = swarms
        .iter()
        .map(|swarm| swarm.cost)
        .fold(f64::INFINITY, f64::min);
    let worst = swarms.iter_mut().max_by(|a, b| a.cost.total_cmp(&b.cost));
    if let Some(worst) = worst.filter(|_| cost < best) {
        *worst = Candidate {
            position: mean,
            cost,
        };
    }
}

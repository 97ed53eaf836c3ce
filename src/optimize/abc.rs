//! ABC: the artificial bee colony (Table 1: 50 employed bees, 50 onlookers, Limit = 20).
//!
//! What is left open, and how it is read here:
//!
//! - A bee changes one random variable, `v_j = x_j + U(-1, 1) (x_j - x_kj)` with k
//!   another source; what leaves the map is clipped. Better replaces at once.
//! - All employed bees fly from where the sources were at the beginning of the cycle,
//!   all onlookers from where these left them: moves are drawn before any is evaluated.
//! - An onlooker chooses source i with a probability in proportion to `1 / (1 + J_i)`.
//! - At most one scout a cycle: the source that failed most often, if more than Limit
//!   times, is drawn anew. Limit = 20 is the paper's; usual is sources times variables.
//! - A cycle evaluates 100, or 101 with a scout, and the first 50 sources once.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::{Evaluator, Problem, population};

/// Parameters of Table 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AbcParameters {
    /// Food sources, and employed bees, at least 2.
    pub sources: usize,
    /// Onlookers.
    pub onlookers: usize,
    /// Failures after which a source may be left.
    pub limit: usize,
}

impl Default for AbcParameters {
    fn default() -> Self {
        Self {
            sources: 50,
            onlookers: 50,
            limit: 20,
        }
    }
}

/// A food source.
struct Source {
    position: Vec<f64>,
    cost: f64,
    failures: usize,
}

/// Runs until the budget is spent.
pub(super) fn search<P: Problem + ?Sized>(
    evaluator: &mut Evaluator<'_, P>,
    parameters: &AbcParameters,
    rng: &mut ChaCha8Rng,
) {
    let dimension = evaluator.dimension();
    let count = parameters.sources.max(2);
    let positions: Vec<Vec<f64>> = (0..count)
        .map(|_| population::uniform(dimension, rng))
        .collect();
    let costs = evaluator.evaluate(&positions.concat());
    let mut sources: Vec<Source> = positions
        .into_iter()
        .zip(costs)
        .map(|(position, cost)| Source {
            position,
            cost,
            failures: 0,
        })
        .collect();
    while !evaluator.is_exhausted() {
        let employed: Vec<usize> = (0..count).collect();
        forage(evaluator, &mut sources, &employed, rng);
        let chosen = choices(&sources, parameters.onlookers, rng);
        forage(evaluator, &mut sources, &chosen, rng);
        scout(evaluator, &mut sources, parameters.limit, rng);
    }
}

/// One move from each of the listed sources.
fn forage<P: Problem + ?Sized>(
    evaluator: &mut Evaluator<'_, P>,
    sources: &mut [Source],
    from: &[usize],
    rng: &mut ChaCha8Rng,
) {
    let moves: Vec<Vec<f64>> = from
        .iter()
        .map(|&index| neighbour(sources, index, rng))
        .collect();
    let costs = evaluator.evaluate(&moves.concat());
    for ((&index, position), cost) in from.iter().zip(moves).zip(costs) {
        let source = &mut sources[index];
        if cost < source.cost {
            *source = Source {
                position,
                cost,
                failures: 0,
            };
        } else {
            source.failures += 1;
        }
    }
}

/// A source with one variable changed.
fn neighbour(sources: &[Source], index: usize, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let mut position = sources[index].position.clone();
    let j = rng.random_range(0..position.len());
    let other = (index + rng.random_range(1..sources.len())) % sources.len();
    let step = rng.random_range(-1.0..1.0) * (position[j] - sources[other].position[j]);
    position[j] = (position[j] + step).clamp(0.0, 1.0);
    position
}

/// The sources that the onlookers choose.
fn choices(sources: &[Source], onlookers: usize, rng: &mut ChaCha8Rng) -> Vec<usize> {
    let mut sum = 0.0;
    let sums: Vec<f64> = sources
        .iter()
        .map(|source| {
            sum += 1.0 / (1.0 + source.cost.max(0.0));
            sum
        })
        .collect();
    (0..onlookers)
        .map(|_| {
            let at = rng.random::<f64>() * sum;
            sums.partition_point(|&below| below <= at)
                .min(sources.len() - 1)
        })
        .collect()
}

/// Draws the most exhausted source anew, if it is exhausted.
fn scout<P: Problem + ?Sized>(
    evaluator: &mut Evaluator<'_, P>,
    sources: &mut [Source],
    limit: usize,
    rng: &mut ChaCha8Rng,
) {
    // The first of those that failed most.
    let worst = sources
        .iter_mut()
        .rev()
        .max_by_key(|source| source.failures);
    let Some(source) = worst.filter(|source| source.failures > limit) else {
        return;
    };
    let position = population::uniform(evaluator.dimension(), rng);
    let cost = evaluator.evaluate(&position).first().copied();
    *source = Source {
        position,
        cost: cost.unwrap_or(f64::INFINITY),
        failures: 0,
    };
}

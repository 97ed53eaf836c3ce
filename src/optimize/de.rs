//! DE: differential evolution, DE/rand/1/bin (Table 1: F random in [0.2, 0.9], cr = 0.9).
//!
//! What is left open, and how it is read here:
//!
//! - The paper's source of DE is a constrained one (feasibility ranking), but Table 1
//!   has no parameter of it: this is the plain form.
//! - F, "a random value in [0.2, 0.9]", is drawn for each individual.
//! - a, b and c are distinct and other than the individual; one variable at least is
//!   taken from the mutant.
//! - What leaves the map is clipped, or with [`DeParameters::midpoint`] put halfway
//!   between the parent and the edge.
//! - A child replaces its parent if it costs no more; all at once after an iteration.
//! - Evaluating the first population, uniform in the cube, is the first iteration.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::{Candidate, Evaluator, Problem, population};

/// Parameters of Table 1, and how the map's edge is met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeParameters {
    /// Individuals, at least 4.
    pub population: usize,
    /// Least and greatest scaling factor F.
    pub scale: [f64; 2],
    /// Crossover factor cr.
    pub crossover: f64,
    /// Whether what leaves the map is put halfway to its edge instead of on it.
    pub midpoint: bool,
}

impl Default for DeParameters {
    fn default() -> Self {
        Self {
            population: 100,
            scale: [0.2, 0.9],
            crossover: 0.9,
            midpoint: false,
        }
    }
}

/// Runs until the budget is spent.
pub(super) fn search<P: Problem + ?Sized>(
    evaluator: &mut Evaluator<'_, P>,
    parameters: &DeParameters,
    rng: &mut ChaCha8Rng,
) {
    let dimension = evaluator.dimension();
    let count = parameters.population.max(4);
    let first: Vec<Vec<f64>> = (0..count)
        .map(|_| population::uniform(dimension, rng))
        .collect();
    let costs = evaluator.evaluate(&first.concat());
    let mut all: Vec<Candidate> = first
        .into_iter()
        .zip(costs)
        .map(|(position, cost)| Candidate { position, cost })
        .collect();
    while !evaluator.is_exhausted() {
        let children: Vec<Vec<f64>> = (0..count)
            .map(|parent| child(&all, parent, parameters, rng))
            .collect();
        let costs = evaluator.evaluate(&children.concat());
        for ((parent, position), cost) in all.iter_mut().zip(children).zip(costs) {
            if cost <= parent.cost {
                *parent = Candidate { position, cost };
            }
        }
    }
}

/// The trial vector of one individual.
fn child(
    all: &[Candidate],
    parent: usize,
    parameters: &DeParameters,
    rng: &mut ChaCha8Rng,
) -> Vec<f64> {
    let [a, b, c] = three_others(all.len(), parent, rng);
    let at = |index: usize| all[index].position.as_slice();
    let [low, high] = parameters.scale;
    let scale = rng.random_range(low..=high);
    let forced = rng.random_range(0..at(parent).len());
    at(parent)
        .iter()
        .enumerate()
        .map(|(j, &x)| {
            let crosses = rng.random::<f64>() < parameters.crossover || j == forced;
            if !crosses {
                return x;
            }
            let mutant = at(a)[j] + scale * (at(b)[j] - at(c)[j]);
            let edge = mutant.clamp(0.0, 1.0);
            let is_inside = (0.0..=1.0).contains(&mutant);
            if parameters.midpoint && !is_inside {
                0.5 * (x + edge)
            } else {
                edge
            }
        })
        .collect()
}

/// Three distinct indices below `count`, none of them `parent`.
fn three_others(count: usize, parent: usize, rng: &mut ChaCha8Rng) -> [usize; 3] {
    let mut chosen = [parent; 3];
    for k in 0..3 {
        chosen[k] = loop {
            let index = rng.random_range(0..count);
            if index != parent && !chosen[..k].contains(&index) {
                break index;
            }
        };
    }
    chosen
}

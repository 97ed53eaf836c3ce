//! FOA: the fruit fly optimisation algorithm (Pan 2012; Eq. 2 to 6 of the paper).
//!
//! What is left open, and how it is read here:
//!
//! - Every decision variable has its own pair (X, Y), as in MSFOA, so that FOA is
//!   MSFOA without swarms, threshold and offspring.
//! - Eq. 3 has the smell judgement `S = 1 / D` with D the distance to the origin,
//!   MSFOA `S = D`. Here `S = D`; [`FoaParameters::reciprocal`] is the other. Then
//!   flies live outside the unit disc, S <= 1 being D >= 1, and begin uniform in the
//!   ring of 1 <= D <= 10.
//! - A step is U(-1, 1) in X and in Y; a pair with S > 1 is drawn again, for that
//!   variable only, up to 100 times; then the swarm's own value stays.
//! - The first location is not evaluated: the first iteration's best fly replaces it.
//! - One iteration evaluates M flies.

use rand_chacha::ChaCha8Rng;

use super::fly::{Fly, Mapping, keenest, smells};
use super::{Evaluator, Problem};
use rand::RngExt;

/// Parameters; Table 1 has the population alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoaParameters {
    /// Flies, M.
    pub population: usize,
    /// Whether S is 1 / D instead of D.
    pub reciprocal: bool,
}

impl Default for FoaParameters {
    fn default() -> Self {
        Self {
            population: 100,
            reciprocal: false,
        }
    }
}

/// Draws before a variable keeps its swarm's value.
const MAX_DRAWS: usize = 100;
/// Outer radius of the ring in which reciprocal flies begin.
const RING: f64 = 10.0;

/// A pair of a reciprocal swarm, its S at most 1.
type Pair = (f64, f64);

/// Runs until the budget is spent.
pub(super) fn search<P: Problem + ?Sized>(
    evaluator: &mut Evaluator<'_, P>,
    parameters: &FoaParameters,
    rng: &mut ChaCha8Rng,
) {
    let flies = parameters.population.max(1);
    if parameters.reciprocal {
        reciprocal(evaluator, flies, rng);
    } else {
        direct(evaluator, flies, rng);
    }
}

/// With S = D.
fn direct<P: Problem + ?Sized>(
    evaluator: &mut Evaluator<'_, P>,
    flies: usize,
    rng: &mut ChaCha8Rng,
) {
    let mut location = Fly::random(evaluator.dimension(), rng);
    let mut smell = f64::INFINITY;
    while !evaluator.is_exhausted() {
        let swarm: Vec<Fly> = (0..flies).map(|_| location.olfactory(|u| u, rng)).collect();
        let found = smells(evaluator, &swarm, Mapping::Variable);
        let best = keenest(&found);
        if found[best] < smell {
            location = swarm[best].clone();
            smell = found[best];
        }
    }
}

/// With S = 1 / D.
fn reciprocal<P: Problem + ?Sized>(
    evaluator: &mut Evaluator<'_, P>,
    flies: usize,
    rng: &mut ChaCha8Rng,
) {
    let dimension = evaluator.dimension();
    let mut location: Vec<Pair> = (0..dimension).map(|_| in_ring(rng)).collect();
    let mut smell = f64::INFINITY;
    while !evaluator.is_exhausted() {
        let swarm: Vec<Vec<Pair>> = (0..flies)
            .map(|_| location.iter().map(|&pair| stepped(pair, rng)).collect())
            .collect();
        let rows: Vec<f64> = swarm
            .iter()
            .flatten()
            .map(|pair| (1.0 / pair.0.hypot(pair.1)).min(1.0))
            .collect();
        let found = evaluator.evaluate(&rows);
        let best = keenest(&found);
        if found[best] < smell {
            location.clone_from(&swarm[best]);
            smell = found[best];
        }
    }
}

/// Uniform in the ring, by rejection.
fn in_ring(rng: &mut ChaCha8Rng) -> Pair {
    loop {
        let pair: Pair = (rng.random_range(-RING..RING), rng.random_range(-RING..RING));
        if (1.0..=RING).contains(&pair.0.hypot(pair.1)) {
            return pair;
        }
    }
}

/// A pair one step on, its S at most 1.
fn stepped((x0, y0): Pair, rng: &mut ChaCha8Rng) -> Pair {
    for _ in 0..MAX_DRAWS {
        let (x, y) = (
            x0 + rng.random_range(-1.0..1.0),
            y0 + rng.random_range(-1.0..1.0),
        );
        if x * x + y * y >= 1.0 {
            return (x, y);
        }
    }
    (x0, y0)
}

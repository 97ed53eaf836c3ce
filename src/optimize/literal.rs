//! MSFOA as printed: Algorithm 2 of Shi, Zhang, Xia, Appl. Sci. 2020, 10(8), 2822.
//!
//! What the paper leaves open, and how it is read here:
//!
//! - Mapping (Eq. 31 to 33): each decision variable has its own pair (X, Y) in the
//!   unit disc and is `S = sqrt(X^2 + Y^2)`, Eq. 11. Step 8 tests only S <= 1, which
//!   keeps a path in the map only if each coordinate is a scalar of its own.
//! - Swarm locations start uniform in the disc by rejection; each is evaluated once,
//!   so that `smell_best` is defined before the first test against the threshold.
//! - Above the threshold a fly steps by Eq. 7 and 8, else by Eq. 9 and 10; the text
//!   cites them as (10), (11). The switch is per swarm. The random numbers of X and Y
//!   are independent. Steps are in units of the whole map.
//! - A pair that leaves the disc is drawn again, for that variable only (step 8
//!   returns to step 7); after 100 draws the swarm's own value stays.
//! - `oldbest` is the best fly of this iteration, not the swarm's location (Eq. 12, 13).
//! - Offspring (Eq. 14) are made after all swarms have searched (Algorithm 2 has
//!   separate loops): `0.8 oldbest_q + 0.2 X_i` with q uniform over the swarms, drawn
//!   once for each fly, own swarm allowed. Two points of the disc mix to a point of
//!   the disc, so the jump of step 14 is never taken.
//! - A swarm moves only to something strictly better than its location (the sentence
//!   after Eq. 19); between equal old and new the old one wins.
//! - R, "searching step dwindled parameter", is printed without an index: constant
//!   (0.1) to the letter. [`Step::Dwindling`] is the other reading,
//!   `R(nc) = R0 (1 - (nc - 1) / NC)^2`.
//! - The threshold is not printed; it is a cost of one vehicle, 1000.
//! - One iteration evaluates 2 M = 200 flies; NC follows from the budget.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::FRAC_PI_2;

use super::{Candidate, Evaluator, Problem};

/// Weight of the best fly in its offspring, coe1 of Eq. 15 (Table 1); coe2 is the rest.
const PARENT_WEIGHT: f64 = 0.8;
/// Draws before a variable keeps its swarm's value.
const MAX_DRAWS: usize = 100;

/// The local searching step R of Eq. 9 and 10.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// The same throughout.
    Constant(f64),
    /// From this value to 0, with the square of the iterations left.
    Dwindling(f64),
}

/// Parameters of Table 1, and those it lacks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiteralParameters {
    /// Flies in all, M.
    pub population: usize,
    /// Swarms, G.
    pub swarms: usize,
    /// Cost above which a swarm searches globally.
    pub threshold: f64,
    /// The local step.
    pub step: Step,
}

impl LiteralParameters {
    /// M = 100 and G = 5 of Table 1, threshold 1000, R = 0.1.
    #[must_use]
    pub fn literal() -> Self {
        Self {
            population: 100,
            swarms: 5,
            threshold: 1000.0,
            step: Step::Constant(0.1),
        }
    }

    /// The same with R shrinking from 0.3.
    #[must_use]
    pub fn dwindle() -> Self {
        Self {
            step: Step::Dwindling(0.3),
            ..Self::literal()
        }
    }
}

/// One pair (X, Y) for each decision variable.
#[derive(Clone)]
struct Fly {
    pairs: Vec<(f64, f64)>,
}

/// A swarm's location and smell.
struct Swarm {
    location: Fly,
    smell: f64,
}

impl Fly {
    /// Uniform in the unit disc, by rejection.
    fn random(dimension: usize, rng: &mut ChaCha8Rng) -> Self {
        let pair = |rng: &mut ChaCha8Rng| loop {
            let (x, y) = (rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0));
            if x * x + y * y <= 1.0 {
                break (x, y);
            }
        };
        Self {
            pairs: (0..dimension).map(|_| pair(rng)).collect(),
        }
    }

    /// Eq. 7 to 10 around this location: `step` maps a number of (-1, 1) to a step.
    fn olfactory(&self, step: impl Fn(f64) -> f64, rng: &mut ChaCha8Rng) -> Self {
        let mut draw = |(x0, y0): (f64, f64)| {
            for _ in 0..MAX_DRAWS {
                let x = x0 + step(rng.random_range(-1.0..1.0));
                let y = y0 + step(rng.random_range(-1.0..1.0));
                if x * x + y * y <= 1.0 {
                    return (x, y);
                }
            }
            (x0, y0)
        };
        Self {
            pairs: self.pairs.iter().map(|&pair| draw(pair)).collect(),
        }
    }

    /// Eq. 14 and 15: mostly `self`, partly `other`.
    fn cross(&self, other: &Self) -> Self {
        let mix = |a: f64, b: f64| PARENT_WEIGHT * a + (1.0 - PARENT_WEIGHT) * b;
        Self {
            pairs: self
                .pairs
                .iter()
                .zip(&other.pairs)
                .map(|(a, b)| (mix(a.0, b.0), mix(a.1, b.1)))
                .collect(),
        }
    }

    /// Eq. 11. A mixture may pass 1 by rounding.
    fn position(&self) -> Vec<f64> {
        self.pairs
            .iter()
            .map(|(x, y)| (x * x + y * y).sqrt().min(1.0))
            .collect()
    }
}

/// Smells of flies, in order.
fn smells<P: Problem + ?Sized>(evaluator: &mut Evaluator<'_, P>, flies: &[Fly]) -> Vec<f64> {
    let rows: Vec<f64> = flies.iter().flat_map(Fly::position).collect();
    evaluator.evaluate(&rows)
}

/// Index of the first least smell of one swarm (Eq. 12 and 17).
fn keenest(smells: &[f64]) -> usize {
    (0..smells.len())
        .min_by(|&a, &b| smells[a].total_cmp(&smells[b]))
        .unwrap_or(0)
}

/// Runs until the budget is spent; returns the swarms' locations.
pub(super) fn search<P: Problem + ?Sized>(
    evaluator: &mut Evaluator<'_, P>,
    parameters: &LiteralParameters,
    rng: &mut ChaCha8Rng,
) -> Vec<Candidate> {
    let count = parameters.swarms.max(1);
    let flies_each = (parameters.population / count).max(1);
    let iterations = (evaluator.budget().saturating_sub(count))
        .div_ceil(2 * count * flies_each)
        .max(1);
    let locations: Vec<Fly> = (0..count)
        .map(|_| Fly::random(evaluator.dimension(), rng))
        .collect();
    let first = smells(evaluator, &locations);
    let mut swarms: Vec<Swarm> = locations
        .into_iter()
        .zip(first)
        .map(|(location, smell)| Swarm { location, smell })
        .collect();
    for iteration in 0..iterations {
        if evaluator.is_exhausted() {
            break;
        }
        let radius = local_step(parameters.step, iteration, iterations);
        let old: Vec<Fly> = swarms
            .iter()
            .flat_map(|swarm| std::iter::repeat_n(swarm, flies_each))
            .map(|swarm| {
                if swarm.smell > parameters.threshold {
                    swarm.location.olfactory(|u| (FRAC_PI_2 * u).sin(), rng)
                } else {
                    swarm.location.olfactory(|u| radius * u, rng)
                }
            })
            .collect();
        let old_smells = smells(evaluator, &old);
        let best_of = |swarm: usize, smells: &[f64]| {
            swarm * flies_each + keenest(&smells[swarm * flies_each..][..flies_each])
        };
        let new: Vec<Fly> = old
            .iter()
            .map(|fly| {
                let parent = rng.random_range(0..count);
                old[best_of(parent, &old_smells)].cross(fly)
            })
            .collect();
        let new_smells = smells(evaluator, &new);
        for (g, swarm) in swarms.iter_mut().enumerate() {
            let (a, b) = (best_of(g, &old_smells), best_of(g, &new_smells));
            let (fly, smell) = if new_smells[b] < old_smells[a] {
                (&new[b], new_smells[b])
            } else {
                (&old[a], old_smells[a])
            };
            if smell < swarm.smell {
                *swarm = Swarm {
                    location: fly.clone(),
                    smell,
                };
            }
        }
    }
    swarms
        .iter()
        .filter(|swarm| swarm.smell.is_finite())
        .map(|swarm| Candidate {
            position: swarm.location.position(),
            cost: swarm.smell,
        })
        .collect()
}

/// R in an iteration, counted from 0.
fn local_step(step: Step, iteration: usize, iterations: usize) -> f64 {
    match step {
        Step::Constant(radius) => radius,
        Step::Dwindling(radius) => {
            #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 iterations")]
            let left = 1.0 - iteration as f64 / iterations as f64;
            radius * left * left
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::Seed;

    #[test]
    fn the_local_step_dwindles_from_its_start_to_almost_nothing() {
        assert!((local_step(Step::Dwindling(0.3), 0, 200) - 0.3).abs() < 1e-15);
        assert!((local_step(Step::Dwindling(0.3), 100, 200) - 0.075).abs() < 1e-15);
        assert!(local_step(Step::Dwindling(0.3), 199, 200) < 1e-5);
    }

    #[test]
    fn flies_and_their_offspring_stay_in_the_unit_disc() {
        let mut rng = Seed(3).stream("test", 0);
        let (a, b) = (Fly::random(50, &mut rng), Fly::random(50, &mut rng));
        for fly in [
            a.olfactory(|u| (FRAC_PI_2 * u).sin(), &mut rng),
            a.olfactory(|u| 0.1 * u, &mut rng),
            a.cross(&b),
        ] {
            assert!(fly.pairs.iter().all(|(x, y)| x * x + y * y <= 1.0 + 1e-12));
            assert!(fly.position().iter().all(|s| (0.0..=1.0).contains(s)));
        }
    }
}

//! MSFOA as printed: Algorithm 2 of Shi, Zhang, Xia, Appl. Sci. 2020, 10(8), 2822.
//!
//! What the paper leaves open, and how it is read here:
//!
//! - Mapping (Eq. 31 to 33): each decision variable has its own pair (X, Y) in the
//!   unit disc and is `S = sqrt(X^2 + Y^2)`, Eq. 11. Step 8 tests only S <= 1, which
//!   keeps a path in the map only if each coordinate is a scalar of its own.
//!   [`Mapping::Point`] is the other reading, a pair for each control point.
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
//!   once for each fly, own swarm allowed; with [`Parents::EachPair`], as Eq. 38 could be
//!   read, anew for each pair. Two points of the disc mix to a point of the disc, so the
//!   jump of step 14 is never taken.
//! - A swarm moves only to something strictly better than its location (the sentence
//!   after Eq. 19); between equal old and new the old one wins.
//! - R, "searching step dwindled parameter", is printed without an index: constant
//!   (0.1) to the letter. [`Step::Dwindling`] is the other reading,
//!   `R(nc) = R0 (1 - (nc - 1) / NC)^2`.
//! - The threshold is not printed; it is a cost of one vehicle, 1000.
//! - One iteration evaluates 2 M = 200 flies; NC follows from the budget.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::fly::{Fly, Mapping, big_step, keenest, smells};
use super::{Candidate, Evaluator, Problem};

/// The local searching step R of Eq. 9 and 10.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// The same throughout.
    Constant(f64),
    /// From this value to 0, with the square of the iterations left.
    Dwindling(f64),
}

/// For what a parent of offspring is drawn, q of Eq. 14.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parents {
    /// Once for a fly.
    EachFly,
    /// For every pair of it.
    EachPair,
}

/// Parameters of Table 1, and those it lacks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PublishedParameters {
    /// Flies in all, M.
    pub population: usize,
    /// Swarms, G.
    pub swarms: usize,
    /// Cost above which a swarm searches globally.
    pub threshold: f64,
    /// The local step.
    pub step: Step,
    /// Whether flies have offspring (Eq. 14 to 19); without, an iteration evaluates M.
    pub offspring: bool,
    /// For what their parents are drawn.
    pub parents: Parents,
    /// What a pair (X, Y) stands for; [`Mapping::Point`] needs a problem of points in space.
    pub mapping: Mapping,
}

impl PublishedParameters {
    /// M = 100 and G = 5 of Table 1, threshold 1000, R = 0.1.
    #[must_use]
    pub fn literal() -> Self {
        Self {
            population: 100,
            swarms: 5,
            threshold: 1000.0,
            step: Step::Constant(0.1),
            offspring: true,
            parents: Parents::EachFly,
            mapping: Mapping::Variable,
        }
    }

    /// Evaluations of one iteration.
    fn evaluations_each(&self, flies: usize) -> usize {
        if self.offspring { 2 * flies } else { flies }
    }

    /// Evaluations of all iterations, those of the first locations included.
    #[must_use]
    pub fn evaluations(&self, iterations: usize) -> usize {
        let swarms = self.swarms.max(1);
        let flies = swarms * (self.population / swarms).max(1);
        swarms + iterations * self.evaluations_each(flies)
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

/// A swarm's location and smell.
struct Swarm {
    location: Fly,
    smell: f64,
}

/// Runs until the budget is spent; returns the swarms' locations.
pub(super) fn search<P: Problem + ?Sized>(
    evaluator: &mut Evaluator<'_, P>,
    parameters: &PublishedParameters,
    rng: &mut ChaCha8Rng,
) -> Vec<Candidate> {
    let count = parameters.swarms.max(1);
    let flies_each = (parameters.population / count).max(1);
    let iterations = (evaluator.budget().saturating_sub(count))
        .div_ceil(parameters.evaluations_each(count * flies_each))
        .max(1);
    let locations: Vec<Fly> = (0..count)
        .map(|_| Fly::random(parameters.mapping.pairs(evaluator.dimension()), rng))
        .collect();
    let first = smells(evaluator, &locations, parameters.mapping);
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
        let old = olfactory(&swarms, parameters, (flies_each, radius), rng);
        let old = Generation::new(evaluator, old, flies_each, parameters.mapping);
        let new = offspring(&old, parameters, count, rng);
        let new = Generation::new(evaluator, new, flies_each, parameters.mapping);
        visual(&mut swarms, &old, parameters.offspring.then_some(&new));
    }
    swarms
        .iter()
        .filter(|swarm| swarm.smell.is_finite())
        .map(|swarm| Candidate {
            position: swarm.location.position(parameters.mapping),
            cost: swarm.smell,
        })
        .collect()
}

/// Flies of all swarms, one swarm after another, with their smells.
struct Generation {
    flies: Vec<Fly>,
    smells: Vec<f64>,
    flies_each: usize,
}

impl Generation {
    fn new<P: Problem + ?Sized>(
        evaluator: &mut Evaluator<'_, P>,
        flies: Vec<Fly>,
        flies_each: usize,
        mapping: Mapping,
    ) -> Self {
        let smells = smells(evaluator, &flies, mapping);
        Self {
            flies,
            smells,
            flies_each,
        }
    }

    /// The keenest fly of a swarm: its index.
    fn best_of(&self, swarm: usize) -> usize {
        let first = swarm * self.flies_each;
        first + keenest(&self.smells[first..][..self.flies_each])
    }
}

/// Osphresis: flies around each swarm's location, far from it where it smells too much.
fn olfactory(
    swarms: &[Swarm],
    parameters: &PublishedParameters,
    (flies_each, radius): (usize, f64),
    rng: &mut ChaCha8Rng,
) -> Vec<Fly> {
    swarms
        .iter()
        .flat_map(|swarm| std::iter::repeat_n(swarm, flies_each))
        .map(|swarm| {
            if swarm.smell > parameters.threshold {
                swarm.location.olfactory(big_step, rng)
            } else {
                swarm.location.olfactory(|u| radius * u, rng)
            }
        })
        .collect()
}

/// Offspring of every fly with the best flies of swarms drawn at random; none without the
/// option.
fn offspring(
    old: &Generation,
    parameters: &PublishedParameters,
    swarms: usize,
    rng: &mut ChaCha8Rng,
) -> Vec<Fly> {
    if !parameters.offspring {
        return Vec::new();
    }
    let best: Vec<usize> = (0..swarms).map(|swarm| old.best_of(swarm)).collect();
    let mut draw = || &old.flies[best[rng.random_range(0..swarms)]];
    old.flies
        .iter()
        .map(|fly| match parameters.parents {
            Parents::EachPair => fly.offspring(&mut draw),
            Parents::EachFly => {
                let parent = draw();
                fly.offspring(|| parent)
            }
        })
        .collect()
}

/// Vision: each swarm moves to its keenest fly where that smells less than its location.
fn visual(swarms: &mut [Swarm], old: &Generation, new: Option<&Generation>) {
    for (g, swarm) in swarms.iter_mut().enumerate() {
        let a = old.best_of(g);
        let (mut fly, mut smell) = (&old.flies[a], old.smells[a]);
        if let Some(new) = new {
            let b = new.best_of(g);
            if new.smells[b] < smell {
                (fly, smell) = (&new.flies[b], new.smells[b]);
            }
        }
        if smell < swarm.smell {
            *swarm = Swarm {
                location: fly.clone(),
                smell,
            };
        }
    }
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

    #[test]
    fn the_local_step_dwindles_from_its_start_to_almost_nothing() {
        assert!((local_step(Step::Dwindling(0.3), 0, 200) - 0.3).abs() < 1e-15);
        assert!((local_step(Step::Dwindling(0.3), 100, 200) - 0.075).abs() < 1e-15);
        assert!(local_step(Step::Dwindling(0.3), 199, 200) < 1e-5);
    }
}

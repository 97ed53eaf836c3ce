//! Fruit flies as the paper encodes them: pairs (X, Y) in the unit disc.

use std::f64::consts::FRAC_PI_2;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::{Evaluator, Problem};

/// Weight of the best fly in its offspring, coe1 of Eq. 15 (Table 1); coe2 is the rest.
const PARENT_WEIGHT: f64 = 0.8;
/// Draws before a variable keeps its swarm's value.
const MAX_DRAWS: usize = 100;

/// What a pair (X, Y) stands for: Eq. 31 to 33 can be read in two ways.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mapping {
    /// One decision variable, `S = sqrt(X^2 + Y^2)`.
    Variable,
    /// Three of them, a control point: `|X|`, `|Y|` and `S`. The variables are then all
    /// first coordinates, all second and all third. The far corner, `|X| = |Y| = 1`, is
    /// out of reach, and altitude is tied to the distance from the origin.
    Point,
}

impl Mapping {
    /// Pairs of a fly for a number of variables.
    pub(super) fn pairs(self, dimension: usize) -> usize {
        match self {
            Self::Variable => dimension,
            Self::Point => dimension / 3,
        }
    }
}

/// Pairs (X, Y) in the unit disc.
#[derive(Clone)]
pub(super) struct Fly {
    pairs: Vec<(f64, f64)>,
}

impl Fly {
    /// Uniform in the unit disc, by rejection.
    pub(super) fn random(pairs: usize, rng: &mut ChaCha8Rng) -> Self {
        let pair = |rng: &mut ChaCha8Rng| loop {
            let (x, y) = (rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0));
            if x * x + y * y <= 1.0 {
                break (x, y);
            }
        };
        Self {
            pairs: (0..pairs).map(|_| pair(rng)).collect(),
        }
    }

    /// Eq. 7 to 10 around this location: `step` maps a number of (-1, 1) to a step.
    pub(super) fn olfactory(&self, step: impl Fn(f64) -> f64, rng: &mut ChaCha8Rng) -> Self {
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

    /// Eq. 14 and 15: mostly the parent that is given for each pair, partly `self`.
    pub(super) fn offspring<'a>(&self, mut parent: impl FnMut() -> &'a Self) -> Self {
        let mix = |a: f64, b: f64| PARENT_WEIGHT * a + (1.0 - PARENT_WEIGHT) * b;
        Self {
            pairs: self
                .pairs
                .iter()
                .enumerate()
                .map(|(j, b)| {
                    let a = parent().pairs[j];
                    (mix(a.0, b.0), mix(a.1, b.1))
                })
                .collect(),
        }
    }

    /// Eq. 11 and 32. A mixture may pass 1 by rounding.
    pub(super) fn position(&self, mapping: Mapping) -> Vec<f64> {
        let smell = |(x, y): &(f64, f64)| (x * x + y * y).sqrt().min(1.0);
        match mapping {
            Mapping::Variable => self.pairs.iter().map(smell).collect(),
            Mapping::Point => {
                let x = self.pairs.iter().map(|(x, _)| x.abs().min(1.0));
                let y = self.pairs.iter().map(|(_, y)| y.abs().min(1.0));
                x.chain(y).chain(self.pairs.iter().map(smell)).collect()
            }
        }
    }
}

/// The steps of Eq. 7 and 8 for a number of (-1, 1).
pub(super) fn big_step(u: f64) -> f64 {
    (FRAC_PI_2 * u).sin()
}

/// Smells of flies, in order.
pub(super) fn smells<P: Problem + ?Sized>(
    evaluator: &mut Evaluator<'_, P>,
    flies: &[Fly],
    mapping: Mapping,
) -> Vec<f64> {
    let rows: Vec<f64> = flies.iter().flat_map(|fly| fly.position(mapping)).collect();
    evaluator.evaluate(&rows)
}

/// Index of the first least smell of one swarm (Eq. 12 and 17).
pub(super) fn keenest(smells: &[f64]) -> usize {
    (0..smells.len())
        .min_by(|&a, &b| smells[a].total_cmp(&smells[b]))
        .unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::Seed;

    #[test]
    fn flies_and_their_offspring_stay_in_the_unit_disc() {
        let mut rng = Seed(3).stream("test", 0);
        let (a, b) = (Fly::random(50, &mut rng), Fly::random(50, &mut rng));
        for fly in [
            a.olfactory(big_step, &mut rng),
            a.olfactory(|u| 0.1 * u, &mut rng),
            a.offspring(|| &b),
        ] {
            assert!(fly.pairs.iter().all(|(x, y)| x * x + y * y <= 1.0 + 1e-12));
            for mapping in [Mapping::Variable, Mapping::Point] {
                let position = fly.position(mapping);
                assert!(position.iter().all(|s| (0.0..=1.0).contains(s)));
                assert_eq!(mapping.pairs(position.len()), 50);
            }
        }
    }

    #[test]
    fn a_pair_is_one_variable_or_one_control_point() {
        let fly = Fly {
            pairs: vec![(-0.6, 0.8), (0.3, -0.4)],
        };
        let near = |found: Vec<f64>, expected: &[f64]| {
            assert_eq!(found.len(), expected.len());
            assert!(
                found
                    .iter()
                    .zip(expected)
                    .all(|(a, b)| (a - b).abs() < 1e-12)
            );
        };
        near(fly.position(Mapping::Variable), &[1.0, 0.5]);
        near(
            fly.position(Mapping::Point),
            &[0.6, 0.3, 0.8, 0.4, 1.0, 0.5],
        );
    }
}

//! One sub-swarm: its place, its flies, and what they learn.

use std::f64::consts::FRAC_PI_2;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::{MsfoaParameters, SearchSeed};
use crate::optimize::Candidate;
use crate::optimize::cma_es::{Adapted, Draw};

/// Evaluations of one swarm without gain after which it begins again.
const PATIENCE: usize = 700;
/// What counts as gain, as a share of the cost.
const GAIN: f64 = 2e-4;
/// Global steps, in units of the scale of a seed.
const GLOBAL_STEP: f64 = 3.0;

/// One sub-swarm.
pub(super) struct Swarm {
    pub(super) class: u64,
    pub(super) scale: Vec<f64>,
    pub(super) adapted: Adapted,
    /// Its keenest fly since it last began.
    pub(super) best: Candidate,
    /// Its keenest fly of all.
    pub(super) elite: Candidate,
    /// What that cost in the relaxed problem, when this was left.
    pub(super) relaxed_cost: Option<f64>,
    /// Evaluations since the last gain, and the cost then.
    pub(super) idle: usize,
    pub(super) idle_cost: f64,
}

impl Swarm {
    pub(super) fn new(seed: &SearchSeed, parameters: &MsfoaParameters) -> Self {
        let nobody = Candidate {
            position: seed.mean.clone(),
            cost: f64::INFINITY,
        };
        Self {
            class: seed.class,
            scale: seed.scale.clone(),
            adapted: Adapted::new(&seed.mean, &seed.scale, parameters.step, parameters.flies),
            best: nobody.clone(),
            elite: nobody,
            relaxed_cost: None,
            idle: 0,
            idle_cost: f64::INFINITY,
        }
    }

    /// Big steps from the keenest fly, Eq. 7 and 8 per variable.
    pub(super) fn global_fly(&self, rng: &mut ChaCha8Rng) -> Vec<f64> {
        self.best
            .position
            .iter()
            .zip(&self.scale)
            .map(|(&x, &scale)| {
                let step = (FRAC_PI_2 * rng.random_range(-1.0..1.0)).sin();
                (x + GLOBAL_STEP * scale * step).clamp(0.0, 1.0)
            })
            .collect()
    }

    /// Visual search: the swarm remembers its keenest fly.
    pub(super) fn see(&mut self, position: &[f64], cost: f64) {
        if cost < self.best.cost {
            self.best = Candidate {
                position: position.to_vec(),
                cost,
            };
            if cost < self.elite.cost {
                self.elite = self.best.clone();
            }
        }
    }

    /// What it has found: its keenest flies and the mean of all.
    pub(super) fn found(&self) -> [&[f64]; 3] {
        let (best, elite) = (&self.best.position, &self.elite.position);
        [best, elite, self.adapted.mean()]
    }

    /// The costs of these by the problem itself, after an relaxed one.
    pub(super) fn judge_again(&mut self, [best, elite, mean]: [f64; 3]) {
        self.relaxed_cost = Some(self.elite.cost);
        (self.best.cost, self.elite.cost) = (best, elite);
        if best < elite {
            self.elite = self.best.clone();
        }
        self.idle = 0;
        self.idle_cost = best;
        let middle = self.adapted.mean().to_vec();
        self.see(&middle, mean);
    }

    /// Forgets its keenest flies, to search the relaxed problem; that of all is given back.
    pub(super) fn set_out(&mut self) -> Candidate {
        self.best.cost = f64::INFINITY;
        std::mem::replace(&mut self.elite, self.best.clone())
    }

    /// Back from there, with the keenest fly of all before, and with what its keenest fly there
    /// and the mean of all cost by the problem itself.
    pub(super) fn come_back(&mut self, elite: Candidate, [best, mean]: [f64; 2]) {
        self.elite = elite;
        self.best.cost = f64::INFINITY;
        let (keenest, middle) = (self.best.position.clone(), self.adapted.mean().to_vec());
        self.see(&keenest, best);
        self.see(&middle, mean);
        self.idle = 0;
        self.idle_cost = self.best.cost;
    }

    /// Counts evaluations; true when too many brought no gain.
    pub(super) fn is_tired(&mut self, evaluations: usize) -> bool {
        let needed = GAIN * self.idle_cost.abs();
        if self.idle_cost.is_infinite() || self.idle_cost - self.best.cost > needed {
            self.idle = 0;
            self.idle_cost = self.best.cost;
        } else {
            self.idle += evaluations;
        }
        self.idle >= PATIENCE
    }

    /// The swarm's distribution learns from its local flies, if enough were evaluated: from steps
    /// put together group by group, each by the parts of the costs that the group may change, so
    /// that a good first half of a path is not lost for a bad second one.
    pub(super) fn learn(&mut self, flights: &[Flight], costs: &[f64], parts: &[f64]) {
        let groups = parts.len() / costs.len();
        let mut flies = Vec::new();
        let mut draws = Vec::new();
        for (fly, flight) in flights.iter().enumerate() {
            if let Flight::Local(draw) = flight {
                flies.push(fly);
                draws.push(draw);
            }
        }
        let evaluated = flies.iter().filter(|&&fly| costs[fly].is_finite()).count();
        if evaluated < flights.len() / 2 {
            return;
        }
        let order = |group: usize| {
            let part = |&fly: &usize| parts[fly * groups + group];
            let mut ranked: Vec<(f64, usize)> = flies.iter().map(part).zip(0..).collect();
            ranked.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            ranked.into_iter().map(|(_, draw)| draw).collect()
        };
        let orders: Vec<Vec<usize>> = (0..groups).map(order).collect();
        self.adapted.learn(&draws, &orders);
    }
}

/// What one fly does in a generation: a draw to learn from, or a global step to a place.
pub(super) enum Flight {
    Local(Draw),
    Global(Vec<f64>),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_swarm_tires_only_without_gain() {
        let parameters = MsfoaParameters {
            swarms: 1,
            flies: 16,
            threshold: f64::INFINITY,
            step: 0.4,
            group: 1,
            racing: true,
            offspring: true,
            restarts: true,
        };
        let seed = SearchSeed {
            mean: vec![0.5],
            scale: vec![0.1],
            class: 0,
        };
        let mut swarm = Swarm::new(&seed, &parameters);
        let mut cost = 100.0;
        for _ in 0..100 {
            cost *= 0.99;
            swarm.see(&[0.5], cost);
            assert!(!swarm.is_tired(16));
        }
        assert!((0..PATIENCE / 16).all(|_| !swarm.is_tired(16)));
        assert!(swarm.is_tired(16));
    }
}

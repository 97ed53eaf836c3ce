//! Offspring: by which swarms exchange what they know.

use super::swarm::Swarm;
use crate::optimize::{Evaluator, Problem};

/// Swarms that mate at the end of a round.
const PARENTS: usize = 4;

/// Competition of offspring among the best swarms: each takes the best of its
/// children that beats its own keenest fly, and with `must_gain` that of the other parent: else
/// it may be no more than a copy of that.
pub(super) fn compete<P: Problem + ?Sized>(
    evaluator: &mut Evaluator<'_, P>,
    swarms: &mut [Swarm],
    group: usize,
    must_gain: bool,
) {
    swarms.sort_by(|a, b| a.elite.cost.total_cmp(&b.elite.cost));
    let dimension = evaluator.dimension();
    let parents = swarms.len().min(PARENTS);
    let mut rows = Vec::new();
    let mut owners = Vec::new();
    for (g, first) in swarms[..parents].iter().enumerate() {
        for second in swarms[..parents].iter().filter(|s| s.class != first.class) {
            for cut in (group..dimension).step_by(group) {
                rows.extend_from_slice(&first.elite.position[..cut]);
                rows.extend_from_slice(&second.elite.position[cut..]);
                let rival = must_gain.then_some(second.elite.cost);
                owners.push((g, rival));
            }
        }
    }
    let costs = evaluator.evaluate(&rows);
    for (child, &(owner, rival)) in owners.iter().enumerate() {
        let swarm = &mut swarms[owner];
        let gains = rival.is_none_or(|rival| costs[child] < rival);
        if gains && costs[child] < swarm.elite.cost {
            swarm.see(&rows[child * dimension..][..dimension], costs[child]);
            swarm.adapted.move_to(&swarm.best.position);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::first_swarms;
    use super::*;
    use crate::optimize::{MsfoaParameters, SearchSeed};

    /// Costs the last variable.
    struct Last;

    impl Problem for Last {
        fn dimension(&self) -> usize {
            2
        }

        fn evaluate(&self, candidates: &[f64], costs: &mut [f64]) {
            for (cost, row) in costs.iter_mut().zip(candidates.chunks(2)) {
                *cost = row[1];
            }
        }
    }

    #[test]
    fn offspring_that_gains_nothing_over_both_parents_may_be_dropped() {
        let parameters = MsfoaParameters {
            swarms: 2,
            flies: 4,
            threshold: f64::INFINITY,
            step: 0.1,
            group: 1,
            racing: true,
            offspring: true,
            restarts: true,
        };
        let costs_after = |must_gain| {
            let seed = |class: u64, x: f64| SearchSeed {
                mean: vec![x; 2],
                scale: vec![0.1; 2],
                class,
            };
            let seeds = [seed(1, 0.2), seed(2, 0.7)];
            let mut swarms = first_swarms(&seeds, &parameters, must_gain);
            for swarm in &mut swarms {
                let mean = swarm.adapted.mean().to_vec();
                swarm.see(&mean, mean[1]);
            }
            let mut evaluator = Evaluator::new(&Last, 100, &|_| ());
            compete(&mut evaluator, &mut swarms, parameters.group, must_gain);
            swarms
                .iter()
                .map(|swarm| swarm.elite.cost)
                .collect::<Vec<_>>()
        };
        assert_eq!(costs_after(false), [0.2, 0.2]);
        assert_eq!(costs_after(true), [0.2, 0.7]);
    }
}

//! The race of sub-swarms: who goes on after a round.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use super::swarm::Swarm;
use super::{ROUND_ENDS, share};
use crate::optimize::Candidate;

/// Share of the swarms that survives a round.
const SURVIVAL: f64 = 0.4;

/// Swarms that go on after so many rounds: at least two until the last round.
pub(super) fn survivors(swarms: usize, rounds: usize) -> usize {
    if rounds + 1 == ROUND_ENDS.len() {
        return 1;
    }
    (0..rounds)
        .fold(swarms, |left, _| share(left * 10, SURVIVAL).div_ceil(10))
        .max(2)
}

/// Keeps the best swarms, one of each class; returns the best of those that go.
pub(super) fn drop_the_slow(swarms: &mut Vec<Swarm>, keep: usize) -> Vec<Candidate> {
    swarms.sort_by(|a, b| a.elite.cost.total_cmp(&b.elite.cost));
    let (mut classes, mut stay) = (BTreeSet::new(), BTreeSet::new());
    for place in placed(swarms) {
        if stay.len() < keep && classes.insert(swarms[place].class) {
            stay.insert(place);
        }
    }
    let mut dropped = Vec::new();
    for (place, swarm) in std::mem::take(swarms).into_iter().enumerate() {
        if stay.contains(&place) {
            swarms.push(Swarm {
                eased_cost: None,
                ..swarm
            });
        } else {
            dropped.push(swarm.elite);
        }
    }
    dropped
}

/// Places of sorted swarms in the order in which they stay: by turns who is best, and who was
/// while limits were cheap to break, because a good path may just not be clean yet.
fn placed(swarms: &[Swarm]) -> Vec<usize> {
    let cost = |place: usize| swarms[place].eased_cost;
    let mut eased: Vec<usize> = (0..swarms.len())
        .filter(|&place| cost(place).is_some())
        .collect();
    eased.sort_by(|&a, &b| cost(a).partial_cmp(&cost(b)).unwrap_or(Ordering::Equal));
    let turns = (0..swarms.len()).flat_map(|place| [Some(place), eased.get(place).copied()]);
    turns.flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_race_narrows_to_one_swarm() {
        let rounds = |swarms| [1, 2, 3].map(|round| survivors(swarms, round));
        assert_eq!(rounds(14), [6, 3, 1]);
        assert_eq!(rounds(10), [4, 2, 1]);
        assert_eq!(rounds(1), [2, 2, 1]);
    }
}

//! The race of sub-swarms: who goes on after a round.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use super::swarm::Swarm;
use super::{ROUND_ENDS, share};
use crate::optimize::Candidate;

/// Share of the swarms that survives a round.
const SURVIVAL: f64 = 0.4;

/// Swarms that go on after `rounds` rounds: at least two until the last round.
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
    for rank in ranked(swarms) {
        if stay.len() < keep && classes.insert(swarms[rank].class) {
            stay.insert(rank);
        }
    }
    let mut dropped = Vec::new();
    for (rank, swarm) in std::mem::take(swarms).into_iter().enumerate() {
        if stay.contains(&rank) {
            swarms.push(Swarm {
                relaxed_cost: None,
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
fn ranked(swarms: &[Swarm]) -> Vec<usize> {
    let cost = |rank: usize| swarms[rank].relaxed_cost;
    let mut relaxed: Vec<usize> = (0..swarms.len())
        .filter(|&rank| cost(rank).is_some())
        .collect();
    relaxed.sort_by(|&a, &b| cost(a).partial_cmp(&cost(b)).unwrap_or(Ordering::Equal));
    let turns = (0..swarms.len()).flat_map(|rank| [Some(rank), relaxed.get(rank).copied()]);
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

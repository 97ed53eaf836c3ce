//! Beginnings in which all vehicles follow one rule, like ships that all pass to starboard: every
//! path is bent to the same side, and those of different groups fly at different heights or times.

use std::f64::consts::TAU;

use super::conflicts::{Choice, Conflicts, Flown};
use super::moves::Ruled;

/// Most groups.
const MAX_GROUPS: usize = 3;
/// How far paths are bent, in separations: as far as the first without a conflict.
const ASIDE: [f64; 14] = [
    0.0, 0.3, 0.6, 1.0, 1.5, 2.0, 2.6, 3.3, 4.2, 5.5, 8.0, 12.0, 15.0, 18.0,
];
/// How often the step to the bend before is halved towards the least without a conflict.
const HALVINGS: usize = 6;
/// Share of the cost that finding the least may save.
const WORTH: f64 = 0.05;

/// What sets groups apart.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Apart {
    Height,
    /// The same from soon after the beginning of the route until shortly before its end.
    HeightThroughout,
    Time,
}

/// Which vehicles form a group: those that fly in like directions, or every second, third.. of
/// them in the order of their directions.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Members {
    Alike,
    Alternate,
}

/// One rule for all.
#[derive(Clone, Copy, Debug)]
struct Rule {
    groups: usize,
    apart: Apart,
    members: Members,
    /// Left is 1, right -1.
    side: f64,
}

/// Choices without a conflict, the cheapest first: rules with the least bend that keeps all
/// apart, as far as they are cheaper than those before.
pub(super) fn without_conflict(conflicts: &mut Conflicts<'_>) -> Vec<Choice> {
    let order = by_direction(conflicts);
    let mut found: Vec<Choice> = Vec::new();
    let mut least = f64::INFINITY;
    for rule in rules(conflicts.can_wait()) {
        if let Some((cost, choice)) = smallest_bend(conflicts, &order, rule, least) {
            least = cost;
            found.insert(0, choice);
        }
    }
    found
}

fn rules(can_wait: bool) -> Vec<Rule> {
    let one = Rule {
        groups: 1,
        apart: Apart::Height,
        members: Members::Alike,
        side: 1.0,
    };
    let mut rules = vec![one, Rule { side: -1.0, ..one }];
    for groups in 2..=MAX_GROUPS {
        for members in [Members::Alike, Members::Alternate] {
            let height = Rule {
                groups,
                members,
                ..one
            };
            rules.push(height);
            rules.push(Rule {
                apart: Apart::HeightThroughout,
                ..height
            });
            rules.extend(can_wait.then_some(Rule {
                apart: Apart::Time,
                ..height
            }));
        }
    }
    rules
}

/// The rank of each vehicle in the order of directions.
fn by_direction(conflicts: &Conflicts<'_>) -> Vec<usize> {
    let count = conflicts.vehicles();
    let direction_rad: Vec<f64> = (0..count)
        .map(|vehicle| conflicts.direction_rad(vehicle).rem_euclid(TAU))
        .collect();
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&a, &b| direction_rad[a].total_cmp(&direction_rad[b]));
    let mut rank = vec![0; count];
    for (number, vehicle) in order.into_iter().enumerate() {
        rank[vehicle] = number;
    }
    rank
}

/// The choice of a rule with the least bend at which no two vehicles are in conflict, and its cost,
/// if that is below one that is known.
fn smallest_bend(
    conflicts: &mut Conflicts<'_>,
    rank: &[usize],
    rule: Rule,
    known: f64,
) -> Option<(f64, Choice)> {
    let mut at = |aside: f64| -> Option<(f64, Choice)> {
        let choice: Option<Choice> = (0..rank.len())
            .map(|vehicle| {
                let own = rule.of(rank[vehicle], rank.len(), aside);
                conflicts.add_ruled(vehicle, own)
            })
            .collect();
        let choice = choice.filter(|choice| is_free(conflicts, choice))?;
        let flown = choice.iter().copied().enumerate();
        Some((flown.map(|flown| conflicts.cost(flown)).sum(), choice))
    };
    let found = ASIDE.iter().enumerate().find_map(|(step, &aside)| {
        let too_little = if step > 0 { ASIDE[step - 1] } else { 0.0 };
        at(aside).map(|found| (found, too_little, aside))
    });
    // Between what is too little and what is enough.
    let (mut best, mut too_little, mut enough) = found?;
    for _ in 0..HALVINGS {
        if best.0 - known > WORTH * known {
            break;
        }
        let aside = 0.5 * (too_little + enough);
        match at(aside) {
            Some(found) => (best, enough) = (found, aside),
            None => too_little = aside,
        }
    }
    Some(best).filter(|(cost, _)| *cost < known)
}

fn is_free(conflicts: &mut Conflicts<'_>, choice: &Choice) -> bool {
    let all: Vec<Flown> = choice.iter().copied().enumerate().collect();
    all.iter().enumerate().all(|(number, &own)| {
        let later = &all[number + 1..];
        conflicts.judge(own.0, &[own.1], later);
        let mut later = later.iter();
        conflicts.can_fly(own) && later.all(|&other| !conflicts.are_in_conflict(own, other))
    })
}

impl Rule {
    /// For the vehicle of a rank among some.
    fn of(self, rank: usize, count: usize, aside: f64) -> Ruled {
        let group = match self.members {
            Members::Alike => rank * self.groups / count,
            Members::Alternate => rank % self.groups,
        };
        #[expect(clippy::cast_precision_loss, reason = "few groups")]
        let (group, last) = (group as f64, (self.groups - 1).max(1) as f64);
        let aside = self.side * aside;
        let (up, window) = match self.apart {
            Apart::Height | Apart::HeightThroughout => (group, None),
            Apart::Time => (0.0, Some(group / last)),
        };
        Ruled {
            aside,
            up,
            is_wide: self.apart == Apart::HeightThroughout,
            window,
        }
    }
}

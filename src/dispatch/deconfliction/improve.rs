//! A cheaper fleet without a conflict: large-neighbourhood search over the variants of vehicles.
//!
//! All paths are drawn towards the paths alone together; groups of vehicles get new variants; a
//! vehicle takes a cheaper variant, and those in its way give way; single shapes are bent a little.
//! Only what leaves no conflict and is no dearer stays.

use rand::RngExt;
use rand::seq::SliceRandom;

use super::conflicts::{Choice, Flown};
use super::search::{Search, others};

/// Most work, in pairs judged.
const MAX_WORK: usize = 300_000;
/// Most rounds of all that is tried.
const MAX_ROUNDS: usize = 12;
/// The last round makes the fleet cheaper by less than this share.
const ENOUGH: f64 = 5e-4;
/// Groups that are tried for a cheaper fleet, for each vehicle, and most of them in one round.
const GROUPS: usize = 6;
const MAX_GROUPED: usize = 120;
/// Most vehicles of a group.
const GROUP: usize = 4;
/// Shares by which all paths are drawn together.
const TOGETHER: [f64; 4] = [0.3, 0.1, 0.03, 0.01];
/// Cheaper variants of a vehicle that others may give way to, and most that give way.
const PUSHED: usize = 8;
const MAX_IN_THE_WAY: usize = 3;
/// Variants near to the present one that a vehicle gets.
const NEAR: usize = 6;

impl Search<'_, '_> {
    /// Makes a fleet without a conflict cheaper, as long as it pays.
    pub(super) fn improve(&mut self, choice: &mut Choice) {
        let end = self.conflicts.work() + MAX_WORK;
        for _ in 0..MAX_ROUNDS {
            let before = self.cost(choice);
            self.draw_together(choice);
            for _ in 0..(GROUPS * choice.len()).min(MAX_GROUPED) {
                if self.conflicts.work() > end {
                    break;
                }
                self.regroup(choice);
                self.push(choice);
            }
            for vehicle in 0..choice.len() {
                self.refine(vehicle, choice);
            }
            if self.conflicts.work() > end || before - self.cost(choice) < ENOUGH * before {
                break;
            }
        }
    }

    /// Draws all paths towards the paths alone by the same shares, as far as no conflict appears.
    fn draw_together(&mut self, choice: &mut Choice) {
        let mut steps = TOGETHER.into_iter();
        let mut share = steps.next();
        while let Some(by) = share {
            let flown = choice.iter().copied().enumerate();
            let drawn: Option<Choice> = flown
                .map(|(vehicle, variant)| match variant {
                    0 => Some(0),
                    _ => self.conflicts.add_drawn((vehicle, variant), by),
                })
                .collect();
            match drawn.filter(|drawn| self.is_free(drawn)) {
                Some(drawn) if self.cost(&drawn) < self.cost(choice) => *choice = drawn,
                _ => share = steps.next(),
            }
        }
    }

    fn is_free(&mut self, choice: &Choice) -> bool {
        let is_broken = |search: &mut Self| !search.pairs(choice).is_empty();
        !is_broken(self)
            && (choice.iter().copied().enumerate()).all(|flown| self.conflicts.can_fly(flown))
    }

    /// Gives one vehicle variants near to its own and between its own and the path alone.
    fn refine(&mut self, vehicle: usize, choice: &mut Choice) {
        if choice[vehicle] == 0 {
            return;
        }
        let own = (vehicle, choice[vehicle]);
        self.conflicts.add_between(own);
        self.conflicts.add_near(own, NEAR, &mut self.rng);
        let below = self.conflicts.cost(own);
        let found = self.free_below(vehicle, &others(choice, &[vehicle]), below);
        choice[vehicle] = found.unwrap_or(choice[vehicle]);
    }

    /// Gives new variants to a dear vehicle and a few others, one after the other, if that is
    /// cheaper.
    fn regroup(&mut self, choice: &mut Choice) {
        let Some(first) = self.dear(choice) else {
            return;
        };
        let mut rest: Vec<usize> = (0..choice.len()).filter(|&other| other != first).collect();
        rest.shuffle(&mut self.rng);
        let size = self.rng.random_range(1..GROUP);
        let mut group = vec![first];
        group.extend(rest.into_iter().take(size));
        self.conflicts.add_random(first, 1, &mut self.rng);
        for &vehicle in &group {
            let own = (vehicle, choice[vehicle]);
            self.conflicts.add_near(own, 2, &mut self.rng);
        }
        let set = others(choice, &group);
        self.reinsert(&group, set, choice);
    }

    /// Lets a dear vehicle take a cheaper variant, and gives others to those in its way, if that is
    /// cheaper in all.
    fn push(&mut self, choice: &mut Choice) {
        let Some(first) = self.dear(choice) else {
            return;
        };
        let own = (first, choice[first]);
        self.conflicts.add_near(own, NEAR, &mut self.rng);
        let cost = self.conflicts.cost(own);
        let mut cheaper = self.conflicts.cheapest_first(first);
        cheaper.retain(|&variant| self.conflicts.cost((first, variant)) < cost);
        cheaper.shuffle(&mut self.rng);
        cheaper.truncate(PUSHED);
        let all = others(choice, &[first]);
        self.conflicts.judge(first, &cheaper, &all);
        cheaper.retain(|&variant| self.conflicts.can_fly((first, variant)));
        for variant in cheaper {
            let new = (first, variant);
            let is_met = |other: &&Flown| self.conflicts.are_in_conflict(new, **other);
            let met: Vec<usize> = all.iter().filter(is_met).map(|other| other.0).collect();
            if met.len() > MAX_IN_THE_WAY {
                continue;
            }
            for &other in &met {
                let own = (other, choice[other]);
                self.conflicts.add_near(own, NEAR, &mut self.rng);
            }
            let mut set = all.clone();
            set.retain(|other| !met.contains(&other.0));
            set.push(new);
            if self.reinsert(&met, set, choice) {
                return;
            }
        }
    }

    /// Gives the cheapest variants without a conflict to some vehicles, one after the other, among
    /// what the others fly, if the fleet then costs no more. Whether it does.
    fn reinsert(&mut self, group: &[usize], mut set: Vec<Flown>, choice: &mut Choice) -> bool {
        let before = self.cost(choice);
        let mut next = choice.clone();
        for &(vehicle, variant) in &set {
            next[vehicle] = variant;
        }
        let costs = |search: &Self, set: &[Flown]| -> f64 {
            set.iter().map(|&flown| search.conflicts.cost(flown)).sum()
        };
        let least = |search: &Self, group: &[usize]| -> f64 {
            group
                .iter()
                .map(|&vehicle| search.conflicts.cost((vehicle, 0)))
                .sum()
        };
        for (number, &vehicle) in group.iter().enumerate() {
            let rest = least(self, &group[number + 1..]);
            let below = before - costs(self, &set) - rest + 1e-9;
            let Some(found) = self.free_below(vehicle, &set, below) else {
                return false;
            };
            next[vehicle] = found;
            set.push((vehicle, found));
        }
        if self.cost(&next) > before {
            return false;
        }
        *choice = next;
        true
    }

    /// One of the vehicles that cost more than alone, by how much.
    fn dear(&mut self, choice: &Choice) -> Option<usize> {
        let over = |vehicle: usize| {
            self.conflicts.cost((vehicle, choice[vehicle])) - self.conflicts.cost((vehicle, 0))
        };
        let all = (0..choice.len()).map(|vehicle| (vehicle, over(vehicle)));
        let dear: Vec<(usize, f64)> = all.filter(|(_, over)| *over > 1e-6).collect();
        let sum: f64 = dear.iter().map(|(_, over)| over).sum();
        let mut left = self.rng.random::<f64>() * sum;
        let found = dear.iter().find(|(_, over)| {
            left -= over;
            left <= 0.0
        });
        found.or(dear.last()).map(|(vehicle, _)| *vehicle)
    }
}

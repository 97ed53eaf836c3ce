//! Which variants of two vehicles are in conflict, each pair judged once.

use std::collections::HashMap;

use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::plan::VehiclePlan;
use crate::spec::MissionSpec;
use crate::verify::{Executed, Judge};
use crate::world::World;

use super::moves::Ruled;
use super::variants::Variants;

/// A vehicle and one of its variants.
pub(super) type Flown = (usize, usize);

/// The variant of each vehicle.
pub(super) type Choice = Vec<usize>;

/// The variants of a fleet, and what has been judged of them.
pub(super) struct Conflicts<'a> {
    world: &'a World,
    judge: Judge<'a>,
    fleet: Vec<Variants<'a>>,
    /// The flight of each variant; none inside where its mission breaks a limit of its own.
    flights: HashMap<Flown, Option<Executed<'a>>>,
    pairs: HashMap<(Flown, Flown), bool>,
}

impl<'a> Conflicts<'a> {
    /// None where a path has no shape that could be moved.
    pub(super) fn new(
        (spec, world): (&'a MissionSpec, &'a World),
        alone: &[VehiclePlan],
    ) -> Option<Self> {
        let fleet: Option<Vec<_>> = (alone.par_iter().enumerate())
            .map(|(index, plan)| Variants::new((spec, world), index, plan))
            .collect();
        Some(Self {
            world,
            judge: Judge::new(spec, world),
            fleet: fleet?,
            flights: HashMap::new(),
            pairs: HashMap::new(),
        })
    }

    /// Vehicles of the fleet.
    pub(super) fn vehicles(&self) -> usize {
        self.fleet.len()
    }

    pub(super) fn cost(&self, (vehicle, variant): Flown) -> f64 {
        self.fleet[vehicle].all[variant].cost
    }

    /// Variants of a vehicle, the cheapest first, and of equals that which departs the nearest
    /// to the specified time.
    pub(super) fn cheapest_first(&self, vehicle: usize) -> Vec<usize> {
        let all = &self.fleet[vehicle].all;
        let mut order: Vec<usize> = (0..all.len()).collect();
        order.sort_by(|&a, &b| {
            let by_cost = all[a].cost.total_cmp(&all[b].cost);
            by_cost.then(all[a].later_s.abs().total_cmp(&all[b].later_s.abs()))
        });
        order
    }

    /// Adds variants of a vehicle at random.
    pub(super) fn add_random(&mut self, vehicle: usize, count: usize, rng: &mut ChaCha8Rng) {
        self.fleet[vehicle].add_random(count, rng);
    }

    /// Adds the variant of a vehicle by a rule for all. None if it breaks a limit of its own.
    pub(super) fn add_ruled(&mut self, vehicle: usize, rule: Ruled) -> Option<usize> {
        self.fleet[vehicle].add_ruled(rule)
    }

    /// Whether a vehicle may depart at another time.
    pub(super) fn can_wait(&self) -> bool {
        self.fleet.iter().any(Variants::can_wait)
    }

    /// The direction from the beginning of its way to the end.
    pub(super) fn direction_rad(&self, vehicle: usize) -> f64 {
        self.fleet[vehicle].direction_rad()
    }

    /// Adds variants between one and the path alone.
    pub(super) fn add_between(&mut self, (vehicle, variant): Flown) {
        self.fleet[vehicle].add_between(variant);
    }

    pub(super) fn plan(&self, (vehicle, variant): Flown) -> VehiclePlan {
        self.fleet[vehicle].plan(variant)
    }

    /// Judges some variants of a vehicle against those of others, on all threads.
    pub(super) fn judge(&mut self, vehicle: usize, variants: &[usize], others: &[Flown]) {
        self.fly(variants.iter().map(|&variant| (vehicle, variant)));
        self.fly(others.iter().copied());
        let new: Vec<(Flown, Vec<Flown>)> = variants
            .iter()
            .map(|&variant| {
                let own = (vehicle, variant);
                let known = |other: &&Flown| self.pairs.contains_key(&pair(own, **other));
                let new = others.iter().filter(|other| !known(other)).copied();
                (own, new.collect())
            })
            .filter(|(_, others): &(_, Vec<Flown>)| !others.is_empty())
            .collect();
        let judged: Vec<(Flown, Vec<(Flown, bool)>)> = new
            .into_par_iter()
            .map(|(own, others)| (own, self.judged(own, &others)))
            .collect();
        for (own, found) in judged {
            let found = found.into_iter();
            self.pairs
                .extend(found.map(|(other, near)| (pair(own, other), near)));
        }
    }

    fn judged(&self, own: Flown, others: &[Flown]) -> Vec<(Flown, bool)> {
        let flight = |flown: &Flown| self.flights.get(flown).and_then(Option::as_ref);
        let Some(mine) = flight(&own) else {
            return Vec::new();
        };
        let flown: Vec<(Flown, &Executed<'a>)> = others
            .iter()
            .filter_map(|other| Some((*other, flight(other)?)))
            .collect();
        let flights: Vec<&Executed<'a>> = flown.iter().map(|(_, executed)| *executed).collect();
        let near = self.judge.conflicts(mine, &self.judge.others(&flights));
        let is_near = |position: usize| near.iter().any(|conflict| conflict.other == position);
        let all = flown.iter().enumerate();
        all.map(|(position, (other, _))| (*other, is_near(position)))
            .collect()
    }

    fn fly(&mut self, flown: impl Iterator<Item = Flown>) {
        let new: Vec<Flown> = flown
            .filter(|flown| !self.flights.contains_key(flown))
            .collect();
        let flights: Vec<_> = new
            .into_par_iter()
            .map(|(vehicle, variant)| {
                let of = &self.fleet[vehicle];
                let executed = of.executed(&self.judge, self.world, variant);
                ((vehicle, variant), executed)
            })
            .collect();
        self.flights.extend(flights);
    }

    /// Whether a judged variant keeps every limit that concerns its vehicle alone.
    pub(super) fn can_fly(&self, flown: Flown) -> bool {
        self.flights.get(&flown).is_some_and(Option::is_some)
    }

    /// Whether two judged variants are in conflict.
    pub(super) fn are_in_conflict(&self, a: Flown, b: Flown) -> bool {
        self.pairs.get(&pair(a, b)).copied().unwrap_or(true)
    }
}

fn pair(a: Flown, b: Flown) -> (Flown, Flown) {
    (a.min(b), a.max(b))
}

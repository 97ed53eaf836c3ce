//! Which variants of two vehicles are in conflict, each pair judged once.

use std::collections::HashMap;

use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::plan::VehiclePlan;
use crate::spec::MissionSpec;
use crate::verify::Judge;
use crate::world::World;

use super::moves::Ruled;
use super::variants::{Flight, Variants};

/// A vehicle and one of its variants.
pub(super) type Flown = (usize, usize);

/// The variant of each vehicle.
pub(super) type Choice = Vec<usize>;

/// What flying one variant counts for, where judging one pair counts for one: a wing is steered step by step, and there
/// is much beside its legs to be judged.
const FLYING: usize = 20;
const FLYING_A_WING: usize = 1200;
const JUDGING_A_WING: usize = 850;
/// Most flights that are remembered: the others are flown again when they are needed.
const MAX_FLIGHTS: usize = 2000;

/// The variants of a fleet, and what has been judged of them.
pub(super) struct Conflicts<'a> {
    world: &'a World,
    judge: Judge<'a>,
    fleet: Vec<Variants<'a>>,
    /// Whether the mission of a variant keeps every limit of its own.
    flies: HashMap<Flown, bool>,
    /// Of those that may, some.
    flights: HashMap<Flown, Flight<'a>>,
    pairs: HashMap<u64, bool>,
    /// What has been flown and judged so far, in pairs.
    work: usize,
}

impl<'a> Conflicts<'a> {
    /// None where a path has no shape that could be moved.
    pub(super) fn new(
        (spec, world): (&'a MissionSpec, &'a World),
        alone: &[VehiclePlan],
    ) -> Option<Self> {
        let judge = Judge::new(spec, world);
        let fleet: Option<Vec<_>> = (alone.par_iter().enumerate())
            .map(|(index, plan)| {
                let even = Variants::new((spec, world), index, plan, true);
                let even = even.filter(|even| {
                    let flown = even.flown(&judge, world, 0);
                    flown.is_some_and(|flown| judge.keeps_own_limits(index, &flown.mission))
                });
                even.or_else(|| Variants::new((spec, world), index, plan, false))
            })
            .collect();
        Some(Self {
            world,
            judge,
            fleet: fleet?,
            flies: HashMap::new(),
            flights: HashMap::new(),
            pairs: HashMap::new(),
            work: 0,
        })
    }

    /// What has been flown and judged so far, in pairs.
    pub(super) fn work(&self) -> usize {
        self.work
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
        self.fleet[vehicle].cheapest_first()
    }

    /// Adds variants of a vehicle at random.
    pub(super) fn add_random(&mut self, vehicle: usize, count: usize, rng: &mut ChaCha8Rng) {
        self.fleet[vehicle].add_random(count, rng);
    }

    /// Adds variants of a vehicle that are later from some part of its path on.
    pub(super) fn add_delayed(&mut self, vehicle: usize) {
        self.fleet[vehicle].add_delayed();
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

    /// Adds variants of a vehicle that are near to one of them, at random.
    pub(super) fn add_near(
        &mut self,
        (vehicle, variant): Flown,
        count: usize,
        rng: &mut ChaCha8Rng,
    ) {
        self.fleet[vehicle].add_near(variant, count, rng);
    }

    /// Adds the variant that is nearer to the path alone by a share. None if it breaks a limit of
    /// its own.
    pub(super) fn add_drawn(&mut self, (vehicle, variant): Flown, share: f64) -> Option<usize> {
        self.fleet[vehicle].add_drawn(variant, share)
    }

    /// Adds variants between one and the path alone.
    pub(super) fn add_between(&mut self, (vehicle, variant): Flown) {
        self.fleet[vehicle].add_between(variant);
    }

    pub(super) fn plan(&self, (vehicle, variant): Flown) -> VehiclePlan {
        self.fleet[vehicle].plan(variant)
    }

    /// Judges some variants of a vehicle by its own limits and against those of others, on all
    /// threads.
    pub(super) fn judge(&mut self, vehicle: usize, variants: &[usize], others: &[Flown]) {
        let all = variants.iter().map(|&variant| (vehicle, variant));
        let all: Vec<Flown> = all.collect();
        self.judge_own_limits(&all);
        self.judge_pairs(&all, others);
    }

    /// The first of some variants of a vehicle that keeps its own limits and is in no conflict
    /// with those of others. Its own limits take the most time, so they come last.
    pub(super) fn first_free(
        &mut self,
        vehicle: usize,
        variants: &[usize],
        others: &[Flown],
    ) -> Option<usize> {
        let mut free: Vec<Flown> = variants.iter().map(|&variant| (vehicle, variant)).collect();
        free.retain(|own| self.flies.get(own) != Some(&false));
        self.judge_pairs(&free, others);
        free.retain(|&own| {
            let mut others = others.iter();
            others.all(|&other| !self.are_in_conflict(own, other))
        });
        free.into_iter().find_map(|own| {
            self.judge_own_limits(&[own]);
            self.can_fly(own).then_some(own.1)
        })
    }

    /// Judges those that were not yet by what concerns their vehicles alone.
    fn judge_own_limits(&mut self, all: &[Flown]) {
        let mut new = all.to_vec();
        new.retain(|flown| !self.flies.contains_key(flown));
        self.fly(&new);
        let wings = (new.iter()).filter(|(vehicle, _)| self.fleet[*vehicle].has_wing());
        self.work += JUDGING_A_WING * wings.count();
        let this = &*self;
        let judged: Vec<(Flown, bool)> = (new.into_par_iter())
            .map(|flown| {
                let flight = this.flights.get(&flown);
                let keeps =
                    |flight: &Flight<'a>| this.judge.keeps_own_limits(flown.0, &flight.mission);
                (flown, flight.is_some_and(keeps))
            })
            .collect();
        self.flies.extend(judged);
    }

    /// Judges variants against those of others, as far as they may keep their own limits.
    fn judge_pairs(&mut self, all: &[Flown], others: &[Flown]) {
        let may_fly = |this: &Self, flown: &Flown| this.flies.get(flown) != Some(&false);
        let new: Vec<(Flown, Vec<Flown>)> = (all.iter().copied())
            .filter(|own| may_fly(self, own))
            .map(|own| {
                let known = |other: &&Flown| self.pairs.contains_key(&pair(own, **other));
                let new = others.iter().filter(|other| !known(other)).copied();
                (own, new.collect())
            })
            .filter(|(_, others): &(_, Vec<Flown>)| !others.is_empty())
            .collect();
        let mut needed: Vec<Flown> = (new.iter())
            .flat_map(|(own, others)| others.iter().chain([own]).copied())
            .filter(|flown| may_fly(self, flown))
            .collect();
        needed.sort_unstable();
        needed.dedup();
        self.fly(&needed);
        let this = &*self;
        let judged: Vec<(u64, bool)> = new
            .into_par_iter()
            .flat_map_iter(|(own, others)| {
                let others = others.into_iter();
                others.filter_map(move |other| Some((pair(own, other), this.meet(own, other)?)))
            })
            .collect();
        self.work += judged.len();
        self.pairs.extend(judged);
    }

    /// Whether two that have been flown meet.
    fn meet(&self, own: Flown, other: Flown) -> Option<bool> {
        let (own, other) = (self.flights.get(&own)?, self.flights.get(&other)?);
        Some(self.judge.are_in_conflict(&own.executed, &other.executed))
    }

    /// Flies those whose flights are not there. What cannot be encoded cannot fly.
    fn fly(&mut self, all: &[Flown]) {
        if self.flights.len() > MAX_FLIGHTS {
            self.flights.clear();
        }
        let all = all.par_iter().copied();
        let new = all.filter(|flown| !self.flights.contains_key(flown));
        let flights: Vec<(Flown, Option<Flight<'a>>)> = new
            .map(|(vehicle, variant)| {
                let of = &self.fleet[vehicle];
                (
                    (vehicle, variant),
                    of.flown(&self.judge, self.world, variant),
                )
            })
            .collect();
        let work = flights.iter().map(|((vehicle, _), _)| {
            if self.fleet[*vehicle].has_wing() {
                FLYING_A_WING
            } else {
                FLYING
            }
        });
        self.work += work.sum::<usize>();
        for (flown, flight) in flights {
            match flight {
                Some(flight) => drop(self.flights.insert(flown, flight)),
                None => drop(self.flies.insert(flown, false)),
            }
        }
    }

    /// Whether a judged variant keeps every limit that concerns its vehicle alone.
    pub(super) fn can_fly(&self, flown: Flown) -> bool {
        self.flies.get(&flown) == Some(&true)
    }

    /// Whether two judged variants are in conflict.
    pub(super) fn are_in_conflict(&self, a: Flown, b: Flown) -> bool {
        self.pairs.get(&pair(a, b)).copied().unwrap_or(true)
    }
}

/// One number for two variants, whatever their order.
fn pair(a: Flown, b: Flown) -> u64 {
    let number = |(vehicle, variant): Flown| ((vehicle as u64) << 24) | variant as u64;
    let (a, b) = (number(a), number(b));
    (a.min(b) << 32) | a.max(b)
}

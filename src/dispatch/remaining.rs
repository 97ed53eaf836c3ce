//! Pairs that planning one by one leaves too near. Single vehicles of them take other variants of
//! their paths: another departure, a bend aside, or more height for a while. Every variant is
//! encoded and judged as by the verdict, against the missions of all others.

use std::collections::{BTreeMap, BTreeSet};

use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::numeric::Seed;
use crate::plan::FleetPlan;
use crate::spec::MissionSpec;
use crate::verify::{Executed, Judge, Limit, Review};
use crate::world::World;

use super::deconfliction::{Flight, Variants};
use super::{Dispatched, Job};

/// Most pairs that are moved apart: more are no remainder. One for this number of vehicles.
const VEHICLES_A_PAIR: usize = 10;
/// Moves of one vehicle, for each pair, at most.
const MOVES_A_PAIR: usize = 6;
/// Variants of a vehicle at random, near to its path and around it, where no other is free.
const AT_RANDOM: usize = 80;
/// Variants of vehicles that are in conflict with all of their first ones, at most: the pairs that
/// are left then stay.
const MAX_SEARCHED: usize = 20_000;
/// What each move of a vehicle makes a conflict with it weigh more.
const HEAVIER: f64 = 1.0;

/// By their indices, the lower first.
type Pair = (usize, usize);

/// The plan with single vehicles of pairs that are too near on other variants of their paths, so
/// that no pair is left. None where there are no such pairs, too many, or no such variants.
pub(super) fn moved_apart(job: Job<'_>, found: &Dispatched) -> Option<FleetPlan> {
    let pairs = too_near(job.spec, &found.review);
    let most = job.spec.vehicles.len() / VEHICLES_A_PAIR;
    if pairs.is_empty() || pairs.len() > most {
        return None;
    }
    let retimed = found.plan.retimed(job.spec);
    let judge = Judge::new(job.spec, job.world);
    let flights = found.missions.par_iter();
    let flights =
        flights.filter_map(|(index, mission)| Some((*index, judge.fly(*index, mission)?)));
    let mut fleet = Fleet {
        spec: &retimed,
        world: job.world,
        flights: flights.collect(),
        judge,
        plan: found.plan.clone(),
        rng: Seed(job.run.seed).stream("remaining", 0),
        weights: BTreeMap::new(),
        searched: 0,
    };
    fleet.move_apart(pairs).then_some(fleet.plan)
}

/// Pairs whose missions are too near each other.
fn too_near(spec: &MissionSpec, review: &Review) -> BTreeSet<Pair> {
    let index = |id: &str| spec.vehicles.iter().position(|vehicle| vehicle.id == id);
    let broken = review.margins.iter().filter(|margin| !margin.ok);
    let near = broken.filter(|margin| margin.limit == Limit::Separation);
    let pairs = near.filter_map(|margin| {
        let (a, b) = (index(&margin.vehicle)?, index(margin.other.as_deref()?)?);
        Some((a.min(b), a.max(b)))
    });
    pairs.collect()
}

struct Fleet<'a> {
    /// With the departures and speeds of the plan.
    spec: &'a MissionSpec,
    world: &'a World,
    judge: Judge<'a>,
    /// By the index of the vehicle.
    flights: BTreeMap<usize, Executed<'a>>,
    plan: FleetPlan,
    rng: ChaCha8Rng,
    /// What a conflict with a vehicle weighs: more, the more often it moved.
    weights: BTreeMap<usize, f64>,
    /// Variants of vehicles none of whose first is free.
    searched: usize,
}

/// A variant of a vehicle as it is flown.
struct Move<'a> {
    variant: usize,
    /// What it costs more than the path before.
    dearer: f64,
    flight: Executed<'a>,
    /// Those that it is in conflict with.
    met: Vec<usize>,
}

impl<'a> Fleet<'a> {
    /// Moves vehicles until no pair is left in conflict. Whether none is.
    fn move_apart(&mut self, mut pairs: BTreeSet<Pair>) -> bool {
        for _ in 0..MOVES_A_PAIR * pairs.len() {
            let Some(&(first, second)) = pairs.first() else {
                break;
            };
            if self.searched > MAX_SEARCHED {
                break;
            }
            // The vehicle of lower priority gives way, where both can at the same cost.
            let moves = [second, first].map(|vehicle| self.best_move(vehicle));
            let [of_second, of_first] = moves;
            let of_second = of_second.map(|found| (second, found));
            let of_first = of_first.map(|found| (first, found));
            let chosen = (of_second.into_iter().chain(of_first)).reduce(|best, next| {
                if self.is_better(&next.1, &best.1) {
                    next
                } else {
                    best
                }
            });
            let Some((vehicle, (variants, found))) = chosen else {
                return false;
            };
            pairs.retain(|&(a, b)| a != vehicle && b != vehicle);
            let met = found.met.iter();
            pairs.extend(met.map(|&other| (vehicle.min(other), vehicle.max(other))));
            self.take(vehicle, &variants, found, (first, second));
        }
        pairs.is_empty()
    }

    fn is_better(
        &self,
        (_, own): &(Variants<'a>, Move<'a>),
        (_, other): &(Variants<'a>, Move<'a>),
    ) -> bool {
        let (own_weight, other_weight) = (self.weight(&own.met), self.weight(&other.met));
        own_weight < other_weight || own_weight <= other_weight && own.dearer < other.dearer
    }

    fn weight(&self, met: &[usize]) -> f64 {
        let weight = |other| self.weights.get(other).copied().unwrap_or(1.0);
        met.iter().map(weight).sum()
    }

    /// The cheapest variant of a vehicle without a conflict, and where there is none that with the
    /// conflicts that weigh least.
    fn best_move(&mut self, vehicle: usize) -> Option<(Variants<'a>, Move<'a>)> {
        let base = self.plan.vehicles.get(vehicle)?;
        let of = (self.spec, self.world);
        let mut variants = Variants::new(of, vehicle, base, true)
            .or_else(|| Variants::new(of, vehicle, base, false))?;
        if let Some(free) = self.cheapest_free(vehicle, &variants, 0) {
            return Some((variants, free));
        }
        let known = variants.all.len();
        variants.add_near(0, AT_RANDOM, &mut self.rng);
        variants.add_random(AT_RANDOM, &mut self.rng);
        self.searched += variants.all.len();
        if let Some(free) = self.cheapest_free(vehicle, &variants, known) {
            return Some((variants, free));
        }
        let all = (0..variants.all.len()).into_par_iter();
        let flown = all.filter_map(|variant| self.flown(vehicle, &variants, variant, usize::MAX));
        let flown: Vec<Move<'a>> = flown.collect();
        let least = flown.into_iter().reduce(|best, next| {
            let (weight, least) = (self.weight(&next.met), self.weight(&best.met));
            let is_better = weight < least || weight <= least && next.dearer < best.dearer;
            if is_better { next } else { best }
        })?;
        Some((variants, least))
    }

    /// The cheapest variant of a number or a higher one that is in no conflict.
    fn cheapest_free(
        &self,
        vehicle: usize,
        variants: &Variants<'a>,
        from: usize,
    ) -> Option<Move<'a>> {
        let order = variants.cheapest_first();
        let order: Vec<usize> = order.into_iter().filter(|&one| one >= from).collect();
        let flown = |&variant: &usize| self.flown(vehicle, variants, variant, 0);
        order.par_iter().find_map_first(flown)
    }

    /// A variant as it is flown; none if it is in conflict with more others than it may, or breaks
    /// a limit of its own, which takes longer to judge.
    fn flown(
        &self,
        vehicle: usize,
        variants: &Variants<'a>,
        variant: usize,
        most: usize,
    ) -> Option<Move<'a>> {
        let Flight { mission, executed } = variants.flown(&self.judge, self.world, variant)?;
        let mut met = Vec::new();
        for (&other, of_other) in self.flights.iter().filter(|(other, _)| **other != vehicle) {
            if self.judge.are_in_conflict(&executed, of_other) {
                met.push(other);
                if met.len() > most {
                    return None;
                }
            }
        }
        let keeps_own_limits = self.judge.keeps_own_limits(vehicle, &mission);
        keeps_own_limits.then(|| Move {
            variant,
            dearer: variants.all[variant].cost - self.plan.vehicles[vehicle].terms.total(),
            flight: executed,
            met,
        })
    }

    /// Lets a vehicle fly a variant. It gives way to the other of a pair, if that is before it.
    fn take(&mut self, vehicle: usize, variants: &Variants<'a>, found: Move<'a>, pair: Pair) {
        let mut plan = variants.plan(found.variant);
        if vehicle == pair.1 && !plan.avoids.contains(&pair.0) {
            plan.avoids.push(pair.0);
            plan.avoids.sort_unstable();
        }
        self.plan.vehicles[vehicle] = plan;
        self.flights.insert(vehicle, found.flight);
        *self.weights.entry(vehicle).or_insert(1.0) += HEAVIER;
    }
}

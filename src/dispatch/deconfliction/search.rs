//! Who flies which variant: without conflicts first, and then as cheap as possible.

use rand::RngExt;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::collective;
use super::conflicts::{Choice, Conflicts, Flown};

/// Changes of one vehicle for each vehicle of the fleet, at most, until no conflict is left.
const REPAIRS: usize = 60;
/// Beginnings from other orders of vehicles.
const BEGINNINGS: usize = 8;
/// Beginnings whose cost is at most this multiple of the least are improved.
const PROMISING: f64 = 1.01;
/// Beginnings by one rule for all that are improved: more than one of them end alike.
const RULES: usize = 1;
/// Variants that are judged at once, where the first without a conflict is enough.
const CHUNK: usize = 16;
/// Variants that a vehicle in conflict gets besides, at random, from the second beginning on.
const MORE: usize = 8;

/// Most work until no conflict is left, and after it for a cheaper fleet, in pairs judged.
const MAX_REPAIR: usize = 400_000;

pub(super) struct Search<'s, 'a> {
    pub(super) conflicts: &'s mut Conflicts<'a>,
    pub(super) rng: ChaCha8Rng,
    /// What a conflict of two costs: more, the longer it lasted.
    weights: Vec<Vec<f64>>,
}

/// What changes of single vehicles led to.
struct Repaired {
    /// Pairs in conflict.
    left: usize,
    /// Whether two vehicles were in conflict after every change.
    is_stuck: bool,
}

impl<'s, 'a> Search<'s, 'a> {
    pub(super) fn new(conflicts: &'s mut Conflicts<'a>, rng: ChaCha8Rng) -> Self {
        let count = conflicts.vehicles();
        Self {
            conflicts,
            rng,
            weights: vec![vec![1.0; count]; count],
        }
    }

    /// Variants of all vehicles, and how many pairs are left in conflict. None where a vehicle has
    /// no variant that keeps its own limits.
    pub(super) fn run(&mut self) -> Option<(Choice, usize)> {
        let mut free = collective::without_conflict(self.conflicts);
        if free.is_empty() {
            let (choice, left) = self.one_by_one()?;
            if left > 0 {
                return Some((choice, left));
            }
            free.push(choice);
        } else {
            free.truncate(RULES);
            free.extend(self.all_free());
        }
        let costs: Vec<f64> = free.iter().map(|choice| self.cost(choice)).collect();
        let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
        for (choice, cost) in free.iter_mut().zip(costs) {
            if cost <= PROMISING * least {
                self.improve(choice);
            }
        }
        let cheapest = free
            .into_iter()
            .min_by(|a, b| self.cost(a).total_cmp(&self.cost(b)))?;
        Some((cheapest, 0))
    }

    /// Vehicles get the cheapest variants without a conflict, one after the other; none where one
    /// has no such variant.
    fn all_free(&mut self) -> Option<Choice> {
        let mut choice = Choice::new();
        for vehicle in 0..self.conflicts.vehicles() {
            let others: Vec<Flown> = choice.iter().copied().enumerate().collect();
            choice.push(self.free(vehicle, &others)?);
        }
        Some(choice)
    }

    /// Vehicles get variants one after the other, in some orders, until one leaves no conflict.
    fn one_by_one(&mut self) -> Option<(Choice, usize)> {
        let count = self.conflicts.vehicles();
        let mut best: Option<(Choice, usize)> = None;
        for beginning in 0..BEGINNINGS {
            let mut order: Vec<usize> = (0..count).collect();
            if beginning > 0 {
                order.shuffle(&mut self.rng);
            }
            if beginning == 1 {
                (0..count).for_each(|vehicle| self.conflicts.add_delayed(vehicle));
            }
            let mut choice = self.in_order(&order)?;
            let more = if beginning > 0 { MORE } else { 0 };
            let repaired = self.repair(&mut choice, more);
            let left = repaired.left;
            if best.as_ref().is_none_or(|(_, least)| left < *least) {
                best = Some((choice, left));
            }
            // No order of vehicles parts two that no variants of theirs did, those at random included.
            let is_hopeless = more > 0 && repaired.is_stuck;
            if left == 0 || is_hopeless || self.conflicts.work() > MAX_REPAIR {
                break;
            }
        }
        best
    }

    /// Vehicles get the cheapest variants with the fewest conflicts, one after the other.
    fn in_order(&mut self, order: &[usize]) -> Option<Choice> {
        let mut choice = vec![0; self.conflicts.vehicles()];
        for (number, &vehicle) in order.iter().enumerate() {
            let others: Vec<Flown> = order[..number]
                .iter()
                .map(|&other| (other, choice[other]))
                .collect();
            choice[vehicle] = match self.free(vehicle, &others) {
                Some(variant) => variant,
                None => self.fewest_conflicts(vehicle, &others, None)?,
            };
        }
        Some(choice)
    }

    /// The cheapest variant without a conflict.
    pub(super) fn free(&mut self, vehicle: usize, others: &[Flown]) -> Option<usize> {
        self.free_below(vehicle, others, f64::INFINITY)
    }

    /// The same of those that cost less than this.
    pub(super) fn free_below(
        &mut self,
        vehicle: usize,
        others: &[Flown],
        cost: f64,
    ) -> Option<usize> {
        let mut order = self.conflicts.cheapest_first(vehicle);
        order.retain(|&variant| self.conflicts.cost((vehicle, variant)) < cost);
        let mut chunks = order.chunks(CHUNK);
        chunks.find_map(|chunk| self.conflicts.first_free(vehicle, chunk, others))
    }

    /// The variant with the least weight of conflicts, and of equals the cheapest; not the
    /// one that is `left`.
    fn fewest_conflicts(
        &mut self,
        vehicle: usize,
        others: &[Flown],
        left: Option<usize>,
    ) -> Option<usize> {
        let mut order = self.conflicts.cheapest_first(vehicle);
        self.conflicts.judge(vehicle, &order, others);
        order.retain(|&variant| self.conflicts.can_fly((vehicle, variant)));
        if order.len() > 1 {
            order.retain(|&variant| Some(variant) != left);
        }
        let weight = |variant: usize| -> f64 {
            let near = others.iter();
            near.filter(|&&other| self.conflicts.are_in_conflict((vehicle, variant), other))
                .map(|&(other, _)| self.weights[vehicle][other])
                .sum()
        };
        let weighed = order.into_iter().map(|variant| (variant, weight(variant)));
        let least = weighed.reduce(|best, next| if next.1 < best.1 { next } else { best });
        least.map(|(variant, _)| variant)
    }

    /// Gives other variants to vehicles in conflict, until none is left or the changes are spent.
    /// The best choice that was met, and its number of conflicts. With each change the vehicle gets
    /// `more` variants.
    fn repair(&mut self, choice: &mut Choice, more: usize) -> Repaired {
        let mut pairs = self.pairs(choice);
        let mut never_apart = pairs.clone();
        let mut best = (pairs.len(), choice.clone());
        for _ in 0..REPAIRS * choice.len() {
            if pairs.is_empty() || self.conflicts.work() > MAX_REPAIR {
                break;
            }
            let (a, b) = pairs[self.rng.random_range(0..pairs.len())];
            for &(a, b) in &pairs {
                self.weights[a][b] += 0.2;
                self.weights[b][a] += 0.2;
            }
            let vehicle = if self.rng.random_range(0..2) == 0 {
                a
            } else {
                b
            };
            self.conflicts.add_random(vehicle, more, &mut self.rng);
            let others = others(choice, &[vehicle]);
            if let Some(found) = self.fewest_conflicts(vehicle, &others, Some(choice[vehicle])) {
                choice[vehicle] = found;
                pairs.retain(|&(a, b)| a != vehicle && b != vehicle);
                let own = (vehicle, found);
                let near = others
                    .iter()
                    .filter(|&&other| self.conflicts.are_in_conflict(own, other));
                pairs.extend(near.map(|other| (vehicle.min(other.0), vehicle.max(other.0))));
                never_apart.retain(|pair| pairs.contains(pair));
            }
            if pairs.len() < best.0 {
                best = (pairs.len(), choice.clone());
            }
        }
        if pairs.len() > best.0 {
            *choice = best.1;
        }
        Repaired {
            left: best.0.min(pairs.len()),
            is_stuck: !never_apart.is_empty(),
        }
    }

    /// Pairs in conflict.
    pub(super) fn pairs(&mut self, choice: &Choice) -> Vec<(usize, usize)> {
        let all: Vec<Flown> = choice.iter().copied().enumerate().collect();
        let mut pairs = Vec::new();
        for (number, &own) in all.iter().enumerate() {
            let later = &all[number + 1..];
            self.conflicts.judge(own.0, &[own.1], later);
            let near = later
                .iter()
                .filter(|&&other| self.conflicts.are_in_conflict(own, other));
            pairs.extend(near.map(|other| (own.0, other.0)));
        }
        pairs
    }

    pub(super) fn cost(&self, choice: &Choice) -> f64 {
        let all = choice.iter().copied().enumerate();
        all.map(|flown| self.conflicts.cost(flown)).sum()
    }
}

/// What all but some vehicles fly.
pub(super) fn others(choice: &Choice, but: &[usize]) -> Vec<Flown> {
    let all = choice.iter().copied().enumerate();
    all.filter(|(vehicle, _)| !but.contains(vehicle)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::Seed;
    use crate::plan::{self, Request};
    use crate::spec::SpecFile;
    use crate::world;

    /// A QuadPlane over the place where a copter starts and climbs at the same time.
    const STUCK: &str = "sortie: 2
name: stuck
area: {south_west: {lat: -85.01, lon: -0.114737}, north_east: {lat: -84.99, lon: 0.114737}, min_agl_m: 20, max_amsl_m: 6000}
terrain: {flat: {amsl_m: 3000}}
vehicles:
  - {id: v0, sysid: 1, autopilot: ardupilot, airframe: vtol, link: sim, speed_mps: 20, finish: land,
     start: {lat: -85.003802, lon: -0.076477, agl_m: 80}, goal: {lat: -84.997751, lon: -0.053025, agl_m: 80}}
  - {id: v1, sysid: 2, autopilot: ardupilot, airframe: copter, link: sim, speed_mps: 5, finish: loiter,
     start: {lat: -85.002915, lon: -0.045296, agl_m: 100}, goal: {lat: -85.001332, lon: -0.027884, agl_m: 100}}
separation: {distance_m: 100, time_slack_s: 0, vertical_m: 20}
planner: {evaluations: 300}
";

    #[test]
    fn the_search_ends_where_two_vehicles_were_never_apart() {
        let path = std::path::Path::new("stuck.yaml");
        let file = SpecFile::parse(path, STUCK.to_owned()).expect("a spec");
        let world = world::load(&file).expect("a world");
        let spec = &file.spec;
        let alone = plan::plan_each_alone(spec, &world, &Request::new(1)).vehicles;
        let mut conflicts = Conflicts::new((spec, &world), &alone).expect("paths that bend");
        let rng = Seed(1).stream("deconfliction", 0);
        let (_, left) = Search::new(&mut conflicts, rng).run().expect("flown alone");
        assert_eq!(left, 1);
        // All beginnings were made, up to all of the work.
        assert!(conflicts.work() < MAX_REPAIR / 2, "{}", conflicts.work());
    }
}

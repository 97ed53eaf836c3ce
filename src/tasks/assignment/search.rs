//! Regret insertion, then removal and new insertion.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::insertion::{Insertion, Noise};
use super::{Assigned, Assignment};

/// Rounds of removal and new insertion after the first insertion.
const ROUNDS: u64 = 10_000;
/// All jobs are taken out in one round of this number.
const RESTART: u32 = 12;
/// Most that a sharing may cost above the best to be gone on from, at first; percent.
const MOST_DEARER: u64 = 10;
/// Most jobs taken out in one round.
const MOST_REMOVED: usize = 6;

impl Assignment<'_> {
    pub(super) fn search(&self, seed: u64) -> Assigned {
        let own: Vec<usize> = self.vehicles.iter().filter_map(|one| one.own).collect();
        let free: Vec<usize> = (0..self.jobs.len())
            .filter(|job| !own.contains(job))
            .collect();
        let vehicles = 0..self.vehicles.len();
        let mut best = Assigned {
            visits: vehicles.map(|vehicle| self.own_visits(vehicle)).collect(),
            left: free.clone(),
            cost: 0,
        };
        self.insert(&mut best, None);
        let mut current = best.clone();
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let most = MOST_REMOVED.min(free.len());
        for round in 0..if most == 0 { 0 } else { ROUNDS } {
            let mut next = current.clone();
            // Now and then everything begins anew.
            let all = rng.random_range(0..RESTART) == 0;
            let removed = if all {
                free.len()
            } else {
                rng.random_range(1..=most)
            };
            for nth in 0..removed {
                let job = free[if all {
                    nth
                } else {
                    rng.random_range(0..free.len())
                }];
                if !next.left.contains(&job) {
                    next.left.push(job);
                }
                for visits in &mut next.visits {
                    visits.retain(|visit| visit.0 != job);
                }
            }
            // Half of the rounds insert in a random order and not where it is cheapest: some
            // sharings come of no cheapest insertion.
            let mut noise = None;
            if rng.random_range(0..2) == 0 {
                let scale = rng.random_range(0..=best.cost / free.len().max(1) as u64);
                let rng = &mut rng;
                noise = Some(Noise { rng, scale });
            }
            self.insert(&mut next, noise);
            // Somewhat dearer ones are gone on from too, ever less: they lead out of local minima.
            let share = MOST_DEARER * (ROUNDS - round);
            let dearer = best.cost * share / (100 * ROUNDS);
            if (next.left.len(), next.cost) <= (best.left.len(), best.cost + dearer) {
                current = next;
            }
            if (current.left.len(), current.cost) < (best.left.len(), best.cost) {
                best = current.clone();
            }
        }
        best.left.sort_unstable();
        best
    }

    /// Inserts the jobs that are left wherever they fit: first those that lose most if their best
    /// vehicle is taken, or in random order with noise.
    fn insert(&self, assigned: &mut Assigned, mut noise: Option<Noise<'_>>) {
        let mut waiting = std::mem::take(&mut assigned.left);
        waiting.sort_unstable();
        // The best insertion of each waiting job into each vehicle; one vehicle changes at a time.
        let mut found: Vec<Vec<Option<Insertion>>> = Vec::with_capacity(waiting.len());
        for &job in &waiting {
            let fleet = assigned.visits.iter().enumerate();
            let each = fleet.map(|(v, visits)| self.cheapest(visits, (v, job), noise.as_mut()));
            found.push(each.collect());
        }
        while !waiting.is_empty() {
            let picked = match noise.as_mut() {
                Some(noise) => noise.rng.random_range(0..waiting.len()),
                None => most_regretted(&found),
            };
            let job = waiting.remove(picked);
            let ways = found.remove(picked).into_iter().enumerate();
            let ways = ways.filter_map(|(vehicle, way)| Some((way?, vehicle)));
            let Some((way, vehicle)) = ways.min_by_key(|(way, _)| way.added) else {
                assigned.left.push(job);
                continue;
            };
            let count = self.jobs[job].visits.len();
            way.into(&mut assigned.visits[vehicle], (job, count));
            let visits = &assigned.visits[vehicle];
            for (job, known) in waiting.iter().zip(&mut found) {
                known[vehicle] = self.cheapest(visits, (vehicle, *job), noise.as_mut());
            }
        }
        let costs = assigned.visits.iter().enumerate();
        assigned.cost = costs
            .filter_map(|(vehicle, visits)| Some(self.go(vehicle, visits.iter().copied())?.time))
            .sum();
    }
}

/// Index of the job whose second best vehicle costs most more than its best.
fn most_regretted(found: &[Vec<Option<Insertion>>]) -> usize {
    let regret = |ways: &[Option<Insertion>]| {
        let mut added: Vec<i64> = ways.iter().flatten().map(|way| way.added).collect();
        added.sort_unstable();
        match added[..] {
            [] => i64::MIN,
            [_] => i64::MAX,
            [first, second, ..] => second - first,
        }
    };
    let regrets = found.iter().enumerate().rev();
    let most = regrets.max_by_key(|(_, ways)| regret(ways));
    most.map_or(0, |(index, _)| index)
}

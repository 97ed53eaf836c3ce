//! Regret insertion, then removal and new insertion, and vehicles that exchange all that they do.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::insertion::{Insertion, Noise};
use super::{Assigned, Assignment, Form};

/// Rounds of removal and new insertion after the first insertion.
const ROUNDS: u64 = 10_000;
/// All jobs are taken out in one round of this number.
const RESTART: u32 = 12;
/// Most that a sharing may cost above the best to be gone on from, at first; percent.
const MAX_DEARER: u64 = 10;
/// In one round of this number two vehicles exchange what they do.
const EXCHANGE: u32 = 10;
/// Most jobs taken out in one round.
const MAX_REMOVED: usize = 6;
/// In one round of this number jobs are taken out at random.
const RANDOM: u32 = 3;
/// Most vehicles that lose a string of visits.
const MAX_STRINGS: usize = 3;
/// Most visits in such a string.
const MAX_IN_STRING: usize = 10;

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
        let near = self.near(&free);
        for round in 0..if free.is_empty() { 0 } else { ROUNDS } {
            let mut next = current.clone();
            if rng.random_range(0..EXCHANGE) == 0 {
                self.exchange(&mut next.visits, &mut rng);
            }
            for job in self.removed(&next, &free, &near, &mut rng) {
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
            let share = MAX_DEARER * (ROUNDS - round);
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

    /// For each job the jobs in order of the time from one to the other, itself first.
    fn near(&self, free: &[usize]) -> Vec<Vec<usize>> {
        let apart = |one: usize, other: usize| {
            let sites = |job: usize| self.jobs[job].visits.iter().map(|visit| visit.place);
            let pairs = sites(one).flat_map(|from| sites(other).map(move |to| (from, to)));
            // Vehicles of one fleet differ little in what is near.
            let own = self.vehicles.first();
            let ways = pairs.filter_map(|(from, to)| own?.ways[from][to]);
            ways.map(|way| way.time).min().unwrap_or(u32::MAX)
        };
        let order = |one: &usize| {
            let mut others = free.to_vec();
            others.sort_by_key(|other| (*other != *one, apart(*one, *other)));
            others
        };
        free.iter().map(order).collect()
    }

    /// Jobs to take out: now and then all, some at random, or what vehicles visit one after the other
    /// around one place.
    fn removed(
        &self,
        assigned: &Assigned,
        free: &[usize],
        near: &[Vec<usize>],
        rng: &mut ChaCha8Rng,
    ) -> Vec<usize> {
        if rng.random_range(0..RESTART) == 0 {
            return free.to_vec();
        }
        if rng.random_range(0..RANDOM) == 0 {
            let count = rng.random_range(1..=MAX_REMOVED.min(free.len()));
            return (0..count)
                .map(|_| free[rng.random_range(0..free.len())])
                .collect();
        }
        let mut removed: Vec<usize> = Vec::new();
        let mut vehicles: Vec<usize> = Vec::new();
        let strings = rng.random_range(1..=MAX_STRINGS);
        for &job in &near[rng.random_range(0..free.len())] {
            if vehicles.len() == strings {
                break;
            }
            let is_there = |visits: &Vec<(usize, usize)>| visits.iter().any(|visit| visit.0 == job);
            let Some(vehicle) = assigned.visits.iter().position(is_there) else {
                removed.push(job);
                continue;
            };
            if vehicles.contains(&vehicle) {
                continue;
            }
            vehicles.push(vehicle);
            let visits = &assigned.visits[vehicle];
            let at = visits.iter().position(|visit| visit.0 == job).unwrap_or(0);
            let length = rng.random_range(1..=MAX_IN_STRING.min(visits.len()));
            let first = (at + 1).saturating_sub(length);
            let last = at.min(visits.len() - length);
            let first = rng.random_range(first..=last.max(first));
            let string = visits.iter().skip(first).take(length).map(|visit| visit.0);
            removed.extend(string.filter(|job| free.contains(job)));
        }
        removed
    }

    /// Two vehicles exchange all that they do, each beginning where that takes the least time.
    fn exchange(&self, visits: &mut [Vec<(usize, usize)>], rng: &mut ChaCha8Rng) {
        let [one, other] = [0; 2].map(|_| rng.random_range(0..visits.len()));
        if one == other
            || [one, other]
                .iter()
                .any(|at| self.vehicles[*at].own.is_some())
        {
            return;
        }
        let taken = self.begun_best(one, &visits[other]);
        let given = self.begun_best(other, &visits[one]);
        if let (Some(taken), Some(given)) = (taken, given) {
            (visits[one], visits[other]) = (taken, given);
        }
    }

    /// Visits as a ring, begun where a vehicle takes the least time for them; none where it may not do them.
    fn begun_best(&self, vehicle: usize, ring: &[(usize, usize)]) -> Option<Vec<(usize, usize)>> {
        let own = &self.vehicles[vehicle];
        let may = |visit: &(usize, usize)| self.jobs[visit.0].vehicles[vehicle];
        if ring.len() > own.max_visits || !ring.iter().all(may) {
            return None;
        }
        let turned = |first: usize| ring.iter().cycle().skip(first).take(ring.len()).copied();
        let time = |first: usize| {
            let is_whole = first == 0 || self.is_in_order(turned(first));
            let spent = is_whole
                .then(|| self.go(vehicle, turned(first)))
                .flatten()?;
            (spent.uses <= own.budget).then_some((spent.time, first))
        };
        let best = (0..ring.len().max(1)).filter_map(time).min();
        best.map(|(_, first)| turned(first).collect())
    }

    /// Whether each job is done in its order, and at once where it has to be.
    fn is_in_order(&self, visits: impl Iterator<Item = (usize, usize)> + Clone) -> bool {
        let before = visits.clone();
        visits.enumerate().all(|(at, (job, position))| {
            let of = &self.jobs[job];
            let last = of.visits.len() - 1;
            let mut earlier = before.clone().take(at);
            match of.form {
                Form::Open => position == 0 || earlier.any(|visit| visit == (job, position - 1)),
                // Forwards or backwards, from one of its ends on.
                Form::Together | Form::EitherWay => {
                    let is_end = position == 0 || (position == last && of.form == Form::EitherWay);
                    match earlier.clone().last() {
                        Some(before) if before.0 == job => true,
                        _ => is_end && !earlier.any(|visit| visit.0 == job),
                    }
                }
            }
        })
    }

    /// Takes out the jobs that vehicles come to before the time of a zone has ended, since they do no longer
    /// what they did before.
    fn come_too_soon(&self, visits: &mut [Vec<(usize, usize)>]) -> Vec<usize> {
        let mut taken = Vec::new();
        for (vehicle, (own, visits)) in self.vehicles.iter().zip(visits).enumerate() {
            let is_open = own.closed.iter().all(Vec::is_empty);
            if is_open || self.go(vehicle, visits.iter().copied()).is_some() {
                continue;
            }
            let is_timed = |visit: &&(usize, usize)| {
                let place = self.jobs[visit.0].visits[visit.1].place;
                own.minds_time_at(place) && own.own != Some(visit.0)
            };
            let mut timed: Vec<usize> = visits
                .iter()
                .filter(is_timed)
                .map(|visit| visit.0)
                .collect();
            timed.sort_unstable();
            timed.dedup();
            visits.retain(|visit| !timed.contains(&visit.0));
            taken.append(&mut timed);
        }
        taken
    }

    /// Inserts the jobs that are left wherever they fit: first those that lose most if their best
    /// vehicle is taken, or in random order with noise.
    fn insert(&self, assigned: &mut Assigned, mut noise: Option<Noise<'_>>) {
        let mut waiting = std::mem::take(&mut assigned.left);
        waiting.extend(self.come_too_soon(&mut assigned.visits));
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

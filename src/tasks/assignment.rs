//! Who does which job, and in which order: regret insertion, then removal and new insertion.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Rounds of removal and new insertion after the first insertion.
const ROUNDS: u64 = 3000;
/// How long ways take at least, in thousandths of their times.
const SOONEST: u64 = 995;
/// All jobs are taken out in one round of this number.
const RESTART: u32 = 12;
/// Most that a sharing may cost above the best to be gone on from, at first; percent.
const MOST_DEARER: u64 = 10;
/// Most jobs taken out in one round.
const MOST_REMOVED: usize = 6;

/// Jobs to share among vehicles.
#[derive(Clone, Copy, Debug)]
pub struct Assignment<'a> {
    /// The vehicles; each goes once.
    pub vehicles: &'a [Carrier<'a>],
    /// The jobs.
    pub jobs: &'a [Job],
}

/// A vehicle as the assignment sees it.
#[derive(Clone, Copy, Debug)]
pub struct Carrier<'a> {
    /// The way from the place of the row to that of the column; square, none where there is no
    /// way.
    pub ways: &'a [Vec<Option<Way>>],
    /// Place where it begins.
    pub start: usize,
    /// Place where it ends.
    pub goal: usize,
    /// The job that is its own: it does its places in their order, whatever that uses.
    pub own: Option<usize>,
    /// Most that it may use.
    pub budget: u64,
    /// What resting uses in one unit of time.
    pub rest_uses: u64,
    /// Most places that it visits.
    pub most_visits: usize,
    /// When it is at its start.
    pub begins: u64,
    /// How long its ways may take, in thousandths of their times: windows hold for that and for
    /// the times themselves.
    pub slowest: u64,
    /// Waits are whole numbers of this.
    pub wait_step: u64,
}

/// A way from one place to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Way {
    /// How long it takes.
    pub time: u32,
    /// What it uses, in the unit of the budget of its vehicle.
    pub uses: u32,
}

/// A job for one vehicle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Job {
    /// Its places, visited in this order by one vehicle: one for a visit, pick-up and drop for a
    /// delivery. Other jobs may come between.
    pub visits: Vec<Visit>,
    /// Which vehicles may do it.
    pub vehicles: Vec<bool>,
}

/// A place of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Visit {
    /// Row and column of the ways.
    pub place: usize,
    /// How long the vehicle stays there.
    pub rest: u32,
    /// When its rest may begin, first and last; who comes earlier waits.
    pub window: Option<(u64, u64)>,
}

/// Who does what.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Assigned {
    /// For each vehicle its visits in order, as job and position within the job, without start
    /// and goal.
    pub visits: Vec<Vec<(usize, usize)>>,
    /// Jobs that found no vehicle with enough budget left, ascending.
    pub left: Vec<usize>,
    /// Sum of the times of the ways of all vehicles; one without jobs goes from its start to its
    /// goal.
    pub cost: u64,
}

impl Assignment<'_> {
    /// Shares the jobs: as many as it can, then for the least cost. The same seed gives the same
    /// result. `None` where a place or a vehicle is outside of its list, or ways are not square.
    #[must_use]
    pub fn assign(&self, seed: u64) -> Option<Assigned> {
        self.is_whole().then(|| self.search(seed))
    }

    fn is_whole(&self) -> bool {
        let count = self.vehicles.len();
        let is_whole = |(index, one): (usize, &Carrier<'_>)| {
            let size = one.ways.len();
            let jobs = self.jobs.iter().filter(|job| job.vehicles[index]);
            let mut sites = jobs.flat_map(|job| &job.visits).map(|visit| visit.place);
            one.ways.iter().all(|row| row.len() == size)
                && sites.all(|place| place < size)
                && one.start.max(one.goal) < size
                && one.own.is_none_or(|own| own < self.jobs.len())
        };
        self.jobs.iter().all(|job| job.vehicles.len() == count)
            && self.vehicles.iter().enumerate().all(is_whole)
    }

    fn search(&self, seed: u64) -> Assigned {
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
            way.into(&mut assigned.visits[vehicle], job);
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

    /// The cheapest way for a vehicle with these visits to do one more job within its budget.
    fn cheapest(
        &self,
        visits: &[(usize, usize)],
        (vehicle, job): (usize, usize),
        mut noise: Option<&mut Noise<'_>>,
    ) -> Option<Insertion> {
        let sites = self.jobs[job].visits.len();
        let is_full = visits.len() + sites > self.vehicles[vehicle].most_visits;
        if is_full || !self.jobs[job].vehicles[vehicle] {
            return None;
        }
        let before = self.go(vehicle, visits.iter().copied())?.time;
        let mut at = vec![0; sites];
        let mut best: Option<Insertion> = None;
        loop {
            let with = merged(visits, job, &at);
            if let Some(used) = self.go(vehicle, with)
                && used.uses <= self.vehicles[vehicle].budget
            {
                let above = noise.as_mut().map_or(0, |noise| noise.draw());
                let added = (used.time + above).cast_signed() - before.cast_signed();
                if best.as_ref().is_none_or(|best| added < best.added) {
                    let at = at.clone();
                    best = Some(Insertion { added, at });
                }
            }
            if !next_positions(&mut at, visits.len()) {
                return best;
            }
        }
    }

    /// What a vehicle spends with its own job and one more, the least use in any order and whatever
    /// its budget; none where there is no way, or the job is not for it.
    #[must_use]
    pub fn alone(&self, vehicle: usize, job: usize) -> Option<Spent> {
        if !self.jobs[job].vehicles[vehicle] {
            return None;
        }
        let own = self.own_visits(vehicle);
        let mut at = vec![0; self.jobs[job].visits.len()];
        let mut best: Option<Spent> = None;
        loop {
            let spent = self.go(vehicle, merged(&own, job, &at));
            best = best.into_iter().chain(spent).min_by_key(|spent| spent.uses);
            if !next_positions(&mut at, own.len()) {
                return best;
            }
        }
    }

    fn own_visits(&self, vehicle: usize) -> Vec<(usize, usize)> {
        let own = self.vehicles[vehicle].own.into_iter();
        own.flat_map(|job| (0..self.jobs[job].visits.len()).map(move |at| (job, at)))
            .collect()
    }

    /// Time and use of a vehicle with these visits; none where there is no way, or a window is
    /// missed.
    #[must_use]
    pub fn go(
        &self,
        vehicle: usize,
        visits: impl Iterator<Item = (usize, usize)>,
    ) -> Option<Spent> {
        self.walk(vehicle, visits, &mut |_| ())
    }

    /// How long a vehicle with these visits waits at each.
    #[must_use]
    pub fn waits(&self, vehicle: usize, visits: &[(usize, usize)]) -> Vec<u64> {
        let mut waits = Vec::with_capacity(visits.len());
        let visits = visits.iter().copied();
        self.walk(vehicle, visits, &mut |wait| waits.push(wait));
        waits
    }

    fn walk(
        &self,
        vehicle: usize,
        visits: impl Iterator<Item = (usize, usize)>,
        waits: &mut dyn FnMut(u64),
    ) -> Option<Spent> {
        let own = &self.vehicles[vehicle];
        let mut spent = Spent::default();
        let mut at = own.start;
        // A wait is as long as it is in the plan, whether the vehicle comes early or late.
        let (mut early, mut late) = (own.begins, own.begins);
        for (job, position) in visits {
            let visit = self.jobs[job].visits[position];
            let way = own.ways[at][visit.place]?;
            spent.add(way);
            early += u64::from(way.time) * SOONEST / 1000;
            late += (u64::from(way.time) * own.slowest).div_ceil(1000);
            let mut rest = u64::from(visit.rest);
            if let Some((first, last)) = visit.window {
                let wait = first.saturating_sub(early).div_ceil(own.wait_step) * own.wait_step;
                if late + wait > last {
                    return None;
                }
                waits(wait);
                rest += wait;
            } else {
                waits(0);
            }
            (early, late) = (early + rest, late + rest);
            spent.rest += rest;
            spent.uses += rest * own.rest_uses;
            at = visit.place;
        }
        spent.add(own.ways[at][own.goal]?);
        Some(spent)
    }
}

/// What a vehicle spends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Spent {
    /// Time on its ways.
    pub time: u64,
    /// Time at rest.
    pub rest: u64,
    /// Of its budget.
    pub uses: u64,
}

impl Spent {
    fn add(&mut self, way: Way) {
        self.time += u64::from(way.time);
        self.uses += u64::from(way.uses);
    }
}

/// What insertions are dearer by, at random.
struct Noise<'a> {
    rng: &'a mut ChaCha8Rng,
    /// At most.
    scale: u64,
}

impl Noise<'_> {
    fn draw(&mut self) -> u64 {
        self.rng.random_range(0..=self.scale)
    }
}

/// Where a job is inserted into the visits of a vehicle.
#[derive(Clone, Debug)]
struct Insertion {
    /// The time that it adds.
    added: i64,
    /// Before which of the visits each of its places comes; ascending.
    at: Vec<usize>,
}

impl Insertion {
    fn into(self, visits: &mut Vec<(usize, usize)>, job: usize) {
        *visits = merged(visits, job, &self.at).collect();
    }
}

/// Visits with the places of one more job before those with these indices.
fn merged(
    visits: &[(usize, usize)],
    job: usize,
    at: &[usize],
) -> impl Iterator<Item = (usize, usize)> {
    let mut next = 0;
    let mut index = 0;
    std::iter::from_fn(move || {
        if at.get(next).is_some_and(|&before| before <= index) {
            next += 1;
            return Some((job, next - 1));
        }
        index += 1;
        visits.get(index - 1).copied()
    })
}

/// The next ascending positions up to `most`; none after the last.
fn next_positions(at: &mut [usize], most: usize) -> bool {
    for place in (0..at.len()).rev() {
        if at[place] < most {
            let value = at[place] + 1;
            at[place..].fill(value);
            return true;
        }
    }
    false
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

#[cfg(test)]
mod tests {
    use super::*;

    fn way(from: (i32, i32), to: (i32, i32)) -> Option<Way> {
        let time = from.0.abs_diff(to.0) + from.1.abs_diff(to.1);
        Some(Way { time, uses: time })
    }

    fn carrier(ways: &[Vec<Option<Way>>], start: usize, budget: u64) -> Carrier<'_> {
        Carrier {
            ways,
            start,
            goal: start,
            own: None,
            budget,
            rest_uses: 0,
            most_visits: 100,
            begins: 0,
            slowest: 1000,
            wait_step: 1,
        }
    }

    fn job(sites: Vec<usize>, vehicles: usize) -> Job {
        let visit = |place| Visit {
            place,
            rest: 0,
            window: None,
        };
        Job {
            visits: sites.into_iter().map(visit).collect(),
            vehicles: vec![true; vehicles],
        }
    }

    /// Fewest jobs left and least cost over every sharing and every order.
    fn exact(
        problem: &Assignment<'_>,
        done: &mut Vec<usize>,
        at: (usize, usize),
        sum: (u64, u64),
    ) -> (usize, u64) {
        let (vehicle, place) = at;
        let jobs = problem.jobs.iter().map(|job| job.visits.len());
        let Some(carrier) = problem.vehicles.get(vehicle) else {
            let left = jobs.zip(done.iter()).filter(|(job, done)| job != *done);
            return (left.count(), sum.0);
        };
        let way = |to: usize| -> u64 {
            carrier.ways[place][to]
                .expect("all ways are open")
                .uses
                .into()
        };
        let (before, own) = sum;
        let mut best = (usize::MAX, u64::MAX);
        let end = own + way(carrier.goal);
        let is_carrying = jobs
            .zip(done.iter())
            .any(|(job, done)| *done == 1 && job == 2);
        // Across vehicles a job that was begun must be finished by the same one.
        if end <= carrier.budget && !is_carrying {
            let next = problem
                .vehicles
                .get(vehicle + 1)
                .map_or(0, |next| next.start);
            best = exact(problem, done, (vehicle + 1, next), (before + end, 0));
        }
        for job in 0..problem.jobs.len() {
            if let Some(visit) = problem.jobs[job].visits.get(done[job]) {
                done[job] += 1;
                let to = visit.place;
                let own = own + way(to);
                if own <= carrier.budget {
                    best = best.min(exact(problem, done, (vehicle, to), (before, own)));
                }
                done[job] -= 1;
            }
        }
        best
    }

    #[test]
    fn jobs_are_shared_as_well_as_by_trying_everything() {
        let mut had_left = 0;
        for seed in 0..20 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let at: Vec<(i32, i32)> = (0..9)
                .map(|_| (rng.random_range(0..1000), rng.random_range(0..1000)))
                .collect();
            let ways: Vec<Vec<Option<Way>>> = at
                .iter()
                .map(|from| at.iter().map(|to| way(*from, *to)).collect())
                .collect();
            let budget = if seed % 2 == 0 { 10_000 } else { 1800 };
            let vehicles = [0, 1].map(|start| carrier(&ways, start, budget));
            let jobs = [vec![2, 3], vec![4, 5], vec![6], vec![7], vec![8]].map(|of| job(of, 2));
            let problem = Assignment {
                vehicles: &vehicles,
                jobs: &jobs,
            };
            let found = problem.assign(1).expect("whole");
            let least = exact(&problem, &mut vec![0; jobs.len()], (0, 0), (0, 0));
            assert_eq!((found.left.len(), found.cost), least, "seed {seed}");

            assert_eq!(
                problem.assign(1),
                Some(found.clone()),
                "same seed, same result"
            );
            had_left += usize::from(!found.left.is_empty());
            let mut seen: Vec<(usize, usize)> = found.visits.concat();
            seen.sort_unstable();
            let all = (0..jobs.len()).filter(|job| !found.left.contains(job));
            let all: Vec<_> = all
                .flat_map(|job| (0..jobs[job].visits.len()).map(move |at| (job, at)))
                .collect();
            assert_eq!(seen, all, "each job once");
        }
        assert!(had_left > 0, "no case lacked budget");
    }

    #[test]
    fn own_sites_stay_in_their_order_and_rest_counts() {
        let at = [(0, 0), (100, 0), (50, 0), (10, 0)];
        let ways: Vec<Vec<Option<Way>>> = at
            .iter()
            .map(|from| at.iter().map(|to| way(*from, *to)).collect())
            .collect();
        let mut jobs = [job(vec![1, 2], 1), job(vec![3], 1)];
        let own = Carrier {
            own: Some(0),
            rest_uses: 1,
            ..carrier(&ways, 0, 230)
        };
        let found = |jobs: &[Job], own| {
            let vehicles = [own];
            let problem = Assignment {
                vehicles: &vehicles,
                jobs,
            };
            problem.assign(1).expect("whole")
        };
        let both = found(&jobs, own);
        assert!(both.left.is_empty());
        assert_eq!(both.visits[0].len(), 3);
        assert_eq!(both.cost, 200);
        // 200 on its ways and 31 at rest are more than 230.
        jobs[1].visits[0].rest = 31;
        assert_eq!(found(&jobs, own).left, [1]);
        // What is its own is done anyway.
        jobs[1].visits[0].rest = 0;
        let poor = Carrier { budget: 10, ..own };
        let alone = found(&jobs, poor);
        assert_eq!((alone.visits[0].len(), alone.left), (2, vec![1]));
        jobs[1].vehicles = vec![false];
        assert_eq!(found(&jobs, own).left, [1]);
    }

    #[test]
    fn a_place_outside_of_the_matrix_is_refused() {
        let ways = vec![vec![way((0, 0), (0, 0))]];
        let vehicles = [carrier(&ways, 0, 1)];
        let jobs = [job(vec![1], 1)];
        let problem = Assignment {
            vehicles: &vehicles,
            jobs: &jobs,
        };
        assert_eq!(problem.assign(1), None);
    }
}

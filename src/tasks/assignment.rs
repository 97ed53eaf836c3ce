//! Who does which job, and in which order: regret insertion, then removal and new insertion.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Rounds of removal and new insertion after the first insertion.
const ROUNDS: usize = 3000;
/// Most jobs taken out in one round.
const MOST_REMOVED: usize = 6;

/// Jobs to share among vehicles. Places are rows of the matrix.
#[derive(Clone, Copy, Debug)]
pub struct Assignment<'a> {
    /// Cost of the way from the place of the row to that of the column; square, in one unit with
    /// the budgets. What is spent at a place belongs to the ways that lead there.
    pub costs: &'a [Vec<u32>],
    /// The vehicles; each goes once.
    pub vehicles: &'a [Carrier],
    /// Places of each job, visited in this order by one vehicle: one for a visit, pick-up and drop
    /// for a delivery. Other jobs may come between.
    pub jobs: &'a [Vec<usize>],
}

/// A vehicle as the assignment sees it.
#[derive(Clone, Copy, Debug)]
pub struct Carrier {
    /// Place where it begins.
    pub start: usize,
    /// Place where it ends.
    pub goal: usize,
    /// Most that its whole way may cost.
    pub budget: u64,
}

/// Who does what.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Assigned {
    /// For each vehicle its visits in order, as job and position within the job, without start
    /// and goal.
    pub visits: Vec<Vec<(usize, usize)>>,
    /// Jobs that found no vehicle with enough budget left, ascending.
    pub left: Vec<usize>,
    /// Sum of the ways of all vehicles; one without jobs goes from its start to its goal.
    pub cost: u64,
}

impl Assignment<'_> {
    /// Shares the jobs: as many as it finds room for, then for the least cost. The same seed gives
    /// the same result. `None` where a place is outside of the matrix or the matrix not square.
    #[must_use]
    pub fn assign(&self, seed: u64) -> Option<Assigned> {
        self.is_whole().then(|| self.search(seed))
    }

    fn is_whole(&self) -> bool {
        let size = self.costs.len();
        let ends = self.vehicles.iter().flat_map(|one| [one.start, one.goal]);
        let mut places = ends.chain(self.jobs.iter().flatten().copied());
        self.costs.iter().all(|row| row.len() == size) && places.all(|place| place < size)
    }

    fn search(&self, seed: u64) -> Assigned {
        let mut best = Assigned {
            visits: vec![Vec::new(); self.vehicles.len()],
            left: (0..self.jobs.len()).collect(),
            cost: 0,
        };
        self.insert(&mut best, None);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let most = MOST_REMOVED.min(self.jobs.len());
        for _ in 0..if most == 0 { 0 } else { ROUNDS } {
            let mut next = best.clone();
            for _ in 0..rng.random_range(1..=most) {
                let job = rng.random_range(0..self.jobs.len());
                if !next.left.contains(&job) {
                    next.left.push(job);
                }
                for visits in &mut next.visits {
                    visits.retain(|visit| visit.0 != job);
                }
            }
            // Half of the rounds insert in a random order, which regret would never take.
            let is_shuffled = rng.random_range(0..2) == 0;
            self.insert(&mut next, is_shuffled.then_some(&mut rng));
            // Equal ones are taken too: they lead across plateaus.
            if (next.left.len(), next.cost) <= (best.left.len(), best.cost) {
                best = next;
            }
        }
        best.left.sort_unstable();
        best
    }

    /// Inserts the jobs that are left wherever they fit: first those that lose most if their best
    /// vehicle is taken, or in random order.
    fn insert(&self, assigned: &mut Assigned, mut rng: Option<&mut ChaCha8Rng>) {
        let mut waiting = std::mem::take(&mut assigned.left);
        waiting.sort_unstable();
        while !waiting.is_empty() {
            let picked = match rng.as_deref_mut() {
                Some(rng) => rng.random_range(0..waiting.len()),
                None => self.most_regretted(assigned, &waiting),
            };
            let job = waiting.swap_remove(picked);
            let ways = (0..self.vehicles.len())
                .filter_map(|vehicle| self.cheapest(assigned, vehicle, job));
            match ways.min_by_key(|way| way.0) {
                Some((_, vehicle, visits)) => assigned.visits[vehicle] = visits,
                None => assigned.left.push(job),
            }
        }
        let costs = assigned.visits.iter().enumerate();
        assigned.cost = costs
            .map(|(vehicle, visits)| self.cost(vehicle, visits))
            .sum();
    }

    /// Position in the list of the job whose second best vehicle costs most more than its best.
    fn most_regretted(&self, assigned: &Assigned, waiting: &[usize]) -> usize {
        let regret = |job: usize| {
            let ways = (0..self.vehicles.len())
                .filter_map(|vehicle| self.cheapest(assigned, vehicle, job));
            let mut added: Vec<i64> = ways.map(|way| way.0).collect();
            added.sort_unstable();
            match added[..] {
                [] => i64::MIN,
                [_] => i64::MAX,
                [first, second, ..] => second - first,
            }
        };
        let regrets = waiting.iter().enumerate().rev();
        let most = regrets.max_by_key(|(_, job)| regret(**job));
        most.map_or(0, |(position, _)| position)
    }

    /// The cheapest way for a vehicle to do one more job within its budget: what it adds, the
    /// vehicle, and its visits with the job.
    fn cheapest(
        &self,
        assigned: &Assigned,
        vehicle: usize,
        job: usize,
    ) -> Option<(i64, usize, Vec<(usize, usize)>)> {
        let before = self.cost(vehicle, &assigned.visits[vehicle]);
        let mut visits = assigned.visits[vehicle].clone();
        let mut best = None;
        self.place(vehicle, (job, 0, 0), &mut visits, &mut best);
        let (cost, visits) = best?;
        Some((cost.cast_signed() - before.cast_signed(), vehicle, visits))
    }

    /// Tries every position for the places of the job (job, next of its places, first position).
    fn place(
        &self,
        vehicle: usize,
        (job, next, from): (usize, usize, usize),
        visits: &mut Vec<(usize, usize)>,
        best: &mut Option<(u64, Vec<(usize, usize)>)>,
    ) {
        if next == self.jobs[job].len() {
            let cost = self.cost(vehicle, visits);
            let is_better = best.as_ref().is_none_or(|(least, _)| cost < *least);
            if cost <= self.vehicles[vehicle].budget && is_better {
                *best = Some((cost, visits.clone()));
            }
            return;
        }
        for position in from..=visits.len() {
            visits.insert(position, (job, next));
            self.place(vehicle, (job, next + 1, position + 1), visits, best);
            visits.remove(position);
        }
    }

    /// Cost of the way of a vehicle with these visits.
    fn cost(&self, vehicle: usize, visits: &[(usize, usize)]) -> u64 {
        let Carrier { start, goal, .. } = self.vehicles[vehicle];
        let places = visits.iter().map(|&(job, place)| self.jobs[job][place]);
        let (sum, last) = places.fold((0, start), |(sum, from), to| {
            (sum + u64::from(self.costs[from][to]), to)
        });
        sum + u64::from(self.costs[last][goal])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fewest jobs left and least cost over every sharing and every order.
    fn exact(
        problem: &Assignment,
        done: &mut Vec<usize>,
        at: (usize, usize),
        sum: (u64, u64),
    ) -> (usize, u64) {
        let (vehicle, place) = at;
        let Some(carrier) = problem.vehicles.get(vehicle) else {
            let left =
                (problem.jobs.iter().zip(done.iter())).filter(|(job, done)| job.len() != **done);
            return (left.count(), sum.0);
        };
        let (before, own) = sum;
        let mut best = (usize::MAX, u64::MAX);
        let end = own + u64::from(problem.costs[place][carrier.goal]);
        let is_carrying =
            (problem.jobs.iter().zip(done.iter())).any(|(job, done)| *done == 1 && job.len() == 2);
        // Across vehicles a job that was begun must be finished by the same one.
        if end <= carrier.budget && !is_carrying {
            let next = problem
                .vehicles
                .get(vehicle + 1)
                .map_or(0, |next| next.start);
            best = exact(problem, done, (vehicle + 1, next), (before + end, 0));
        }
        for job in 0..problem.jobs.len() {
            if let Some(&to) = problem.jobs[job].get(done[job]) {
                done[job] += 1;
                let own = own + u64::from(problem.costs[place][to]);
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
            let way = |a: &(i32, i32), b: &(i32, i32)| a.0.abs_diff(b.0) + a.1.abs_diff(b.1);
            let costs: Vec<Vec<u32>> = at
                .iter()
                .map(|from| at.iter().map(|to| way(from, to)).collect())
                .collect();
            let budget = if seed % 2 == 0 { 10_000 } else { 1800 };
            let vehicles = [0, 1].map(|start| Carrier {
                start,
                goal: start,
                budget,
            });
            let jobs = [vec![2, 3], vec![4, 5], vec![6], vec![7], vec![8]];
            let problem = Assignment {
                costs: &costs,
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
                .flat_map(|job| (0..jobs[job].len()).map(move |at| (job, at)))
                .collect();
            assert_eq!(seen, all, "each job once");
        }
        assert!(had_left > 0, "no case lacked budget");
    }

    #[test]
    fn a_place_outside_of_the_matrix_is_refused() {
        let costs = vec![vec![0]];
        let vehicles = [Carrier {
            start: 0,
            goal: 0,
            budget: 1,
        }];
        let jobs = [vec![1]];
        let problem = Assignment {
            costs: &costs,
            vehicles: &vehicles,
            jobs: &jobs,
        };
        assert_eq!(problem.assign(1), None);
    }
}

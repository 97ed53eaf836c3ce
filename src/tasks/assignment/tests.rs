//! Assignments against those that try everything.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

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
        max_visits: 100,
        begins: (0, 0),
        slowest: 1000,
        late_after_way: 0,
        wait_step: 1,
        closed: &[],
    }
}

fn job(sites: Vec<usize>, vehicles: usize) -> Job {
    let visit = |place| Visit {
        place,
        rest: 0,
        window: None,
        depth: Some(0),
    };
    Job {
        visits: sites.into_iter().map(visit).collect(),
        vehicles: vec![true; vehicles],
        form: Form::Open,
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

#[test]
fn visits_at_one_place_wait_for_the_last_of_their_windows_before_anything_is_done() {
    let sites = [(0, 0), (100, 0)];
    let ways: Vec<Vec<Option<Way>>> = sites
        .iter()
        .map(|from| sites.iter().map(|to| way(*from, *to)).collect())
        .collect();
    let carriers = [carrier(&ways, 0, u64::MAX)];
    let timed = |window, rest| Job {
        visits: vec![Visit {
            place: 1,
            rest,
            window: Some(window),
            depth: Some(0),
        }],
        ..job(vec![1], 1)
    };
    let jobs = [
        timed((1000, 1060), 3),
        timed((300, 2000), 60),
        timed((400, 410), 1),
    ];
    let problem = Assignment {
        vehicles: &carriers,
        jobs: &jobs,
    };
    for order in [[(0, 0), (1, 0)], [(1, 0), (0, 0)]] {
        let waits = problem.waits(0, &order);
        let begins = 99 + waits.iter().max().expect("two waits");
        assert!((1000..=1001).contains(&begins), "{order:?}: {waits:?}");
    }
    // One stop cannot begin in two windows that have no moment in common.
    assert!(problem.go(0, [(2, 0), (0, 0)].into_iter()).is_none());
}

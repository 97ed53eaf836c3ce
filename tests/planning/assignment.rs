//! The assignment of tasks against an exact solver.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use sortie::tasks::{Assignment, Carrier, Form, Job, Visit, Way};

use crate::support::peers;

const TASKS: usize = 20;
const VEHICLES: usize = 5;

/// Places of 20 tasks and the pads of 5 copters, 50 m from takeoff to landing, in 6 by 6 km; ways in tenths of
/// seconds at 9 m/s, slower to the east by up to 30 %, as in a wind.
fn ways(seed: u64) -> Vec<Vec<Option<Way>>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut place = || [0; 2].map(|_| rng.random_range(0.0..6000.0_f64));
    let mut places: Vec<[f64; 2]> = (0..TASKS).map(|_| place()).collect();
    for _ in 0..VEHICLES {
        let [east, north] = place();
        places.extend([[east, north], [east + 50.0, north]]);
    }
    let slower = rng.random_range(0.0..0.3);
    let way = |from: &[f64; 2], to: &[f64; 2]| {
        let length_m = (to[0] - from[0]).hypot(to[1] - from[1]);
        let share = if to[0] > from[0] { 1.0 + slower } else { 1.0 };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "some thousand"
        )]
        let time = (share * length_m / 9.0 * 10.0).round() as u32;
        Some(Way { time, uses: time })
    };
    let row = |from: &[f64; 2]| places.iter().map(|to| way(from, to)).collect();
    places.iter().map(row).collect()
}

fn pads(vehicle: usize) -> [usize; 2] {
    let start = TASKS + 2 * vehicle;
    [start, start + 1]
}

/// The cost of the sharing that is found.
fn assigned(ways: &[Vec<Option<Way>>]) -> u64 {
    let vehicles: Vec<Carrier<'_>> = (0..VEHICLES)
        .map(|vehicle| Carrier {
            ways,
            start: pads(vehicle)[0],
            goal: pads(vehicle)[1],
            own: None,
            budget: u64::MAX,
            rest_uses: 0,
            max_visits: 100,
            begins: (0, 0),
            slowest: 1000,
            late_after_way: 0,
            wait_step: 1,
            closed: &[],
        })
        .collect();
    let job = |place| Job {
        visits: vec![Visit {
            place,
            rest: 0,
            window: None,
            depth: Some(0),
        }],
        vehicles: vec![true; VEHICLES],
        form: Form::Open,
    };
    let jobs: Vec<Job> = (0..TASKS).map(job).collect();
    let problem = Assignment {
        vehicles: &vehicles,
        jobs: &jobs,
    };
    let found = problem.assign(1).expect("whole");
    assert!(found.left.is_empty(), "{:?}", found.left);
    found.cost
}

#[test]
fn twenty_tasks_of_five_vehicles_are_shared_within_two_percent_of_an_exact_solver() {
    let Some(python) = peers::python() else {
        return;
    };
    let cases: Vec<_> = (0..20).map(ways).collect();
    let documents = cases.iter().map(|ways| {
        let times = |row: &Vec<Option<Way>>| row.iter().flatten().map(|way| way.time).collect();
        let times: Vec<Vec<u32>> = ways.iter().map(times).collect();
        let visits: Vec<usize> = (0..TASKS).collect();
        let vehicles: Vec<[usize; 2]> = (0..VEHICLES).map(pads).collect();
        json!({"ways": times, "visits": visits, "vehicles": vehicles})
    });
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("cases.json");
    let documents = Value::Array(documents.collect());
    std::fs::write(&path, documents.to_string()).expect("written");
    let solved = peers::run(&python, "assign.py", &[&path.display().to_string()]);
    let mut worst = 0.0_f64;
    for (seed, ways) in cases.iter().enumerate() {
        #[expect(clippy::cast_precision_loss, reason = "some thousand")]
        let cost = assigned(ways) as f64;
        let bound = solved[seed]["bound"].as_f64().expect("a proven bound");
        assert!(
            cost >= bound - 0.5,
            "case {seed}: {cost} is below the bound {bound}"
        );
        worst = worst.max(cost / bound - 1.0);
        assert!(
            cost <= 1.02 * bound,
            "case {seed}: {cost}, and at least {bound}: {}",
            solved[seed]
        );
    }
    assert!(worst < 0.02, "{worst}");
}

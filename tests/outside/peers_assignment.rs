//! Who does which task, against a solver that proves how little it can cost.
//!
//! Peer: CP-SAT of ortools 9.15.

use crate::support::peers;

use std::fs;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use sortie::tasks::{Assignment, Carrier, Form, Job, Visit, Way};

const TASKS: usize = 20;
const VEHICLES: usize = 5;
/// Time for the proof of one case; most take a second.
const SECONDS: &str = "60";

/// Places in a square of 10 km: tasks, then start and goal of each vehicle; and what one vehicle
/// may use, which binds in every second case.
fn case(seed: u64) -> (Vec<Vec<u32>>, u64) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut at: Vec<(f64, f64)> = Vec::new();
    for _ in 0..TASKS + 2 * VEHICLES {
        at.push((
            rng.random_range(0.0..10_000.0),
            rng.random_range(0.0..10_000.0),
        ));
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "at most 15 km"
    )]
    let time = |a: &(f64, f64), b: &(f64, f64)| (a.0 - b.0).hypot(a.1 - b.1).round() as u32;
    let times = at.iter().map(|a| at.iter().map(|b| time(a, b)).collect());
    (
        times.collect(),
        if seed.is_multiple_of(2) {
            1_000_000
        } else {
            16_000
        },
    )
}

/// The cost of the sharing that was found; none where tasks are left.
fn shared(times: &[Vec<u32>], budget: u64) -> Option<u64> {
    let way = |time: &u32| {
        Some(Way {
            time: *time,
            uses: *time,
        })
    };
    let ways: Vec<Vec<Option<Way>>> = times
        .iter()
        .map(|row| row.iter().map(way).collect())
        .collect();
    let carrier = |vehicle: usize| Carrier {
        ways: &ways,
        start: TASKS + 2 * vehicle,
        goal: TASKS + 2 * vehicle + 1,
        own: None,
        budget,
        rest_uses: 0,
        most_visits: 100,
        begins: 0,
        slowest: 1000,
        wait_step: 1,
    };
    let vehicles: Vec<Carrier<'_>> = (0..VEHICLES).map(carrier).collect();
    let job = |place: usize| Job {
        visits: vec![Visit {
            place,
            rest: 0,
            window: None,
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
    found.left.is_empty().then_some(found.cost)
}

#[test]
fn no_sharing_of_twenty_tasks_costs_less_by_more_than_two_percent() {
    let Some(python) = peers::python() else {
        return;
    };
    let cases = (0..20).map(|seed| {
        let (times, budget) = case(seed);
        let known = shared(&times, budget).expect("all tasks are done");
        json!({"times": times, "vehicles": VEHICLES, "budget": budget, "known": known})
    });
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("cases.json");
    let cases: Vec<Value> = cases.collect();
    fs::write(&file, serde_json::to_string(&cases).expect("JSON")).expect("written");
    let name = file.to_str().expect("a path");
    let answers = peers::run(&python, "assign_exactly.py", &[name, SECONDS]);
    let answers = answers.as_array().expect("a list");
    assert_eq!(answers.len(), cases.len());
    for (seed, answer) in answers.iter().enumerate() {
        assert_eq!(answer["better"], json!(false), "case {seed}: {answer}");
    }
}

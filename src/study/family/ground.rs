//! Problems that are hard in altitude.

use std::f64::consts::TAU;

use rand::RngExt;

use super::{BASE_AMSL_M, Problem, Rng, Round, Zone};
use crate::numeric::as_f64;

/// A valley that winds over 16 km between ridges of some 400 m, under a ceiling of 250 m over the
/// plain.
pub(super) fn canyon(rng: &mut Rng) -> Problem {
    const LENGTH_M: f64 = 16_000.0;
    const STEP_M: f64 = 450.0;
    /// Hills from two steps before the start to some behind the goal.
    const STEPS: usize = 41;
    let (bow_m, wave_m) = (
        rng.random_range(800.0..1400.0),
        rng.random_range(6000.0..9000.0),
    );
    let (turn, half_m) = (rng.random_range(0.0..TAU), rng.random_range(900.0..1200.0));
    let middle = |east_m: f64| (east_m, bow_m * (TAU * east_m / wave_m + turn).sin());
    let area = ((-1000.0, -5000.0), (LENGTH_M + 1000.0, 5000.0));
    let mut problem = Problem::new(area, (middle(0.0), middle(LENGTH_M)));
    problem.max_amsl_m = BASE_AMSL_M + 250.0;
    problem.speed_mps = 9.0;
    problem.slopes_deg = (8.0, 6.0);
    for step in 0..STEPS {
        let (east_m, north_m) = middle(STEP_M * (as_f64(step) - 2.0));
        for side in [-1.0, 1.0] {
            for row in 0..4 {
                let away_m = half_m + 700.0 * f64::from(row) + rng.random_range(-50.0..50.0);
                problem.hills.push(Round {
                    at: (east_m, north_m + side * away_m),
                    radius_m: 500.0,
                    height_m: rng.random_range(150.0..200.0),
                });
            }
        }
    }
    problem
}

/// A plateau 250 m high and 5 to 7 km wide across the way of 14 km, slopes of 2.5 to 4 degrees.
pub(super) fn plateau(rng: &mut Rng) -> Problem {
    const LENGTH_M: f64 = 14_000.0;
    const STEP_M: f64 = 600.0;
    let goal = (LENGTH_M, rng.random_range(-800.0..800.0));
    let area = ((-1000.0, -6000.0), (LENGTH_M + 1000.0, 6000.0));
    let mut problem = Problem::new(area, ((0.0, 0.0), goal));
    problem.max_amsl_m = BASE_AMSL_M + 600.0;
    problem.speed_mps = 9.0;
    problem.slopes_deg = (rng.random_range(2.5..4.0), rng.random_range(2.5..4.0));
    let (north_m, radius_m) = (
        rng.random_range(-1500.0..1500.0),
        rng.random_range(2500.0..3500.0),
    );
    for column in -6..=6 {
        for row in -6..=6 {
            let at = (STEP_M * f64::from(column), STEP_M * f64::from(row));
            if at.0.hypot(at.1) < radius_m {
                problem.hills.push(Round {
                    at: (0.5 * LENGTH_M + at.0, north_m + at.1),
                    radius_m: 550.0,
                    height_m: rng.random_range(85.0..110.0),
                });
            }
        }
    }
    problem
}

/// 305 hills of three sizes over 15 km, and 14 threats.
pub(super) fn rough(rng: &mut Rng) -> Problem {
    const LENGTH_M: f64 = 15_000.0;
    let area = ((-1000.0, -5000.0), (LENGTH_M + 1000.0, 5000.0));
    let mut problem = Problem::new(area, ((0.0, 0.0), (LENGTH_M, 0.0)));
    problem.max_amsl_m = BASE_AMSL_M + 900.0;
    problem.speed_mps = 9.0;
    problem.slopes_deg = (8.0, 6.0);
    for (count, height_m, radius_m) in [(25, 160.0, 1800.0), (80, 80.0, 800.0), (200, 35.0, 350.0)]
    {
        for _ in 0..count {
            problem.hills.push(Round {
                at: (
                    rng.random_range(-1000.0..LENGTH_M + 1000.0),
                    rng.random_range(-5000.0..5000.0),
                ),
                radius_m: radius_m * rng.random_range(0.7..1.3),
                height_m: height_m * rng.random_range(0.5..1.5),
            });
        }
    }
    for _ in 0..14 {
        problem.threats.push(Round {
            at: (
                rng.random_range(1500.0..LENGTH_M - 1500.0),
                rng.random_range(-3500.0..3500.0),
            ),
            radius_m: rng.random_range(300.0..900.0),
            height_m: 0.0,
        });
    }
    problem
}

/// Three to five rows of zones across 12 km, closed below 90 to 300 m over the ground; between
/// neighbours 5 or 120 m are free.
pub(super) fn overflight(rng: &mut Rng) -> Problem {
    const LENGTH_M: f64 = 12_000.0;
    const HALF_M: f64 = 3000.0;
    let ends = [0.0, LENGTH_M].map(|east_m| (east_m, rng.random_range(-1500.0..1500.0)));
    let area = ((-500.0, -HALF_M), (LENGTH_M + 500.0, HALF_M));
    let mut problem = Problem::new(area, ends.into());
    problem.max_amsl_m = BASE_AMSL_M + 320.0;
    problem.slopes_deg = (8.0, 6.0);
    for row in 1..=rng.random_range(3..=5_usize) {
        let east_m = LENGTH_M * as_f64(row) / 6.0 + rng.random_range(-200.0..200.0);
        let mut north_m = -HALF_M;
        while north_m < HALF_M {
            let next_m = north_m + rng.random_range(700.0..1800.0);
            let gap_m = [5.0, 5.0, 120.0][rng.random_range(0..3)];
            let height_m = [90.0, 140.0, 200.0, 300.0][rng.random_range(0..4)];
            let to = (east_m + rng.random_range(300.0..900.0), next_m - gap_m);
            let block = Zone::block((east_m, north_m), to);
            problem.zones.push(block.below(BASE_AMSL_M + height_m));
            north_m = next_m;
        }
    }
    problem
}

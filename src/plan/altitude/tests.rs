//! Laws of the lowest spline.

use super::*;
use crate::numeric::Basis;
use proptest::prelude::*;

fn rows(controls: usize, samples: usize) -> Vec<Row> {
    let basis = Basis::uniform(controls, samples);
    (0..samples).map(|k| basis.row(k)).collect()
}

fn altitudes(rows: &[Row], z: &[f64]) -> Vec<f64> {
    rows.iter()
        .map(|(first, w)| (0..4).map(|i| w[i] * z[first + i]).sum())
        .collect()
}

/// Ten control points over 101 samples.
fn solve(floor: &[f64], weights: &[f64], ends: (f64, f64), step_m: f64) -> Vec<f64> {
    let rows = rows(10, 101);
    let mut z = vec![0.0; 10];
    (z[0], z[9]) = ends;
    let demand = Demand {
        floor_m: floor.to_vec(),
        up_m: vec![step_m; 100],
        down_m: vec![step_m; 100],
        weights: weights.to_vec(),
        ..Demand::default()
    };
    AltitudeLp::new(rows, 10).solve(&demand, &mut z, &mut Workspace::default());
    z
}

#[test]
fn over_a_flat_floor_the_path_is_flat() {
    let z = solve(&[460.0; 101], &[1.0; 101], (460.0, 460.0), 1.0);
    assert!(z.iter().all(|z| (z - 460.0).abs() < 1e-3), "{z:?}");
}

#[test]
fn near_an_end_the_floor_binds_as_far_as_slopes_reach_it() {
    let rows = rows(10, 2001);
    let altitude_over = |bump_m: f64| {
        let mut demand = Demand {
            floor_m: vec![100.0; 2001],
            up_m: vec![0.05; 2000],
            down_m: vec![0.05; 2000],
            weights: vec![1.0; 2001],
            ..Demand::default()
        };
        demand.floor_m[8] += bump_m;
        let mut z = vec![100.0; 10];
        AltitudeLp::new(rows.clone(), 10).solve(&demand, &mut z, &mut Workspace::default());
        altitudes(&rows, &z)[8]
    };
    assert!(altitude_over(0.3) > 100.3 - 1e-5);
    // 0.4 m is the most that eight steps climb.
    assert!(altitude_over(0.5) < 100.1);
}

#[test]
fn a_neighbour_s_basis_changes_the_way_to_the_answer_and_not_the_answer() {
    let rows = rows(26, 101);
    let lp = AltitudeLp::new(rows.clone(), 26);
    let mut warm = Workspace::default();
    for shift in 0..20 {
        let floor_m = (0..101)
            .map(|k| 100.0 + 60.0 * (f64::from(k + shift) * 0.17).sin())
            .collect();
        let demand = Demand {
            floor_m,
            up_m: vec![9.0; 100],
            down_m: vec![8.0; 100],
            weights: (0..101)
                .map(|k| 1.0 + 0.01 * f64::from(k * shift % 7))
                .collect(),
            ..Demand::default()
        };
        let solved = |work: &mut Workspace| {
            let mut z = vec![170.0; 26];
            lp.solve(&demand, &mut z, work);
            z
        };
        let (warm, cold) = (solved(&mut warm), solved(&mut Workspace::default()));
        for (a, b) in warm.iter().zip(&cold) {
            assert!((a - b).abs() < 1e-6, "{warm:?} {cold:?}");
        }
    }
}

#[test]
fn slope_limits_hold_where_feasible_and_are_dropped_elsewhere() {
    let rows = rows(10, 101);
    let mut floor = vec![100.0; 101];
    floor[50] = 300.0;
    let peak = |step_m| solve(&floor, &[1.0; 101], (100.0, 100.0), step_m);
    let steepest = |z: &[f64]| {
        altitudes(&rows, z)
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).abs())
            .fold(0.0, f64::max)
    };
    let free = peak(f64::INFINITY);
    let limit = 0.8 * steepest(&free);
    assert!((steepest(&peak(limit)) - limit).abs() < 1e-3);
    // 200 m up in 50 steps of 3 m: no.
    assert_eq!(free, peak(3.0));
}

proptest! {
    /// A law of linear programs: no feasible point costs less.
    #[test]
    fn no_spline_over_the_floor_is_lower(
        peaks in prop::collection::vec((0.15..0.85_f64, 50.0..900.0_f64, 0.02..0.3_f64), 1..5),
        speeds in prop::collection::vec(0.2..3.0_f64, 101),
        moves in prop::collection::vec(prop::collection::vec(-40.0..40.0_f64, 8), 40),
    ) {
        let rows = rows(10, 101);
        let floor: Vec<f64> = (0..101).map(|k| {
            let u = f64::from(k) / 100.0;
            100.0 + peaks.iter()
                .map(|(at, height, width)| height * (-((u - at) / width).powi(2)).exp())
                .sum::<f64>()
        }).collect();
        let z = solve(&floor, &speeds, (floor[0] + 20.0, floor[100] + 20.0), f64::INFINITY);
        let lp = AltitudeLp::new(rows.clone(), 10);
        let height = |z: &[f64]| -> f64 {
            altitudes(&rows, z).iter().zip(&speeds).map(|(a, w)| a * w).sum()
        };
        let short_by = |z: &[f64]| -> f64 {
            altitudes(&rows, z).iter().zip(&floor).zip(&lp.binding)
                .filter(|(_, binding)| **binding)
                .map(|((a, h), _)| h - a)
                .fold(f64::NEG_INFINITY, f64::max)
        };
        prop_assert!(short_by(&z) < 1e-5);
        for change in &moves {
            let mut other = z.clone();
            for (value, change) in other[1..9].iter_mut().zip(change) {
                *value += change;
            }
            // Lifted as far as it is short: feasible.
            let lift = short_by(&other).max(0.0) / (1.0 - END_WEIGHT);
            other[1..9].iter_mut().for_each(|value| *value += lift);
            prop_assert!(height(&other) >= height(&z) - 1e-3, "{} < {}", height(&other), height(&z));
        }
    }

    #[test]
    fn the_fallback_clears_the_floor(floor in prop::collection::vec(0.0..500.0_f64, 101)) {
        let rows = rows(10, 101);
        let mut z = vec![500.0; 10];
        AltitudeLp::new(rows.clone(), 10).lift(&floor, &mut z);
        for (altitude, h) in altitudes(&rows, &z).iter().zip(&floor) {
            prop_assert!(*altitude >= h - 1e-9);
        }
    }
}

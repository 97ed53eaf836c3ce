//! Laws of the altitudes of least cost.

use proptest::prelude::*;

use super::*;
use crate::numeric::Basis;
use crate::plan::altitude::{AltitudeLp, Workspace};

const CONTROLS: usize = 20;
const SAMPLES: usize = 401;
const RUN_M: f64 = 10.0;
const PRICES: AltitudePrices = AltitudePrices {
    length: 1.0,
    altitude: 1.0,
};

struct Solved {
    demand: Demand,
    decoded: Profile,
    cheapest: Profile,
    cost: (f64, f64),
}

/// Over a floor 4 km long, with slopes up to 0.3, under a roof.
fn solved(floor_m: Vec<f64>, roof_m: f64) -> Solved {
    let basis = Basis::uniform(CONTROLS, SAMPLES);
    let rows: Vec<Row> = (0..SAMPLES).map(|k| basis.row(k)).collect();
    let demand = Demand {
        up_m: vec![0.3 * RUN_M; SAMPLES - 1],
        down_m: vec![0.3 * RUN_M; SAMPLES - 1],
        weights: vec![RUN_M; SAMPLES],
        floor_m,
        ..Demand::default()
    };
    let mut amsl_m = vec![0.0; CONTROLS];
    (amsl_m[0], amsl_m[CONTROLS - 1]) =
        (demand.floor_m[0] + 1.0, demand.floor_m[SAMPLES - 1] + 1.0);
    let lp = AltitudeLp::new(rows.clone(), CONTROLS);
    lp.solve(&demand, &mut amsl_m, &mut Workspace::default());
    let runs_m = vec![RUN_M; SAMPLES - 1];
    let roof_m = vec![roof_m; SAMPLES];
    let least = LeastCost::new(&rows, (&demand, &runs_m), &roof_m, PRICES, &amsl_m);
    let least = least.expect("samples are dense");
    let decoded = Profile::of(&rows, &amsl_m);
    least.improve(&mut amsl_m);
    let cheapest = Profile::of(&rows, &amsl_m);
    let cost = (least.cost(&decoded), least.cost(&cheapest));
    Solved {
        demand,
        decoded,
        cheapest,
        cost,
    }
}

fn dips(depth_m: f64, count: f64) -> Vec<f64> {
    let share = |k: u32| f64::from(k) / 400.0;
    (0..401)
        .map(|k| 500.0 + depth_m * (std::f64::consts::TAU * count * share(k)).cos())
        .collect()
}

#[test]
fn over_short_dips_the_decoded_path_is_not_the_cheapest() {
    let Solved {
        decoded,
        cheapest,
        cost: (before, after),
        ..
    } = solved(dips(20.0, 6.0), f64::INFINITY);
    assert!(after < before - 1e-3, "{before} {after}");
    // It is higher for what it saves in length.
    let height_m = |of: &Profile| of.amsl_m.iter().sum::<f64>();
    assert!(height_m(&cheapest) > height_m(&decoded));
}

#[test]
fn over_long_dips_the_decoded_path_is_the_cheapest() {
    let Solved {
        cost: (before, after),
        ..
    } = solved(dips(60.0, 1.0), f64::INFINITY);
    assert!(after <= before && after > before - 2e-3, "{before} {after}");
}

proptest! {
    /// Up to what the limits are wider than those of the LP; where its path misses one, that
    /// of least cost misses it by no more.
    #[test]
    fn no_limit_is_violated_that_the_decoded_path_satisfies(
        heights in proptest::collection::vec(0.0..120.0_f64, 9), over_m in 5.0..80.0_f64
    ) {
        let floor_m = (0..401_u32)
            .map(|k| {
                let at = f64::from(k) / 50.0;
                let cell = usize::try_from(k / 50).unwrap_or(0).min(7);
                let part = at - at.floor();
                let part = if k == 400 { 1.0 } else { part };
                heights[cell] + part * (heights[cell + 1] - heights[cell])
            })
            .collect();
        let roof_m = 120.0 + over_m;
        let Solved { demand, decoded, cheapest, cost } = solved(floor_m, roof_m);
        prop_assert!(cost.1 <= cost.0);
        for (k, (low_m, cheap_m)) in decoded.amsl_m.iter().zip(&cheapest.amsl_m).enumerate() {
            prop_assert!(*cheap_m > demand.floor_m[k].min(*low_m) - WIDER_M);
            prop_assert!(*cheap_m < roof_m.max(low_m + WIDER_M));
        }
        for (low_m, cheap_m) in decoded.rise_m.iter().zip(&cheapest.rise_m) {
            let max_m = 0.3 * RUN_M * (1.0 + STEEPER);
            prop_assert!(cheap_m.abs() < max_m.max(low_m.abs() + RISE_M));
        }
    }
}

//! Same seed, same bytes: on any number of threads, in any order of runs.

mod support;

use sortie::plan::{FleetPlan, Request, plan_fleet};
use sortie::spec::*;
use support::{copter, empty_spec, place, world};

/// Three vehicles among hills and threats.
fn spec(algorithm: Algorithm) -> MissionSpec {
    let mut spec = empty_spec(vec![
        copter("alpha", 1, place(36.30, -84.32), place(36.30, -84.18)),
        copter("bravo", 2, place(36.24, -84.25), place(36.36, -84.25)),
        copter("charlie", 3, place(36.25, -84.31), place(36.35, -84.19)),
    ]);
    spec.terrain = TerrainSource::Analytic {
        base: sortie::geodesy::Amsl(400.0),
        hills: (0..6)
            .map(|k| Hill {
                place: place(
                    36.25 + 0.02 * f64::from(k),
                    -84.30 + 0.017 * f64::from(k * k % 7),
                ),
                height_m: 150.0 + 30.0 * f64::from(k),
                radius_m: 1500.0,
            })
            .collect(),
    };
    spec.threats = vec![Threat {
        id: "radar-1".to_owned(),
        kind: "radar".to_owned(),
        place: place(36.30, -84.25),
        radius_m: 1500.0,
    }];
    spec.planner.algorithm = algorithm;
    spec.planner.evaluations = 1500;
    spec
}

fn plan(spec: &MissionSpec, seed: u64, threads: usize) -> FleetPlan {
    let world = world(spec);
    let request = Request {
        seed,
        margins: Vec::new(),
        extra_parameters: Vec::new(),
        progress: &|_| (),
    };
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("a pool")
        .install(|| plan_fleet(spec, &world, &request))
}

/// Every bit of a plan, as text.
fn bytes(plan: &FleetPlan) -> String {
    format!("{plan:?}")
}

#[test]
fn a_plan_is_the_same_on_one_two_and_eight_threads() {
    for algorithm in [Algorithm::Msfoa, Algorithm::MsfoaDwindle] {
        let spec = spec(algorithm);
        let one = bytes(&plan(&spec, 7, 1));
        assert_eq!(one, bytes(&plan(&spec, 7, 2)));
        assert_eq!(one, bytes(&plan(&spec, 7, 8)));
        assert_ne!(one, bytes(&plan(&spec, 8, 2)));
    }
}

#[test]
fn a_vehicle_added_at_the_end_changes_nothing_before_it() {
    let three = spec(Algorithm::Msfoa);
    let mut two = three.clone();
    two.vehicles.pop();
    assert_eq!(
        plan(&three, 3, 2).vehicles[..2],
        plan(&two, 3, 2).vehicles[..]
    );
}

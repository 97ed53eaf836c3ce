//! Same seed, same bytes: on any number of threads, in any order of runs.

use crate::support;

use sortie::plan::{FleetPlan, Request, plan_fleet, plan_one_at_a_time, replan};
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
    let request = Request::new(seed);
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

/// Copters across each other's ways: more than are planned around all before them.
fn crowd() -> MissionSpec {
    let copters = (0..24_u8).map(|n| {
        let (row, side) = (f64::from(n % 12), f64::from(n / 12));
        let id = format!("v{n:02}");
        let way = if n < 12 {
            (
                place(36.24 + 0.01 * row, -84.32),
                place(36.35 - 0.01 * row, -84.18),
            )
        } else {
            (
                place(36.24, -84.31 + 0.01 * row),
                place(36.36, -84.19 - 0.01 * row * side),
            )
        };
        copter(&id, n + 1, way.0, way.1)
    });
    let mut spec = empty_spec(copters.collect());
    for (vehicle, n) in spec.vehicles.iter_mut().zip(0_u8..) {
        vehicle.depart_s = f64::from(n % 7) * 9.0;
    }
    spec.planner.evaluations = 120;
    spec
}

#[test]
fn a_crowd_planned_at_once_is_the_one_planned_one_at_a_time() {
    let hurried = crowd();
    let mut patient = crowd();
    for vehicle in patient.vehicles.iter_mut().skip(1).step_by(2) {
        vehicle.retiming.depart_s = Some(Span {
            least: vehicle.depart_s,
            most: vehicle.depart_s + 40.0,
        });
    }
    for spec in [hurried, patient] {
        let request = Request::new(5);
        let one_at_a_time = plan_one_at_a_time(&spec, &world(&spec), &request);
        let again = one_at_a_time.vehicles.iter().filter(|plan| plan.plans > 1);
        assert!(again.count() > 5, "too few meet for this to say anything");
        for threads in [1, 2, 8] {
            assert_eq!(bytes(&plan(&spec, 5, threads)), bytes(&one_at_a_time));
        }
    }
}

#[test]
fn planning_one_again_leaves_alone_whom_it_does_not_meet() {
    let spec = crowd();
    let world = world(&spec);
    let mut request = Request::new(5);
    let first = plan_fleet(&spec, &world, &request);
    request.margins = vec![Default::default(); spec.vehicles.len()];
    request.margins[12].clearance_m = 30.0;
    let second = replan(&first, &[12], &spec, &world, &request);
    assert_ne!(first.vehicles[12].routes, second.vehicles[12].routes);
    assert!(second.vehicles[12].plans > first.vehicles[12].plans);
    let pairs = || first.vehicles.iter().zip(&second.vehicles);
    assert!(pairs().take(12).all(|(a, b)| a == b));
    let changed = pairs().filter(|(a, b)| a != b).count();
    assert!((1..12).contains(&changed), "{changed}");
    // Nobody meets anybody the worse for it.
    for (a, b) in pairs() {
        assert!(b.terms.collision <= a.terms.collision + 1e-9);
    }
    let threads = |count: usize| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(count)
            .build()
            .expect("a pool")
            .install(|| replan(&first, &[12], &spec, &world, &request))
    };
    assert_eq!(bytes(&threads(1)), bytes(&second));
    assert_eq!(bytes(&threads(8)), bytes(&second));
}

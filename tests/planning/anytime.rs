//! Plans of rising quality, cold and warm, and reviews that know what they judged before.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use sortie::dispatch::{Improving, dispatch};
use sortie::mission::{VehicleMission, command};
use sortie::spec::{MissionSpec, SpecFile};
use sortie::verify::{Reviewer, review};
use sortie::world::World;

use crate::support::{copter, empty_spec, place, threat, world};

/// Two vehicles that cross behind a threat.
fn crossing() -> (MissionSpec, World) {
    let mut spec = empty_spec(vec![
        copter("alpha", 1, place(36.30, -84.28), place(36.30, -84.22)),
        copter("bravo", 2, place(36.28, -84.25), place(36.32, -84.25)),
    ]);
    spec.threats = vec![threat("radar-1", place(36.30, -84.25), 500.0)];
    spec.planner.evaluations = 4000;
    let world = world(&spec);
    (spec, world)
}

/// A plane over terrain: it gets cheaper with the evaluations. Copters past a threat are drawn taut, and cost the
/// same from the fewest on.
fn plane() -> (MissionSpec, World) {
    let missions = Path::new(env!("CARGO_MANIFEST_DIR")).join("missions");
    let file = SpecFile::read(&missions.join("plane-ardupilot.yaml")).expect("the spec");
    let world = sortie::world::load(&file).expect("the terrain");
    let mut spec = file.spec;
    spec.planner.evaluations = 4000;
    (spec, world)
}

#[test]
fn plans_come_verified_each_cheaper_than_the_one_before() {
    let (spec, world) = plane();
    let cancel = AtomicBool::new(false);
    let plans: Vec<_> = Improving::new(&spec, &world, 1, &cancel).collect();
    let cost = |index: usize| plans[index].dispatched.plan.cost();
    assert!(plans.len() > 1, "{}", plans.len());
    for (index, plan) in plans.iter().enumerate() {
        assert!(plan.dispatched.review.passes());
        assert!(plan.dispatched.plan.gap().is_some_and(|gap| gap >= 0.0));
        assert!(index == 0 || cost(index) < cost(index - 1));
        let mut same = spec.clone();
        same.planner.evaluations = plan.evaluations;
        let again = dispatch(&same, &world, 1, &|_| ());
        assert_eq!(again.plan, plan.dispatched.plan);
        assert_eq!(again.missions, plan.dispatched.missions);
    }
}

#[test]
fn more_than_the_default_evaluations_never_cost_more_than_the_default_ones() {
    // Alone, 100 000 end 0.01 % above 40 000 here: in another race of the same gaps.
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = ["study", "scenario", "--family", "gaps", "--seed", "33"];
    let spec = crate::support::command::sortie(folder.path(), &arguments);
    std::fs::write(folder.path().join("gaps.yaml"), spec.stdout).expect("a spec");
    let file = SpecFile::read(&folder.path().join("gaps.yaml")).expect("the spec");
    let world = sortie::world::load(&file).expect("flat ground");
    let cost = |evaluations: usize| {
        let mut spec = file.spec.clone();
        spec.planner.evaluations = evaluations;
        let found = dispatch(&spec, &world, 1, &|_| ());
        assert!(found.review.passes());
        found.plan.cost()
    };
    assert!(cost(100_000) <= cost(40_000));
}

#[test]
fn an_earlier_plan_of_a_spec_that_changed_a_little_is_taken_over_at_once() {
    let (mut spec, _) = crossing();
    let earlier = dispatch(&spec, &world(&spec), 1, &|_| ());
    spec.area.min_agl.0 += 10.0;
    let world = world(&spec);
    let cancel = AtomicBool::new(false);
    let mut plans = Improving::new(&spec, &world, 1, &cancel).from_earlier(&earlier.plan);
    let first = plans.next().expect("a plan").dispatched;
    assert!(first.review.passes());
    for (old, new) in earlier.plan.vehicles.iter().zip(&first.plan.vehicles) {
        assert_eq!((new.evaluations, new.plans), (1, 1));
        let places = |plan: &sortie::plan::VehiclePlan| {
            let points = plan.routes[0].control_points.iter();
            points.map(|point| point.at).collect::<Vec<_>>()
        };
        assert_eq!(places(old), places(new));
        assert!(new.bound <= new.terms.total());
    }
}

#[test]
fn a_cancelled_search_yields_nothing_more() {
    let (spec, world) = crossing();
    let cancel = AtomicBool::new(false);
    let mut plans = Improving::new(&spec, &world, 1, &cancel).without_end();
    assert!(plans.next().is_some());
    std::thread::scope(|scope| {
        scope.spawn(|| {
            std::thread::sleep(std::time::Duration::from_millis(300));
            cancel.store(true, Ordering::Relaxed);
        });
        // Without an end but for the cancellation.
        while plans.next().is_some() {}
    });
    assert!(plans.next().is_none());
}

#[test]
fn a_reviewer_that_knows_most_missions_says_what_a_fresh_one_says() {
    let (spec, world) = crossing();
    let planned = dispatch(&spec, &world, 1, &|_| ());
    let mut missions = planned.missions;
    let mut reviewer = Reviewer::new(&spec, &world);
    let mut judged = |missions: &[(usize, VehicleMission)]| {
        let each: Vec<_> = missions.iter().map(|(index, own)| (*index, own)).collect();
        let found = reviewer.review(&each);
        // Values that cannot be known are NaN, which equals nothing.
        let fresh = review(&spec, &world, &each);
        assert_eq!(format!("{found:?}"), format!("{fresh:?}"));
        found.passes()
    };
    assert!(judged(&missions) && judged(&missions));
    let whole = missions.clone();
    for item in &mut missions[1].1.items {
        item.z -= if item.command == command::NAV_WAYPOINT {
            90.0
        } else {
            0.0
        };
    }
    assert!(!judged(&missions) && judged(&whole));
    missions.pop();
    assert!(!judged(&missions) && judged(&whole));
    missions.push(missions[0].clone());
    assert!(!judged(&missions) && judged(&whole));
}

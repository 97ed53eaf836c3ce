//! Fleets planned in small worlds whose answer is plain to see.

use crate::support;

use std::path::Path;

use proptest::prelude::*;
use sortie::cost::Margins;
use sortie::geodesy::{Amsl, EastNorth};
use sortie::numeric::approach::{Segment, closest_approach};
use sortie::path::Flight;
use sortie::plan::{FleetPlan, Request, plan_fleet, replan_from};
use sortie::spec::*;
use sortie::world::World;
use support::plans::{EAST, NORTH, SOUTH, WEST, plan, request};
use support::{copter, empty_spec, generated, place, threat};

/// The least height above ground along the planned points, metres.
fn min_clearance_m(world: &World, plan: &FleetPlan, vehicle: usize) -> f64 {
    plan.vehicles[vehicle]
        .routes
        .iter()
        .flat_map(|route| &route.path)
        .map(|timed| timed.point.amsl.0 - world.ground.height_m(timed.point.at))
        .fold(f64::INFINITY, f64::min)
}

fn segments(flight: &Flight) -> Vec<Segment> {
    let place = |timed: &sortie::path::TimedPoint| {
        let at = timed.point.at;
        (timed.t_s, [at.east_m, at.north_m, timed.point.amsl.0])
    };
    flight
        .points
        .windows(2)
        .map(|pair| Segment::between(place(&pair[0]), place(&pair[1])))
        .collect()
}

/// Least distance of two flights at any allowed shift of departures, metres.
fn separation_m(a: &Flight, b: &Flight, slack_s: f64) -> f64 {
    let (a, b) = (segments(a), segments(b));
    a.iter()
        .flat_map(|a| b.iter().map(move |b| (a, b)))
        .filter_map(|(a, b)| closest_approach(a, b, slack_s))
        .map(|approach| approach.value)
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn over_flat_ground_a_copter_flies_the_straight_line() {
    let spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
    let (world, plan) = plan(&spec);
    let vehicle = &plan.vehicles[0];
    assert!(vehicle.terms.is_clean(), "{:?}", vehicle.terms);
    assert!(vehicle.terms.total() >= vehicle.bound);
    assert!(vehicle.terms.length < 1.001 * vehicle.bound, "{vehicle:?}");
    assert!(vehicle.estimate >= vehicle.bound);
    assert!(vehicle.evaluations <= spec.planner.evaluations);
    let path = &vehicle.routes[0].path;
    assert_eq!(path.first().map(|p| p.point), Some(world.sites[0].start));
    assert_eq!(path.last().map(|p| p.point), Some(world.sites[0].goal));
    assert!(path.windows(2).all(|pair| pair[0].t_s <= pair[1].t_s));
}

#[test]
fn a_path_that_begins_and_ends_at_the_minimum_height_stays_there() {
    let mut spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
    spec.vehicles[0].start.altitude = Placement::Agl(spec.area.min_agl);
    spec.vehicles[0].goal.altitude = Placement::Agl(spec.area.min_agl);
    let (world, plan) = plan(&spec);
    let terms = plan.vehicles[0].terms;
    assert!(terms.is_clean(), "{terms:?}");
    assert!(terms.total() < 1.005 * plan.vehicles[0].bound, "{terms:?}");
    let highest_m = plan.vehicles[0].routes[0]
        .path
        .iter()
        .map(|timed| timed.point.amsl.0 - world.ground.height_m(timed.point.at))
        .fold(0.0, f64::max);
    assert!(highest_m < 65.0, "{highest_m}");
}

#[test]
fn a_threat_on_the_line_is_passed_clean() {
    let mut spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
    spec.threats = vec![threat("radar-1", place(36.302, -84.25), 2000.0)];
    let (world, plan) = plan(&spec);
    let vehicle = &plan.vehicles[0];
    assert!(vehicle.terms.is_clean(), "{:?}", vehicle.terms);
    let disc = world.threats[0];
    let nearest_m = vehicle.routes[0]
        .path
        .iter()
        .map(|timed| timed.point.at.distance_m(disc.center))
        .fold(f64::INFINITY, f64::min);
    assert!(nearest_m >= disc.radius_m, "{nearest_m}");
    assert!(nearest_m < 1.05 * disc.radius_m, "{nearest_m}");
    assert!(vehicle.gap().is_some_and(|gap| (0.0..0.02).contains(&gap)));
}

#[test]
fn a_no_fly_zone_is_passed_or_flown_over_whatever_is_cheaper() {
    let corners = vec![
        place(36.27, -84.27),
        place(36.27, -84.23),
        place(36.33, -84.23),
        place(36.33, -84.27),
    ];
    let zone = |below: Option<Amsl>| Zone {
        id: "town".to_owned(),
        polygon: corners.clone(),
        ceiling: below.map(sortie::spec::Placement::Amsl),
        ..Zone::default()
    };
    let mut spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
    spec.no_fly = vec![zone(None)];
    let (_, around) = plan(&spec);
    assert!(
        around.vehicles[0].terms.is_clean(),
        "{:?}",
        around.vehicles[0].terms
    );
    spec.no_fly = vec![zone(Some(Amsl(520.0)))];
    let (_, over) = plan(&spec);
    // Nothing is closed at all heights there: its bound is the straight distance.
    assert!(around.vehicles[0].terms.length > 1.02 * over.vehicles[0].bound);
    let terms = over.vehicles[0].terms;
    assert!(terms.is_clean(), "{terms:?}");
    assert!(
        terms.total() < around.vehicles[0].terms.total(),
        "{terms:?}"
    );
}

/// A goal just behind a wall of seven kilometres: straight through it is short.
const WALL: &str = "sortie: 1
name: wall
area: {south_west: {lat: -35.405, lon: 149.11}, north_east: {lat: -35.315, lon: 149.22}, min_agl_m: 40, max_amsl_m: 704}
terrain: {flat: {amsl_m: 584}}
no_fly:
  - {id: wall, polygon: [[-35.391, 149.165], [-35.391, 149.167], [-35.329, 149.167], [-35.329, 149.165]]}
vehicles:
  - {id: a, sysid: 1, autopilot: ardupilot, link: sim, finish: land, speed_mps: 10, start: {lat: -35.36, lon: 149.16, agl_m: 60}, goal: {lat: -35.36, lon: 149.172, agl_m: 60}}
";

#[test]
fn a_long_way_around_a_wall_is_not_given_up_for_a_short_one_through_it() {
    let file = SpecFile::parse(Path::new("wall.yaml"), WALL.to_owned());
    let mut spec = file.unwrap_or_else(|error| panic!("{error}")).spec;
    for evaluations in [600, 2000, 10_000] {
        for seed in 1..=3 {
            spec.planner.seed = seed;
            spec.planner.evaluations = evaluations;
            let (_, plan) = plan(&spec);
            let vehicle = &plan.vehicles[0];
            assert!(
                vehicle.terms.is_clean(),
                "{evaluations}: {:?}",
                vehicle.terms
            );
            assert!(vehicle.terms.total() < 7.6, "{:?}", vehicle.terms);
        }
    }
}

/// Detours are fitted beside the paths that a vehicle would fly alone: both count.
#[test]
fn a_vehicle_that_gives_way_with_few_evaluations_ends_within_them() {
    let mut spec = empty_spec(vec![
        copter("alpha", 1, WEST, EAST),
        copter("bravo", 2, SOUTH, NORTH),
    ]);
    for evaluations in [1, 2, 5, 20, 60, 150] {
        spec.planner.evaluations = evaluations;
        let (_, plan) = plan(&spec);
        for vehicle in &plan.vehicles {
            assert!(
                vehicle.evaluations <= 2 * evaluations,
                "{} of {evaluations}",
                vehicle.evaluations
            );
        }
    }
}

#[test]
fn a_ridge_is_crossed_at_minimum_clearance() {
    let mut spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
    // A wall of hills from edge to edge.
    let hills = (0..13)
        .map(|k| Hill {
            place: place(36.21 + 0.015 * f64::from(k), -84.25),
            height_m: 250.0,
            radius_m: 2000.0,
        })
        .collect();
    spec.terrain = TerrainSource::Analytic {
        base: Amsl(400.0),
        hills,
    };
    let (world, plan) = plan(&spec);
    let terms = plan.vehicles[0].terms;
    assert!(terms.is_clean(), "{terms:?}");
    let clearance_m = min_clearance_m(&world, &plan, 0);
    assert!(clearance_m >= 60.0, "{clearance_m}");
    assert!(clearance_m < 70.0, "{clearance_m}");
    let top = plan.vehicles[0].routes[0]
        .path
        .iter()
        .map(|timed| timed.point.amsl.0)
        .fold(0.0, f64::max);
    assert!(top > 600.0, "the ridge was not crossed: {top}");
}

#[test]
fn vehicles_that_cross_keep_apart_all_the_way() {
    let spec = empty_spec(vec![
        copter("alpha", 1, WEST, EAST),
        copter("bravo", 2, SOUTH, NORTH),
        copter("charlie", 3, EAST, WEST),
    ]);
    let mut spec = spec;
    // Not on one another's pads.
    spec.vehicles[2] = copter("charlie", 3, place(36.32, -84.18), place(36.28, -84.32));
    let (world, plan) = plan(&spec);
    for vehicle in &plan.vehicles {
        assert!(vehicle.terms.is_clean(), "{:?}", vehicle.terms);
        assert!(vehicle.terms.length < 1.02 * vehicle.bound);
    }
    let flights = plan.flights(&spec, &world);
    for (a, b) in [(0, 1), (0, 2), (1, 2)] {
        let distance_m = separation_m(&flights[a], &flights[b], spec.separation.time_slack_s);
        assert!(
            distance_m >= spec.separation.distance_m,
            "{a} and {b}: {distance_m}"
        );
    }
    assert_eq!(plan.column_conflicts(&spec, &world), []);
}

#[test]
fn who_meets_others_in_a_gate_waits_on_its_way_and_does_not_fly_around_the_wall() {
    // Three vehicles with one gate in a belt; the way around it costs the last a tenth more.
    let file = generated(25, 5);
    let world = sortie::world::load(&file).expect("the ground is analytic");
    let mut spec = file.spec;
    spec.planner.evaluations = 10_000;
    let plan = plan_fleet(&spec, &world, &request(1));
    assert!(plan.vehicles.iter().all(|of| of.terms.is_clean()));
    let costs: Vec<f64> = plan.vehicles.iter().map(|of| of.terms.total()).collect();
    assert!(costs[2] < 14.0, "{costs:?}");
}

#[test]
fn a_vehicle_that_returns_has_a_second_route_to_over_its_home() {
    let mut spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
    spec.vehicles[0].finish = Finish::Return;
    let (world, plan) = plan(&spec);
    let vehicle = &plan.vehicles[0];
    let [out, back] = vehicle.routes.as_slice() else {
        panic!("{} routes", vehicle.routes.len());
    };
    assert_eq!(out.path.last(), back.path.first());
    let end = back.path.last().expect("a path").point;
    assert_eq!(end.at, world.sites[0].home.at);
    assert_eq!(end.amsl, world.sites[0].start.amsl);
    assert!(vehicle.evaluations <= spec.planner.evaluations);
    assert!(vehicle.terms.length < 1.001 * vehicle.bound);
}

#[test]
fn a_landing_on_a_vehicle_that_loiters_there_is_told() {
    let mut spec = empty_spec(vec![
        copter("alpha", 1, WEST, EAST),
        copter("bravo", 2, SOUTH, EAST),
    ]);
    spec.vehicles[0].finish = Finish::Loiter;
    spec.vehicles[1].depart_s = 600.0;
    spec.planner.evaluations = 1000;
    let (world, plan) = plan(&spec);
    let conflicts = plan.column_conflicts(&spec, &world);
    assert_eq!(conflicts.len(), 1);
    assert_eq!((conflicts[0].vehicle, conflicts[0].other), (1, 0));
    assert!(conflicts[0].distance_m < 1.0);
}

#[test]
fn a_goal_behind_threats_ends_with_violated_terms_and_no_error() {
    let mut spec = empty_spec(vec![copter("alpha", 1, WEST, place(36.30, -84.25))]);
    spec.threats = (0..12)
        .map(|k| {
            let angle = f64::from(k) * std::f64::consts::TAU / 12.0;
            let at = place(36.30 + 0.03 * angle.sin(), -84.25 + 0.037 * angle.cos());
            threat(&format!("radar-{k}"), at, 1500.0)
        })
        .collect();
    let (_, plan) = plan(&spec);
    let vehicle = &plan.vehicles[0];
    assert!(vehicle.terms.threat > 0.0);
    assert!(vehicle.terms.total().is_finite());
    assert_eq!(vehicle.evaluations, spec.planner.evaluations);
}

#[test]
fn every_algorithm_and_objective_plans() {
    for algorithm in [
        Algorithm::Msfoa,
        Algorithm::MsfoaLiteral,
        Algorithm::MsfoaDwindle,
        Algorithm::Foa,
        Algorithm::Pso,
        Algorithm::De,
        Algorithm::Abc,
        Algorithm::Iffo,
        Algorithm::Mfoa,
    ] {
        for objective in [Objective::Operational, Objective::Paper] {
            let mut spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
            spec.planner.algorithm = algorithm;
            spec.planner.objective = objective;
            spec.planner.evaluations = 2000;
            let (_, plan) = plan(&spec);
            let vehicle = &plan.vehicles[0];
            assert_eq!(vehicle.evaluations, 2000);
            assert!(
                vehicle.terms.total() >= vehicle.bound,
                "{algorithm:?} {objective:?}"
            );
            assert!(vehicle.terms.total().is_finite());
        }
    }
}

#[test]
fn a_budget_of_nothing_still_gives_a_path() {
    let mut spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
    for (algorithm, evaluations) in [
        (Algorithm::Msfoa, 0),
        (Algorithm::Msfoa, 3),
        (Algorithm::MsfoaLiteral, 0),
    ] {
        spec.planner.algorithm = algorithm;
        spec.planner.evaluations = evaluations;
        let (_, plan) = plan(&spec);
        assert_eq!(plan.vehicles[0].evaluations, evaluations);
        assert!(plan.vehicles[0].terms.total().is_finite());
    }
}

#[test]
fn replanning_keeps_the_vehicles_before_and_repeats_those_after() {
    let mut spec = empty_spec(vec![
        copter("alpha", 1, WEST, EAST),
        copter("bravo", 2, SOUTH, NORTH),
    ]);
    spec.planner.evaluations = 1500;
    let (world, plan) = plan(&spec);
    let again = replan_from(&plan, 1, &spec, &world, &request(1));
    assert_eq!(plan, again);
    let wider = Request {
        margins: vec![
            Margins::default(),
            Margins {
                clearance_m: 25.0,
                ..Margins::default()
            },
        ],
        extra_parameters: vec![vec![], vec![0.123, 0.456]],
        ..request(1)
    };
    let higher = replan_from(&plan, 1, &spec, &world, &wider);
    assert_eq!(plan.vehicles[0], higher.vehicles[0]);
    assert!(min_clearance_m(&world, &higher, 1) >= 80.0);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    /// Nothing that is found costs less than what is proven to be least.
    #[test]
    fn no_plan_costs_less_than_its_bound(
        seed in 0_u64..1000,
        ends in prop::collection::vec((36.22..36.38_f64, -84.34..-84.16_f64), 2),
        hills in prop::collection::vec((36.22..36.38_f64, -84.34..-84.16_f64, 50.0..400.0_f64), 0..4),
    ) {
        let (start, goal) = (place(ends[0].0, ends[0].1), place(ends[1].0, ends[1].1));
        let mut spec = empty_spec(vec![copter("alpha", 1, start, goal)]);
        spec.planner.seed = seed;
        spec.planner.evaluations = 300;
        spec.terrain = TerrainSource::Analytic {
            base: Amsl(300.0),
            hills: hills.iter().map(|&(lat, lon, height_m)| Hill {
                place: place(lat, lon), height_m, radius_m: 1500.0,
            }).collect(),
        };
        let (world, plan) = plan(&spec);
        let vehicle = &plan.vehicles[0];
        let straight_km = world.sites[0].start.distance_m(world.sites[0].goal) / 1000.0;
        prop_assert!((vehicle.bound - straight_km).abs() < 1e-9);
        prop_assert!(vehicle.terms.total() >= vehicle.bound - 1e-9);
        prop_assert!(vehicle.estimate >= vehicle.bound);
        let origin = EastNorth { east_m: 0.0, north_m: 0.0 };
        prop_assert!(vehicle.routes[0].path.iter().all(|p| p.point.at.distance_m(origin) < 40_000.0));
    }
}

#[test]
fn the_fewest_and_the_most_control_points_plan() {
    for (control_points, samples) in [(2, 11), (30, 11), (30, 201)] {
        let mut spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
        spec.threats = vec![threat("radar-1", place(36.302, -84.25), 2000.0)];
        spec.planner.control_points = control_points;
        spec.planner.samples = samples;
        spec.planner.evaluations = 1000;
        let (_, plan) = plan(&spec);
        let vehicle = &plan.vehicles[0];
        let found = vehicle.routes[0].control_points.len();
        // Drawn taut a path may have more of them, as many as its bends need.
        assert!(found == control_points + 2 || found > 4, "{found}");
        assert!(vehicle.terms.total().is_finite());
        assert!(
            vehicle.terms.total() < 2.0 * vehicle.bound,
            "{:?}",
            vehicle.terms
        );
    }
}

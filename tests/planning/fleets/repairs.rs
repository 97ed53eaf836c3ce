//! Vehicles of a large fleet that are planned again: they give way to all others.

use sortie::cost::Margins;
use sortie::numeric::tracks::{Nearness, Track, Tracks};
use sortie::path::Flight;
use sortie::plan::{FleetPlan, Request, VehiclePlan, plan_fleet, replan};
use sortie::spec::{MissionSpec, Separation, Span, Vehicle};
use sortie::world::World;

use crate::support::{self, copter, empty_spec, place};

/// Copters that fly east and as many that fly north: each crosses the way of half of the others.
fn crossing_fleet(can_wait: bool) -> (MissionSpec, World) {
    let rows = 52_u8;
    let at = |row: u8| 36.225 + 0.003 * f64::from(row);
    let flight = |row: u8| {
        let lon_deg = -84.33 + 0.0033 * f64::from(row);
        let east = (place(at(row), -84.34), place(at(row), -84.15));
        let north = (place(36.22, lon_deg), place(36.385, lon_deg));
        [("east", east), ("north", north)].map(|(name, (from, to))| {
            let mut vehicle = copter(&format!("{name}-{row}"), row + 1, from, to);
            let window_s = Span {
                least: 0.0,
                most: 600.0,
            };
            vehicle.retiming.depart_s = can_wait.then_some(window_s);
            vehicle
        })
    };
    let vehicles: Vec<Vehicle> = (0..rows).flat_map(flight).collect();
    let mut spec = empty_spec(vehicles);
    spec.separation = Separation {
        distance_m: 40.0,
        vertical_m: Some(20.0),
        time_slack_s: 2.0,
    };
    spec.planner.evaluations = 100;
    let world = support::world(&spec);
    (spec, world)
}

fn again() -> Vec<usize> {
    (3..104).step_by(9).collect()
}

/// Plans those again that shall keep further apart from the others and from the ground.
fn stricter(spec: &MissionSpec, world: &World, first: &FleetPlan) -> FleetPlan {
    let mut margins = vec![Margins::default(); spec.vehicles.len()];
    for vehicle in again() {
        margins[vehicle] = Margins {
            separation_m: 25.0,
            clearance_m: 1.0,
            ..Margins::default()
        };
    }
    let request = Request {
        margins,
        ..Request::new(1)
    };
    replan(first, &again(), spec, world, &request)
}

fn is_as_before(one: &VehiclePlan, other: &VehiclePlan) -> bool {
    one.depart_s.to_bits() == other.depart_s.to_bits() && one.routes == other.routes
}

/// Those that a vehicle comes nearer to than a distance.
fn met(flights: &[Flight], vehicle: usize, distance_m: f64) -> Vec<usize> {
    let nearness = Nearness {
        distance_m,
        vertical_m: Some(20.0),
        slack_s: 2.0,
        clear_m: 0.0,
    };
    let all: Vec<Track> = flights.iter().map(Flight::track).collect();
    let own = all[vehicle].clone();
    let mut tracks = Tracks::new(&nearness);
    tracks.extend(all);
    let mut met = tracks.near(&own, &nearness, 0);
    met.retain(|&other| other != vehicle);
    met
}

#[test]
fn nobody_of_a_large_fleet_is_planned_again_but_those_that_failed() {
    let (spec, world) = crossing_fleet(true);
    let first = plan_fleet(&spec, &world, &Request::new(1));
    let plan = stricter(&spec, &world, &first);
    let pairs = plan.vehicles.iter().zip(&first.vehicles);
    let changed: Vec<usize> = (pairs.enumerate())
        .filter(|(_, (now, before))| !is_as_before(now, before))
        .map(|(vehicle, _)| vehicle)
        .collect();
    assert_eq!(changed, again());
    assert!(plan.vehicles.iter().all(|plan| plan.terms.is_clean()));
    let flights = plan.flights(&spec, &world);
    for vehicle in again() {
        let near = met(&flights, vehicle, 65.0);
        assert!(near.is_empty(), "{vehicle} is near {near:?}");
    }
}

#[test]
fn where_nobody_can_wait_those_without_a_path_among_all_others_move_those_after_them() {
    let (spec, world) = crossing_fleet(false);
    let first = plan_fleet(&spec, &world, &Request::new(1));
    let broken = |plan: &FleetPlan| {
        let plans = plan.vehicles.iter();
        plans.filter(|plan| !plan.terms.is_clean()).count()
    };
    let plan = stricter(&spec, &world, &first);
    let pairs = plan.vehicles.iter().zip(&first.vehicles);
    let moved: Vec<usize> = (pairs.enumerate())
        .filter(|(index, (now, before))| !again().contains(index) && !is_as_before(now, before))
        .map(|(index, _)| index)
        .collect();
    assert!(!moved.is_empty());
    assert!(broken(&plan) <= broken(&first), "{}", broken(&plan));
}

#[test]
fn a_line_that_is_too_low_is_raised_and_not_searched_again() {
    let (spec, world) = crossing_fleet(true);
    let first = plan_fleet(&spec, &world, &Request::new(1));
    let plan = stricter(&spec, &world, &first);
    let spent = |plan: &FleetPlan| -> usize {
        let again = again().into_iter();
        again
            .map(|vehicle| plan.vehicles[vehicle].evaluations)
            .sum()
    };
    let more = spent(&plan) - spent(&first);
    assert!(
        more > 0 && more < again().len() * spec.planner.evaluations,
        "{more}"
    );
}

#[test]
fn a_large_fleet_is_planned_again_the_same_on_one_and_two_threads() {
    let (spec, world) = crossing_fleet(true);
    let first = plan_fleet(&spec, &world, &Request::new(1));
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().expect("a pool");
        pool.install(|| stricter(&spec, &world, &first))
    };
    assert!(on(1) == on(2));
}

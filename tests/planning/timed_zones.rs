//! Zones with times: flown through while they are inactive, waited for where departures are open.

#![allow(clippy::float_cmp)]

use crate::support;

use sortie::dispatch::{Dispatched, dispatch};
use sortie::spec::*;
use support::plans::{EAST, WEST};
use support::{copter, empty_spec, place, world};

/// From the first to the last second of a zone across the whole area, or the middle of it.
fn closed(active_s: (f64, f64), is_whole: bool) -> MissionSpec {
    let (south, north) = if is_whole {
        (36.0, 36.6)
    } else {
        (36.27, 36.33)
    };
    let zone = Zone {
        id: "range".to_owned(),
        polygon: vec![
            place(south, -84.27),
            place(south, -84.23),
            place(north, -84.23),
            place(north, -84.27),
        ],
        active_s: Some(active_s),
        ..Zone::default()
    };
    let mut spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
    spec.no_fly = vec![zone];
    spec.planner.evaluations = 4000;
    spec
}

fn dispatched(spec: &MissionSpec) -> Dispatched {
    dispatch(spec, &world(spec), 1, &|_| ())
}

/// Cost of the same flight without the zone.
fn cost_without(spec: &MissionSpec) -> f64 {
    let mut open = spec.clone();
    open.no_fly.clear();
    dispatched(&open).plan.cost()
}

#[test]
fn a_zone_that_closes_after_the_flight_is_flown_through() {
    let spec = closed((36_000.0, 40_000.0), true);
    let done = dispatched(&spec);
    assert!(done.review.passes());
    assert!(done.plan.cost() < 1.001 * cost_without(&spec));
    assert_eq!(done.plan.vehicles[0].depart_s, spec.vehicles[0].depart_s);
}

#[test]
fn a_vehicle_with_a_window_waits_for_the_end_of_a_zone_that_closes_its_way() {
    let mut spec = closed((0.0, 600.0), true);
    spec.planner.evaluations = 500;
    spec.vehicles[0].retiming.depart_s = Some(Span {
        least: 0.0,
        most: 1200.0,
    });
    let done = dispatched(&spec);
    assert!(done.review.passes());
    let depart_s = done.plan.vehicles[0].depart_s;
    assert!((600.0..700.0).contains(&depart_s), "{depart_s}");
}

#[test]
fn a_vehicle_with_a_window_waits_where_the_way_around_is_longer() {
    let mut spec = closed((0.0, 600.0), false);
    let around = dispatched(&spec);
    assert!(around.review.passes());
    spec.vehicles[0].retiming.depart_s = Some(Span {
        least: 0.0,
        most: 1200.0,
    });
    let done = dispatched(&spec);
    assert!(done.review.passes());
    assert!(done.plan.cost() < 0.99 * around.plan.cost());
    assert!(done.plan.vehicles[0].depart_s > 600.0);
}

#[test]
fn a_zone_that_is_active_in_flight_is_gone_around_where_waiting_gains_nothing() {
    let mut spec = closed((0.0, 36_000.0), false);
    let around = dispatched(&spec);
    assert!(around.review.passes());
    assert!(around.plan.cost() > 1.01 * cost_without(&spec));
    // A window that ends before the zone's time leaves it so.
    spec.vehicles[0].retiming.depart_s = Some(Span {
        least: 0.0,
        most: 300.0,
    });
    let same = dispatched(&spec);
    assert_eq!(same.plan.vehicles[0].depart_s, 0.0);
    assert!((same.plan.cost() - around.plan.cost()).abs() < 1e-9);
}

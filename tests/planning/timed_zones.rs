//! Zones with times: flown through while they are inactive, waited for where departures are open.

#![allow(clippy::float_cmp)]

use crate::support;
use std::path::Path;

use super::stops::stop;
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
    // On the ground until it comes there after the zone's time.
    let depart_s = done.plan.vehicles[0].depart_s;
    assert!((200.0..600.0).contains(&depart_s), "{depart_s}");
    let (middle_s, _) = passes_at_s(&spec);
    assert!(depart_s + middle_s > 600.0, "{depart_s} {middle_s}");
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
    assert!(done.plan.vehicles[0].depart_s > 200.0);
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

/// When a vehicle is in the middle of its flight without zones, and at its end, seconds.
fn passes_at_s(spec: &MissionSpec) -> (f64, f64) {
    let mut open = spec.clone();
    open.no_fly.clear();
    let flight = dispatched(&open)
        .plan
        .flights(&open, &world(&open))
        .remove(0);
    let ends_s = flight.points.last().expect("flown").t_s;
    (ends_s / 2.0, ends_s)
}

fn with_times(spec: &MissionSpec, active_s: (f64, f64)) -> MissionSpec {
    let mut spec = spec.clone();
    spec.no_fly[0].active_s = Some(active_s);
    spec
}

#[test]
fn a_zone_that_begins_or_ends_in_flight_is_flown_through_before_or_after_it() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let mut spec = closed((0.0, 1.0), true);
        spec.vehicles[0].autopilot = autopilot;
        let (middle_s, ends_s) = passes_at_s(&spec);
        let free = cost_without(&spec);
        for active_s in [
            (middle_s + 0.3 * ends_s, 9000.0),
            (0.0, middle_s - 0.3 * ends_s),
        ] {
            let spec = with_times(&spec, active_s);
            let done = dispatched(&spec);
            assert!(done.review.passes(), "{autopilot:?} {active_s:?}");
            assert!(done.plan.cost() < 1.001 * free);
            assert_eq!(done.plan.vehicles[0].depart_s, 0.0);
            // The fence of the mission knows no times.
            assert!(done.missions[0].1.items.len() > 2);
        }
        // While it is active in the middle of the flight there is no way.
        let spec = with_times(&spec, (middle_s - 0.1 * ends_s, middle_s + 0.1 * ends_s));
        assert!(!dispatched(&spec).review.passes());
    }
}

#[test]
fn a_vehicle_departs_within_its_window_so_that_it_passes_a_zone_after_or_before_its_time() {
    let mut spec = closed((0.0, 1.0), true);
    let (middle_s, ends_s) = passes_at_s(&spec);
    let window = |least, most| Some(Span { least, most });
    // It ends too late to be waited for on the ground.
    let late_s = 0.3 * ends_s;
    spec.vehicles[0].retiming.depart_s = window(0.0, late_s + 200.0);
    let after = with_times(&spec, (0.0, middle_s + late_s));
    let done = dispatched(&after);
    assert!(done.review.passes());
    let depart_s = done.plan.vehicles[0].depart_s;
    assert!(
        (late_s - 100.0..late_s + 200.0).contains(&depart_s),
        "{depart_s}"
    );
    // It begins too early for the specified departure.
    spec.vehicles[0].depart_s = 600.0;
    spec.vehicles[0].retiming.depart_s = window(0.0, 600.0);
    let before = with_times(&spec, (middle_s + 300.0, 9000.0));
    let done = dispatched(&before);
    assert!(done.review.passes());
    let depart_s = done.plan.vehicles[0].depart_s;
    assert!((0.0..300.0).contains(&depart_s), "{depart_s}");
}

#[test]
fn each_vehicle_of_a_fleet_has_the_zones_of_its_own_time() {
    let mut spec = closed((0.0, 1.0), false);
    let (middle_s, ends_s) = passes_at_s(&spec);
    let free = cost_without(&spec);
    let mut later = spec.vehicles[0].clone();
    later.id = "bravo".to_owned();
    later.sysid = 2;
    later.depart_s = ends_s;
    later.retiming = Retiming::default();
    spec.vehicles.push(later);
    let spec = with_times(&spec, (middle_s + 0.3 * ends_s, 9000.0));
    let done = dispatched(&spec);
    assert!(done.review.passes());
    let [alpha, bravo] = [0, 1].map(|index| done.plan.vehicles[index].terms.total());
    assert!(alpha < 1.001 * free, "{alpha} {free}");
    assert!(bravo > 1.01 * free, "{bravo} {free}");
}

#[test]
fn what_is_flown_through_an_inactive_zone_is_no_dearer_than_the_way_around_it() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("missions/airspace.yaml");
    let text = std::fs::read_to_string(&path).expect("a spec");
    let file = SpecFile::parse(&path, text).unwrap_or_else(|error| panic!("{error}"));
    let around = {
        let mut spec = file.spec.clone();
        for zone in &mut spec.no_fly {
            zone.active_s = None;
        }
        spec
    };
    let [through, around] = [&file.spec, &around].map(|spec| {
        let mut file = file.clone();
        file.spec = spec.clone();
        let world = sortie::world::load(&file).unwrap_or_else(|error| panic!("{error}"));
        let done = dispatch(spec, &world, 1, &|_| ());
        assert!(done.review.passes());
        done.plan.cost()
    });
    assert!(through <= around, "{through} {around}");
}

/// A zone around a place near the start, active until a time, and a place farther on: what is near is
/// the first thing to be done otherwise.
fn near_and_far(autopilot: Autopilot, until_s: f64) -> (MissionSpec, [Stop; 2]) {
    let mut spec = closed((0.0, until_s), true);
    spec.no_fly[0].polygon = vec![
        place(36.28, -84.305),
        place(36.28, -84.295),
        place(36.32, -84.295),
        place(36.32, -84.305),
    ];
    spec.planner.evaluations = 1000;
    spec.vehicles[0].autopilot = autopilot;
    let stops = [("near", -84.30), ("far", -84.25)];
    (
        spec,
        stops.map(|(id, lon_deg)| stop(id, place(36.301, lon_deg), 3.0)),
    )
}

#[test]
fn a_free_order_comes_to_a_stop_in_a_zone_after_its_time() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let order = |until_s: f64| {
            let (mut spec, stops) = near_and_far(autopilot, until_s);
            (spec.vehicles[0].stops, spec.vehicles[0].order) = (stops.to_vec(), Order::Free);
            let done = dispatched(&spec);
            (done.review.passes(), done.plan.vehicles[0].order.clone())
        };
        // The zone is no longer active as the vehicle departs.
        assert_eq!(order(-1.0), (true, vec![0, 1]));
        assert_eq!(order(600.0), (true, vec![1, 0]));
        // With PX4 it takes as long to find that out.
        assert!(autopilot == Autopilot::Px4 || !order(9000.0).0);
    }
}

#[test]
fn tasks_in_a_zone_are_done_after_its_time_or_named_with_it() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let assigned = |until_s: f64| {
            let (mut spec, stops) = near_and_far(autopilot, until_s);
            let tasks = stops.into_iter().map(|stop| Task {
                id: stop.id.clone(),
                stops: vec![stop],
                sweep: None,
            });
            spec.tasks = tasks.collect();
            let done = dispatched(&spec);
            let tasks = done.tasks.as_ref().expect("tasks");
            let ids: Vec<String> = tasks.done[0].iter().map(|task| task.id.clone()).collect();
            let left: Vec<String> = tasks.left.iter().map(|task| task.why.clone()).collect();
            (done.review.passes(), ids.join(" "), left.join(" "))
        };
        let all = |ids: &str| (true, ids.to_owned(), String::new());
        assert_eq!(assigned(-1.0), all("near far"));
        assert_eq!(assigned(600.0), all("far near"));
        if autopilot == Autopilot::Px4 {
            continue;
        }
        let (passes, done, why) = assigned(9000.0);
        assert_eq!((passes, done.as_str()), (false, "far"));
        assert!(
            why.contains("zone range is closed from T0 +0 s to T0 +9000 s"),
            "{why}"
        );
        assert!(why.contains("`depart_window_s`"), "{why}");
    }
}

//! Tasks of a fleet: assigned, flown as stops, and found again in the encoded items.

use crate::support;

use sortie::dispatch::{Dispatched, dispatch};
use sortie::geodesy::LatLon;
use sortie::mission::{Item, VehicleMission, command};
use sortie::spec::*;
use sortie::verify::{Limit, Review, review};
use sortie::world::World;
use support::plans::{EAST, NORTH, SOUTH, WEST};
use support::{copter, empty_spec, world};

use super::stops::stop;

fn at(lat_deg: f64, lon_deg: f64) -> LatLon {
    LatLon { lat_deg, lon_deg }
}

fn task(id: &str, places: &[LatLon]) -> Task {
    let release = |place: usize| StopAction::Gripper { grabs: place == 0 };
    let stops = places.iter().enumerate().map(|(index, place)| Stop {
        actions: vec![release(index)],
        ..stop(&format!("{id}.{index}"), *place, 4.0)
    });
    Task {
        id: id.to_owned(),
        stops: stops.collect(),
        sweep: None,
    }
}

/// Two copters in the west and in the east, two deliveries from one place, and a visit.
fn shared(autopilot: Autopilot) -> MissionSpec {
    let ends = [
        ("west", WEST, at(36.302, -84.32)),
        ("east", EAST, at(36.302, -84.18)),
    ];
    let vehicles = ends.into_iter().zip(1..).map(|((id, start, goal), sysid)| {
        let mut vehicle = copter(id, sysid, start, goal);
        (vehicle.autopilot, vehicle.speed_mps) = (autopilot, 10.0);
        vehicle
    });
    let mut spec = empty_spec(vehicles.collect());
    spec.planner.evaluations = 4000;
    let depot = at(36.31, -84.29);
    spec.tasks = vec![
        task("visit", &[at(36.31, -84.19)]),
        task("first", &[depot, at(36.32, -84.28)]),
        task("second", &[depot, at(36.29, -84.28)]),
    ];
    spec
}

fn dispatched(spec: &MissionSpec) -> (World, Dispatched) {
    let world = world(spec);
    let done = dispatch(spec, &world, 1, &|_| ());
    (world, done)
}

fn failed(review: &Review) -> Vec<String> {
    let failed = review.margins.iter().filter(|margin| !margin.ok);
    failed
        .map(|margin| format!("{}: {}: {}", margin.vehicle, margin.limit, margin.note))
        .collect()
}

/// The verdict on the missions of a plan without what the plan knows.
fn judged_again(spec: &MissionSpec, world: &World, done: &Dispatched) -> Review {
    let missions = done.missions.iter();
    let missions: Vec<_> = missions.map(|(index, one)| (*index, one)).collect();
    review(spec, world, &missions)
}

fn ids(done: &Dispatched, vehicle: usize) -> Vec<&str> {
    let tasks = done.tasks.as_ref().expect("tasks");
    let of_vehicle = tasks.done[vehicle].iter();
    of_vehicle.map(|task| task.id.as_str()).collect()
}

#[test]
fn each_vehicle_does_the_tasks_on_its_side_and_loads_of_one_place_at_once() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let spec = shared(autopilot);
        let (world, done) = dispatched(&spec);
        assert!(done.review.passes(), "{:?}", failed(&done.review));
        assert_eq!(ids(&done, 1), ["visit"]);
        let mut west = ids(&done, 0);
        west.sort_unstable();
        assert_eq!(west, ["first", "second"]);
        let (planned_spec, _) = done.planned_spec(&spec, &world);
        let stops = &planned_spec.vehicles[0].stops;
        assert_eq!(stops.len(), 3);
        assert_eq!((stops[0].actions.len(), stops[0].hold_s.round()), (2, 8.0));
        // The verdict finds both tasks in the items alone, and who does them.
        for (id, vehicle) in [("visit", "east"), ("first", "west"), ("second", "west")] {
            let limit = Limit::Task(id.to_owned());
            let margin = done.review.margins.iter().find(|one| one.limit == limit);
            assert_eq!(margin.expect("judged").vehicle, vehicle);
        }
    }
}

#[test]
fn a_task_left_out_cut_short_or_without_its_actions_fails() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let spec = shared(autopilot);
        let (world, done) = dispatched(&spec);
        let judged = |change: &dyn Fn(&mut VehicleMission)| {
            let mut changed: Vec<(usize, VehicleMission)> = done.missions.clone();
            change(&mut changed[0].1);
            let missions: Vec<_> = changed.iter().map(|(index, one)| (*index, one)).collect();
            failed(&review(&spec, &world, &missions))
        };
        assert_eq!(judged(&|_| ()), Vec::<String>::new());
        let is_hold = |item: &&mut sortie::mission::Item| {
            item.command == command::NAV_WAYPOINT && item.params[0] > 1.0
        };
        let passed = judged(&|mission| {
            let last = mission.items.iter_mut().rfind(is_hold);
            last.expect("a drop").params[0] = 1.0;
        });
        assert!(
            passed.iter().any(|what| what.contains("stop")),
            "cut short: {passed:?}"
        );
        let elsewhere = judged(&|mission| {
            let items = mission.items.iter_mut();
            for item in items.filter(|item| item.command == command::NAV_WAYPOINT) {
                item.x += i32::from(item.params[0] > 0.5) * 5000;
            }
        });
        let left = elsewhere
            .iter()
            .filter(|what| what.contains("no vehicle does it"));
        assert_eq!(left.count(), 2, "{elsewhere:?}");
        let full_handed = judged(&|mission| {
            let released = |item: &sortie::mission::Item| {
                item.command == command::DO_GRIPPER && item.params[1].abs() < 0.5
            };
            mission.items.retain(|item| !released(item));
        });
        assert!(
            full_handed
                .iter()
                .any(|what| what.contains("actions at stop")),
            "{full_handed:?}"
        );
    }
}

#[test]
fn a_task_beyond_the_endurance_of_all_is_left_with_the_reason_and_the_plan_fails() {
    let mut spec = shared(Autopilot::ArduPilot);
    for vehicle in &mut spec.vehicles {
        vehicle.endurance = Some(Endurance {
            capacity: Capacity::Time(2000.0),
            reserve: 0.2,
        });
    }
    spec.tasks.push(task("far", &[SOUTH]));
    let (_, done) = dispatched(&spec);
    let tasks = done.tasks.as_ref().expect("tasks");
    let left: Vec<&str> = tasks.left.iter().map(|task| task.id.as_str()).collect();
    assert_eq!(left, ["far"]);
    assert!(tasks.left[0].why.contains("of 1600 s"), "{:?}", tasks.left);
    let failed = failed(&done.review);
    assert_eq!(failed.len(), 1, "{failed:?}");
    assert!(
        failed[0].contains("task far: no vehicle does it: out of reach"),
        "{failed:?}"
    );
    // Its own stops stay with a vehicle, between its tasks.
    spec.tasks.pop();
    spec.vehicles[1].stops = vec![stop("own", NORTH, 0.0)];
    for vehicle in &mut spec.vehicles {
        vehicle.endurance = None;
    }
    let (world, done) = dispatched(&spec);
    assert!(done.review.passes(), "{:?}", done.review.passes());
    let (planned_spec, _) = done.planned_spec(&spec, &world);
    assert!(
        planned_spec.vehicles[1]
            .stops
            .iter()
            .any(|stop| stop.id == "own")
    );
}

#[test]
fn a_task_that_is_too_near_another_for_a_leg_is_left_for_that_reason() {
    let mut spec = shared(Autopilot::ArduPilot);
    spec.vehicles.truncate(1);
    spec.planner.evaluations = 500;
    // 6.7 m apart.
    spec.tasks = vec![
        task("b", &[at(36.31, -84.29)]),
        task("c", &[at(36.310_06, -84.29)]),
    ];
    let (_, done) = dispatched(&spec);
    let left = &done.tasks.as_ref().expect("tasks").left;
    assert_eq!(left.len(), 1);
    assert!(left[0].why.contains("less than 10 m from it"), "{left:?}");
}

#[test]
fn a_vehicle_waits_for_a_window_and_the_verdict_holds_the_begin_against_it() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let mut spec = shared(autopilot);
        let window = |least: f64, most: f64| Some(Span { least, most });
        // PX4 may be later by the 12 s that it dwells behind its climb.
        let end_s = if autopilot == Autopilot::Px4 {
            350.0
        } else {
            330.0
        };
        spec.tasks[0].stops[0].window_s = window(300.0, end_s);
        let (world, done) = dispatched(&spec);
        assert!(done.review.passes(), "{:?}", failed(&done.review));
        let (planned_spec, _) = done.planned_spec(&spec, &world);
        let stop = &planned_spec.vehicles[1].stops[0];
        assert!(stop.wait_s > 60.0, "{}", stop.wait_s);
        let missions: Vec<_> = done
            .missions
            .iter()
            .map(|(index, one)| (*index, one))
            .collect();
        // The same flight comes too early and too late for other windows.
        for (from, to) in [(340.0, 400.0), (0.0, 290.0)] {
            let mut other = spec.clone();
            other.tasks[0].stops[0].window_s = window(from, to);
            let failed = failed(&review(&other, &world, &missions));
            assert_eq!(failed.len(), 1, "{failed:?}");
            assert!(failed[0].contains("window of task visit"), "{failed:?}");
        }
        // Nobody can be there so early.
        spec.tasks[0].stops[0].window_s = window(0.0, 10.0);
        let (_, done) = dispatched(&spec);
        let left = &done.tasks.as_ref().expect("tasks").left;
        assert_eq!(left.len(), 1);
        assert!(left[0].why.contains("window"), "{left:?}");
        assert!(!done.review.passes());
    }
}

#[test]
fn what_is_done_behind_a_long_hold_begins_after_it() {
    let mut spec = shared(Autopilot::ArduPilot);
    spec.tasks[0].stops[0].window_s = Some(Span {
        least: 60.0,
        most: 400.0,
    });
    spec.tasks[0].stops[0].actions = vec![StopAction::Gripper { grabs: false }];
    let (world, done) = dispatched(&spec);
    assert!(done.review.passes(), "{:?}", failed(&done.review));
    for number in [command::NAV_LOITER_TIME, command::NAV_DELAY] {
        let mut missions = done.missions.clone();
        let items = &mut missions[1].1.items;
        let load = items
            .iter()
            .position(|item| item.command == command::DO_GRIPPER);
        let load = load.expect("encoded");
        let here = items[..load]
            .iter()
            .rfind(|item| item.command == command::NAV_WAYPOINT);
        let here = *here.expect("a waypoint");
        let hold = match number {
            command::NAV_DELAY => Item {
                command: number,
                params: [600.0, -1.0, -1.0, -1.0],
                ..items[load]
            },
            _ => Item {
                command: number,
                params: [600.0, 0.0, 0.0, 0.0],
                ..here
            },
        };
        items.insert(load, hold);
        let missions: Vec<_> = missions.iter().map(|(index, one)| (*index, one)).collect();
        let failed = failed(&review(&spec, &world, &missions));
        let window = |note: &String| note.contains("window of task visit");
        assert!(failed.iter().any(window), "{number}: {failed:?}");
    }
}

#[test]
fn a_window_in_which_a_late_or_early_vehicle_does_not_begin_fails() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let mut spec = shared(autopilot);
        let window = |least: f64, most: f64| Some(Span { least, most });
        spec.tasks[0].stops[0].window_s = window(300.0, 400.0);
        let (world, done) = dispatched(&spec);
        assert!(done.review.passes(), "{:?}", failed(&done.review));
        let mut margins = done.review.margins.iter();
        let begin = margins.find(|margin| matches!(margin.limit, Limit::TaskWindow(_)));
        let begins_s = begin.and_then(|of| of.at).expect("a begin").t_s;
        // A takeoff and a stop make it late.
        for (from_s, to_s, holds) in [
            (300.0, begins_s + 2.0, false),
            (300.0, begins_s + 12.0 + 3.0, false),
            (begins_s + 1.0, 500.0, false),
            (begins_s - 1.0, 500.0, true),
            (300.0, begins_s + 40.0, true),
        ] {
            let mut other = spec.clone();
            other.tasks[0].stops[0].window_s = window(from_s, to_s);
            let failed = failed(&judged_again(&other, &world, &done));
            assert_eq!(failed.is_empty(), holds, "{from_s} {to_s}: {failed:?}");
        }
    }
}

#[test]
fn a_window_shorter_than_a_vehicle_may_be_late_is_the_reason_that_is_named() {
    let mut spec = shared(Autopilot::ArduPilot);
    spec.tasks.truncate(1);
    spec.tasks[0].stops[0].window_s = Some(Span {
        least: 300.0,
        most: 302.0,
    });
    let (_, done) = dispatched(&spec);
    let left = &done.tasks.as_ref().expect("tasks").left;
    assert_eq!(left.len(), 1);
    let why = &left[0].why;
    assert!(
        why.starts_with("its window of 2.0 s is shorter than the lateness of ")
            && why.ends_with(" s that east may have there"),
        "{why}"
    );
    let failed = failed(&done.review);
    assert!(failed.iter().any(|of| of.contains(why)), "{failed:?}");
}

#[test]
fn the_deliveries_mission_does_all_tasks_in_their_windows() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("missions/deliveries.yaml");
    let file = SpecFile::read(&path).expect("a good spec");
    let world = sortie::world::load(&file).expect("good over the ground");
    let done = dispatch(&file.spec, &world, 1, &|_| ());
    assert!(done.review.passes(), "{:?}", failed(&done.review));
    let tasks = done.tasks.as_ref().expect("tasks");
    assert_eq!(tasks.done.iter().map(Vec::len).sum::<usize>(), 20);
    let windows = done.review.margins.iter();
    let windows = windows.filter(|margin| matches!(margin.limit, Limit::TaskWindow(_)));
    assert_eq!(windows.count(), 6);
}

#[test]
fn drops_of_two_depths_at_one_place_are_made_by_two_vehicles_and_never_by_one_in_a_row() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let mut spec = shared(autopilot);
        let low = |id: &str, drop_m: f64| {
            let mut task = task(id, &[at(36.31, -84.25)]);
            task.stops[0].drop_m = drop_m;
            task
        };
        spec.tasks = vec![low("yard", 74.0), low("roof", 66.0)];
        let (world, done) = dispatched(&spec);
        assert!(done.review.passes(), "{:?}", failed(&done.review));
        assert_eq!(ids(&done, 0).len() + ids(&done, 1).len(), 2);
        assert!(judged_again(&spec, &world, &done).passes());
        // Alone a vehicle makes one of them, and the other is said to be left.
        spec.vehicles.truncate(1);
        let (_, alone) = dispatched(&spec);
        let left = &alone.tasks.as_ref().expect("tasks").left;
        assert_eq!((ids(&alone, 0).len(), left.len()), (1, 1), "{left:?}");
        let why = failed(&alone.review);
        assert!(why.len() == 1 && why[0].contains("no vehicle"), "{why:?}");
    }
}

#[test]
fn loads_of_nearly_one_place_are_taken_at_once() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let mut spec = shared(autopilot);
        // 0.8 m to the north of the other.
        let depot = spec.tasks[1].stops[0].end.place;
        let near = at(depot.lat_deg + 0.8 / 111_200.0, depot.lon_deg);
        spec.tasks[2].stops[0].end.place = near;
        let (world, done) = dispatched(&spec);
        assert!(done.review.passes(), "{:?}", failed(&done.review));
        assert_eq!(ids(&done, 0), ["first", "second"]);
        let stops = &done.planned_spec(&spec, &world).0.vehicles[0].stops;
        assert_eq!(stops.len(), 3, "{stops:?}");
        assert!(judged_again(&spec, &world, &done).passes());
    }
}

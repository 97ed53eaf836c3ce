//! Departures and speeds that a spec leaves open: how they are judged, and that the choice
//! depends on nothing but the fleet.

use std::fs;

use sortie::cost::Margins;
use sortie::dispatch::dispatch;
use sortie::mission::{Item, VehicleMission, command};
use sortie::path::Flight;
use sortie::plan::{self, Request};
use sortie::spec::{MissionSpec, Retiming, Span, SpecFile};
use sortie::verify::{self, Review};
use sortie::world::{self, World};

use super::conflicts::{folder, read};
use crate::support::command::{sortie, text};

fn planned(name: &str) -> (MissionSpec, World, Vec<(usize, VehicleMission)>) {
    let file = read(name);
    let world = world::load(&file).unwrap_or_else(|error| panic!("{error}"));
    let dispatched = dispatch(&file.spec, &world, 1, &|_| ());
    assert!(dispatched.review.passes());
    (file.spec, world, dispatched.missions)
}

/// The verdict with the items of the second mission changed.
fn judged(
    (spec, world, missions): &(MissionSpec, World, Vec<(usize, VehicleMission)>),
    change: impl Fn(&mut VehicleMission),
) -> Review {
    let mut missions = missions.clone();
    change(&mut missions[1].1);
    let missions: Vec<(usize, &VehicleMission)> = missions.iter().map(|(i, m)| (*i, m)).collect();
    verify::review(spec, world, &missions)
}

fn broken(review: &Review) -> Vec<String> {
    let failed = review.margins.iter().filter(|margin| !margin.ok);
    let mut what: Vec<String> = failed.map(|margin| margin.limit.to_string()).collect();
    what.dedup();
    what
}

fn set(command: u16, parameter: usize, value: f32) -> impl Fn(&mut VehicleMission) {
    move |mission| {
        let mut items = mission.items.iter_mut();
        let item = items.find(|item| item.command == command).expect("an item");
        item.params[parameter] = value;
    }
}

#[test]
fn what_the_mission_holds_is_judged_by_window_and_range() {
    let fleet = planned("shared-goal");
    let late = &fleet.0.vehicles[1];
    assert_eq!((late.departures().most, late.speeds().least), (35.0, 8.0));
    let delay = |delay_s| set(command::NAV_DELAY, 0, delay_s);
    let speed = |speed_mps| set(command::DO_CHANGE_SPEED, 1, speed_mps);
    assert!(judged(&fleet, |_| ()).passes());
    // Apart, but later than allowed: nobody asked for that.
    assert_eq!(broken(&judged(&fleet, delay(36.0))), ["departure"]);
    assert_eq!(broken(&judged(&fleet, delay(500.0))), ["departure"]);
    assert_eq!(broken(&judged(&fleet, speed(5.5))), ["speed"]);
    assert!(broken(&judged(&fleet, speed(12.5))).contains(&"speed".to_owned()));
    // Within both, and too near: what was wanted is no excuse.
    let wanted = judged(&fleet, |mission| {
        delay(20.0)(mission);
        speed(10.0)(mission);
    });
    // It would land within half a minute of the other at the same place, too.
    assert_eq!(broken(&wanted), ["separation", "landing place"]);
    // Without the item its parameter counts, and without that the speed is the vehicle's own.
    let is_speed = |item: &Item| item.command == command::DO_CHANGE_SPEED;
    let by_parameter = |cm_per_s: f32| {
        judged(&fleet, |mission| {
            mission.items.retain(|item| !is_speed(item));
            mission.params[0].value = cm_per_s;
        })
    };
    assert_eq!(fleet.2[1].1.params[0].name, "WPNAV_SPEED");
    assert!(by_parameter(fleet.2[1].1.params[0].value).passes());
    assert_eq!(broken(&by_parameter(550.0)), ["speed"]);
    let unknown = judged(&fleet, |mission| {
        mission.items.retain(|item| !is_speed(item));
        (mission.params).retain(|param| param.name == "DISARM_DELAY");
    });
    assert!(broken(&unknown).contains(&"speed".to_owned()));
    // The same files without retiming are not what the spec says.
    let mut strict = fleet;
    strict.0.vehicles[1].retiming = Retiming::default();
    let review = judged(&strict, |_| ());
    assert_eq!(broken(&review), ["departure", "speed"]);
}

#[test]
fn a_mission_without_its_delay_leaves_at_once() {
    let mut fleet = planned("corridor");
    let waits_s = fleet.2[1].1.items[0].params[0];
    assert!(waits_s > 30.0, "{waits_s} s");
    let without = |mission: &mut VehicleMission| {
        let delays = |item: &Item| item.command == command::NAV_DELAY;
        mission.items.retain(|item| !delays(item));
    };
    // Departure 0 is in the window; the vehicles then meet.
    let review = judged(&fleet, without);
    assert_eq!(broken(&review), ["separation"]);
    fleet.0.vehicles[1].retiming.depart_s = Some(Span {
        least: 30.0,
        most: 300.0,
    });
    let review = judged(&fleet, without);
    assert!(
        broken(&review).contains(&"departure".to_owned()),
        "{review:?}"
    );
}

#[test]
fn files_outside_the_window_are_not_accepted() {
    let place = tempfile::tempdir().expect("a folder");
    let spec = folder().join("shared-goal.yaml");
    let spec = spec.to_str().expect("a path");
    let run = |arguments: &[&str], code: i32| {
        let output = sortie(place.path(), arguments);
        let said = text(&output.stdout) + &text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
        said
    };
    let said = run(&["plan", spec, "--out", "out"], 0);
    let plan = fs::read_to_string(place.path().join("out/plan.json")).expect("a plan");
    let plan: serde_json::Value = serde_json::from_str(&plan).expect("JSON");
    let (early, late) = (&plan["vehicles"][0], &plan["vehicles"][1]);
    assert_eq!(early["gives_way_to"], serde_json::Value::Null);
    assert_eq!(late["gives_way_to"][0], "early");
    let depart_s = late["depart_s"].as_f64().expect("a time");
    assert!(
        (20.0..=35.0).contains(&depart_s) && depart_s > 20.0,
        "{depart_s}"
    );
    let note = format!("note: late: takes off at {depart_s} s");
    assert!(said.contains(&note), "{note} in {said}");
    assert!(late["speed_mps"].as_f64().is_some_and(|speed| speed < 10.0));
    let params = fs::read_to_string(place.path().join("out/late.params")).expect("parameters");
    let speed = late["speed_mps"].as_f64().expect("a speed");
    let line = format!("WPNAV_SPEED,{}", speed * 100.0);
    assert!(params.contains(&line), "{line} in {params}");
    run(&["upload", "out", "--dry-run"], 0);
    run(
        &["review", spec, "out/early.waypoints", "out/late.waypoints"],
        0,
    );

    let waypoints = place.path().join("out/late.waypoints");
    let good = fs::read_to_string(&waypoints).expect("a mission");
    let later = good.replace(&format!("\t93\t{depart_s}\t"), "\t93\t45\t");
    assert!(later != good, "{good}");
    fs::write(&waypoints, later).expect("written");
    let said = run(
        &["review", spec, "out/early.waypoints", "out/late.waypoints"],
        4,
    );
    assert!(said.contains("departure"), "{said}");
    let said = run(&["upload", "out", "--dry-run"], 4);
    assert!(said.contains("disagree"), "{said}");
}

/// Twelve vehicles that cross each other's ways, all of which may wait, some also fly slower.
fn crowd() -> (MissionSpec, World) {
    let file = read("crossing");
    let world = world::load(&file).expect("a world");
    let mut spec = file.spec;
    spec.planner.evaluations = 300;
    let pair = spec.vehicles.clone();
    spec.vehicles.clear();
    for number in 0..12_u8 {
        let mut vehicle = pair[usize::from(number % 2)].clone();
        vehicle.id = format!("v{number}");
        vehicle.sysid = number + 1;
        let aside_deg = 0.001 * f64::from(number / 2) - 0.003;
        for place in [
            &mut vehicle.home,
            &mut vehicle.start.place,
            &mut vehicle.goal.place,
        ] {
            if number % 2 == 0 {
                place.lat_deg += aside_deg;
            } else {
                place.lon_deg += aside_deg;
            }
        }
        vehicle.retiming = Retiming {
            depart_s: Some(Span {
                least: 0.0,
                most: 90.0,
            }),
            speed_mps: (number % 3 == 0).then_some(Span {
                least: 8.0,
                most: 12.0,
            }),
        };
        spec.vehicles.push(vehicle);
    }
    let world = World::new(&spec, world.terrain).expect("ground");
    (spec, world)
}

#[test]
fn what_is_chosen_is_the_same_however_many_are_planned_at_once() {
    let (spec, world) = crowd();
    let margins = Margins {
        separation_m: 10.0,
        ..Margins::default()
    };
    let request = Request {
        margins: vec![margins; spec.vehicles.len()],
        ..Request::new(1)
    };
    let one = plan::plan_one_at_a_time(&spec, &world, &request);
    let many = plan::plan_fleet(&spec, &world, &request);
    assert_eq!(one, many);
    let waits = |index: usize| one.vehicles[index].depart_s > 0.0;
    let waiting = (0..12).filter(|index| waits(*index)).count();
    assert!(waiting >= 3, "{waiting} wait");
    for (plan, vehicle) in one.vehicles.iter().zip(&spec.vehicles) {
        assert!(vehicle.departures().miss(plan.depart_s) <= 0.0);
        assert!(vehicle.speeds().miss(plan.speed_mps) <= 0.0);
        assert!(plan.terms.is_clean(), "{}: {:?}", vehicle.id, plan.terms);
    }
    let dispatched = dispatch(&spec, &world, 1, &|_| ());
    assert!(
        dispatched.review.passes(),
        "{:?}",
        broken(&dispatched.review)
    );
}

/// Two that exchange their places.
const EXCHANGE: &str = "sortie: 2
name: exchange
area: {south_west: {lat: 39.995, lon: -100.007}, north_east: {lat: 40.005, lon: -99.993}, min_agl_m: 40, max_amsl_m: 640}
terrain: {flat: {amsl_m: 500}}
separation: {distance_m: 30, time_slack_s: 3}
vehicles:
  - {id: east, sysid: 1, autopilot: ardupilot, link: sim, finish: land, speed_mps: 5, depart_window_s: {from: 0, to: 600},
     start: {lat: 40.0, lon: -100.004, agl_m: 60}, goal: {lat: 40.0, lon: -99.996, agl_m: 60}}
  - {id: west, sysid: 2, autopilot: ardupilot, link: sim, finish: land, speed_mps: 5, depart_window_s: {from: 0, to: 600},
     start: {lat: 40.0, lon: -99.996, agl_m: 60}, goal: {lat: 40.0, lon: -100.004, agl_m: 60}}
planner: {evaluations: 2000}
";

#[test]
fn who_may_wait_does_not_wait_where_another_lands() {
    let path = std::path::Path::new("exchange.yaml");
    let file = SpecFile::parse(path, EXCHANGE.to_owned()).expect("a spec");
    let world = world::load(&file).expect("a world");
    let plan = plan::plan_fleet(&file.spec, &world, &Request::new(1));
    let [first, second] = plan.flights(&file.spec, &world).try_into().expect("two");
    let landing_s = |flight: &Flight| flight.points.last().expect("a flight").t_s;
    let (east, west) = (&plan.vehicles[0], &plan.vehicles[1]);
    assert!(west.depart_s < landing_s(&first), "{}", west.depart_s);
    assert!(east.depart_s < landing_s(&second), "{}", east.depart_s);
    assert!(west.terms.is_clean());
}

//! Stops and tasks are said to be done when they were seen done, and only then.

use std::path::Path;

use crate::support::sky::{Planned, Sky, US, plan_spec};

use serde_json::Value;
use sortie::flight::{
    Fix, Outcome, ReferenceTrajectory, ServiceState, flight_json, flight_page, judge,
};
use sortie::link::{Command, FlightMessage, Message};
use sortie::mission::command;
use sortie::spec::SpecFile;

const FLEET: &str = "
sortie: 2
name: served
area: {south_west: {lat: 36.27, lon: -84.31}, north_east: {lat: 36.34, lon: -84.19}, min_agl_m: 30, max_amsl_m: 900}
terrain: {flat: {amsl_m: 400}}
vehicles:
  - {id: alpha, sysid: 1, autopilot: ardupilot, link: sim, speed_mps: 9, finish: land,
     start: {lat: 36.2900, lon: -84.2800, agl_m: 60}, goal: {lat: 36.2900, lon: -84.2630, agl_m: 60}, ALPHA}
  - {id: bravo, sysid: 2, autopilot: px4, link: sim, speed_mps: 9, finish: land,
     start: {lat: 36.3000, lon: -84.2800, agl_m: 60}, goal: {lat: 36.3000, lon: -84.2630, agl_m: 60}, BRAVO}
separation: {distance_m: 50, time_slack_s: 5}
planner: {seed: 1, evaluations: 2000, control_points: 4}
";

const STOPS: &str = "
  stops: [{id: s1, lat: LAT, lon: -84.2760, agl_m: 60, hold_s: 4},
          {id: s2, lat: LAT, lon: -84.2720, agl_m: 60, hold_s: 4, actions: [{photo: {}}]},
          {id: s3, lat: LAT, lon: -84.2680, agl_m: 60, hold_s: 4}]
";

const TASKS: &str = "
tasks:
  - {id: look, visit: {lat: 36.2930, lon: -84.2760, agl_m: 60, hold_s: 3, actions: [{photo: {}}]}}
  - {id: dip, visit: {lat: 36.3060, lon: -84.2680, agl_m: 6}}
  - {id: yard, visit: {lat: 36.2910, lon: -84.2700, agl_m: 60, actions: [{payload_place: {max_descent_m: 80}}]}}
  - id: parcel
    deliver:
      from: {lat: 36.3020, lon: -84.2760, agl_m: 60, hold_s: 4, actions: [{gripper: grab}]}
      to: {lat: 36.3030, lon: -84.2700, agl_m: 60, hold_s: 4, actions: [{gripper: release}]}
  - id: field
    survey:
      polygon: [[36.2960, -84.2760], [36.2960, -84.2740], [36.2945, -84.2740], [36.2945, -84.2760]]
      camera: {fov_deg: [60, 45]}
      front_overlap: 0.5
      side_overlap: 0.3
      agl_m: 60
  - id: road
    corridor: {line: [[36.3060, -84.2760], [36.3065, -84.2720]], width_m: 20, agl_m: 60}
  - id: lost
    search: {pattern: expanding_square, at: {lat: 36.2880, lon: -84.2660, agl_m: 60}, leg_m: 60, legs: 4}
";

/// The fleet with stops of both vehicles, and these tasks.
fn planned(tasks: &str) -> Planned {
    let stops = |lat: &str| STOPS.trim().replace("LAT", lat).replace('\n', " ");
    let text = FLEET
        .replace("ALPHA", &stops("36.2900"))
        .replace("BRAVO", &stops("36.3000"));
    let file = SpecFile::parse(Path::new("served.yaml"), text + tasks).expect("good");
    plan_spec(file.spec)
}

/// The document of a flight, its verdict aside.
fn document(plan: &Planned, sky: &Sky<'_>) -> Value {
    let record = plan.record(sky);
    let document = flight_json(&record, &plan.judge(sky));
    serde_json::to_value(document).expect("JSON")
}

/// The rows of the table of stops and tasks on the page of a flight.
fn page_rows(plan: &Planned, sky: &Sky<'_>) -> Vec<String> {
    let missions = plan.dispatched.missions.iter();
    let missions: Vec<_> = missions.map(|(index, of)| (*index, of)).collect();
    let (record, judged) = (plan.record(sky), plan.judge(sky));
    let page = flight_page(&plan.spec, &plan.world, &record, &judged, &missions);
    let table = page.split_once("<table id=\"served\">");
    let rows = table.and_then(|(_, after)| after.split_once("<tbody>\n"));
    let rows = rows.and_then(|(_, after)| after.split_once("    </tbody>"));
    let (rows, _) = rows.expect("a table of stops and tasks");
    rows.lines().map(str::to_owned).collect()
}

/// The row of a vehicle and a stop or task, in a state.
fn is_row(row: &str, vehicle: &str, label: &str, state: &str) -> bool {
    let cells =
        format!("{vehicle}</td><td>{label}</td><td class=\"mark\"><span>{state}</span></td>");
    row.contains(&cells)
}

/// The state and times of each stop or task of a vehicle, by its id.
fn entry<'a>(document: &'a Value, vehicle: &str, kind: &str, id: &str) -> &'a Value {
    let find = |list: &'a Value, id: &str| {
        let mut all = list.as_array().into_iter().flatten();
        all.find(|of| of["id"] == id).unwrap_or(&Value::Null)
    };
    find(&find(&document["vehicles"], vehicle)[kind], id)
}

#[test]
fn stops_and_tasks_of_every_kind_are_seen_done() {
    let plan = planned(TASKS);
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    sky.fly_to(1.0);
    let all: usize = sky.fleet.status(sky.now).iter().map(|of| of.done.1).sum();
    assert_eq!(all, 13, "six stops and seven tasks");
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    let report = plan.judge(&sky);
    assert!(report.passes(), "{report:#?}");
    let served = report.vehicles.iter().flat_map(|of| &of.served);
    assert_eq!(served.clone().count(), 13, "{report:#?}");
    for of in served {
        assert_eq!(of.state, ServiceState::Done, "{of:?}");
        assert!(of.from_s <= of.until_s, "{of:?}");
    }
    let done = sky.fleet.status(sky.now);
    assert!(done.iter().all(|of| of.done.0 == of.done.1), "{done:?}");
    let document = document(&plan, &sky);
    assert_eq!(document["stops"]["done"], 6, "{document:#}");
    assert_eq!(document["tasks"]["done"], 7, "{document:#}");
    let says = |text: &str| ["alpha", "bravo"].iter().any(|id| sky.says(id, text));
    for (id, kind) in [
        ("look", "visit"),
        ("dip", "visit"),
        ("yard", "visit"),
        ("parcel", "delivery"),
        ("field", "area"),
        ("road", "corridor"),
        ("lost", "search"),
    ] {
        let task = format!("task {id} ({kind})");
        assert!(says(&format!("{task} begins")), "{:?}", sky.events);
        assert!(says(&format!("{task} done")), "{:?}", sky.events);
    }
    assert!(says("task parcel (delivery) picked up"), "{:?}", sky.events);
    assert!(!says("missed"), "{:?}", sky.events);
    let rows = page_rows(&plan, &sky);
    assert_eq!(rows.len(), 13, "{rows:#?}");
    assert!(
        rows.iter().all(|row| row.starts_with("<tr class=\"ok\">")),
        "{rows:#?}"
    );
    assert!(rows.iter().all(|row| !row.contains('–')), "{rows:#?}");
    let has = |label: &str| {
        let mut rows = rows.iter();
        rows.any(|row| {
            ["alpha", "bravo"]
                .iter()
                .any(|id| is_row(row, id, label, "done"))
        })
    };
    assert!(has("stop s2") && has("task parcel (delivery)"), "{rows:#?}");
    // It is at a stop for as long as planned, and when the plan has it there.
    let s1 = entry(&document, "alpha", "stops", "s1");
    let stay_s = s1["until_s"].as_f64().expect("a time") - s1["from_s"].as_f64().expect("a time");
    assert!((3.0..7.0).contains(&stay_s), "{s1:#}");
}

#[test]
fn a_load_that_goes_down_as_a_new_mission_is_taken_over_is_seen_placed() {
    let plan = planned(
        "\ntasks:\n  - {id: yard, visit: {lat: 36.2910, lon: -84.2700, agl_m: 60, actions: [{payload_place: {}}]}}\n",
    );
    let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
    assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
    let mut record = plan.record(&sky);
    let puts_down = |of: &sortie::mission::Item| of.command == command::NAV_PAYLOAD_PLACE;
    let mut missions = plan.dispatched.missions.iter().enumerate();
    let row =
        missions.find_map(|(at, (_, of))| Some((at, of.items.iter().position(puts_down)? + 1)));
    let (at, row) = row.expect("a load is placed");
    let flight = &mut record.flights[at];
    // A metre below the waypoint before it the vehicle has the same mission with another number of
    // items, as from `replan`: that begins with the waypoint.
    let mut new = flight.plans[0].clone();
    new.items += 1;
    let waypoints = &new.reference.waypoints;
    let first = waypoints
        .iter()
        .position(|of| of.item + 1 == row)
        .expect("a waypoint");
    let (end_s, lands) = (new.reference.end_s, new.reference.lands);
    let top_m = waypoints[first].point.amsl.0;
    let ahead = waypoints[first - 1..].to_vec();
    new.reference = ReferenceTrajectory::of_waypoints(ahead, (end_s, lands), plan.world.frame);
    let lowers = |fix: &&mut Fix| fix.item < row || fix.amsl.0 > top_m - 1.2;
    let lowered = flight.flown.fixes.iter_mut().skip_while(lowers);
    lowered.for_each(|fix| fix.items = new.items);
    flight.plans.push(new);
    let report = judge(&plan.spec, &plan.world, &record);
    assert!(report.passes(), "{report:#?}");
    let mut served = report.vehicles[at].served.iter();
    let yard = served.find(|of| of.id == "yard").expect("a task");
    assert_eq!(yard.state, ServiceState::Done, "{yard:?}");
}

/// Another ground station has a vehicle go on with a row of its mission.
fn jump(sky: &mut Sky<'_>, index: usize, row: usize, first_row: u16) {
    let target = sky.vehicles[index].address();
    let seq = u16::try_from(row).expect("small") - first_row;
    let order = Command::new(Command::DO_SET_MISSION_CURRENT, [f32::from(seq)]);
    let message = Message::Flight(match first_row {
        0 => FlightMessage::Command { target, order },
        // PX4 does not know the command.
        _ => FlightMessage::SetCurrent { target, seq },
    });
    sky.vehicles[index].handle(sky.now, US, &message);
}

/// Row of the first item of a vehicle at a stop.
fn row_of(plan: &Planned, index: usize, id: &str) -> usize {
    let stop = plan.spec.vehicles[index].stops.iter();
    let stop = stop.clone().find(|stop| stop.id == id).expect("a stop");
    let items = plan.dispatched.missions[index].1.items.iter();
    let near = items.clone().position(|item| {
        let place = item.place();
        item.command == command::NAV_WAYPOINT
            && place.is_some_and(|place| place.chord_m(stop.end.place) < 1.0)
    });
    near.expect("an item") + 1
}

#[test]
fn a_stop_that_is_skipped_is_not_said_to_be_done() {
    let plan = planned("");
    for (index, id, first_row) in [(0, "alpha", 0), (1, "bravo", 1)] {
        let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
        sky.fly_to(1.0);
        while !sky.says(id, "stop s1 done") {
            sky.step();
        }
        let row_is = |sky: &Sky<'_>, state: &str| {
            let rows = page_rows(&plan, sky);
            rows.iter().any(|row| {
                is_row(row, id, "stop s2", state) && row.contains("<td class=\"num\">–</td></tr>")
            })
        };
        assert!(row_is(&sky, "left"));
        let row = row_of(&plan, index, "s3");
        jump(&mut sky, index, row, first_row);
        assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
        assert!(row_is(&sky, "missed"));
        assert!(sky.says(id, "stop s2 missed"), "{:?}", sky.events);
        assert!(!sky.says(id, "stop s2 done"), "{:?}", sky.events);
        assert!(sky.says(id, "stop s3 done (2 of 3)"), "{:?}", sky.events);
        let document = document(&plan, &sky);
        let state = |stop: &str| entry(&document, id, "stops", stop)["state"].clone();
        let states = ["s1", "s2", "s3"].map(state);
        assert_eq!(states, ["done", "missed", "done"], "{document:#}");
        assert_eq!(document["stops"]["done"], 5, "{document:#}");
        assert!(
            entry(&document, id, "stops", "s2")["until_s"].is_null(),
            "{document:#}"
        );
    }
}

#[test]
fn a_stop_that_is_left_before_its_time_is_not_said_to_be_done() {
    let plan = planned("");
    for (index, id, first_row) in [(0, "alpha", 0), (1, "bravo", 1)] {
        let mut sky = Sky::new(plan.fleet(false, true), plan.vehicles());
        let at = row_of(&plan, index, "s2");
        sky.fly_to(1.0);
        // It rests at the stop, and has not taken its picture.
        let rests = |sky: &Sky<'_>| {
            let mut status = sky.fleet.status(sky.now).into_iter();
            let (_, flown) = sky.fleet.flown().nth(index).expect("a vehicle");
            let is_at = status.nth(index).is_some_and(|of| of.item.0 == at);
            let is_slow = flown.fixes.last().is_some_and(|fix| fix.speed_mps < 0.5);
            is_at && is_slow && sky.says(id, "stop s1 done")
        };
        while !rests(&sky) {
            sky.step();
        }
        let row = row_of(&plan, index, "s3");
        jump(&mut sky, index, row, first_row);
        assert_eq!(sky.fly_out(), Outcome::Flown, "{:?}", sky.events);
        assert!(!sky.says(id, "stop s2 done"), "{:?}", sky.events);
        let document = document(&plan, &sky);
        let s2 = entry(&document, id, "stops", "s2");
        assert_eq!(s2["state"], "missed", "{document:#}");
    }
}

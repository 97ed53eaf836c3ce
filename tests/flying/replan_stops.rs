//! Copters in flight keep their stops and actions on new paths around a threat that came up.

use std::path::{Path, PathBuf};

use crate::support::{command, in_flight};
use command::{sortie, text};
use in_flight::{json, lines, planned, take_off, wait_for, wait_until};
use serde_json::Value;

/// Two copters on parallel lanes, a kilometre apart, each past four places 300 m apart.
const SPEC: &str = "
sortie: 1
name: visits
area: {south_west: {lat: 36.27, lon: -84.31}, north_east: {lat: 36.34, lon: -84.19}, min_agl_m: 30, max_amsl_m: 900}
terrain: {flat: {amsl_m: 400}}
vehicles:
  - {id: alpha, sysid: 1, autopilot: ardupilot, link: sim, speed_mps: 9, climb_mps: 3, descent_mps: 3, finish: land,
     start: {lat: 36.2900, lon: -84.2800, agl_m: 60}, goal: {lat: 36.2900, lon: -84.2630, agl_m: 60}, stops: [STOPS]}
  - {id: bravo, sysid: 2, autopilot: px4, link: sim, speed_mps: 9, climb_mps: 3, descent_mps: 3, finish: land,
     start: {lat: 36.3000, lon: -84.2800, agl_m: 60}, goal: {lat: 36.3000, lon: -84.2630, agl_m: 60}, stops: [STOPS]}
separation: {distance_m: 100, time_slack_s: 5}
planner: {algorithm: msfoa, seed: 1, evaluations: 4000, control_points: 4}
";

fn spec() -> String {
    let mut text = SPEC.to_owned();
    for lat in ["36.2900", "36.3000"] {
        let stops: Vec<String> = (1..=4)
            .map(|number| {
                let lon = -84.2800 + 0.00333 * f64::from(number);
                format!(
                    "{{id: s{number}, lat: {lat}, lon: {lon:.5}, agl_m: 60, hold_s: 3, \
                     actions: [{{gimbal: {{pitch_deg: -60}}}}, {{photo: {{}}}}]}}"
                )
            })
            .collect();
        text = text.replacen("STOPS", &stops.join(", "), 1);
    }
    text
}

/// When a vehicle rests near a place, seconds; the first time.
fn rest_s(lines: &[Value], vehicle: &str, lat: f64, lon: f64) -> Option<f64> {
    let of = |line: &&Value| line["vehicle"] == vehicle && line["lat_deg"].is_f64();
    let number = |line: &Value, key: &str| line[key].as_f64().expect("a number");
    let near = |line: &&Value| {
        let (north, east) = (number(line, "lat_deg") - lat, number(line, "lon_deg") - lon);
        (north * 111_000.0).hypot(east * 89_600.0) < 5.0 && number(line, "speed_mps") < 0.5
    };
    let found = lines.iter().filter(of).find(near)?;
    Some(number(found, "t_s"))
}

/// Waits until both copters are on their ways behind the first place.
fn wait_for_the_first_stop(runs: &Path) {
    for vehicle in ["alpha", "bravo"] {
        wait_until(runs, vehicle, "at its first place", |line| {
            line["lon_deg"]
                .as_f64()
                .is_some_and(|lon| lon > -84.28 + 0.00333 + 0.0004)
        });
    }
}

/// Flies a spec and leads both copters around a threat between the third and the fourth place once `is_time`; the records of a
/// flight that passed, and the folder that holds them.
fn led_around(name: &str, spec: &str, is_time: fn(&Path)) -> (tempfile::TempDir, PathBuf) {
    let (folder, runs) = planned(name, spec);
    let file = format!("{name}.yaml");
    let mut flight = take_off(folder.path(), &file, "8");
    is_time(&runs);
    let threat = "--threat=36.2950,-84.26835,564";
    let output = sortie(folder.path(), &["replan", &file, threat]);
    let told = text(&output.stdout);
    assert!(output.status.success(), "{told}{}", text(&output.stderr));
    assert_eq!(told.matches("on its new path").count(), 2, "{told}");
    let status = flight.0.wait().expect("it ends");
    let flown = json(&runs.join("flight.json"));
    assert_eq!(flown["verdict"], "pass", "{flown:#}");
    assert!(status.success(), "{status}");
    // What `replan` left to do, `fly` saw done.
    for kind in ["stops", "tasks"] {
        assert_eq!(flown[kind]["done"], flown[kind]["of"], "{flown:#}");
    }
    (folder, runs)
}

#[test]
fn copters_make_the_stops_that_are_left_on_their_new_paths() {
    // One stop is made, three are left.
    let (_folder, runs) = led_around("visits", &spec(), wait_for_the_first_stop);
    let replanned = json(&runs.join("replan.json"));
    for vehicle in replanned["vehicles"].as_array().expect("vehicles") {
        let left = vehicle["left"].as_array().expect("what is left");
        let ids: Vec<&str> = left.iter().filter_map(|of| of["id"].as_str()).collect();
        assert_eq!(ids, ["s2", "s3", "s4"], "{vehicle:#}");
    }
    let flown = json(&runs.join("flight.json"));
    assert_eq!(flown["stops"]["of"], 8, "{flown:#}");
    let lines = lines(&runs);
    for (vehicle, lat) in [("alpha", 36.29), ("bravo", 36.30)] {
        let of = |line: &&Value| line["vehicle"] == vehicle && line["plan"].is_object();
        assert_eq!(lines.iter().filter(of).count(), 2, "{vehicle}");
        let rests: Vec<Option<f64>> = (1..=4)
            .map(|number| rest_s(&lines, vehicle, lat, -84.28 + 0.00333 * f64::from(number)))
            .collect();
        assert!(rests.iter().all(Option::is_some), "{vehicle}: {rests:?}");
        assert!(rests.is_sorted(), "{vehicle}: {rests:?}");
    }
}

/// A task each for two copters on those lanes.
const TASKS: &str = "
sortie: 2
buffer_m: {all: 0}
name: tasks
area: {south_west: {lat: 36.27, lon: -84.31}, north_east: {lat: 36.34, lon: -84.19}, min_agl_m: 30, max_amsl_m: 900}
terrain: {flat: {amsl_m: 400}}
tasks:
  - {id: one, visit: {lat: 36.2900, lon: -84.2760, agl_m: 60, actions: [ACTION]}}
  - {id: two, visit: {lat: 36.3000, lon: -84.2760, agl_m: 60, actions: [{photo: {}}]}}
vehicles:
  - {id: alpha, sysid: 1, autopilot: ardupilot, link: sim, speed_mps: 9, climb_mps: 3, descent_mps: 3, finish: land,
     start: {lat: 36.2900, lon: -84.2800, agl_m: 60}, goal: {lat: 36.2900, lon: -84.2630, agl_m: 60}}
  - {id: bravo, sysid: 2, autopilot: px4, link: sim, speed_mps: 9, climb_mps: 3, descent_mps: 3, finish: land,
     start: {lat: 36.3000, lon: -84.2800, agl_m: 60}, goal: {lat: 36.3000, lon: -84.2630, agl_m: 60}}
separation: {distance_m: 100, time_slack_s: 5}
planner: {seed: 1, evaluations: 4000, control_points: 4}
";

#[test]
fn a_fleet_with_tasks_is_led_around_a_threat() {
    let tasks = TASKS.replace("ACTION", "{photo: {}}");
    led_around("tasks", &tasks, |runs| wait_for(runs, "alpha", 40.0));
}

#[test]
fn a_task_that_places_a_load_is_flown_with_the_parameters_of_its_plan() {
    let action = "{payload_place: {max_descent_m: 80}}";
    let (folder, runs) = planned("tasks", &TASKS.replace("ACTION", action));
    let mut flight = take_off(folder.path(), "tasks.yaml", "30");
    assert!(flight.0.wait().expect("it ends").success());
    assert_eq!(json(&runs.join("flight.json"))["verdict"], "pass");
}

/// When the plan has a vehicle at its first stop, seconds after T0.
fn stop_s(runs: &Path, vehicle: &str) -> f64 {
    let plan = json(&runs.with_extension("").join("plan.json"));
    let mut vehicles = plan["vehicles"].as_array().expect("vehicles").iter();
    let found = vehicles.find(|of| of["id"] == vehicle).expect("a vehicle");
    found["stops"][0]["t_s"].as_f64().expect("a time")
}

/// Waits until the record has an event with this text.
fn wait_until_said(runs: &Path, text: &str) {
    for _ in 0..1200 {
        let says = |line: &Value| line["event"].as_str().is_some_and(|of| of.contains(text));
        if lines(runs).iter().any(says) {
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    panic!("nothing said {text:?} within a minute");
}

const THREAT: &str = "--threat=36.2950,-84.26835,564";

#[test]
fn a_copter_that_places_its_load_has_its_new_path_when_it_goes_on() {
    let action = "{payload_place: {max_descent_m: 80}}";
    // The other one is slower, and still on its way then.
    let (alpha, bravo) = TASKS.split_once("{id: bravo").expect("two copters");
    let bravo = bravo.replacen("speed_mps: 9", "speed_mps: 6", 1);
    let spec = format!("{alpha}{{id: bravo{bravo}").replace("ACTION", action);
    let (folder, runs) = planned("tasks", &spec);
    let mut flight = take_off(folder.path(), "tasks.yaml", "5");
    // It comes down for two minutes.
    wait_for(&runs, "alpha", stop_s(&runs, "alpha") + 40.0);
    let output = sortie(folder.path(), &["replan", "tasks.yaml", THREAT]);
    let said = text(&output.stdout) + &text(&output.stderr);
    assert!(
        said.contains("alpha cannot avoid popup-1 (it is placing its load"),
        "{said}"
    );
    wait_until_said(&runs, "task one (visit) done");
    let output = sortie(folder.path(), &["replan", "tasks.yaml", THREAT]);
    let said = text(&output.stdout) + &text(&output.stderr);
    assert!(output.status.success(), "{said}");
    assert!(flight.0.wait().expect("it ends").success());
    let flown = json(&runs.join("flight.json"));
    assert_eq!(flown["verdict"], "pass", "{flown:#}");
    assert_eq!(flown["tasks"]["done"], 2, "{flown:#}");
}

#[test]
fn a_copter_that_is_about_to_place_its_load_places_it_and_takes_its_new_path() {
    let action = "{payload_place: {max_descent_m: 80}}";
    let places_it = |before_s: f64| {
        let (folder, runs) = planned("tasks", &TASKS.replace("ACTION", action));
        // The tightest wait is half a second of the clock: a loaded machine takes that long to order.
        let mut flight = take_off(folder.path(), "tasks.yaml", "4");
        wait_for(&runs, "alpha", stop_s(&runs, "alpha") - before_s);
        let output = sortie(folder.path(), &["replan", "tasks.yaml", THREAT]);
        let said = text(&output.stdout) + &text(&output.stderr);
        assert!(output.status.success(), "{before_s}: {said}");
        assert!(flight.0.wait().expect("it ends").success(), "{before_s}");
        let flown = json(&runs.join("flight.json"));
        assert_eq!(flown["verdict"], "pass", "{before_s}: {flown:#}");
        assert_eq!(flown["tasks"]["done"], 2, "{before_s}: {flown:#}");
    };
    // They wait for the clock.
    std::thread::scope(|scope| {
        for before_s in [12.0, 6.0, 2.0] {
            scope.spawn(move || places_it(before_s));
        }
    });
}

//! Copters in flight keep their stops and actions on new paths around a threat that came up.

use std::path::PathBuf;

use crate::support::{command, in_flight};
use command::{sortie, text};
use in_flight::{json, lines, planned, take_off, wait_for};
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

/// Flies a spec and leads both copters around a threat between the third and the fourth place, that
/// many seconds after T0; the records of a flight that passed, and the folder that holds them.
fn led_around(name: &str, spec: &str, at_s: f64) -> (tempfile::TempDir, PathBuf) {
    let (folder, runs) = planned(name, spec);
    let file = format!("{name}.yaml");
    let mut flight = take_off(folder.path(), &file, "8");
    wait_for(&runs, "alpha", at_s);
    let threat = "--threat=36.2950,-84.26835,564";
    let output = sortie(folder.path(), &["replan", &file, threat]);
    let told = text(&output.stdout);
    assert!(output.status.success(), "{told}{}", text(&output.stderr));
    assert_eq!(told.matches("on its new path").count(), 2, "{told}");
    let status = flight.0.wait().expect("it ends");
    let flown = json(&runs.join("flight.json"));
    assert_eq!(flown["verdict"], "pass", "{flown:#}");
    assert!(status.success(), "{status}");
    (folder, runs)
}

#[test]
fn copters_make_the_stops_that_are_left_on_their_new_paths() {
    // One stop is made, three are left.
    let (_folder, runs) = led_around("visits", &spec(), 62.0);
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
    led_around("tasks", &TASKS.replace("ACTION", "{photo: {}}"), 40.0);
}

#[test]
fn a_task_that_places_a_load_is_flown_with_the_parameters_of_its_plan() {
    let action = "{payload_place: {max_descent_m: 80}}";
    let (folder, runs) = planned("tasks", &TASKS.replace("ACTION", action));
    let mut flight = take_off(folder.path(), "tasks.yaml", "30");
    assert!(flight.0.wait().expect("it ends").success());
    assert_eq!(json(&runs.join("flight.json"))["verdict"], "pass");
}

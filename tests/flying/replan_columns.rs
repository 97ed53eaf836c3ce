//! Threats that come up while a vehicle goes straight down or up: in its landing, or in a drop.

use std::path::Path;
use std::time::Duration;

use crate::support::{command, in_flight};
use command::{sortie, text};
use in_flight::{json, lines, planned, take_off};
use serde_json::Value;

/// A vehicle that lands soon, and comes down slowly, 2 km from a copter that flies on. Its home lies on a hill.
const LANDING: &str = "
sortie: 2
buffer_m: {all: 0}
name: landing
area: {south_west: {lat: 36.27, lon: -84.31}, north_east: {lat: 36.34, lon: -84.19}, min_agl_m: 30, max_amsl_m: 900}
terrain: {analytic: {base_amsl_m: 400, hills: [{lat: 36.2900, lon: -84.2800, height_m: HILL, radius_m: 250}]}}
vehicles:
  - {id: alpha, sysid: 1, autopilot: AUTOPILOT, airframe: AIRFRAME, link: sim, climb_mps: 5, descent_mps: 1, finish: land,
     start: {lat: 36.2900, lon: -84.2800, agl_m: 50}, goal: {lat: 36.2900, lon: -84.2630, agl_m: 50}, speed_mps: SPEED}
  - {id: bravo, sysid: 2, autopilot: ardupilot, link: sim, speed_mps: 9, climb_mps: 3, descent_mps: 3, finish: land,
     start: {lat: 36.3100, lon: -84.2900, agl_m: 50}, goal: {lat: 36.3100, lon: -84.2500, agl_m: 50}}
separation: {distance_m: 100, time_slack_s: 5}
planner: {seed: 1, evaluations: 3000, control_points: 6}
";

fn landing((autopilot, airframe): (&str, &str), hill_m: &str) -> String {
    let speed = match airframe {
        "vtol" => "18, loiter_radius_m: 80",
        _ => "9",
    };
    let spec = LANDING.replace("AUTOPILOT", autopilot);
    let spec = spec.replace("HILL", hill_m);
    spec.replace("AIRFRAME", airframe).replace("SPEED", speed)
}

/// Waits until the record has a position of a vehicle that is so.
fn wait_until(runs: &Path, vehicle: &str, is_so: &dyn Fn(f64, f64) -> bool) {
    for _ in 0..2400 {
        let is_it = |line: &Value| {
            let number = |key: &str| line[key].as_f64();
            let (t_s, amsl_m) = (number("t_s"), number("amsl_m"));
            line["vehicle"] == vehicle && t_s.zip(amsl_m).is_some_and(|(t, amsl)| is_so(t, amsl))
        };
        if lines(runs).iter().any(is_it) {
            return;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    panic!("{vehicle} was not seen there within two minutes");
}

#[test]
fn a_vehicle_in_its_landing_descent_keeps_its_mission_and_nobody_from_a_new_path() {
    // The second hill is higher than the descent is long. They wait for the clock: the two airframes at the same time.
    let cases = [
        [("ardupilot", "copter", "1"), ("px4", "copter", "60")],
        [("ardupilot", "vtol", "60"), ("px4", "vtol", "1")],
    ];
    std::thread::scope(|scope| {
        for of_airframe in cases {
            scope.spawn(move || of_airframe.map(keeps_its_mission));
        }
    });
}

fn keeps_its_mission((autopilot, airframe, hill_m): (&str, &str, &str)) {
    let (folder, runs) = planned("landing", &landing((autopilot, airframe), hill_m));
    let mut flight = take_off(folder.path(), "landing.yaml", "10");
    wait_until(&runs, "alpha", &|t_s, amsl_m| t_s > 60.0 && amsl_m < 430.0);
    // Where alpha has been; and on the path of bravo.
    for (threat, led) in [("36.2900,-84.2720,100", 0), ("36.3100,-84.2600,150", 1)] {
        let threat = format!("--threat={threat}");
        let output = sortie(folder.path(), &["replan", "landing.yaml", &threat]);
        let said = text(&output.stdout) + &text(&output.stderr);
        let case = format!("{autopilot} {airframe}, {threat}: {said}");
        assert!(output.status.success(), "{case}");
        assert_eq!(said.matches("on its new path").count(), led, "{case}");
    }
    assert!(flight.0.wait().expect("it ends").success());
    let flown = json(&runs.join("flight.json"));
    assert_eq!(
        flown["verdict"], "pass",
        "{autopilot} {airframe}: {flown:#}"
    );
    assert_eq!(flown["vehicles"][0]["end"], "landed", "{flown:#}");
}

#[test]
fn a_vehicle_that_comes_down_next_to_a_threat_is_not_led_up_again() {
    let (folder, runs) = planned("landing", &landing(("ardupilot", "copter"), "1"));
    let _flight = take_off(folder.path(), "landing.yaml", "10");
    wait_until(&runs, "alpha", &|t_s, amsl_m| t_s > 60.0 && amsl_m < 430.0);
    // Its rim is within the tolerance of alpha's landing place.
    let threat = "--threat=36.2900,-84.26189,99";
    let output = sortie(folder.path(), &["replan", "landing.yaml", threat]);
    let said = text(&output.stdout) + &text(&output.stderr);
    assert!(!said.contains("on its new path"), "{said}");
    assert!(output.status.success(), "{said}");
}

/// A copter with a stop 6 m above the ground, and one that flies past.
const DROP: &str = "
sortie: 2
name: drop
area: {south_west: {lat: 36.27, lon: -84.31}, north_east: {lat: 36.34, lon: -84.19}, min_agl_m: 50, max_amsl_m: 900}
terrain: {flat: {amsl_m: 400}}
vehicles:
  - {id: alpha, sysid: 1, autopilot: AUTOPILOT, link: sim, speed_mps: 9, climb_mps: 2, descent_mps: 2, finish: land,
     start: {lat: 36.2900, lon: -84.2800, agl_m: 70}, goal: {lat: 36.2900, lon: -84.2580, agl_m: 70},
     stops: [{id: low, lat: 36.2900, lon: -84.2760, agl_m: 6, hold_s: 8, actions: [{photo: {}}]}]}
  - {id: bravo, sysid: 2, autopilot: px4, link: sim, speed_mps: 6, climb_mps: 3, descent_mps: 3, finish: land,
     start: {lat: 36.3000, lon: -84.2800, agl_m: 70}, goal: {lat: 36.3000, lon: -84.2580, agl_m: 70}}
separation: {distance_m: 100, time_slack_s: 5}
planner: {seed: 1, evaluations: 4000, control_points: 4}
";

/// When the plan has alpha above its stop, seconds after T0.
fn stop_s(runs: &Path) -> f64 {
    let plan = json(&runs.with_extension("").join("plan.json"));
    let stop = &plan["vehicles"][0]["stops"][0];
    stop["t_s"].as_f64().expect("a time")
}

#[test]
fn a_copter_in_a_drop_is_named_and_has_its_new_path_when_it_rests_above_it() {
    std::thread::scope(|scope| {
        for autopilot in ["ardupilot", "px4"] {
            scope.spawn(move || rests_above_its_drop(autopilot));
        }
    });
}

fn rests_above_its_drop(autopilot: &str) {
    let (folder, runs) = planned("drop", &DROP.replace("AUTOPILOT", autopilot));
    let mut flight = take_off(folder.path(), "drop.yaml", "6");
    let replan = |threat: &str| {
        let threat = format!("--threat={threat}");
        let output = sortie(folder.path(), &["replan", "drop.yaml", &threat]);
        let said = text(&output.stdout) + &text(&output.stderr);
        (output.status.code(), format!("{autopilot}: {said}"))
    };
    let threat = "36.2900,-84.2660,120";
    // It comes down 54 m at 2 m/s, is at work for 8 s, and rises.
    let above_s = stop_s(&runs);
    let is_down = |t_s: f64, amsl_m: f64| t_s > above_s + 3.0 && amsl_m < 440.0;
    let is_rising = |t_s: f64, amsl_m: f64| t_s > above_s + 38.0 && amsl_m > 420.0;
    for is_there in [&is_down as &dyn Fn(f64, f64) -> bool, &is_rising] {
        wait_until(&runs, "alpha", is_there);
        let (code, said) = replan(threat);
        assert_eq!(code, Some(4), "{said}");
        let why = "(it is in a drop: give the threat again when it rests above it)";
        assert!(said.contains("alpha cannot avoid popup-1"), "{said}");
        assert!(said.contains(why), "{said}");
    }
    wait_until(&runs, "alpha", &|t_s, amsl_m| {
        t_s > above_s + 45.0 && amsl_m > 459.5
    });
    let (code, said) = replan(threat);
    assert_eq!(code, Some(0), "{said}");
    assert!(flight.0.wait().expect("it ends").success());
    let flown = json(&runs.join("flight.json"));
    assert_eq!(flown["verdict"], "pass", "{autopilot}: {flown:#}");
    assert_eq!(flown["stops"]["done"], 1, "{autopilot}: {flown:#}");
}

//! New paths of vehicles that have a drop, a stop with a radius of its own, or pictures on the way, ahead.

use crate::support::{command, in_flight};
use command::{sortie, text};
use in_flight::{json, planned, take_off, wait_for};

/// A copter with a stop on its way, and a threat that comes up on the leg to it.
const AHEAD: &str = "
sortie: 2
name: ahead
area: {south_west: {lat: 60.10, lon: 24.90}, north_east: {lat: 60.14, lon: 24.98}, min_agl_m: 30, max_amsl_m: 200}
terrain: {flat: {amsl_m: 20}}
vehicles:
  - {id: alpha, sysid: 1, autopilot: AUTOPILOT, link: sim, speed_mps: 8, FINISH,
     start: {lat: 60.12, lon: 24.91, agl_m: 60}, goal: {lat: 60.121, lon: 24.96, agl_m: 60},
     stops: [{id: s4, lat: 60.13, lon: 24.95, STOP}]}
planner: {evaluations: 2000}
";

#[test]
fn what_is_left_at_stops_and_on_the_way_is_in_the_new_mission_as_it_was_planned() {
    let cases = [
        ("finish: land", "agl_m: 10"),
        ("finish: land", "agl_m: 60, acceptance_radius_m: 1"),
        (
            "finish: return, camera: {trigger_distance_m: 30}",
            "agl_m: 60",
        ),
    ];
    for autopilot in ["ardupilot", "px4"] {
        std::thread::scope(|scope| {
            for (finish, stop) in cases {
                scope.spawn(move || flies_around(autopilot, finish, stop));
            }
        });
    }
}

fn flies_around(autopilot: &str, finish: &str, stop: &str) {
    let spec = AHEAD.replace("AUTOPILOT", autopilot);
    let spec = spec.replace("FINISH", finish).replace("STOP", stop);
    let (folder, runs) = planned("ahead", &spec);
    let mut flight = take_off(folder.path(), "ahead.yaml", "20");
    wait_for(&runs, "alpha", 60.0);
    let threat = "--threat=60.1266,24.9366,100";
    let output = sortie(folder.path(), &["replan", "ahead.yaml", threat]);
    let said = text(&output.stdout) + &text(&output.stderr);
    let case = format!("{autopilot}, {finish}, {stop}: {said}");
    assert_eq!(output.status.code(), Some(0), "{case}");
    assert!(said.contains("on its new path"), "{case}");
    assert!(flight.0.wait().expect("it ends").success(), "{case}");
    let flown = json(&runs.join("flight.json"));
    assert_eq!(flown["verdict"], "pass", "{case}: {flown:#}");
    assert_eq!(flown["stops"]["done"], 1, "{case}: {flown:#}");
}

//! Tasks with windows at one place and after a departure that was shifted, as `plan` writes them.

use std::fs;
use std::path::Path;

use crate::support::command::{sortie, text};
use crate::support::in_flight::json;
use serde_json::Value;

/// A copter west of the places of its tasks.
const SPEC: &str = "sortie: 2
name: windows
t0: 2030-05-05T10:00:00Z
area: {south_west: {lat: -33.020, lon: 18.000}, north_east: {lat: -32.990, lon: 18.040}, min_agl_m: 30, max_amsl_m: 300}
terrain: {flat: {amsl_m: 50}}
planner: {evaluations: 2000}
vehicles:
  - {id: a, sysid: 1, autopilot: ardupilot, link: sim, start: {lat: -33.015, lon: 18.004, agl_m: 60}, finish: land,
     goal: {lat: -33.0147, lon: 18.004, agl_m: 60}, speed_mps: 9, depart_window_s: {from: 0, to: 900}}
";

/// Plans the spec with more of it: what was said, and `plan.json`.
fn planned(folder: &Path, more: &str) -> (Option<i32>, String, Value) {
    fs::write(folder.join("windows.yaml"), format!("{SPEC}{more}")).expect("written");
    let output = sortie(folder, &["plan", "windows.yaml"]);
    let said = text(&output.stdout) + &text(&output.stderr);
    let plan = json(&folder.join("out/windows/plan.json"));
    (output.status.code(), said, plan)
}

#[test]
fn tasks_at_one_place_wait_before_the_first_action_for_the_later_window() {
    let folder = tempfile::tempdir().expect("a folder");
    let tasks = "tasks:
  - {id: q, visit: {lat: -33.000, lon: 18.02, agl_m: 60, window_s: {from: 1000, to: 1060}, actions: [{photo: {}}]}}
  - {id: s, visit: {lat: -33.000, lon: 18.02, agl_m: 60, window_s: {from: 300, to: 2000}, hold_s: 60}}
";
    let (code, said, _) = planned(folder.path(), tasks);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("2: q, s"), "{said}");
}

/// How long the vehicle is at its stops, seconds.
fn rests_s(plan: &Value) -> f64 {
    let stops = plan["vehicles"][0]["stops"].as_array().expect("stops");
    stops
        .iter()
        .filter_map(|stop| stop["rest_s"].as_f64())
        .sum()
}

#[test]
fn a_vehicle_that_departs_later_for_a_zone_does_not_wait_as_if_it_had_not() {
    let folder = tempfile::tempdir().expect("a folder");
    // It comes to w 205 s after its departure.
    let more = "zones: [{id: zz, circle: {lat: -33.013, lon: 18.010, radius_m: 250}, active: {from: 2030-05-05T10:00:00Z, to: 2030-05-05T10:06:40Z}}]
tasks:
  - {id: v, visit: {lat: -33.013, lon: 18.010, agl_m: 60}}
  - {id: w, visit: {lat: -33.010, lon: 18.020, agl_m: 60, window_s: {from: 450, to: 650}}}
";
    let (code, said, plan) = planned(folder.path(), more);
    assert_eq!(code, Some(0), "{said}");
    assert!(rests_s(&plan) < 10.0, "{plan:#}");
}

#[test]
fn a_task_in_a_zone_with_a_time_is_done_after_a_later_departure() {
    let folder = tempfile::tempdir().expect("a folder");
    let more = "zones: [{id: zz, circle: {lat: -33.005, lon: 18.01, radius_m: 150}, active: {from: 2030-05-05T10:00:00Z, to: 2030-05-05T10:06:40Z}}]
tasks:
  - {id: p, deliver: {from: {lat: -33.005, lon: 18.010, agl_m: 60, hold_s: 5, actions: [{gripper: grab}]}, to: {lat: -33.000, lon: 18.03, agl_m: 60, actions: [{gripper: release}]}, window_s: {from: 600, to: 800}}}
  - {id: v, visit: {lat: -33.012, lon: 18.02, agl_m: 60}}
";
    let (code, said, _) = planned(folder.path(), more);
    assert_eq!(code, Some(0), "{said}");
}

#[test]
fn each_cause_for_a_task_that_is_left_has_a_sentence_of_its_own() {
    let folder = tempfile::tempdir().expect("a folder");
    let tasks = "tasks:
  - {id: near, visit: {lat: -33.015, lon: 18.004, agl_m: 60}}
  - {id: soon, visit: {lat: -33.000, lon: 18.03, agl_m: 60, window_s: {from: 0, to: 20}}}
";
    let (code, said, _) = planned(folder.path(), tasks);
    assert_eq!(code, Some(4), "{said}");
    assert!(
        said.contains("its place is within 10 m of the start or the goal"),
        "{said}"
    );
    assert!(
        said.contains("no vehicle that may do it is there in its window"),
        "{said}"
    );
    assert!(!said.contains("runs its actions"), "{said}");
}

/// A plane whose turns after its takeoff lead over its start before it comes to it.
const PLANE: &str = "sortie: 2
name: plane
area: {south_west: {lat: 50.00, lon: 10.00}, north_east: {lat: 50.06, lon: 10.10}, min_agl_m: 50, max_amsl_m: 400}
terrain: {flat: {amsl_m: 100}}
planner: {evaluations: 2000}
vehicles:
  - {id: a, sysid: 1, autopilot: AUTOPILOT, airframe: plane, link: sim, home: {lat: 50.02, lon: 10.02}, finish: land,
     start: {lat: 50.02, lon: 10.03, agl_m: 90, actions: [{video: start}]}, goal: {lat: 50.03, lon: 10.07, agl_m: 90},
     takeoff_heading_deg: 90, landing: {glide_deg: 6, heading_deg: 0}, speed_mps: 16, max_climb_deg: 8, max_descent_deg: 8, STOPS}
";

#[test]
fn a_plane_that_crosses_its_start_before_it_comes_to_it_acts_as_it_comes_to_it() {
    let folder = tempfile::tempdir().expect("a folder");
    // It leaves its start northwards.
    let north = "stops: [{id: s2, lat: 50.045, lon: 10.05, agl_m: 90, hold_s: 60, actions: [{photo: {}}]},
             {id: s3, lat: 50.045, lon: 10.02, agl_m: 120, acceptance_radius_m: 30},
             {id: s4, lat: 50.035, lon: 10.03, agl_m: 90, actions: [{gripper: release}]},
             {id: s1, lat: 50.025, lon: 10.05, agl_m: 100, actions: [{gimbal: {pitch_deg: -45}}, {photo: {}}]}], order: free";
    // As fast as an ArduPlane may be it comes within 21.1 m of its start.
    let wide = "mission: {tolerance_m: 25}\nterrain:";
    for (autopilot, stops, terrain) in
        [("px4", "stops: []", "terrain:"), ("ardupilot", north, wide)]
    {
        let spec = PLANE
            .replace("AUTOPILOT", autopilot)
            .replace("STOPS", stops)
            .replace("terrain:", terrain);
        fs::write(folder.path().join("plane.yaml"), spec).expect("written");
        let output = sortie(folder.path(), &["plan", "plane.yaml"]);
        let said = text(&output.stdout) + &text(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{autopilot}: {said}");
    }
}

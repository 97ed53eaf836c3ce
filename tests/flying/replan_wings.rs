//! Wings in flight are led onto new paths around a threat that came up, and never stop.

use crate::support::{command, in_flight};
use command::{sortie, text};
use in_flight::{json, lines, planned, take_off, wait_for};
use serde_json::Value;

/// Three VTOL on parallel lanes, a kilometre and two apart, 5 km and 3.6 km each.
const SPEC: &str = "
sortie: 1
name: lanes
area: {south_west: {lat: 36.27, lon: -84.31}, north_east: {lat: 36.34, lon: -84.19}, min_agl_m: 30, max_amsl_m: 900}
terrain: {flat: {amsl_m: 400}}
vehicles:
  - {id: osprey, sysid: 1, autopilot: ardupilot, airframe: vtol, link: sim, speed_mps: 18, climb_mps: 4, descent_mps: 3,
     start: {lat: 36.2900, lon: -84.280, agl_m: 60}, goal: {lat: 36.2900, lon: -84.225, agl_m: 60}, finish: land,
     loiter_radius_m: 80}
  - {id: kestrel, sysid: 2, autopilot: px4, airframe: vtol, link: sim, speed_mps: 18, climb_mps: 4, descent_mps: 3,
     start: {lat: 36.2990, lon: -84.280, agl_m: 60}, goal: {lat: 36.2990, lon: -84.225, agl_m: 60}, finish: loiter,
     loiter_radius_m: 80}
  - {id: merlin, sysid: 3, autopilot: ardupilot, airframe: vtol, link: sim, speed_mps: 18, climb_mps: 4, descent_mps: 3,
     start: {lat: 36.3200, lon: -84.280, agl_m: 60}, goal: {lat: 36.3200, lon: -84.240, agl_m: 60}, finish: land,
     loiter_radius_m: 80}
separation: {distance_m: 100, time_slack_s: 5}
planner: {algorithm: msfoa, seed: 1, evaluations: 2000, control_points: 8}
";

/// Times and speeds of a vehicle on its wing.
fn speeds(lines: &[Value], vehicle: &str, from_s: f64) -> Vec<(f64, f64)> {
    let of = |line: &&Value| line["vehicle"] == vehicle && line["lat_deg"].is_f64();
    let number = |line: &Value, key: &str| line[key].as_f64().expect("a number");
    let all = lines.iter().filter(of);
    all.map(|line| (number(line, "t_s"), number(line, "speed_mps")))
        .filter(|(t_s, _)| *t_s > from_s)
        .collect()
}

#[test]
fn vtol_in_flight_go_around_a_popup_threat_without_a_stop_and_one_is_not_touched() {
    let (folder, runs) = planned("lanes", SPEC);
    let mut flight = take_off(folder.path(), "lanes.yaml", "16");
    wait_for(&runs, "osprey", 60.0);
    let threat = "--threat=36.2945,-84.245,500";
    let output = sortie(folder.path(), &["replan", "lanes.yaml", threat]);
    let told = text(&output.stdout);
    assert!(output.status.success(), "{told}{}", text(&output.stderr));
    assert_eq!(told.matches("on its new path").count(), 2, "{told}");
    assert_eq!(told.matches("not touched").count(), 1, "{told}");
    let status = flight.0.wait().expect("it ends");
    let flown = json(&runs.join("flight.json"));
    assert_eq!(flown["verdict"], "pass", "{flown:#}");
    assert!(status.success(), "{status}");
    let margins = flown["margins"].as_array().expect("margins");
    let popups = margins.iter().filter(|m| m["what"] == "threat popup-1");
    assert_eq!(popups.count(), 3, "{margins:#?}");
    let ends = ["landed", "loiters", "landed"];
    for (vehicle, end) in flown["vehicles"].as_array().expect("them").iter().zip(ends) {
        assert_eq!(vehicle["end"], end, "{vehicle:#}");
    }
    let lines = lines(&runs);
    for (vehicle, plans) in [("osprey", 2), ("kestrel", 2), ("merlin", 1)] {
        let of = |line: &&Value| line["vehicle"] == vehicle && line["plan"].is_object();
        assert_eq!(lines.iter().filter(of).count(), plans, "{vehicle}");
        let on_wing = speeds(&lines, vehicle, 60.0);
        let on_wing = on_wing.iter().filter(|(t_s, _)| *t_s < 200.0);
        let slowest_mps = on_wing.map(|of| of.1).fold(f64::INFINITY, f64::min);
        assert!(slowest_mps > 16.0, "{vehicle}: {slowest_mps} m/s");
    }
}

/// A QuadPlane that flies with the wind, and lands into it.
const WINDY: &str = "
sortie: 2
name: windy
area: {south_west: {lat: 36.25, lon: -84.33}, north_east: {lat: 36.36, lon: -84.17}, min_agl_m: 30, max_amsl_m: 900}
terrain: {flat: {amsl_m: 400}}
wind: {from_deg: 270, speed_mps: 3}
vehicles:
  - {id: osprey, sysid: 1, autopilot: ardupilot, airframe: vtol, link: sim, speed_mps: 18, climb_mps: 4, descent_mps: 3,
     start: {lat: 36.2900, lon: -84.290, agl_m: 80}, goal: {lat: 36.2900, lon: -84.220, agl_m: 80}, finish: land,
     loiter_radius_m: 100}
separation: {distance_m: 100, time_slack_s: 5}
planner: {algorithm: msfoa, seed: 1, evaluations: 2000, control_points: 8}
";

#[test]
fn a_quadplane_that_was_to_land_into_the_wind_is_led_around_a_threat_all_the_same() {
    let (folder, runs) = planned("windy", WINDY);
    let mut flight = take_off(folder.path(), "windy.yaml", "6");
    wait_for(&runs, "osprey", 60.0);
    let threat = "--threat=36.2900,-84.250,400";
    let output = sortie(folder.path(), &["replan", "windy.yaml", threat]);
    let told = text(&output.stdout);
    assert!(output.status.success(), "{told}{}", text(&output.stderr));
    assert_eq!(told.matches("on its new path").count(), 1, "{told}");
    let status = flight.0.wait().expect("it ends");
    let flown = json(&runs.join("flight.json"));
    assert_eq!(flown["verdict"], "pass", "{flown:#}");
    assert_eq!(flown["vehicles"][0]["end"], "landed", "{flown:#}");
    assert!(status.success(), "{status}");
}

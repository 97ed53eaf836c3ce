//! Landings far below and above home, where the slow end may begin at its height above home.

use std::fs;

use serde_json::Value;

use crate::support::command::{sortie, text};

/// What the endurance margin of a flight from a hill into the plain is, or from the plain onto the hill, seconds.
fn used_s(home_lat: f64, goal_lat: f64) -> f64 {
    let folder = tempfile::tempdir().expect("a folder");
    let spec = format!(
        "sortie: 2
name: t
area:
  south_west: {{lat: 46.95, lon: 7.40}}
  north_east: {{lat: 47.05, lon: 7.50}}
  min_agl_m: 30
  max_amsl_m: 900
terrain: {{analytic: {{base_amsl_m: 300, hills: [{{lat: 47.0, lon: 7.45, height_m: 100, radius_m: 300}}]}}}}
buffer_m: {{all: 0}}
vehicles:
  - id: a
    sysid: 1
    autopilot: ardupilot
    airframe: copter
    link: sim
    home: {{lat: {home_lat}, lon: 7.45}}
    start: {{lat: {home_lat}, lon: 7.45, amsl_m: 560}}
    goal: {{lat: {goal_lat}, lon: 7.45, amsl_m: 560}}
    finish: land
    endurance: {{time_s: 2000, reserve: 0.0}}
    speed_mps: 8
mission: {{fence: false}}
"
    );
    fs::write(folder.path().join("s.yaml"), spec).expect("written");
    let planned = sortie(folder.path(), &["plan", "s.yaml", "--out", "out"]);
    let said = text(&planned.stdout) + &text(&planned.stderr);
    assert_eq!(planned.status.code(), Some(0), "{said}");
    let review = fs::read_to_string(folder.path().join("out/review.json")).expect("written");
    let review: Value = serde_json::from_str(&review).expect("JSON");
    let margins = review["margins"].as_array().expect("margins");
    let endurance = margins.iter().find(|margin| margin["what"] == "endurance");
    let endurance = endurance.unwrap_or_else(|| panic!("{review}"));
    endurance["value"].as_f64().expect("a number")
}

/// `Mode::get_alt_above_ground_m`: without terrain data or a rangefinder it is the height above home.
#[test]
fn a_landing_below_home_counts_as_slow_from_its_height_above_home_on() {
    // Down 160 m or 260 m: 10 m of it at 0.5 m/s and the rest at 1.5 m/s, or slow from 410 m on.
    let (down_s, up_s) = (used_s(47.0, 47.01), used_s(47.01, 47.0));
    let slow_s = 100.0 * (1.0 / 0.5 - 1.0 / 1.5);
    // The way up is 100 m longer, and the way down as much shorter.
    let otherwise_s = 100.0 / 2.5 - 100.0 / 1.5;
    let difference_s = down_s - up_s + otherwise_s;
    assert!((difference_s - slow_s).abs() < 5.0, "{down_s} {up_s}");
}

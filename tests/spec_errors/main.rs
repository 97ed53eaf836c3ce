//! What is wrong with a spec is said at once, each problem with its place.

mod airspeed;
mod areas;
mod buffers;
mod fleets;
mod ground;
mod limits;
mod meaning;
mod on_alarm;
mod ranges;
mod stops;
mod structure;
mod tasks;
mod wings;
mod zones;

use std::fs;
use std::path::Path;

use sortie::geodesy::{Agl, Amsl};
use sortie::spec::{
    Airframe, Algorithm, AltitudeReference, Autopilot, Finish, Issue, Link, MissionSpec,
    OnLinkLoss, Placement, SpecError, SpecFile, TerrainSource,
};
use sortie::world;

/// Every key of the format once, all good.
const FULL: &str = "\
sortie: 1
name: full
origin: {lat: 36.30, lon: -84.25}
area:
  south_west: {lat: 36.20, lon: -84.40}
  north_east: {lat: 36.40, lon: -84.10}
  min_agl_m: 60
  max_amsl_m: 1500
terrain:
  analytic:
    base_amsl_m: 300
    hills:
      - {lat: 36.30, lon: -84.25, height_m: 200, radius_m: 2000}
threats:
  - {id: radar-1, kind: radar, lat: 36.31, lon: -84.26, radius_m: 3000}
no_fly:
  - {id: town, polygon: [[36.35, -84.20], [36.36, -84.20], [36.36, -84.18]], below_amsl_m: 900}
rally:
  - {lat: 36.22, lon: -84.38, agl_m: 80}
vehicles:
  - id: alpha
    sysid: 1
    autopilot: ardupilot
    airframe: copter
    link: udpout:127.0.0.1:14550
    home: {lat: 36.21, lon: -84.39}
    start: {lat: 36.21, lon: -84.38, agl_m: 80}
    goal: {lat: 36.39, lon: -84.12, amsl_m: 700}
    finish: land
    speed_mps: 15
    max_load_factor: 1.2
    max_climb_deg: 15
    max_descent_deg: 10
    climb_mps: 4
    descent_mps: 3
    accel_mps2: 2
    depart_s: 5
    return_amsl_m: 900
  - id: bravo
    sysid: 2
    autopilot: px4
    link: tcp:127.0.0.1:5760
    start: {lat: 36.39, lon: -84.39, agl_m: 80}
    goal: {lat: 36.21, lon: -84.12, agl_m: 80}
    finish: return
    speed_mps: 12
    max_airspeed_mps: 20
separation: {distance_m: 150, time_slack_s: 10, vertical_m: 40}
planner:
  algorithm: msfoa-dwindle
  objective: paper
  seed: 7
  evaluations: 5000
  control_points: 6
  samples: 51
  weights: {length: 2, altitude: 1, threat: 1, terrain: 1, turn: 1, climb: 1, collision: 1}
  swarms: 4
  population: 40
  threshold: 0.5
  step: 0.1
mission: {altitude: relative, tolerance_m: 3, max_items: 100, fence: false}
wind: {from_deg: 270, speed_mps: 5}
on_link_loss: hold_all
";

fn parse(text: &str) -> Result<SpecFile, SpecError> {
    SpecFile::parse(Path::new("mission.yaml"), text.to_owned())
}

fn good(text: &str) -> MissionSpec {
    parse(text).unwrap_or_else(|error| panic!("{error}")).spec
}

/// The full spec with one piece of text replaced.
fn with(old: &str, new: &str) -> String {
    assert!(FULL.contains(old), "{old}");
    FULL.replacen(old, new, 1)
}

fn issues(text: &str) -> Vec<Issue> {
    let Err(error) = parse(text) else {
        panic!("accepted:\n{text}")
    };
    assert!(!error.issues.is_empty());
    error.issues
}

/// The only issue of a changed spec: its path, and what a person reads.
fn only(old: &str, new: &str) -> (String, String) {
    let text = with(old, new);
    let mut found = issues(&text);
    assert_eq!(found.len(), 1, "{found:#?}");
    let issue = found.remove(0);
    assert!(issue.position.is_some(), "{issue:?}");
    let text = said_of(std::slice::from_ref(&issue));
    (issue.path, text)
}

/// What the user reads of issues.
fn said_of(issues: &[Issue]) -> String {
    let mut error = SpecError::default();
    "mission.yaml".clone_into(&mut error.file);
    error.issues = issues.to_vec();
    error.to_string()
}

/// Line and column of a piece of text that occurs once.
fn place_of(text: &str, piece: &str) -> (usize, usize) {
    let at = text.find(piece).unwrap_or_else(|| panic!("{piece}"));
    let before = &text[..at];
    let line = before.matches('\n').count() + 1;
    (line, at - before.rfind('\n').map_or(0, |end| end + 1) + 1)
}

/// Issues that show only when the ground is read.
fn over_ground(text: &str) -> Vec<Issue> {
    let file = parse(text).unwrap_or_else(|error| panic!("{error}"));
    world::load(&file)
        .expect_err("something is wrong over the ground")
        .issues
}

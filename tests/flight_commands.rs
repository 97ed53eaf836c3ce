//! `sortie fly` and `sortie replan` as an operator types them, in a hurry.

#[path = "support/command.rs"]
#[allow(unreachable_pub)]
mod command;

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use assert_cmd::cargo::cargo_bin;
use command::{sortie, text};
use serde_json::Value;

/// Two copters on parallel lanes 600 m apart, 2.4 km each.
const SPEC: &str = "
sortie: 1
name: lanes
area: {south_west: {lat: 36.28, lon: -84.30}, north_east: {lat: 36.33, lon: -84.20}, min_agl_m: 30, max_amsl_m: 900}
terrain: {flat: {amsl_m: 400}}
vehicles:
  - {id: alpha, sysid: 1, autopilot: ardupilot, link: sim, speed_mps: 15, climb_mps: 5, descent_mps: 4,
     start: {lat: 36.300, lon: -84.265, agl_m: 60}, goal: {lat: 36.300, lon: -84.238, agl_m: 60}, finish: land}
  - {id: bravo, sysid: 2, autopilot: px4, link: sim, speed_mps: 15, climb_mps: 5, descent_mps: 4,
     start: {lat: 36.310, lon: -84.265, agl_m: 60}, goal: {lat: 36.310, lon: -84.238, agl_m: 60}, finish: loiter}
separation: {distance_m: 100, time_slack_s: 5}
planner: {algorithm: msfoa, seed: 1, evaluations: 2000}
";

fn planned() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("lanes.yaml"), SPEC).expect("written");
    let output = sortie(folder.path(), &["plan", "lanes.yaml"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    folder
}

fn json(path: &Path) -> Value {
    let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_slice(&bytes).expect("JSON")
}

#[test]
fn a_fleet_flies_in_a_hurry_and_its_record_says_that_the_limits_held() {
    let folder = planned();
    let output = sortie(folder.path(), &["fly", "lanes.yaml", "--speedup", "20"]);
    let told = text(&output.stdout);
    assert!(output.status.success(), "{told}{}", text(&output.stderr));
    for line in [
        "all are armed: T0",
        "alpha: took off",
        "alpha: landed",
        "bravo: loiters",
    ] {
        assert!(told.contains(line), "{line} in {told}");
    }
    let runs = folder.path().join("out/lanes.runs");
    let flight = json(&runs.join("flight.json"));
    assert_eq!(flight["verdict"], "pass");
    assert_eq!(flight["vehicles"][0]["end"], "landed");
    let separation = flight["margins"].as_array().expect("margins").iter();
    let mut separation = separation.filter(|margin| margin["what"] == "separation");
    let flown = separation.next().expect("one pair")["value"]
        .as_f64()
        .expect("metres");
    assert!((900.0..1200.0).contains(&flown), "{flown}");
    let lines = std::fs::read_to_string(runs.join("flight.jsonl")).expect("the record");
    let fixes = lines
        .lines()
        .filter(|line| line.contains("lat_deg"))
        .count();
    assert!(fixes > 800, "{fixes} positions");
    assert!(!runs.join("links.json").exists());
}

#[test]
fn without_a_plan_or_with_another_spec_nothing_is_started() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("lanes.yaml"), SPEC).expect("written");
    let output = sortie(folder.path(), &["fly", "lanes.yaml"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(text(&output.stderr).contains("sortie plan lanes.yaml"));
    let folder = planned();
    let other = SPEC.replace("min_agl_m: 30", "min_agl_m: 31");
    std::fs::write(folder.path().join("lanes.yaml"), other).expect("written");
    let output = sortie(folder.path(), &["fly", "lanes.yaml"]);
    assert_eq!(output.status.code(), Some(4));
    assert!(text(&output.stderr).contains("another spec"));
}

/// A flight in a process of its own.
struct Flight(Child);

impl Drop for Flight {
    fn drop(&mut self) {
        // Already over is as good.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Waits until the record of the flight has a position of a vehicle this late.
fn wait_for(runs: &Path, vehicle: &str, t_s: f64) {
    #[allow(clippy::disallowed_methods)]
    let began = Instant::now();
    while began.elapsed() < Duration::from_secs(60) {
        let entries = std::fs::read_dir(runs).into_iter().flatten().flatten();
        let records = entries.filter(|e| e.file_name().to_string_lossy().ends_with(".jsonl"));
        for record in records {
            let lines = std::fs::read_to_string(record.path()).unwrap_or_default();
            let is_late = lines.lines().any(|line| {
                let line: Value = serde_json::from_str(line).unwrap_or_default();
                line["vehicle"] == vehicle && line["t_s"].as_f64().is_some_and(|t| t > t_s)
            });
            if is_late {
                return;
            }
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    panic!("{vehicle} was not flown for {t_s} s within a minute");
}

#[test]
fn a_popup_threat_is_flown_around_without_a_stop_and_the_other_is_not_touched() {
    let folder = planned();
    let child = Command::new(cargo_bin("sortie"))
        .current_dir(&folder)
        .args(["fly", "lanes.yaml", "--speedup", "4"])
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("sortie runs");
    let mut flight = Flight(child);
    let runs = folder.path().join("out/lanes.runs");
    wait_for(&runs, "alpha", 35.0);
    let threat = "--threat=36.3002,-84.2465,150";
    let output = sortie(folder.path(), &["replan", "lanes.yaml", threat]);
    let told = text(&output.stdout);
    assert!(output.status.success(), "{told}{}", text(&output.stderr));
    assert!(
        told.contains("on its new path") && told.contains("not touched"),
        "{told}"
    );
    let status = flight.0.wait().expect("it ends");
    assert!(status.success(), "{status}");
    let flown = json(&runs.join("flight.json"));
    assert_eq!(flown["verdict"], "pass", "{flown}");
    let lines = std::fs::read_to_string(runs.join("flight.jsonl")).expect("the record");
    let center = (36.3002_f64, -84.2465_f64);
    let mut nearest = f64::INFINITY;
    let mut slowest = f64::INFINITY;
    for line in lines.lines() {
        let fix: Value = serde_json::from_str(line).expect("JSON");
        let number = |key: &str| fix[key].as_f64();
        let (Some(lat), Some(lon), Some(speed)) =
            (number("lat_deg"), number("lon_deg"), number("speed_mps"))
        else {
            continue;
        };
        if fix["vehicle"] != "alpha" {
            continue;
        }
        let north = (lat - center.0) * 110_960.0;
        let east = (lon - center.1) * 111_320.0 * center.0.to_radians().cos();
        nearest = nearest.min(north.hypot(east));
        if (-84.258..-84.242).contains(&lon) {
            slowest = slowest.min(speed);
        }
    }
    assert!(nearest > 149.0, "{nearest} m from the middle of the threat");
    assert!(slowest > 2.0, "{slowest} m/s on the way");
    let bravo = &flown["vehicles"][1];
    let beside = bravo["cross_track_m"]["worst"].as_f64().expect("metres");
    assert!(beside < 10.0, "{bravo}");
    assert_eq!(
        json(&runs.join("replan.json"))["vehicles"][0]["id"],
        "alpha"
    );
}

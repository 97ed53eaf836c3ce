//! A flight by the real binary that goes on while the test does something else, and its record.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use assert_cmd::cargo::cargo_bin;
use serde_json::Value;

/// Two copters on parallel lanes 1100 m apart, from -84.265 to that longitude.
pub fn lanes(goal_lon: &str) -> String {
    let spec = "
sortie: 1
name: lanes
area: {south_west: {lat: 36.28, lon: -84.30}, north_east: {lat: 36.33, lon: -84.20}, min_agl_m: 30, max_amsl_m: 900}
terrain: {flat: {amsl_m: 400}}
vehicles:
  - {id: alpha, sysid: 1, autopilot: ardupilot, link: sim, speed_mps: 15, climb_mps: 5, descent_mps: 4,
     start: {lat: 36.300, lon: -84.265, agl_m: 40}, goal: {lat: 36.300, lon: GOAL, agl_m: 40}, finish: land}
  - {id: bravo, sysid: 2, autopilot: px4, link: sim, speed_mps: 15, climb_mps: 5, descent_mps: 4,
     start: {lat: 36.310, lon: -84.265, agl_m: 40}, goal: {lat: 36.310, lon: GOAL, agl_m: 40}, finish: loiter}
separation: {distance_m: 100, time_slack_s: 5}
planner: {algorithm: msfoa, seed: 1, evaluations: 1000}
";
    spec.replace("GOAL", goal_lon)
}

/// A document that a command wrote.
pub fn json(path: &Path) -> Value {
    let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_slice(&bytes).expect("JSON")
}

/// A folder with a spec of that name and its plan, and where its records go.
pub fn planned(name: &str, spec: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = format!("{name}.yaml");
    std::fs::write(folder.path().join(&file), spec).expect("written");
    let output = Command::new(cargo_bin("sortie"))
        .current_dir(folder.path())
        .args(["plan", &file])
        .output()
        .expect("sortie runs");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    let runs = folder.path().join(format!("out/{name}.runs"));
    (folder, runs)
}

/// A flight in a process of its own.
pub struct Flight(pub Child);

impl Drop for Flight {
    fn drop(&mut self) {
        // Already over is as good.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Every line of the record that is being written.
pub fn lines(runs: &Path) -> Vec<Value> {
    let entries = std::fs::read_dir(runs).into_iter().flatten().flatten();
    let is_record = |name: &str| name.starts_with("flight-") && name.ends_with(".jsonl");
    let records = entries.filter(|e| is_record(&e.file_name().to_string_lossy()));
    let texts = records.map(|record| std::fs::read_to_string(record.path()).unwrap_or_default());
    let parse = |line: &str| serde_json::from_str(line).ok();
    texts
        .flat_map(|text| text.lines().filter_map(parse).collect::<Vec<Value>>())
        .collect()
}

/// Waits until the record of the flight has a position of a vehicle this late.
pub fn wait_for(runs: &Path, vehicle: &str, t_s: f64) {
    let what = format!("flown for {t_s} s");
    wait_until(runs, vehicle, &what, |line| {
        line["t_s"].as_f64().is_some_and(|t| t > t_s)
    });
}

/// Waits until the record holds a position of a vehicle that is as it should be.
pub fn wait_until(runs: &Path, vehicle: &str, what: &str, is_there: impl Fn(&Value) -> bool) {
    #[allow(clippy::disallowed_methods)]
    let began = Instant::now();
    while began.elapsed() < Duration::from_secs(120) {
        let is_good =
            |line: &Value| line["vehicle"] == vehicle && line["lat_deg"].is_f64() && is_there(line);
        if lines(runs).iter().any(is_good) {
            return;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    panic!("{vehicle} was not {what} within two minutes");
}

pub fn take_off(folder: &Path, spec: &str, speedup: &str) -> Flight {
    begin(folder, &["fly", spec, "--speedup", speedup])
}

/// A command that goes on while the test does.
pub fn begin(folder: &Path, arguments: &[&str]) -> Flight {
    let child = Command::new(cargo_bin("sortie"))
        .current_dir(folder)
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("sortie runs");
    Flight(child)
}

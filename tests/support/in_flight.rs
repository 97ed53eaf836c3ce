//! A flight by the real binary that goes on while the test does something else, and its record.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use assert_cmd::cargo::cargo_bin;
use serde_json::Value;

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
    #[allow(clippy::disallowed_methods)]
    let began = Instant::now();
    while began.elapsed() < Duration::from_secs(120) {
        let is_late = |line: &Value| {
            line["vehicle"] == vehicle
                && line["lat_deg"].is_f64()
                && line["t_s"].as_f64().is_some_and(|t| t > t_s)
        };
        if lines(runs).iter().any(is_late) {
            return;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    panic!("{vehicle} was not flown for {t_s} s within two minutes");
}

pub fn take_off(folder: &Path, spec: &str, speedup: &str) -> Flight {
    let child = Command::new(cargo_bin("sortie"))
        .current_dir(folder)
        .args(["fly", spec, "--speedup", speedup])
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("sortie runs");
    Flight(child)
}

//! From a spec to verified vehicles in one command: `sortie plan --upload`.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::support::command::{sortie, text};

fn missions() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("missions")
}

/// Plans, verifies, writes and uploads to a simulated vehicle, with the binary.
fn on_board(spec: &Path, out: &Path) -> Value {
    let run = std::process::Command::new(assert_cmd::cargo::cargo_bin("sortie"))
        .args(["plan", "--upload", "--json", "--out"])
        .args([out, spec])
        .output()
        .expect("sortie runs");
    let told = String::from_utf8_lossy(&run.stderr);
    assert_eq!(run.status.code(), Some(0), "{}: {told}", spec.display());
    let runs = out.with_extension("runs").join("upload.json");
    let text = fs::read(&runs).unwrap_or_else(|error| panic!("{}: {error}", runs.display()));
    serde_json::from_slice(&text).expect("JSON")
}

/// The commands of a `.waypoints` file, home aside.
fn commands(file: &Path) -> Vec<u16> {
    let text = fs::read_to_string(file).expect("a mission");
    let field = |line: &str| line.split('\t').nth(3).expect("a command").parse();
    let rows = text.lines().skip(2);
    rows.map(|line| field(line).expect("a number")).collect()
}

#[test]
fn a_simulated_vehicle_that_flies_is_not_verified_by_another_one_in_its_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("first");
    on_board(&missions().join("first.yaml"), &out);
    let runs = out.with_extension("runs");
    // As `sortie fly` holds it.
    let lock = fs::File::create(runs.join(".fly.lock")).expect("a lock");
    lock.try_lock().expect("nobody flies");
    let upload = || {
        let run = sortie(folder.path(), &["upload", "first"]);
        (run.status.code(), text(&run.stderr), text(&run.stdout))
    };
    let (code, why, said) = upload();
    assert_eq!(code, Some(5), "{why}{said}");
    let text = "its simulated vehicle belongs to the flight of ";
    assert!(
        why.contains(text) && why.contains("nothing was sent"),
        "{why}"
    );
    assert!(!said.contains("verified"), "{said}");
    drop(lock);
    let (code, why, said) = upload();
    assert_eq!(code, Some(0), "{why}{said}");
}

#[test]
fn every_autopilot_and_airframe_plans_verifies_uploads_and_reads_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let first = fs::read_to_string(missions().join("first.yaml")).expect("a spec");
    let copter = |autopilot: &str| {
        let path = folder.path().join(format!("copter-{autopilot}.yaml"));
        let text = first.replace("autopilot: ardupilot", &format!("autopilot: {autopilot}"));
        fs::write(&path, text).expect("a spec");
        path
    };
    let shipped = |name: &str| missions().join(name).with_extension("yaml");
    for (spec, id, takeoff, end) in [
        (copter("ardupilot"), "alpha", 22, 21),
        (copter("px4"), "alpha", 22, 21),
        (shipped("plane-ardupilot"), "heron", 22, 21),
        (shipped("plane-px4"), "gannet", 22, 21),
        (shipped("vtol-ardupilot"), "osprey", 84, 85),
        (shipped("vtol-px4"), "kestrel", 84, 17),
    ] {
        let out = folder.path().join(spec.file_stem().expect("a name"));
        let upload = on_board(&spec, &out);
        assert!(upload.to_string().contains("verified"), "{upload}");
        let items = commands(&out.join(format!("{id}.waypoints")));
        assert_eq!(items.first(), Some(&takeoff), "{items:?}");
        assert_eq!(items.last(), Some(&end), "{items:?}");
    }
}

/// Two copters, by a grid of starts and one of goals.
const GRIDS: &str = "\
sortie: 1
name: pair
area:
  south_west: {lat: 36.28, lon: -84.30}
  north_east: {lat: 36.32, lon: -84.20}
  min_agl_m: 60
  max_amsl_m: 800
terrain: {flat: {amsl_m: 300}}
fleet:
  start_grid: {south_west: {lat: 36.285, lon: -84.29}, rows: 1, columns: 2, spacing_m: 300}
  goal_grid: {south_west: {lat: 36.285, lon: -84.27}, rows: 1, columns: 2, spacing_m: 300}
  id: d{n:02}
  defaults:
    autopilot: ardupilot
    link: sim
    start: {agl_m: 80}
    goal: {agl_m: 80}
    finish: land
    speed_mps: 12
    max_climb_deg: 15
    max_descent_deg: 10
planner: {evaluations: 500}
";

#[test]
fn vehicles_made_by_grids_are_planned_and_uploaded_like_any() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("pair.yaml"), GRIDS).expect("written");
    let output = sortie(folder.path(), &["plan", "pair.yaml", "--upload"]);
    let said = text(&output.stdout) + &text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert_eq!(said.matches("verified").count(), 2, "{said}");
}

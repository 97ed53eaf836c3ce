//! The command as a user meets it: exit codes, messages, and what is left on disk.

use crate::support::command;
use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use assert_cmd::cargo::cargo_bin;
use command::{sortie, text};
use serde_json::Value;
use tempfile::TempDir;

/// A spec that plans in no time: one copter, 2.3 km over flat ground.
const SPEC: &str = "\
sortie: 1
name: hop
area:
  south_west: {lat: 36.28, lon: -84.30}
  north_east: {lat: 36.32, lon: -84.20}
  min_agl_m: 60
  max_amsl_m: 800
terrain: {flat: {amsl_m: 300}}
threats:
  - {id: radar, kind: radar, lat: 36.300, lon: -84.250, radius_m: 200}
vehicles:
  - id: alpha
    sysid: 1
    autopilot: ardupilot
    airframe: copter
    link: sim
    start: {lat: 36.30, lon: -84.265, agl_m: 80}
    goal: {lat: 36.30, lon: -84.235, agl_m: 80}
    finish: land
    speed_mps: 12
    max_load_factor: 1.2
    max_climb_deg: 15
    max_descent_deg: 10
    climb_mps: 3
separation: {distance_m: 100, time_slack_s: 5}
planner: {seed: 1, evaluations: 2000}
mission: {altitude: amsl, tolerance_m: 5, max_items: 200, fence: true}
";

fn folder_with(spec: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("hop.yaml"), spec).expect("the spec is written");
    folder
}

/// Runs `plan` on a changed spec, and asserts the exit code, the words of the
/// message, and that nothing was written.
fn plan_is_refused(from: &str, to: &str, code: i32, words: &[&str]) {
    assert!(SPEC.contains(from), "{from:?} is not in the spec");
    let folder = folder_with(&SPEC.replace(from, to));
    let output = sortie(folder.path(), &["plan", "hop.yaml"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{message}");
    for word in words {
        assert!(message.contains(word), "{word:?} is not in: {message}");
    }
    assert!(!message.contains("panicked"), "{message}");
    assert!(!folder.path().join("out").exists(), "something was written");
}

#[test]
fn a_plan_leaves_every_file_and_says_that_it_passes() {
    let folder = folder_with(SPEC);
    let output = sortie(folder.path(), &["plan", "hop.yaml"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("alpha"));
    let out = folder.path().join("out/hop");
    for name in [
        "spec.yaml",
        "plan.json",
        "review.json",
        "review.html",
        "fleet.kml",
        "fleet.geojson",
        "timing.json",
        "alpha.waypoints",
        "alpha.plan",
        "alpha.params",
    ] {
        assert!(out.join(name).is_file(), "{name} is missing");
    }
    assert_eq!(fs::read_to_string(out.join("spec.yaml")).unwrap(), SPEC);
    let plan: Value = serde_json::from_slice(&fs::read(out.join("plan.json")).unwrap()).unwrap();
    assert_eq!(plan["verdict"], "pass");
    let cost = plan["vehicles"][0]["cost"].as_object().unwrap();
    let sum: f64 = cost
        .iter()
        .filter(|(key, _)| *key != "total")
        .map(|(_, v)| v.as_f64().unwrap())
        .sum();
    assert!(
        (sum - cost["total"].as_f64().unwrap()).abs() < 1e-6,
        "the terms do not sum to the total"
    );
    let review: Value =
        serde_json::from_slice(&fs::read(out.join("review.json")).unwrap()).unwrap();
    assert_eq!(review["verdict"], "pass");
}

#[test]
fn json_is_one_document_on_stdout() {
    let folder = folder_with(SPEC);
    let output = sortie(
        folder.path(),
        &["plan", "hop.yaml", "--json", "--seed", "7"],
    );
    let document: Value = serde_json::from_slice(&output.stdout).expect("one JSON document");
    assert_eq!(document["seed"], 7);
    assert_eq!(document["verdict"], "pass");
    let params = fs::read_dir(folder.path().join("out/hop")).expect("written");
    let mut params = params.map(|file| file.expect("a file").path());
    let params = params.find(|path| path.extension().is_some_and(|of| of == "params"));
    let params = fs::read_to_string(params.expect("parameters")).expect("text");
    assert!(params.starts_with("# What the verdict on this mission (seed 7) assumes"));
}

#[test]
fn upload_verifies_transfers_and_reads_back() {
    let folder = folder_with(SPEC);
    assert_eq!(
        sortie(folder.path(), &["plan", "hop.yaml"]).status.code(),
        Some(0)
    );
    let output = sortie(folder.path(), &["upload", "out/hop"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(
        text(&output.stdout).contains("verified"),
        "{}",
        text(&output.stdout)
    );
    let record: Value =
        serde_json::from_slice(&fs::read(folder.path().join("out/hop.runs/upload.json")).unwrap())
            .unwrap();
    assert_eq!(record["vehicles"][0]["verdict"], "verified");
}

#[test]
fn a_dry_run_sends_nothing() {
    let folder = folder_with(&SPEC.replace("link: sim", "link: 'udpout:127.0.0.1:9'"));
    assert_eq!(
        sortie(folder.path(), &["plan", "hop.yaml"]).status.code(),
        Some(0)
    );
    let output = sortie(folder.path(), &["upload", "out/hop", "--dry-run"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(!folder.path().join("out/hop.runs").exists());
}

#[test]
fn nobody_at_the_link_is_a_failed_transfer() {
    let folder = folder_with(&SPEC.replace("link: sim", "link: 'udpout:127.0.0.1:9'"));
    assert_eq!(
        sortie(folder.path(), &["plan", "hop.yaml"]).status.code(),
        Some(0)
    );
    let output = sortie(folder.path(), &["upload", "out/hop"]);
    assert_eq!(output.status.code(), Some(5), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("alpha"));
    let record: Value =
        serde_json::from_slice(&fs::read(folder.path().join("out/hop.runs/upload.json")).unwrap())
            .unwrap();
    assert_eq!(record["vehicles"][0]["verdict"], "failed");
}

#[test]
fn an_edited_mission_is_not_uploaded() {
    let folder = folder_with(SPEC);
    assert_eq!(
        sortie(folder.path(), &["plan", "hop.yaml"]).status.code(),
        Some(0)
    );
    let path = folder.path().join("out/hop/alpha.plan");
    let mut plan: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    let items = plan["mission"]["items"].as_array_mut().unwrap();
    let waypoint = items
        .iter_mut()
        .rfind(|item| item["command"] == 16)
        .unwrap();
    waypoint["params"][6] = Value::from(10.0);
    fs::write(&path, serde_json::to_vec(&plan).unwrap()).unwrap();
    let output = sortie(folder.path(), &["upload", "out/hop"]);
    assert_eq!(output.status.code(), Some(4), "{}", text(&output.stdout));
    assert!(
        !folder.path().join("out/hop.runs").exists(),
        "something was sent"
    );
}

#[test]
fn a_folder_that_was_edited_is_not_uploaded() {
    let folder = folder_with(SPEC);
    let plan = || {
        assert_eq!(
            sortie(folder.path(), &["plan", "hop.yaml"]).status.code(),
            Some(0)
        )
    };
    let edit = |name: &str, from: &str, to: &str| {
        let path = folder.path().join("out/hop").join(name);
        let before = fs::read_to_string(&path).unwrap();
        assert!(before.contains(from), "{from:?} is not in {name}");
        fs::write(path, before.replacen(from, to, 1)).unwrap();
        let output = sortie(folder.path(), &["upload", "out/hop"]);
        assert_eq!(
            output.status.code(),
            Some(4),
            "{name}: {}",
            text(&output.stderr)
        );
        assert!(
            text(&output.stderr).contains(name),
            "{}",
            text(&output.stderr)
        );
    };
    plan();
    let review = || sortie(folder.path(), &["review", "out/hop"]);
    assert_eq!(review().status.code(), Some(0));
    edit("alpha.waypoints", "36.3000000", "36.3000001");
    // Which of the two would be flown nobody knows, with the spec or without it.
    for _ in 0..2 {
        let said = review();
        assert_eq!(said.status.code(), Some(4), "{}", text(&said.stdout));
        let why = "alpha.waypoints disagree: name the one to review";
        assert!(text(&said.stderr).contains(why), "{}", text(&said.stderr));
        let _ = fs::remove_file(folder.path().join("out/hop/spec.yaml"));
    }
    fs::remove_dir_all(folder.path().join("out")).unwrap();
    plan();
    edit("spec.yaml", "radius_m: 200", "radius_m: 100");
    assert!(
        !folder.path().join("out/hop.runs").exists(),
        "something was sent"
    );
}

#[test]
fn a_rejected_file_needs_force_under_every_command() {
    let folder = folder_with(SPEC);
    assert_eq!(
        sortie(folder.path(), &["plan", "hop.yaml"]).status.code(),
        Some(0)
    );
    fs::copy(
        folder.path().join("out/hop/alpha.plan"),
        folder.path().join("alpha.REJECTED.plan"),
    )
    .unwrap();
    let arguments = ["upload", "--spec", "hop.yaml", "alpha.REJECTED.plan"];
    let output = sortie(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(4), "{}", text(&output.stderr));
    let forced = sortie(folder.path(), &[&arguments[..], &["--force"]].concat());
    assert_eq!(forced.status.code(), Some(0), "{}", text(&forced.stderr));
}

#[test]
fn a_refused_upload_is_still_one_json_document() {
    let folder = folder_with(SPEC);
    assert_eq!(
        sortie(folder.path(), &["plan", "hop.yaml"]).status.code(),
        Some(0)
    );
    let spec = SPEC.replace("radius_m: 200", "radius_m: 700");
    fs::write(folder.path().join("wider.yaml"), spec).unwrap();
    let output = sortie(
        folder.path(),
        &[
            "upload",
            "--json",
            "--spec",
            "wider.yaml",
            "out/hop/alpha.plan",
        ],
    );
    assert_eq!(output.status.code(), Some(4), "{}", text(&output.stderr));
    let document: Value = serde_json::from_slice(&output.stdout).expect("one JSON document");
    assert_eq!(document["verdict"], "refused");
}

#[test]
fn a_result_that_cannot_be_printed_is_exit_1() {
    let folder = folder_with(SPEC);
    let full = fs::OpenOptions::new()
        .write(true)
        .open("/dev/full")
        .expect("a device that is full");
    let status = Command::new(cargo_bin("sortie"))
        .current_dir(folder.path())
        .arg("schema")
        .stdout(full)
        .status()
        .unwrap();
    assert_eq!(status.code(), Some(1));
}

#[test]
fn a_page_never_replaces_what_is_no_page() {
    let folder = folder_with(SPEC);
    assert_eq!(
        sortie(folder.path(), &["plan", "hop.yaml"]).status.code(),
        Some(0)
    );
    let page = |name: &str| {
        sortie(
            folder.path(),
            &["review", "hop.yaml", "out/hop/alpha.plan", "--html", name],
        )
        .status
        .code()
    };
    assert_eq!(page("hop.yaml"), Some(2));
    assert_eq!(
        fs::read_to_string(folder.path().join("hop.yaml")).unwrap(),
        SPEC
    );
    assert_eq!(page("page.html"), Some(0));
    assert!(folder.path().join("page.html").is_file());
}

#[test]
fn a_file_that_no_plan_wrote_keeps_its_folder_from_being_replaced() {
    let folder = folder_with(SPEC);
    let plan = || sortie(folder.path(), &["plan", "hop.yaml"]);
    assert_eq!(plan().status.code(), Some(0));
    assert_eq!(plan().status.code(), Some(0), "an earlier plan is replaced");
    fs::write(
        folder.path().join("out/hop/notes.txt"),
        "wind from the west",
    )
    .unwrap();
    let output = plan();
    assert_eq!(output.status.code(), Some(1));
    assert!(
        text(&output.stderr).contains("notes.txt"),
        "{}",
        text(&output.stderr)
    );
    assert!(folder.path().join("out/hop/notes.txt").exists());
}

#[test]
fn an_output_folder_that_cannot_be_written_is_refused_before_planning() {
    // Planning this takes minutes: the answer must not wait for it.
    let slow = SPEC.replace("evaluations: 2000", "evaluations: 100000000");
    let folder = folder_with(&slow);
    let root = folder.path();
    fs::write(root.join("notes.txt"), "wind from the west").unwrap();
    fs::create_dir(root.join("thesis")).unwrap();
    fs::write(root.join("thesis/thesis.tex"), "").unwrap();
    for (out, why) in [
        ("notes.txt", "a file of this name is in the way"),
        ("notes.txt/a/b", "notes.txt is no folder"),
        ("thesis", "is not replaced"),
        // Linux lets nobody make folders there, not even root.
        ("/proc/sortie", "/proc"),
    ] {
        let mut program = Command::new(cargo_bin("sortie"));
        let program = program.current_dir(root).stderr(Stdio::piped());
        let mut child = program
            .args(["plan", "hop.yaml", "--out", out])
            .spawn()
            .unwrap();
        let is_running = |child: &mut std::process::Child| child.try_wait().unwrap().is_none();
        let mut turns = 0..1000;
        while is_running(&mut child) && turns.next().is_some() {
            std::thread::sleep(std::time::Duration::from_millis(20));
        }
        let _ = child.kill();
        let output = child.wait_with_output().unwrap();
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{out}: {message}");
        assert!(message.contains(why), "{out}: {message}");
    }
    let names = fs::read_dir(root).unwrap().count();
    assert_eq!(names, 3, "something was written");
}

#[test]
fn a_review_prints_the_warnings_that_its_json_holds() {
    let folder = folder_with(&SPEC.replace("speed_mps: 12", "speed_mps: 14"));
    assert_eq!(
        sortie(folder.path(), &["plan", "hop.yaml"]).status.code(),
        Some(0)
    );
    let arguments = ["review", "hop.yaml", "out/hop/alpha.plan"];
    let reviewed = sortie(folder.path(), &arguments);
    let warning = "alpha: 14.0 m/s through the air is faster than";
    let json = sortie(folder.path(), &[&arguments[..], &["--json"]].concat());
    assert!(
        text(&json.stdout).contains(warning),
        "{}",
        text(&json.stdout)
    );
    let errors = text(&reviewed.stderr);
    assert!(errors.contains(&format!("warning: {warning}")), "{errors}");
}

#[test]
fn review_of_the_files_alone_reaches_the_same_verdict() {
    let folder = folder_with(SPEC);
    assert_eq!(
        sortie(folder.path(), &["plan", "hop.yaml"]).status.code(),
        Some(0)
    );
    for file in ["out/hop/alpha.waypoints", "out/hop/alpha.plan"] {
        let output = sortie(folder.path(), &["review", "hop.yaml", file]);
        assert_eq!(
            output.status.code(),
            Some(0),
            "{file}: {}{}",
            text(&output.stdout),
            text(&output.stderr)
        );
    }
}

#[test]
fn a_missing_spec_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let output = sortie(folder.path(), &["plan", "nowhere.yaml"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(text(&output.stderr).contains("nowhere.yaml"));
}

#[test]
fn broken_yaml_is_refused_with_its_line() {
    plan_is_refused(
        "terrain: {flat: {amsl_m: 300}}",
        "terrain: {flat: {amsl_m: 300",
        3,
        &["hop.yaml:"],
    );
}

#[test]
fn an_unknown_key_is_refused_with_its_place() {
    plan_is_refused(
        "    speed_mps: 12",
        "    spede_mps: 12",
        3,
        &["hop.yaml:20:5", "spede_mps"],
    );
}

#[test]
fn a_latitude_of_123_is_refused() {
    plan_is_refused(
        "lat: 36.30, lon: -84.265",
        "lat: 123, lon: -84.265",
        3,
        &["hop.yaml:17:18", "start.lat", "123"],
    );
}

#[test]
fn a_start_in_a_threat_is_refused() {
    plan_is_refused(
        "lat: 36.30, lon: -84.265",
        "lat: 36.30, lon: -84.2505",
        3,
        &["start", "radar"],
    );
}

#[test]
fn a_start_under_ground_is_refused() {
    plan_is_refused(
        "lon: -84.265, agl_m: 80",
        "lon: -84.265, amsl_m: 250",
        3,
        &["start", "250"],
    );
}

#[test]
fn a_goal_outside_the_area_is_refused() {
    plan_is_refused(
        "lat: 36.30, lon: -84.235",
        "lat: 36.40, lon: -84.235",
        3,
        &["goal", "area"],
    );
}

#[test]
fn two_vehicles_with_one_sysid_are_refused() {
    let start = SPEC.find("  - id: alpha").unwrap();
    let end = SPEC.find("separation:").unwrap();
    let second = SPEC[start..end]
        .replace("alpha", "bravo")
        .replace("36.30,", "36.31,");
    plan_is_refused(
        "separation:",
        &format!("{second}separation:"),
        3,
        &["vehicles[1].sysid", "alpha"],
    );
}

#[test]
fn void_terrain_is_refused() {
    let folder = folder_with(&SPEC.replace("flat: {amsl_m: 300}", "file: N36W085.hgt"));
    let void = i16::MIN.to_be_bytes().repeat(1201 * 1201);
    fs::write(folder.path().join("N36W085.hgt"), void).unwrap();
    let output = sortie(folder.path(), &["plan", "hop.yaml"]);
    assert_eq!(output.status.code(), Some(3), "{}", text(&output.stderr));
    assert!(
        text(&output.stderr).contains("elevation"),
        "{}",
        text(&output.stderr)
    );
    assert!(!folder.path().join("out").exists());
}

#[test]
fn an_unreachable_goal_is_a_verdict_and_its_files_are_named_rejected() {
    // A wall of threats from edge to edge.
    let wall: String = (0..12)
        .map(|i| {
            format!(
                "  - {{id: wall-{i}, kind: sam, lat: {:.4}, lon: -84.250, radius_m: 600}}\n",
                36.278 + 0.004 * f64::from(i)
            )
        })
        .collect();
    let folder = folder_with(&SPEC.replace("vehicles:\n", &format!("{wall}vehicles:\n")));
    let output = sortie(folder.path(), &["plan", "hop.yaml", "--upload"]);
    assert_eq!(output.status.code(), Some(4), "{}", text(&output.stderr));
    assert!(
        text(&output.stdout).contains("wall-"),
        "{}",
        text(&output.stdout)
    );
    let out = folder.path().join("out/hop");
    assert!(out.join("alpha.REJECTED.waypoints").exists() && !out.join("alpha.waypoints").exists());
    assert!(
        !folder.path().join("out/hop.runs").exists(),
        "something was sent"
    );
    let upload = sortie(folder.path(), &["upload", "out/hop"]);
    assert_eq!(upload.status.code(), Some(4), "{}", text(&upload.stderr));
}

#[test]
fn an_output_that_cannot_be_written_is_exit_1() {
    let folder = folder_with(SPEC);
    let output = sortie(
        folder.path(),
        &["plan", "hop.yaml", "--out", "hop.yaml/out"],
    );
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("cannot write"));
}

#[test]
fn a_full_disk_leaves_no_half_written_folder() {
    let folder = folder_with(SPEC);
    // No file may grow beyond 16 blocks: the review page does not fit.
    let script = format!(
        "trap '' XFSZ; ulimit -f 16; exec {} plan hop.yaml",
        cargo_bin("sortie").display()
    );
    let output = Command::new("sh")
        .current_dir(folder.path())
        .args(["-c", &script])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert!(
        text(&output.stderr).contains("cannot write"),
        "{}",
        text(&output.stderr)
    );
    let left: Vec<_> = fs::read_dir(folder.path().join("out")).unwrap().collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn a_folder_of_something_else_is_not_replaced() {
    let folder = folder_with(SPEC);
    let output = sortie(folder.path(), &["plan", "hop.yaml", "--out", "."]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert!(folder.path().join("hop.yaml").exists());
}

#[test]
fn wrong_usage_is_exit_2() {
    let folder = folder_with(SPEC);
    for arguments in [
        &["plan"][..],
        &["fly-away"],
        &["review", "hop.yaml", "--vehicle", "alpha"],
    ] {
        let output = sortie(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
        let output = sortie(folder.path(), &[arguments, &["--json"]].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let document: Value = serde_json::from_slice(&output.stdout).expect("one JSON document");
        assert_eq!(document["verdict"], "fail");
        let found = document["issues"][0]["found"].as_str().expect("words");
        assert!(!found.is_empty() && !found.contains('\n'), "{found}");
    }
}

#[test]
fn help_and_schema_are_printed() {
    let folder = tempfile::tempdir().unwrap();
    let help = sortie(folder.path(), &["--help"]);
    assert_eq!(help.status.code(), Some(0));
    assert!(text(&help.stdout).contains("Exit codes"));
    let schema: Value =
        serde_json::from_slice(&sortie(folder.path(), &["schema"]).stdout).expect("JSON");
    assert!(
        schema["$schema"]
            .as_str()
            .is_some_and(|s| s.contains("2020-12"))
    );
}

#[test]
fn hills_narrower_than_the_grid_of_the_search_are_planned_around_or_over() {
    let hills = |count: u32, lat: f64| -> String {
        let hill = |index: u32| {
            let lat = lat + f64::from(index) * 1e-5;
            format!("      - {{lat: {lat:.5}, lon: -84.25, height_m: 100, radius_m: 1}}\n")
        };
        (0..count).map(hill).collect()
    };
    let flat = "terrain: {flat: {amsl_m: 300}}\n";
    assert!(SPEC.contains(flat));
    for (count, lat) in [(1, 36.30), (1600, 36.305)] {
        let ground = "terrain:\n  analytic:\n    base_amsl_m: 300\n    hills:\n".to_owned();
        let folder = folder_with(&SPEC.replace(flat, &(ground + &hills(count, lat))));
        let output = sortie(folder.path(), &["plan", "hop.yaml"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
}

/// A pipe that nobody writes to would be waited for without end.
#[cfg(unix)]
#[test]
fn a_pipe_in_the_place_of_a_file_is_refused_at_once() {
    let folder = folder_with(SPEC);
    let pipes = ["p.yaml", "p.plan", "p.waypoints", "p.jsonl", "p.tlog"];
    let made = Command::new("mkfifo")
        .current_dir(folder.path())
        .args(pipes)
        .status();
    assert!(made.expect("mkfifo").success());
    for arguments in [
        &["check", "p.yaml"][..],
        &["plan", "p.yaml"],
        &["review", "p.yaml"],
        &["review", "hop.yaml", "p.plan"],
        &["review", "p.waypoints"],
        &["review", "hop.yaml", "p.jsonl"],
        &["convert", "p.plan", "x.waypoints"],
        &["fly", "p.yaml"],
    ] {
        let output = Command::new("timeout")
            .arg("20")
            .arg(cargo_bin("sortie"))
            .current_dir(folder.path())
            .args(arguments)
            .output()
            .expect("it runs");
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{arguments:?} {message}");
        assert!(message.contains("it is a pipe"), "{arguments:?} {message}");
    }
}

#[test]
fn a_plan_within_some_time_is_made_again_from_the_evaluations_that_it_prints() {
    let folder = folder_with(SPEC);
    let within = sortie(
        folder.path(),
        &["plan", "hop.yaml", "--within", "0.5", "--out", "a"],
    );
    let said = text(&within.stderr);
    assert_eq!(within.status.code(), Some(0), "{said}");
    let flag = said.split("`--evaluations ").nth(1).expect("evaluations");
    let evaluations = flag.split('`').next().expect("a number");
    let again = [
        "plan",
        "hop.yaml",
        "--evaluations",
        evaluations,
        "--out",
        "b",
    ];
    let again = sortie(folder.path(), &again);
    assert_eq!(again.status.code(), Some(0), "{}", text(&again.stderr));
    for name in ["plan.json", "review.json", "alpha.waypoints", "review.html"] {
        let read = |run: &str| fs::read(folder.path().join(run).join(name)).expect("a file");
        assert!(read("a") == read("b"), "{name}");
    }
}

#[test]
fn an_interrupt_within_the_time_of_a_plan_takes_the_best_so_far() {
    let folder = folder_with(SPEC);
    let mut process = Command::new(cargo_bin("sortie"))
        .current_dir(folder.path())
        .args(["plan", "hop.yaml", "--within", "600", "--out", "a"])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("sortie runs");
    let lines = BufReader::new(process.stderr.take().expect("piped")).lines();
    let mut lines = lines.map_while(Result::ok);
    let shown = lines.find(|line| line.contains("Ctrl-C takes the best"));
    assert!(shown.is_some(), "it says that there is a plan");
    let interrupt = Command::new("kill")
        .args(["-INT", &process.id().to_string()])
        .status();
    assert!(interrupt.expect("kill runs").success());
    let said = lines.last().expect("the evaluations of the best");
    assert!(said.contains("gives the same plan"), "{said}");
    assert_eq!(process.wait().expect("it ends").code(), Some(0));
    assert!(folder.path().join("a/plan.json").exists());
}

#[test]
fn a_time_to_plan_for_that_is_none_is_wrong_usage() {
    let folder = folder_with(SPEC);
    for seconds in ["nan", "-1", "inf", "1e9"] {
        let refused = sortie(folder.path(), &["plan", "hop.yaml", "--within", seconds]);
        let message = text(&refused.stderr);
        assert_eq!(refused.status.code(), Some(2), "{seconds}: {message}");
        assert!(message.contains("from 0 to 3e7"), "{seconds}: {message}");
    }
}

#[test]
fn review_writes_the_trajectories_that_it_judges() {
    let folder = folder_with(SPEC);
    let out = sortie(folder.path(), &["plan", "hop.yaml"]);
    assert!(out.status.success(), "{}", text(&out.stderr));
    let judged = sortie(
        folder.path(),
        &["review", "out/hop", "--trajectories", "t.json", "--json"],
    );
    assert!(judged.status.success(), "{}", text(&judged.stderr));
    let review: Value = serde_json::from_slice(&judged.stdout).expect("JSON");
    let written = fs::read(folder.path().join("t.json")).expect("it is written");
    let document: Value = serde_json::from_slice(&written).expect("JSON");
    let vehicle = &document["vehicles"][0];
    assert_eq!(vehicle["takeoff_late_s"], 12.0);
    let segments = vehicle["segments"].as_array().expect("segments");
    let is_flown = |segment: &&Value| segment["flown"] == true;
    let flown: Vec<&Value> = segments.iter().filter(is_flown).collect();
    // In one piece from the ground at home to the ground at the goal.
    assert_eq!(flown[0]["from"]["t_s"], 0.0);
    for pair in flown.windows(2) {
        assert_eq!(pair[0]["to"]["t_s"], pair[1]["from"]["t_s"]);
        assert_eq!(pair[0]["to"]["lat_deg"], pair[1]["from"]["lat_deg"]);
    }
    let end = &flown[flown.len() - 1]["to"];
    assert_eq!(
        (&flown[0]["from"]["amsl_m"], &end["amsl_m"]),
        (&300.0.into(), &300.0.into())
    );
    // The lowest place on the way is what the table says.
    let margins = review["margins"].as_array().expect("margins");
    let finish = margins
        .iter()
        .find(|margin| margin["what"] == "ground contact")
        .expect("it lands");
    let last_item = segments.iter().map(|segment| &segment["to"]["item"]);
    assert_eq!(
        last_item.max_by_key(|item| item.as_u64()),
        Some(&finish["at"]["item"])
    );
    let refused = sortie(
        folder.path(),
        &["review", "out/hop", "--trajectories", "t.plan"],
    );
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("the name of a document ends in .json"));
}

#[test]
fn a_landing_where_another_vehicle_stands_is_warned_of() {
    let other = "  - id: bravo
    sysid: 2
    autopilot: px4
    link: sim
    start: {lat: 36.31, lon: -84.265, agl_m: 80}
    goal: {lat: 36.30, lon: -84.235, agl_m: 80}
    depart_s: 600
    finish: land
    speed_mps: 12
    max_climb_deg: 15
    max_descent_deg: 10
";
    let spec = SPEC.replace("separation:", &format!("{other}separation:"));
    let folder = folder_with(&spec);
    let output = sortie(folder.path(), &["plan", "hop.yaml"]);
    let said = text(&output.stdout) + &text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(
        said.contains("warning: bravo lands 0.0 m from where alpha stands from T0+"),
        "{said}"
    );
    let review = fs::read_to_string(folder.path().join("out/hop/review.html")).expect("a page");
    assert!(review.contains("bravo lands 0.0 m from where alpha stands"));
}

#[test]
fn an_upload_says_which_versions_of_px4_fly_other_altitudes_unless_the_spec_names_one() {
    let spec = SPEC.replace("autopilot: ardupilot", "autopilot: px4");
    for (named, says) in [("", true), ("    autopilot_version: \"1.18\"\n", false)] {
        let spec = spec.replace("    link: sim\n", &format!("    link: sim\n{named}"));
        let folder = folder_with(&spec);
        let plan = sortie(folder.path(), &["plan", "hop.yaml"]);
        assert_eq!(plan.status.code(), Some(0), "{}", text(&plan.stdout));
        for arguments in [
            &["upload", "out/hop", "--dry-run"][..],
            &["plan", "hop.yaml", "--upload"],
        ] {
            let output = sortie(folder.path(), arguments);
            let said = text(&output.stderr);
            let warning =
                "warning: alpha: PX4 1.18 and later climbs and descends at the start of each leg";
            assert_eq!(said.contains(warning), says, "{said}");
        }
    }
}

#[test]
fn an_airspeed_outside_of_the_default_limits_of_an_autopilot_is_warned_of() {
    let plane = fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/missions/vtol-ardupilot.yaml"
    ))
    .expect("a mission");
    let terrain = concat!(env!("CARGO_MANIFEST_DIR"), "/missions/terrain");
    let folder = folder_with(&plane.replace("speed_mps: 18", "speed_mps: 8"));
    std::os::unix::fs::symlink(terrain, folder.path().join("terrain")).expect("a link");
    let output = sortie(folder.path(), &["check", "hop.yaml"]);
    let said = text(&output.stderr);
    assert!(
        said.contains(
            "8 m/s is planned, and ArduPilot flies no slower than AIRSPEED_MIN, by default 9 m/s"
        ),
        "{said}"
    );
}

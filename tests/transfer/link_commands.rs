//! `sortie vehicles`, `sortie download` and captures, as their user meets them.

use crate::support::{command, ports};
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use assert_cmd::cargo::cargo_bin;
use command::{sortie, text};
use tempfile::TempDir;

/// Two copters 2 km apart over flat ground, one of each autopilot.
const SPEC: &str = "\
sortie: 1
name: pair
area:
  south_west: {lat: 36.28, lon: -84.30}
  north_east: {lat: 36.32, lon: -84.20}
  min_agl_m: 60
  max_amsl_m: 800
terrain: {flat: {amsl_m: 300}}
rally:
  - {lat: 36.31, lon: -84.25, agl_m: 80}
vehicles:
  - id: alpha
    sysid: 1
    autopilot: ardupilot
    link: sim
    start: {lat: 36.29, lon: -84.265, agl_m: 80}
    goal: {lat: 36.29, lon: -84.235, agl_m: 80}
    finish: land
    speed_mps: 12
    max_climb_deg: 15
    max_descent_deg: 10
  - id: bravo
    sysid: 2
    autopilot: px4
    link: sim
    start: {lat: 36.31, lon: -84.265, agl_m: 80}
    goal: {lat: 36.31, lon: -84.235, agl_m: 80}
    finish: land
    speed_mps: 12
    max_climb_deg: 15
    max_descent_deg: 10
planner: {seed: 1, evaluations: 2000}
";

/// `sortie vehicles` and the links it printed; it ends when this is dropped.
struct Fleet {
    process: Child,
    links: Vec<String>,
}

impl Fleet {
    fn start(folder: &Path, vehicles: usize, arguments: &[&str]) -> Self {
        let mut process = Command::new(cargo_bin("sortie"))
            .current_dir(folder)
            .args(["vehicles", "pair.yaml", "--port", "0", "--for", "60"])
            .args(arguments)
            .stdout(Stdio::piped())
            .spawn()
            .expect("sortie runs");
        let lines = BufReader::new(process.stdout.take().expect("piped")).lines();
        let links = lines
            .map_while(Result::ok)
            .filter_map(|line| line.split_whitespace().last().map(str::to_owned))
            .filter(|word| word.starts_with("udp"))
            .take(vehicles)
            .collect();
        Self { process, links }
    }
}

impl Drop for Fleet {
    fn drop(&mut self) {
        // Already gone is as good.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

fn planned() -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("pair.yaml"), SPEC).expect("the spec is written");
    let output = sortie(folder.path(), &["plan", "pair.yaml", "--out", "out"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    folder
}

#[test]
fn what_is_uploaded_over_a_bad_link_is_what_is_downloaded() {
    let folder = planned();
    let folder = folder.path();
    let bad = ["--loss", "3", "--delay", "2", "--seed", "3"];
    let fleet = Fleet::start(folder, 2, &bad);
    let [alpha, bravo] = &fleet.links[..] else {
        panic!("two vehicles: {:?}", fleet.links);
    };
    let links = [format!("alpha={alpha}"), format!("bravo={bravo}")];
    let upload = [
        "upload", "out", "--link", &links[0], "--link", &links[1], "--tlog", "all.tlog",
    ];
    let output = sortie(folder, &upload);
    assert!(output.status.success(), "{}", text(&output.stderr));

    for (id, link, sysid) in [("alpha", alpha, "1"), ("bravo", bravo, "2")] {
        for ending in ["plan", "waypoints"] {
            let name = format!("{id}.{ending}");
            let download = ["download", "--link", link, "--sysid", sysid, "-o", &name];
            let output = sortie(folder, &download);
            let (told, notes) = (text(&output.stdout), text(&output.stderr));
            assert!(output.status.success(), "{told}{notes}");
            assert!(told.starts_with(&format!("system {sysid} (")), "{told}");
            assert_eq!(
                notes.contains("the fence ("),
                ending == "waypoints",
                "{notes}"
            );
            assert_eq!(notes.contains("1 rally point is"), ending == "waypoints");
        }
        // What came down is flown like what went up: the verdict is the same.
        let file = format!("{id}.plan");
        let sent = format!("out/{id}.plan");
        let verdict = |file: &str| {
            let vehicle = format!("{id}={file}");
            let arguments = ["review", "pair.yaml", "--vehicle", &vehicle, "--json"];
            let output = sortie(folder, &arguments);
            let review: serde_json::Value =
                serde_json::from_slice(&output.stdout).expect("a review");
            let margins = review["margins"].as_array().expect("margins").iter();
            margins
                .map(|margin| (margin["what"].to_string(), margin["ok"] == true))
                .collect::<Vec<_>>()
        };
        let down = verdict(&file);
        assert!(down.len() > 5 && down == verdict(&sent), "{id}: {down:?}");
    }
    is_a_capture(&fs::read(folder.join("all.tlog")).expect("a capture"));
}

/// Frames of both sides, each behind its time.
fn is_a_capture(bytes: &[u8]) {
    let mut rest = bytes;
    let mut senders = Vec::new();
    let mut before = 0;
    while let Some((stamp, frame)) = rest.split_at_checked(8) {
        let us = u64::from_be_bytes(stamp.try_into().expect("eight bytes"));
        assert!(us >= before, "time goes on");
        before = us;
        assert_eq!(frame[0], 0xfd, "MAVLink 2");
        senders.push(frame[5]);
        rest = &frame[12 + usize::from(frame[1])..];
    }
    assert!(rest.is_empty(), "whole frames");
    for sender in [1, 2, 245] {
        assert!(senders.contains(&sender), "system {sender}");
    }
}

#[test]
fn a_vehicle_far_from_the_home_of_its_mission_is_warned_of() {
    let folder = planned();
    let folder = folder.path();
    let elsewhere = tempfile::tempdir().expect("a temporary folder");
    let moved = SPEC.replace("lat: 36.29, lon: -84.265", "lat: 36.30, lon: -84.265");
    assert_ne!(moved, SPEC);
    fs::write(elsewhere.path().join("pair.yaml"), moved).expect("the spec is written");
    let fleet = Fleet::start(elsewhere.path(), 2, &[]);
    let links: Vec<String> = (["alpha", "bravo"].iter().zip(&fleet.links))
        .map(|(id, link)| format!("{id}={link}"))
        .collect();
    let upload = ["upload", "out", "--link", &links[0], "--link", &links[1]];
    let output = sortie(folder, &upload);
    let warnings = text(&output.stderr);
    assert!(output.status.success(), "{warnings}");
    let expected = "warning: alpha stands 1.1 km from the home of its mission: fly refuses that (allowed: 15 m)";
    assert!(warnings.contains(expected), "{warnings}");
    assert!(!warnings.contains("bravo stands"), "{warnings}");
    let record = fs::read(folder.join("out.runs/upload.json")).expect("the record");
    let record: serde_json::Value = serde_json::from_slice(&record).expect("JSON");
    let away_m = |n: usize| record["vehicles"][n]["from_home_m"].as_f64();
    // A hundredth of a degree of latitude.
    assert!(away_m(0).is_some_and(|away_m| (1105.0..1115.0).contains(&away_m)));
    assert!(away_m(1).is_some_and(|away_m| away_m < 1.0));
}

#[test]
fn several_vehicles_on_a_link_must_be_told_apart_and_a_failure_leaves_no_file() {
    let folder = planned();
    let folder = folder.path();
    let port = ports::unshared().to_string();
    let _fleet = Fleet::start(folder, 2, &["--speak-to", &port]);
    let link = format!("udpin:{port}");
    let output = sortie(folder, &["download", "--link", &link, "-o", "x.plan"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(5), "{message}");
    assert!(message.contains("system 1, 2"), "{message}");
    assert!(!folder.join("x.plan").exists());

    let named = ["download", "--link", &link, "--sysid", "2", "-o", "x.plan"];
    let output = sortie(folder, &named);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let told = text(&output.stdout);
    assert!(
        told.starts_with("system 2 (PX4 quadrotor): 0 mission items"),
        "{told}"
    );
    assert!(folder.join("x.plan").exists());
}

#[test]
fn an_interrupt_ends_the_vehicles_cleanly_and_they_say_what_they_hold() {
    let folder = planned();
    let folder = folder.path();
    let mut process = Command::new(cargo_bin("sortie"))
        .current_dir(folder)
        .args(["vehicles", "pair.yaml", "--port", "0"])
        .stdout(Stdio::piped())
        .spawn()
        .expect("sortie runs");
    let mut lines = BufReader::new(process.stdout.take().expect("piped")).lines();
    let alpha = lines
        .by_ref()
        .map_while(Result::ok)
        .filter_map(|line| line.split_whitespace().last().map(str::to_owned))
        .find(|word| word.starts_with("udp"))
        .expect("a link");
    let link = format!("alpha={alpha}");
    let upload = ["upload", "out", "--link", &link, "--json"];
    let output = sortie(folder, &upload);
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).expect("a document");
    assert_eq!(told["vehicles"][0]["version"], "4.6.3", "{told}");
    let interrupt = Command::new("kill")
        .args(["-INT", &process.id().to_string()])
        .status();
    assert!(interrupt.expect("kill runs").success());
    let last = lines.map_while(Result::ok).last().expect("a summary");
    assert!(
        last.starts_with("ended: 1 of 2 vehicles were loaded"),
        "{last}"
    );
    assert_eq!(process.wait().expect("it ends").code(), Some(0));
}

#[test]
fn wrong_usage_of_the_link_commands_is_exit_2() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("pair.yaml"), SPEC).expect("the spec is written");
    for arguments in [
        &["download", "--link", "sim", "-o", "x.plan"][..],
        &["download", "--link", "udpout:host", "-o", "x.plan"],
        &["download", "--link", "udpout:127.0.0.1:1", "-o", "x.txt"],
        &[
            "download",
            "--link",
            "udpout:127.0.0.1:1",
            "--sysid",
            "0",
            "-o",
            "x.plan",
        ],
        &["vehicles", "pair.yaml", "--loss", "101"],
        &["vehicles", "pair.yaml", "--port", "65535"],
        &["vehicles", "pair.yaml", "--speak-to", "nowhere"],
    ] {
        let output = sortie(folder.path(), arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    }
}

//! One flight has one commander and one record, whatever becomes of their folder and of the clock.
#![cfg(unix)]

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use assert_cmd::cargo::cargo_bin;
use serde_json::Value;

use super::flight_watch::{Terminal, fly_lanes, has_event, signal, vehicles};
use crate::support::command::{sortie, text};
use crate::support::in_flight::{Flight, json, lanes, lines, planned, wait_for};

/// A flight of vehicles in another process.
struct Aloft {
    folder: tempfile::TempDir,
    runs: PathBuf,
    _vehicles: Flight,
    flight: Flight,
    links: [String; 2],
}

fn aloft(t_s: f64) -> Aloft {
    let (folder, runs) = planned("lanes", &lanes("-84.262"));
    let (vehicles, links) = vehicles(folder.path());
    let flight = fly_lanes(folder.path(), &links);
    wait_for(&runs, "alpha", t_s);
    Aloft {
        folder,
        runs,
        _vehicles: vehicles,
        flight,
        links,
    }
}

fn copy(from: &Path, to: &Path) {
    let copied = Command::new("cp").arg("-a").args([from, to]).status();
    assert!(copied.expect("cp").success());
}

#[test]
fn a_copied_folder_of_a_flight_that_goes_on_is_not_taken_over() {
    let mut of = aloft(4.0);
    let root = of.folder.path();
    copy(&root.join("out"), &root.join("copy"));
    let [alpha, bravo] = &of.links;
    let output = sortie(root, &["watch", "copy/lanes"]);
    let (shown, errors) = (text(&output.stdout), text(&output.stderr));
    assert!(!shown.contains("the flight is taken over"), "{shown}");
    assert_eq!(output.status.code(), Some(5), "{shown}{errors}");
    let first = of.runs.canonicalize().expect("it is there");
    let first = first.display().to_string();
    assert!(errors.contains(&first), "{first} in {errors}");
    // Nor is another flight begun with the same vehicles.
    copy(&root.join("out/lanes"), &root.join("again"));
    let fly = ["fly", "lanes.yaml", "--dir", "again", alpha, bravo];
    let output = sortie(root, &fly);
    let errors = text(&output.stderr);
    assert_eq!(output.status.code(), Some(5), "{errors}");
    assert!(errors.contains(&first), "{first} in {errors}");
    // When it is gone, the copy can be taken over.
    signal(&of.flight, "-KILL");
    let _ = of.flight.0.wait();
    let output = sortie(root, &["watch", "copy/lanes"]);
    let (shown, errors) = (text(&output.stdout), text(&output.stderr));
    assert!(
        shown.contains("the flight is taken over"),
        "{shown}{errors}"
    );
}

#[test]
fn a_folder_of_records_that_is_moved_in_flight_is_named_at_once_and_the_record_is_whole() {
    let mut of = aloft(4.0);
    let moved = of.folder.path().join("moved");
    std::fs::rename(&of.runs, &moved).expect("moved");
    std::thread::sleep(Duration::from_millis(2500));
    let record = lines(&of.runs);
    let text = "the record was moved or deleted";
    assert!(has_event(&record, text), "{record:?}");
    // Others attach to it all the same, and no other command begins.
    let terminal = Terminal::attach(of.folder.path());
    let output = sortie(of.folder.path(), &["plan", "lanes.yaml"]);
    assert_ne!(output.status.code(), Some(0), "{:?}", output);
    let (_, shown) = terminal.end();
    assert!(shown.contains(text), "{shown}");
    let code = of.flight.0.wait().expect("it ends").code();
    assert_eq!(code, Some(0), "{shown}");
    let flown = json(&of.runs.join("flight.json"));
    assert_eq!(flown["verdict"], "pass");
    let record = lines(&of.runs);
    let first = record.iter().find(|line| line["lat_deg"].is_f64());
    let first_s = first.and_then(|line| line["t_s"].as_f64());
    assert!(first_s.is_some_and(|t_s| t_s < 1.0), "{first:?}");
}

#[test]
fn a_record_that_loses_bytes_in_flight_is_not_judged() {
    let mut of = aloft(6.0);
    let notice = json(&of.runs.join("links.json"));
    let path = of.runs.join(notice["record"].as_str().expect("a name"));
    let file = std::fs::File::options().write(true).open(&path);
    let file = file.expect("the record");
    let length = file.metadata().expect("its length").len();
    file.set_len(length / 2).expect("cut");
    let terminal = Terminal::attach(of.folder.path());
    let (code, shown) = terminal.end();
    assert_eq!(code, Some(1), "{shown}");
    assert!(shown.contains("bytes of the record are missing"), "{shown}");
    assert_eq!(of.flight.0.wait().expect("it ends").code(), Some(1));
}

#[test]
fn a_system_clock_that_was_set_back_or_forward_does_not_shift_a_flight_that_is_taken_over() {
    for by_ms in [90_000_i64, -3_600_000] {
        let mut of = aloft(4.0);
        signal(&of.flight, "-KILL");
        let _ = of.flight.0.wait();
        // As if the clock of the system had been set by the opposite.
        let path = of.runs.join("links.json");
        let mut notice = json(&path);
        let t0_ms = notice["t0_unix_ms"].as_i64().expect("T0");
        notice["t0_unix_ms"] = (t0_ms + by_ms).into();
        std::fs::write(&path, notice.to_string()).expect("written");
        let output = sortie(of.folder.path(), &["watch", "out/lanes"]);
        let (shown, errors) = (text(&output.stdout), text(&output.stderr));
        assert!(
            shown.contains("the flight is taken over"),
            "{shown}{errors}"
        );
        let named = "the clock of this computer was set";
        assert!(shown.contains(named), "{shown}{errors}");
        assert!(!shown.contains("ALARM"), "{shown}{errors}");
        for line in ["alpha: landed, motors stopped", "bravo: loiters"] {
            assert!(shown.contains(line), "{line} in {shown}{errors}");
        }
        let until_s = |line: &Value| line["t_s"].as_f64().unwrap_or(0.0);
        let record = lines(&of.runs);
        let last_s = record.iter().map(until_s).fold(0.0, f64::max);
        assert!(last_s < 300.0, "{last_s}");
    }
}

#[test]
fn after_another_start_of_the_computer_the_time_is_said_to_be_uncertain() {
    let mut of = aloft(4.0);
    signal(&of.flight, "-KILL");
    let _ = of.flight.0.wait();
    let path = of.runs.join("links.json");
    let mut notice = json(&path);
    notice["boot"]["id"] = "another".into();
    std::fs::write(&path, notice.to_string()).expect("written");
    let output = sortie(of.folder.path(), &["watch", "out/lanes"]);
    let (shown, errors) = (text(&output.stdout), text(&output.stderr));
    let named = "this computer was started again";
    assert!(shown.contains(named), "{shown}{errors}");
}

/// A flight on a terminal of its own, with its keyboard.
fn on_a_terminal(folder: &Path) -> std::process::Child {
    let fly = format!(
        "{} fly lanes.yaml --speedup 4",
        cargo_bin("sortie").display()
    );
    Command::new("script")
        .current_dir(folder)
        .args(["-qfec", &fly, "/dev/null"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("script runs")
}

#[test]
fn a_terminal_that_is_stopped_by_ctrl_s_gives_its_command_to_one_that_is_attached() {
    let (folder, runs) = planned("lanes", &lanes("-84.238"));
    let mut screen = on_a_terminal(folder.path());
    let mut stdout = screen.stdout.take().expect("a screen");
    std::thread::spawn(move || std::io::copy(&mut stdout, &mut std::io::sink()));
    wait_for(&runs, "alpha", 4.0);
    let keyboard = screen.stdin.as_mut().expect("a keyboard");
    keyboard.write_all(&[0x13]).expect("Ctrl-S");
    keyboard.flush().expect("sent");
    let mut other = Terminal::attach(folder.path());
    std::thread::sleep(Duration::from_millis(9000));
    // On a machine that stands still meanwhile it commands later, and an old order is not taken.
    for _ in 0..6 {
        if other.0.try_wait().expect("its state").is_some() {
            break;
        }
        other.order("l");
        std::thread::sleep(Duration::from_millis(2000));
    }
    let (code, shown) = other.end();
    // The verdict does not wait for the terminal that takes nothing.
    assert_eq!(code, Some(5), "{shown}");
    for line in [
        "the terminal of this flight takes no lines any more: one that is attached commands",
        "this terminal commands the flight",
        "all land",
        "alpha: landed as ordered",
    ] {
        assert!(shown.contains(line), "{line} in {shown}");
    }
    let _ = screen.kill();
    let _ = screen.wait();
}

//! A flight outlives its ground station and its terminal: it is taken over from its record, and
//! other terminals attach to it.
#![cfg(unix)]

use std::io::{BufRead, BufReader, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use crate::support::{command, in_flight, ports};
use assert_cmd::cargo::cargo_bin;
use command::{sortie, text};
use in_flight::{Flight, begin, json, lanes, lines, planned, take_off, wait_for};
use serde_json::Value;

pub(super) fn signal(flight: &Flight, name: &str) {
    let id = flight.0.id().to_string();
    let sent = Command::new("kill").args([name, &id]).status();
    assert!(sent.expect("kill").success());
}

/// The vehicles of a spec in a process of their own, and the links to them.
pub(super) fn vehicles(folder: &Path) -> (Flight, [String; 2]) {
    let first = loop {
        // Two neighbouring ports that nobody has.
        let (a, b) = (ports::unshared().port(), ports::unshared().port());
        if b == a + 1 {
            break a;
        }
    };
    let port = first.to_string();
    let vehicles = begin(folder, &["vehicles", "lanes.yaml", "--port", &port]);
    let link = |id: &str, port: u16| format!("--link={id}=udpout:127.0.0.1:{port}");
    (vehicles, [link("alpha", first), link("bravo", first + 1)])
}

pub(super) fn has_event(lines: &[Value], text: &str) -> bool {
    let event = |line: &Value| line["event"].as_str().map(str::to_owned);
    lines
        .iter()
        .filter_map(event)
        .any(|event| event.contains(text))
}

/// The command that flies the two of `lanes.yaml` on their links.
fn of_lanes([alpha, bravo]: &[String; 2]) -> [&str; 6] {
    [
        "fly",
        "lanes.yaml",
        "--upload",
        "--set-params",
        alpha,
        bravo,
    ]
}

/// Flies them.
pub(super) fn fly_lanes(folder: &Path, links: &[String; 2]) -> Flight {
    begin(folder, &of_lanes(links))
}

#[test]
fn a_flight_whose_ground_station_was_killed_is_taken_over_and_its_verdict_covers_all_of_it() {
    let (folder, runs) = planned("lanes", &lanes("-84.262"));
    let (_vehicles, links) = vehicles(folder.path());
    let mut flight = fly_lanes(folder.path(), &links);
    wait_for(&runs, "alpha", 2.0);
    // Stopped, it blames itself and not the vehicles.
    signal(&flight, "-STOP");
    std::thread::sleep(Duration::from_millis(3500));
    signal(&flight, "-CONT");
    wait_for(&runs, "alpha", 8.0);
    signal(&flight, "-KILL");
    assert!(!flight.0.wait().expect("it ends").success());
    let before = lines(&runs);
    assert!(
        has_event(&before, "this program was stopped for"),
        "{before:?}"
    );
    assert!(!has_event(&before, "link lost"));
    // It left its socket, half a line, and what a disk has behind it after a loss of power.
    assert!(runs.join("session.sock").exists());
    let notice = json(&runs.join("links.json"));
    let record = runs.join(notice["record"].as_str().expect("a name"));
    let mut file = std::fs::File::options()
        .append(true)
        .open(&record)
        .expect("the record");
    file.write_all(b"{\"t_s\":9.1,\"vehi").expect("written");
    file.write_all(&[0; 64]).expect("written");
    let output = sortie(folder.path(), &["fly", "lanes.yaml", "--resume", "--force"]);
    assert_eq!(output.status.code(), Some(2), "--force is for the ground");
    std::thread::sleep(Duration::from_millis(6500));
    let output = sortie(folder.path(), &["watch", "out/lanes"]);
    let (shown, errors) = (text(&output.stdout), text(&output.stderr));
    assert!(
        shown.contains("the flight is taken over"),
        "{shown}{errors}"
    );
    let lost = "the last 80 bytes of the record could not be read: they are in ";
    assert!(shown.contains(lost), "{shown}{errors}");
    for line in ["alpha: landed, motors stopped", "bravo: loiters"] {
        assert!(shown.contains(line), "{line} in {shown}{errors}");
    }
    // Nobody knows what was flown in the gap; everything else is in order.
    assert_eq!(output.status.code(), Some(5), "{shown}{errors}");
    let judged = json(&runs.join("flight.json"));
    let margins = judged["margins"].as_array().expect("margins");
    let failed: Vec<&Value> = margins.iter().filter(|of| of["ok"] == false).collect();
    assert_eq!(failed.len(), 2, "{failed:?}");
    for gap in failed {
        let note = gap["note"].as_str().unwrap_or_default();
        assert!(note.contains("the recording program was stopped"), "{gap}");
        assert!(gap["value"].as_f64().is_some_and(|s| s > 5.0), "{gap}");
    }
    let ends: Vec<&str> = judged["vehicles"]
        .as_array()
        .expect("vehicles")
        .iter()
        .filter_map(|of| of["end"].as_str())
        .collect();
    assert_eq!(ends, ["landed", "loiters"]);
    // One record, with the flight before and after.
    let after = std::fs::read_to_string(&record).expect("the record");
    let positions = |text: &str| text.lines().filter(|of| of.contains("lat_deg")).count();
    let known = before.iter().filter(|of| of["lat_deg"].is_f64()).count();
    assert!(known > 40 && positions(&after) > known + 40, "{known}");
    assert_eq!(after.matches("t0_unix_s").count(), 1);
    let newest = std::fs::read_to_string(runs.join("flight.jsonl")).expect("the newest");
    assert_eq!(newest, after);
    for name in ["links.json", "session.sock"] {
        assert!(!runs.join(name).exists(), "{name}");
    }
    // It is over: nobody takes it over again.
    let output = sortie(folder.path(), &["watch", "out/lanes"]);
    let errors = text(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{errors}");
    assert!(
        errors.contains("no flight of this plan is under way"),
        "{errors}"
    );
}

/// A terminal that is attached to a flight.
pub(super) struct Terminal(pub(super) Child);

impl Terminal {
    pub(super) fn attach(folder: &Path) -> Self {
        let child = Command::new(cargo_bin("sortie"))
            .current_dir(folder)
            .args(["watch", "out/lanes"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        Self(child.expect("sortie runs"))
    }

    pub(super) fn order(&mut self, line: &str) {
        let stdin = self.0.stdin.as_mut().expect("a keyboard");
        writeln!(stdin, "{line}").expect("it is there");
    }

    /// The exit code, and everything that it showed.
    pub(super) fn end(mut self) -> (Option<i32>, String) {
        let stdout = self.0.stdout.take().expect("a screen");
        let lines = BufReader::new(stdout).lines().map_while(Result::ok);
        let shown: Vec<String> = lines.collect();
        let status = self.0.wait().expect("it ends");
        (status.code(), shown.join("\n"))
    }
}

#[test]
fn terminals_attach_to_a_flight_and_one_of_them_commands() {
    let (folder, runs) = planned("lanes", &lanes("-84.238"));
    let mut flight = take_off(folder.path(), "lanes.yaml", "4");
    wait_for(&runs, "alpha", 12.0);
    let socket = runs.join("session.sock");
    let mode = std::fs::metadata(&socket)
        .expect("the session")
        .permissions();
    assert_eq!(mode.mode() & 0o777, 0o600);
    let mut first = Terminal::attach(folder.path());
    std::thread::sleep(Duration::from_millis(800));
    let mut second = Terminal::attach(folder.path());
    std::thread::sleep(Duration::from_millis(800));
    second.order("hold");
    std::thread::sleep(Duration::from_millis(300));
    first.order("l");
    let (code, shown) = second.end();
    assert!(
        shown.contains("another terminal commands this flight"),
        "{shown}"
    );
    assert!(!shown.contains("all hold"), "{shown}");
    assert_eq!(code, Some(5), "{shown}");
    let (code, shown) = first.end();
    assert_eq!(code, Some(5), "{shown}");
    for line in [
        "all are armed: T0",
        "this terminal commands the flight",
        "all land",
        "alpha: landed as ordered",
        "bravo: landed as ordered",
    ] {
        assert!(shown.contains(line), "{line} in {shown}");
    }
    assert_eq!(flight.0.wait().expect("it ends").code(), Some(5));
    assert!(!socket.exists());
}

#[test]
fn a_flight_whose_process_stands_still_is_named_and_an_old_order_is_not_carried_out() {
    let (folder, runs) = planned("lanes", &lanes("-84.238"));
    let mut flight = take_off(folder.path(), "lanes.yaml", "4");
    wait_for(&runs, "alpha", 12.0);
    let terminal = Terminal::attach(folder.path());
    std::thread::sleep(Duration::from_millis(1500));
    signal(&flight, "-STOP");
    let shown = ordered_at_rest(&flight, terminal);
    let goes_on = "the process of the flight goes on, after about";
    assert!(shown.contains(goes_on), "{shown}");
    let _ = flight.0.wait();
}

/// What a terminal shows that orders a hold while the process of the flight stands still, and to land when it goes on.
fn ordered_at_rest(flight: &Flight, mut terminal: Terminal) -> String {
    std::thread::sleep(Duration::from_millis(500));
    terminal.order("hold");
    std::thread::sleep(Duration::from_millis(7000));
    signal(flight, "-CONT");
    std::thread::sleep(Duration::from_millis(2500));
    terminal.order("l");
    let (_, shown) = terminal.end();
    for line in [
        "nothing heard of the process of the flight for 3 s: nobody watches the fleet",
        "while this flight stood still: it is not carried out, give it again",
        "all land",
    ] {
        assert!(shown.contains(line), "{line} in {shown}");
    }
    assert!(!shown.contains("all hold"), "{shown}");
    shown
}

#[test]
fn a_terminal_that_goes_leaves_the_flight_alone_and_the_next_one_commands() {
    let (folder, runs) = planned("lanes", &lanes("-84.251"));
    let mut flight = take_off(folder.path(), "lanes.yaml", "8");
    wait_for(&runs, "alpha", 4.0);
    let mut first = Terminal::attach(folder.path());
    std::thread::sleep(Duration::from_millis(500));
    let second = Terminal::attach(folder.path());
    std::thread::sleep(Duration::from_millis(500));
    first.0.kill().expect("it goes");
    let _ = first.0.wait();
    let (code, shown) = second.end();
    assert_eq!(code, Some(0), "{shown}");
    assert!(
        shown.contains("this terminal commands the flight"),
        "{shown}"
    );
    assert!(
        shown.contains("kept its limits and ended as planned"),
        "{shown}"
    );
    assert!(flight.0.wait().expect("it ends").success());
}

#[test]
fn of_two_that_take_a_flight_over_one_does_and_knows_what_was_ordered_before() {
    let (folder, runs) = planned("lanes", &lanes("-84.262"));
    let (_vehicles, links) = vehicles(folder.path());
    let mut flight = fly_lanes(folder.path(), &links);
    wait_for(&runs, "alpha", 6.0);
    let mut terminal = Terminal::attach(folder.path());
    std::thread::sleep(Duration::from_millis(800));
    terminal.order("l");
    let is_ordered = |lines: &[Value]| lines.iter().any(|line| line["order"] == "land");
    while !is_ordered(&lines(&runs)) {
        std::thread::sleep(Duration::from_millis(100));
    }
    std::thread::sleep(Duration::from_millis(2500));
    signal(&flight, "-KILL");
    let _ = flight.0.wait();
    let _ = terminal.end();
    let watches = [0, 1].map(|_| Terminal::attach(folder.path()));
    let ends = watches.map(Terminal::end);
    let all: Vec<&str> = ends.iter().map(|(_, shown)| shown.as_str()).collect();
    for (code, _) in &ends {
        assert_eq!(*code, Some(5), "{all:?}");
    }
    // The other one attached to it.
    let attached = all
        .iter()
        .filter(|of| of.contains("attached: Ctrl-C detaches"));
    assert_eq!(attached.count(), 1, "{all:?}");
    for line in [
        "alpha: is watched again: it was ordered to land, and is in LAND",
        "alpha: landed as ordered",
        "bravo: landed as ordered",
    ] {
        assert!(all.iter().any(|of| of.contains(line)), "{line} in {all:?}");
    }
    assert!(!all.iter().any(|of| of.contains("ALARM")), "{all:?}");
}

#[test]
fn a_flight_that_broke_off_on_the_ground_is_not_taken_over() {
    let (folder, runs) = planned("lanes", &lanes("-84.251"));
    std::fs::create_dir_all(&runs).expect("a folder");
    let watch = |arguments: &[&str]| {
        let output = sortie(folder.path(), arguments);
        (output.status.code(), text(&output.stderr))
    };
    let (code, errors) = watch(&["watch", "out/lanes"]);
    assert_eq!(code, Some(3), "{errors}");
    assert!(errors.contains("links.json is missing"), "{errors}");
    let notice = "{\"links\": {}, \"speedup\": 1.0, \"t0_unix_ms\": null}";
    std::fs::write(runs.join("links.json"), notice).expect("written");
    let (code, errors) = watch(&["fly", "lanes.yaml", "--resume"]);
    assert_eq!(code, Some(3), "{errors}");
    assert!(errors.contains("broke off before T0"), "{errors}");
    let (code, errors) = watch(&["watch", "nowhere"]);
    assert_eq!(code, Some(3), "{errors}");
    assert!(errors.contains("not a folder"), "{errors}");
}

#[test]
fn one_that_attaches_to_a_process_that_stands_still_is_warned_and_its_old_order_is_not_carried_out()
{
    let (folder, runs) = planned("lanes", &lanes("-84.238"));
    let mut flight = take_off(folder.path(), "lanes.yaml", "4");
    wait_for(&runs, "alpha", 12.0);
    signal(&flight, "-STOP");
    ordered_at_rest(&flight, Terminal::attach(folder.path()));
    let _ = flight.0.wait();
}

#[test]
fn a_terminal_that_commands_and_stands_still_gives_way_to_one_that_orders() {
    let (folder, runs) = planned("lanes", &lanes("-84.238"));
    let mut flight = take_off(folder.path(), "lanes.yaml", "4");
    wait_for(&runs, "alpha", 8.0);
    let first = Terminal::attach(folder.path());
    std::thread::sleep(Duration::from_millis(2500));
    let id = first.0.id().to_string();
    let stopped = Command::new("kill").args(["-STOP", &id]).status();
    assert!(stopped.expect("kill").success());
    let mut second = Terminal::attach(folder.path());
    std::thread::sleep(Duration::from_millis(7000));
    second.order("l");
    let (_, shown) = second.end();
    for line in [
        "another one commands",
        "this terminal commands the flight",
        "all land",
    ] {
        assert!(shown.contains(line), "{line} in {shown}");
    }
    let mut first = first;
    first.0.kill().expect("it goes");
    let _ = first.0.wait();
    let _ = flight.0.wait();
}

#[test]
fn a_flight_that_broke_off_is_kept_from_another_fly_and_from_another_plan() {
    let (folder, runs) = planned("lanes", &lanes("-84.262"));
    let (_vehicles, links) = vehicles(folder.path());
    let mut flight = fly_lanes(folder.path(), &links);
    let [alpha, bravo] = &links;
    wait_for(&runs, "alpha", 4.0);
    signal(&flight, "-KILL");
    let _ = flight.0.wait();
    let notice = std::fs::read(runs.join("links.json")).expect("it says where they are");
    let link = folder.path().join("another");
    std::os::unix::fs::symlink(folder.path().join("out/lanes"), &link).expect("a link");
    for arguments in [
        &of_lanes(&links)[..],
        &["fly", "lanes.yaml", "--dir", "another", alpha, bravo],
        &["plan", "lanes.yaml"],
    ] {
        let output = sortie(folder.path(), arguments);
        let errors = text(&output.stderr);
        assert_eq!(output.status.code(), Some(5), "{errors}");
        assert!(errors.contains("broke off"), "{errors}");
    }
    assert_eq!(
        std::fs::read(runs.join("links.json")).expect("still"),
        notice
    );
    let output = sortie(folder.path(), &["watch", "out/lanes"]);
    let shown = text(&output.stdout);
    assert!(shown.contains("the flight is taken over"), "{shown}");
    let output = sortie(folder.path(), &["plan", "lanes.yaml"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
}

//! A flight goes on whatever the terminal does.
#![cfg(target_os = "linux")]

use std::io::{Read, Write};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use assert_cmd::cargo::cargo_bin;

use crate::support::in_flight::{Flight, json, lanes, planned};

/// Bytes that a pipe takes while nobody reads it.
const PIPE: usize = 65_536;

#[test]
fn a_terminal_that_takes_nothing_stops_no_flight_and_gets_its_lines_when_it_reads_again() {
    let (folder, runs) = planned("lanes", &lanes("-84.251"));
    let (mut screen, mut lines) = std::io::pipe().expect("a pipe");
    // Two or three lines, and it is full.
    lines.write_all(&[b'.'; PIPE - 200]).expect("it has room");
    let child = Command::new(cargo_bin("sortie"))
        .current_dir(folder.path())
        .args(["fly", "lanes.yaml", "--speedup", "20"])
        .stdin(Stdio::null())
        .stdout(lines.try_clone().expect("a pipe"))
        .stderr(lines)
        .spawn()
        .expect("sortie runs");
    let mut flight = Flight(child);
    #[allow(clippy::disallowed_methods)]
    let began = Instant::now();
    while !runs.join("flight.json").exists() {
        assert!(
            began.elapsed() < Duration::from_secs(90),
            "the flight stands still"
        );
        std::thread::sleep(Duration::from_millis(50));
    }
    let mut shown = Vec::new();
    screen.read_to_end(&mut shown).expect("readable");
    let shown = String::from_utf8_lossy(&shown);
    let shown = shown.trim_start_matches('.');
    let ended = flight.0.wait().expect("it ends");
    assert!(ended.success(), "{shown}");
    assert_eq!(json(&runs.join("flight.json"))["verdict"], "pass");
    for text in ["alpha: took off", "bravo: took off", "separation"] {
        assert!(shown.contains(text), "{shown}");
    }
}

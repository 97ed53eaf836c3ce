//! The verdict against a second implementation in Python, which shares nothing with it
//! but the flight model as the documentation of `verify` has it.

use crate::support::peers;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};

use assert_cmd::cargo::cargo_bin;

/// What must have been compared of each kind of vehicle.
const COMPARED: [(&str, &[&str]); 6] = [
    (
        "copter-ardupilot",
        &["clearance", "ceiling", "threat", "separation"],
    ),
    (
        "copter-px4",
        &["clearance", "ceiling", "threat", "separation"],
    ),
    (
        "plane-ardupilot",
        &["clearance", "slope", "ceiling", "threat"],
    ),
    (
        "plane-px4",
        &["clearance", "slope", "ceiling", "threat", "separation"],
    ),
    ("vtol-ardupilot", &["clearance", "ceiling", "threat"]),
    (
        "vtol-px4",
        &["clearance", "ceiling", "threat", "separation"],
    ),
];
/// The least number of margins of each.
const MIN: usize = 5;

/// Adds the numbers of lines such as `compared plane-px4: clearance 8, slope 8`.
fn count(found: &str, counts: &mut BTreeMap<(String, String), usize>) {
    let lines = found
        .lines()
        .filter_map(|line| line.strip_prefix("compared "));
    for (kind, numbers) in lines.filter_map(|line| line.split_once(": ")) {
        for (measure, number) in numbers.split(", ").filter_map(|part| part.split_once(' ')) {
            let key = (kind.to_owned(), measure.to_owned());
            *counts.entry(key).or_default() += number.parse::<usize>().unwrap_or(0);
        }
    }
}

#[test]
fn dense_sampling_of_random_fleets_of_every_kind_finds_what_the_verdict_reports() {
    let Some(python) = peers::python() else {
        return;
    };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/check_missions.py");
    // Each fleet has its own seed: copters from 1 to 50, wings of each kind from 1 to 8 and 26 to 33, two processors at it.
    let halves = ["1", "26"].map(|first| {
        Command::new(&python)
            .arg(&script)
            .args(["--fleets", "25", "--wings", "8", "--pairs", "8"])
            .args(["--seed", first, "--sortie"])
            .arg(cargo_bin("sortie"))
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("python starts")
    });
    let mut counts = BTreeMap::new();
    for half in halves {
        let output = half.wait_with_output().expect("python ends");
        let (found, errors) = (
            String::from_utf8_lossy(&output.stdout),
            String::from_utf8_lossy(&output.stderr),
        );
        assert!(output.status.success(), "{found}\n{errors}");
        count(&found, &mut counts);
    }
    for (kind, measures) in COMPARED {
        for measure in measures {
            let found = counts.get(&(kind.to_owned(), (*measure).to_owned()));
            assert!(
                found.is_some_and(|&found| found >= MIN),
                "{kind}, {measure}: {found:?} compared"
            );
        }
    }
}

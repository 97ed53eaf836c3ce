//! The verdict against a second implementation in Python, which shares nothing with it
//! but the flight model as the documentation of `verify` has it.

use crate::support::peers;
use std::path::Path;
use std::process::{Command, Stdio};

use assert_cmd::cargo::cargo_bin;

#[test]
fn dense_sampling_of_fifty_random_fleets_finds_what_the_verdict_reports() {
    let Some(python) = peers::python() else {
        return;
    };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/check_missions.py");
    // Each fleet has its own seed: these are the ones from 1 to 50, two processors at it.
    let halves = [("1", "25"), ("26", "25")].map(|(first, fleets)| {
        Command::new(&python)
            .arg(&script)
            .args([
                "--fleets", fleets, "--wings", fleets, "--seed", first, "--sortie",
            ])
            .arg(cargo_bin("sortie"))
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("python starts")
    });
    for half in halves {
        let output = half.wait_with_output().expect("python ends");
        let (found, errors) = (
            String::from_utf8_lossy(&output.stdout),
            String::from_utf8_lossy(&output.stderr),
        );
        assert!(output.status.success(), "{found}\n{errors}");
    }
}

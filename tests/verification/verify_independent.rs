//! The verdict against a second implementation in Python, which shares nothing with it
//! but the flight model as the documentation of `verify` has it.

use crate::support::peers;
use std::path::Path;
use std::process::Command;

use assert_cmd::cargo::cargo_bin;

#[test]
fn dense_sampling_of_fifty_random_fleets_finds_what_the_verdict_reports() {
    let Some(python) = peers::python() else {
        return;
    };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/check_missions.py");
    let output = Command::new(python)
        .arg(script)
        .args(["--fleets", "50", "--seed", "1", "--sortie"])
        .arg(cargo_bin("sortie"))
        .output()
        .expect("python starts");
    let (found, errors) = (
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr),
    );
    assert!(output.status.success(), "{found}\n{errors}");
}

//! `sortie review` without a spec, of a mission with its parameters next to it.

use std::fs;

use crate::support::command::{sortie, text};

const RETURN: &str = "QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t46.0\t8.0\t500\t1\n1\t0\t3\t22\t0\t0\t0\t0\t0\t0\t50\t1\n2\t0\t3\t16\t0\t0\t0\t0\t46.01\t8.0\t50\t1\n3\t0\t3\t20\t0\t0\t0\t0\t0\t0\t0\t1\n";

/// Exit code and all that is said of the return with these parameters and flags.
fn review(params: &str, flags: &[&str]) -> (Option<i32>, String) {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("m.waypoints"), RETURN).expect("written");
    fs::write(folder.path().join("m.params"), params).expect("written");
    let always = [
        "review",
        "m.waypoints",
        "--no-terrain",
        "--airframe",
        "copter",
    ];
    let output = sortie(folder.path(), &[&always[..], flags].concat());
    let said = text(&output.stdout) + &text(&output.stderr);
    (output.status.code(), said)
}

#[test]
fn a_return_is_judged_at_the_altitude_of_the_parameters_next_to_the_mission() {
    let ceiling = ["--max-amsl", "600"];
    let (code, said) = review("RTL_ALT,30000\n", &ceiling);
    assert_eq!(code, Some(4), "{said}");
    assert!(said.contains("800.0 m"), "{said}");
    assert!(!said.contains("RTL_ALT 1500"), "{said}");
    let (code, said) = review("RTL_ALT,8000\n", &ceiling);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("580.0 m"), "{said}");
    // What the file does not hold is still assumed, and said.
    assert!(said.contains("RTL_LOIT_TIME 5000"), "{said}");
    let (code, said) = review("not a parameter\n", &ceiling);
    assert_eq!(code, Some(3), "{said}");
}

//! The Python interpreter that has the independent peers, and what it prints.
#![allow(clippy::print_stdout)]

use std::path::{Path, PathBuf};
use std::process::Command;

/// The interpreter of `target/peers`, which `tools/test` makes.
///
/// `None`, and a line that says so, when it is not there: the caller returns. With
/// `SORTIE_REQUIRE_PEERS=1` that is a failure instead.
pub fn python() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/peers");
    let python = root.join("bin/python");
    if root.join("ready").exists() && python.exists() {
        return Some(python);
    }
    assert!(
        std::env::var("SORTIE_REQUIRE_PEERS").as_deref() != Ok("1"),
        "the peers are not installed: run tools/test"
    );
    println!("skipped: the peers are not installed (tools/test does it)");
    None
}

/// The interpreter and MAVProxy; `None` as with [`python`].
#[allow(dead_code, reason = "one test alone speaks with MAVProxy")]
pub fn mavproxy() -> Option<(PathBuf, PathBuf)> {
    let python = python()?;
    let script = python.with_file_name("mavproxy.py");
    if script.exists() {
        return Some((python, script));
    }
    assert!(
        std::env::var("SORTIE_REQUIRE_PEERS").as_deref() != Ok("1"),
        "MAVProxy is not installed: run tools/test"
    );
    println!("skipped: MAVProxy is not installed (tools/test does it)");
    None
}

/// Runs a script of `tests/peers` and returns the JSON on the last line that it prints.
pub fn run(python: &Path, script: &str, arguments: &[&str]) -> serde_json::Value {
    let script = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/peers")
        .join(script);
    let output = Command::new(python)
        .arg(&script)
        .args(arguments)
        .output()
        .expect("python starts");
    let text = String::from_utf8_lossy(&output.stdout);
    let last = text.lines().last().unwrap_or_default();
    serde_json::from_str(last).unwrap_or_else(|error| {
        let errors = String::from_utf8_lossy(&output.stderr);
        panic!(
            "{} {arguments:?}: {error}\n{text}\n{errors}",
            script.display()
        )
    })
}

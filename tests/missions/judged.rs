//! `sortie review` of one mission without a spec, with what it judges.

use std::fs;

use serde_json::Value;

use crate::support::command::{sortie, text};

/// What is said of a mission, and all that is judged of it.
pub(crate) struct Judged {
    /// Exit code.
    pub(crate) code: Option<i32>,
    /// Text of both streams.
    pub(crate) said: String,
    /// Segments of its trajectory, as they are written.
    pub(crate) segments: Vec<Value>,
}

/// Judges a mission without terrain, with the text of a parameter file next to it if there is any.
pub(crate) fn judged(mission: &str, params: &str, flags: &[&str]) -> Judged {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("m.waypoints"), mission).expect("written");
    if !params.is_empty() {
        fs::write(folder.path().join("m.params"), params).expect("written");
    }
    let always = "review m.waypoints --no-terrain --trajectories t.json";
    let arguments: Vec<&str> = always.split(' ').chain(flags.iter().copied()).collect();
    let output = sortie(folder.path(), &arguments);
    let written = fs::read_to_string(folder.path().join("t.json")).unwrap_or_default();
    let written: Value = serde_json::from_str(&written).unwrap_or_default();
    let segments = written["vehicles"][0]["segments"].as_array();
    let segments = segments.cloned().unwrap_or_default();
    Judged {
        code: output.status.code(),
        said: text(&output.stdout) + &text(&output.stderr),
        segments,
    }
}

//! The real binary, run in a folder.

use std::path::Path;
use std::process::{Command, Output};

use assert_cmd::cargo::cargo_bin;

pub fn sortie(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(cargo_bin("sortie"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .expect("sortie runs")
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

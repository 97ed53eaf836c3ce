//! The architecture is the folder list: each folder imports only from lower layers.

use std::fs;
use std::path::{Path, PathBuf};

/// Folder, layer, and what it may not import although it lies lower.
const HOUSE: &[(&str, u32, &[&str])] = &[
    ("numeric", 0, &[]),
    ("geodesy", 1, &[]),
    ("autopilot", 1, &[]),
    ("optimize", 1, &[]),
    ("spec", 2, &["optimize"]),
    ("world", 3, &["optimize"]),
    ("path", 4, &["optimize"]),
    ("cost", 5, &["optimize"]),
    ("plan", 6, &[]),
    ("mission", 7, &["optimize", "cost", "plan"]),
    ("formats", 8, &["optimize", "cost", "plan"]),
    ("verify", 8, &["optimize", "cost", "plan"]),
    ("dispatch", 9, &["optimize"]),
    ("link", 9, &["optimize", "path", "cost", "plan", "world"]),
    ("simulator", 10, &["optimize", "path", "cost", "plan"]),
    ("report", 10, &["optimize", "link"]),
    ("flight", 11, &[]),
    ("study", 11, &["link"]),
    ("cli", 12, &[]),
];

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("src can be read") {
        let path = entry.expect("src can be read").path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// Folders named after `crate::` in a line, `crate::{a, b}` included.
fn imports(line: &str) -> Vec<String> {
    let name = |text: &str| {
        text.trim_start()
            .chars()
            .take_while(|c| c.is_alphanumeric() || *c == '_')
            .collect::<String>()
    };
    line.match_indices("crate::")
        .flat_map(|(at, found)| {
            let rest = &line[at + found.len()..];
            match rest.strip_prefix('{') {
                Some(list) => list.split([',', '}']).map(name).collect(),
                None => vec![name(rest)],
            }
        })
        .collect()
}

#[test]
fn each_folder_imports_only_what_lies_below_it() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&src, &mut files);
    let mut broken = Vec::new();
    let mut folders_seen = 0;
    for file in files {
        let inside = file.strip_prefix(&src).expect("a file of src");
        let Some(folder) = inside
            .parent()
            .and_then(|p| p.iter().next())
            .and_then(|p| p.to_str())
        else {
            continue;
        };
        let row = HOUSE.iter().find(|(name, ..)| *name == folder);
        let (_, layer, forbidden) =
            row.unwrap_or_else(|| panic!("{folder} is not a room of the house"));
        folders_seen += 1;
        let text = fs::read_to_string(&file).expect("a source file");
        for (number, line) in text.lines().enumerate() {
            let code = line.split("//").next().unwrap_or("");
            for import in imports(code) {
                let Some((_, below, _)) = HOUSE.iter().find(|(name, ..)| *name == import) else {
                    continue;
                };
                if import != folder && (below >= layer || forbidden.contains(&import.as_str())) {
                    broken.push(format!(
                        "{}:{}: {folder} (layer {layer}) must not import {import} (layer {below})",
                        inside.display(),
                        number + 1
                    ));
                }
            }
        }
    }
    assert!(
        folders_seen > 10,
        "only {folders_seen} files were looked at"
    );
    assert!(broken.is_empty(), "\n{}", broken.join("\n"));
}

#[test]
fn imports_are_found_in_every_spelling() {
    assert_eq!(imports("use crate::plan::Route;"), ["plan"]);
    assert_eq!(
        imports("use crate::{plan, cost::Terms};"),
        ["plan", "cost", ""]
    );
    assert_eq!(
        imports("let a = crate::link::f(crate::spec::g());"),
        ["link", "spec"]
    );
}

//! Damaged and odd mission files, each with what is to become of it (`tests/corpus/outcomes.txt`).

use crate::support::command;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use sortie::formats;

use command::{sortie, text};

/// One line of the table.
struct Case {
    name: String,
    flags: Vec<String>,
    read: String,
    review: String,
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus")
}

fn cases() -> Vec<Case> {
    let table = fs::read_to_string(folder().join("outcomes.txt")).expect("a table");
    let lines = table.lines().filter(|line| !line.starts_with('#'));
    lines
        .map(|line| {
            let columns: Vec<&str> = line.split('|').map(str::trim).collect();
            let [name, flags, read, review] = columns[..] else {
                panic!("{line}");
            };
            Case {
                name: name.to_owned(),
                flags: flags.split_whitespace().map(str::to_owned).collect(),
                read: read.to_owned(),
                review: review.to_owned(),
            }
        })
        .collect()
}

/// Whether each text is said in a line of its own, part by part, and no line is left.
fn matches(expected: &str, mut lines: Vec<String>) -> bool {
    let mut texts = expected.split("; ").filter(|text| !text.is_empty());
    let all_said = texts.all(|text| {
        let said = |line: &String| text.split(": ").all(|part| line.contains(part));
        let found = lines.iter().position(said);
        found.map(|index| lines.remove(index)).is_some()
    });
    all_said && lines.is_empty()
}

/// What the reader says of a file, as a line of the table would.
fn read(path: &Path) -> (&'static str, Vec<String>) {
    match formats::read(&fs::read(path).expect("a file")) {
        Ok((_, document)) if document.repairs.is_empty() => ("accepted", Vec::new()),
        Ok((_, document)) => {
            let repairs = document.repairs.iter().map(ToString::to_string);
            ("repaired", repairs.collect())
        }
        Err(error) => ("refused", vec![error.to_string()]),
    }
}

/// What the review says: its failed margins as `what: note`.
fn review(case: &Case) -> (&'static str, Vec<String>) {
    let mut arguments = vec!["review", "--json", case.name.as_str()];
    arguments.extend(case.flags.iter().map(String::as_str));
    let output = sortie(&folder(), &arguments);
    let (out, errors) = (text(&output.stdout), text(&output.stderr));
    assert!(!errors.contains("panicked"), "{}: {errors}", case.name);
    let failed = || -> Vec<String> {
        let json: serde_json::Value = serde_json::from_str(&out).expect("review.json");
        let margins = json["margins"].as_array().expect("margins");
        let failed = margins.iter().filter(|margin| margin["ok"] == false);
        let word = |margin: &serde_json::Value, key: &str| {
            margin[key].as_str().unwrap_or_default().to_owned()
        };
        failed
            .map(|margin| format!("{}: {}", word(margin, "what"), word(margin, "note")))
            .collect()
    };
    match output.status.code() {
        Some(0) => ("pass", failed()),
        Some(4) => ("fail", failed()),
        Some(3) => ("refused", Vec::new()),
        other => panic!("{}: exit {other:?}: {errors}", case.name),
    }
}

#[test]
fn every_damaged_file_comes_to_its_expected_end_and_none_passes_in_silence() {
    let cases = cases();
    assert!(cases.len() >= 60, "{} files", cases.len());
    let mut wrong = Vec::new();
    for case in &cases {
        let (kind, told) = read(&folder().join(&case.name));
        let (wanted, texts) = case.read.split_once(": ").unwrap_or((&case.read, ""));
        if kind != wanted || !matches(texts, told.clone()) {
            wrong.push(format!("{}: read: {kind}: {}", case.name, told.join("; ")));
        }
        let (kind, told) = review(case);
        let (wanted, texts) = case.review.split_once(": ").unwrap_or((&case.review, ""));
        if kind != wanted || !matches(texts, told.clone()) {
            wrong.push(format!(
                "{}: review: {kind}: {}",
                case.name,
                told.join("; ")
            ));
        }
        // What the reader refuses no review may judge.
        assert_eq!(
            case.read.starts_with("refused"),
            case.review == "refused" && !case.name.starts_with("for_another_autopilot"),
            "{}",
            case.name
        );
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_file_of_the_corpus_is_in_the_table_once() {
    let mut named: BTreeMap<String, usize> = BTreeMap::new();
    for case in cases() {
        *named.entry(case.name).or_default() += 1;
    }
    let there: BTreeMap<String, usize> = fs::read_dir(folder())
        .expect("a folder")
        .map(|entry| {
            entry
                .expect("a file")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .filter(|name| name != "outcomes.txt")
        .map(|name| (name, 1))
        .collect();
    assert_eq!(named, there);
}

/// A mission of so many items, each the same row.
fn long(rows: usize, row: &str) -> String {
    let mut text = String::from(
        "QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t36.3\t-84.25\t488\t1\n1\t0\t3\t22\t0\t0\t0\t0\t36.3\t-84.25\t80\t1\n",
    );
    for index in 2..=rows {
        text += &format!("{index}\t0\t3\t{row}\t1\n");
    }
    text
}

#[test]
fn a_hundred_thousand_items_do_not_hang_and_fail_by_number() {
    let folder = tempfile::tempdir().expect("a folder");
    let cases = [
        (
            "waypoints",
            "16\t0\t0\t0\t0\t36.31\t-84.25\t80",
            "item count",
        ),
        (
            "unknown",
            "31010\t0\t0\t0\t0\t36.31\t-84.25\t80",
            "known command",
        ),
        ("jumps", "177\t1\t30000\t0\t0\t0\t0\t0", "item count"),
    ];
    for (name, row, rule) in cases {
        let name = format!("{name}.waypoints");
        // The count of a row is 16 bits.
        fs::write(folder.path().join(&name), long(60_000, row)).expect("written");
        let output = sortie(folder.path(), &["review", &name, "--no-terrain"]);
        assert_eq!(output.status.code(), Some(4), "{}", text(&output.stderr));
        assert!(text(&output.stdout).contains(rule), "{name}");
    }
    fs::write(
        folder.path().join("long.waypoints"),
        long(100_000, cases[0].1),
    )
    .expect("written");
    let output = sortie(folder.path(), &["review", "long.waypoints", "--no-terrain"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(text(&output.stderr).contains("0 to 65535"));
}

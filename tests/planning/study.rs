//! The paper's experiment: maps, runs, shards, tables.

use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use sortie::geodesy::EastNorth;
use sortie::spec::{Document, Scenario, SpecFile};
use sortie::study::{self, Config, Job, MapText, Record, Results, Study, results_md};

fn map(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("missions/paper")
        .join(name)
}

/// A small study of one map.
fn config() -> Config {
    Config {
        version: "test".to_owned(),
        runs: 2,
        population: 10,
        iterations: 5,
        seed: 1,
        ablations: true,
        readings: true,
        published_objective: false,
        control_points: None,
        maps: vec![MapText {
            file: "s1.yaml".to_owned(),
            text: fs::read_to_string(map("s1.yaml")).expect("shipped"),
        }],
    }
}

fn records(config: &Config) -> Vec<Record> {
    let settings = config.settings().expect("good maps");
    let all = std::sync::Mutex::new(Vec::new());
    study::run(config, &settings, &Job::all(config), &|record, _| {
        all.lock().expect("no panic").push(record);
        true
    });
    all.into_inner().expect("no panic")
}

fn sortie(arguments: &[&str]) -> assert_cmd::assert::Assert {
    Command::cargo_bin("sortie")
        .expect("built")
        .args(arguments)
        .assert()
}

fn small(folder: &Path, more: &[&str]) -> assert_cmd::assert::Assert {
    let (folder, map) = (folder.display().to_string(), map("stress.yaml"));
    let map = map.display().to_string();
    let mut arguments = vec!["study", "paper", &map, "--out", &folder];
    arguments.extend(["--runs", "2", "--iterations", "5", "--population", "10"]);
    arguments.extend(more);
    sortie(&arguments)
}

#[test]
fn the_maps_are_good_scenarios_and_no_missions() {
    for name in [
        "s1.yaml",
        "s2.yaml",
        "s3.yaml",
        "s1-8.yaml",
        "s2-8.yaml",
        "s3-8.yaml",
        "stress.yaml",
    ] {
        let path = map(name);
        assert!(matches!(
            Document::read(&path).expect(name),
            Document::Scenario(_)
        ));
        let error = SpecFile::read(&path).expect_err(name).to_string();
        assert!(error.contains("frame: a scenario of the study"), "{error}");
        let text = path.display().to_string();
        sortie(&["check", &text]).success();
        sortie(&["plan", &text]).code(3);
    }
}

#[test]
fn a_straight_line_is_as_long_as_the_maps_were_meant() {
    for (name, sum_km) in [("s1.yaml", 307.5), ("s2.yaml", 331.3), ("s3.yaml", 344.1)] {
        let scenario = Scenario::read(&map(name)).expect(name);
        let sum_m: f64 = scenario
            .vehicles
            .iter()
            .map(|vehicle| vehicle.start.at.distance_m(vehicle.goal.at))
            .sum();
        assert!((sum_m * 1e-3 - sum_km).abs() < 0.1, "{name}: {sum_m}");
    }
}

#[test]
fn the_ground_is_that_of_the_formula() {
    let scenario = Scenario::read(&map("s1.yaml")).expect("shipped");
    let height = |east_m, north_m| scenario.surface.height_m(EastNorth { east_m, north_m });
    // sin(0.1) + cos(0) + 0.2 + 0.02 at the origin; the peaks are 42 km away.
    assert!((height(0.0, 0.0) - 100.0 * (0.1_f64.sin() + 1.22)).abs() < 1.0);
    // A summit of 2000 m over rolling ground of at most 200.
    assert!((1990.0..2200.0).contains(&height(30_000.0, 30_000.0)));
}

#[test]
fn what_is_wrong_with_a_scenario_is_said_with_its_place() {
    let good = fs::read_to_string(map("s1.yaml")).expect("shipped");
    for (from, to, expected) in [
        ("speed_mps: 200", "speed_mps: -1", "vehicles[0].speed_mps"),
        (
            "east_m: 5000, north_m: 10000, agl_m: 100",
            "east_m: 45000, north_m: 42000, agl_m: 100",
            "inside threat `radar-1`",
        ),
        ("agl_m: 100}", "agl_m: 50}", "vehicles[0].start"),
        ("agl_m: 100}", "agl_m: 100, up_m: 3}", "one of the two"),
        (
            "objective: paper",
            "objective: operational",
            "planner.objective",
        ),
        ("frame: local", "frame: global", "frame"),
        ("control_points: 5", "control_pints: 5", "control_pints"),
        // What a scenario allows there, not a spec.
        (
            "sortie: 1\n",
            "",
            "sortie: missing field `sortie` (allowed: 1)",
        ),
    ] {
        let text = good.replacen(from, to, 1);
        assert_ne!(text, good, "{from}");
        let error = Scenario::parse(Path::new("x.yaml"), &text).expect_err(to);
        let error = error.to_string();
        assert!(
            error.contains(expected) && error.contains("x.yaml:"),
            "{error}"
        );
    }
}

#[test]
fn every_contestant_spends_what_its_protocol_gives_and_runs_repeat() {
    let config = config();
    let mut first = records(&config);
    let mut again = records(&config);
    let order = |record: &Record| {
        (
            record.algorithm.clone(),
            record.protocol.clone(),
            record.run,
        )
    };
    first.sort_by_key(order);
    again.sort_by_key(order);
    assert_eq!(first, again);
    for record in &first {
        let doubled = record.protocol == "iterations";
        for vehicle in &record.vehicles {
            let expected = if doubled { 5 + 2 * 50 } else { 50 };
            assert_eq!(vehicle.evaluations, expected, "{}", record.algorithm);
            let terms = vehicle.terms;
            let sum = terms.length
                + terms.altitude
                + terms.threat
                + terms.terrain
                + terms.turn
                + terms.climb
                + terms.collision;
            assert!((sum - vehicle.total).abs() < 1e-9);
            assert!(vehicle.trace.is_sorted_by(|a, b| a >= b));
        }
        let sum: f64 = record.vehicles.iter().map(|vehicle| vehicle.total).sum();
        assert!((sum - record.total).abs() < 1e-9);
    }
    // The search and the record agree on what was found.
    let of_search = first.iter().filter(|record| record.algorithm != "planner");
    for vehicle in of_search.flat_map(|record| &record.vehicles) {
        let found = vehicle.trace.last().expect("a trace");
        assert!((found - vehicle.total).abs() <= 1e-9 * found.abs());
    }
}

#[test]
fn four_shards_merged_are_one_run_byte_for_byte() {
    let home = tempfile::tempdir().expect("a folder");
    let at = |name: &str| home.path().join(name);
    small(&at("whole"), &[]).success();
    let mut arguments = vec!["study".to_owned(), "merge".to_owned()];
    for part in 1..=4 {
        let folder = at(&format!("part{part}"));
        small(&folder, &["--shard", &format!("{part}/4")]).success();
        arguments.push(folder.display().to_string());
    }
    let missing: Vec<&str> = arguments[..4].iter().map(String::as_str).collect();
    let merged = at("merged").display().to_string();
    sortie(&[&missing[..], &["--out", &merged]].concat()).code(3);
    let all: Vec<&str> = arguments.iter().map(String::as_str).collect();
    sortie(&[&all[..], &["--out", &merged]].concat()).success();
    let names = fs::read_dir(at("whole")).expect("a folder");
    let mut compared = 0;
    for name in names.map(|entry| entry.expect("an entry").file_name()) {
        if name != "times.jsonl" && name != ".lock" {
            let read = |folder: &str| fs::read(at(folder).join(&name)).expect("a file");
            assert!(read("whole") == read("merged"), "{name:?} differs");
            compared += 1;
        }
    }
    assert!(compared >= 5, "only {compared} files");
    let other = at("other");
    small(&other, &["--shard", "1/4", "--seed", "9"]).success();
    let other = other.display().to_string();
    let shards = [&all[..5], &[other.as_str(), "--out", &merged]].concat();
    let refused = sortie(&shards).code(3);
    let said = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    assert!(said.contains("another configuration"), "{said}");
}

#[test]
fn a_killed_study_goes_on_where_it_was() {
    let home = tempfile::tempdir().expect("a folder");
    let (whole, cut) = (home.path().join("whole"), home.path().join("cut"));
    small(&whole, &[]).success();
    let runs = fs::read_to_string(whole.join("runs.jsonl")).expect("runs");
    // As a kill leaves it: some runs, and half of one.
    fs::create_dir(&cut).expect("a folder");
    fs::copy(whole.join("study.json"), cut.join("study.json")).expect("copied");
    let end = runs.match_indices('\n').nth(6).expect("seven lines").0;
    fs::write(cut.join("journal.jsonl"), &runs[..end + 200]).expect("written");
    small(&cut, &[]).code(2);
    small(&cut, &["--resume", "--seed", "7"]).code(3);
    let done = small(&cut, &["--resume"]).success();
    let said = String::from_utf8_lossy(&done.get_output().stdout).into_owned();
    let all = runs.lines().count();
    assert!(
        said.starts_with(&format!("{} runs made", all - 7)),
        "{said}"
    );
    assert_eq!(
        fs::read_to_string(cut.join("runs.jsonl")).expect("runs"),
        runs
    );
    assert!(!cut.join("journal.jsonl").exists());
    let again = small(&cut, &["--resume"]).success();
    assert!(again.get_output().stdout.starts_with(b"0 runs made"));
}

/// Names of the runs in a file of times, and lines of the journal.
fn run_names(folder: &Path) -> Vec<String> {
    let text = fs::read_to_string(folder.join("times.jsonl")).unwrap_or_default();
    let names = text.lines().filter_map(|line| {
        let (name, _) = line.split_once(",\"seconds\"")?;
        Some(name.to_owned())
    });
    names.collect()
}

fn journal(folder: &Path) -> Vec<String> {
    let text = fs::read_to_string(folder.join("journal.jsonl")).unwrap_or_default();
    let whole = text.rfind('\n').map_or("", |end| &text[..end]);
    whole.lines().map(str::to_owned).collect()
}

#[test]
fn a_study_killed_again_and_again_loses_no_run_and_repeats_none() {
    let home = tempfile::tempdir().expect("a folder");
    let (whole, killed) = (home.path().join("whole"), home.path().join("killed"));
    let options = ["--ablations", "--readings", "--iterations", "30"];
    let arguments = |folder: &Path| -> Vec<String> {
        let (map, out) = (map("s1.yaml"), folder.display().to_string());
        let map = map.display().to_string();
        ["study", "paper", &map, "--out", &out, "--runs", "2"]
            .into_iter()
            .chain(["--population", "10", "--resume"])
            .chain(options)
            .map(str::to_owned)
            .collect()
    };
    let mut before: Vec<String> = Vec::new();
    let mut kills = 0;
    // Killed at the very beginning, then whenever so many runs more are finished.
    for more in [0, 1, 2, 5, 1, 3, 8] {
        let mut process = std::process::Command::new(assert_cmd::cargo::cargo_bin("sortie"))
            .args(arguments(&killed))
            .stdout(std::process::Stdio::null())
            .spawn()
            .expect("started");
        while journal(&killed).len() < before.len() + more
            && process.try_wait().expect("a state").is_none()
        {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        // On Unix this is SIGKILL: nothing of the program runs after it.
        process.kill().expect("killed");
        let status = process.wait().expect("ended");
        kills += usize::from(!status.success());
        let after = journal(&killed);
        let lost = before.iter().filter(|line| !after.contains(line)).count();
        assert_eq!(lost, 0, "after {more} more");
        before = after;
    }
    assert!(kills >= 5, "only {kills} kills came in time");
    let rest: Vec<String> = arguments(&killed);
    sortie(&rest.iter().map(String::as_str).collect::<Vec<_>>()).success();
    let at_once = arguments(&whole);
    sortie(&at_once.iter().map(String::as_str).collect::<Vec<_>>()).success();
    for name in ["study.json", "runs.jsonl", "RESULTS.md", "study.html"] {
        let read = |folder: &Path| fs::read(folder.join(name)).expect(name);
        assert!(read(&whole) == read(&killed), "{name} differs");
    }
    let mut names = run_names(&killed);
    let all = names.len();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), all, "a finished run was made again");
}

#[test]
fn two_processes_do_not_write_one_study() {
    let home = tempfile::tempdir().expect("a folder");
    let settled = config();
    let store = study::Store::open(home.path(), &settled, false).expect("opened");
    let second = study::Store::open(home.path(), &settled, true).expect_err("locked");
    assert!(second.to_string().contains("another process"), "{second}");
    drop(store);
    study::Store::open(home.path(), &settled, true).expect("free again");
}

/// The study of `missions/paper/RESULTS.md`, by the command that it names.
fn published() -> Config {
    let text = fs::read_to_string(map("RESULTS.md")).expect("shipped");
    let command = text.split('`').nth(1).expect("a command");
    assert!(command.starts_with("sortie study paper --out DIR --runs "));
    let words: Vec<&str> = command.split(' ').collect();
    Config {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        runs: words[6].parse().expect("a number"),
        population: 100,
        iterations: 200,
        seed: 1,
        ablations: words.contains(&"--ablations"),
        readings: words.contains(&"--readings"),
        published_objective: false,
        control_points: None,
        maps: study::shipped_maps()
            .map(|(file, text)| MapText {
                file: file.to_owned(),
                text: text.to_owned(),
            })
            .into(),
    }
}

/// Cells of a row of Table 2 in `RESULTS.md`.
fn published_row(map_index: usize, row: &str) -> Vec<String> {
    let text = fs::read_to_string(map("RESULTS.md")).expect("shipped");
    let map = &text[text
        .find(&format!("\n## s{}\n", map_index + 1))
        .expect("a map")..];
    let line = map
        .lines()
        .find(|line| line.starts_with(&format!("| {row} |")))
        .expect(row);
    line.split('|').map(|cell| cell.trim().to_owned()).collect()
}

#[test]
fn the_published_results_are_those_of_this_program() {
    let config = published();
    let text = fs::read_to_string(map("RESULTS.md")).expect("shipped");
    assert!(
        text.contains(&config.hash()[..12]),
        "RESULTS.md is of another configuration: make it again"
    );
    let settings = config.settings().expect("good maps");
    for (contestant, map, row) in [
        (4, 0, "FOA, equal evaluations"),
        (3, 1, "MSFOA, R from 0.3, equal evaluations"),
    ] {
        let cells = published_row(map, row);
        let run = cells[2].parse().expect("a run");
        let job = Job {
            contestant,
            map,
            run,
        };
        let found = std::sync::Mutex::new(None);
        study::run(&config, &settings, &[job], &|record, _| {
            *found.lock().expect("no panic") = Some(record);
            true
        });
        let record = found.into_inner().expect("no panic").expect("a run");
        let parts = record.vehicles.iter().map(|v| format!("{:.2}", v.total));
        assert_eq!(parts.collect::<Vec<_>>(), cells[3..6], "{row}");
        let sum = format!("{:.2} ({:.2})", record.total, record.fine_total);
        assert_eq!(sum, cells[6], "{row}");
    }
}

#[test]
fn tables_and_account_are_made_of_the_runs() {
    let config = config();
    let mut records = records(&config);
    records.sort_by_key(|record| record.run);
    let results = Results::new(&config, &records).expect("good maps");
    let contestants = config.contestants().len();
    assert_eq!(results.table_3().lines().count(), 1 + contestants);
    assert_eq!(results.table_2().lines().count(), 1 + 4 * contestants);
    let text = results_md(&results);
    for wanted in [
        "## s1",
        "Friedman",
        "| one swarm, R = 0.1 |",
        "| FOA, S = 1/D |",
        "## Claims of the paper",
        "| the default planner |",
        "sortie study paper missions/paper/s1.yaml --out DIR --runs 2",
    ] {
        assert!(text.contains(wanted), "{wanted}");
    }
    assert!(!text.contains("NaN") && !text.contains("inf"));
}

#[test]
fn a_mission_without_a_best_known_total_is_named_and_a_lower_total_is_kept_when_asked() {
    let folder = tempfile::tempdir().expect("a folder");
    let best = folder.path().join("best.json");
    let first = Path::new(env!("CARGO_MANIFEST_DIR")).join("missions/first.yaml");
    let study = |out: &str, evaluations: &str, more: &[&str]| -> String {
        let out = folder.path().join(out).display().to_string();
        let (best, first) = (best.display().to_string(), first.display().to_string());
        let mut arguments = vec!["study", "planner", &first, "--out", &out, "--seeds", "1"];
        arguments.extend(["--evaluations", evaluations, "--best-known", &best]);
        arguments.extend(more);
        let done = sortie(&arguments).success();
        String::from_utf8(done.get_output().stdout.clone()).expect("text")
    };
    let told = |what: &str| format!("{what} (--update saves it)");
    let new = format!(
        "not in {}, compared with the best of these runs: first",
        best.display()
    );
    let text = study("a", "500", &[]);
    assert!(text.contains(&told(&new)) && !best.exists(), "{text}");
    let text = study("b", "500", &["--update"]);
    assert!(text.contains(&format!("{new} (updated)")), "{text}");
    let saved = std::fs::read_to_string(&best).expect("saved");
    let mut saved: serde_json::Value = serde_json::from_str(&saved).expect("JSON");
    let total = saved["first"]["total"].as_f64().expect("a number");
    saved["first"]["total"] = (1.01 * total).into();
    std::fs::write(&best, saved.to_string()).expect("written");
    let text = study("c", "500", &[]);
    let below = format!("below the best known of {}: first", best.display());
    assert!(
        text.contains(&told(&below)) && !text.contains("not in"),
        "{text}"
    );
}

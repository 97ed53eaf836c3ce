//! The paper's experiment: maps, runs, shards, tables.

use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use sortie::cost::PaperOptions;
use sortie::geodesy::EastNorth;
use sortie::spec::{Document, Scenario, SpecFile};
use sortie::study::{self, Config, Job, MapText, Record, Results, Setting, results_md};

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
        printed_objective: false,
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
    for name in ["s1.yaml", "s2.yaml", "s3.yaml", "stress.yaml"] {
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
        "one swarm, R = 0.1:",
        "What holds",
        "the default planner",
    ] {
        assert!(text.contains(wanted), "{wanted}");
    }
    assert!(!text.contains("NaN") && !text.contains("inf"));
}

#[test]
fn in_the_stress_map_collisions_and_turns_cost_a_straight_flight() {
    let text = fs::read_to_string(map("stress.yaml")).expect("shipped");
    let study = Config {
        maps: vec![MapText {
            file: "stress.yaml".to_owned(),
            text,
        }],
        ..config()
    };
    let records = records(&study);
    let of = |term: fn(&study::Terms) -> f64| {
        records
            .iter()
            .flat_map(|record| &record.vehicles)
            .map(|vehicle| term(&vehicle.terms))
            .fold(0.0, f64::max)
    };
    assert!(of(|terms| terms.turn) > 0.0);
    assert!(of(|terms| terms.threat) > 0.0);
    let setting = Setting::new(
        Scenario::read(&map("stress.yaml")).expect("shipped"),
        PaperOptions::default(),
    );
    assert_eq!(setting.scenario.vehicles.len(), 3);
}

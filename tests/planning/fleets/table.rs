//! From a table or grids to files.

use std::fs;

use serde_json::Value;

use crate::support::command::{sortie, text};

const SPEC: &str = "\
sortie: 1
name: pair
area:
  south_west: {lat: 36.28, lon: -84.30}
  north_east: {lat: 36.32, lon: -84.20}
  min_agl_m: 60
  max_amsl_m: 800
terrain: {flat: {amsl_m: 300}}
fleet:
  csv: tables/pair.csv
  id: d{n:02}
  defaults:
    autopilot: ardupilot
    link: sim
    start: {agl_m: 80}
    goal: {agl_m: 80}
    finish: land
    speed_mps: 12
    max_climb_deg: 15
    max_descent_deg: 10
planner: {evaluations: 500}
";

const TABLE: &str = "\
start_lat,start_lon,goal_lat,goal_lon
36.300,-84.265,36.300,-84.245
36.305,-84.265,36.305,-84.245
";

#[test]
fn a_table_goes_with_the_plan_and_no_other_is_uploaded_with_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("tables")).expect("a folder");
    fs::write(at("pair.yaml"), SPEC).expect("written");
    fs::write(at("tables/pair.csv"), TABLE).expect("written");
    let run = |arguments: &[&str], code: i32| {
        let output = sortie(folder.path(), arguments);
        let said = text(&output.stdout) + &text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
        said
    };
    // Twice: an earlier plan with its table is replaced.
    for _ in 0..2 {
        run(&["plan", "pair.yaml"], 0);
    }
    let copy = at("out/pair/tables/pair.csv");
    assert_eq!(fs::read_to_string(&copy).expect("copied"), TABLE);
    assert_eq!(
        fs::read_to_string(at("out/pair/spec.yaml")).expect("copied"),
        SPEC
    );
    let plan = fs::read_to_string(at("out/pair/plan.json")).expect("a plan");
    let plan: Value = serde_json::from_str(&plan).expect("JSON");
    assert_eq!(plan["vehicles"][1]["id"], "d02");
    assert_eq!(plan["table_sha256"].as_str().map(str::len), Some(64));
    for ending in ["waypoints", "plan", "params"] {
        assert!(at(&format!("out/pair/d01.{ending}")).is_file());
    }
    run(&["upload", "out/pair", "--dry-run"], 0);
    run(
        &[
            "review",
            "pair.yaml",
            "out/pair/d01.plan",
            "out/pair/d02.plan",
        ],
        0,
    );

    // The same place to a metre: the files still pass against it, and are not what it says.
    fs::write(&copy, TABLE.replace("36.305,-84.265", "36.305001,-84.265")).expect("edited");
    let said = run(&["upload", "out/pair", "--dry-run"], 4);
    assert!(said.contains("pair.csv is not the table"), "{said}");
    let said = run(&["plan", "pair.yaml"], 1);
    assert!(said.contains("not replaced"), "{said}");
}

#[test]
fn of_a_large_fleet_the_table_shows_the_forty_nearest_to_a_limit_the_worst_first() {
    let folder = tempfile::tempdir().expect("a folder");
    // All stay more than 20 m above the least height, but one that passes 7 m from a threat.
    let lanes = "  start_grid: {south_west: {lat: 36.282, lon: -84.29}, rows: 42, columns: 1, spacing_m: 100}
  goal_grid: {south_west: {lat: 36.282, lon: -84.285}, rows: 42, columns: 1, spacing_m: 100}\n";
    let spec = SPEC
        .replace("  csv: tables/pair.csv\n", lanes)
        .replace("min_agl_m: 60", "min_agl_m: 20")
        .replace("evaluations: 500", "evaluations: 100, control_points: 8")
        + "separation: {distance_m: 20, time_slack_s: 0}
threats: [{id: tower, kind: tower, lat: 36.31823, lon: -84.2875, radius_m: 27}]\n";
    fs::write(folder.path().join("pair.yaml"), spec).expect("written");
    let output = sortie(folder.path(), &["plan", "pair.yaml"]);
    let said = text(&output.stdout) + &text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(
        said.contains("the 40 vehicles with the tightest margins; 2 more keep every limit"),
        "{said}"
    );
    let listed: Vec<&str> = said
        .lines()
        .filter_map(|line| line.split_whitespace().next())
        .filter(|word| word.len() == 3 && word.starts_with('d'))
        .collect();
    assert_eq!(listed.len(), 40, "{said}");
    assert_eq!(listed[0], "d41", "{said}");
}

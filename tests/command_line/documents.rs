//! The JSON documents of commands and folders, and the schemas of them.

use std::fs;

use crate::support::command;
use command::{sortie, text};
use serde_json::Value;

/// A copter with a battery, and one without; a task for either.
const SPEC: &str = "\
sortie: 2
name: pair
area: {south_west: {lat: 36.28, lon: -84.30}, north_east: {lat: 36.32, lon: -84.20}, min_agl_m: 60, max_amsl_m: 800}
terrain: {flat: {amsl_m: 300}}
threats:
  - {id: radar, lat: 36.300, lon: -84.250, radius_m: 200}
  - {id: dish, lat: 36.310, lon: -84.250, radius_m: 100, shape: dome}
vehicles:
  - {id: alpha, sysid: 1, autopilot: ardupilot, link: sim, speed_mps: 9, finish: land, endurance: {time_s: 1200},
     start: {lat: 36.30, lon: -84.265, agl_m: 80}, goal: {lat: 36.30, lon: -84.235, agl_m: 80}}
  - {id: bravo, sysid: 2, autopilot: px4, link: sim, speed_mps: 9, finish: land,
     start: {lat: 36.29, lon: -84.265, agl_m: 80}, goal: {lat: 36.29, lon: -84.235, agl_m: 80}}
tasks:
  - {id: look, visit: {lat: 36.291, lon: -84.25, agl_m: 80}}
planner: {evaluations: 500}
";

/// What a value has that its schema does not know, and what it lacks.
fn deviations(value: &Value, schema: &Value, root: &Value, at: &str) -> Vec<String> {
    if let Some(name) = schema["$ref"].as_str() {
        let target = root.pointer(name.trim_start_matches('#'));
        let target = target.unwrap_or_else(|| panic!("{name} of {at} is not in the schema"));
        return deviations(value, target, root, at);
    }
    if let Some(choices) = schema["anyOf"].as_array() {
        let each = choices
            .iter()
            .map(|choice| deviations(value, choice, root, at));
        return each.min_by_key(Vec::len).unwrap_or_default();
    }
    let kind = match value {
        Value::Null => "null",
        Value::Bool(_) => "boolean",
        Value::Number(number) if number.is_f64() => "number",
        Value::Number(_) => "integer",
        Value::String(_) => "string",
        Value::Array(_) => "array",
        Value::Object(_) => "object",
    };
    let is = |of: &Value| of == kind || of == "number" && kind == "integer";
    let fits = match &schema["type"] {
        Value::Null => true,
        Value::Array(kinds) => kinds.iter().any(is),
        one => is(one),
    };
    if !fits {
        return vec![format!("{at} is {kind}: {}", schema["type"])];
    }
    match value {
        Value::Array(items) => {
            let each = items.iter().enumerate();
            each.flat_map(|(index, item)| {
                deviations(item, &schema["items"], root, &format!("{at}[{index}]"))
            })
            .collect()
        }
        Value::Object(object) => {
            let required = schema["required"].as_array().into_iter().flatten();
            let missing = required
                .filter_map(Value::as_str)
                .filter(|key| !object.contains_key(*key));
            let mut found: Vec<String> = missing.map(|key| format!("{at} lacks {key}")).collect();
            for (key, value) in object {
                let inner = &schema["properties"][key];
                let at = format!("{at}.{key}");
                match inner {
                    Value::Null => found.push(format!("{at} is not in the schema")),
                    inner => found.extend(deviations(value, inner, root, &at)),
                }
            }
            found
        }
        _ => Vec::new(),
    }
}

fn schema(name: &str) -> Value {
    let output = sortie(std::path::Path::new("."), &["schema", name]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

/// Asserts that a document has what its schema requires and nothing else, and that one without its first key does not.
fn is_of_schema(document: &Value, name: &str) {
    let schema = schema(name);
    let found = deviations(document, &schema, &schema, name);
    assert!(found.is_empty(), "{found:#?}");
    let mut lacking = document.clone();
    let keys = lacking.as_object_mut().expect("an object");
    let required = schema["required"][0].as_str().expect("a required key");
    keys.remove(required);
    assert_ne!(deviations(&lacking, &schema, &schema, name), found);
}

#[test]
fn every_document_is_as_its_schema_says() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("pair.yaml"), SPEC).expect("the spec is written");
    let run = |arguments: &[&str]| {
        let output = sortie(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        output.stdout
    };
    let json = |bytes: &[u8]| serde_json::from_slice::<Value>(bytes).expect("JSON");
    let read = |name: &str| json(&fs::read(folder.path().join(name)).expect("a document"));

    is_of_schema(&json(&run(&["check", "pair.yaml", "--json"])), "check");
    let printed = json(&run(&["plan", "pair.yaml", "--upload", "--json"]));
    is_of_schema(&printed, "plan");
    assert_eq!(printed["out"], "out/pair");
    assert_eq!(printed["upload"]["verdict"], "verified");
    let plan = read("out/pair/plan.json");
    is_of_schema(&plan, "plan");
    assert_eq!(plan["out"], Value::Null);
    let [alpha, bravo] = [&plan["vehicles"][0], &plan["vehicles"][1]];
    assert_eq!(alpha["endurance"]["unit"], "s");
    assert_eq!(alpha["endurance"]["limit"], 960.0);
    let used_s = alpha["endurance"]["used"].as_f64().expect("a time");
    assert!((300.0..960.0).contains(&used_s), "{used_s}");
    assert_eq!(alpha["tasks"], serde_json::json!([]));
    assert_eq!(bravo["endurance"], Value::Null);
    assert_eq!(bravo["tasks"][0]["id"], "look");
    for name in ["review", "timing"] {
        let document = read(&format!("out/pair/{name}.json"));
        is_of_schema(&document, name);
        assert_eq!(document["seed"], plan["seed"], "{name}");
    }
    is_of_schema(&read("out/pair.runs/upload.json"), "upload");
    run(&[
        "certify",
        "pair.yaml",
        "out/pair",
        "--within",
        "1",
        "--cells",
        "30",
    ]);
    is_of_schema(&read("out/pair/certificate.json"), "certificate");
    run(&["review", "out/pair", "--trajectories", "t.json"]);
    is_of_schema(&read("t.json"), "trajectories");
    run(&["convert", "out/pair/alpha.plan", "a.waypoints", "--json"]);
    let converted = run(&["convert", "out/pair/bravo.plan", "b.waypoints", "--json"]);
    is_of_schema(&json(&converted), "convert");
    is_of_schema(
        &json(&run(&["study", "speed", "--seconds", "0.01", "--json"])),
        "speed",
    );
    let tile = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/missions/terrain/jacksboro.tif"
    );
    is_of_schema(&json(&run(&["terrain", "info", tile, "--json"])), "terrain");
}

#[test]
fn a_dry_run_says_in_json_what_would_be_sent() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("pair.yaml"), SPEC).expect("the spec is written");
    let planned = sortie(folder.path(), &["plan", "pair.yaml"]);
    assert_eq!(planned.status.code(), Some(0), "{}", text(&planned.stderr));
    assert_eq!(text(&planned.stderr), "", "no progress into a pipe");
    let output = sortie(
        folder.path(),
        &["upload", "out/pair", "--dry-run", "--json"],
    );
    assert_eq!(output.status.code(), Some(0));
    let document: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    is_of_schema(&document, "upload");
    assert_eq!(document["verdict"], "not sent");
    assert_eq!(document["vehicles"][1]["vehicle"], "bravo");
    let items = document["vehicles"][1]["items"].as_u64().expect("a number");
    assert!(items > 2, "{items}");
    // What is not even looked at has a document too.
    let alpha = folder.path().join("out/pair/alpha.waypoints");
    fs::copy(folder.path().join("out/pair/bravo.waypoints"), alpha).expect("a file is copied");
    let output = sortie(folder.path(), &["review", "out/pair", "--json"]);
    assert_eq!(output.status.code(), Some(4));
    let document: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    is_of_schema(&document, "check");
    assert_eq!(document["verdict"], "fail");
}

#[test]
fn a_bad_spec_is_one_document_of_every_problem_with_its_place() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let bad = SPEC
        .replace("sysid: 2", "sysid: 1")
        .replace("max_amsl_m: 800", "max_amsl_m: 310");
    fs::write(folder.path().join("pair.yaml"), bad).expect("the spec is written");
    let printed = |arguments: &[&str]| {
        let output = sortie(folder.path(), &[arguments, &["--json"]].concat());
        assert_eq!(output.status.code(), Some(3), "{arguments:?}");
        output
    };
    let output = printed(&["check", "pair.yaml"]);
    let document: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let same: [&[&str]; 4] = [
        &["plan", "pair.yaml"],
        &["review", "pair.yaml"],
        &["certify", "pair.yaml", "out"],
        &["fly", "pair.yaml"],
    ];
    for arguments in same {
        let other = printed(arguments);
        assert_eq!(text(&other.stdout), text(&output.stdout), "{arguments:?}");
    }
    is_of_schema(&document, "check");
    assert_eq!(document["verdict"], "fail");
    let issues = document["issues"].as_array().expect("a list");
    assert!(issues.len() > 1, "{issues:?}");
    let twice = issues
        .iter()
        .find(|issue| issue["path"] == "vehicles[1].sysid");
    let twice = twice.expect("the sysid is there twice");
    assert_eq!(twice["line"], 11);
    assert_eq!(text(&output.stderr).lines().count(), issues.len());
}

#[test]
fn a_bad_input_file_is_one_document_as_well() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("alpha.waypoints"), "no mission").expect("a file is written");
    let bad: [&[&str]; 4] = [
        &["review", "alpha.waypoints"],
        &["convert", "alpha.waypoints", "alpha.plan"],
        &["watch", "nothing"],
        &["study", "planner", "nothing.yaml", "--out", "out"],
    ];
    for arguments in bad {
        let output = sortie(folder.path(), &[arguments, &["--json"]].concat());
        assert_eq!(output.status.code(), Some(3), "{arguments:?}");
        let document: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        is_of_schema(&document, "check");
        let issue = &document["issues"][0]["found"];
        let line = text(&output.stderr);
        assert!(
            issue.is_string() && line.contains(issue.as_str().unwrap_or_default()),
            "{issue}, {line}"
        );
    }
}

#[test]
fn unusable_elevation_files_are_in_the_document_of_the_others() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("a.tif"), "no tiles").expect("a file is written");
    fs::create_dir(folder.path().join("empty")).expect("a folder");
    let tile = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/missions/terrain/jacksboro.tif"
    );
    let output = sortie(
        folder.path(),
        &["terrain", "info", "a.tif", "empty", tile, "--json"],
    );
    assert_eq!(output.status.code(), Some(3));
    let document: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    is_of_schema(&document, "terrain");
    assert_eq!(document["files"][0]["file"], tile);
    let unusable = document["unusable"].as_array().expect("a list");
    let lines = text(&output.stderr);
    assert_eq!((unusable.len(), lines.lines().count()), (2, 2), "{lines}");
}

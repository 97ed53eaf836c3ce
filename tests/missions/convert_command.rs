//! `sortie convert`: what goes from one format to another, and what is told of the rest.

use crate::support;
use crate::support::command;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use sortie::formats::{self, Document};
use sortie::mission::Item;

use command::{sortie, text};
use support::peers;

const HOME: &str = "36.3,-84.25,488";

fn corpus() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus")
}

fn read(path: &Path) -> Option<Document> {
    let bytes = fs::read(path).expect("a file");
    formats::read(&bytes).ok().map(|(_, document)| document)
}

/// Converts and returns the report; the exit code and what was said if it was refused.
fn convert(from: &Path, to: &Path, flags: &[&str]) -> Result<Value, (Option<i32>, String)> {
    let (from, to) = (from.display().to_string(), to.display().to_string());
    let mut arguments = vec!["convert", &from, &to, "--json"];
    arguments.extend(flags);
    let output = sortie(Path::new("."), &arguments);
    let errors = text(&output.stderr);
    assert!(!errors.contains("panicked"), "{from}: {errors}");
    if output.status.code() != Some(0) {
        return Err((output.status.code(), errors));
    }
    assert!(errors.is_empty(), "--json tells all on stdout: {errors}");
    Ok(serde_json::from_slice(&output.stdout).expect("a report"))
}

fn said(report: &Value, key: &str) -> String {
    let all = report[key].as_array().expect("a list");
    let all = all.iter().map(|one| one.as_str().expect("a sentence"));
    all.collect::<Vec<_>>().join("\n")
}

/// A WPL file of rows after the header.
fn waypoints(folder: &Path, name: &str, rows: &[&str]) -> PathBuf {
    let path = folder.join(name);
    let rows: String = rows
        .iter()
        .map(|row| row.replace(' ', "\t") + "\n")
        .collect();
    fs::write(&path, format!("QGC WPL 110\n{rows}")).expect("written");
    path
}

/// The numbers of items in `items 1-3, 7: ...`.
fn numbers(sentence: &str, what: &str) -> Vec<usize> {
    let list = sentence
        .strip_prefix(&format!("{what}s "))
        .or_else(|| sentence.strip_prefix(&format!("{what} ")))
        .and_then(|rest| rest.split(": ").next())
        .unwrap_or_default();
    let run = |run: &str| {
        let (first, last) = run.split_once('-').unwrap_or((run, run));
        let number = |text: &str| text.parse::<usize>().ok();
        number(first)
            .zip(number(last))
            .map_or(0..0, |(a, b)| a..b + 1)
    };
    list.split(", ").flat_map(run).collect()
}

/// Whether every item is as it was, or named as changed by the report.
fn kept_or_told(report: &Value, what: &str, was: &[Item], is: &[Item]) -> bool {
    let told = said(report, "not_kept");
    if told.contains(&format!("the order of the {what}s")) {
        return was.len() == is.len();
    }
    let told: Vec<usize> = told.lines().flat_map(|line| numbers(line, what)).collect();
    let mut pairs = was.iter().zip(is).zip(1..);
    was.len() == is.len() && pairs.all(|((was, is), number)| was == is || told.contains(&number))
}

#[test]
fn every_readable_file_goes_to_a_plan_and_back_whole_or_says_what_is_lost() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut whole, mut refused) = (0, Vec::new());
    for entry in fs::read_dir(corpus()).expect("the corpus") {
        let path = entry.expect("a file").path();
        let name = path
            .file_name()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        let Some(was) = read(&path).filter(|_| name != "outcomes.txt") else {
            continue;
        };
        let (plan, back) = (
            folder.path().join("a.plan"),
            folder.path().join("b.waypoints"),
        );
        let there = match convert(&path, &plan, &["--home", HOME]) {
            Ok(report) => report,
            Err((code, errors)) => {
                assert_eq!(code, Some(3), "{name}: {errors}");
                refused.push(name);
                continue;
            }
        };
        let middle = read(&plan).expect("our own plan");
        for (what, was, is) in [
            ("item", &was.items, &middle.items),
            ("fence item", &was.fence, &middle.fence),
            ("rally point", &was.rally, &middle.rally),
        ] {
            assert!(kept_or_told(&there, what, was, is), "{name}: {there:#}");
        }
        if let (Some(was), Some(is)) = (was.home, middle.home) {
            assert!(was == is || (was.x, was.y) == (0, 0), "{name}");
        }
        let here = match convert(&plan, &back, &[]) {
            Ok(report) => report,
            Err((code, errors)) => {
                assert!(
                    code == Some(3) && errors.contains("altitude"),
                    "{name}: {errors}"
                );
                refused.push(name);
                continue;
            }
        };
        let last = read(&back).expect("our own rows");
        assert!(
            kept_or_told(&here, "item", &middle.items, &last.items),
            "{name}: {here:#}"
        );
        whole += usize::from(!was.items.is_empty() && was.items == last.items);
    }
    refused.sort();
    assert!(whole > 60, "{whole} came back whole");
    // A jump to nowhere has no doJumpId, an altitude that is no number no row.
    assert_eq!(
        refused,
        [
            "fence_two_corners.waypoints",
            "jump_negative.waypoints",
            "jump_nowhere.waypoints",
            "nan_altitude.waypoints"
        ]
    );
}

#[test]
fn ardupilot_to_px4_names_frames_commands_and_what_is_read_differently() {
    let folder = tempfile::tempdir().expect("a folder");
    let from = waypoints(
        folder.path(),
        "a.waypoints",
        &[
            "0 1 0 16 0 0 0 0 36.3 -84.25 488 1",
            "1 0 3 22 0 0 0 0 36.3 -84.25 30 1",
            "2 0 10 16 0 5 0 90 36.31 -84.25 30 1",
            "3 0 3 18 2 0 50 0 36.31 -84.25 30 1",
            "4 0 3 177 2 1 0 0 0 0 0 1",
            "5 0 3 20 0 0 0 0 0 0 0 1",
            "6 0 3 16 0 0 0 0 36.31 -84.24 0 1",
            "7 0 3 16 0 0 0 0 0 0 30 1",
            "8 0 3 22 0 0 0 0 36.302 -84.25 30 1",
        ],
    );
    let plan = folder.path().join("a.plan");
    let report = convert(&from, &plan, &["--autopilot", "px4"]).expect("converted");
    let refused = said(&report, "refused");
    for part in [
        "item 2: frame: frame 10",
        "item 3: known command: command 18",
        "item 4: frame: frame 3",
        "item 5: frame: frame 3",
    ] {
        assert!(refused.contains(part), "{refused}");
    }
    let different = said(&report, "read_differently");
    for part in [
        "items 1-2, 6-8: param4: PX4 turns to this heading",
        "item 2: param2: the acceptance radius",
        "item 5: returns at the altitude",
        "item 6: altitude 0: ArduPilot keeps the altitude that it has",
        "item 7: latitude and longitude 0",
        "item 8: takes off at a place away from home",
    ] {
        assert!(different.contains(part), "{different}");
    }
    // Altitudes keep their reference, jumps their target.
    let document = read(&plan).expect("a plan");
    assert_eq!(document.items, read(&from).expect("rows").items);
    let json: Value = serde_json::from_slice(&fs::read(&plan).expect("a plan")).expect("JSON");
    assert_eq!(json["mission"]["firmwareType"], 12);
    assert_eq!(json["mission"]["items"][3]["params"][0], 2);
    // Without an autopilot asked for, nothing is said about another.
    let report = convert(&from, &plan, &[]).expect("converted");
    assert_eq!(said(&report, "read_differently"), "");
    assert!(said(&report, "assumed").contains("--autopilot"));
}

#[test]
fn what_a_plan_holds_beside_its_items_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let to = folder.path().join("b.waypoints");
    let report = convert(&corpus().join("survey.plan"), &to, &[]).expect("converted");
    let told = said(&report, "not_kept");
    for part in [
        "what the survey was drawn from; its 3 flown items are kept",
        "mission.cruiseSpeed 15",
        "that it is for PX4",
    ] {
        assert!(told.contains(part), "{told}");
    }
    let report = convert(&corpus().join("unknown_keys.plan"), &to, &[]).expect("converted");
    assert!(said(&report, "not_kept").lines().count() > 3, "{report:#}");
    let report = convert(&corpus().join("fence.plan"), &to, &[]).expect("converted");
    assert!(
        said(&report, "not_kept").contains("fence items"),
        "{report:#}"
    );
    assert_eq!(report["fence_items"], 0);
}

#[test]
fn what_flies_it_is_kept_or_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let (rows, plan) = (
        folder.path().join("a.waypoints"),
        folder.path().join("a.plan"),
    );
    let report = convert(&corpus().join("plane.plan"), &rows, &[]).expect("converted");
    let told = said(&report, "not_kept");
    assert!(told.contains("that it is for a plane"), "{told}");
    let kind = |flags: &[&str]| {
        let report = convert(&rows, &plan, flags).expect("converted");
        let json: Value = serde_json::from_slice(&fs::read(&plan).expect("a plan")).expect("JSON");
        let told = said(&report, "assumed").contains("--airframe");
        (json["mission"]["vehicleType"].clone(), told)
    };
    assert_eq!(kind(&["--airframe", "plane"]), (1.into(), false));
    assert_eq!(kind(&[]), (2.into(), true));
}

#[test]
fn a_fence_and_rally_points_become_lists_of_rows_and_come_back() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, list) in [("fence_list.txt", "fence"), ("rally_list.txt", "rally")] {
        let from = corpus().join(name);
        let to = folder.path().join("list.txt");
        convert(&from, &to, &[]).expect("converted");
        let (was, is) = (read(&from).expect("a list"), read(&to).expect("rows"));
        assert_eq!((was.fence, was.rally), (is.fence, is.rally), "{name}");
        let first = fs::read_to_string(&to).expect("text");
        assert!(first.starts_with("QGC WPL 110\n0\t0\t"), "{first}");
        // Out of a plan by name.
        let plan = folder.path().join("list.plan");
        convert(&from, &plan, &["--home", HOME]).expect("converted");
        convert(&plan, &to, &["--list", list]).expect("converted");
        let back = read(&to).expect("rows");
        assert!(back.is_list(), "{name}");
    }
}

/// Rows have no home at 0, 0: that is a blank row.
#[test]
fn a_home_that_does_not_come_back_is_named_in_degrees_and_metres() {
    let folder = tempfile::tempdir().expect("a folder");
    let rows = ["0 1 0 16 0 0 0 0 0 0 0 1", "1 0 3 22 0 0 0 0 47 8 50 1"];
    let from = waypoints(folder.path(), "a.waypoints", &rows);
    let to = folder.path().join("b.waypoints");
    let flags = ["--autopilot", "ardupilot", "--home", "0,0,100.5"];
    let report = convert(&from, &to, &flags).expect("converted");
    let expected = "home: latitude 0, longitude 0 degrees, 100.5 m above sea level becomes none";
    assert!(said(&report, "not_kept").contains(expected), "{report:#}");
}

#[test]
fn what_cannot_be_done_has_its_exit_code_and_leaves_no_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let good = corpus().join("good.waypoints");
    let copy = folder.path().join("copy.waypoints");
    fs::copy(&good, &copy).expect("copied");
    let there = |name: &str| folder.path().join(name);
    let code =
        |from: &Path, to: &Path, flags: &[&str]| convert(from, to, flags).expect_err("refused").0;
    assert_eq!(code(&copy, &copy, &[]), Some(2));
    assert_eq!(
        fs::read(&copy).expect("kept"),
        fs::read(&good).expect("good")
    );
    assert_eq!(code(&good, &there("a.gpx"), &[]), Some(2));
    assert_eq!(code(&good, &there("a.plan"), &["--list", "fence"]), Some(2));
    assert_eq!(code(&there("none.plan"), &there("a.plan"), &[]), Some(3));
    assert_eq!(
        code(&corpus().join("gpx.waypoints"), &there("a.plan"), &[]),
        Some(3)
    );
    let no_home = corpus().join("no_home_120.waypoints");
    let (exit, errors) = convert(&no_home, &there("a.plan"), &[]).expect_err("refused");
    assert!(exit == Some(3) && errors.contains("--home"), "{errors}");
    fs::create_dir(there("folder.plan")).expect("a folder");
    assert_eq!(code(&good, &there("folder.plan"), &[]), Some(1));
    assert_eq!(code(&good, &copy.join("a.plan"), &[]), Some(1));
    let mut left: Vec<_> = fs::read_dir(folder.path())
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name())
        .collect();
    left.sort();
    assert_eq!(left, ["copy.waypoints", "folder.plan"]);
}

#[test]
fn altitudes_that_the_file_does_not_tell_are_drawn_flat_and_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let map = folder.path().join("a.geojson");
    let features = |map: &Path| -> Vec<Value> {
        let json: Value = serde_json::from_slice(&fs::read(map).expect("a map")).expect("JSON");
        json["features"].as_array().expect("features").clone()
    };
    let from = corpus().join("terrain_frame.waypoints");
    let report = convert(&from, &map, &[]).expect("converted");
    assert!(said(&report, "not_kept").contains("altitude above the sea is not known"));
    let all = features(&map);
    let route = all.iter().find(|f| f["properties"]["kind"] == "route");
    let places = &route.expect("a route")["geometry"]["coordinates"];
    let mut places = places.as_array().expect("places").iter();
    assert!(places.all(|place| place.as_array().is_some_and(|place| place.len() == 2)));
    // Without a home an altitude above it is no altitude above the sea; with one it is.
    let from = corpus().join("no_home_120.waypoints");
    convert(&from, &map, &[]).expect("converted");
    let amsl = |all: &[Value]| -> Vec<Value> {
        let items = all.iter().filter(|f| f["properties"]["kind"] == "item");
        items.map(|f| f["properties"]["amsl_m"].clone()).collect()
    };
    assert!(amsl(&features(&map)).iter().all(Value::is_null));
    convert(&from, &map, &["--home", HOME]).expect("converted");
    assert_eq!(amsl(&features(&map))[0], 488.0 + 80.0);
}

#[test]
fn other_readers_find_the_mission_in_the_maps() {
    let Some(python) = peers::python() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    for name in [
        "good.plan",
        "fence.plan",
        "jump.waypoints",
        "fence_list.txt",
        "terrain_frame.waypoints",
    ] {
        let from = corpus().join(name);
        let was = read(&from).expect("a mission");
        for (ending, script) in [("kml", "read_kml.py"), ("geojson", "read_geojson.py")] {
            let map = folder.path().join(format!("map.{ending}"));
            convert(&from, &map, &[]).expect("converted");
            let found = peers::run(&python, script, &[&map.display().to_string()]);
            let points = found["geometries"]["Point"].as_u64().unwrap_or(0);
            let outlines = found["geometries"]["Polygon"].as_u64().unwrap_or(0);
            let placed = |items: &[Item]| {
                let placed = items.iter().filter(|item| {
                    item.place().is_some()
                        && (item.x, item.y) != (0, 0)
                        && !(5001..=5004).contains(&item.command)
                });
                u64::try_from(placed.count()).expect("a count")
            };
            let home = u64::from(was.home.is_some());
            let wanted = home + placed(&was.items) + placed(&was.fence) + placed(&was.rally);
            assert_eq!(points, wanted, "{name} {ending}: {found:#}");
            let fence = was.fence.iter().any(|item| item.command > 5000);
            assert_eq!(outlines > 0, fence, "{name} {ending}: {found:#}");
        }
    }
}

/// `ModeAuto::loc_from_cmd`: the review flies it at the altitude before it.
#[test]
fn an_arducopter_waypoint_of_altitude_zero_is_drawn_at_the_altitude_before_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let mission = waypoints(
        folder.path(),
        "m.waypoints",
        &[
            "0 1 0 16 0 0 0 0 47.0 7.45 400 1",
            "1 0 3 22 0 0 0 0 47.0 7.45 60 1",
            "2 0 3 16 0 0 0 0 47.005 7.45 80 1",
            "3 0 3 16 0 0 0 0 47.01 7.45 0 1",
            "4 0 3 82 0 0 0 0 47.02 7.45 0 1",
            "5 0 3 21 0 0 0 0 47.02 7.45 0 1",
        ],
    );
    let drawn = |flags: &[&str]| {
        let map = folder.path().join("m.geojson");
        convert(&mission, &map, flags).expect("converted");
        let text = fs::read_to_string(map).expect("written");
        let map: Value = serde_json::from_str(&text).expect("JSON");
        let features = map["features"].as_array().expect("features");
        let items = features
            .iter()
            .map(|feature| &feature["properties"])
            .filter(|properties| properties["kind"] == "item");
        items
            .map(|properties| properties["amsl_m"].as_f64())
            .collect::<Vec<_>>()
    };
    let home = Some(400.0);
    assert_eq!(
        drawn(&["--autopilot", "ardupilot"]),
        [Some(460.0), Some(480.0), Some(480.0), Some(480.0), home]
    );
    assert_eq!(
        drawn(&["--autopilot", "px4"]),
        [Some(460.0), Some(480.0), home, home, home]
    );
}

fn placemark(name: &str, corners: &str) -> String {
    format!(
        "<Placemark><name>{name}</name><Polygon><outerBoundaryIs><LinearRing><coordinates>{corners}</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark>"
    )
}

#[test]
fn folders_nested_too_deep_in_kml_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let zone = placemark("a", "7,47 7.01,47 7,47.01 7,47");
    for (depth, code) in [(20, Some(0)), (1500, Some(3)), (200_000, Some(3))] {
        let (open, close) = ("<Folder>".repeat(depth), "</Folder>".repeat(depth));
        let nesting = format!("<kml><Document>{open}{zone}{close}</Document></kml>");
        let nested = folder.path().join("nested.kml");
        fs::write(&nested, nesting).expect("written");
        let to = folder.path().join("o.geojson");
        let files = [&nested, &to].map(|path| path.display().to_string());
        let output = sortie(Path::new("."), &["convert", &files[0], &files[1]]);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), code, "{depth}: {said}");
        assert!(code == Some(0) || said.contains("nested"), "{said}");
    }
}

#[test]
fn zones_that_are_lost_in_a_conversion_are_an_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let whole = placemark("whole", "7,47 7.01,47 7,47.01 7,47");
    let broken = placemark("broken", "7,47 7.01,47");
    for (zones, code, count) in [
        (whole.clone(), Some(0), 1),
        (whole + &broken, Some(3), 1),
        (broken, Some(3), 0),
    ] {
        let from = folder.path().join("z.kml");
        fs::write(&from, format!("<kml><Document>{zones}</Document></kml>")).expect("written");
        let to = folder.path().join("z.geojson");
        let files = [&from, &to].map(|path| path.display().to_string());
        for flags in [&[][..], &["--json"]] {
            let arguments = [&["convert", &files[0], &files[1]], flags].concat();
            let output = sortie(Path::new("."), &arguments);
            let said = text(&output.stderr);
            assert_eq!(output.status.code(), code, "{said}");
            assert!(
                code == Some(0) || said.contains("1 shape is not in"),
                "{said}"
            );
        }
        let written = fs::read_to_string(&to).expect("written");
        assert_eq!(written.matches("Polygon").count(), count, "{written}");
    }
}

#[test]
fn heights_that_zones_do_not_keep_are_counted_and_shapes_are_counted_by_kind() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let high = "8.0,47.0,900 8.1,47.0,900 8.1,47.1,900 8.0,47.0,900";
    let ring = format!(
        "<outerBoundaryIs><LinearRing><coordinates>{high}</coordinates></LinearRing></outerBoundaryIs>"
    );
    let mode = "<altitudeMode>absolute</altitudeMode>";
    let geometries = [
        // Kept as a ceiling, lost, lost, and on the ground whatever its coordinates say.
        format!("<Polygon><extrude>1</extrude>{mode}{ring}</Polygon>"),
        format!("<Polygon>{mode}{ring}</Polygon>"),
        format!("<LineString>{mode}<coordinates>{high}</coordinates></LineString>"),
        "<Point><coordinates>8.0,47.0,900</coordinates></Point>".to_owned(),
    ];
    let marks = geometries.map(|of| format!("<Placemark>{of}</Placemark>"));
    let kml = format!("<kml><Document>{}</Document></kml>", marks.concat());
    fs::write(at("zones.kml"), kml).unwrap();
    let output = sortie(folder.path(), &["convert", "zones.kml", "zones.geojson"]);
    let (out, errors) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(0), "{errors}");
    assert!(
        errors.contains("2 of 4 shapes: the heights of their corners are not kept"),
        "{errors}"
    );
    assert!(
        out.contains("4 shapes (2 polygons, 1 line, 1 point)"),
        "{out}"
    );
    let written = fs::read_to_string(at("zones.geojson")).unwrap();
    assert!(written.contains("900"), "{written}");
    // What has floors and ceilings loses nothing.
    let output = sortie(
        folder.path(),
        &["convert", "zones.geojson", "again.geojson"],
    );
    assert_eq!(text(&output.stderr), "");
}

#[test]
fn circles_that_ardupilot_stores_otherwise_are_named_by_convert_and_review() {
    let folder = tempfile::tempdir().unwrap();
    let rows = [
        "0 1 0 16 0 0 0 0 46.0 8.0 500 1",
        "1 0 3 22 0 0 0 0 0 0 50 1",
        "2 0 3 18 300 0 3000 0 46.001 8.0 50 1",
        "3 0 3 21 0 0 0 0 46.001 8.0 0 1",
    ];
    let input = waypoints(folder.path(), "m.waypoints", &rows);
    let stored =
        "item 2: ArduPilot stores 255 turns instead of 300, a radius of 2550 m instead of 3000 m";
    let output = folder.path().join("m.plan");
    let report = convert(&input, &output, &[]).expect("converted");
    assert_eq!(said(&report, "stored_otherwise"), stored);
    let report = convert(&input, &output, &["--autopilot", "px4"]).expect("converted");
    assert_eq!(said(&report, "stored_otherwise"), "");
    let reviewed = sortie(folder.path(), &["review", "m.waypoints", "--no-terrain"]);
    let errors = text(&reviewed.stderr);
    assert!(
        errors.contains(&format!("warning: m: {stored}; judged as stored")),
        "{errors}"
    );
}

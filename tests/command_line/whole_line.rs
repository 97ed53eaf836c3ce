//! The whole line over real terrain: one spec in, verified missions on board three vehicles.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

use assert_cmd::cargo::cargo_bin;
use serde_json::Value;
use tempfile::TempDir;

fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn sortie(threads: &str, arguments: &[&str]) -> Output {
    Command::new(cargo_bin("sortie"))
        .current_dir(repository())
        .env("RAYON_NUM_THREADS", threads)
        .args(arguments)
        .output()
        .expect("sortie runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Jacksboro, planned and uploaded once for all tests of this file.
struct Planned {
    folder: TempDir,
    output: Output,
}

static JACKSBORO: LazyLock<Planned> = LazyLock::new(|| {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("jacksboro");
    let output = sortie(
        "2",
        &[
            "plan",
            "missions/jacksboro.yaml",
            "--upload",
            "--out",
            &out.display().to_string(),
        ],
    );
    Planned { folder, output }
});

impl Planned {
    fn out(&self) -> PathBuf {
        self.folder.path().join("jacksboro")
    }

    fn json(&self, name: &str) -> Value {
        serde_json::from_slice(&fs::read(self.out().join(name)).expect(name)).expect("JSON")
    }

    /// Copies the `.waypoints` files aside, so that one can be changed.
    fn copies(&self) -> TempDir {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for id in ids(&self.json("plan.json")) {
            let name = format!("{id}.waypoints");
            fs::copy(self.out().join(&name), folder.path().join(&name)).expect("a copy");
        }
        folder
    }
}

fn ids(plan: &Value) -> Vec<String> {
    let vehicles = plan["vehicles"].as_array().expect("vehicles");
    vehicles
        .iter()
        .map(|vehicle| vehicle["id"].as_str().expect("an id").to_owned())
        .collect()
}

fn review(folder: &Path, extension: &str) -> Output {
    let mut files: Vec<String> = fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == extension))
        .map(|path| path.display().to_string())
        .collect();
    files.sort();
    let mut arguments = vec!["review", "missions/jacksboro.yaml", "--json"];
    arguments.extend(files.iter().map(String::as_str));
    sortie("2", &arguments)
}

/// Rewrites columns of one row of a `.waypoints` file.
fn edit(file: &Path, row: usize, columns: &[(usize, String)]) {
    let before = fs::read_to_string(file).expect("a mission");
    let mut lines: Vec<String> = before.lines().map(str::to_owned).collect();
    let mut fields: Vec<String> = lines[row + 1].split('\t').map(str::to_owned).collect();
    for (column, value) in columns {
        fields[*column].clone_from(value);
    }
    lines[row + 1] = fields.join("\t");
    fs::write(file, lines.join("\n") + "\n").expect("the mission is written");
}

/// Rows of waypoints (command 16, not home) as (row, lat, lon, alt).
fn waypoints(file: &Path) -> Vec<(usize, f64, f64, f64)> {
    let content = fs::read_to_string(file).expect("a mission");
    content
        .lines()
        .skip(1)
        .map(|line| line.split('\t').map(str::to_owned).collect::<Vec<_>>())
        .filter(|fields| fields[3] == "16" && fields[0] != "0")
        .map(|fields| {
            let number = |i: usize| fields[i].parse::<f64>().expect("a number");
            (
                fields[0].parse().expect("a row"),
                number(8),
                number(9),
                number(10),
            )
        })
        .collect()
}

/// The failed margins of a review that must fail, each with item, place and time.
fn failures(output: &Output) -> Vec<Value> {
    assert_eq!(
        output.status.code(),
        Some(4),
        "{}{}",
        text(&output.stdout),
        text(&output.stderr)
    );
    let document: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(document["verdict"], "fail");
    document["margins"]
        .as_array()
        .expect("margins")
        .iter()
        .filter(|m| m["ok"] == false)
        .cloned()
        .collect()
}

fn names_a_place(margin: &Value) -> bool {
    ["lat_deg", "lon_deg", "amsl_m", "t_s", "item"]
        .iter()
        .all(|key| margin["at"][key].is_number())
}

#[test]
fn jacksboro_is_planned_verified_written_uploaded_and_read_back() {
    let planned = &*JACKSBORO;
    let (stdout, stderr) = (text(&planned.output.stdout), text(&planned.output.stderr));
    assert_eq!(planned.output.status.code(), Some(0), "{stdout}{stderr}");
    let ids = ids(&planned.json("plan.json"));
    assert_eq!(ids.len(), 3);
    let record: Value = serde_json::from_slice(
        &fs::read(planned.folder.path().join("jacksboro.runs/upload.json")).unwrap(),
    )
    .unwrap();
    for (index, id) in ids.iter().enumerate() {
        assert!(
            stdout.contains(id.as_str()),
            "{id} is not in the table:\n{stdout}"
        );
        assert_eq!(record["vehicles"][index]["verdict"], "verified");
        for extension in ["waypoints", "plan", "params"] {
            assert!(planned.out().join(format!("{id}.{extension}")).is_file());
        }
    }
    assert_eq!(planned.json("review.json")["verdict"], "pass");
    assert!(
        planned.out().join("terrain/jacksboro.tif").is_file(),
        "the terrain is not beside the spec"
    );
}

#[test]
fn the_files_alone_reach_the_same_verdict() {
    let planned = &*JACKSBORO;
    let written = planned.json("review.json");
    for extension in ["waypoints", "plan"] {
        let output = review(&planned.out(), extension);
        assert_eq!(
            output.status.code(),
            Some(0),
            "{extension}: {}",
            text(&output.stderr)
        );
        let judged: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(judged["verdict"], written["verdict"]);
        let count = |document: &Value| document["margins"].as_array().unwrap().len();
        if extension == "plan" {
            assert_eq!(
                judged["margins"], written["margins"],
                ".plan keeps everything"
            );
        } else {
            assert!(
                count(&judged) > 0 && text(&output.stderr).contains("fence"),
                "the loss is not named"
            );
        }
    }
}

#[test]
fn a_waypoint_moved_into_a_threat_is_found() {
    let planned = &*JACKSBORO;
    let folder = planned.copies();
    let id = &ids(&planned.json("plan.json"))[0];
    let file = folder.path().join(format!("{id}.waypoints"));
    let route = waypoints(&file);
    let (row, ..) = route[route.len() / 2];
    // The first threat of the mission, read from the spec as written.
    let spec = fs::read_to_string(repository().join("missions/jacksboro.yaml")).unwrap();
    let line = spec
        .lines()
        .find(|line| line.contains("radius_m:") && line.contains("id:"))
        .unwrap();
    let number = |key: &str| {
        let rest = &line[line.find(key).unwrap() + key.len()..];
        rest.split([',', '}']).next().unwrap().trim().to_owned()
    };
    edit(&file, row, &[(8, number(" lat:")), (9, number(" lon:"))]);
    let failed = failures(&review(folder.path(), "waypoints"));
    let threat = failed
        .iter()
        .find(|m| m["what"].as_str().unwrap().contains(number("id:").as_str()));
    let threat = threat.unwrap_or_else(|| panic!("no threat among {failed:?}"));
    assert!(names_a_place(threat), "{threat}");
    assert_eq!(threat["vehicle"], **id);
    let item = usize::try_from(threat["at"]["item"].as_u64().unwrap()).unwrap();
    assert!(
        (row..=row + 1).contains(&item),
        "item {item} is not beside the moved row {row}"
    );
}

#[test]
fn a_waypoint_moved_under_the_ridge_is_found() {
    let planned = &*JACKSBORO;
    let folder = planned.copies();
    let id = &ids(&planned.json("plan.json"))[0];
    let file = folder.path().join(format!("{id}.waypoints"));
    // Where the clearance is least, the ground is near.
    let written = planned.json("review.json");
    let margins = written["margins"].as_array().unwrap();
    let least = margins
        .iter()
        .find(|m| m["vehicle"] == **id && m["what"] == "terrain clearance");
    let near = usize::try_from(least.unwrap()["at"]["item"].as_u64().unwrap()).unwrap();
    let route = waypoints(&file);
    let (row, _, _, amsl_m) = *route
        .iter()
        .min_by_key(|(row, ..)| row.abs_diff(near))
        .unwrap();
    edit(&file, row, &[(10, format!("{}", amsl_m - 150.0))]);
    let failed = failures(&review(folder.path(), "waypoints"));
    let clearance = failed
        .iter()
        .find(|m| m["what"].as_str().unwrap().contains("clearance"));
    let clearance = clearance.unwrap_or_else(|| panic!("no clearance among {failed:?}"));
    assert!(names_a_place(clearance), "{clearance}");
    assert!(clearance["value"].as_f64().unwrap() < clearance["limit"].as_f64().unwrap());
    let item = usize::try_from(clearance["at"]["item"].as_u64().unwrap()).unwrap();
    assert!(
        item.abs_diff(row) <= 1,
        "item {item} is not beside the moved row {row}"
    );
}

#[test]
fn a_vehicle_moved_onto_the_path_of_another_is_found() {
    let planned = &*JACKSBORO;
    let folder = planned.copies();
    let ids = ids(&planned.json("plan.json"));
    // The second vehicle flies the mission of the first.
    let first = folder.path().join(format!("{}.waypoints", ids[0]));
    fs::copy(first, folder.path().join(format!("{}.waypoints", ids[1]))).unwrap();
    let failed = failures(&review(folder.path(), "waypoints"));
    let separation = failed
        .iter()
        .find(|m| m["what"] == "separation")
        .expect("separation fails");
    assert!(names_a_place(separation), "{separation}");
    assert!(separation["other"].is_string());
}

#[test]
fn the_same_seed_gives_the_same_bytes_at_any_thread_count() {
    let read = |threads: &str| {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let output = sortie(
            threads,
            &[
                "plan",
                "missions/jacksboro.yaml",
                "--out",
                &out.display().to_string(),
            ],
        );
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let mut files = BTreeMap::new();
        for entry in fs::read_dir(&out).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_file() && name != "timing.json" {
                files.insert(name, fs::read(&path).unwrap());
            }
        }
        files
    };
    let one = read("1");
    assert!(one.len() > 10);
    for threads in ["2", "8"] {
        let many = read(threads);
        assert_eq!(
            one.keys().collect::<Vec<_>>(),
            many.keys().collect::<Vec<_>>()
        );
        for (name, bytes) in &one {
            assert!(
                bytes == &many[name],
                "{name} differs between 1 and {threads} threads"
            );
        }
    }
}

#[test]
fn every_shipped_mission_plans_and_passes() {
    for mission in ["first", "harbour"] {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out").display().to_string();
        let output = sortie(
            "2",
            &[
                "plan",
                &format!("missions/{mission}.yaml"),
                "--upload",
                "--out",
                &out,
            ],
        );
        assert_eq!(
            output.status.code(),
            Some(0),
            "{mission}: {}{}",
            text(&output.stdout),
            text(&output.stderr)
        );
    }
}

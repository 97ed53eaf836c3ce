//! `sortie terrain` as a user meets it: info, fetch from a server on this machine, export for ArduPilot.

use crate::support::{command, peers, tile_server};
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output};

use command::{sortie, text};
use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::{Value, json};
use sortie::geodesy::LatLon;
use sortie::spec::SpecFile;
use sortie::world;
use tempfile::TempDir;
use tile_server::TileServer;

/// A copter beside the corner of four tiles; the margin around its area touches all of them.
const SPEC: &str = "\
sortie: 1
name: corner
area:
  south_west: {lat: 36.95, lon: -84.06}
  north_east: {lat: 36.99, lon: -84.01}
  min_agl_m: 50
  max_amsl_m: 4000
terrain: {folder: tiles}
vehicles:
  - id: alpha
    sysid: 1
    autopilot: ardupilot
    link: sim
    start: {lat: 36.96, lon: -84.05, agl_m: 80}
    goal: {lat: 36.98, lon: -84.02, agl_m: 80}
    finish: land
    speed_mps: 12
";

fn folder_with(spec: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("corner.yaml"), spec).expect("written");
    folder
}

/// A tile of 3 arc-seconds with heights of its own.
fn tile(base: i16) -> Vec<u8> {
    (0..1201_i16)
        .flat_map(|row| (0..1201_i16).map(move |column| base + (row * 7 + column * 3) % 50))
        .flat_map(i16::to_be_bytes)
        .collect()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).expect("packed");
    encoder.finish().expect("packed")
}

/// `terrain fetch` from the server, whatever proxies this machine has.
fn fetch(folder: &Path, server: &TileServer) -> Output {
    let url = format!("http://{}/{{ns}}{{lat}}/{{tile}}.hgt.gz", server.address);
    let mut command = Command::new(assert_cmd::cargo::cargo_bin("sortie"));
    for name in ["http_proxy", "HTTP_PROXY", "all_proxy", "ALL_PROXY"] {
        command.env_remove(name);
    }
    command
        .current_dir(folder)
        .args(["terrain", "fetch", "corner.yaml", "--url", &url])
        .output()
        .expect("sortie runs")
}

/// A server of the four tiles.
fn four_tiles() -> TileServer {
    let server = TileServer::start();
    for (base, name) in (1..).zip(["N36/N36W085", "N36/N36W084", "N37/N37W085", "N37/N37W084"]) {
        server.put(
            &format!("/{name}.hgt.gz"),
            gzip(&tile(300 * base)),
            Some("\"1\""),
        );
    }
    server
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| {
            entry
                .expect("a file")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    names.sort();
    names
}

#[test]
fn info_tells_what_each_file_holds() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut bytes = tile(400);
    bytes[..2].copy_from_slice(&i16::MIN.to_be_bytes());
    fs::write(folder.path().join("N36W085.hgt.gz"), gzip(&bytes)).expect("written");
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/geotiff/egm96.tif");
    fs::copy(fixture, folder.path().join("alps.tif")).expect("copied");
    let output = sortie(folder.path(), &["terrain", "info", ".", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let found: Value = serde_json::from_slice(&output.stdout).expect("one document");
    let (tile, alps) = (&found["files"][0], &found["files"][1]);
    assert_eq!(tile["format"], "SRTM tile, gzip");
    assert_eq!(
        (&tile["rows"], &tile["columns"], &tile["voids"]),
        (&json!(1201), &json!(1201), &json!(1))
    );
    assert_eq!(
        tile["south_west"],
        json!({ "lat_deg": 36.0, "lon_deg": -85.0 })
    );
    assert_eq!(
        tile["north_east"],
        json!({ "lat_deg": 37.0, "lon_deg": -84.0 })
    );
    assert_eq!(
        (&tile["lowest_amsl_m"], &tile["highest_amsl_m"]),
        (&json!(400.0), &json!(449.0))
    );
    assert_eq!(alps["format"], "GeoTIFF");
    assert_eq!(
        (&alps["lowest_amsl_m"], &alps["highest_amsl_m"]),
        (&json!(400.0), &json!(457.0))
    );
    assert!(
        alps["datum"].as_str().expect("words").contains("EPSG:5773"),
        "{alps}"
    );
    let words = text(&sortie(folder.path(), &["terrain", "info", "N36W085.hgt.gz"]).stdout);
    for part in [
        "1201 x 1201 posts every 3.000\"",
        "400.0 m to 449.0 m, 1 void",
        "above EGM96",
    ] {
        assert!(words.contains(part), "{part:?} is not in: {words}");
    }
}

/// The citation of the vertical system is text out of the file, as is its name.
#[cfg(unix)]
#[test]
fn what_a_file_says_of_itself_commands_no_terminal() {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/geotiff");
    let mut bytes = fs::read(fixtures.join("egm96.tif")).expect("a fixture");
    // The last GeoKey, VerticalGeodeticCRS 5773, becomes VerticalCitation (4097): 22 bytes
    // of GeoAsciiParams (34737), which follow the keys.
    let crs = [4096_u16, 0, 1, 5773].map(u16::to_le_bytes).concat();
    let at = bytes.windows(8).position(|eight| eight == crs);
    let at = at.expect("the key of the vertical system");
    let citation = [4097_u16, 34737, 22, 0].map(u16::to_le_bytes).concat();
    bytes[at..at + 8].copy_from_slice(&citation);
    bytes[at + 8..at + 30].copy_from_slice(b"\x1b[2K\r landed as plann|");
    let folder = tempfile::tempdir().expect("a folder");
    let name = "a\u{1b}[2K\rb\nlanded as planned.tif";
    fs::write(folder.path().join(name), &bytes).expect("written");
    let output = sortie(folder.path(), &["terrain", "info", name]);
    let words = text(&output.stdout);
    assert!(
        words.starts_with("a\\u{1b}[2K\\rb\\nlanded as planned.tif: "),
        "{words}"
    );
    assert!(words.contains("\\u{1b}[2K\\r"), "{words}");
    assert!(!words.contains(['\u{1b}', '\r']), "{words}");
    assert_eq!(words.lines().count(), 5, "{words}");
    let missing = sortie(folder.path(), &["terrain", "info", "x\nlanded.tif"]);
    let said = text(&missing.stderr);
    assert!(said.starts_with("x\\nlanded.tif: "), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
}

#[test]
fn info_tells_of_the_good_files_and_of_the_bad_ones() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("N36W085.hgt"), tile(400)).expect("written");
    fs::write(folder.path().join("N37W085.hgt"), b"short").expect("written");
    let output = sortie(folder.path(), &["terrain", "info", "."]);
    assert_eq!(output.status.code(), Some(3));
    assert!(text(&output.stdout).contains("N36W085.hgt: SRTM tile"));
    assert!(
        text(&output.stderr).contains("N37W085.hgt: 5 bytes"),
        "{}",
        text(&output.stderr)
    );
}

#[test]
fn fetch_gets_the_tiles_of_a_spec_and_asks_for_none_twice() {
    let (folder, server) = (folder_with(SPEC), four_tiles());
    let output = fetch(folder.path(), &server);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let tiles = [
        "N36W084.hgt.gz",
        "N36W085.hgt.gz",
        "N37W084.hgt.gz",
        "N37W085.hgt.gz",
    ];
    assert_eq!(names(&folder.path().join("tiles")), tiles);
    let asked = server.asked();
    assert_eq!(asked.len(), 4, "{asked:?}");
    let check = sortie(folder.path(), &["check", "corner.yaml"]);
    assert_eq!(check.status.code(), Some(0), "{}", text(&check.stderr));
    let again = fetch(folder.path(), &server);
    assert!(text(&again.stdout).contains("there already"));
    assert!(server.asked().is_empty());
}

#[test]
fn a_transfer_that_breaks_off_is_gone_on_with() {
    let (folder, server) = (folder_with(SPEC), four_tiles());
    server.cut(10_000);
    server.cut(5000);
    let output = fetch(folder.path(), &server);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let starts: Vec<usize> = server.asked().iter().map(|(_, start, _)| *start).collect();
    assert_eq!(starts, [0, 10_000, 15_000, 0, 0, 0]);
    assert!(text(&output.stdout).contains("resumed"));
    let first = fs::read(folder.path().join("tiles/N36W085.hgt.gz")).expect("a tile");
    assert_eq!(first, gzip(&tile(300)));
}

#[test]
fn what_arrived_is_gone_on_with_by_the_next_run_unless_the_file_has_changed() {
    for (version, starts) in [("\"1\"", vec![20_000, 0, 0, 0]), ("\"2\"", vec![0; 4])] {
        let (folder, server) = (folder_with(SPEC), four_tiles());
        for _ in 0..4 {
            server.cut(5000);
        }
        let output = fetch(folder.path(), &server);
        assert_eq!(output.status.code(), Some(5));
        assert!(
            text(&output.stderr).contains("the transfer broke off"),
            "{}",
            text(&output.stderr)
        );
        assert_eq!(
            names(&folder.path().join("tiles")),
            [".fetch"],
            "nothing half done is a tile"
        );
        server.asked();
        let changed = gzip(&tile(if version == "\"1\"" { 300 } else { 700 }));
        server.put("/N36/N36W085.hgt.gz", changed.clone(), Some(version));
        let output = fetch(folder.path(), &server);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let asked: Vec<usize> = server.asked().iter().map(|(_, start, _)| *start).collect();
        assert_eq!(asked, starts);
        assert_eq!(
            fs::read(folder.path().join("tiles/N36W085.hgt.gz")).expect("a tile"),
            changed
        );
        assert!(!folder.path().join("tiles/.fetch").exists());
    }
}

#[test]
fn without_a_version_a_transfer_is_begun_again() {
    let (folder, server) = (folder_with(SPEC), four_tiles());
    server.put("/N36/N36W085.hgt.gz", gzip(&tile(300)), None);
    server.cut(10_000);
    assert_eq!(fetch(folder.path(), &server).status.code(), Some(0));
    let starts: Vec<usize> = server.asked().iter().map(|(_, start, _)| *start).collect();
    assert_eq!(starts, [0, 0, 0, 0, 0]);
}

#[test]
fn what_is_no_tile_is_never_written() {
    let page = b"<html>Please log in</html>".to_vec();
    let mut bent = gzip(&tile(300));
    let middle = bent.len() / 2;
    bent[middle] ^= 1;
    for bytes in [page, bent, gzip(&[0; 1000])] {
        let (folder, server) = (folder_with(SPEC), four_tiles());
        server.put("/N36/N36W085.hgt.gz", bytes, Some("\"1\""));
        let output = fetch(folder.path(), &server);
        assert_eq!(output.status.code(), Some(3), "{}", text(&output.stderr));
        assert!(
            text(&output.stderr).contains("N36W085.hgt.gz"),
            "{}",
            text(&output.stderr)
        );
        assert!(names(&folder.path().join("tiles")).is_empty());
    }
}

#[test]
fn a_tile_that_the_server_lacks_fails_where_the_area_is_and_is_noted_in_the_margin() {
    let (folder, server) = (folder_with(SPEC), four_tiles());
    server
        .state
        .lock()
        .expect("not poisoned")
        .files
        .remove("/N37/N37W085.hgt.gz");
    let output = fetch(folder.path(), &server);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(
        text(&output.stderr).contains("only the margin"),
        "{}",
        text(&output.stderr)
    );
    let (folder, server) = (folder_with(SPEC), four_tiles());
    server
        .state
        .lock()
        .expect("not poisoned")
        .files
        .remove("/N36/N36W085.hgt.gz");
    let output = fetch(folder.path(), &server);
    assert_eq!(output.status.code(), Some(5));
    assert!(text(&output.stderr).contains("N36/N36W085.hgt.gz: the server has no such file"));
    let (folder, server) = (folder_with(SPEC), four_tiles());
    server.state.lock().expect("not poisoned").status = Some(403);
    let output = fetch(folder.path(), &server);
    assert_eq!(output.status.code(), Some(5));
    assert!(
        text(&output.stderr).contains("answers 403"),
        "{}",
        text(&output.stderr)
    );
}

#[test]
fn fetch_needs_a_folder_in_the_spec_and_a_server_that_is_there() {
    let folder = folder_with(&SPEC.replace("{folder: tiles}", "{flat: {amsl_m: 300}}"));
    let server = four_tiles();
    let output = fetch(folder.path(), &server);
    assert_eq!(output.status.code(), Some(3));
    assert!(text(&output.stderr).contains("terrain: {folder: tiles}"));
    let folder = folder_with(SPEC);
    let url = "http://127.0.0.1:9/{tile}.hgt";
    let output = sortie(
        folder.path(),
        &["terrain", "fetch", "corner.yaml", "--url", url],
    );
    assert_eq!(output.status.code(), Some(5), "{}", text(&output.stderr));
}

/// Hills, and an area across four degree squares.
const HILLS: &str = "\
sortie: 1
name: hills
area:
  south_west: {lat: -0.06, lon: -0.07}
  north_east: {lat: 0.05, lon: 0.04}
  min_agl_m: 50
  max_amsl_m: 4000
terrain:
  analytic:
    base_amsl_m: 200
    hills:
      - {lat: 0.01, lon: 0.01, height_m: 900, radius_m: 5000}
      - {lat: -0.03, lon: -0.05, height_m: 400, radius_m: 4000}
vehicles:
  - id: alpha
    sysid: 1
    autopilot: ardupilot
    link: sim
    start: {lat: -0.05, lon: -0.06, agl_m: 80}
    goal: {lat: 0.04, lon: 0.03, agl_m: 80}
    finish: land
    speed_mps: 12
";

/// What the vehicle reads at places of the area, by a reader that shares no code.
fn read_back(python: &Path, folder: &Path, places: &[[f64; 2]], spacing: &str) -> Vec<Option<f64>> {
    let folder = folder.display().to_string();
    let places = serde_json::to_string(places).expect("numbers");
    let answer = peers::run(python, "read_dat.py", &[&folder, spacing, &places]);
    serde_json::from_value(answer).expect("heights")
}

/// Places all over a box, its corners included.
fn all_over(south: f64, west: f64, north: f64, east: f64) -> Vec<[f64; 2]> {
    let share = |step: u32| f64::from(step) / 24.0;
    let steps = (0..=24).flat_map(|up| (0..=24).map(move |right| (share(up), share(right))));
    steps
        .map(|(up, right)| [south + (north - south) * up, west + (east - west) * right])
        .collect()
}

#[test]
fn the_vehicle_reads_the_ground_of_the_spec_from_the_exported_database() {
    let folder = folder_with(HILLS);
    let output = sortie(folder.path(), &["terrain", "export", "corner.yaml"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("TERRAIN_SPACING 100"));
    let out = folder.path().join("out/hills.terrain");
    assert_eq!(
        names(&out),
        ["N00E000.DAT", "N00W001.DAT", "S01E000.DAT", "S01W001.DAT"]
    );
    let fine = [
        "terrain",
        "export",
        "corner.yaml",
        "--out",
        "fine",
        "--spacing",
        "30",
    ];
    assert_eq!(sortie(folder.path(), &fine).status.code(), Some(0));
    let Some(python) = peers::python() else {
        return;
    };
    let spec = SpecFile::read(&folder.path().join("corner.yaml")).expect("a spec");
    let world = world::load(&spec).expect("a world");
    let places = all_over(-0.06, -0.07, 0.05, 0.04);
    for (folder, spacing) in [(out, "100"), (folder.path().join("fine"), "30")] {
        let heights = read_back(&python, &folder, &places, spacing);
        for ([lat_deg, lon_deg], height) in places.iter().zip(heights) {
            let place = LatLon::new(*lat_deg, *lon_deg).expect("a place");
            let truth = world.terrain.height(place).expect("ground").0;
            let height = height.unwrap_or_else(|| panic!("no height at {place:?}"));
            // Half a metre of rounding, and what a hill bends between two heights.
            assert!(
                (height - truth).abs() < 1.2,
                "{height} at {place:?}, in truth {truth}"
            );
        }
    }
}

#[test]
fn far_from_the_equator_the_vehicle_finds_its_blocks_too() {
    let Some(python) = peers::python() else {
        return;
    };
    for (south, west) in [(59.97, 19.96), (-43.03, 171.4), (36.5, -84.54)] {
        let (north, east) = (south + 0.06, west + 0.09);
        let at = |up: f64, right: f64| format!("lat: {}, lon: {}", south + up, west + right);
        let spec = HILLS
            .replace("lat: -0.06, lon: -0.07", &at(0.0, 0.0))
            .replace("lat: 0.05, lon: 0.04", &at(0.06, 0.09))
            .replace("lat: -0.05, lon: -0.06", &at(0.01, 0.01))
            .replace("lat: 0.04, lon: 0.03", &at(0.05, 0.08))
            .replace("lat: 0.01, lon: 0.01", &at(0.03, 0.03))
            .replace("lat: -0.03, lon: -0.05", &at(0.02, 0.07));
        let folder = folder_with(&spec);
        let output = sortie(folder.path(), &["terrain", "export", "corner.yaml"]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let file = SpecFile::read(&folder.path().join("corner.yaml")).expect("a spec");
        let world = world::load(&file).expect("a world");
        let places = all_over(south, west, north, east);
        let heights = read_back(
            &python,
            &folder.path().join("out/hills.terrain"),
            &places,
            "100",
        );
        for ([lat_deg, lon_deg], height) in places.iter().zip(heights) {
            let place = LatLon::new(*lat_deg, *lon_deg).expect("a place");
            let truth = world.terrain.height(place).expect("ground").0;
            let height = height.unwrap_or_else(|| panic!("no height at {place:?}"));
            assert!(
                (height - truth).abs() < 1.2,
                "{height} at {place:?}, in truth {truth}"
            );
        }
    }
}

/// A spike of one post, 92 m from its neighbours: the database has a height every 100 m.
#[test]
fn export_says_how_far_the_ground_stands_above_what_the_vehicle_will_know() {
    let folder = folder_with(SPEC);
    let tiles = folder.path().join("tiles");
    fs::create_dir(&tiles).expect("a folder");
    let mut bytes: Vec<u8> = std::iter::repeat_n(400_i16, 1201 * 1201)
        .flat_map(i16::to_be_bytes)
        .collect();
    // 36.965 N, 84.035 W.
    let post = 2 * (42 * 1201 + 1158);
    bytes[post..post + 2].copy_from_slice(&600_i16.to_be_bytes());
    fs::write(tiles.join("N36W085.hgt"), bytes).expect("written");
    let export = |spacing: &str| {
        let arguments = [
            "terrain",
            "export",
            "corner.yaml",
            "--out",
            "dat",
            "--spacing",
            spacing,
        ];
        let output = sortie(folder.path(), &arguments);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        text(&output.stderr)
    };
    let told = export("100");
    let (_, rest) = told.split_once("stands up to ").expect("it is told");
    let (hidden_m, place) = rest.split_once(" m higher").expect("metres");
    let hidden_m: f64 = hidden_m.parse().expect("metres");
    assert!(place.contains("at 36.965000, -84.035000"), "{told}");
    assert!(
        !told.contains("left out"),
        "no voids are within the area: {told}"
    );
    // What the vehicle reads at the spike, by a reader that shares no code.
    if let Some(python) = peers::python() {
        let at_spike = [[36.965, -84.035]];
        let read_m = read_back(&python, &folder.path().join("dat"), &at_spike, "100")[0];
        assert!(
            (600.0 - read_m.expect("a height") - hidden_m).abs() < 0.1,
            "{told} {read_m:?}"
        );
    }
    let finer = export("10");
    let (_, rest) = finer.split_once("stands up to ").expect("it is told");
    let (finer_m, _) = rest.split_once(" m higher").expect("metres");
    assert!(finer_m.parse::<f64>().expect("metres") < 30.0, "{finer}");
}

#[test]
fn voids_are_left_out_of_the_database_and_told() {
    let folder = folder_with(SPEC);
    let tiles = folder.path().join("tiles");
    fs::create_dir(&tiles).expect("a folder");
    let mut bytes = tile(400);
    // 0.965 N, 0.965 E of the corner: away from start and goal.
    let post = 2 * (42 * 1201 + 1158);
    bytes[post..post + 2].copy_from_slice(&i16::MIN.to_be_bytes());
    fs::write(tiles.join("N36W085.hgt"), bytes).expect("written");
    let output = sortie(
        folder.path(),
        &["terrain", "export", "corner.yaml", "--out", "dat"],
    );
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(
        text(&output.stderr).contains("left out"),
        "{}",
        text(&output.stderr)
    );
    let Some(python) = peers::python() else {
        return;
    };
    let places = [[36.965, -84.035], [36.98, -84.02]];
    let heights = read_back(&python, &folder.path().join("dat"), &places, "100");
    assert_eq!(heights[0], None, "a void is not 0");
    assert!(heights[1].is_some_and(|height| height > 390.0));
    fs::write(folder.path().join("dat/notes.txt"), b"mine").expect("written");
    let again = sortie(
        folder.path(),
        &["terrain", "export", "corner.yaml", "--out", "dat"],
    );
    assert_eq!(
        again.status.code(),
        Some(1),
        "a folder with something else is kept"
    );
}

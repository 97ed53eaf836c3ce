//! Packed tiles, and folders of tiles as one ground.

use crate::support::command;
use std::fs;
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

use command::{sortie, text};
use flate2::Compression;
use flate2::write::GzEncoder;
use sortie::geodesy::LatLon;
use sortie::world::{Bounds, TerrainError, TerrainGrid, inspect, read_terrain, terrain_files};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// Posts in a degree of the tiles here.
const POSTS: i32 = 1200;

fn place(lat_deg: f64, lon_deg: f64) -> LatLon {
    LatLon { lat_deg, lon_deg }
}

fn bounds(south: f64, west: f64, north: f64, east: f64) -> Option<Bounds> {
    Some(Bounds {
        south_west: place(south, west),
        north_east: place(north, east),
    })
}

/// A height that every tile gives to the post of this row and column of the whole earth: rough, so that
/// a post out of place shows.
fn height(row: i32, column: i32) -> i16 {
    let mixed = (row.wrapping_mul(7919) ^ column.wrapping_mul(104_729)).rem_euclid(1500);
    i16::try_from(mixed).expect("a small number")
}

/// The tile with this south-west corner, degrees.
fn tile(lat: i32, lon: i32) -> Vec<u8> {
    let (north, west) = ((lat + 1) * POSTS, lon * POSTS);
    let posts = (0..=POSTS).flat_map(|down| (0..=POSTS).map(move |right| (down, right)));
    posts
        .flat_map(|(down, right)| height(north - down, west + right).to_be_bytes())
        .collect()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).expect("packed");
    encoder.finish().expect("packed")
}

fn zip(entries: &[(&str, &[u8])]) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in entries {
        archive
            .start_file(*name, SimpleFileOptions::default())
            .expect("an entry");
        archive.write_all(bytes).expect("packed");
    }
    archive.finish().expect("an archive").into_inner()
}

fn put(folder: &Path, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.join(name);
    fs::write(&path, bytes).expect("written");
    path
}

fn refused(path: &Path) -> String {
    read_terrain(path, None).expect_err("refused").to_string()
}

/// Every post of a grid is where the earth has it.
fn is_the_earth(grid: &TerrainGrid) {
    let whole = |degrees: f64| {
        let posts = degrees * f64::from(POSTS);
        assert!((posts - posts.round()).abs() < 1e-6, "{degrees}");
        #[expect(clippy::cast_possible_truncation, reason = "a post of the earth")]
        let post = posts.round() as i32;
        post
    };
    for row in 0..grid.rows {
        for column in 0..grid.columns {
            let truth = height(
                whole(grid.row_lat_deg(row)),
                whole(grid.column_lon_deg(column)),
            );
            assert_eq!(
                grid.node_m(row, column),
                Some(f64::from(truth)),
                "{row}, {column}"
            );
        }
    }
}

#[test]
fn packed_tiles_are_read_as_plain_ones() {
    let folder = tempfile::tempdir().expect("a folder");
    let bytes = tile(36, -85);
    let plain = put(folder.path(), "N36W085.hgt", &bytes);
    let gz = put(folder.path(), "N36W085.hgt.gz", &gzip(&bytes));
    let archive = zip(&[("readme.txt", b"SRTM"), ("N36W085.hgt", &bytes)]);
    let zipped = put(folder.path(), "N36W085.SRTMGL3.hgt.zip", &archive);
    for part in [
        None,
        bounds(36.2, -84.9, 36.21, -84.89),
        bounds(36.99, -84.01, 37.0, -84.0),
    ] {
        let truth = read_terrain(&plain, part).expect("a plain tile");
        is_the_earth(&truth);
        for path in [&gz, &zipped] {
            assert_eq!(
                read_terrain(path, part).expect("a packed tile"),
                truth,
                "{path:?}"
            );
        }
    }
    let formats: Vec<&str> = [&plain, &gz, &zipped]
        .map(|path| inspect(path).expect("a tile").format)
        .to_vec();
    assert_eq!(formats, ["SRTM tile", "SRTM tile, gzip", "SRTM tile, zip"]);
}

#[test]
fn a_damaged_pack_is_an_error_wherever_the_damage_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let bytes = tile(36, -85);
    for (name, whole) in [
        ("N36W085.hgt.gz", gzip(&bytes)),
        ("N36W085.hgt.zip", zip(&[("N36W085.hgt", &bytes)])),
    ] {
        for cut in [
            0,
            1,
            3,
            10,
            1000,
            whole.len() / 2,
            whole.len() - 9,
            whole.len() - 1,
        ] {
            let path = put(folder.path(), name, &whole[..cut]);
            assert!(
                refused(&path).contains("unpacked") || refused(&path).contains("bytes"),
                "{name} {cut}"
            );
        }
        // Somewhere in the packed heights: the checksum tells, though only a corner is wanted.
        for at in [whole.len() / 3, whole.len() / 2, 2 * whole.len() / 3] {
            let mut bent = whole.clone();
            bent[at] ^= 0x10;
            let path = put(folder.path(), name, &bent);
            let error = read_terrain(&path, bounds(36.99, -85.0, 37.0, -84.99));
            assert!(
                matches!(error, Err(TerrainError::Packed(_))),
                "{name} {at}: {error:?}"
            );
        }
    }
}

#[test]
fn a_bomb_is_refused_before_it_unfolds() {
    let folder = tempfile::tempdir().expect("a folder");
    let zeros = vec![0; 300_000_000];
    let gz = gzip(&zeros);
    let path = put(folder.path(), "N36W085.hgt.gz", &gz);
    assert!(
        refused(&path).contains("300000000 bytes"),
        "{}",
        refused(&path)
    );
    // The same that says to be a tile.
    let mut lying = gz;
    let size = lying.len() - 4;
    lying[size..].copy_from_slice(&2_884_802_u32.to_le_bytes());
    put(folder.path(), "N36W085.hgt.gz", &lying);
    assert!(refused(&path).contains("more in it"), "{}", refused(&path));
    let path = put(
        folder.path(),
        "N36W085.hgt.zip",
        &zip(&[("N36W085.hgt", &zeros)]),
    );
    assert!(
        refused(&path).contains("300000000 bytes"),
        "{}",
        refused(&path)
    );
}

#[test]
fn an_archive_holds_the_one_tile_that_its_name_promises() {
    let folder = tempfile::tempdir().expect("a folder");
    let bytes = tile(36, -85);
    for (entries, why) in [
        (vec![("N36W084.hgt", &bytes[..])], "another name"),
        (vec![("valley.hgt", &bytes[..])], "another name"),
        (
            vec![("N36W085.hgt", &bytes[..]), ("N37W085.hgt", &bytes[..])],
            "2 tiles",
        ),
        (vec![("readme.txt", &bytes[..])], "0 tiles"),
        (vec![("N36W085.hgt", &bytes[..100])], "100 bytes"),
    ] {
        let path = put(folder.path(), "N36W085.hgt.zip", &zip(&entries));
        let error = refused(&path);
        assert!(error.contains(why) && error.contains("allowed"), "{error}");
    }
}

#[test]
fn tiles_meet_at_their_common_posts() {
    let folder = tempfile::tempdir().expect("a folder");
    put(folder.path(), "N36W085.hgt", &tile(36, -85));
    put(folder.path(), "N36W084.hgt.gz", &gzip(&tile(36, -84)));
    put(
        folder.path(),
        "N37W085.hgt.zip",
        &zip(&[("N37W085.hgt", &tile(37, -85))]),
    );
    put(folder.path(), "N37W084.hgt", &tile(37, -84));
    put(folder.path(), "README.md", b"not elevation");
    let around = bounds(36.95, -84.05, 37.05, -83.95);
    let grid = read_terrain(folder.path(), around).expect("four tiles");
    assert_eq!((grid.rows, grid.columns), (121, 121));
    is_the_earth(&grid);
    // The ground is the same whether a tile is read alone or with its neighbours.
    let alone = read_terrain(&folder.path().join("N36W084.hgt.gz"), None).expect("a tile");
    for step in 0..=50 {
        let at = place(
            37.0 - 0.001 * f64::from(step),
            -84.0 + 0.0007 * f64::from(step),
        );
        let (one, all) = (alone.height_m(at), grid.height_m(at));
        let off_m = one.expect("inside") - all.expect("inside");
        assert!(off_m.abs() < 1e-6, "{off_m} at {at:?}");
    }
    assert_eq!(terrain_files(folder.path(), around).expect("four").len(), 4);
    let used = terrain_files(folder.path(), bounds(36.2, -84.9, 36.3, -84.8)).expect("one");
    assert_eq!(used, [folder.path().join("N36W085.hgt")]);
}

#[test]
fn rasters_without_common_posts_meet_in_the_cell_between_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/geotiff");
    for name in ["area.tif", "east.tif"] {
        fs::copy(fixtures.join(name), folder.path().join(name)).expect("copied");
    }
    let grid = read_terrain(folder.path(), None).expect("two rasters");
    assert_eq!((grid.rows, grid.columns), (6, 16));
    for (lon, height_m) in [
        (8.10, 400.0),
        (8.17, 407.0),
        (8.175, 407.5),
        (8.18, 408.0),
        (8.25, 415.0),
    ] {
        let found = grid.height_m(place(47.05, lon)).expect("ground");
        assert!((found - height_m).abs() < 1e-3, "{found} at {lon}");
    }
}

#[test]
fn a_void_on_a_seam_is_filled_by_the_tile_that_knows_and_the_higher_post_counts() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut west, east) = (tile(36, -85), tile(36, -84));
    // The last post of the first row, and of the second.
    let last = 2 * 1200;
    west[last..last + 2].copy_from_slice(&i16::MIN.to_be_bytes());
    let second = last + 2 * 1201;
    west[second..second + 2].copy_from_slice(&4000_i16.to_be_bytes());
    put(folder.path(), "N36W085.hgt", &west);
    put(folder.path(), "N36W084.hgt", &east);
    let grid = read_terrain(folder.path(), bounds(36.99, -84.01, 37.0, -83.99)).expect("both");
    let filled = grid.height_m(place(37.0, -84.0));
    assert_eq!(filled, Some(f64::from(height(37 * POSTS, -84 * POSTS))));
    assert_eq!(
        grid.height_m(place(37.0 - 1.0 / 1200.0, -84.0)),
        Some(4000.0)
    );
}

#[test]
fn a_missing_tile_is_no_data_and_never_zero() {
    let folder = tempfile::tempdir().expect("a folder");
    put(folder.path(), "N36W085.hgt", &tile(36, -85));
    put(folder.path(), "N37W084.hgt", &tile(37, -84));
    let grid = read_terrain(folder.path(), bounds(36.9, -84.1, 37.1, -83.9)).expect("two of four");
    assert!(grid.height_m(place(36.95, -84.05)).is_some());
    assert!(grid.height_m(place(37.05, -83.95)).is_some());
    assert_eq!(grid.height_m(place(36.95, -83.95)), None);
    assert_eq!(grid.height_m(place(37.05, -84.05)), None);
    assert_eq!(
        grid.height_m(place(36.95, -83.9999)),
        None,
        "right beside the seam"
    );
}

#[test]
fn folders_that_cannot_be_one_ground_are_refused_by_the_names_of_their_files() {
    let bytes = tile(36, -85);
    let near = bounds(36.2, -84.9, 36.3, -84.8);
    let with = |files: &[(&str, &[u8])]| {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, bytes) in files {
            put(folder.path(), name, bytes);
        }
        read_terrain(folder.path(), near).map_err(|error| error.to_string())
    };
    let twice =
        with(&[("N36W085.hgt", &bytes), ("N36W085.hgt.gz", &gzip(&bytes))]).expect_err("twice");
    assert!(twice.contains("N36W085.hgt and N36W085.hgt.gz"), "{twice}");
    let finer = vec![0; 25_934_402];
    let around = bounds(36.2, -84.1, 36.3, -83.9);
    let folder = tempfile::tempdir().expect("a folder");
    put(folder.path(), "N36W085.hgt", &bytes);
    put(folder.path(), "N36W084.hgt", &finer);
    // Of two spacings, the highest counts where they meet.
    let mixed = read_terrain(folder.path(), around).expect("both");
    let coarse = read_terrain(&folder.path().join("N36W085.hgt"), None).expect("one");
    let at = |lon_deg| LatLon {
        lat_deg: 36.25,
        lon_deg,
    };
    let (west, east) = (at(-84.05), at(-83.95));
    let over_m = mixed.height_m(west).expect("west") - coarse.height_m(west).expect("west");
    assert!((0.0..=mixed.raised_m + 1e-3).contains(&over_m), "{over_m}");
    assert_eq!(mixed.height_m(east), Some(0.0));
    let nothing = with(&[("N46E008.hgt", &bytes), ("notes.txt", b"")]).expect_err("elsewhere");
    assert!(
        nothing.contains("none of the 1 elevation files"),
        "{nothing}"
    );
    let broken = with(&[("N36W085.hgt", &bytes[..99])]).expect_err("broken");
    assert!(broken.starts_with("N36W085.hgt: 99 bytes"), "{broken}");
    // What lies elsewhere is not opened.
    assert!(with(&[("N36W085.hgt", &bytes), ("N46E008.hgt", b"broken")]).is_ok());
}

/// One copter, 2.7 km across the seam of two tiles.
const SPEC: &str = "\
sortie: 1
name: seam
area:
  south_west: {lat: 36.48, lon: -84.03}
  north_east: {lat: 36.52, lon: -83.97}
  min_agl_m: 50
  max_amsl_m: 4000
terrain: {folder: tiles}
vehicles:
  - id: alpha
    sysid: 1
    autopilot: ardupilot
    link: sim
    start: {lat: 36.50, lon: -84.015, agl_m: 80}
    goal: {lat: 36.50, lon: -83.985, agl_m: 80}
    finish: land
    speed_mps: 12
planner: {seed: 1, evaluations: 1000}
";

/// A tile of gentle ground.
fn gentle() -> Vec<u8> {
    let posts = (0..=POSTS).flat_map(|_| (0..=POSTS).map(|right| 300 + (right - 600).abs() / 100));
    posts
        .flat_map(|height| i16::try_from(height).expect("low").to_be_bytes())
        .collect()
}

#[test]
fn a_plan_over_a_folder_takes_the_tiles_that_it_uses_with_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let tiles = folder.path().join("tiles");
    fs::create_dir(&tiles).expect("a folder");
    let packed = gzip(&gentle());
    put(&tiles, "N36W085.hgt.gz", &packed);
    put(&tiles, "N36W084.hgt", &gentle());
    put(&tiles, "N46E008.hgt", b"not looked at");
    put(folder.path(), "seam.yaml", SPEC.as_bytes());
    let output = sortie(folder.path(), &["plan", "seam.yaml"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let out = folder.path().join("out/seam");
    assert_eq!(
        fs::read_to_string(out.join("spec.yaml")).expect("a copy"),
        SPEC
    );
    let mut names: Vec<String> = fs::read_dir(out.join("tiles"))
        .expect("the tiles")
        .map(|entry| {
            entry
                .expect("a tile")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    names.sort();
    assert_eq!(names, ["N36W084.hgt", "N36W085.hgt.gz"]);
    assert_eq!(
        fs::read(out.join("tiles/N36W085.hgt.gz")).expect("a tile"),
        packed
    );
    // The copy is judged alone, and may be replaced by the next plan.
    fs::remove_dir_all(&tiles).expect("removed");
    let again = sortie(&out, &["review", "spec.yaml", "alpha.waypoints"]);
    assert_eq!(again.status.code(), Some(0), "{}", text(&again.stderr));
    let check = sortie(folder.path(), &["check", "seam.yaml"]);
    assert_eq!(check.status.code(), Some(3));
    assert!(
        text(&check.stderr).contains("terrain.folder"),
        "{}",
        text(&check.stderr)
    );
}

#[test]
fn a_mission_over_a_missing_tile_is_refused_with_the_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let tiles = folder.path().join("tiles");
    fs::create_dir(&tiles).expect("a folder");
    put(&tiles, "N36W085.hgt", &gentle());
    put(folder.path(), "seam.yaml", SPEC.as_bytes());
    let output = sortie(folder.path(), &["plan", "seam.yaml"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{message}");
    assert!(
        message.contains("vehicles[0].goal: no elevation data at 36.500000, -83.985000"),
        "{message}"
    );
}

/// 1.4 GB of tiles, of which an area of 5 km touches two: in 500 MB of address space.
#[cfg(target_os = "linux")]
#[test]
fn memory_follows_the_area_and_not_the_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let tiles = folder.path().join("tiles");
    fs::create_dir(&tiles).expect("a folder");
    for lat in 33..40 {
        for lon in 80..88 {
            let file =
                fs::File::create(tiles.join(format!("N{lat}W{lon:03}.hgt"))).expect("a tile");
            file.set_len(25_934_402).expect("a sparse tile of the sea");
        }
    }
    put(folder.path(), "seam.yaml", SPEC.as_bytes());
    let limited = std::process::Command::new("sh")
        .args(["-c", "ulimit -v 500000; exec \"$0\" check seam.yaml"])
        .arg(assert_cmd::cargo::cargo_bin("sortie"))
        .current_dir(folder.path())
        .output()
        .expect("sh runs");
    assert!(limited.status.success(), "{}", text(&limited.stderr));
}

//! Elevation files as they come from others, and the ground made from them.

use std::fs;
use std::path::{Path, PathBuf};

use proptest::prelude::*;
use sortie::geodesy::{Agl, Amsl, EastNorth, LatLon};
use sortie::spec::{Area, SpecFile};
use sortie::world::{self, Bounds, Terrain, TerrainError, TerrainGrid, read_terrain};

fn place(lat_deg: f64, lon_deg: f64) -> LatLon {
    LatLon { lat_deg, lon_deg }
}

fn bounds(south: f64, west: f64, north: f64, east: f64) -> Option<Bounds> {
    Some(Bounds {
        south_west: place(south, west),
        north_east: place(north, east),
    })
}

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn fixture(name: &str) -> PathBuf {
    shipped("tests/data/geotiff").join(name)
}

/// A 3-arc-second tile: the height is 1 m a row from the south and 2 m a column from the west, with one void.
fn write_tile(folder: &Path, name: &str) -> PathBuf {
    let mut bytes = Vec::new();
    for row in 0..1201_i16 {
        for column in 0..1201_i16 {
            let void = row == 600 && column == 600;
            let height = if void {
                -32768
            } else {
                (1200 - row) + 2 * column
            };
            bytes.extend(height.to_be_bytes());
        }
    }
    let path = folder.join(name);
    fs::write(&path, bytes).expect("written");
    path
}

fn close(height: Option<f64>, expected: f64) {
    let height = height.unwrap_or_else(|| panic!("no height, expected {expected}"));
    assert!(
        (height - expected).abs() < 1e-3,
        "{height}, expected {expected}"
    );
}

#[test]
fn an_srtm_tile_lies_where_its_name_says_with_its_first_row_in_the_north() {
    let folder = tempfile::tempdir().expect("a folder");
    let grid = read_terrain(&write_tile(folder.path(), "N36W085.hgt"), None).expect("a tile");
    assert_eq!((grid.rows, grid.columns), (1201, 1201));
    close(grid.height_m(place(36.0, -85.0)), 0.0);
    close(grid.height_m(place(37.0, -85.0)), 1200.0);
    close(grid.height_m(place(36.0, -84.0)), 2400.0);
    close(grid.height_m(place(37.0, -84.0)), 3600.0);
    // A plane is its own bilinear interpolation.
    close(
        grid.height_m(place(36.3, -84.77)),
        0.3 * 1200.0 + 0.23 * 2400.0,
    );
    let south = read_terrain(&write_tile(folder.path(), "s01e010.hgt"), None).expect("a tile");
    close(south.height_m(place(-1.0, 10.0)), 0.0);
    close(south.height_m(place(-0.0, 11.0)), 3600.0);
}

#[test]
fn a_void_is_no_data_in_every_cell_around_it_and_never_zero() {
    let folder = tempfile::tempdir().expect("a folder");
    let grid = read_terrain(&write_tile(folder.path(), "N36W085.hgt"), None).expect("a tile");
    let step = 1.0 / 1200.0;
    assert_eq!(grid.height_m(place(36.5, -84.5)), None);
    for (north, east) in [
        (0.5, 0.5),
        (-0.5, 0.5),
        (0.5, -0.5),
        (-0.5, -0.5),
        (0.9, 0.0),
    ] {
        assert_eq!(
            grid.height_m(place(36.5 + north * step, -84.5 + east * step)),
            None
        );
    }
    close(
        grid.height_m(place(36.5 + step, -84.5 + step)),
        601.0 + 1202.0,
    );
    assert_eq!(grid.node_m(600, 600), None);
    assert_eq!(grid.cell_m(599, 599), None);
    assert_eq!(
        grid.cell_m(601, 601).map(|corners| corners[0]),
        grid.node_m(601, 601)
    );
}

#[test]
fn outside_of_a_tile_there_is_no_data() {
    let folder = tempfile::tempdir().expect("a folder");
    let grid = read_terrain(&write_tile(folder.path(), "N36W085.hgt"), None).expect("a tile");
    for outside in [
        place(35.999, -84.5),
        place(37.001, -84.5),
        place(36.5, -85.001),
        place(36.5, -83.999),
        place(36.5, 275.5),
    ] {
        assert_eq!(grid.height_m(outside), None, "{outside:?}");
        assert!(Terrain::Grid(grid.clone()).height(outside).is_err());
    }
}

#[test]
fn reading_a_part_gives_the_same_heights_as_reading_all() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = write_tile(folder.path(), "N36W085.hgt");
    let part = read_terrain(&path, bounds(36.1001, -84.9, 36.2, -84.7999)).expect("a part");
    assert!(
        part.rows <= 123 && part.columns <= 123,
        "{} x {}",
        part.rows,
        part.columns
    );
    let all = read_terrain(&path, None).expect("all");
    for step in 0..=40 {
        let at = place(
            36.1001 + 0.0024 * f64::from(step),
            -84.9 + 0.0025 * f64::from(step),
        );
        close(part.height_m(at), all.height_m(at).expect("inside"));
    }
    assert!(matches!(
        read_terrain(&path, bounds(40.0, -84.9, 40.1, -84.8)),
        Err(TerrainError::ReturnTargets { .. })
    ));
    assert!(matches!(
        read_terrain(&path, bounds(36.1, 84.8, 36.2, 84.9)),
        Err(TerrainError::ReturnTargets { .. })
    ));
}

#[test]
fn tiles_of_another_size_or_name_are_errors() {
    let folder = tempfile::tempdir().expect("a folder");
    let short = folder.path().join("N36W085.hgt");
    for size in [0_usize, 2, 2_884_801, 2_884_803] {
        fs::write(&short, vec![0; size]).expect("written");
        let Err(TerrainError::Convertible { error, .. }) = read_terrain(&short, None) else {
            panic!("{size} bytes");
        };
        assert!(matches!(*error, TerrainError::Size(_)), "{size}");
    }
    let named = folder.path().join("valley.hgt");
    fs::write(&named, [0; 2]).expect("written");
    assert!(matches!(
        read_terrain(&named, None),
        Err(TerrainError::Name(_))
    ));
    assert!(matches!(
        read_terrain(&folder.path().join("dem.gif"), None),
        Err(TerrainError::UnknownKind)
    ));
    for missing in ["N37W085.hgt", "dem.tif"] {
        assert!(matches!(
            read_terrain(&folder.path().join(missing), None),
            Err(TerrainError::Unreadable(_))
        ));
    }
}

/// The fixtures are written by GDAL: 400 + 10 row + column, north-west node 47.05 N 8.10 E, 0.01 degrees.
fn is_the_fixture(grid: &TerrainGrid, base_m: f64) {
    assert_eq!((grid.rows, grid.columns), (6, 8));
    close(grid.height_m(place(47.05, 8.10)), base_m);
    close(grid.height_m(place(47.00, 8.17)), base_m + 57.0);
    close(grid.height_m(place(47.025, 8.135)), base_m + 28.5);
    assert_eq!(grid.height_m(place(47.0501, 8.10)), None);
}

#[test]
fn geotiffs_of_every_common_kind_are_read_alike() {
    for name in [
        "area.tif",
        "point.tif",
        "double.tif",
        "word.tif",
        "long.tif",
        "tiled.tif",
        "big.tif",
        "egm96.tif",
    ] {
        let grid =
            read_terrain(&fixture(name), None).unwrap_or_else(|error| panic!("{name}: {error}"));
        is_the_fixture(&grid, 400.0);
        let part =
            read_terrain(&fixture(name), bounds(47.011, 8.121, 47.029, 8.139)).expect("a part");
        assert_eq!((part.rows, part.columns), (3, 3), "{name}");
        close(part.height_m(place(47.02, 8.13)), 433.0);
    }
    is_the_fixture(
        &read_terrain(&fixture("byte.tif"), None).expect("bytes"),
        0.0,
    );
}

#[test]
fn what_a_geotiff_calls_no_data_is_none_and_so_is_what_cannot_be_ground() {
    let grid = read_terrain(&fixture("float.tif"), None).expect("floats");
    assert_eq!(grid.node_m(2, 3), None, "the file's no-data value");
    assert_eq!(grid.node_m(4, 5), None, "not a number");
    assert_eq!(grid.node_m(0, 0), None, "20 km high");
    close(grid.node_m(5, 7), 457.0);
}

#[test]
fn geotiffs_that_would_be_misread_are_refused_by_name() {
    let refused = [
        ("nad27.tif", "EPSG:4267"),
        ("no_crs.tif", "no coordinate system"),
        ("ellipsoid.tif", "4979"),
        ("rotated.tif", "rotated"),
        ("south_up.tif", "north to south"),
        ("two_bands.tif", "2 bands"),
        ("complex.tif", "samples of"),
        ("no_place.tif", "no place"),
    ];
    for (name, why) in refused {
        let error = read_terrain(&fixture(name), None)
            .expect_err(name)
            .to_string();
        assert!(error.contains(why), "{name}: {error}");
        assert!(error.contains("allowed"), "{name}: {error}");
    }
}

#[test]
fn a_geotiff_in_a_three_dimensional_system_holds_no_heights_above_the_sea() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("area.tif");
    let mut bytes = fs::read(fixture("area.tif")).expect("a fixture");
    // GeographicTypeGeoKey, one short: WGS84.
    let key = [0x00, 0x08, 0, 0, 1, 0];
    let wgs84 = [key.as_slice(), &4326_u16.to_le_bytes()].concat();
    let at = bytes.windows(wgs84.len()).position(|of| of == wgs84);
    let at = at.expect("the key") + key.len();
    // WGS84, ETRS89, GDA2020.
    for code in [4979_u16, 4937, 7843] {
        bytes[at..at + 2].copy_from_slice(&code.to_le_bytes());
        fs::write(&path, &bytes).expect("written");
        let error = read_terrain(&path, None).expect_err("refused").to_string();
        let why = format!("metres above an ellipsoid (EPSG:{code})");
        assert!(error.contains(&why), "{error}");
    }
}

#[test]
fn a_truncated_geotiff_is_an_error_wherever_it_ends() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("cut.tif");
    for name in ["area.tif", "tiled.tif", "big.tif"] {
        let whole = fs::read(fixture(name)).expect("a fixture");
        for length in 0..whole.len() {
            fs::write(&path, &whole[..length]).expect("written");
            if let Ok(grid) = read_terrain(&path, None) {
                // What was cut off may have been padding.
                is_the_fixture(&grid, 400.0);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn a_damaged_geotiff_never_panics(
        which in 0_usize..4, damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let name = ["area.tif", "point.tif", "tiled.tif", "float.tif"][which];
        let mut bytes = fs::read(fixture(name)).expect("a fixture");
        for (at, value) in damage {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("damaged.tif");
        fs::write(&path, bytes).expect("written");
        if let Ok(grid) = read_terrain(&path, bounds(46.9, 8.0, 47.1, 8.2)) {
            prop_assert_eq!(grid.heights_m.len(), grid.rows * grid.columns);
        }
    }

    #[test]
    fn heights_lie_between_the_corners_of_their_cell(lat in 47.0..=47.05, lon in 8.10..=8.17) {
        let grid = read_terrain(&fixture("area.tif"), None).expect("a grid");
        let (row, column) = grid.row_column(place(lat, lon));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "inside of the grid")]
        let (row, column) = ((row.max(0.0) as usize).min(4), (column.max(0.0) as usize).min(6));
        prop_assert!(grid.row_lat_deg(row) + 1e-9 >= lat && grid.row_lat_deg(row + 1) - 1e-9 <= lat);
        prop_assert!(grid.column_lon_deg(column) - 1e-9 <= lon && grid.column_lon_deg(column + 1) + 1e-9 >= lon);
        let corners = grid.cell_m(row, column).expect("a cell");
        let height = grid.height_m(place(lat, lon)).expect("inside");
        let least = corners.into_iter().fold(f64::INFINITY, f64::min);
        let most = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
        prop_assert!(least - 1e-9 <= height && height <= most + 1e-9);
    }
}

/// The highest cell, 1076 m, is on Cross Mountain, Tennessee (36.1986 N 84.2308 W).
#[test]
fn the_shipped_terrain_has_its_summit_where_the_map_has_it() {
    let grid = read_terrain(&shipped("missions/terrain/jacksboro.tif"), None)
        .expect("the shipped terrain");
    assert_eq!((grid.rows, grid.columns), (344, 403));
    let highest = grid
        .heights_m
        .iter()
        .copied()
        .fold(f32::NEG_INFINITY, f32::max);
    assert_eq!(highest.to_bits(), 1076_f32.to_bits());
    let index = grid
        .heights_m
        .iter()
        .position(|height| *height >= highest)
        .expect("a summit");
    let summit = place(
        grid.row_lat_deg(index / grid.columns),
        grid.column_lon_deg(index % grid.columns),
    );
    assert!(
        summit.chord_m(place(36.1986, -84.2308)) < 60.0,
        "{summit:?}"
    );
    // Nodes lie on whole 3 arc-seconds, as in SRTM.
    assert!((summit.lat_deg * 1200.0 - (summit.lat_deg * 1200.0).round()).abs() < 1e-6);
    assert!((summit.lon_deg * 1200.0 - (summit.lon_deg * 1200.0).round()).abs() < 1e-6);
}

fn mission(terrain: &str, start: &str) -> String {
    format!(
        "sortie: 1\nname: valley\narea:\n  south_west: {{lat: 36.45, lon: -84.55}}\n  north_east: {{lat: 36.55, lon: -84.45}}\n  \
         min_agl_m: 50\n  max_amsl_m: 4000\nterrain: {{file: {terrain}}}\nvehicles:\n  - id: alpha\n    sysid: 1\n    \
         autopilot: ardupilot\n    link: sim\n    start: {{{start}, agl_m: 80}}\n    \
         goal: {{lat: 36.54, lon: -84.46, agl_m: 80}}\n    finish: land\n    speed_mps: 10\n"
    )
}

#[test]
fn a_spec_finds_its_terrain_beside_it_and_the_ground_agrees_with_it() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::create_dir(folder.path().join("tiles")).expect("a folder");
    write_tile(&folder.path().join("tiles"), "N36W085.hgt");
    let path = folder.path().join("mission.yaml");
    fs::write(
        &path,
        mission("tiles/N36W085.hgt", "lat: 36.46, lon: -84.54"),
    )
    .expect("written");
    let file = SpecFile::read(&path).expect("a spec");
    let world = world::load(&file).expect("a world");
    let start = world.sites[0].start;
    assert!(
        (start.amsl.0 - (0.46 * 1200.0 + 0.46 * 2400.0 + 80.0)).abs() < 1e-2,
        "{start:?}"
    );
    let Terrain::Grid(grid) = &world.terrain else {
        panic!("a grid")
    };
    assert!(
        grid.rows < 300 && grid.columns < 350,
        "cut to the area: {} x {}",
        grid.rows,
        grid.columns
    );
    for step in 0..20 {
        let at = EastNorth {
            east_m: 150.0 * f64::from(step) - 4000.0,
            north_m: 190.0 * f64::from(step) - 5000.0,
        };
        let exact = world
            .terrain
            .height(world.frame.from_plan(at))
            .expect("ground")
            .0;
        assert!(
            (world.ground.height_m(at) - exact).abs() < 0.5,
            "{exact} at {at:?}"
        );
    }
    let void = EastNorth {
        east_m: 0.0,
        north_m: 0.0,
    };
    assert!(
        world.ground.height_m(void).is_nan(),
        "the void in the middle is not filled"
    );
}

#[test]
fn a_start_over_a_void_is_an_error_with_its_place() {
    let folder = tempfile::tempdir().expect("a folder");
    write_tile(folder.path(), "N36W085.hgt");
    let path = folder.path().join("mission.yaml");
    fs::write(&path, mission("N36W085.hgt", "lat: 36.5001, lon: -84.5001")).expect("written");
    let error = world::load(&SpecFile::read(&path).expect("a spec")).expect_err("no data");
    let paths: Vec<&str> = error
        .issues
        .iter()
        .map(|issue| issue.path.as_str())
        .collect();
    assert_eq!(paths, ["vehicles[0].home", "vehicles[0].start"], "{error}");
    assert!(
        error
            .to_string()
            .contains("no elevation data at 36.500100, -84.500100"),
        "{error}"
    );
    assert_eq!(error.issues[1].position.map(|(line, _)| line), Some(14));
}

#[test]
fn a_terrain_of_elsewhere_is_an_error_at_its_key() {
    let folder = tempfile::tempdir().expect("a folder");
    write_tile(folder.path(), "N46E008.hgt");
    let path = folder.path().join("mission.yaml");
    fs::write(&path, mission("N46E008.hgt", "lat: 36.46, lon: -84.54")).expect("written");
    let error = world::load(&SpecFile::read(&path).expect("a spec")).expect_err("elsewhere");
    assert_eq!(error.issues[0].path, "terrain.file");
    assert!(error.to_string().contains("nothing of the area"), "{error}");
}

#[test]
fn the_margin_around_an_area_covers_its_box_in_planning_coordinates() {
    for (lat, span) in [(0.0, 2.0), (45.0, 2.0), (-65.0, 3.0), (75.0, 2.0)] {
        let area = Area {
            south_west: place(lat, 10.0),
            north_east: place(lat + span, 10.0 + span),
            min_agl: Agl(0.0),
            max_amsl: Amsl(1000.0),
            altitudes: sortie::spec::AltitudeLimits::default(),
        };
        let frame = sortie::geodesy::LocalFrame::new(place(lat + span / 2.0, 10.0 + span / 2.0));
        let corners: Vec<EastNorth> = area
            .outline()
            .into_iter()
            .map(|corner| frame.to_plan(corner))
            .collect();
        let extreme = |pick: fn(&EastNorth) -> f64, better: fn(f64, f64) -> f64| {
            corners
                .iter()
                .map(pick)
                .reduce(better)
                .expect("four corners")
        };
        let (west, east) = (
            extreme(|c| c.east_m, f64::min),
            extreme(|c| c.east_m, f64::max),
        );
        let (south, north) = (
            extreme(|c| c.north_m, f64::min),
            extreme(|c| c.north_m, f64::max),
        );
        let bounds = Bounds::around(&area);
        for step in 0..=20 {
            let t = f64::from(step) / 20.0;
            let (x, y) = (west + t * (east - west), south + t * (north - south));
            for (east_m, north_m) in [(x, south), (x, north), (west, y), (east, y)] {
                let at = frame.from_plan(EastNorth { east_m, north_m });
                let inside = (bounds.south_west.lat_deg..=bounds.north_east.lat_deg)
                    .contains(&at.lat_deg)
                    && (bounds.south_west.lon_deg..=bounds.north_east.lon_deg)
                        .contains(&at.lon_deg);
                assert!(inside, "{at:?} of {area:?} is not in {bounds:?}");
            }
        }
    }
}

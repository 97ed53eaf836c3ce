//! GeoTIFFs in map projections, and folders of several spacings, as one ground.
//!
//! Where the pixels are is from PROJ 9.5.1 (pyproj 3.7.2, `Transformer.from_crs(4326, CODE)`).

#![expect(clippy::cast_possible_truncation, reason = "samples are f32")]

use std::fs;

use sortie::geodesy::LatLon;
use sortie::world::{TerrainError, TerrainGrid, inspect, read_terrain};

const SIDE: usize = 41;

/// A GeoTIFF of 41 x 41 floats: code of its system, whether that is a projection, its first pixel's
/// corner (or middle, of points), its pixels' size.
struct Raster {
    code: u16,
    is_projected: bool,
    is_point: bool,
    vertical: Option<u16>,
    first: (f64, f64),
    step: f64,
}

impl Raster {
    /// A raster in a projection around a point.
    fn around(code: u16, middle: (f64, f64), step: f64) -> Self {
        Self {
            code,
            is_projected: true,
            is_point: false,
            vertical: None,
            first: (middle.0 - 20.5 * step, middle.1 + 20.5 * step),
            step,
        }
    }

    fn bytes(&self, height_m: impl Fn(usize, usize) -> f32) -> Vec<u8> {
        let raster = if self.is_point { 2 } else { 1 };
        let (model, key) = if self.is_projected {
            (1, 3072)
        } else {
            (2, 2048)
        };
        let mut keys: Vec<[u16; 4]> = vec![
            [1024, 0, 1, model],
            [1025, 0, 1, raster],
            [key, 0, 1, self.code],
        ];
        keys.extend(self.vertical.map(|code| [4096, 0, 1, code]));
        let mut geo = vec![1, 1, 0, u16::try_from(keys.len()).expect("few")];
        geo.extend(keys.concat());
        let shorts = |values: &[u16]| {
            values
                .iter()
                .flat_map(|v| v.to_le_bytes())
                .collect::<Vec<u8>>()
        };
        let doubles = |values: &[f64]| {
            values
                .iter()
                .flat_map(|v| v.to_le_bytes())
                .collect::<Vec<u8>>()
        };
        let samples: Vec<u8> = (0..SIDE * SIDE)
            .flat_map(|at| height_m(at / SIDE, at % SIDE).to_le_bytes())
            .collect();
        let side = u16::try_from(SIDE).expect("small");
        let length = u32::try_from(samples.len()).expect("small");
        let mut file = b"II*\0".to_vec();
        file.extend((8 + length).to_le_bytes());
        file.extend(&samples);
        // Code, type, count, value: shorts are 3, longs 4, doubles 12.
        let tags: Vec<(u16, u16, Vec<u8>)> = vec![
            (256, 3, shorts(&[side])),
            (257, 3, shorts(&[side])),
            (258, 3, shorts(&[32])),
            (259, 3, shorts(&[1])),
            (262, 3, shorts(&[1])),
            (273, 4, 8_u32.to_le_bytes().to_vec()),
            (277, 3, shorts(&[1])),
            (278, 3, shorts(&[side])),
            (279, 4, length.to_le_bytes().to_vec()),
            (339, 3, shorts(&[3])),
            (33550, 12, doubles(&[self.step, self.step, 0.0])),
            (
                33922,
                12,
                doubles(&[0.0, 0.0, 0.0, self.first.0, self.first.1, 0.0]),
            ),
            (34735, 3, shorts(&geo)),
        ];
        let directory = u32::try_from(file.len() + 2 + 12 * tags.len() + 4).expect("small");
        let (mut entries, mut values): (Vec<u8>, Vec<u8>) = Default::default();
        for (code, kind, mut bytes) in tags.iter().cloned() {
            let size = match kind {
                3 => 2,
                4 => 4,
                _ => 8,
            };
            let count = u32::try_from(bytes.len() / size).expect("small");
            if bytes.len() > 4 {
                let at = directory + u32::try_from(values.len()).expect("small");
                values.extend(&bytes);
                bytes = at.to_le_bytes().to_vec();
            }
            bytes.resize(4, 0);
            entries.extend([code.to_le_bytes(), kind.to_le_bytes()].concat());
            entries.extend([count.to_le_bytes().to_vec(), bytes].concat());
        }
        file.extend(u16::try_from(tags.len()).expect("few").to_le_bytes());
        file.extend(entries);
        file.extend([0; 4]);
        file.extend(values);
        file
    }
}

fn read(bytes: &[u8]) -> Result<TerrainGrid, TerrainError> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("dem.tif");
    fs::write(&path, bytes).expect("written");
    assert!(inspect(&path).is_ok(), "info reads as plan does");
    read_terrain(&path, None)
}

#[expect(clippy::cast_precision_loss, reason = "small")]
fn count(index: usize) -> f32 {
    index as f32
}

fn height_m(grid: &TerrainGrid, lat_deg: f64, lon_deg: f64) -> f64 {
    grid.height_m(LatLon { lat_deg, lon_deg })
        .expect("a height")
}

#[test]
fn pixels_of_projections_are_where_proj_has_them() {
    // Code, place, east, north, pixel: what PROJ says.
    for (code, lat_deg, lon_deg, east, north, step) in [
        (32632, 47.0, 8.1, 431_577.174, 5_205_557.149, 25.0),
        (25832, 47.0, 8.1, 431_577.174, 5_205_557.149, 1.0),
        (25832, 60.1, 5.4, 299_872.921, 6_668_001.071, 50.0),
        (3857, 60.1, 5.4, 601_125.250, 8_422_035.519, 30.0),
        (2056, 46.5, 7.4, 2_597_033.754, 1_149_855.020, 10.0),
        (2154, 47.0, 8.1, 1_087_261.749, 6_668_041.372, 25.0),
        (5514, 52.3, 13.2, -791_777.800, -787_121.286, 25.0),
    ] {
        let raster = Raster::around(code, (east, north), step);
        // A slope of 0.2 to the south-east, and one pixel that stands out in the middle.
        let slope_m = |row: usize, column: usize| 600.0 + 0.2 * count(row + column) * step as f32;
        let plain = read(&raster.bytes(slope_m)).expect("a grid");
        let truth_m = f64::from(slope_m(20, 20));
        let found_m = height_m(&plain, lat_deg, lon_deg);
        // 2 m for heights of unknown origin, and 0.1 to 5 m of place on the steepest slope, 0.28.
        let max_m = truth_m + 2.0 + 5.0 * 0.4 + 0.3;
        assert!(
            (truth_m + 2.0..max_m).contains(&found_m),
            "EPSG:{code}: {found_m} of {truth_m}"
        );
        assert!(plain.raised_m >= found_m - truth_m, "EPSG:{code}");
        let tower = |row, column| match (row, column) {
            (20, 20) => slope_m(20, 20) + 60.0,
            _ => slope_m(row, column),
        };
        let peaked = read(&raster.bytes(tower)).expect("a grid");
        let over_m = height_m(&peaked, lat_deg, lon_deg) - f64::from(tower(20, 20));
        assert!(over_m >= 0.0, "EPSG:{code}: {over_m}");
        assert!(peaked.raised_m >= over_m, "EPSG:{code}");
        // Three pixels away nothing of it is left.
        let three_deg = 3.0 * step / 111_200.0;
        let beside_m = height_m(&peaked, lat_deg + three_deg, lon_deg);
        assert!(
            beside_m < f64::from(tower(20, 20)) - 20.0 || step < 2.0,
            "EPSG:{code}: {beside_m}"
        );
    }
}

#[test]
fn pixels_are_areas_or_points() {
    let area = Raster::around(32632, (431_577.174, 5_205_557.149), 30.0);
    let first = (431_577.174 - 600.0, 5_205_557.149 + 600.0);
    let point = Raster {
        is_point: true,
        first,
        ..Raster::around(32632, (0.0, 0.0), 30.0)
    };
    let rough = |row: usize, column: usize| 500.0 + count((row * 7 + column * 13) % 40);
    let (one, other) = (read(&area.bytes(rough)), read(&point.bytes(rough)));
    let (one, other) = (one.expect("a grid"), other.expect("a grid"));
    for (a, b) in one.heights_m.iter().zip(&other.heights_m) {
        assert!((a - b).abs() < 1e-2 || a.is_nan() && b.is_nan(), "{a}, {b}");
    }
    assert!((one.north_west.lat_deg - other.north_west.lat_deg).abs() < 1e-9);
}

#[test]
fn no_node_of_a_file_stands_above_the_ground_that_is_made_of_it() {
    // ETRS89: degrees, within a metre of WGS84, so that the place of each node is known.
    let step = 0.0003;
    let raster = Raster {
        is_projected: false,
        code: 4258,
        first: (8.0 - 0.5 * step, 47.0 + 0.5 * step),
        ..Raster::around(4258, (0.0, 0.0), step)
    };
    let rough =
        |row: usize, column: usize| 500.0 + 15.0 * count(((row * 7919) ^ (column * 104_729)) % 23);
    let grid = read(&raster.bytes(rough)).expect("a grid");
    for row in 1..SIDE - 1 {
        for column in 1..SIDE - 1 {
            let (lat, lon) = (
                47.0 - f64::from(count(row)) * step,
                8.0 + f64::from(count(column)) * step,
            );
            let over_m = height_m(&grid, lat, lon) - f64::from(rough(row, column));
            assert!(
                (0.0..=grid.raised_m).contains(&over_m),
                "{row}, {column}: {over_m}"
            );
        }
    }
}

#[test]
fn the_vertical_system_and_the_projection_are_uncertain_by_their_own() {
    let flat = |vertical, code, middle| {
        let raster = Raster {
            vertical,
            ..Raster::around(code, middle, 25.0)
        };
        let grid = read(&raster.bytes(|_, _| 500.0)).expect("a grid");
        f64::from(grid.heights_m[grid.heights_m.len() / 2]) - 500.0
    };
    let utm = (431_577.174, 5_205_557.149);
    for (vertical, error_m) in [
        (Some(5773), 0.0),
        (Some(3855), 1.0),
        (None, 2.0),
        (Some(7837), 2.0),
    ] {
        let found_m = flat(vertical, 32632, utm);
        assert!((found_m - error_m).abs() < 1e-3, "{vertical:?}: {found_m}");
    }
}

#[test]
fn a_refused_file_names_the_command_that_converts_it() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/geotiff");
    for (name, target) in [("nad27.tif", "EPSG:4326"), ("ellipsoid.tif", "EPSG:9707")] {
        let error = read_terrain(&folder.join(name), None)
            .expect_err(name)
            .to_string();
        assert!(
            error.contains(&format!("gdalwarp -t_srs {target}")),
            "{error}"
        );
    }
    // Grids of shifts are needed: OSGB36, NAD27.
    for code in [27700, 26717] {
        let raster = Raster::around(code, (400_000.0, 300_000.0), 25.0);
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("dem.tif");
        fs::write(&path, raster.bytes(|_, _| 500.0)).expect("written");
        let error = read_terrain(&path, None)
            .expect_err("no way to WGS84")
            .to_string();
        assert!(error.contains(&format!("EPSG:{code}")), "{error}");
    }
}

#[test]
fn neighbours_in_a_projection_meet_without_a_gap() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, east) in [("a.tif", 431_577.0), ("b.tif", 431_577.0 + 41.0 * 25.0)] {
        let raster = Raster::around(32632, (east, 5_205_557.0), 25.0);
        fs::write(folder.path().join(name), raster.bytes(|_, _| 500.0)).expect("written");
    }
    let grid = read_terrain(folder.path(), None).expect("a grid");
    for step in 0..60 {
        let lon_deg = 8.1 + f64::from(step) * 0.0002;
        assert!(
            (height_m(&grid, 47.0, lon_deg) - 502.0).abs() < 1e-3,
            "{lon_deg}"
        );
    }
}

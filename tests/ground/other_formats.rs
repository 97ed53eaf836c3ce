//! ASCII grids and Terrarium tiles as ground, and the commands that convert refused files.

use std::fs;
use std::path::{Path, PathBuf};

use sortie::geodesy::LatLon;
use sortie::world::{Bounds, TerrainError, TerrainGrid, inspect, read_terrain, terrain_files};

const UTM: &str = r#"PROJCS["WGS_1984_UTM_Zone_32N",GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137.0,298.257223563]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],UNIT["Meter",1.0]]"#;

fn place(lat_deg: f64, lon_deg: f64) -> LatLon {
    LatLon { lat_deg, lon_deg }
}

fn put(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    fs::create_dir_all(path.parent().expect("a folder")).expect("made");
    fs::write(&path, bytes).expect("written");
    path
}

/// Heights 400 + 10 row + column, as in the fixtures that GDAL wrote.
fn ascii(header: &str) -> String {
    let row = |row: i32| {
        let heights = (0..8).map(|column| (400 + 10 * row + column).to_string());
        heights.collect::<Vec<_>>().join(" ")
    };
    let rows: Vec<String> = (0..6).map(row).collect();
    format!("ncols 8\nnrows 6\n{header}\n{}\n", rows.join("\n"))
}

fn refused(path: &Path) -> String {
    let error = read_terrain(path, None).expect_err("refused").to_string();
    let info = inspect(path).expect_err("refused").to_string();
    assert_eq!(error, info);
    error
}

fn height_m(grid: &TerrainGrid, lat_deg: f64, lon_deg: f64) -> f64 {
    grid.height_m(place(lat_deg, lon_deg)).expect("a height")
}

#[test]
fn an_ascii_grid_in_degrees_is_read_as_the_geotiff_of_the_same_heights() {
    let folder = tempfile::tempdir().expect("a folder");
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/geotiff/area.tif");
    let expected = read_terrain(&fixture, None).expect("a grid");
    let corner = "xllcorner 8.095\nyllcorner 46.995\ncellsize 0.01\nNODATA_value -9999";
    let center = "XLLCENTER 8.10\nYLLCENTER 47.0\ndx 0.01\ndy 0.01";
    for header in [corner, center] {
        let path = put(folder.path(), "dem.asc", ascii(header));
        for system in [
            "EPSG:4326\n",
            r#"GEOGCS["GCS_WGS_1984",UNIT["Degree",0.0174]]"#,
        ] {
            put(folder.path(), "dem.prj", system);
            let grid = read_terrain(&path, None).expect("a grid");
            assert_eq!(grid.heights_m, expected.heights_m);
            let apart = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} {b}");
            apart(grid.north_west.lat_deg, expected.north_west.lat_deg);
            apart(grid.north_west.lon_deg, expected.north_west.lon_deg);
            apart(grid.row_step_deg, expected.row_step_deg);
        }
    }
    let info = inspect(&folder.path().join("dem.asc")).expect("info");
    assert_eq!((info.rows, info.columns, info.voids), (6, 8, 0));
    assert_eq!(info.format, "ESRI ASCII grid");
}

#[test]
fn an_ascii_grid_in_a_projection_lies_where_its_prj_says() {
    let folder = tempfile::tempdir().expect("a folder");
    // 47 N 9 E is at 500 000, 5 205 164.1 of UTM 32N: 0.9996 of the meridian arc.
    let header = "xllcorner 499920\nyllcorner 5205104.1\ncellsize 20\nNODATA_value -1";
    let path = put(folder.path(), "dem.asc", ascii(header));
    put(folder.path(), "dem.prj", UTM);
    let grid = read_terrain(&path, None).expect("a grid");
    // The middle lies between rows 2 and 3, and columns 3 and 4.
    let found = height_m(&grid, 47.0, 9.0);
    let over_m = found - 428.5;
    assert!((0.0..=grid.raised_m + 0.1).contains(&over_m), "{over_m}");
    // What travels with a spec has its system.
    let files = terrain_files(&path, None).expect("files");
    assert_eq!(files, [path.clone(), path.with_extension("prj")]);
}

#[test]
fn a_void_of_an_ascii_grid_is_no_data() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = ascii("xllcorner 8\nyllcorner 47\ncellsize 0.01").replace("411", "-9999");
    let path = put(folder.path(), "dem.asc", text.replace("422", "nan"));
    put(folder.path(), "dem.prj", "EPSG:4326");
    let grid = read_terrain(&path, None).expect("a grid");
    assert_eq!(grid.node_m(1, 1), None);
    assert_eq!(grid.node_m(2, 2), None);
    assert_eq!(grid.node_m(1, 2), Some(412.0));
}

#[test]
fn an_ascii_grid_without_a_system_names_what_to_write() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = ascii("xllcorner 8\nyllcorner 47\ncellsize 0.01");
    let path = put(folder.path(), "my dem.asc", text);
    let error = refused(&path);
    assert!(error.contains("no my dem.prj next to it"), "{error}");
    assert!(error.contains("the one line EPSG:4326"), "{error}");
    let (old, new) = (path.display(), path.with_extension("new.tif"));
    let command = format!(
        "`gdalwarp -s_srs EPSG:CODE -t_srs EPSG:4326 -r bilinear '{old}' '{}'`",
        new.display()
    );
    assert!(error.contains(&command), "{error}");
    for (system, why) in [
        (
            "PROJCS[\"Mine\",UNIT[\"Meter\",1.0]]",
            "coordinates in `PROJCS",
        ),
        ("EPSG:4267", "EPSG:4267"),
        ("EPSG:x", "EPSG:x"),
        ("", "``"),
    ] {
        put(folder.path(), "my dem.prj", system);
        let error = refused(&path);
        assert!(error.contains(why), "{error}");
        assert!(error.contains("gdalwarp -t_srs EPSG:4326"), "{error}");
    }
}

#[test]
fn an_ascii_grid_in_a_three_dimensional_system_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = put(
        folder.path(),
        "dem.asc",
        ascii("xllcorner 8\nyllcorner 47\ncellsize 0.01"),
    );
    for system in ["EPSG:4979", "EPSG:4937", "EPSG:7843"] {
        put(folder.path(), "dem.prj", system);
        let error = refused(&path);
        assert!(error.contains("above an ellipsoid"), "{error}");
    }
}

#[test]
fn a_damaged_ascii_grid_is_refused_by_what_is_wrong() {
    let folder = tempfile::tempdir().expect("a folder");
    put(folder.path(), "dem.prj", "EPSG:4326");
    let good = ascii("xllcorner 8\nyllcorner 47\ncellsize 0.01");
    for (text, why) in [
        (good.replace("457", ""), "it ends before 6 x 8"),
        (format!("{good} 1"), "more than 6 x 8"),
        (good.replace("457", "457,5"), "`457,5` as row 6"),
        (good.replace("nrows 6\n", ""), "no nrows"),
        (good.replace("nrows 6", "nrows 6.5"), "nrows 6.5"),
        (
            good.replace("ncols 8", "ncols 4000000000"),
            "ncols 4000000000",
        ),
        (good.replace("0.01", "-0.01"), "cell size"),
        (good.replace("xllcorner 8\n", ""), "xllcorner or xllcenter"),
        (
            good.replace("ncols 8\n", "ncols 8\nncols 8\n"),
            "ncols twice",
        ),
        (
            good.replace("ncols 8\n", "ncols 8\nrotation 3\n"),
            "`rotation`",
        ),
        (good.replace("yllcorner 47", "yllcorner 470"), "degrees"),
        ("x".repeat(1000), "no numbers"),
        (String::new(), "no ncols"),
    ] {
        let path = put(folder.path(), "dem.asc", text);
        let error = refused(&path);
        assert!(error.contains(why), "{why}: {error}");
        assert!(error.contains("dem.new.tif"), "{error}");
    }
}

/// A Terrarium tile whose heights are those of a function of row and column.
fn tile(side: u32, height_m: impl Fn(u32, u32) -> f64) -> Vec<u8> {
    let mut pixels = Vec::new();
    for at in 0..side * side {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "heights of ground"
        )]
        let whole = ((height_m(at / side, at % side) + 32_768.0) * 256.0).round() as u32;
        pixels.extend(&whole.to_be_bytes()[1..]);
    }
    picture(side, png::ColorType::Rgb, &pixels)
}

fn picture(side: u32, colours: png::ColorType, pixels: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, side, side);
    encoder.set_color(colours);
    encoder.set_depth(png::BitDepth::Eight);
    let mut image = encoder.write_header().expect("a header");
    image.write_image_data(pixels).expect("pixels");
    image.finish().expect("written");
    file
}

fn bounds(south: f64, west: f64, north: f64, east: f64) -> Option<Bounds> {
    Some(Bounds {
        south_west: place(south, west),
        north_east: place(north, east),
    })
}

/// Tile 12/2151/1440 begins at 47.3388227 N 9.0527344 E, where column 2151 of 4096 begins, and ends at
/// 47.2792290 N.
#[test]
fn terrarium_tiles_lie_where_their_paths_say_and_meet() {
    let folder = tempfile::tempdir().expect("a folder");
    let west = put(
        folder.path(),
        "t/12/2150/1440.png",
        tile(256, |_, column| f64::from(column)),
    );
    let east = tile(512, |_, column| 256.0 + f64::from(column) / 2.0);
    put(folder.path(), "other/12_2151_1440.png", &east);
    let grid = read_terrain(&west, None).expect("a grid");
    let edge = 360.0 * 2151.0 / 4096.0 - 180.0;
    let (lat_deg, column_deg) = (47.01, 360.0 / 4096.0 / 256.0);
    let over_m = height_m(&grid, lat_deg, edge - 10.5 * column_deg) - 245.0;
    assert!((0.0..=grid.raised_m + 0.1).contains(&over_m), "{over_m}");
    assert_eq!(grid.height_m(place(lat_deg, edge + column_deg)), None);
    put(
        folder.path(),
        "t/12/2151/1440.png",
        tile(256, |_, column| 256.0 + f64::from(column)),
    );
    // A coarser level of the same pyramid is not used.
    put(folder.path(), "t/11/1075/720.png", tile(256, |_, _| 5000.0));
    put(folder.path(), "t/legend.png", "no tile");
    let tiles = folder.path().join("t");
    let within = bounds(47.0, edge - 0.02, 47.02, edge + 0.02);
    let grid = read_terrain(&tiles, within).expect("a grid");
    for columns in [-20.5, -0.75, 0.0, 0.25, 30.5] {
        let expected = 255.5 + columns;
        let over_m = height_m(&grid, lat_deg, edge + columns * column_deg) - expected;
        assert!(
            (-0.01..=grid.raised_m + 0.1).contains(&over_m),
            "{columns}: {over_m}"
        );
    }
    let files = terrain_files(&tiles, within).expect("files");
    assert_eq!(
        files,
        [
            tiles.join("12/2150/1440.png"),
            tiles.join("12/2151/1440.png")
        ]
    );
    put(folder.path(), "t/12/2151/1440.png", &east);
    let mixed = read_terrain(&tiles, within)
        .expect_err("two sizes")
        .to_string();
    assert!(
        mixed.contains("12/2151/1440.png: not a readable Terrarium tile: 512"),
        "{mixed}"
    );
}

#[test]
fn pictures_that_are_no_terrarium_tiles_are_refused_by_what_is_wrong() {
    let folder = tempfile::tempdir().expect("a folder");
    // 500 m in the encoding of Mapbox: (500 + 10000) * 10 = 0x019a28.
    let mapbox = [0x01, 0x9a, 0x28].repeat(256 * 256);
    for (bytes, why) in [
        (picture(256, png::ColorType::Rgb, &mapbox), "terrain-RGB"),
        (
            picture(256, png::ColorType::Grayscale, &[0; 256 * 256]),
            "Grayscale",
        ),
        (tile(100, |_, _| 0.0), "100 x 100 pixels"),
        (b"no picture".to_vec(), "not a readable"),
        (tile(256, |_, _| 0.0)[..100].to_vec(), "not a readable"),
    ] {
        let path = put(folder.path(), "12/2151/1440.png", bytes);
        let error = refused(&path);
        assert!(error.contains(why), "{why}: {error}");
    }
    let path = put(folder.path(), "dem.png", tile(256, |_, _| 0.0));
    let error = refused(&path);
    assert!(error.contains("zoom, column and row"), "{error}");
    let clear = [126, 0, 0, 0].repeat(256 * 256);
    let path = put(
        folder.path(),
        "12/2151/1440.png",
        picture(256, png::ColorType::Rgba, &clear),
    );
    assert_eq!(inspect(&path).expect("info").voids, 256 * 256);
}

#[test]
fn every_refused_file_names_the_command_that_converts_it() {
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/geotiff");
    for (name, command) in [
        ("nad27.tif", "gdalwarp -t_srs EPSG:4326 -r bilinear OLD NEW"),
        (
            "no_crs.tif",
            "gdalwarp -s_srs EPSG:CODE -t_srs EPSG:4326 -r bilinear OLD NEW",
        ),
        ("ellipsoid.tif", "gdalwarp -t_srs EPSG:9707 OLD NEW"),
        (
            "rotated.tif",
            "gdalwarp -t_srs EPSG:4326 -r bilinear OLD NEW",
        ),
        (
            "south_up.tif",
            "gdalwarp -t_srs EPSG:4326 -r bilinear OLD NEW",
        ),
        ("two_bands.tif", "gdal_translate -b 1 OLD NEW"),
        ("complex.tif", "gdal_translate -ot Float32 OLD NEW"),
        (
            "no_place.tif",
            "gdal_translate -a_srs EPSG:4326 -a_ullr WEST NORTH EAST SOUTH OLD NEW",
        ),
        (
            "masked.tif",
            "gdalwarp -t_srs EPSG:4326 -r bilinear -dstnodata -9999 OLD NEW",
        ),
    ] {
        let path = fixture.join(name);
        let error = read_terrain(&path, None).expect_err(name).to_string();
        let new = path.with_extension("new.tif").display().to_string();
        let command = command.replace("OLD", &path.display().to_string());
        let command = format!("`{}`", command.replace("NEW", &new));
        assert!(error.contains(&command), "{name}: {error}");
    }
    // One file of a folder is named with its folder.
    let folder = tempfile::tempdir().expect("a folder");
    put(
        folder.path(),
        "a.tif",
        fs::read(fixture.join("nad27.tif")).expect("a fixture"),
    );
    let error = read_terrain(folder.path(), None)
        .expect_err("nad27")
        .to_string();
    assert!(matches!(
        read_terrain(folder.path(), None),
        Err(TerrainError::InFile { .. })
    ));
    let path = folder.path().join("a.tif");
    assert!(
        error.contains(&format!("bilinear {} ", path.display())),
        "{error}"
    );
}

#[test]
fn a_tile_of_another_size_names_the_command_that_converts_it() {
    let folder = tempfile::tempdir().expect("a folder");
    // North of 50 degrees tiles of one arc-second may have half the columns.
    let path = put(folder.path(), "N60E010.hgt", vec![0; 2 * 1801 * 3601]);
    let error = refused(&path);
    assert!(error.contains("12970802 bytes"), "{error}");
    let (old, new) = (path.display(), path.with_extension("new.tif"));
    let command = format!("`gdal_translate {old} {}` converts", new.display());
    assert!(error.contains(&command), "{error}");
    assert!(matches!(
        read_terrain(&path, None),
        Err(TerrainError::Convertible { .. })
    ));
}

/// An unknown compression: the tag of `area.tif` set to 50000.
#[test]
fn an_unknown_compression_names_the_command_that_writes_it_anew() {
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/geotiff/area.tif");
    let mut file = fs::read(fixture).expect("a fixture");
    let tag = [3, 1, 3, 0, 1, 0, 0, 0];
    let at = file
        .windows(8)
        .position(|bytes| bytes == tag)
        .expect("the tag");
    file[at + 8..at + 10].copy_from_slice(&50_000_u16.to_le_bytes());
    let folder = tempfile::tempdir().expect("a folder");
    let path = put(folder.path(), "dem.tif", file);
    let error = refused(&path);
    assert!(error.contains("ompression"), "{error}");
    let path = path.display();
    assert!(
        error.contains(&format!("gdal_translate -co COMPRESS=DEFLATE {path} ")),
        "{error}"
    );
}

#[test]
fn files_of_other_kinds_name_the_command_that_converts_them() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, command) in [
        ("cloud.laz", "`pdal translate OLD NEW -w writers.gdal"),
        ("cloud.LAS", "`pdal translate OLD NEW -w writers.gdal"),
        (
            "quad.dem",
            "`gdalwarp -t_srs EPSG:4326 -r bilinear OLD NEW`",
        ),
        ("n47.dt2", "`gdal_translate OLD NEW`"),
        ("dem.vrt", "`gdal_translate OLD NEW`"),
    ] {
        let path = put(folder.path(), name, "x");
        let error = refused(&path);
        let command = command.replace("OLD", &path.display().to_string());
        let command = command.replace("NEW", &path.with_extension("tif").display().to_string());
        assert!(error.contains(&command), "{name}: {error}");
        assert!(error.contains("unknown kind"), "{error}");
    }
    assert!(!refused(&put(folder.path(), "notes.txt", "x")).contains('`'));
}

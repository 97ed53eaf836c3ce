//! Tags of a GeoTIFF, and files next to it, that change what its numbers mean.

use std::fs;
use std::path::{Path, PathBuf};

use sortie::geodesy::LatLon;
use sortie::world::{TerrainError, TerrainGrid, inspect, read_terrain};

const GDAL_METADATA: u16 = 42112;
const GEO_KEYS: u16 = 34735;

fn fixture(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/geotiff");
    folder.join(name)
}

/// A tag to add to a classic little-endian TIFF: its code, type, count and bytes.
struct Tag {
    code: u16,
    kind: u16,
    count: u32,
    bytes: Vec<u8>,
}

fn text(code: u16, text: &str) -> Tag {
    let mut bytes = text.as_bytes().to_vec();
    bytes.push(0);
    let count = u32::try_from(bytes.len()).expect("short");
    Tag {
        code,
        kind: 2,
        count,
        bytes,
    }
}

fn shorts(code: u16, values: &[u16]) -> Tag {
    Tag {
        code,
        kind: 3,
        count: u32::try_from(values.len()).expect("short"),
        bytes: values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect(),
    }
}

fn doubles(code: u16, values: &[f64]) -> Tag {
    Tag {
        code,
        kind: 12,
        count: u32::try_from(values.len()).expect("short"),
        bytes: values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect(),
    }
}

/// The file with a tag set: its directory is written anew at its end.
fn with_tag(name: &str, tag: &Tag) -> Vec<u8> {
    let mut file = fs::read(fixture(name)).expect("a fixture");
    let word = |at: usize| u16::from_le_bytes([file[at], file[at + 1]]);
    let start = usize::try_from(u32::from_le_bytes(file[4..8].try_into().expect("four")))
        .expect("an offset");
    let mut entries: Vec<Vec<u8>> = (0..usize::from(word(start)))
        .map(|entry| file[start + 2 + 12 * entry..start + 14 + 12 * entry].to_vec())
        .filter(|entry| u16::from_le_bytes([entry[0], entry[1]]) != tag.code)
        .collect();
    let mut value = tag.bytes.clone();
    if value.len() > 4 {
        let at = u32::try_from(file.len()).expect("small");
        file.extend(&value);
        value = at.to_le_bytes().to_vec();
    }
    value.resize(4, 0);
    let head = [tag.code.to_le_bytes(), tag.kind.to_le_bytes()].concat();
    entries.push([head, tag.count.to_le_bytes().to_vec(), value].concat());
    entries.sort_by_key(|entry| u16::from_le_bytes([entry[0], entry[1]]));
    file.resize(file.len().next_multiple_of(2), 0);
    let start = u32::try_from(file.len()).expect("small");
    file[4..8].copy_from_slice(&start.to_le_bytes());
    file.extend(u16::try_from(entries.len()).expect("few").to_le_bytes());
    file.extend(entries.concat());
    file.extend([0; 4]);
    file
}

fn read(bytes: &[u8]) -> Result<TerrainGrid, TerrainError> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("dem.tif");
    fs::write(&path, bytes).expect("written");
    let grid = read_terrain(&path, None);
    assert_eq!(
        grid.is_ok(),
        inspect(&path).is_ok(),
        "info reads as plan does"
    );
    grid
}

fn metadata(items: &str) -> Result<TerrainGrid, TerrainError> {
    let tag = text(
        GDAL_METADATA,
        &format!("<GDALMetadata>\n{items}\n</GDALMetadata>\n"),
    );
    read(&with_tag("area.tif", &tag))
}

fn item(role: &str, value: &str) -> String {
    let name = role.to_uppercase();
    format!("<Item name=\"{name}\" sample=\"0\" role=\"{role}\">{value}</Item>")
}

fn height_m(grid: &TerrainGrid) -> f64 {
    let place = LatLon {
        lat_deg: 47.05,
        lon_deg: 8.10,
    };
    grid.height_m(place).expect("a height")
}

fn is_refused(grid: Result<TerrainGrid, TerrainError>, why: &str) {
    let error = grid.expect_err(why).to_string();
    assert!(error.contains(why), "{why}: {error}");
    assert!(error.contains("allowed"), "{error}");
}

/// `scaled.tif` is written by GDAL: samples (height - 300) * 10, scale 0.1, offset 300.
#[test]
fn the_scale_and_offset_that_gdal_wrote_are_applied() {
    let grid = read_terrain(&fixture("scaled.tif"), None).expect("a grid");
    for (row, column) in [(0, 0), (2, 3), (5, 7)] {
        #[expect(clippy::cast_precision_loss, reason = "small")]
        let expected = 400.0 + (10 * row + column) as f64;
        let height_m = grid.node_m(row, column).expect("a height");
        assert!((height_m - expected).abs() < 1e-3, "{height_m}, {expected}");
    }
    let info = inspect(&fixture("scaled.tif")).expect("info");
    let (low, high) = info.range.expect("heights");
    assert!(
        (low.0 - 400.0).abs() < 1e-3 && (high.0 - 457.0).abs() < 1e-3,
        "{low:?} {high:?}"
    );
}

#[test]
fn scale_offset_and_unit_count_each_alone_and_identities_change_nothing() {
    let height_of = |items: &str| height_m(&metadata(items).expect(items));
    let close = |found: f64, expected: f64| {
        assert!(
            (found - expected).abs() < 1e-3,
            "{found}, expected {expected}"
        );
    };
    close(height_of(&item("scale", "0.5")), 200.0);
    close(height_of(&item("offset", "-355")), 45.0);
    close(height_of(&item("unittype", "metre")), 400.0);
    close(height_of(""), 400.0);
    close(height_of("<Item name=\"AREA_OR_POINT\">Area</Item>"), 400.0);
    close(
        height_of("<Item name=\"lat#units\">degrees_north</Item>"),
        400.0,
    );
    close(
        height_of("<Item name=\"Band1#scale_factor\">1</Item>"),
        400.0,
    );
}

#[test]
fn metadata_that_is_not_understood_is_refused() {
    let feet = "heights in unit `ft`";
    is_refused(metadata(&item("unittype", "ft")), feet);
    is_refused(metadata(&item("scale", "0")), "scale of 0");
    is_refused(metadata(&item("scale", "a tenth")), "a tenth");
    is_refused(metadata(&item("offset", "nan")), "nan");
    is_refused(
        metadata("<Item name=\"SCALE\" role=\"scale\">0.1</Item>"),
        "no band",
    );
    is_refused(
        metadata("<Item name=\"Band1#scale_factor\">0.1</Item>"),
        "GDAL does not apply",
    );
    is_refused(
        metadata("<Item name=\"units\">US survey feet</Item>"),
        "feet",
    );
    is_refused(metadata("<Item name="), "no XML");
    is_refused(
        read(&with_tag("area.tif", &text(GDAL_METADATA, "<Other/>"))),
        "unknown form",
    );
    is_refused(
        read(&with_tag("area.tif", &shorts(GDAL_METADATA, &[1, 2]))),
        "no text",
    );
}

#[test]
fn model_tags_with_a_scale_or_offset_of_height_are_refused() {
    let scale = |z| doubles(33550, &[0.01, 0.01, z]);
    for (z, fine) in [(0.0, true), (1.0, true), (0.1, false), (0.3048, false)] {
        let grid = read(&with_tag("area.tif", &scale(z)));
        assert_eq!(grid.is_ok(), fine, "{z}");
    }
    let tie = doubles(33922, &[0.0, 0.0, 0.0, 8.095, 47.055, 355.0]);
    is_refused(read(&with_tag("area.tif", &tie)), "model tags");
}

#[test]
fn what_is_no_plain_grid_of_heights_is_refused() {
    is_refused(read_terrain(&fixture("masked.tif"), None), "mask");
    is_refused(
        read(&with_tag("area.tif", &shorts(262, &[0]))),
        "photometric",
    );
    is_refused(
        read(&with_tag("area.tif", &shorts(274, &[3]))),
        "orientation",
    );
}

/// The codes are of EPSG: 5703 and 6360 are NAVD88 in metres and in US survey feet, 5715
/// is a depth.
#[test]
fn heights_in_feet_or_downwards_are_refused_by_the_code_of_their_system() {
    let keys = |vertical: &[(u16, u16)]| {
        let mut values = vec![1, 1, 0, 0];
        let base = [(1024, 2), (1025, 1), (2048, 4326), (2054, 9102)];
        for (key, value) in base.iter().chain(vertical) {
            values.extend([*key, 0, 1, *value]);
            values[3] += 1;
        }
        read(&with_tag("area.tif", &shorts(GEO_KEYS, &values)))
    };
    for code in [5703, 3855, 5773, 5103] {
        assert!((height_m(&keys(&[(4096, code)]).expect("metres")) - 400.0).abs() < 1e-3);
    }
    for code in [6360, 8228, 5702, 5715, 6357, 60000] {
        is_refused(keys(&[(4096, code)]), &format!("EPSG:{code}"));
    }
    is_refused(keys(&[(4096, 5703), (4099, 9003)]), "unit EPSG:9003");
    is_refused(keys(&[(4099, 9002)]), "unit EPSG:9002");
}

#[test]
fn a_file_of_gdal_next_to_it_that_changes_numbers_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("dem.tif");
    fs::copy(fixture("area.tif"), &path).expect("copied");
    let with = |band: &str| {
        let text =
            format!("<PAMDataset><PAMRasterBand band=\"1\">{band}</PAMRasterBand></PAMDataset>");
        fs::write(folder.path().join("dem.tif.aux.xml"), text).expect("written");
        read_terrain(&path, None)
    };
    with("<Metadata><MDI key=\"STATISTICS_MEAN\">3</MDI></Metadata>").expect("statistics");
    with("<Scale>1</Scale><Offset>0</Offset><UnitType>m</UnitType>").expect("identities");
    for changed in [
        "<Scale>0.1</Scale>",
        "<Offset>300</Offset>",
        "<UnitType>ft</UnitType>",
        "<NoDataValue>400</NoDataValue>",
    ] {
        is_refused(with(changed), "dem.tif.aux.xml");
    }
    is_refused(with("<Scale>"), "no XML");
}

//! `sortie terrain`: elevation files, inspected, fetched, and exported for a vehicle.

pub(super) mod export;
pub(super) mod fetch;
pub(super) mod http;

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use super::args;
use super::print::console::{out_json, out_lines};
use super::print::failure::Failure;
use crate::geodesy::LatLon;
use crate::world::{self, TerrainError, TerrainInfo};

pub(super) fn run(command: &args::Terrain) -> Result<(), Failure> {
    match command {
        args::Terrain::Info(arguments) => info(arguments),
        args::Terrain::Fetch(arguments) => fetch::run(arguments),
        args::Terrain::Export(arguments) => export::run(arguments),
    }
}

/// A file that cannot be used as ground.
pub(super) fn unusable(path: &Path, error: &TerrainError) -> Failure {
    Failure::new(Failure::INPUT, format!("{}: {error}", path.display()))
}

/// Inspects every file, and reports the unusable ones at the end.
fn info(arguments: &args::TerrainInfo) -> Result<(), Failure> {
    let mut files: Vec<PathBuf> = Vec::new();
    let mut bad = Vec::new();
    for path in &arguments.files {
        if path.is_dir() {
            match world::elevation_files(path) {
                Ok(found) if found.is_empty() => bad.push(format!(
                    "{}: no elevation file in this folder",
                    path.display()
                )),
                Ok(found) => files.extend(found),
                Err(error) => bad.push(unusable(path, &error).message),
            }
        } else {
            files.push(path.clone());
        }
    }
    let mut good = Vec::new();
    for path in files {
        match world::inspect(&path) {
            Ok(found) => good.push((path, found)),
            Err(error) => bad.push(unusable(&path, &error).message),
        }
    }
    if arguments.json {
        let files = good
            .iter()
            .map(|(path, found)| TerrainFile::new(path, found));
        out_json(&TerrainDocument {
            files: files.collect(),
            unusable: bad.clone(),
        })?;
    } else {
        for (path, found) in &good {
            out_lines(&lines(path, found))?;
        }
    }
    if bad.is_empty() {
        Ok(())
    } else {
        Err(Failure::all(Failure::INPUT, bad))
    }
}

fn lines(path: &Path, found: &TerrainInfo) -> [String; 5] {
    let (south_west, north_east) = (found.south_west, found.north_east);
    let middle = LatLon {
        lat_deg: f64::midpoint(south_west.lat_deg, north_east.lat_deg),
        lon_deg: south_west.lon_deg,
    };
    let distance_m = |lat_deg: f64, lon_deg: f64| {
        middle.chord_m(LatLon {
            lat_deg: middle.lat_deg + lat_deg,
            lon_deg: middle.lon_deg + lon_deg,
        })
    };
    let range = match found.range {
        Some((low, high)) => format!("{:.1} m to {:.1} m", low.0, high.0),
        None => "no height at all".to_owned(),
    };
    let voids = match found.voids {
        0 => "no voids".to_owned(),
        1 => "1 void".to_owned(),
        voids => format!("{voids} voids"),
    };
    [
        format!("{}: {}", path.display(), found.format),
        format!(
            "  latitude {:.6} to {:.6}, longitude {:.6} to {:.6}",
            south_west.lat_deg, north_east.lat_deg, south_west.lon_deg, north_east.lon_deg
        ),
        format!(
            "  {} x {} posts every {:.3}\" x {:.3}\" ({:.1} m x {:.1} m)",
            found.rows,
            found.columns,
            found.row_step_deg * 3600.0,
            found.column_step_deg * 3600.0,
            distance_m(found.row_step_deg, 0.0),
            distance_m(0.0, found.column_step_deg),
        ),
        format!("  {range}, {voids}"),
        format!("  {}", found.datum),
    ]
}

/// What elevation files hold.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct TerrainDocument {
    /// In the order of the arguments.
    files: Vec<TerrainFile>,
    /// Files and folders that cannot be used, each with the reason.
    unusable: Vec<String>,
}

/// What one elevation file holds.
#[derive(Debug, Serialize, JsonSchema)]
struct TerrainFile {
    /// Its path.
    file: String,
    /// Its format.
    format: &'static str,
    /// Its south-west corner.
    south_west: Corner,
    /// Its north-east corner.
    north_east: Corner,
    /// Posts from north to south.
    rows: usize,
    /// Posts from west to east.
    columns: usize,
    /// From post to post north, degrees.
    row_step_deg: f64,
    /// From post to post east, degrees.
    column_step_deg: f64,
    /// Posts without data.
    voids: usize,
    /// Metres above mean sea level; null without any data.
    #[serde(rename = "lowest_amsl_m")]
    min_amsl_m: Option<f64>,
    /// Metres above mean sea level; null without any data.
    #[serde(rename = "highest_amsl_m")]
    max_amsl_m: Option<f64>,
    /// What its heights refer to.
    datum: String,
}

/// A place.
#[derive(Debug, Serialize, JsonSchema)]
struct Corner {
    /// Degrees north, WGS84.
    lat_deg: f64,
    /// Degrees east, WGS84.
    lon_deg: f64,
}

impl From<LatLon> for Corner {
    fn from(LatLon { lat_deg, lon_deg }: LatLon) -> Self {
        Self { lat_deg, lon_deg }
    }
}

impl TerrainFile {
    fn new(path: &Path, found: &TerrainInfo) -> Self {
        Self {
            file: path.display().to_string(),
            format: found.format,
            south_west: found.south_west.into(),
            north_east: found.north_east.into(),
            rows: found.rows,
            columns: found.columns,
            row_step_deg: found.row_step_deg,
            column_step_deg: found.column_step_deg,
            voids: found.voids,
            min_amsl_m: found.range.map(|(low, _)| low.0),
            max_amsl_m: found.range.map(|(_, high)| high.0),
            datum: found.datum.clone(),
        }
    }
}

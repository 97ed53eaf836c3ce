//! `sortie new`: a commented spec for a place, to begin with.

use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::args;
use super::print::console::{note, out};
use super::print::failure::Failure;
use crate::spec::SpecFile;
use crate::world::{self, World};

/// The spec, with names in braces where it depends on the place.
const TEMPLATE: &str = include_str!("new.yaml");
/// Metres of a degree of latitude, about.
const DEGREE_M: f64 = 111_320.0;
/// From the middle of the area to its sides, and to start and goal, metres.
const SIDE_M: f64 = 1500.0;
const ROUTE_M: f64 = 600.0;
/// From the highest ground to the ceiling, metres.
const CEILING_M: f64 = 120.0;
/// A ceiling above all ground, with which terrain is read for the first time, metres.
const HIGHEST_M: f64 = 9500.0;

pub(super) fn run(arguments: &args::New) -> Result<(), Failure> {
    let path = match &arguments.output {
        Some(path) => path.clone(),
        None => PathBuf::from(format!("{}.yaml", arguments.name)),
    };
    refuse_antimeridian(arguments.at)?;
    let spec = |ceiling_m| text(&path, arguments, ceiling_m);
    let ceiling_m = match arguments.terrain {
        Some(_) => highest_m(&checked(&path, spec(HIGHEST_M))?) + CEILING_M,
        None => CEILING_M,
    };
    let text = spec(ceiling_m.ceil());
    checked(&path, text.clone())?;
    let written = File::create_new(&path).and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|error| {
        let message = match error.kind() {
            ErrorKind::AlreadyExists => {
                format!(
                    "{} is there already, and not replaced (another file: -o FILE)",
                    path.display()
                )
            }
            _ => format!("{}: {error}", path.display()),
        };
        Failure::new(Failure::OUTPUT, message)
    })?;
    let shown = path.display();
    if arguments.terrain.is_none() {
        note(
            "The ground is taken as flat, and altitudes as above home: give elevation with --terrain, \
             or the height of the ground above the sea in `terrain`.",
        );
    }
    out(&format!(
        "{shown}: written. Next: `sortie check {shown}`, `sortie plan {shown}`"
    ))
}

/// An area of a spec lies on one side of the antimeridian.
fn refuse_antimeridian((lat_deg, lon_deg): (f64, f64)) -> Result<(), Failure> {
    // Rounded down, so that what is said to be allowed is.
    let max_deg = (1e4 * (180.0 - degrees_east(SIDE_M, lat_deg))).floor() / 1e4;
    if lon_deg.abs() <= max_deg {
        return Ok(());
    }
    let message = format!(
        "--at {lat_deg},{lon_deg}: an area of {} km around it would cross the antimeridian (allowed at this latitude: longitudes from -{max_deg} to {max_deg})",
        2.0 * SIDE_M / 1000.0
    );
    Err(Failure::new(Failure::USAGE, message))
}

/// Degrees of longitude of a distance at a latitude, about.
fn degrees_east(m: f64, lat_deg: f64) -> f64 {
    m / (DEGREE_M * lat_deg.to_radians().cos())
}

/// The spec of the arguments under a ceiling.
fn text(path: &Path, arguments: &args::New, ceiling_m: f64) -> String {
    let (lat_deg, lon_deg) = arguments.at;
    let north = |m: f64| format!("{:.6}", lat_deg + m / DEGREE_M);
    let east = |m: f64| format!("{:.6}", lon_deg + degrees_east(m, lat_deg));
    let terrain = match &arguments.terrain {
        Some(file) => format!("terrain: {{file: {}}}", quoted(&file.to_string_lossy())),
        None => "terrain: {flat: {amsl_m: 0}}     # the height of flat ground above the sea, or {file: ELEVATION.tif}"
            .to_owned(),
    };
    let reference = match arguments.terrain {
        Some(_) => "amsl",
        None => "relative",
    };
    let values = [
        ("file", path.display().to_string()),
        ("name", quoted(&arguments.name)),
        ("south", north(-SIDE_M)),
        ("north", north(SIDE_M)),
        ("west", east(-SIDE_M)),
        ("east", east(SIDE_M)),
        ("ceiling", ceiling_m.to_string()),
        ("terrain", terrain),
        ("lat", north(0.0)),
        ("lon", east(0.0)),
        ("start_lon", east(-ROUTE_M)),
        ("goal_lon", east(ROUTE_M)),
        ("reference", reference.to_owned()),
    ];
    values
        .into_iter()
        .fold(TEMPLATE.to_owned(), |text, (name, value)| {
            text.replace(&format!("{{{name}}}"), &value)
        })
}

/// A YAML string, whatever is in it: JSON is YAML.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// The world of a spec that must be good.
fn checked(path: &Path, text: String) -> Result<World, Failure> {
    let file = SpecFile::parse_known(path, text).map_err(world::with_ground)?;
    Ok(world::load(&file)?)
}

/// Highest ground of the area, metres above the sea.
fn highest_m(world: &World) -> f64 {
    let heights = world.ground.heights_m.iter().copied().map(f64::from);
    heights.fold(f64::NEG_INFINITY, f64::max)
}

//! `sortie terrain export`: the ground of a spec as ArduPilot's terrain database.

use std::fs;
use std::path::{Path, PathBuf};

use crate::cli::args;
use crate::cli::folder::replace::NewFolder;
use crate::cli::print::console::{note, out};
use crate::cli::print::failure::Failure;
use crate::formats::dat;
use crate::spec::SpecFile;
use crate::world;

pub(crate) fn run(arguments: &args::TerrainExport) -> Result<(), Failure> {
    let file = SpecFile::read_known(&arguments.spec).map_err(world::with_ground)?;
    let world = world::load(&file)?;
    let default = || PathBuf::from("out").join(format!("{}.terrain", file.spec.name));
    let target = arguments.out.clone().unwrap_or_else(default);
    let database = dat::write(&world.terrain, &file.spec.area, arguments.spacing);
    let folder = NewFolder::next_to(&target, reason_not_to_replace)?;
    for file in &database.files {
        folder.write(&file.name, &file.bytes)?;
    }
    folder.publish()?;
    let names: Vec<&str> = database
        .files
        .iter()
        .map(|file| file.name.as_str())
        .collect();
    out(&format!(
        "{}: {}, {} blocks; copy to APM/TERRAIN on the vehicle's card and set TERRAIN_SPACING {}",
        target.display(),
        names.join(", "),
        database.blocks,
        arguments.spacing
    ))?;
    let hidden = dat::hidden(&world.terrain, &file.spec.area, arguments.spacing);
    if let Some(worst) = hidden.filter(|worst| worst.height_m >= 1.0) {
        note(&format!(
            "between its heights the ground stands up to {:.1} m higher than the vehicle will know, at {:.6}, {:.6}",
            worst.height_m, worst.place.lat_deg, worst.place.lon_deg
        ));
    }
    if database.missing > 0 {
        note(&format!(
            "{} patches of 4 x 4 heights within the area have no elevation data and were left out: the vehicle asks its ground station for them",
            database.missing
        ));
    }
    Ok(())
}

/// Only a folder of such files and nothing else may be replaced.
fn reason_not_to_replace(target: &Path) -> Option<String> {
    let Ok(entries) = fs::read_dir(target) else {
        return target
            .exists()
            .then(|| "a file of this name is in the way".to_owned());
    };
    let mut foreign: Vec<String> = entries
        .flatten()
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .filter(|name| !name.ends_with(".DAT"))
        .collect();
    foreign.sort();
    let first = foreign.first()?;
    Some(format!("it holds {first}, and is not replaced"))
}

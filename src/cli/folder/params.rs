//! The parameters of a vehicle next to its mission file.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::cli::print::failure::Failure;
use crate::formats;
use crate::mission::Parameter;
use crate::numeric::text::read_regular;

/// Extensions of parameter files: Sortie's and QGroundControl's, Mission Planner's, MAVProxy's.
const PARAMS: [&str; 3] = ["params", "param", "parm"];

/// The file with the parameters of a vehicle next to its mission file: by the id of the vehicle, or
/// by the name of the mission.
pub(in crate::cli) fn params_path(path: &Path, id: &str) -> Option<PathBuf> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let named = |stem: &str| PARAMS.map(|end| path.with_file_name(format!("{stem}.{end}")));
    let mut found = named(id).into_iter().chain(named(&stem));
    found.find(|params| params.symlink_metadata().is_ok())
}

/// The parameters of a vehicle that stand next to its mission file, so that every command judges a
/// mission with the same ones; none without such a file.
pub(in crate::cli) fn read_params(path: &Path, id: &str) -> Result<Vec<Parameter>, Failure> {
    let Some(params) = params_path(path, id) else {
        return Ok(Vec::new());
    };
    let found = read_params_file(&params)?;
    let values = |found: &[Parameter]| -> BTreeMap<String, u32> {
        let values = found.iter();
        values
            .map(|of| (of.name.clone(), of.value.to_bits()))
            .collect()
    };
    // Nobody knows which of them the vehicle has.
    for other in PARAMS.map(|end| params.with_extension(end)) {
        let stands = other != params && other.symlink_metadata().is_ok();
        if stands && values(&read_params_file(&other)?) != values(&found) {
            let message = format!(
                "{} and {} have different parameters: remove one of them",
                params.display(),
                other.display()
            );
            return Err(Failure::new(Failure::INPUT, message));
        }
    }
    Ok(found)
}

/// None where there is no such file.
fn read_params_file(path: &Path) -> Result<Vec<Parameter>, Failure> {
    let bad = |why: String| Failure::new(Failure::INPUT, format!("{}: {why}", path.display()));
    match read_regular(path) {
        Ok(text) => formats::params::read(&text).map_err(|error| bad(error.to_string())),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(Vec::new()),
        Err(error) => Err(bad(error.to_string())),
    }
}

//! Mission files and the vehicles that they are for.

use std::collections::BTreeMap;
use std::path::PathBuf;

use super::{REJECTED, read_mission, refuse_edited, vehicle_of};
use crate::cli::print::failure::Failure;
use crate::mission::VehicleMission;
use crate::spec::SpecFile;

/// The mission file of each vehicle, by index in the spec.
pub(crate) type Files = BTreeMap<usize, PathBuf>;

/// Assigns each file to its vehicle: `<id>.*` by name, others as `--vehicle` says.
pub(crate) fn assign<'a>(
    file: &SpecFile,
    paths: impl Iterator<Item = &'a PathBuf>,
    named: &[(&str, PathBuf)],
) -> Result<Files, Failure> {
    let ids = || {
        file.spec
            .vehicles
            .iter()
            .map(|v| v.id.as_str())
            .collect::<Vec<_>>()
            .join(", ")
    };
    let mut files = Files::new();
    let mut add = |vehicle: usize, path: PathBuf| match files.insert(vehicle, path.clone()) {
        None => Ok(()),
        Some(other) => Err(Failure::new(
            Failure::USAGE,
            format!(
                "{} and {} are both for {}: name one",
                other.display(),
                path.display(),
                file.spec.vehicles[vehicle].id
            ),
        )),
    };
    for (id, path) in named {
        let vehicle = file
            .spec
            .vehicles
            .iter()
            .position(|vehicle| vehicle.id == *id);
        let unknown = || {
            Failure::new(
                Failure::USAGE,
                format!("no vehicle {id} in the spec (there are: {})", ids()),
            )
        };
        add(vehicle.ok_or_else(unknown)?, path.clone())?;
    }
    for path in paths {
        let vehicle = vehicle_of(path, file).ok_or_else(|| {
            let message = format!(
                "{}: for which vehicle? Use --vehicle ID=FILE (there are: {})",
                path.display(),
                ids()
            );
            Failure::new(Failure::USAGE, message)
        })?;
        add(vehicle, path.clone())?;
    }
    if files.is_empty() {
        return Err(Failure::new(Failure::USAGE, "no mission files given"));
    }
    Ok(files)
}

/// Reads the mission of each vehicle, in the order of the spec.
pub(crate) fn read(
    file: &SpecFile,
    files: &Files,
) -> Result<Vec<(usize, VehicleMission)>, Failure> {
    files
        .iter()
        .map(|(vehicle, path)| Ok((*vehicle, read_mission(path, file, *vehicle)?)))
        .collect()
}

/// The spec and the missions of a folder that `plan` wrote.
pub(crate) fn from_folder(
    paths: &[PathBuf],
    force: bool,
) -> Result<(SpecFile, Files, PathBuf), Failure> {
    let [folder] = paths else {
        return Err(Failure::new(
            Failure::USAGE,
            "one folder at a time; for files, name their spec with --spec",
        ));
    };
    if !folder.is_dir() {
        let message = format!(
            "{}: not a folder; for files, name their spec with --spec",
            folder.display()
        );
        return Err(Failure::new(Failure::INPUT, message));
    }
    let spec = folder.join("spec.yaml");
    if !spec.exists() {
        let message = format!(
            "{}: not a folder that `sortie plan` wrote: it holds no spec.yaml",
            folder.display()
        );
        return Err(Failure::new(Failure::INPUT, message));
    }
    let file = SpecFile::read(&spec)?;
    let mut files = Files::new();
    for (index, vehicle) in file.spec.vehicles.iter().enumerate() {
        let accepted = folder.join(format!("{}.plan", vehicle.id));
        let rejected = folder.join(format!("{}{}.plan", vehicle.id, REJECTED));
        let path = match (accepted.is_file(), rejected.is_file()) {
            (true, _) => accepted,
            (false, true) if force => rejected,
            (false, true) => {
                let message = format!(
                    "{} was rejected by verification; nothing was sent",
                    rejected.display()
                );
                return Err(Failure::new(Failure::VERDICT, message));
            }
            (false, false) => {
                return Err(Failure::new(
                    Failure::INPUT,
                    format!("{} is missing", accepted.display()),
                ));
            }
        };
        files.insert(index, path);
    }
    if !force {
        refuse_edited(folder, &file, &files)?;
    }
    Ok((file, files, folder.clone()))
}

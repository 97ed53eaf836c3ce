//! Folders among the files of a review.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::cli::folder::disagreeing_counterpart;
use crate::cli::print::failure::Failure;
use crate::mission::VehicleMission;

/// The paths with each folder replaced by what it holds: its `spec.yaml`, or its only spec, and one
/// mission file for each name, `.plan` before `.waypoints`, which holds no fence.
pub(super) fn opened(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let mut opened = Vec::new();
    for path in paths {
        match path.is_dir() {
            true => opened.extend(of_folder(path)?),
            false => opened.push(path.clone()),
        }
    }
    Ok(opened)
}

/// Refuses a folder whose `.plan` and `.waypoints` hold different missions of one vehicle: either may be
/// the one that is flown.
pub(super) fn refuse_disagreeing<'a>(
    paths: &[PathBuf],
    missions: impl Iterator<Item = (&'a PathBuf, &'a VehicleMission)>,
) -> Result<(), Failure> {
    for (path, mission) in missions {
        if !paths.iter().any(|folder| path.parent() == Some(folder)) {
            continue;
        }
        if let Some(counterpart) = disagreeing_counterpart(path, mission)? {
            let message = format!(
                "{} and {} disagree: name the one to review",
                path.display(),
                counterpart.display()
            );
            return Err(Failure::new(Failure::VERDICT, message));
        }
    }
    Ok(())
}

fn of_folder(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let refused = |why: String| {
        let message = format!("{}: {why}", folder.display());
        Failure::new(Failure::INPUT, message)
    };
    let entries = std::fs::read_dir(folder).map_err(|error| refused(error.to_string()))?;
    let (mut specs, mut missions) = (Vec::new(), BTreeMap::<PathBuf, PathBuf>::new());
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    for path in paths.into_iter().filter(|path| path.is_file()) {
        let ending = path.extension().and_then(|ending| ending.to_str());
        match ending {
            Some("yaml" | "yml") => specs.push(path),
            // In the order of their names `.plan` comes first.
            Some("plan" | "waypoints") => {
                missions.entry(path.with_extension("")).or_insert(path);
            }
            _ => {}
        }
    }
    if missions.is_empty() {
        return Err(refused("holds no mission (.plan, .waypoints)".to_owned()));
    }
    if specs.len() > 1 {
        specs.retain(|path| path.file_name().is_some_and(|name| name == "spec.yaml"));
    }
    Ok(specs.into_iter().chain(missions.into_values()).collect())
}

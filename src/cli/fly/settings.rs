//! The parameter files of a plan: what the verdict assumes of the vehicles.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::cli::print::failure::Failure;
use crate::formats;
use crate::mission::{self, Parameter, VehicleMission};
use crate::spec::MissionSpec;

/// Why a plan without this file is not flown.
const MISSING: &str = "is missing: `plan` writes one for each vehicle, with the parameters that the verdict assumes \
     of it; plan again; nothing was started";

fn path_of(spec: &MissionSpec, folder: &Path, vehicle: usize) -> PathBuf {
    folder.join(format!("{}.params", spec.vehicles[vehicle].id))
}

/// Gives every mission the parameters in its file.
pub(super) fn read(
    spec: &MissionSpec,
    folder: &Path,
    missions: &mut [(usize, VehicleMission)],
) -> Result<(), Failure> {
    for (vehicle, mission) in missions {
        let path = path_of(spec, folder, *vehicle);
        let bad = |why: String| Failure::new(Failure::INPUT, format!("{}: {why}", path.display()));
        let text = std::fs::read_to_string(&path).map_err(|error| match error.kind() {
            ErrorKind::NotFound => bad(MISSING.to_owned()),
            _ => bad(error.to_string()),
        })?;
        mission.params = formats::params::read(&text).map_err(|error| bad(error.to_string()))?;
    }
    Ok(())
}

/// Refuses parameters that are not those of the plan: a vehicle would be held against them, and
/// set to them. Speeds and departures of the spec are those of the missions.
pub(super) fn refuse_edited(
    spec: &MissionSpec,
    folder: &Path,
    missions: &[(usize, VehicleMission)],
) -> Result<(), Failure> {
    for (vehicle, mission) in missions {
        let has_fence = !mission.fence.is_empty();
        let (this, options) = (&spec.vehicles[*vehicle], &spec.mission);
        let home_amsl_m = f64::from(mission.home.amsl_m);
        let planned = mission::parameters(this, options, home_amsl_m, has_fence);
        if let Some(what) = difference(&mission.params, &planned) {
            let path = path_of(spec, folder, *vehicle);
            let message = format!("{}: {what}; nothing was started", path.display());
            return Err(Failure::new(Failure::VERDICT, message));
        }
    }
    Ok(())
}

/// The first difference, in words.
fn difference(found: &[Parameter], planned: &[Parameter]) -> Option<String> {
    /// What speeds and homes lose as the numbers of a mission.
    const SHARE: f32 = 1e-4;
    let of = |list: &[Parameter], name: &str| -> Option<f32> {
        list.iter().find(|of| of.name == name).map(|of| of.value)
    };
    for wanted in planned {
        let (name, value) = (&wanted.name, wanted.value);
        let Some(held) = of(found, name) else {
            return Some(format!("{name} is missing, the plan assumes {value}"));
        };
        // Not `>`: what is no number differs.
        let is_same = (held - value).abs() <= SHARE * value.abs().max(1.0);
        if !is_same {
            return Some(format!("{name} is {held}, the plan assumes {value}"));
        }
    }
    let mut names = found.iter().enumerate();
    let stranger = names.find(|(index, one)| {
        of(planned, &one.name).is_none() || found[..*index].iter().any(|of| of.name == one.name)
    });
    stranger.map(|(_, one)| format!("{} = {} is none of the plan's", one.name, one.value))
}

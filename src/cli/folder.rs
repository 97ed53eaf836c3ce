//! The files of an output folder: what `plan` writes and `upload` reads.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::failure::Failure;
use super::output::NewFolder;
use crate::dispatch::Dispatched;
use crate::formats;
use crate::mission::VehicleMission;
use crate::path::TimedPoint;
use crate::report::{self, ReviewInput};
use crate::spec::{SpecFile, TerrainSource};
use crate::verify::Review;
use crate::world::World;

/// SHA-256 of a text, in hexadecimal.
pub(super) fn sha256(text: &str) -> String {
    Sha256::digest(text.as_bytes())
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}

/// Where records of uploads and flights of an output folder go: `DIR.runs`.
pub(super) fn runs_folder(out: &Path) -> PathBuf {
    let out = std::path::absolute(out).unwrap_or_else(|_| out.to_owned());
    let mut name = out.file_name().map(OsStr::to_owned).unwrap_or_default();
    name.push(".runs");
    out.with_file_name(name)
}

/// Writes everything that `plan` leaves, whole or not at all.
pub(super) fn write(
    out: &Path,
    file: &SpecFile,
    world: &World,
    dispatched: &Dispatched,
    timing: &serde_json::Value,
) -> Result<(), Failure> {
    let (spec, review) = (&file.spec, &dispatched.review);
    let folder = NewFolder::beside(out)?;
    if let (Some(path), TerrainSource::File(name)) = (file.terrain_path(), &spec.terrain) {
        let bytes = std::fs::read(&path).map_err(|error| {
            Failure::new(
                Failure::INPUT,
                format!("cannot read {}: {error}", path.display()),
            )
        })?;
        folder.write(&name.to_string_lossy(), &bytes)?;
    }
    folder.write("spec.yaml", file.text.as_bytes())?;
    for (vehicle, mission) in &dispatched.missions {
        let id = &spec.vehicles[*vehicle].id;
        let tag = if review.accepts(id) { "" } else { REJECTED };
        let waypoints = formats::waypoints::write(mission);
        folder.write(&format!("{id}{tag}.waypoints"), waypoints.as_bytes())?;
        folder.write(
            &format!("{id}{tag}.plan"),
            formats::plan::write(mission).as_bytes(),
        )?;
        folder.write(
            &format!("{id}.params"),
            formats::params::write(mission).as_bytes(),
        )?;
    }
    let paths: Vec<(&str, Vec<TimedPoint>)> = spec
        .vehicles
        .iter()
        .zip(&dispatched.plan.vehicles)
        .map(|(vehicle, plan)| (vehicle.id.as_str(), plan.path()))
        .collect();
    let paths: Vec<(&str, &[TimedPoint])> = paths
        .iter()
        .map(|(id, path)| (*id, path.as_slice()))
        .collect();
    folder.write(
        "fleet.kml",
        formats::kml::write(spec, world, &paths).as_bytes(),
    )?;
    folder.write(
        "fleet.geojson",
        formats::geojson::write(spec, world, &paths).as_bytes(),
    )?;
    let hash = sha256(&file.text);
    let plan = report::plan_json(&hash, spec, world, &dispatched.plan, review.passes());
    folder.write("plan.json", report::json_text(&plan).as_bytes())?;
    folder.write(
        "review.json",
        report::json_text(&report::review_json(review)).as_bytes(),
    )?;
    let missions: Vec<(usize, &VehicleMission)> = dispatched
        .missions
        .iter()
        .map(|(vehicle, mission)| (*vehicle, mission))
        .collect();
    let page = page(file, world, Some(dispatched), &missions, review);
    folder.write("review.html", page.as_bytes())?;
    folder.write("timing.json", report::json_text(timing).as_bytes())?;
    folder.publish()?;
    Ok(())
}

/// The review page.
pub(super) fn page(
    file: &SpecFile,
    world: &World,
    dispatched: Option<&Dispatched>,
    missions: &[(usize, &VehicleMission)],
    review: &Review,
) -> String {
    report::review_html(&ReviewInput {
        spec: &file.spec,
        world,
        plan: dispatched.map(|dispatched| &dispatched.plan),
        missions,
        review,
        seed: dispatched.map(|dispatched| dispatched.plan.seed),
        spec_sha256: &sha256(&file.text),
        version: env!("CARGO_PKG_VERSION"),
    })
}

/// Marks the name of a mission that fails verification.
pub(super) const REJECTED: &str = ".REJECTED";

/// Reads a mission file by its extension, `.waypoints` or `.plan`.
pub(super) fn read_mission(
    path: &Path,
    file: &SpecFile,
    vehicle: usize,
) -> Result<VehicleMission, Failure> {
    let bad = |what: String| Failure::new(Failure::INPUT, format!("{}: {what}", path.display()));
    let bytes = std::fs::read(path).map_err(|error| bad(format!("cannot be read: {error}")))?;
    let text = String::from_utf8(bytes).map_err(|error| bad(format!("not text: {error}")))?;
    let document = match path.extension().and_then(OsStr::to_str) {
        Some("waypoints") => formats::waypoints::read(&text),
        Some("plan") => formats::plan::read(&text),
        _ => {
            return Err(Failure::new(
                Failure::USAGE,
                format!("{}: neither .waypoints nor .plan", path.display()),
            ));
        }
    };
    let vehicle = &file.spec.vehicles[vehicle];
    document
        .and_then(|document| document.into_mission(vehicle.autopilot, vehicle.airframe))
        .map_err(|error| bad(error.to_string()))
}

/// The vehicle whose name a mission file has, such as `alpha.waypoints` or `alpha.REJECTED.plan`.
pub(super) fn vehicle_of(path: &Path, file: &SpecFile) -> Option<usize> {
    let stem = path.file_stem()?.to_str()?;
    let stem = stem.strip_suffix(REJECTED).unwrap_or(stem);
    file.spec
        .vehicles
        .iter()
        .position(|vehicle| vehicle.id == stem)
}

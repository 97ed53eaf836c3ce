//! The output folder: `plan` writes its files, `upload` reads them.

pub(super) mod claim;
pub(super) mod missions;
pub(super) mod params;
pub(super) mod replace;
pub(super) mod runs;

use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

use sha2::{Digest, Sha256};

use super::print::failure::Failure;
use crate::dispatch::Dispatched;
use crate::formats::{self, Document};
use crate::library::mission_files;
use crate::mission::VehicleMission;
use crate::numeric::text::open_regular;
use crate::path::TimedPoint;
use crate::report::{self, PlanDocument, ReviewInput, TimingDocument};
use crate::spec::{SpecFile, TerrainSource};
use crate::world::{self, World};
use params::read_params;
use replace::NewFolder;

/// SHA-256 of a text, in hexadecimal.
pub(super) fn sha256(text: &str) -> String {
    Sha256::digest(text.as_bytes())
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}

/// The content of `plan.json`.
pub(super) fn plan_document<'a>(
    file: &'a SpecFile,
    world: &'a World,
    dispatched: &'a Dispatched,
) -> PlanDocument<'a> {
    let (spec, world) = dispatched.planned_spec(&file.spec, world);
    let passes = dispatched.review.passes();
    let sha256 = sha256(&file.text);
    let mut document = PlanDocument {
        table_sha256: table_sha256(file),
        ..report::plan_json(&sha256, spec, world, &dispatched.plan, passes)
    };
    if let Some(tasks) = &dispatched.tasks {
        document.add_tasks(tasks);
    }
    document.add_review(&dispatched.review);
    document
}

/// SHA-256 of the table of vehicles that a spec names.
fn table_sha256(file: &SpecFile) -> Option<String> {
    file.table.as_ref().map(|table| sha256(&table.text))
}

/// Checks that [`write()`] can make or replace the folder, before the planning.
///
/// # Errors
/// It holds something else than an earlier plan, or cannot be written.
pub(super) fn check_output(out: &Path) -> Result<(), Failure> {
    Ok(replace::check(out, reason_not_to_replace)?)
}

/// Writes the output folder of `plan`, whole or not at all.
pub(super) fn write(
    out: &Path,
    file: &SpecFile,
    world: &World,
    dispatched: &Dispatched,
    timing: &dyn Fn() -> TimingDocument,
) -> Result<(), Failure> {
    let folder = NewFolder::next_to(out, reason_not_to_replace)?;
    copy_terrain(&folder, file)?;
    if let Some(table) = &file.table {
        folder.write(&table.name.to_string_lossy(), table.text.as_bytes())?;
    }
    for attached in &file.attached {
        folder.write(&attached.name.to_string_lossy(), &attached.bytes)?;
    }
    folder.write("spec.yaml", file.text.as_bytes())?;
    let accepted = dispatched.review.accepted();
    let seed = dispatched.plan.seed;
    for (vehicle, mission) in &dispatched.missions {
        let id = &file.spec.vehicles[*vehicle].id;
        write_mission(&folder, id, (mission, seed), accepted.contains(id.as_str()))?;
    }
    write_documents(&folder, file, world, dispatched)?;
    folder.write("timing.json", report::json_text(&timing()).as_bytes())?;
    folder.publish()?;
    Ok(())
}

/// Writes maps, plan, review and page: the documents of the whole fleet.
fn write_documents(
    folder: &NewFolder,
    file: &SpecFile,
    world: &World,
    dispatched: &Dispatched,
) -> Result<(), Failure> {
    let review = &dispatched.review;
    let seed = dispatched.plan.seed;
    let (spec, planned_world) = dispatched.planned_spec(&file.spec, world);
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
    let missions: Vec<(usize, &VehicleMission)> = dispatched
        .missions
        .iter()
        .map(|(vehicle, mission)| (*vehicle, mission))
        .collect();
    let hash = sha256(&file.text);
    let input = ReviewInput {
        spec,
        world: planned_world,
        plan: Some(&dispatched.plan),
        missions: &missions,
        review,
        seed: Some(seed),
        spec_sha256: &hash,
        version: env!("CARGO_PKG_VERSION"),
    };
    let (page, (kml, geojson)) = rayon::join(
        || report::review_html(&input),
        || {
            let kml = formats::kml::write(spec, planned_world, &paths, seed);
            (
                kml,
                formats::geojson::write(spec, planned_world, &paths, seed),
            )
        },
    );
    folder.write("fleet.kml", kml.as_bytes())?;
    folder.write("fleet.geojson", geojson.as_bytes())?;
    drop((kml, geojson));
    folder.write("review.html", page.as_bytes())?;
    drop(page);
    folder.write_json("plan.json", &plan_document(file, world, dispatched))?;
    folder.write_json("review.json", &report::review_json(review, Some(seed)))?;
    Ok(())
}

/// The files of one vehicle; a rejected mission has a name of its own.
fn write_mission(
    folder: &NewFolder,
    id: &str,
    planned: (&VehicleMission, u64),
    is_accepted: bool,
) -> Result<(), Failure> {
    for (name, text) in mission_files(id, planned, is_accepted) {
        folder.write(&name, text.as_bytes())?;
    }
    Ok(())
}

/// Copies the elevation files that a spec uses to the same place beside its copy.
fn copy_terrain(folder: &NewFolder, file: &SpecFile) -> Result<(), Failure> {
    let unusable = |error| Failure::new(Failure::INPUT, format!("the terrain: {error}"));
    let spec_folder = file.path.parent().unwrap_or(Path::new(""));
    for path in world::files(file).map_err(unusable)? {
        let name = path.strip_prefix(spec_folder).unwrap_or(&path);
        folder.copy(&path, &name.to_string_lossy())?;
    }
    Ok(())
}

/// Marks the name of a mission that fails verification.
pub(super) use crate::library::REJECTED;

/// Largest mission file: a thousand times the largest mission of any autopilot.
const MAX_BYTES: u64 = 64 << 20;

pub(super) fn is_waypoints(path: &Path) -> bool {
    path.extension()
        .is_some_and(|extension| extension == "waypoints")
}

/// Whether a mission file is marked as rejected.
pub(super) fn is_rejected(path: &Path) -> bool {
    path.file_stem()
        .is_some_and(|stem| stem.to_string_lossy().ends_with(REJECTED))
}

/// Reads a mission file of any format.
pub(super) fn read_document(path: &Path) -> Result<Document, Failure> {
    let bad = |what: String| Failure::new(Failure::INPUT, format!("{}: {what}", path.display()));
    let mut bytes = Vec::new();
    open_regular(path)
        .and_then(|file| file.take(MAX_BYTES + 1).read_to_end(&mut bytes))
        .map_err(|error| bad(format!("cannot be read: {error}")))?;
    if u64::try_from(bytes.len()).is_ok_and(|length| length > MAX_BYTES) {
        return Err(bad(format!(
            "too large for a mission (allowed: {} MiB)",
            MAX_BYTES >> 20
        )));
    }
    let (_, document) = formats::read(&bytes).map_err(|error| bad(error.to_string()))?;
    Ok(document)
}

/// The mission of one vehicle in a file of any kind, with the parameters next to it.
pub(super) fn read_mission(
    path: &Path,
    file: &SpecFile,
    vehicle: usize,
) -> Result<VehicleMission, Failure> {
    let vehicle = &file.spec.vehicles[vehicle];
    let mut mission = read_document(path)?
        .into_mission(vehicle.autopilot, vehicle.airframe)
        .map(|mission| mission.for_version(vehicle.autopilot_version))
        .map_err(|error| Failure::new(Failure::INPUT, format!("{}: {error}", path.display())))?;
    mission.params = read_params(path, &vehicle.id)?;
    Ok(mission)
}

/// Refuses a folder in which something was edited since `plan` wrote it: the spec,
/// or one of the two files of a mission, so that they disagree.
pub(super) fn refuse_edited(
    folder: &Path,
    file: &SpecFile,
    files: &BTreeMap<usize, PathBuf>,
) -> Result<(), Failure> {
    let edited = |what: String| {
        let message = format!("{what}; nothing was sent");
        Err(Failure::new(Failure::VERDICT, message))
    };
    let planned = planned_from(folder);
    if planned.is_none() {
        let plan = folder.join("plan.json");
        return edited(format!("{} is not there, or not a plan", plan.display()));
    }
    if planned.as_ref().map(|(spec, _)| spec) != Some(&sha256(&file.text)) {
        return edited(format!(
            "{} is not the spec that plan.json was made from",
            folder.join("spec.yaml").display()
        ));
    }
    if let Some(table) = &file.table
        && planned.and_then(|(_, table)| table) != table_sha256(file)
    {
        return edited(format!(
            "{} is not the table that plan.json was made from",
            folder.join(&table.name).display()
        ));
    }
    for (vehicle, path) in files {
        let mission = read_mission(path, file, *vehicle)?;
        if let Some(counterpart) = disagreeing_counterpart(path, &mission)? {
            return edited(format!(
                "{} and {} disagree",
                path.display(),
                counterpart.display()
            ));
        }
    }
    Ok(())
}

/// The other of the two files of a mission, if it holds another one.
pub(super) fn disagreeing_counterpart(
    path: &Path,
    mission: &VehicleMission,
) -> Result<Option<PathBuf>, Failure> {
    let counterpart = path.with_extension("waypoints");
    if counterpart == path || !counterpart.exists() {
        return Ok(None);
    }
    let mut document = read_document(&counterpart)?;
    document.home = document.home.or(Some(mission.home));
    let other = document
        .into_mission(mission.autopilot, mission.airframe)
        .map(|other| other.for_version(mission.autopilot_version))
        .map_err(|error| {
            Failure::new(
                Failure::INPUT,
                format!("{}: {error}", counterpart.display()),
            )
        })?;
    // The `.waypoints` format loses some fields, so both are compared as written in it.
    let is_same = formats::waypoints::write(mission) == formats::waypoints::write(&other);
    Ok((!is_same).then_some(counterpart))
}

/// The hashes of the spec and its table from which an output folder was made; none if the
/// folder is no output folder.
fn planned_from(folder: &Path) -> Option<(String, Option<String>)> {
    /// Other keys are skipped: for a large fleet they hold a hundred megabytes.
    #[derive(serde::Deserialize)]
    struct Plan {
        #[serde(rename = "sortie")]
        _version: serde::de::IgnoredAny,
        spec_sha256: String,
        table_sha256: Option<String>,
    }
    let plan: Plan = serde_json::from_slice(&fs::read(folder.join("plan.json")).ok()?).ok()?;
    Some((plan.spec_sha256, plan.table_sha256))
}

/// Why a folder cannot be replaced; none if it holds only the files that `plan` wrote.
pub(super) fn reason_not_to_replace(target: &Path) -> Option<String> {
    let Ok(entries) = fs::read_dir(target) else {
        return target
            .exists()
            .then(|| "a file of this name is in the way".to_owned());
    };
    let mut names: Vec<String> = entries
        .flatten()
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    if names.is_empty() {
        return None;
    }
    let spec = target.join("spec.yaml");
    let (text, planned) = (fs::read_to_string(&spec).ok(), planned_from(target));
    let is_ours = match (&text, &planned) {
        (Some(text), Some((hash, _))) => *hash == sha256(text),
        _ => false,
    };
    if !is_ours {
        return Some(
            "this folder holds something else than an earlier plan and is not replaced".to_owned(),
        );
    }
    // A table that was edited here is no copy any more, and is kept.
    let file = SpecFile::read(&spec)
        .ok()
        .filter(|file| planned.and_then(|(_, table)| table) == table_sha256(file));
    let copies = file.as_ref().map_or_else(Vec::new, copied_names);
    let foreign = names
        .iter()
        .find(|name| !is_plan_output(name) && !copies.contains(name))?;
    Some(format!(
        "it holds {foreign}, which no plan wrote, and is not replaced"
    ))
}

/// Whether `plan` writes a file of this name, or `certify` does for that plan.
fn is_plan_output(name: &str) -> bool {
    let fixed = [
        "spec.yaml",
        "plan.json",
        "review.json",
        "review.html",
        "fleet.kml",
        "fleet.geojson",
        "timing.json",
        "certificate.json",
    ];
    let endings = [".waypoints", ".plan", ".params"];
    fixed.contains(&name) || endings.iter().any(|ending| name.ends_with(ending))
}

/// The files and folders that were copied with a spec: the first parts of their paths.
fn copied_names(file: &SpecFile) -> Vec<String> {
    let terrain = match &file.spec.terrain {
        TerrainSource::File(path) | TerrainSource::Folder(path) => Some(path),
        TerrainSource::Flat(_) | TerrainSource::Analytic { .. } => None,
    };
    let table = file.table.as_ref().map(|table| &table.name);
    let first = |path: &PathBuf| {
        let mut parts = path.components();
        let part = parts.find(|part| matches!(part, Component::Normal(_)))?;
        Some(part.as_os_str().to_string_lossy().into_owned())
    };
    let attached = file.attached.iter().map(|attached| &attached.name);
    let system = terrain.and_then(|path| world::prj_path(path));
    let named = terrain.into_iter().chain(&system);
    let named = named.chain(table).chain(attached);
    named.filter_map(first).collect()
}

/// The name of a mission file without its ending, and without the mark of a rejected one.
pub(super) fn stem(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    stem.strip_suffix(REJECTED).unwrap_or(&stem).to_owned()
}

/// The vehicle whose name a mission file has, such as `alpha.waypoints` or `alpha.REJECTED.plan`.
pub(super) fn vehicle_of(path: &Path, file: &SpecFile) -> Option<usize> {
    let stem = stem(path);
    file.spec
        .vehicles
        .iter()
        .position(|vehicle| vehicle.id == stem)
}

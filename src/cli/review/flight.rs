//! `sortie review` of a flight: a record (`flight.jsonl`) or a capture of its links (`.tlog`).

use std::io::Read;
use std::path::{Path, PathBuf};

use crate::cli::args;
use crate::cli::folder::{self, missions, replace};
use crate::cli::print::console::{note, out_json};
use crate::cli::print::failure::Failure;
use crate::cli::print::flight::report;
use crate::flight::{self, Capture, Fix, Plan, Record, ReferenceTrajectory, Waypoint};
use crate::mission::VehicleMission;
use crate::numeric::text::{open_regular, read_regular};
use crate::spec::SpecFile;
use crate::verify::{self, Track};
use crate::world::{self, World};

/// Two waypoints nearer than this are one, metres.
const ALIKE_M: f64 = 0.1;

/// Whether a file holds a flight.
pub(crate) fn is_flight(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str());
    matches!(ending, Some("jsonl" | "tlog"))
}

/// The verdict on one flight. `spec` may be left out for one that lies in `DIR.runs/`, where
/// `fly` puts it; `files` are the missions that were flown, for a capture.
pub(crate) fn run(
    spec: Option<&Path>,
    files: &[&PathBuf],
    arguments: &args::Review,
) -> Result<(), Failure> {
    let (flights, missions): (Vec<&PathBuf>, Vec<&PathBuf>) =
        files.iter().copied().partition(|path| is_flight(path));
    let [path] = flights[..] else {
        let message = format!("review judges one flight at a time, got {}", flights.len());
        return Err(Failure::new(Failure::USAGE, message));
    };
    let has_mission_outputs = arguments.svg.is_some() || arguments.trajectories.is_some();
    if arguments.limits != args::Limits::default() || has_mission_outputs {
        let message = "a flight is judged by the limits of its spec, and has a page (--html)";
        return Err(Failure::new(Failure::USAGE, message));
    }
    let folder = plan_folder(path);
    let near_record = folder.as_ref().map(|folder| folder.join("spec.yaml"));
    let spec = spec.map(Path::to_owned).or(near_record).ok_or_else(|| {
        let message = format!("{}: flown by which spec? Name it (*.yaml)", path.display());
        Failure::new(Failure::USAGE, message)
    })?;
    let file = SpecFile::read_known(&spec).map_err(world::with_ground)?;
    let world = world::load(&file)?;
    let missions: Vec<PathBuf> = if missions.is_empty() {
        folder.map_or_else(Vec::new, |folder| planned(&folder, &file))
    } else {
        missions.into_iter().cloned().collect()
    };
    let missions = if missions.is_empty() {
        Vec::new()
    } else {
        missions::read(&file, &missions::assign(&file, missions.iter(), &[])?)?
    };
    let record = if path.extension().is_some_and(|ending| ending == "tlog") {
        capture(path, &file, &world, &missions)?
    } else {
        let record = read_record(path, &file, &world)?;
        compare(path, &record, &world, (&file, &missions));
        record
    };
    let record = with_unflown_vehicles(record, path, &file)?;
    write_result(&file, &world, &record, &missions, arguments)
}

/// The folder of the plan that a record in `DIR.runs/` belongs to.
fn plan_folder(path: &Path) -> Option<PathBuf> {
    let path = std::path::absolute(path).ok()?;
    let runs = path.parent()?;
    let name = runs.file_name()?.to_str()?.strip_suffix(".runs")?;
    let folder = runs.with_file_name(name);
    folder.join("spec.yaml").is_file().then_some(folder)
}

/// The mission files of a plan.
fn planned(folder: &Path, file: &SpecFile) -> Vec<PathBuf> {
    let fleet = file.spec.vehicles.iter();
    let paths = fleet.map(|vehicle| folder.join(format!("{}.waypoints", vehicle.id)));
    paths.filter(|path| path.is_file()).collect()
}

fn read_record(path: &Path, file: &SpecFile, world: &World) -> Result<Record, Failure> {
    let bad = |why: String| Failure::new(Failure::INPUT, format!("{}: {why}", path.display()));
    let text = read_regular(path).map_err(|error| bad(error.to_string()))?;
    let record = flight::read_record(&text, world.frame).map_err(|error| bad(error.to_string()))?;
    if record.spec_sha256.is_empty() {
        return Err(bad("has no header: by which spec was it flown?".to_owned()));
    }
    let hash = folder::sha256(&file.text);
    if record.spec_sha256 != hash {
        check_in_area(path, &record, file, world)?;
        note(&format!(
            "note: {} was flown by another spec than {}; the limits are those of the latter",
            path.display(),
            file.path.display()
        ));
    }
    Ok(record)
}

/// A record of another spec is accepted only if each vehicle was at some time in the area of this one.
fn check_in_area(
    path: &Path,
    record: &Record,
    file: &SpecFile,
    world: &World,
) -> Result<(), Failure> {
    for flight in &record.flights {
        let mut fixes = flight.flown.fixes.iter();
        let is_in = |fix: &Fix| world.in_area(world.frame.to_plan(fix.place));
        if fixes.len() > 0 && !fixes.any(is_in) {
            let message = format!(
                "{}: was flown by another spec than {}: {} was never in the area of the latter",
                path.display(),
                file.path.display(),
                flight.vehicle
            );
            return Err(Failure::new(Failure::INPUT, message));
        }
    }
    Ok(())
}

/// Says whose plan in the record is not that of the missions at hand.
fn compare(
    path: &Path,
    record: &Record,
    world: &World,
    (file, missions): (&SpecFile, &[(usize, VehicleMission)]),
) {
    let untimed = |vehicle: &str| Track {
        vehicle: vehicle.to_owned(),
        moments: Vec::new(),
        late_s: Vec::new(),
    };
    for (index, mission) in missions {
        let id = &file.spec.vehicles[*index].id;
        let mut flights = record.flights.iter();
        let flight = flights.find(|flight| flight.vehicle == *id);
        let Some(plan) = flight.and_then(|flight| flight.plans.first()) else {
            continue;
        };
        let held = ReferenceTrajectory::new(mission, &untimed(id), world);
        let is_alike = plan.items == mission.items.len()
            && plan.reference.lands == held.lands
            && plan.reference.waypoints.len() == held.waypoints.len()
            && plan
                .reference
                .waypoints
                .iter()
                .zip(&held.waypoints)
                .all(alike);
        if !is_alike {
            note(&format!(
                "note: the plan of {id} in {} is not its mission; the flight is judged by the plan in the record",
                path.display()
            ));
        }
    }
}

/// Whether two waypoints are one, as encoded.
fn alike((a, b): (&Waypoint, &Waypoint)) -> bool {
    a.item == b.item
        && a.point.distance_m(b.point) < ALIKE_M
        && (a.radius_m - b.radius_m).abs() < ALIKE_M
}

fn capture(
    path: &Path,
    file: &SpecFile,
    world: &World,
    missions: &[(usize, VehicleMission)],
) -> Result<Record, Failure> {
    let bad = |why: String| Failure::new(Failure::INPUT, format!("{}: {why}", path.display()));
    if missions.is_empty() {
        let message = format!(
            "{}: a capture does not say what was planned; name the missions too",
            path.display()
        );
        return Err(Failure::new(Failure::USAGE, message));
    }
    let judged: Vec<(usize, &VehicleMission)> = missions.iter().map(|(v, m)| (*v, m)).collect();
    let review = verify::review(&file.spec, world, &judged);
    let captures: Vec<Capture> = missions
        .iter()
        .zip(&review.tracks)
        .map(|((index, mission), track)| {
            let vehicle = &file.spec.vehicles[*index];
            Capture {
                vehicle: vehicle.id.clone(),
                sysid: vehicle.sysid,
                autopilot: vehicle.autopilot,
                airframe: vehicle.airframe,
                plan: Plan {
                    items: mission.items.len(),
                    reference: ReferenceTrajectory::new(mission, track, world),
                    from_s: 0.0,
                },
            }
        })
        .collect();
    let mut bytes = Vec::new();
    open_regular(path)
        .and_then(|mut file| file.read_to_end(&mut bytes))
        .map_err(|error| bad(error.to_string()))?;
    let record = flight::read_tlog(&bytes, &captures).map_err(bad)?;
    Ok(Record {
        spec_sha256: folder::sha256(&file.text),
        ..record
    })
}

/// The record with one flight for each vehicle of the spec, in its order; a vehicle without one fails.
fn with_unflown_vehicles(record: Record, path: &Path, file: &SpecFile) -> Result<Record, Failure> {
    let fleet = &file.spec.vehicles;
    let unknown = record
        .flights
        .iter()
        .find(|flight| fleet.iter().all(|vehicle| vehicle.id != flight.vehicle));
    if let Some(unknown) = unknown {
        let message = format!(
            "{}: no vehicle {} in the spec {}",
            path.display(),
            unknown.vehicle,
            file.path.display()
        );
        return Err(Failure::new(Failure::INPUT, message));
    }
    let of = |id: &str| {
        let found = record.flights.iter().find(|flight| flight.vehicle == id);
        found.cloned().unwrap_or_else(|| flight::Flight {
            vehicle: id.to_owned(),
            plans: Vec::new(),
            flown: flight::Flown::default(),
            itinerary: flight::Itinerary::default(),
        })
    };
    Ok(Record {
        flights: fleet.iter().map(|vehicle| of(&vehicle.id)).collect(),
        ..record
    })
}

fn write_result(
    file: &SpecFile,
    world: &World,
    record: &Record,
    missions: &[(usize, VehicleMission)],
    arguments: &args::Review,
) -> Result<(), Failure> {
    let judged = flight::judge(&file.spec, world, record);
    if let Some(target) = &arguments.html {
        let missions: Vec<(usize, &VehicleMission)> =
            missions.iter().map(|(v, m)| (*v, m)).collect();
        let page = flight::flight_page(&file.spec, world, record, &judged, &missions);
        replace::write_file(target, page.as_bytes())?;
    }
    if arguments.json {
        let document = flight::flight_json(record, &judged);
        out_json(&document)?;
    } else {
        report(&judged)?;
    }
    if judged.passes() {
        return Ok(());
    }
    let message = "the flight did not keep its limits, or did not end as planned";
    Err(Failure::new(Failure::VERDICT, message))
}

//! `sortie upload`: verify again, transfer, read back, compare, one table.

use std::path::{Path, PathBuf};
use std::sync::Mutex;

use super::fleet_transfer::FleetTransfer;
use crate::cli::args;
use crate::cli::folder::{self, missions, runs};
use crate::cli::links::{self, link_of};
use crate::cli::print::console::{
    Paint, note, note_lines, out, out_json, out_lines, warn_of_parked,
};
use crate::cli::print::failure::Failure;
use crate::cli::print::overview::Overview;
use crate::cli::print::progress::Progress;
use crate::cli::print::table;
use crate::cli::print::table::Rows;
use crate::link::{self, Job, Tlog};
use crate::mission::VehicleMission;
use crate::report::{UploadDocument, UploadedVehicle};
use crate::simulator;
use crate::simulator::{Running, Simulated};
use crate::spec::{Link, SpecFile};
use crate::verify::{self, Review};
use crate::world;

/// Why a dry run sends nothing.
const DRY_RUN: &str = "nothing was sent (--dry-run)";

pub(crate) fn run(arguments: &args::Upload) -> Result<(), Failure> {
    let (file, files, target) = match &arguments.spec {
        Some(spec) => from_files(spec, arguments)?,
        None => missions::from_folder(&arguments.paths, arguments.force).map_err(|refusal| {
            let way_out = match refusal.code {
                Failure::VERDICT => " (--force overrides)",
                _ => "",
            };
            Failure::new(refusal.code, refusal.message + way_out)
        })?,
    };
    let links = links::given(&file, &arguments.link)?;
    let world = world::load(&file)?;
    let missions = missions::read(&file, &files)?;
    let judged: Vec<(usize, &VehicleMission)> = missions.iter().map(|(v, m)| (*v, m)).collect();
    let review = verify::review(&file.spec, &world, &judged);
    for text in verify::distant_from_area(&file.spec, &judged) {
        note(&format!("warning: {text}"));
    }
    warn_of_parked(&review);
    warn_of_versions(&file, &judged);
    if !review.passes() {
        refuse_failing(&review, arguments)?;
    }
    if arguments.dry_run {
        if arguments.json {
            return out_json(&dry_run_document(&file, &missions));
        }
        return print_dry_run(&file, &missions, &links);
    }
    refuse_flown(&file, &missions, &links, &target)?;
    runs::make(&runs::folder(&target))?;
    let tlog = arguments.tlog.as_deref();
    let transfer = upload_fleet(&file, judged, &links, arguments.force, tlog)?;
    transfer.record(&target)?;
    transfer.warn();
    if arguments.json {
        out_json(&transfer.document())?;
    } else {
        transfer.print()?;
        table::print_no_buffers(&file.spec)?;
    }
    transfer.verdict()
}

/// Names what fails of missions that do not pass.
///
/// # Errors
/// Nothing is sent, unless by force.
fn refuse_failing(review: &Review, arguments: &args::Upload) -> Result<(), Failure> {
    let failures = table::failures(review, Paint::for_stdout());
    if arguments.json {
        note_lines(&failures);
    } else {
        out_lines(&failures)?;
    }
    if !arguments.force {
        let reason = "the missions do not pass verification; nothing was sent";
        if arguments.json {
            out_json(&UploadDocument::not_begun("refused", reason, Vec::new()))?;
        }
        return Err(Failure::new(Failure::VERDICT, reason));
    }
    let what = match arguments.dry_run {
        true => "they would be sent nevertheless",
        false => "sent nevertheless",
    };
    note(&format!(
        "the missions do not pass verification; {what} (--force)"
    ));
    Ok(())
}

/// Warns of copters that a later version of their autopilot flies at other altitudes than judged.
pub(crate) fn warn_of_versions(file: &SpecFile, missions: &[(usize, &VehicleMission)]) {
    let mut ids = Vec::new();
    let mut later = None;
    for (vehicle, mission) in missions {
        let range = mission.facts().heights_at_once;
        if let Some(range) = range.filter(|_| mission.autopilot_version.is_none()) {
            ids.push(file.spec.vehicles[*vehicle].id.as_str());
            later = Some((mission.autopilot.name(), range));
        }
    }
    if let Some((name, range)) = later {
        note(&format!(
            "warning: {}: {name} {range} climbs and descends at the start of each leg, which was not judged: \
             for such a version set autopilot_version and plan again",
            ids.join(", ")
        ));
    }
}

/// A spec and the mission files of the command line, and the folder of their records.
fn from_files(
    spec: &Path,
    arguments: &args::Upload,
) -> Result<(SpecFile, missions::Files, PathBuf), Failure> {
    let file = SpecFile::read_known(spec).map_err(world::with_ground)?;
    let files = missions::assign(&file, arguments.paths.iter(), &[])?;
    if !arguments.force {
        refuse_rejected(files.values())?;
    }
    for path in files.values().filter(|path| folder::is_waypoints(path)) {
        note(&format!(
            "{}: a .waypoints file holds no fence and no rally points: those on board are cleared",
            path.display()
        ));
    }
    let target = PathBuf::from("out").join(&file.spec.name);
    Ok((file, files, target))
}

/// A mission that was rejected is not taken under another command either.
fn refuse_rejected<'a>(mut files: impl Iterator<Item = &'a PathBuf>) -> Result<(), Failure> {
    match files.find(|path| folder::is_rejected(path)) {
        None => Ok(()),
        Some(path) => {
            let path = path.display();
            let message = format!("{path} was rejected by verification; nothing was sent");
            Err(Failure::new(Failure::VERDICT, message))
        }
    }
}

/// A simulated vehicle of a flight has no address in the spec: another one would be started in its place, and nothing be
/// on board of the one that flies.
fn refuse_flown(
    file: &SpecFile,
    missions: &[(usize, VehicleMission)],
    links: &[(usize, Link)],
    target: &Path,
) -> Result<(), Failure> {
    let mut all = missions.iter().map(|(vehicle, _)| *vehicle);
    let simulated = all.find(|vehicle| *link_of(file, *vehicle, links) == Link::Sim);
    let Some(vehicle) = simulated.filter(|_| runs::is_in_flight(target)) else {
        return Ok(());
    };
    let (id, out) = (&file.spec.vehicles[vehicle].id, target.display());
    let message = format!(
        "{id}: its simulated vehicle belongs to the flight of {out}, which goes on: `sortie replan` changes its mission, or --link {id}=ADDR names another vehicle; nothing was sent"
    );
    Err(Failure::new(Failure::TRANSFER, message))
}

fn print_dry_run(
    file: &SpecFile,
    missions: &[(usize, VehicleMission)],
    links: &[(usize, Link)],
) -> Result<(), Failure> {
    let mut rows = Rows::new(&["vehicle", "system", "link", "items", "fence", "rally"]);
    for (vehicle, mission) in missions {
        let this = &file.spec.vehicles[*vehicle];
        rows.add([
            this.id.clone(),
            this.sysid.to_string(),
            link_of(file, *vehicle, links).to_string(),
            mission.items.len().to_string(),
            mission.fence.len().to_string(),
            mission.rally.len().to_string(),
        ]);
    }
    rows.print()?;
    table::print_no_buffers(&file.spec)?;
    out(DRY_RUN)
}

/// What would be sent.
fn dry_run_document(file: &SpecFile, missions: &[(usize, VehicleMission)]) -> UploadDocument {
    const NOT_SENT: &str = "not sent";
    let vehicles = missions.iter().map(|(vehicle, mission)| UploadedVehicle {
        vehicle: file.spec.vehicles[*vehicle].id.clone(),
        sysid: file.spec.vehicles[*vehicle].sysid,
        items: mission.items.len(),
        fence: mission.fence.len(),
        rally: mission.rally.len(),
        verdict: NOT_SENT,
        ..UploadedVehicle::default()
    });
    UploadDocument::not_begun(NOT_SENT, DRY_RUN, vehicles.collect())
}

/// Transfers to every vehicle at once. Simulated vehicles are started inside
/// this process and reached over UDP on loopback like any other.
pub(crate) fn upload_fleet(
    file: &SpecFile,
    missions: Vec<(usize, &VehicleMission)>,
    links: &[(usize, Link)],
    force: bool,
    tlog: Option<&Path>,
) -> Result<FleetTransfer, Failure> {
    links::refuse_shared(file, missions.iter().map(|(vehicle, _)| *vehicle), links)?;
    let capture = tlog.map(begin_capture).transpose()?;
    let mut simulated: Vec<Running> = Vec::new();
    let mut resolved: Vec<Link> = Vec::new();
    for (vehicle, mission) in &missions {
        let link = link_of(file, *vehicle, links).clone();
        resolved.push(if link == Link::Sim {
            let running = simulate(file, *vehicle, mission)?;
            let address = running.address().to_string();
            simulated.push(running);
            Link::UdpOut(address)
        } else {
            link
        });
    }
    let jobs: Vec<Job<'_>> = missions
        .iter()
        .zip(&resolved)
        .map(|((vehicle, mission), link)| {
            let this = &file.spec.vehicles[*vehicle];
            Job {
                vehicle: &this.id,
                sysid: this.sysid,
                link,
                mission,
                force,
            }
        })
        .collect();
    let (progress, overview) = (Progress::start(), Overview::of(jobs.len()));
    progress.say(&overview.to_string());
    let shown = Mutex::new((progress, overview));
    let reports = link::upload_fleet_captured(&jobs, capture.as_ref(), &|id, at| {
        if let Ok(mut shown) = shown.lock() {
            let (progress, overview) = &mut *shown;
            overview.note(id, at);
            progress.say(&overview.to_string());
        }
    });
    drop(shown);
    if let Some(Err(error)) = capture.map(Tlog::finish) {
        note(&format!("the capture is not complete: {error}"));
    }
    Ok(FleetTransfer { reports })
}

/// A capture in a file, or in a folder under the time of its beginning.
fn begin_capture(path: &Path) -> Result<Tlog, Failure> {
    let path = if path.is_dir() {
        path.join(format!("upload-{}.tlog", runs::seconds_since_1970()))
    } else {
        path.to_owned()
    };
    Tlog::create(&path).map_err(|error| {
        let message = format!("cannot write {}: {error}", path.display());
        Failure::new(Failure::OUTPUT, message)
    })
}

fn simulate(file: &SpecFile, vehicle: usize, mission: &VehicleMission) -> Result<Running, Failure> {
    let this = &file.spec.vehicles[vehicle];
    simulator::spawn(&Simulated {
        airframe: this.airframe,
        fence_points: this.fence_points,
        ..Simulated::on_loopback(this.autopilot.into(), this.sysid, Some(mission.home))
    })
    .map_err(|error| {
        Failure::new(
            Failure::TRANSFER,
            format!("{}: the simulated vehicle does not start: {error}", this.id),
        )
    })
}

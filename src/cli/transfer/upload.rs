//! `sortie upload`: verify again, transfer, read back, compare, one table.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use super::delivery::Delivery;
use crate::cli::args;
use crate::cli::folder;
use crate::cli::folder::runs;
use crate::cli::print::console::{Paint, note, note_lines, out, out_json, out_lines};
use crate::cli::print::failure::Failure;
use crate::cli::print::overview::Overview;
use crate::cli::print::progress::Progress;
use crate::cli::print::table;
use crate::cli::print::table::Rows;
use crate::cli::review;
use crate::flight::{FlightPlan, Notice};
use crate::link::{self, Job, Tlog};
use crate::mission::VehicleMission;
use crate::simulator;
use crate::simulator::{Running, Simulated};
use crate::spec::{Link, SpecFile};
use crate::verify;
use crate::world;

pub(crate) fn run(arguments: &args::Upload) -> Result<(), Failure> {
    let (file, files, target) = match &arguments.spec {
        Some(spec) => from_files(spec, arguments)?,
        None => from_folder(&arguments.paths, arguments.force).map_err(|refusal| {
            let way_out = match refusal.code {
                Failure::VERDICT => " (--force overrides)",
                _ => "",
            };
            Failure::new(refusal.code, refusal.message + way_out)
        })?,
    };
    let links = links(&file, &arguments.link)?;
    let world = world::load(&file)?;
    let missions = review::read(&file, &files)?;
    let judged: Vec<(usize, &VehicleMission)> = missions.iter().map(|(v, m)| (*v, m)).collect();
    let review = verify::review(&file.spec, &world, &judged);
    for text in verify::distant_from_area(&file.spec, &judged) {
        note(&format!("warning: {text}"));
    }
    if !review.passes() {
        let failures = table::failures(&review, Paint::for_stdout());
        if arguments.json {
            note_lines(&failures);
        } else {
            out_lines(&failures)?;
        }
        if !arguments.force {
            let reason = "the missions do not pass verification; nothing was sent";
            if arguments.json {
                out_json(&Delivery::nothing(reason))?;
            }
            return Err(Failure::new(Failure::VERDICT, reason));
        }
        note("the missions do not pass verification; sent nevertheless (--force)");
    }
    if arguments.dry_run {
        if arguments.json {
            let reason = "nothing was sent (--dry-run)";
            return out_json(&Delivery::nothing(reason));
        }
        return print_dry_run(&file, &missions, &links);
    }
    runs::make(&runs::folder(&target))?;
    let tlog = arguments.tlog.as_deref();
    let delivery = deliver(&file, judged, &links, arguments.force, tlog)?;
    delivery.record(&target)?;
    if arguments.json {
        out_json(&delivery.json())?;
    } else {
        delivery.print()?;
        table::print_no_buffers(&file.spec)?;
    }
    delivery.verdict()
}

/// A spec and the mission files of the command line, and the folder of their records.
fn from_files(
    spec: &Path,
    arguments: &args::Upload,
) -> Result<(SpecFile, review::Files, PathBuf), Failure> {
    let file = SpecFile::read(spec)?;
    let files = review::assign(&file, arguments.paths.iter(), &[])?;
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

/// The spec and the missions of a folder that `plan` wrote.
pub(crate) fn from_folder(
    paths: &[PathBuf],
    force: bool,
) -> Result<(SpecFile, review::Files, PathBuf), Failure> {
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
    let file = SpecFile::read(&folder.join("spec.yaml"))?;
    let mut files = review::Files::new();
    for (index, vehicle) in file.spec.vehicles.iter().enumerate() {
        let accepted = folder.join(format!("{}.plan", vehicle.id));
        let rejected = folder.join(format!("{}{}.plan", vehicle.id, folder::REJECTED));
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
        folder::refuse_edited(folder, &file, &files)?;
    }
    Ok((file, files, folder.clone()))
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

/// Links from the command line, by the index of their vehicle.
pub(crate) fn links(file: &SpecFile, arguments: &[String]) -> Result<Vec<(usize, Link)>, Failure> {
    let usage = |message: String| Failure::new(Failure::USAGE, message);
    arguments
        .iter()
        .map(|argument| {
            let (id, address) = argument
                .split_once('=')
                .ok_or_else(|| usage(format!("--link {argument}: not of the form ID=ADDR")))?;
            let vehicle = file
                .spec
                .vehicles
                .iter()
                .position(|vehicle| vehicle.id == id);
            let vehicle = vehicle
                .ok_or_else(|| usage(format!("--link {argument}: no vehicle {id} in the spec")))?;
            let link = Link::parse(address).ok_or_else(|| {
                usage(format!(
                    "--link {argument}: no such link (allowed: {})",
                    Link::ALLOWED
                ))
            })?;
            Ok((vehicle, link))
        })
        .collect()
}

/// The addresses of vehicles in flight: from the command line, else from the running `fly`, else
/// from the spec.
pub(crate) fn links_under_way(
    plan: &FlightPlan,
    arguments: &[String],
    notice: &Notice,
) -> Result<Vec<(usize, Link)>, Failure> {
    let given = links(&plan.file, arguments)?;
    let mut found = Vec::new();
    for (index, _) in &plan.missions {
        let id = &plan.vehicle(*index).id;
        let announced = notice.links.get(id).and_then(|link| Link::parse(link));
        let is_given = given.iter().any(|(of, _)| of == index);
        let link = match announced {
            Some(link) if !is_given => link,
            _ => link_of(&plan.file, *index, &given).clone(),
        };
        if link == Link::Sim {
            let message = format!(
                "{id}: its simulated vehicle does not run (`sortie fly` starts it, or `sortie vehicles` with --link)"
            );
            return Err(Failure::new(Failure::TRANSFER, message));
        }
        found.push((*index, link));
    }
    Ok(found)
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
    out("nothing was sent (--dry-run)")
}

pub(crate) fn link_of<'a>(
    file: &'a SpecFile,
    vehicle: usize,
    links: &'a [(usize, Link)],
) -> &'a Link {
    let given = links.iter().rev().find(|(of, _)| *of == vehicle);
    given.map_or(&file.spec.vehicles[vehicle].link, |(_, link)| link)
}

/// Transfers to every vehicle at once. Simulated vehicles are started inside
/// this process and reached over UDP on loopback like any other.
pub(crate) fn deliver(
    file: &SpecFile,
    missions: Vec<(usize, &VehicleMission)>,
    links: &[(usize, Link)],
    force: bool,
    tlog: Option<&Path>,
) -> Result<Delivery, Failure> {
    distinct_on_links(file, missions.iter().map(|(vehicle, _)| *vehicle), links)?;
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
    Ok(Delivery { reports })
}

/// Vehicles on one link need different system ids.
fn distinct_on_links(
    file: &SpecFile,
    vehicles: impl Iterator<Item = usize>,
    links: &[(usize, Link)],
) -> Result<(), Failure> {
    let mut seen = BTreeMap::new();
    for vehicle in vehicles {
        let this = &file.spec.vehicles[vehicle];
        let link = link_of(file, vehicle, links);
        // Every simulated vehicle has a link of its own.
        if *link == Link::Sim {
            continue;
        }
        if let Some(other) = seen.insert((link.to_string(), this.sysid), &this.id) {
            let message = format!(
                "{other} and {} have one system id, {}, on one link, {link}; nothing was sent",
                this.id, this.sysid
            );
            return Err(Failure::new(Failure::INPUT, message));
        }
    }
    Ok(())
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
        ..Simulated::on_loopback(this.autopilot.into(), this.sysid, Some(mission.home))
    })
    .map_err(|error| {
        Failure::new(
            Failure::TRANSFER,
            format!("{}: the simulated vehicle does not start: {error}", this.id),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const LARGE: &str = "\
sortie: 1
name: large
area:
  south_west: {lat: 36.20, lon: -84.40}
  north_east: {lat: 36.40, lon: -84.10}
  min_agl_m: 60
  max_amsl_m: 1500
terrain: {flat: {amsl_m: 300}}
fleet:
  id: d{n}
  start_grid: {south_west: {lat: 36.21, lon: -84.39}, rows: 5, columns: 50, spacing_m: 150}
  goal_grid: {south_west: {lat: 36.30, lon: -84.39}, rows: 5, columns: 50, spacing_m: 150}
  defaults: {autopilot: px4, link: sim, start: {agl_m: 80}, goal: {agl_m: 80}, finish: land, speed_mps: 12}
";

    #[test]
    fn one_system_id_on_one_link_is_one_vehicle_too_many() {
        let file = SpecFile::parse(Path::new("large.yaml"), LARGE.to_owned()).unwrap();
        let sysid = |index: usize| file.spec.vehicles[index].sysid;
        assert_eq!(
            (file.spec.vehicles.len(), sysid(0), sysid(240)),
            (250, 1, 1)
        );
        let all = || 0..file.spec.vehicles.len();
        assert!(
            distinct_on_links(&file, all(), &[]).is_ok(),
            "each has its own"
        );
        let to = |index: usize, port: u16| (index, Link::UdpOut(format!("127.0.0.1:{port}")));
        assert!(distinct_on_links(&file, all(), &[to(0, 14550), to(240, 14551)]).is_ok());
        assert!(distinct_on_links(&file, all(), &[to(0, 14550), to(239, 14550)]).is_ok());
        let refused = distinct_on_links(&file, all(), &[to(0, 14550), to(240, 14550)]);
        let message = refused.unwrap_err().message;
        assert!(
            message.contains("d1 and d241 have one system id, 1"),
            "{message}"
        );
        let refused = crate::flight::refuse_shared_sysids(&file.spec);
        let message = refused.unwrap_err().to_string();
        assert!(message.contains("d1 and d241"), "{message}");
    }
}

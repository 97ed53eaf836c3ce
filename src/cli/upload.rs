//! `sortie upload`: verify again, transfer, read back, compare, one table.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{SystemTime, UNIX_EPOCH};

use serde_json::{Value, json};

use super::args;
use super::console::{Paint, note, out};
use super::failure::Failure;
use super::folder;
use super::output;
use super::progress::Progress;
use super::review;
use super::table::{self, Rows};
use crate::link::{self, Job, Tlog, TransferReport, Verdict};
use crate::mission::VehicleMission;
use crate::spec::{Autopilot, Link, SpecFile};
use crate::vehicle::{self, Profile, Running, Simulated};
use crate::verify;
use crate::world;

/// What came of a transfer to a fleet.
pub(super) struct Delivery {
    pub(super) reports: Vec<TransferReport>,
}

pub(super) fn run(arguments: &args::Upload) -> Result<(), Failure> {
    let (file, files, target) = match &arguments.spec {
        Some(spec) => {
            let file = SpecFile::read(spec)?;
            let files = review::assign(&file, arguments.paths.iter(), &[])?;
            if !arguments.force {
                refuse_rejected(files.values())?;
            }
            for path in files.values().filter(|path| folder::is_waypoints(path)) {
                note(&format!(
                    "{}: a .waypoints file holds no fence and no rally points: what is on board is cleared",
                    path.display()
                ));
            }
            let target = PathBuf::from("out").join(&file.spec.name);
            (file, files, target)
        }
        None => from_folder(&arguments.paths, arguments.force)?,
    };
    let links = links(&file, &arguments.link)?;
    let world = world::load(&file)?;
    let missions = review::read(&file, &files)?;
    let judged: Vec<(usize, &VehicleMission)> = missions.iter().map(|(v, m)| (*v, m)).collect();
    let review = verify::review(&file.spec, &world, &judged);
    if !review.passes() {
        let failures = table::failures(&review, Paint::for_stdout());
        if arguments.json {
            note(&failures);
        } else {
            out(&failures)?;
        }
        if !arguments.force {
            let reason = "the missions do not pass verification; nothing was sent";
            if arguments.json {
                out(report_text(&Delivery::nothing(reason)).trim_end())?;
            }
            return Err(Failure::new(Failure::VERDICT, reason));
        }
        note("the missions do not pass verification; sent all the same, as told by --force");
    }
    if arguments.dry_run {
        if arguments.json {
            let reason = "nothing was sent (--dry-run)";
            return out(report_text(&Delivery::nothing(reason)).trim_end());
        }
        return say_what_would_be_sent(&file, &missions, &links);
    }
    let tlog = arguments.tlog.as_deref();
    let delivery = deliver(&file, judged, &links, arguments.force, tlog)?;
    delivery.record(&target)?;
    if arguments.json {
        out(report_text(&delivery.json()).trim_end())?;
    } else {
        delivery.tell()?;
    }
    delivery.verdict()
}

/// The spec and the missions of a folder that `plan` wrote.
pub(super) fn from_folder(
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
pub(super) fn links(file: &SpecFile, arguments: &[String]) -> Result<Vec<(usize, Link)>, Failure> {
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

fn say_what_would_be_sent(
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
    out(&rows.to_string())?;
    out("nothing was sent (--dry-run)")
}

pub(super) fn link_of<'a>(
    file: &'a SpecFile,
    vehicle: usize,
    links: &'a [(usize, Link)],
) -> &'a Link {
    let told = links.iter().rev().find(|(of, _)| *of == vehicle);
    told.map_or(&file.spec.vehicles[vehicle].link, |(_, link)| link)
}

/// Transfers to every vehicle at once. Simulated vehicles are started inside
/// this process and reached over UDP on loopback like any other.
pub(super) fn deliver(
    file: &SpecFile,
    missions: Vec<(usize, &VehicleMission)>,
    links: &[(usize, Link)],
    force: bool,
    tlog: Option<&Path>,
) -> Result<Delivery, Failure> {
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
    let progress = Mutex::new(Progress::start());
    let reports = link::upload_fleet_captured(&jobs, capture.as_ref(), &|id, at| {
        if let Ok(progress) = progress.lock() {
            progress.say(format!("{id}: {} {} of {}", at.stage, at.done, at.total));
        }
    });
    if let Some(Err(error)) = capture.map(Tlog::finish) {
        note(&format!("the capture is not complete: {error}"));
    }
    Ok(Delivery { reports })
}

/// A capture in a file, or in a folder under the time of its beginning.
fn begin_capture(path: &Path) -> Result<Tlog, Failure> {
    let path = if path.is_dir() {
        path.join(format!("upload-{}.tlog", seconds_since_1970()))
    } else {
        path.to_owned()
    };
    Tlog::create(&path).map_err(|error| {
        let message = format!("cannot write {}: {error}", path.display());
        Failure::new(Failure::OUTPUT, message)
    })
}

#[expect(
    clippy::disallowed_methods,
    reason = "records carry the time they were made"
)]
pub(super) fn seconds_since_1970() -> u64 {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |since| since.as_secs())
}

fn simulate(file: &SpecFile, vehicle: usize, mission: &VehicleMission) -> Result<Running, Failure> {
    let this = &file.spec.vehicles[vehicle];
    let profile = match this.autopilot {
        Autopilot::ArduPilot => Profile::ArduPilot,
        Autopilot::Px4 => Profile::Px4,
    };
    vehicle::spawn(&Simulated::on_loopback(
        profile,
        this.sysid,
        Some(mission.home),
    ))
    .map_err(|error| {
        Failure::new(
            Failure::TRANSFER,
            format!("{}: the simulated vehicle does not start: {error}", this.id),
        )
    })
}

/// `on board` as one word and the figures behind it.
pub(super) fn state(report: &TransferReport) -> String {
    match &report.verdict {
        Verdict::Verified => format!("verified, {:.1} s", report.seconds),
        Verdict::Failed(_) => "FAILED".to_owned(),
        Verdict::Refused(_) => "refused".to_owned(),
    }
}

/// What came of one transfer, in words.
pub(super) fn sentence(report: &TransferReport) -> String {
    let why = match &report.verdict {
        Verdict::Verified => "holds exactly its mission".to_owned(),
        Verdict::Failed(failure) => failure.to_string(),
        Verdict::Refused(refusal) => format!("refused: {refusal} (--force overrides)"),
    };
    let mut text = format!("{}: {why}", report.vehicle);
    for difference in report.differences.iter().take(5) {
        text += &format!("\n  {difference}");
    }
    for said in &report.statustexts {
        text += &format!("\n  the vehicle says: {said}");
    }
    text
}

fn report_text(document: &Value) -> String {
    crate::report::json_text(document)
}

impl Delivery {
    /// The document of a transfer that never began.
    fn nothing(reason: &str) -> Value {
        json!({
            "sortie": env!("CARGO_PKG_VERSION"),
            "verdict": "refused",
            "reason": reason,
            "vehicles": [],
        })
    }

    pub(super) fn json(&self) -> Value {
        let vehicles: Vec<Value> = self
            .reports
            .iter()
            .map(|report| {
                let (verdict, reason) = match &report.verdict {
                    Verdict::Verified => ("verified", None),
                    Verdict::Failed(failure) => ("failed", Some(failure.to_string())),
                    Verdict::Refused(refusal) => ("refused", Some(refusal.to_string())),
                };
                json!({
                    "vehicle": report.vehicle,
                    "sysid": report.sysid,
                    "autopilot": report.autopilot,
                    "items": report.items,
                    "fence": report.fence,
                    "rally": report.rally,
                    "attempts": report.attempts,
                    "retries": report.retries,
                    "seconds": report.seconds,
                    "hash": report.hash,
                    "verdict": verdict,
                    "reason": reason,
                    "differences": report.differences.iter().map(ToString::to_string).collect::<Vec<_>>(),
                    "statustexts": report.statustexts,
                })
            })
            .collect();
        let verdict = if self.is_verified() {
            "verified"
        } else {
            "failed"
        };
        json!({"sortie": env!("CARGO_PKG_VERSION"), "verdict": verdict, "vehicles": vehicles})
    }

    fn is_verified(&self) -> bool {
        !self.reports.is_empty() && self.reports.iter().all(TransferReport::is_verified)
    }

    /// Writes the record to `DIR.runs/`, under its time and as the newest.
    pub(super) fn record(&self, target: &Path) -> Result<(), Failure> {
        let text = report_text(&self.json());
        let folder = folder::runs_folder(target);
        let seconds = seconds_since_1970();
        output::write_file(
            &folder.join(format!("upload-{seconds}.json")),
            text.as_bytes(),
        )?;
        output::write_file(&folder.join("upload.json"), text.as_bytes())?;
        Ok(())
    }

    fn tell(&self) -> Result<(), Failure> {
        let paint = Paint::for_stdout();
        let mut rows = Rows::new(&[
            "vehicle",
            "system",
            "says it is",
            "items",
            "fence",
            "rally",
            "on board",
            "hash",
        ]);
        for report in &self.reports {
            rows.add([
                report.vehicle.clone(),
                report.sysid.to_string(),
                report.autopilot.clone(),
                report.items.to_string(),
                report.fence.to_string(),
                report.rally.to_string(),
                state(report),
                report.hash.chars().take(12).collect(),
            ]);
        }
        out(&rows.to_string())?;
        for report in self.reports.iter().filter(|report| !report.is_verified()) {
            out(&format!("{} {}", paint.bad("FAIL"), sentence(report)))?;
        }
        Ok(())
    }

    pub(super) fn verdict(&self) -> Result<(), Failure> {
        if self.is_verified() {
            return Ok(());
        }
        let failed = self
            .reports
            .iter()
            .filter(|report| !report.is_verified())
            .count();
        let message = format!(
            "{failed} of {} vehicles do not hold their mission for certain",
            self.reports.len()
        );
        Err(Failure::new(Failure::TRANSFER, message))
    }
}

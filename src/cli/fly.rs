//! `sortie fly`: launch the fleet, watch it, judge what it flew.

mod show;

use std::collections::BTreeMap;
use std::io::{BufRead, BufWriter, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use serde_json::json;

use super::args;
use super::console::{Paint, note, out};
use super::failure::Failure;
use super::folder;
use super::output;
use super::review;
use super::table;
use super::upload;
use crate::flight::{
    self, Assignment, Event, Fleet, FlightReport, Flown, Intervention, Options, Outcome, Reference,
};
use crate::formats;
use crate::link::{Arrival, Links, Time};
use crate::mission::{VehicleMission, command};
use crate::report;
use crate::spec::{Link, MissionSpec, SpecFile, Vehicle};
use crate::vehicle::{self, Running, Simulated, Surroundings};
use crate::verify::{self, Review};
use crate::world::{self, World};

use show::Show;

/// Between two positions of a vehicle, seconds of its own time.
const POSITION_S: f64 = 0.2;
/// How long disarming commands have to go out when nothing was started, milliseconds.
const PARTING_MS: u64 = 1500;

/// A plan that was read back from its folder and verified again.
pub(super) struct Sorties {
    pub(super) file: SpecFile,
    pub(super) folder: PathBuf,
    pub(super) world: World,
    pub(super) missions: Vec<(usize, VehicleMission)>,
    review: Review,
}

pub(super) fn run(arguments: &args::Fly) -> Result<(), Failure> {
    let sorties = read(&arguments.spec, arguments.dir.as_deref())?;
    let told = upload::links(&sorties.file, &arguments.link)?;
    let (simulated, links) = reach(arguments, &sorties, &told)?;
    let references = references(&sorties);
    let fleet = |us, now| {
        let assignments = assignments(arguments, &sorties, &references, &simulated);
        let options = Options {
            speedup: arguments.speedup,
            set_params: arguments.set_params,
            force: arguments.force,
            on_link_loss: sorties.file.spec.on_link_loss,
            position_s: POSITION_S,
        };
        Fleet::new(assignments, options, us, now)
    };
    let systems: Vec<(u8, &Link)> = sorties
        .missions
        .iter()
        .zip(&links)
        .map(|((vehicle, _), link)| (sorties.file.spec.vehicles[*vehicle].sysid, link))
        .collect();
    let open = Links::open(&systems)
        .map_err(|(link, error)| Failure::new(Failure::TRANSFER, format!("{link}: {error}")))?;
    let runs = folder::runs_folder(&sorties.folder);
    announce(&runs, &sorties, &links, arguments.speedup)?;
    let mut flying = Flying::begin(&runs, &open, arguments, !simulated.is_empty())?;
    let mut fleet = fleet(open.us(), flying.now());
    let flown = flying.fly(&mut fleet);
    // Nobody can be reached there any more.
    let _ = std::fs::remove_file(runs.join("links.json"));
    flown?;
    flying.end(&fleet, &sorties, &references, arguments)
}

/// The plan in its folder, of the spec that was named, verified again.
pub(super) fn read(spec: &Path, dir: Option<&Path>) -> Result<Sorties, Failure> {
    let asked = SpecFile::read(spec)?;
    copters_alone(&asked.spec)?;
    let folder = match dir {
        Some(dir) => dir.to_owned(),
        None => Path::new("out").join(&asked.spec.name),
    };
    if !folder.is_dir() {
        let message = format!(
            "{}: no plan there; make it first: sortie plan {}",
            folder.display(),
            spec.display()
        );
        return Err(Failure::new(Failure::INPUT, message));
    }
    let (file, files, folder) = upload::from_folder(&[folder], false)?;
    told_apart(&file.spec)?;
    if file.text != asked.text || file.table != asked.table {
        let message = format!(
            "{} was planned from another spec than {}; nothing was started",
            folder.display(),
            spec.display()
        );
        return Err(Failure::new(Failure::VERDICT, message));
    }
    let world = world::load(&file)?;
    let mut missions = review::read(&file, &files)?;
    for (vehicle, mission) in &mut missions {
        let path = folder.join(format!("{}.params", file.spec.vehicles[*vehicle].id));
        let text = std::fs::read_to_string(&path).map_err(|error| {
            Failure::new(Failure::INPUT, format!("{}: {error}", path.display()))
        })?;
        mission.params = formats::params::read(&text).map_err(|error| {
            Failure::new(Failure::INPUT, format!("{}: {error}", path.display()))
        })?;
    }
    let judged: Vec<(usize, &VehicleMission)> = missions.iter().map(|(v, m)| (*v, m)).collect();
    let review = verify::review(&file.spec, &world, &judged);
    if !review.passes() {
        note(&table::failures(&review, Paint::for_stdout()));
        let message = "the missions do not pass verification; nothing was started";
        return Err(Failure::new(Failure::VERDICT, message));
    }
    Ok(Sorties {
        file,
        folder,
        world,
        missions,
        review,
    })
}

/// Planes and VTOL have other modes in flight, and our simulated vehicles move like copters:
/// what a flight of theirs would show is not what was planned.
fn copters_alone(spec: &MissionSpec) -> Result<(), Failure> {
    let winged = |vehicle: &&Vehicle| vehicle.airframe.has_wing();
    spec.vehicles.iter().find(winged).map_or(Ok(()), |vehicle| {
        let message = format!(
            "{} has a wing: only copters are flown and led onto new paths; upload its mission, and start it from a ground station",
            vehicle.id
        );
        Err(Failure::new(Failure::VERDICT, message))
    })
}

/// In the air vehicles are told apart by system id alone, whatever their link.
fn told_apart(spec: &MissionSpec) -> Result<(), Failure> {
    for (index, vehicle) in spec.vehicles.iter().enumerate() {
        let mut earlier = spec.vehicles[..index].iter();
        if let Some(other) = earlier.find(|other| other.sysid == vehicle.sysid) {
            let message = format!(
                "{} and {} have one system id, {}: such a fleet is uploaded, and started from ground stations",
                other.id, vehicle.id, vehicle.sysid
            );
            return Err(Failure::new(Failure::VERDICT, message));
        }
    }
    Ok(())
}

/// Starts the simulated vehicles, and says where each vehicle is reached.
fn reach(
    arguments: &args::Fly,
    sorties: &Sorties,
    told: &[(usize, Link)],
) -> Result<(BTreeMap<usize, Running>, Vec<Link>), Failure> {
    let mut simulated = BTreeMap::new();
    let mut links = Vec::new();
    let spec = &sorties.file.spec;
    let terrain = Arc::new(sorties.world.terrain.clone());
    for (index, mission) in &sorties.missions {
        let link = upload::link_of(&sorties.file, *index, told).clone();
        if link != Link::Sim {
            links.push(link);
            continue;
        }
        let this = &spec.vehicles[*index];
        let params = mission.params.iter();
        let surroundings = Surroundings {
            terrain: Some(Arc::clone(&terrain)),
            wind: spec.wind,
            noise_m: arguments.noise,
            seed: spec.planner.seed,
            params: params.map(|p| (p.name.clone(), p.value)).collect(),
        };
        let home = Some(mission.home);
        let vehicle = Simulated::on_loopback(this.autopilot.into(), this.sysid, home);
        let running =
            vehicle::spawn_in(&vehicle, surroundings, arguments.speedup).map_err(|error| {
                let message = format!("{}: the simulated vehicle does not start: {error}", this.id);
                Failure::new(Failure::TRANSFER, message)
            })?;
        links.push(Link::UdpOut(running.address().to_string()));
        simulated.insert(*index, running);
    }
    Ok((simulated, links))
}

/// The planned flights, in the order of the missions.
fn references(sorties: &Sorties) -> Vec<Reference> {
    sorties
        .missions
        .iter()
        .zip(&sorties.review.tracks)
        .map(|((_, mission), track)| Reference::new(mission, track, &sorties.world))
        .collect()
}

fn assignments<'a>(
    arguments: &args::Fly,
    sorties: &'a Sorties,
    references: &[Reference],
    simulated: &BTreeMap<usize, Running>,
) -> Vec<Assignment<'a>> {
    let fleet = &sorties.file.spec.vehicles;
    sorties
        .missions
        .iter()
        .zip(references)
        .map(|((index, mission), reference)| Assignment {
            vehicle: &fleet[*index].id,
            sysid: fleet[*index].sysid,
            mission,
            reference: reference.clone(),
            start_s: if waits_itself(mission) {
                0.0
            } else {
                fleet[*index].depart_s
            },
            upload: arguments.upload || simulated.contains_key(index),
        })
        .collect()
}

/// Whether the delay before the takeoff is in the mission: then it is not waited for here too.
fn waits_itself(mission: &VehicleMission) -> bool {
    let before = mission
        .items
        .iter()
        .take_while(|item| item.command != command::NAV_TAKEOFF);
    before
        .into_iter()
        .any(|item| item.command == command::NAV_DELAY)
}

/// Says where the vehicles are reached while they fly, for `replan`.
fn announce(runs: &Path, sorties: &Sorties, links: &[Link], speedup: f64) -> Result<(), Failure> {
    let fleet = &sorties.file.spec.vehicles;
    let links: serde_json::Map<String, serde_json::Value> = sorties
        .missions
        .iter()
        .zip(links)
        .map(|((index, _), link)| (fleet[*index].id.clone(), json!(link.to_string())))
        .collect();
    let document = json!({"links": links, "speedup": speedup});
    output::write_file(
        &runs.join("links.json"),
        report::json_text(&document).as_bytes(),
    )?;
    Ok(())
}

/// The driver of the fleet: clock, links, record, screen, keyboard.
struct Flying<'a> {
    links: &'a Links,
    began: Instant,
    t0_unix_s: u64,
    record: BufWriter<std::fs::File>,
    path: PathBuf,
    runs: PathBuf,
    written: Vec<usize>,
    show: Show,
    interrupts: Arc<AtomicUsize>,
    heeded: usize,
    answers: Option<Receiver<String>>,
    are_simulated: bool,
}

impl<'a> Flying<'a> {
    fn begin(
        runs: &Path,
        links: &'a Links,
        arguments: &args::Fly,
        are_simulated: bool,
    ) -> Result<Self, Failure> {
        let t0_unix_s = super::delivery::seconds_since_1970();
        let path = runs.join(format!("flight-{t0_unix_s}.jsonl"));
        let record = std::fs::File::create(&path).map_err(|error| unwritable(&path, &error))?;
        let interrupts = Arc::new(AtomicUsize::new(0));
        let counted = Arc::clone(&interrupts);
        ctrlc::set_handler(move || {
            counted.fetch_add(1, Ordering::Relaxed);
        })
        .map_err(|error| Failure::new(Failure::OUTPUT, format!("Ctrl-C: {error}")))?;
        #[allow(
            clippy::disallowed_methods,
            reason = "vehicles fly in real time; the fleet gets it as a value"
        )]
        let began = Instant::now();
        Ok(Self {
            links,
            began,
            t0_unix_s,
            record: BufWriter::new(record),
            path,
            runs: runs.to_owned(),
            written: Vec::new(),
            show: Show::new(arguments.json),
            interrupts,
            heeded: 0,
            answers: None,
            are_simulated,
        })
    }

    fn now(&self) -> Time {
        Time(u64::try_from(self.began.elapsed().as_millis()).unwrap_or(u64::MAX))
    }

    /// Until the flight is over, or was not begun.
    fn fly(&mut self, fleet: &mut Fleet<'_>) -> Result<(), Failure> {
        let mut parting: Option<Time> = None;
        loop {
            let now = self.now();
            fleet.handle_timeout(now);
            while let Some((system, message)) = fleet.poll_transmit() {
                self.links.send(system, message);
            }
            self.write(fleet)?;
            self.heed(fleet, now);
            self.show.fleet(fleet, now);
            match fleet.outcome() {
                Some(Outcome::NotStarted(_)) if parting.is_none_or(|end| now < end) => {
                    parting = parting.or(Some(now + PARTING_MS));
                }
                Some(_) => return self.write(fleet),
                None => {}
            }
            self.listen(fleet);
        }
    }

    fn listen(&mut self, fleet: &mut Fleet<'_>) {
        let wait = Duration::from_millis(fleet.poll_timeout() - self.now());
        let mut arrival = self.links.receive(wait.max(Duration::from_millis(1)));
        // What has come in meanwhile is not kept waiting.
        for _ in 0..1000 {
            let Some(arrived) = arrival else { return };
            let now = self.now();
            match arrived {
                Arrival::Message(from, message) => fleet.handle(now, from, &message),
                Arrival::Twins(system) => {
                    let what = "speaks from two addresses at once";
                    fleet.trouble(now, Some(system), what);
                }
                Arrival::Failed(link, why) => {
                    fleet.trouble(now, None, &format!("the link {link} has failed: {why}"));
                }
            }
            arrival = self.links.receive(Duration::ZERO);
        }
    }

    /// Events to the screen; events and positions to the record.
    fn write(&mut self, fleet: &mut Fleet<'_>) -> Result<(), Failure> {
        let mut lines: Vec<String> = Vec::new();
        while let Some(event) = fleet.poll_event() {
            if event.text.ends_with(": T0") {
                self.t0_unix_s = super::delivery::seconds_since_1970();
            }
            lines.push(flight::event_line(&event).to_string());
            self.show.event(&event)?;
        }
        for (index, (vehicle, flown)) in fleet.flown().enumerate() {
            if self.written.len() <= index {
                self.written.push(0);
            }
            let fresh = flown.fixes.get(self.written[index]..).unwrap_or_default();
            lines.extend(
                fresh
                    .iter()
                    .map(|fix| flight::fix_line(vehicle, fix).to_string()),
            );
            self.written[index] = flown.fixes.len();
        }
        let written = lines
            .iter()
            .try_for_each(|line| writeln!(self.record, "{line}"))
            .and_then(|()| self.record.flush());
        written.map_err(|error| unwritable(&self.path, &error))
    }

    /// Ctrl-C asks; without a terminal the vehicles are left as they are.
    fn heed(&mut self, fleet: &mut Fleet<'_>, now: Time) {
        let count = self.interrupts.load(Ordering::Relaxed);
        if count > self.heeded {
            let again = self.heeded > 0 && self.answers.is_some();
            self.heeded = count;
            let is_asked = std::io::stdin().is_terminal() && std::io::stderr().is_terminal();
            if again || !is_asked {
                self.leave(fleet, now);
            } else {
                note("Ctrl-C: [h]old, [l]and, [q]uit and leave flying, anything else to go on?");
                self.answers = Some(ask());
            }
        }
        let answer = self
            .answers
            .as_ref()
            .and_then(|answers| answers.try_recv().ok());
        let Some(answer) = answer else { return };
        self.answers = None;
        match answer.trim() {
            "h" | "hold" => fleet.intervene(now, Intervention::Hold),
            "l" | "land" => fleet.intervene(now, Intervention::Land),
            "q" | "quit" => self.leave(fleet, now),
            _ => note("they fly on"),
        }
    }

    fn leave(&self, fleet: &mut Fleet<'_>, now: Time) {
        fleet.intervene(now, Intervention::Leave);
        if self.are_simulated {
            note("the simulated vehicles end with this command");
        }
    }

    /// The verdict on what was flown, its record and its table.
    fn end(
        self,
        fleet: &Fleet<'_>,
        sorties: &Sorties,
        references: &[Reference],
        arguments: &args::Fly,
    ) -> Result<(), Failure> {
        if let Some(Outcome::NotStarted(why)) = fleet.outcome() {
            for (vehicle, problem) in why {
                note(&format!("{vehicle}: {problem}"));
            }
            let hint = if why
                .iter()
                .any(|(_, problem)| problem.starts_with("parameter"))
            {
                " (--set-params sets parameters, --force flies all the same)"
            } else {
                ""
            };
            let message = format!("none was started{hint}");
            return Err(Failure::new(Failure::TRANSFER, message));
        }
        let flights: Vec<(&str, &Reference, &Flown)> = fleet
            .flown()
            .zip(references)
            .map(|((vehicle, flown), reference)| (vehicle, reference, flown))
            .collect();
        let judged = flight::judge(&sorties.file.spec, &sorties.world, &flights);
        let hash = folder::sha256(&sorties.file.text);
        let document = flight::flight_json(&hash, (self.t0_unix_s, arguments.speedup), &judged);
        let text = report::json_text(&document);
        let named = self.path.with_extension("json");
        output::write_file(&named, text.as_bytes())?;
        output::write_file(&self.runs.join("flight.json"), text.as_bytes())?;
        let copied = std::fs::copy(&self.path, self.runs.join("flight.jsonl"));
        copied.map_err(|error| unwritable(&self.path, &error))?;
        if arguments.json {
            out(text.trim_end())?;
        } else {
            show::report(&judged)?;
            out(&format!("{}", named.display()))?;
        }
        verdict(&judged)
    }
}

fn verdict(judged: &FlightReport) -> Result<(), Failure> {
    if judged.passes() {
        return Ok(());
    }
    let message = "the flight did not keep its limits, or did not end as planned";
    Err(Failure::new(Failure::TRANSFER, message))
}

fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    let message = format!("cannot write {}: {error}", path.display());
    Failure::new(Failure::OUTPUT, message)
}

/// Reads one line while the flight goes on.
fn ask() -> Receiver<String> {
    let (send, answers) = channel();
    std::thread::spawn(move || {
        let mut line = String::new();
        if std::io::stdin().lock().read_line(&mut line).is_ok() {
            // The flight may be over by now.
            let _ = send.send(line);
        }
    });
    answers
}

/// An event as a line.
fn sentence(event: &Event) -> String {
    let at = event
        .t_s
        .map_or_else(String::new, |t_s| format!("T0+{} ", table::clock(t_s)));
    match &event.vehicle {
        Some(vehicle) => format!("{at}{vehicle}: {}", event.text),
        None => format!("{at}{}", event.text),
    }
}

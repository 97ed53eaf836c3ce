//! The driver of a fleet in flight: clock, links, record, screen, keyboard.

use std::io::{BufRead, BufWriter, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use super::call::Call;
use super::show::{self, Show};
use super::{Sorties, args};
use crate::cli::console::{note, out};
use crate::cli::failure::Failure;
use crate::cli::{delivery, folder, output};
use crate::flight::{
    self, Fleet, FlightReport, Flown, Intervention, Line, Outcome, Plan, Reference,
};
use crate::link::{Arrival, Links, Time};
use crate::mission::VehicleMission;
use crate::report;

/// How long disarming commands have to go out when nothing was started, milliseconds.
const PARTING_MS: u64 = 1500;
/// Between two looks for what `replan` has laid down, milliseconds.
const UNDERWAY_MS: u64 = 250;

/// The driver of the fleet: clock, links, record, screen, keyboard.
pub(super) struct Flying<'a> {
    links: &'a Links,
    began: Instant,
    record: BufWriter<std::fs::File>,
    path: PathBuf,
    runs: PathBuf,
    call: &'a Call,
    written: Vec<Written>,
    /// Bytes taken from what `replan` laid down, and when that is looked for again.
    taken: (usize, Time),
    show: Show,
    interrupts: Arc<AtomicUsize>,
    heeded: usize,
    answers: Option<Receiver<String>>,
    are_simulated: bool,
}

impl<'a> Flying<'a> {
    pub(super) fn begin(
        sorties: &Sorties,
        links: &'a Links,
        call: &'a Call,
        arguments: &args::Fly,
        are_simulated: bool,
    ) -> Result<Self, Failure> {
        let runs = folder::runs_folder(&sorties.folder);
        let t0_unix_s = delivery::seconds_since_1970();
        let path = runs.join(format!("flight-{t0_unix_s}.jsonl"));
        let mut record = std::fs::File::create(&path).map_err(|error| unwritable(&path, &error))?;
        let fleet = &sorties.file.spec.vehicles;
        let ids = sorties.missions.iter();
        let head = Line::Head {
            sortie: env!("CARGO_PKG_VERSION").to_owned(),
            spec_sha256: folder::sha256(&sorties.file.text),
            speedup: arguments.speedup,
            vehicles: ids.map(|(index, _)| fleet[*index].id.clone()).collect(),
        };
        writeln!(record, "{}", text(&head)).map_err(|error| unwritable(&path, &error))?;
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
            record: BufWriter::new(record),
            path,
            runs,
            call,
            written: Vec::new(),
            taken: (0, Time(0)),
            show: Show::new(arguments.json),
            interrupts,
            heeded: 0,
            answers: None,
            are_simulated,
        })
    }

    pub(super) fn now(&self) -> Time {
        Time(u64::try_from(self.began.elapsed().as_millis()).unwrap_or(u64::MAX))
    }

    /// Until the flight is over, or was not begun.
    pub(super) fn fly(&mut self, fleet: &mut Fleet<'_>) -> Result<(), Failure> {
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

    /// The plans that the vehicles take off with.
    pub(super) fn note_plans(
        &mut self,
        sorties: &Sorties,
        plans: &[Reference],
    ) -> Result<(), Failure> {
        let fleet = &sorties.file.spec.vehicles;
        let missions = sorties.missions.iter().zip(plans);
        let lines = missions.map(|((index, mission), reference)| {
            let plan = Plan {
                items: mission.items.len(),
                reference: reference.clone(),
            };
            text(&Line::of_plan(&fleet[*index].id, 0.0, &plan))
        });
        let lines: Vec<String> = lines.collect();
        self.put(&lines)
    }

    /// Events to the screen; all that happened to the record.
    fn write(&mut self, fleet: &mut Fleet<'_>) -> Result<(), Failure> {
        let mut lines: Vec<String> = Vec::new();
        while let Some(event) = fleet.poll_event() {
            if event.text.ends_with(": T0") {
                let t0_unix_ms = delivery::milliseconds_since_1970();
                let t0_unix_s = t0_unix_ms / 1000;
                self.call.announce(Some(t0_unix_ms))?;
                lines.push(text(&Line::Start { t0_unix_s }));
            }
            lines.push(text(&Line::of_event(&event)));
            self.show.event(&event)?;
        }
        for (index, (vehicle, flown)) in fleet.flown().enumerate() {
            if self.written.len() <= index {
                self.written.push(Written::default());
            }
            lines.extend(self.written[index].fresh(vehicle, flown));
        }
        let now = self.now();
        if now >= self.taken.1 || fleet.outcome().is_some() {
            let (fresh, taken) = self.call.taken_up(self.taken.0);
            lines.extend(fresh);
            self.taken = (taken, now + UNDERWAY_MS);
        }
        self.put(&lines)
    }

    fn put(&mut self, lines: &[String]) -> Result<(), Failure> {
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
        match answer.trim().to_ascii_lowercase().as_str() {
            "h" | "hold" => fleet.intervene(now, Intervention::Hold),
            "l" | "land" => fleet.intervene(now, Intervention::Land),
            "q" | "quit" => self.leave(fleet, now),
            _ => note("they fly on; Ctrl-C asks again"),
        }
    }

    fn leave(&self, fleet: &mut Fleet<'_>, now: Time) {
        fleet.intervene(now, Intervention::Leave);
        if self.are_simulated {
            note("the simulated vehicles end with this command");
        }
    }

    /// The verdict on what was flown, by its record; and its table.
    pub(super) fn end(
        mut self,
        fleet: &Fleet<'_>,
        sorties: &Sorties,
        arguments: &args::Fly,
    ) -> Result<(), Failure> {
        if let Some(Outcome::NotStarted(why)) = fleet.outcome() {
            return Err(not_started(why));
        }
        let ends = fleet.flown().map(|(vehicle, flown)| {
            text(&Line::End {
                vehicle: vehicle.to_owned(),
                end: flown.end.words().to_owned(),
            })
        });
        let ends: Vec<String> = ends.collect();
        self.put(&ends)?;
        // What was written is judged: whoever judges it again finds the same.
        let record =
            std::fs::read_to_string(&self.path).map_err(|error| unwritable(&self.path, &error))?;
        let spec = &sorties.file.spec;
        let record = flight::read_record(&record, sorties.world.frame)
            .map_err(|error| Failure::new(Failure::OUTPUT, error.to_string()))?;
        let judged = flight::judge(spec, &sorties.world, &record);
        let text = report::json_text(&flight::flight_json(&record, &judged));
        let named = self.path.with_extension("json");
        output::write_file(&named, text.as_bytes())?;
        output::write_file(&self.runs.join("flight.json"), text.as_bytes())?;
        let missions: Vec<(usize, &VehicleMission)> =
            sorties.missions.iter().map(|(v, m)| (*v, m)).collect();
        let page = flight::flight_page(spec, &sorties.world, &record, &judged, &missions);
        output::write_file(&self.path.with_extension("html"), page.as_bytes())?;
        output::write_file(&self.runs.join("flight.html"), page.as_bytes())?;
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

/// How much of a vehicle's flight is in the record.
#[derive(Clone, Copy, Default)]
struct Written {
    fixes: usize,
    reached: usize,
}

impl Written {
    /// What is not there yet.
    fn fresh(&mut self, vehicle: &str, flown: &Flown) -> Vec<String> {
        let fixes = flown.fixes.get(self.fixes..).unwrap_or_default();
        let reached = flown.reached.get(self.reached..).unwrap_or_default();
        (self.fixes, self.reached) = (flown.fixes.len(), flown.reached.len());
        let fixes = fixes.iter().map(|fix| text(&Line::of_fix(vehicle, fix)));
        let reached = reached.iter().map(|&(reached, t_s)| {
            text(&Line::Reached {
                t_s,
                vehicle: vehicle.to_owned(),
                reached,
            })
        });
        fixes.chain(reached).collect()
    }
}

fn text(line: &Line) -> String {
    // A line holds text and numbers alone.
    serde_json::to_string(line).unwrap_or_default()
}

fn not_started(why: &[(String, String)]) -> Failure {
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
    Failure::new(Failure::TRANSFER, format!("none was started{hint}"))
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

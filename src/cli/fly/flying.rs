//! The driver of a fleet in flight: clock, links, record, screen, keyboard.

use std::io::{BufRead, IsTerminal};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use super::call::Call;
use super::journal::{Journal, text};
use super::show::{self, Show};
use super::{Sorties, args};
use crate::cli::folder::{replace, runs};
use crate::cli::print::console::{note, out, out_json_text};
use crate::cli::print::failure::Failure;
use crate::cli::transfer::delivery;
use crate::flight::{
    self, End, Event, Fleet, FlightReport, Intervention, Line, Outcome, Plan, Reference,
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
    journal: Journal,
    runs: PathBuf,
    call: &'a Call,
    /// What could not be written, each once.
    unwritten: Vec<String>,
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
        let runs = runs::folder(&sorties.folder);
        let journal = Journal::begin(&runs, sorties, arguments)?;
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
            journal,
            runs,
            call,
            unwritten: Vec::new(),
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

    /// Until the flight is over, or was not begun. Nothing that cannot be written ends it: whoever
    /// is in the air is watched to the ground.
    pub(super) fn fly(&mut self, fleet: &mut Fleet<'_>) {
        let mut parting: Option<Time> = None;
        loop {
            let now = self.now();
            fleet.handle_timeout(now);
            while let Some((system, message)) = fleet.poll_transmit() {
                self.links.send(system, message);
            }
            self.write(fleet);
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
                Arrival::Message(link, from, message) => {
                    fleet.handle(now, (link, from), &message);
                }
                Arrival::DuplicateSystem(system) => {
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
        self.journal.put(&lines)
    }

    /// Events to the screen; all that happened to the record.
    fn write(&mut self, fleet: &mut Fleet<'_>) {
        let mut lines: Vec<String> = Vec::new();
        while let Some(event) = fleet.poll_event() {
            if event.text.ends_with(": T0") {
                let t0_unix_ms = delivery::milliseconds_since_1970();
                let t0_unix_s = t0_unix_ms / 1000;
                let announced = self.call.announce(Some(t0_unix_ms));
                self.note_unwritten(fleet, announced);
                self.forget_the_last();
                lines.push(text(&Line::Start { t0_unix_s }));
            }
            lines.push(text(&Line::of_event(&event)));
            let shown = self.show.event(&event);
            self.note_unwritten(fleet, shown);
        }
        lines.extend(self.journal.fresh(fleet.flown()));
        let now = self.now();
        if now >= self.taken.1 || fleet.outcome().is_some() {
            let (fresh, taken) = self.call.taken_up(self.taken.0);
            for line in fresh {
                lines.extend(self.take_up(line, fleet.t_s(now)));
            }
            self.taken = (taken, now + UNDERWAY_MS);
        }
        let written = self.journal.put(&lines);
        self.note_unwritten(fleet, written);
    }

    /// A line that `replan` laid down, and what of it an operator reads. A threat counts from now
    /// on at the latest, whatever time it was given.
    fn take_up(&self, line: String, t_s: Option<f64>) -> Vec<String> {
        let (line, vehicle, what) = match serde_json::from_str(&line) {
            Ok(Line::Threat {
                t_s: told_s,
                threat,
            }) => {
                let t_s = t_s.map_or(told_s, |now_s| told_s.min(now_s));
                let what = format!("replan was told of a threat, {}", threat.words());
                (text(&Line::Threat { t_s, threat }), None, what)
            }
            Ok(Line::Plan { vehicle, .. }) => {
                let what = "is sent another plan by replan".to_owned();
                (line, Some(vehicle), what)
            }
            _ => return vec![line],
        };
        let event = Event {
            t_s,
            vehicle,
            text: what,
        };
        // A screen that takes nothing is told of by the next event.
        let _ = self.show.event(&event);
        vec![line, text(&Line::of_event(&event))]
    }

    /// The newest flight is this one from now on, however it ends: no verdict of another stays.
    fn forget_the_last(&self) {
        for ending in ["json", "html", "jsonl"] {
            // Not there is as good.
            let _ = std::fs::remove_file(self.runs.join("flight").with_extension(ending));
        }
    }

    /// Says once what cannot be written. On the ground that ends the flight, in the air it does not.
    fn note_unwritten(&mut self, fleet: &mut Fleet<'_>, written: Result<(), Failure>) {
        let Err(failure) = written else { return };
        if self.unwritten.contains(&failure.message) {
            return;
        }
        if fleet.t_s(self.now()).is_some() {
            let so = "the vehicles are watched on";
            note(&format!("{}; {so}", failure.message));
        } else {
            fleet.trouble(self.now(), None, &failure.message);
        }
        self.unwritten.push(failure.message);
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
            "h" | "hold" => {
                fleet.intervene(now, Intervention::Hold);
                note("they are watched on, whoever brings them down; Ctrl-C asks again");
            }
            "l" | "land" => fleet.intervene(now, Intervention::Land),
            "q" | "quit" => self.leave(fleet, now),
            "" => note("nothing was changed; Ctrl-C asks again"),
            other => note(&format!(
                "{other:?} is none of h, l and q: nothing was changed; Ctrl-C asks again"
            )),
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
            return Err(not_started(why, !self.unwritten.is_empty()));
        }
        let ends = fleet.flown();
        let ends = ends.map(|(vehicle, flown)| text(&Line::of_end(vehicle, flown)));
        let ends: Vec<String> = ends.collect();
        let ended = self.journal.put(&ends);
        self.unwritten
            .extend(ended.err().map(|failure| failure.message));
        self.tell_who_stays(fleet);
        if self.journal.is_broken {
            let why = self.unwritten.join("; ");
            let message = format!("{why}: the record breaks off, and the flight is not judged");
            return Err(Failure::new(Failure::OUTPUT, message));
        }
        let judged = self.judge(sorties, arguments)?;
        match self.unwritten.first() {
            Some(what) => Err(Failure::new(Failure::OUTPUT, what)),
            None => verdict(&judged),
        }
    }

    /// Who is in the air when nobody watches any more.
    fn tell_who_stays(&self, fleet: &Fleet<'_>) {
        let stays = |end: &End| matches!(end, End::Held | End::LeftFlying | End::Loitering);
        let flown = fleet.flown().filter(|(_, flown)| stays(&flown.end));
        let names: Vec<&str> = flown.map(|(vehicle, _)| vehicle).collect();
        if !names.is_empty() && !self.are_simulated {
            note(&format!(
                "still in the air, and not watched any more: {}",
                names.join(", ")
            ));
        }
    }

    /// What was written is judged: whoever judges it again finds the same.
    fn judge(&self, sorties: &Sorties, arguments: &args::Fly) -> Result<FlightReport, Failure> {
        let path = self.journal.path();
        let text = std::fs::read_to_string(path).map_err(|error| {
            let message = format!("cannot read {}: {error}", path.display());
            Failure::new(Failure::OUTPUT, message)
        })?;
        let spec = &sorties.file.spec;
        let record = flight::read_record(&text, sorties.world.frame)
            .map_err(|error| Failure::new(Failure::OUTPUT, error.to_string()))?;
        let judged = flight::judge(spec, &sorties.world, &record);
        let document = report::json_text(&flight::flight_json(&record, &judged));
        let missions: Vec<(usize, &VehicleMission)> =
            sorties.missions.iter().map(|(v, m)| (*v, m)).collect();
        let page = flight::flight_page(spec, &sorties.world, &record, &judged, &missions);
        let written = self.keep([("jsonl", &text), ("html", &page), ("json", &document)]);
        // Whether or not that went well, the operator sees how the flight went.
        if arguments.json {
            out_json_text(&document)?;
        } else {
            show::report(&judged)?;
            out(&format!("{}", path.with_extension("json").display()))?;
        }
        written?;
        Ok(judged)
    }

    /// Writes the documents of the flight beside its record, and as those of the newest.
    fn keep(&self, documents: [(&str, &String); 3]) -> Result<(), Failure> {
        for (ending, text) in documents {
            let named = self.journal.path().with_extension(ending);
            if named != self.journal.path() {
                replace::write_file(&named, text.as_bytes())?;
            }
            let newest = self.runs.join("flight").with_extension(ending);
            replace::write_file(&newest, text.as_bytes())?;
        }
        Ok(())
    }
}

fn not_started(why: &[(String, String)], is_unwritten: bool) -> Failure {
    for (vehicle, problem) in why {
        let colon = if vehicle.is_empty() { "" } else { ": " };
        note(&format!("{vehicle}{colon}{problem}"));
    }
    let hint = if why
        .iter()
        .any(|(_, problem)| problem.starts_with("parameter"))
    {
        " (--set-params sets parameters, --force flies all the same)"
    } else {
        ""
    };
    let code = if is_unwritten {
        Failure::OUTPUT
    } else {
        Failure::TRANSFER
    };
    Failure::new(code, format!("none was started{hint}"))
}

fn verdict(judged: &FlightReport) -> Result<(), Failure> {
    if judged.passes() {
        return Ok(());
    }
    let message = "the flight did not keep its limits, or did not end as planned";
    Err(Failure::new(Failure::TRANSFER, message))
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

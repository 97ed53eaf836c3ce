//! The operator at the terminal: events and the table of the fleet, Ctrl-C and its answers.

use std::io::{BufRead, IsTerminal};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, channel};

use super::Socket;
use super::show::{self, Show};
use crate::cli::folder::runs::{self, PlanLock};
use crate::cli::print::console::{hang_up, note};
use crate::cli::print::failure::Failure;
use crate::cli::print::printer::Printer;
use crate::flight::{Event, Fleet, FlightError, Intervention, Operator};
use crate::link::Time;

/// Signals besides Ctrl-C that have come.
#[derive(Default)]
struct Signals {
    /// SIGTERM, which counts as Ctrl-C.
    terminated: Arc<AtomicBool>,
    /// SIGHUP: the terminal is gone, and the fleet is still in the air.
    hung_up: Arc<AtomicBool>,
}

impl Signals {
    #[cfg(unix)]
    fn begin() -> std::io::Result<Self> {
        use signal_hook::consts::{SIGHUP, SIGTERM};
        let signals = Self::default();
        signal_hook::flag::register(SIGTERM, Arc::clone(&signals.terminated))?;
        signal_hook::flag::register(SIGHUP, Arc::clone(&signals.hung_up))?;
        Ok(signals)
    }

    #[cfg(not(unix))]
    fn begin() -> std::io::Result<Self> {
        Ok(Self::default())
    }
}

/// Screen and keyboard of a flight.
pub(super) struct Screen {
    show: Show,
    interrupts: Arc<AtomicUsize>,
    signals: Signals,
    /// Interrupts that were answered.
    handled: usize,
    answers: Option<Receiver<String>>,
    has_simulated: bool,
    /// Other terminals; none where the session could not be opened.
    socket: Option<Socket>,
    /// Whether the own terminal is there and commands.
    has_terminal: bool,
    /// What is being written on the own terminal, and since when.
    at_work: (Option<u64>, Time),
    is_stuck: bool,
    /// When other terminals get the table of the fleet again.
    table_due: Time,
    folder: PathBuf,
    /// Holds the folder of the records that was made anew in place of one that was moved or deleted.
    lock: Option<PlanLock>,
}

/// Between two tables for other terminals, milliseconds.
const TABLE_MS: u64 = 1000;
/// The own terminal that takes nothing for this long does not command, milliseconds.
const STUCK_MS: u64 = 5000;

impl Screen {
    /// Takes over Ctrl-C, and opens the session in the folder of the records. `json` says whether
    /// stdout belongs to a document.
    pub(super) fn begin(json: bool, has_simulated: bool, folder: &Path) -> Result<Self, Failure> {
        let interrupts = Arc::new(AtomicUsize::new(0));
        let counted = Arc::clone(&interrupts);
        ctrlc::set_handler(move || {
            counted.fetch_add(1, Ordering::Relaxed);
        })
        .map_err(|error| Failure::new(Failure::OUTPUT, format!("Ctrl-C: {error}")))?;
        let signals = Signals::begin();
        let signals =
            signals.map_err(|error| Failure::new(Failure::OUTPUT, format!("signals: {error}")))?;
        Ok(Self {
            signals,
            show: Show::new(json),
            interrupts,
            handled: 0,
            answers: None,
            has_simulated,
            socket: open_session(folder),
            has_terminal: is_terminal(),
            at_work: (None, Time(0)),
            is_stuck: false,
            table_due: Time(0),
            folder: folder.to_owned(),
            lock: None,
        })
    }

    /// Leaves the screen to others: the session of the flight goes on, and lines may not be written yet.
    pub(super) fn into_parts(mut self) -> (Option<Socket>, Printer) {
        if let Some(socket) = &mut self.socket {
            socket.rest();
        }
        (self.socket, self.show.into_printer())
    }

    /// Whether everything could be shown so far, as far as is known.
    fn shown(&self) -> Result<(), FlightError> {
        let shown = self.show.shown();
        shown.map_err(|failure| FlightError::Record(failure.message))
    }

    /// Looks whether the own terminal takes what is written: one that was stopped (Ctrl-S, a connection that stalls)
    /// does not command, so that others can.
    fn look_at_terminal(&mut self, now: Time) {
        let at_work = self.show.at_work();
        if at_work != self.at_work.0 {
            self.at_work = (at_work, now);
        }
        let is_stuck = at_work.is_some() && now - self.at_work.1 >= STUCK_MS;
        if is_stuck == self.is_stuck || !self.has_terminal {
            return;
        }
        self.is_stuck = is_stuck;
        if let Some(socket) = &mut self.socket {
            socket.show(match is_stuck {
                true => "the terminal of this flight takes no lines any more: one that is attached commands",
                false => "the terminal of this flight takes lines again: it commands",
            });
        }
    }

    fn leave(&self) -> Intervention {
        if self.has_simulated {
            self.show
                .note("the simulated vehicles end with this command");
        }
        Intervention::Leave
    }

    /// Asks at an interrupt. Without a terminal, or at a second interrupt, the vehicles are left
    /// as they are.
    fn interrupted(&mut self) -> Option<Intervention> {
        if self.signals.hung_up.swap(false, Ordering::Relaxed) {
            hang_up();
            self.show
                .note("the terminal is gone (SIGHUP): the fleet is still monitored and recorded");
            self.has_terminal = false;
        }
        if self.signals.terminated.swap(false, Ordering::Relaxed) {
            self.interrupts.fetch_add(1, Ordering::Relaxed);
        }
        let count = self.interrupts.load(Ordering::Relaxed);
        if count <= self.handled {
            return None;
        }
        let again = self.handled > 0 && self.answers.is_some();
        self.handled = count;
        if again || !is_terminal() {
            return Some(self.leave());
        }
        self.show
            .note("Ctrl-C: [h]old, [l]and, [q]uit and leave flying, anything else to go on?");
        self.answers = Some(read_line());
        None
    }
}

impl Operator for Screen {
    fn event(&mut self, event: &Event) -> Result<(), FlightError> {
        if let Some(socket) = &mut self.socket {
            socket.show(&show::sentence(event));
        }
        self.show.event(event);
        self.shown()
    }

    fn update(&mut self, fleet: &Fleet<'_>, now: Time) -> Result<(), FlightError> {
        self.show.fleet(fleet, now);
        self.look_at_terminal(now);
        if let Some(socket) = self.socket.as_mut().filter(|_| now >= self.table_due) {
            self.table_due = now + TABLE_MS;
            socket.set_table(fleet.status(now).iter().map(show::line).collect());
            if socket.restore(&self.folder) {
                self.lock = runs::try_lock(&self.folder, "fly").ok().flatten();
            }
        }
        self.shown()
    }

    fn warn(&mut self, text: &str) {
        if let Some(socket) = &mut self.socket {
            socket.show(text);
        }
        self.show.note(text);
    }

    fn intervention(&mut self) -> Option<Intervention> {
        if let Some(leave) = self.interrupted() {
            return Some(leave);
        }
        let has_terminal = self.has_terminal && !self.is_stuck;
        let ordered = self.socket.as_mut();
        if let Some(order) = ordered.and_then(|socket| socket.poll(has_terminal)) {
            return Some(order);
        }
        let answer = self.answers.as_ref()?.try_recv().ok()?;
        self.answers = None;
        match answer.trim().to_ascii_lowercase().as_str() {
            "h" | "hold" => {
                self.show
                    .note("the vehicles hold and are still monitored; Ctrl-C asks again");
                return Some(Intervention::Hold);
            }
            "l" | "land" => return Some(Intervention::Land),
            "q" | "quit" => return Some(self.leave()),
            "" => self.show.note("nothing was changed; Ctrl-C asks again"),
            other => self.show.note(&format!(
                "{other:?} is none of h, l and q: nothing was changed; Ctrl-C asks again"
            )),
        }
        None
    }
}

/// Whether an operator sits at this command.
fn is_terminal() -> bool {
    std::io::stdin().is_terminal() && std::io::stderr().is_terminal()
}

/// A flight without a session is flown all the same.
fn open_session(folder: &Path) -> Option<Socket> {
    let opened = Socket::open(folder);
    if let Err(error) = &opened {
        note(&format!(
            "no session for other terminals, `sortie watch` cannot attach: {error}"
        ));
    }
    opened.ok()
}

/// Reads one line while the flight goes on.
fn read_line() -> Receiver<String> {
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

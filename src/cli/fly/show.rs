//! What an operator sees of a flight.

use std::io::IsTerminal;

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

use crate::cli::print::console::{note, out, shown};
use crate::cli::print::failure::Failure;
use crate::cli::print::printer::{Paper, Printer};
use crate::cli::print::table;
use crate::flight::{Event, Fleet, Status};
use crate::link::Time;

/// Between two pictures of the table, milliseconds.
const PICTURE_MS: u64 = 250;

/// What an operator sees: handed to a thread that writes it, so that the flight waits for no terminal.
pub(super) struct Show {
    printer: Printer,
    is_live: bool,
    due: Time,
}

impl Show {
    pub(super) fn new(json: bool) -> Self {
        let is_live = std::io::stderr().is_terminal();
        let page = Page {
            rows: Vec::new(),
            all: MultiProgress::new(),
            is_live,
            json,
        };
        Self {
            printer: Printer::start(page),
            is_live,
            due: Time(0),
        }
    }

    /// One line for what happened.
    pub(super) fn event(&self, event: &Event) {
        self.printer.line(sentence(event));
    }

    /// Whether every line could be written so far.
    pub(super) fn shown(&self) -> Result<(), Failure> {
        self.printer.failure()
    }

    /// One line that is no event.
    pub(super) fn note(&self, line: &str) {
        self.printer.note(line);
    }

    /// One row for each vehicle.
    pub(super) fn fleet(&mut self, fleet: &Fleet<'_>, now: Time) {
        if !self.is_live || now < self.due {
            return;
        }
        self.due = now + PICTURE_MS;
        self.printer
            .table(fleet.status(now).iter().map(line).collect());
    }

    /// See [`Printer::at_work`].
    pub(super) fn at_work(&self) -> Option<u64> {
        self.printer.at_work()
    }

    /// What may be not written yet.
    pub(super) fn into_printer(self) -> Printer {
        self.printer
    }
}

/// A live table on a terminal, plain lines elsewhere.
struct Page {
    rows: Vec<ProgressBar>,
    all: MultiProgress,
    is_live: bool,
    /// Whether stdout belongs to a document.
    json: bool,
}

impl Paper for Page {
    fn line(&mut self, line: &str) -> Result<(), Failure> {
        if self.is_live {
            // A terminal that is gone shows nothing.
            let _ = self.all.println(shown(line));
            return Ok(());
        }
        if self.json {
            note(line);
            return Ok(());
        }
        out(line)
    }

    fn note(&mut self, line: &str) {
        note(line);
    }

    fn table(&mut self, rows: &[String]) {
        for (index, text) in rows.iter().enumerate() {
            if self.rows.len() <= index {
                let bar = self.all.add(ProgressBar::new(100));
                if let Ok(style) = ProgressStyle::with_template("{wide_msg}") {
                    bar.set_style(style);
                }
                self.rows.push(bar);
            }
            if let Some(row) = self.rows.get(index) {
                row.set_message(shown(text).into_owned());
            }
        }
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        self.rows.iter().for_each(ProgressBar::finish_and_clear);
    }
}

pub(super) fn line(status: &Status) -> String {
    let (item, of) = status.item;
    let time = match status.behind_s {
        Some(late) if late >= 0.0 => format!("{late:.0} s behind"),
        Some(late) => format!("{:.0} s ahead", -late),
        None => String::new(),
    };
    let closest = status
        .closest
        .as_ref()
        .map_or_else(String::new, |(other, m)| format!("{other} {m:.0} m"));
    let lost = status
        .lost_s
        .map_or_else(String::new, |s| format!("LINK LOST {s:.0} s"));
    let done = match status.done {
        (_, 0) => String::new(),
        (done, all) => format!("  done {done} of {all}"),
    };
    let alarms: Vec<&str> = status.alarms.iter().map(|kind| kind.key()).collect();
    let alarms = if alarms.is_empty() {
        String::new()
    } else {
        format!("ALARM {}", alarms.join(", "))
    };
    format!(
        "{:>10}  {:<11}  {}  item {item:>3} of {of:<3}{done}  {:>3.0} %  {time:>12}  {closest:<18} {lost} {alarms}",
        status.vehicle,
        status.stage,
        instruments(status),
        100.0 * status.progress,
    )
}

/// Mode, armed, GPS fix, battery, altitude and age of the position.
fn instruments(status: &Status) -> String {
    let or_dash = |value: Option<String>| value.unwrap_or_else(|| "-".to_owned());
    let mode = status.mode.as_deref().unwrap_or("-");
    let armed = if status.is_armed { "armed" } else { "safe" };
    let fix = match status.gps_fix {
        None => "-",
        Some(0 | 1) => "NO FIX",
        Some(2) => "2D",
        Some(3) => "3D",
        Some(_) => "3D+",
    };
    let battery = or_dash(status.battery_percent.map(|percent| format!("{percent} %")));
    let amsl = or_dash(status.amsl_m.map(|amsl_m| format!("{amsl_m:.0} m")));
    let age = or_dash(status.age_s.map(|age_s| format!("{age_s:.1} s")));
    format!("{mode:<12} {armed:<5} GPS {fix:<6} bat {battery:>5} {amsl:>7} age {age:>5}")
}

/// An event as a line.
pub(super) fn sentence(event: &Event) -> String {
    let at = event
        .t_s
        .map_or_else(String::new, |t_s| format!("T0+{} ", table::clock(t_s)));
    match &event.vehicle {
        Some(vehicle) => format!("{at}{vehicle}: {}", event.text),
        None => format!("{at}{}", event.text),
    }
}

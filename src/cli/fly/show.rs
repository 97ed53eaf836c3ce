//! What an operator sees of a flight.

use std::io::IsTerminal;

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

use crate::cli::print::console::{Paint, note, out, shown};
use crate::cli::print::failure::Failure;
use crate::cli::print::table;
use crate::cli::print::table::Rows;
use crate::flight::{Event, Fleet, FlightReport, Spread, Status};
use crate::link::Time;
use crate::verify::{Limit, Margin, Sense};

/// Between two pictures of the table, milliseconds.
const PICTURE_MS: u64 = 250;

/// A live table on a terminal, plain lines elsewhere.
pub(super) struct Show {
    rows: Vec<ProgressBar>,
    all: MultiProgress,
    is_live: bool,
    /// Whether stdout belongs to a document.
    json: bool,
    due: Time,
}

impl Show {
    pub(super) fn new(json: bool) -> Self {
        Self {
            rows: Vec::new(),
            all: MultiProgress::new(),
            is_live: std::io::stderr().is_terminal(),
            json,
            due: Time(0),
        }
    }

    /// One line for what happened.
    pub(super) fn event(&self, event: &Event) -> Result<(), Failure> {
        let line = sentence(event);
        if self.is_live {
            // A terminal that is gone shows nothing.
            let _ = self.all.println(shown(&line));
            return Ok(());
        }
        if self.json {
            note(&line);
            return Ok(());
        }
        out(&line)
    }

    /// One row for each vehicle.
    pub(super) fn fleet(&mut self, fleet: &Fleet<'_>, now: Time) {
        if !self.is_live || now < self.due {
            return;
        }
        self.due = now + PICTURE_MS;
        for (index, status) in fleet.status(now).iter().enumerate() {
            if self.rows.len() <= index {
                let bar = self.all.add(ProgressBar::new(100));
                if let Ok(style) = ProgressStyle::with_template("{wide_msg}") {
                    bar.set_style(style);
                }
                self.rows.push(bar);
            }
            if let Some(row) = self.rows.get(index) {
                row.set_message(shown(&line(status)).into_owned());
            }
        }
    }
}

impl Drop for Show {
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
    let alarms: Vec<&str> = status.alarms.iter().map(|kind| kind.key()).collect();
    let alarms = if alarms.is_empty() {
        String::new()
    } else {
        format!("ALARM {}", alarms.join(", "))
    };
    format!(
        "{:>10}  {:<11}  {}  item {item:>3} of {of:<3}  {:>3.0} %  {time:>12}  {closest:<18} {lost} {alarms}",
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

/// Prints the table of a flight that is over, and the limits that were violated.
pub(in crate::cli) fn report(judged: &FlightReport) -> Result<(), Failure> {
    let paint = Paint::for_stdout();
    vehicle_rows(judged, paint).print()?;
    let stopped = judged.vehicles.iter().filter(|of| !of.ended_as_planned);
    for of in stopped {
        out(&format!(
            "{} {}: {}; a flight as planned ends with the landing, or in the air where the plan ends",
            paint.bad("FAIL"),
            of.vehicle,
            of.end
        ))?;
    }
    for margin in judged.margins.iter().filter(|m| m.other.is_some() || !m.ok) {
        out(&margin_line(margin, paint))?;
    }
    Ok(())
}

/// One row for each vehicle.
fn vehicle_rows(judged: &FlightReport, paint: Paint) -> Rows {
    let mut rows = Rows::new(&[
        "vehicle",
        "end",
        "cross-track error",
        "altitude error",
        "late",
        "clearance",
        "",
    ]);
    let spread = |spread: Option<Spread>| {
        spread.map_or_else(
            || "-".to_owned(),
            |s| format!("{:.1} / {:.1} / {:.1} m", s.median, s.p95, s.worst),
        )
    };
    for vehicle in &judged.vehicles {
        let latest = vehicle.passages.iter().map(crate::flight::Passage::late_s);
        let latest = latest.max_by(|a, b| a.abs().total_cmp(&b.abs()));
        let clearance = judged
            .margins
            .iter()
            .find(|m| m.vehicle == vehicle.vehicle && m.limit == Limit::TerrainClearance);
        let is_within = judged
            .margins
            .iter()
            .all(|margin| margin.ok || !margin.concerns(&vehicle.vehicle));
        rows.add([
            vehicle.vehicle.clone(),
            vehicle.end.clone(),
            spread(vehicle.cross_track_m),
            spread(vehicle.altitude_error_m),
            latest.map_or_else(|| "-".to_owned(), |s| format!("{s:.0} s at most")),
            clearance
                .filter(|margin| margin.value.is_finite())
                .map_or_else(|| "-".to_owned(), |m| format!("{:.0} m", m.value)),
            if is_within && vehicle.ended_as_planned {
                paint.good("ok")
            } else {
                paint.bad("FAIL")
            },
        ]);
    }
    rows
}

/// The worst value of a limit as a line.
fn margin_line(margin: &Margin, paint: Paint) -> String {
    let whom = margin
        .other
        .as_ref()
        .map_or_else(String::new, |other| format!(" and {other}"));
    let sign = if margin.sense == Sense::AtLeast {
        ">="
    } else {
        "<="
    };
    let at = margin
        .at
        .map_or_else(String::new, |at| format!(" at T0+{}", table::clock(at.t_s)));
    let mark = if margin.ok {
        paint.good("ok")
    } else {
        paint.bad("FAIL")
    };
    format!(
        "{mark} {}{whom}: {} {} {} flown ({sign} {}){at} {}",
        margin.vehicle,
        margin.limit,
        table::number(margin.value, 1),
        margin.unit,
        table::number(margin.bound, 1),
        margin.note
    )
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

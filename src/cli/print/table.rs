//! Tables for the terminal: one for the fleet, one for what fails.

use comfy_table::{ContentArrangement, LineStyle, Table, presets};

use super::console::{Paint, out, out_lines, safe};
use super::failure::Failure;
use crate::numeric::digits;
use crate::spec::{Autopilot, MissionSpec};
use crate::verify::{Limit, Margin, Review, Sense, Topic};

/// With more rows than this, the lines between them are left out.
const MAX_RULED: usize = 12;

/// A table, or on a terminal too narrow for it a list of the same cells.
pub(crate) struct Rows {
    header: Vec<&'static str>,
    rows: Vec<Vec<String>>,
    spare: Vec<&'static str>,
}

impl Rows {
    pub(crate) fn new(header: &[&'static str]) -> Self {
        Self {
            header: header.to_vec(),
            rows: Vec::new(),
            spare: Vec::new(),
        }
    }

    /// Columns that a narrow terminal omits, in this order.
    pub(crate) fn spare(&mut self, heads: &[&'static str]) {
        self.spare = heads.to_vec();
    }

    /// Adds a row with a cell for each head.
    pub(crate) fn add(&mut self, cells: impl Into<Vec<String>>) {
        let cells: Vec<String> = cells.into();
        let safe_cells = cells.iter().map(|cell| safe(cell).into_owned());
        self.rows.push(safe_cells.collect());
    }
}

impl Rows {
    /// The table without the columns `without`.
    fn table(&self, without: &[&str]) -> Table {
        let keeps = |column: usize| {
            let head = self.header.get(column);
            head.is_none_or(|head| !without.contains(head))
        };
        let mut table = Table::new();
        table.load_style(presets::UTF8_HORIZONTAL_ONLY);
        if self.rows.len() > MAX_RULED {
            table.style_mut().row_separator = LineStyle::none();
        }
        table.set_content_arrangement(ContentArrangement::Disabled);
        table.set_header(self.header.iter().filter(|head| !without.contains(head)));
        for row in &self.rows {
            let cells = row.iter().enumerate();
            table.add_row(cells.filter_map(|(n, cell)| keeps(n).then_some(cell)));
        }
        table
    }
}

impl Rows {
    /// Prints the table, on a narrow terminal as a list.
    pub(crate) fn print(&self) -> Result<(), Failure> {
        for spared in 0..=self.spare.len() {
            let table = self.table(self.spare.get(..spared).unwrap_or_default());
            let lines: Vec<String> = table.lines().collect();
            let needed = lines.iter().map(|line| line.chars().count()).max();
            let fits = |columns: u16| needed.is_none_or(|needed| needed <= usize::from(columns));
            if table.width().is_none_or(fits) {
                return out_lines(&lines);
            }
        }
        for (index, row) in self.rows.iter().enumerate() {
            if index > 0 {
                out("")?;
            }
            let cells = self.header.iter().zip(row);
            for (head, cell) in cells.filter(|(_, cell)| !cell.is_empty()) {
                out(&format!("{head:>18}  {cell}"))?;
            }
        }
        Ok(())
    }
}

/// Prints below a table that its limits have no buffers, where they have none.
pub(crate) fn print_no_buffers(spec: &MissionSpec) -> Result<(), Failure> {
    let Some(why) = spec.why_no_buffers() else {
        return Ok(());
    };
    out(&Paint::for_stdout().dim(&format!("note: {why}")))
}

/// The decimals of a value in a unit: what is counted has none.
pub(crate) fn decimals(unit: &str) -> usize {
    usize::from(!["items", "problems", "legs", "missing"].contains(&unit))
}

/// The unit of a value: one of what is counted has no plural.
pub(crate) fn unit(value: f64, unit: &'static str) -> &'static str {
    let is_one = decimals(unit) == 0 && (value - 1.0).abs() < 1e-9;
    match is_one {
        true => unit.trim_end_matches('s'),
        false => unit,
    }
}

/// A number with at most `decimals` decimals; a huge one with a power of ten.
pub(crate) fn number(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        "not known".to_owned()
    } else if value.abs() < 1e9 {
        format!("{value:.decimals$}")
    } else {
        format!("{value:.1e}")
    }
}

/// A number with enough decimals to differ from the limit it misses.
fn number_against(value: f64, limit: f64, decimals: usize) -> String {
    if value.abs() < 1e9 {
        digits::distinct_from(value, limit, decimals)
    } else {
        number(value, decimals)
    }
}

/// The tightest margin of a vehicle among the limits of some topics: value and limit.
pub(crate) fn tightest(review: &Review, vehicle: &str, topics: &[Topic]) -> String {
    let worst = review
        .margins
        .iter()
        .filter(|margin| margin.concerns(vehicle) && topics.contains(&margin.limit.topic()))
        .min_by(|a, b| a.ok.cmp(&b.ok).then(a.slack().total_cmp(&b.slack())));
    let Some(margin) = worst else {
        return "-".to_owned();
    };
    let whom = match &margin.other {
        Some(other) if other != vehicle => format!(" to {other}"),
        Some(_) => format!(" to {}", margin.vehicle),
        None => match &margin.limit {
            Limit::Threat(id) | Limit::Zone(id) => format!(" to {id}"),
            _ => String::new(),
        },
    };
    let mark = if margin.ok { "" } else { " FAIL" };
    if !margin.value.is_finite() {
        return format!("not known{whom}{mark}");
    }
    let limit = number(margin.bound, 0);
    let value = match margin.ok {
        true => number(margin.value, 0),
        false => number_against(margin.value, margin.bound, 0),
    };
    let sign = match margin.sense {
        Sense::AtLeast => ">=",
        Sense::AtMost => "<=",
    };
    format!("{value} {}{whom} ({sign} {limit}){mark}", margin.unit)
}

/// The tightest separation of a vehicle in a fleet, or why it has none.
pub(crate) fn separation(review: &Review, vehicle: &str, fleet: usize) -> String {
    let topics = [Topic::Separation];
    let is_judged = (review.margins.iter())
        .any(|margin| margin.concerns(vehicle) && topics.contains(&margin.limit.topic()));
    let mut tracks = review.tracks.iter();
    let is_flown = tracks.any(|track| track.vehicle == vehicle && !track.moments.is_empty());
    match (is_judged, is_flown) {
        (true, _) => tightest(review, vehicle, &topics),
        (false, _) if fleet < 2 => "alone".to_owned(),
        (false, true) => "none near".to_owned(),
        (false, false) => "no mission".to_owned(),
    }
}

/// A sentence for each failed margin, with times after T0.
pub(crate) fn failures(review: &Review, paint: Paint) -> Vec<String> {
    failures_since(review, paint, "T0")
}

/// A sentence for each failed margin, with times after `since`.
pub(crate) fn failures_since(review: &Review, paint: Paint, since: &str) -> Vec<String> {
    let failed = review.margins.iter().filter(|margin| !margin.ok);
    failed
        .map(|margin| format!("{} {}", paint.bad("FAIL"), sentence(margin, since)))
        .collect()
}

/// One margin in words: vehicles, limit, value, place and time.
fn sentence(margin: &Margin, since: &str) -> String {
    let mut text = match &margin.other {
        Some(other) => format!("{} and {other}: {}", margin.vehicle, margin.limit),
        // What concerns the fleet as a whole, such as a task that nobody does.
        None if margin.vehicle.is_empty() => margin.limit.to_string(),
        None => format!("{}: {}", margin.vehicle, margin.limit),
    };
    if margin.value.is_finite() {
        text += &format!(
            ": {} {}, {} {} {} allowed",
            number_against(margin.value, margin.bound, decimals(margin.unit)),
            unit(margin.value, margin.unit),
            sense(margin),
            number(margin.bound, decimals(margin.unit)),
            unit(margin.bound, margin.unit)
        );
    }
    if let Some(at) = &margin.at {
        text += &format!(
            ", at item {}, {:.6} {:.6}, {:.0} m AMSL, {since}{:+.0} s",
            at.item, at.place.lat_deg, at.place.lon_deg, at.amsl.0, at.t_s
        );
    }
    if !margin.note.is_empty() {
        text += &format!(" ({})", margin.note);
    }
    text
}

/// Which side of the limit is good, in words.
pub(crate) fn sense(margin: &Margin) -> &'static str {
    match margin.sense {
        Sense::AtLeast => "at least",
        Sense::AtMost => "at most",
    }
}

/// Seconds as minutes and seconds.
pub(crate) fn clock(seconds: f64) -> String {
    if !seconds.is_finite() {
        return "no end".to_owned();
    }
    let whole = seconds.round().max(0.0);
    format!("{:.0}:{:02.0}", (whole / 60.0).floor(), whole % 60.0)
}

/// The name of an autopilot.
pub(crate) fn autopilot(autopilot: Autopilot) -> &'static str {
    autopilot.name()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_fleet_takes_one_line_for_each_vehicle() {
        let lines = |count: usize| {
            let mut rows = Rows::new(&["vehicle", "items"]);
            (0..count).for_each(|n| rows.add([format!("v{n}"), "200".to_owned()]));
            rows.table(&[]).to_string().lines().count()
        };
        assert_eq!((lines(3), lines(100)), (9, 104));
    }
}

//! Tables for the terminal: one for the fleet, one for what fails.

use std::fmt;

use comfy_table::{ContentArrangement, LineStyle, Table, presets};

use super::console::Paint;
use crate::numeric::digits;
use crate::spec::Autopilot;
use crate::verify::{Limit, Margin, Review, Sense, Topic};

/// With more rows than these the lines between them only take room.
const MOST_RULED: usize = 12;

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

    /// Columns that a narrow terminal does without, the first one first.
    pub(crate) fn spare(&mut self, heads: &[&'static str]) {
        self.spare = heads.to_vec();
    }

    /// Adds a row with a cell for each head.
    pub(crate) fn add(&mut self, cells: impl Into<Vec<String>>) {
        self.rows.push(cells.into());
    }
}

impl Rows {
    /// The table without some columns.
    fn table(&self, without: &[&str]) -> Table {
        let keeps = |column: usize| {
            let head = self.header.get(column);
            head.is_none_or(|head| !without.contains(head))
        };
        let mut table = Table::new();
        table.load_style(presets::UTF8_HORIZONTAL_ONLY);
        if self.rows.len() > MOST_RULED {
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

impl fmt::Display for Rows {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for spared in 0..=self.spare.len() {
            let table = self.table(self.spare.get(..spared).unwrap_or_default());
            let text = table.to_string();
            let needed = text.lines().map(|line| line.chars().count()).max();
            let fits = |columns: u16| needed.is_none_or(|needed| needed <= usize::from(columns));
            if table.width().is_none_or(fits) {
                return f.write_str(&text);
            }
        }
        for (index, row) in self.rows.iter().enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            for (head, cell) in self
                .header
                .iter()
                .zip(row)
                .filter(|(_, cell)| !cell.is_empty())
            {
                writeln!(f, "{head:>18}  {cell}")?;
            }
        }
        Ok(())
    }
}

/// A number of at most so many decimals; short whatever its size.
pub(crate) fn number(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        "not known".to_owned()
    } else if value.abs() < 1e9 {
        format!("{value:.decimals$}")
    } else {
        format!("{value:.1e}")
    }
}

/// The same, with more decimals where it would read like the limit it misses.
fn number_beside(value: f64, limit: f64, decimals: usize) -> String {
    if value.abs() < 1e9 {
        digits::distinct_from(value, limit, decimals)
    } else {
        number(value, decimals)
    }
}

/// The tightest margin of a vehicle among the limits of some topics, as an operator
/// reads it: the value and what it is compared with.
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
        false => number_beside(margin.value, margin.bound, 0),
    };
    format!("{value} {}{whom} (>= {limit}){mark}", margin.unit)
}

/// Every failed margin in words, with times after T0.
pub(crate) fn failures(review: &Review, paint: Paint) -> String {
    failures_since(review, paint, "T0")
}

/// The same with times after something else.
pub(crate) fn failures_since(review: &Review, paint: Paint, since: &str) -> String {
    let failed = review.margins.iter().filter(|margin| !margin.ok);
    failed
        .map(|margin| format!("{} {}", paint.bad("FAIL"), sentence(margin, since)))
        .collect::<Vec<_>>()
        .join("\n")
}

/// One margin in words: who, what, by how much, where, when.
fn sentence(margin: &Margin, since: &str) -> String {
    let mut text = match &margin.other {
        Some(other) => format!("{} and {other}: {}", margin.vehicle, margin.limit),
        None => format!("{}: {}", margin.vehicle, margin.limit),
    };
    if margin.value.is_finite() {
        text += &format!(
            ": {} {unit}, {} {} {unit} allowed",
            number_beside(margin.value, margin.bound, 1),
            sense(margin),
            number(margin.bound, 1),
            unit = margin.unit
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

/// The autopilot as its people write it.
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

//! Where the values of a spec stand: in the YAML, and for a vehicle that `fleet` makes in
//! its table, its grid or its defaults.

use super::issue::{Issue, MISSING};
use super::keys::schema;
use super::positions::Positions;
use super::table::{Row, Table};

/// Keys that are of one vehicle, though a part of them may be common to all.
const WHOLE: [&str; 5] = ["", "home", "start", "goal", "landing"];

/// The positions of a spec and of its table.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct ValueSources {
    positions: Positions,
    /// Number of vehicles that `vehicles` lists; those after them are made by `fleet`.
    listed: usize,
    made: Vec<Made>,
    table: Table,
}

/// A vehicle that `fleet` made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Made {
    pub(super) id: String,
    /// Index of its row in the table; none: by a grid.
    pub(super) row: Option<usize>,
}

impl ValueSources {
    /// Of a spec whose `vehicles` lists this many.
    pub(super) fn new(positions: Positions, listed: usize) -> Self {
        Self {
            positions,
            listed,
            ..Self::default()
        }
    }

    /// Takes the vehicles that `fleet` made, and the table they come from.
    pub(super) fn add_fleet(&mut self, made: Vec<Made>, table: Table) {
        (self.made, self.table) = (made, table);
    }

    /// A problem at a path such as `vehicles[7].start.lat`.
    pub(super) fn issue(&self, path: &str, found: String, allowed: String) -> Issue {
        let Some((made, key)) = self.made(path) else {
            return self.in_file(path, found, allowed);
        };
        let row = self.row(made);
        if let Some(row) = row {
            let cell = |key: &str| self.cell(&row.cells, key);
            // A vehicle without a home stands under its start.
            let under = || (key == "home").then(|| cell("start")).flatten();
            if let Some(column) = cell(key).or_else(under) {
                return self.table.cell_issue(row.line, column, found, &allowed);
            }
        }
        let common = self.common(key);
        // What the defaults say is wrong once, whichever vehicle it is true of.
        let is_common =
            common.strip_prefix("fleet.defaults.") == Some(key) && !WHOLE.contains(&key);
        match row {
            Some(row) if !is_common => self.table.row_issue(row.line, key, found, &allowed),
            _ if is_common => self.in_file(&common, found, allowed),
            _ => self.in_file(&common, format!("`{}`: {found}", made.id), allowed),
        }
    }

    /// A key that is missing below a path such as `vehicles[7].start`, and what the schema allows there.
    pub(super) fn missing(&self, path: &str, key: &str) -> Issue {
        let whole = format!("{path}.{key}");
        let Some((made, key)) = self.made(&whole) else {
            let found = format!("{MISSING}{key}`");
            let allowed = schema::allowed_at(schema::of_spec(), &whole);
            return self.in_file(&whole, found, allowed);
        };
        let column = key.replace('.', "_");
        let names = &self.table.columns;
        let index = names.iter().position(|name| *name == column);
        let allowed = match (self.row(made), index, key) {
            (Some(row), Some(index), _) => {
                let found = "an empty cell".to_owned();
                let allowed = format!("a value, or {key} in fleet.defaults");
                return self.table.cell_issue(row.line, index, found, &allowed);
            }
            (Some(_), None, _) => format!("{key} here, or a column {column}"),
            (None, _, "start.lat" | "start.lon") => format!("{key} here, or start_grid"),
            (None, _, "goal.lat" | "goal.lon") => format!("{key} here, or goal_grid"),
            (None, ..) => format!("{key}, as a vehicle has it"),
        };
        self.in_file("fleet.defaults", format!("no {key}"), allowed)
    }

    fn in_file(&self, path: &str, found: String, allowed: String) -> Issue {
        Issue {
            path: path.to_owned(),
            table: None,
            position: self.positions.find(path),
            found,
            allowed,
        }
    }

    /// What an operator calls `vehicles[7]`.
    pub(super) fn name(&self, path: &str) -> String {
        match self.made(path).map(|(made, _)| (made.row, self.row(made))) {
            None => path.to_owned(),
            Some((None, _)) => "another vehicle of fleet".to_owned(),
            Some((_, row)) => {
                let line = row.map_or(0, |row| row.line);
                format!("row {line} of {}", self.table.file)
            }
        }
    }

    /// The vehicle of a path that `fleet` made, and the rest of the path.
    fn made<'p>(&self, path: &'p str) -> Option<(&Made, &'p str)> {
        let (index, rest) = path.strip_prefix("vehicles[")?.split_once(']')?;
        let index: usize = index.parse().ok()?;
        let made = self.made.get(index.checked_sub(self.listed)?)?;
        Some((made, rest.trim_start_matches('.')))
    }

    /// Whether `fleet` made the vehicle of a path.
    pub(super) fn is_made(&self, path: &str) -> bool {
        self.made(path).is_some()
    }

    fn row(&self, made: &Made) -> Option<&Row> {
        self.table.rows.get(made.row?)
    }

    /// Index of the first column that has a cell for this key or for a part of it.
    fn cell(&self, cells: &[String], key: &str) -> Option<usize> {
        let key = key.replace('.', "_");
        let filled = |column: &usize| !cells[*column].is_empty();
        let mut columns = (0..self.table.columns.len()).filter(filled);
        let part = format!("{key}_");
        columns.find(|column| {
            let name = &self.table.columns[*column];
            !key.is_empty() && (*name == key || name.starts_with(&part))
        })
    }

    /// The path in `fleet` that gives its vehicles this key.
    fn common(&self, key: &str) -> String {
        let own = format!("fleet.defaults.{key}");
        let paths = match key {
            "" => ["fleet", "fleet", "fleet"],
            "id" => ["fleet.id", "fleet", "fleet"],
            "sysid" => ["fleet.first_sysid", "fleet", "fleet"],
            "depart_s" => ["fleet.depart_every_s", &own, "fleet.defaults"],
            "start" | "start.lat" | "start.lon" => ["fleet.start_grid", &own, "fleet.defaults"],
            "goal" | "goal.lat" | "goal.lon" => ["fleet.goal_grid", &own, "fleet.defaults"],
            "home" => [&own, "fleet.start_grid", "fleet.defaults.start"],
            _ => [&own, "fleet.defaults", "fleet"],
        };
        let mut known = paths.into_iter().filter(|path| self.positions.has(path));
        known.next().unwrap_or("fleet").to_owned()
    }
}

/// Problems in file order. Of those that the same lines of `fleet` cause for many vehicles,
/// the first, with the number of the others.
pub(super) fn in_order(mut issues: Vec<Issue>) -> Vec<Issue> {
    issues.sort_by_key(Issue::order);
    let mut distinct: Vec<(Issue, usize)> = Vec::new();
    for issue in issues {
        let of_fleet = issue.table.is_none() && issue.path.starts_with("fleet");
        let same = distinct.iter_mut().rev().take(16).find(|(other, _)| {
            of_fleet && other.path == issue.path && other.allowed == issue.allowed
        });
        match same {
            Some((other, more)) if other.found != issue.found => *more += 1,
            Some(_) => {}
            None => distinct.push((issue, 0)),
        }
    }
    let with_count = |(mut issue, more): (Issue, usize)| {
        if more > 0 {
            issue.found = format!("{} (and {more} more like it)", issue.found);
        }
        issue
    };
    distinct.into_iter().map(with_count).collect()
}

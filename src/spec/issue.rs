//! Problems of a spec: where, what was found, what is allowed.

use std::fmt;

use crate::numeric::text::escaped;

/// How the parser, and the check, name a missing key.
pub(super) const MISSING: &str = "missing field `";

/// One problem of a spec.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Issue {
    /// Path in the YAML, such as `vehicles[2].start.lat`, also of a key that is missing; empty for the whole file. In a
    /// table the name of the column; empty for the whole row.
    pub path: String,
    /// The table in which the problem stands; none: in the spec itself.
    pub table: Option<String>,
    /// Line and column, from 1; absent if unknown. Of a missing key those of the keys around it. In a table the row,
    /// which is the line, and the number of the column, 0 for the whole row.
    pub position: Option<(usize, usize)>,
    /// What was found.
    pub found: String,
    /// What is allowed; empty when `found` says it all.
    pub allowed: String,
}

impl Issue {
    /// Sorts the spec before its table, each from top to bottom.
    pub(super) fn order(&self) -> (bool, Option<(usize, usize)>) {
        (self.table.is_some(), self.position)
    }
}

/// Everything that is wrong with a spec, at once.
#[derive(Clone, Debug, Default, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub struct SpecError {
    /// File name as given, for the messages.
    pub file: String,
    /// At least one problem, in file order.
    pub issues: Vec<Issue>,
}

impl fmt::Display for SpecError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, issue) in self.issues.iter().enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            write!(f, "{}", escaped(&issue.sentence(&self.file)))?;
        }
        Ok(())
    }
}

impl Issue {
    fn sentence(&self, file: &str) -> String {
        let place = self.place(file);
        let found = &self.found;
        if self.allowed.is_empty() {
            format!("{place}: {found}")
        } else {
            format!("{place}: {found} (allowed: {})", self.allowed)
        }
    }

    /// `spec.yaml:17:18: vehicles[0].start.lat`, or `fleet.csv: row 4, column 2 (start_lat)`.
    fn place(&self, file: &str) -> String {
        let mut place = self.table.as_deref().unwrap_or(file).to_owned();
        match (&self.table, self.position) {
            (_, None) => {}
            (None, Some((line, column))) => place += &format!(":{line}:{column}"),
            (Some(_), Some((row, 0))) => place += &format!(": row {row}"),
            (Some(_), Some((row, column))) => place += &format!(": row {row}, column {column}"),
        }
        match &self.table {
            _ if self.path.is_empty() => place,
            None => format!("{place}: {}", self.path),
            Some(_) => format!("{place} ({})", self.path),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Issue, SpecError};

    #[test]
    fn text_of_a_file_does_not_control_the_terminal() {
        let error = SpecError {
            file: "spec.yaml".to_owned(),
            issues: vec![Issue {
                path: "\u{1b}[2Jname".to_owned(),
                table: Some("fleet.csv".to_owned()),
                position: Some((4, 2)),
                found: "bell\u{7}".to_owned(),
                allowed: "a name".to_owned(),
            }],
        };
        let message = "fleet.csv: row 4, column 2 (\\u{1b}[2Jname): bell\\u{7} (allowed: a name)";
        assert_eq!(error.to_string(), message);
    }
}

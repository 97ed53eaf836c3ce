//! What is wrong with a spec: where, what was found, what is allowed.

use std::fmt;

/// One problem of a spec.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Issue {
    /// Path in the YAML, such as `vehicles[2].start.lat`; empty for the whole file. In a
    /// table the name of the column; empty for the whole row.
    pub path: String,
    /// The table in which the problem stands; none: in the spec itself.
    pub table: Option<String>,
    /// Line and column, from 1; absent if the place cannot be told. In a table the row,
    /// which is the line, and the number of the column, 0 for the whole row.
    pub position: Option<(usize, usize)>,
    /// What was found.
    pub found: String,
    /// What is allowed; empty when `found` says it all.
    pub allowed: String,
}

impl Issue {
    /// Where it stands among others: the spec before its table, each from top to bottom.
    pub(super) fn order(&self) -> (bool, Option<(usize, usize)>) {
        (self.table.is_some(), self.position)
    }
}

/// Everything that is wrong with a spec, at once.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
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
            issue.place(&self.file, f)?;
            write!(f, ": {}", issue.found)?;
            if !issue.allowed.is_empty() {
                write!(f, " (allowed: {})", issue.allowed)?;
            }
        }
        Ok(())
    }
}

impl Issue {
    /// `spec.yaml:17:18: vehicles[0].start.lat`, or `fleet.csv: row 4, column 2 (start_lat)`.
    fn place(&self, file: &str, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(table) = &self.table else {
            write!(f, "{file}")?;
            if let Some((line, column)) = self.position {
                write!(f, ":{line}:{column}")?;
            }
            if !self.path.is_empty() {
                write!(f, ": {}", self.path)?;
            }
            return Ok(());
        };
        write!(f, "{table}")?;
        if let Some((row, column)) = self.position {
            write!(f, ": row {row}")?;
            if column > 0 {
                write!(f, ", column {column}")?;
            }
        }
        if !self.path.is_empty() {
            write!(f, " ({})", self.path)?;
        }
        Ok(())
    }
}

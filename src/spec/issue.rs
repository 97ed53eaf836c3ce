//! What is wrong with a spec: where, what was found, what is allowed.

use std::fmt;

/// One problem of a spec.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Issue {
    /// Path in the YAML, such as `vehicles[2].start.lat`; empty for the whole file.
    pub path: String,
    /// Line and column, from 1; absent if the place cannot be told.
    pub position: Option<(usize, usize)>,
    /// What was found.
    pub found: String,
    /// What is allowed; empty when `found` says it all.
    pub allowed: String,
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
            write!(f, "{}", self.file)?;
            if let Some((line, column)) = issue.position {
                write!(f, ":{line}:{column}")?;
            }
            if !issue.path.is_empty() {
                write!(f, ": {}", issue.path)?;
            }
            write!(f, ": {}", issue.found)?;
            if !issue.allowed.is_empty() {
                write!(f, " (allowed: {})", issue.allowed)?;
            }
        }
        Ok(())
    }
}

//! A table of vehicles: comma-separated values with a row of names first.

use std::path::PathBuf;

use super::Issue;
use crate::numeric::text::with_line_feeds;

/// The file that a spec names as its table, byte for byte.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TableFile {
    /// Its path relative to the spec.
    pub name: PathBuf,
    /// What it holds.
    pub text: String,
}

/// Its columns and rows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Table {
    /// The file, for messages.
    pub(super) file: String,
    /// Line of the names.
    header: usize,
    /// The names.
    pub(super) columns: Vec<String>,
    pub(super) rows: Vec<Row>,
}

/// One row, with as many cells as there are columns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Row {
    /// Its first line, from 1: the row in a spreadsheet.
    pub(super) line: usize,
    pub(super) cells: Vec<String>,
}

impl Table {
    /// Reads a table. Spaces around cells, blank lines, and lines that begin with # are skipped.
    ///
    /// # Errors
    /// No row of names, a name given twice, and every row with another number of cells.
    pub(super) fn read(file: String, text: &str) -> Result<Self, Vec<Issue>> {
        let text = with_line_feeds(text.trim_start_matches('\u{feff}').as_bytes());
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .from_reader(text.as_slice());
        let mut table = Self {
            file,
            ..Self::default()
        };
        let mut issues = Vec::new();
        for record in reader.records() {
            let record = match record {
                Ok(record) => record,
                Err(error) => {
                    let line = error.position().map_or(1, |at| at.line());
                    issues.push(table.row_issue(whole(line), "", error.to_string(), "a row"));
                    break;
                }
            };
            let line = whole(record.position().map_or(1, csv::Position::line));
            let cells: Vec<String> = record.iter().map(str::to_owned).collect();
            if table.columns.is_empty() {
                table.header = line;
                table.columns = cells;
            } else if cells.len() == table.columns.len() {
                table.rows.push(Row { line, cells });
            } else {
                let found = format!("{} cells", cells.len());
                let allowed = format!("{}, as in the row of names", table.columns.len());
                issues.push(table.row_issue(line, "", found, &allowed));
            }
        }
        table.check_names(&mut issues);
        if issues.is_empty() {
            Ok(table)
        } else {
            Err(issues)
        }
    }

    fn check_names(&self, issues: &mut Vec<Issue>) {
        if self.columns.is_empty() {
            let allowed = "the names of the columns, then one row for each vehicle";
            issues.push(self.row_issue(1, "", "an empty table".to_owned(), allowed));
        }
        for (column, name) in self.columns.iter().enumerate() {
            if self.columns[..column].contains(name) {
                let found = "a column of this name a second time".to_owned();
                issues.push(self.name_issue(column, found, "each once"));
            }
        }
    }

    /// A problem of the name of a column, by its index.
    pub(super) fn name_issue(&self, column: usize, found: String, allowed: &str) -> Issue {
        self.cell_issue(self.header, column, found, allowed)
    }

    /// A problem of a cell, by its line and the index of its column.
    pub(super) fn cell_issue(
        &self,
        line: usize,
        column: usize,
        found: String,
        allowed: &str,
    ) -> Issue {
        Issue {
            path: self.columns.get(column).cloned().unwrap_or_default(),
            table: Some(self.file.clone()),
            position: Some((line, column + 1)),
            found,
            allowed: allowed.to_owned(),
        }
    }

    /// A problem of a whole row, or of a key that it has no cell for.
    pub(super) fn row_issue(&self, line: usize, key: &str, found: String, allowed: &str) -> Issue {
        Issue {
            path: key.to_owned(),
            table: Some(self.file.clone()),
            position: Some((line, 0)),
            found,
            allowed: allowed.to_owned(),
        }
    }
}

fn whole(line: u64) -> usize {
    usize::try_from(line).unwrap_or(usize::MAX)
}

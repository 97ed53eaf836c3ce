//! The record of a flight while it is written.

use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use super::Flown;
use super::lines::Line;
use crate::flight::error::FlightError;

/// Writes the record of a flight, a line for each thing that happened.
#[derive(Debug)]
pub struct Journal {
    file: BufWriter<std::fs::File>,
    path: PathBuf,
    /// Positions and items reached that are written, for each vehicle.
    written: Vec<(usize, usize)>,
    /// A line could not be written; none was after it.
    is_broken: bool,
}

impl Journal {
    /// Creates the record and writes its header.
    ///
    /// # Errors
    /// [`FlightError::Record`]: there is such a file already, or it cannot be written.
    pub fn begin(path: PathBuf, header: &Line) -> Result<Self, FlightError> {
        let file = std::fs::File::create_new(&path);
        let file = file.map_err(|error| unwritable(&path, &error))?;
        let mut journal = Self {
            file: BufWriter::new(file),
            path,
            written: Vec::new(),
            is_broken: false,
        };
        journal.put(&[header.text()])?;
        Ok(journal)
    }

    /// Goes on with a record that broke off: `written` are the positions and items reached of each
    /// vehicle in it. The last bytes, `lost` of them, are removed.
    ///
    /// # Errors
    /// [`FlightError::Record`]: it cannot be written.
    pub fn resume(
        path: PathBuf,
        written: Vec<(usize, usize)>,
        lost: usize,
    ) -> Result<Self, FlightError> {
        let open = || {
            let file = std::fs::File::options().append(true).open(&path)?;
            let length = file.metadata()?.len();
            file.set_len(length.saturating_sub(u64::try_from(lost).unwrap_or(u64::MAX)))?;
            Ok(file)
        };
        let file = open().map_err(|error| unwritable(&path, &error))?;
        Ok(Self {
            file: BufWriter::new(file),
            path,
            written,
            is_broken: false,
        })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn is_broken(&self) -> bool {
        self.is_broken
    }

    /// Writes lines out, to the disk's care. After the first that could not be written none is:
    /// a record with a hole in it would be judged as a whole one.
    pub(crate) fn put(&mut self, lines: &[String]) -> Result<(), FlightError> {
        if self.is_broken {
            return Ok(());
        }
        let written = lines
            .iter()
            .try_for_each(|line| writeln!(self.file, "{line}"))
            .and_then(|()| self.file.flush());
        written.map_err(|error| {
            self.is_broken = true;
            unwritable(&self.path, &error)
        })
    }

    /// Lines for everything that the vehicles have flown since the last call.
    pub(crate) fn fresh<'a>(
        &mut self,
        flown: impl Iterator<Item = (&'a str, &'a Flown)>,
    ) -> Vec<String> {
        let mut lines = Vec::new();
        for (index, (vehicle, flown)) in flown.enumerate() {
            if self.written.len() <= index {
                self.written.push((0, 0));
            }
            let (fixes, reached) = self.written[index];
            self.written[index] = (flown.fixes.len(), flown.reached.len());
            let fixes = flown.fixes.get(fixes..).unwrap_or_default().iter();
            lines.extend(fixes.map(|fix| Line::of_fix(vehicle, fix).text()));
            let reached = flown.reached.get(reached..).unwrap_or_default().iter();
            lines.extend(reached.map(|&(reached, t_s)| {
                let vehicle = vehicle.to_owned();
                Line::Reached {
                    t_s,
                    vehicle,
                    reached,
                }
                .text()
            }));
        }
        lines
    }
}

pub(super) fn unwritable(path: &Path, error: &std::io::Error) -> FlightError {
    FlightError::Record(format!("cannot write {}: {error}", path.display()))
}

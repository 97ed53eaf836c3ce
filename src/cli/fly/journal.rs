//! The record of a flight while it is written.

use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use super::{Sorties, args};
use crate::cli::folder::runs;
use crate::cli::folder::sha256;
use crate::cli::print::failure::Failure;
use crate::flight::{Flown, Line};

/// The record of a flight, a line for each thing that happened.
pub(super) struct Journal {
    record: BufWriter<std::fs::File>,
    path: PathBuf,
    written: Vec<Written>,
    /// A line could not be written; none was after it.
    pub(super) is_broken: bool,
}

/// How much of a vehicle's flight is in the record.
#[derive(Clone, Copy, Default)]
struct Written {
    fixes: usize,
    reached: usize,
}

impl Journal {
    /// A new one, named after the time, that says what is flown.
    pub(super) fn begin(
        folder: &Path,
        sorties: &Sorties,
        arguments: &args::Fly,
    ) -> Result<Self, Failure> {
        let path = runs::named(folder, "flight", "jsonl");
        let file = std::fs::File::create_new(&path);
        let file = file.map_err(|error| unwritable(&path, &error))?;
        let fleet = &sorties.file.spec.vehicles;
        let ids = sorties.missions.iter();
        let head = Line::Head {
            sortie: env!("CARGO_PKG_VERSION").to_owned(),
            spec_sha256: sha256(&sorties.file.text),
            speedup: arguments.speedup,
            vehicles: ids.map(|(index, _)| fleet[*index].id.clone()).collect(),
        };
        let mut journal = Self {
            record: BufWriter::new(file),
            path,
            written: Vec::new(),
            is_broken: false,
        };
        journal.put(&[text(&head)])?;
        Ok(journal)
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Writes lines out, to the disk's care. After the first that could not be written none is:
    /// a record with a hole in it would be judged as a whole one.
    pub(super) fn put(&mut self, lines: &[String]) -> Result<(), Failure> {
        if self.is_broken {
            return Ok(());
        }
        let written = lines
            .iter()
            .try_for_each(|line| writeln!(self.record, "{line}"))
            .and_then(|()| self.record.flush());
        written.map_err(|error| {
            self.is_broken = true;
            unwritable(&self.path, &error)
        })
    }

    /// What vehicles have flown and is not there yet.
    pub(super) fn fresh<'a>(
        &mut self,
        flown: impl Iterator<Item = (&'a str, &'a Flown)>,
    ) -> Vec<String> {
        let mut lines = Vec::new();
        for (index, (vehicle, flown)) in flown.enumerate() {
            if self.written.len() <= index {
                self.written.push(Written::default());
            }
            lines.extend(self.written[index].fresh(vehicle, flown));
        }
        lines
    }
}

impl Written {
    /// What is not there yet.
    fn fresh(&mut self, vehicle: &str, flown: &Flown) -> Vec<String> {
        let fixes = flown.fixes.get(self.fixes..).unwrap_or_default();
        let reached = flown.reached.get(self.reached..).unwrap_or_default();
        (self.fixes, self.reached) = (flown.fixes.len(), flown.reached.len());
        let fixes = fixes.iter().map(|fix| text(&Line::of_fix(vehicle, fix)));
        let reached = reached.iter().map(|&(reached, t_s)| {
            text(&Line::Reached {
                t_s,
                vehicle: vehicle.to_owned(),
                reached,
            })
        });
        fixes.chain(reached).collect()
    }
}

pub(super) fn text(line: &Line) -> String {
    // A line holds text and numbers alone.
    serde_json::to_string(line).unwrap_or_default()
}

pub(super) fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    let message = format!("cannot write {}: {error}", path.display());
    Failure::new(Failure::OUTPUT, message)
}

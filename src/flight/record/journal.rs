//! The record of a flight while it is written.

use std::fs::{File, Metadata};
use std::io::{Read, Seek, Write};
use std::path::{Path, PathBuf};

use super::Flown;
use super::lines::Line;
use crate::flight::error::FlightError;

/// Writes the record of a flight, a line for each thing that happened.
#[derive(Debug)]
pub struct Journal {
    file: File,
    path: PathBuf,
    /// Bytes that were written, with those of before.
    length: u64,
    /// Positions and items reached that are written, for each vehicle.
    written: Vec<(usize, usize)>,
    /// A line could not be written; none was after it.
    is_broken: bool,
    /// Why the record is not that of the flight any more.
    spoilt: Option<String>,
}

impl Journal {
    /// Creates the record and writes its header.
    ///
    /// # Errors
    /// [`FlightError::Record`]: there is such a file already, or it cannot be written.
    pub fn begin(path: PathBuf, header: &Line) -> Result<Self, FlightError> {
        let file = create(&path).map_err(|error| unwritable(&path, &error))?;
        let mut journal = Self::of(file, path, 0, Vec::new());
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
            let file = File::options().read(true).append(true).open(&path)?;
            let length = file.metadata()?.len();
            let length = length.saturating_sub(u64::try_from(lost).unwrap_or(u64::MAX));
            file.set_len(length)?;
            Ok((file, length))
        };
        let (file, length) = open().map_err(|error| unwritable(&path, &error))?;
        Ok(Self::of(file, path, length, written))
    }

    fn of(file: File, path: PathBuf, length: u64, written: Vec<(usize, usize)>) -> Self {
        Self {
            file,
            path,
            length,
            written,
            is_broken: false,
            spoilt: None,
        }
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn is_broken(&self) -> bool {
        self.is_broken
    }

    /// Why the record cannot be judged as that of the flight, although it was written.
    pub(crate) fn spoilt(&self) -> Option<&str> {
        self.spoilt.as_deref()
    }

    /// Everything that is in the record, wherever its file is by now.
    pub(crate) fn text(&self) -> Result<String, FlightError> {
        let read = || {
            let mut file = &self.file;
            file.rewind()?;
            let mut text = String::new();
            file.read_to_string(&mut text)?;
            Ok(text)
        };
        read().map_err(|error: std::io::Error| {
            FlightError::Record(format!("cannot read {}: {error}", self.path.display()))
        })
    }

    /// Looks whether the record is where it should be, and nobody else wrote to it. One that was moved or deleted is
    /// written anew as a whole; in words, if it was.
    ///
    /// # Errors
    /// [`FlightError::Record`]: bytes of it are missing, or it cannot be written anew. Then it goes on in its open file.
    pub(crate) fn look(&mut self) -> Result<Option<String>, FlightError> {
        let own = self.file.metadata();
        let own = own.map_err(|error| unwritable(&self.path, &error))?;
        let path = self.path.display();
        let found = own.len();
        // A line that could not be written may be there in part.
        if found != self.length && !self.is_broken {
            let why = match self.length.checked_sub(found) {
                Some(lost) => format!("{path}: {lost} bytes of the record are missing"),
                None => format!("{path}: another program writes to the record"),
            };
            self.length = found;
            self.spoilt = Some(why.clone());
            return Err(FlightError::Record(why));
        }
        let there = std::fs::metadata(&self.path);
        // Some file systems number a file anew; another one does not grow with this.
        if there.is_ok_and(|there| is_same(&there, &own) || there.len() == found) {
            return Ok(None);
        }
        let what = "the record was moved or deleted";
        match self.write_anew() {
            Ok(()) => Ok(Some(format!(
                "{what}: it is written anew, whole, in {}",
                self.path.display()
            ))),
            Err(error) => Err(FlightError::Record(format!(
                "{what}, and cannot be written anew in {}: {error}; it goes on in its open file, and is judged by that",
                self.path.display()
            ))),
        }
    }

    /// Writes the whole record where it was. Another file in its place is set aside.
    fn write_anew(&mut self) -> std::io::Result<()> {
        let text = self.text().map_err(std::io::Error::other)?;
        if let Some(folder) = self.path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        if self.path.exists() {
            std::fs::rename(&self.path, self.path.with_extension("other"))?;
        }
        let mut file = create(&self.path)?;
        file.write_all(text.as_bytes())?;
        self.file = file;
        Ok(())
    }

    /// Writes lines out, to the disk's care. After the first that could not be written none is:
    /// a record with a hole in it would be judged as a whole one.
    pub(crate) fn put(&mut self, lines: &[String]) -> Result<(), FlightError> {
        if self.is_broken || lines.is_empty() {
            return Ok(());
        }
        let text: String = lines.iter().flat_map(|line| [line, "\n"]).collect();
        let written = self.file.write_all(text.as_bytes());
        self.length += text.len() as u64;
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

fn create(path: &Path) -> std::io::Result<File> {
    let mut options = File::options();
    options.read(true).append(true).create_new(true).open(path)
}

/// Whether two are the same file.
#[cfg(unix)]
fn is_same(a: &Metadata, b: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (a.dev(), a.ino()) == (b.dev(), b.ino())
}

/// Other systems keep an open file where it is.
#[cfg(not(unix))]
fn is_same(a: &Metadata, b: &Metadata) -> bool {
    a.is_file() == b.is_file()
}

pub(super) fn unwritable(path: &Path, error: &std::io::Error) -> FlightError {
    FlightError::Record(format!("cannot write {}: {error}", path.display()))
}

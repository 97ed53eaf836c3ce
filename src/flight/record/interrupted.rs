//! A flight whose ground station crashed, by its record: everything that goes on from there.

use std::path::{Path, PathBuf};

use super::handoff::{Ended, FlightHandoff, Notice};
use super::journal::{Journal, unwritable};
use super::lines::Line;
use super::read::read_record;
use super::{Flight, Record};
use crate::flight::clock::steady_ms;
use crate::flight::error::FlightError;
use crate::flight::session::end::End;
use crate::geodesy::LocalFrame;
use crate::numeric::text::read_regular_bytes;

/// A flight that broke off in the air.
#[derive(Debug)]
pub struct Interrupted {
    path: PathBuf,
    record: Record,
    /// Milliseconds since 1970 at T0.
    t0_unix_ms: u64,
    /// Lines of `replan` that are in the record.
    replan_lines: usize,
    /// What comes after the last line that can be read.
    lost: Vec<u8>,
    /// What `fly` wrote of the flight.
    notice: Notice,
}

impl Interrupted {
    /// Reads the record of the flight under way in a folder of records; `frame` is that of the
    /// spec.
    ///
    /// # Errors
    /// [`FlightError::Input`]: nothing flies by this plan, it never took off, or its record cannot
    /// be read or is of a flight that is over.
    pub fn find(
        folder: &Path,
        handoff: &FlightHandoff,
        frame: LocalFrame,
    ) -> Result<Self, FlightError> {
        let notice = &handoff.notice;
        let Some(t0_unix_ms) = notice.t0_unix_ms.filter(|_| !notice.record.is_empty()) else {
            return Err(FlightError::Input(format!(
                "{}: the flight broke off before T0: look whether a vehicle is armed, then start it anew with `sortie fly`",
                folder.display()
            )));
        };
        // A name alone: the record lies in the folder.
        let name = Path::new(&notice.record).file_name().unwrap_or_default();
        let path = folder.join(name);
        let bad = |why: String| FlightError::Input(format!("{}: {why}", path.display()));
        let bytes = read_regular_bytes(&path).map_err(|error| bad(error.to_string()))?;
        let length = readable(&bytes);
        let text = String::from_utf8_lossy(&bytes[..length]);
        let record = read_record(&text, frame).map_err(|error| bad(error.to_string()))?;
        if record
            .flights
            .iter()
            .all(|of| of.flown.end != End::NotFlown)
        {
            let why = "the flight is over; `sortie review` judges its record";
            return Err(bad(why.to_owned()));
        }
        if record.flights.iter().any(|of| of.plans.is_empty()) {
            return Err(bad("a vehicle has no plan in it".to_owned()));
        }
        let lines = text
            .lines()
            .filter_map(|line| serde_json::from_str(line).ok());
        let replan_lines = lines.filter(Line::is_of_replan).count();
        Ok(Self {
            path,
            record,
            t0_unix_ms,
            notice: notice.clone(),
            replan_lines,
            lost: bytes[length..].to_vec(),
        })
    }

    /// SHA-256 of the spec that is flown, hexadecimal.
    #[must_use]
    pub fn spec_sha256(&self) -> &str {
        &self.record.spec_sha256
    }

    /// Milliseconds since 1970 at T0.
    #[must_use]
    pub fn t0_unix_ms(&self) -> u64 {
        self.t0_unix_ms
    }

    /// The time of now, milliseconds since 1970, on a clock that was not set since T0, as far as there is one.
    #[must_use]
    pub fn now_unix_ms(&self) -> u64 {
        let since_ms = self.notice.since_t0_ms(steady_ms());
        self.t0_unix_ms.saturating_add(since_ms)
    }

    /// What an operator must know of the time since T0.
    pub(crate) fn clock_words(&self) -> Option<String> {
        self.notice.clock_words()
    }

    /// How much faster than the wall's clock the vehicles' time goes.
    #[must_use]
    pub fn speedup(&self) -> f64 {
        self.record.speedup
    }

    /// What was recorded of a vehicle.
    #[must_use]
    pub fn flight(&self, vehicle: &str) -> Option<&Flight> {
        let mut flights = self.record.flights.iter();
        flights.find(|of| of.vehicle == vehicle)
    }

    /// How the flight of a vehicle ended before it broke off, and whether the record says so.
    pub(crate) fn ended(&self, vehicle: &str) -> Option<(Ended, bool)> {
        let flown = self.flight(vehicle).map(|of| &of.flown);
        if let Some(flown) = flown.filter(|flown| flown.end != End::NotFlown) {
            let (end, t_s) = (flown.end.words().to_owned(), flown.until_s);
            return Some((Ended { end, t_s }, true));
        }
        self.notice
            .ended
            .get(vehicle)
            .cloned()
            .map(|ended| (ended, false))
    }

    /// When the last position was recorded, seconds after T0.
    #[must_use]
    pub fn until_s(&self) -> f64 {
        let flights = self.record.flights.iter();
        let last = flights.filter_map(|of| of.flown.fixes.last());
        last.fold(0.0, |last_s, fix| fix.t_s.max(last_s))
    }

    /// The record, to be written on. Its vehicles are in the order of `vehicles`.
    ///
    /// # Errors
    /// [`FlightError::Record`]: it cannot be written.
    pub fn journal<'a>(
        &self,
        vehicles: impl Iterator<Item = &'a str>,
    ) -> Result<Journal, FlightError> {
        let written = vehicles.map(|id| {
            let flown = self.flight(id).map(|of| &of.flown);
            flown.map_or((0, 0), |flown| (flown.fixes.len(), flown.reached.len()))
        });
        if !self.lost.is_empty() {
            let path = self.lost_path();
            let set_aside = std::fs::write(&path, &self.lost);
            set_aside.map_err(|error| unwritable(&path, &error))?;
        }
        Journal::resume(self.path.clone(), written.collect(), self.lost.len())
    }

    /// What could not be read of the record, and where it is, in words; nothing for a last line that was cut off.
    #[must_use]
    pub fn lost(&self) -> Option<String> {
        let is_cut_off = !self.lost.iter().any(|byte| [b'\n', 0].contains(byte));
        let is_text = std::str::from_utf8(&self.lost).is_ok();
        (!is_cut_off || !is_text).then(|| {
            let (bytes, path) = (self.lost.len(), self.lost_path());
            format!(
                "the last {bytes} bytes of the record could not be read: they are in {}",
                path.display()
            )
        })
    }

    fn lost_path(&self) -> PathBuf {
        self.path.with_extension("lost")
    }

    /// Lines of `replan` that are in the record.
    pub(crate) fn replan_lines(&self) -> usize {
        self.replan_lines
    }
}

/// How many bytes of a record are lines, up to the first that is none: where a computer lost its power, the
/// rest may be anything.
fn readable(bytes: &[u8]) -> usize {
    let mut length = 0;
    for line in bytes.split_inclusive(|byte| *byte == b'\n') {
        let text = std::str::from_utf8(line).ok();
        let text = text.and_then(|text| text.strip_suffix('\n'));
        let is_line =
            |text: &str| text.trim().is_empty() || serde_json::from_str::<Line>(text).is_ok();
        if !text.is_some_and(is_line) {
            break;
        }
        length += line.len();
    }
    length
}

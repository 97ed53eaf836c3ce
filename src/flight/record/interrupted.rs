//! A flight whose ground station crashed, by its record: everything that goes on from there.

use std::path::{Path, PathBuf};

use super::journal::Journal;
use super::lines::Line;
use super::read::read_record;
use super::underway::Underway;
use super::{Flight, Record};
use crate::flight::error::FlightError;
use crate::flight::session::end::End;
use crate::geodesy::LocalFrame;
use crate::numeric::text::read_regular;

/// A flight that broke off in the air.
#[derive(Debug)]
pub struct Interrupted {
    path: PathBuf,
    record: Record,
    /// Milliseconds since 1970 at T0.
    t0_unix_ms: u64,
    /// Lines of `replan` that are in the record.
    replan_lines: usize,
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
        underway: &Underway,
        frame: LocalFrame,
    ) -> Result<Self, FlightError> {
        let notice = &underway.notice;
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
        let text = read_regular(&path).map_err(|error| bad(error.to_string()))?;
        let record = read_record(&text, frame).map_err(|error| bad(error.to_string()))?;
        if record
            .flights
            .iter()
            .any(|of| of.flown.end != End::NotFlown)
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
        let replan_lines = lines.filter(is_of_replan).count();
        Ok(Self {
            path,
            record,
            t0_unix_ms,
            replan_lines,
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
        Journal::resume(self.path.clone(), written.collect())
    }

    /// Lines of `replan` that are in the record.
    pub(crate) fn replan_lines(&self) -> usize {
        self.replan_lines
    }
}

/// Whether `replan` wrote a line: a threat, or a plan that a vehicle did not take off with.
fn is_of_replan(line: &Line) -> bool {
    match line {
        Line::Threat { .. } => true,
        Line::Plan { t_s, .. } => *t_s > 0.0,
        _ => false,
    }
}

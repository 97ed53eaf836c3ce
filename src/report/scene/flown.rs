//! Flown tracks against their plans, for the page of a flight.

use serde::Serialize;

use super::track::metres;
use crate::geodesy::PlanPoint;

/// Points of a chart of errors, for each vehicle.
const MAX_ERRORS: usize = 400;

/// How far a vehicle was from its plan at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlownError {
    /// Seconds after T0.
    pub t_s: f64,
    /// Cross-track error, metres.
    pub cross_track_m: f64,
    /// Above the planned path, metres; negative below.
    pub above_m: f64,
}

/// One vehicle's flight against its plans.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FlownFacts {
    /// Id in the spec.
    pub vehicle: String,
    /// The planned paths, one after the other.
    pub planned: Vec<Vec<PlanPoint>>,
    /// In order of time.
    pub errors: Vec<FlownError>,
    /// Its stops and tasks, in the order in which they begin.
    pub served: Vec<ServedFacts>,
}

/// A stop or a task of a vehicle, and what was seen of it.
#[derive(Clone, Debug, PartialEq)]
pub struct ServedFacts {
    /// What it is called: `stop west`, `task delivery-2 (delivery)`.
    pub label: String,
    /// `done`, `left` or `missed`.
    pub state: &'static str,
    /// When it began, seconds after T0; none where it was not seen to.
    pub from_s: Option<f64>,
    /// When it was done, seconds after T0; none where it was not seen done.
    pub until_s: Option<f64>,
}

/// The shapes that the views draw.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(in crate::report) struct FlownShape {
    /// Paths of points: east, north, altitude.
    pub(in crate::report) planned: Vec<Vec<[f64; 3]>>,
    /// Time, cross-track error, metres above the path.
    errors: Vec<[f64; 3]>,
}

impl FlownShape {
    pub(in crate::report) fn new(facts: &FlownFacts) -> Self {
        let point = |p: &PlanPoint| [metres(p.at.east_m), metres(p.at.north_m), metres(p.amsl.0)];
        let bucket = facts.errors.len().div_ceil(MAX_ERRORS).max(1);
        // The worst of each span of time, so that no peak is lost.
        let errors = facts.errors.chunks(bucket).filter_map(|chunk| {
            let first = chunk.first()?;
            let aside = chunk.iter().map(|error| error.cross_track_m);
            let above = chunk.iter().map(|error| error.above_m);
            let aside = aside.fold(0.0, f64::max);
            let above = above.max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
            Some([metres(first.t_s), metres(aside), metres(above)])
        });
        Self {
            planned: facts
                .planned
                .iter()
                .map(|path| path.iter().map(point).collect())
                .collect(),
            errors: errors.collect(),
        }
    }
}

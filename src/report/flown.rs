//! A flight over its plan, for the page of a flight.

use serde::Serialize;

use super::documents::rounded;
use crate::geodesy::PlanPoint;

/// Most points of a chart of errors, for each vehicle.
const MOST_ERRORS: usize = 400;

/// How far a vehicle was from its plan at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlownError {
    /// Seconds after T0.
    pub t_s: f64,
    /// Beside the planned way, metres.
    pub cross_track_m: f64,
    /// Above it, metres; negative below.
    pub above_m: f64,
}

/// One vehicle's flight against its plans.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FlownFacts {
    /// Id in the spec.
    pub vehicle: String,
    /// The planned ways, one after the other.
    pub planned: Vec<Vec<PlanPoint>>,
    /// In order of time.
    pub errors: Vec<FlownError>,
}

/// What the views draw of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(super) struct FlownShape {
    /// Ways of places: east, north, altitude.
    pub(super) planned: Vec<Vec<[f64; 3]>>,
    /// Time, metres beside the way, metres above it.
    errors: Vec<[f64; 3]>,
}

impl FlownShape {
    pub(super) fn new(facts: &FlownFacts) -> Self {
        let metres = |value: f64| rounded(value, 10.0).unwrap_or(0.0);
        let place = |p: &PlanPoint| [metres(p.at.east_m), metres(p.at.north_m), metres(p.amsl.0)];
        let bucket = facts.errors.len().div_ceil(MOST_ERRORS).max(1);
        // The worst of each stretch of time, so that none is lost.
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
                .map(|way| way.iter().map(place).collect())
                .collect(),
            errors: errors.collect(),
        }
    }
}

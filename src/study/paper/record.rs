//! Results of one run: one line of JSON.

use serde::{Deserialize, Serialize};

use crate::cost::CostTerms;

/// One run of one contestant on one map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// Hash of the configuration.
    pub config: String,
    /// Name of the contestant.
    pub algorithm: String,
    /// Its protocol.
    pub protocol: String,
    /// Name of the map.
    pub scenario: String,
    /// Number of the run, from 0.
    pub run: usize,
    /// Its seed.
    pub seed: u64,
    /// Sum of the vehicles' totals as searched.
    pub total: f64,
    /// The same sum at 2001 samples.
    pub fine_total: f64,
    /// Whether every vehicle is safe.
    pub safe: bool,
    /// The vehicles.
    pub vehicles: Vec<VehicleRecord>,
}

/// One vehicle of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VehicleRecord {
    /// J of the paper at the samples of the search.
    pub total: f64,
    /// Its terms.
    pub terms: CostTerms,
    /// J at 2001 samples.
    pub fine_total: f64,
    /// Terms at 2001 samples; CH with the ground itself as limit.
    pub fine: CostTerms,
    /// Whether no limit is violated there.
    pub safe: bool,
    /// Evaluations spent.
    pub evaluations: usize,
    /// Control points: metres east, north and up.
    pub control_points: Vec<[f64; 3]>,
    /// Least J after each fiftieth of the evaluations.
    pub trace: Vec<f64>,
}

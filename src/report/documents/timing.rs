//! `timing.json`: what a plan took.

use schemars::JsonSchema;
use serde::Serialize;

/// What a plan took: `timing.json`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct TimingDocument {
    /// The seed of the plan.
    pub seed: u64,
    /// To read spec and terrain, seconds.
    pub read_s: f64,
    /// To plan and verify, seconds.
    pub plan_s: f64,
    /// Time of all processors, seconds; null where the system does not say.
    pub cpu_s: Option<f64>,
    /// Most memory, MiB; null where the system does not say.
    pub memory_mib: Option<f64>,
}

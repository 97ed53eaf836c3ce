//! How the mission is planned, written and flown, as YAML has it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::{Algorithm, AltitudeReference, Objective, Weights};

/// How paths are searched.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Planner {
    /// Which algorithm.
    pub algorithm: Algorithm,
    /// Which objective.
    pub objective: Objective,
    /// Seed of every random choice: the same seed gives the same files.
    pub seed: u64,
    /// Evaluations of the objective for each vehicle.
    #[schemars(range(min = 100, max = 100_000_000))]
    pub evaluations: u64,
    /// Free control points of the spline; absent: 16 for `msfoa`, 8 for the paper's algorithms
    /// and objective.
    #[schemars(range(min = 2, max = 30))]
    pub control_points: Option<u64>,
    /// Samples of the path in the objective.
    #[schemars(range(min = 11, max = 2001))]
    pub samples: u64,
    /// Factors on the terms of the objective.
    pub weights: Weights,
    /// Number of swarms; absent: the algorithm's own.
    #[schemars(range(min = 1, max = 1000))]
    pub swarms: Option<u64>,
    /// Flies in all; absent: the algorithm's own.
    #[schemars(range(min = 2, max = 1_000_000))]
    pub population: Option<u64>,
    /// Cost above which a swarm searches globally; absent: the algorithm's own.
    pub threshold: Option<f64>,
    /// Local step, as a fraction of the map; absent: the algorithm's own.
    #[schemars(range(min = 0.000_001, max = 1))]
    pub step: Option<f64>,
}

impl Default for Planner {
    fn default() -> Self {
        Self {
            algorithm: Algorithm::Msfoa,
            objective: Objective::Operational,
            seed: 1,
            evaluations: 40_000,
            control_points: None,
            samples: 101,
            weights: Weights::default(),
            swarms: None,
            population: None,
            threshold: None,
            step: None,
        }
    }
}

/// How paths become mission items.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MissionOptions {
    /// Reference of the altitudes in the items; terrain: not for px4.
    pub altitude: AltitudeReference,
    /// Furthest the waypoint legs may leave the planned path, metres.
    #[schemars(range(min = 0.1, max = 100))]
    pub tolerance_m: f64,
    /// Most items in one mission.
    #[schemars(range(min = 5, max = 60000))]
    pub max_items: u64,
    /// Whether a fence is written.
    pub fence: bool,
}

impl Default for MissionOptions {
    fn default() -> Self {
        Self {
            altitude: AltitudeReference::Amsl,
            tolerance_m: 5.0,
            max_items: 200,
            fence: true,
        }
    }
}

/// Distances that plan and verdict keep beyond the limits; each absent one is `all`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Buffers {
    /// Of every limit that has none of its own, metres; absent: the default of the autopilots
    /// and airframes.
    #[schemars(range(min = 0, max = 1000))]
    pub all: Option<f64>,
    /// Beyond the radius of threats, metres.
    #[schemars(range(min = 0, max = 1000))]
    pub threats: Option<f64>,
    /// Around no-fly zones, and over those with a height, metres.
    #[schemars(range(min = 0, max = 1000))]
    pub zones: Option<f64>,
    /// Inside the edge of the area, metres.
    #[schemars(range(min = 0, max = 1000))]
    pub area: Option<f64>,
    /// Above the least height over ground, metres.
    #[schemars(range(min = 0, max = 1000))]
    pub terrain: Option<f64>,
    /// Below the ceiling, metres.
    #[schemars(range(min = 0, max = 1000))]
    pub ceiling: Option<f64>,
    /// Over the separation of vehicles, horizontal and vertical, metres.
    #[schemars(range(min = 0, max = 1000))]
    pub separation: Option<f64>,
}

/// A steady wind.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wind {
    /// Direction it blows from, degrees clockwise from north.
    #[schemars(range(min = 0, max = 360))]
    pub from_deg: f64,
    /// Speed, m/s.
    #[schemars(range(min = 0, max = 50))]
    pub speed_mps: f64,
}

//! How the mission is planned, written and flown, as YAML has it.

use schemars::JsonSchema;
use serde::Deserialize;

/// How far apart vehicles stay.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(in crate::spec) struct Separation {
    /// Least distance at the same time, metres.
    #[schemars(range(min = 1, max = 50000))]
    pub(in crate::spec) distance_m: f64,
    /// Kept for every relative shift of departures up to this, seconds.
    #[schemars(range(min = 0, max = 3600))]
    pub(in crate::spec) time_slack_s: f64,
    /// With it, two vehicles conflict only if they are also less than this apart in height, metres.
    #[schemars(range(min = 1, max = 10000))]
    pub(in crate::spec) vertical_m: Option<f64>,
}

impl Default for Separation {
    fn default() -> Self {
        Self {
            distance_m: 100.0,
            time_slack_s: 5.0,
            vertical_m: None,
        }
    }
}

/// How paths are searched.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(in crate::spec) struct Planner {
    /// Which algorithm.
    pub(in crate::spec) algorithm: Algorithm,
    /// Which objective.
    pub(in crate::spec) objective: Objective,
    /// Seed of every random choice: the same seed gives the same files.
    pub(in crate::spec) seed: u64,
    /// Evaluations of the objective for each vehicle.
    #[schemars(range(min = 100, max = 100_000_000))]
    pub(in crate::spec) evaluations: u64,
    /// Free control points of the spline; absent: 16 for `msfoa`, 8 for the paper's algorithms
    /// and objective.
    #[schemars(range(min = 2, max = 30))]
    pub(in crate::spec) control_points: Option<u64>,
    /// Samples of the path in the objective.
    #[schemars(range(min = 11, max = 2001))]
    pub(in crate::spec) samples: u64,
    /// Factors on the terms of the objective.
    pub(in crate::spec) weights: Weights,
    /// Number of swarms; absent: the algorithm's own.
    #[schemars(range(min = 1, max = 1000))]
    pub(in crate::spec) swarms: Option<u64>,
    /// Flies in all; absent: the algorithm's own.
    #[schemars(range(min = 2, max = 1_000_000))]
    pub(in crate::spec) population: Option<u64>,
    /// Cost above which a swarm searches globally; absent: the algorithm's own.
    pub(in crate::spec) threshold: Option<f64>,
    /// Local step, as a fraction of the map; absent: the algorithm's own.
    #[schemars(range(min = 0.000_001, max = 1))]
    pub(in crate::spec) step: Option<f64>,
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

/// Factors on the terms of the objective; 1 means as designed.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(in crate::spec) struct Weights {
    /// Length.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub(in crate::spec) length: f64,
    /// Height above the minimum.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub(in crate::spec) altitude: f64,
    /// Threats, zones and area.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub(in crate::spec) threat: f64,
    /// Height below the minimum.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub(in crate::spec) terrain: f64,
    /// Turns beyond the limit.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub(in crate::spec) turn: f64,
    /// Slopes beyond the limit.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub(in crate::spec) climb: f64,
    /// Nearness to earlier vehicles.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub(in crate::spec) collision: f64,
}

impl Default for Weights {
    fn default() -> Self {
        Self {
            length: 1.0,
            altitude: 1.0,
            threat: 1.0,
            terrain: 1.0,
            turn: 1.0,
            climb: 1.0,
            collision: 1.0,
        }
    }
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::spec) enum Algorithm {
    Msfoa,
    MsfoaLiteral,
    MsfoaDwindle,
    Foa,
    Pso,
    De,
    Abc,
    Iffo,
    Mfoa,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(in crate::spec) enum Objective {
    Operational,
    Paper,
}

/// How paths become mission items.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(in crate::spec) struct MissionOptions {
    /// Reference of the altitudes in the items; terrain: not for px4.
    pub(in crate::spec) altitude: AltitudeReference,
    /// Furthest the waypoint legs may leave the planned path, metres.
    #[schemars(range(min = 0.1, max = 100))]
    pub(in crate::spec) tolerance_m: f64,
    /// Most items in one mission.
    #[schemars(range(min = 5, max = 60000))]
    pub(in crate::spec) max_items: u64,
    /// Whether a fence is written.
    pub(in crate::spec) fence: bool,
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

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(in crate::spec) enum AltitudeReference {
    Amsl,
    Relative,
    Terrain,
}

/// A steady wind.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::spec) struct Wind {
    /// Direction it blows from, degrees clockwise from north.
    #[schemars(range(min = 0, max = 360))]
    pub(in crate::spec) from_deg: f64,
    /// Speed, m/s.
    #[schemars(range(min = 0, max = 50))]
    pub(in crate::spec) speed_mps: f64,
}

#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(in crate::spec) enum OnLinkLoss {
    #[default]
    Continue,
    HoldAll,
    LandAll,
}

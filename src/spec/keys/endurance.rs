//! How long or how far a vehicle flies, as YAML has it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How long a vehicle flies on one battery or tank: exactly one of time_s, range_m and energy.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Endurance {
    /// Seconds from takeoff to touchdown.
    #[schemars(range(min = 1, max = 1_000_000))]
    pub time_s: Option<f64>,
    /// Metres through the air from takeoff to touchdown: over the ground where no wind blows.
    #[schemars(range(min = 1, max = 10_000_000))]
    pub range_m: Option<f64>,
    /// Energy on board and power drawn.
    pub energy: Option<Energy>,
    /// Share that must be left at touchdown; absent: 0.2.
    #[schemars(range(min = 0, max = 0.9))]
    pub reserve: Option<f64>,
}

/// The energy on board and what flying draws.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Energy {
    /// Energy on board, watt hours.
    #[schemars(required, range(min = 0.1, max = 1_000_000))]
    pub wh: Option<f64>,
    /// Power in a hover, watts. A plane needs none.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub hover_w: Option<f64>,
    /// Power while climbing at climb_mps, watts; absent: climbing draws no more.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub climb_w: Option<f64>,
    /// Power in level flight by speed through the air, ascending: pairs of m/s and watts.
    #[serde(default)]
    #[schemars(length(max = 100))]
    pub cruise: Vec<[f64; 2]>,
}

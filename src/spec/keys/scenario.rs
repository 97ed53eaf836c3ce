//! A scenario of the study, as YAML has it: `frame: local`, Cartesian.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Planner;

/// The whole file.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::spec) struct Scenario {
    #[schemars(range(min = 1, max = 1))]
    pub(in crate::spec) sortie: u32,
    pub(in crate::spec) name: String,
    #[serde(rename = "frame")]
    pub(in crate::spec) _frame: Frame,
    pub(in crate::spec) area: Box,
    pub(in crate::spec) terrain: Surface,
    #[serde(default)]
    pub(in crate::spec) threats: Vec<Cylinder>,
    pub(in crate::spec) vehicles: Vec<Mover>,
    pub(in crate::spec) planner: Planner,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(in crate::spec) enum Frame {
    Local,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::spec) struct Box {
    #[schemars(inner(range(min = -300_000, max = 300_000)))]
    pub(in crate::spec) east_m: [f64; 2],
    #[schemars(inner(range(min = -300_000, max = 300_000)))]
    pub(in crate::spec) north_m: [f64; 2],
    #[schemars(range(min = 0, max = 10_000))]
    pub(in crate::spec) min_agl_m: f64,
    #[schemars(range(min = -500, max = 20_000))]
    pub(in crate::spec) max_up_m: f64,
}

#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::spec) struct Surface {
    pub(in crate::spec) waves: Option<Waves>,
    #[serde(default)]
    pub(in crate::spec) peaks: Vec<Peak>,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::spec) struct Waves {
    #[schemars(range(min = 0, max = 9000))]
    pub(in crate::spec) height_m: f64,
    #[schemars(range(min = -1000, max = 1000))]
    pub(in crate::spec) a: f64,
    #[schemars(range(min = -1000, max = 1000))]
    pub(in crate::spec) b: f64,
    #[schemars(range(min = -1000, max = 1000))]
    pub(in crate::spec) c: f64,
    #[schemars(range(min = -1000, max = 1000))]
    pub(in crate::spec) d: f64,
    #[schemars(range(min = -1000, max = 1000))]
    pub(in crate::spec) e: f64,
    #[schemars(range(min = -1000, max = 1000))]
    pub(in crate::spec) f: f64,
    #[schemars(range(min = -1000, max = 1000))]
    pub(in crate::spec) g: f64,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::spec) struct Peak {
    #[schemars(range(min = -300_000, max = 300_000))]
    pub(in crate::spec) east_m: f64,
    #[schemars(range(min = -300_000, max = 300_000))]
    pub(in crate::spec) north_m: f64,
    #[schemars(range(min = 0, max = 9000))]
    pub(in crate::spec) height_m: f64,
    #[schemars(range(min = 1, max = 500_000))]
    pub(in crate::spec) width_east_m: f64,
    #[schemars(range(min = 1, max = 500_000))]
    pub(in crate::spec) width_north_m: f64,
}

#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::spec) struct Cylinder {
    pub(in crate::spec) id: String,
    pub(in crate::spec) kind: Option<String>,
    #[schemars(range(min = -300_000, max = 300_000))]
    pub(in crate::spec) east_m: f64,
    #[schemars(range(min = -300_000, max = 300_000))]
    pub(in crate::spec) north_m: f64,
    #[schemars(range(min = 1, max = 500_000))]
    pub(in crate::spec) radius_m: f64,
}

#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::spec) struct Mover {
    pub(in crate::spec) id: String,
    pub(in crate::spec) start: End,
    pub(in crate::spec) goal: End,
    #[schemars(range(min = 0.5, max = 1000))]
    pub(in crate::spec) speed_mps: f64,
    #[schemars(range(min = 1.001, max = 10))]
    pub(in crate::spec) max_load_factor: f64,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::spec) struct End {
    #[schemars(range(min = -300_000, max = 300_000))]
    pub(in crate::spec) east_m: f64,
    #[schemars(range(min = -300_000, max = 300_000))]
    pub(in crate::spec) north_m: f64,
    pub(in crate::spec) up_m: Option<f64>,
    pub(in crate::spec) agl_m: Option<f64>,
}

//! Tasks of a fleet as YAML has them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::StopAction;

mod areas;

pub use areas::{Camera, Corridor, Pattern, SearchArea, SearchPlace, SurveyArea};

/// A task for whichever copter can do it: exactly one of visit, deliver, survey, corridor and
/// search.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Task {
    /// Name, unique among the tasks.
    #[schemars(required, length(min = 1, max = 64))]
    pub id: Option<String>,
    /// A place to be visited.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub visit: Option<TaskPlace>,
    /// A delivery: one vehicle visits both places, from before to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub deliver: Option<Deliver>,
    /// An area to cover.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub survey: Option<SurveyArea>,
    /// A line to fly along, or a strip to cover.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub corridor: Option<Corridor>,
    /// A search pattern.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub search: Option<SearchArea>,
}

/// A delivery. Its vehicle may do other tasks in between.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Deliver {
    /// Where the load is picked up.
    #[schemars(with = "TaskPlace")]
    pub from: Option<TaskPlace>,
    /// Where it is dropped.
    #[schemars(with = "TaskPlace")]
    pub to: Option<TaskPlace>,
    /// When it may be dropped, seconds after T0; absent: at any time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window_s: Option<TaskWindow>,
}

/// From when until when a task may be begun, seconds after T0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TaskWindow {
    /// Not before; a vehicle that comes earlier waits.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub from: f64,
    /// Not after.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub to: f64,
}

/// A place of a task: with agl_m or with amsl_m, not both.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TaskPlace {
    /// Latitude, degrees north.
    #[schemars(required, range(min = -90, max = 90))]
    pub lat: Option<f64>,
    /// Longitude, degrees east.
    #[schemars(required, range(min = -180, max = 180))]
    pub lon: Option<f64>,
    /// Height above the ground there, metres. A copter comes straight down to a place below area.min_agl_m.
    #[schemars(range(min = 0, max = 20000))]
    pub agl_m: Option<f64>,
    /// Metres above mean sea level.
    #[schemars(range(min = -500, max = 20000))]
    pub amsl_m: Option<f64>,
    /// How long the vehicle stays there, seconds, rounded up to whole ones; absent: 1, to come to rest.
    #[schemars(range(min = 0, max = 3600))]
    pub hold_s: Option<f64>,
    /// What it does there, one after the other, at rest.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 20))]
    pub actions: Vec<StopAction>,
    /// When what is done there may begin, seconds after T0; absent: at any time. A delivery has its
    /// window beside from and to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window_s: Option<TaskWindow>,
}

//! Stops as a vehicle has them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::StopAction;

/// A place that a vehicle visits between start and goal: with agl_m or with amsl_m, not both.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stop {
    /// Name, unique among the stops of the vehicle.
    #[schemars(required, length(min = 1, max = 64))]
    pub id: Option<String>,
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
    /// How long it stays there, seconds, rounded up to whole ones; a plane or VTOL circles around it.
    /// Absent: a copter comes to rest for 1 s, the others fly past.
    #[schemars(range(min = 0, max = 3600))]
    pub hold_s: Option<f64>,
    /// How near it must come, metres; absent: mission.tolerance_m, and on planes and VTOLs 20 or more.
    #[schemars(range(min = 0.5, max = 100))]
    pub acceptance_radius_m: Option<f64>,
    /// Where the nose of a copter points while it stays there, 5 s at least, degrees clockwise from north.
    #[schemars(range(min = 0, max = 360))]
    pub heading_deg: Option<f64>,
    /// What it does there, one after the other, at rest and with its nose turned.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 20))]
    pub actions: Vec<StopAction>,
    /// Planned speed of a copter from there on, m/s.
    #[schemars(range(min = 0.5, max = 100))]
    pub speed_mps: Option<f64>,
}

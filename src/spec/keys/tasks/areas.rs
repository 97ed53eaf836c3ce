//! Areas to cover, corridors and search patterns as YAML has them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::keys::{Place, words};

/// An area to cover with parallel lines, by as many copters as it takes. Camera or `swath_m`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SurveyArea {
    /// Corners as [latitude, longitude], degrees, in order around it.
    #[schemars(required, length(min = 3, max = 1000))]
    pub polygon: Option<Vec<[f64; 2]>>,
    /// Polygons inside it that need not be seen.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub holes: Vec<Vec<[f64; 2]>>,
    /// What looks straight down.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<Camera>,
    /// Width of the ground that a sensor sees at agl_m, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 10000))]
    pub swath_m: Option<f64>,
    /// Share of a picture that the next one on the line shows again; absent: 0.7.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 0.95))]
    pub front_overlap: Option<f64>,
    /// Share of the width of a line that the next line shows again; absent: 0.6, with `swath_m` 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 0.95))]
    pub side_overlap: Option<f64>,
    /// Direction of the lines, degrees clockwise from north; absent: the cheapest one.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 360))]
    pub heading_deg: Option<f64>,
    /// Height of the lines above the ground, metres.
    #[schemars(required, range(min = 1, max = 20000))]
    pub agl_m: Option<f64>,
    /// Speed on the lines, m/s; absent: that of the vehicle.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.5, max = 100))]
    pub speed_mps: Option<f64>,
}

/// A line on the ground to fly along, or with a camera or `swath_m` a strip to cover.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Corridor {
    /// Its corners as [latitude, longitude], degrees, in order.
    #[schemars(required, length(min = 2, max = 100))]
    pub line: Option<Vec<[f64; 2]>>,
    /// Width of the strip, metres.
    #[schemars(required, range(min = 1, max = 10000))]
    pub width_m: Option<f64>,
    /// What looks straight down.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<Camera>,
    /// Width of the ground that a sensor sees at agl_m, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 10000))]
    pub swath_m: Option<f64>,
    /// Share of a picture that the next one on the line shows again; absent: 0.7.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 0.95))]
    pub front_overlap: Option<f64>,
    /// Share of the width of a line that the next line shows again; absent: 0.6, with `swath_m` 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 0.95))]
    pub side_overlap: Option<f64>,
    /// Height of the lines above the ground, metres.
    #[schemars(required, range(min = 1, max = 20000))]
    pub agl_m: Option<f64>,
    /// Speed on the lines, m/s; absent: that of the vehicle.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.5, max = 100))]
    pub speed_mps: Option<f64>,
}

/// A camera that looks straight down, its wider side across the line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Angles of view across and along the line, degrees: 1 to 170.
    #[schemars(required)]
    pub fov_deg: Option<[f64; 2]>,
}

/// A search pattern, flown by one copter (IAMSAR manual, volume II).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SearchArea {
    /// Which pattern.
    #[schemars(with = "Pattern")]
    pub pattern: Option<Pattern>,
    /// Where it begins: the datum of an expanding square or a sector search, the first corner of
    /// parallel tracks.
    #[schemars(with = "SearchPlace")]
    pub at: Option<SearchPlace>,
    /// Length of the first leg, metres; an expanding square grows by it, others keep it.
    #[schemars(required, range(min = 10, max = 100000))]
    pub leg_m: Option<f64>,
    /// Number of legs; of a sector search a multiple of 3.
    #[schemars(required, range(min = 1, max = 99))]
    pub legs: Option<i64>,
    /// Parallel tracks: distance between them, metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 10, max = 100000))]
    pub spacing_m: Option<f64>,
    /// Direction of the first leg, degrees clockwise from north; absent: 0. Turns are to the right.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 360))]
    pub heading_deg: Option<f64>,
    /// Speed on the legs, m/s; absent: that of the vehicle.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.5, max = 100))]
    pub speed_mps: Option<f64>,
}

/// Where a search pattern begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SearchPlace {
    /// Latitude, degrees north.
    #[schemars(required, range(min = -90, max = 90))]
    pub lat: Option<f64>,
    /// Longitude, degrees east.
    #[schemars(required, range(min = -180, max = 180))]
    pub lon: Option<f64>,
    /// Height of all legs above the ground, metres.
    #[schemars(required, range(min = 1, max = 20000))]
    pub agl_m: Option<f64>,
}

impl SearchPlace {
    pub(in crate::spec) fn place(self) -> Place {
        Place {
            lat: self.lat,
            lon: self.lon,
        }
    }
}

/// Which search pattern.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(transform = words)]
pub enum Pattern {
    /// Outward around the datum, each second leg longer by the first one.
    ExpandingSquare,
    /// Triangles that pass over the datum, turned by 120 degrees, and by 30 after each third.
    Sector,
    /// There and back, one track beside the other.
    ParallelTrack,
}

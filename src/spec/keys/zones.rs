//! Zones with a shape: a polygon or a circle, with a floor, a ceiling and times.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A zone that must not be entered between its floor and its ceiling, or must not be left.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShapedZone {
    /// Unique name.
    pub id: String,
    /// Corners as [latitude, longitude], degrees, in order around it; this or circle.
    #[schemars(length(min = 3, max = 1000))]
    pub polygon: Option<Vec<[f64; 2]>>,
    /// A circle; this or polygon.
    pub circle: Option<Circle>,
    /// Polygons inside the polygon that do not belong to the zone.
    #[serde(default)]
    pub holes: Vec<Vec<[f64; 2]>>,
    /// Lower limit; absent: the ground.
    pub floor: Option<Height>,
    /// Upper limit; absent: unlimited.
    pub ceiling: Option<Height>,
    /// When it is closed; absent, or without t0 in the spec: always.
    pub active: Option<Active>,
    /// The zone must not be left: vehicles stay in the union of all such zones.
    #[serde(default)]
    pub keep_in: bool,
}

/// A circle on the ground.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Circle {
    /// Latitude of the centre, degrees north.
    #[schemars(range(min = -90, max = 90))]
    pub lat: f64,
    /// Longitude of the centre, degrees east.
    #[schemars(range(min = -180, max = 180))]
    pub lon: f64,
    /// Radius, metres.
    #[schemars(range(min = 1, max = 500_000))]
    pub radius_m: f64,
}

/// A vertical limit: exactly one of the keys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("minProperties" = 1, "maxProperties" = 1))]
pub struct Height {
    /// Metres above mean sea level.
    #[schemars(range(min = -500, max = 100_000))]
    pub amsl_m: Option<f64>,
    /// Metres above the ground.
    #[schemars(range(min = 0, max = 100_000))]
    pub agl_m: Option<f64>,
    /// Flight level: hundreds of feet of pressure altitude. Needs qnh_hpa.
    #[schemars(range(min = 0, max = 660))]
    pub fl: Option<f64>,
}

/// A period; both times with an offset from UTC (RFC 3339).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Active {
    /// Active from this time; absent: from the beginning.
    pub from: Option<String>,
    /// Active until this time; absent: without end.
    pub to: Option<String>,
}

/// Range of QNH expected on the day, hPa.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Qnh {
    /// Lowest QNH, hPa.
    #[schemars(range(min = 850, max = 1100))]
    pub min: f64,
    /// Highest QNH, hPa.
    #[schemars(range(min = 850, max = 1100))]
    pub max: f64,
}

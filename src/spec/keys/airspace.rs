//! Zones and obstacles that stand in files of their own.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A file of airspace.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AirspaceFile {
    /// Its path relative to this file: .geojson and .json (GeoJSON, ED-318, ED-269), .kml, .kmz, .txt and .openair (OpenAir), .plan and .waypoints (their fences).
    pub file: String,
    /// Distance kept from its zones, metres.
    #[schemars(range(min = 0, max = 100_000))]
    pub buffer_m: Option<f64>,
    /// Only these of its zones; absent: all.
    pub only: Option<Only>,
    /// Names of zones that are left out, also of those that cannot be read.
    #[serde(default)]
    pub skip: Vec<String>,
}

/// Which zones of a file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Only {
    /// Classes or types, as the file writes them: C, D, CTR, PROHIBITED.
    pub class: Vec<String>,
}

/// A file of obstacles over the terrain.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObstacleFile {
    /// Its path relative to this file: .csv with the columns lat, lon, height_m and radius_m, .csv with WKT in place of lat and lon, or .geojson, both with these properties: points are masts, lines are wires, as high as the higher of the tops at the ends of each span (radius_m: half their width; heights_m: a height for each vertex), polygons are buildings.
    pub file: String,
}

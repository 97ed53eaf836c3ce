//! The keys of a spec as the file has them: names, units and shapes, unchecked.
//!
//! The JSON Schema is made of these structs: their doc comments are its descriptions, their
//! `range` attributes are the ranges that `check` enforces. A key that must be
//! given is an `Option` with the attribute `required`; the check reports where it is missing.

mod actions;
mod airspace;
mod endurance;
mod fleet;
mod on_alarm;
mod options;
mod scenario;
pub(super) mod schema;
mod stops;
mod tasks;
mod vehicle;
mod zones;

pub use actions::{
    Gimbal, Gripper, PayloadPlace, Photo, Relay, RoiNone, Servo, StopAction, Video, Winch,
};
pub use airspace::{AirspaceFile, ObstacleFile, Only};
pub use endurance::{Endurance, Energy};
pub use fleet::{Fleet, Grid};
pub use on_alarm::{Action, AlarmKind, Answer, OnAlarm, Who};
pub use options::{Buffers, MissionOptions, Planner, Wind};
pub(super) use scenario::{Cylinder, End, Mover, Scenario, Surface};
pub use stops::Stop;
pub use tasks::{
    Camera, Corridor, Deliver, Pattern, SearchArea, SearchPlace, SurveyArea, Task, TaskPlace,
    TaskWindow,
};
pub use vehicle::{EndPoint, Landing, OnboardCamera, SpeedRange, Station, Vehicle, Window};
pub use zones::{Active, Circle, Height, Qnh, ShapedZone};

use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{OnLinkLoss, Separation};
use crate::geodesy::LatLon;

/// One mission for a fleet of UAVs, for `sortie plan`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(
    title = "Sortie mission",
    extend("anyOf" = [{"required": ["vehicles"]}, {"required": ["fleet"]}])
)]
pub struct Spec {
    /// Version of this format: 2, or 1, which has no buffers.
    #[schemars(range(min = 1, max = 2))]
    pub sortie: u32,
    /// Name of the mission and of its output folder: letters, digits, - and _.
    #[schemars(length(min = 1, max = 64))]
    pub name: String,
    /// Where the local frame touches the earth; absent: the middle of the area.
    pub origin: Option<Place>,
    /// Where flying is allowed.
    pub area: Area,
    /// Where the ground comes from.
    pub terrain: Terrain,
    /// Vertical cylinders of infinite height that must not be entered.
    #[serde(default)]
    pub threats: Vec<Threat>,
    /// Polygons that must not be entered.
    #[serde(default)]
    pub no_fly: Vec<Zone>,
    /// The wider form of no_fly: circles, holes, floors, ceilings, times, and zones to stay in.
    #[serde(default)]
    pub zones: Vec<ShapedZone>,
    /// Files of airspace, whose zones count like those of zones.
    #[serde(default)]
    pub airspace: Vec<AirspaceFile>,
    /// Files of obstacles that stand on the terrain.
    #[serde(default)]
    pub obstacles: Vec<ObstacleFile>,
    /// The air pressure that is possible on the day; needed where a zone has a flight level.
    pub qnh_hpa: Option<Qnh>,
    /// The real time of T0, with an offset from UTC (RFC 3339); absent: zones are always active.
    pub t0: Option<String>,
    /// Rally points.
    #[serde(default)]
    pub rally: Vec<Rally>,
    /// The vehicles, in order of priority.
    #[serde(default)]
    pub vehicles: Vec<Vehicle>,
    /// More vehicles, in a compact form.
    pub fleet: Option<Fleet>,
    /// Tasks for whichever copters can do them; version 2.
    #[serde(default)]
    pub tasks: Vec<Task>,
    /// How far apart vehicles stay from takeoff to touchdown.
    #[serde(default)]
    pub separation: Separation,
    /// What plan and verdict keep beyond each limit, for errors of position and control; absent:
    /// the default of the autopilots and airframes, at least 10 m. Version 1 has none.
    pub buffer_m: Option<Buffers>,
    /// How paths are searched.
    #[serde(default)]
    pub planner: Planner,
    /// How paths become mission items.
    #[serde(default)]
    pub mission: MissionOptions,
    /// A steady wind; absent: none is assumed.
    pub wind: Option<Wind>,
    /// What the fleet does when the link to one vehicle is lost; absent: continue.
    #[serde(default)]
    pub on_link_loss: OnLinkLoss,
    /// What is done at alarms in flight.
    #[serde(default)]
    pub on_alarm: OnAlarm,
}

/// A place on the earth, WGS84.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Place {
    /// Latitude, degrees north.
    #[schemars(required, range(min = -90, max = 90))]
    pub lat: Option<f64>,
    /// Longitude, degrees east.
    #[schemars(required, range(min = -180, max = 180))]
    pub lon: Option<f64>,
}

impl Place {
    /// A place by its latitude and longitude, degrees.
    #[must_use]
    pub fn new(lat: f64, lon: f64) -> Self {
        Self {
            lat: Some(lat),
            lon: Some(lon),
        }
    }
}

impl From<LatLon> for Place {
    fn from(place: LatLon) -> Self {
        Self {
            lat: Some(place.lat_deg),
            lon: Some(place.lon_deg),
        }
    }
}

/// A box of latitude, longitude and altitude.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Area {
    /// South-west corner.
    pub south_west: Place,
    /// North-east corner.
    pub north_east: Place,
    /// Least height above ground but for the columns of takeoff and landing, metres.
    #[schemars(range(min = 0, max = 10000))]
    pub min_agl_m: f64,
    /// Ceiling, metres above mean sea level.
    #[schemars(range(min = -500, max = 20000))]
    pub max_amsl_m: f64,
    /// Greatest height above ground, everywhere, metres; absent: none.
    #[schemars(range(min = 1, max = 10000))]
    pub max_agl_m: Option<f64>,
    /// Least altitude from start to goal, metres above mean sea level; absent: none.
    #[schemars(range(min = -500, max = 20000))]
    pub min_amsl_m: Option<f64>,
}

impl Area {
    /// An area by its corners, the least height above ground and the ceiling, metres.
    #[must_use]
    pub fn new(south_west: Place, north_east: Place, min_agl_m: f64, max_amsl_m: f64) -> Self {
        Self {
            south_west,
            north_east,
            min_agl_m,
            max_amsl_m,
            max_agl_m: None,
            min_amsl_m: None,
        }
    }
}

/// Where the ground comes from: exactly one of the keys.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("minProperties" = 1, "maxProperties" = 1))]
pub struct Terrain {
    /// An elevation file, its path relative to this one: SRTM .hgt, .hgt.gz or .hgt.zip, GeoTIFF, an ASCII grid (.asc) with its .prj, or a Terrarium tile such as 12/2145/1434.png.
    pub file: Option<String>,
    /// A folder of such files, used as one; its path relative to this file.
    pub folder: Option<String>,
    /// The same height everywhere.
    pub flat: Option<Flat>,
    /// Gaussian hills over a base.
    pub analytic: Option<Analytic>,
}

impl Terrain {
    /// The same height everywhere, metres above mean sea level.
    #[must_use]
    pub fn flat(amsl_m: f64) -> Self {
        Self {
            flat: Some(Flat { amsl_m }),
            ..Self::default()
        }
    }
}

/// The same height everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Flat {
    /// Metres above mean sea level.
    #[schemars(range(min = -500, max = 20000))]
    pub amsl_m: f64,
}

/// Gaussian hills over a base.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Analytic {
    /// Height far from every hill, metres above mean sea level.
    #[schemars(range(min = -500, max = 9000))]
    pub base_amsl_m: f64,
    /// The hills.
    #[serde(default)]
    pub hills: Vec<Hill>,
}

/// A hill: height * exp(-(distance / radius)^2).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hill {
    /// Latitude of the summit, degrees north.
    #[schemars(range(min = -90, max = 90))]
    pub lat: f64,
    /// Longitude of the summit, degrees east.
    #[schemars(range(min = -180, max = 180))]
    pub lon: f64,
    /// Height over the base, metres; negative for a hollow.
    #[schemars(range(min = -9000, max = 9000))]
    pub height_m: f64,
    /// Where the height has fallen to 1/e, metres.
    #[schemars(range(min = 1, max = 500_000))]
    pub radius_m: f64,
}

/// What of space a threat takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[schemars(transform = words)]
pub enum ThreatShape {
    /// Every height within the radius.
    #[default]
    Cylinder,
    /// Up to the radius over the ground at the place, and less beside it: a half sphere.
    Dome,
}

/// A vertical cylinder of infinite height, or a dome.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Threat {
    /// Unique name.
    pub id: String,
    /// A label such as radar; without meaning to the planner.
    pub kind: Option<String>,
    /// Latitude of the axis, degrees north.
    #[schemars(range(min = -90, max = 90))]
    pub lat: f64,
    /// Longitude of the axis, degrees east.
    #[schemars(range(min = -180, max = 180))]
    pub lon: f64,
    /// Radius, metres.
    #[schemars(range(min = 1, max = 500_000))]
    pub radius_m: f64,
    /// Cylinder or dome; absent: a cylinder.
    pub shape: Option<ThreatShape>,
}

/// A polygon that must not be entered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Zone {
    /// Unique name.
    pub id: String,
    /// Corners as [latitude, longitude], degrees, in order around it.
    #[schemars(length(min = 3, max = 1000))]
    pub polygon: Vec<[f64; 2]>,
    /// Closed below this only, metres above mean sea level; absent: at all heights.
    #[schemars(range(min = -500, max = 20000))]
    pub below_amsl_m: Option<f64>,
}

/// A rally point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rally {
    /// Latitude, degrees north.
    #[schemars(range(min = -90, max = 90))]
    pub lat: f64,
    /// Longitude, degrees east.
    #[schemars(range(min = -180, max = 180))]
    pub lon: f64,
    /// Height above the ground there, metres.
    #[schemars(range(min = 0, max = 20000))]
    pub agl_m: f64,
}

/// Schema of an enum of words: the words alone, without the description of each.
pub(super) fn words(schema: &mut Schema) {
    let word = |value: &Value| value.get("const").cloned();
    if let Some(Value::Array(variants)) = schema.remove("oneOf") {
        let words: Vec<Value> = variants.iter().filter_map(word).collect();
        schema.insert("type".to_owned(), "string".into());
        schema.insert("enum".to_owned(), words.into());
        schema.remove("description");
    }
}

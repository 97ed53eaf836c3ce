//! The spec as YAML has it: names, units and shapes of the file, nothing checked
//! beyond types. The JSON Schema is made from these structs, and their doc
//! comments are its descriptions.

mod fleet;
mod options;
mod scenario;
mod vehicle;

pub(super) use fleet::{Defaults, End as PartOfEnd, Fleet, Grid};
pub(super) use options::{
    Algorithm, AltitudeReference, MissionOptions, Objective, OnLinkLoss, Planner, Separation, Wind,
};
pub(super) use scenario::{Cylinder, End, Mover, Scenario, Surface};
pub(super) use vehicle::{EndPoint, Finish, Landing, SpeedRange, Vehicle, Window};

use schemars::JsonSchema;
use serde::Deserialize;

/// One mission for a fleet of UAVs, for `sortie plan`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(
    title = "Sortie mission",
    extend("anyOf" = [{"required": ["vehicles"]}, {"required": ["fleet"]}])
)]
pub(super) struct Spec {
    /// Version of this format: 1.
    #[schemars(range(min = 1, max = 1))]
    pub(super) sortie: u32,
    /// Name of the mission and of its output folder: letters, digits, - and _.
    #[schemars(length(min = 1, max = 64))]
    pub(super) name: String,
    /// Where the local frame touches the earth; absent: the middle of the area.
    pub(super) origin: Option<Place>,
    /// Where flying is allowed.
    pub(super) area: Area,
    /// Where the ground comes from.
    pub(super) terrain: Terrain,
    /// Vertical cylinders of infinite height that must not be entered.
    #[serde(default)]
    pub(super) threats: Vec<Threat>,
    /// Polygons that must not be entered.
    #[serde(default)]
    pub(super) no_fly: Vec<Zone>,
    /// Rally points.
    #[serde(default)]
    pub(super) rally: Vec<Rally>,
    /// The vehicles, in order of priority.
    #[serde(default)]
    pub(super) vehicles: Vec<Vehicle>,
    /// More vehicles, in a compact form.
    pub(super) fleet: Option<Fleet>,
    /// How far apart vehicles stay from takeoff to touchdown.
    #[serde(default)]
    pub(super) separation: Separation,
    /// How paths are searched.
    #[serde(default)]
    pub(super) planner: Planner,
    /// How paths become mission items.
    #[serde(default)]
    pub(super) mission: MissionOptions,
    /// A steady wind; absent: none is assumed.
    pub(super) wind: Option<Wind>,
    /// What the fleet does when the link to one vehicle is lost; absent: continue.
    #[serde(default)]
    pub(super) on_link_loss: OnLinkLoss,
}

/// A place on the earth, WGS84.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Place {
    /// Latitude, degrees north.
    #[schemars(range(min = -90, max = 90))]
    pub(super) lat: f64,
    /// Longitude, degrees east.
    #[schemars(range(min = -180, max = 180))]
    pub(super) lon: f64,
}

/// A box of latitude, longitude and altitude.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Area {
    /// South-west corner.
    pub(super) south_west: Place,
    /// North-east corner.
    pub(super) north_east: Place,
    /// Least height above ground but for the columns of takeoff and landing, metres.
    #[schemars(range(min = 0, max = 10000))]
    pub(super) min_agl_m: f64,
    /// Ceiling, metres above mean sea level.
    #[schemars(range(min = -500, max = 20000))]
    pub(super) max_amsl_m: f64,
}

/// Where the ground comes from: exactly one of the keys.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("minProperties" = 1, "maxProperties" = 1))]
pub(super) struct Terrain {
    /// An elevation file beside this one: SRTM .hgt, .hgt.gz or .hgt.zip, or GeoTIFF in EPSG:4326.
    pub(super) file: Option<String>,
    /// A folder of such files beside this one, used as one.
    pub(super) folder: Option<String>,
    /// The same height everywhere.
    pub(super) flat: Option<Flat>,
    /// Gaussian hills over a base.
    pub(super) analytic: Option<Analytic>,
}

/// The same height everywhere.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Flat {
    /// Metres above mean sea level.
    #[schemars(range(min = -500, max = 20000))]
    pub(super) amsl_m: f64,
}

/// Gaussian hills over a base.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Analytic {
    /// Height far from every hill, metres above mean sea level.
    #[schemars(range(min = -500, max = 9000))]
    pub(super) base_amsl_m: f64,
    /// The hills.
    #[serde(default)]
    pub(super) hills: Vec<Hill>,
}

/// A hill: height * exp(-(distance / radius)^2).
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Hill {
    /// Latitude of the summit, degrees north.
    #[schemars(range(min = -90, max = 90))]
    pub(super) lat: f64,
    /// Longitude of the summit, degrees east.
    #[schemars(range(min = -180, max = 180))]
    pub(super) lon: f64,
    /// Height over the base, metres; negative for a hollow.
    #[schemars(range(min = -9000, max = 9000))]
    pub(super) height_m: f64,
    /// Where the height has fallen to 1/e, metres.
    #[schemars(range(min = 1, max = 500_000))]
    pub(super) radius_m: f64,
}

/// A vertical cylinder of infinite height.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Threat {
    /// Unique name.
    pub(super) id: String,
    /// A label such as radar; without meaning to the planner.
    pub(super) kind: Option<String>,
    /// Latitude of the axis, degrees north.
    #[schemars(range(min = -90, max = 90))]
    pub(super) lat: f64,
    /// Longitude of the axis, degrees east.
    #[schemars(range(min = -180, max = 180))]
    pub(super) lon: f64,
    /// Radius, metres.
    #[schemars(range(min = 1, max = 500_000))]
    pub(super) radius_m: f64,
}

/// A polygon that must not be entered.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Zone {
    /// Unique name.
    pub(super) id: String,
    /// Corners as [latitude, longitude], degrees, in order around it.
    #[schemars(length(min = 3, max = 1000))]
    pub(super) polygon: Vec<[f64; 2]>,
    /// Closed below this only, metres above mean sea level; absent: at all heights.
    #[schemars(range(min = -500, max = 20000))]
    pub(super) below_amsl_m: Option<f64>,
}

/// A rally point.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Rally {
    /// Latitude, degrees north.
    #[schemars(range(min = -90, max = 90))]
    pub(super) lat: f64,
    /// Longitude, degrees east.
    #[schemars(range(min = -180, max = 180))]
    pub(super) lon: f64,
    /// Height above the ground there, metres.
    #[schemars(range(min = 0, max = 20000))]
    pub(super) agl_m: f64,
}

//! The spec as YAML has it: names, units and shapes of the file, nothing checked
//! beyond types. The JSON Schema is made from these structs, and their doc
//! comments are its descriptions.

use schemars::JsonSchema;
use serde::Deserialize;

/// One mission for a fleet of UAVs, for `sortie plan`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Sortie mission")]
pub(super) struct RawSpec {
    /// Version of this format: 1.
    #[schemars(range(min = 1, max = 1))]
    pub(super) sortie: u32,
    /// Name of the mission and of its output folder: letters, digits, - and _.
    #[schemars(length(min = 1, max = 64))]
    pub(super) name: String,
    /// Where the local frame touches the earth; absent: the middle of the area.
    pub(super) origin: Option<RawPlace>,
    /// Where flying is allowed.
    pub(super) area: RawArea,
    /// Where the ground comes from.
    pub(super) terrain: RawTerrain,
    /// Vertical cylinders of infinite height that must not be entered.
    #[serde(default)]
    pub(super) threats: Vec<RawThreat>,
    /// Polygons that must not be entered.
    #[serde(default)]
    pub(super) no_fly: Vec<RawZone>,
    /// Rally points.
    #[serde(default)]
    pub(super) rally: Vec<RawRally>,
    /// The fleet, in order of priority.
    #[schemars(length(min = 1))]
    pub(super) vehicles: Vec<RawVehicle>,
    /// How far apart vehicles stay from takeoff to touchdown.
    #[serde(default)]
    pub(super) separation: RawSeparation,
    /// How paths are searched.
    #[serde(default)]
    pub(super) planner: RawPlanner,
    /// How paths become mission items.
    #[serde(default)]
    pub(super) mission: RawMission,
    /// A steady wind; absent: none is assumed.
    pub(super) wind: Option<RawWind>,
    /// What the fleet does when the link to one vehicle is lost; absent: continue.
    #[serde(default)]
    pub(super) on_link_loss: RawOnLinkLoss,
}

/// A place on the earth, WGS84.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RawPlace {
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
pub(super) struct RawArea {
    /// South-west corner.
    pub(super) south_west: RawPlace,
    /// North-east corner.
    pub(super) north_east: RawPlace,
    /// Least height above ground from start to goal, metres.
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
pub(super) struct RawTerrain {
    /// An elevation file beside this one: SRTM .hgt, or GeoTIFF in EPSG:4326.
    pub(super) file: Option<String>,
    /// The same height everywhere.
    pub(super) flat: Option<RawFlat>,
    /// Gaussian hills over a base.
    pub(super) analytic: Option<RawAnalytic>,
}

/// The same height everywhere.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RawFlat {
    /// Metres above mean sea level.
    #[schemars(range(min = -500, max = 20000))]
    pub(super) amsl_m: f64,
}

/// Gaussian hills over a base.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RawAnalytic {
    /// Height far from every hill, metres above mean sea level.
    #[schemars(range(min = -500, max = 9000))]
    pub(super) base_amsl_m: f64,
    /// The hills.
    #[serde(default)]
    pub(super) hills: Vec<RawHill>,
}

/// A hill: height * exp(-(distance / radius)^2).
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RawHill {
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
pub(super) struct RawThreat {
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
pub(super) struct RawZone {
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
pub(super) struct RawRally {
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

/// A place in the air: with agl_m or with amsl_m, not both.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("minProperties" = 3, "maxProperties" = 3))]
pub(super) struct RawEndPoint {
    /// Latitude, degrees north.
    #[schemars(range(min = -90, max = 90))]
    pub(super) lat: f64,
    /// Longitude, degrees east.
    #[schemars(range(min = -180, max = 180))]
    pub(super) lon: f64,
    /// Height above the ground there, metres.
    #[schemars(range(min = 0, max = 20000))]
    pub(super) agl_m: Option<f64>,
    /// Metres above mean sea level.
    #[schemars(range(min = -500, max = 20000))]
    pub(super) amsl_m: Option<f64>,
}

/// One vehicle.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RawVehicle {
    /// Unique name; its files begin with it: letters, digits, - and _.
    #[schemars(length(min = 1, max = 64))]
    pub(super) id: String,
    /// MAVLink system id, unique.
    #[schemars(range(min = 1, max = 255))]
    pub(super) sysid: i64,
    /// Which autopilot reads the mission.
    pub(super) autopilot: RawAutopilot,
    /// What flies; absent: copter.
    #[serde(default)]
    pub(super) airframe: RawAirframe,
    /// How to reach it: sim, udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT or serial:DEVICE:BAUD.
    pub(super) link: String,
    /// Where it stands, on the ground; absent: under start.
    pub(super) home: Option<RawPlace>,
    /// The planned path begins here, airborne.
    pub(super) start: RawEndPoint,
    /// The planned path ends here, airborne.
    pub(super) goal: RawEndPoint,
    /// At the goal: land; loiter there for ever; or return along a planned path and land at home.
    pub(super) finish: RawFinish,
    /// Planned ground speed, m/s.
    #[schemars(range(min = 0.5, max = 100))]
    pub(super) speed_mps: f64,
    /// Turn overload n; the turn radius is v^2 / (g sqrt(n^2 - 1)). Absent: 1.15, a bank of 30 degrees.
    #[schemars(range(min = 1.001, max = 10))]
    pub(super) max_load_factor: Option<f64>,
    /// Steepest climb, degrees; absent: the slope polynomial of the paper.
    #[schemars(range(min = 0.1, max = 89))]
    pub(super) max_climb_deg: Option<f64>,
    /// Steepest descent, degrees, positive; absent: the slope polynomial of the paper.
    #[schemars(range(min = 0.1, max = 89))]
    pub(super) max_descent_deg: Option<f64>,
    /// Vertical speed up, m/s; absent: the autopilot's default.
    #[schemars(range(min = 0.1, max = 50))]
    pub(super) climb_mps: Option<f64>,
    /// Vertical speed down, m/s, positive; absent: the autopilot's default.
    #[schemars(range(min = 0.1, max = 50))]
    pub(super) descent_mps: Option<f64>,
    /// Horizontal acceleration, m/s^2; absent: the autopilot's default.
    #[schemars(range(min = 0.1, max = 50))]
    pub(super) accel_mps2: Option<f64>,
    /// Takeoff starts this long after the fleet's T0, seconds; absent: 0.
    #[schemars(range(min = 0, max = 86400))]
    pub(super) depart_s: Option<f64>,
    /// Only with it may the autopilot's own return be written: its altitude, metres above mean sea level.
    #[schemars(range(min = -500, max = 20000))]
    pub(super) return_amsl_m: Option<f64>,
    /// Planes and vtol: direction of takeoff, degrees clockwise from north.
    #[schemars(range(min = 0, max = 360))]
    pub(super) takeoff_heading_deg: Option<f64>,
    /// Planes and vtol: how it lands.
    pub(super) landing: Option<RawLanding>,
    /// Planes and vtol: radius of circling, metres.
    #[schemars(range(min = 1, max = 10000))]
    pub(super) loiter_radius_m: Option<f64>,
}

/// How a plane lands.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[expect(dead_code, reason = "part of the format; read when planes fly")]
pub(super) struct RawLanding {
    /// Direction of the approach, degrees clockwise from north.
    #[schemars(range(min = 0, max = 360))]
    pub(super) heading_deg: f64,
    /// Angle of the glide, degrees.
    #[schemars(range(min = 1, max = 30))]
    pub(super) glide_deg: f64,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum RawAutopilot {
    ArduPilot,
    Px4,
}

#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum RawAirframe {
    #[default]
    Copter,
    Plane,
    Vtol,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum RawFinish {
    Land,
    Loiter,
    Return,
}

#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum RawOnLinkLoss {
    #[default]
    Continue,
    HoldAll,
    LandAll,
}

/// How far apart vehicles stay.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawSeparation {
    /// Least distance at the same time, metres.
    #[schemars(range(min = 1, max = 50000))]
    pub(super) distance_m: f64,
    /// Kept for every relative shift of departures up to this, seconds.
    #[schemars(range(min = 0, max = 3600))]
    pub(super) time_slack_s: f64,
    /// With it, two vehicles conflict only if they are also less than this apart in height, metres.
    #[schemars(range(min = 1, max = 10000))]
    pub(super) vertical_m: Option<f64>,
}

impl Default for RawSeparation {
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
pub(super) struct RawPlanner {
    /// Which algorithm.
    pub(super) algorithm: RawAlgorithm,
    /// Which objective.
    pub(super) objective: RawObjective,
    /// Seed of every random choice: the same seed gives the same files.
    pub(super) seed: u64,
    /// Evaluations of the objective for each vehicle.
    #[schemars(range(min = 100, max = 100_000_000))]
    pub(super) evaluations: u64,
    /// Free control points of the spline.
    #[schemars(range(min = 2, max = 30))]
    pub(super) control_points: u64,
    /// Samples of the path in the objective.
    #[schemars(range(min = 11, max = 2001))]
    pub(super) samples: u64,
    /// Factors on the terms of the objective.
    pub(super) weights: RawWeights,
    /// Number of swarms; absent: the algorithm's own.
    #[schemars(range(min = 1, max = 1000))]
    pub(super) swarms: Option<u64>,
    /// Flies in all; absent: the algorithm's own.
    #[schemars(range(min = 2, max = 1_000_000))]
    pub(super) population: Option<u64>,
    /// Cost above which a swarm searches globally; absent: the algorithm's own.
    pub(super) threshold: Option<f64>,
    /// Local step, as a fraction of the map; absent: the algorithm's own.
    #[schemars(range(min = 0.000_001, max = 1))]
    pub(super) step: Option<f64>,
}

impl Default for RawPlanner {
    fn default() -> Self {
        Self {
            algorithm: RawAlgorithm::Msfoa,
            objective: RawObjective::Operational,
            seed: 1,
            evaluations: 40_000,
            control_points: 8,
            samples: 101,
            weights: RawWeights::default(),
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
pub(super) struct RawWeights {
    /// Length.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub(super) length: f64,
    /// Height above the minimum.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub(super) altitude: f64,
    /// Threats, zones and area.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub(super) threat: f64,
    /// Height below the minimum.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub(super) terrain: f64,
    /// Turns beyond the limit.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub(super) turn: f64,
    /// Slopes beyond the limit.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub(super) climb: f64,
    /// Nearness to earlier vehicles.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub(super) collision: f64,
}

impl Default for RawWeights {
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
pub(super) enum RawAlgorithm {
    Msfoa,
    MsfoaLiteral,
    MsfoaDwindle,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum RawObjective {
    Operational,
    Paper,
}

/// How paths become mission items.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RawMission {
    /// Reference of the altitudes in the items; terrain: not for px4.
    pub(super) altitude: RawAltitude,
    /// Furthest the waypoint legs may leave the planned path, metres.
    #[schemars(range(min = 0.1, max = 1000))]
    pub(super) tolerance_m: f64,
    /// Most items in one mission.
    #[schemars(range(min = 5, max = 60000))]
    pub(super) max_items: u64,
    /// Whether a fence is written.
    pub(super) fence: bool,
}

impl Default for RawMission {
    fn default() -> Self {
        Self {
            altitude: RawAltitude::Amsl,
            tolerance_m: 5.0,
            max_items: 200,
            fence: true,
        }
    }
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum RawAltitude {
    Amsl,
    Relative,
    Terrain,
}

/// A steady wind.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RawWind {
    /// Direction it blows from, degrees clockwise from north.
    #[schemars(range(min = 0, max = 360))]
    pub(super) from_deg: f64,
    /// Speed, m/s.
    #[schemars(range(min = 0, max = 50))]
    pub(super) speed_mps: f64,
}

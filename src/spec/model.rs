//! The checked spec. A [`MissionSpec`] holds values that passed every check without the ground.

mod buffers;
mod elevation;
mod sweep;
mod task;

pub(crate) use buffers::BufferedLimit;
pub use buffers::Buffers;
pub use elevation::{ELEVATION_ENDINGS, elevation_command};
pub use sweep::{SearchPattern, Sensor, Sweep, SweepShape};
pub use task::{MAX_TASKS, Task};

use std::ops::RangeInclusive;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::autopilot::Airframe;
use crate::geodesy::{Agl, Amsl, LatLon, LocalFrame};

use super::airspace::Zone;
use super::keys::{Action, Answer, OnAlarm, Who, words};
use super::vehicle::{AltitudeLimits, Vehicle};
use super::wind::Wind;

/// One mission for a fleet, checked and in SI units. Positions stay geodetic;
/// [`MissionSpec::frame`] takes them to planning coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct MissionSpec {
    /// Version of the format: 1, which has no buffers, or 2.
    pub version: u32,
    /// Name of the mission, and of its output folder.
    pub name: String,
    /// The local frame at `origin` (default: the middle of the area).
    pub frame: LocalFrame,
    /// Where flying is allowed.
    pub area: Area,
    /// Where the ground comes from.
    pub terrain: TerrainSource,
    /// Cylinders of infinite height that must not be entered.
    pub threats: Vec<Threat>,
    /// What must not be entered: `no_fly`, then `zones`, those of files, and obstacles.
    pub no_fly: Vec<Zone>,
    /// Rally points.
    pub rally: Vec<Rally>,
    /// The fleet, in order of priority.
    pub vehicles: Vec<Vehicle>,
    /// Tasks for whichever of its copters can do them.
    pub tasks: Vec<Task>,
    /// How far apart vehicles must stay; [`MissionSpec::buffered_separation`] has the buffer.
    pub separation: Separation,
    /// What a plan keeps beyond threats, zones, area, ground, ceiling and separation.
    pub buffers: Buffers,
    /// How paths are searched.
    pub planner: Planner,
    /// How paths become mission items.
    pub mission: MissionOptions,
    /// Steady wind, if any is assumed.
    pub wind: Option<Wind>,
    /// What the fleet does when the link to one vehicle is lost.
    pub on_link_loss: OnLinkLoss,
    /// What is done at alarms in flight.
    pub on_alarm: OnAlarm,
}

impl MissionSpec {
    /// What is done at alarms in flight, `on_link_loss` included.
    #[must_use]
    pub fn answers(&self) -> OnAlarm {
        let action = match self.on_link_loss {
            OnLinkLoss::Continue => return self.on_alarm,
            OnLinkLoss::HoldAll => Action::Hold,
            OnLinkLoss::LandAll => Action::Land,
        };
        let who = Who::All;
        OnAlarm {
            link: self.on_alarm.link.or(Some(Answer { who, action })),
            ..self.on_alarm
        }
    }
}

impl MissionSpec {
    /// The separation that a plan satisfies: the limit and its buffer.
    #[must_use]
    pub fn buffered_separation(&self) -> Separation {
        let buffer_m = self.buffers.separation_m;
        Separation {
            distance_m: self.separation.distance_m + buffer_m,
            vertical_m: self.separation.vertical_m.map(|limit_m| limit_m + buffer_m),
            ..self.separation
        }
    }

    /// Whether the path of a vehicle may pass its limits nearer than `mission.tolerance_m`, so that
    /// its legs must stay nearer to it there: that of a copter, but not in a large fleet, which would be
    /// planned again more often, nor in the published experiment.
    #[must_use]
    pub fn passes_limits_closely(&self, vehicle: &Vehicle) -> bool {
        /// Most vehicles of such a fleet.
        const MAX: usize = 60;
        vehicle.airframe == Airframe::Copter
            && self.vehicles.len() <= MAX
            && self.planner.objective == Objective::Operational
    }

    /// The least distance that a plan keeps from what a fence encloses: its margin, metres.
    #[must_use]
    pub fn fence_margin_m(&self) -> f64 {
        let buffers = &self.buffers;
        let of_threats = (!self.threats.is_empty()).then_some(buffers.threats_m);
        let has_zones = self.no_fly.iter().any(Zone::fits_fence);
        let of_zones = has_zones.then_some(buffers.zones_m);
        let others = of_threats.into_iter().chain(of_zones);
        others.fold(buffers.area_m, f64::min)
    }

    /// The greatest speed through the air that a copter may need at its planned ground speed, m/s:
    /// against the wind. None on a wing, and in specs of version 1, whose parameters stay.
    #[must_use]
    pub fn airspeed_mps(&self, vehicle: &Vehicle) -> Option<f64> {
        let is_judged = self.version >= 2 && vehicle.airframe == Airframe::Copter;
        let wind_mps = self.wind.map_or(0.0, |wind| wind.speed_mps);
        is_judged.then_some(vehicle.speed_mps + wind_mps)
    }

    /// Why the plan has no buffers, for the tables; `None` where a limit has one.
    #[must_use]
    pub fn why_no_buffers(&self) -> Option<&'static str> {
        match (self.buffers.is_none(), self.version, self.planner.objective) {
            (false, ..) => None,
            (true, 1, _) => Some("no buffers: sortie: 1"),
            (true, _, Objective::Paper) => Some("no buffers: planner.objective: paper"),
            (true, _, Objective::Operational) => Some("no buffers: buffer_m: {all: 0}"),
        }
    }
}

/// The allowed box of latitude, longitude and altitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// South-west corner.
    pub south_west: LatLon,
    /// North-east corner.
    pub north_east: LatLon,
    /// Minimum height above ground wherever a vehicle flies, the columns of takeoff and
    /// landing aside (h_min of the paper).
    pub min_agl: Agl,
    /// Ceiling.
    pub max_amsl: Amsl,
    /// The other limits of altitude; those of each vehicle include them.
    pub altitudes: AltitudeLimits,
}

impl Area {
    /// The corners, counter-clockwise from the south-west.
    #[must_use]
    pub fn outline(&self) -> Vec<LatLon> {
        let corner = |lat_deg, lon_deg| LatLon { lat_deg, lon_deg };
        let (south, west) = (self.south_west.lat_deg, self.south_west.lon_deg);
        let (north, east) = (self.north_east.lat_deg, self.north_east.lon_deg);
        vec![
            corner(south, west),
            corner(south, east),
            corner(north, east),
            corner(north, west),
        ]
    }
}

/// Where the ground comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum TerrainSource {
    /// An elevation file, its path relative to the spec.
    File(PathBuf),
    /// A folder of elevation files, its path relative to the spec.
    Folder(PathBuf),
    /// The same height everywhere.
    Flat(Amsl),
    /// Gaussian hills over a base, for examples and tests.
    Analytic {
        /// Height far from every hill.
        base: Amsl,
        /// The hills.
        hills: Vec<Hill>,
    },
}

/// A Gaussian hill of an analytic terrain: `height * exp(-(d/radius)^2)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hill {
    /// Summit.
    pub place: LatLon,
    /// Height of the summit over the base, metres.
    pub height_m: f64,
    /// Distance at which the height has fallen to 1/e, metres.
    pub radius_m: f64,
}

/// Radius of a threat or of a hill, metres.
pub const THREAT_RADIUS_M: RangeInclusive<f64> = 1.0..=500_000.0;

/// A vertical cylinder of infinite height.
#[derive(Clone, Debug, PartialEq)]
pub struct Threat {
    /// Unique name.
    pub id: String,
    /// A label such as `radar`; without meaning to the planner.
    pub kind: String,
    /// Axis.
    pub place: LatLon,
    /// Radius, metres.
    pub radius_m: f64,
}

/// A rally point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rally {
    /// Where.
    pub place: LatLon,
    /// How high over the ground there.
    pub agl: Agl,
}

/// How far apart vehicles stay.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Separation {
    /// Least distance at the same time, metres.
    #[schemars(range(min = 1, max = 50000))]
    pub distance_m: f64,
    /// Applies to every relative shift of departures up to this, seconds.
    #[schemars(range(min = 0, max = 3600))]
    pub time_slack_s: f64,
    /// With it, two vehicles conflict only if they are also less than this apart in height, metres.
    #[schemars(range(min = 1, max = 10000))]
    pub vertical_m: Option<f64>,
}

impl Default for Separation {
    fn default() -> Self {
        Self {
            distance_m: 100.0,
            time_slack_s: 5.0,
            vertical_m: None,
        }
    }
}

impl Separation {
    /// Whether two positions at the same time conflict, by their horizontal and vertical
    /// distance, metres.
    #[must_use]
    pub fn is_conflict(&self, across_m: f64, up_m: f64) -> bool {
        match self.vertical_m {
            Some(vertical_m) => across_m < self.distance_m && up_m < vertical_m,
            None => across_m.hypot(up_m) < self.distance_m,
        }
    }
}

/// Most free control points of a spline.
pub const MAX_CONTROL_POINTS: usize = 30;

/// How paths are searched.
#[derive(Clone, Debug, PartialEq)]
pub struct Planner {
    /// Which algorithm.
    pub algorithm: Algorithm,
    /// Which objective.
    pub objective: Objective,
    /// Seed of every random stream.
    pub seed: u64,
    /// Objective evaluations for each vehicle.
    pub evaluations: usize,
    /// Free control points of the spline.
    pub control_points: usize,
    /// Samples of the path in the objective.
    pub samples: usize,
    /// Weights of the objective's terms.
    pub weights: Weights,
    /// Number of swarms; absent: the algorithm's own.
    pub swarms: Option<usize>,
    /// Flies in all; absent: the algorithm's own.
    pub population: Option<usize>,
    /// Cost above which a swarm searches globally; absent: the algorithm's own.
    pub threshold: Option<f64>,
    /// Local step R, as a fraction of the map; absent: the algorithm's own.
    pub step: Option<f64>,
}

/// Which algorithm searches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(transform = words)]
pub enum Algorithm {
    /// The default: several swarms in different route classes.
    Msfoa,
    /// Algorithm 2 of the paper to the letter.
    MsfoaLiteral,
    /// The same with a shrinking local step.
    MsfoaDwindle,
    /// Fruit fly optimisation.
    Foa,
    /// Particle swarm optimisation.
    Pso,
    /// Differential evolution.
    De,
    /// Artificial bee colony.
    Abc,
    /// Improved fruit fly optimisation.
    Iffo,
    /// Multi-swarm fruit fly optimisation.
    Mfoa,
}

/// Which objective is minimised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[schemars(transform = words)]
pub enum Objective {
    /// Integrals along the path, independent of the sampling.
    Operational,
    /// The paper's sums over samples.
    Paper,
}

/// Factors on the terms of the objective; 1 means as designed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Weights {
    /// Length.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub length: f64,
    /// Height above the minimum.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub altitude: f64,
    /// Threats, zones and area.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub threat: f64,
    /// Height below the minimum.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub terrain: f64,
    /// Turns beyond the limit.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub turn: f64,
    /// Slopes beyond the limit.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub climb: f64,
    /// Nearness to earlier vehicles.
    #[schemars(range(min = 0, max = 1_000_000))]
    pub collision: f64,
}

impl Default for Weights {
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

/// How paths become mission items.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MissionOptions {
    /// Reference of the altitudes in the items.
    pub altitude: AltitudeReference,
    /// Furthest the waypoint legs may leave the planned path, metres.
    pub tolerance_m: f64,
    /// Most items in one mission.
    pub max_items: usize,
    /// Whether a fence is written.
    pub fence: bool,
}

/// Reference of the altitudes in mission items.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[schemars(transform = words)]
pub enum AltitudeReference {
    /// Above mean sea level.
    Amsl,
    /// Above home.
    Relative,
    /// Above terrain, by the vehicle's own terrain data.
    Terrain,
}

/// What the fleet does when the link to one vehicle is lost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(transform = words)]
pub enum OnLinkLoss {
    /// All vehicles continue.
    #[default]
    Continue,
    /// All vehicles hold their position.
    HoldAll,
    /// All vehicles land at their position.
    LandAll,
}

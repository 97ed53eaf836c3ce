//! Vehicles as YAML and tables have them.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use super::{Endurance, Place, Stop, StopAction};
use crate::autopilot::{Airframe, Autopilot};
use crate::spec::{Finish, Order};

impl JsonSchema for Autopilot {
    fn schema_name() -> Cow<'static, str> {
        "Autopilot".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({"type": "string", "enum": Self::ALL})
    }
}

impl JsonSchema for Airframe {
    fn schema_name() -> Cow<'static, str> {
        "Airframe".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({"type": "string", "enum": Self::ALL})
    }
}

/// A place in the air: with agl_m or with amsl_m, not both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("minProperties" = 3, "maxProperties" = 3))]
pub struct EndPoint {
    /// Latitude, degrees north.
    #[schemars(required, range(min = -90, max = 90))]
    pub lat: Option<f64>,
    /// Longitude, degrees east.
    #[schemars(required, range(min = -180, max = 180))]
    pub lon: Option<f64>,
    /// Height above the ground there, metres.
    #[schemars(range(min = 0, max = 20000))]
    pub agl_m: Option<f64>,
    /// Metres above mean sea level.
    #[schemars(range(min = -500, max = 20000))]
    pub amsl_m: Option<f64>,
}

impl EndPoint {
    /// A place by latitude and longitude, degrees, and its height above the ground there, metres.
    #[must_use]
    pub fn above_ground(lat: f64, lon: f64, agl_m: f64) -> Self {
        Self {
            lat: Some(lat),
            lon: Some(lon),
            agl_m: Some(agl_m),
            ..Self::default()
        }
    }

    /// A place by latitude and longitude, degrees, and its altitude above mean sea level, metres.
    #[must_use]
    pub fn above_sea(lat: f64, lon: f64, amsl_m: f64) -> Self {
        Self {
            lat: Some(lat),
            lon: Some(lon),
            amsl_m: Some(amsl_m),
            ..Self::default()
        }
    }
}

/// An end of the planned path: with agl_m or with amsl_m, not both.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("minProperties" = 3, "maxProperties" = 4))]
pub struct Station {
    /// Latitude, degrees north.
    #[schemars(required, range(min = -90, max = 90))]
    pub lat: Option<f64>,
    /// Longitude, degrees east.
    #[schemars(required, range(min = -180, max = 180))]
    pub lon: Option<f64>,
    /// Height above the ground there, metres.
    #[schemars(range(min = 0, max = 20000))]
    pub agl_m: Option<f64>,
    /// Metres above mean sea level.
    #[schemars(range(min = -500, max = 20000))]
    pub amsl_m: Option<f64>,
    /// What is done there, one after the other. A copter stays for it, as at a stop; planes and VTOLs
    /// do it on their way.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 20))]
    pub actions: Vec<StopAction>,
}

impl Station {
    /// Where it is.
    #[must_use]
    pub fn point(&self) -> EndPoint {
        EndPoint {
            lat: self.lat,
            lon: self.lon,
            agl_m: self.agl_m,
            amsl_m: self.amsl_m,
        }
    }
}

impl From<EndPoint> for Station {
    fn from(point: EndPoint) -> Self {
        Self {
            lat: point.lat,
            lon: point.lon,
            agl_m: point.agl_m,
            amsl_m: point.amsl_m,
            actions: Vec::new(),
        }
    }
}

/// Pictures along the way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OnboardCamera {
    /// Distance over the ground from one picture to the next, from start to goal, metres.
    #[schemars(required, range(min = 1, max = 1000))]
    pub trigger_distance_m: Option<f64>,
}

/// One vehicle.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Vehicle {
    /// Unique name; its files begin with it: letters, digits, - and _.
    #[schemars(required, length(min = 1, max = 64))]
    pub id: Option<String>,
    /// MAVLink system id, unique.
    #[schemars(required, range(min = 1, max = 255))]
    pub sysid: Option<i64>,
    /// Which autopilot reads the mission.
    #[schemars(with = "Autopilot")]
    pub autopilot: Option<Autopilot>,
    /// Its firmware version, such as 4.7; absent: the mission suits every supported version.
    pub autopilot_version: Option<String>,
    /// What flies; absent: copter.
    pub airframe: Option<Airframe>,
    /// How to reach it: sim, udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT, tcpin:HOST:PORT or serial:DEVICE:BAUD.
    #[schemars(required)]
    pub link: Option<String>,
    /// Where it stands, on the ground; absent: under start. A plane needs one, away from start.
    pub home: Option<Place>,
    /// The planned path begins here, airborne.
    #[schemars(with = "Station")]
    pub start: Option<Station>,
    /// The planned path ends here, airborne. A plane that lands touches down at this place,
    /// and its glide begins at this height. Absent, which needs stops: the start.
    pub goal: Option<Station>,
    /// Places to visit between start and goal.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stops: Vec<Stop>,
    /// Pictures on the way from start to goal.
    pub camera: Option<OnboardCamera>,
    /// Whether stops are visited as they are listed, or in the order that costs least; absent: fixed.
    pub order: Option<Order>,
    /// At the goal: land; loiter there for ever; or return along a planned path and land at home.
    #[schemars(with = "Finish")]
    pub finish: Option<Finish>,
    /// Planned speed, m/s: over the ground; of planes and vtol the indicated airspeed.
    #[schemars(required, range(min = 0.5, max = 100))]
    pub speed_mps: Option<f64>,
    /// Turn overload n; the turn radius is v^2 / (g sqrt(n^2 - 1)). Absent: 1.15, a bank of 30 degrees.
    #[schemars(range(min = 1.001, max = 10))]
    pub max_load_factor: Option<f64>,
    /// Steepest climb, degrees; absent: the slope polynomial of the paper.
    #[schemars(range(min = 0.1, max = 89))]
    pub max_climb_deg: Option<f64>,
    /// Steepest descent, degrees, positive; absent: the slope polynomial of the paper.
    #[schemars(range(min = 0.1, max = 89))]
    pub max_descent_deg: Option<f64>,
    /// Vertical speed up, m/s; absent: the autopilot's default.
    #[schemars(range(min = 0.1, max = 50))]
    pub climb_mps: Option<f64>,
    /// Vertical speed down, m/s, positive; absent: the autopilot's default.
    #[schemars(range(min = 0.1, max = 50))]
    pub descent_mps: Option<f64>,
    /// Copters: the greatest speed through the air that this one was flown at within its own lean
    /// limit, m/s. Absent: what a stock one of its autopilot reached, and up to 50 degrees of lean.
    #[schemars(range(min = 0.5, max = 100))]
    pub max_airspeed_mps: Option<f64>,
    /// Horizontal acceleration, m/s^2, of planes on the takeoff run; absent: the autopilot's default.
    #[schemars(range(min = 0.1, max = 50))]
    pub accel_mps2: Option<f64>,
    /// Takeoff starts this long after the fleet's T0, seconds; absent: 0.
    #[schemars(range(min = 0, max = 86400))]
    pub depart_s: Option<f64>,
    /// Copters: the planner may choose another departure in this window where that costs less
    /// than a detour around other vehicles. depart_s lies in it; absent, it is the beginning.
    pub depart_window_s: Option<Window>,
    /// ArduPilot's copters: the planner may choose another speed in this range where that costs
    /// less than a detour around other vehicles. speed_mps lies in it.
    pub speed_range_mps: Option<SpeedRange>,
    /// Greatest height above ground, everywhere, metres; the lower one of this and the area's counts.
    #[schemars(range(min = 1, max = 10000))]
    pub max_agl_m: Option<f64>,
    /// Least altitude from start to goal, metres above mean sea level; the higher one of this and the area's counts.
    #[schemars(range(min = -500, max = 20000))]
    pub min_amsl_m: Option<f64>,
    /// Fence items that it keeps; absent: what its autopilot keeps without further storage.
    #[schemars(range(min = 4, max = 5000))]
    pub fence_points: Option<usize>,
    /// How long or how far it flies; absent: not judged.
    pub endurance: Option<Endurance>,
    /// Only with it may the autopilot's own return be written: its altitude, metres above mean sea level.
    #[schemars(range(min = -500, max = 20000))]
    pub return_amsl_m: Option<f64>,
    /// Planes: direction of the takeoff run and of the climb to the height of start. A vtol may
    /// have one, for its transition. Degrees clockwise from north.
    #[schemars(range(min = 0, max = 360))]
    pub takeoff_heading_deg: Option<f64>,
    /// How a plane lands. A vtol may have one, for the direction of its approach.
    pub landing: Option<Landing>,
    /// Planes and vtol: radius of circling, metres, not below the turn radius; absent: a quarter more than that.
    #[schemars(range(min = 1, max = 10000))]
    pub loiter_radius_m: Option<f64>,
}

/// A window of time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Window {
    /// Seconds after the fleet's T0.
    #[schemars(required, range(min = 0, max = 86400))]
    pub from: Option<f64>,
    /// Seconds after the fleet's T0.
    #[schemars(required, range(min = 0, max = 86400))]
    pub to: Option<f64>,
}

/// A range of speeds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpeedRange {
    /// Slowest, m/s.
    #[schemars(required, range(min = 0.5, max = 100))]
    pub min: Option<f64>,
    /// Fastest, m/s.
    #[schemars(required, range(min = 0.5, max = 100))]
    pub max: Option<f64>,
}

/// How a plane or vtol lands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Landing {
    /// Direction of the approach, degrees clockwise from north. By default, where there is wind, into it,
    /// or the nearest to that from where the approach is free.
    #[schemars(range(min = 0, max = 360))]
    pub heading_deg: Option<f64>,
    /// Angle of a plane's glide, degrees; a vtol comes down vertically.
    #[schemars(required, range(min = 1, max = 30))]
    pub glide_deg: Option<f64>,
}

//! Vehicles, as YAML has them.

use schemars::JsonSchema;
use serde::Deserialize;

use super::Place;
use crate::autopilot::{Airframe, Autopilot};

/// A place in the air: with agl_m or with amsl_m, not both.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("minProperties" = 3, "maxProperties" = 3))]
pub(in crate::spec) struct EndPoint {
    /// Latitude, degrees north.
    #[schemars(range(min = -90, max = 90))]
    pub(in crate::spec) lat: f64,
    /// Longitude, degrees east.
    #[schemars(range(min = -180, max = 180))]
    pub(in crate::spec) lon: f64,
    /// Height above the ground there, metres.
    #[schemars(range(min = 0, max = 20000))]
    pub(in crate::spec) agl_m: Option<f64>,
    /// Metres above mean sea level.
    #[schemars(range(min = -500, max = 20000))]
    pub(in crate::spec) amsl_m: Option<f64>,
}

/// One vehicle.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::spec) struct Vehicle {
    /// Unique name; its files begin with it: letters, digits, - and _.
    #[schemars(length(min = 1, max = 64))]
    pub(in crate::spec) id: String,
    /// MAVLink system id, unique.
    #[schemars(range(min = 1, max = 255))]
    pub(in crate::spec) sysid: i64,
    /// Which autopilot reads the mission.
    pub(in crate::spec) autopilot: Autopilot,
    /// Its firmware version, such as 4.7; absent: the mission suits every supported version.
    pub(in crate::spec) autopilot_version: Option<String>,
    /// What flies; absent: copter.
    #[serde(default)]
    pub(in crate::spec) airframe: Airframe,
    /// How to reach it: sim, udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT, tcpin:HOST:PORT or serial:DEVICE:BAUD.
    pub(in crate::spec) link: String,
    /// Where it stands, on the ground; absent: under start. A plane needs one, away from start.
    pub(in crate::spec) home: Option<Place>,
    /// The planned path begins here, airborne.
    pub(in crate::spec) start: EndPoint,
    /// The planned path ends here, airborne. A plane that lands touches down at this place,
    /// and its glide begins at this height.
    pub(in crate::spec) goal: EndPoint,
    /// At the goal: land; loiter there for ever; or return along a planned path and land at home.
    pub(in crate::spec) finish: Finish,
    /// Planned speed, m/s: over the ground; of planes and vtol the indicated airspeed.
    #[schemars(range(min = 0.5, max = 100))]
    pub(in crate::spec) speed_mps: f64,
    /// Turn overload n; the turn radius is v^2 / (g sqrt(n^2 - 1)). Absent: 1.15, a bank of 30 degrees.
    #[schemars(range(min = 1.001, max = 10))]
    pub(in crate::spec) max_load_factor: Option<f64>,
    /// Steepest climb, degrees; absent: the slope polynomial of the paper.
    #[schemars(range(min = 0.1, max = 89))]
    pub(in crate::spec) max_climb_deg: Option<f64>,
    /// Steepest descent, degrees, positive; absent: the slope polynomial of the paper.
    #[schemars(range(min = 0.1, max = 89))]
    pub(in crate::spec) max_descent_deg: Option<f64>,
    /// Vertical speed up, m/s; absent: the autopilot's default.
    #[schemars(range(min = 0.1, max = 50))]
    pub(in crate::spec) climb_mps: Option<f64>,
    /// Vertical speed down, m/s, positive; absent: the autopilot's default.
    #[schemars(range(min = 0.1, max = 50))]
    pub(in crate::spec) descent_mps: Option<f64>,
    /// Horizontal acceleration, m/s^2, of planes on the takeoff run; absent: the autopilot's default.
    #[schemars(range(min = 0.1, max = 50))]
    pub(in crate::spec) accel_mps2: Option<f64>,
    /// Takeoff starts this long after the fleet's T0, seconds; absent: 0.
    #[schemars(range(min = 0, max = 86400))]
    pub(in crate::spec) depart_s: Option<f64>,
    /// Copters: takeoff may also start at another time of this window, if that is cheaper than a
    /// way around others; depart_s is in it, and absent the beginning of it.
    pub(in crate::spec) depart_window_s: Option<Window>,
    /// ArduPilot's copters: the planned speed may also be another of this range, if that is
    /// cheaper than a way around others; speed_mps is in it.
    pub(in crate::spec) speed_range_mps: Option<SpeedRange>,
    /// Only with it may the autopilot's own return be written: its altitude, metres above mean sea level.
    #[schemars(range(min = -500, max = 20000))]
    pub(in crate::spec) return_amsl_m: Option<f64>,
    /// Planes: direction of the takeoff run and of the climb to the height of start. A vtol may
    /// have one, for its transition. Degrees clockwise from north.
    #[schemars(range(min = 0, max = 360))]
    pub(in crate::spec) takeoff_heading_deg: Option<f64>,
    /// How a plane lands. A vtol may have one, for the direction of its approach.
    pub(in crate::spec) landing: Option<Landing>,
    /// Planes and vtol: radius of circling, metres, not below the turn radius; absent: a quarter more than that.
    #[schemars(range(min = 1, max = 10000))]
    pub(in crate::spec) loiter_radius_m: Option<f64>,
}

/// A window of time.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::spec) struct Window {
    /// Seconds after the fleet's T0.
    #[schemars(range(min = 0, max = 86400))]
    pub(in crate::spec) from: f64,
    /// Seconds after the fleet's T0.
    #[schemars(range(min = 0, max = 86400))]
    pub(in crate::spec) to: f64,
}

/// A range of speeds.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::spec) struct SpeedRange {
    /// Slowest, m/s.
    #[schemars(range(min = 0.5, max = 100))]
    pub(in crate::spec) min: f64,
    /// Fastest, m/s.
    #[schemars(range(min = 0.5, max = 100))]
    pub(in crate::spec) max: f64,
}

/// How a plane or vtol lands.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::spec) struct Landing {
    /// Direction of the approach, degrees clockwise from north.
    #[schemars(range(min = 0, max = 360))]
    pub(in crate::spec) heading_deg: f64,
    /// Angle of a plane's glide, degrees; a vtol comes down vertically.
    #[schemars(range(min = 1, max = 30))]
    pub(in crate::spec) glide_deg: f64,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(in crate::spec) enum Finish {
    Land,
    Loiter,
    Return,
}

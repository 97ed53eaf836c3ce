//! Vehicles in a compact form, as YAML and a table have them.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{Finish, Place};
use crate::autopilot::{Airframe, Autopilot};

/// Vehicles in a compact form. They come after those of `vehicles` in priority, in the order
/// of the table or of the grid. Their starts and goals are in `csv`, in grids or in `defaults`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::spec) struct Fleet {
    /// Their names, such as d{n:03}: {n} is the number of the vehicle in the fleet, from 1;
    /// {n:03} the same in three digits. Absent: from the column id of the table.
    #[schemars(length(min = 1, max = 64))]
    pub(in crate::spec) id: Option<String>,
    /// System id of the first one; the others count on, past those of `vehicles`, and after 240
    /// begin again at 1. Absent: 1.
    #[schemars(range(min = 1, max = 240))]
    pub(in crate::spec) first_sysid: Option<i64>,
    /// Each takes off this much later than the one before, seconds; absent: 0.
    #[schemars(range(min = 0, max = 86400))]
    pub(in crate::spec) depart_every_s: Option<f64>,
    /// What they have in common: any key of a vehicle but id and sysid.
    #[serde(default)]
    pub(in crate::spec) defaults: Defaults,
    /// Where they start.
    pub(in crate::spec) start_grid: Option<Grid>,
    /// Where they go: the first of this grid is the goal of the first of the other.
    pub(in crate::spec) goal_grid: Option<Grid>,
    /// A table beside this file, one row for each vehicle. The names of its columns are the
    /// keys of a vehicle, with _ for the dot: id, start_lat, start_lon, goal_agl_m, speed_mps.
    /// An empty cell means the default.
    pub(in crate::spec) csv: Option<String>,
}

/// Positions in rows from west to east, the rows from south to north.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::spec) struct Grid {
    /// The first place.
    pub(in crate::spec) south_west: Place,
    /// Number of rows.
    #[schemars(range(min = 1, max = 10000))]
    pub(in crate::spec) rows: u64,
    /// Positions in each row.
    #[schemars(range(min = 1, max = 10000))]
    pub(in crate::spec) columns: u64,
    /// Distance between neighbours, metres.
    #[schemars(range(min = 0.1, max = 100_000))]
    pub(in crate::spec) spacing_m: f64,
}

/// What the vehicles of a fleet have in common, each as in `vehicles`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(in crate::spec) struct Defaults {
    /// Which autopilot reads the missions.
    pub(in crate::spec) autopilot: Option<Autopilot>,
    /// Its firmware version, such as 4.7.
    pub(in crate::spec) autopilot_version: Option<String>,
    /// What flies; absent: copter.
    pub(in crate::spec) airframe: Option<Airframe>,
    /// How to reach them. {n} is the number of the vehicle; {14550+n} and {5750+10*n} count on.
    pub(in crate::spec) link: Option<String>,
    /// Where they stand; absent: each under its start.
    pub(in crate::spec) home: Option<Place>,
    /// Where they start; with grids or a table, what those do not say.
    pub(in crate::spec) start: Option<End>,
    /// Where they go; with grids or a table, what those do not say.
    pub(in crate::spec) goal: Option<End>,
    /// What happens at the goal.
    pub(in crate::spec) finish: Option<Finish>,
    /// Planned speed, m/s.
    #[schemars(range(min = 0.5, max = 100))]
    pub(in crate::spec) speed_mps: Option<f64>,
    /// Turn overload n.
    #[schemars(range(min = 1.001, max = 10))]
    pub(in crate::spec) max_load_factor: Option<f64>,
    /// Steepest climb, degrees.
    #[schemars(range(min = 0.1, max = 89))]
    pub(in crate::spec) max_climb_deg: Option<f64>,
    /// Steepest descent, degrees.
    #[schemars(range(min = 0.1, max = 89))]
    pub(in crate::spec) max_descent_deg: Option<f64>,
    /// Vertical speed up, m/s.
    #[schemars(range(min = 0.1, max = 50))]
    pub(in crate::spec) climb_mps: Option<f64>,
    /// Vertical speed down, m/s.
    #[schemars(range(min = 0.1, max = 50))]
    pub(in crate::spec) descent_mps: Option<f64>,
    /// Horizontal acceleration, m/s^2.
    #[schemars(range(min = 0.1, max = 50))]
    pub(in crate::spec) accel_mps2: Option<f64>,
    /// Takeoff of the first one, seconds after T0; in a table, of that vehicle.
    #[schemars(range(min = 0, max = 86400))]
    pub(in crate::spec) depart_s: Option<f64>,
    /// Copters: other times at which takeoff may start, seconds after T0.
    pub(in crate::spec) depart_window_s: Option<PartOfWindow>,
    /// ArduPilot's copters: other speeds that they may have, m/s.
    pub(in crate::spec) speed_range_mps: Option<PartOfRange>,
    /// Altitude of the autopilot's own return, metres above mean sea level.
    #[schemars(range(min = -500, max = 20000))]
    pub(in crate::spec) return_amsl_m: Option<f64>,
    /// Planes: direction of the takeoff, degrees.
    #[schemars(range(min = 0, max = 360))]
    pub(in crate::spec) takeoff_heading_deg: Option<f64>,
    /// How planes land.
    pub(in crate::spec) landing: Option<Approach>,
    /// Planes and vtol: radius of circling, metres.
    #[schemars(range(min = 1, max = 10000))]
    pub(in crate::spec) loiter_radius_m: Option<f64>,
}

/// A place in the air, or a part of it.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(in crate::spec) struct End {
    /// Latitude, degrees north.
    #[schemars(range(min = -90, max = 90))]
    pub(in crate::spec) lat: Option<f64>,
    /// Longitude, degrees east.
    #[schemars(range(min = -180, max = 180))]
    pub(in crate::spec) lon: Option<f64>,
    /// Height above the ground there, metres.
    #[schemars(range(min = 0, max = 20000))]
    pub(in crate::spec) agl_m: Option<f64>,
    /// Metres above mean sea level.
    #[schemars(range(min = -500, max = 20000))]
    pub(in crate::spec) amsl_m: Option<f64>,
}

/// How a plane lands, or a part of it.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(in crate::spec) struct Approach {
    /// Direction of the approach, degrees clockwise from north.
    #[schemars(range(min = 0, max = 360))]
    pub(in crate::spec) heading_deg: Option<f64>,
    /// Angle of the glide, degrees.
    #[schemars(range(min = 1, max = 30))]
    pub(in crate::spec) glide_deg: Option<f64>,
}

/// A window of time, or a part of it.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(in crate::spec) struct PartOfWindow {
    /// Seconds after the fleet's T0.
    #[schemars(range(min = 0, max = 86400))]
    pub(in crate::spec) from: Option<f64>,
    /// Seconds after the fleet's T0.
    #[schemars(range(min = 0, max = 86400))]
    pub(in crate::spec) to: Option<f64>,
}

/// A range of speeds, or a part of it.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(in crate::spec) struct PartOfRange {
    /// Slowest, m/s.
    #[schemars(range(min = 0.5, max = 100))]
    pub(in crate::spec) min: Option<f64>,
    /// Fastest, m/s.
    #[schemars(range(min = 0.5, max = 100))]
    pub(in crate::spec) max: Option<f64>,
}

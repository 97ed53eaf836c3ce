//! What the cells of a table say of a vehicle.

use serde::Deserialize;
use serde::de::IntoDeserializer;
use serde::de::value::{Error, StrDeserializer};

use super::super::raw;

/// A vehicle that is not whole yet.
#[derive(Clone, Debug, Default)]
pub(super) struct Part {
    pub(super) id: Option<String>,
    pub(super) sysid: Option<i64>,
    /// Of a home of its own, latitude and longitude, degrees.
    pub(super) home: [Option<f64>; 2],
    pub(super) rest: raw::Defaults,
}

/// Every column that a table may have.
pub(super) const COLUMNS: [&str; 34] = [
    "id",
    "sysid",
    "autopilot",
    "autopilot_version",
    "airframe",
    "link",
    "home_lat",
    "home_lon",
    "start_lat",
    "start_lon",
    "start_agl_m",
    "start_amsl_m",
    "goal_lat",
    "goal_lon",
    "goal_agl_m",
    "goal_amsl_m",
    "finish",
    "speed_mps",
    "max_load_factor",
    "max_climb_deg",
    "max_descent_deg",
    "climb_mps",
    "descent_mps",
    "accel_mps2",
    "depart_s",
    "depart_window_s_from",
    "depart_window_s_to",
    "speed_range_mps_min",
    "speed_range_mps_max",
    "return_amsl_m",
    "takeoff_heading_deg",
    "landing_heading_deg",
    "landing_glide_deg",
    "loiter_radius_m",
];

impl Part {
    /// Takes in a cell that is not empty.
    ///
    /// # Errors
    /// What such a cell may be.
    pub(super) fn set(&mut self, column: &str, cell: &str) -> Result<(), String> {
        let rest = &mut self.rest;
        let start = rest.start.get_or_insert_default();
        let goal = rest.goal.get_or_insert_default();
        let (window, range) = (&mut rest.depart_window_s, &mut rest.speed_range_mps);
        let number = || {
            cell.parse::<f64>()
                .map_err(|_| number_like(cell).to_owned())
        };
        let whole = || cell.parse::<i64>().map_err(|_| "a whole number".to_owned());
        match column {
            "id" => self.id = Some(cell.to_owned()),
            "sysid" => self.sysid = Some(whole()?),
            "autopilot" => rest.autopilot = Some(word(cell)?),
            "autopilot_version" => rest.autopilot_version = Some(cell.to_owned()),
            "airframe" => rest.airframe = Some(word(cell)?),
            "link" => rest.link = Some(cell.to_owned()),
            "home_lat" => self.home[0] = Some(number()?),
            "home_lon" => self.home[1] = Some(number()?),
            "start_lat" => start.lat = Some(number()?),
            "start_lon" => start.lon = Some(number()?),
            "start_agl_m" => start.agl_m = Some(number()?),
            "start_amsl_m" => start.amsl_m = Some(number()?),
            "goal_lat" => goal.lat = Some(number()?),
            "goal_lon" => goal.lon = Some(number()?),
            "goal_agl_m" => goal.agl_m = Some(number()?),
            "goal_amsl_m" => goal.amsl_m = Some(number()?),
            "finish" => rest.finish = Some(word(cell)?),
            "speed_mps" => rest.speed_mps = Some(number()?),
            "max_load_factor" => rest.max_load_factor = Some(number()?),
            "max_climb_deg" => rest.max_climb_deg = Some(number()?),
            "max_descent_deg" => rest.max_descent_deg = Some(number()?),
            "climb_mps" => rest.climb_mps = Some(number()?),
            "descent_mps" => rest.descent_mps = Some(number()?),
            "accel_mps2" => rest.accel_mps2 = Some(number()?),
            "depart_s" => rest.depart_s = Some(number()?),
            "depart_window_s_from" => window.get_or_insert_default().from = Some(number()?),
            "depart_window_s_to" => window.get_or_insert_default().to = Some(number()?),
            "speed_range_mps_min" => range.get_or_insert_default().min = Some(number()?),
            "speed_range_mps_max" => range.get_or_insert_default().max = Some(number()?),
            "return_amsl_m" => rest.return_amsl_m = Some(number()?),
            "takeoff_heading_deg" => rest.takeoff_heading_deg = Some(number()?),
            "loiter_radius_m" => rest.loiter_radius_m = Some(number()?),
            "landing_heading_deg" => {
                rest.landing.get_or_insert_default().heading_deg = Some(number()?);
            }
            "landing_glide_deg" => {
                rest.landing.get_or_insert_default().glide_deg = Some(number()?);
            }
            _ => return Err(COLUMNS.join(", ")),
        }
        Ok(())
    }

    /// An altitude of the row stands instead of the one of the defaults, whatever its reference.
    pub(super) fn forget_altitude(&mut self, column: &str) {
        let end = match column {
            "start_agl_m" | "start_amsl_m" => &mut self.rest.start,
            "goal_agl_m" | "goal_amsl_m" => &mut self.rest.goal,
            _ => return,
        };
        if let Some(end) = end {
            (end.agl_m, end.amsl_m) = (None, None);
        }
    }
}

/// What a cell that should be a number may be.
fn number_like(cell: &str) -> &'static str {
    let digits = cell.trim_start_matches(['-', '+']).to_ascii_lowercase();
    let other_base = ["0x", "0o", "0b"]
        .iter()
        .any(|sign| digits.starts_with(sign));
    match other_base {
        true => "a number in decimal digits, such as 16",
        false => "a number",
    }
}

/// A word of a closed list.
fn word<'de, T: Deserialize<'de>>(cell: &'de str) -> Result<T, String> {
    let word: StrDeserializer<'de, Error> = cell.into_deserializer();
    T::deserialize(word).map_err(|error| {
        let message = error.to_string();
        let allowed = message.split_once("expected ").map(|(_, words)| words);
        allowed.unwrap_or(&message).to_owned()
    })
}

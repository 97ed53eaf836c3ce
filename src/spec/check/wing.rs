//! What only planes and vtol have: takeoff heading, landing, circles.

use super::super::keys;
use super::super::{Airframe, Finish, Landing, Vehicle, Wind, Wing, turn_radius_by_load_m};
use super::Checker;
use crate::geodesy::{Amsl, true_airspeed_ratio};
use crate::numeric::digits;

/// Least distance from the home of a plane to its start, metres.
const MIN_HOME_TO_START_M: f64 = 10.0;
/// The radius of circling where the spec has none, in turn radii.
const DEFAULT_LOITER: f64 = 1.25;

/// How the vehicle flies, as far as it is known when its wing is checked.
pub(super) struct Flown {
    pub(super) airframe: Airframe,
    pub(super) finish: Finish,
    pub(super) speed_mps: f64,
    pub(super) load_factor: f64,
    pub(super) descent_mps: f64,
    pub(super) wind: Option<Wind>,
    /// Of the area.
    pub(super) ceiling: Amsl,
    /// From a home of its own to the start, metres.
    pub(super) home_to_start_m: Option<f64>,
}

impl Flown {
    /// Greatest speed over the ground, m/s.
    fn fastest_mps(&self) -> f64 {
        self.true_mps() + self.wind.map_or(0.0, |wind| wind.speed_mps)
    }

    /// Greatest speed through the air, m/s.
    fn true_mps(&self) -> f64 {
        self.speed_mps * true_airspeed_ratio(self.ceiling)
    }

    /// Speed over the ground on a course. Where the wind is too strong to hold that course, the
    /// speed through the air; then the verdict fails.
    fn ground_speed_mps(&self, course_rad: f64) -> f64 {
        let carried = |wind: Wind| wind.ground_speed_mps(self.true_mps(), course_rad);
        self.wind.and_then(carried).unwrap_or(self.true_mps())
    }
}

impl Checker {
    /// Checks the keys of planes and vtol; none of them may stand on a copter.
    pub(super) fn wing(&mut self, path: &str, keys: &keys::Vehicle, flown: &Flown) -> Option<Wing> {
        let at = |key: &str| format!("{path}.{key}");
        if flown.airframe == Airframe::Copter {
            for (key, is_present) in [
                ("takeoff_heading_deg", keys.takeoff_heading_deg.is_some()),
                ("landing", keys.landing.is_some()),
                ("loiter_radius_m", keys.loiter_radius_m.is_some()),
            ] {
                if is_present {
                    self.report(&at(key), "a key of planes, on a copter", "without it");
                }
            }
            return None;
        }
        if keys.return_amsl_m.is_some() {
            let found = "the autopilot's own return, which ends in a circle over home";
            self.report(&at("return_amsl_m"), found, "without it; finish: return");
        }
        self.runway(path, keys, flown);
        Some(Wing {
            takeoff_heading_rad: keys.takeoff_heading_deg.map(f64::to_radians),
            landing: self.landing(&at("landing"), keys, flown),
            loiter_radius_m: self.loiter_radius(&at("loiter_radius_m"), keys, flown),
            ceiling: flown.ceiling,
        })
    }

    /// More wind than wings of the fleet were flown in; reported once for each kind of them.
    pub(super) fn wind_was_flown(&mut self, fleet: &[(String, Vehicle)]) {
        let mut kinds = Vec::new();
        for (_, vehicle) in fleet {
            let kind = vehicle.facts().firmware;
            let (Some(why), Some(wind)) = (vehicle.too_much_wind(), vehicle.carried_by()) else {
                continue;
            };
            if !kinds.contains(&kind) {
                kinds.push(kind);
                let speed = digits::plain(wind.speed_mps);
                let found = format!("{speed} m/s, and `{}` is of {kind}", vehicle.id);
                self.report("wind.speed_mps", found, why);
            }
        }
    }

    /// A plane needs a course to take off on, and a distance between home and start; so does a
    /// vtol that has a course.
    fn runway(&mut self, path: &str, keys: &keys::Vehicle, flown: &Flown) {
        let is_plane = flown.airframe == Airframe::Plane;
        if is_plane && keys.takeoff_heading_deg.is_none() {
            let found = "a plane without takeoff_heading_deg";
            self.report(path, found, "takeoff_heading_deg: 0 to 360");
        }
        let needs_distance = is_plane || keys.takeoff_heading_deg.is_some();
        match flown.home_to_start_m {
            None if needs_distance && keys.home.is_none() => {
                let found =
                    "a takeoff along a course and no home: the vehicle stands under its start";
                self.report(path, found, "home: {lat, lon}, away from start");
            }
            Some(apart_m) if needs_distance && apart_m < MIN_HOME_TO_START_M => {
                let found = format!(
                    "{} m from start",
                    digits::distinct_from(apart_m, MIN_HOME_TO_START_M, 1)
                );
                let allowed = format!("at least {MIN_HOME_TO_START_M} m from start");
                self.report(&format!("{path}.home"), found, allowed);
            }
            _ => {}
        }
    }

    fn landing(&mut self, path: &str, keys: &keys::Vehicle, flown: &Flown) -> Option<Landing> {
        let is_plane = flown.airframe == Airframe::Plane;
        let lands = flown.finish != Finish::Loiter;
        let wind = flown.wind.filter(|wind| wind.speed_mps > 0.0);
        let Some(landing) = keys.landing else {
            if is_plane && lands {
                let found = "a plane that lands, without landing";
                self.report(path, found, "landing: {heading_deg, glide_deg}");
            }
            // Version 1 stays as it was: from any direction.
            let into_wind = wind.filter(|_| !is_plane && lands && self.version > 1);
            return into_wind.map(|_| Landing {
                heading_rad: None,
                glide_rad: 0.0,
            });
        };
        // Where there is wind it may be left open.
        let heading_deg = match wind {
            Some(_) => landing.heading_deg,
            None => Some(self.required(path, "heading_deg", landing.heading_deg)?),
        };
        let glide_deg = self.required(path, "glide_deg", landing.glide_deg)?;
        let heading_rad = heading_deg.map(f64::to_radians);
        let glide_rad = glide_deg.to_radians();
        let into_wind_rad = wind.map_or(0.0, |wind| wind.from_rad);
        let ground_mps = flown.ground_speed_mps(heading_rad.unwrap_or(into_wind_rad));
        let sink_mps = ground_mps * glide_rad.tan();
        if is_plane && sink_mps > flown.descent_mps {
            let found = format!("{glide_deg} at {ground_mps:.4} m/s sinks {sink_mps:.2} m/s");
            let steepest_deg = (flown.descent_mps / ground_mps).atan().to_degrees();
            let allowed = format!(
                "at most {steepest_deg:.1} (descent_mps {})",
                flown.descent_mps
            );
            self.report(&format!("{path}.glide_deg"), found, allowed);
        }
        Some(Landing {
            heading_rad,
            glide_rad,
        })
    }

    fn loiter_radius(&mut self, path: &str, keys: &keys::Vehicle, flown: &Flown) -> f64 {
        let min_m = turn_radius_by_load_m(flown.fastest_mps(), flown.load_factor);
        let Some(radius_m) = keys.loiter_radius_m else {
            return (DEFAULT_LOITER * min_m).ceil();
        };
        if (1.0..min_m).contains(&radius_m) {
            let found = format!("{radius_m} m, tighter than the turn radius");
            let allowed = format!(
                "at least {:.1} m at {:.1} m/s and a load factor of {}",
                (min_m * 10.0).ceil() / 10.0,
                flown.fastest_mps(),
                flown.load_factor
            );
            self.report(path, found, allowed);
        }
        radius_m
    }
}

//! What only planes and vtol have: takeoff heading, landing, circles.

use super::super::raw;
use super::super::{Airframe, Landing, Wind, Wing, turn_radius_by_load_m};
use super::Checker;
use crate::geodesy::{Amsl, true_airspeed_ratio};
use crate::numeric::digits;

/// A plane stands at least this far from its start, metres.
const LEAST_RUN_M: f64 = 10.0;
/// The radius of circling where the spec has none, in turn radii.
const ROOM: f64 = 1.25;
/// The autopilots keep whole metres of this range in every item that circles, metres.
const MOST_LOITER_M: f64 = 10_000.0;

/// How the vehicle flies, as far as it is known when its wing is checked.
pub(super) struct Flown {
    pub(super) airframe: Airframe,
    pub(super) speed_mps: f64,
    pub(super) load_factor: f64,
    pub(super) descent_mps: f64,
    pub(super) wind: Option<Wind>,
    /// Of the area.
    pub(super) ceiling: Amsl,
    /// From a home of its own to the start, metres.
    pub(super) way_to_start_m: Option<f64>,
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

    /// Speed over the ground on a course; where the wind is too strong for that, the verdict
    /// says so.
    fn ground_speed_mps(&self, course_rad: f64) -> f64 {
        let carried = |wind: Wind| wind.ground_speed_mps(self.true_mps(), course_rad);
        self.wind.and_then(carried).unwrap_or(self.true_mps())
    }
}

impl Checker<'_> {
    /// Checks the keys of planes and vtol; none of them may stand on a copter.
    pub(super) fn wing(&mut self, path: &str, raw: &raw::Vehicle, flown: &Flown) -> Option<Wing> {
        let at = |key: &str| format!("{path}.{key}");
        if flown.airframe == Airframe::Copter {
            for (key, is_present) in [
                ("takeoff_heading_deg", raw.takeoff_heading_deg.is_some()),
                ("landing", raw.landing.is_some()),
                ("loiter_radius_m", raw.loiter_radius_m.is_some()),
            ] {
                if is_present {
                    self.report(&at(key), "a key of planes, on a copter", "without it");
                }
            }
            return None;
        }
        if raw.return_amsl_m.is_some() {
            let found = "the autopilot's own return, which ends in a circle over home";
            self.report(&at("return_amsl_m"), found, "without it; finish: return");
        }
        self.runway(path, raw, flown);
        let heading = self.optional(
            &at("takeoff_heading_deg"),
            raw.takeoff_heading_deg,
            0.0..=360.0,
        );
        Some(Wing {
            takeoff_heading_rad: heading.map(f64::to_radians),
            landing: self.landing(&at("landing"), raw, flown),
            loiter_radius_m: self.loiter_radius(&at("loiter_radius_m"), raw, flown),
            wind: flown.wind,
            ceiling: flown.ceiling,
        })
    }

    /// A plane needs a course to take off on, and room between home and start; a vtol that
    /// has a course needs the room too.
    fn runway(&mut self, path: &str, raw: &raw::Vehicle, flown: &Flown) {
        let is_plane = flown.airframe == Airframe::Plane;
        if is_plane && raw.takeoff_heading_deg.is_none() {
            let found = "a plane without takeoff_heading_deg";
            self.report(path, found, "takeoff_heading_deg: 0 to 360");
        }
        let needs_room = is_plane || raw.takeoff_heading_deg.is_some();
        match flown.way_to_start_m {
            None if needs_room && raw.home.is_none() => {
                let found = "a takeoff along a course, and no home: it would stand under its start";
                self.report(path, found, "home: {lat, lon}, away from start");
            }
            Some(way_m) if needs_room && way_m < LEAST_RUN_M => {
                let found = format!(
                    "{} m from start",
                    digits::distinct_from(way_m, LEAST_RUN_M, 1)
                );
                let allowed = format!("at least {LEAST_RUN_M} m from start");
                self.report(&format!("{path}.home"), found, allowed);
            }
            _ => {}
        }
    }

    fn landing(&mut self, path: &str, raw: &raw::Vehicle, flown: &Flown) -> Option<Landing> {
        let is_plane = flown.airframe == Airframe::Plane;
        let lands = !matches!(raw.finish, raw::Finish::Loiter);
        let Some(landing) = raw.landing else {
            if is_plane && lands {
                let found = "a plane that lands, without landing";
                self.report(path, found, "landing: {heading_deg, glide_deg}");
            }
            return None;
        };
        let heading_path = format!("{path}.heading_deg");
        let heading_deg = self.number(&heading_path, landing.heading_deg, 0.0..=360.0);
        let glide_path = format!("{path}.glide_deg");
        let glide_deg = self.number(&glide_path, landing.glide_deg, 1.0..=30.0);
        let glide_rad = glide_deg.to_radians();
        let ground_mps = flown.ground_speed_mps(heading_deg.to_radians());
        let sink_mps = ground_mps * glide_rad.tan();
        if is_plane && sink_mps > flown.descent_mps {
            let found = format!("{glide_deg} at {ground_mps:.4} m/s sinks {sink_mps:.2} m/s");
            let steepest_deg = (flown.descent_mps / ground_mps).atan().to_degrees();
            let allowed = format!(
                "at most {steepest_deg:.1} (descent_mps {})",
                flown.descent_mps
            );
            self.report(&glide_path, found, allowed);
        }
        Some(Landing {
            heading_rad: heading_deg.to_radians(),
            glide_rad,
        })
    }

    fn loiter_radius(&mut self, path: &str, raw: &raw::Vehicle, flown: &Flown) -> f64 {
        let least_m = turn_radius_by_load_m(flown.fastest_mps(), flown.load_factor);
        let Some(radius_m) = raw.loiter_radius_m else {
            return (ROOM * least_m).ceil();
        };
        let radius_m = self.number(path, radius_m, 1.0..=MOST_LOITER_M);
        if radius_m < least_m {
            let found = format!("{radius_m} m, tighter than the turn radius");
            let allowed = format!(
                "at least {:.1} m at {:.1} m/s and a load factor of {}",
                (least_m * 10.0).ceil() / 10.0,
                flown.fastest_mps(),
                flown.load_factor
            );
            self.report(path, found, allowed);
        }
        radius_m
    }
}

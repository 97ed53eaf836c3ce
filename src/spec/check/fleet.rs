//! The vehicles, each alone and against each other.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use nalgebra::Vector3;

use super::super::raw;
use super::super::{
    Airframe, Autopilot, EndPoint, Finish, Link, Placement, Separation, Vehicle, Wind,
};
use super::Checker;
use super::map::Map;
use super::wing::Flown;
use crate::geodesy::{Agl, Amsl, LatLon};
use crate::numeric::digits;

/// Load factor of a bank of 30 degrees, the lean limit that copters come with.
const DEFAULT_LOAD_FACTOR: f64 = 1.15;

/// Start and goal of a vehicle are at least this far apart, horizontally, metres.
const LEAST_WAY_M: f64 = 10.0;

/// Greatest `MAV_SYS_ID`.
const PX4_LAST_SYSTEM_ID: i64 = 250;

/// A larger fleet has not enough system ids for one each: those above are of ground stations.
const MOST_SYSTEM_IDS: usize = 240;

/// Departures, seconds after T0.
pub(super) const LATEST_S: RangeInclusive<f64> = 0.0..=86_400.0;
/// Planned speeds, m/s.
pub(super) const SPEED_MPS: RangeInclusive<f64> = 0.5..=100.0;

/// What an autopilot does unless told otherwise.
struct Defaults {
    climb_mps: f64,
    descent_mps: f64,
    accel_mps2: f64,
}

/// `WPNAV_SPEED_UP`, `WPNAV_SPEED_DN`, `WPNAV_ACCEL` of ArduCopter.
const ARDUCOPTER: Defaults = Defaults {
    climb_mps: 2.5,
    descent_mps: 1.5,
    accel_mps2: 2.5,
};
/// `TECS_CLMB_MAX`, `TECS_SINK_MAX` of ArduPlane, `FW_T_CLMB_MAX`, `FW_T_SINK_MAX` of PX4.
/// No parameter has the acceleration of a takeoff run; this one is gentle.
const PLANE: Defaults = Defaults {
    climb_mps: 5.0,
    descent_mps: 5.0,
    accel_mps2: 3.0,
};
/// `MPC_Z_V_AUTO_UP`, `MPC_Z_V_AUTO_DN`, `MPC_ACC_HOR` of PX4.
const PX4_COPTER: Defaults = Defaults {
    climb_mps: 3.0,
    descent_mps: 1.5,
    accel_mps2: 3.0,
};

impl Checker<'_> {
    /// Checks the fleet; vehicles that are broken are left out, and then there is an issue.
    pub(super) fn fleet(
        &mut self,
        raw: &raw::Spec,
        map: Option<&Map>,
        separation: Separation,
        wind: Option<Wind>,
    ) -> Vec<Vehicle> {
        if raw.vehicles.is_empty() && raw.fleet.is_none() {
            self.report("vehicles", "no vehicle", "at least one, here or by fleet");
        }
        self.unique(
            "vehicles",
            raw.vehicles.iter().map(|vehicle| vehicle.id.as_str()),
        );
        self.system_ids(raw);
        self.altitude_reference(raw);
        let mut vehicles = Vec::new();
        for (index, vehicle) in raw.vehicles.iter().enumerate() {
            let path = format!("vehicles[{index}]");
            if let Some(checked) = self.vehicle(&path, vehicle, map, wind) {
                vehicles.push((path, checked));
            }
        }
        self.pads(&vehicles, separation);
        vehicles.into_iter().map(|(_, vehicle)| vehicle).collect()
    }

    /// PX4 has no terrain altitudes in missions.
    fn altitude_reference(&mut self, raw: &raw::Spec) {
        let px4 = |vehicle: &&raw::Vehicle| matches!(vehicle.autopilot, raw::Autopilot::Px4);
        if let raw::AltitudeReference::Terrain = raw.mission.altitude
            && let Some(vehicle) = raw.vehicles.iter().find(px4)
        {
            let found = format!(
                "terrain, and vehicle `{}` is px4",
                vehicle.id.escape_debug()
            );
            self.report("mission.altitude", found, "amsl or relative");
        }
    }

    /// A ground station tells vehicles apart by system id alone, so a fleet that can has one
    /// for each; a larger one has one for each vehicle on a link.
    fn system_ids(&mut self, raw: &raw::Spec) {
        let is_large = raw.vehicles.len() > MOST_SYSTEM_IDS;
        let mut seen: BTreeMap<(i64, Option<&str>), &str> = BTreeMap::new();
        for (index, vehicle) in raw.vehicles.iter().enumerate() {
            let path = format!("vehicles[{index}].sysid");
            let px4 = matches!(vehicle.autopilot, raw::Autopilot::Px4);
            if !(1..=255).contains(&vehicle.sysid) {
                self.report(&path, vehicle.sysid, "1 to 255");
            } else if px4 && vehicle.sysid > PX4_LAST_SYSTEM_ID {
                let allowed = format!("at most {PX4_LAST_SYSTEM_ID} for px4");
                self.report(&path, vehicle.sysid, allowed);
            }
            // Every simulated vehicle has a link of its own.
            if is_large && vehicle.link == "sim" {
                continue;
            }
            let link = is_large.then_some(vehicle.link.as_str());
            if let Some(other) = seen.insert((vehicle.sysid, link), &vehicle.id) {
                let found = format!(
                    "{}, already the system id of `{}`",
                    vehicle.sysid,
                    other.escape_debug()
                );
                let allowed = match link {
                    Some(_) => "one system id for each vehicle on a link",
                    None => "one system id for each vehicle",
                };
                self.report(&path, found, allowed);
            }
        }
    }

    fn vehicle(
        &mut self,
        path: &str,
        raw: &raw::Vehicle,
        map: Option<&Map>,
        wind: Option<Wind>,
    ) -> Option<Vehicle> {
        let at = |key: &str| format!("{path}.{key}");
        self.file_name(&at("id"), &raw.id);
        let link = self.link(&at("link"), &raw.link);
        let start = self.end_point(&at("start"), raw.start);
        let goal = self.end_point(&at("goal"), raw.goal);
        let home = match raw.home {
            Some(home) => self.place(&at("home"), home.lat, home.lon),
            None => start.map(|start| start.place),
        };
        let own_home = home.filter(|_| raw.home.is_some());
        let (from, to) = (start.map(|end| end.place), goal.map(|end| end.place));
        self.way(&at("goal"), from, to);
        self.all_clear(
            path,
            map,
            [("start", from), ("goal", to), ("home", own_home)],
        );
        let (autopilot, lifting) = match raw.autopilot {
            raw::Autopilot::ArduPilot => (Autopilot::ArduPilot, ARDUCOPTER),
            raw::Autopilot::Px4 => (Autopilot::Px4, PX4_COPTER),
        };
        // A vtol climbs and comes down on its rotors, slower than on its wing.
        let (airframe, defaults) = match raw.airframe {
            raw::Airframe::Copter => (Airframe::Copter, lifting),
            raw::Airframe::Plane => (Airframe::Plane, PLANE),
            raw::Airframe::Vtol => (Airframe::Vtol, lifting),
        };
        let load_factor = raw.max_load_factor.unwrap_or(DEFAULT_LOAD_FACTOR);
        let climb_mps = raw.climb_mps.unwrap_or(defaults.climb_mps);
        let descent_mps = raw.descent_mps.unwrap_or(defaults.descent_mps);
        let accel_mps2 = raw.accel_mps2.unwrap_or(defaults.accel_mps2);
        let max_climb = self.optional(&at("max_climb_deg"), raw.max_climb_deg, 0.1..=89.0);
        let max_descent = self.optional(&at("max_descent_deg"), raw.max_descent_deg, 0.1..=89.0);
        let flown = Flown {
            airframe,
            speed_mps: raw.speed_mps,
            load_factor,
            descent_mps,
            wind,
            ceiling: map.map_or(Amsl(0.0), |map| map.area.max_amsl),
            way_to_start_m: from.zip(own_home).map(|(start, home)| start.chord_m(home)),
        };
        let wing = self.wing(path, raw, &flown);
        let retiming = self.retiming(path, raw);
        let opens_s = retiming.depart_s.map(|window| window.least);
        let depart_s = raw.depart_s.or(opens_s).unwrap_or(0.0);
        Some(Vehicle {
            wing,
            speed_mps: self.number(&at("speed_mps"), raw.speed_mps, SPEED_MPS),
            max_load_factor: self.number(&at("max_load_factor"), load_factor, 1.001..=10.0),
            max_climb_rad: max_climb.map(f64::to_radians),
            max_descent_rad: max_descent.map(f64::to_radians),
            climb_mps: self.number(&at("climb_mps"), climb_mps, 0.1..=50.0),
            descent_mps: self.number(&at("descent_mps"), descent_mps, 0.1..=50.0),
            accel_mps2: self.number(&at("accel_mps2"), accel_mps2, 0.1..=50.0),
            depart_s: self.number(&at("depart_s"), depart_s, LATEST_S),
            retiming,
            return_amsl: self
                .optional(&at("return_amsl_m"), raw.return_amsl_m, -500.0..=20_000.0)
                .map(Amsl),
            id: raw.id.clone(),
            sysid: u8::try_from(raw.sysid).ok()?,
            autopilot,
            airframe,
            link: link?,
            home: home?,
            start: start?,
            goal: goal?,
            finish: match raw.finish {
                raw::Finish::Land => Finish::Land,
                raw::Finish::Loiter => Finish::Loiter,
                raw::Finish::Return => Finish::Return,
            },
        })
    }

    /// There must be a way to plan between start and goal.
    fn way(&mut self, path: &str, start: Option<LatLon>, goal: Option<LatLon>) {
        let (Some(start), Some(goal)) = (start, goal) else {
            return;
        };
        let apart_m = (start.to_ecef(0.0) - goal.to_ecef(0.0)).norm();
        if apart_m < LEAST_WAY_M {
            let found = format!(
                "{} m from start",
                digits::distinct_from(apart_m, LEAST_WAY_M, 1)
            );
            self.report(path, found, format!("at least {LEAST_WAY_M} m from start"));
        }
    }

    /// Reports those places of a vehicle at which nothing may stand.
    fn all_clear(&mut self, path: &str, map: Option<&Map>, places: [(&str, Option<LatLon>); 3]) {
        let Some(map) = map else { return };
        for (key, place) in places {
            if let Some(place) = place {
                self.clear(&format!("{path}.{key}"), key, place, map);
            }
        }
    }

    fn end_point(&mut self, path: &str, raw: raw::EndPoint) -> Option<EndPoint> {
        let agl = self.optional(&format!("{path}.agl_m"), raw.agl_m, 0.0..=20_000.0);
        let amsl = self.optional(&format!("{path}.amsl_m"), raw.amsl_m, -500.0..=20_000.0);
        let place = self.place(path, raw.lat, raw.lon);
        let altitude = match (agl, amsl) {
            (Some(agl), None) => Placement::Agl(Agl(agl)),
            (None, Some(amsl)) => Placement::Amsl(Amsl(amsl)),
            (None, None) | (Some(_), Some(_)) => {
                let found = if agl.is_some() {
                    "two altitudes"
                } else {
                    "no altitude"
                };
                self.report(path, found, "either agl_m or amsl_m");
                return None;
            }
        };
        place.map(|place| EndPoint { place, altitude })
    }

    fn link(&mut self, path: &str, text: &str) -> Option<Link> {
        let link = Link::parse(text);
        if link.is_none() {
            let found = format!("link `{}`", text.escape_debug());
            self.report(path, found, Link::ALLOWED);
        }
        link
    }

    /// Two vehicles that take off in each other's separation must not do so at the same time;
    /// what their windows leave open is for the planner.
    fn pads(&mut self, vehicles: &[(String, Vehicle)], separation: Separation) {
        let pads: Vec<Vector3<f64>> = vehicles
            .iter()
            .map(|(_, vehicle)| vehicle.home.to_ecef(0.0))
            .collect();
        for (index, (path, vehicle)) in vehicles.iter().enumerate() {
            for ((_, earlier), pad) in vehicles[..index].iter().zip(&pads) {
                let apart_m = (pads[index] - pad).norm();
                let (own, other) = (vehicle.departures(), earlier.departures());
                let apart_s = (own.most - other.least).max(other.most - own.least);
                if apart_m < separation.distance_m && apart_s <= separation.time_slack_s {
                    let across_m = digits::distinct_from(apart_m, separation.distance_m, 1);
                    let found = format!(
                        "takeoff {across_m} m from `{}` and {apart_s} s apart in time",
                        earlier.id
                    );
                    let allowed = format!(
                        "at least {} m, or depart_s more than {} s apart",
                        separation.distance_m, separation.time_slack_s
                    );
                    self.report(path, found, allowed);
                }
            }
        }
    }
}

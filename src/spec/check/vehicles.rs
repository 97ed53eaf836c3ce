//! The vehicles, each alone and against each other.

mod actions;
mod altitudes;
mod ends;
mod endurance;
mod stops;
mod tasks;

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::super::keys;
use super::super::{
    AltitudeLimits, AltitudeReference, BufferedLimit, EndPoint, Finish, KnownPlace, Link,
    PlaceKind, Separation, Stop, Vehicle, Wind, turn_radius_by_load_m,
};
use super::Checker;
use super::map::Map;
use super::wing::Flown;
use crate::autopilot::{Airframe, Autopilot, MAX_LEAN_DEG, Version, facts, frame};
use crate::geodesy::{Agl, Amsl};
use crate::numeric::digits;
use ends::Ends;

/// Load factor of a bank of 30 degrees, the lean limit that copters come with.
const DEFAULT_LOAD_FACTOR: f64 = 1.15;

/// Least horizontal distance from start to goal, metres.
const MIN_START_TO_GOAL_M: f64 = 10.0;
/// Stops of a wing are this far apart at least, in radii of its circles.
const TURNS_APART: f64 = 8.0;

/// A speed that no copter flies is probably in km/h above this, m/s.
const KMH_FROM_MPS: f64 = 20.0;
/// System ids for vehicles: those above belong to ground stations.
const SYSTEM_IDS: usize = 240;

/// What a vehicle is called, and how it is reached; none where broken.
struct Identity {
    id: Option<String>,
    sysid: Option<u8>,
    autopilot: Option<Autopilot>,
    autopilot_version: Option<Version>,
    link: Option<Link>,
}

/// How far stops must be apart at least, metres: a wing needs a few turns from one to the next.
fn min_apart_m(keys: &keys::Vehicle) -> f64 {
    if !keys.airframe.unwrap_or_default().has_wing() {
        return MIN_START_TO_GOAL_M;
    }
    let load_factor = keys.max_load_factor.unwrap_or(DEFAULT_LOAD_FACTOR);
    let turn_m = turn_radius_by_load_m(keys.speed_mps.unwrap_or(0.0), load_factor);
    let circle_m = keys.loiter_radius_m.unwrap_or(turn_m).max(turn_m);
    MIN_START_TO_GOAL_M.max((TURNS_APART * circle_m).ceil())
}

/// The limits of altitude that a vehicle has, whatever else is wrong with it.
fn limits_of(keys: &keys::Vehicle, map: &Map) -> AltitudeLimits {
    let own = AltitudeLimits {
        max_agl: keys.max_agl_m.map(Agl),
        min_amsl: keys.min_amsl_m.map(Amsl),
    };
    own.tighter(map.area.altitudes)
}

/// Whether a goal may be below the least height above ground: where it is not known, it may.
fn may_drop(keys: &keys::Vehicle) -> bool {
    let lands = keys.finish.is_none_or(|finish| finish == Finish::Land);
    keys.airframe != Some(Airframe::Plane) && lands
}

impl Checker {
    /// Remembers a point of a plan, for the ground to judge.
    fn known_point(
        &mut self,
        (path, what): (&str, &'static str),
        end: Option<EndPoint>,
        altitudes: AltitudeLimits,
        can_drop: bool,
    ) {
        let Some(end) = end else { return };
        self.sites.push(KnownPlace {
            path: path.to_owned(),
            kind: PlaceKind::Airborne {
                what,
                end,
                altitudes,
                can_drop,
            },
        });
    }

    /// Checks the fleet; vehicles that are broken are left out, and then there is an issue.
    pub(super) fn vehicles(
        &mut self,
        keys: &keys::Spec,
        map: Option<&Map>,
        wind: Option<Wind>,
    ) -> Vec<Vehicle> {
        if keys.vehicles.is_empty() && keys.fleet.is_none() {
            self.report("vehicles", "no vehicle", "at least one, here or by fleet");
        }
        let ids = keys.vehicles.iter().map(|vehicle| vehicle.id.as_deref());
        self.unique("vehicles", ids);
        self.system_ids(&keys.vehicles);
        self.altitude_reference(keys);
        let mut vehicles = Vec::new();
        for (index, vehicle) in keys.vehicles.iter().enumerate() {
            let path = format!("vehicles[{index}]");
            if let Some(checked) = self.vehicle(&path, vehicle, map, wind) {
                self.flyable(&path, &checked, keys.sortie);
                if checked.stops.len() == vehicle.stops.len() {
                    self.flyable_from_stops(&path, &checked, keys.sortie);
                }
                vehicles.push((path, checked));
            }
        }
        self.wind_was_flown(&vehicles);
        let buffer_m = map.map_or(0.0, |map| map.buffers.separation_m);
        self.pads(&vehicles, keys.separation, buffer_m);
        let (paths, vehicles) = vehicles.into_iter().unzip();
        self.vehicles = paths;
        vehicles
    }

    /// Some autopilots have no terrain altitudes in missions.
    fn altitude_reference(&mut self, keys: &keys::Spec) {
        let without_terrain = |vehicle: &keys::Vehicle| {
            let autopilot = vehicle.autopilot?;
            let acceptance = facts(autopilot, vehicle.airframe.unwrap_or_default()).acceptance;
            let frames = acceptance.location_frames;
            let id = vehicle.id.as_deref().unwrap_or_default().escape_debug();
            let key = autopilot.conventions().key;
            (!frames.contains(&frame::GLOBAL_TERRAIN_ALT))
                .then(|| format!("terrain, and vehicle `{id}` is {key}"))
        };
        if keys.mission.altitude == AltitudeReference::Terrain
            && let Some(found) = keys.vehicles.iter().find_map(without_terrain)
        {
            self.report("mission.altitude", found, "amsl or relative");
        }
    }

    /// A ground station distinguishes vehicles by system id alone, so each has its own where
    /// there are enough; in a larger fleet system ids are unique on each link.
    fn system_ids(&mut self, vehicles: &[keys::Vehicle]) {
        let is_large = vehicles.len() > SYSTEM_IDS;
        let mut seen: BTreeMap<(i64, Option<&str>), &str> = BTreeMap::new();
        for (index, vehicle) in vehicles.iter().enumerate() {
            let Some(sysid) = vehicle.sysid else { continue };
            let path = format!("vehicles[{index}].sysid");
            if let Some(autopilot) = vehicle.autopilot.map(Autopilot::conventions) {
                let last = i64::from(autopilot.max_system_id);
                if (last + 1..=255).contains(&sysid) {
                    let allowed = format!("at most {last} for {}", autopilot.key);
                    self.report(&path, sysid, allowed);
                }
            }
            let link = vehicle.link.as_deref().filter(|_| is_large);
            // Every simulated vehicle has a link of its own.
            if link == Some("sim") {
                continue;
            }
            let id = vehicle.id.as_deref().unwrap_or_default();
            if let Some(other) = seen.insert((sysid, link), id) {
                let other = other.escape_debug();
                let found = format!("{sysid}, already the system id of `{other}`");
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
        keys: &keys::Vehicle,
        map: Option<&Map>,
        wind: Option<Wind>,
    ) -> Option<Vehicle> {
        let identity = self.identity(path, keys);
        let finish = self.required(path, "finish", keys.finish);
        let speed_mps = self.required(path, "speed_mps", keys.speed_mps);
        let (ends, stops) = self.ends_and_stops(path, keys, map);
        let (autopilot, speed_mps, finish) = (identity.autopilot?, speed_mps?, finish?);
        let airframe = keys.airframe.unwrap_or_default();
        let defaults = facts(autopilot, airframe).defaults;
        let flown = Flown {
            airframe,
            finish,
            speed_mps,
            load_factor: keys.max_load_factor.unwrap_or(DEFAULT_LOAD_FACTOR),
            descent_mps: keys.descent_mps.unwrap_or(defaults.descent_mps),
            wind,
            ceiling: map.map_or(Amsl(0.0), |map| map.area.max_amsl),
            home_to_start_m: ends.home_to_start_m,
        };
        let wing = self.wing(path, keys, &flown);
        let climb_mps = keys.climb_mps.unwrap_or(defaults.climb_mps);
        let endurance = self.endurance(path, keys.endurance.as_ref(), (airframe, climb_mps));
        let retiming = self.retiming(path, keys, (autopilot, airframe));
        Some(Vehicle {
            wind,
            wing,
            speed_mps,
            max_load_factor: flown.load_factor,
            max_climb_rad: keys.max_climb_deg.map(f64::to_radians),
            max_descent_rad: keys.max_descent_deg.map(f64::to_radians),
            climb_mps,
            descent_mps: flown.descent_mps,
            accel_mps2: keys.accel_mps2.unwrap_or(defaults.accel_mps2),
            max_airspeed_mps: keys.max_airspeed_mps,
            depart_s: keys.depart_s.unwrap_or_else(|| retiming.opens_s()),
            retiming,
            altitudes: self.altitudes(path, keys, map),
            endurance,
            fence_points: keys.fence_points,
            return_amsl: keys.return_amsl_m.map(Amsl),
            id: identity.id?,
            sysid: identity.sysid?,
            autopilot,
            autopilot_version: identity.autopilot_version,
            airframe,
            link: identity.link?,
            home: ends.home?,
            start: ends.start?,
            goal: ends.goal?,
            stops,
            on_way: self.on_way(path, keys),
            order: keys.order.unwrap_or_default(),
            finish,
        })
    }

    /// Where it stands, its path ends, and what it visits, far enough apart.
    fn ends_and_stops(
        &mut self,
        path: &str,
        keys: &keys::Vehicle,
        map: Option<&Map>,
    ) -> (Ends, Vec<Stop>) {
        let ends = self.ends(path, keys, map);
        let stops = self.stops(path, keys, map);
        if let (Some(start), Some(goal)) = (ends.start, ends.goal) {
            let min_m = min_apart_m(keys);
            self.stops_apart(path, keys, (start.place, goal.place), (&stops, min_m));
        }
        (ends, stops)
    }

    fn identity(&mut self, path: &str, keys: &keys::Vehicle) -> Identity {
        let at = |key: &str| format!("{path}.{key}");
        let id = self.required(path, "id", keys.id.clone());
        if let Some(id) = &id {
            self.file_name(&at("id"), id);
        }
        let sysid = self.required(path, "sysid", keys.sysid);
        let autopilot = self.required(path, "autopilot", keys.autopilot);
        let link = keys.link.as_deref();
        if link.is_none() {
            self.missing(path, "link", Link::ALLOWED.to_owned());
        }
        let version = keys.autopilot_version.as_deref();
        Identity {
            id,
            sysid: sysid.and_then(|sysid| u8::try_from(sysid).ok()),
            autopilot,
            autopilot_version: autopilot
                .and_then(|of| self.version(&at("autopilot_version"), version, of)),
            link: link.and_then(|link| self.link(&at("link"), link)),
        }
    }

    /// The speed of a copter that its autopilot cannot reach in still air at any lean angle that a
    /// plan asks for. In wind the verdict judges each leg.
    fn flyable(&mut self, path: &str, vehicle: &Vehicle, version: u32) {
        if vehicle.airframe.has_wing() && vehicle.max_airspeed_mps.is_some() {
            let found = "a greatest airspeed, on a wing: its airspeed is speed_mps";
            self.report(&format!("{path}.max_airspeed_mps"), found, "copters only");
        }
        let max_mps = vehicle.flyable_mps(Some(MAX_LEAN_DEG));
        let Some(max_mps) = max_mps.filter(|mps| version == 2 && vehicle.speeds().most > *mps)
        else {
            return;
        };
        let facts = vehicle.facts();
        let reached = facts.behaviour.lean_speed_mps.of(vehicle.autopilot_version);
        let allowed = match (vehicle.max_airspeed_mps, reached) {
            (None, Some(reached)) => format!(
                "at most {max_mps:.1} m/s: a stock {} {} reached {reached} at {:.0} degrees of lean, and a plan raises it to \
                 {MAX_LEAN_DEG:.0} at most; max_airspeed_mps states what a vehicle was flown at",
                facts.firmware, reached.version, facts.behaviour.lean_deg
            ),
            _ => format!("at most {max_mps} m/s: max_airspeed_mps"),
        };
        let key = match vehicle.retiming.speed_mps {
            Some(_) => "speed_range_mps.max",
            None => "speed_mps",
        };
        let found_mps = vehicle.speeds().most;
        let found = match found_mps > KMH_FROM_MPS {
            true => format!(
                "{found_mps} m/s: is it in km/h? Those are {:.1} m/s",
                found_mps / 3.6
            ),
            false => format!("{found_mps} m/s"),
        };
        self.report(&format!("{path}.{key}"), found, allowed);
    }

    /// The speeds from stops on, as [`Self::flyable`].
    fn flyable_from_stops(&mut self, path: &str, vehicle: &Vehicle, version: u32) {
        let max_mps = vehicle.flyable_mps(Some(MAX_LEAN_DEG));
        let Some(max_mps) = max_mps.filter(|_| version == 2) else {
            return;
        };
        for (index, stop) in vehicle.stops.iter().enumerate() {
            if let Some(speed_mps) = stop.speed_mps.filter(|mps| *mps > max_mps) {
                let path = format!("{path}.stops[{index}].speed_mps");
                let allowed = format!("at most {max_mps:.1} m/s, as speed_mps of the vehicle");
                self.report(&path, format!("{speed_mps} m/s"), allowed);
            }
        }
    }

    /// A version whose rules are known.
    fn version(&mut self, path: &str, text: Option<&str>, autopilot: Autopilot) -> Option<Version> {
        let text = text?;
        let known = autopilot.conventions().versions;
        let version = text.parse().ok().filter(|version| known.contains(version));
        if version.is_none() {
            let found = format!("`{}`", text.escape_debug());
            let names: Vec<String> = known.iter().map(Version::to_string).collect();
            let allowed = format!("{} for {}", names.join(", "), autopilot.conventions().key);
            self.report(path, found, allowed);
        }
        version
    }

    /// Reports a missing key of a vehicle; the schema does not say all that is allowed there.
    fn missing(&mut self, path: &str, key: &str, allowed: String) {
        let mut issue = self.sources.missing(path, key);
        if !self.sources.is_made(path) {
            issue.allowed = allowed;
        }
        self.issues.push(issue);
    }

    fn link(&mut self, path: &str, text: &str) -> Option<Link> {
        let link = Link::parse(text);
        if link.is_none() {
            let found = format!("link `{}`", text.escape_debug());
            self.report(path, found, Link::ALLOWED);
        }
        link
    }

    /// Two vehicles that take off in each other's separation must not do so at the same time.
    /// The planner chooses among the departures that their windows leave open.
    fn pads(&mut self, vehicles: &[(String, Vehicle)], separation: Separation, buffer_m: f64) {
        let distance_m = separation.distance_m + buffer_m;
        let pads: Vec<Vector3<f64>> = vehicles
            .iter()
            .map(|(_, vehicle)| vehicle.home.to_ecef(0.0))
            .collect();
        for (index, (path, vehicle)) in vehicles.iter().enumerate() {
            for ((_, earlier), pad) in vehicles[..index].iter().zip(&pads) {
                let apart_m = (pads[index] - pad).norm();
                let (own, other) = (vehicle.departures(), earlier.departures());
                let apart_s = (own.most - other.least).max(other.most - own.least);
                if apart_m < distance_m && apart_s <= separation.time_slack_s {
                    let across_m = digits::distinct_from(apart_m, distance_m, 1);
                    let found = format!(
                        "takeoff {across_m} m from `{}` and {apart_s} s apart in time",
                        earlier.id
                    );
                    let limit = BufferedLimit {
                        key: "separation",
                        of: "separation.distance_m",
                        limit_m: separation.distance_m,
                        buffered_m: distance_m,
                    };
                    let least = match apart_m < separation.distance_m {
                        true => format!("at least {distance_m} m"),
                        false => limit.allowed(apart_m),
                    };
                    let slack_s = separation.time_slack_s;
                    let allowed = format!("{least}, or depart_s more than {slack_s} s apart");
                    self.report(path, found, allowed);
                }
            }
        }
    }
}

//! One vehicle's paths as a mission.

mod clearance;
pub(super) mod encode;
pub(super) mod fence;
pub(super) mod legs;
pub(super) mod simplify;
pub(super) mod stops;
pub(super) mod wing;

use super::accept::MissionType;
use super::item::{Item, VehicleMission};
use super::params::parameters;
use crate::autopilot::{command, frame};
use crate::geodesy::PlanPoint;
use crate::path::{TimedPoint, VehicleLimits, route_ends};
use crate::spec::{AltitudeReference, Autopilot, Finish, MissionSpec, Vehicle};
use crate::world::{Departure, Layer, NoData, VehicleSites, World};
use clearance::strictness;
use encode::{ENCODING_M, Encoder};
use legs::{Keep, Point};
use simplify::waypoints;

/// Why a path cannot become a mission.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MissionError {
    /// There is no vehicle of that index.
    #[error("no vehicle {index}: the spec has {fleet}")]
    NoSuchVehicle {
        /// Index asked for.
        index: usize,
        /// Vehicles in the spec.
        fleet: usize,
    },
    /// A vehicle needs one route, and one more to return.
    #[error("vehicle {vehicle}: {found} routes (allowed: {needed}, each of at least two points)")]
    Routes {
        /// Id.
        vehicle: String,
        /// Routes of at least two points.
        found: usize,
        /// Routes needed.
        needed: usize,
    },
    /// A point of a route is not a number.
    #[error("vehicle {vehicle}: point {point} of route {route} is not finite")]
    NotFinite {
        /// Id.
        vehicle: String,
        /// Route, from 0.
        route: usize,
        /// Point, from 0.
        point: usize,
    },
    /// PX4 has no terrain frame.
    #[error("vehicle {vehicle}: PX4 refuses altitudes above terrain (allowed: amsl, relative)")]
    TerrainOnPx4 {
        /// Id.
        vehicle: String,
    },
    /// No ground under an item whose altitude depends on it.
    #[error("vehicle {vehicle}: {source}")]
    NoGround {
        /// Id.
        vehicle: String,
        /// Where.
        source: NoData,
    },
    /// More items than the spec or the autopilot allows.
    #[error("vehicle {vehicle}: {count} {list} items (allowed: {limit}, {why})")]
    TooManyItems {
        /// Id.
        vehicle: String,
        /// Which list.
        list: MissionType,
        /// Items needed.
        count: usize,
        /// Items allowed.
        limit: usize,
        /// Who allows no more.
        why: &'static str,
    },
}

/// Where the mission must stop on its way the vehicle waits this long, seconds:
/// a hold makes both autopilots come to rest instead of cutting the corner.
const HOLD_S: f32 = 1.0;

/// Encodes the routes of one vehicle.
///
/// `routes` are those between [`route_ends`], each at least two points; the vehicle rests between
/// them, at its stops and where it turns back. Waypoints keep `mission.tolerance_m` to them in three
/// dimensions, the arcs at corners included; where corners are too tight for the
/// turn radius the mission misses them least, and the verdict will say so. Waypoints
/// of turns join the routes of a plane or vtol to its takeoff and landing.
/// Altitudes are whole quarters of a metre, rounded up.
///
/// # Errors
/// [`MissionError`]; a path that is bad to fly is none.
pub fn build(
    spec: &MissionSpec,
    world: &World,
    vehicle: usize,
    routes: &[Vec<TimedPoint>],
) -> Result<VehicleMission, MissionError> {
    let known = spec.vehicles.get(vehicle).zip(world.sites.get(vehicle));
    let needed = known.map_or(1, |(vehicle, sites)| route_ends(vehicle, sites).len());
    build_course(spec, world, vehicle, routes, needed)
}

/// The same for a vehicle that has `needed` routes before it, and comes to rest between them.
///
/// # Errors
/// As [`build`].
pub fn build_course(
    spec: &MissionSpec,
    world: &World,
    vehicle: usize,
    routes: &[Vec<TimedPoint>],
    needed: usize,
) -> Result<VehicleMission, MissionError> {
    let no_such = || MissionError::NoSuchVehicle {
        index: vehicle,
        fleet: spec.vehicles.len(),
    };
    let sites = world.sites.get(vehicle).ok_or_else(no_such)?;
    let layer = world.layer(vehicle);
    let vehicle = spec.vehicles.get(vehicle).ok_or_else(no_such)?;
    check(spec, vehicle, routes, needed)?;
    let (reference, ground) = (spec.mission.altitude, sites.home.amsl);
    let encoder = Encoder::new(world, reference, vehicle.home, ground);
    let writer = ItemWriter {
        spec,
        vehicle,
        encoder: &encoder,
        limits: (world, layer),
    };
    let no_ground = |source| MissionError::NoGround {
        vehicle: vehicle.id.clone(),
        source,
    };
    let items = if vehicle.airframe.has_wing() {
        writer.winged_items(sites, routes)
    } else {
        writer.items(sites, routes)
    };
    let items = items.map_err(no_ground)?;
    let rally = fence::rally(spec, world, &encoder).map_err(no_ground)?;
    let (fence, mut notes) = fenced(spec, vehicle, &items);
    notes.extend(wing::landing_course_note(vehicle, sites));
    let params = parameters(
        vehicle,
        &spec.mission,
        &items,
        encoder.home_amsl().0,
        (!fence.is_empty()).then(|| spec.fence_margin_m()),
        spec.airspeed_mps(vehicle),
    );
    let mission = VehicleMission {
        autopilot_version: vehicle.autopilot_version,
        autopilot: vehicle.autopilot,
        airframe: vehicle.airframe,
        home: encoder.home(),
        items,
        fence,
        is_fence_known: true,
        rally,
        params,
        notes,
    };
    count(spec, vehicle, &mission)?;
    Ok(mission)
}

/// The fence of a vehicle that flies some items, if it has one, and what an operator must know of it.
fn fenced(spec: &MissionSpec, vehicle: &Vehicle, items: &[Item]) -> (Vec<Item>, Vec<String>) {
    match spec.mission.fence {
        true => fence::fence(spec, vehicle, items),
        false => (Vec::new(), Vec::new()),
    }
}

/// What can be refused before anything is encoded.
fn check(
    spec: &MissionSpec,
    vehicle: &Vehicle,
    routes: &[Vec<TimedPoint>],
    needed: usize,
) -> Result<(), MissionError> {
    let found = routes.iter().filter(|route| route.len() >= 2).count();
    if found != needed || routes.len() != needed {
        return Err(MissionError::Routes {
            vehicle: vehicle.id.clone(),
            found,
            needed,
        });
    }
    for (index, route) in routes.iter().enumerate() {
        let lost = route.iter().position(|sample| {
            let PlanPoint { at, amsl } = sample.point;
            !(at.east_m.is_finite() && at.north_m.is_finite() && amsl.0.is_finite())
        });
        if let Some(point) = lost {
            return Err(MissionError::NotFinite {
                vehicle: vehicle.id.clone(),
                route: index,
                point,
            });
        }
    }
    let frames = vehicle.facts().acceptance.location_frames;
    let has_terrain = frames.contains(&frame::GLOBAL_TERRAIN_ALT);
    if !has_terrain && spec.mission.altitude == AltitudeReference::Terrain {
        return Err(MissionError::TerrainOnPx4 {
            vehicle: vehicle.id.clone(),
        });
    }
    Ok(())
}

/// Holds the three lists against what the spec and the autopilot allow.
fn count(
    spec: &MissionSpec,
    vehicle: &Vehicle,
    mission: &VehicleMission,
) -> Result<(), MissionError> {
    let allowed = vehicle.facts().capacity;
    let storage = "the autopilot's storage";
    let (items, fence, rally) = (&mission.items, &mission.fence, &mission.rally);
    let max_items = spec.mission.max_items;
    let too_many = [
        (MissionType::Mission, items, max_items, "mission.max_items"),
        (MissionType::Mission, items, allowed.items, storage),
        (MissionType::Fence, fence, vehicle.fence_capacity(), storage),
        (MissionType::Rally, rally, allowed.rally, storage),
    ]
    .into_iter()
    .find(|(_, items, limit, _)| items.len() > *limit);
    match too_many {
        Some((list, items, limit, why)) => Err(MissionError::TooManyItems {
            vehicle: vehicle.id.clone(),
            list,
            count: items.len(),
            limit,
            why,
        }),
        None => Ok(()),
    }
}

/// Writes the items of one mission.
pub(super) struct ItemWriter<'a> {
    pub(super) spec: &'a MissionSpec,
    pub(super) vehicle: &'a Vehicle,
    pub(super) encoder: &'a Encoder<'a>,
    /// What its routes keep.
    limits: (&'a World, Layer),
}

impl ItemWriter<'_> {
    fn items(&self, sites: &VehicleSites, routes: &[Vec<TimedPoint>]) -> Result<Vec<Item>, NoData> {
        let mut legs = routes
            .iter()
            .enumerate()
            .map(|(number, route)| self.route(number, route))
            .collect::<Result<Vec<_>, NoData>>()?
            .into_iter();
        let out = legs.next().unwrap_or_default();
        let Some((&start, onward)) = out.split_first() else {
            return Ok(self.departure());
        };
        let mut items = match sites.departure {
            Departure::Ground => self.takeoff(sites.home, start)?,
            Departure::Airborne { .. } => self.speed().into_iter().collect(),
        };
        items.extend(self.vehicle.on_way.trigger_m.map(stops::trigger));
        let to_goal = match self.vehicle.finish {
            Finish::Return => routes.len().min(self.vehicle.stops.len() + 1),
            Finish::Land | Finish::Loiter => routes.len(),
        };
        let mut last = start;
        let mut leg = onward.to_vec();
        for number in 0.. {
            let next = legs.next();
            for (index, &point) in leg.iter().enumerate() {
                let is_end = index + 1 == leg.len();
                let stop = match (is_end, number + 1 == to_goal) {
                    (true, true) => self.vehicle.goal_stop(),
                    (true, false) => self.vehicle.stops.get(number).cloned(),
                    (false, _) => None,
                };
                match stop {
                    Some(stop) => items.extend(self.stop(&stop, point)?),
                    None => {
                        let rests = is_end && next.is_some();
                        let hold_s = if rests { HOLD_S } else { 0.0 };
                        items.push(self.at(command::NAV_WAYPOINT, hold_s, point)?);
                    }
                }
                last = point;
            }
            if number + 1 == to_goal {
                items.extend(self.trigger_off());
            }
            match next {
                Some(points) => leg = points[points.len().min(1)..].to_vec(),
                None => break,
            }
        }
        items.push(match self.vehicle.finish {
            Finish::Land => self.at(command::NAV_LAND, 0.0, self.encoder.on_ground(last)?)?,
            Finish::Loiter => self.at(command::NAV_LOITER_UNLIM, 0.0, last)?,
            Finish::Return => self.at(command::NAV_LAND, 0.0, sites.home)?,
        });
        Ok(items)
    }

    /// From home to rest at the start.
    fn takeoff(&self, home: PlanPoint, start: PlanPoint) -> Result<Vec<Item>, NoData> {
        let mut items = self.departure();
        // Both autopilots climb straight up from where they stand and come to rest.
        let above_home = PlanPoint {
            at: home.at,
            amsl: start.amsl,
        };
        items.push(self.at(command::NAV_TAKEOFF, 0.0, above_home)?);
        items.extend(self.speed());
        if let Some(stop) = self.vehicle.start_stop() {
            items.extend(self.stop(&stop, start)?);
        } else if !self.encoder.is_over_home(start) {
            items.push(self.at(command::NAV_WAYPOINT, HOLD_S, start)?);
        }
        Ok(items)
    }

    /// The last picture along the way, if there are any.
    pub(super) fn trigger_off(&self) -> Option<Item> {
        let trigger_m = self.vehicle.on_way.trigger_m;
        trigger_m.map(|_| stops::trigger(0.0))
    }

    /// Waits on the ground. The other parameters would be a time of day; -1 means none.
    pub(super) fn departure(&self) -> Vec<Item> {
        if self.vehicle.depart_s > 0.0 {
            let delay_s = float(self.vehicle.depart_s);
            vec![Item::without_place(
                command::NAV_DELAY,
                [delay_s, -1.0, -1.0, -1.0],
            )]
        } else {
            Vec::new()
        }
    }

    /// Sets the speed, where a mission can: over the ground, on a wing through the air.
    fn speed(&self) -> Option<Item> {
        let conventions = self.vehicle.autopilot.conventions();
        let speed_mps = self.vehicle.speed_mps;
        conventions
            .speed_in_mission
            .then(|| self.change_speed(speed_mps))
    }

    /// Changes the speed from the next leg on.
    fn change_speed(&self, speed_mps: f64) -> Item {
        let kind = if self.vehicle.wing.is_some() {
            0.0
        } else {
            1.0
        };
        let speed_mps = float(speed_mps);
        Item::without_place(command::DO_CHANGE_SPEED, [kind, speed_mps, -1.0, 0.0])
    }

    /// An item whose `param4` is a heading: PX4 keeps its own with NaN, ArduPilot drops it.
    pub(super) fn at(&self, command: u16, hold_s: f32, point: PlanPoint) -> Result<Item, NoData> {
        let heading = self.vehicle.autopilot.conventions().no_heading;
        self.encoder
            .item(command, [hold_s, 0.0, 0.0, heading], point)
    }

    /// The samples of a route that become waypoints; `number` counts the routes of the vehicle.
    ///
    /// Between waypoints an autopilot interpolates the altitude in the frame of the
    /// items, so the tolerance holds in the reference of the mission.
    pub(super) fn route(
        &self,
        number: usize,
        route: &[TimedPoint],
    ) -> Result<Vec<PlanPoint>, NoData> {
        let chosen = self.waypoints(number, route, &[])?;
        Ok(chosen.into_iter().map(|index| route[index].point).collect())
    }

    /// The indices of those samples, some of them given.
    pub(super) fn waypoints(
        &self,
        number: usize,
        route: &[TimedPoint],
        through: &[usize],
    ) -> Result<Vec<usize>, NoData> {
        let path = route
            .iter()
            .map(|sample| {
                let at = sample.point.at;
                Ok(Point::new(
                    at.east_m,
                    at.north_m,
                    self.encoder.height_m(sample.point)?,
                ))
            })
            .collect::<Result<Vec<Point>, NoData>>()?;
        let tolerance_m = self.spec.mission.tolerance_m;
        let keep = Keep {
            tolerance_m: (tolerance_m - ENCODING_M).max(tolerance_m / 2.0),
            limits: VehicleLimits::of(&self.vehicle.on_route(number)),
            zero: self.encoder.zero(),
        };
        let strictness = match self.spec.passes_limits_closely(self.vehicle) {
            true => strictness(self.limits, route, keep.tolerance_m),
            false => self.encoder.strictness(route, keep.tolerance_m),
        };
        let chosen = waypoints((&path, &strictness), through, &keep);
        Ok(match self.vehicle.autopilot {
            Autopilot::ArduPilot => self.without_bends(&path, chosen),
            Autopilot::Px4 => chosen,
        })
    }

    /// With more samples where a leg is so long that the map of ArduPilot bends it.
    fn without_bends(&self, path: &[Point], chosen: Vec<usize>) -> Vec<usize> {
        // Samples are not where a leg would be cut.
        let longest_m = 0.9 * self.encoder.straight_m();
        let mut all: Vec<usize> = chosen.first().copied().into_iter().collect();
        for pair in chosen.windows(2) {
            let away_m = |to: usize| (path[to] - path[pair[0]]).xy().norm();
            let parts = (away_m(pair[1]) / longest_m).ceil();
            let mut part = 1.0;
            for index in pair[0] + 1..pair[1] {
                if part < parts && away_m(index) >= part / parts * away_m(pair[1]) {
                    all.push(index);
                    part += 1.0;
                }
            }
            all.push(pair[1]);
        }
        all
    }
}

pub(super) fn float(value: f64) -> f32 {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "parameters are float32 on the wire"
    )]
    let value = value as f32;
    value
}

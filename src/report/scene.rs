//! The shapes that the views of a report draw, in planning coordinates: rounded and
//! simplified, so that a page stays small for any fleet.

use serde::Serialize;

use super::ReviewInput;
use super::documents::{rounded, whole_path};
use super::flown::{FlownFacts, FlownShape};
use super::relief::{Bounds, Relief};
use super::simplify::{Fix, simplify};
use crate::geodesy::{Amsl, EastNorth, LatLon, PlanPoint};
use crate::mission::{Item, VehicleMission, command, frame};
use crate::spec::{Finish, Vehicle};
use crate::verify::{Moment, Track};
use crate::world::World;

/// Fixes of all tracks together, samples of ground, and waypoints: a page of
/// 1000 vehicles stays under 3 MB.
const MAX_FIXES: usize = 24_000;
const MAX_GROUND_SAMPLES: usize = 36_000;
const MAX_WAYPOINTS: usize = 12_000;
/// Fixes of one track: the corners of a survey of a day.
const MAX_FIXES_EACH: usize = 6000;
/// How far rounding to decimetres moves a point at most, metres.
const ROUNDING_M: f64 = 0.087;

/// Everything that the views draw.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Scene {
    pub(super) bounds: Bounds,
    pub(super) relief: Relief,
    /// Latitude and longitude of the origin, degrees.
    origin: [f64; 2],
    min_agl_m: f64,
    max_amsl_m: f64,
    separation: SeparationLimit,
    pub(super) area: Vec<[f64; 2]>,
    pub(super) threats: Vec<ThreatShape>,
    pub(super) zones: Vec<ZoneShape>,
    pub(super) rally: Vec<[f64; 2]>,
    pub(super) vehicles: Vec<VehicleShape>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct SeparationLimit {
    /// None if nothing was held against it.
    distance_m: Option<f64>,
    vertical_m: Option<f64>,
    slack_s: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct ThreatShape {
    pub(super) id: String,
    pub(super) kind: String,
    pub(super) at: [f64; 2],
    pub(super) radius_m: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct ZoneShape {
    pub(super) id: String,
    pub(super) ring: Vec<[f64; 2]>,
    pub(super) below_m: Option<f64>,
}

/// One vehicle: points are east, north, altitude.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct VehicleShape {
    pub(super) id: String,
    pub(super) home: [f64; 3],
    pub(super) start: [f64; 3],
    pub(super) goal: [f64; 3],
    /// Whether it flies a planned path home from the goal.
    returns: bool,
    pub(super) track: TrackShape,
    /// Ground under the track at equal steps of distance, from its beginning.
    ground: GroundShape,
    /// East, north, altitude, and the row of the item.
    pub(super) waypoints: Vec<(f64, f64, f64, usize)>,
    /// The plan under what was flown, on the page of a flight.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) flown: Option<FlownShape>,
    /// How far any point of the trajectory is from the drawn track at most, metres.
    pub(super) drawn_within_m: f64,
    /// How its motion ends; none without a track.
    #[serde(skip)]
    pub(super) end: Option<Ending>,
    /// Length of the trajectory, metres, not of the drawn track.
    #[serde(skip)]
    pub(super) length_m: f64,
}

/// How the motion of a vehicle ends, seconds after T0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Ending {
    /// On the ground.
    Down { t_s: f64 },
    /// It reaches its last place then, and stays there in the air.
    Stays { from_s: f64 },
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(super) struct TrackShape {
    pub(super) e: Vec<f64>,
    pub(super) n: Vec<f64>,
    pub(super) z: Vec<f64>,
    pub(super) t: Vec<f64>,
    pub(super) item: Vec<usize>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
struct GroundShape {
    step_m: f64,
    amsl_m: Vec<Option<f64>>,
}

impl Scene {
    pub(super) fn new(input: &ReviewInput<'_>) -> Self {
        let (spec, world) = (input.spec, input.world);
        let flat = |at: EastNorth| [metres(at.east_m), metres(at.north_m)];
        let vehicles: Vec<VehicleShape> = spec
            .vehicles
            .iter()
            .enumerate()
            .map(|(index, vehicle)| vehicle_shape(input, index, vehicle))
            .collect();
        let mut margins = input.review.margins.iter();
        let is_held = margins.any(|margin| margin.what == "separation");
        let bounds = bounds(world, &vehicles);
        let origin = world.frame.origin();
        Self {
            relief: Relief::sample(world, &bounds),
            bounds,
            origin: [origin.lat_deg, origin.lon_deg],
            min_agl_m: metres(world.min_agl.0),
            max_amsl_m: metres(world.max_amsl.0),
            separation: SeparationLimit {
                distance_m: is_held.then_some(spec.separation.distance_m),
                vertical_m: spec.separation.vertical_m,
                slack_s: spec.separation.time_slack_s,
            },
            area: ring(&world.area),
            threats: spec
                .threats
                .iter()
                .zip(&world.threats)
                .map(|(threat, disc)| ThreatShape {
                    id: threat.id.clone(),
                    kind: threat.kind.clone(),
                    at: flat(disc.center),
                    radius_m: metres(disc.radius_m),
                })
                .collect(),
            zones: spec
                .no_fly
                .iter()
                .zip(&world.zones)
                .map(|(zone, shape)| ZoneShape {
                    id: zone.id.clone(),
                    ring: ring(&shape.outline),
                    below_m: shape.below.map(|amsl| metres(amsl.0)),
                })
                .collect(),
            rally: spec
                .rally
                .iter()
                .map(|rally| flat(world.frame.to_plan(rally.place)))
                .collect(),
            vehicles,
        }
    }
}

impl Scene {
    /// Puts the plan of a vehicle under what it flew.
    pub(super) fn lay_under(&mut self, facts: &FlownFacts) {
        let mut vehicles = self.vehicles.iter_mut();
        if let Some(vehicle) = vehicles.find(|vehicle| vehicle.id == facts.vehicle) {
            vehicle.flown = Some(FlownShape::new(facts));
        }
    }
}

impl VehicleShape {
    /// Seconds from the first fix until it is down, or where it stays; none
    /// without a track.
    pub(super) fn duration_s(&self) -> Option<f64> {
        let end_s = match self.end? {
            Ending::Down { t_s } => t_s,
            Ending::Stays { from_s } => from_s,
        };
        Some(end_s - self.track.t.first()?)
    }

    /// Whether it is still in the air when all others are down.
    pub(super) fn stays(&self) -> bool {
        matches!(self.end, Some(Ending::Stays { .. }))
    }
}

impl TrackShape {
    fn new(fixes: &[Fix]) -> Self {
        let column = |value: fn(&Fix) -> f64| fixes.iter().map(|fix| metres(value(fix))).collect();
        Self {
            e: column(|fix| fix.east_m),
            n: column(|fix| fix.north_m),
            z: column(|fix| fix.amsl_m),
            t: column(|fix| fix.t_s),
            item: fixes.iter().map(|fix| fix.item).collect(),
        }
    }
}

/// The area, and what lies or flies around it, as far as a quarter of its size.
fn bounds(world: &World, vehicles: &[VehicleShape]) -> Bounds {
    let mut area = Bounds::NONE;
    for [east_m, north_m] in ring(&world.area) {
        area.include(EastNorth { east_m, north_m });
    }
    let size_m = area.width_m().max(area.height_m());
    let most = area.padded(0.25 * size_m);
    let mut bounds = area;
    for vehicle in vehicles {
        let corners = [vehicle.home, vehicle.start, vehicle.goal];
        let stations = corners.map(|[e, n, _]| (e, n));
        let track = &vehicle.track;
        let flown = track.e.iter().zip(&track.n).map(|(e, n)| (*e, *n));
        for (east_m, north_m) in flown.chain(stations) {
            bounds.include(most.clamp(EastNorth { east_m, north_m }));
        }
    }
    bounds.padded(0.015 * size_m)
}

fn ring(polygon: &geo::Polygon<f64>) -> Vec<[f64; 2]> {
    polygon
        .exterior()
        .coords()
        .map(|corner| [metres(corner.x), metres(corner.y)])
        .collect()
}

fn vehicle_shape(input: &ReviewInput<'_>, index: usize, vehicle: &Vehicle) -> VehicleShape {
    let world = input.world;
    let share = |all: usize, least: usize| (all / input.spec.vehicles.len().max(1)).max(least);
    let point = |point: PlanPoint| {
        [
            metres(point.at.east_m),
            metres(point.at.north_m),
            metres(point.amsl.0),
        ]
    };
    let whole = fixes(input, index, vehicle);
    let (simplified, error_m) = simplify(&whole, share(MAX_FIXES, 12).min(MAX_FIXES_EACH));
    let track = TrackShape::new(&simplified);
    let mission = input.missions.iter().find(|(of, _)| *of == index);
    let waypoints = mission.map_or_else(Vec::new, |(_, mission)| waypoints(mission, world));
    let too_many = waypoints.len() > share(MAX_WAYPOINTS, 0);
    let stations = world.stations.get(index);
    let station = |pick: fn(&crate::world::Stations) -> PlanPoint| {
        stations.map_or([0.0; 3], |stations| point(pick(stations)))
    };
    VehicleShape {
        id: vehicle.id.clone(),
        home: station(|stations| stations.home),
        start: station(|stations| stations.start),
        goal: station(|stations| stations.goal),
        returns: vehicle.finish == Finish::Return,
        ground: ground_under(&track, world, share(MAX_GROUND_SAMPLES, 24).min(600)),
        track,
        waypoints: if too_many { Vec::new() } else { waypoints },
        flown: None,
        drawn_within_m: ((error_m + ROUNDING_M) * 10.0).ceil() / 10.0,
        end: ending(&whole, world, vehicle),
        length_m: whole
            .windows(2)
            .map(|pair| {
                (pair[1].east_m - pair[0].east_m)
                    .hypot(pair[1].north_m - pair[0].north_m)
                    .hypot(pair[1].amsl_m - pair[0].amsl_m)
            })
            .sum(),
    }
}

/// Where the vehicle is over time: as reviewed, else as planned, else nowhere.
fn fixes(input: &ReviewInput<'_>, index: usize, vehicle: &Vehicle) -> Vec<Fix> {
    let world = input.world;
    let fix = |at: EastNorth, amsl: Amsl, t_s: f64, item: usize| Fix {
        east_m: at.east_m,
        north_m: at.north_m,
        amsl_m: amsl.0,
        t_s,
        item,
    };
    let of_moment = |moment: &Moment| {
        fix(
            world.frame.to_plan(moment.place),
            moment.amsl,
            moment.t_s,
            moment.item,
        )
    };
    let reviewed = |track: &&Track| track.vehicle == vehicle.id && !track.moments.is_empty();
    let found: Vec<Fix> = match input.review.tracks.iter().find(reviewed) {
        Some(track) => track.moments.iter().map(of_moment).collect(),
        None => input
            .plan
            .and_then(|plan| plan.vehicles.get(index))
            .map_or_else(Vec::new, |planned| {
                whole_path(&planned.routes)
                    .map(|timed| fix(timed.point.at, timed.point.amsl, timed.t_s, 0))
                    .collect()
            }),
    };
    let known = |fix: &Fix| {
        [fix.east_m, fix.north_m, fix.amsl_m, fix.t_s]
            .iter()
            .all(|value| value.is_finite())
    };
    found.into_iter().filter(known).collect()
}

/// Above ground by more than this at the end is in the air, metres.
const ON_GROUND_M: f64 = 2.0;
/// Nearer than this to the last place is there, metres.
const THERE_M: f64 = 0.5;

/// What the end of the track shows; over unknown ground, what the spec says.
fn ending(fixes: &[Fix], world: &World, vehicle: &Vehicle) -> Option<Ending> {
    let last = fixes.last()?;
    let at = |fix: &Fix| EastNorth {
        east_m: fix.east_m,
        north_m: fix.north_m,
    };
    let stays = match ground_m(world, at(last)) {
        Some(ground_m) => last.amsl_m - ground_m > ON_GROUND_M,
        None => vehicle.finish == Finish::Loiter,
    };
    if !stays {
        return Some(Ending::Down { t_s: last.t_s });
    }
    let there = |fix: &&Fix| at(fix).distance_m(at(last)).hypot(fix.amsl_m - last.amsl_m) < THERE_M;
    let arrival = fixes.iter().rev().take_while(there).last()?;
    Some(Ending::Stays {
        from_s: arrival.t_s,
    })
}

/// The true ground along the drawn track.
fn ground_under(track: &TrackShape, world: &World, most: usize) -> GroundShape {
    let leg_m = |at: usize| (track.e[at] - track.e[at - 1]).hypot(track.n[at] - track.n[at - 1]);
    let length_m: f64 = (1..track.e.len()).map(leg_m).sum();
    let steps = u32::try_from(most).unwrap_or(u32::MAX).max(2) - 1;
    let step_m = (length_m / f64::from(steps)).max(1.0);
    let mut ground = GroundShape {
        step_m,
        amsl_m: Vec::with_capacity(most),
    };
    let mut next_m = 0.0;
    let mut begin_m = 0.0;
    for at in 1..track.e.len() {
        let leg_m = leg_m(at);
        while next_m <= begin_m + leg_m && leg_m > 0.0 {
            let share = (next_m - begin_m) / leg_m;
            let place = EastNorth {
                east_m: track.e[at - 1] + (track.e[at] - track.e[at - 1]) * share,
                north_m: track.n[at - 1] + (track.n[at] - track.n[at - 1]) * share,
            };
            ground.amsl_m.push(ground_m(world, place));
            next_m += step_m;
        }
        begin_m += leg_m;
    }
    if let (Some(e), Some(n)) = (track.e.last(), track.n.last()) {
        let place = EastNorth {
            east_m: *e,
            north_m: *n,
        };
        ground.amsl_m.push(ground_m(world, place));
    }
    ground
}

fn ground_m(world: &World, at: EastNorth) -> Option<f64> {
    let amsl = world.terrain.height(world.frame.from_plan(at)).ok()?;
    rounded(amsl.0, 10.0)
}

/// Places of the items that name one, with their altitude above the sea.
fn waypoints(mission: &VehicleMission, world: &World) -> Vec<(f64, f64, f64, usize)> {
    mission
        .items
        .iter()
        .enumerate()
        .filter(|(_, item)| {
            item.command <= command::NAV_TAKEOFF || item.command == 84 || item.command == 85
        })
        .filter(|(_, item)| (item.x, item.y) != (0, 0))
        .filter_map(|(row, item)| {
            let place = item.place()?;
            let amsl_m = altitude_m(item, mission, world, place)?;
            let at = world.frame.to_plan(place);
            Some((
                metres(at.east_m),
                metres(at.north_m),
                metres(amsl_m),
                row + 1,
            ))
        })
        .collect()
}

/// The altitude of an item above the sea; landings are on the ground.
fn altitude_m(item: &Item, mission: &VehicleMission, world: &World, place: LatLon) -> Option<f64> {
    let ground_m = || Some(world.terrain.height(place).ok()?.0);
    if matches!(item.command, command::NAV_LAND | 85) {
        return ground_m();
    }
    let reference_m = match frame::canonical(item.frame) {
        frame::GLOBAL_RELATIVE_ALT => f64::from(mission.home.amsl_m),
        frame::GLOBAL_TERRAIN_ALT => ground_m()?,
        _ => 0.0,
    };
    let amsl_m = reference_m + f64::from(item.z);
    amsl_m.is_finite().then_some(amsl_m)
}

/// To the decimetre; what is not a number is drawn at 0.
fn metres(value: f64) -> f64 {
    rounded(value, 10.0).unwrap_or(0.0)
}

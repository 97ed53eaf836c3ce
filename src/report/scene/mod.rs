//! The shapes that the views of a report draw, in planning coordinates: rounded and
//! simplified, so that a page stays small for any fleet.

mod flown;
mod relief;
mod simplify;
mod track;

use serde::Serialize;

use crate::geodesy::{Agl, Amsl, EastNorth, LatLon, PlanPoint};
use crate::mission::{Item, VehicleMission, command, frame};
use crate::report::{ReviewInput, words};
use crate::spec::{
    Arrival, Finish, MissionSpec, Placement, Stop, SweepShape, Vehicle, Zone, dome_of,
};
use crate::verify::Limit;
use crate::world::{PlanZone, World};
use flown::FlownShape;
pub use flown::{FlownError, FlownFacts, ServedFacts};
pub(in crate::report) use relief::{Bounds, Relief, round_step};
use simplify::simplify;
pub(in crate::report) use track::{Ending, TrackShape};
use track::{GroundShape, ending, fixes, ground_under, metres};

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
pub(in crate::report) struct Scene {
    pub(in crate::report) bounds: Bounds,
    pub(in crate::report) relief: Relief,
    /// Latitude and longitude of the origin, degrees.
    origin: [f64; 2],
    min_agl_m: f64,
    max_amsl_m: f64,
    separation: SeparationLimit,
    pub(in crate::report) area: Vec<[f64; 2]>,
    pub(in crate::report) threats: Vec<ThreatShape>,
    pub(in crate::report) zones: Vec<ZoneShape>,
    pub(in crate::report) rally: Vec<[f64; 2]>,
    /// Outlines of what tasks cover, holes too.
    #[serde(skip)]
    pub(in crate::report) covered: Vec<(String, Vec<[f64; 2]>)>,
    /// Where the paths of a failed plan violate a limit most, and which.
    #[serde(skip)]
    pub(in crate::report) violations: Vec<([f64; 2], String)>,
    pub(in crate::report) vehicles: Vec<VehicleShape>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct SeparationLimit {
    /// None if nothing was held against it.
    distance_m: Option<f64>,
    vertical_m: Option<f64>,
    slack_s: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub(in crate::report) struct ThreatShape {
    pub(in crate::report) id: String,
    pub(in crate::report) kind: String,
    pub(in crate::report) at: [f64; 2],
    pub(in crate::report) radius_m: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub(in crate::report) struct ZoneShape {
    pub(in crate::report) id: String,
    /// What is written in its middle: once for all spans of a line and all layers of a dome.
    pub(in crate::report) name: Option<String>,
    /// Between which heights it is closed, behind its name on the map.
    #[serde(skip)]
    pub(in crate::report) heights: String,
    pub(in crate::report) ring: Vec<[f64; 2]>,
    pub(in crate::report) below_m: Option<f64>,
}

/// A place that a vehicle visits, and what it does there.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(in crate::report) struct StopShape {
    /// East, north, altitude.
    pub(in crate::report) at: [f64; 3],
    /// Its id, how long the vehicle stays, and its actions.
    pub(in crate::report) text: String,
}

/// One vehicle: points are east, north, altitude.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(in crate::report) struct VehicleShape {
    pub(in crate::report) id: String,
    pub(in crate::report) home: [f64; 3],
    pub(in crate::report) start: [f64; 3],
    pub(in crate::report) goal: [f64; 3],
    /// Its stops, those apart between which lines are flown.
    pub(in crate::report) stops: Vec<StopShape>,
    /// Whether it flies a planned path home from the goal.
    returns: bool,
    pub(in crate::report) track: TrackShape,
    /// Ground under the track at equal steps of distance, from its beginning.
    ground: GroundShape,
    /// East, north, altitude, and the row of the item.
    pub(in crate::report) waypoints: Vec<(f64, f64, f64, usize)>,
    /// The plan under what was flown, on the page of a flight.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(in crate::report) flown: Option<FlownShape>,
    /// How far any point of the trajectory is from the drawn track at most, metres.
    pub(in crate::report) drawn_within_m: f64,
    /// How its motion ends; none without a track.
    #[serde(skip)]
    pub(in crate::report) end: Option<Ending>,
    /// Length of the trajectory, metres, not of the drawn track.
    #[serde(skip)]
    pub(in crate::report) length_m: f64,
}

impl Scene {
    pub(in crate::report) fn new(input: &ReviewInput<'_>) -> Self {
        let (spec, world) = (input.spec, input.world);
        let flat = |at: EastNorth| [metres(at.east_m), metres(at.north_m)];
        let vehicles: Vec<VehicleShape> = spec
            .vehicles
            .iter()
            .enumerate()
            .map(|(index, vehicle)| vehicle_shape(input, index, vehicle))
            .collect();
        let mut margins = input.review.margins.iter();
        let is_held = margins.any(|margin| margin.limit == Limit::Separation);
        let bounds = bounds(spec, world, &vehicles);
        let origin = world.frame.origin();
        let separation = spec.buffered_separation();
        Self {
            relief: Relief::sample(world, &bounds),
            bounds,
            origin: [origin.lat_deg, origin.lon_deg],
            min_agl_m: metres(spec.area.min_agl.0 + spec.buffers.terrain_m),
            max_amsl_m: metres(spec.area.max_amsl.0 - spec.buffers.ceiling_m),
            separation: SeparationLimit {
                distance_m: is_held.then_some(separation.distance_m),
                vertical_m: separation.vertical_m,
                slack_s: spec.separation.time_slack_s,
            },
            area: ring(&world.frame.outline(&spec.area.outline())),
            threats: spec
                .threats
                .iter()
                .map(|threat| ThreatShape {
                    id: threat.id.clone(),
                    kind: threat.kind.clone(),
                    at: flat(world.frame.to_plan(threat.place)),
                    radius_m: metres(threat.radius_m),
                })
                .collect(),
            zones: spec
                .no_fly
                .iter()
                .zip(&world.zones)
                .zip(zone_names(&spec.no_fly))
                .map(|((zone, shape), name)| ZoneShape {
                    id: zone.id.clone(),
                    name,
                    heights: heights(zone),
                    ring: ring(&shape.outline),
                    below_m: top_m(world, shape),
                })
                .collect(),
            rally: spec
                .rally
                .iter()
                .map(|rally| flat(world.frame.to_plan(rally.place)))
                .collect(),
            covered: covered(spec, world),
            violations: violations(input),
            vehicles,
        }
    }

    /// Adds the plan of a vehicle below its flown track.
    pub(in crate::report) fn lay_under(&mut self, facts: &FlownFacts) {
        let mut vehicles = self.vehicles.iter_mut();
        if let Some(vehicle) = vehicles.find(|vehicle| vehicle.id == facts.vehicle) {
            vehicle.flown = Some(FlownShape::new(facts));
        }
    }
}

/// Between which heights a zone is closed; nothing of a layer or part.
fn heights(zone: &Zone) -> String {
    let text = |height: Placement| match height {
        Placement::Agl(Agl(agl_m)) => format!("{} m AGL", words::number(agl_m, 0)),
        Placement::Amsl(Amsl(amsl_m)) => format!("{} m AMSL", words::number(amsl_m, 0)),
    };
    match (zone.floor.map(text), zone.ceiling.map(text)) {
        _ if whole(zone).is_some() => String::new(),
        (None, None) => String::new(),
        (None, Some(ceiling)) => format!(" below {ceiling}"),
        (Some(floor), None) => format!(" above {floor}"),
        (Some(floor), Some(ceiling)) => format!(" {floor} to {ceiling}"),
    }
}

/// The line, building or dome that a zone is a part of.
fn whole(zone: &Zone) -> Option<&str> {
    zone.part_of.as_deref().or_else(|| dome_of(zone))
}

/// The name that is written in each zone. What follows each other as parts of one whole has its name in
/// the middle one.
fn zone_names(zones: &[Zone]) -> Vec<Option<String>> {
    let is_whole = |one: &Zone, other: &Zone| whole(one).is_some() && whole(one) == whole(other);
    let wholes = zones.chunk_by(is_whole);
    let names = wholes.flat_map(|parts| {
        let middle = parts.len() / 2;
        let name = |(index, part): (usize, &Zone)| {
            let name = match parts.len() {
                1 => Some(part.id.as_str()),
                _ => whole(part).filter(|_| index == middle),
            };
            name.map(str::to_owned)
        };
        parts.iter().enumerate().map(name).collect::<Vec<_>>()
    });
    names.collect()
}

impl VehicleShape {
    /// Seconds from the first fix to touchdown, or to the place where it stays; none
    /// without a track.
    pub(in crate::report) fn duration_s(&self) -> Option<f64> {
        let end_s = match self.end? {
            Ending::Down { t_s } => t_s,
            Ending::Stays { from_s } => from_s,
        };
        Some(end_s - self.track.t.first()?)
    }

    /// Whether it is still in the air when all others are down.
    pub(in crate::report) fn stays(&self) -> bool {
        matches!(self.end, Some(Ending::Stays { .. }))
    }
}

fn violations(input: &ReviewInput<'_>) -> Vec<([f64; 2], String)> {
    let mut violations = Vec::new();
    for of in input.infeasibilities() {
        for at in &of.violations {
            let place = [metres(at.at.at.east_m), metres(at.at.at.north_m)];
            let what = format!("{}: {} ({})", of.vehicle, at.what, at.how);
            violations.push((place, what));
        }
    }
    violations
}

/// Outlines of the areas that tasks cover.
fn covered(spec: &MissionSpec, world: &World) -> Vec<(String, Vec<[f64; 2]>)> {
    let mut outlines = Vec::new();
    for task in &spec.tasks {
        let shape = task.sweep.as_ref().map(|sweep| &sweep.shape);
        let Some(SweepShape::Survey { polygon, holes, .. }) = shape else {
            continue;
        };
        for corners in std::iter::once(polygon).chain(holes) {
            outlines.push((task.id.clone(), ring(&world.frame.outline(corners))));
        }
    }
    outlines
}

/// The altitude up to which a zone is drawn: its ceiling, over the highest ground at its corners
/// where that is measured from the ground, without its buffer; none if there is no ceiling.
fn top_m(world: &World, zone: &PlanZone) -> Option<f64> {
    let corners = zone.outline.exterior().coords();
    let tops = corners.map(|corner| {
        let at = EastNorth {
            east_m: corner.x,
            north_m: corner.y,
        };
        zone.closed_m(world.ground.height_m(at)).1
    });
    let top_m = tops.fold(f64::NEG_INFINITY, f64::max);
    top_m.is_finite().then(|| metres(top_m - zone.buffer_m))
}

/// The area, and what lies or flies around it, as far as a quarter of its size.
fn bounds(spec: &MissionSpec, world: &World, vehicles: &[VehicleShape]) -> Bounds {
    let mut area = Bounds::NONE;
    for [east_m, north_m] in ring(&world.frame.outline(&spec.area.outline())) {
        area.include(EastNorth { east_m, north_m });
    }
    let size_m = area.width_m().max(area.height_m());
    let most = area.padded(0.25 * size_m);
    let mut bounds = area;
    for vehicle in vehicles {
        let corners = [vehicle.home, vehicle.start, vehicle.goal];
        let sites = corners.map(|[e, n, _]| (e, n));
        let track = &vehicle.track;
        let flown = track.e.iter().zip(&track.n).map(|(e, n)| (*e, *n));
        for (east_m, north_m) in flown.chain(sites) {
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
    let sites = world.sites.get(index);
    let fixed = |pick: fn(&crate::world::VehicleSites) -> PlanPoint| {
        sites.map_or([0.0; 3], |sites| point(pick(sites)))
    };
    VehicleShape {
        id: vehicle.id.clone(),
        home: fixed(|sites| sites.home),
        start: fixed(|sites| sites.start),
        goal: fixed(|sites| sites.goal),
        stops: sites.map_or_else(Vec::new, |sites| {
            let stops = vehicle.stops.iter().zip(&sites.stops);
            let visited = stops
                .filter(|(stop, _)| !matches!(stop.arrives, Arrival::OnLine(_) | Arrival::Exact));
            let shape = |(stop, at): (&Stop, &PlanPoint)| StopShape {
                at: point(*at),
                text: words::stop(vehicle, stop),
            };
            visited.map(shape).collect()
        }),
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

//! The world a mission flies in: ground, threats, zones, area, in planning coordinates.

mod approach;
mod departure;
mod ground;
mod layer;
mod load;
mod mounds;
mod reader;
mod sunken_zones;
mod terrain;
mod unit_warnings;
mod zone;

pub use departure::Departure;
pub use ground::Ground;
pub use layer::Layer;
pub use load::{files, load, with_ground};
pub use reader::{
    Bounds, TerrainError, TerrainInfo, elevation_files, inspect, is_elevation, prj_path,
    read_terrain, terrain_files,
};
pub use terrain::{NoData, Terrain, TerrainGrid};
pub use unit_warnings::unit_warnings;
pub use zone::{PlanZone, floor_over};

use std::sync::Arc;

use geo::{Contains, Intersects, Point, Polygon};

use crate::geodesy::{Agl, Amsl, EastNorth, LocalFrame, PlanPoint};
use crate::numeric::geometry::Ring;
use crate::spec::{
    Buffers, EndPoint, Finish, MissionSpec, Placement, Task, Threat, Vehicle, Zone, zone_buffer_m,
};

/// A threat in planning coordinates: a vertical cylinder of infinite height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Axis.
    pub center: EastNorth,
    /// Radius, of a threat of the spec with its buffer, metres.
    pub radius_m: f64,
}

/// The fixed positions of one vehicle, altitudes resolved over the terrain.
#[derive(Clone, Debug, PartialEq)]
pub struct VehicleSites {
    /// How the vehicle begins its path.
    pub departure: Departure,
    /// Where it stands, on the ground.
    pub home: PlanPoint,
    /// Where the planned path begins, airborne.
    pub start: PlanPoint,
    /// Where it ends, airborne: over the goal of the spec, or, where a landing has a course,
    /// before the approach to it.
    pub goal: PlanPoint,
    /// Where the vehicle lands if it lands at the goal: the place that the spec gives.
    pub landing: EastNorth,
    /// The ground there.
    pub goal_ground: Amsl,
    /// The course on which a wing comes to its landing, radians clockwise from north: that of the spec,
    /// or where it leaves it open one into the wind. None: from anywhere.
    pub landing_rad: Option<f64>,
    /// The stops between start and goal, in the order of the vehicle's.
    pub stops: Vec<PlanPoint>,
}

/// A place below the least height above ground, and the point above it from which a copter comes straight down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LowPlace {
    /// Where the path to it ends.
    pub top: PlanPoint,
    /// The altitude of the place.
    pub low: Amsl,
}

/// Everything that does not move, as a plan has to keep it: every limit with its buffer. The spec
/// has the limits alone. Threats, zones and stations keep the order of the spec.
#[derive(Clone, Debug)]
pub struct World {
    /// Between geodetic and planning coordinates.
    pub frame: LocalFrame,
    /// The ground as its source has it: what the verdict is judged on.
    pub terrain: Terrain,
    /// The same ground on a grid in planning coordinates: what the search reads.
    pub ground: Arc<Ground>,
    /// The same with every void a cell wider; none if there are no voids.
    pub wider_voids: Option<Arc<Ground>>,
    /// Threats.
    pub threats: Vec<Disc>,
    /// No-fly zones.
    pub zones: Vec<PlanZone>,
    /// The allowed area, without its buffer along the edge.
    pub area: Polygon<f64>,
    /// Minimum height above ground between start and goal, its buffer included.
    pub min_agl: Agl,
    /// Ceiling, less its buffer.
    pub max_amsl: Amsl,
    /// The other limits of altitude of each vehicle, their buffers included.
    pub layers: Vec<Layer>,
    /// Home, start and goal of each vehicle.
    pub sites: Vec<VehicleSites>,
    /// The places of each task.
    pub tasks: Vec<Vec<PlanPoint>>,
    /// What single vehicles are planned among instead, where they pass zones outside of their times;
    /// empty where all are planned among the same.
    pub own: Vec<Option<Arc<OwnWorld>>>,
}

/// A spec and its world without the zones that one vehicle passes outside of their times.
#[derive(Clone, Debug)]
pub struct OwnWorld {
    /// The spec.
    pub spec: MissionSpec,
    /// Its world.
    pub world: World,
}

impl Disc {
    /// Whether a point of the plane lies in the threat; its rim does.
    #[must_use]
    pub fn contains(&self, at: EastNorth) -> bool {
        self.center.distance_m(at) <= self.radius_m
    }
}

impl World {
    /// A point as a spec would give it, above the sea.
    #[must_use]
    pub fn end_point(&self, point: PlanPoint) -> EndPoint {
        EndPoint {
            place: self.frame.from_plan(point.at),
            altitude: Placement::Amsl(point.amsl),
        }
    }

    /// The limits of altitude of a vehicle besides those of the area.
    #[must_use]
    pub fn layer(&self, vehicle: usize) -> Layer {
        (self.layers.get(vehicle).copied()).unwrap_or(Layer::UNLIMITED)
    }

    /// The world of a spec over a terrain that was read before.
    ///
    /// # Errors
    /// [`NoData`] when the terrain has no height under a home, start or goal.
    pub fn new(spec: &MissionSpec, terrain: Terrain) -> Result<Self, NoData> {
        let frame = spec.frame;
        let area = frame.outline(&spec.area.outline());
        let vehicles = spec.vehicles.iter();
        let sites = vehicles
            .map(|vehicle| VehicleSites::of(spec, vehicle, &terrain))
            .collect::<Result<_, NoData>>()?;
        let task_sites = |task: &Task| {
            let stops = task.stops.iter();
            stops
                .map(|stop| resolve(&frame, &terrain, stop.end))
                .collect()
        };
        let tasks = spec
            .tasks
            .iter()
            .map(task_sites)
            .collect::<Result<_, NoData>>()?;
        let ground = Arc::new(Ground::sample(&terrain, &frame, &area));
        let world = Self {
            frame,
            terrain,
            wider_voids: ground.with_wider_voids().map(Arc::new),
            ground,
            threats: Vec::new(),
            zones: Vec::new(),
            area,
            min_agl: spec.area.min_agl,
            max_amsl: spec.area.max_amsl,
            layers: Vec::new(),
            sites,
            tasks,
            own: Vec::new(),
        };
        Ok(world.with_limits(spec, true).with_approaches(spec))
    }

    /// The same world with the limits of a spec alone, as a flight is judged.
    #[must_use]
    pub fn without_buffers(&self, spec: &MissionSpec) -> Self {
        self.clone().with_limits(spec, false)
    }

    /// The limits of a spec with or without their buffers.
    fn with_limits(self, spec: &MissionSpec, is_buffered: bool) -> Self {
        let frame = self.frame;
        let buffers = match is_buffered {
            true => spec.buffers,
            false => Buffers::NONE,
        };
        let zone_buffer_m = |zone: &Zone| match is_buffered {
            true => zone_buffer_m(&buffers, zone),
            false => 0.0,
        };
        let disc = |threat: &Threat| Disc {
            center: frame.to_plan(threat.place),
            radius_m: threat.radius_m + buffers.threats_m,
        };
        let closed = |zone: &Zone| {
            let outline = frame.outline(&zone.outline());
            let slack_s = spec.separation.time_slack_s;
            let closed = PlanZone::new(outline, zone, slack_s, &self.terrain);
            closed.buffered(zone_buffer_m(zone))
        };
        Self {
            threats: spec.threats.iter().map(disc).collect(),
            zones: PlanZone::among_each_other(spec.no_fly.iter().map(closed).collect()),
            // A start that satisfies the buffer proves that an area is left.
            area: inset(frame.outline(&spec.area.outline()), buffers.area_m),
            min_agl: Agl(spec.area.min_agl.0 + buffers.terrain_m),
            max_amsl: Amsl(spec.area.max_amsl.0 - buffers.ceiling_m),
            layers: (spec.vehicles.iter())
                .map(|vehicle| Layer::of(vehicle.altitudes, &buffers))
                .map(|layer| layer.over_lower_ground(self.terrain.raised_m()))
                .collect(),
            ..self
        }
    }

    /// The places below the least height above ground that a vehicle may come to: its own stops, and those of
    /// tasks.
    #[must_use]
    pub fn drops(
        &self,
        spec: &MissionSpec,
        vehicle: &Vehicle,
        sites: &VehicleSites,
    ) -> Vec<LowPlace> {
        let own = vehicle.stops.iter().zip(&sites.stops);
        let tasks = spec.tasks.iter().zip(&self.tasks);
        let tasks = tasks.flat_map(|(task, points)| task.stops.iter().zip(points));
        let low = own.chain(tasks).filter(|(stop, _)| stop.drop_m > 0.0);
        low.map(|(stop, top)| LowPlace {
            top: *top,
            low: stop.below(*top).amsl,
        })
        .collect()
    }

    /// Whether a point of the plane lies in the allowed area; its edge does not.
    #[must_use]
    pub fn in_area(&self, at: EastNorth) -> bool {
        self.area.contains(&Point::new(at.east_m, at.north_m))
    }
}

impl VehicleSites {
    /// Where the vehicle touches down at the end, on the ground, and the altitude from which it comes there.
    #[must_use]
    pub fn touchdown(&self, finish: Finish) -> (PlanPoint, Amsl) {
        match finish {
            Finish::Return => (self.home, self.start.amsl),
            Finish::Land | Finish::Loiter => {
                let touchdown = PlanPoint {
                    at: self.landing,
                    amsl: self.goal_ground,
                };
                (touchdown, self.goal.amsl)
            }
        }
    }

    /// Those of a vehicle, over a terrain.
    fn of(spec: &MissionSpec, vehicle: &Vehicle, terrain: &Terrain) -> Result<Self, NoData> {
        let frame = spec.frame;
        let goal_ground = terrain.height(vehicle.goal.place)?;
        let over_goal = resolve(&frame, terrain, vehicle.goal)?;
        let landing = vehicle.wing.and_then(|wing| wing.landing);
        let landing_rad = landing.and_then(|landing| landing.heading_rad);
        let stops = vehicle.stops.iter();
        Ok(Self {
            departure: Departure::Ground,
            home: PlanPoint {
                at: frame.to_plan(vehicle.home),
                amsl: terrain.height(vehicle.home)?,
            },
            start: resolve(&frame, terrain, vehicle.start)?,
            goal: route_end(
                vehicle,
                landing_rad,
                raised(spec, vehicle, over_goal, goal_ground),
                goal_ground,
            ),
            landing: over_goal.at,
            landing_rad,
            goal_ground,
            stops: stops
                .map(|stop| resolve(&frame, terrain, stop.end))
                .collect::<Result<_, NoData>>()?,
        })
    }
}

fn point(at: EastNorth) -> [f64; 2] {
    [at.east_m, at.north_m]
}

/// An area without what is nearer to its edge than a buffer; all of it if nothing would be left.
fn inset(area: Polygon<f64>, buffer_m: f64) -> Polygon<f64> {
    if buffer_m <= 0.0 {
        return area;
    }
    let Some(inner) = Ring::around(&area).inset(buffer_m) else {
        return area;
    };
    let corners: Vec<(f64, f64)> = inner.corners().iter().map(|&[x, y]| (x, y)).collect();
    Polygon::new(corners.into(), Vec::new())
}

/// Whether a polygon and its edge hold a point.
fn covers(polygon: &Polygon<f64>, at: EastNorth) -> bool {
    polygon.intersects(&Point::new(at.east_m, at.north_m))
}

/// The goal of a vehicle, or the least height above it where it is a drop.
fn raised(spec: &MissionSpec, vehicle: &Vehicle, goal: PlanPoint, ground: Amsl) -> PlanPoint {
    let least = Agl(spec.area.min_agl.0 + spec.buffers.terrain_m).over(ground);
    match vehicle.can_drop() && goal.amsl < least {
        true => PlanPoint {
            amsl: least,
            ..goal
        },
        false => goal,
    }
}

/// Where the planned path of a vehicle ends: over its goal, or before its approach to it.
fn route_end(
    vehicle: &Vehicle,
    landing_rad: Option<f64>,
    over_goal: PlanPoint,
    ground: Amsl,
) -> PlanPoint {
    match vehicle.finish {
        Finish::Land => gate(vehicle, landing_rad, over_goal, ground).unwrap_or(over_goal),
        Finish::Loiter | Finish::Return => over_goal,
    }
}

/// Where the approach on a course begins to a landing on the ground under a place, from the height
/// over it; none for a vehicle that needs no approach.
fn gate(
    vehicle: &Vehicle,
    landing_rad: Option<f64>,
    over: PlanPoint,
    ground: Amsl,
) -> Option<PlanPoint> {
    let landing_rad = landing_rad?;
    let lengths = vehicle.approach_lengths(over.amsl.above_ground(ground).0)?;
    let before_m = lengths.straight_m + lengths.gate_m;
    let (sin, cos) = landing_rad.sin_cos();
    Some(PlanPoint::new(
        over.at.east_m - before_m * sin,
        over.at.north_m - before_m * cos,
        over.amsl,
    ))
}

fn resolve(frame: &LocalFrame, terrain: &Terrain, end: EndPoint) -> Result<PlanPoint, NoData> {
    let amsl = match end.altitude {
        Placement::Amsl(amsl) => amsl,
        Placement::Agl(agl) => agl.over(terrain.height(end.place)?),
    };
    Ok(PlanPoint {
        at: frame.to_plan(end.place),
        amsl,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(east_m: f64, north_m: f64) -> EastNorth {
        EastNorth { east_m, north_m }
    }

    #[test]
    fn the_rim_of_a_threat_is_closed() {
        let disc = Disc {
            center: at(0.0, 0.0),
            radius_m: 5.0,
        };
        assert!(disc.contains(at(3.0, 4.0)) && !disc.contains(at(3.0, 4.1)));
    }
}

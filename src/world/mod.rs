//! The world a mission flies in: ground, threats, zones, area, in planning coordinates.

mod ground;
mod terrain;

pub use ground::Ground;
pub use terrain::{NoData, Terrain, TerrainGrid};

use geo::{Contains, LineString, Point, Polygon};

use crate::geodesy::{Agl, Amsl, EastNorth, LocalFrame, PlanPoint};
use crate::spec::{EndPoint, MissionSpec, Placement};

/// A threat in planning coordinates: a vertical cylinder of infinite height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Axis.
    pub center: EastNorth,
    /// Radius, metres.
    pub radius_m: f64,
}

/// A no-fly zone in planning coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanZone {
    /// Outline (x east, y north, metres).
    pub outline: Polygon<f64>,
    /// Closed below this only; at all heights if absent.
    pub below: Option<Amsl>,
}

/// The fixed places of one vehicle, altitudes resolved over the terrain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stations {
    /// Where it stands, on the ground.
    pub home: PlanPoint,
    /// Where the planned path begins, airborne.
    pub start: PlanPoint,
    /// Where it ends, airborne.
    pub goal: PlanPoint,
    /// The ground under the goal.
    pub goal_ground: Amsl,
}

/// Everything that does not move. Threats, zones and stations keep the order of the spec.
#[derive(Clone, Debug)]
pub struct World {
    /// Between geodetic and planning coordinates.
    pub frame: LocalFrame,
    /// The ground as its source has it: what the verdict is judged on.
    pub terrain: Terrain,
    /// The same ground on a grid in planning coordinates: what the search reads.
    pub ground: Ground,
    /// Threats.
    pub threats: Vec<Disc>,
    /// No-fly zones.
    pub zones: Vec<PlanZone>,
    /// The allowed area.
    pub area: Polygon<f64>,
    /// Minimum height above ground between start and goal.
    pub min_agl: Agl,
    /// Ceiling.
    pub max_amsl: Amsl,
    /// Home, start and goal of each vehicle.
    pub stations: Vec<Stations>,
}

impl World {
    /// The world of a spec over a terrain that was read before.
    ///
    /// # Errors
    /// [`NoData`] when the terrain has no height under a home, start or goal.
    pub fn new(spec: &MissionSpec, terrain: Terrain) -> Result<Self, NoData> {
        let frame = spec.frame;
        let outline = |corners: Vec<crate::geodesy::LatLon>| {
            let ring: Vec<(f64, f64)> = corners
                .into_iter()
                .map(|corner| {
                    let plan = frame.to_plan(corner);
                    (plan.east_m, plan.north_m)
                })
                .collect();
            Polygon::new(LineString::from(ring), Vec::new())
        };
        let threats = spec
            .threats
            .iter()
            .map(|threat| Disc {
                center: frame.to_plan(threat.place),
                radius_m: threat.radius_m,
            })
            .collect();
        let zones = spec
            .no_fly
            .iter()
            .map(|zone| PlanZone {
                outline: outline(zone.polygon.clone()),
                below: zone.below,
            })
            .collect();
        let area = outline(spec.area.outline());
        let stations = spec
            .vehicles
            .iter()
            .map(|vehicle| {
                Ok(Stations {
                    home: PlanPoint {
                        at: frame.to_plan(vehicle.home),
                        amsl: terrain.height(vehicle.home)?,
                    },
                    start: resolve(&frame, &terrain, vehicle.start)?,
                    goal: resolve(&frame, &terrain, vehicle.goal)?,
                    goal_ground: terrain.height(vehicle.goal.place)?,
                })
            })
            .collect::<Result<_, NoData>>()?;
        let ground = Ground::sample(&terrain, &frame, &area);
        Ok(Self {
            frame,
            terrain,
            ground,
            threats,
            zones,
            area,
            min_agl: spec.area.min_agl,
            max_amsl: spec.area.max_amsl,
            stations,
        })
    }

    /// Whether a point of the plane lies in the allowed area.
    #[must_use]
    pub fn in_area(&self, at: EastNorth) -> bool {
        self.area.contains(&Point::new(at.east_m, at.north_m))
    }
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

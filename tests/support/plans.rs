//! Four places around a map of 12 km, and fleets planned without encoding them.

use sortie::geodesy::LatLon;
use sortie::plan::{FleetPlan, Request, plan_fleet};
use sortie::spec::MissionSpec;
use sortie::world::World;

use super::world;

pub const WEST: LatLon = LatLon {
    lat_deg: 36.30,
    lon_deg: -84.32,
};
pub const EAST: LatLon = LatLon {
    lat_deg: 36.30,
    lon_deg: -84.18,
};
pub const SOUTH: LatLon = LatLon {
    lat_deg: 36.24,
    lon_deg: -84.25,
};
pub const NORTH: LatLon = LatLon {
    lat_deg: 36.36,
    lon_deg: -84.25,
};

pub fn request(seed: u64) -> Request<'static> {
    Request::new(seed)
}

pub fn plan(spec: &MissionSpec) -> (World, FleetPlan) {
    let world = world(spec);
    let plan = plan_fleet(spec, &world, &request(spec.planner.seed));
    (world, plan)
}

//! `certificate.json`: proofs of bounds, for checkers that share no code.

use schemars::JsonSchema;
use serde::Serialize;

use crate::geodesy::PlanPoint;
use crate::plan::{RouteBound, RouteCertificate};
use crate::spec::MissionSpec;
use crate::world::World;

/// The certificates of a fleet.
#[derive(Debug, Serialize, JsonSchema)]
pub struct CertificateDocument {
    /// Version of this program.
    pub sortie: &'static str,
    /// Of the bytes of the spec.
    pub spec_sha256: String,
    /// Where the planning coordinates touch the earth, degrees: latitude, longitude.
    pub origin: [f64; 2],
    /// Of the spec, by id.
    pub vehicles: Vec<CertifiedVehicle>,
}

/// The certificates of one vehicle.
#[derive(Debug, Serialize, JsonSchema)]
pub struct CertifiedVehicle {
    /// Its id.
    pub id: String,
    /// Proven: no path that keeps the limits costs less.
    pub bound: f64,
    /// Route by route; null where start and goal are the proof. The bound counts these too.
    pub routes: Vec<Option<CertifiedRoute>>,
}

/// The certificate of one route: see [`RouteCertificate`].
#[derive(Debug, Serialize, JsonSchema)]
pub struct CertifiedRoute {
    bound: f64,
    /// East, north, altitude of start and goal, metres.
    ends: [[f64; 3]; 2],
    longest_m: f64,
    climb: f64,
    descent: f64,
    rows: usize,
    columns: usize,
    end_nodes: [usize; 2],
    nodes: Vec<[f64; 2]>,
    floor_m: Vec<f64>,
    levels_m: Vec<f64>,
    potential_km: Vec<f64>,
}

/// The document of some vehicles: index in the spec, and what is proven of its routes.
#[must_use]
pub fn certificate_document(
    (spec, world): (&MissionSpec, &World),
    spec_sha256: &str,
    vehicles: Vec<(usize, Vec<RouteBound>)>,
) -> CertificateDocument {
    let vehicle = |(index, routes): (usize, Vec<RouteBound>)| CertifiedVehicle {
        id: spec.vehicles[index].id.clone(),
        bound: routes.iter().map(|route| route.bound).sum(),
        routes: routes
            .into_iter()
            .map(|route| route.certificate.map(certified))
            .collect(),
    };
    let origin = world.frame.origin();
    CertificateDocument {
        sortie: env!("CARGO_PKG_VERSION"),
        spec_sha256: spec_sha256.to_owned(),
        origin: [origin.lat_deg, origin.lon_deg],
        vehicles: vehicles.into_iter().map(vehicle).collect(),
    }
}

fn certified(route: RouteCertificate) -> CertifiedRoute {
    CertifiedRoute {
        bound: route.bound,
        ends: route.ends.map(PlanPoint::axes_m),
        longest_m: route.longest_m,
        climb: *route.slopes.end(),
        descent: -route.slopes.start(),
        rows: route.size[0],
        columns: route.size[1],
        end_nodes: route.end_nodes,
        nodes: route.nodes,
        floor_m: route.floor_m,
        levels_m: route.levels_m,
        potential_km: route.potential_km,
    }
}

//! `fleet.geojson`: area, threats, zones, stations and paths for any map (RFC 7946).
//!
//! Stations and paths have a third coordinate, the height above the WGS84 ellipsoid
//! (section 3.1.1), by EGM96. Altitudes above mean sea level, which the autopilots mean,
//! are in the property `amsl_m`, for a path a list along it. Polygons lie in the plane.

use ::geojson::{Feature, FeatureCollection, Geometry, GeometryValue, JsonObject, Position};
use serde_json::{Value, json};

use super::shape::{circle, ring, rounded};
use crate::geodesy::{Geoid, LatLon, PlanPoint};
use crate::path::TimedPoint;
use crate::spec::MissionSpec;
use crate::world::World;

/// The fleet as GeoJSON text; `paths` are vehicle ids with their paths.
#[must_use]
pub fn write(spec: &MissionSpec, world: &World, paths: &[(&str, &[TimedPoint])]) -> String {
    let mut features = vec![feature(
        polygon(ring(spec.area.outline())),
        &json!({
            "kind": "area", "id": spec.name,
            "min_agl_m": world.min_agl.0, "max_amsl_m": world.max_amsl.0,
        }),
    )];
    for (threat, disc) in spec.threats.iter().zip(&world.threats) {
        features.push(feature(
            polygon(circle(world, disc)),
            &json!({
                "kind": "threat", "id": threat.id, "label": threat.kind, "radius_m": threat.radius_m,
            }),
        ));
    }
    for zone in &spec.no_fly {
        features.push(feature(
            polygon(ring(zone.polygon.clone())),
            &json!({
                "kind": "no_fly", "id": zone.id, "below_amsl_m": zone.below.map(|amsl| amsl.0),
            }),
        ));
    }
    for (vehicle, stations) in spec.vehicles.iter().zip(&world.stations) {
        for (kind, station) in [
            ("home", stations.home),
            ("start", stations.start),
            ("goal", stations.goal),
        ] {
            let coordinates = raised(world, station);
            features.push(feature(
                GeometryValue::Point { coordinates },
                &json!({ "kind": kind, "vehicle": vehicle.id, "amsl_m": metres(station) }),
            ));
        }
    }
    for (vehicle, path) in paths {
        features.push(feature(
            line(world, path),
            &json!({
                "kind": "path", "vehicle": vehicle,
                "amsl_m": path.iter().map(|sample| metres(sample.point)).collect::<Vec<_>>(),
                "t_s": path.iter().map(|sample| rounded(sample.t_s, 1e3)).collect::<Vec<_>>(),
            }),
        ));
    }
    let collection = FeatureCollection {
        bbox: None,
        features,
        foreign_members: None,
    };
    format!("{collection}\n")
}

fn feature(geometry: GeometryValue, properties: &Value) -> Feature {
    let properties: Option<JsonObject> = properties.as_object().cloned();
    Feature {
        bbox: None,
        geometry: Some(Geometry::new(geometry)),
        id: None,
        properties,
        foreign_members: None,
    }
}

fn polygon(ring: Vec<LatLon>) -> GeometryValue {
    GeometryValue::Polygon {
        coordinates: vec![ring.into_iter().map(position).collect()],
    }
}

fn line(world: &World, path: &[TimedPoint]) -> GeometryValue {
    GeometryValue::LineString {
        coordinates: path
            .iter()
            .map(|sample| raised(world, sample.point))
            .collect(),
    }
}

fn position(place: LatLon) -> Position {
    Position::from([rounded(place.lon_deg, 1e7), rounded(place.lat_deg, 1e7)])
}

/// A position with its height above the ellipsoid.
fn raised(world: &World, point: PlanPoint) -> Position {
    let place = world.frame.from_plan(point.at);
    let height = point.amsl.above_ellipsoid(Geoid::egm96(), place);
    Position::from([
        rounded(place.lon_deg, 1e7),
        rounded(place.lat_deg, 1e7),
        rounded(height.0, 1e2),
    ])
}

fn metres(point: PlanPoint) -> f64 {
    rounded(point.amsl.0, 1e2)
}

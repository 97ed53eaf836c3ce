//! `fleet.geojson`: area, threats, zones, stations and paths for any map (RFC 7946).
//!
//! Sites and paths have a third coordinate, the height above the WGS84 ellipsoid
//! (section 3.1.1), by EGM96. Altitudes above mean sea level, which the autopilots mean,
//! are in the property `amsl_m`, for a path a list along it. Polygons lie in the plane.

use ::geojson::{Feature, FeatureCollection, Geometry, GeometryValue, JsonObject, Position};
use serde_json::{Value, json};

use super::drawing::{Drawing, DrawnItem, MapPoint};
use super::outline::{circle, ring, rounded};
use crate::geodesy::{Geoid, LatLon, PlanPoint};
use crate::mission::command_name;
use crate::path::TimedPoint;
use crate::spec::{MissionSpec, Placement, Stop, StopAction, Vehicle, Zone};
use crate::world::World;

/// The fleet as GeoJSON text; `paths` are vehicle ids with their paths, planned from `seed`.
#[must_use]
pub fn write(
    spec: &MissionSpec,
    world: &World,
    paths: &[(&str, &[TimedPoint])],
    seed: u64,
) -> String {
    let mut features = vec![feature(
        polygon(ring(spec.area.outline())),
        &json!({
            "kind": "area", "id": spec.name,
            "min_agl_m": spec.area.min_agl.0, "max_amsl_m": spec.area.max_amsl.0, "seed": seed,
        }),
    )];
    for threat in &spec.threats {
        features.push(feature(
            polygon(circle(world, threat)),
            &json!({
                "kind": "threat", "id": threat.id, "label": threat.kind, "radius_m": threat.radius_m,
            }),
        ));
    }
    for zone in &spec.no_fly {
        features.push(feature(polygon(ring(zone.outline())), &heights(zone)));
    }
    for (vehicle, sites) in spec.vehicles.iter().zip(&world.sites) {
        for (kind, site) in [
            ("home", sites.home),
            ("start", sites.start),
            ("goal", sites.goal),
        ] {
            let coordinates = position(MapPoint::of(world, site));
            features.push(feature(
                GeometryValue::Point { coordinates },
                &json!({ "kind": kind, "vehicle": vehicle.id, "amsl_m": metres(site) }),
            ));
        }
    }
    for (vehicle, sites) in spec.vehicles.iter().zip(&world.sites) {
        for (stop, site) in vehicle.stops.iter().zip(&sites.stops) {
            features.push(of_stop(world, vehicle, (stop, *site)));
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
    collection(features)
}

fn of_stop(world: &World, vehicle: &Vehicle, (stop, site): (&Stop, PlanPoint)) -> Feature {
    let coordinates = position(MapPoint::of(world, site));
    let mut properties = json!({
        "kind": "stop", "id": stop.id, "vehicle": vehicle.id,
        "amsl_m": metres(site), "hold_s": stop.hold_s,
    });
    if !stop.actions.is_empty() {
        let actions = stop.actions.iter().map(StopAction::key);
        properties["actions"] = actions.collect();
    }
    feature(GeometryValue::Point { coordinates }, &properties)
}

/// Properties of a zone: its heights as the spec has them.
fn heights(zone: &Zone) -> Value {
    let mut all = json!({
        "kind": "no_fly", "id": zone.id,
        "below_amsl_m": match zone.ceiling {
            Some(Placement::Amsl(top)) => Some(top.0),
            _ => None,
        },
    });
    let of = |height: Placement| match height {
        Placement::Amsl(amsl) => ("amsl_m", amsl.0),
        Placement::Agl(agl) => ("agl_m", agl.0),
    };
    if let Some((reference, metres)) = zone.floor.map(of) {
        all[format!("from_{reference}")] = metres.into();
    }
    if let Some(("agl_m", metres)) = zone.ceiling.map(of) {
        all["below_agl_m"] = metres.into();
    }
    if let Some((from_s, to_s)) = zone.active_s {
        let end = |t_s: f64| t_s.is_finite().then_some(t_s);
        all["active_s"] = json!([end(from_s), end(to_s)]);
    }
    if let Some(source) = &zone.source {
        all["source"] = source.as_str().into();
    }
    all
}

/// One mission as GeoJSON text: every item that has a place with all its numbers, the
/// route between them, fence and rally points. Items without a place are left out:
/// features without a geometry are allowed, but not every reader takes them.
///
/// Places whose altitude above the sea is not known have two coordinates, and so has
/// the whole route when one of them is on it.
#[must_use]
pub fn write_mission(name: &str, drawing: &Drawing<'_>) -> String {
    let mut features = Vec::new();
    for outline in &drawing.outlines {
        features.push(feature(
            polygon(outline.ring.clone()),
            &json!({ "kind": "fence", "name": outline.name, "inclusion": outline.inclusion }),
        ));
    }
    let route = drawing.route();
    if route.len() > 1 {
        let coordinates = route.iter().map(|point| position(*point)).collect();
        let amsl_m: Vec<Option<f64>> = route.iter().map(|point| amsl_m(*point)).collect();
        features.push(feature(
            GeometryValue::LineString { coordinates },
            &json!({ "kind": "route", "name": name, "amsl_m": amsl_m }),
        ));
    }
    if let Some(home) = drawing.home {
        features.push(feature(
            point(home),
            &json!({ "kind": "home", "amsl_m": amsl_m(home) }),
        ));
    }
    for (kind, items) in [
        ("item", &drawing.items),
        ("fence_point", &drawing.returns),
        ("rally", &drawing.rally),
    ] {
        features.extend(items.iter().filter_map(|item| item_feature(kind, item)));
    }
    collection(features)
}

/// An item with all its fields; NaN is `null`, because JSON has no NaN.
fn item_feature(kind: &str, drawn: &DrawnItem<'_>) -> Option<Feature> {
    let at = drawn.point?;
    let item = drawn.item;
    Some(feature(
        point(at),
        &json!({
            "kind": kind, "item": drawn.number,
            "command": item.command, "command_name": command_name(item.command),
            "frame": item.frame, "autocontinue": item.autocontinue,
            "params": item.params, "z_m": item.z, "amsl_m": amsl_m(at),
        }),
    ))
}

fn point(at: MapPoint) -> GeometryValue {
    let coordinates = position(at);
    GeometryValue::Point { coordinates }
}

fn amsl_m(point: MapPoint) -> Option<f64> {
    point.amsl.map(|amsl| rounded(amsl.0, 1e2))
}

fn collection(features: Vec<Feature>) -> String {
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
        coordinates: vec![ring.into_iter().map(flat).collect()],
    }
}

fn line(world: &World, path: &[TimedPoint]) -> GeometryValue {
    GeometryValue::LineString {
        coordinates: path
            .iter()
            .map(|sample| position(MapPoint::of(world, sample.point)))
            .collect(),
    }
}

fn flat(place: LatLon) -> Position {
    Position::from([rounded(place.lon_deg, 1e7), rounded(place.lat_deg, 1e7)])
}

/// Longitude, latitude and, if the altitude is known, height above the ellipsoid.
fn position(point: MapPoint) -> Position {
    let place = point.place;
    let Some(amsl) = point.amsl else {
        return flat(place);
    };
    let height = amsl.above_ellipsoid(Geoid::egm96(), place);
    Position::from([
        rounded(place.lon_deg, 1e7),
        rounded(place.lat_deg, 1e7),
        rounded(height.0, 1e2),
    ])
}

fn metres(point: PlanPoint) -> f64 {
    rounded(point.amsl.0, 1e2)
}

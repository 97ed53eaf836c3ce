//! GeoJSON (RFC 7946), and what stands in it: ED-318 zones, OpenAIP airspace, our own zones.

use ::geojson::{Feature, GeoJson, GeometryValue, JsonObject, Position};
use serde_json::Value;

use super::crs::System;
use super::heights::{Side, floor, height};
use super::periods::{Period, hull};
use super::{
    Collection, Geometry, Height, Refused, Shape, ShapesError, circle, malformed, place, ring,
};
use crate::geodesy::LatLon;

/// Shapes of a file.
pub(super) fn read(text: &str) -> Result<Collection, ShapesError> {
    let root: GeoJson = text
        .parse()
        .map_err(|error: ::geojson::Error| malformed("GeoJSON", error))?;
    let mut system = System::Degrees;
    let mut features = match root {
        GeoJson::FeatureCollection(all) => {
            system = System::within(all.foreign_members.as_ref(), &system)?;
            all.features
        }
        GeoJson::Feature(one) => vec![one],
        GeoJson::Geometry(geometry) => vec![Feature {
            geometry: Some(geometry),
            ..Feature::default()
        }],
    };
    for feature in &mut features {
        system.apply(feature)?;
    }
    let mut collection = Collection::default();
    for (index, feature) in features.iter().enumerate() {
        let properties = feature.properties.clone().unwrap_or_default();
        let name = name(feature, &properties).unwrap_or(format!("feature {}", index + 1));
        let Some(geometry) = &feature.geometry else {
            let why = "no geometry".to_owned();
            collection.refused.push(Refused { name, why });
            continue;
        };
        let classes = classes(&properties);
        if classes.iter().any(|class| class == "NO_RESTRICTION") {
            collection.unrestricted += 1;
            continue;
        }
        let mut parts = Vec::new();
        flatten(geometry, &mut parts);
        for (part, geometry) in parts.iter().enumerate() {
            let name = match part {
                0 => name.clone(),
                _ => format!("{name} part {}", part + 1),
            };
            match shapes(&name, &classes, &properties, geometry) {
                Ok(shapes) => {
                    if has_heights(&geometry.value) {
                        collection.without_heights += shapes.len();
                    }
                    collection.shapes.extend(shapes);
                }
                Err(why) => collection.refused.push(Refused { name, why }),
            }
        }
    }
    Ok(collection)
}

fn word(of: Option<&Value>) -> Option<String> {
    let word = match of? {
        Value::String(word) => word.trim().to_owned(),
        Value::Number(number) => number.to_string(),
        // ED-318: a list of texts by language.
        Value::Array(texts) => return word(texts.first()?.get("text")),
        _ => return None,
    };
    (!word.is_empty()).then_some(word)
}

fn name(feature: &Feature, properties: &JsonObject) -> Option<String> {
    let keys = ["identifier", "id", "name", "Name", "title"];
    keys.iter()
        .find_map(|key| word(properties.get(*key)))
        .or_else(|| match &feature.id {
            Some(::geojson::feature::Id::String(id)) => Some(id.clone()),
            Some(::geojson::feature::Id::Number(id)) => Some(id.to_string()),
            None => None,
        })
}

/// Classes by the keys of ED-318, OpenAIP and usual files.
fn classes(properties: &JsonObject) -> Vec<String> {
    /// Of OpenAIP, in the order of its numbers.
    const ICAO: [&str; 9] = ["A", "B", "C", "D", "E", "F", "G", "", "UNC"];
    let mut classes: Vec<String> = ["class", "CLASS", "type", "restriction"]
        .iter()
        .filter_map(|key| word(properties.get(*key)))
        .collect();
    let icao = properties.get("icaoClass").and_then(Value::as_u64);
    let icao = icao.and_then(|index| ICAO.get(usize::try_from(index).ok()?));
    classes.extend(icao.map(|class| (*class).to_owned()));
    classes
}

fn flatten<'g>(geometry: &'g ::geojson::Geometry, parts: &mut Vec<&'g ::geojson::Geometry>) {
    match &geometry.value {
        GeometryValue::GeometryCollection { geometries } => {
            for part in geometries {
                flatten(part, parts);
            }
        }
        _ => parts.push(geometry),
    }
}

fn shapes(
    name: &str,
    classes: &[String],
    properties: &JsonObject,
    geometry: &::geojson::Geometry,
) -> Result<Vec<Shape>, String> {
    let layer = geometry.foreign_members.as_ref();
    let layer = layer.and_then(|members| members.get("layer"));
    let extent = geometry.foreign_members.as_ref();
    let extent = extent.and_then(|members| members.get("extent"));
    let active = active(properties)?;
    let numbers: Vec<(String, f64)> = properties
        .iter()
        .filter_map(|(key, value)| Some((key.clone(), value.as_f64()?)))
        .collect();
    let lists: Vec<(String, Vec<f64>)> = properties
        .iter()
        .filter_map(|(key, value)| Some((key.clone(), list(value)?)))
        .collect();
    let outlines = outlines(&geometry.value, extent, properties)?;
    let count = outlines.len();
    let shape = |(index, geometry): (usize, Geometry)| {
        // Some services put the members of the layer among the properties.
        let is_flat = ["lowerReference", "upperReference"]
            .iter()
            .any(|key| properties.contains_key(*key));
        let (lower, ceiling) = match layer {
            Some(layer) => of_layer(layer, &geometry)?,
            None if is_flat => of_layer(&Value::Object(properties.clone()), &geometry)?,
            None => of_properties(properties, &geometry)?,
        };
        Ok(Shape {
            name: match count {
                1 => name.to_owned(),
                _ => format!("{name} polygon {}", index + 1),
            },
            classes: classes.to_vec(),
            floor: floor(lower),
            ceiling,
            active,
            keep_in: properties.get("keep_in") == Some(&Value::Bool(true)),
            numbers: numbers.clone(),
            lists: lists.clone(),
            geometry,
        })
    };
    outlines.into_iter().enumerate().map(shape).collect()
}

/// A list of numbers, and at least one.
fn list(of: &Value) -> Option<Vec<f64>> {
    let numbers: Option<Vec<f64>> = of.as_array()?.iter().map(Value::as_f64).collect();
    numbers.filter(|numbers| !numbers.is_empty())
}

fn active(properties: &JsonObject) -> Result<Period, String> {
    let limited = properties.get("limitedApplicability");
    hull(limited.or_else(|| properties.get("applicability")))
}

/// Floor and ceiling.
type Limits = (Option<Height>, Option<Height>);

/// The layer of ED-318.
fn of_layer(layer: &Value, over: &Geometry) -> Result<Limits, String> {
    let text = |key: &str| layer.get(key).and_then(Value::as_str);
    let unit = text("uom").unwrap_or("m");
    let limit = |key: &str, reference: &str, side: Side| {
        let Some(value) = layer.get(key).filter(|value| !value.is_null()) else {
            return Ok(None);
        };
        let number = value.as_f64().ok_or("a limit that is no number")?;
        let reference = text(reference).ok_or("a limit without a reference")?;
        height((number, unit), reference, side, over).map(Some)
    };
    Ok((
        limit("lower", "lowerReference", Side::Floor)?,
        limit("upper", "upperReference", Side::Ceiling)?,
    ))
}

/// Heights among the properties: those of OpenAIP, or `floor` and `ceiling` as a spec has them.
fn of_properties(properties: &JsonObject, over: &Geometry) -> Result<Limits, String> {
    let limit = |keys: [&str; 3], side: Side| {
        let found = keys.iter().find_map(|key| properties.get(*key));
        let Some(of) = found.filter(|value| !value.is_null()) else {
            return Ok(None);
        };
        let number = |key: &str| of.get(key).and_then(Value::as_f64);
        let own = [
            ("amsl_m", Height::Amsl as fn(f64) -> Height),
            ("agl_m", Height::Agl),
            ("fl", Height::FlightLevel),
        ];
        if let Some(height) = own.iter().find_map(|(key, make)| Some(make(number(key)?))) {
            return Ok(Some(height));
        }
        let value = number("value").ok_or("a limit without a value")?;
        // Words, or the numbers of OpenAIP for them.
        let unit = word(of.get("unit")).ok_or("a limit without a unit")?;
        let reference = word(of.get("referenceDatum")).ok_or("a limit without a referenceDatum")?;
        let reference = match reference.as_str() {
            "0" => "AGL",
            "1" => "AMSL",
            "2" => "STD",
            other => other,
        };
        let unit = match unit.to_uppercase().as_str() {
            "6" | "FL" => return Ok(Some(Height::FlightLevel(value))),
            "0" => "m",
            "1" => "ft",
            _ => unit.as_str(),
        };
        height((value, unit), reference, side, over).map(Some)
    };
    Ok((
        limit(["floor", "lowerLimit", "lowerCeiling"], Side::Floor)?,
        limit(["ceiling", "upperLimit", "upperCeiling"], Side::Ceiling)?,
    ))
}

/// The radius that makes a point a circle. One that cannot be read is an error: as a point it would close nothing.
fn radius_m(properties: &JsonObject) -> Result<Option<f64>, String> {
    let read = ["radius_m", "radius"];
    if let Some(radius_m) = (read.iter()).find_map(|key| properties.get(*key)?.as_f64()) {
        return Ok(Some(radius_m));
    }
    let mut properties = properties.iter();
    match properties
        .find(|(key, value)| key.to_lowercase().starts_with("radius") && !value.is_null())
    {
        Some((key, value)) => Err(format!(
            "a point with {key} {value} (allowed: radius_m or radius, a number of metres)"
        )),
        None => Ok(None),
    }
}

fn outlines(
    value: &GeometryValue,
    extent: Option<&Value>,
    properties: &JsonObject,
) -> Result<Vec<Geometry>, String> {
    match value {
        GeometryValue::Polygon { coordinates } => Ok(vec![polygon(coordinates)?]),
        GeometryValue::MultiPolygon { coordinates } => {
            coordinates.iter().map(|rings| polygon(rings)).collect()
        }
        GeometryValue::Point { coordinates } => {
            let center = position(coordinates)?;
            let radius_m = match extent {
                Some(extent) if extent.get("subType").and_then(Value::as_str) == Some("Circle") => {
                    Some(
                        extent
                            .get("radius")
                            .and_then(Value::as_f64)
                            .ok_or("no radius")?,
                    )
                }
                Some(_) => return Err("an extent that is no circle".to_owned()),
                None => radius_m(properties)?,
            };
            let point = Geometry::Point(center);
            Ok(vec![
                radius_m.map_or(Ok(point), |radius_m| circle(center, radius_m))?,
            ])
        }
        GeometryValue::MultiPoint { coordinates } => {
            let points = coordinates.iter();
            points
                .map(|at| Ok(Geometry::Point(position(at)?)))
                .collect()
        }
        GeometryValue::LineString { coordinates } => Ok(vec![line(coordinates)?]),
        GeometryValue::MultiLineString { coordinates } => coordinates
            .iter()
            .map(|positions| line(positions))
            .collect(),
        GeometryValue::GeometryCollection { .. } => Err("a collection in a collection".to_owned()),
    }
}

fn polygon(rings: &[Vec<Position>]) -> Result<Geometry, String> {
    let mut rings = rings
        .iter()
        .map(|corners| ring(corners.iter().map(position).collect::<Result<_, _>>()?));
    Ok(Geometry::Polygon {
        outer: rings.next().ok_or("a polygon without coordinates")??,
        holes: rings.collect::<Result<_, _>>()?,
    })
}

fn line(positions: &[Position]) -> Result<Geometry, String> {
    let positions: Vec<LatLon> = positions.iter().map(position).collect::<Result<_, _>>()?;
    match positions.len() {
        0 | 1 => Err("a line of less than two positions".to_owned()),
        _ => Ok(Geometry::Line(positions)),
    }
}

/// Whether positions have heights: those of a zone are its `floor` and `ceiling`.
fn has_heights(value: &GeometryValue) -> bool {
    let high = |of: &Position| of.as_slice().get(2).is_some_and(|height| *height != 0.0);
    let any = |positions: &[Position]| positions.iter().any(high);
    match value {
        GeometryValue::Point { coordinates } => high(coordinates),
        GeometryValue::MultiPoint { coordinates } | GeometryValue::LineString { coordinates } => {
            any(coordinates)
        }
        GeometryValue::Polygon { coordinates } | GeometryValue::MultiLineString { coordinates } => {
            coordinates.iter().any(|line| any(line))
        }
        GeometryValue::MultiPolygon { coordinates } => {
            let mut rings = coordinates.iter().flatten();
            rings.any(|ring| any(ring))
        }
        GeometryValue::GeometryCollection { .. } => false,
    }
}

fn position(of: &Position) -> Result<LatLon, String> {
    match of.as_slice() {
        [lon_deg, lat_deg, ..] => place(*lat_deg, *lon_deg),
        _ => Err("a position of less than two numbers".to_owned()),
    }
}

//! ED-269 (EUROCAE, annex 2): UAS geographical zones as national authorities publish them.

use serde_json::Value;

use super::heights::{Side, floor, height};
use super::periods::hull;
use super::{Collection, Geometry, Refused, Shape, ShapesError, circle, malformed, place, ring};

/// The zones of a file; `None` if it is JSON of another kind.
pub(super) fn read(text: &str) -> Result<Option<Collection>, ShapesError> {
    let root: Value = serde_json::from_str(text).map_err(|error| malformed("JSON", error))?;
    // Some authorities publish the bare list.
    let features = root.as_array().or_else(|| root.get("features")?.as_array());
    let features = features.or_else(|| root.get("UASZoneList").and_then(Value::as_array));
    let is_volume = |of: &Value| of.get("horizontalProjection").is_some();
    let is_zone = |feature: &Value| {
        let geometry = feature.get("geometry");
        geometry.is_some_and(|of| of.is_array() || is_volume(of))
    };
    let Some(features) = features.filter(|all| all.iter().any(is_zone)) else {
        return Ok(None);
    };
    let mut collection = Collection::default();
    for (index, feature) in features.iter().enumerate() {
        let named = ["identifier", "name"]
            .iter()
            .find_map(|key| word(feature, key));
        let name = named.map_or_else(|| format!("feature {}", index + 1), str::to_owned);
        if word(feature, "restriction") == Some("NO_RESTRICTION") {
            collection.unrestricted += 1;
            continue;
        }
        let volumes = match feature.get("geometry") {
            Some(Value::Array(volumes)) => volumes.as_slice(),
            Some(volume @ Value::Object(_)) => std::slice::from_ref(volume),
            _ => &[],
        };
        if volumes.is_empty() {
            let (name, why) = (name.clone(), "no geometry".to_owned());
            collection.refused.push(Refused { name, why });
        }
        for (part, volume) in volumes.iter().enumerate() {
            let name = match part {
                0 => name.clone(),
                _ => format!("{name} part {}", part + 1),
            };
            match shape(&name, feature, volume) {
                Ok(shape) => collection.shapes.push(shape),
                Err(why) => collection.refused.push(Refused { name, why }),
            }
        }
    }
    Ok(Some(collection))
}

fn word<'v>(of: &'v Value, key: &str) -> Option<&'v str> {
    let word = of.get(key)?.as_str()?.trim();
    (!word.is_empty()).then_some(word)
}

fn shape(name: &str, feature: &Value, volume: &Value) -> Result<Shape, String> {
    let projection = volume
        .get("horizontalProjection")
        .ok_or("no horizontalProjection")?;
    let unit = word(volume, "uomDimensions").unwrap_or("M");
    let geometry = geometry(projection)?;
    let limit = |value: &str, reference: &str, side: Side| {
        let Some(value) = volume.get(value).filter(|value| !value.is_null()) else {
            return Ok(None);
        };
        let number = value.as_f64().ok_or("a limit that is no number")?;
        let reference = word(volume, reference).ok_or("a limit without a reference")?;
        height((number, unit), reference, side, &geometry).map(Some)
    };
    let lower = limit("lowerLimit", "lowerVerticalReference", Side::Floor)?;
    let ceiling = limit("upperLimit", "upperVerticalReference", Side::Ceiling)?;
    let classes = ["restriction", "type"].iter();
    Ok(Shape {
        name: name.to_owned(),
        classes: classes
            .filter_map(|key| word(feature, key))
            .map(str::to_owned)
            .collect(),
        floor: floor(lower),
        ceiling,
        active: hull(feature.get("applicability"))?,
        keep_in: false,
        numbers: Vec::new(),
        lists: Vec::new(),
        geometry,
    })
}

/// A radius is in metres: authorities that give limits in feet give it so, and of both readings it is the wider zone.
fn geometry(projection: &Value) -> Result<Geometry, String> {
    match word(projection, "type") {
        Some("Circle") => {
            let center = position(
                projection
                    .get("center")
                    .ok_or("a circle without a center")?,
            )?;
            let radius = projection.get("radius").and_then(Value::as_f64);
            circle(center, radius.ok_or("a circle without a radius")?)
        }
        Some("Polygon") => {
            let rings = projection.get("coordinates").and_then(Value::as_array);
            let rings = rings.ok_or("a polygon without coordinates")?;
            let mut rings = rings.iter().map(|corners| {
                let corners = corners.as_array().ok_or("a ring that is no list")?;
                ring(corners.iter().map(position).collect::<Result<_, _>>()?)
            });
            Ok(Geometry::Polygon {
                outer: rings.next().ok_or("a polygon without coordinates")??,
                holes: rings.collect::<Result<_, String>>()?,
            })
        }
        other => Err(format!("a projection of type {other:?}")),
    }
}

/// Longitude and latitude.
fn position(of: &Value) -> Result<crate::geodesy::LatLon, String> {
    let number = |index: usize| of.get(index).and_then(Value::as_f64);
    match (number(1), number(0)) {
        (Some(lat_deg), Some(lon_deg)) => place(lat_deg, lon_deg),
        _ => Err("a position that is not two numbers".to_owned()),
    }
}

//! Fences of mission files: inclusions are to stay in, exclusions to stay out of.

use serde_json::Value;

use super::{Collection, Geometry, Refused, Shape, ShapesError, circle, malformed, place, ring};
use crate::geodesy::LatLon;

/// Commands of fence items: polygon and circle, inclusion and exclusion.
const POLYGON_IN: u16 = 5001;
const POLYGON_OUT: u16 = 5002;
const CIRCLE_IN: u16 = 5003;
const CIRCLE_OUT: u16 = 5004;

/// The `geoFence` of a plan of QGroundControl.
pub(super) fn read_plan(text: &str) -> Result<Collection, ShapesError> {
    let root: Value = serde_json::from_str(text).map_err(|error| malformed("plan", error))?;
    let fence = root.get("geoFence");
    let fence = fence.ok_or_else(|| malformed("plan", "no geoFence"))?;
    let list = |key: &str| fence.get(key).and_then(Value::as_array);
    let mut collection = Collection::default();
    for (index, polygon) in list("polygons").into_iter().flatten().enumerate() {
        let corners = polygon.get("polygon").and_then(Value::as_array);
        let corners = corners.into_iter().flatten().map(position);
        let geometry = corners.collect::<Result<_, _>>().and_then(ring);
        let geometry = geometry.map(|outer| Geometry::Polygon {
            outer,
            holes: Vec::new(),
        });
        add(&mut collection, ("polygon", index), polygon, geometry);
    }
    for (index, of) in list("circles").into_iter().flatten().enumerate() {
        let shape = of.get("circle").unwrap_or(of);
        let radius = shape.get("radius").and_then(Value::as_f64);
        let geometry = shape
            .get("center")
            .ok_or_else(|| "no center".to_owned())
            .and_then(position)
            .and_then(|center| circle(center, radius.ok_or("no radius")?));
        add(&mut collection, ("circle", index), of, geometry);
    }
    Ok(collection)
}

fn add(
    collection: &mut Collection,
    (kind, index): (&str, usize),
    of: &Value,
    geometry: Result<Geometry, String>,
) {
    let name = format!("fence {kind} {}", index + 1);
    let is_in = of.get("inclusion").and_then(Value::as_bool);
    match (geometry, is_in) {
        (Ok(geometry), Some(keep_in)) => {
            collection.shapes.push(shape(name, geometry, keep_in));
        }
        (Err(why), _) => collection.refused.push(Refused { name, why }),
        (_, None) => {
            let why = "neither an inclusion nor an exclusion".to_owned();
            collection.refused.push(Refused { name, why });
        }
    }
}

fn shape(name: String, geometry: Geometry, keep_in: bool) -> Shape {
    Shape {
        name,
        classes: Vec::new(),
        geometry,
        floor: None,
        ceiling: None,
        active: (None, None),
        keep_in,
        numbers: Vec::new(),
        lists: Vec::new(),
    }
}

/// Latitude and longitude.
fn position(of: &Value) -> Result<LatLon, String> {
    let number = |index: usize| of.get(index).and_then(Value::as_f64);
    match (number(0), number(1)) {
        (Some(lat_deg), Some(lon_deg)) => place(lat_deg, lon_deg),
        _ => Err("a position that is not two numbers".to_owned()),
    }
}

/// A fence row of a list of waypoints.
struct Row {
    number: usize,
    command: u16,
    param1: f64,
    at: LatLon,
}

/// Fence rows of QGC WPL 110; other rows are passed over.
pub(super) fn read_rows(text: &str) -> Result<Collection, ShapesError> {
    if !text.trim_start().starts_with("QGC WPL") {
        return Err(malformed("waypoints", "it does not begin with QGC WPL"));
    }
    let mut collection = Collection::default();
    let mut rows = Vec::new();
    for (index, line) in text.lines().enumerate().skip(1) {
        match row(index + 1, line) {
            Ok(row) => rows.extend(row),
            Err(why) => collection.refused.push(Refused {
                name: format!("line {}", index + 1),
                why,
            }),
        }
    }
    let mut ahead = &rows[..];
    while let Some(first) = ahead.first() {
        let name = format!("fence line {}", first.number);
        let count = match first.command {
            POLYGON_IN | POLYGON_OUT => corners(ahead),
            _ => 1,
        };
        let (boundary, rest) = ahead.split_at(count);
        ahead = rest;
        let geometry = match first.command {
            CIRCLE_IN | CIRCLE_OUT => circle(first.at, first.param1),
            _ if (usize_of(first.param1)) != Some(count) => Err(format!(
                "{count} corners in a row, and {} by its first",
                first.param1
            )),
            _ => ring(boundary.iter().map(|row| row.at).collect()).map(|outer| Geometry::Polygon {
                outer,
                holes: Vec::new(),
            }),
        };
        let keep_in = matches!(first.command, POLYGON_IN | CIRCLE_IN);
        match geometry {
            Ok(geometry) => collection.shapes.push(shape(name, geometry, keep_in)),
            Err(why) => collection.refused.push(Refused { name, why }),
        }
    }
    Ok(collection)
}

/// Rows of one polygon: as many as its first says, of one command.
fn corners(rows: &[Row]) -> usize {
    let first = &rows[0];
    let most = usize_of(first.param1).unwrap_or(1).max(1);
    let same = rows
        .iter()
        .take(most)
        .take_while(|row| row.command == first.command);
    same.count()
}

fn usize_of(number: f64) -> Option<usize> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "checked to be a small whole number"
    )]
    let count = number as usize;
    ((0.0..1e6).contains(&number) && number.fract() == 0.0).then_some(count)
}

fn row(number: usize, line: &str) -> Result<Option<Row>, String> {
    let fields: Vec<&str> = line.split_whitespace().collect();
    let Some(command) = fields.get(3).and_then(|text| text.parse::<u16>().ok()) else {
        return Ok(None);
    };
    if !(POLYGON_IN..=CIRCLE_OUT).contains(&command) {
        return Ok(None);
    }
    let value = |index: usize| {
        let text = fields.get(index).ok_or("a row with too few fields")?;
        text.parse::<f64>()
            .map_err(|_| format!("`{}` is no number", text.escape_debug()))
    };
    Ok(Some(Row {
        number,
        command,
        param1: value(4)?,
        at: place(value(8)?, value(9)?)?,
    }))
}

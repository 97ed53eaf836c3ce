//! Shapes as GeoJSON: heights are properties, as a spec has them, so that no file loses any. As KML and
//! OpenAir, which have less, each comes out no smaller, and what is lost is said.

mod kml;
mod openair;

use ::geojson::{Feature, FeatureCollection, Geometry as Written, GeometryValue, Position};
use serde_json::{Value, json};

use super::{Geometry, Height, Refused, Shape};
use crate::geodesy::LatLon;

/// A format that shapes are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// GeoJSON, which keeps all.
    GeoJson,
    /// KML: no floors, times and flight levels.
    Kml,
    /// OpenAir: no holes and times, whole feet.
    OpenAir,
}

/// A file of shapes, and what it could not keep of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rewritten {
    /// The text.
    pub text: String,
    /// Shapes that came out larger: name and how.
    pub enlarged: Vec<(String, &'static str)>,
    /// Shapes that are not in it.
    pub left_out: Vec<Refused>,
}

impl Rewritten {
    fn enlarge(&mut self, shape: &Shape, how: &'static str) {
        self.enlarged.push((shape.name.clone(), how));
    }

    fn leave_out(&mut self, shape: &Shape, why: &str) {
        self.left_out.push(Refused {
            name: shape.name.clone(),
            why: why.to_owned(),
        });
    }
}

/// The shapes in a format; reading them again gives shapes that are no smaller.
#[must_use]
pub fn write_as(format: Format, shapes: &[Shape]) -> Rewritten {
    match format {
        Format::GeoJson => Rewritten {
            text: write(shapes),
            ..Rewritten::default()
        },
        Format::Kml => kml::write(shapes),
        Format::OpenAir => openair::write(shapes),
    }
}

/// The text of a GeoJSON file; reading it gives the same shapes.
#[must_use]
pub fn write(shapes: &[Shape]) -> String {
    let collection = FeatureCollection {
        bbox: None,
        features: shapes.iter().map(feature).collect(),
        foreign_members: None,
    };
    let mut text = ::geojson::GeoJson::from(collection).to_string();
    text.push('\n');
    text
}

fn feature(shape: &Shape) -> Feature {
    let mut properties = serde_json::Map::new();
    properties.insert("id".to_owned(), shape.name.as_str().into());
    let mut classes = shape.classes.iter();
    for (key, class) in ["class", "type", "restriction"].iter().zip(&mut classes) {
        properties.insert((*key).to_owned(), class.as_str().into());
    }
    for (key, height) in [("floor", shape.floor), ("ceiling", shape.ceiling)] {
        if let Some(height) = height {
            properties.insert(key.to_owned(), limit(height));
        }
    }
    if let (None, None) = shape.active {
    } else {
        let (from, to) = shape.active;
        let text = |time: Option<jiff::Timestamp>| time.map(|time| time.to_string());
        let period = json!([{"startDateTime": text(from), "endDateTime": text(to)}]);
        properties.insert("applicability".to_owned(), period);
    }
    if shape.keep_in {
        properties.insert("keep_in".to_owned(), true.into());
    }
    for (key, number) in &shape.numbers {
        properties.insert(key.clone(), (*number).into());
    }
    for (key, numbers) in &shape.lists {
        properties.insert(key.clone(), numbers.clone().into());
    }
    if let Geometry::Circle { radius_m, .. } = shape.geometry {
        properties.insert("radius_m".to_owned(), radius_m.into());
    }
    Feature {
        geometry: Some(Written::new(geometry(&shape.geometry))),
        properties: Some(properties),
        ..Feature::default()
    }
}

fn limit(of: Height) -> Value {
    match of {
        Height::Amsl(metres) => json!({"amsl_m": metres}),
        Height::Agl(metres) => json!({"agl_m": metres}),
        Height::FlightLevel(level) => json!({"fl": level}),
    }
}

fn geometry(of: &Geometry) -> GeometryValue {
    let ring = |corners: &[LatLon]| {
        let closed = corners.iter().chain(corners.first());
        closed.map(position).collect::<Vec<Position>>()
    };
    match of {
        Geometry::Polygon { outer, holes } => {
            let mut coordinates = vec![ring(outer)];
            coordinates.extend(holes.iter().map(|hole| ring(hole)));
            GeometryValue::Polygon { coordinates }
        }
        Geometry::Circle { center: at, .. } | Geometry::Point(at) => GeometryValue::Point {
            coordinates: position(at),
        },
        Geometry::Line(positions) => GeometryValue::LineString {
            coordinates: positions.iter().map(position).collect(),
        },
    }
}

fn position(of: &LatLon) -> Position {
    Position::from([of.lon_deg, of.lat_deg])
}

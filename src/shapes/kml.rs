//! KML (OGC 2.2) and KMZ. A polygon that is extruded reaches from the ground to its corners, any
//! other is without heights.

mod nesting;
mod placemarks;

use std::io::{Cursor, Read};

use ::kml::types::{AltitudeMode, Coord, Geometry as KmlGeometry, LinearRing, Placemark, Polygon};
use ::kml::{Kml, KmlReader};

use super::{Collection, Geometry, Height, Refused, Shape, ShapesError, malformed, place, ring};
use crate::geodesy::LatLon;

/// Deepest nesting of elements: the parser calls itself for each.
const MAX_DEPTH: usize = 64;
/// Most bytes of the KML inside a KMZ.
const MAX_BYTES: u64 = 256 << 20;

/// Shapes of KML text.
pub(super) fn read(text: &str) -> Result<Collection, ShapesError> {
    if nesting::is_deeper(text, MAX_DEPTH) {
        let why = format!("elements are nested more than {MAX_DEPTH} deep");
        return Err(malformed("KML", why));
    }
    let parse = |text: &str| KmlReader::<_, f64>::from_string(text).read();
    let mut collection = Collection::default();
    let root = match parse(text) {
        Ok(root) => root,
        Err(_) => {
            let (rest, refused) = placemarks::without_broken(text, &|placemark| {
                parse(placemark).err().map(|error| error.to_string())
            });
            collection.refused = refused;
            parse(&rest).map_err(|error| malformed("KML", error))?
        }
    };
    add(&root, &mut collection);
    Ok(collection)
}

/// Shapes of the first KML file in an archive.
pub(super) fn read_zipped(bytes: &[u8]) -> Result<Collection, ShapesError> {
    let wrong = |error: &dyn std::fmt::Display| malformed("KMZ", error);
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| wrong(&error))?;
    let mut name: Option<String> = None;
    for of in archive.file_names().filter_map(Result::ok) {
        if name.is_none() && of.to_lowercase().ends_with(".kml") {
            name = Some(of.into_owned());
        }
    }
    let name = name.ok_or_else(|| wrong(&"no .kml file inside"))?;
    let file = archive.by_name(&name).map_err(|error| wrong(&error))?;
    let mut text = String::new();
    let read = file.take(MAX_BYTES + 1).read_to_string(&mut text);
    read.map_err(|error| wrong(&error))?;
    if text.len() as u64 > MAX_BYTES {
        return Err(wrong(&"more than 256 MiB of KML inside"));
    }
    self::read(text.strip_prefix('\u{feff}').unwrap_or(&text))
}

fn add(of: &Kml, collection: &mut Collection) {
    match of {
        Kml::KmlDocument(document) => {
            for element in &document.elements {
                add(element, collection);
            }
        }
        Kml::Document { elements, .. } => {
            for element in elements {
                add(element, collection);
            }
        }
        Kml::Folder(folder) => {
            for element in &folder.elements {
                add(element, collection);
            }
        }
        Kml::Placemark(placemark) => add_placemark(placemark, collection),
        _ => {}
    }
}

fn add_placemark(placemark: &Placemark, collection: &mut Collection) {
    let number = collection.shapes.len() + collection.refused.len() + 1;
    let name = placemark.name.as_deref().map(str::trim).unwrap_or_default();
    let name = match name {
        "" => format!("placemark {number}"),
        _ => name.to_owned(),
    };
    let mut parts = Vec::new();
    match &placemark.geometry {
        Some(geometry) => flatten(geometry, &mut parts),
        None => {
            let why = "no geometry".to_owned();
            return collection.refused.push(Refused { name, why });
        }
    }
    for (part, geometry) in parts.iter().enumerate() {
        let name = match part {
            0 => name.clone(),
            _ => format!("{name} part {}", part + 1),
        };
        match shape(&name, geometry) {
            Ok(shape) => collection.shapes.push(shape),
            Err(why) => collection.refused.push(Refused { name, why }),
        }
    }
}

fn flatten<'g>(geometry: &'g KmlGeometry, parts: &mut Vec<&'g KmlGeometry>) {
    match geometry {
        KmlGeometry::MultiGeometry(multi) => {
            for part in &multi.geometries {
                flatten(part, parts);
            }
        }
        _ => parts.push(geometry),
    }
}

fn shape(name: &str, geometry: &KmlGeometry) -> Result<Shape, String> {
    let (geometry, ceiling) = match geometry {
        KmlGeometry::Polygon(polygon) => (
            Geometry::Polygon {
                outer: corners(&polygon.outer)?,
                holes: polygon
                    .inner
                    .iter()
                    .map(corners)
                    .collect::<Result<_, _>>()?,
            },
            top(polygon)?,
        ),
        KmlGeometry::LinearRing(ring) => (
            Geometry::Polygon {
                outer: corners(ring)?,
                holes: Vec::new(),
            },
            None,
        ),
        KmlGeometry::LineString(line) => {
            let positions = line.coords.iter().map(position);
            (Geometry::Line(positions.collect::<Result<_, _>>()?), None)
        }
        KmlGeometry::Point(point) => (Geometry::Point(position(&point.coord)?), None),
        _ => return Err("a geometry that is no polygon, line or point".to_owned()),
    };
    Ok(Shape {
        name: name.to_owned(),
        classes: Vec::new(),
        geometry,
        floor: None,
        ceiling,
        active: (None, None),
        keep_in: false,
        numbers: Vec::new(),
        lists: Vec::new(),
    })
}

/// The highest corner of an extruded polygon; KML measures from the EGM96 geoid.
fn top(polygon: &Polygon) -> Result<Option<Height>, String> {
    if !polygon.extrude {
        return Ok(None);
    }
    let heights = polygon.outer.coords.iter().map(|corner| corner.z);
    let highest = heights
        .map(|height| height.ok_or("an extruded polygon with a corner without height"))
        .try_fold(f64::NEG_INFINITY, |most, height| {
            height.map(|z| most.max(z))
        })?;
    match polygon.altitude_mode {
        AltitudeMode::Absolute => Ok(Some(Height::Amsl(highest))),
        AltitudeMode::RelativeToGround => Ok(Some(Height::Agl(highest))),
        AltitudeMode::ClampToGround => Ok(None),
    }
}

fn corners(of: &LinearRing) -> Result<Vec<LatLon>, String> {
    ring(of.coords.iter().map(position).collect::<Result<_, _>>()?)
}

fn position(of: &Coord) -> Result<LatLon, String> {
    place(of.y, of.x)
}

//! KML (OGC 2.2) and KMZ. A polygon that is extruded reaches from the ground to its corners, any
//! other is without heights.
//!
//! Read as XML: crates for KML lose geometries beside one that they do not know, without a word.

mod nesting;

use std::io::{Cursor, Read};

use roxmltree::{Document, Node};

use super::{Collection, Geometry, Height, Refused, Shape, ShapesError, malformed, place, ring};
use crate::geodesy::LatLon;

/// Deepest nesting of elements.
const MAX_DEPTH: usize = 64;
/// Most bytes of the KML inside a KMZ.
const MAX_BYTES: u64 = 256 << 20;

/// Shapes of KML text.
pub(super) fn read(text: &str) -> Result<Collection, ShapesError> {
    if nesting::is_deeper(text, MAX_DEPTH) {
        let why = format!("elements are nested more than {MAX_DEPTH} deep");
        return Err(malformed("KML", why));
    }
    let document = Document::parse(text).map_err(|error| malformed("KML", error))?;
    let mut collection = Collection::default();
    for node in document.root_element().descendants() {
        match node.tag_name().name() {
            "Placemark" => add_placemark(&document, node, &mut collection),
            "NetworkLink" => {
                let why = "a link to another file, which is not read";
                refuse(&document, node, &mut collection, why);
            }
            _ => {}
        }
    }
    Ok(collection)
}

/// Shapes of all KML files in an archive.
pub(super) fn read_zipped(bytes: &[u8]) -> Result<Collection, ShapesError> {
    let wrong = |error: &dyn std::fmt::Display| malformed("KMZ", error);
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| wrong(&error))?;
    let names = archive.file_names().filter_map(Result::ok);
    let names: Vec<String> = names
        .filter(|name| name.to_lowercase().ends_with(".kml"))
        .map(std::borrow::Cow::into_owned)
        .collect();
    if names.is_empty() {
        return Err(wrong(&"no .kml file inside"));
    }
    let mut all = Collection::default();
    let mut left = MAX_BYTES;
    for name in names {
        let file = archive.by_name(&name).map_err(|error| wrong(&error))?;
        let mut text = String::new();
        let read = file.take(left + 1).read_to_string(&mut text);
        read.map_err(|error| wrong(&error))?;
        left = left
            .checked_sub(text.len() as u64)
            .ok_or_else(|| wrong(&"more than 256 MiB of KML inside"))?;
        let found = self::read(text.strip_prefix('\u{feff}').unwrap_or(&text))?;
        all.shapes.extend(found.shapes);
        all.refused.extend(found.refused);
        all.without_heights += found.without_heights;
    }
    Ok(all)
}

/// The text of the first child of that name: all of it, whatever comments stand between.
fn text(of: Node<'_, '_>, name: &str) -> Option<String> {
    let mut children = of.children();
    let child = children.find(|child| child.tag_name().name() == name)?;
    let parts = child.children().filter(Node::is_text);
    let whole: String = parts.filter_map(|part| part.text()).collect();
    Some(whole.trim().to_owned()).filter(|text| !text.is_empty())
}

fn refuse(document: &Document<'_>, node: Node<'_, '_>, collection: &mut Collection, why: &str) {
    let line = document.text_pos_at(node.range().start).row;
    let name = text(node, "name").unwrap_or_else(|| format!("line {line}"));
    let why = format!("line {line}: {}", why.escape_debug());
    collection.refused.push(Refused { name, why });
}

fn add_placemark(document: &Document<'_>, placemark: Node<'_, '_>, collection: &mut Collection) {
    let number = collection.shapes.len() + collection.refused.len() + 1;
    let name = text(placemark, "name").unwrap_or_else(|| format!("placemark {number}"));
    let mut parts = Vec::new();
    flatten(placemark, &mut parts);
    if parts.is_empty() {
        return refuse(document, placemark, collection, "no geometry");
    }
    for (part, geometry) in parts.into_iter().enumerate() {
        let name = match part {
            0 => name.clone(),
            _ => format!("{name} part {}", part + 1),
        };
        match shape(&name, geometry) {
            Ok(shape) => {
                let loses = shape.ceiling.is_none() && has_heights(geometry);
                collection.without_heights += usize::from(loses);
                collection.shapes.push(shape);
            }
            // By its own name: who skips it skips no other part.
            Err(why) => {
                refuse(document, placemark, collection, &why);
                if let Some(refused) = collection.refused.last_mut().filter(|_| part > 0) {
                    refused.name = name;
                }
            }
        }
    }
}

/// The geometries in an element, also those that cannot be read.
fn flatten<'a, 'input>(of: Node<'a, 'input>, parts: &mut Vec<Node<'a, 'input>>) {
    for child in of.children() {
        match child.tag_name().name() {
            "MultiGeometry" => flatten(child, parts),
            "Polygon" | "LinearRing" | "LineString" | "Point" | "Model" | "Track"
            | "MultiTrack" => parts.push(child),
            _ => {}
        }
    }
}

fn shape(name: &str, of: Node<'_, '_>) -> Result<Shape, String> {
    let (geometry, ceiling) = match of.tag_name().name() {
        "Polygon" => polygon(of)?,
        "LinearRing" => {
            let (outer, holes) = (outline(of)?, Vec::new());
            (Geometry::Polygon { outer, holes }, None)
        }
        "LineString" => {
            let corners = corners(of)?.into_iter();
            (Geometry::Line(corners.map(|(at, _)| at).collect()), None)
        }
        "Point" => {
            let at = corners(of)?.first().copied();
            let (at, _) = at.ok_or("a point without coordinates")?;
            (Geometry::Point(at), None)
        }
        other => return Err(format!("a {other}, no polygon, line or point")),
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

fn polygon(of: Node<'_, '_>) -> Result<(Geometry, Option<Height>), String> {
    let rings = |boundary: &'static str| {
        let boundaries = of.children();
        let boundaries = boundaries.filter(move |node| node.tag_name().name() == boundary);
        let rings = boundaries.flat_map(|node| node.children());
        rings.filter(|node| node.tag_name().name() == "LinearRing")
    };
    let mut outer = rings("outerBoundaryIs");
    let (Some(first), None) = (outer.next(), outer.next()) else {
        return Err("a polygon that has not exactly one outer boundary".to_owned());
    };
    let holes = rings("innerBoundaryIs").map(outline);
    let geometry = Geometry::Polygon {
        outer: outline(first)?,
        holes: holes.collect::<Result<_, _>>()?,
    };
    Ok((geometry, top(of, first)?))
}

/// The highest corner of an extruded polygon; KML measures from the EGM96 geoid.
fn top(polygon: Node<'_, '_>, outer: Node<'_, '_>) -> Result<Option<Height>, String> {
    let as_height: Option<fn(f64) -> Height> = match text(polygon, "altitudeMode").as_deref() {
        None | Some("clampToGround") => None,
        Some("absolute") => Some(Height::Amsl),
        Some("relativeToGround") => Some(Height::Agl),
        Some(other) => return Err(format!("an altitude mode `{other}`")),
    };
    if !matches!(text(polygon, "extrude").as_deref(), Some("1" | "true")) {
        return Ok(None);
    }
    let highest = corners(outer)?
        .into_iter()
        .map(|(_, height)| height.ok_or("an extruded polygon with a corner without height"))
        .try_fold(f64::NEG_INFINITY, |most, height| {
            height.map(|z| most.max(z))
        })?;
    Ok(as_height.map(|of| of(highest)))
}

/// Whether a geometry lies at heights of its own. Clamped to the ground it does not, whatever its
/// coordinates say.
fn has_heights(of: Node<'_, '_>) -> bool {
    let is_clamped = matches!(
        text(of, "altitudeMode").as_deref(),
        None | Some("clampToGround")
    );
    let mut rings = of.descendants();
    !is_clamped
        && rings.any(|ring| {
            let heights = corners(ring).into_iter().flatten();
            heights
                .filter_map(|(_, height)| height)
                .any(|height| height != 0.0)
        })
}

fn outline(of: Node<'_, '_>) -> Result<Vec<LatLon>, String> {
    ring(corners(of)?.into_iter().map(|(at, _)| at).collect())
}

/// Places and heights, if there are: longitude, latitude and height with commas, one after the other.
fn corners(of: Node<'_, '_>) -> Result<Vec<(LatLon, Option<f64>)>, String> {
    let mut all = (of.children()).filter(|child| child.tag_name().name() == "coordinates");
    let first = all.next();
    if all.next().is_some() {
        return Err("coordinates twice".to_owned());
    }
    if first.is_some_and(|of| of.children().any(|child| child.is_element())) {
        return Err("an element within coordinates".to_owned());
    }
    let tuples = text(of, "coordinates").unwrap_or_default();
    tuples.split_whitespace().map(corner).collect()
}

fn corner(tuple: &str) -> Result<(LatLon, Option<f64>), String> {
    let numbers = tuple.split(',').map(str::parse::<f64>);
    let numbers: Vec<f64> = numbers
        .collect::<Result<_, _>>()
        .map_err(|_| format!("coordinates `{tuple}`"))?;
    match numbers[..] {
        [lon, lat] => Ok((place(lat, lon)?, None)),
        [lon, lat, height] if height.is_finite() => Ok((place(lat, lon)?, Some(height))),
        _ => Err(format!("coordinates `{tuple}`")),
    }
}

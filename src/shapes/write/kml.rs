//! Shapes as KML. A zone comes out no smaller: without its floor and times, and without its ceiling where
//! that is a flight level.

use std::fmt::Write as _;

use super::Rewritten;
use crate::geodesy::{EastNorth, LatLon, LocalFrame};
use crate::shapes::{Geometry, Height, Shape};

/// Corners of a circle.
const CORNERS: u32 = 64;

/// The text of a file.
pub(super) fn write(shapes: &[Shape]) -> Rewritten {
    let mut rewritten = Rewritten::default();
    let mut text = String::from(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\"><Document>\n",
    );
    for shape in shapes {
        if let Some(placemark) = placemark(shape, &mut rewritten) {
            text += &placemark;
        }
    }
    text += "</Document></kml>\n";
    rewritten.text = text;
    rewritten
}

fn placemark(shape: &Shape, rewritten: &mut Rewritten) -> Option<String> {
    if shape.keep_in {
        rewritten.leave_out(shape, "a zone to stay in: KML has none");
        return None;
    }
    if shape.active != (None, None) {
        rewritten.enlarge(shape, "always active: KML has no times of zones");
    }
    if shape.floor.is_some() {
        rewritten.enlarge(shape, "from the ground: KML has no floors");
    }
    let (mode, height_m) = match shape.ceiling {
        Some(Height::Amsl(metres)) => ("absolute", Some(metres)),
        Some(Height::Agl(metres)) => ("relativeToGround", Some(metres)),
        Some(Height::FlightLevel(_)) => {
            rewritten.enlarge(shape, "at all heights: KML has no flight levels");
            ("clampToGround", None)
        }
        None => ("clampToGround", None),
    };
    let geometry = match &shape.geometry {
        Geometry::Polygon { outer, holes } => polygon(outer, holes, (mode, height_m)),
        Geometry::Circle { center, radius_m } => {
            polygon(&around(*center, *radius_m), &[], (mode, height_m))
        }
        Geometry::Line(line) => format!(
            "<LineString><coordinates>{}</coordinates></LineString>",
            coordinates(line.iter(), None)
        ),
        Geometry::Point(at) => format!(
            "<Point><coordinates>{}</coordinates></Point>",
            coordinates(std::iter::once(at), None)
        ),
    };
    let name = escaped(&shape.name);
    Some(format!(
        "<Placemark><name>{name}</name>{geometry}</Placemark>\n"
    ))
}

fn polygon(
    outer: &[LatLon],
    holes: &[Vec<LatLon>],
    (mode, height_m): (&str, Option<f64>),
) -> String {
    let ring = |corners: &[LatLon]| {
        let closed = corners.iter().chain(corners.first());
        let coordinates = coordinates(closed, height_m);
        format!("<LinearRing><coordinates>{coordinates}</coordinates></LinearRing>")
    };
    let extrude = u8::from(height_m.is_some());
    let mut text = format!(
        "<Polygon><extrude>{extrude}</extrude><altitudeMode>{mode}</altitudeMode><outerBoundaryIs>{}</outerBoundaryIs>",
        ring(outer)
    );
    for hole in holes {
        let _ = write!(text, "<innerBoundaryIs>{}</innerBoundaryIs>", ring(hole));
    }
    text + "</Polygon>"
}

/// Corners whose edges touch a circle from outside.
fn around(center: LatLon, radius_m: f64) -> Vec<LatLon> {
    let frame = LocalFrame::new(center);
    let step_rad = std::f64::consts::TAU / f64::from(CORNERS);
    let outside_m = radius_m / (0.5 * step_rad).cos();
    let corners = (0..CORNERS).map(|corner| {
        let (sin, cos) = (f64::from(corner) * step_rad).sin_cos();
        frame.from_plan(EastNorth {
            east_m: outside_m * cos,
            north_m: outside_m * sin,
        })
    });
    corners.collect()
}

fn coordinates<'p>(line: impl Iterator<Item = &'p LatLon>, height_m: Option<f64>) -> String {
    let line = line.map(|at| match height_m {
        Some(height_m) => format!("{:.8},{:.8},{height_m}", at.lon_deg, at.lat_deg),
        None => format!("{:.8},{:.8}", at.lon_deg, at.lat_deg),
    });
    line.collect::<Vec<_>>().join(" ")
}

fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for c in text.chars() {
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            c if c.is_control() => escaped.push(' '),
            c => escaped.push(c),
        }
    }
    escaped
}

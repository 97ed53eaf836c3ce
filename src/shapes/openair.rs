//! OpenAir, the airspace format of gliding and flight planning. Distances are nautical miles,
//! heights feet, metres or flight levels; arcs become polylines that enclose them.

use ::openair::{Airspace, Altitude, Arc, ArcSegment, Coord, Direction, Geometry as Outline};
use ::openair::{Class, PolygonSegment};
use jiff::Timestamp;

use super::heights::{FOOT_M, NAUTICAL_MILE_M};
use super::{Collection, Geometry, Height, Refused, Shape, ShapesError, circle, malformed, place};
use super::{periods::Period, ring};
use crate::geodesy::{EastNorth, LatLon, LocalFrame};

/// Longest step of an arc, radians.
const STEP_RAD: f64 = 0.06;

/// Reads each block on its own, so that an error in one does not affect the others.
pub(super) fn read(bytes: &[u8]) -> Result<Collection, ShapesError> {
    let text = String::from_utf8_lossy(bytes);
    let mut collection = Collection::default();
    for (line, block) in blocks(&text) {
        let label = name_of(&block);
        let label = label.unwrap_or_else(|| format!("line {line}"));
        let parsed = with_heights(&block);
        let found: Vec<_> = ::openair::parse(parsed.as_bytes()).collect();
        match <[_; 1]>::try_from(found) {
            Ok([Ok(airspace)]) if is_open(&airspace) => collection.open += 1,
            Ok([Ok(airspace)]) => match shape(&label, &airspace, &block) {
                Ok(shape) => collection.shapes.push(shape),
                Err(why) => collection.refused.push(Refused { name: label, why }),
            },
            Ok([Err(why)]) => collection.refused.push(Refused { name: label, why }),
            Err(found) => {
                let why = found.into_iter().find_map(Result::err);
                let why = why.unwrap_or("not exactly one airspace".to_owned());
                collection.refused.push(Refused { name: label, why });
            }
        }
    }
    if collection.shapes.is_empty() && collection.refused.is_empty() && collection.open == 0 {
        return Err(malformed("OpenAir", "no line begins with AC"));
    }
    Ok(collection)
}

/// The lines from each `AC` to the next, with the number of the first.
fn blocks(text: &str) -> Vec<(usize, String)> {
    let mut blocks: Vec<(usize, String)> = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.trim_start_matches('\u{feff}').trim();
        let is_first = line.split_whitespace().next() == Some("AC");
        if is_first {
            blocks.push((index + 1, String::new()));
        }
        if let Some((_, block)) = blocks.last_mut() {
            block.push_str(line);
            block.push('\n');
        }
    }
    blocks
}

/// The block with the widest height for each that it leaves out: the shape is closed from the ground or without
/// end.
fn with_heights(block: &str) -> String {
    let mut lines: Vec<&str> = block.lines().collect();
    for line in ["AL GND", "AH UNL"] {
        let key = |line: &str| line.split_whitespace().next().map(str::to_owned);
        if !lines.iter().any(|of| key(of) == key(line)) {
            // After AC: heights come before corners.
            lines.insert(lines.len().min(1), line);
        }
    }
    lines.join("\n") + "\n"
}

fn name_of(block: &str) -> Option<String> {
    let mut lines = block.lines();
    let name = lines.find_map(|line| line.strip_prefix("AN "))?.trim();
    (!name.is_empty()).then(|| name.to_owned())
}

/// Class G without a type forbids nothing.
fn is_open(airspace: &Airspace) -> bool {
    airspace.type_.is_none() && matches!(airspace.class, Class::G)
}

fn shape(name: &str, airspace: &Airspace, block: &str) -> Result<Shape, String> {
    let mut classes = vec![airspace.class.as_str().to_owned()];
    classes.extend(airspace.type_.as_ref().map(|of| of.as_str().to_owned()));
    Ok(Shape {
        name: name.to_owned(),
        classes,
        geometry: match &airspace.geom {
            Outline::Circle {
                centerpoint,
                radius,
            } => circle(coord(centerpoint)?, f64::from(*radius) * NAUTICAL_MILE_M)?,
            Outline::Polygon { segments } => Geometry::Polygon {
                outer: ring(corners(segments)?)?,
                holes: Vec::new(),
            },
        },
        floor: match &airspace.lower_bound {
            Altitude::Gnd => None,
            Altitude::Unlimited => return Err("a floor without end".to_owned()),
            other => super::heights::floor(Some(height(other, metres(block, "AL"))?)),
        },
        ceiling: match &airspace.upper_bound {
            Altitude::Unlimited => None,
            Altitude::Gnd => return Err("a ceiling on the ground".to_owned()),
            other => Some(height(other, metres(block, "AH"))?),
        },
        active: active(airspace)?,
        keep_in: false,
        numbers: Vec::new(),
        lists: Vec::new(),
    })
}

/// The value of an `AL` or `AH` line in metres, which the parser rounds to whole feet.
fn metres(block: &str, limit: &str) -> Option<f64> {
    let mut lines = block.lines().filter_map(|line| line.strip_prefix(limit));
    let value = lines
        .find(|value| value.starts_with(char::is_whitespace))?
        .trim();
    let digits = value.find(|c: char| !c.is_ascii_digit())?;
    let (number, rest) = value.split_at(digits);
    let unit = rest.split_whitespace().next()?;
    (unit.eq_ignore_ascii_case("m")).then(|| number.parse().ok())?
}

fn height(of: &Altitude, metres: Option<f64>) -> Result<Height, String> {
    let in_metres = |feet: i32| metres.unwrap_or(f64::from(feet) * FOOT_M);
    match of {
        Altitude::FeetAmsl(feet) => Ok(Height::Amsl(in_metres(*feet))),
        Altitude::FeetAgl(feet) => Ok(Height::Agl(in_metres(*feet))),
        Altitude::FlightLevel(level) => Ok(Height::FlightLevel(f64::from(*level))),
        Altitude::Other(text) => Err(format!(
            "a height `{}` that cannot be read",
            text.escape_debug()
        )),
        other => Err(format!("a height `{other}` that cannot be read")),
    }
}

fn active(airspace: &Airspace) -> Result<Period, String> {
    let Some(times) = airspace.activation_times else {
        return Ok((None, None));
    };
    let end = |of: Option<_>| match of {
        Some(time) => {
            let text = format!("{time}");
            let parsed = text.parse::<Timestamp>();
            parsed
                .map(Some)
                .map_err(|_| format!("`{}` is no time", text.escape_debug()))
        }
        None => Ok(None),
    };
    Ok((end(times.start)?, end(times.end)?))
}

fn corners(segments: &[PolygonSegment]) -> Result<Vec<LatLon>, String> {
    let mut corners = Vec::new();
    for segment in segments {
        match segment {
            PolygonSegment::Point(at) => corners.push(coord(at)?),
            PolygonSegment::Arc(arc) => corners.extend(between(arc)?),
            PolygonSegment::ArcSegment(arc) => corners.extend(swept(arc)?),
        }
    }
    Ok(corners)
}

/// An arc from one place to another around a third.
fn between(arc: &Arc) -> Result<Vec<LatLon>, String> {
    let frame = LocalFrame::new(coord(&arc.centerpoint)?);
    let end = |of: &Coord| {
        let EastNorth { east_m, north_m } = frame.to_plan(coord(of)?);
        Ok::<_, String>((east_m.atan2(north_m), east_m.hypot(north_m)))
    };
    let (from, to) = (end(&arc.start)?, end(&arc.end)?);
    // The two radii of a file differ by its rounding.
    if (from.1 - to.1).abs() > 0.05 * from.1.max(to.1) + 100.0 {
        let why = format!("an arc with radii of {:.0} m and {:.0} m", from.1, to.1);
        return Err(why);
    }
    Ok(drawn(
        &frame,
        (from.0, to.0),
        from.1.max(to.1),
        arc.direction,
    ))
}

/// An arc of a radius between two bearings.
fn swept(arc: &ArcSegment) -> Result<Vec<LatLon>, String> {
    let frame = LocalFrame::new(coord(&arc.centerpoint)?);
    let radius_m = f64::from(arc.radius) * NAUTICAL_MILE_M;
    circle(coord(&arc.centerpoint)?, radius_m)?;
    let rad = |degrees: f32| f64::from(degrees).to_radians();
    let bearings = (rad(arc.angle_start), rad(arc.angle_end));
    Ok(drawn(&frame, bearings, radius_m, arc.direction))
}

/// Both ends of an arc, and corners between them whose edges touch it from outside.
fn drawn(
    frame: &LocalFrame,
    (from_rad, to_rad): (f64, f64),
    radius_m: f64,
    direction: Direction,
) -> Vec<LatLon> {
    let turn_rad = match direction {
        Direction::Cw => (to_rad - from_rad).rem_euclid(std::f64::consts::TAU),
        Direction::Ccw => -(from_rad - to_rad).rem_euclid(std::f64::consts::TAU),
    };
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a turn is at most a full circle"
    )]
    let steps = (turn_rad.abs() / STEP_RAD).ceil().max(1.0) as u32;
    let step_rad = turn_rad / f64::from(steps);
    let at = |bearing_rad: f64, away_m: f64| {
        let (sin, cos) = bearing_rad.sin_cos();
        frame.from_plan(EastNorth {
            east_m: away_m * sin,
            north_m: away_m * cos,
        })
    };
    let outside_m = radius_m / (0.5 * step_rad).cos();
    let middles = (0..steps).map(|step| {
        let bearing_rad = from_rad + (f64::from(step) + 0.5) * step_rad;
        at(bearing_rad, outside_m)
    });
    let mut corners = vec![at(from_rad, radius_m)];
    corners.extend(middles);
    corners.push(at(to_rad, radius_m));
    corners
}

fn coord(of: &Coord) -> Result<LatLon, String> {
    place(of.lat, of.lng)
}

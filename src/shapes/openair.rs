//! OpenAir, the airspace format of gliding and flight planning. Distances are nautical miles,
//! heights feet, metres or flight levels; arcs become polylines that enclose the zone.

use ::openair::{Airspace, Altitude, Arc, ArcSegment, Coord, Direction, Geometry as Outline};
use ::openair::{Class, PolygonSegment};
use std::borrow::Cow;
use std::f64::consts::TAU;

use jiff::Timestamp;

use super::heights::{FOOT_M, NAUTICAL_MILE_M};
use super::{Collection, Geometry, Height, Refused, Shape, ShapesError, circle, malformed, place};
use super::{periods::Period, ring};
use crate::geodesy::{EastNorth, LatLon, LocalFrame};

/// Longest step of an arc, radians.
const STEP_RAD: f64 = 0.06;
/// Records of a zone. Other lines before the first one that begins with AC are titles.
const RECORDS: [&str; 12] = [
    "AN", "AL", "AH", "AY", "AA", "AI", "V", "DP", "DC", "DA", "DB", "AF",
];

/// Reads each block on its own, so that an error in one does not affect the others.
pub(super) fn read(bytes: &[u8]) -> Result<Collection, ShapesError> {
    let text = decoded(bytes);
    let mut collection = Collection::default();
    let (stray, blocks) = blocks(&text);
    if let Some(line) = stray {
        let why = "a record before the first line that begins with AC".to_owned();
        let name = format!("line {line}");
        collection.refused.push(Refused { name, why });
    }
    for (line, block) in blocks {
        let label = name_of(&block);
        let label = label.unwrap_or_else(|| format!("line {line}"));
        if let Some((at, record)) = record_after_corners(&block) {
            let why = format!(
                "line {}: {record} after corners: a zone begins with AC",
                line + at
            );
            collection.refused.push(Refused { name: label, why });
            continue;
        }
        let parsed = with_heights(&block);
        let found: Vec<_> = ::openair::parse(parsed.as_bytes()).collect();
        match <[_; 1]>::try_from(found) {
            Ok([Ok(airspace)]) if is_unrestricted(&airspace) => collection.unrestricted += 1,
            Ok([Ok(airspace)]) => {
                match angles(&block).and_then(|()| shape(&label, &airspace, &block)) {
                    Ok(shape) => collection.shapes.push(shape),
                    Err(why) => collection.refused.push(Refused { name: label, why }),
                }
            }
            Ok([Err(why)]) => collection.refused.push(Refused { name: label, why }),
            Err(found) => {
                let why = found.into_iter().find_map(Result::err);
                let why = why.unwrap_or("not exactly one airspace".to_owned());
                collection.refused.push(Refused { name: label, why });
            }
        }
    }
    if collection.shapes.is_empty() && collection.refused.is_empty() && collection.unrestricted == 0
    {
        return Err(malformed("OpenAir", "no line begins with AC"));
    }
    Ok(collection)
}

/// UTF-8, else Latin-1, which many files are in.
fn decoded(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => bytes.iter().map(|byte| char::from(*byte)).collect(),
    }
}

/// The lines from each `AC` to the next, with the number of the first, and the first record before all of them.
fn blocks(text: &str) -> (Option<usize>, Vec<(usize, String)>) {
    let mut blocks: Vec<(usize, String)> = Vec::new();
    let mut stray = None;
    for (index, line) in text.lines().enumerate() {
        let line = line.trim_start_matches('\u{feff}').trim();
        let key = line.split_whitespace().next().unwrap_or_default();
        // In small letters it is an error of its block.
        if key.eq_ignore_ascii_case("AC") {
            blocks.push((index + 1, String::new()));
        }
        let is_record = || RECORDS.iter().any(|of| key.eq_ignore_ascii_case(of));
        match blocks.last_mut() {
            Some((_, block)) => {
                block.push_str(line);
                block.push('\n');
            }
            None if stray.is_none() && is_record() => stray = Some(index + 1),
            None => {}
        }
    }
    (stray, blocks)
}

/// The first record of a block that can only belong to another zone: the parser would leave out all after it. With
/// its line, from 0.
fn record_after_corners(block: &str) -> Option<(usize, &str)> {
    let is_corner = |line: &str| {
        let key = line.split_whitespace().next().unwrap_or_default();
        ["V", "DP", "DC", "DA", "DB"].contains(&key)
    };
    let corners = block.lines().position(is_corner)?;
    let after = block.lines().enumerate().skip(corners);
    let mut records = after.filter_map(|(at, line)| Some((at, line.get(..2)?)));
    // AT places a label.
    records.find(|(_, key)| key.starts_with('A') && *key != "AT")
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
fn is_unrestricted(airspace: &Airspace) -> bool {
    airspace.type_.is_none() && matches!(airspace.class, Class::G)
}

/// The parser takes any number of minutes and seconds.
fn angles(block: &str) -> Result<(), String> {
    let is_place = |line: &&str| {
        ["DP", "DB", "V"].contains(&line.split_whitespace().next().unwrap_or_default())
    };
    let lines = block.lines().filter(is_place);
    let words =
        lines.flat_map(|line| line.split(|c: char| !(c.is_ascii_digit() || ":.".contains(c))));
    for word in words.filter(|word| word.contains(':')) {
        let mut parts = word.split(':').skip(1);
        if parts.any(|part| part.parse().is_ok_and(|part: f64| part >= 60.0)) {
            return Err(format!("{word} (allowed: minutes and seconds below 60)"));
        }
    }
    Ok(())
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
        active: active(airspace, block)?,
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

/// The active times. The parser leaves out what follows the first two, and later lines: with more than one period the
/// zone is active always.
fn active(airspace: &Airspace, block: &str) -> Result<Period, String> {
    let mut lines = block.lines().filter_map(|line| line.strip_prefix("AA "));
    let is_time = |c: char| c.is_ascii_alphanumeric() || "-+:.".contains(c);
    let is_end = |text: &str| !text.is_empty() && text.chars().all(is_time);
    let is_one = |line: &str| line.trim().split('/').filter(|end| is_end(end)).count() == 2;
    let is_whole = lines
        .next()
        .is_none_or(|line| is_one(line) && line.matches('/').count() == 1);
    let is_read = is_whole && lines.next().is_none();
    let Some(times) = airspace.activation_times.filter(|_| is_read) else {
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

/// The corners of a zone, which its edges do not cut anything off from: an arc has its corners outside of its circle
/// where the zone is inside of it, and inside otherwise.
fn corners(segments: &[PolygonSegment]) -> Result<Vec<LatLon>, String> {
    let arcs: Vec<Part> = segments.iter().map(part).collect::<Result<_, _>>()?;
    let ends = arcs.iter().flat_map(|part| part.corners(None));
    let is_clockwise = clockwise(&ends.collect::<Vec<_>>());
    let corners = arcs
        .iter()
        .flat_map(|part| part.corners(Some(is_clockwise)));
    Ok(corners.collect())
}

/// Whether a ring turns clockwise as seen from above.
fn clockwise(ring: &[LatLon]) -> bool {
    let Some(frame) = ring.first().map(|at| LocalFrame::new(*at)) else {
        return true;
    };
    let at: Vec<EastNorth> = ring.iter().map(|at| frame.to_plan(*at)).collect();
    let next = at.iter().cycle().skip(1);
    let cross = |(a, b): (&EastNorth, &EastNorth)| a.east_m * b.north_m - b.east_m * a.north_m;
    at.iter().zip(next).map(cross).sum::<f64>() < 0.0
}

/// A part of an outline.
enum Part {
    Corner(LatLon),
    /// Around the origin of the frame: the bearing of its begin, how far it turns (clockwise positive), radians, and
    /// its least and greatest radius, metres.
    Arc {
        frame: LocalFrame,
        from_rad: f64,
        turn_rad: f64,
        radii_m: [f64; 2],
    },
}

fn part(segment: &PolygonSegment) -> Result<Part, String> {
    match segment {
        PolygonSegment::Point(at) => Ok(Part::Corner(coord(at)?)),
        PolygonSegment::Arc(arc) => between(arc),
        PolygonSegment::ArcSegment(arc) => swept(arc),
    }
}

/// An arc from one place to another around a third.
fn between(arc: &Arc) -> Result<Part, String> {
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
    Ok(Part::Arc {
        frame,
        from_rad: from.0,
        turn_rad: turn_rad((from.0, to.0), arc.direction),
        radii_m: [from.1.min(to.1), from.1.max(to.1)],
    })
}

/// An arc of a radius between two bearings.
fn swept(arc: &ArcSegment) -> Result<Part, String> {
    let radius_m = f64::from(arc.radius) * NAUTICAL_MILE_M;
    circle(coord(&arc.centerpoint)?, radius_m)?;
    let rad = |degrees: f32| f64::from(degrees).to_radians();
    let bearings = (rad(arc.angle_start), rad(arc.angle_end));
    Ok(Part::Arc {
        frame: LocalFrame::new(coord(&arc.centerpoint)?),
        from_rad: bearings.0,
        turn_rad: turn_rad(bearings, arc.direction),
        radii_m: [radius_m; 2],
    })
}

/// How far an arc turns from one bearing to another; one that ends where it begins is a circle.
fn turn_rad((from_rad, to_rad): (f64, f64), direction: Direction) -> f64 {
    let (min_rad, sign) = match direction {
        Direction::Cw => (to_rad - from_rad, 1.0),
        Direction::Ccw => (from_rad - to_rad, -1.0),
    };
    let turn_rad = min_rad.rem_euclid(TAU);
    let is_circle = turn_rad < 1e-9 || TAU - turn_rad < 1e-9;
    sign * if is_circle { TAU } else { turn_rad }
}

impl Part {
    /// Its corners; of an arc in a zone that turns clockwise, counterclockwise, or either way.
    fn corners(&self, zone: Option<bool>) -> Vec<LatLon> {
        let (frame, from_rad, turn_rad, [min_m, max_m]) = match self {
            Self::Corner(at) => return vec![*at],
            Self::Arc {
                frame,
                from_rad,
                turn_rad,
                radii_m,
            } => (frame, *from_rad, *turn_rad, *radii_m),
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
        let is_inside = zone.is_none_or(|is_clockwise| is_clockwise == (turn_rad > 0.0));
        if !is_inside {
            let corners = (0..=steps).map(|step| at(from_rad + f64::from(step) * step_rad, min_m));
            return corners.collect();
        }
        // Its edges touch the circle.
        let outside_m = max_m / (0.5 * step_rad).cos();
        let mut corners = vec![at(from_rad, max_m)];
        corners.extend((0..steps).map(|step| {
            let bearing_rad = from_rad + (f64::from(step) + 0.5) * step_rad;
            at(bearing_rad, outside_m)
        }));
        corners.push(at(from_rad + turn_rad, max_m));
        corners
    }
}

fn coord(of: &Coord) -> Result<LatLon, String> {
    place(of.lat, of.lng)
}

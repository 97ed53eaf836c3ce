//! Zones and obstacles from files.

mod obstacles;
mod shaped_table;

use std::collections::BTreeSet;

use geo::BoundingRect;

use super::super::airspace::{AirspaceImport, AttachedFile};
use super::super::keys;
use super::super::{Placement, Zone};
use super::Checker;
use super::map::{Map, with_axes_swapped};
use super::zones::References;
use crate::geodesy::{Agl, Amsl, LatLon, LocalFrame, flight_level};
use crate::numeric::text::{is_hidden, meant};
use crate::shapes::{self, Collection, Geometry, Height, Shape};

/// How far beyond the area a zone still counts, metres: tracks and margins stay within.
const REACH_M: f64 = 1000.0;
/// Most corners of one ring of a file: more than any fence, and than is measured in time.
const MAX_CORNERS: usize = 5_000;
/// Classes that close a zone: of ED-269, ED-318, and as authorities write them.
const RESTRICTIONS: [&str; 8] = [
    "PROHIBITED",
    "REQ_AUTHORISATION",
    "REQ_AUTHORIZATION",
    "CONDITIONAL",
    "RESTRICTED",
    "DANGER",
    "NO_FLY",
    "USPACE",
];
/// Longest id, bytes.
const MAX_ID: usize = 60;

/// Why a shape is not among the zones.
enum Dropped {
    Refused(String),
    OutOfReach,
    WithoutArea,
}

impl Checker {
    /// Adds the zones of all files, and what became of each.
    pub(super) fn add_files(
        &mut self,
        keys: &keys::Spec,
        files: &[AttachedFile],
        references: References,
        map: &mut Map,
    ) {
        let (airspace, obstacles) = files.split_at(keys.airspace.len().min(files.len()));
        for (index, (of, file)) in keys.airspace.iter().zip(airspace).enumerate() {
            let path = format!("airspace[{index}]");
            self.add_airspace((&path, of), file, references, map);
        }
        for (index, (of, file)) in keys.obstacles.iter().zip(obstacles).enumerate() {
            let path = format!("obstacles[{index}]");
            self.add_obstacles((&path, of), file, map);
        }
    }

    fn add_airspace(
        &mut self,
        (path, keys): (&str, &keys::AirspaceFile),
        file: &AttachedFile,
        references: References,
        map: &mut Map,
    ) {
        let path = format!("{path}.file");
        let collection = match shapes::read(&keys.file, &file.bytes) {
            Ok(collection) => collection,
            Err(error) => {
                let allowed = format!("a file of the kind {}", shapes::ENDINGS.join(", "));
                return self.report(&path, error, allowed);
            }
        };
        let mut import = AirspaceImport {
            file: keys.file.clone(),
            unrestricted: collection.unrestricted,
            ..AirspaceImport::default()
        };
        import.unmatched = unmatched(keys, &collection);
        let is_skipped = |name: &str| keys.skip.iter().any(|skip| skip == name);
        let mut refused: Vec<(String, String)> = Vec::new();
        for of in collection.refused {
            match is_skipped(&of.name) {
                true => import.left_out += 1,
                false => refused.push((of.name, of.why)),
            }
        }
        for shape in collection.shapes {
            if is_skipped(&shape.name) || !is_asked(keys, &shape) {
                import.left_out += 1;
                continue;
            }
            let buffer_m = keys.buffer_m.unwrap_or(0.0);
            let zone = zone(&shape, buffer_m, references, map);
            let has_axes_swapped = || usize::from(has_axes_swapped(&shape.geometry, map));
            match zone.and_then(|zone| self.simple(zone, map)) {
                Ok(mut zone) => {
                    zone.id = free_id(&shape.name, map);
                    zone.buffer_m = buffer_m;
                    zone.source = Some(source(&keys.file, &shape));
                    import.zones.push(zone.id.clone());
                    map.no_fly.push(zone);
                }
                Err(Dropped::OutOfReach) => {
                    import.out_of_reach += 1;
                    import.axes_swapped += has_axes_swapped();
                }
                Err(Dropped::WithoutArea) => import.without_area += 1,
                Err(Dropped::Refused(why)) => refused.push((shape.name, why)),
            }
        }
        for (name, why) in refused {
            let found = format!("`{}` cannot be a zone: {why}", name.escape_debug());
            let allowed = "zones that can be read, or its name in skip";
            self.report(&path, found, allowed);
        }
        map.imports.push(import);
    }

    /// A zone whose rings do not cross themselves.
    fn simple(&mut self, zone: Zone, map: &Map) -> Result<Zone, Dropped> {
        let before = self.issues.len();
        for ring in std::iter::once(&zone.polygon).chain(&zone.holes) {
            if zone.circle.is_none() && !self.polygon("", &map.frame, ring) {
                let why = self.issues.split_off(before);
                let why = why.into_iter().next().map(|issue| issue.found);
                return Err(Dropped::Refused(why.unwrap_or_default()));
            }
        }
        Ok(zone)
    }
}

/// The names and classes that a spec asks for and a file does not have, with those that they are like.
fn unmatched(keys: &keys::AirspaceFile, of: &Collection) -> Vec<(String, Option<String>)> {
    let names = || {
        let shapes = of.shapes.iter().map(|shape| shape.name.as_str());
        shapes.chain(of.refused.iter().map(|refused| refused.name.as_str()))
    };
    let classes = || {
        of.shapes
            .iter()
            .flat_map(|shape| shape.classes.iter().map(String::as_str))
    };
    let known: BTreeSet<&str> = names().collect();
    let skip = keys
        .skip
        .iter()
        .filter(|name| !known.contains(name.as_str()));
    let asked = keys.only.iter().flat_map(|only| &only.class);
    let asked = asked.filter(|class| !classes().any(|of| of.eq_ignore_ascii_case(class)));
    let like = |word: &String, like: Option<&str>| (word.clone(), like.map(str::to_owned));
    // A file has many shapes of few classes.
    let few: BTreeSet<&str> = classes().collect();
    let skip = skip.map(|name| like(name, meant(name, known.iter().copied())));
    let asked = asked.map(|class| like(class, meant(class, few.iter().copied())));
    skip.chain(asked).collect()
}

/// Whether a shape has a class that a file is read for.
fn is_asked(keys: &keys::AirspaceFile, shape: &Shape) -> bool {
    keys.only.as_ref().is_none_or(|only| {
        let mut asked = only.class.iter();
        asked.any(|class| {
            let mut classes = shape.classes.iter();
            classes.any(|of| of.eq_ignore_ascii_case(class))
        })
    })
}

/// The zone of a shape, without its id.
fn zone(shape: &Shape, buffer_m: f64, references: References, map: &Map) -> Result<Zone, Dropped> {
    let (polygon, holes, circle) = match &shape.geometry {
        Geometry::Polygon { outer, holes } => (outer.clone(), holes.clone(), None),
        Geometry::Circle { center, radius_m } => {
            let around = LocalFrame::new(*center).circumscribed(*radius_m);
            (around, Vec::new(), Some((*center, *radius_m)))
        }
        Geometry::Line(_) | Geometry::Point(_) => return Err(without_area(shape, map)),
    };
    if is_far(&polygon, buffer_m, map) {
        return Err(Dropped::OutOfReach);
    }
    let refused = |why: &str| Err(Dropped::Refused(why.to_owned()));
    if shape.keep_in {
        return refused("it is to stay in, not out: an inclusion fence");
    }
    if polygon.len() > MAX_CORNERS {
        return refused("more than 5000 corners");
    }
    if has_nothing_left(&polygon, &holes, map) {
        return refused("a hole that is as large as its outline");
    }
    let floor = placed(shape.floor, references.qnh, |qnh| qnh.min)?;
    let ceiling = placed(shape.ceiling, references.qnh, |qnh| qnh.max)?;
    if let Some(Placement::Amsl(floor)) = floor
        && floor.0 - buffer_m >= map.area.max_amsl.0
    {
        return Err(Dropped::OutOfReach);
    }
    match (floor, ceiling) {
        (Some(Placement::Amsl(low)), Some(Placement::Amsl(high))) if low >= high => {
            return refused("a ceiling below its floor");
        }
        (Some(Placement::Agl(low)), Some(Placement::Agl(high))) if low >= high => {
            return refused("a ceiling below its floor");
        }
        _ => {}
    }
    let after_s = |time: Option<jiff::Timestamp>, absent_s: f64| {
        let time = time.zip(references.t0);
        time.map_or(absent_s, |(time, t0)| time.duration_since(t0).as_secs_f64())
    };
    let (from_s, to_s) = (
        after_s(shape.active.0, f64::NEG_INFINITY),
        after_s(shape.active.1, f64::INFINITY),
    );
    if from_s > to_s {
        return refused("a period that ends before it begins");
    }
    Ok(Zone {
        holes,
        circle,
        floor,
        ceiling,
        active_s: (from_s.is_finite() || to_s.is_finite()).then_some((from_s, to_s)),
        ..Zone::closed(String::new(), polygon)
    })
}

/// Whether a hole takes all of a zone, or more.
fn has_nothing_left(polygon: &[LatLon], holes: &[Vec<LatLon>], map: &Map) -> bool {
    let size = |ring: &[LatLon]| geo::Area::unsigned_area(&map.frame.outline(ring));
    let is_whole = |hole: &Vec<LatLon>| size(hole) >= 0.999 * size(polygon);
    holes.iter().any(is_whole)
}

/// What becomes of a line or a point: one that is declared a restriction must not be missing.
fn without_area(shape: &Shape, map: &Map) -> Dropped {
    let is_restriction = |class: &String| {
        let mut words = RESTRICTIONS.iter();
        words.any(|word| word.eq_ignore_ascii_case(class))
    };
    let has_heights = shape.floor.is_some() || shape.ceiling.is_some();
    if !has_heights && !shape.classes.iter().any(is_restriction) {
        return Dropped::WithoutArea;
    }
    if is_far(&shape.geometry.positions(), 0.0, map) {
        return Dropped::OutOfReach;
    }
    let why = match &shape.geometry {
        Geometry::Line(_) => "a restriction that is a line: draw the polygon around it",
        _ => "a restriction that is a point without a radius in metres",
    };
    Dropped::Refused(why.to_owned())
}

/// A height in metres; a flight level at the pressure that makes the zone largest.
fn placed(
    height: Option<Height>,
    qnh: Option<keys::Qnh>,
    widest: fn(keys::Qnh) -> f64,
) -> Result<Option<Placement>, Dropped> {
    Ok(match height {
        None => None,
        Some(Height::Amsl(metres)) => Some(Placement::Amsl(Amsl(metres))),
        Some(Height::Agl(metres)) => Some(Placement::Agl(Agl(metres))),
        Some(Height::FlightLevel(level)) => {
            let Some(qnh) = qnh else {
                let why = format!("flight level {level} needs qnh_hpa in the spec");
                return Err(Dropped::Refused(why));
            };
            Some(Placement::Amsl(flight_level(level, widest(qnh))))
        }
    })
}

/// Whether a shape would be in the area with its latitudes and longitudes exchanged.
fn has_axes_swapped(geometry: &Geometry, map: &Map) -> bool {
    let (low, high) = (map.area.south_west, map.area.north_east);
    let is_inside = |place: &LatLon| {
        with_axes_swapped(*place).is_some_and(|at| {
            (low.lat_deg..=high.lat_deg).contains(&at.lat_deg)
                && (low.lon_deg..=high.lon_deg).contains(&at.lon_deg)
        })
    };
    match geometry {
        Geometry::Polygon { outer, .. } => outer.iter().any(is_inside),
        Geometry::Circle { center, .. } => is_inside(center),
        Geometry::Point(at) => is_inside(at),
        Geometry::Line(line) => line.iter().any(is_inside),
    }
}

/// Whether the box of a zone with its buffer lies beside the area.
fn is_far(polygon: &[LatLon], buffer_m: f64, map: &Map) -> bool {
    let Some(area) = map.outline.bounding_rect() else {
        return false;
    };
    // Far from the frame its coordinates mean nothing, nearness does.
    let origin = map.frame.origin();
    let near_m = REACH_M + buffer_m;
    let reach_m = near_m + area.width().hypot(area.height());
    if polygon.len() < 2_000 && polygon.iter().all(|at| at.chord_m(origin) < 500_000.0) {
        let Some(zone) = map.frame.outline(polygon).bounding_rect() else {
            return false;
        };
        return zone.min().x > area.max().x + near_m
            || zone.max().x < area.min().x - near_m
            || zone.min().y > area.max().y + near_m
            || zone.max().y < area.min().y - near_m;
    }
    let bounds = |of: fn(&LatLon) -> f64| {
        let values = polygon.iter().map(of);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
            (a.min(x), b.max(x))
        })
    };
    let (south, north) = bounds(|at| at.lat_deg);
    let (west, east) = bounds(|at| at.lon_deg);
    let degrees = reach_m / 100_000.0;
    let wide = degrees / origin.lat_deg.to_radians().cos().max(0.05);
    // A zone across the date line spans all longitudes this way, and so is near.
    origin.lat_deg < south - degrees
        || origin.lat_deg > north + degrees
        || origin.lon_deg < west - wide
        || origin.lon_deg > east + wide
}

/// A name as an id that no zone has yet.
fn free_id(name: &str, map: &Map) -> String {
    let shown: String = name
        .chars()
        .map(|sign| if is_hidden(sign) { '_' } else { sign })
        .collect();
    let mut id = String::new();
    for sign in shown.trim().chars() {
        if id.len() + sign.len_utf8() > MAX_ID {
            break;
        }
        id.push(sign);
    }
    if id.is_empty() {
        id.push_str("zone");
    }
    let is_taken = |id: &str| {
        map.no_fly
            .iter()
            .any(|zone| zone.id.eq_ignore_ascii_case(id))
    };
    if !is_taken(&id) {
        return id;
    }
    let numbered = (2..).map(|number: u64| format!("{id} {number}"));
    let mut free = numbered.skip_while(|id| is_taken(id));
    free.next().unwrap_or(id)
}

/// File, item, classes.
fn source(file: &str, shape: &Shape) -> String {
    let classes = shape.classes.join(", ");
    match classes.as_str() {
        "" => format!("{file}, {}", shape.name),
        _ => format!("{file}, {} ({classes})", shape.name),
    }
}

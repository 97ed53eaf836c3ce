//! Obstacles that stand on the terrain, from files: masts, lines between masts, buildings.

use super::super::super::airspace::{AirspaceImport, AttachedFile};
use super::super::super::keys;
use super::super::super::{Placement, Zone};
use super::super::map::Map;
use super::{Checker, Dropped, MAX_CORNERS, free_id, has_axes_swapped, is_far, shaped_table};
use crate::geodesy::{Agl, EastNorth, LatLon, LocalFrame};
use crate::numeric::text::{meant, with_line_feeds};
use crate::shapes::{self, Geometry, Shape};

/// What is measured of a mast in a table.
const COLUMNS: [&str; 4] = ["lat", "lon", "height_m", "radius_m"];
/// Radius of an obstacle that states none, metres.
const MAST_RADIUS_M: f64 = 5.0;
/// Most rows of a table that are named as wrong.
const MAX_NAMED: usize = 10;
/// Half the width of a line that states none, metres.
const LINE_RADIUS_M: f64 = 10.0;
/// Furthest two vertices of a line may be apart, metres: further, the ground between them is unknown.
const MAX_SPAN_M: f64 = 5000.0;
/// Widest footprint over which the ground is no higher than at its corners and in its middle, metres.
const SMALL_M: f64 = 200.0;

/// A mast, a span of a line, a building.
struct Obstacle {
    name: String,
    /// The name of what it is a part of, such as a line of a span.
    whole: String,
    footprint: Footprint,
    height_m: f64,
}

enum Footprint {
    Circle(LatLon, f64),
    /// Between two vertices of a line, with half its width.
    Span([LatLon; 2], f64),
    Building {
        outer: Vec<LatLon>,
        holes: Vec<Vec<LatLon>>,
    },
}

impl Checker {
    pub(super) fn add_obstacles(
        &mut self,
        (path, keys): (&str, &keys::ObstacleFile),
        file: &AttachedFile,
        map: &mut Map,
    ) {
        let path = format!("{path}.file");
        let found = match keys.file.to_lowercase().ends_with(".csv") {
            true => rows(&keys.file, &file.bytes),
            false => shaped(&keys.file, &file.bytes).map_err(|why| vec![why]),
        };
        let found = match found {
            Ok(found) => found,
            Err(found) => {
                let allowed = "a .csv with lat, lon, height_m, radius_m or with WKT and height_m, or GeoJSON points, lines and polygons with height_m";
                for why in found {
                    self.report(&path, why, allowed);
                }
                return;
            }
        };
        let mut import = AirspaceImport {
            file: keys.file.clone(),
            ..AirspaceImport::default()
        };
        for obstacle in found {
            if is_far(&obstacle.polygon(), 0.0, map) {
                import.out_of_reach += 1;
                import.axes_swapped += usize::from(has_axes_swapped(&obstacle.geometry(), map));
                continue;
            }
            for (name, zone) in obstacle.zones() {
                let zone = match self.simple(zone, map) {
                    Ok(zone) => zone,
                    Err(Dropped::Refused(why)) => {
                        let found = format!("`{}`: {why}", obstacle.name.escape_debug());
                        self.report(&path, found, "a polygon that does not cross itself");
                        break;
                    }
                    Err(_) => break,
                };
                let zone = Zone {
                    id: free_id(&name, map),
                    source: Some(format!("{}, {}", keys.file, obstacle.name)),
                    part_of: Some(obstacle.whole.clone()),
                    ..zone
                };
                import.zones.push(zone.id.clone());
                map.no_fly.push(zone);
            }
        }
        map.imports.push(import);
    }
}

impl Obstacle {
    fn polygon(&self) -> Vec<LatLon> {
        match &self.footprint {
            Footprint::Circle(at, radius_m) => LocalFrame::new(*at).circumscribed(*radius_m),
            Footprint::Span(ends, half_m) => strip(*ends, *half_m),
            Footprint::Building { outer, .. } => outer.clone(),
        }
    }

    fn geometry(&self) -> Geometry {
        match &self.footprint {
            Footprint::Circle(at, _) => Geometry::Point(*at),
            Footprint::Span(ends, _) => Geometry::Line(ends.to_vec()),
            Footprint::Building { outer, .. } => Geometry::Line(outer.clone()),
        }
    }

    /// Its zones with their names. A wire hangs between tops, and a roof is flat: over a valley or a
    /// slope they are further above the ground than their height, so that they reach up to it above the
    /// highest ground of their ends or corners. Where the ground between these may be higher, a second
    /// zone is as high above it.
    fn zones(&self) -> Vec<(String, Zone)> {
        let over_ground = Zone {
            ceiling: Some(Placement::Agl(Agl(self.height_m))),
            ..Zone::closed(String::new(), self.polygon())
        };
        let (bases, over_ground) = match &self.footprint {
            Footprint::Circle(at, radius_m) => {
                let zone = Zone {
                    circle: Some((*at, *radius_m)),
                    ..over_ground
                };
                return vec![(self.name.clone(), zone)];
            }
            Footprint::Span(ends, _) => (ends.to_vec(), over_ground),
            Footprint::Building { outer, holes } => {
                let mut bases = outer.clone();
                bases.extend(middle(outer));
                let holes = holes.clone();
                let zone = Zone {
                    holes,
                    ..over_ground
                };
                (bases, zone)
            }
        };
        let is_small = bases.iter().all(|at| at.chord_m(bases[0]) <= SMALL_M);
        let level = Zone {
            bases,
            ..over_ground.clone()
        };
        let mut zones = vec![(self.name.clone(), level)];
        if !is_small {
            zones.push((format!("{} above ground", self.name), over_ground));
        }
        zones
    }
}

/// The middle of the corners; none where they are on both sides of the date line.
fn middle(corners: &[LatLon]) -> Option<LatLon> {
    let frame = LocalFrame::new(*corners.first()?);
    let mut sum = (0.0, 0.0);
    for corner in corners {
        let at = frame.to_plan(*corner);
        sum = (sum.0 + at.east_m, sum.1 + at.north_m);
    }
    let count = f64::from(u32::try_from(corners.len()).ok()?);
    Some(frame.from_plan(EastNorth {
        east_m: sum.0 / count,
        north_m: sum.1 / count,
    }))
}

/// What lies within half a width of a span, with square ends.
fn strip([from, to]: [LatLon; 2], half_m: f64) -> Vec<LatLon> {
    let frame = LocalFrame::new(from);
    let end = frame.to_plan(to);
    let length_m = end.east_m.hypot(end.north_m);
    let (east, north) = (end.east_m / length_m, end.north_m / length_m);
    let corner = |along_m: f64, left_m: f64| {
        frame.from_plan(EastNorth {
            east_m: along_m * east - left_m * north,
            north_m: along_m * north + left_m * east,
        })
    };
    vec![
        corner(-half_m, -half_m),
        corner(length_m + half_m, -half_m),
        corner(length_m + half_m, half_m),
        corner(-half_m, half_m),
    ]
}

/// A height and a radius that are possible.
fn checked(name: &str, height_m: Option<f64>, radius_m: f64) -> Result<(f64, f64), String> {
    let height_m = height_m.ok_or_else(|| format!("{name}: no height_m"))?;
    if !(0.0..=2000.0).contains(&height_m) || height_m <= 0.0 {
        return Err(format!("{name}: height_m {height_m}, not above 0 to 2000"));
    }
    if !(1.0..=10_000.0).contains(&radius_m) {
        return Err(format!("{name}: radius_m {radius_m}, not 1 to 10000"));
    }
    Ok((height_m, radius_m))
}

/// A mast of numbers that are possible.
fn mast(
    name: String,
    at: LatLon,
    height_m: Option<f64>,
    radius_m: Option<f64>,
) -> Result<Obstacle, String> {
    let (height_m, radius_m) = checked(&name, height_m, radius_m.unwrap_or(MAST_RADIUS_M))?;
    Ok(Obstacle {
        whole: name.clone(),
        name,
        footprint: Footprint::Circle(at, radius_m),
        height_m,
    })
}

/// The rows of a table with the columns lat, lon, height_m, and perhaps radius_m and id; or with a column of
/// well-known text in place of lat and lon.
fn rows(file: &str, bytes: &[u8]) -> Result<Vec<Obstacle>, Vec<String>> {
    let bytes = with_line_feeds(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes));
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(bytes.as_slice());
    let names = reader.headers();
    let names = names.map_err(|error| vec![error.to_string()])?.clone();
    if let Some(twice) = shaped_table::twice(&names) {
        let column = twice.escape_debug();
        return Err(vec![format!(
            "column `{column}` stands twice (allowed: each once)"
        )]);
    }
    let column = |name: &str| shaped_table::column(&names, name);
    let records: Result<Vec<_>, _> = reader.records().collect();
    let records = records.map_err(|error| vec![error.to_string()])?;
    let geometry = shaped_table::geometry_column(&names, &records);
    let columns = match geometry {
        Some(_) => &COLUMNS[2..],
        None => &COLUMNS[..],
    };
    // Without radius_m a mast is narrow: it must not be missing because its name is misspelt.
    for missing in columns.iter().filter(|name| column(name).is_none()) {
        let mut others = (names.iter()).filter(|of| !COLUMNS.contains(of) && *of != "heights_m");
        if let Some(other) = others.find(|other| meant(other, [*missing]).is_some()) {
            let other = other.escape_debug();
            return Err(vec![format!("column `{other}`: did you mean `{missing}`?")]);
        }
    }
    if let Some(geometry) = geometry {
        let table = (&names, records.as_slice());
        let bytes = shaped_table::as_geojson(file, table, geometry).map_err(|why| vec![why])?;
        return shaped("table.geojson", &bytes)
            .map_err(|why| vec![format!("{why}; {}", shaped_table::command(file))]);
    }
    masts(&names, &records)
}

/// The rows of a table with the columns lat, lon, height_m; or what is wrong with each that is not one.
fn masts(
    names: &csv::StringRecord,
    records: &[csv::StringRecord],
) -> Result<Vec<Obstacle>, Vec<String>> {
    let column = |name: &str| shaped_table::column(names, name);
    let required = |name: &str| column(name).ok_or_else(|| vec![format!("no column {name}")]);
    let (lat, lon, height) = (required("lat")?, required("lon")?, required("height_m")?);
    let (radius, id) = (column("radius_m"), column("id").or(column("name")));
    let read = |record: &csv::StringRecord| {
        let line = record.position().map_or(0, csv::Position::line);
        let cell = |column: usize| record.get(column).unwrap_or_default();
        let number = |column: usize| {
            let text = cell(column);
            let number = text.parse::<f64>().ok().filter(|of| of.is_finite());
            number.ok_or_else(|| format!("line {line}: `{}` is no number", text.escape_debug()))
        };
        let at = LatLon::new(number(lat)?, number(lon)?);
        let at = at.map_err(|error| format!("line {line}: {error}"))?;
        let radius_m = radius.filter(|column| !cell(*column).is_empty());
        let radius_m = radius_m.map(number).transpose()?;
        let name = id.map(cell).filter(|name| !name.is_empty());
        let name = name.map_or_else(|| format!("line {line}"), str::to_owned);
        mast(name, at, Some(number(height)?), radius_m)
    };
    let (mut found, mut wrong) = (Vec::new(), Vec::new());
    for record in records {
        match read(record) {
            Ok(mast) => found.push(mast),
            Err(why) => wrong.push(why),
        }
    }
    let more = wrong.len().saturating_sub(MAX_NAMED);
    if more > 0 {
        wrong.truncate(MAX_NAMED);
        wrong.push(format!("{more} more rows that are wrong"));
    }
    match wrong.is_empty() {
        true => Ok(found),
        false => Err(wrong),
    }
}

/// The obstacles of a file of shapes, by their properties `height_m`, `heights_m` and `radius_m`.
fn shaped(name: &str, bytes: &[u8]) -> Result<Vec<Obstacle>, String> {
    let collection = shapes::read(name, bytes).map_err(|error| error.to_string())?;
    if let Some(refused) = collection.refused.first() {
        return Err(format!("{}: {}", refused.name, refused.why));
    }
    let mut obstacles = Vec::new();
    for shape in &collection.shapes {
        let number = |key: &str| {
            let found = shape.numbers.iter().find(|(name, _)| name == key);
            found.map(|(_, number)| *number)
        };
        let (name, height_m, radius_m) = (&shape.name, number("height_m"), number("radius_m"));
        match &shape.geometry {
            Geometry::Point(at) => obstacles.push(mast(name.clone(), *at, height_m, radius_m)?),
            Geometry::Circle { center, radius_m } => {
                obstacles.push(mast(name.clone(), *center, height_m, Some(*radius_m))?);
            }
            Geometry::Line(line) => obstacles.extend(spans(shape, line, (height_m, radius_m))?),
            Geometry::Polygon { outer, holes } => {
                if radius_m.is_some() {
                    return Err(format!(
                        "{name}: radius_m of a polygon, which has its own width"
                    ));
                }
                if outer.len() > MAX_CORNERS {
                    return Err(format!("{name}: more than {MAX_CORNERS} corners"));
                }
                let (height_m, _) = checked(name, height_m, MAST_RADIUS_M)?;
                obstacles.push(Obstacle {
                    name: name.clone(),
                    whole: name.clone(),
                    footprint: Footprint::Building {
                        outer: outer.clone(),
                        holes: holes.clone(),
                    },
                    height_m,
                });
            }
        }
    }
    Ok(obstacles)
}

/// The spans of a line, each as high as the higher of its ends.
fn spans(
    shape: &Shape,
    line: &[LatLon],
    (height_m, radius_m): (Option<f64>, Option<f64>),
) -> Result<Vec<Obstacle>, String> {
    let name = &shape.name;
    let half_m = radius_m.unwrap_or(LINE_RADIUS_M);
    let each = shape.lists.iter().find(|(key, _)| key == "heights_m");
    let heights_m = match each {
        Some((_, heights_m)) if heights_m.len() != line.len() => {
            let (heights, vertices) = (heights_m.len(), line.len());
            return Err(format!(
                "{name}: {heights} heights_m of {vertices} vertices"
            ));
        }
        Some((_, heights_m)) => heights_m.iter().copied().map(Some).collect(),
        None => vec![height_m; line.len()],
    };
    let mut spans = Vec::new();
    for (index, (ends, heights_m)) in line.windows(2).zip(heights_m.windows(2)).enumerate() {
        let name = format!("{name} span {}", index + 1);
        let (first_m, _) = checked(&name, heights_m[0], half_m)?;
        let (second_m, _) = checked(&name, heights_m[1], half_m)?;
        let ends = [ends[0], ends[1]];
        let length_m = ends[0].chord_m(ends[1]);
        if length_m > MAX_SPAN_M {
            return Err(format!(
                "{name}: {length_m:.0} m long, not at most {MAX_SPAN_M}"
            ));
        }
        // A vertex that stands twice makes no span.
        if length_m > 0.0 {
            spans.push(Obstacle {
                name,
                whole: shape.name.clone(),
                footprint: Footprint::Span(ends, half_m),
                height_m: first_m.max(second_m),
            });
        }
    }
    Ok(spans)
}

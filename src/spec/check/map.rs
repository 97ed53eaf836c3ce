//! What lies on the map: area, terrain, threats, zones, rally points.

use std::ops::RangeInclusive;
use std::path::{Component, Path, PathBuf};

use geo::algorithm::line_intersection::{LineIntersection, line_intersection};
use geo::{Area as _, Contains, Intersects, Line, Point, Polygon};

use super::super::raw;
use super::super::{Area, Hill, Rally, TerrainSource, Threat, Zone};
use super::Checker;
use crate::geodesy::{Agl, Amsl, LatLon, LocalFrame};

/// Furthest corner of the area from the origin: the local frame is proven to here.
const MAX_AREA_M: f64 = 300_000.0;
/// Furthest anything else may be from the origin; what is further is a slip of the pen.
const MAX_AWAY_M: f64 = 1_000_000.0;
/// Radius of a threat or hill, metres.
const RADIUS_M: RangeInclusive<f64> = 1.0..=500_000.0;
/// Least area of a zone; what has less is a line.
const MIN_ZONE_M2: f64 = 1.0;
/// Most corners of one zone.
const MAX_CORNERS: usize = 1000;

/// The checked map. Threats, zones and rally points that are broken are left out;
/// then there is an issue and no spec.
pub(super) struct Map {
    pub(super) frame: LocalFrame,
    pub(super) area: Area,
    pub(super) outline: Polygon<f64>,
    pub(super) terrain: Option<TerrainSource>,
    pub(super) threats: Vec<Threat>,
    pub(super) no_fly: Vec<Zone>,
    pub(super) rally: Vec<Rally>,
}

impl Checker<'_> {
    /// Checks everything that does not move; `None` without a usable area.
    pub(super) fn map(&mut self, raw: &raw::Spec) -> Option<Map> {
        let terrain = self.terrain(&raw.terrain);
        let origin = raw.origin.map(|at| self.place("origin", at.lat, at.lon));
        let area = self.area(&raw.area);
        self.unique(
            "threats",
            raw.threats.iter().map(|threat| threat.id.as_str()),
        );
        self.unique("no_fly", raw.no_fly.iter().map(|zone| zone.id.as_str()));
        let mut threats = Vec::new();
        for (index, threat) in raw.threats.iter().enumerate() {
            threats.extend(self.threat(&format!("threats[{index}]"), threat));
        }
        let mut corners = Vec::new();
        for (index, zone) in raw.no_fly.iter().enumerate() {
            corners.push(self.corners(&format!("no_fly[{index}]"), zone));
        }
        let mut rally = Vec::new();
        for (index, point) in raw.rally.iter().enumerate() {
            let path = format!("rally[{index}]");
            let agl = self.number(&format!("{path}.agl_m"), point.agl_m, 0.0..=20_000.0);
            if let Some(place) = self.place(&path, point.lat, point.lon) {
                rally.push((
                    path,
                    Rally {
                        place,
                        agl: Agl(agl),
                    },
                ));
            }
        }
        let area = area?;
        let frame = LocalFrame::new(origin.unwrap_or_else(|| Some(middle(&area)))?);
        self.near(raw, &area, frame.origin())?;
        let mut no_fly = Vec::new();
        for (index, (zone, corners)) in raw.no_fly.iter().zip(corners).enumerate() {
            let path = format!("no_fly[{index}].polygon");
            let Some(polygon) = corners else { continue };
            if self.polygon(&path, &frame, &polygon) {
                let below = zone.below_amsl_m.map(Amsl);
                no_fly.push(Zone {
                    id: zone.id.clone(),
                    polygon,
                    below,
                });
            }
        }
        let outline = frame.outline(&area.outline());
        let mut map = Map {
            frame,
            area,
            outline,
            terrain,
            threats,
            no_fly,
            rally: Vec::new(),
        };
        for (path, point) in rally {
            self.clear(&path, "the rally point", point.place, &map);
            map.rally.push(point);
        }
        Some(map)
    }

    fn area(&mut self, raw: &raw::Area) -> Option<Area> {
        let south_west = self.place("area.south_west", raw.south_west.lat, raw.south_west.lon);
        let north_east = self.place("area.north_east", raw.north_east.lat, raw.north_east.lon);
        let min_agl = self.number("area.min_agl_m", raw.min_agl_m, 0.0..=10_000.0);
        let max_amsl = self.number("area.max_amsl_m", raw.max_amsl_m, -500.0..=20_000.0);
        let (south_west, north_east) = (south_west?, north_east?);
        let ordered =
            south_west.lat_deg < north_east.lat_deg && south_west.lon_deg < north_east.lon_deg;
        if !ordered {
            let found = format!(
                "{}, {}, not south and west of {}, {}",
                south_west.lat_deg, south_west.lon_deg, north_east.lat_deg, north_east.lon_deg
            );
            let allowed = "a corner south and west of north_east; not across the date line";
            self.report("area.south_west", found, allowed);
            return None;
        }
        Some(Area {
            south_west,
            north_east,
            min_agl: Agl(min_agl),
            max_amsl: Amsl(max_amsl),
        })
    }

    /// Everything is near the origin; `None` if the area is not.
    fn near(&mut self, raw: &raw::Spec, area: &Area, origin: LatLon) -> Option<()> {
        let furthest_m = area
            .outline()
            .into_iter()
            .map(|corner| corner.chord_m(origin))
            .fold(0.0, f64::max);
        if furthest_m > MAX_AREA_M {
            let path = if raw.origin.is_some() {
                "origin"
            } else {
                "area"
            };
            let found = format!(
                "a corner of the area {:.0} km from the origin",
                furthest_m / 1e3
            );
            self.report(path, found, format!("at most {:.0} km", MAX_AREA_M / 1e3));
            return None;
        }
        let threats = raw
            .threats
            .iter()
            .enumerate()
            .map(|(i, at)| (format!("threats[{i}]"), at.lat, at.lon));
        let zones = raw.no_fly.iter().enumerate().flat_map(|(i, zone)| {
            let corners = zone.polygon.iter().enumerate();
            corners
                .map(move |(j, corner)| (format!("no_fly[{i}].polygon[{j}]"), corner[0], corner[1]))
        });
        for (path, lat_deg, lon_deg) in threats.chain(zones) {
            let Ok(place) = LatLon::new(lat_deg, lon_deg) else {
                continue;
            };
            let away_m = place.chord_m(origin);
            if away_m > MAX_AWAY_M {
                let allowed = format!("at most {:.0} km; latitude comes first", MAX_AWAY_M / 1e3);
                self.report(
                    &path,
                    format!("{:.0} km from the origin", away_m / 1e3),
                    allowed,
                );
            }
        }
        Some(())
    }

    fn terrain(&mut self, raw: &raw::Terrain) -> Option<TerrainSource> {
        match (&raw.file, &raw.flat, &raw.analytic) {
            (Some(file), None, None) => self.terrain_file(file).map(TerrainSource::File),
            (None, Some(flat), None) => {
                let amsl = self.number("terrain.flat.amsl_m", flat.amsl_m, -500.0..=20_000.0);
                Some(TerrainSource::Flat(Amsl(amsl)))
            }
            (None, None, Some(analytic)) => {
                let path = "terrain.analytic";
                let base = self.number(
                    &format!("{path}.base_amsl_m"),
                    analytic.base_amsl_m,
                    -500.0..=9000.0,
                );
                let mut hills = Vec::new();
                for (index, hill) in analytic.hills.iter().enumerate() {
                    let path = format!("{path}.hills[{index}]");
                    let height_m =
                        self.number(&format!("{path}.height_m"), hill.height_m, -9000.0..=9000.0);
                    let radius_m =
                        self.number(&format!("{path}.radius_m"), hill.radius_m, RADIUS_M);
                    let place = self.place(&path, hill.lat, hill.lon);
                    hills.extend(place.map(|place| Hill {
                        place,
                        height_m,
                        radius_m,
                    }));
                }
                Some(TerrainSource::Analytic {
                    base: Amsl(base),
                    hills,
                })
            }
            _ => {
                self.report(
                    "terrain",
                    "none or several of file, flat and analytic",
                    "exactly one",
                );
                None
            }
        }
    }

    /// A path that stays beside the spec wherever both are copied.
    fn terrain_file(&mut self, file: &str) -> Option<PathBuf> {
        let path = Path::new(file);
        let inside = path
            .components()
            .all(|part| matches!(part, Component::Normal(_)));
        if file.is_empty()
            || !inside
            || file.contains(['\\', ':'])
            || file.chars().any(char::is_control)
        {
            let allowed = "a path relative to the spec, with /, without .. and drive letters";
            self.report(
                "terrain.file",
                format!("`{}`", file.escape_debug()),
                allowed,
            );
            return None;
        }
        let extension = path
            .extension()
            .and_then(|ending| ending.to_str())
            .unwrap_or("");
        if !["hgt", "tif", "tiff"].contains(&extension.to_ascii_lowercase().as_str()) {
            self.report(
                "terrain.file",
                format!("`{file}`"),
                "a file named .hgt, .tif or .tiff",
            );
            return None;
        }
        Some(path.to_owned())
    }

    fn threat(&mut self, path: &str, raw: &raw::Threat) -> Option<Threat> {
        self.label(&format!("{path}.id"), &raw.id);
        let radius_m = self.number(&format!("{path}.radius_m"), raw.radius_m, RADIUS_M);
        let place = self.place(path, raw.lat, raw.lon)?;
        let kind = raw.kind.clone().unwrap_or_else(|| "threat".to_owned());
        self.label(&format!("{path}.kind"), &kind);
        // A radius that is wrong already must not swallow every start and goal as well.
        RADIUS_M.contains(&radius_m).then(|| Threat {
            id: raw.id.clone(),
            kind,
            place,
            radius_m,
        })
    }

    /// The corners of a zone, without a last one that only repeats the first.
    fn corners(&mut self, path: &str, raw: &raw::Zone) -> Option<Vec<LatLon>> {
        self.label(&format!("{path}.id"), &raw.id);
        self.optional(
            &format!("{path}.below_amsl_m"),
            raw.below_amsl_m,
            -500.0..=20_000.0,
        );
        let path = format!("{path}.polygon");
        let mut corners = Vec::new();
        for (index, [lat_deg, lon_deg]) in raw.polygon.iter().enumerate() {
            let path = format!("{path}[{index}]");
            self.number(&format!("{path}[0]"), *lat_deg, -90.0..=90.0);
            self.number(&format!("{path}[1]"), *lon_deg, -180.0..=180.0);
            corners.push(LatLon::new(*lat_deg, *lon_deg).ok());
        }
        let mut corners = corners.into_iter().collect::<Option<Vec<LatLon>>>()?;
        if corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        if !(3..=MAX_CORNERS).contains(&corners.len()) {
            self.report(
                &path,
                format!("{} corners", corners.len()),
                format!("3 to {MAX_CORNERS}"),
            );
            return None;
        }
        Some(corners)
    }

    /// Whether the edges of a polygon meet only where neighbours should.
    fn polygon(&mut self, path: &str, frame: &LocalFrame, corners: &[LatLon]) -> bool {
        let outline = frame.outline(corners);
        if outline.unsigned_area() < MIN_ZONE_M2 {
            self.report(
                path,
                "a polygon without area",
                "corners that are not on a line",
            );
            return false;
        }
        let edges: Vec<Line<f64>> = outline.exterior().lines().collect();
        for (first, edge) in edges.iter().enumerate() {
            if edge.start == edge.end {
                let found = "this corner twice in a row";
                self.report(&format!("{path}[{first}]"), found, "corners that differ");
                return false;
            }
            for (second, other) in edges.iter().enumerate().skip(first + 1) {
                let neighbours = second == first + 1 || (first == 0 && second + 1 == edges.len());
                let crossed = match line_intersection(*edge, *other) {
                    None => false,
                    Some(LineIntersection::Collinear { .. }) => true,
                    Some(LineIntersection::SinglePoint { .. }) => !neighbours,
                };
                if crossed {
                    let end = |edge: usize| (edge + 1) % edges.len();
                    let found = format!(
                        "the edge from corner {second} to {} meets the edge from corner {first} to {}",
                        end(second),
                        end(first)
                    );
                    self.report(
                        &format!("{path}[{second}]"),
                        found,
                        "a polygon that does not cross itself",
                    );
                    return false;
                }
            }
        }
        true
    }

    /// Reports a place outside of the area, in a threat, or in a zone closed at every height.
    pub(super) fn clear(&mut self, path: &str, what: &str, place: LatLon, map: &Map) {
        let plan = map.frame.to_plan(place);
        let point = Point::new(plan.east_m, plan.north_m);
        let away_m = place.chord_m(map.frame.origin());
        if away_m > MAX_AWAY_M || !map.outline.contains(&point) {
            let (south_west, north_east) = (map.area.south_west, map.area.north_east);
            let allowed = format!(
                "latitude {} to {}, longitude {} to {}",
                south_west.lat_deg, north_east.lat_deg, south_west.lon_deg, north_east.lon_deg
            );
            let found = format!(
                "{what} at {}, {} is outside of the area",
                place.lat_deg, place.lon_deg
            );
            self.report(path, found, allowed);
            return;
        }
        for threat in &map.threats {
            let distance_m = plan.distance_m(map.frame.to_plan(threat.place));
            if distance_m <= threat.radius_m {
                let found = format!(
                    "{what} is inside threat `{}`, {distance_m:.0} m from its axis",
                    threat.id
                );
                self.report(path, found, format!("more than {} m", threat.radius_m));
            }
        }
        for zone in map.no_fly.iter().filter(|zone| zone.below.is_none()) {
            if map.frame.outline(&zone.polygon).intersects(&point) {
                self.report(
                    path,
                    format!("{what} is inside no-fly zone `{}`", zone.id),
                    "outside",
                );
            }
        }
    }
}

fn middle(area: &Area) -> LatLon {
    LatLon {
        lat_deg: f64::midpoint(area.south_west.lat_deg, area.north_east.lat_deg),
        lon_deg: f64::midpoint(area.south_west.lon_deg, area.north_east.lon_deg),
    }
}

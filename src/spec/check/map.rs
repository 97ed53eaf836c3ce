//! What lies on the map, and where nothing may stand.

use geo::{Contains, Intersects, Point, Polygon};

use super::super::airspace::{
    AirspaceImport, AttachedFile, dome_layers, zone_buffer_key, zone_buffer_m,
};
use super::super::keys;
use super::super::{
    AltitudeLimits, Area, BufferedLimit, Buffers, KnownPlace, PlaceKind, Placement, Rally,
    TerrainSource, Threat, Zone,
};
use super::Checker;
use crate::geodesy::{Agl, Amsl, EastNorth, LatLon, LocalFrame};
use crate::numeric::digits;
use crate::numeric::geometry::Ring;

/// Furthest corner of the area from the origin: the local frame is proven to here.
const MAX_AREA_M: f64 = 300_000.0;
/// Furthest anything else may be from the origin: beyond it, a number is mistyped.
const MAX_AWAY_M: f64 = 1_000_000.0;

/// The checked map. Threats, zones and rally points that are broken are left out;
/// then there is an issue and no spec.
pub(super) struct Map {
    pub(super) frame: LocalFrame,
    pub(super) area: Area,
    pub(super) buffers: Buffers,
    pub(super) outline: Polygon<f64>,
    pub(super) terrain: Option<TerrainSource>,
    pub(super) threats: Vec<Threat>,
    pub(super) no_fly: Vec<Zone>,
    pub(super) rally: Vec<Rally>,
    /// What became of the shapes of each file.
    pub(super) imports: Vec<AirspaceImport>,
}

impl Checker {
    /// Checks everything that does not move; `None` without a usable area.
    pub(super) fn map(
        &mut self,
        keys: &keys::Spec,
        buffers: Buffers,
        attached: &[AttachedFile],
    ) -> Option<Map> {
        let terrain = self.terrain(&keys.terrain);
        let origin = keys.origin.map(|at| self.place("origin", at));
        let area = self.area(&keys.area);
        self.unique(
            "no_fly",
            (keys.no_fly.iter()).map(|zone| Some(zone.id.as_str())),
        );
        self.unique_zones(keys);
        let references = self.references(keys);
        let (threats, domes) = self.threats(keys, &buffers);
        let zones = keys.no_fly.iter().enumerate();
        let corners: Vec<Option<Vec<LatLon>>> = zones
            .map(|(index, zone)| self.corners(&format!("no_fly[{index}]"), zone))
            .collect();
        let area = area?;
        self.altitude_layer("area", area.altitudes, &area, &buffers);
        let frame = LocalFrame::new(origin.unwrap_or_else(|| Some(middle(&area)))?);
        self.near(keys, &area, frame.origin())?;
        self.origin = Some(frame.origin());
        let mut no_fly = self.zones(keys, &frame, corners);
        no_fly.extend(self.shaped_zones(keys, &frame, (&area, references)));
        no_fly.extend(domes);
        let outline = frame.outline(&area.outline());
        let mut map = Map {
            frame,
            area,
            buffers,
            outline,
            terrain,
            threats,
            no_fly,
            rally: Vec::new(),
            imports: Vec::new(),
        };
        self.add_files(keys, attached, references, &mut map);
        for (index, point) in keys.rally.iter().enumerate() {
            let Ok(place) = LatLon::new(point.lat, point.lon) else {
                continue;
            };
            self.rally_height(&format!("rally[{index}].agl_m"), point.agl_m, &map);
            self.clear(&format!("rally[{index}]"), "the rally point", place, &map);
            let agl = Agl(point.agl_m);
            self.sites.push(KnownPlace {
                path: format!("rally[{index}]"),
                kind: PlaceKind::Rally(place, point.agl_m),
            });
            map.rally.push(Rally { place, agl });
        }
        Some(map)
    }

    /// The threats that are cylinders, and the zones of those that are domes.
    fn threats(&mut self, keys: &keys::Spec, buffers: &Buffers) -> (Vec<Threat>, Vec<Zone>) {
        self.unique(
            "threats",
            keys.threats.iter().map(|threat| Some(threat.id.as_str())),
        );
        let (mut cylinders, mut domes) = (Vec::new(), Vec::new());
        for (index, of) in keys.threats.iter().enumerate() {
            let threat = self.threat(&format!("threats[{index}]"), of);
            match of.shape {
                Some(keys::ThreatShape::Dome) => {
                    domes.extend(threat.iter().flat_map(|of| dome_layers(of, buffers)));
                }
                Some(keys::ThreatShape::Cylinder) | None => cylinders.extend(threat),
            }
        }
        (cylinders, domes)
    }

    /// A rally point keeps the least height over ground and its buffer.
    fn rally_height(&mut self, path: &str, agl_m: f64, map: &Map) {
        let Agl(min_m) = map.area.min_agl;
        let of = ("terrain", "area.min_agl_m");
        let limit = BufferedLimit::beyond(of, min_m, map.buffers.terrain_m);
        if (0.0..min_m).contains(&agl_m) {
            let allowed = format!("at least area.min_agl_m, {min_m}");
            self.report(path, digits::plain(agl_m), allowed);
        } else if (0.0..limit.buffered_m).contains(&agl_m) {
            self.report(path, digits::plain(agl_m), limit.allowed(agl_m));
        }
        let Some(Agl(max_m)) = map.area.altitudes.max_agl else {
            return;
        };
        let limit = BufferedLimit {
            key: "ceiling",
            of: "area.max_agl_m",
            limit_m: max_m,
            buffered_m: max_m - map.buffers.ceiling_m,
        };
        if agl_m > max_m {
            let allowed = format!("at most area.max_agl_m, {max_m}");
            self.report(path, digits::plain(agl_m), allowed);
        } else if agl_m > limit.buffered_m {
            self.report(path, digits::plain(agl_m), limit.allowed(agl_m));
        }
    }

    /// The zones whose corners are good and whose edges do not cross.
    fn zones(
        &mut self,
        keys: &keys::Spec,
        frame: &LocalFrame,
        corners: Vec<Option<Vec<LatLon>>>,
    ) -> Vec<Zone> {
        let mut zones = Vec::new();
        for (index, (zone, corners)) in keys.no_fly.iter().zip(corners).enumerate() {
            let path = format!("no_fly[{index}].polygon");
            let Some(polygon) = corners else { continue };
            if are_near(&polygon, frame.origin()) && self.polygon(&path, frame, &polygon) {
                let ceiling = zone
                    .below_amsl_m
                    .map(|amsl_m| Placement::Amsl(Amsl(amsl_m)));
                zones.push(Zone {
                    ceiling,
                    ..Zone::closed(zone.id.clone(), polygon)
                });
            }
        }
        zones
    }

    fn area(&mut self, keys: &keys::Area) -> Option<Area> {
        let south_west = self.place("area.south_west", keys.south_west);
        let north_east = self.place("area.north_east", keys.north_east);
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
            min_agl: Agl(keys.min_agl_m),
            max_amsl: Amsl(keys.max_amsl_m),
            altitudes: AltitudeLimits {
                max_agl: keys.max_agl_m.map(Agl),
                min_amsl: keys.min_amsl_m.map(Amsl),
            },
        })
    }

    /// Everything is near the origin; `None` if the area is not.
    fn near(&mut self, keys: &keys::Spec, area: &Area, origin: LatLon) -> Option<()> {
        let furthest_m = area
            .outline()
            .into_iter()
            .map(|corner| corner.chord_m(origin))
            .fold(0.0, f64::max);
        if furthest_m > MAX_AREA_M {
            let path = if keys.origin.is_some() {
                "origin"
            } else {
                "area"
            };
            let found = format!(
                "a corner of the area {} km from the origin",
                digits::distinct_from(furthest_m / 1e3, MAX_AREA_M / 1e3, 0)
            );
            self.report(path, found, format!("at most {:.0} km", MAX_AREA_M / 1e3));
            return None;
        }
        let threats = keys
            .threats
            .iter()
            .enumerate()
            .map(|(i, at)| (format!("threats[{i}]"), at.lat, at.lon));
        let zones = keys.no_fly.iter().enumerate().flat_map(|(i, zone)| {
            let corners = zone.polygon.iter().enumerate();
            corners
                .map(move |(j, corner)| (format!("no_fly[{i}].polygon[{j}]"), corner[0], corner[1]))
        });
        let shaped = keys.zones.iter().enumerate().flat_map(|(i, zone)| {
            let center = zone
                .circle
                .map(|at| (format!("zones[{i}].circle"), at.lat, at.lon));
            let corners = zone.polygon.iter().flatten().enumerate();
            let corners =
                corners.map(move |(j, at)| (format!("zones[{i}].polygon[{j}]"), at[0], at[1]));
            let holes = zone.holes.iter().enumerate().flat_map(move |(j, hole)| {
                let corners = hole.iter().enumerate();
                corners.map(move |(k, at)| (format!("zones[{i}].holes[{j}][{k}]"), at[0], at[1]))
            });
            center.into_iter().chain(corners).chain(holes)
        });
        for (path, lat_deg, lon_deg) in threats.chain(zones).chain(shaped) {
            if let Ok(place) = LatLon::new(lat_deg, lon_deg) {
                self.is_near(&path, place, origin);
            }
        }
        Some(())
    }

    /// Whether a place is within reach of the origin; reported if not.
    pub(super) fn is_near(&mut self, path: &str, place: LatLon, origin: LatLon) -> bool {
        let away_m = place.chord_m(origin);
        if away_m <= MAX_AWAY_M {
            return true;
        }
        let away_km = digits::distinct_from(away_m / 1e3, MAX_AWAY_M / 1e3, 0);
        let found = format!(
            "{}, {} is {away_km} km from the origin",
            place.lat_deg, place.lon_deg
        );
        let is_near = |place: LatLon| place.chord_m(origin) <= MAX_AWAY_M;
        let hint = match with_axes_swapped(place).is_some_and(is_near) {
            true => ": are latitude and longitude exchanged?",
            false => "",
        };
        let max_km = MAX_AWAY_M / 1e3;
        let allowed = format!("at most {max_km:.0} km; latitude comes first{hint}");
        self.report(path, found, allowed);
        false
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
            let (across, along) = (
                south_west.lon_deg..=north_east.lon_deg,
                south_west.lat_deg..=north_east.lat_deg,
            );
            // The range alone does not explain a number that lies in it.
            let on_edge = across.contains(&place.lon_deg) && along.contains(&place.lat_deg);
            let (is, allowed) = if on_edge {
                (
                    "is on the edge of the area",
                    format!("{allowed}, without the edges"),
                )
            } else if with_axes_swapped(place).is_some_and(|place| {
                across.contains(&place.lon_deg) && along.contains(&place.lat_deg)
            }) {
                let allowed = format!("{allowed}: are latitude and longitude exchanged?");
                ("is outside of the area", allowed)
            } else {
                ("is outside of the area", allowed)
            };
            let found = format!("{what} at {}, {} {is}", place.lat_deg, place.lon_deg);
            self.report(path, found, allowed);
            return;
        }
        let of = Of { path, what, plan };
        let edge_m = Ring::around(&map.outline).boundary_distance([plan.east_m, plan.north_m]);
        let from = "inside of the edge of the area";
        let buffer_m = map.buffers.area_m;
        let limit = BufferedLimit::beyond(("area", "the edge"), 0.0, buffer_m);
        self.buffered(&of, (edge_m, from), &limit);
        for threat in &map.threats {
            self.clear_of_threat(&of, threat, map);
        }
        for zone in map.no_fly.iter().filter(|zone| zone.is_closed_throughout()) {
            self.clear_of_zone(&of, zone, map);
        }
    }

    fn clear_of_threat(&mut self, of: &Of<'_>, threat: &Threat, map: &Map) {
        let distance_m = of.plan.distance_m(map.frame.to_plan(threat.place));
        if distance_m <= threat.radius_m {
            let away_m = digits::distinct_from(distance_m, threat.radius_m, 0);
            let found = format!(
                "{} is inside threat `{}`, {away_m} m from its axis",
                of.what, threat.id
            );
            self.report(of.path, found, format!("more than {} m", threat.radius_m));
            return;
        }
        let from = format!("from the axis of threat `{}`", threat.id);
        let buffer_m = map.buffers.threats_m;
        let limit = BufferedLimit::beyond(("threats", "its radius"), threat.radius_m, buffer_m);
        self.buffered(of, (distance_m, &from), &limit);
    }

    fn clear_of_zone(&mut self, of: &Of<'_>, zone: &Zone, map: &Map) {
        let outline = map.frame.outline(&zone.outline());
        if outline.intersects(&Point::new(of.plan.east_m, of.plan.north_m)) {
            let found = format!("{} is inside no-fly zone `{}`", of.what, zone.id);
            self.report(of.path, found, "outside");
            return;
        }
        let at = [of.plan.east_m, of.plan.north_m];
        let away_m = Ring::around(&outline).boundary_distance(at);
        let from = format!("from no-fly zone `{}`", zone.id);
        let buffer_m = zone_buffer_m(&map.buffers, zone);
        let key = zone_buffer_key(zone);
        let limit = BufferedLimit::beyond((key, "its outline"), 0.0, buffer_m);
        self.buffered(of, (away_m, &from), &limit);
    }

    /// Reports a point that satisfies a limit and not its buffer, with its distance from what.
    fn buffered(&mut self, of: &Of<'_>, (value_m, from): (f64, &str), limit: &BufferedLimit<'_>) {
        if value_m < limit.buffered_m {
            let value = digits::distinct_from(value_m, limit.buffered_m, 1);
            let found = format!("{} is {value} m {from}", of.what);
            self.report(of.path, found, limit.allowed(value_m));
        }
    }
}

/// A place that must be clear: its path, what stands there, and its planning coordinates.
struct Of<'a> {
    path: &'a str,
    what: &'a str,
    plan: EastNorth,
}

/// A place with its latitude as longitude and the other way round.
pub(super) fn with_axes_swapped(place: LatLon) -> Option<LatLon> {
    LatLon::new(place.lon_deg, place.lat_deg).ok()
}

/// Whether all corners are so near to the origin that their polygon means something; those that are
/// not are reported one by one.
pub(super) fn are_near(corners: &[LatLon], origin: LatLon) -> bool {
    let mut corners = corners.iter();
    corners.all(|corner| corner.chord_m(origin) <= MAX_AWAY_M)
}

fn middle(area: &Area) -> LatLon {
    LatLon {
        lat_deg: f64::midpoint(area.south_west.lat_deg, area.north_east.lat_deg),
        lon_deg: f64::midpoint(area.south_west.lon_deg, area.north_east.lon_deg),
    }
}

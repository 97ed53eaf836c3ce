//! What lies on the map, and where nothing may stand.

use geo::{Contains, Intersects, Point, Polygon};

use super::super::keys;
use super::super::{Area, Placement, Rally, TerrainSource, Threat, Zone};
use super::Checker;
use crate::geodesy::{Agl, Amsl, LatLon, LocalFrame};
use crate::numeric::digits;

/// Furthest corner of the area from the origin: the local frame is proven to here.
const MAX_AREA_M: f64 = 300_000.0;
/// Furthest anything else may be from the origin: beyond it, a number is mistyped.
const MAX_AWAY_M: f64 = 1_000_000.0;

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

impl Checker {
    /// Checks everything that does not move; `None` without a usable area.
    pub(super) fn map(&mut self, keys: &keys::Spec) -> Option<Map> {
        let terrain = self.terrain(&keys.terrain);
        let origin = keys.origin.map(|at| self.place("origin", at));
        let area = self.area(&keys.area);
        self.unique(
            "threats",
            keys.threats.iter().map(|threat| Some(threat.id.as_str())),
        );
        self.unique(
            "no_fly",
            (keys.no_fly.iter()).map(|zone| Some(zone.id.as_str())),
        );
        self.unique_zones(keys);
        let references = self.references(keys);
        let threats = keys.threats.iter().enumerate();
        let threats: Vec<Threat> = threats
            .filter_map(|(index, threat)| self.threat(&format!("threats[{index}]"), threat))
            .collect();
        let zones = keys.no_fly.iter().enumerate();
        let corners: Vec<Option<Vec<LatLon>>> = zones
            .map(|(index, zone)| self.corners(&format!("no_fly[{index}]"), zone))
            .collect();
        let area = area?;
        let frame = LocalFrame::new(origin.unwrap_or_else(|| Some(middle(&area)))?);
        self.near(keys, &area, frame.origin())?;
        let mut no_fly = self.zones(keys, &frame, corners);
        for of in keys.zones.iter().enumerate() {
            no_fly.extend(self.shaped_zone(of, &frame, references));
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
        for (index, point) in keys.rally.iter().enumerate() {
            let Ok(place) = LatLon::new(point.lat, point.lon) else {
                continue;
            };
            let Agl(least_m) = map.area.min_agl;
            if (0.0..least_m).contains(&point.agl_m) {
                let allowed = format!("at least area.min_agl_m, {least_m}");
                let found = digits::plain(point.agl_m);
                self.report(&format!("rally[{index}].agl_m"), found, allowed);
            }
            self.clear(&format!("rally[{index}]"), "the rally point", place, &map);
            let agl = Agl(point.agl_m);
            map.rally.push(Rally { place, agl });
        }
        Some(map)
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
            if self.polygon(&path, frame, &polygon) {
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
            center.into_iter().chain(corners)
        });
        for (path, lat_deg, lon_deg) in threats.chain(zones).chain(shaped) {
            let Ok(place) = LatLon::new(lat_deg, lon_deg) else {
                continue;
            };
            let away_m = place.chord_m(origin);
            if away_m > MAX_AWAY_M {
                let allowed = format!("at most {:.0} km; latitude comes first", MAX_AWAY_M / 1e3);
                let away_km = digits::distinct_from(away_m / 1e3, MAX_AWAY_M / 1e3, 0);
                self.report(&path, format!("{away_km} km from the origin"), allowed);
            }
        }
        Some(())
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
            } else {
                ("is outside of the area", allowed)
            };
            let found = format!("{what} at {}, {} {is}", place.lat_deg, place.lon_deg);
            self.report(path, found, allowed);
            return;
        }
        for threat in &map.threats {
            let distance_m = plan.distance_m(map.frame.to_plan(threat.place));
            if distance_m <= threat.radius_m {
                let away_m = digits::distinct_from(distance_m, threat.radius_m, 0);
                let found = format!(
                    "{what} is inside threat `{}`, {away_m} m from its axis",
                    threat.id
                );
                self.report(path, found, format!("more than {} m", threat.radius_m));
            }
        }
        for zone in map.no_fly.iter().filter(|zone| zone.is_closed_throughout()) {
            if map.frame.outline(&zone.outline()).intersects(&point) {
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

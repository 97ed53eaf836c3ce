//! Surveys, corridors and search patterns: shapes, sensors, heights.

use geo::{Area as _, Contains, Intersects, Point, Polygon};

use super::super::Checker;
use crate::geodesy::{Agl, EastNorth, LatLon};
use crate::numeric::digits;
use crate::spec::check::map::{Map, are_near};
use crate::spec::keys::{self, Pattern};
use crate::spec::{SearchPattern, Sensor, Sweep, SweepShape};

/// Overlaps where none is given.
const FRONT_OVERLAP: f64 = 0.7;
const SIDE_OVERLAP: f64 = 0.6;
/// Least distance of neighbouring lines, metres.
const MIN_SPACING_M: f64 = 2.0;
/// Most length of all lines of one task, metres.
const MAX_LINES_M: f64 = 1_000_000.0;
/// Most corners of a corridor.
const MAX_CORNERS: usize = 100;
/// Corners of a corridor are at least this far apart, metres.
const MIN_LEG_M: f64 = 10.0;

/// What surveys and corridors say of their sensor and lines.
struct Looking {
    camera: Option<keys::Camera>,
    swath_m: Option<f64>,
    front_overlap: Option<f64>,
    side_overlap: Option<f64>,
    agl_m: Option<f64>,
}

impl Checker {
    pub(super) fn survey(
        &mut self,
        path: &str,
        keys: &keys::SurveyArea,
        map: Option<&Map>,
    ) -> Option<Sweep> {
        let at = |key: &str| format!("{path}.{key}");
        let agl = self.height_of_lines(path, keys.agl_m, map);
        let looking = Looking {
            camera: keys.camera,
            swath_m: keys.swath_m,
            front_overlap: keys.front_overlap,
            side_overlap: keys.side_overlap,
            agl_m: keys.agl_m,
        };
        let sensor = self.sensor(path, &looking);
        if matches!(sensor, Some(None)) {
            self.report(path, "neither camera nor swath_m", "one of them");
        }
        let corners = self.required(path, "polygon", keys.polygon.as_ref());
        let polygon = corners.and_then(|corners| self.outline(&at("polygon"), corners, map));
        let holes = keys.holes.iter().enumerate().map(|(index, corners)| {
            let path = at(&format!("holes[{index}]"));
            let hole = self.outline(&path, corners, None)?;
            self.is_hole(&path, (&hole, polygon.as_deref()), map);
            Some(hole)
        });
        let holes = holes.collect::<Option<Vec<_>>>();
        let (polygon, holes, sensor, agl) = (polygon?, holes?, sensor?, agl?);
        if let (Some(map), Some(sensor)) = (map, sensor) {
            self.area_clear(&at("polygon"), (&polygon, &holes), map);
            let area_m2 = map.frame.outline(&polygon).unsigned_area();
            self.length_of_lines(path, area_m2, (sensor, agl));
        }
        Some(Sweep {
            shape: SweepShape::Survey {
                polygon,
                holes,
                heading_rad: keys.heading_deg.map(f64::to_radians),
            },
            sensor,
            agl,
            speed_mps: keys.speed_mps,
        })
    }

    pub(super) fn corridor(
        &mut self,
        path: &str,
        keys: &keys::Corridor,
        map: Option<&Map>,
    ) -> Option<Sweep> {
        let at = |key: &str| format!("{path}.{key}");
        let agl = self.height_of_lines(path, keys.agl_m, map);
        let looking = Looking {
            camera: keys.camera,
            swath_m: keys.swath_m,
            front_overlap: keys.front_overlap,
            side_overlap: keys.side_overlap,
            agl_m: keys.agl_m,
        };
        let sensor = self.sensor(path, &looking);
        let width_m = self.required(path, "width_m", keys.width_m);
        let corners = self.required(path, "line", keys.line.as_ref());
        let line = corners.and_then(|corners| {
            if !(2..=MAX_CORNERS).contains(&corners.len()) {
                let found = format!("{} corners", corners.len());
                self.report(&at("line"), found, format!("2 to {MAX_CORNERS}"));
                return None;
            }
            let corners = corners.iter().enumerate().map(|(index, [lat, lon])| {
                let place = keys::Place {
                    lat: Some(*lat),
                    lon: Some(*lon),
                };
                let path = at(&format!("line[{index}]"));
                match self.place(&path, place) {
                    Some(place) => {
                        if let Some(map) = map {
                            self.clear(&path, "corner", place, map);
                        }
                        Some(place)
                    }
                    None => {
                        let found = format!("{}, {}", digits::plain(*lat), digits::plain(*lon));
                        self.report(&path, found, "latitude -90 to 90, longitude -180 to 180");
                        None
                    }
                }
            });
            corners.collect::<Option<Vec<LatLon>>>()
        });
        let (line, width_m, sensor, agl) = (line?, width_m?, sensor?, agl?);
        self.legs_apart(&at("line"), &line);
        let length_m: f64 = line.windows(2).map(|pair| pair[0].chord_m(pair[1])).sum();
        if let Some(sensor) = sensor {
            self.length_of_lines(path, length_m * width_m, (sensor, agl));
        }
        Some(Sweep {
            shape: SweepShape::Corridor { line, width_m },
            sensor,
            agl,
            speed_mps: keys.speed_mps,
        })
    }

    pub(super) fn search(
        &mut self,
        path: &str,
        keys: &keys::SearchArea,
        map: Option<&Map>,
    ) -> Option<Sweep> {
        let at = |key: &str| format!("{path}.{key}");
        let pattern = self.required(path, "pattern", keys.pattern);
        let leg_m = self.required(path, "leg_m", keys.leg_m);
        let legs = self.required(path, "legs", keys.legs);
        let begin = self.required(path, "at", keys.at)?;
        let place = self.place(&at("at"), begin.place());
        let agl = self.height_of_lines(&at("at"), begin.agl_m, map);
        let (pattern, leg_m, place) = (pattern?, leg_m?, place?);
        let legs = u32::try_from(legs?).ok()?;
        if pattern == Pattern::Sector && legs % 3 != 0 {
            self.report(&at("legs"), legs, "a multiple of 3 for pattern sector");
        }
        match (pattern, keys.spacing_m) {
            (Pattern::ParallelTrack, None) => {
                self.required(path, "spacing_m", keys.spacing_m);
            }
            (Pattern::ExpandingSquare | Pattern::Sector, Some(_)) => {
                let allowed = "spacing_m with pattern parallel_track alone";
                self.report(&at("spacing_m"), "a distance of tracks", allowed);
            }
            _ => {}
        }
        let search = SearchPattern {
            pattern,
            at: place,
            heading_rad: keys.heading_deg.unwrap_or(0.0).to_radians(),
            leg_m,
            legs,
            spacing_m: keys.spacing_m.unwrap_or(leg_m),
        };
        if let Some(map) = map {
            self.pattern_clear(path, &search, map);
        }
        Some(Sweep {
            shape: SweepShape::Search(search),
            sensor: None,
            agl: agl?,
            speed_mps: keys.speed_mps,
        })
    }

    /// Lines are not below the least height above ground, nor above the greatest, buffers included.
    fn height_of_lines(
        &mut self,
        path: &str,
        agl_m: Option<f64>,
        map: Option<&Map>,
    ) -> Option<Agl> {
        let agl_m = self.required(path, "agl_m", agl_m)?;
        let at = format!("{path}.agl_m");
        if let Some(map) = map {
            let min_m = map.area.min_agl.0 + map.buffers.terrain_m;
            if agl_m < min_m {
                let allowed = format!(
                    "at least {} m: area.min_agl_m and buffer_m.terrain",
                    digits::plain(min_m)
                );
                self.report(&at, digits::plain(agl_m), allowed);
            }
            let most = map.area.altitudes.max_agl;
            let max_m = most.map_or(f64::INFINITY, |most| most.0 - map.buffers.ceiling_m);
            if agl_m > max_m {
                let allowed = format!(
                    "at most {} m: area.max_agl_m less buffer_m.ceiling",
                    digits::plain(max_m)
                );
                self.report(&at, digits::plain(agl_m), allowed);
            }
        }
        Some(Agl(agl_m))
    }

    /// Camera or swath with overlaps; `Some(None)` where there is neither.
    #[expect(clippy::option_option, reason = "absent is good, wrong is not")]
    fn sensor(&mut self, path: &str, keys: &Looking) -> Option<Option<Sensor>> {
        let at = |key: &str| format!("{path}.{key}");
        let overlaps = [
            ("front_overlap", keys.front_overlap),
            ("side_overlap", keys.side_overlap),
        ];
        let mut is_good = true;
        for (key, overlap) in overlaps {
            // Its range is checked by the schema; a number above 1 looks like percent.
            is_good &= overlap.is_none_or(|overlap| (0.0..=0.95).contains(&overlap));
            if let (Some(_), None, None) = (overlap, keys.camera, keys.swath_m) {
                let allowed = "overlaps beside camera or swath_m";
                self.report(&at(key), "an overlap of nothing", allowed);
                is_good = false;
            }
        }
        let sensor = match (keys.camera, keys.swath_m) {
            (Some(_), Some(_)) => {
                self.report(path, "camera and swath_m", "one of them");
                return None;
            }
            (Some(camera), None) => {
                let path = at("camera");
                let fov_deg = self.required(&path, "fov_deg", camera.fov_deg)?;
                for (index, deg) in fov_deg.iter().enumerate() {
                    if !(1.0..=170.0).contains(deg) {
                        let path = format!("{path}.fov_deg[{index}]");
                        let found =
                            format!("{}, which sees no ground of a size", digits::plain(*deg));
                        self.report(&path, found, "1 to 170 degrees");
                        is_good = false;
                    }
                }
                let [across, along] = fov_deg.map(|deg| (deg / 2.0).to_radians().tan());
                Some(Sensor {
                    across,
                    along: Some((along, keys.front_overlap.unwrap_or(FRONT_OVERLAP))),
                    side_overlap: keys.side_overlap.unwrap_or(SIDE_OVERLAP),
                })
            }
            (None, Some(swath_m)) => {
                if keys.front_overlap.is_some() {
                    let allowed = "front_overlap with a camera alone";
                    self.report(&at("front_overlap"), "an overlap of pictures", allowed);
                    return None;
                }
                Some(Sensor {
                    across: swath_m / 2.0 / keys.agl_m.filter(|&agl_m| agl_m > 0.0)?,
                    along: None,
                    side_overlap: keys.side_overlap.unwrap_or(0.0),
                })
            }
            (None, None) => None,
        };
        is_good.then_some(sensor)
    }

    /// The corners of a polygon that does not cross itself, each clear.
    fn outline(
        &mut self,
        path: &str,
        corners: &[[f64; 2]],
        map: Option<&Map>,
    ) -> Option<Vec<LatLon>> {
        let corners = self.ring_corners(path, corners)?;
        if let Some(map) = map {
            for (index, corner) in corners.iter().enumerate() {
                self.clear(&format!("{path}[{index}]"), "corner", *corner, map);
            }
            let is_good =
                are_near(&corners, map.frame.origin()) && self.polygon(path, &map.frame, &corners);
            return is_good.then_some(corners);
        }
        Some(corners)
    }

    fn is_hole(
        &mut self,
        path: &str,
        (hole, polygon): (&[LatLon], Option<&[LatLon]>),
        map: Option<&Map>,
    ) {
        let (Some(polygon), Some(map)) = (polygon, map) else {
            return;
        };
        let origin = map.frame.origin();
        for (index, corner) in hole.iter().enumerate() {
            if !self.is_near(&format!("{path}[{index}]"), *corner, origin) {
                return;
            }
        }
        let is_simple = self.polygon(path, &map.frame, hole);
        let (outer, inner) = (map.frame.outline(polygon), map.frame.outline(hole));
        if is_simple && !outer.contains(inner.exterior()) {
            let found = "a hole that is not inside the polygon";
            self.report(path, found, "holes inside of the polygon");
        }
    }

    /// What is closed at all heights lies in a hole or outside.
    fn area_clear(&mut self, path: &str, (polygon, holes): (&[LatLon], &[Vec<LatLon>]), map: &Map) {
        let ring = |corners: &[LatLon]| map.frame.outline(corners).exterior().clone();
        let holes = holes.iter().map(|hole| ring(hole)).collect();
        let area = Polygon::new(ring(polygon), holes);
        for threat in &map.threats {
            let at = map.frame.to_plan(threat.place);
            if area.contains(&Point::new(at.east_m, at.north_m)) {
                let found = format!("threat `{}` inside of the area to cover", threat.id);
                self.report(path, found, "a hole around it, or another polygon");
            }
        }
        for zone in map.no_fly.iter().filter(|zone| zone.is_closed_throughout()) {
            if area.intersects(&map.frame.outline(&zone.outline())) {
                let found = format!("no-fly zone `{}` meets the area to cover", zone.id);
                self.report(path, found, "a hole around it, or another polygon");
            }
        }
    }

    /// Lines of a footprint that is no smaller than the area needs.
    fn length_of_lines(&mut self, path: &str, area_m2: f64, (sensor, agl): (Sensor, Agl)) {
        let spacing_m = sensor.swath_m(agl.0) * (1.0 - sensor.side_overlap);
        if spacing_m < MIN_SPACING_M {
            let found = format!(
                "lines {} m apart",
                digits::distinct_from(spacing_m, MIN_SPACING_M, 2)
            );
            let allowed = format!(
                "at least {MIN_SPACING_M} m: by agl_m, side_overlap and the angle of view or swath_m"
            );
            self.report(path, found, allowed);
        } else if area_m2 / spacing_m > MAX_LINES_M {
            let found = format!("{:.0} km of lines", area_m2 / spacing_m / 1e3);
            let allowed = format!(
                "at most {:.0} km: a smaller area, a wider swath, less overlap",
                MAX_LINES_M / 1e3
            );
            self.report(path, found, allowed);
        }
    }

    fn legs_apart(&mut self, path: &str, line: &[LatLon]) {
        for (index, pair) in line.windows(2).enumerate() {
            let apart_m = pair[0].chord_m(pair[1]);
            if apart_m < MIN_LEG_M {
                let apart = digits::distinct_from(apart_m, MIN_LEG_M, 1);
                let found = format!("{apart} m from the corner before it");
                let path = format!("{path}[{}]", index + 1);
                self.report(&path, found, format!("at least {MIN_LEG_M} m"));
            }
        }
    }

    /// All corners of a pattern lie in the area.
    fn pattern_clear(&mut self, path: &str, search: &SearchPattern, map: &Map) {
        let datum = map.frame.to_plan(search.at);
        for (number, [east_m, north_m]) in search.corners().into_iter().enumerate() {
            let at = EastNorth {
                east_m: datum.east_m + east_m,
                north_m: datum.north_m + north_m,
            };
            let what = match number {
                0 => "the pattern's begin".to_owned(),
                _ => format!("the end of leg {number}"),
            };
            let before = self.issues.len();
            self.clear(path, &what, map.frame.from_plan(at), map);
            if self.issues.len() > before {
                return;
            }
        }
    }
}

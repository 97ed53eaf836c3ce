//! Single things on the map: the source of the ground, threats, zones, rally points.

use std::path::{Component, Path, PathBuf};

use geo::algorithm::line_intersection::{LineIntersection, line_intersection};
use geo::{Area as _, Line};

use super::super::raw;
use super::super::{ELEVATION_ENDINGS, Hill, Rally, THREAT_RADIUS_M, TerrainSource, Threat};
use super::Checker;
use crate::geodesy::{Agl, Amsl, LatLon, LocalFrame};
use crate::numeric::digits;

/// Least area of a zone; what has less is a line.
const MIN_ZONE_M2: f64 = 1.0;
/// Least width of a zone: what is narrower lies within what rounding makes of a margin.
const MIN_ZONE_WIDTH_M: f64 = 0.01;
/// Most corners of one zone.
const MAX_CORNERS: usize = 1000;

/// A path that stays in the folder in which it is looked for; none for any other.
pub(in crate::spec) fn relative(name: &str) -> Option<PathBuf> {
    let mut path = PathBuf::new();
    let mut inside = !name.contains(['\\', ':']) && !name.chars().any(char::is_control);
    for part in Path::new(name).components() {
        match part {
            Component::Normal(name) => path.push(name),
            Component::CurDir => {}
            Component::ParentDir | Component::RootDir | Component::Prefix(_) => inside = false,
        }
    }
    (inside && !path.as_os_str().is_empty()).then_some(path)
}

impl Checker<'_> {
    pub(super) fn terrain(&mut self, raw: &raw::Terrain) -> Option<TerrainSource> {
        match (&raw.file, &raw.folder, &raw.flat, &raw.analytic) {
            (Some(file), None, None, None) => self.terrain_file(file).map(TerrainSource::File),
            (None, Some(folder), None, None) => self
                .beside("terrain.folder", folder)
                .map(TerrainSource::Folder),
            (None, None, Some(flat), None) => {
                let amsl = self.number("terrain.flat.amsl_m", flat.amsl_m, -500.0..=20_000.0);
                Some(TerrainSource::Flat(Amsl(amsl)))
            }
            (None, None, None, Some(analytic)) => {
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
                        self.number(&format!("{path}.radius_m"), hill.radius_m, THREAT_RADIUS_M);
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
                    "none or several of file, folder, flat and analytic",
                    "exactly one",
                );
                None
            }
        }
    }

    fn terrain_file(&mut self, file: &str) -> Option<PathBuf> {
        let path = self.beside("terrain.file", file)?;
        let name = file.to_ascii_lowercase();
        let mut endings = ELEVATION_ENDINGS.iter();
        if !endings.any(|ending| name.ends_with(ending)) {
            let allowed = format!("a file named {}", ELEVATION_ENDINGS.join(", "));
            self.report("terrain.file", format!("`{file}`"), allowed);
            return None;
        }
        Some(path)
    }

    /// A path that stays beside the spec wherever both are copied.
    pub(super) fn beside(&mut self, key: &str, name: &str) -> Option<PathBuf> {
        let path = relative(name);
        if path.is_none() {
            let allowed = "a path relative to the spec, with /, without .. and drive letters";
            let found = format!("`{}`", name.escape_debug());
            self.report(key, found, allowed);
        }
        path
    }

    pub(super) fn threat(&mut self, path: &str, raw: &raw::Threat) -> Option<Threat> {
        self.label(&format!("{path}.id"), &raw.id);
        let radius_m = self.number(&format!("{path}.radius_m"), raw.radius_m, THREAT_RADIUS_M);
        let place = self.place(path, raw.lat, raw.lon)?;
        let kind = raw.kind.clone().unwrap_or_else(|| "threat".to_owned());
        self.label(&format!("{path}.kind"), &kind);
        // A radius that is wrong already must not swallow every start and goal as well.
        THREAT_RADIUS_M.contains(&radius_m).then(|| Threat {
            id: raw.id.clone(),
            kind,
            place,
            radius_m,
        })
    }

    pub(super) fn rally(&mut self, path: &str, raw: &raw::Rally) -> Option<Rally> {
        let agl = self.number(&format!("{path}.agl_m"), raw.agl_m, 0.0..=20_000.0);
        let place = self.place(path, raw.lat, raw.lon)?;
        Some(Rally {
            place,
            agl: Agl(agl),
        })
    }

    /// The corners of a zone, without a last one that only repeats the first.
    pub(super) fn corners(&mut self, path: &str, raw: &raw::Zone) -> Option<Vec<LatLon>> {
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
    pub(super) fn polygon(&mut self, path: &str, frame: &LocalFrame, corners: &[LatLon]) -> bool {
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
        // That of a strip of the same area and perimeter.
        let lengths_m = edges.iter().map(|edge| edge.dx().hypot(edge.dy()));
        let width_m = 2.0 * outline.unsigned_area() / lengths_m.sum::<f64>();
        if width_m < MIN_ZONE_WIDTH_M {
            let found = format!(
                "a polygon {} m wide",
                digits::distinct_from(width_m, MIN_ZONE_WIDTH_M, 4)
            );
            self.report(path, found, format!("at least {MIN_ZONE_WIDTH_M} m"));
            return false;
        }
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
}

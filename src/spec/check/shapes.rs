//! Single things on the map: the source of the ground, threats, zones, rally points.

use std::path::{Component, Path, PathBuf};

use geo::algorithm::line_intersection::{LineIntersection, line_intersection};
use geo::{Area as _, Line};

use super::super::keys;
use super::super::{
    ELEVATION_ENDINGS, Hill, THREAT_RADIUS_M, TerrainSource, Threat, elevation_command,
};
use super::Checker;
use crate::geodesy::{Amsl, LatLon, LocalFrame};
use crate::numeric::digits;

/// Least area of a zone: less is a line.
const MIN_ZONE_M2: f64 = 1.0;
/// Least width of a zone: a narrower one lies within the rounding of a margin.
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

/// The corner at which each edge of an outline begins, as a polygon was written: long edges are drawn in
/// pieces.
fn written(corners: &[LatLon]) -> Vec<usize> {
    let next = corners.iter().cycle().skip(1);
    let edges = corners.iter().zip(next).enumerate();
    let pieces = edges.flat_map(|(corner, (from, to))| {
        let pieces = LocalFrame::pieces(*from, *to);
        (0..pieces).map(move |_| corner)
    });
    pieces.collect()
}

impl Checker {
    pub(super) fn terrain(&mut self, keys: &keys::Terrain) -> Option<TerrainSource> {
        match (&keys.file, &keys.folder, &keys.flat, &keys.analytic) {
            (Some(file), None, None, None) => self.terrain_file(file).map(TerrainSource::File),
            (None, Some(folder), None, None) => self
                .relative("terrain.folder", folder)
                .map(TerrainSource::Folder),
            (None, None, Some(flat), None) => Some(TerrainSource::Flat(Amsl(flat.amsl_m))),
            (None, None, None, Some(analytic)) => {
                let hills = analytic.hills.iter().filter_map(|hill| {
                    Some(Hill {
                        place: LatLon::new(hill.lat, hill.lon).ok()?,
                        height_m: hill.height_m,
                        radius_m: hill.radius_m,
                    })
                });
                Some(TerrainSource::Analytic {
                    base: Amsl(analytic.base_amsl_m),
                    hills: hills.collect(),
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
        let path = self.relative("terrain.file", file)?;
        let name = file.to_ascii_lowercase();
        let mut endings = ELEVATION_ENDINGS.iter();
        if !endings.any(|ending| name.ends_with(ending)) {
            let mut allowed = format!("a file named {}", ELEVATION_ENDINGS.join(", "));
            if let Some(command) = elevation_command(file) {
                allowed = format!("{allowed}; {command}");
            }
            self.report("terrain.file", format!("`{file}`"), allowed);
            return None;
        }
        Some(path)
    }

    /// A path that stays with the spec wherever both are copied.
    pub(super) fn relative(&mut self, key: &str, name: &str) -> Option<PathBuf> {
        let path = relative(name);
        if path.is_none() {
            let allowed = "a path relative to the spec, with /, without .. and drive letters";
            let found = format!("`{}`", name.escape_debug());
            self.report(key, found, allowed);
        }
        path
    }

    pub(super) fn threat(&mut self, path: &str, keys: &keys::Threat) -> Option<Threat> {
        self.label(&format!("{path}.id"), &keys.id);
        let place = LatLon::new(keys.lat, keys.lon).ok()?;
        let kind = keys.kind.clone().unwrap_or_else(|| "threat".to_owned());
        self.label(&format!("{path}.kind"), &kind);
        // A radius that is wrong already must not swallow every start and goal as well.
        THREAT_RADIUS_M.contains(&keys.radius_m).then(|| Threat {
            id: keys.id.clone(),
            kind,
            place,
            radius_m: keys.radius_m,
        })
    }

    /// The corners of a zone, without a last one that only repeats the first.
    pub(super) fn corners(&mut self, path: &str, keys: &keys::Zone) -> Option<Vec<LatLon>> {
        self.label(&format!("{path}.id"), &keys.id);
        self.ring_corners(&format!("{path}.polygon"), &keys.polygon)
    }

    /// The corners of a ring, without a last one that only repeats the first.
    pub(super) fn ring_corners(&mut self, path: &str, keys: &[[f64; 2]]) -> Option<Vec<LatLon>> {
        let mut corners = Vec::new();
        for (index, [lat_deg, lon_deg]) in keys.iter().enumerate() {
            let path = format!("{path}[{index}]");
            for (part, degrees, most) in [(0, lat_deg, 90.0), (1, lon_deg, 180.0)] {
                if !(-most..=most).contains(degrees) {
                    let found = digits::plain(*degrees);
                    let first = match part {
                        0 if (-180.0..=180.0).contains(degrees) => "; latitude comes first",
                        _ => "",
                    };
                    let allowed = format!("-{most} to {most}{first}");
                    self.report(&format!("{path}[{part}]"), found, allowed);
                }
            }
            corners.push(LatLon::new(*lat_deg, *lon_deg).ok());
        }
        let mut corners = corners.into_iter().collect::<Option<Vec<LatLon>>>()?;
        if corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        if !(3..=MAX_CORNERS).contains(&corners.len()) {
            self.report(
                path,
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
        let edges: Vec<Line<f64>> = outline.exterior().lines().collect();
        let written = written(corners);
        if outline.unsigned_area() < MIN_ZONE_M2 {
            // The parts of a bow-tie cancel each other.
            match crossing(&edges, &|_, meets| is_proper(meets)) {
                Some(crossing) => self.crosses(path, corners, crossing, &written),
                None => self.report(
                    path,
                    "a polygon without area",
                    "corners that are not on a line",
                ),
            }
            return false;
        }
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
        let twice = edges.iter().position(|edge| edge.start == edge.end);
        let crossed = crossing(&edges[..], &|neighbours, meets| match meets {
            LineIntersection::Collinear { .. } => true,
            LineIntersection::SinglePoint { .. } => !neighbours,
        });
        match (twice, crossed) {
            (Some(twice), crossed) if crossed.is_none_or(|(first, _)| twice <= first) => {
                let found = "this corner twice in a row";
                let path = format!("{path}[{}]", written[twice]);
                self.report(&path, found, "corners that differ");
                false
            }
            (_, Some(crossing)) => {
                self.crosses(path, corners, crossing, &written);
                false
            }
            _ => true,
        }
    }

    /// Reports two edges that meet.
    fn crosses(
        &mut self,
        path: &str,
        corners: &[LatLon],
        (first, second): (usize, usize),
        written: &[usize],
    ) {
        let (first, second) = (written[first], written[second]);
        let end = |corner: usize| (corner + 1) % corners.len();
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
    }
}

/// The first two edges that meet as `counts` says, by their indices: it is given whether they are neighbours.
fn crossing(
    edges: &[Line<f64>],
    counts: &dyn Fn(bool, LineIntersection<f64>) -> bool,
) -> Option<(usize, usize)> {
    for (first, edge) in edges.iter().enumerate() {
        for (second, other) in edges.iter().enumerate().skip(first + 1) {
            let neighbours = second == first + 1 || (first == 0 && second + 1 == edges.len());
            let meets = line_intersection(*edge, *other);
            if meets.is_some_and(|meets| counts(neighbours, meets)) {
                return Some((first, second));
            }
        }
    }
    None
}

/// Whether two edges cross between their ends.
fn is_proper(meets: LineIntersection<f64>) -> bool {
    matches!(
        meets,
        LineIntersection::SinglePoint {
            is_proper: true,
            ..
        }
    )
}

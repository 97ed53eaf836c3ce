//! Parallel lines over an area.

use geo::{Area as _, BooleanOps, BoundingRect, Coord, MapCoords, Polygon, Rect};

use super::line::{Spacing, SweepLine};
use crate::geodesy::EastNorth;
use crate::spec::Sensor;

/// Whether something that is closed at every height lies on the way between two places.
pub(super) type IsClosed<'c> = dyn Fn(EastNorth, EastNorth) -> bool + 'c;

/// A line goes on over a gap that is no longer than this many swaths, if it is open.
const GAP_SWATHS: f64 = 2.0;
/// A share of the swath at the edge of the area that is not relied on.
const EDGE: f64 = 0.03;
/// What a line costs besides its length, in metres: slowing down, resting, turning.
const EACH_LINE_M: f64 = 40.0;
/// Directions that are tried besides those of the edges are this far apart, degrees.
const EVERY_DEG: u32 = 10;
/// Most edges whose directions are tried, the longest ones.
const MAX_EDGES: usize = 16;

/// The lines over an area in the direction that costs least, or in a given one.
pub(super) fn lines(
    area: &Polygon<f64>,
    (sensor, agl_m): (&Sensor, f64),
    heading_rad: Option<f64>,
    spacing: Spacing,
    is_closed: &IsClosed<'_>,
) -> Vec<SweepLine> {
    let along =
        |heading_rad: f64| lines_along(area, (sensor, agl_m), heading_rad, spacing, is_closed);
    if let Some(heading_rad) = heading_rad {
        return along(heading_rad);
    }
    let headings = headings(area).into_iter().map(along);
    let best =
        headings.min_by(|one, other| cost_m(one, spacing).total_cmp(&cost_m(other, spacing)));
    best.unwrap_or_default()
}

/// Length of lines and turns, and what each line costs besides.
fn cost_m(lines: &[SweepLine], spacing: Spacing) -> f64 {
    let each_m = spacing.lines_m + EACH_LINE_M;
    lines.iter().map(|line| line.length_m() + each_m).sum()
}

/// Directions to try: those of the edges, and others all around.
fn headings(area: &Polygon<f64>) -> Vec<f64> {
    let mut edges: Vec<_> = area.exterior().lines().collect();
    let length = |edge: &geo::Line<f64>| edge.dx().hypot(edge.dy());
    edges.sort_by(|one, other| length(other).total_cmp(&length(one)));
    let edges = edges.iter().take(MAX_EDGES);
    let along = edges.map(|edge| edge.dx().atan2(edge.dy()).rem_euclid(std::f64::consts::PI));
    let around = (0..180 / EVERY_DEG).map(|step| f64::from(step * EVERY_DEG).to_radians());
    along.chain(around).collect()
}

/// The offsets of lines across a width from 0 on, such that each place in it is seen by as many
/// lines as the sensor wants.
pub(super) fn offsets_m(width_m: f64, half_m: f64, lines: u32, spacing_m: f64) -> Vec<f64> {
    let half_m = half_m * (1.0 - EDGE);
    let more = f64::from(lines - 1);
    let inset_m = half_m - more * spacing_m;
    let between_m = width_m - 2.0 * inset_m;
    let gaps = (between_m / spacing_m).ceil();
    let (gaps, first_m, step_m) = if gaps <= more {
        (more, (width_m - more * spacing_m) / 2.0, spacing_m)
    } else {
        (gaps, inset_m, between_m / gaps)
    };
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the length of all lines is limited"
    )]
    let count = gaps.clamp(0.0, 1e5) as u32;
    (0..=count)
        .map(|line| first_m + f64::from(line) * step_m)
        .collect()
}

/// How far a line goes on beyond what it has to show, metres; negative where less is enough.
pub(super) fn beyond_m(sensor: &Sensor, agl_m: f64, spacing: Spacing) -> f64 {
    let (Some(picture_m), Some(trigger_m)) = (sensor.picture_m(agl_m), spacing.pictures_m) else {
        return 1.0;
    };
    // There is a picture at each end.
    let before = f64::from(sensor.pictures() - 1) * trigger_m;
    before - (1.0 - EDGE) * picture_m / 2.0 + 1.0
}

fn lines_along(
    area: &Polygon<f64>,
    (sensor, agl_m): (&Sensor, f64),
    heading_rad: f64,
    spacing: Spacing,
    is_closed: &IsClosed<'_>,
) -> Vec<SweepLine> {
    let (sin, cos) = heading_rad.sin_cos();
    // x along the lines, y to the right of them.
    let turned = area.map_coords(|Coord { x, y }| Coord {
        x: x * sin + y * cos,
        y: x * cos - y * sin,
    });
    let Some(bounds) = turned.bounding_rect() else {
        return Vec::new();
    };
    let (low, high) = (bounds.min(), bounds.max());
    let swath_m = sensor.swath_m(agl_m);
    let offsets = offsets_m(
        high.y - low.y,
        swath_m / 2.0,
        sensor.lines(),
        spacing.lines_m,
    );
    let step_m = match offsets[..] {
        [first, second, ..] => second - first,
        _ => swath_m,
    };
    let beyond_m = beyond_m(sensor, agl_m, spacing);
    let at_edge = sensor.lines() as usize;
    let half_m = f64::from(sensor.lines()) * step_m / 2.0;
    let mut lines = Vec::new();
    for (number, offset_m) in offsets.iter().enumerate() {
        let y = low.y + offset_m;
        // What no other lines show is shown by those at the edge.
        let from = if number < at_edge {
            low.y - 1.0
        } else {
            y - half_m
        };
        let to = if number + at_edge >= offsets.len() {
            high.y + 1.0
        } else {
            y + half_m
        };
        let slab = Rect::new((low.x - 1.0, from), (high.x + 1.0, to)).to_polygon();
        let back = |x: f64| turned_back((x, y), (sin, cos));
        let goes_on = |from: f64, to: f64| {
            to - from <= GAP_SWATHS * swath_m && !is_closed(back(from), back(to))
        };
        for (first, last) in spans(&turned, &slab, goes_on) {
            let (first, last) = at_least_long(first - beyond_m, last + beyond_m);
            lines.push(SweepLine {
                points: vec![back(first), back(last)],
                is_reversible: true,
            });
        }
    }
    lines
}

/// A place by its way along the lines and to the right of them.
fn turned_back((x, y): (f64, f64), (sin, cos): (f64, f64)) -> EastNorth {
    EastNorth {
        east_m: x * sin + y * cos,
        north_m: x * cos - y * sin,
    }
}

/// A line has some length even where a picture would do.
pub(super) fn at_least_long(first: f64, last: f64) -> (f64, f64) {
    const MIN_M: f64 = 10.0;
    let short = (MIN_M - (last - first)).max(0.0) / 2.0;
    (first - short, last + short)
}

/// From where to where along x an area lies in a slab, with the gaps over which a line goes on.
fn spans(
    area: &Polygon<f64>,
    slab: &Polygon<f64>,
    goes_on: impl Fn(f64, f64) -> bool,
) -> Vec<(f64, f64)> {
    let parts = area.intersection(slab);
    let parts = parts.iter().filter(|part| part.unsigned_area() > 1e-3);
    let bounds = parts.filter_map(BoundingRect::bounding_rect);
    let mut each: Vec<(f64, f64)> = bounds.map(|rect| (rect.min().x, rect.max().x)).collect();
    each.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut spans: Vec<(f64, f64)> = Vec::new();
    for (first, last) in each {
        match spans.last_mut() {
            Some(before) if first <= before.1 || goes_on(before.1, first) => {
                before.1 = before.1.max(last)
            }
            _ => spans.push((first, last)),
        }
    }
    spans
}

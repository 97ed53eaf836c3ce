//! The lines of a task, as near to each other as the ground needs.

use geo::{Coord, Distance, Euclidean, Point, Polygon};

use super::coverage::{Cells, Pass, seen_by};
use super::line::{Spacing, SweepLine};
use super::profile::{Sampled, lifted};
use super::{corridor, survey};
use crate::geodesy::EastNorth;
use crate::spec::{Sensor, Sweep, SweepShape};
use crate::world::World;

/// Share of an area that the lines over it show, as far as the plan knows the ground.
const MIN_SHARE: f64 = 0.999;
/// Lines are brought nearer to each other by this share at a time, and so often at most.
const NEARER: f64 = 0.96;
const MAX_TIMES: u32 = 12;
/// Pictures are nearer to each other than their overlap needs by this share: hills.
const PICTURES: f64 = 0.92;
/// Steepest slope of a line, as long as no vehicle is known.
const SLOPE: f64 = 0.25;

/// The lines of a task.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// In order from one side to the other.
    pub lines: Vec<SweepLine>,
    /// Distance between pictures, metres; none without a camera.
    pub trigger_m: Option<f64>,
}

/// Lays out the lines of a task.
#[must_use]
pub fn lay_out(sweep: &Sweep, world: &World) -> Layout {
    let plan = |at: &crate::geodesy::LatLon| world.frame.to_plan(*at);
    match (&sweep.shape, sweep.sensor) {
        (SweepShape::Search(search), _) => {
            let datum = world.frame.to_plan(search.at);
            let corners = search.corners().into_iter();
            let points = corners.map(|[east_m, north_m]| EastNorth {
                east_m: datum.east_m + east_m,
                north_m: datum.north_m + north_m,
            });
            one_line(points.collect(), false)
        }
        (SweepShape::Corridor { line, .. }, None) => {
            one_line(line.iter().map(plan).collect(), true)
        }
        (SweepShape::Survey { .. }, None) => Layout {
            lines: Vec::new(),
            trigger_m: None,
        },
        (_, Some(sensor)) => over_ground(sweep, &sensor, world),
    }
}

fn one_line(points: Vec<EastNorth>, is_reversible: bool) -> Layout {
    Layout {
        lines: vec![SweepLine {
            points,
            is_reversible,
        }],
        trigger_m: None,
    }
}

/// Lines as far apart as the overlap allows over flat ground, and nearer where hills need it.
fn over_ground(sweep: &Sweep, sensor: &Sensor, world: &World) -> Layout {
    let agl_m = sweep.agl.0;
    let level_m = sensor.swath_m(agl_m) * (1.0 - sensor.side_overlap);
    let pictures_m = sensor.along.map(|(_, overlap)| {
        let between_m = sensor.picture_m(agl_m).unwrap_or(0.0) * (1.0 - overlap) * PICTURES;
        // As it is encoded.
        ((between_m * 10.0).floor() / 10.0).max(0.1)
    });
    let cells = Cells::of(sweep, world);
    let mut lines_m = level_m;
    for _ in 0..MAX_TIMES {
        let spacing = Spacing {
            lines_m,
            pictures_m,
        };
        let layout = Layout {
            lines: lines(sweep, sensor, world, spacing),
            trigger_m: pictures_m,
        };
        let share = cells.as_ref().map_or(1.0, |cells| {
            share_seen(sweep, sensor, (cells, world), &layout)
        });
        if share >= MIN_SHARE {
            return layout;
        }
        lines_m *= NEARER;
    }
    let spacing = Spacing {
        lines_m: level_m * NEARER,
        pictures_m,
    };
    Layout {
        lines: lines(sweep, sensor, world, spacing),
        trigger_m: pictures_m,
    }
}

fn lines(sweep: &Sweep, sensor: &Sensor, world: &World, spacing: Spacing) -> Vec<SweepLine> {
    let agl_m = sweep.agl.0;
    match &sweep.shape {
        SweepShape::Survey {
            polygon,
            holes,
            heading_rad,
        } => {
            let ring = |corners| world.frame.outline(corners).exterior().clone();
            let holes = holes.iter().map(|hole| ring(hole)).collect();
            let area: Polygon<f64> = Polygon::new(ring(polygon), holes);
            let is_closed = |from: EastNorth, to: EastNorth| is_closed(world, from, to);
            survey::lines(&area, (sensor, agl_m), *heading_rad, spacing, &is_closed)
        }
        SweepShape::Corridor { line, width_m } => {
            let line: Vec<EastNorth> = line.iter().map(|at| world.frame.to_plan(*at)).collect();
            corridor::lines(&line, *width_m, (sensor, agl_m), spacing)
        }
        SweepShape::Search(_) => Vec::new(),
    }
}

/// Whether a threat, or a zone that is closed at every height and time, lies on the way between two places.
fn is_closed(world: &World, from: EastNorth, to: EastNorth) -> bool {
    let at = |place: EastNorth| Coord {
        x: place.east_m,
        y: place.north_m,
    };
    let way = geo::Line::new(at(from), at(to));
    let mut threats = world.threats.iter();
    let zones = world.zones.iter();
    let mut zones = zones.filter(|zone| zone.is_closed_throughout());
    threats.any(|disc| Euclidean.distance(&way, &Point(at(disc.center))) <= disc.radius_m)
        || zones.any(|zone| Euclidean.distance(&way, &zone.outline) <= zone.buffer_m)
}

/// The share of an area that is seen from lines at their height above the ground.
fn share_seen(
    sweep: &Sweep,
    sensor: &Sensor,
    (cells, world): (&Cells, &World),
    layout: &Layout,
) -> f64 {
    let pass = |line: &SweepLine| {
        let legs = line.points.windows(2).map(|pair| Sampled {
            from: pair[0],
            to: pair[1],
            above_m: sweep.agl.0,
        });
        let points = lifted(&legs.collect::<Vec<_>>(), world, (SLOPE, SLOPE));
        Pass {
            legs: points.windows(2).map(|pair| (pair[0], pair[1])).collect(),
            trigger_m: layout.trigger_m,
            ends: [true, true],
        }
    };
    let passes: Vec<Pass> = layout.lines.iter().map(pass).collect();
    let seen = seen_by(cells, sensor, sweep.agl.0, &passes);
    let enough = seen
        .iter()
        .filter(|lines| **lines >= sensor.lines())
        .count();
    share(enough, seen.len())
}

#[expect(clippy::cast_precision_loss, reason = "numbers of cells")]
fn share(part: usize, whole: usize) -> f64 {
    part as f64 / whole.max(1) as f64
}

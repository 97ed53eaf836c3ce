//! The shortest line past the corners that a path passes.
//!
//! Corners of zones and threats near a path are joined by straight edges that cross nothing closed and
//! lead onward along it. Few of them lead past obstacles on other sides than the path, and those that
//! do are shorter.

use std::f64::consts::{PI, TAU};

use crate::geodesy::EastNorth;
use crate::numeric::geometry::{Offset, Point, Ring, disc_chord, distance};
use crate::plan::route_context::RouteContext;
use crate::world::PlanZone;

/// Corners further from the path are not passed, in turn radii, and at least in metres.
const NEAR_RADII: f64 = 4.0;
const NEAR_M: f64 = 100.0;
/// Shares of that, and corners of a whole turn around the corner of a zone with a buffer: the next where there are too
/// many corners.
const NEARER: [(f64, f64); 4] = [(1.0, 24.0), (0.5, 24.0), (0.25, 24.0), (0.25, 8.0)];
/// Most corners: edges between more of them take too long.
const MAX_CORNERS: usize = 1200;
/// How far back along the path a line may lead, metres: around one bend of it.
const BACK_M: f64 = 25.0;
/// Lines pass corners at this distance, metres.
const AWAY_M: f64 = 0.02;
/// Sine of the angle of two lines below which they do not meet.
const MIN_SINE: f64 = 0.1;
/// Corners of a threat.
const THREAT_CORNERS: f64 = 96.0;

/// What is closed in the plane, margins included.
pub(crate) struct Closed {
    area: Ring,
    zones: Vec<Offset>,
    threats: Vec<(Point, f64)>,
}

/// Where a line bends, or an end of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bend {
    pub at: EastNorth,
    /// The circle that it bends around: a threat, the corner of a zone with its buffer, or no more
    /// than the place itself.
    pub around: (EastNorth, f64),
    /// Circles around it that its turn is nearest to, positive to the left; 0 where it turns the shorter way.
    pub circles: f64,
}

impl Bend {
    /// A bend around nothing but its place.
    pub(crate) fn place(at: EastNorth) -> Self {
        Self {
            at,
            around: (at, 0.0),
            circles: 0.0,
        }
    }
}

/// A corner, the circle that it stands for, and how far along the path it is.
#[derive(Clone, Copy)]
struct Corner {
    at: Point,
    around: (Point, f64),
    along_m: f64,
}

/// The shortest line along a path that is given by many points, ends included, and what is closed there; none where
/// there are too many corners, or none that leads from end to end.
pub(crate) fn taut_line(
    context: &RouteContext<'_>,
    path: &[EastNorth],
    radius_m: f64,
) -> Option<(Vec<Bend>, Closed)> {
    let (line, closed) = shortest_near(context, path, radius_m)?;
    let bend = |corner: Corner| Bend {
        at: east_north(corner.at),
        around: (east_north(corner.around.0), corner.around.1),
        circles: 0.0,
    };
    Some((line.into_iter().map(bend).collect(), closed))
}

/// The same as the places at which it bends, ends included: around one circle as few as there is space for; and what is
/// closed there.
pub(crate) fn cornered_line(
    context: &RouteContext<'_>,
    path: &[EastNorth],
    radius_m: f64,
) -> Option<(Vec<EastNorth>, Closed)> {
    let (line, closed) = shortest_near(context, path, radius_m)?;
    let turns: Vec<&[Corner]> = line.chunk_by(Corner::is_around_same).collect();
    let mut all: Vec<Point> = Vec::new();
    for (index, turn) in turns.iter().enumerate() {
        let after = turns.get(index + 1).map(|turn| turn[0].at);
        let shorter = all.last().zip(after).and_then(|(&before, after)| {
            let is_free = |corners: &Vec<Point>| {
                let whole = [&[before], &corners[..], &[after]].concat();
                !corners.iter().any(|&corner| closed.holds(corner))
                    && (whole.windows(2)).all(|leg| closed.is_free(leg[0], leg[1]))
            };
            fewer_corners((before, after), turn)
                .into_iter()
                .find(is_free)
        });
        all.extend(shorter.unwrap_or_else(|| turn.iter().map(|corner| corner.at).collect()));
    }
    Some((all.into_iter().map(east_north).collect(), closed))
}

/// The shortest line along a path, and what is closed there.
fn shortest_near(
    context: &RouteContext<'_>,
    path: &[EastNorth],
    radius_m: f64,
) -> Option<(Vec<Corner>, Closed)> {
    let path: Vec<Point> = path.iter().map(|&at| plane(at)).collect();
    let (&first, &last) = (path.first()?, path.last()?);
    let near_m = (NEAR_RADII * radius_m).max(NEAR_M);
    let (closed, mut nodes) = (NEARER.iter())
        .map(|(share, round)| corners_near(context, &path, (share * near_m, *round)))
        .find(|(_, nodes)| nodes.len() <= MAX_CORNERS)?;
    nodes.insert(0, Corner::place(first));
    nodes.push(Corner {
        along_m: f64::INFINITY,
        ..Corner::place(last)
    });
    Some((shortest(&nodes, &closed)?, closed))
}

/// Where tangents of a turn around a circle meet, those before and behind it first, then these and one between them;
/// none where the line does not turn around it more than once.
fn fewer_corners((before, after): (Point, Point), turn: &[Corner]) -> Vec<Vec<Point>> {
    let &[first, .., last] = turn else {
        return Vec::new();
    };
    let middle = turn[turn.len() / 2];
    let into = (first.at, minus(first.at, before));
    let out = (last.at, minus(after, last.at));
    let away = minus(middle.at, middle.around.0);
    let between = (middle.at, [-away[1], away[0]]);
    let one = meet(into, out).into_iter().collect();
    let two = meet(into, between).into_iter().chain(meet(between, out));
    vec![one, two.collect()]
}

/// Where two lines meet, each a place and a direction; none where they are nearly parallel.
fn meet((a, along): (Point, Point), (b, other): (Point, Point)) -> Option<Point> {
    let cross = |a: Point, b: Point| a[0] * b[1] - a[1] * b[0];
    let between = cross(along, other);
    let is_steep = between.abs() > MIN_SINE * along[0].hypot(along[1]) * other[0].hypot(other[1]);
    let share = cross(minus(b, a), other) / between;
    (is_steep && share > 0.0).then(|| [a[0] + share * along[0], a[1] + share * along[1]])
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

fn east_north([east_m, north_m]: Point) -> EastNorth {
    EastNorth { east_m, north_m }
}

/// What is closed along a path, and its corners near the path, in order along it.
fn corners_near(
    context: &RouteContext<'_>,
    path: &[Point],
    (near_m, round): (f64, f64),
) -> (Closed, Vec<Corner>) {
    let (closed, corners) = Closed::along(context, path, (near_m, round));
    let mut gone_m = vec![0.0];
    for pair in path.windows(2) {
        gone_m.push(gone_m[gone_m.len() - 1] + distance(pair[0], pair[1]));
    }
    let mut nodes: Vec<Corner> = corners
        .into_iter()
        .filter_map(|corner| {
            let along_m = gone_m[nearest(path, corner.at, near_m)?];
            Some(Corner { along_m, ..corner })
        })
        .filter(|corner| !closed.holds(corner.at))
        .collect();
    nodes.sort_by(|a, b| a.along_m.total_cmp(&b.along_m));
    (closed, nodes)
}

/// The shortest line from the first of some nodes to the last, onward along the path: back by no more
/// than the corners around one bend of it.
fn shortest(nodes: &[Corner], closed: &Closed) -> Option<Vec<Corner>> {
    let last = nodes.len() - 1;
    let mut min_m = vec![f64::INFINITY; nodes.len()];
    let mut before = vec![0; nodes.len()];
    let mut open: Vec<usize> = (0..nodes.len()).collect();
    min_m[0] = 0.0;
    while !open.is_empty() {
        let (place, &from) =
            (open.iter().enumerate()).min_by(|a, b| min_m[*a.1].total_cmp(&min_m[*b.1]))?;
        if from == last || min_m[from].is_infinite() {
            break;
        }
        open.swap_remove(place);
        for &to in &open {
            let length_m = min_m[from] + distance(nodes[from].at, nodes[to].at);
            if length_m < min_m[to]
                && nodes[to].along_m >= nodes[from].along_m - BACK_M
                && closed.is_free(nodes[from].at, nodes[to].at)
            {
                (min_m[to], before[to]) = (length_m, from);
            }
        }
    }
    if min_m[last].is_infinite() {
        return None;
    }
    let step = |&node: &usize| (node > 0).then(|| before[node]);
    let back = std::iter::successors(Some(last), step);
    let mut line: Vec<Corner> = back.map(|node| nodes[node]).collect();
    line.reverse();
    Some(line)
}

/// The index of the point of a path that is nearest to a place, where that is near.
fn nearest(path: &[Point], at: Point, near_m: f64) -> Option<usize> {
    let square = |point: Point| (point[0] - at[0]).powi(2) + (point[1] - at[1]).powi(2);
    let away = path.iter().map(|&point| square(point)).enumerate();
    let nearest = away.min_by(|a, b| a.1.total_cmp(&b.1))?;
    (nearest.1 <= near_m * near_m).then_some(nearest.0)
}

impl Corner {
    /// Whether both are of one turn.
    fn is_around_same(&self, other: &Self) -> bool {
        self.around.1 > 0.0 && self.around == other.around
    }

    /// A corner that stands for no circle, anywhere along the path.
    fn place(at: Point) -> Self {
        Self {
            at,
            around: (at, 0.0),
            along_m: 0.0,
        }
    }
}

impl Closed {
    /// What is closed along a path, and its corners.
    fn along(
        context: &RouteContext<'_>,
        path: &[Point],
        (near_m, round): (f64, f64),
    ) -> (Self, Vec<Corner>) {
        let (world, margin_m) = (context.world, context.margins.threat_m);
        let ends = [context.ends.from.at, context.ends.to.at].map(plane);
        let (low, high) = bounds(path, near_m);
        let mut closed = Self {
            area: Ring::around(&world.area),
            zones: Vec::new(),
            threats: Vec::new(),
        };
        let mut corners = Vec::new();
        for zone in &world.zones {
            let offset = zone.away_from(ends, margin_m);
            // A path over or under a zone passes it in the plane.
            let is_crossed = || {
                zone.is_open_below(world.max_amsl)
                    && path
                        .iter()
                        .any(|&at| !offset.is_far_from(at, at) && offset.contains(at))
            };
            if !offset.is_far_from(low, high) && !is_crossed() {
                corners.extend(corners_of(zone, ends, (margin_m, round)));
                closed.zones.push(offset);
            }
        }
        for threat in &world.threats {
            let center = plane(threat.center);
            let rooms_m = ends.map(|end| distance(end, center) - threat.radius_m);
            let room_m = rooms_m[0].min(rooms_m[1]).max(0.0);
            let radius_m = threat.radius_m + margin_m.min(room_m);
            closed.threats.push((center, radius_m));
            corners.extend(around(center, radius_m, (0.0, TAU), THREAT_CORNERS));
        }
        (closed, corners)
    }

    /// Whether a place is closed, or outside of the area, which is a rectangle: a straight piece between places in it is in
    /// it.
    pub(crate) fn holds(&self, at: Point) -> bool {
        let in_threat = |&(center, radius_m): &(Point, f64)| distance(at, center) < radius_m;
        let in_zone = |zone: &Offset| !zone.is_far_from(at, at) && zone.contains(at);
        !self.area.contains(at)
            || self.threats.iter().any(in_threat)
            || self.zones.iter().any(in_zone)
    }

    /// Whether a straight piece crosses nothing closed.
    pub(crate) fn is_free(&self, a: Point, b: Point) -> bool {
        let crosses = |&(center, radius_m): &(Point, f64)| {
            disc_chord(a, b, center, radius_m).is_some_and(|chord| chord.fraction > 0.0)
        };
        let mut crossings = Vec::new();
        let mut enters = |zone: &Offset| {
            !zone.is_far_from(a, b)
                && zone.inside_fraction((a, b), (0.0, 1.0), &mut crossings) > 0.0
        };
        !self.threats.iter().any(crosses) && !self.zones.iter().any(&mut enters)
    }
}

/// Corners of what a zone closes.
fn corners_of(
    zone: &PlanZone,
    ends: [Point; 2],
    (margin_m, round_corners): (f64, f64),
) -> Vec<Corner> {
    let ring = Ring::around(&zone.outline);
    let room_m =
        (ends.iter().map(|end| ring.boundary_distance(*end))).fold(f64::INFINITY, f64::min);
    if zone.buffer_m <= 0.0 {
        let wider_m = margin_m.min(0.5 * room_m).max(0.0);
        let wider = ring.outset(wider_m + AWAY_M);
        return (wider.corners().iter())
            .map(|&at| Corner::place(at))
            .collect();
    }
    let radius_m = zone.buffer_m + margin_m.min(room_m - zone.buffer_m).max(0.0);
    let corners = ring.corners();
    let count = corners.len();
    let mut round = Vec::new();
    for (index, &at) in corners.iter().enumerate() {
        let (before, after) = (
            corners[(index + count - 1) % count],
            corners[(index + 1) % count],
        );
        let course_rad = |a: Point, b: Point| (b[1] - a[1]).atan2(b[0] - a[0]);
        let (into_rad, out_rad) = (course_rad(before, at), course_rad(at, after));
        let turn_rad = (out_rad - into_rad + PI).rem_euclid(TAU) - PI;
        if turn_rad > 0.0 {
            // Counter-clockwise: outside is to the right.
            let from_rad = into_rad - 0.5 * PI;
            round.extend(around(at, radius_m, (from_rad, turn_rad), round_corners));
        }
    }
    round
}

/// Points around an arc, so that lines through them stay outside of it: `whole` of them around a
/// circle.
fn around(
    center: Point,
    radius_m: f64,
    (from_rad, turn_rad): (f64, f64),
    whole: f64,
) -> impl Iterator<Item = Corner> {
    let count = (whole * turn_rad / TAU).ceil().max(1.0);
    let step_rad = turn_rad / count;
    let away_m = radius_m / (0.5 * step_rad).cos() + AWAY_M;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "at most a hundred"
    )]
    let count = count as u32;
    (0..count).map(move |number| {
        let (sin, cos) = (from_rad + step_rad * (f64::from(number) + 0.5)).sin_cos();
        Corner {
            around: (center, radius_m + AWAY_M),
            ..Corner::place([center[0] + away_m * cos, center[1] + away_m * sin])
        }
    })
}

/// The box of some points and what is near it.
fn bounds(points: &[Point], near_m: f64) -> (Point, Point) {
    let of = |axis: usize| {
        let values = points.iter().map(move |point| point[axis]);
        let low_m = values.clone().fold(f64::INFINITY, f64::min);
        let high_m = values.fold(f64::NEG_INFINITY, f64::max);
        (low_m - near_m, high_m + near_m)
    };
    let (east, north) = (of(0), of(1));
    ([east.0, north.0], [east.1, north.1])
}

fn plane(at: EastNorth) -> Point {
    [at.east_m, at.north_m]
}

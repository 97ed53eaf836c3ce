//! A line with its corners rounded as tightly as a vehicle may turn, as control points.
//!
//! A spline whose control points lie evenly on an arc is that arc, a little smaller. So the rounded
//! line is a belt around circles, one at each corner, which the spline touches there.

use nalgebra::{Rotation2, Vector2};

use crate::geodesy::EastNorth;
use crate::numeric::as_f64;
use crate::plan::classes::taut_line::Bend;

/// Greatest turn at one control point, radians.
const TURN_RAD: f64 = 0.45;
/// A wider turn than need be at a corner may lengthen the line by this, metres.
const LONGER_M: f64 = 0.05;
/// A wider turn takes no more than this share of the shorter leg.
const LEG_SHARE: f64 = 0.4;
/// Distance of control points at the ends, as a share of that on straight legs: there a path comes
/// down to where it is cheap, or up from it.
const END_SHARE: f64 = 1.0 / 16.0;
/// Rounds in which circles and legs are brought in line.
const ROUNDS: usize = 6;
/// Smaller turns are none, radians.
const STRAIGHT_RAD: f64 = 1e-6;

type Vector = Vector2<f64>;

/// The circle around which a line turns at a corner; at an end of the line it is a point.
#[derive(Clone, Copy, Debug)]
struct Circle {
    /// What it bends around: a place, and the distance that it keeps from it.
    around: (Vector, f64),
    /// Least radius of the turn.
    radius_m: f64,
    center: Vector,
    /// Distance of the legs from the centre, positive where the line turns left.
    legs_m: f64,
    /// Control points, their distance from the centre, and the turn at each.
    points: usize,
    points_m: f64,
    each_rad: f64,
}

/// The free control points of a spline along a line that turns no tighter than a radius, and on
/// straight legs has a control point at least every `span_m`; none where the corners are too near to
/// each other for that.
pub(super) fn controls(line: &[Bend], radius_m: f64, span_m: f64) -> Option<Vec<EastNorth>> {
    // Around one circle there is one turn.
    let is_same = |a: &Bend, b: &Bend| a.around.1 > 0.0 && a.around == b.around;
    let turns: Vec<&[Bend]> = line.chunk_by(is_same).collect();
    let mut circles: Vec<Circle> = turns.iter().map(|turn| Circle::point(&turn[0])).collect();
    let inner = 1..turns.len().saturating_sub(1);
    for index in inner.clone() {
        let [before, first] = [turns[index - 1].last()?, turns[index].first()?];
        let [last, after] = [turns[index].last()?, turns[index + 1].first()?];
        let into = vector(first.at) - vector(before.at);
        let out = vector(after.at) - vector(last.at);
        let (_, around_m) = first.around;
        circles[index].radius_m = match around_m > 0.0 {
            true => radius_m.max(around_m),
            false => wide_m(into, out, radius_m),
        };
        circles[index].turn(into.normalize(), out.normalize());
    }
    for _ in 0..ROUNDS {
        let courses = courses(&circles)?;
        for index in inner.clone() {
            circles[index].turn(courses[index - 1], courses[index]);
        }
    }
    let courses = courses(&circles)?;
    let mut free: Vec<Vector> = Vec::new();
    for (index, course) in courses.iter().enumerate() {
        let (from, to) = (&circles[index], &circles[index + 1]);
        let begin = from.points(before(&courses, index), *course);
        let end = to.points(*course, after(&courses, index));
        let begin = begin.last().copied().unwrap_or(from.center);
        let at_end = end.first().copied().unwrap_or(to.center);
        if (at_end - begin).dot(course) < 0.0 {
            return None;
        }
        let apart_m = |circle: &Circle| circle.apart_m().unwrap_or(END_SHARE * span_m);
        free.extend(leg((begin, apart_m(from)), (at_end, apart_m(to)), span_m));
        free.extend(end);
    }
    let at = |at: Vector| EastNorth {
        east_m: at.x,
        north_m: at.y,
    };
    Some(free.into_iter().map(at).collect())
}

fn vector(at: EastNorth) -> Vector {
    Vector::new(at.east_m, at.north_m)
}

fn before(courses: &[Vector], index: usize) -> Vector {
    courses[index.saturating_sub(1)]
}

fn after(courses: &[Vector], index: usize) -> Vector {
    courses[(index + 1).min(courses.len() - 1)]
}

/// The radius of a turn: where it is slight a wider one costs nothing.
fn wide_m(into: Vector, out: Vector, radius_m: f64) -> f64 {
    let turn_rad = turn_rad(into, out).abs().max(STRAIGHT_RAD);
    let by_length_m = 24.0 * LONGER_M / turn_rad.powi(3);
    let by_leg_m =
        LEG_SHARE * into.norm().min(out.norm()) / (0.5 * turn_rad).tan().max(STRAIGHT_RAD);
    by_length_m.min(by_leg_m).max(radius_m)
}

fn turn_rad(into: Vector, out: Vector) -> f64 {
    into.perp(&out).atan2(into.dot(&out))
}

/// The courses of the legs between circles: unit vectors.
fn courses(circles: &[Circle]) -> Option<Vec<Vector>> {
    let course = |pair: &[Circle]| {
        let (from, to) = (&pair[0], &pair[1]);
        let between = to.center - from.center;
        let sine = (from.legs_m - to.legs_m) / between.norm();
        (sine.abs() < 1.0).then(|| {
            let unit = between / between.norm();
            let left = Vector::new(-unit.y, unit.x);
            unit * (1.0 - sine * sine).sqrt() + left * sine
        })
    };
    circles.windows(2).map(course).collect()
}

/// Control points on a straight leg, near those at its ends as near as these are to each other, and
/// wider apart between them.
fn leg((begin, first_m): (Vector, f64), (end, last_m): (Vector, f64), span_m: f64) -> Vec<Vector> {
    let length_m = (end - begin).norm();
    let (mut from_m, mut to_m) = (vec![0.0], vec![length_m]);
    let (mut first_m, mut last_m) = (first_m.min(span_m), last_m.min(span_m));
    let (mut begun_m, mut left_m) = (0.0, length_m);
    let mut number = 0;
    while left_m - begun_m > first_m.min(last_m) * 2.0 && (first_m < span_m || last_m < span_m) {
        // Two as near as those on the arc, then each twice as far.
        let grown = |step_m: f64| {
            if number < 2 {
                step_m
            } else {
                (2.0 * step_m).min(span_m)
            }
        };
        let (is_first, is_last) = (first_m <= last_m, last_m <= first_m);
        if is_first {
            begun_m += first_m;
            from_m.push(begun_m);
            first_m = grown(first_m);
        }
        if is_last {
            if left_m - begun_m > last_m {
                left_m -= last_m;
                to_m.push(left_m);
            }
            last_m = grown(last_m);
        }
        number += 1;
    }
    let gap_m = left_m - begun_m;
    let pieces = gap_m / first_m.max(last_m).max(1e-3);
    // Points nearer to each other would turn tighter.
    let pieces = (if first_m < span_m {
        pieces.floor()
    } else {
        pieces.ceil()
    })
    .clamp(1.0, 1000.0);
    let mut all_m = from_m;
    let mut piece = 1.0;
    while piece < pieces {
        all_m.push(begun_m + gap_m * piece / pieces);
        piece += 1.0;
    }
    all_m.extend(to_m.into_iter().rev());
    let inner = all_m.len().saturating_sub(1);
    let along = (end - begin) / length_m.max(1e-9);
    all_m[1..inner].iter().map(|m| begin + along * *m).collect()
}

impl Circle {
    fn point(bend: &Bend) -> Self {
        let (center, around_m) = bend.around;
        Self {
            around: (vector(center), around_m),
            radius_m: 0.0,
            center: vector(center),
            legs_m: 0.0,
            points: 0,
            points_m: 0.0,
            each_rad: 0.0,
        }
    }

    /// The circle of a turn between two courses.
    fn turn(&mut self, into: Vector, out: Vector) {
        let turn_rad = turn_rad(into, out);
        let count = (turn_rad.abs() / TURN_RAD).ceil().max(1.0);
        self.each_rad = turn_rad.abs().max(STRAIGHT_RAD) / count;
        let (sin, cos) = (0.5 * self.each_rad).sin_cos();
        // Control points so far apart that the spline through them turns with the radius.
        let touches = touches(self.each_rad);
        self.points_m = self.radius_m / touches;
        self.points_m = self.points_m.max(0.5 * self.radius_m * self.each_rad / sin);
        self.legs_m = (self.points_m * cos).copysign(turn_rad);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a handful"
        )]
        let points = count as usize;
        self.points = points;
        let (at, around_m) = self.around;
        self.center = at - outward(into, out) * (self.points_m * touches - around_m);
    }

    /// Distance between control points at the corner; an end is none.
    fn apart_m(&self) -> Option<f64> {
        (self.points > 0).then(|| 2.0 * self.points_m * (0.5 * self.each_rad).sin())
    }

    /// The control points of the turn between two courses.
    fn points(&self, into: Vector, out: Vector) -> Vec<Vector> {
        let middle = 0.5 * (as_f64(self.points) - 1.0);
        let each_rad = self.each_rad.copysign(self.legs_m);
        let on_circle = |number: usize| {
            let turned = (as_f64(number) - middle) * each_rad;
            self.center + Rotation2::new(turned) * outward(into, out) * self.points_m
        };
        (0..self.points).map(on_circle).collect()
    }
}

/// Where a line turns from one course to another: the direction away from the centre.
fn outward(into: Vector, out: Vector) -> Vector {
    let away = into - out;
    let left = Vector::new(-into.y, into.x);
    match away.norm() > STRAIGHT_RAD {
        true => away.normalize(),
        false => left,
    }
}

/// How near to its centre a spline comes whose control points are on a circle of radius 1, each so
/// far from the next.
fn touches(each_rad: f64) -> f64 {
    let at_point = (2.0 + each_rad.cos()) / 3.0;
    let between = (23.0 * (0.5 * each_rad).cos() + (1.5 * each_rad).cos()) / 24.0;
    at_point.min(between)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::Basis;

    #[test]
    fn a_belt_passes_its_corners_and_turns_no_tighter_than_its_radius() {
        const RADIUS_M: f64 = 25.0;
        let at = |east_m, north_m| EastNorth { east_m, north_m };
        let place = |at: EastNorth| Bend {
            at,
            around: (at, 0.0),
        };
        let line = [
            at(0.0, 0.0),
            at(2000.0, 300.0),
            at(2500.0, 900.0),
            at(2400.0, 1000.0),
            at(200.0, 1100.0),
        ];
        let free = controls(&line.map(place), 1.05 * RADIUS_M, 150.0).expect("legs are long");
        let all = [&line[..1], &free, &line[4..]].concat();
        let basis = Basis::uniform(all.len(), 40_001);
        let sampled =
            |of: fn(&EastNorth) -> f64| basis.sampled(&all.iter().map(of).collect::<Vec<f64>>());
        let (east, north) = (sampled(|at| at.east_m), sampled(|at| at.north_m));
        let path: Vec<EastNorth> = east.into_iter().zip(north).map(|(e, n)| at(e, n)).collect();
        for corner in &line[1..4] {
            let nearest_m = path.iter().map(|at| at.distance_m(*corner));
            assert!(nearest_m.fold(f64::INFINITY, f64::min) < 0.1);
        }
        for three in path.windows(3) {
            let (into, out) = (
                vector(three[1]) - vector(three[0]),
                vector(three[2]) - vector(three[1]),
            );
            let per_m = turn_rad(into, out).abs() / (0.5 * (into.norm() + out.norm()));
            assert!(per_m < 1.0 / RADIUS_M, "{per_m} at {three:?}");
        }
    }
}

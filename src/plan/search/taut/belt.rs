//! A line with its corners rounded as tightly as a vehicle may turn, as control points.
//!
//! A spline whose control points lie evenly on an arc is that arc, a little smaller. So the rounded
//! line is a belt around circles, one at each corner, which the spline touches there.

mod straight_leg;
mod turn_circle;

use nalgebra::Vector2;

use self::straight_leg::leg;
use self::turn_circle::Circle;
use crate::geodesy::EastNorth;
use crate::plan::classes::taut_line::Bend;

/// Distance of control points at the ends, as a share of that on straight legs: there a path comes
/// down to where it is cheap, or up from it.
const END_SHARE: f64 = 1.0 / 16.0;
/// Rounds in which the line around the circles is drawn taut.
const ROUNDS: usize = 60;
/// In the first rounds no circle is left out.
const FIRST_ROUNDS: usize = 5;
/// How far apart circles are that the line crosses between, as a share of the least, and rounds in which they are parted.
const PARTED: f64 = 1.001;
const PARTINGS: usize = 100;

type Vector = Vector2<f64>;

/// The free control points of a spline along a line that turns no tighter than a radius at each bend, and on
/// straight legs has a control point at least every `span_m`; none where the corners are too near to
/// each other for that.
pub(super) fn controls(line: &[Bend], radii_m: &[f64], span_m: f64) -> Option<Vec<EastNorth>> {
    // Around one circle there is one turn.
    let is_same = |a: &Bend, b: &Bend| a.around.1 > 0.0 && a.around == b.around;
    let turns: Vec<&[Bend]> = line.chunk_by(is_same).collect();
    let firsts = turns.iter().scan(0, |first, turn| {
        let index = *first;
        *first += turn.len();
        radii_m.get(index).copied()
    });
    let radii_m: Vec<f64> = firsts.collect();
    let mut circles: Vec<Circle> = turns.iter().map(|turn| Circle::point(&turn[0])).collect();
    for index in 1..turns.len().saturating_sub(1) {
        let [before, first] = [turns[index - 1].last()?, turns[index].first()?];
        let [last, after] = [turns[index].last()?, turns[index + 1].first()?];
        let into = vector(first.at) - vector(before.at);
        let out = vector(after.at) - vector(last.at);
        circles[index].begin((into, out), *radii_m.get(index)?);
    }
    let courses = draw_taut(&mut circles)?;
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
    Some(free.into_iter().map(east_north).collect())
}

/// Moves circles around their places until the line around them is as short as it can be, and leaves out those that it
/// passes without a turn. The courses of its legs; none where it cannot lead between two circles.
///
/// A centre moves against the gradient of the length, which is the difference of the courses, and no further from its
/// place than the turn is wide.
fn draw_taut(circles: &mut Vec<Circle>) -> Option<Vec<Vector>> {
    part(circles);
    for round in 0..ROUNDS {
        let courses = courses(circles)?;
        let turned = |index: usize| circles[index].turned_rad(courses[index - 1], courses[index]);
        let inner = 1..circles.len() - 1;
        let least = inner
            .clone()
            .min_by(|a, b| turned(*a).total_cmp(&turned(*b)));
        if let Some(index) = least.filter(|index| round >= FIRST_ROUNDS && turned(*index) <= 0.0) {
            circles.remove(index);
            continue;
        }
        for index in inner {
            let (into, out) = (courses[index - 1], courses[index]);
            let circle = &mut circles[index];
            circle.turn(into, out);
            circle.center -= circle.step_m * (into - out);
            circle.hold();
        }
        part(circles);
    }
    let drawn = courses(circles)?;
    for index in 1..circles.len() - 1 {
        circles[index].turn(drawn[index - 1], drawn[index]);
    }
    courses(circles)
}

/// Parts circles that the line crosses between: no leg leads between two that are too near.
fn part(circles: &mut [Circle]) {
    for _ in 0..PARTINGS {
        let mut are_parted = true;
        for index in 1..circles.len() {
            let (from, to) = (circles[index - 1], circles[index]);
            let between = to.center - from.center;
            let (apart_m, min_m) = (between.norm(), (from.legs_m - to.legs_m).abs());
            if from.legs_m * to.legs_m >= 0.0 || apart_m > min_m || apart_m <= 0.0 {
                continue;
            }
            are_parted = false;
            let each = between * (0.5 * (PARTED * min_m - apart_m) / apart_m);
            circles[index - 1].center -= each;
            circles[index].center += each;
            circles[index - 1].hold();
            circles[index].hold();
        }
        if are_parted {
            return;
        }
    }
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

fn before(courses: &[Vector], index: usize) -> Vector {
    courses[index.saturating_sub(1)]
}

fn after(courses: &[Vector], index: usize) -> Vector {
    courses[(index + 1).min(courses.len() - 1)]
}

pub(super) fn east_north(at: Vector) -> EastNorth {
    EastNorth {
        east_m: at.x,
        north_m: at.y,
    }
}

pub(super) fn vector(at: EastNorth) -> Vector {
    Vector::new(at.east_m, at.north_m)
}

pub(super) fn turn_rad(into: Vector, out: Vector) -> f64 {
    into.perp(&out).atan2(into.dot(&out))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::numeric::Basis;

    const fn at(east_m: f64, north_m: f64) -> EastNorth {
        EastNorth { east_m, north_m }
    }

    /// The spline along a line of corners, sampled.
    fn path(line: &[EastNorth], radius_m: f64, span_m: f64) -> Vec<EastNorth> {
        let bends: Vec<Bend> = line.iter().map(|at| Bend::place(*at)).collect();
        along(&bends, radius_m, span_m)
    }

    /// The same along a line of bends.
    fn along(line: &[Bend], radius_m: f64, span_m: f64) -> Vec<EastNorth> {
        let free = controls(line, &vec![radius_m; line.len()], span_m).expect("a belt");
        let all = [&[line[0].at], &free[..], &[line[line.len() - 1].at]].concat();
        let basis = Basis::uniform(all.len(), 40_001);
        let sampled =
            |of: fn(&EastNorth) -> f64| basis.sampled(&all.iter().map(of).collect::<Vec<f64>>());
        let (east, north) = (sampled(|at| at.east_m), sampled(|at| at.north_m));
        east.into_iter().zip(north).map(|(e, n)| at(e, n)).collect()
    }

    fn turns_no_tighter(path: &[EastNorth], radius_m: f64) {
        for three in path.windows(3) {
            let (into, out) = (
                vector(three[1]) - vector(three[0]),
                vector(three[2]) - vector(three[1]),
            );
            let per_m = turn_rad(into, out).abs() / (0.5 * (into.norm() + out.norm()));
            assert!(per_m < 1.0 / radius_m, "{per_m} at {three:?}");
        }
    }

    #[test]
    fn a_belt_passes_its_corners_and_turns_no_tighter_than_its_radius() {
        const RADIUS_M: f64 = 25.0;
        let line = [
            at(0.0, 0.0),
            at(2000.0, 300.0),
            at(2500.0, 900.0),
            at(2400.0, 1000.0),
            at(200.0, 1100.0),
        ];
        let path = path(&line, 1.05 * RADIUS_M, 150.0);
        for corner in &line[1..4] {
            let nearest_m = path.iter().map(|at| at.distance_m(*corner));
            assert!(nearest_m.fold(f64::INFINITY, f64::min) < 0.1);
        }
        turns_no_tighter(&path, RADIUS_M);
    }

    #[test]
    fn circles_are_as_long_and_as_wide_as_they_are_asked_for() {
        const RADIUS_M: f64 = 40.0;
        for circles in [-3.0, -1.0, 2.0] {
            let circle = Bend {
                around: (at(300.0, RADIUS_M.copysign(circles)), RADIUS_M),
                circles,
                ..Bend::place(at(300.0, 0.0))
            };
            let line = [
                Bend::place(at(0.0, 0.0)),
                circle,
                Bend::place(at(500.0, 20.0)),
            ];
            let path = along(&line, 20.0, 30.0);
            // Before them and behind them the spline turns a little tighter.
            turns_no_tighter(&path, RADIUS_M / 1.06);
            let length_m: f64 = path.windows(2).map(|two| two[0].distance_m(two[1])).sum();
            let straight_m = 500.0_f64.hypot(20.0);
            let around_m = length_m - straight_m - circles.abs() * TAU * RADIUS_M;
            assert!(around_m.abs() < 8.0, "{circles}: {around_m}");
        }
    }

    /// Ends of walls 20 m thick, with turns that are as wide: around one, and to and fro between two.
    #[test]
    fn a_belt_leads_around_corners_that_are_as_near_as_its_turns_are_wide() {
        const RADIUS_M: f64 = 10.0;
        let around = [
            at(106.2, 278.6),
            at(278.5, 491.0),
            at(298.6, 491.0),
            at(298.5, 86.2),
            at(-106.3, -470.9),
        ];
        let to_and_fro = [
            at(20.0, -300.0),
            at(0.0, 0.0),
            at(20.0, 0.0),
            at(0.0, 300.0),
        ];
        for line in [&around[..], &to_and_fro[..]] {
            let path = path(line, 1.13 * RADIUS_M, 60.0);
            turns_no_tighter(&path, RADIUS_M);
            let length_m = |of: &[EastNorth]| {
                of.windows(2)
                    .map(|two| two[0].distance_m(two[1]))
                    .sum::<f64>()
            };
            let longer_m = length_m(&path) - length_m(line);
            assert!((0.0..15.0).contains(&longer_m), "{longer_m} m longer");
            for three in line.windows(3) {
                // It passes outside of each corner.
                let (into, out) = (
                    vector(three[1]) - vector(three[0]),
                    vector(three[2]) - vector(three[1]),
                );
                let near = |at: &&[EastNorth]| at[0].distance_m(three[1]);
                let nearest = path.windows(2).min_by(|a, b| near(a).total_cmp(&near(b)));
                let nearest = nearest.expect("a path");
                let along = (vector(nearest[1]) - vector(nearest[0])).normalize();
                let off_m = along.perp(&(vector(three[1]) - vector(nearest[0])));
                let outside_m = off_m * turn_rad(into, out).signum();
                assert!(outside_m > -0.05, "{outside_m} m at {:?}", three[1]);
            }
        }
    }
}

//! The circle around which a line turns at a corner, and the control points of a spline on it.

use std::f64::consts::TAU;

use nalgebra::Rotation2;

use super::{Vector, turn_rad, vector};
use crate::numeric::as_f64;
use crate::plan::classes::taut_line::Bend;

/// Greatest turn at one control point, radians.
const TURN_RAD: f64 = 0.45;
/// A wider turn than need be at a corner may lengthen the line by this, metres.
const LONGER_M: f64 = 0.05;
/// A wider turn takes no more than this share of the shorter leg: control points beside it are as far apart as its own.
const LEG_SHARE: f64 = 0.07;
/// The greatest step of a centre for each unit of the difference of courses, as a share of the radius or the shorter leg.
const STEP: f64 = 0.25;
/// Smaller turns are none, radians.
const STRAIGHT_RAD: f64 = 1e-6;

/// The circle around which a line turns at a corner; at an end of the line it is a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Circle {
    /// What it bends around: a place, and the distance that it keeps from it.
    around: (Vector, f64),
    /// Positive where the line turns left.
    side: f64,
    /// Circles that its turn is nearest to; 0 where it turns the shorter way.
    circles: f64,
    /// Least radius of the turn.
    radius_m: f64,
    /// Greatest step of its centre for each unit of the difference of courses, metres.
    pub(super) step_m: f64,
    /// How far from the centre the spline passes.
    touches_m: f64,
    pub(super) center: Vector,
    /// Distance of the legs from the centre, positive where the line turns left.
    pub(super) legs_m: f64,
    /// Control points, their distance from the centre, and the turn at each.
    points: usize,
    points_m: f64,
    each_rad: f64,
}

impl Circle {
    pub(super) fn point(bend: &Bend) -> Self {
        let (center, around_m) = bend.around;
        Self {
            around: (vector(center), around_m),
            side: match bend.circles.abs() > 0.0 {
                true => bend.circles.signum(),
                false => 0.0,
            },
            circles: bend.circles.abs(),
            radius_m: 0.0,
            step_m: 0.0,
            touches_m: 0.0,
            center: vector(center),
            legs_m: 0.0,
            points: 0,
            points_m: 0.0,
            each_rad: 0.0,
        }
    }

    /// The circle of a turn between two legs of the line, where it touches its place.
    pub(super) fn begin(&mut self, (into, out): (Vector, Vector), radius_m: f64) {
        let (at, around_m) = self.around;
        let circles = self.circles > 0.0;
        if !circles {
            self.side = turn_rad(into, out).signum();
        }
        self.radius_m = match around_m > 0.0 {
            true => radius_m.max(around_m),
            false => wide_m(into, out, radius_m),
        };
        // Circles stay where there is space for them.
        self.step_m = match circles {
            true => 0.0,
            false => STEP * self.radius_m.min(into.norm()).min(out.norm()),
        };
        let (into, out) = (into.normalize(), out.normalize());
        self.turn(into, out);
        self.center = at - outward(into, out) * (self.touches_m - around_m);
    }

    /// How far it turns between two courses, circles included.
    pub(super) fn turned_rad(&self, into: Vector, out: Vector) -> f64 {
        let turn_rad = self.side * turn_rad(into, out);
        match self.circles > 0.0 {
            true => turn_rad + TAU * (self.circles - turn_rad / TAU).round(),
            false => turn_rad,
        }
    }

    /// Its control points for a turn between two courses.
    pub(super) fn turn(&mut self, into: Vector, out: Vector) {
        let turn_rad = match self.circles > 0.0 {
            true => self.turned_rad(into, out),
            false => turn_rad(into, out).abs(),
        };
        let count = (turn_rad / TURN_RAD).ceil().max(1.0);
        self.each_rad = turn_rad.max(STRAIGHT_RAD) / count;
        let (sin, cos) = (0.5 * self.each_rad).sin_cos();
        // Control points so far apart that the spline through them turns with the radius.
        let touches = touches(self.each_rad);
        self.points_m = self.radius_m / touches;
        self.points_m = self.points_m.max(0.5 * self.radius_m * self.each_rad / sin);
        self.legs_m = self.points_m * cos * self.side;
        self.touches_m = self.points_m * touches;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a handful"
        )]
        let points = count as usize;
        self.points = points;
    }

    /// What it bends around stays within it.
    pub(super) fn hold(&mut self) {
        let (at, around_m) = self.around;
        let (away, max_m) = (self.center - at, (self.touches_m - around_m).max(0.0));
        let away_m = away.norm();
        if away_m > max_m {
            self.center = at + away * (max_m / away_m);
        }
    }

    /// Distance between control points at the corner; an end is none.
    pub(super) fn apart_m(&self) -> Option<f64> {
        (self.points > 0).then(|| 2.0 * self.points_m * (0.5 * self.each_rad).sin())
    }

    /// The control points of the turn between two courses.
    pub(super) fn points(&self, into: Vector, out: Vector) -> Vec<Vector> {
        let each_rad = self.each_rad.copysign(self.legs_m);
        // Circles begin where the leg before touches them; of a turn the middle is known.
        let (from, first) = match self.circles > 0.0 {
            true => (Vector::new(into.y, -into.x) * self.side, 0.5),
            false => (outward(into, out), 0.5 - 0.5 * as_f64(self.points)),
        };
        let on_circle = |number: usize| {
            let turned = (as_f64(number) + first) * each_rad;
            self.center + Rotation2::new(turned) * from * self.points_m
        };
        (0..self.points).map(on_circle).collect()
    }
}

/// The radius of a turn: where it is slight a wider one costs nothing.
fn wide_m(into: Vector, out: Vector, radius_m: f64) -> f64 {
    let turn_rad = turn_rad(into, out).abs().max(STRAIGHT_RAD);
    let by_length_m = 24.0 * LONGER_M / turn_rad.powi(3);
    let by_leg_m =
        LEG_SHARE * into.norm().min(out.norm()) / (0.5 * turn_rad).tan().max(STRAIGHT_RAD);
    by_length_m.min(by_leg_m).max(radius_m)
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

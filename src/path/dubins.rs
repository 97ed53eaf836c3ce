//! The shortest way between two courses for whatever cannot turn more tightly than a
//! circle: at most three arcs and straight lines (Dubins 1957, in the normalised form
//! of Shkel and Lumelsky 2001).

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::geodesy::EastNorth;

/// A place and a course.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Where.
    pub at: EastNorth,
    /// Course, radians clockwise from north.
    pub heading_rad: f64,
}

/// The shortest way from one pose to another with turns of `radius_m` (positive).
#[derive(Clone, Debug, PartialEq)]
pub struct Turns {
    /// Length, metres.
    pub length_m: f64,
    /// Where the tangents of its arcs meet, in order: rounded with arcs of the radius, the
    /// polyline from the first pose over these to the last is the way itself. No arc turns
    /// by more than a right angle.
    pub corners: Vec<EastNorth>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Move {
    Left,
    Straight,
    Right,
}

use Move::{Left, Right, Straight};

const WORDS: [[Move; 3]; 6] = [
    [Left, Straight, Left],
    [Right, Straight, Right],
    [Left, Straight, Right],
    [Right, Straight, Left],
    [Right, Left, Right],
    [Left, Right, Left],
];

/// Turns below this change no course that matters, radians.
const MIN_TURN_RAD: f64 = 1e-4;
/// How near a way must end to where it should, in radii.
const CLOSE: f64 = 1e-6;

/// The shortest way from one pose to another with turns of a radius.
#[must_use]
pub fn turns(from: Pose, to: Pose, radius_m: f64) -> Turns {
    let start = State::of(from);
    let Some((word, lengths)) = shortest(start, State::of(to), radius_m) else {
        // Two poses always have a way; only rounding far beyond any map could lose it.
        return Turns {
            length_m: from.at.distance_m(to.at),
            corners: Vec::new(),
        };
    };
    start.along(word, lengths, radius_m)
}

/// The ways from one pose to another that turn to one side or the other at either end, the shortest is [`turns`].
#[must_use]
pub fn all_turns(from: Pose, to: Pose, radius_m: f64) -> Vec<Turns> {
    let start = State::of(from);
    ways(start, State::of(to), radius_m)
        .map(|(word, lengths)| start.along(word, lengths, radius_m))
        .collect()
}

/// The points of the same way, no more than `step_m` apart on its arcs, both ends included.
#[must_use]
pub fn turns_sampled(from: Pose, to: Pose, radius_m: f64, step_m: f64) -> Vec<EastNorth> {
    let mut state = State::of(from);
    let mut points = vec![from.at];
    if let Some((word, lengths)) = shortest(state, State::of(to), radius_m) {
        for (step, length) in word.iter().zip(lengths) {
            let pieces = match step {
                Straight => 1.0,
                Left | Right => (length * radius_m / step_m).ceil(),
            };
            let mut piece = 1.0;
            while length * radius_m > 1e-6 && piece <= pieces {
                let part = state.moved(*step, length * piece / pieces, radius_m);
                points.push(part.at());
                piece += 1.0;
            }
            state = state.moved(*step, length, radius_m);
        }
        points.pop();
    }
    points.push(to.at);
    points
}

/// The moves of the shortest way between two states, and their lengths in radii and radians.
fn shortest(start: State, end: State, radius_m: f64) -> Option<(&'static [Move; 3], [f64; 3])> {
    ways(start, end, radius_m).min_by(|a, b| a.1.iter().sum::<f64>().total_cmp(&b.1.iter().sum()))
}

/// The moves of every way between two states, and their lengths.
fn ways(
    start: State,
    end: State,
    radius_m: f64,
) -> impl Iterator<Item = (&'static [Move; 3], [f64; 3])> {
    let (east_m, north_m) = (end.east_m - start.east_m, end.north_m - start.north_m);
    let along_rad = north_m.atan2(east_m);
    let (alpha, beta) = (start.course_rad - along_rad, end.course_rad - along_rad);
    let distance = east_m.hypot(north_m) / radius_m;
    WORDS
        .iter()
        .filter_map(move |word| Some((word, lengths(word, distance, alpha, beta)?)))
        .filter(move |(word, lengths)| {
            let reached = word
                .iter()
                .zip(lengths)
                .fold(start, |state, (step, length)| {
                    state.moved(*step, *length, radius_m)
                });
            reached.misses_m(&end) <= CLOSE * radius_m * (1.0 + distance)
        })
}

/// A pose with its course counter-clockwise from east.
#[derive(Clone, Copy, Debug)]
struct State {
    east_m: f64,
    north_m: f64,
    course_rad: f64,
}

impl State {
    fn of(pose: Pose) -> Self {
        Self {
            east_m: pose.at.east_m,
            north_m: pose.at.north_m,
            course_rad: FRAC_PI_2 - pose.heading_rad,
        }
    }

    fn at(&self) -> EastNorth {
        EastNorth {
            east_m: self.east_m,
            north_m: self.north_m,
        }
    }

    /// The way of some moves from here, of these lengths.
    fn along(self, word: &[Move; 3], lengths: [f64; 3], radius_m: f64) -> Turns {
        let mut state = self;
        let mut corners = Vec::new();
        for (step, length) in word.iter().zip(lengths) {
            if *step != Straight && length > MIN_TURN_RAD {
                let pieces = (length / FRAC_PI_2).ceil().max(1.0);
                let piece = length / pieces;
                let mut left = length;
                let mut at = state;
                while left > 0.5 * piece {
                    corners.push(at.moved(Straight, (0.5 * piece).tan(), radius_m).at());
                    at = at.moved(*step, piece, radius_m);
                    left -= piece;
                }
            }
            state = state.moved(*step, length, radius_m);
        }
        Turns {
            length_m: lengths.iter().sum::<f64>() * radius_m,
            corners,
        }
    }

    /// The state after a length: radii straight on, or radians of a turn.
    fn moved(&self, step: Move, length: f64, radius_m: f64) -> Self {
        let course = self.course_rad;
        let (east, north, turned) = match step {
            Straight => (length * course.cos(), length * course.sin(), 0.0),
            Left => (
                (course + length).sin() - course.sin(),
                course.cos() - (course + length).cos(),
                length,
            ),
            Right => (
                course.sin() - (course - length).sin(),
                (course - length).cos() - course.cos(),
                -length,
            ),
        };
        Self {
            east_m: self.east_m + east * radius_m,
            north_m: self.north_m + north * radius_m,
            course_rad: course + turned,
        }
    }

    /// Distance of the points, and of the courses on a circle of a metre.
    fn misses_m(&self, other: &Self) -> f64 {
        let turn = (self.course_rad - other.course_rad + PI).rem_euclid(TAU) - PI;
        (self.east_m - other.east_m).hypot(self.north_m - other.north_m) + turn.abs()
    }
}

/// Lengths of the moves of a word, in radii and radians; none where there is no such way.
fn lengths(word: &[Move; 3], d: f64, alpha: f64, beta: f64) -> Option<[f64; 3]> {
    let ((sa, ca), (sb, cb)) = (alpha.sin_cos(), beta.sin_cos());
    let cab = (alpha - beta).cos();
    let root = |square: f64| (square >= -1e-12).then(|| square.max(0.0).sqrt());
    let (t, p, q) = match word {
        [Left, Straight, Left] => {
            let p = root(2.0 + d * d - 2.0 * cab + 2.0 * d * (sa - sb))?;
            let at = (cb - ca).atan2(d + sa - sb);
            (at - alpha, p, beta - at)
        }
        [Right, Straight, Right] => {
            let p = root(2.0 + d * d - 2.0 * cab + 2.0 * d * (sb - sa))?;
            let at = (ca - cb).atan2(d - sa + sb);
            (alpha - at, p, at - beta)
        }
        [Left, Straight, Right] => {
            let p = root(d * d - 2.0 + 2.0 * cab + 2.0 * d * (sa + sb))?;
            let at = (-ca - cb).atan2(d + sa + sb) - (-2.0_f64).atan2(p);
            (at - alpha, p, at - beta)
        }
        [Right, Straight, Left] => {
            let p = root(d * d - 2.0 + 2.0 * cab - 2.0 * d * (sa + sb))?;
            let at = (ca + cb).atan2(d - sa - sb) - 2.0_f64.atan2(p);
            (alpha - at, p, beta - at)
        }
        [Right, ..] => {
            let cosine = (6.0 - d * d + 2.0 * cab + 2.0 * d * (sa - sb)) / 8.0;
            let p = TAU - acos(cosine)?;
            let t = alpha - (ca - cb).atan2(d - sa + sb) + 0.5 * p;
            (t, p, alpha - beta - t + p)
        }
        _ => {
            let cosine = (6.0 - d * d + 2.0 * cab + 2.0 * d * (sb - sa)) / 8.0;
            let p = TAU - acos(cosine)?;
            let t = (cb - ca).atan2(d + sa - sb) - alpha + 0.5 * p;
            (t, p, beta - alpha - t + p)
        }
    };
    let p = if word[1] == Straight { p } else { turn(p) };
    Some([turn(t), p, turn(q)])
}

fn acos(cosine: f64) -> Option<f64> {
    (cosine.abs() <= 1.0).then(|| cosine.acos())
}

/// Within one circle; a hair less than a whole one is none.
fn turn(angle_rad: f64) -> f64 {
    const TOLERANCE: f64 = 1e-9;
    let angle_rad = angle_rad.rem_euclid(TAU);
    if angle_rad > TAU - TOLERANCE {
        0.0
    } else {
        angle_rad
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pose(east_m: f64, north_m: f64, heading_deg: f64) -> Pose {
        Pose {
            at: EastNorth { east_m, north_m },
            heading_rad: heading_deg.to_radians(),
        }
    }

    #[test]
    fn straight_on_needs_no_corner_and_a_u_turn_is_half_a_circle() {
        let straight = turns(pose(0.0, 0.0, 90.0), pose(500.0, 0.0, 90.0), 80.0);
        assert!(straight.corners.is_empty());
        assert!((straight.length_m - 500.0).abs() < 1e-6);
        let back = turns(pose(0.0, 0.0, 0.0), pose(160.0, 0.0, 180.0), 80.0);
        assert!((back.length_m - 80.0 * PI).abs() < 1e-6);
        assert_eq!(back.corners.len(), 2, "two right angles");
        assert!(
            back.corners[0].distance_m(EastNorth {
                east_m: 0.0,
                north_m: 80.0
            }) < 1e-6
        );
        assert!(
            back.corners[1].distance_m(EastNorth {
                east_m: 160.0,
                north_m: 80.0
            }) < 1e-6
        );
    }

    #[test]
    fn back_to_the_same_place_on_the_other_course_takes_three_arcs() {
        // Two of 60 degrees and one of 300 (Dubins): 7 pi / 3 radii.
        let around = turns(pose(0.0, 0.0, 0.0), pose(0.0, 0.0, 180.0), 50.0);
        assert!(
            (around.length_m - 50.0 * 7.0 * PI / 3.0).abs() < 1e-6,
            "{around:?}"
        );
    }

    proptest! {
        #[test]
        fn the_rounded_corners_lead_from_pose_to_pose_and_fit_their_legs(
            (east_m, north_m) in (-600.0..600.0_f64, -600.0..600.0_f64),
            (first_deg, last_deg) in (0.0..360.0_f64, 0.0..360.0_f64),
        ) {
            let (radius_m, from, to) = (90.0, pose(0.0, 0.0, first_deg), pose(east_m, north_m, last_deg));
            let way = turns(from, to, radius_m);
            prop_assert!(way.length_m >= east_m.hypot(north_m) - 1e-6);
            let mut points = vec![from.at];
            points.extend(&way.corners);
            points.push(to.at);
            let course = |leg: &[EastNorth]| {
                (leg[1].east_m - leg[0].east_m).atan2(leg[1].north_m - leg[0].north_m)
            };
            let legs: Vec<&[EastNorth]> = points.windows(2).filter(|leg| leg[0].distance_m(leg[1]) > 1e-3).collect();
            let wrap = |angle: f64| (angle + PI).rem_euclid(TAU) - PI;
            if let (Some(first), Some(last)) = (legs.first(), legs.last()) {
                prop_assert!(wrap(course(first) - from.heading_rad).abs() < 2e-3);
                prop_assert!(wrap(course(last) - to.heading_rad).abs() < 2e-3);
            }
            let used = |a: &[EastNorth], b: &[EastNorth]| {
                radius_m * (0.5 * wrap(course(b) - course(a)).abs()).tan()
            };
            for (index, leg) in legs.iter().enumerate() {
                let before = index.checked_sub(1).map_or(0.0, |i| used(legs[i], leg));
                let after = legs.get(index + 1).map_or(0.0, |next| used(leg, next));
                prop_assert!(leg[0].distance_m(leg[1]) - before - after > -0.1);
            }
        }
    }
}

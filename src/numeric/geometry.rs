//! Geometry in the plane: segments, discs, polygons. Points are `[x, y]`.

pub mod cover;
mod offset;
mod ring;

pub use offset::Offset;
pub use ring::{Ring, edge_distance};

/// A point of the plane.
pub type Point = [f64; 2];

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Distance between two points.
#[must_use]
pub fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Whether the box from `low` to `high` misses the box of the segment from `a` to `b`.
#[inline]
pub(crate) fn box_misses((low, high): (Point, Point), (a, b): (Point, Point)) -> bool {
    a[0].max(b[0]) < low[0]
        || a[0].min(b[0]) > high[0]
        || a[1].max(b[1]) < low[1]
        || a[1].min(b[1]) > high[1]
}

/// Distance between a point and the segment from `a` to `b`.
#[must_use]
pub fn point_segment_distance(point: Point, a: Point, b: Point) -> f64 {
    let [x, y] = from_segment(point, (a, b));
    x.hypot(y)
}

/// The way to a point from the nearest of the segment from `a` to `b`.
fn from_segment(point: Point, (a, b): (Point, Point)) -> Point {
    let along = minus(b, a);
    let from = minus(point, a);
    let square = dot(along, along);
    let fraction = if square > 0.0 {
        (dot(from, along) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    [from[0] - fraction * along[0], from[1] - fraction * along[1]]
}

/// The point of the segment from `a` to `b` that is nearest to a point.
fn nearest_on_segment(point: Point, (a, b): (Point, Point)) -> Point {
    let along = minus(b, a);
    let square = dot(along, along);
    let fraction = match square > 0.0 {
        true => (dot(minus(point, a), along) / square).clamp(0.0, 1.0),
        false => 0.0,
    };
    match fraction < 1.0 {
        true => [a[0] + fraction * along[0], a[1] + fraction * along[1]],
        false => b,
    }
}

/// The points at which two segments are nearest to each other, one on each; the same one
/// twice where they cross.
#[must_use]
pub fn closest_points(one: (Point, Point), other: (Point, Point)) -> (Point, Point) {
    let along = minus(one.1, one.0);
    let sides = (
        cross(along, minus(other.0, one.0)),
        cross(along, minus(other.1, one.0)),
    );
    let across = minus(other.1, other.0);
    let ends = (
        cross(across, minus(one.0, other.0)),
        cross(across, minus(one.1, other.0)),
    );
    let differ = |(a, b): (f64, f64)| (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0);
    if differ(sides) && differ(ends) {
        let share = sides.0 / (sides.0 - sides.1);
        let at = [
            other.0[0] + share * across[0],
            other.0[1] + share * across[1],
        ];
        return (at, at);
    }
    let of_other = [other.0, other.1].map(|point| (nearest_on_segment(point, one), point));
    let of_one = [one.0, one.1].map(|point| (point, nearest_on_segment(point, other)));
    let pairs = of_other.into_iter().chain(of_one);
    pairs
        .min_by(|a, b| distance(a.0, a.1).total_cmp(&distance(b.0, b.1)))
        .unwrap_or((one.0, other.0))
}

/// Angle by which the way from `a` over `b` to `c` turns at `b`, radians in
/// `[0, pi]`; 0 when one of the two legs has no length.
#[must_use]
pub fn turn_angle(a: Point, b: Point, c: Point) -> f64 {
    let (into, out) = (minus(b, a), minus(c, b));
    if dot(into, into) <= 0.0 || dot(out, out) <= 0.0 {
        return 0.0;
    }
    cross(into, out).abs().atan2(dot(into, out))
}

/// The part of a segment inside a disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chord {
    /// Length inside as a fraction of the segment.
    pub fraction: f64,
    /// Least distance between segment and centre.
    pub closest: f64,
}

/// Segments whose length squared is no more than this, of a nanometre, are points.
pub const POINT_SQ: f64 = 1e-18;

/// The chord of the segment from `a` to `b` in an open disc; `None` if they do not meet.
#[must_use]
pub fn disc_chord(a: Point, b: Point, center: Point, radius: f64) -> Option<Chord> {
    let along = minus(b, a);
    let from = minus(a, center);
    let square = dot(along, along);
    let outside = dot(from, from) - radius * radius;
    if square <= POINT_SQ {
        return (outside < 0.0).then(|| Chord {
            fraction: 1.0,
            closest: dot(from, from).sqrt(),
        });
    }
    let half = dot(from, along);
    let discriminant = half * half - square * outside;
    if discriminant <= 0.0 {
        return None;
    }
    // The line meets the disc; does it before `a`, or after `b`?
    let past = half + square;
    if (outside >= 0.0 && half >= 0.0) || (outside + (half + past) >= 0.0 && past <= 0.0) {
        return None;
    }
    let root = discriminant.sqrt();
    let per_square = 1.0 / square;
    let enter = ((-half - root) * per_square).max(0.0);
    let leave = ((-half + root) * per_square).min(1.0);
    if leave <= enter {
        return None;
    }
    let nearest = (-half * per_square).clamp(0.0, 1.0);
    let gap = [from[0] + nearest * along[0], from[1] + nearest * along[1]];
    let closest = dot(gap, gap).sqrt();
    Some(Chord {
        fraction: leave - enter,
        closest,
    })
}

/// Twice the area of a polygon, positive if it turns counter-clockwise.
pub(crate) fn doubled_area(corners: &[Point]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| cross(*a, *b)).sum()
}

/// Number of equal steps that a length is cut into: as many as keep each at most `apart`, but within a range.
#[must_use]
pub fn steps(length: f64, apart: f64, (least, most): (u16, u16)) -> u16 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the range"
    )]
    let steps = (length / apart)
        .ceil()
        .clamp(f64::from(least), f64::from(most)) as u16;
    steps
}

#[cfg(test)]
mod tests {
    use super::{Point, Ring, disc_chord, point_segment_distance, turn_angle};
    use proptest::prelude::*;

    pub(super) const STEPS: u32 = 4000;

    /// Midpoints of many equal parts of a segment.
    pub(super) fn along(a: Point, b: Point) -> impl Iterator<Item = Point> {
        (0..STEPS).map(move |i| {
            let share = (f64::from(i) + 0.5) / f64::from(STEPS);
            [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]
        })
    }

    fn distance(a: Point, b: Point) -> f64 {
        (a[0] - b[0]).hypot(a[1] - b[1])
    }

    pub(super) fn share(count: usize) -> f64 {
        f64::from(u32::try_from(count).unwrap()) / f64::from(STEPS)
    }

    pub(super) fn point() -> impl Strategy<Value = Point> {
        [-10.0..10.0_f64, -10.0..10.0_f64]
    }

    /// A star-shaped polygon around the origin: simple, mostly concave.
    pub(super) fn star() -> impl Strategy<Value = Vec<Point>> {
        prop::collection::vec(2.0..9.0_f64, 3..12).prop_map(|reaches| {
            let count = f64::from(u32::try_from(reaches.len()).unwrap());
            (0_u32..)
                .zip(reaches)
                .map(|(i, reach)| {
                    let (sin, cos) = (f64::from(i) / count * std::f64::consts::TAU).sin_cos();
                    [reach * cos, reach * sin]
                })
                .collect()
        })
    }

    proptest! {
        #[test]
        fn a_chord_is_what_dense_points_say(a in point(), b in point(), center in point(), radius in 0.5..8.0_f64) {
            let inside = along(a, b).filter(|p| distance(*p, center) < radius).count();
            let closest = along(a, b).map(|p| distance(p, center)).fold(f64::INFINITY, f64::min);
            match disc_chord(a, b, center, radius) {
                Some(chord) => {
                    prop_assert!((chord.fraction - share(inside)).abs() < 2.0 / f64::from(STEPS));
                    prop_assert!((chord.closest - closest).abs() < 0.01);
                    prop_assert!(chord.closest < radius);
                }
                None => prop_assert!(inside <= 1),
            }
            prop_assert!((point_segment_distance(center, a, b) - closest).abs() < 0.01);
        }

        #[test]
        fn the_length_in_a_concave_polygon_is_what_dense_points_say(corners in star(), a in point(), b in point()) {
            let ring = Ring::new(&corners);
            let inside = along(a, b).filter(|p| ring.contains(*p)).count();
            let exact = ring.inside_fraction((a, b), (0.0, 1.0), &mut Vec::new());
            let crossings = f64::from(u32::try_from(corners.len()).unwrap());
            prop_assert!((exact - share(inside)).abs() <= crossings / f64::from(STEPS), "{exact} {}", share(inside));
            // Two halves make the whole, and the order of corners does not matter.
            let first = ring.inside_fraction((a, b), (0.0, 0.3), &mut Vec::new());
            let second = ring.inside_fraction((a, b), (0.3, 1.0), &mut Vec::new());
            prop_assert!((first + second - exact).abs() < 1e-12);
            let turned: Vec<Point> = corners.iter().rev().copied().collect();
            let other = Ring::new(&turned).inside_fraction((a, b), (0.0, 1.0), &mut Vec::new());
            prop_assert!((other - exact).abs() < 1e-9);
        }

        #[test]
        fn an_outset_polygon_holds_what_is_within_the_distance_and_little_more(
            corners in star(), distance in 0.1..1.0_f64, p in point()
        ) {
            let ring = Ring::new(&corners);
            let outset = ring.outset(distance);
            let near = ring.boundary_distance(p);
            if ring.contains(p) || near < 0.999 * distance {
                prop_assert!(outset.contains(p), "{p:?} is {near} away");
            }
            if outset.contains(p) && !ring.contains(p) {
                prop_assert!(near < 2.001 * distance, "{p:?} is {near} away");
            }
        }
    }

    #[test]
    fn an_inset_square_keeps_the_distance_and_a_small_one_has_none() {
        let square = Ring::new(&[[0.0, 0.0], [8.0, 0.0], [8.0, 3.0], [8.0, 6.0], [0.0, 6.0]]);
        let inset = square.inset(1.0).expect("large enough");
        assert_eq!(inset.bounds(), ([1.0, 1.0], [7.0, 5.0]));
        for corner in inset.corners() {
            assert!((square.boundary_distance(*corner) - 1.0).abs() < 1e-12);
        }
        assert_eq!(square.inset(3.1), None);
    }

    #[test]
    fn a_segment_along_an_edge_and_one_through_a_corner_are_no_surprise() {
        let square = Ring::new(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [0.0, 0.0]]);
        let inside = |a, b| square.inside_fraction((a, b), (0.0, 1.0), &mut Vec::new());
        assert!((inside([-1.0, -1.0], [3.0, 3.0]) - 0.5).abs() < 1e-12);
        assert!(inside([-1.0, 1.0], [1.0, 3.0]) < 1e-12);
        let along_edge = inside([-1.0, 0.0], [3.0, 0.0]);
        assert!(along_edge < 1e-12 || (along_edge - 0.5).abs() < 1e-12);
        assert!((inside([1.0, 1.0], [1.0, 1.0]) - 1.0).abs() < 1e-12);
        assert!(inside([5.0, 1.0], [5.0, 1.0]) < 1e-12);
    }

    #[test]
    fn turns_are_measured_from_straight_on() {
        let degrees = |c| turn_angle([0.0, 0.0], [1.0, 0.0], c).to_degrees();
        assert!(degrees([2.0, 0.0]) < 1e-12);
        assert!((degrees([1.0, 5.0]) - 90.0).abs() < 1e-12);
        assert!((degrees([0.0, 0.0]) - 180.0).abs() < 1e-12);
        assert!(degrees([1.0, 0.0]) < 1e-12);
    }
}

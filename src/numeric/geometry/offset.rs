//! A polygon with everything within a distance of it.

use super::{Point, Ring, box_misses, cross, dot, minus, point_segment_distance};

/// All points in a polygon or within a distance of it: corners become arcs. Exact.
#[derive(Clone, Debug, PartialEq)]
pub struct Offset {
    ring: Ring,
    distance: f64,
    low: Point,
    high: Point,
}

impl Offset {
    /// A polygon that does not cross itself, and a distance that is not negative.
    #[must_use]
    pub fn new(ring: Ring, distance: f64) -> Self {
        let (low, high) = ring.bounds();
        Self {
            low: low.map(|least| least - distance),
            high: high.map(|most| most + distance),
            ring,
            distance,
        }
    }

    /// Least and greatest coordinates.
    #[must_use]
    pub fn bounds(&self) -> (Point, Point) {
        (self.low, self.high)
    }

    /// Whether the box of the segment from `a` to `b` misses the box of the offset polygon.
    #[must_use]
    pub fn is_far_from(&self, a: Point, b: Point) -> bool {
        box_misses((self.low, self.high), (a, b))
    }

    /// Whether a point lies in the polygon or nearer to it than the distance.
    #[must_use]
    pub fn contains(&self, point: Point) -> bool {
        let mut edges = self.ring.edges();
        self.ring.contains(point)
            || edges.any(|(a, b)| point_segment_distance(point, a, b) < self.distance)
    }

    /// How much of the segment from `a` to `b` lies inside, counting only its part between the
    /// fractions `from` and `to`; a fraction of the whole. `crossings` is scratch space.
    #[must_use]
    pub fn inside_fraction(
        &self,
        (a, b): (Point, Point),
        (from, to): (f64, f64),
        crossings: &mut Vec<(f64, i32)>,
    ) -> f64 {
        let along = minus(b, a);
        if dot(along, along) <= 0.0 {
            return if self.contains(a) { to - from } else { 0.0 };
        }
        crossings.clear();
        self.ring.cross_line((a, b), crossings);
        if self.distance > 0.0 {
            for edge in self.ring.edges() {
                self.cross_edge((a, b), edge, crossings);
            }
        }
        Ring::positive_fraction((from, to), crossings)
    }

    /// Where the line through `a` and `b` enters and leaves the disc around the begin of an edge
    /// and the rectangle around the edge. What cannot meet the segment itself is left out.
    fn cross_edge(
        &self,
        (a, b): (Point, Point),
        (p, q): (Point, Point),
        crossings: &mut Vec<(f64, i32)>,
    ) {
        let reach = self.distance;
        let misses = |axis: usize| {
            a[axis].max(b[axis]) < p[axis].min(q[axis]) - reach
                || a[axis].min(b[axis]) > p[axis].max(q[axis]) + reach
        };
        if misses(0) || misses(1) {
            return;
        }
        let mut add = |within: Option<(f64, f64)>| {
            if let Some((enters, leaves)) = within {
                crossings.push((enters, 1));
                crossings.push((leaves, -1));
            }
        };
        // Every corner is the begin of one edge, but that one may lie apart from the segment.
        add(disc_interval((a, b), p, reach));
        add(disc_interval((a, b), q, reach));
        add(rectangle_interval((a, b), (p, q), reach));
    }
}

/// Where the line through two points is within a disc, as fractions of the way from the first.
fn disc_interval((a, b): (Point, Point), center: Point, radius: f64) -> Option<(f64, f64)> {
    let (along, from) = (minus(b, a), minus(a, center));
    let (square, half) = (dot(along, along), dot(from, along));
    let discriminant = half * half - square * (dot(from, from) - radius * radius);
    (discriminant > 0.0).then(|| {
        let root = discriminant.sqrt();
        ((-half - root) / square, (-half + root) / square)
    })
}

/// Where the line through two points is within a distance of an edge, between its ends.
fn rectangle_interval(
    (a, b): (Point, Point),
    (p, q): (Point, Point),
    reach: f64,
) -> Option<(f64, f64)> {
    let (edge, along, from) = (minus(q, p), minus(b, a), minus(a, p));
    let square = dot(edge, edge);
    let width = reach * square.sqrt();
    // Along the edge and across it, both times its length.
    let axes = [
        (dot(from, edge), dot(along, edge), (0.0, square)),
        (cross(edge, from), cross(edge, along), (-width, width)),
    ];
    let (mut enters, mut leaves) = (f64::NEG_INFINITY, f64::INFINITY);
    for (at, step, (low, high)) in axes {
        if step.abs() > 0.0 {
            let (one, other) = ((low - at) / step, (high - at) / step);
            enters = enters.max(one.min(other));
            leaves = leaves.min(one.max(other));
        } else if at < low || at > high {
            return None;
        }
    }
    (enters < leaves && enters.is_finite() && leaves.is_finite()).then_some((enters, leaves))
}

#[cfg(test)]
mod tests {
    use super::super::tests::{STEPS, along, point, share, star};
    use super::{Offset, Ring};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_length_near_a_polygon_is_what_dense_points_say(
            corners in star(), distance in 0.0..3.0_f64, a in point(), b in point()
        ) {
            let ring = Ring::new(&corners);
            let offset = Offset::new(ring.clone(), distance);
            let is_near = |p: &[f64; 2]| ring.contains(*p) || ring.boundary_distance(*p) < distance;
            let near = along(a, b).filter(is_near).count();
            let exact = offset.inside_fraction((a, b), (0.0, 1.0), &mut Vec::new());
            let crossings = 3.0 * f64::from(u32::try_from(corners.len()).unwrap());
            prop_assert!((exact - share(near)).abs() <= crossings / f64::from(STEPS), "{exact} {}", share(near));
            let first = offset.inside_fraction((a, b), (0.0, 0.3), &mut Vec::new());
            let second = offset.inside_fraction((a, b), (0.3, 1.0), &mut Vec::new());
            prop_assert!((first + second - exact).abs() < 1e-12);
            prop_assert_eq!(offset.contains(a), is_near(&a));
            if offset.is_far_from(a, b) {
                prop_assert!(exact <= 0.0);
            }
        }

        #[test]
        fn without_a_distance_it_is_the_polygon_to_the_bit(corners in star(), a in point(), b in point()) {
            let ring = Ring::new(&corners);
            let plain = ring.inside_fraction((a, b), (0.0, 1.0), &mut Vec::new());
            let offset = Offset::new(ring, 0.0).inside_fraction((a, b), (0.0, 1.0), &mut Vec::new());
            prop_assert_eq!(offset.to_bits(), plain.to_bits());
        }
    }
}

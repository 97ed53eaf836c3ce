//! Polygons.

use super::{Point, box_misses, cross, dot, doubled_area, from_segment, minus};

/// A closed polygon, possibly concave, turned counter-clockwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Ring {
    corners: Vec<Point>,
    low: Point,
    high: Point,
}

impl Ring {
    /// The polygon of these corners; a last corner equal to the first is dropped.
    #[must_use]
    pub fn new(corners: &[Point]) -> Self {
        let mut corners = corners.to_vec();
        corners.dedup();
        if corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        if doubled_area(&corners) < 0.0 {
            corners.reverse();
        }
        let bound = |axis: usize, pick: fn(f64, f64) -> f64, start: f64| {
            corners
                .iter()
                .fold(start, |value, corner| pick(value, corner[axis]))
        };
        let (least, most) = (f64::INFINITY, f64::NEG_INFINITY);
        Self {
            low: [bound(0, f64::min, least), bound(1, f64::min, least)],
            high: [bound(0, f64::max, most), bound(1, f64::max, most)],
            corners,
        }
    }

    /// The outer boundary of a polygon, `x` and `y` as they are.
    #[must_use]
    pub fn around(polygon: &geo::Polygon<f64>) -> Self {
        let corners = polygon.exterior().coords();
        let corners: Vec<Point> = corners.map(|corner| [corner.x, corner.y]).collect();
        Self::new(&corners)
    }

    /// Corners, counter-clockwise, the first not repeated.
    #[must_use]
    pub fn corners(&self) -> &[Point] {
        &self.corners
    }

    /// Least and greatest coordinates.
    #[must_use]
    pub fn bounds(&self) -> (Point, Point) {
        (self.low, self.high)
    }

    /// Whether the box of the segment from `a` to `b` misses the box of the polygon.
    #[must_use]
    pub fn is_far_from(&self, a: Point, b: Point) -> bool {
        box_misses((self.low, self.high), (a, b))
    }

    /// The edges, counter-clockwise.
    pub fn edges(&self) -> impl Iterator<Item = (Point, Point)> {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().copied().zip(next.copied())
    }

    /// Whether a point lies inside.
    #[must_use]
    pub fn contains(&self, point: Point) -> bool {
        let winding: i32 = self
            .edges()
            .filter(|(a, b)| (a[1] > point[1]) != (b[1] > point[1]))
            .map(|(a, b)| {
                let left = cross(minus(b, a), minus(point, a)) > 0.0;
                match (b[1] > a[1], left) {
                    (true, true) => 1,
                    (false, false) => -1,
                    _ => 0,
                }
            })
            .sum();
        winding > 0
    }

    /// Distance between a point and the boundary.
    #[must_use]
    pub fn boundary_distance(&self, point: Point) -> f64 {
        edge_distance(point, self.edges())
    }

    /// How much of the segment from `a` to `b` lies inside, counting only its
    /// part between the fractions `from` and `to`; a fraction of the whole.
    ///
    /// Exact: follows the winding number along the line through the segment,
    /// from far away where it is 0. `crossings` is scratch space.
    #[must_use]
    pub fn inside_fraction(
        &self,
        (a, b): (Point, Point),
        (from, to): (f64, f64),
        crossings: &mut Vec<(f64, i32)>,
    ) -> f64 {
        let along = minus(b, a);
        let square = dot(along, along);
        if square <= 0.0 {
            return if self.contains(a) { to - from } else { 0.0 };
        }
        crossings.clear();
        self.cross_line((a, b), crossings);
        Self::positive_fraction((from, to), crossings)
    }

    /// Adds where the line through `a` and `b` crosses the boundary, as fractions of the way
    /// from `a`, and by how much the winding number grows there.
    pub(super) fn cross_line(&self, (a, b): (Point, Point), crossings: &mut Vec<(f64, i32)>) {
        let along = minus(b, a);
        let square = dot(along, along);
        for (p, q) in self.edges() {
            let (side_p, side_q) = (cross(along, minus(p, a)), cross(along, minus(q, a)));
            if (side_p >= 0.0) == (side_q >= 0.0) {
                continue;
            }
            let share = side_p / (side_p - side_q);
            let at = [p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])];
            // Counter-clockwise: an edge that goes from left to right is entered across.
            let turn = if side_p >= 0.0 { 1 } else { -1 };
            crossings.push((dot(minus(at, a), along) / square, turn));
        }
    }

    /// How much between two fractions has a positive sum of the turns before it.
    pub(super) fn positive_fraction((from, to): (f64, f64), crossings: &mut [(f64, i32)]) -> f64 {
        crossings.sort_unstable_by(|x, y| x.0.total_cmp(&y.0));
        let (mut inside, mut winding, mut entered) = (0.0, 0, 0.0);
        for &(at, turn) in crossings.iter() {
            let was_inside = winding > 0;
            winding += turn;
            if was_inside && winding <= 0 {
                inside += at.clamp(from, to) - entered;
            } else if !was_inside && winding > 0 {
                entered = at.clamp(from, to);
            }
        }
        inside
    }

    /// The polygon with every edge moved inward by `distance`; `None` where nothing is left of a
    /// convex one, or where so much is cut off that edges vanish.
    #[must_use]
    pub fn inset(&self, distance: f64) -> Option<Self> {
        if distance <= 0.0 {
            return Some(self.clone());
        }
        let inner = Self {
            corners: self.mitred(-distance),
            ..self.clone()
        };
        let inner_edges = inner.edges();
        let keeps_course = |((a, b), (p, q)): ((Point, Point), (Point, Point))| {
            dot(minus(b, a), minus(q, p)) > 0.0
        };
        let is_whole = self.edges().zip(inner_edges).all(keeps_course);
        is_whole.then(|| Self::new(&inner.corners))
    }

    /// The corners with every edge moved outward by `distance` (inward if negative): none of
    /// them may turn back.
    fn mitred(&self, distance: f64) -> Vec<Point> {
        let normals = self.normals();
        let before = normals.iter().cycle().skip(normals.len().saturating_sub(1));
        let pairs = before.zip(&normals).zip(&self.corners);
        pairs
            .map(|((into, out), corner)| {
                let by = distance / (1.0 + dot(*into, *out));
                [
                    corner[0] + by * (into[0] + out[0]),
                    corner[1] + by * (into[1] + out[1]),
                ]
            })
            .collect()
    }

    /// The outward unit normals of the edges.
    fn normals(&self) -> Vec<Point> {
        self.edges()
            .map(|(a, b)| {
                let along = minus(b, a);
                let length = dot(along, along).sqrt();
                [along[1] / length, -along[0] / length]
            })
            .collect()
    }

    /// The polygon with every edge moved outward by `distance`, corners mitred
    /// to at most twice that. Where the moved edges cross, the winding number
    /// of what is turned inside out is not positive, so it does not count as inside.
    #[must_use]
    pub fn outset(&self, distance: f64) -> Self {
        if distance <= 0.0 || self.corners.len() < 3 {
            return self.clone();
        }
        let normals = self.normals();
        let before = normals.iter().cycle().skip(normals.len() - 1);
        let mut moved = Vec::with_capacity(2 * self.corners.len());
        for ((corner, into), out) in self.corners.iter().zip(before).zip(&normals) {
            let shift =
                |normal: Point, by: f64| [corner[0] + by * normal[0], corner[1] + by * normal[1]];
            let cosine = dot(*into, *out);
            let middle = [into[0] + out[0], into[1] + out[1]];
            // |middle|^2 = 2 + 2 cos; the mitre is middle * distance / (1 + cos).
            if cosine >= -0.5 {
                moved.push(shift(middle, distance / (1.0 + cosine)));
            } else {
                // A spike: cut it square, one distance beyond the corner.
                let tip = [-into[1] * distance, into[0] * distance];
                let back = [out[1] * distance, -out[0] * distance];
                let (left, right) = (shift(*into, distance), shift(*out, distance));
                moved.push([left[0] + tip[0], left[1] + tip[1]]);
                moved.push([right[0] + back[0], right[1] + back[1]]);
            }
        }
        let mut ring = Self::new(&moved);
        // `new` would turn a ring around whose inverted loops outweigh it: keep the order.
        if doubled_area(&moved) < 0.0 {
            ring.corners.reverse();
        }
        ring
    }
}

/// Distance between a point and the nearest of some edges; infinite of none.
#[must_use]
pub fn edge_distance(point: Point, edges: impl Iterator<Item = (Point, Point)>) -> f64 {
    /// Squares are rounded otherwise than distances: those so near to the least are compared as these.
    const ROUNDED: f64 = 1.0 + 1e-9;
    let (mut least, mut max_square) = (f64::INFINITY, f64::INFINITY);
    for edge in edges {
        let [x, y] = from_segment(point, edge);
        if x * x + y * y <= max_square {
            least = x.hypot(y).min(least);
            max_square = ROUNDED * least * least;
        }
    }
    least
}

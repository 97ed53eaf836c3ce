//! Simpler shapes that cover a polygon: a circle, its convex hull, fewer corners.

use super::{Point, closest_points, cross, distance, dot, minus};

/// Steps towards the middle of the enclosing circle.
const CIRCLE_STEPS: u32 = 200;
/// A moved corner is at most this often the greatest extent of the polygon away from its edge.
const MAX_REACH: f64 = 1.0;

/// A circle around points, at most a hundredth wider than the least one: centre and radius.
#[must_use]
pub fn enclosing_circle(points: &[Point]) -> (Point, f64) {
    let mut center = points.first().copied().unwrap_or_default();
    let furthest = |center: Point| {
        let square = |point: &Point| {
            let away = minus(*point, center);
            dot(away, away)
        };
        let squares = points.iter().map(|point| (square(point), point));
        squares
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, point)| point)
    };
    // Badoiu and Clarkson 2003: 1/n of the way to the furthest point, n times.
    for step in 1..=CIRCLE_STEPS {
        let Some(far) = furthest(center) else { break };
        let share = 1.0 / f64::from(step + 1);
        let away = minus(*far, center);
        center = [center[0] + share * away[0], center[1] + share * away[1]];
    }
    let radius = furthest(center).map_or(0.0, |far| distance(center, *far));
    (center, radius)
}

/// The convex hull of points, counter-clockwise, without points on its edges.
#[must_use]
pub fn convex_hull(points: &[Point]) -> Vec<Point> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let half = |points: &mut dyn Iterator<Item = Point>| {
        let mut chain: Vec<Point> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..] {
                if cross(minus(b, a), minus(point, b)) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut hull = half(&mut sorted.iter().copied());
    hull.extend(half(&mut sorted.iter().rev().copied()));
    hull
}

/// Whether a point is in a polygon, by the even-odd rule.
#[must_use]
pub fn is_inside(corners: &[Point], at: Point) -> bool {
    edges(corners).fold(false, |inside, (a, b)| {
        let spans = (a[1] > at[1]) != (b[1] > at[1]);
        let left = spans && at[0] < a[0] + (b[0] - a[0]) * (at[1] - a[1]) / (b[1] - a[1]);
        inside != left
    })
}

/// Least distance between a polygon and a segment, 0 where they meet.
#[must_use]
pub fn distance_to_segment(corners: &[Point], (a, b): (Point, Point)) -> f64 {
    if is_inside(corners, a) {
        return 0.0;
    }
    edges(corners)
        .map(|edge| {
            let (on, other) = closest_points(edge, (a, b));
            distance(on, other)
        })
        .fold(f64::INFINITY, f64::min)
}

/// Least distance between two polygons, 0 where they meet.
#[must_use]
pub fn distance_between(one: &[Point], other: &[Point]) -> f64 {
    if one.first().is_some_and(|&corner| is_inside(other, corner)) {
        return 0.0;
    }
    let gaps = edges(other).map(|edge| distance_to_segment(one, edge));
    gaps.fold(f64::INFINITY, f64::min)
}

/// Twice the area of a polygon, positive if it is counter-clockwise.
#[must_use]
pub fn twice_area(corners: &[Point]) -> f64 {
    edges(corners).map(|(a, b)| cross(a, b)).sum()
}

/// A polygon (counter-clockwise) that covers another with fewer corners, at least `least`.
///
/// Each step takes the corner away that adds the least area: one that points inward, or two of an
/// outward edge for where its neighbours meet. `may_add` says whether the triangle that is added
/// may belong to the polygon. Ends where nothing may be added.
#[must_use]
pub fn widened(
    corners: &[Point],
    least: usize,
    may_add: &dyn Fn(&[Point; 3]) -> bool,
) -> Vec<Point> {
    let mut ring = corners.to_vec();
    let (low, high) = ring.iter().fold(
        ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]),
        |(low, high): (Point, Point), p| {
            (
                [low[0].min(p[0]), low[1].min(p[1])],
                [high[0].max(p[0]), high[1].max(p[1])],
            )
        },
    );
    let reach = MAX_REACH * distance(low, high);
    while ring.len() > least.max(3) {
        let mut steps: Vec<Step> = (0..ring.len())
            .flat_map(|at| [inward(&ring, at), outward(&ring, at, reach)])
            .flatten()
            .collect();
        steps.sort_by(|a, b| a.area.total_cmp(&b.area).then(a.at.cmp(&b.at)));
        let is_good = |step: &&Step| may_add(&step.added) && stays_simple(&ring, step);
        let Some(step) = steps.iter().find(is_good) else {
            break;
        };
        ring = step.taken(&ring);
    }
    ring
}

/// A way to take one corner away.
struct Step {
    at: usize,
    /// The new corner for this one and the next; none: this one only goes.
    corner: Option<Point>,
    added: [Point; 3],
    area: f64,
}

impl Step {
    fn taken(&self, ring: &[Point]) -> Vec<Point> {
        let next = (self.at + 1) % ring.len();
        let corners = ring.iter().enumerate();
        corners
            .filter_map(|(index, corner)| match self.corner {
                Some(_) if index == next => None,
                new if index == self.at => new,
                _ => Some(*corner),
            })
            .collect()
    }
}

/// Takes away a corner that points inward, or lies on the line of its neighbours.
fn inward(ring: &[Point], at: usize) -> Option<Step> {
    let count = ring.len();
    let (a, b, c) = (
        ring[(at + count - 1) % count],
        ring[at],
        ring[(at + 1) % count],
    );
    let twice = cross(minus(b, a), minus(c, b));
    (twice <= 0.0).then(|| Step {
        at,
        corner: None,
        added: [a, c, b],
        area: -twice,
    })
}

/// Takes away an edge whose neighbours meet beyond it.
fn outward(ring: &[Point], at: usize, reach: f64) -> Option<Step> {
    let count = ring.len();
    let corner = |by: usize| ring[(at + by) % count];
    let (a, b, c, d) = (corner(count - 1), corner(0), corner(1), corner(2));
    let (into, along, back) = (minus(b, a), minus(c, b), minus(c, d));
    // Both corners turn left, together by less than half a turn.
    let turn = cross(into, minus(d, c));
    if cross(into, along) <= 0.0 || cross(along, minus(d, c)) <= 0.0 || turn <= 0.0 {
        return None;
    }
    let ahead = cross(along, back) / cross(into, back);
    if !(ahead.is_finite() && ahead > 0.0) {
        return None;
    }
    let tip = [b[0] + ahead * into[0], b[1] + ahead * into[1]];
    let is_near = distance(tip, b).max(distance(tip, c)) <= reach;
    (is_near && dot(minus(tip, c), back) >= 0.0).then(|| Step {
        at,
        corner: Some(tip),
        added: [b, tip, c],
        area: cross(minus(tip, b), minus(c, tip)).abs(),
    })
}

/// Whether no other part of the ring reaches into what a step adds.
fn stays_simple(ring: &[Point], step: &Step) -> bool {
    let added = &step.added;
    let is_corner = |point: &Point| added.contains(point);
    let others = ring.iter().filter(|point| !is_corner(point));
    let mut clear = others.clone().all(|point| !is_inside(added, *point));
    let new_edges = match step.corner {
        Some(tip) => vec![(added[0], tip), (tip, added[2])],
        None => vec![(added[0], added[1])],
    };
    for (p, q) in edges(ring) {
        let crosses = |&(a, b): &(Point, Point)| {
            let side = |from, to, at| cross(minus(to, from), minus(at, from));
            side(a, b, p) * side(a, b, q) < 0.0 && side(p, q, a) * side(p, q, b) < 0.0
        };
        clear &= !new_edges.iter().any(crosses);
    }
    clear
}

fn edges(corners: &[Point]) -> impl Iterator<Item = (Point, Point)> + '_ {
    let next = corners.iter().cycle().skip(1);
    corners.iter().copied().zip(next.copied())
}

#[cfg(test)]
mod tests {
    use super::super::tests::star;
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_widened_polygon_covers_the_one_that_it_was(corners in star(), least in 3_usize..8) {
            let mut corners = corners;
            if twice_area(&corners) < 0.0 {
                corners.reverse();
            }
            let wide = widened(&corners, least, &|_| true);
            prop_assert!(wide.len() <= corners.len() && wide.len() >= 3);
            prop_assert!(twice_area(&wide) >= twice_area(&corners) - 1e-9);
            for (a, b) in edges(&corners) {
                for share in [0.0, 0.3, 0.7] {
                    let at = [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
                    let off = distance_to_segment(&wide, (at, at));
                    prop_assert!(off < 1e-6, "{at:?} {off}");
                }
            }
        }

        #[test]
        fn the_circle_and_the_hull_hold_every_point(corners in star()) {
            let (center, radius) = enclosing_circle(&corners);
            let hull = convex_hull(&corners);
            for corner in &corners {
                prop_assert!(distance(center, *corner) <= radius + 1e-9);
                prop_assert!(distance_to_segment(&hull, (*corner, *corner)) < 1e-9);
            }
        }
    }

    #[test]
    fn nothing_is_added_where_it_may_not_be() {
        let u = [
            [0.0, 0.0],
            [9.0, 0.0],
            [9.0, 9.0],
            [6.0, 9.0],
            [6.0, 3.0],
            [3.0, 3.0],
            [3.0, 9.0],
            [0.0, 9.0],
        ];
        assert!(widened(&u, 3, &|_| true).len() <= 4);
        assert_eq!(widened(&u, 3, &|_| false), u);
        // A place between the arms stays outside.
        let outside: Point = [4.5, 8.5];
        let wide = widened(&u, 3, &|added| {
            distance_to_segment(added, (outside, outside)) > 0.5
        });
        assert!(
            wide.len() < u.len() && !is_inside(&wide, outside),
            "{wide:?}"
        );
    }
}

//! What is seen of an edge from a corner, and which way around a corner can be shortest.

use super::mesh::{FreeSpace, NONE, left_of};
use crate::numeric::geometry::{Point, distance};

/// A part of an edge that is seen from a root, about to be crossed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    /// The corner that the path comes from in a straight line.
    pub(super) root: usize,
    /// The triangle behind the edge, and the first corner of the edge in it.
    pub(super) triangle: usize,
    pub(super) side: usize,
    /// The corners that bound the sight, seen from the root.
    pub(super) left: usize,
    pub(super) right: usize,
}

impl FreeSpace {
    /// The interval beyond a side of a triangle.
    pub(super) fn through(
        &self,
        (triangle, side): (usize, usize),
        root: usize,
        (left, right): (usize, usize),
    ) -> Option<Interval> {
        let next = self.beyond[triangle][side];
        if next == NONE {
            return None;
        }
        let from = self.triangles[triangle][(side + 1) % 3];
        let side = (0..3).find(|&at| self.triangles[next][at] == from)?;
        Some(Interval {
            root,
            triangle: next,
            side,
            left,
            right,
        })
    }

    /// The corner that is seen behind an interval, if it is, and the intervals beyond.
    pub(super) fn behind(&self, interval: &Interval) -> (Option<usize>, [Option<Interval>; 2]) {
        let &Interval {
            root,
            triangle,
            side,
            left,
            right,
        } = interval;
        let apex = self.triangles[triangle][(side + 2) % 3];
        let at = |node: usize| self.nodes[node];
        let from_left = left_of(at(root), at(left), at(apex));
        let from_right = left_of(at(root), at(right), at(apex));
        let sides = [(triangle, (side + 2) % 3), (triangle, (side + 1) % 3)];
        if from_left > 0.0 {
            return (None, [None, self.through(sides[1], root, (left, right))]);
        }
        if from_right < 0.0 {
            return (None, [self.through(sides[0], root, (left, right)), None]);
        }
        let part = |opens: bool, side, sight| {
            if opens {
                self.through(side, root, sight)
            } else {
                None
            }
        };
        let parts = [
            part(from_left < 0.0, sides[0], (left, apex)),
            part(from_right > 0.0, sides[1], (apex, right)),
        ];
        (Some(apex), parts)
    }

    /// At most the length of any path from the root through the interval to `goal`.
    pub(super) fn min_m(&self, interval: &Interval, goal: Point) -> f64 {
        let corners = self.triangles[interval.triangle];
        let (a, b) = (corners[interval.side], corners[(interval.side + 1) % 3]);
        let root = self.nodes[interval.root];
        let (a_at, b_at) = (self.nodes[a], self.nodes[b]);
        let end = |bound: usize, own: usize, own_at: Point| {
            if bound == own {
                return own_at;
            }
            let bound = self.nodes[bound];
            let (of_a, of_b) = (left_of(root, bound, a_at), left_of(root, bound, b_at));
            let share = of_a / (of_a - of_b);
            if share.is_finite() {
                let share = share.clamp(0.0, 1.0);
                [0, 1].map(|axis| a_at[axis] + share * (b_at[axis] - a_at[axis]))
            } else {
                own_at
            }
        };
        let (left, right) = (end(interval.left, a, a_at), end(interval.right, b, b_at));
        let goal = match left_of(a_at, b_at, goal) < 0.0 {
            true => mirrored(a_at, b_at, goal),
            false => goal,
        };
        if left_of(root, left, goal) > 0.0 {
            distance(root, left) + distance(left, goal)
        } else if left_of(root, right, goal) < 0.0 {
            distance(root, right) + distance(right, goal)
        } else {
            distance(root, goal)
        }
    }
}

/// A point on the other side of a line.
fn mirrored(a: Point, b: Point, point: Point) -> Point {
    let along = [b[0] - a[0], b[1] - a[1]];
    let to = [point[0] - a[0], point[1] - a[1]];
    let square = along[0] * along[0] + along[1] * along[1];
    let share = 2.0 * (to[0] * along[0] + to[1] * along[1]) / square;
    [0, 1].map(|axis| a[axis] + share * along[axis] - to[axis])
}

/// The free triangles around a corner from one border to the next, counter-clockwise.
#[derive(Clone, Debug, Default)]
pub(super) struct Sector {
    /// The triangles, and which of their corners it is.
    pub(super) triangles: Vec<(usize, usize)>,
    /// The other corners: one more than triangles.
    pub(super) rim: Vec<usize>,
}

impl FreeSpace {
    /// The sectors of every node around which a path can bend: those of more than half a circle.
    pub(super) fn sectors(&self) -> Vec<Vec<Sector>> {
        let mut all = vec![Vec::new(); self.nodes.len()];
        for (triangle, corners) in self.triangles.iter().enumerate() {
            for (side, &node) in corners.iter().enumerate() {
                // A sector begins where the side from the node is a border.
                if self.beyond[triangle][side] == NONE {
                    let sector = self.sector(node, (triangle, side));
                    if self.is_bend(node, &sector) {
                        all[node].push(sector);
                    }
                }
            }
        }
        all
    }

    /// The triangles from one on counter-clockwise around a node, to the next border.
    fn sector(&self, node: usize, first: (usize, usize)) -> Sector {
        let mut sector = Sector::default();
        let (mut triangle, mut side) = first;
        sector.rim.push(self.triangles[triangle][(side + 1) % 3]);
        loop {
            sector.triangles.push((triangle, side));
            sector.rim.push(self.triangles[triangle][(side + 2) % 3]);
            let next = self.beyond[triangle][(side + 2) % 3];
            if next == NONE || sector.triangles.len() > self.triangles.len() {
                return sector;
            }
            let Some(at) = (0..3).find(|&at| self.triangles[next][at] == node) else {
                return sector;
            };
            (triangle, side) = (next, at);
        }
    }

    /// Whether a sector is wider than half a circle.
    fn is_bend(&self, node: usize, sector: &Sector) -> bool {
        let at = |node: usize| self.nodes[node];
        let first = at(sector.rim[0]);
        // Once the rim has passed the line beyond the first border.
        sector.rim[1..].windows(2).any(|pair| {
            left_of(first, at(node), at(pair[0])) <= 0.0
                && left_of(first, at(node), at(pair[1])) > 0.0
        })
    }

    /// The triangles of a sector that a shortest path from `before` through the corner may enter:
    /// those beyond its straight line, on the side of the obstacle.
    pub(super) fn taut(&self, before: usize, node: usize, sector: &Sector) -> Vec<(usize, usize)> {
        let at = |node: usize| self.nodes[node];
        let holds = |pair: &[usize]| {
            left_of(at(node), at(pair[0]), at(before)) >= 0.0
                && left_of(at(node), at(pair[1]), at(before)) <= 0.0
        };
        let mut taut = vec![false; sector.triangles.len()];
        for came in (0..taut.len()).filter(|&at| holds(&sector.rim[at..at + 2])) {
            for (index, taut) in taut.iter_mut().enumerate() {
                let (low, high) = (sector.rim[index], sector.rim[index + 1]);
                *taut |= index < came && left_of(at(before), at(node), at(low)) <= 0.0
                    || index > came && left_of(at(before), at(node), at(high)) >= 0.0;
            }
        }
        let chosen = sector.triangles.iter().zip(taut);
        chosen
            .filter(|(_, taut)| *taut)
            .map(|(at, _)| *at)
            .collect()
    }
}

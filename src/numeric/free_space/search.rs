//! The shortest path, best interval first.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::intervals::{Interval, Sector};
use super::mesh::FreeSpace;
use crate::numeric::geometry::{Point, distance};

/// Paths to a corner that are longer than the shortest by this are dropped, metres.
const TOLERANCE_M: f64 = 1e-9;

/// The shortest path between two sites of a free space.
#[derive(Clone, Debug, PartialEq)]
pub struct Shortest {
    /// Length in the plane, metres; at most that of any path, but for rounding.
    pub length_m: f64,
    /// Its corners, ends included; empty where the search ended before it was found.
    pub corners: Vec<Point>,
}

/// Where the search goes on.
#[derive(Clone, Copy, Debug)]
enum Step {
    /// Through an edge.
    Edge(Interval),
    /// Around a corner, or at the goal.
    Corner,
}

/// Something to look at: at least so long is any path through it.
#[derive(Clone, Copy, Debug)]
struct Entry {
    min_m: f64,
    /// Order of the discovery, so that ties do not depend on the heap.
    rank: usize,
    /// The corner, and the length of the path up to it.
    root: usize,
    to_root_m: f64,
    step: Step,
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Entry {}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        // The heap pops the greatest.
        let shorter = other.min_m.total_cmp(&self.min_m);
        shorter.then(other.rank.cmp(&self.rank))
    }
}

/// The state of a search.
struct Search<'a> {
    space: &'a FreeSpace,
    sectors: &'a [Vec<Sector>],
    start: usize,
    goal: usize,
    heap: BinaryHeap<Entry>,
    rank: usize,
    /// The shortest known path to each corner, and the corner before it.
    to_m: Vec<f64>,
    before: Vec<usize>,
}

/// Shortest paths in a free space.
#[derive(Clone, Debug)]
pub struct Sights {
    space: FreeSpace,
    sectors: Vec<Vec<Sector>>,
}

impl Sights {
    /// Paths in a space.
    #[must_use]
    pub fn new(space: FreeSpace) -> Self {
        let sectors = space.sectors();
        Self { space, sectors }
    }

    /// The space.
    #[must_use]
    pub fn space(&self) -> &FreeSpace {
        &self.space
    }

    /// The shortest path from one place to another, by their numbers; `None` without any.
    ///
    /// After `most` steps the search ends with a length that no path is shorter than, and
    /// without a path.
    #[must_use]
    pub fn shortest(&self, from: usize, to: usize, most: usize) -> Option<Shortest> {
        let place = |index: usize| self.space.sites.get(index).copied().flatten();
        let (start, goal) = (place(from)?, place(to)?);
        let mut search = Search {
            space: &self.space,
            sectors: &self.sectors,
            start,
            goal,
            heap: BinaryHeap::new(),
            rank: 0,
            to_m: vec![f64::INFINITY; self.space.nodes.len()],
            before: vec![start; self.space.nodes.len()],
        };
        search.to_m[start] = 0.0;
        for (triangle, corners) in self.space.triangles.iter().enumerate() {
            if let Some(side) = (0..3).find(|&side| corners[side] == start) {
                search.look((triangle, side), start, 0.0);
            }
        }
        search.run(most)
    }
}

impl Search<'_> {
    fn run(mut self, most: usize) -> Option<Shortest> {
        let mut steps = 0;
        while let Some(entry) = self.heap.pop() {
            let is_found = matches!(entry.step, Step::Corner) && entry.root == self.goal;
            if is_found || steps >= most {
                return Some(Shortest {
                    length_m: entry.min_m,
                    corners: if is_found { self.corners() } else { Vec::new() },
                });
            }
            if entry.to_root_m > self.to_m[entry.root] + TOLERANCE_M {
                continue;
            }
            steps += 1;
            match entry.step {
                Step::Edge(interval) => self.cross(&interval, entry.to_root_m),
                Step::Corner => self.turn(entry.root, entry.to_root_m),
            }
        }
        None
    }

    fn at(&self, node: usize) -> Point {
        self.space.nodes[node]
    }

    fn push(&mut self, min_m: f64, root: usize, to_root_m: f64, step: Step) {
        self.rank += 1;
        let rank = self.rank;
        self.heap.push(Entry {
            min_m,
            rank,
            root,
            to_root_m,
            step,
        });
    }

    /// Looks from a corner of a triangle across it.
    fn look(&mut self, (triangle, side): (usize, usize), root: usize, to_root_m: f64) {
        let corners = self.space.triangles[triangle];
        let (right, left) = (corners[(side + 1) % 3], corners[(side + 2) % 3]);
        self.see(right, root, to_root_m);
        self.see(left, root, to_root_m);
        let opposite = (triangle, (side + 1) % 3);
        if let Some(interval) = self.space.through(opposite, root, (left, right)) {
            self.expect(interval, to_root_m);
        }
    }

    fn expect(&mut self, interval: Interval, to_root_m: f64) {
        let min_m = to_root_m + self.space.min_m(&interval, self.at(self.goal));
        self.push(min_m, interval.root, to_root_m, Step::Edge(interval));
    }

    /// A corner that is seen from a root.
    fn see(&mut self, node: usize, root: usize, to_root_m: f64) {
        let to_node_m = to_root_m + distance(self.at(root), self.at(node));
        let is_useful = node == self.goal || !self.sectors[node].is_empty();
        if is_useful && to_node_m < self.to_m[node] {
            self.to_m[node] = to_node_m;
            self.before[node] = root;
            let min_m = to_node_m + distance(self.at(node), self.at(self.goal));
            self.push(min_m, node, to_node_m, Step::Corner);
        }
    }

    fn cross(&mut self, interval: &Interval, to_root_m: f64) {
        let (seen, parts) = self.space.behind(interval);
        if let Some(node) = seen {
            self.see(node, interval.root, to_root_m);
        }
        for part in parts.into_iter().flatten() {
            self.expect(part, to_root_m);
        }
    }

    fn turn(&mut self, node: usize, to_node_m: f64) {
        let before = self.before[node];
        let sectors = self.sectors;
        for sector in &sectors[node] {
            for triangle in self.space.taut(before, node, sector) {
                self.look(triangle, node, to_node_m);
            }
        }
    }

    fn corners(&self) -> Vec<Point> {
        let mut corners = vec![self.at(self.goal)];
        let mut node = self.goal;
        while node != self.start && corners.len() <= self.before.len() {
            node = self.before[node];
            corners.push(self.at(node));
        }
        corners.reverse();
        corners
    }
}

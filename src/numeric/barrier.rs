//! Whether what touches shuts two places off from each other.

use std::collections::VecDeque;

use super::cells::{Cells, Extent};
use super::geometry::{Point, closest_points, distance};

/// All places within a radius of a segment; a disc if the segment is a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// Where the segment begins.
    pub from: Point,
    /// Where it ends.
    pub to: Point,
    /// Radius, not negative.
    pub radius: f64,
}

/// Capsules, and which of them touch.
///
/// Two that touch are joined by a curve that stays within them. If a closed curve of such
/// joints crosses the straight line between two places an odd number of times, one place
/// is inside of it and the other outside (Jordan): every way between them meets a capsule.
/// Where every way does, and neither place is in a capsule, there is such a curve.
#[derive(Clone, Debug)]
pub struct Chains {
    capsules: Vec<Capsule>,
    /// What touches capsule `c` is `touching[starts[c]..starts[c + 1]]`.
    starts: Vec<usize>,
    touching: Vec<u32>,
}

/// Capsules from which the shortest closed chain is looked for, at most.
const MAX_ROOTS: usize = 16;

impl Capsule {
    /// A disc.
    #[must_use]
    pub fn disc(center: Point, radius: f64) -> Self {
        Self {
            from: center,
            to: center,
            radius,
        }
    }

    /// A segment without breadth.
    #[must_use]
    pub fn segment((from, to): (Point, Point)) -> Self {
        Self {
            from,
            to,
            radius: 0.0,
        }
    }

    fn extent(&self) -> Extent {
        let side = |axis: usize| {
            let (a, b) = (self.from[axis], self.to[axis]);
            (a.min(b) - self.radius, a.max(b) + self.radius)
        };
        [(0.0, 0.0), side(0), side(1)]
    }

    /// The nearest points of the segments of two capsules.
    fn joint(&self, other: &Self) -> (Point, Point) {
        closest_points((self.from, self.to), (other.from, other.to))
    }

    fn touches(&self, other: &Self) -> bool {
        let (a, b) = self.joint(other);
        distance(a, b) <= self.radius + other.radius
    }
}

/// The straight line between two places.
struct Divide {
    from: Point,
    /// Unit vector.
    along: Point,
    length: f64,
}

impl Divide {
    fn new(from: Point, to: Point) -> Self {
        let run = [to[0] - from[0], to[1] - from[1]];
        let length = run[0].hypot(run[1]).max(f64::MIN_POSITIVE);
        Self {
            from,
            along: [run[0] / length, run[1] / length],
            length,
        }
    }

    /// Whether the segment between two points crosses it. Each point is on one side, so that
    /// the crossings of a closed curve are counted right at its corners too.
    fn is_crossed(&self, a: Point, b: Point) -> bool {
        let aligned = |point: Point| {
            let (x, y) = (point[0] - self.from[0], point[1] - self.from[1]);
            (
                x * self.along[0] + y * self.along[1],
                y * self.along[0] - x * self.along[1],
            )
        };
        let ((t0, s0), (t1, s1)) = (aligned(a), aligned(b));
        if (s0 >= 0.0) == (s1 >= 0.0) {
            return false;
        }
        (0.0..=self.length).contains(&(t0 + (t1 - t0) * s0 / (s0 - s1)))
    }
}

impl Chains {
    /// Finds out which capsules touch.
    #[must_use]
    pub fn of(capsules: Vec<Capsule>) -> Self {
        let extents: Vec<Extent> = capsules.iter().map(Capsule::extent).collect();
        let cells = Cells::new(&extents, [1.0, 1e-3, 1e-3]);
        let mut starts = vec![0];
        let mut touching = Vec::new();
        for (index, extent) in extents.iter().enumerate() {
            let mut near = Vec::new();
            cells.each(extent, |other| near.push(other));
            near.sort_unstable();
            near.retain(|&other| {
                // Asked in one order, so that both say the same.
                let (a, b) = (index.min(other), index.max(other));
                a != b && meet(&extents[a], &extents[b]) && capsules[a].touches(&capsules[b])
            });
            touching.extend(near.into_iter().filter_map(|near| u32::try_from(near).ok()));
            starts.push(touching.len());
        }
        Self {
            capsules,
            starts,
            touching,
        }
    }

    /// The capsules of a closed chain that lies between two places, in its order, as few as
    /// were found; none if there is a way.
    #[must_use]
    pub fn between(&self, from: Point, to: Point) -> Option<Vec<usize>> {
        let divide = Divide::new(from, to);
        let crossing: Vec<usize> = (0..self.capsules.len())
            .filter(|&index| {
                let mut near = self.near(index);
                near.any(|other| self.is_odd(&divide, index, other))
            })
            .collect();
        let mut has_none = vec![false; self.capsules.len()];
        let mut best: Option<Vec<usize>> = None;
        let mut closed = 0;
        for root in crossing {
            if has_none[root] || closed >= MAX_ROOTS {
                continue;
            }
            match self.odd_chain(&divide, root) {
                Ok(chain) => {
                    closed += 1;
                    if best.as_ref().is_none_or(|best| chain.len() < best.len()) {
                        best = Some(chain);
                    }
                }
                Err(joined) => joined.into_iter().for_each(|index| has_none[index] = true),
            }
        }
        best
    }

    fn near(&self, index: usize) -> impl Iterator<Item = usize> + '_ {
        let range = self.starts[index]..self.starts[index + 1];
        self.touching[range].iter().map(|&other| other as usize)
    }

    /// Whether the curve that joins two capsules crosses the divide an odd number of times.
    fn is_odd(&self, divide: &Divide, one: usize, other: usize) -> bool {
        let (first, last) = (one.min(other), one.max(other));
        let (from, to) = (&self.capsules[first], &self.capsules[last]);
        let (a, b) = from.joint(to);
        let curve = [from.from, a, b, to.from];
        let crossings = curve.windows(2);
        crossings
            .filter(|step| divide.is_crossed(step[0], step[1]))
            .count()
            % 2
            == 1
    }

    /// The shortest closed chain from a capsule that crosses the divide an odd number of
    /// times; or all that is joined to it, if there is none.
    fn odd_chain(&self, divide: &Divide, root: usize) -> Result<Vec<usize>, Vec<usize>> {
        // Twice each capsule: reached after an even number of crossings, and an odd one.
        let state = |index: usize, odd: bool| 2 * index + usize::from(odd);
        let mut before = vec![usize::MAX; 2 * self.capsules.len()];
        before[state(root, false)] = state(root, false);
        let mut queue = VecDeque::from([state(root, false)]);
        let mut joined = Vec::new();
        while let Some(at) = queue.pop_front() {
            let (index, odd) = (at / 2, at % 2 == 1);
            joined.push(index);
            for other in self.near(index) {
                let next = state(other, odd != self.is_odd(divide, index, other));
                if before[next] == usize::MAX {
                    before[next] = at;
                    queue.push_back(next);
                }
            }
            if before[state(root, true)] != usize::MAX {
                return Ok(walked(&before, state(root, true), state(root, false)));
            }
        }
        Err(joined)
    }
}

/// The capsules of the walk from a state to another, without what is walked there and back.
fn walked(before: &[usize], from: usize, to: usize) -> Vec<usize> {
    let mut chain = Vec::new();
    let mut at = from;
    while at != to {
        chain.push(at / 2);
        at = before[at];
    }
    while chain.len() > 2 && chain[1] == chain[chain.len() - 1] {
        chain.remove(0);
        chain.pop();
    }
    chain
}

fn meet(a: &Extent, b: &Extent) -> bool {
    a.iter().zip(b).all(|(a, b)| a.0 <= b.1 && b.0 <= a.1)
}

#[cfg(test)]
mod tests {
    use super::{Capsule, Chains};
    use proptest::prelude::*;

    use crate::numeric::geometry::point_segment_distance;

    const FROM: [f64; 2] = [0.5, 5.0];
    const TO: [f64; 2] = [9.5, 5.0];
    /// Cells along each side of a square of ten.
    const CELLS: usize = 100;

    /// Whether cells that share a side, or `corners` too, lead from one place to the other.
    fn leads(is_open: impl Fn([f64; 2]) -> bool, corners: bool) -> bool {
        let middle = |cell: usize| {
            let at = |index: usize| (f64::from(u32::try_from(index).expect("few")) + 0.5) * 0.1;
            [at(cell % CELLS), at(cell / CELLS)]
        };
        let mut is_left: Vec<bool> = (0..CELLS * CELLS)
            .map(|cell| is_open(middle(cell)))
            .collect();
        let (first, last) = (50 * CELLS + 5, 50 * CELLS + 95);
        let mut ahead = vec![first];
        while let Some(cell) = ahead.pop() {
            if !std::mem::replace(&mut is_left[cell], false) {
                continue;
            }
            if cell == last {
                return true;
            }
            for (east, north) in (-1..=1).flat_map(|e| (-1..=1).map(move |n| (e, n))) {
                let column = (cell % CELLS).checked_add_signed(east);
                let row = (cell / CELLS).checked_add_signed(north);
                if let (Some(column), Some(row)) = (column, row)
                    && column < CELLS
                    && row < CELLS
                    && (corners || east == 0 || north == 0)
                {
                    ahead.push(row * CELLS + column);
                }
            }
        }
        false
    }

    fn distance(capsule: &Capsule, at: [f64; 2]) -> f64 {
        point_segment_distance(at, capsule.from, capsule.to)
    }

    /// The edge of the square and more.
    fn with_edge(mut capsules: Vec<Capsule>) -> Vec<Capsule> {
        let corners = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
        for (index, &corner) in corners.iter().enumerate() {
            capsules.push(Capsule::segment((corner, corners[(index + 1) % 4])));
        }
        capsules
    }

    fn capsule() -> impl Strategy<Value = Capsule> {
        let position = || (1.0..9.0_f64, 0.0..10.0_f64);
        (
            position(),
            (-3.0..3.0_f64, -3.0..3.0_f64),
            0.0..1.2_f64,
            any::<bool>(),
        )
            .prop_map(|((x, y), (dx, dy), radius, is_disc)| Capsule {
                from: [x, y],
                to: if is_disc { [x, y] } else { [x + dx, y + dy] },
                radius: if is_disc { radius } else { 0.1 * radius },
            })
    }

    proptest! {
        #[test]
        fn a_chain_lies_between_two_points_if_no_path_leads_past_it(
            capsules in prop::collection::vec(capsule(), 0..25)
        ) {
            let capsules = with_edge(capsules);
            let found = Chains::of(capsules.clone()).between(FROM, TO);
            // Half the diagonal of a cell, and then some.
            const HALF: f64 = 0.0708;
            let is_in = |at, reach: f64| {
                capsules.iter().any(|one| distance(one, at) <= one.radius + reach)
            };
            prop_assume!(!is_in(FROM, 2.0 * HALF) && !is_in(TO, 2.0 * HALF));
            if leads(|at| !is_in(at, HALF), false) {
                prop_assert_eq!(&found, &None);
            }
            if !leads(|at| !is_in(at, -HALF), true) {
                prop_assert!(found.is_some());
            }
            if let Some(chain) = found {
                prop_assert!(chain.len() > 2);
                let next = chain.iter().cycle().skip(1);
                for (&one, &other) in chain.iter().zip(next) {
                    prop_assert!(capsules[one].touches(&capsules[other]));
                }
                let only = chain.iter().map(|&index| capsules[index]).collect();
                prop_assert!(Chains::of(only).between(FROM, TO).is_some());
            }
        }
    }

    #[test]
    fn a_wall_without_breadth_closes_what_it_reaches_across() {
        let wall = |to: f64| with_edge(vec![Capsule::segment(([5.0, 0.0], [5.0, to]))]);
        assert!(Chains::of(wall(10.0)).between(FROM, TO).is_some());
        assert_eq!(Chains::of(wall(9.999)).between(FROM, TO), None);
    }

    #[test]
    fn a_chain_is_named_without_what_only_hangs_on_it() {
        let ring = (0..8).map(|k| {
            let angle = f64::from(k) * std::f64::consts::FRAC_PI_4;
            Capsule::disc([TO[0] - 2.0 + angle.cos(), TO[1] + angle.sin()], 0.5)
        });
        let mut capsules: Vec<Capsule> = ring.collect();
        capsules.extend((0..5).map(|k| Capsule::disc([6.0 - f64::from(k), 5.0], 0.6)));
        let mut chain = Chains::of(capsules)
            .between(FROM, [TO[0] - 2.0, TO[1]])
            .expect("it is closed");
        chain.sort_unstable();
        assert_eq!(chain, [0, 1, 2, 3, 4, 5, 6, 7]);
    }
}

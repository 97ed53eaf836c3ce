//! Two motions and the pairs of times that count, as a convex polygon.

use super::{Approach, Segment};

/// Position of A at `t` less that of B at `u`: `at00 + a t - b u`.
pub(super) struct Gap {
    at00: [f64; 3],
    a: [f64; 3],
    b: [f64; 3],
}

impl Gap {
    fn up(&self, [t, u]: [f64; 2]) -> f64 {
        self.at00[2] + self.a[2] * t - self.b[2] * u
    }

    pub(super) fn at(&self, [t, u]: [f64; 2]) -> [f64; 3] {
        let side = |axis: usize| self.at00[axis] + self.a[axis] * t - self.b[axis] * u;
        [side(0), side(1), side(2)]
    }
}

pub(super) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// A convex polygon of times `(t, u)`, counter-clockwise. A box cut by two
/// half-planes twice has at most eight corners.
#[derive(Clone, Copy)]
pub(super) struct Region {
    corners: [[f64; 2]; 10],
    count: usize,
}

/// How far, in seconds or metres, a corner may lie beyond a cut and still
/// count: a slack of 0 leaves a mere line, which rounding must not remove.
const TOLERANCE: f64 = 1e-9;

impl Region {
    fn corners(&self) -> &[[f64; 2]] {
        &self.corners[..self.count]
    }

    pub(super) fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Calls `see` with each corner and the next one, each with its value, which is taken once.
    fn each_edge<T: Copy>(
        &self,
        value: impl Fn([f64; 2]) -> T,
        mut see: impl FnMut(([f64; 2], T), ([f64; 2], T)),
    ) {
        let corners = self.corners();
        let Some(&first) = corners.first() else {
            return;
        };
        let first = (first, value(first));
        let mut from = first;
        for &corner in &corners[1..] {
            let to = (corner, value(corner));
            see(from, to);
            from = to;
        }
        see(from, first);
    }

    /// The part where `value(t, u) <= 0`, for an affine value given at each corner.
    fn cut(&self, value: impl Fn([f64; 2]) -> f64) -> Self {
        let mut part = Self {
            corners: [[0.0; 2]; 10],
            count: 0,
        };
        let mut push = |corner| {
            if part.count < part.corners.len() {
                part.corners[part.count] = corner;
                part.count += 1;
            }
        };
        self.each_edge(value, |(from, at_from), (to, at_to)| {
            if at_from <= TOLERANCE {
                push(from);
            }
            if (at_from <= TOLERANCE) != (at_to <= TOLERANCE) {
                let share = (at_from / (at_from - at_to)).clamp(0.0, 1.0);
                push([
                    from[0] + share * (to[0] - from[0]),
                    from[1] + share * (to[1] - from[1]),
                ]);
            }
        });
        part
    }
}

/// Two motions, with times counted from the first moment at which both count.
pub(super) struct Pair {
    origin_s: f64,
    pub(super) gap: Gap,
    /// Bounds of `t` and of `u`.
    bounds: [(f64, f64); 2],
    slack_s: f64,
    pub(super) region: Region,
}

impl Pair {
    pub(super) fn new(a: &Segment, b: &Segment, slack_s: f64) -> Option<Self> {
        let (t0, t1) = (a.t0_s.max(b.t0_s - slack_s), a.t1_s.min(b.t1_s + slack_s));
        let (u0, u1) = (b.t0_s.max(a.t0_s - slack_s), b.t1_s.min(a.t1_s + slack_s));
        // Not `t0 > t1`: a time that is not a number must not count either.
        if !(t0 <= t1 && u0 <= u1) {
            return None;
        }
        // Both stay for ever, so any moment shows all there is.
        let (t1, u1) = if t1.is_finite() && u1.is_finite() {
            (t1, u1)
        } else {
            (t0.max(u0), t0.max(u0))
        };
        let origin_s = t0;
        let (from_a, from_b) = (a.at(origin_s), b.at(origin_s));
        let gap = Gap {
            at00: minus(from_a, from_b),
            a: a.velocity_mps,
            b: b.velocity_mps,
        };
        let (t1, u0, u1) = (t1 - origin_s, u0 - origin_s, u1 - origin_s);
        let mut corners = [[0.0; 2]; 10];
        corners[..4].copy_from_slice(&[[0.0, u0], [t1, u0], [t1, u1], [0.0, u1]]);
        let region = Region { corners, count: 4 }
            .cut(|[t, u]| u - t - slack_s)
            .cut(|[t, u]| t - u - slack_s);
        (!region.is_empty()).then_some(Self {
            origin_s,
            gap,
            bounds: [(0.0, t1), (u0, u1)],
            slack_s,
            region,
        })
    }

    /// Least difference of heights over the region, metres.
    pub(super) fn min_height(&self) -> f64 {
        let heights = self.region.corners().iter().map(|&at| self.gap.up(at));
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), up| {
            (low.min(up), high.max(up))
        });
        low.max(-high).max(0.0)
    }

    /// The part of the region where heights differ by at most `vertical_m`.
    pub(super) fn strip(&self, vertical_m: f64) -> Region {
        self.region
            .cut(|at| self.gap.up(at) - vertical_m)
            .cut(|at| -self.gap.up(at) - vertical_m)
    }

    pub(super) fn absolute(&self, (value, [t, u]): (f64, [f64; 2])) -> Approach {
        Approach {
            value,
            t_s: self.origin_s + t,
            u_s: self.origin_s + u,
        }
    }

    /// Whether a pair of times counts. Not asked of the corners: where two of
    /// them all but coincide, the side of their edge is a matter of rounding.
    fn allows(&self, at: [f64; 2], vertical_m: f64) -> bool {
        let within = |axis: usize| {
            let (low, high) = self.bounds[axis];
            (low - TOLERANCE..=high + TOLERANCE).contains(&at[axis])
        };
        within(0)
            && within(1)
            && (at[1] - at[0]).abs() <= self.slack_s + TOLERANCE
            && self.gap.up(at).abs() <= vertical_m + TOLERANCE
    }

    /// Least length of the gap in its first `axes` coordinates over a region
    /// that is not empty: what is allowed with heights at most `vertical_m` apart.
    pub(super) fn least(&self, region: &Region, axes: usize, vertical_m: f64) -> (f64, [f64; 2]) {
        let dot = |x: &[f64; 3], y: &[f64; 3]| {
            let plane = x[0] * y[0] + x[1] * y[1];
            if axes > 2 { plane + x[2] * y[2] } else { plane }
        };
        let gap = &self.gap;
        let (aa, ab, bb) = (
            dot(&gap.a, &gap.a),
            dot(&gap.a, &gap.b),
            dot(&gap.b, &gap.b),
        );
        let determinant = aa * bb - ab * ab;
        let mut best = (f64::INFINITY, region.corners[0]);
        // The edges are asked in any case: between motions that are almost
        // parallel the stationary point is known only roughly.
        if determinant > 1e-12 * aa * bb {
            let (a0, b0) = (dot(&gap.a, &gap.at00), dot(&gap.b, &gap.at00));
            let stationary = [
                (ab * b0 - bb * a0) / determinant,
                (aa * b0 - ab * a0) / determinant,
            ];
            if self.allows(stationary, vertical_m) {
                let there = gap.at(stationary);
                best = (dot(&there, &there).sqrt(), stationary);
            }
        }
        region.each_edge(
            |at| gap.at(at),
            |(from, gap_from), (to, gap_to)| {
                let along = minus(gap_to, gap_from);
                let length_sq = dot(&along, &along);
                let share = if length_sq > 0.0 {
                    (-dot(&gap_from, &along) / length_sq).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                let at = [
                    from[0] + share * (to[0] - from[0]),
                    from[1] + share * (to[1] - from[1]),
                ];
                let there = gap.at(at);
                let length_m = dot(&there, &there).sqrt();
                if length_m < best.0 {
                    best = (length_m, at);
                }
            },
        );
        best
    }
}

//! Closest approach of two motions of constant velocity, when one may be shifted in time.
//!
//! With motion A at time `t` and motion B at time `u`, the difference of the
//! positions is affine in `(t, u)`. The pairs that count (both under way,
//! `|u - t| <= slack`, and where asked a limited height difference) fill a
//! convex polygon, so the least distance is that of a convex quadratic over a
//! convex polygon: at its stationary point if that lies inside, else on an edge.

/// A straight motion of constant velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// When it begins, seconds.
    pub t0_s: f64,
    /// When it ends, seconds; infinite for something that stays.
    pub t1_s: f64,
    /// Where it begins, metres; the third coordinate is up.
    pub from_m: [f64; 3],
    /// Metres a second.
    pub velocity_mps: [f64; 3],
}

/// Where two motions are nearest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// Least value: a distance in metres, or a ratio, see the function.
    pub value: f64,
    /// Time of A, seconds.
    pub t_s: f64,
    /// Time of B, seconds: within the slack of `t_s`.
    pub u_s: f64,
}

impl Motion {
    /// The motion between two places; at rest when it has no duration or no end.
    #[must_use]
    pub fn between((t0_s, from_m): (f64, [f64; 3]), (t1_s, to_m): (f64, [f64; 3])) -> Self {
        let duration_s = t1_s - t0_s;
        let speed = |axis: usize| {
            if duration_s > 0.0 && duration_s.is_finite() {
                (to_m[axis] - from_m[axis]) / duration_s
            } else {
                0.0
            }
        };
        Self {
            t0_s,
            t1_s,
            from_m,
            velocity_mps: [speed(0), speed(1), speed(2)],
        }
    }

    /// Where it is at a time (not limited to its duration), metres.
    #[must_use]
    pub fn at(&self, t_s: f64) -> [f64; 3] {
        let since_s = t_s - self.t0_s;
        [0, 1, 2].map(|axis| self.from_m[axis] + self.velocity_mps[axis] * since_s)
    }
}

/// Least distance in three dimensions over `t` in A, `u` in B, `|u - t| <= slack_s`.
///
/// `None` when no such pair of times exists.
#[must_use]
pub fn closest_approach(a: &Motion, b: &Motion, slack_s: f64) -> Option<Approach> {
    let pair = Pair::new(a, b, slack_s)?;
    Some(pair.absolute(least(&pair.region, &pair.gap, 3)))
}

/// Least horizontal distance over the same times, where the height difference
/// is at most `vertical_m`; `None` where it never is.
#[must_use]
pub fn closest_horizontal(
    a: &Motion,
    b: &Motion,
    slack_s: f64,
    vertical_m: f64,
) -> Option<Approach> {
    let pair = Pair::new(a, b, slack_s)?;
    let strip = pair.strip(vertical_m);
    (!strip.is_empty()).then(|| pair.absolute(least(&strip, &pair.gap, 2)))
}

/// Least of `max(horizontal / horizontal_m, vertical / vertical_m)` over the
/// same times: below 1 exactly where both limits are broken at once.
///
/// The set of times on which the value stays under a level is convex and grows
/// with the level, so the level is found by bisection, to the last few bits.
#[must_use]
pub fn least_ratio(
    a: &Motion,
    b: &Motion,
    slack_s: f64,
    horizontal_m: f64,
    vertical_m: f64,
) -> Option<Approach> {
    let pair = Pair::new(a, b, slack_s)?;
    let value = |at: [f64; 2]| {
        let gap = pair.gap.at(at);
        (gap[0].hypot(gap[1]) / horizontal_m).max(gap[2].abs() / vertical_m)
    };
    let start = pair.region.corners[0];
    let mut best = (value(start), start);
    let mut low = 0.0;
    for _ in 0..60 {
        let level = 0.5 * (low + best.0);
        if best.0 - low <= 1e-12 * best.0 {
            break;
        }
        let strip = pair.strip(level * vertical_m);
        let found = if strip.is_empty() {
            None
        } else {
            let (_, at) = least(&strip, &pair.gap, 2);
            Some((value(at), at)).filter(|found| found.0 < best.0)
        };
        match found {
            Some(found) => {
                best = found;
                if best.0 > level {
                    low = level;
                }
            }
            None => low = level,
        }
    }
    Some(pair.absolute(best))
}

/// Position of A at `t` less that of B at `u`: `at00 + a t - b u`.
struct Gap {
    at00: [f64; 3],
    a: [f64; 3],
    b: [f64; 3],
}

impl Gap {
    fn at(&self, [t, u]: [f64; 2]) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.at00[axis] + self.a[axis] * t - self.b[axis] * u)
    }
}

/// A convex polygon of times `(t, u)`, counter-clockwise. A box cut by two
/// half-planes twice has at most eight corners.
#[derive(Clone, Copy)]
struct Region {
    corners: [[f64; 2]; 10],
    count: usize,
}

/// How far, in seconds or metres, a corner may lie beyond a cut and still
/// count: a slack of 0 leaves a mere line, which rounding must not remove.
const HAIR: f64 = 1e-9;

impl Region {
    fn corners(&self) -> &[[f64; 2]] {
        &self.corners[..self.count]
    }

    fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The part where `value(t, u) <= 0`, for an affine value given at each corner.
    fn cut(&self, value: impl Fn([f64; 2]) -> f64) -> Self {
        let mut kept = Self {
            corners: [[0.0; 2]; 10],
            count: 0,
        };
        let mut push = |corner| {
            if kept.count < kept.corners.len() {
                kept.corners[kept.count] = corner;
                kept.count += 1;
            }
        };
        let corners = self.corners();
        for (index, &from) in corners.iter().enumerate() {
            let to = corners[(index + 1) % corners.len()];
            let (at_from, at_to) = (value(from), value(to));
            if at_from <= HAIR {
                push(from);
            }
            if (at_from <= HAIR) != (at_to <= HAIR) {
                let share = (at_from / (at_from - at_to)).clamp(0.0, 1.0);
                push([
                    from[0] + share * (to[0] - from[0]),
                    from[1] + share * (to[1] - from[1]),
                ]);
            }
        }
        kept
    }

    fn contains(&self, [t, u]: [f64; 2]) -> bool {
        let corners = self.corners();
        corners.iter().enumerate().all(|(index, from)| {
            let to = corners[(index + 1) % corners.len()];
            (to[0] - from[0]) * (u - from[1]) - (to[1] - from[1]) * (t - from[0]) >= 0.0
        })
    }
}

/// Two motions, with times counted from the first moment at which both count.
struct Pair {
    origin_s: f64,
    gap: Gap,
    region: Region,
}

impl Pair {
    fn new(a: &Motion, b: &Motion, slack_s: f64) -> Option<Self> {
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
            at00: [0, 1, 2].map(|axis| from_a[axis] - from_b[axis]),
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
            region,
        })
    }

    /// The part of the region where heights differ by at most `vertical_m`.
    fn strip(&self, vertical_m: f64) -> Region {
        self.region
            .cut(|at| self.gap.at(at)[2] - vertical_m)
            .cut(|at| -self.gap.at(at)[2] - vertical_m)
    }

    fn absolute(&self, (value, [t, u]): (f64, [f64; 2])) -> Approach {
        Approach {
            value,
            t_s: self.origin_s + t,
            u_s: self.origin_s + u,
        }
    }
}

/// Least length of the gap in its first `axes` coordinates over a region that is not empty.
fn least(region: &Region, gap: &Gap, axes: usize) -> (f64, [f64; 2]) {
    let dot = |x: &[f64; 3], y: &[f64; 3]| (0..axes).map(|axis| x[axis] * y[axis]).sum::<f64>();
    let square = |at: [f64; 2]| {
        let gap = gap.at(at);
        dot(&gap, &gap)
    };
    let (aa, ab, bb) = (
        dot(&gap.a, &gap.a),
        dot(&gap.a, &gap.b),
        dot(&gap.b, &gap.b),
    );
    let determinant = aa * bb - ab * ab;
    if determinant > 1e-12 * aa * bb {
        let (a0, b0) = (dot(&gap.a, &gap.at00), dot(&gap.b, &gap.at00));
        let stationary = [
            (ab * b0 - bb * a0) / determinant,
            (aa * b0 - ab * a0) / determinant,
        ];
        if region.contains(stationary) {
            return (square(stationary).sqrt(), stationary);
        }
    }
    let corners = region.corners();
    let mut best = (f64::INFINITY, corners[0]);
    for (index, &from) in corners.iter().enumerate() {
        let to = corners[(index + 1) % corners.len()];
        let (gap_from, gap_to) = (gap.at(from), gap.at(to));
        let along = [0, 1, 2].map(|axis| gap_to[axis] - gap_from[axis]);
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
        let found = square(at);
        if found < best.0 {
            best = (found, at);
        }
    }
    (best.0.sqrt(), best.1)
}

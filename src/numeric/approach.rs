//! Closest approach of two motions of constant velocity, when one may be shifted in time.
//!
//! With motion A at time `t` and motion B at time `u`, the difference of the
//! positions is affine in `(t, u)`. The pairs that count (both under way,
//! `|u - t| <= slack`, and where asked a limited height difference) fill a
//! convex polygon, so the least distance is that of a convex quadratic over a
//! convex polygon: at its stationary point if that lies inside, else on an edge.

mod pair;
mod whole;

use pair::Pair;
pub use whole::{Whole, may_be_near};

/// A straight motion of constant velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
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

impl Segment {
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
        let side = |axis: usize| self.from_m[axis] + self.velocity_mps[axis] * since_s;
        [side(0), side(1), side(2)]
    }

    /// The same motion by some seconds later.
    #[must_use]
    pub fn later(&self, later_s: f64) -> Self {
        Self {
            t0_s: self.t0_s + later_s,
            t1_s: self.t1_s + later_s,
            ..*self
        }
    }
}

/// More than rounding takes from a distance of places on earth, metres.
const ROUNDING_M: f64 = 1e-6;

/// When the first of two motions has a time of the other within the slack, from and to, seconds;
/// the end is before the beginning where it never has.
fn shared_s(a: &Segment, b: &Segment, slack_s: f64) -> (f64, f64) {
    (a.t0_s.max(b.t0_s - slack_s), a.t1_s.min(b.t1_s + slack_s))
}

/// Whether two motions are surely further apart than some distances, horizontally or in
/// height, at all pairs of times that count, or have no such pair: by the boxes of what
/// each covers meanwhile. `false` proves nothing.
#[must_use]
pub fn are_surely_apart(
    a: &Segment,
    b: &Segment,
    slack_s: f64,
    horizontal_m: f64,
    vertical_m: f64,
) -> bool {
    let (t0, t1) = shared_s(a, b, slack_s);
    let (u0, u1) = shared_s(b, a, slack_s);
    if t0 > t1 || u0 > u1 {
        return true;
    }
    let side = |segment: &Segment, axis: usize, from_s: f64, to_s: f64| {
        let (from_m, speed_mps) = (segment.from_m[axis], segment.velocity_mps[axis]);
        // At rest for ever: nothing times infinity is no number.
        let at = |t_s: f64| {
            let moved_m = speed_mps * (t_s - segment.t0_s);
            if moved_m.is_nan() {
                from_m
            } else {
                from_m + moved_m
            }
        };
        let (from, to) = (at(from_s), at(to_s));
        (from.min(to), from.max(to))
    };
    let gap = |axis: usize| {
        let (p, q) = (side(a, axis, t0, t1), side(b, axis, u0, u1));
        (p.0 - q.1).max(q.0 - p.1).max(0.0)
    };
    if gap(2) > vertical_m + ROUNDING_M {
        return true;
    }
    let (east_m, north_m) = (gap(0), gap(1));
    let limit_m = horizontal_m + ROUNDING_M;
    east_m * east_m + north_m * north_m > limit_m * limit_m
}

/// Least distance in three dimensions over `t` in A, `u` in B, `|u - t| <= slack_s`.
///
/// `None` when no such pair of times exists.
#[must_use]
pub fn closest_approach(a: &Segment, b: &Segment, slack_s: f64) -> Option<Approach> {
    let pair = Pair::new(a, b, slack_s)?;
    Some(pair.absolute(pair.least(&pair.region, 3, f64::INFINITY)))
}

/// Least horizontal distance over the same times, where the height difference
/// is at most `vertical_m`; `None` where it never is.
#[must_use]
pub fn closest_horizontal(
    a: &Segment,
    b: &Segment,
    slack_s: f64,
    vertical_m: f64,
) -> Option<Approach> {
    let pair = Pair::new(a, b, slack_s)?;
    let strip = pair.strip(vertical_m);
    (!strip.is_empty()).then(|| pair.absolute(pair.least(&strip, 2, vertical_m)))
}

/// Least of `max(horizontal / horizontal_m, vertical / vertical_m)` over the
/// same times: below 1 exactly where both limits are broken at once.
///
/// At a level, let heights differ by no more than the level allows, and take how much the
/// least horizontal ratio then exceeds the level: that excess is convex, falls at least as
/// fast as the level grows, and is 0 at the value sought. So secants with a bracket
/// (Illinois) come to it, to the last few bits.
#[must_use]
pub fn min_ratio(
    a: &Segment,
    b: &Segment,
    slack_s: f64,
    horizontal_m: f64,
    vertical_m: f64,
) -> Option<Approach> {
    let pair = Pair::new(a, b, slack_s)?;
    // The ratios each alone could have: the value is at least these.
    let (level_m, at) = pair.least(&pair.region, 2, f64::INFINITY);
    let mut low = (level_m / horizontal_m).max(pair.min_height() / vertical_m);
    let mut levels = Levels {
        pair: &pair,
        horizontal_m,
        vertical_m,
        best: (f64::INFINITY, at),
    };
    levels.best.0 = levels.value(at);
    let mut low_excess = levels.excess(low);
    let mut high = levels.best.0;
    let mut high_excess = levels.excess(high);
    let mut last_was_low = None;
    while low_excess > 0.0 && levels.best.0 - low > 1e-12 * high.max(1.0) {
        let secant = (low * high_excess - high * low_excess) / (high_excess - low_excess);
        let is_inside = secant > low && secant < high;
        let level = if is_inside {
            secant
        } else {
            0.5 * (low + high)
        };
        if level <= low || level >= high {
            break;
        }
        let excess = levels.excess(level);
        let is_low = excess > 0.0;
        // An end that stays twice counts half.
        let weight = if last_was_low == Some(is_low) {
            0.5
        } else {
            1.0
        };
        last_was_low = Some(is_low);
        if is_low {
            (low, low_excess, high_excess) = (level, excess, weight * high_excess);
        } else if -excess <= 1e-12 {
            break;
        } else {
            (high, high_excess, low_excess) = (level, excess, weight * low_excess);
        }
    }
    Some(pair.absolute(levels.best))
}

/// Levels that [`min_ratio`] tries, and the best that it met: ratio and times.
struct Levels<'a> {
    pair: &'a Pair,
    horizontal_m: f64,
    vertical_m: f64,
    best: (f64, [f64; 2]),
}

impl Levels<'_> {
    /// The greater of both ratios at two times.
    fn value(&self, at: [f64; 2]) -> f64 {
        let gap = self.pair.gap.at(at);
        (gap[0].hypot(gap[1]) / self.horizontal_m).max(gap[2].abs() / self.vertical_m)
    }

    /// How far the least horizontal ratio exceeds a level where heights differ by no more than
    /// the level allows; infinite where they always differ by more.
    fn excess(&mut self, level: f64) -> f64 {
        let height_m = level * self.vertical_m;
        let strip = self.pair.strip(height_m);
        if strip.is_empty() {
            return f64::INFINITY;
        }
        let (level_m, at) = self.pair.least(&strip, 2, height_m);
        let found = self.value(at);
        if found < self.best.0 {
            self.best = (found, at);
        }
        level_m / self.horizontal_m - level
    }
}

#[cfg(test)]
mod tests {
    use super::{
        Segment, are_surely_apart, closest_approach, closest_horizontal, may_be_near, min_ratio,
    };
    use proptest::prelude::*;

    const STEPS: u32 = 300;

    fn segment() -> impl Strategy<Value = Segment> {
        let position = || [-300.0..300.0_f64, -300.0..300.0_f64, 0.0..150.0_f64];
        (
            0.0..30.0_f64,
            0.0..30.0_f64,
            position(),
            position(),
            0..4_u8,
        )
            .prop_map(|(t0_s, duration_s, from, to, kind)| match kind {
                0 => Segment::between((t0_s, from), (f64::INFINITY, from)),
                1 => Segment::between((t0_s, from), (t0_s, from)),
                _ => Segment::between((t0_s, from), (t0_s + duration_s, to)),
            })
    }

    /// Gaps at a dense grid of allowed pairs of times.
    fn dense(a: &Segment, b: &Segment, slack_s: f64) -> Vec<[f64; 3]> {
        let spread =
            |low: f64, high: f64, i: u32| low + (high - low) * f64::from(i) / f64::from(STEPS);
        let (low, high) = (
            a.t0_s.max(b.t0_s - slack_s),
            a.t1_s.min(b.t1_s + slack_s).min(200.0),
        );
        let mut gaps = Vec::new();
        if low > high {
            return gaps;
        }
        for i in 0..=STEPS {
            let t = spread(low, high, i);
            let (from, to) = (b.t0_s.max(t - slack_s), b.t1_s.min(t + slack_s));
            if from > to {
                continue;
            }
            for j in 0..=STEPS {
                let (at_a, at_b) = (a.at(t), b.at(spread(from, to, j)));
                gaps.push([at_a[0] - at_b[0], at_a[1] - at_b[1], at_a[2] - at_b[2]]);
            }
        }
        gaps
    }

    fn level(gap: &[f64; 3]) -> f64 {
        gap[0].hypot(gap[1])
    }

    /// Between two neighbours of the dense grid no gap changes by more than this, metres.
    fn coarse(a: &Segment, b: &Segment) -> f64 {
        let speed = |segment: &Segment| {
            segment
                .velocity_mps
                .iter()
                .map(|v| v * v)
                .sum::<f64>()
                .sqrt()
        };
        (speed(a) + speed(b)) * 80.0 / f64::from(STEPS)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(150))]

        #[test]
        fn no_dense_pair_of_times_is_nearer_and_the_answer_is_one_of_them(
            a in segment(), b in segment(), slack_s in prop_oneof![Just(0.0), 0.0..10.0_f64]
        ) {
            let gaps = dense(&a, &b, slack_s);
            let Some(near) = closest_approach(&a, &b, slack_s) else {
                prop_assert!(gaps.is_empty());
                return Ok(());
            };
            for gap in &gaps {
                prop_assert!(level(gap).hypot(gap[2]) >= near.value - 1e-6);
            }
            // The times are allowed and give the value.
            prop_assert!((near.u_s - near.t_s).abs() <= slack_s + 1e-6);
            prop_assert!(near.t_s >= a.t0_s - 1e-6 && near.t_s <= a.t1_s + 1e-6);
            prop_assert!(near.u_s >= b.t0_s - 1e-6 && near.u_s <= b.t1_s + 1e-6);
            let (at_a, at_b) = (a.at(near.t_s), b.at(near.u_s));
            let gap = [at_a[0] - at_b[0], at_a[1] - at_b[1], at_a[2] - at_b[2]];
            prop_assert!((level(&gap).hypot(gap[2]) - near.value).abs() < 1e-6);
        }

        #[test]
        fn what_is_surely_apart_is_apart(
            a in segment(), b in segment(), slack_s in prop_oneof![Just(0.0), 0.0..10.0_f64],
            horizontal_m in 10.0..300.0_f64, vertical_m in 5.0..120.0_f64
        ) {
            if are_surely_apart(&a, &b, slack_s, horizontal_m, vertical_m) {
                let near = closest_horizontal(&a, &b, slack_s, vertical_m);
                prop_assert!(near.is_none_or(|near| near.value >= horizontal_m), "{near:?}");
            }
            if are_surely_apart(&a, &b, slack_s, horizontal_m, horizontal_m) {
                let near = closest_approach(&a, &b, slack_s);
                prop_assert!(near.is_none_or(|near| near.value >= horizontal_m), "{near:?}");
            }
        }

        #[test]
        fn what_may_not_be_near_is_apart(
            a in segment(), b in segment(), slack_s in prop_oneof![Just(0.0), 0.0..10.0_f64],
            horizontal_m in 10.0..300.0_f64, vertical_m in 5.0..120.0_f64
        ) {
            if !may_be_near(&a, &b, slack_s, horizontal_m, vertical_m) {
                let near = closest_horizontal(&a, &b, slack_s, vertical_m);
                prop_assert!(near.is_none_or(|near| near.value >= horizontal_m), "{near:?}");
            }
            if !may_be_near(&a, &b, slack_s, horizontal_m, horizontal_m) {
                let near = closest_approach(&a, &b, slack_s);
                prop_assert!(near.is_none_or(|near| near.value >= horizontal_m), "{near:?}");
            }
        }

        #[test]
        fn with_a_vertical_limit_no_dense_pair_within_it_is_nearer(
            a in segment(), b in segment(), slack_s in prop_oneof![Just(0.0), 0.0..10.0_f64], vertical_m in 1.0..80.0_f64
        ) {
            let gaps = dense(&a, &b, slack_s);
            let within: Vec<f64> = gaps.iter().filter(|gap| gap[2].abs() <= vertical_m).map(level).collect();
            match closest_horizontal(&a, &b, slack_s, vertical_m) {
                Some(near) => {
                    prop_assert!(within.iter().all(|gap| *gap >= near.value - 1e-6));
                    let gap = a.at(near.t_s)[2] - b.at(near.u_s)[2];
                    prop_assert!(gap.abs() <= vertical_m + 1e-6);
                }
                None => prop_assert!(within.is_empty()),
            }
        }

        #[test]
        fn the_least_ratio_is_below_one_exactly_when_both_limits_are_broken_at_once(
            a in segment(), b in segment(), slack_s in prop_oneof![Just(0.0), 0.0..10.0_f64],
            horizontal_m in 20.0..200.0_f64, vertical_m in 5.0..80.0_f64
        ) {
            let ratio = |gap: &[f64; 3]| (level(gap) / horizontal_m).max(gap[2].abs() / vertical_m);
            let gaps = dense(&a, &b, slack_s);
            let found = gaps.iter().map(ratio).fold(f64::INFINITY, f64::min);
            let Some(near) = min_ratio(&a, &b, slack_s, horizontal_m, vertical_m) else {
                prop_assert!(gaps.is_empty());
                return Ok(());
            };
            prop_assert!(near.value <= found + 1e-9, "{} {found}", near.value);
            if found.is_finite() {
                let most = coarse(&a, &b) / horizontal_m.min(vertical_m);
                prop_assert!(near.value >= found - most - 1e-9, "{} {found}", near.value);
            }
            let conflict = closest_horizontal(&a, &b, slack_s, vertical_m)
                .is_some_and(|near| near.value < horizontal_m);
            if (near.value - 1.0).abs() > 1e-9 {
                prop_assert_eq!(conflict, near.value < 1.0);
            }
        }
    }

    #[test]
    fn two_that_cross_at_one_place_six_seconds_apart_meet_only_with_slack_enough() {
        let a = Segment::between((0.0, [-100.0, 0.0, 50.0]), (20.0, [100.0, 0.0, 50.0]));
        let b = Segment::between((6.0, [0.0, -100.0, 50.0]), (26.0, [0.0, 100.0, 50.0]));
        let at = |slack_s| closest_approach(&a, &b, slack_s).unwrap().value;
        assert!(at(6.0) < 1e-9);
        assert!(at(10.0) < 1e-9);
        // Six seconds at 10 m/s, seen across the diagonal.
        assert!((at(0.0) - 60.0 / 2.0_f64.sqrt()).abs() < 1e-9);
        assert!((at(4.0) - 20.0 / 2.0_f64.sqrt()).abs() < 1e-9);
    }
}

//! Bounds that drop motions before their closest approach is looked for: one motion over several,
//! and whether two may come near each other at all.

use super::pair::minus;
use super::{ROUNDING_M, Segment, shared_s};

/// One motion over several, and the furthest that these are from it at the same time, metres.
#[derive(Clone, Copy, Debug)]
pub struct Whole {
    /// From the beginning of the first to the end of the last.
    pub motion: Segment,
    /// Furthest in the plane.
    pub off_m: f64,
    /// Furthest up or down.
    pub off_up_m: f64,
}

impl Whole {
    /// Over motions that follow each other, at least one.
    #[must_use]
    pub fn over(segments: &[Segment]) -> Self {
        let (first, last) = (segments[0], segments[segments.len() - 1]);
        let end = |segment: &Segment| match segment.t1_s.is_finite() {
            true => segment.at(segment.t1_s),
            false => segment.from_m,
        };
        let motion = match segments {
            [one] => return Self::of(one),
            _ => Segment::between((first.t0_s, first.from_m), (last.t1_s, end(&last))),
        };
        let (mut off_sq, mut off_up_m) = (0.0_f64, 0.0_f64);
        let mut see = |t_s: f64, at: [f64; 3]| {
            let there = match t_s.is_finite() && motion.t1_s.is_finite() {
                true => motion.at(t_s),
                false => motion.from_m,
            };
            let (east_m, north_m) = (at[0] - there[0], at[1] - there[1]);
            off_sq = off_sq.max(east_m * east_m + north_m * north_m);
            off_up_m = off_up_m.max((at[2] - there[2]).abs());
        };
        for segment in segments {
            see(segment.t0_s, segment.from_m);
            see(segment.t1_s, end(segment));
        }
        Self {
            motion,
            off_m: off_sq.sqrt(),
            off_up_m,
        }
    }

    /// Over one motion.
    #[must_use]
    pub fn of(motion: &Segment) -> Self {
        Self {
            motion: *motion,
            off_m: 0.0,
            off_up_m: 0.0,
        }
    }

    /// The same by some seconds later.
    #[must_use]
    pub fn later(&self, later_s: f64) -> Self {
        Self {
            motion: self.motion.later(later_s),
            ..*self
        }
    }

    /// Whether any of these motions may come within some distances of any of others.
    #[must_use]
    pub fn may_be_near(
        &self,
        own: &Self,
        slack_s: f64,
        (horizontal_m, vertical_m): (f64, f64),
    ) -> bool {
        may_be_near(
            &own.motion,
            &self.motion,
            slack_s,
            horizontal_m + self.off_m + own.off_m,
            vertical_m + self.off_up_m + own.off_up_m,
        )
    }
}

/// Whether two motions may be within some distances, horizontally and in height, at some pair of
/// times that counts: by where the first is relative to the second at one time, along and across
/// the course of the second, and how far the second gets along it within the slack. `true` proves
/// nothing.
#[must_use]
pub fn may_be_near(
    a: &Segment,
    b: &Segment,
    slack_s: f64,
    horizontal_m: f64,
    vertical_m: f64,
) -> bool {
    let (t0, t1) = shared_s(a, b, slack_s);
    if t0 > t1 {
        return false;
    }
    // Two that stay for ever are where they are at the beginning.
    let lasts_s = if t1.is_finite() { t1 - t0 } else { 0.0 };
    let (p, q) = (a.at(t0), b.at(t0));
    let apart = minus(p, q);
    let moving = minus(a.velocity_mps, b.velocity_mps);
    let [east_mps, north_mps, up_mps] = b.velocity_mps;
    let mut times = Some((0.0, lasts_s));
    times = within(
        times,
        (apart[2], moving[2]),
        vertical_m + up_mps.abs() * slack_s,
    );
    let speed_mps = (east_mps * east_mps + north_mps * north_mps).sqrt();
    let course = if speed_mps > 1e-9 {
        [east_mps / speed_mps, north_mps / speed_mps]
    } else {
        [1.0, 0.0]
    };
    let along = |of: [f64; 3]| of[0] * course[0] + of[1] * course[1];
    let across = |of: [f64; 3]| of[1] * course[0] - of[0] * course[1];
    times = within(times, (across(apart), across(moving)), horizontal_m);
    let reach_m = horizontal_m + speed_mps * slack_s;
    within(times, (along(apart), along(moving)), reach_m).is_some()
}

/// The part of a span of times, seconds, in which what begins at a distance and changes at a speed
/// is no further than a limit to either side, metres; with more than rounding takes.
fn within(
    times: Option<(f64, f64)>,
    (begins_m, speed_mps): (f64, f64),
    limit_m: f64,
) -> Option<(f64, f64)> {
    /// More than rounding takes from a time, seconds.
    const ROUNDING_S: f64 = 1e-6;
    let (from_s, to_s) = times?;
    let limit_m = limit_m + ROUNDING_M;
    // Slower than that it gets nowhere before the end.
    if speed_mps.abs() * to_s < ROUNDING_M {
        return (begins_m.abs() <= limit_m + ROUNDING_M).then_some((from_s, to_s));
    }
    let (one_s, other_s) = (
        (-limit_m - begins_m) / speed_mps,
        (limit_m - begins_m) / speed_mps,
    );
    let from_s = from_s.max(one_s.min(other_s));
    let to_s = to_s.min(one_s.max(other_s));
    (from_s <= to_s + ROUNDING_S).then_some((from_s, to_s))
}

//! Motions of one track that follow each other.

use super::Nearness;
use crate::numeric::approach::{Segment, Whole};
use crate::numeric::cells::Extent;

/// Most motions that share a box, and fewest that are split once more.
const MAX_OF_RUN: usize = 64;
const SPLIT: usize = 8;
/// Motions share a box where they are that near to one motion over all of them, metres.
const STRAIGHT_M: f64 = 8.0;

/// A box around motions that follow each other, and one motion that is near to all of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    pub(super) first: usize,
    pub(super) end: usize,
    pub(super) extent: Extent,
    pub(super) up_m: (f64, f64),
    pub(super) whole: Whole,
}

impl Run {
    fn around(first: usize, segments: &[Segment]) -> Self {
        let mut all = [(f64::INFINITY, f64::NEG_INFINITY); 4];
        for segment in segments {
            let end_s = if segment.t1_s.is_finite() {
                segment.t1_s
            } else {
                segment.t0_s
            };
            let to_m = segment.at(end_s);
            all[0] = (all[0].0.min(segment.t0_s), all[0].1.max(segment.t1_s));
            for axis in 0..3 {
                let (from, to) = (segment.from_m[axis], to_m[axis]);
                let side = &mut all[axis + 1];
                *side = (side.0.min(from).min(to), side.1.max(from).max(to));
            }
        }
        Self {
            first,
            end: first + segments.len(),
            extent: [all[0], all[1], all[2]],
            up_m: all[3],
            whole: Whole::over(segments),
        }
    }

    /// Runs of motions numbered from `first` on, as long as they are nearly straight
    /// and steady.
    pub(super) fn push_all(first: usize, segments: &[Segment], runs: &mut Vec<Self>) {
        let is_straight = || {
            let whole = Whole::over(segments);
            whole.off_m.max(whole.off_up_m) <= STRAIGHT_M
        };
        if segments.len() <= SPLIT || segments.len() <= MAX_OF_RUN && is_straight() {
            runs.push(Self::around(first, segments));
            return;
        }
        let (one, other) = segments.split_at(segments.len() / 2);
        Self::push_all(first, one, runs);
        Self::push_all(first + one.len(), other, runs);
    }

    /// The extent in which something may be too near, with a hair for rounding.
    pub(super) fn reach(&self, nearness: &Nearness) -> Extent {
        let by = [nearness.slack_s, nearness.distance_m, nearness.distance_m];
        [0, 1, 2].map(|axis| {
            let (low, high) = self.extent[axis];
            (low - by[axis] - 1e-6, high + by[axis] + 1e-6)
        })
    }

    /// The same by some seconds later.
    pub(super) fn later(&self, later_s: f64) -> Self {
        let (from_s, to_s) = self.extent[0];
        Self {
            extent: [
                (from_s + later_s, to_s + later_s),
                self.extent[1],
                self.extent[2],
            ],
            whole: self.whole.later(later_s),
            ..*self
        }
    }

    /// Whether something in another run may be too near, by the boxes.
    pub(super) fn may_meet(&self, reach: &Extent, other: &Self, nearness: &Nearness) -> bool {
        let apart_m = (self.up_m.0 - other.up_m.1).max(other.up_m.0 - self.up_m.1);
        let within = reach
            .iter()
            .zip(&other.extent)
            .all(|(a, b)| a.0 <= b.1 && b.0 <= a.1);
        within && apart_m <= nearness.height_m() + 1e-6
    }
}

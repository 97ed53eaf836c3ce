//! Boxes around pieces of the paths of all lanes.

use fearless_simd::prelude::*;

use super::lanes::{Lanes, Position, V, Wide, store};
use crate::numeric::geometry::Point;

/// Least and greatest east and north of every lane.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BlockBox {
    pub(crate) low: [Wide; 2],
    pub(crate) high: [Wide; 2],
}

impl BlockBox {
    /// The corners of one lane.
    pub(crate) fn lane(&self, lane: usize) -> ([f64; 2], [f64; 2]) {
        (
            [self.low[0][lane], self.low[1][lane]],
            [self.high[0][lane], self.high[1][lane]],
        )
    }
}

/// A box around places of every lane, and the greatest altitude.
#[derive(Clone, Copy)]
pub(crate) struct Bounds<S: Simd> {
    pub(crate) low: [V<S>; 2],
    pub(crate) high: [V<S>; 2],
    pub(crate) top_m: V<S>,
}

impl<S: Simd> Bounds<S> {
    #[inline(always)]
    pub(crate) fn of(position: &Position<S>) -> Self {
        let at = [position[0], position[1]];
        Self {
            low: at,
            high: at,
            top_m: position[2],
        }
    }

    /// The box around those of all lanes.
    #[inline(always)]
    pub(crate) fn of_all_lanes(&self) -> (Point, Point) {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for axis in 0..2 {
            let (mut lows, mut highs) = (Wide::default(), Wide::default());
            store::<S>(self.low[axis], &mut lows);
            store::<S>(self.high[axis], &mut highs);
            for lane in 0..V::<S>::LEN {
                low[axis] = low[axis].min(lows[lane]);
                high[axis] = high[axis].max(highs[lane]);
            }
        }
        (low, high)
    }

    #[inline(always)]
    pub(crate) fn widen(&mut self, position: &Position<S>) {
        self.low = [self.low[0].min(position[0]), self.low[1].min(position[1])];
        self.high = [self.high[0].max(position[0]), self.high[1].max(position[1])];
        self.top_m = self.top_m.max(position[2]);
    }
}

/// In which lanes a box meets another one.
#[inline(always)]
pub(crate) fn meets<S: Simd>(
    low: &[V<S>; 2],
    high: &[V<S>; 2],
    other_low: &Point,
    other_high: &Point,
) -> Lanes<S> {
    high[0].simd_ge(other_low[0])
        & low[0].simd_le(other_high[0])
        & high[1].simd_ge(other_low[1])
        & low[1].simd_le(other_high[1])
}

//! Some pieces of the paths side by side, one candidate in each lane: what is near none
//! of them is passed over for all.
//!
//! What is done for every piece is done in loops of its own, one after the other, since
//! one long loop has more numbers at hand than a processor has registers.

use fearless_simd::prelude::*;

use super::boxes::Bounds;
use super::lanes::{Lanes, Position, Steps, V, Wide, point, points, splat, steps};
use super::limits::LimitLanes;
use crate::cost::hazards::Piece;
use crate::cost::relief::{CellLanes, Corners, ReliefLanes};
use crate::cost::sampling::MAX_SUBSTEPS;
use crate::numeric::geometry::POINT_SQ;

/// Pieces of a block, for which hazards are culled together.
pub(crate) const BLOCK: usize = 8;
/// Fine samples of a block.
pub(crate) const FINE: usize = BLOCK * MAX_SUBSTEPS;

/// The pieces of a block.
pub(crate) struct Block<S: Simd> {
    /// The sample with which it begins.
    pub(super) start: usize,
    pub(super) count: usize,
    /// Readings of the ground in each piece.
    substeps: usize,
    /// Places at the samples, that with which it begins included.
    pub(super) positions: [Position<S>; BLOCK + 1],
    /// Those at the fine samples too, if there are more.
    fine: [Position<S>; FINE],
    /// Where in the ground grid the fine samples lie.
    cells: [CellLanes<S>; FINE],
    /// The last piece of the block before, and those of this one.
    pub(super) steps: [Steps<S>; BLOCK + 1],
    /// Horizontal distance along the route at the end, if it is kept.
    pub(super) along_m: V<S>,
    pub(crate) bounds: Bounds<S>,
    /// Whether a piece goes nowhere, or straight up.
    pub(crate) stays: bool,
    /// Whether a piece may be too steep.
    may_be_steep: bool,
    /// Turns into pieces that may be too tight: bits for the lanes of the first, of eight for
    /// the next, and so on.
    tight: u64,
}

/// What is seen of pieces as they are measured.
struct Look<S: Simd> {
    before: Steps<S>,
    min_sq: V<S>,
    steep: Lanes<S>,
    /// Eight bits for each piece, the last one's on top.
    tight: u64,
}

impl<S: Simd> Look<S> {
    /// At those after a piece.
    #[inline(always)]
    fn at(simd: S, before: &Steps<S>) -> Self {
        let zero = splat(simd, 0.0);
        let none = zero.simd_gt(zero);
        Self {
            before: *before,
            min_sq: splat(simd, f64::INFINITY),
            steep: none,
            tight: 0,
        }
    }

    /// Measures the next one, between two ends.
    #[inline(always)]
    fn measure(&mut self, limits: &LimitLanes<S>, ends: &[Position<S>]) -> Steps<S> {
        let step = steps::<S>(&ends[0], &ends[1]);
        self.min_sq = self.min_sq.min(step.run_sq);
        self.steep |= limits.may_be_steep(&step);
        let tight = limits.may_be_tight(&self.before, &step);
        self.tight = self.tight >> u8::BITS | tight.to_bitmask() << (u64::BITS - u8::BITS);
        self.before = step;
        step
    }
}

/// One piece of every lane.
#[derive(Clone, Copy)]
pub(crate) struct PieceLanes<'a, S: Simd> {
    pub(crate) a: &'a Position<S>,
    pub(crate) b: &'a Position<S>,
    pub(crate) step: &'a Steps<S>,
}

impl<S: Simd> PieceLanes<'_, S> {
    /// Altitude half way.
    #[inline(always)]
    pub(crate) fn middle_m(&self) -> V<S> {
        (self.a[2] + self.b[2]) * 0.5
    }
}

impl<S: Simd> Block<S> {
    /// An empty block of paths whose pieces have `substeps` readings of the ground.
    #[inline(always)]
    pub(crate) fn new(simd: S, substeps: usize) -> Self {
        let zero = splat(simd, 0.0);
        let nowhere = [zero; 3];
        Self {
            start: 0,
            count: 0,
            substeps,
            positions: [nowhere; BLOCK + 1],
            fine: [nowhere; FINE],
            cells: [CellLanes::first(simd); FINE],
            steps: [steps::<S>(&nowhere, &nowhere); BLOCK + 1],
            along_m: zero,
            bounds: Bounds::of(&nowhere),
            stays: false,
            may_be_steep: false,
            tight: 0,
        }
    }

    /// Goes back to where paths begin.
    #[inline(always)]
    pub(crate) fn begin(&mut self, simd: S, position: Position<S>) {
        (self.start, self.count) = (0, 0);
        self.positions[0] = position;
        self.along_m = splat(simd, 0.0);
    }

    /// Goes on to the next `count` pieces, with fine samples at these rows.
    #[inline(always)]
    pub(crate) fn sample(
        &mut self,
        simd: S,
        rows: &[(usize, [f64; 4])],
        count: usize,
        controls: &[[Wide; 3]],
    ) {
        self.positions[0] = self.positions[self.count];
        self.steps[0] = self.steps[self.count];
        self.start += self.count;
        self.count = count;
        let mut bounds = Bounds::of(&self.positions[0]);
        let ends = &mut self.positions[1..=count];
        if self.substeps == 1 {
            for (row, end) in rows.iter().zip(ends) {
                *end = point(simd, row, controls);
                bounds.widen(end);
            }
        } else {
            points(simd, rows, controls, &mut self.fine);
            for (fine, end) in self.fine.chunks_exact(self.substeps).zip(ends) {
                *end = fine[self.substeps - 1];
                bounds.widen(end);
            }
        }
        self.bounds = bounds;
    }

    /// Number of pieces.
    #[inline(always)]
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Readings of the ground in each piece.
    #[inline(always)]
    pub(crate) fn substeps(&self) -> usize {
        self.substeps
    }

    /// Finds the cells of the ground under the fine samples.
    #[inline(always)]
    pub(crate) fn find(&mut self, relief: &ReliefLanes<'_, S>) {
        let (positions, fine) = (&self.positions, &self.fine);
        let fine = fine_positions::<S>(positions, fine, (self.count, self.substeps));
        for (at, cell) in fine.iter().zip(&mut self.cells) {
            *cell = relief.cell(at[0], at[1]);
        }
    }

    /// Measures the pieces, and fetches the corners of their cells: one has nothing to do with
    /// the other, but a processor that waits for roots can fetch.
    #[inline(always)]
    pub(crate) fn measure(
        &mut self,
        simd: S,
        limits: &LimitLanes<S>,
        relief: &ReliefLanes<'_, S>,
        corners: &mut [Corners; FINE],
    ) {
        let mut look = Look::at(simd, &self.steps[0]);
        let pieces = self.positions[..=self.count].windows(2);
        let pieces = pieces.zip(&mut self.steps[1..]);
        if self.substeps == 1 {
            let grounds = self.cells.iter().zip(corners);
            for ((ends, step), (cell, corners)) in pieces.zip(grounds) {
                *step = look.measure(limits, ends);
                relief.fetch(cell, corners);
            }
        } else {
            let cells = self.cells.chunks_exact(self.substeps);
            let grounds = cells.zip(corners.chunks_exact_mut(self.substeps));
            for ((ends, step), (cells, corners)) in pieces.zip(grounds) {
                *step = look.measure(limits, ends);
                for (cell, corners) in cells.iter().zip(corners) {
                    relief.fetch(cell, corners);
                }
            }
        }
        self.stays = look.min_sq.simd_le(POINT_SQ).any_true();
        // There is no turn into the first piece.
        let first = if self.start == 0 { u8::BITS } else { 0 };
        let pieces = look.tight >> (u8::BITS as usize * (BLOCK - self.count));
        self.tight = pieces >> first << first;
        let above = limits.are_above(self.bounds.top_m);
        self.may_be_steep = (look.steep | above).any_true();
    }

    /// The pieces with the places and cells of their fine samples.
    #[inline(always)]
    pub(crate) fn grounds(&self) -> impl Iterator<Item = (&Position<S>, &CellLanes<S>)> {
        let (positions, fine) = (&self.positions, &self.fine);
        let fine = fine_positions::<S>(positions, fine, (self.count, self.substeps));
        fine.iter().zip(&self.cells)
    }

    /// Where the pieces begin and end; beyond the last piece anything.
    #[inline(always)]
    pub(crate) fn positions(&self) -> &[Position<S>; BLOCK + 1] {
        &self.positions
    }

    /// Piece number `k` of one lane.
    #[inline(always)]
    pub(super) fn piece(&self, k: usize, lane: usize) -> Piece {
        let at = |position: &Position<S>, axis: usize| position[axis].as_slice()[lane];
        let (a, b) = (&self.positions[k], &self.positions[k + 1]);
        Piece {
            a: [at(a, 0), at(a, 1)],
            b: [at(b, 0), at(b, 1)],
            amsl_a_m: at(a, 2),
            amsl_b_m: at(b, 2),
        }
    }

    /// The pieces.
    #[inline(always)]
    pub(crate) fn steps(&self) -> &[Steps<S>] {
        &self.steps[1..=self.count]
    }

    /// The pieces, if any of them may be too steep.
    #[inline(always)]
    pub(crate) fn steep(&self) -> impl Iterator<Item = PieceLanes<'_, S>> {
        let count = if self.may_be_steep { self.count } else { 0 };
        let ends = self.positions[..=count].windows(2);
        ends.zip(self.steps()).map(
            #[inline(always)]
            |(pair, step)| PieceLanes {
                a: &pair[0],
                b: &pair[1],
                step,
            },
        )
    }

    /// The pieces before and after each turn that may be too tight, and its lane; the turns of
    /// each lane in order.
    #[inline(always)]
    pub(crate) fn tight(&self) -> impl Iterator<Item = ((&Steps<S>, &Steps<S>), usize)> {
        let mut left = self.tight;
        std::iter::from_fn(
            #[inline(always)]
            move || {
                let bit = (left != 0).then_some(left.trailing_zeros() as usize)?;
                left &= left - 1;
                let k = bit / u8::BITS as usize;
                Some(((&self.steps[k], &self.steps[k + 1]), bit % V::<S>::LEN))
            },
        )
    }
}

/// The fine samples of `count` pieces with `substeps` readings of the ground each: the ends
/// themselves, if there is one.
#[inline(always)]
fn fine_positions<'a, S: Simd>(
    positions: &'a [Position<S>],
    fine: &'a [Position<S>],
    (count, substeps): (usize, usize),
) -> &'a [Position<S>] {
    if substeps == 1 {
        &positions[1..=count]
    } else {
        &fine[..count * substeps]
    }
}

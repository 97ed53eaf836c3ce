//! Costs as they run up along a path: what is changed in one place is judged there.

use fearless_simd::{dispatch, prelude::*};

use super::Batch;
use super::kernel::block::BLOCK;
use super::kernel::lanes::{Scratch, V};
use super::model::CostModel;

impl CostModel {
    /// Number of blocks of a path that [`Self::totals_along`] tells apart.
    #[must_use]
    pub fn blocks(&self) -> usize {
        (self.samples() - 1).div_ceil(BLOCK)
    }

    /// First and last block whose cost depends on where the samples from `first` to `last` lie.
    #[must_use]
    pub fn blocks_of(&self, first: usize, last: usize) -> (usize, usize) {
        let last_piece = self.samples() - 2;
        // The piece before the first sample, and the turn after the piece behind the last.
        let (from, to) = (first.saturating_sub(1), last + 1);
        (from.min(last_piece) / BLOCK, to.min(last_piece) / BLOCK)
    }

    /// The same as [`Self::totals`], and in `along`, row by row, for each of the
    /// [`Self::blocks`] the total from the beginning to its end, collisions left out: when others
    /// are met depends on the whole way up to there. The last block's and the collisions are the
    /// total, to the bit. The paper's objective is not told apart: zeros.
    ///
    /// Allocates nothing once the scratch has grown.
    ///
    /// # Panics
    /// When the batch has control points in another number than [`Self::control_points`], or
    /// `along` has too few numbers.
    pub fn totals_along(
        &self,
        batch: &Batch,
        scratch: &mut Scratch,
        totals: &mut [f64],
        along: &mut [f64],
    ) {
        let blocks = self.blocks();
        assert!(along.len() >= totals.len() * blocks, "a row each");
        let lanes = dispatch!(self.dispatch.0, simd => lanes(simd));
        scratch.runs_up = true;
        self.totals(batch, scratch, totals);
        scratch.runs_up = false;
        for (index, row) in along
            .chunks_exact_mut(blocks)
            .enumerate()
            .take(totals.len())
        {
            let running = &scratch.running[index / lanes * blocks..][..blocks];
            for (to, wide) in row.iter_mut().zip(running) {
                *to = wide[index % lanes];
            }
        }
    }
}

/// Candidates that are evaluated at once.
fn lanes<S: Simd>(_: S) -> usize {
    V::<S>::LEN
}

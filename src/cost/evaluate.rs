//! Evaluates candidates: the terms of one, the totals of many, and totals as they add up along
//! paths, so that a local change can be judged locally.

use fearless_simd::{dispatch, prelude::*};

use super::kernel::block::BLOCK;
use super::kernel::lanes::V;
use super::kernel::{operational, paper};
use super::model::CostModel;
use super::reference::{self, Curve};
use super::{Batch, Controls, CostTerms, Scratch};
use crate::spec::Objective;

impl CostModel {
    /// The seven terms of a candidate, weighted as they enter the total: the
    /// plain reference, one term after the other.
    ///
    /// # Panics
    /// When a coordinate has fewer than [`Self::control_points`] numbers.
    #[must_use]
    pub fn terms(&self, controls: &Controls<'_>) -> CostTerms {
        let curve = Curve::new(self, controls);
        match self.objective {
            Objective::Operational => self.weigh(&reference::sums(self, &curve)),
            Objective::Paper => reference::paper::terms(self, &curve),
        }
    }

    /// The totals of a batch: each equal to `terms(controls).total()` to the bit.
    ///
    /// Allocates nothing once the scratch has grown.
    ///
    /// # Panics
    /// When the batch has control points in another number than [`Self::control_points`].
    pub fn totals(&self, batch: &Batch, scratch: &mut Scratch, totals: &mut [f64]) {
        let mut terms = std::mem::take(&mut scratch.terms);
        terms.resize(totals.len(), CostTerms::default());
        self.evaluate(batch, scratch, &mut terms);
        for (total, terms) in totals.iter_mut().zip(&terms) {
            *total = terms.total();
        }
        scratch.terms = terms;
    }

    /// The terms of a batch: the same as those of [`Self::terms`], to the bit, by the
    /// fast way.
    ///
    /// # Panics
    /// When the batch has control points in another number than [`Self::control_points`].
    #[must_use]
    pub fn judge(&self, batch: &Batch) -> Vec<CostTerms> {
        let mut terms = vec![CostTerms::default(); batch.len()];
        self.evaluate(batch, &mut Scratch::default(), &mut terms);
        terms
    }

    /// The terms of the first candidates, as many as `out` has, as many at once as the vectors
    /// have lanes.
    pub(super) fn evaluate(&self, batch: &Batch, scratch: &mut Scratch, out: &mut [CostTerms]) {
        assert_eq!(batch.controls(), self.control_points(), "control points");
        dispatch!(self.dispatch.0, simd => self.evaluate_by(simd, batch, scratch, out));
    }

    #[inline(always)]
    fn evaluate_by<S: Simd>(
        &self,
        simd: S,
        batch: &Batch,
        scratch: &mut Scratch,
        out: &mut [CostTerms],
    ) {
        scratch.grow(&self.path, out.len().div_ceil(V::<S>::LEN));
        match self.objective {
            Objective::Operational => {
                operational::terms(simd, self, batch, scratch, out);
            }
            Objective::Paper => paper::terms(simd, self, batch, scratch, out),
        }
    }

    /// Number of blocks of a path in [`Self::totals_along`].
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
    /// total, to the bit. Zeros for the paper's objective.
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

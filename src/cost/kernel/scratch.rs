//! Buffers of an evaluation.

use fearless_simd::prelude::*;

use super::batch::Batch;
use super::block::{BLOCK, Block, FINE};
use super::boxes::BlockBox;
use super::lanes::{V, Wide, store, store_position};
use super::threats::{Approaches, Exposures};
use crate::cost::CostTerms;
use crate::cost::hazards::Piece;
use crate::cost::relief::Corners;
use crate::cost::sampling::Sampling;

/// Buffers of an evaluation; they grow on first use and are then reused.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    /// Control points of each lane: east, north, altitude.
    pub(crate) controls: Vec<[Wide; 3]>,
    /// The curves at the samples.
    pub(crate) curve: Vec<[Wide; 3]>,
    /// Horizontal distance along the routes at the samples, metres.
    pub(crate) along_m: Vec<Wide>,
    /// Boxes of the blocks.
    pub(crate) boxes: Vec<BlockBox>,
    pub(crate) crossings: Vec<(f64, i32)>,
    /// The terms of a batch.
    pub(crate) terms: Vec<CostTerms>,
    /// Totals up to the end of each block, group of lanes by group, if `runs_up`.
    pub(crate) running: Vec<Wide>,
    pub(crate) runs_up: bool,
    /// Corners of the cells of a block.
    pub(crate) corners: [Corners; FINE],
    pub(crate) approaches: Approaches,
    pub(crate) exposures: Exposures,
}

impl Scratch {
    /// Grows to `groups` groups of candidates, one candidate in each lane.
    pub(in crate::cost) fn grow(&mut self, path: &Sampling, groups: usize) {
        let blocks = (path.samples - 1).div_ceil(BLOCK);
        self.controls
            .resize(path.fine.control_points(), Default::default());
        self.curve.resize(path.samples, Default::default());
        self.along_m.resize(path.samples, Default::default());
        self.boxes.resize(blocks, BlockBox::default());
        if self.runs_up {
            self.running.clear();
            self.running.resize(blocks * groups, Wide::default());
        }
    }

    /// Puts `used` candidates from number `first` on into the lanes; the last of them also
    /// fills the lanes that are left.
    #[inline(always)]
    pub(crate) fn load<S: Simd>(&mut self, batch: &Batch, first: usize, used: usize) {
        for lane in 0..V::<S>::LEN {
            let of = batch.candidate(first + lane.min(used - 1));
            let positions = of.east_m.iter().zip(of.north_m).zip(of.amsl_m);
            for (wide, ((east_m, north_m), amsl_m)) in self.controls.iter_mut().zip(positions) {
                (wide[0][lane], wide[1][lane], wide[2][lane]) = (*east_m, *north_m, *amsl_m);
            }
        }
    }

    /// Stores where the pieces of a block lie, for conflicts whose times depend on whole paths.
    #[inline(always)]
    pub(super) fn keep<S: Simd>(&mut self, block: &mut Block<S>) {
        let (start, count) = (block.start, block.count);
        if start == 0 {
            store_position::<S>(&block.positions[0], &mut self.curve[0]);
            store::<S>(block.along_m, &mut self.along_m[0]);
        }
        let curve = &mut self.curve[start + 1..];
        for (position, stored) in block.positions[1..=count].iter().zip(curve) {
            store_position::<S>(position, stored);
        }
        let along_m = &mut self.along_m[start + 1..];
        for (step, stored) in block.steps[1..=count].iter().zip(along_m) {
            block.along_m += step.run_m();
            store::<S>(block.along_m, stored);
        }
        let stored = &mut self.boxes[start / BLOCK];
        for axis in 0..2 {
            store::<S>(block.bounds.low[axis], &mut stored.low[axis]);
            store::<S>(block.bounds.high[axis], &mut stored.high[axis]);
        }
    }

    /// The piece of one lane from sample `k` to the next.
    #[inline]
    pub(super) fn piece(&self, k: usize, lane: usize) -> Piece {
        let (a, b) = (&self.curve[k], &self.curve[k + 1]);
        Piece {
            a: [a[0][lane], a[1][lane]],
            b: [b[0][lane], b[1][lane]],
            amsl_a_m: a[2][lane],
            amsl_b_m: b[2][lane],
        }
    }
}

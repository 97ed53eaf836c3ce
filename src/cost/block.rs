//! Some pieces of the paths side by side, one candidate in each lane: what is near none
//! of them is passed over for all.
//!
//! What is done for every piece is done in loops of its own, one after the other, since
//! one long loop has more numbers at hand than a processor has registers.

use fearless_simd::prelude::*;

use super::hazards::{Hazards, Segment};
use super::lanes::{
    Lanes, Place, Scratch, SlopeLanes, Steps, TurnLanes, V, Wide, load, points, splat, steps,
    store, store_place,
};
use super::model::CostModel;
use super::sampling::MOST_SUBSTEPS;
use super::threat_lanes::{Danger, clear};
use crate::numeric::geometry::{POINT_SQ, Point};

/// Pieces of a block, for which hazards are culled together, and between two looks at the
/// cutoff.
pub(super) const BLOCK: usize = 8;
/// Fine samples of a block.
pub(super) const FINE: usize = BLOCK * MOST_SUBSTEPS;

/// Least and greatest east and north of every lane.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BlockBox {
    pub(super) low: [Wide; 2],
    pub(super) high: [Wide; 2],
}

impl BlockBox {
    /// The corners of one lane.
    pub(super) fn lane(&self, lane: usize) -> ([f64; 2], [f64; 2]) {
        (
            [self.low[0][lane], self.low[1][lane]],
            [self.high[0][lane], self.high[1][lane]],
        )
    }
}

/// The pieces of a block.
pub(super) struct Block<S: Simd> {
    /// The sample with which it begins.
    start: usize,
    count: usize,
    /// Places at the samples, that with which it begins included.
    places: [Place<S>; BLOCK + 1],
    /// Those at the fine samples too, if there are more.
    fine: [Place<S>; FINE],
    /// The last piece of the block before, and those of this one.
    steps: [Steps<S>; BLOCK + 1],
    /// Horizontal distance along the route at the end, if it is kept.
    along_m: V<S>,
    /// The longest piece, horizontally.
    pub(super) longest_m: V<S>,
    pub(super) low: [V<S>; 2],
    pub(super) high: [V<S>; 2],
    /// Whether a piece goes nowhere, or straight up.
    pub(super) stays: bool,
}

/// One piece of every lane.
#[derive(Clone, Copy)]
pub(super) struct Piece<'a, S: Simd> {
    pub(super) a: &'a Place<S>,
    pub(super) b: &'a Place<S>,
    pub(super) step: &'a Steps<S>,
}

impl<S: Simd> Piece<'_, S> {
    /// Altitude half way.
    #[inline(always)]
    pub(super) fn middle_m(&self) -> V<S> {
        (self.a[2] + self.b[2]) * 0.5
    }
}

impl<S: Simd> Block<S> {
    /// No pieces, before the one that begins at `place`.
    #[inline(always)]
    pub(super) fn before(simd: S, place: Place<S>) -> Self {
        let zero = splat(simd, 0.0);
        Self {
            start: 0,
            count: 0,
            places: [place; BLOCK + 1],
            fine: [place; FINE],
            steps: [steps::<S>(&place, &place); BLOCK + 1],
            along_m: zero,
            longest_m: zero,
            low: [zero; 2],
            high: [zero; 2],
            stays: false,
        }
    }

    /// Goes on to the next pieces, so many: each ends at every so many of the rows.
    #[inline(always)]
    pub(super) fn sample(
        &mut self,
        simd: S,
        rows: &[(usize, [f64; 4])],
        (count, substeps): (usize, usize),
        controls: &[[Wide; 3]],
    ) {
        self.places[0] = self.places[self.count];
        self.steps[0] = self.steps[self.count];
        self.start += self.count;
        self.count = count;
        let ends = &mut self.places[1..=count];
        if substeps == 1 {
            points(simd, rows, controls, ends);
        } else {
            points(simd, rows, controls, &mut self.fine);
            let mut index = substeps - 1;
            for end in ends {
                *end = self.fine[index];
                index += substeps;
            }
        }
        let first = &self.places[0];
        let (mut low, mut high) = ([first[0], first[1]], [first[0], first[1]]);
        for end in &self.places[1..=count] {
            low = [low[0].min(end[0]), low[1].min(end[1])];
            high = [high[0].max(end[0]), high[1].max(end[1])];
        }
        (self.low, self.high) = (low, high);
    }

    /// Places at the fine samples, without that with which the block begins.
    #[inline(always)]
    pub(super) fn fine(&self, substeps: usize) -> &[Place<S>] {
        if substeps == 1 {
            &self.places[1..=self.count]
        } else {
            &self.fine[..self.count * substeps]
        }
    }

    /// Measures the pieces. What is done `beside` with the fine samples of each has nothing to
    /// do with that, but a processor that waits for roots can do it.
    #[inline(always)]
    pub(super) fn measure(
        &mut self,
        simd: S,
        substeps: usize,
        mut beside: impl FnMut(&[Place<S>]),
    ) {
        let mut least_sq = splat(simd, f64::INFINITY);
        let mut most_sq = splat(simd, 0.0);
        let ends = self.places[..=self.count].windows(2);
        let pieces = ends.zip(&mut self.steps[1..]);
        if substeps == 1 {
            for (pair, to) in pieces {
                *to = steps::<S>(&pair[0], &pair[1]);
                least_sq = least_sq.min(to.run_sq);
                most_sq = most_sq.max(to.run_sq);
                beside(std::slice::from_ref(&pair[1]));
            }
        } else {
            for ((pair, to), fine) in pieces.zip(self.fine.chunks_exact(substeps)) {
                *to = steps::<S>(&pair[0], &pair[1]);
                least_sq = least_sq.min(to.run_sq);
                most_sq = most_sq.max(to.run_sq);
                beside(fine);
            }
        }
        if self.start == 0 {
            // There is no turn into the first piece.
            self.steps[0] = self.steps[1];
        }
        self.longest_m = most_sq.sqrt();
        self.stays = least_sq.simd_le(POINT_SQ).any_true();
    }

    /// Writes down where the pieces lie, for what is met at times that depend on whole paths.
    #[inline(always)]
    pub(super) fn keep(&mut self, simd: S, scratch: &mut Scratch) {
        if self.start == 0 {
            store_place::<S>(&self.places[0], &mut scratch.curve[0]);
            store::<S>(splat(simd, 0.0), &mut scratch.along_m[0]);
        }
        let curve = &mut scratch.curve[self.start + 1..];
        for (place, stored) in self.places[1..=self.count].iter().zip(curve) {
            store_place::<S>(place, stored);
        }
        let along_m = &mut scratch.along_m[self.start + 1..];
        for (step, stored) in self.steps[1..=self.count].iter().zip(along_m) {
            self.along_m += step.run_m();
            store::<S>(self.along_m, stored);
        }
        let stored = &mut scratch.boxes[self.start / BLOCK];
        for axis in 0..2 {
            store::<S>(self.low[axis], &mut stored.low[axis]);
            store::<S>(self.high[axis], &mut stored.high[axis]);
        }
    }

    /// Where the pieces begin and end; beyond the last piece anything.
    #[inline(always)]
    pub(super) fn places(&self) -> &[Place<S>; BLOCK + 1] {
        &self.places
    }

    /// Piece number `k` of one lane.
    #[inline(always)]
    fn segment(&self, k: usize, lane: usize) -> Segment {
        let at = |place: &Place<S>, axis: usize| place[axis].as_slice()[lane];
        let (a, b) = (&self.places[k], &self.places[k + 1]);
        Segment {
            a: [at(a, 0), at(a, 1)],
            b: [at(b, 0), at(b, 1)],
            amsl_a_m: at(a, 2),
            amsl_b_m: at(b, 2),
        }
    }

    /// The pieces.
    #[inline(always)]
    pub(super) fn steps(&self) -> &[Steps<S>] {
        &self.steps[1..=self.count]
    }

    /// The pieces, after that before the first; in the first block this is the first itself.
    #[inline(always)]
    pub(super) fn all_steps(&self) -> &[Steps<S>] {
        &self.steps[..=self.count]
    }

    /// The pieces with their ends.
    #[inline(always)]
    pub(super) fn pieces(&self) -> impl Iterator<Item = Piece<'_, S>> {
        let ends = self.places[..=self.count].windows(2);
        ends.zip(self.steps()).map(
            #[inline(always)]
            |(pair, step)| Piece {
                a: &pair[0],
                b: &pair[1],
                step,
            },
        )
    }

    /// Threats, zones and area, added to `sum`.
    #[inline(always)]
    pub(super) fn add_threats(
        &self,
        simd: S,
        model: &CostModel,
        danger: impl Danger,
        scratch: &mut Scratch,
        mut sum: V<S>,
    ) -> V<S> {
        let hazards = &model.hazards;
        let (zones, outside) = self.near_polygons(hazards);
        let threats = (&hazards.threats[..], danger);
        let exposures = &mut scratch.exposures;
        let is_near = (scratch.encounters).add(simd, self, threats, exposures);
        if !is_near {
            if zones | outside == 0 {
                return sum;
            }
            clear(simd, exposures);
        }
        if zones | outside != 0 {
            for (k, exposure) in exposures[..self.count].iter_mut().enumerate() {
                let mut lanes = zones | outside;
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize;
                    let piece = self.segment(k, lane);
                    exposure[lane] =
                        hazards.add_polygons(&piece, exposure[lane], &mut scratch.crossings);
                    lanes &= lanes - 1;
                }
            }
        }
        for (exposure, step) in exposures.iter().zip(self.steps()) {
            sum += load(simd, exposure) * step.length_km;
        }
        sum
    }

    /// Which lanes need a look at zones, and which at the edge of the area.
    #[inline(always)]
    fn near_polygons(&self, hazards: &Hazards) -> (u64, u64) {
        let (low, high) = (&self.low, &self.high);
        let mut zones = 0;
        for zone in &hazards.zones {
            let (zone_low, zone_high) = zone.bounds();
            zones |= meets::<S>(low, high, &zone_low, &zone_high).to_bitmask();
        }
        let bounds = &hazards.bounds;
        let inside = low[0].simd_ge(bounds.low[0])
            & high[0].simd_le(bounds.high[0])
            & low[1].simd_ge(bounds.low[1])
            & high[1].simd_le(bounds.high[1]);
        (zones, (!inside).to_bitmask())
    }
}

/// Pieces of a block that may break a limit: few, so that only these are looked at closely.
pub(super) struct Suspects<S: Simd> {
    steep: [Lanes<S>; BLOCK],
    tight: [Lanes<S>; BLOCK],
    any_steep: Lanes<S>,
    any_tight: Lanes<S>,
}

impl<S: Simd> Suspects<S> {
    #[inline(always)]
    pub(super) fn none(simd: S) -> Self {
        let zero = splat(simd, 0.0);
        let none = zero.simd_gt(zero);
        Self {
            steep: [none; BLOCK],
            tight: [none; BLOCK],
            any_steep: none,
            any_tight: none,
        }
    }

    /// Looks at piece number `k`, at an altitude, and at the turn into it from that before.
    #[inline(always)]
    pub(super) fn mark(
        &mut self,
        k: usize,
        amsl_m: V<S>,
        (before, step): (&Steps<S>, &Steps<S>),
        (slopes, turns): &(SlopeLanes<S>, TurnLanes<S>),
    ) {
        let steep = slopes.may_be_steep(amsl_m, step);
        let tight = turns.may_be_tight(before, step);
        (self.steep[k], self.tight[k]) = (steep, tight);
        self.any_steep |= steep;
        self.any_tight |= tight;
    }

    /// Pieces that may be too steep.
    #[inline(always)]
    pub(super) fn steep<'a>(&self, block: &'a Block<S>) -> impl Iterator<Item = Piece<'a, S>> {
        let count = if self.any_steep.any_true() { BLOCK } else { 0 };
        let pieces = block.pieces().zip(&self.steep).take(count);
        pieces.filter_map(
            #[inline(always)]
            |(piece, lanes)| lanes.any_true().then_some(piece),
        )
    }

    /// Pieces between which a turn may be too tight. There is none into the first of all.
    #[inline(always)]
    pub(super) fn tight<'a>(
        &self,
        block: &'a Block<S>,
    ) -> impl Iterator<Item = (&'a Steps<S>, &'a Steps<S>)> {
        let first = usize::from(block.start == 0);
        let count = if self.any_tight.any_true() {
            BLOCK
        } else {
            first
        };
        let turns = block.all_steps().windows(2).zip(&self.tight);
        turns.take(count).skip(first).filter_map(
            #[inline(always)]
            |(pair, lanes)| lanes.any_true().then_some((&pair[0], &pair[1])),
        )
    }
}

/// In which lanes a box meets another one.
#[inline(always)]
pub(super) fn meets<S: Simd>(
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

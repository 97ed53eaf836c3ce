//! Some pieces of the paths side by side, one candidate in each lane: what is near none
//! of them is passed over for all.
//!
//! What is done for every piece is done in loops of its own, one after the other, since
//! one long loop has more numbers at hand than a processor has registers.

use fearless_simd::prelude::*;

use super::hazards::Hazards;
use super::lanes::{
    Place, Scratch, Steps, V, Wide, load, segment, splat, steps, store, store_place,
};
use super::model::CostModel;
use super::threat_lanes::{Danger, clear};
use crate::numeric::geometry::{POINT_SQ, Point};

/// Pieces of a block, for which hazards are culled together, and between two looks at the
/// cutoff.
pub(super) const BLOCK: usize = 8;

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
    /// The last piece of the block before, and those of this one.
    steps: [Steps<S>; BLOCK + 1],
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

impl<S: Simd> Block<S> {
    /// No pieces, before the one that begins at `place`.
    #[inline(always)]
    pub(super) fn before(simd: S, place: Place<S>, scratch: &mut Scratch) -> Self {
        let zero = splat(simd, 0.0);
        store_place::<S>(&place, &mut scratch.curve[0]);
        store::<S>(zero, &mut scratch.along_m[0]);
        Self {
            start: 0,
            count: 0,
            places: [place; BLOCK + 1],
            steps: [steps::<S>(&place, &place); BLOCK + 1],
            along_m: zero,
            longest_m: zero,
            low: [zero; 2],
            high: [zero; 2],
            stays: false,
        }
    }

    /// Goes on to the next pieces: every so many of these places are their ends.
    #[inline(always)]
    pub(super) fn advance(
        &mut self,
        simd: S,
        fine: &[Place<S>],
        substeps: usize,
        scratch: &mut Scratch,
    ) {
        self.places[0] = self.places[self.count];
        self.steps[0] = self.steps[self.count];
        self.start += self.count;
        self.count = fine.len() / substeps;
        let first = self.places[0];
        let (mut low, mut high) = ([first[0], first[1]], [first[0], first[1]]);
        let curve = &mut scratch.curve[self.start + 1..];
        let mut index = substeps - 1;
        for (place, stored) in self.places[1..=self.count].iter_mut().zip(curve) {
            let end = fine[index];
            index += substeps;
            *place = end;
            store_place::<S>(&end, stored);
            low = [low[0].min(end[0]), low[1].min(end[1])];
            high = [high[0].max(end[0]), high[1].max(end[1])];
        }
        (self.low, self.high) = (low, high);
        let mut least_sq = splat(simd, f64::INFINITY);
        let mut longest_m = splat(simd, 0.0);
        let mut along_m = self.along_m;
        let stored = &mut scratch.along_m[self.start + 1..];
        let ends = self.places[..=self.count].windows(2);
        for ((pair, to), stored) in ends.zip(&mut self.steps[1..]).zip(stored) {
            let step = steps::<S>(&pair[0], &pair[1]);
            least_sq = least_sq.min(step.run_sq);
            longest_m = longest_m.max(step.run_m);
            along_m += step.run_m;
            store::<S>(along_m, stored);
            *to = step;
        }
        (self.along_m, self.longest_m) = (along_m, longest_m);
        self.stays = least_sq.simd_le(POINT_SQ).any_true();
        let stored = &mut scratch.boxes[self.start / BLOCK];
        for axis in 0..2 {
            store::<S>(low[axis], &mut stored.low[axis]);
            store::<S>(high[axis], &mut stored.high[axis]);
        }
    }

    /// The pieces.
    #[inline(always)]
    pub(super) fn steps(&self) -> &[Steps<S>] {
        &self.steps[1..=self.count]
    }

    /// The pieces, that before the first included if there is one: turns are between them.
    #[inline(always)]
    pub(super) fn turning(&self) -> &[Steps<S>] {
        let first = usize::from(self.start == 0);
        &self.steps[first..=self.count]
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
        let curve = &scratch.curve[self.start..];
        let exposures = &mut scratch.exposures;
        let is_near = (scratch.encounters).add(simd, self, threats, curve, exposures);
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
                    let piece = segment(&scratch.curve, self.start + k, lane);
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

/// In which lanes a box meets another one.
#[inline(always)]
pub(super) fn meets<S: Simd>(
    low: &[V<S>; 2],
    high: &[V<S>; 2],
    other_low: &Point,
    other_high: &Point,
) -> <V<S> as SimdBase<S>>::Mask {
    high[0].simd_ge(other_low[0])
        & low[0].simd_le(other_high[0])
        & high[1].simd_ge(other_low[1])
        & low[1].simd_le(other_high[1])
}

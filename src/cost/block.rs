//! Some pieces of the paths side by side, one candidate in each lane: what is near none
//! of them is passed over for all.
//!
//! What is done for every piece is done in loops of its own, one after the other, since
//! one long loop has more numbers at hand than a processor has registers.

use fearless_simd::prelude::*;

use super::hazards::{FORBIDDEN, Hazards, Threat};
use super::lanes::{Place, Scratch, Steps, V, Wide, segment, splat, steps, store, store_place};
use super::model::CostModel;
use crate::numeric::geometry::POINT_SQ;

/// Pieces of a block, for which hazards are culled together, and between two looks at the
/// cutoff.
pub(super) const BLOCK: usize = 10;

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
    low: [V<S>; 2],
    high: [V<S>; 2],
    /// Whether a piece goes nowhere, or straight up.
    stays: bool,
}

/// What threats do to a piece.
pub(super) trait Danger: Copy {
    /// Adds what one kilometre of a piece from `a` to `b` costs for a threat; `stays` where
    /// some piece of the block may be but a point.
    fn add<S: Simd>(
        self,
        simd: S,
        threat: &Threat,
        piece: &Piece<'_, S>,
        stays: bool,
        exposure: &mut V<S>,
    );
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
        let mut along_m = self.along_m;
        let stored = &mut scratch.along_m[self.start + 1..];
        let ends = self.places[..=self.count].windows(2);
        for ((pair, to), stored) in ends.zip(&mut self.steps[1..]).zip(stored) {
            let step = steps::<S>(&pair[0], &pair[1]);
            least_sq = least_sq.min(step.run_sq);
            along_m += step.run_m;
            store::<S>(along_m, stored);
            *to = step;
        }
        self.along_m = along_m;
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
        let mut exposures = [splat(simd, 0.0); BLOCK];
        let (zones, outside) = self.near_polygons(hazards);
        let mut is_near = zones | outside != 0;
        for threat in &hazards.threats {
            if !threat.may_reach(simd, &self.low, &self.high) {
                continue;
            }
            is_near = true;
            for (piece, exposure) in self.pieces().zip(&mut exposures) {
                danger.add(simd, threat, &piece, self.stays, exposure);
            }
        }
        if !is_near {
            return sum;
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
            sum += *exposure * step.length_km;
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
            let meets = high[0].simd_ge(zone_low[0])
                & low[0].simd_le(zone_high[0])
                & high[1].simd_ge(zone_low[1])
                & low[1].simd_le(zone_high[1]);
            zones |= meets.to_bitmask();
        }
        let bounds = &hazards.bounds;
        let inside = low[0].simd_ge(bounds.low[0])
            & high[0].simd_le(bounds.high[0])
            & low[1].simd_ge(bounds.low[1])
            & high[1].simd_le(bounds.high[1]);
        (zones, (!inside).to_bitmask())
    }
}

impl Threat {
    /// Whether a disc may reach into a box of any lane.
    #[inline(always)]
    fn may_reach<S: Simd>(&self, simd: S, low: &[V<S>; 2], high: &[V<S>; 2]) -> bool {
        let mut gap_sq = splat(simd, 0.0);
        for axis in 0..2 {
            let center = splat(simd, self.center[axis]);
            let beyond = (low[axis] - center).max(center - high[axis]).max(0.0);
            gap_sq += beyond * beyond;
        }
        gap_sq.simd_le(self.reach_sq).any_true()
    }
}

/// The exact length in a disc; see [`Threat::exposure`].
#[derive(Clone, Copy)]
pub(super) struct Chords;

impl Danger for Chords {
    #[inline(always)]
    fn add<S: Simd>(
        self,
        simd: S,
        threat: &Threat,
        piece: &Piece<'_, S>,
        stays: bool,
        exposure: &mut V<S>,
    ) {
        let (a, step) = (piece.a, piece.step);
        let zero = splat(simd, 0.0);
        let from = [a[0] - threat.center[0], a[1] - threat.center[1]];
        let from_sq = from[0] * from[0] + from[1] * from[1];
        let square = step.run_sq;
        let outside = from_sq - threat.radius_m * threat.radius_m;
        let half = from[0] * step.east_m + from[1] * step.north_m;
        let discriminant = half * half - square * outside;
        // Not if the piece begins outside and leads away, or ends outside and leads there.
        let past = half + square;
        let outside_b = outside + (half + past);
        let meets = discriminant.simd_gt(0.0)
            & outside.min(half).simd_lt(0.0)
            & outside_b.min(-past).simd_lt(0.0);
        let points = square.simd_le(POINT_SQ);
        let matters = meets.any_true() || stays && points.any_true();
        if !matters {
            return;
        }
        let root = discriminant.max(zero).sqrt();
        let per_square = splat(simd, 1.0) / square.max(POINT_SQ);
        let enter = ((-half - root) * per_square).max(0.0);
        let leave = ((-half + root) * per_square).min(1.0);
        let nearest = (-half * per_square).max(0.0).min(1.0);
        let gap = [
            from[0] + nearest * step.east_m,
            from[1] + nearest * step.north_m,
        ];
        let closest = (gap[0] * gap[0] + gap[1] * gap[1]).sqrt();
        let through = (leave - enter) * (splat(simd, FORBIDDEN) - closest * threat.per_radius);
        let mut through = (meets & leave.simd_gt(enter)).select(through, zero);
        if stays {
            let over = splat(simd, FORBIDDEN) - from_sq.sqrt() * threat.per_radius;
            through = points.select(outside.simd_lt(0.0).select(over, zero), through);
        }
        *exposure += through;
    }
}

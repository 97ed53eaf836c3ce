//! The paper's objective, lane by lane, in one pass over the candidates.

use fearless_simd::prelude::*;

use super::block::{BLOCK, Block};
use super::boxes::meets;
use super::exposure::add_threats;
use super::lanes::{Lanes, MAX_LANES, V, Wide, load, point, splat, store};
use super::limits::LimitLanes;
use super::scratch::Scratch;
use super::threats::{Danger, Pieces};
use super::turns::TightTurns;
use crate::cost::hazards::Threat;
use crate::cost::model::CostModel;
use crate::cost::paper::{Paper, PaperSums, ThreatForm};
use crate::cost::relief::ReliefLanes;
use crate::cost::{Batch, CostTerms};

/// Terms of the first candidates, as many as `out` has.
#[inline(always)]
pub(crate) fn terms<S: Simd>(
    simd: S,
    model: &CostModel,
    batch: &Batch,
    scratch: &mut Scratch,
    out: &mut [CostTerms],
) {
    let ground = Ground {
        relief: model.relief.lanes(simd),
        limits: LimitLanes::new(simd, model, false),
    };
    let mut block = Block::new(simd, 1);
    let lanes = V::<S>::LEN;
    for (group, out) in out.chunks_mut(lanes).enumerate() {
        scratch.load::<S>(batch, group * lanes, out.len());
        let sums = group_sums(simd, model, &ground, &mut block, scratch);
        weigh(simd, model, &sums, scratch, out);
    }
}

/// What all groups of lanes share.
struct Ground<'a, S: Simd> {
    relief: ReliefLanes<'a, S>,
    limits: LimitLanes<S>,
}

/// Sums of the candidates in the lanes of `scratch`, collisions apart.
#[inline(always)]
fn group_sums<S: Simd>(
    simd: S,
    model: &CostModel,
    Ground { relief, limits }: &Ground<'_, S>,
    block: &mut Block<S>,
    scratch: &mut Scratch,
) -> PaperSums<V<S>> {
    let zero = splat(simd, 0.0);
    let (paper, segments) = (&model.paper, model.path.samples - 1);
    let first = point(simd, &model.path.rows[0], &scratch.controls);
    let ground_m = relief.heights_m(first[0], first[1]);
    let (altitude, terrain) = paper.height_lanes::<S>(ground_m, model, first[2], 0);
    let mut sums = PaperSums {
        altitude,
        terrain,
        ..PaperSums::all(zero)
    };
    let mut turns = TightTurns::none();
    block.begin(simd, first);
    for start in (0..segments).step_by(BLOCK) {
        let count = BLOCK.min(segments - start);
        let rows = &model.path.rows[start + 1..=start + count];
        block.sample(simd, rows, count, &scratch.controls);
        block.find(relief);
        block.measure(simd, limits, relief, &mut scratch.corners);
        let mut sum = [sums.length_km, sums.altitude, sums.terrain];
        let pieces = block.grounds().zip(&scratch.corners).zip(block.steps());
        for (index, (((at, cell), corners), step)) in (start + 1..).zip(pieces) {
            let ground_m = relief.heights_in(cell, corners);
            let (high_km, deep_km) = paper.height_lanes::<S>(ground_m, model, at[2], index);
            sum[0] += step.length_km;
            sum[1] += high_km;
            sum[2] += deep_km;
        }
        [sums.length_km, sums.altitude, sums.terrain] = sum;
        if paper.has_others() {
            scratch.keep(block);
        }
        for piece in block.steep() {
            if let Some(excess) = limits.excesses(piece.a[2], piece.step) {
                sums.climb += excess;
            }
        }
        for (turn, lane) in block.tight() {
            if turns.push(turn, lane) {
                count_tight(simd, model, &mut turns);
            }
        }
        let danger = model.paper.options.threat_form;
        sums.threat = add_threats(simd, block, &model.hazards, danger, (scratch, sums.threat));
    }
    count_tight(simd, model, &mut turns);
    sums.turns = turns.sums(simd);
    sums
}

/// Counts the turns that are too tight among those that wait.
#[inline(always)]
fn count_tight<S: Simd>(simd: S, model: &CostModel, turns: &mut TightTurns) {
    let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
    turns.flush(
        simd,
        #[inline(always)]
        |into, out| model.too_tight(simd, into, out).select(one, zero),
    );
}

/// Terms of a group of lanes from its sums, collisions added.
#[inline(always)]
fn weigh<S: Simd>(
    simd: S,
    model: &CostModel,
    sums: &PaperSums<V<S>>,
    scratch: &mut Scratch,
    out: &mut [CostTerms],
) {
    let paper = &model.paper;
    let mut wide = PaperSums::<Wide>::default();
    for (value, to) in [
        (sums.length_km, &mut wide.length_km),
        (sums.altitude, &mut wide.altitude),
        (sums.threat, &mut wide.threat),
        (sums.terrain, &mut wide.terrain),
        (sums.turns, &mut wide.turns),
        (sums.climb, &mut wide.climb),
    ] {
        store::<S>(value, to);
    }
    if paper.has_others() {
        add_collisions(simd, model, scratch, out.len(), &mut wide.collision);
    }
    for (lane, terms) in out.iter_mut().enumerate() {
        let sums = PaperSums {
            length_km: wide.length_km[lane],
            altitude: wide.altitude[lane],
            threat: wide.threat[lane],
            terrain: wide.terrain[lane],
            turns: wide.turns[lane],
            climb: wide.climb[lane],
            collision: wide.collision[lane],
        };
        *terms = paper.weigh(&model.weights, model.path.samples, &sums);
    }
}

impl Paper {
    /// [`Paper::heights`] in every lane.
    #[inline(always)]
    fn height_lanes<S: Simd>(
        &self,
        ground_m: V<S>,
        model: &CostModel,
        amsl_m: V<S>,
        index: usize,
    ) -> (V<S>, V<S>) {
        let over_m = if self.options.altitude_over_ground {
            amsl_m - ground_m
        } else {
            amsl_m
        };
        let mut high_m = over_m - model.min_agl_m;
        if !self.options.altitude_unclamped {
            high_m = high_m.max(0.0);
        }
        let mut below_m = (ground_m + model.paper_agl_m(index) - amsl_m).max(0.0);
        let mut above_m = (amsl_m - model.max_amsl_m).max(0.0);
        if model.is_layered {
            below_m = below_m.max(amsl_m * -1.0 + model.min_amsl_m);
            above_m = above_m.max(amsl_m - ground_m - model.agl_m[index][1]);
        }
        let deep_m = below_m + above_m;
        (high_m * 1e-3, deep_m * 1e-3)
    }
}

/// `T_de` of Eq. 24 at the middle of a piece.
impl Danger for ThreatForm {
    #[inline(always)]
    fn meets<S: Simd>(self, threat: &Threat, of: &Pieces<S>) -> Lanes<S> {
        apart_sq(threat, of).simd_lt(threat.reach_m * threat.reach_m)
    }

    #[inline(always)]
    fn exposures<S: Simd>(self, simd: S, threat: &Threat, of: &Pieces<S>, _: bool) -> V<S> {
        let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
        let share_sq = apart_sq(threat, of) / threat.radius_sq;
        let danger = match self {
            Self::Quartic => one / (share_sq * share_sq + 1.0),
            Self::Linear => one - share_sq.sqrt(),
        };
        share_sq.simd_lt(1.0).select(danger, zero)
    }
}

/// Squares of the distances from a threat's centre to the middles of pieces.
#[inline(always)]
fn apart_sq<S: Simd>(threat: &Threat, of: &Pieces<S>) -> V<S> {
    let middle = |axis: usize| (of.a[axis] + of.b[axis]) * 0.5;
    let (east_m, north_m) = (middle(0) - threat.center[0], middle(1) - threat.center[1]);
    east_m * east_m + north_m * north_m
}

/// Eq. 28 to 30: blocks that are near no earlier flight are passed over.
#[inline(always)]
fn add_collisions<S: Simd>(
    simd: S,
    model: &CostModel,
    scratch: &Scratch,
    used: usize,
    sums: &mut [f64; MAX_LANES],
) {
    let last = model.path.samples - 1;
    for (block, start) in (0..last).step_by(BLOCK).enumerate() {
        let own = &scratch.boxes[block];
        let side = |wide: &Wide| load(simd, wide);
        let (low, high) = (
            [side(&own.low[0]), side(&own.low[1])],
            [side(&own.high[0]), side(&own.high[1])],
        );
        let mut near = 0;
        for [east_m, north_m] in model.paper.wide_boxes() {
            let (low_m, high_m) = ([east_m[0], north_m[0]], [east_m[1], north_m[1]]);
            near |= meets::<S>(&low, &high, &low_m, &high_m).to_bitmask();
        }
        // The last sample of a block is the first of the next.
        let end = (start + BLOCK).min(last);
        let samples = start..if end == last { end + 1 } else { end };
        for (lane, sum) in sums.iter_mut().enumerate().take(used) {
            if near >> lane & 1 == 1 {
                *sum = add_risks(model, scratch, lane, samples.clone(), *sum);
            }
        }
    }
}

/// The risks at some samples of one lane, added to `sum`.
fn add_risks(
    model: &CostModel,
    scratch: &Scratch,
    lane: usize,
    samples: std::ops::Range<usize>,
    mut sum: f64,
) -> f64 {
    let last = model.path.samples - 1;
    let profile = model.timing.profile(scratch.along_m[last][lane]);
    for index in samples {
        let own = scratch.curve[index].map(|wide| wide[lane]);
        let near = model.paper.near(own[0]);
        if !near.is_empty() {
            let own_s = model.timing.start_s + profile.time_at_s(scratch.along_m[index][lane]);
            sum += model.paper.collision(own, own_s, near);
        }
    }
    sum
}

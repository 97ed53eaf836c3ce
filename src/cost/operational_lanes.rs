//! The operational objective, lane by lane, in one pass over the candidates.

use std::f64::consts::PI;

use fearless_simd::prelude::*;

use super::CostTerms;
use super::block::{BLOCK, Block, Chords, Piece};
use super::lanes::{
    MOST_LANES, Place, Scratch, Steps, V, Wide, point, points, quadrant_angles, segment, splat,
    store,
};
use super::model::CostModel;
use super::operational::Sums;
use super::sampling::MOST_SUBSTEPS;

/// Fine samples of a block.
const FINE: usize = BLOCK * MOST_SUBSTEPS;

/// Clearance of every lane; see [`super::operational::Clearance`].
#[derive(Clone, Copy)]
struct Clearances<S: Simd> {
    altitude_km: V<S>,
    deficit: V<S>,
}

/// Terms of the candidates in the lanes of `scratch`, as many as `out` has; once the
/// sums of all are above `cutoff`, only so many terms that they are.
#[inline(always)]
pub(super) fn terms<S: Simd>(
    simd: S,
    model: &CostModel,
    cutoff: f64,
    scratch: &mut Scratch,
    out: &mut [CostTerms],
) {
    let zero = splat(simd, 0.0);
    let (segments, substeps) = (model.path.samples - 1, model.path.substeps);
    let mut sums = Sums {
        length_km: zero,
        altitude: zero,
        threat: zero,
        terrain: zero,
        turn: zero,
        climb: zero,
        collision: zero,
    };
    let first = point(simd, &model.path.rows[0], &scratch.controls);
    let mut block = Block::before(simd, first, scratch);
    let mut fine = [first; FINE];
    // The last of the block before, then those of this one.
    let mut clearances = [model.clearances(simd, &first, model.wanted_agl_m[0]); FINE + 1];
    for start in (0..segments).step_by(BLOCK) {
        let count = BLOCK.min(segments - start);
        let within = start * substeps + 1..(start + count) * substeps + 1;
        let fine = &mut fine[..count * substeps];
        points(
            simd,
            &model.path.rows[within.clone()],
            &scratch.controls,
            fine,
        );
        let clearances = &mut clearances[..=fine.len()];
        let wanted_agl_m = &model.wanted_agl_m[within];
        for ((at, wanted_m), of) in fine.iter().zip(wanted_agl_m).zip(&mut clearances[1..]) {
            *of = model.clearances(simd, at, *wanted_m);
        }
        block.advance(simd, fine[substeps - 1..].iter().step_by(substeps), scratch);
        for (step, of) in block
            .steps()
            .iter()
            .zip(clearances.windows(substeps + 1).step_by(substeps))
        {
            let (altitude_km, deficit) = means(of);
            let piece_km = step.length_km * model.per_substep;
            sums.altitude += altitude_km * piece_km;
            sums.terrain += deficit * piece_km;
            sums.length_km += step.length_km;
        }
        clearances[0] = clearances[fine.len()];
        for piece in block.pieces() {
            sums.climb += model.slope_excesses(simd, &piece) * piece.step.length_km;
        }
        for pair in block.turning().windows(2) {
            sums.turn += model.turn_excesses(simd, &pair[0], &pair[1]);
        }
        sums.threat = block.add_threats(simd, model, Chords, scratch, sums.threat);
        if cutoff < f64::INFINITY && all_above::<S>(model, &sums, cutoff, out) {
            return;
        }
    }
    let sums = spread::<S>(&sums);
    for (lane, terms) in out.iter_mut().enumerate() {
        let mut sums = sums.map(|wide| wide[lane]);
        if !model.traffic.is_empty() {
            add_collisions(model, scratch, lane, cutoff, &mut sums);
        }
        *terms = model.weigh(&sums);
    }
}

/// The sums of all lanes as numbers.
#[inline(always)]
fn spread<S: Simd>(sums: &Sums<V<S>>) -> Sums<Wide> {
    sums.map(
        #[inline(always)]
        |values| {
            let mut wide = [0.0; MOST_LANES];
            store::<S>(values, &mut wide);
            wide
        },
    )
}

/// Sums over the fine samples of a piece, its ends included, which count half.
#[inline(always)]
fn means<S: Simd>(of: &[Clearances<S>]) -> (V<S>, V<S>) {
    let [first, within @ .., last] = of else {
        unreachable!("a piece has two ends")
    };
    let (mut altitude_km, mut deficit) = (first.altitude_km * 0.5, first.deficit * 0.5);
    for fine in within {
        altitude_km += fine.altitude_km;
        deficit += fine.deficit;
    }
    (
        altitude_km + last.altitude_km * 0.5,
        deficit + last.deficit * 0.5,
    )
}

/// Whether the terms so far, which are then left in `out`, are above the cutoff in all lanes.
#[inline(always)]
fn all_above<S: Simd>(
    model: &CostModel,
    sums: &Sums<V<S>>,
    cutoff: f64,
    out: &mut [CostTerms],
) -> bool {
    let terms = model.weigh_lanes::<S>(sums);
    // In the order of [`CostTerms::total`].
    let total = terms.iter().skip(1).fold(
        terms[0],
        #[inline(always)]
        |sum, term| sum + *term,
    );
    let is_above = total.simd_gt(cutoff).all_true();
    if is_above {
        let sums = spread::<S>(sums);
        for (lane, terms) in out.iter_mut().enumerate() {
            *terms = model.weigh(&sums.map(|wide| wide[lane]));
        }
    }
    is_above
}

impl CostModel {
    /// [`CostModel::clearance`] at a fine sample.
    #[inline(always)]
    fn clearances<S: Simd>(&self, simd: S, at: &Place<S>, wanted_agl_m: f64) -> Clearances<S> {
        let agl_m = at[2] - self.relief.heights_m(simd, at[0], at[1]);
        let below_m = (splat(simd, wanted_agl_m) - agl_m).max(0.0);
        let above_m = (at[2] - self.max_amsl_m).max(0.0);
        Clearances {
            altitude_km: (agl_m - self.min_agl_m).max(0.0) * 1e-3,
            deficit: (below_m + above_m) * self.per_depth,
        }
    }

    /// [`CostModel::slope_excess`].
    #[inline(always)]
    fn slope_excesses<S: Simd>(&self, simd: S, piece: &Piece<'_, S>) -> V<S> {
        let zero = splat(simd, 0.0);
        let step = piece.step;
        let limit = self.slope_limits(simd, (piece.a[2] + piece.b[2]) * 0.5, step.rise_m);
        let limit = limit.min(step.rise_m.simd_ge(0.0).select(
            splat(simd, self.limits.climb.by_speed()),
            splat(simd, self.limits.descent.by_speed()),
        ));
        let excess_m = step.rise_m.abs() - limit * self.slope_share * step.run_m;
        let is_steep = excess_m.simd_gt(0.0);
        if is_steep.any_true() {
            is_steep.select(excess_m / step.run_m.max(1e-3), zero)
        } else {
            zero
        }
    }

    /// [`CostModel::turn_excess`].
    #[inline(always)]
    fn turn_excesses<S: Simd>(&self, simd: S, into: &Steps<S>, out: &Steps<S>) -> V<S> {
        let tight = self.too_tight(simd, into, out);
        if !tight.any_true() {
            return splat(simd, 0.0);
        }
        let ratio = into.run_m.min(out.run_m) * self.per_turn_radius;
        let dot = into.east_m * out.east_m + into.north_m * out.north_m;
        let cross = into.east_m * out.north_m - into.north_m * out.east_m;
        let sharp_rad = quadrant_angles(simd, cross.abs(), dot.abs());
        let turn_rad = dot
            .simd_lt(0.0)
            .select(splat(simd, PI) - sharp_rad, sharp_rad);
        let one = splat(simd, 1.0);
        let sine = (ratio * 0.5).min(one);
        let limit_rad = quadrant_angles(simd, sine, ((one - sine) * (one + sine)).sqrt()) * 2.0;
        let excess = (turn_rad / limit_rad - 1.0).max(0.0);
        tight.select(excess, splat(simd, 0.0))
    }
}

/// Separation of one lane from earlier flights, until its total is above the cutoff.
fn add_collisions(model: &CostModel, scratch: &Scratch, lane: usize, cutoff: f64, sums: &mut Sums) {
    let last = model.path.samples - 1;
    let piece = |k: usize| segment(&scratch.curve, k, lane);
    let length_m = scratch.along_m[last][lane];
    let profile = model.timing.profile(length_m);
    let time_s = |k: usize| model.timing.start_s + profile.time_at_s(scratch.along_m[k][lane]);
    let mut start_s = time_s(0);
    for (block, start) in (0..last).step_by(BLOCK).enumerate() {
        let end = (start + BLOCK).min(last);
        let end_s = time_s(end);
        let (low, high) = scratch.boxes[block].lane(lane);
        let times = (start_s, end_s);
        start_s = end_s;
        if model
            .traffic
            .is_clear(&[times, (low[0], high[0]), (low[1], high[1])])
        {
            continue;
        }
        for k in start..end {
            let piece = piece(k);
            let range = |axis: usize| {
                let (a, b) = (piece.a[axis], piece.b[axis]);
                (a.min(b), a.max(b))
            };
            let times = (time_s(k), time_s(k + 1));
            if model.traffic.is_clear(&[times, range(0), range(1)]) {
                continue;
            }
            let reach_m = (scratch.along_m[k][lane], scratch.along_m[k + 1][lane]);
            let mut mean = 0.0;
            model
                .timing
                .motions(&piece, reach_m, &profile, |motion, share| {
                    mean += model.traffic.mean_severity(&motion) * share;
                });
            sums.collision += mean * super::operational::Step::of(&piece).length_km;
        }
        if model.weigh(sums).total() > cutoff {
            return;
        }
    }
    let end = piece(last - 1);
    let place = [end.b[0], end.b[1], end.amsl_b_m];
    if let Some(motion) = model.timing.motion_after(place, length_m) {
        sums.collision += model.traffic.mean_severity(&motion) * model.timing.after_km;
    }
}

//! The operational objective, lane by lane, in one pass over the candidates.

use std::f64::consts::PI;

use fearless_simd::prelude::*;

use super::CostTerms;
use super::lanes::{
    BLOCK, BlockBox, MOST_LANES, Place, Scratch, Steps, V, Wide, load_place, near_hazards, point,
    quadrant_angles, segment, splat, steps, store, store_place,
};
use super::model::CostModel;
use super::operational::Sums;

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
    let mut along_m = zero;
    store::<S>(along_m, &mut scratch.along_m[0]);
    let mut a = point(simd, &model.path.rows[0], &scratch.controls);
    store_place::<S>(&a, &mut scratch.curve[0]);
    let mut clearance = model.clearances(simd, &a, 0);
    let mut before: Option<Steps<S>> = None;
    for (block, start) in (0..segments).step_by(BLOCK).enumerate() {
        let end = (start + BLOCK).min(segments);
        let (mut low, mut high) = ([a[0], a[1]], [a[0], a[1]]);
        for k in start..end {
            let mut above = clearance.altitude_km * 0.5;
            let mut deficit = clearance.deficit * 0.5;
            let mut b = a;
            for index in k * substeps + 1..=(k + 1) * substeps {
                b = point(simd, &model.path.rows[index], &scratch.controls);
                store_place::<S>(&b, &mut scratch.curve[index]);
                clearance = model.clearances(simd, &b, index);
                let is_end = index == (k + 1) * substeps;
                let share = if is_end { 0.5 } else { 1.0 };
                above += clearance.altitude_km * share;
                deficit += clearance.deficit * share;
            }
            for axis in 0..2 {
                low[axis] = low[axis].min(b[axis]);
                high[axis] = high[axis].max(b[axis]);
            }
            let step = steps::<S>(&a, &b);
            along_m += step.run_m;
            store::<S>(along_m, &mut scratch.along_m[k + 1]);
            sums.length_km += step.length_km;
            let piece_km = step.length_km * model.per_substep;
            sums.altitude += above * piece_km;
            sums.terrain += deficit * piece_km;
            sums.climb += model.slope_excesses(simd, &a, &b, &step) * step.length_km;
            if let Some(before) = &before {
                sums.turn += model.turn_excesses(simd, before, &step);
            }
            before = Some(step);
            a = b;
        }
        BlockBox::store::<S>(&low, &high, &mut scratch.boxes[block]);
        sums.threat = add_threats(
            simd,
            model,
            scratch,
            (start, end),
            (&low, &high),
            sums.threat,
        );
        if cutoff < f64::INFINITY && all_above(model, &spread::<S>(&sums), cutoff, out) {
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

/// Whether the terms so far, which are left in `out`, are above the cutoff in all lanes.
fn all_above(model: &CostModel, sums: &Sums<Wide>, cutoff: f64, out: &mut [CostTerms]) -> bool {
    let mut all = true;
    for (lane, terms) in out.iter_mut().enumerate() {
        *terms = model.weigh(&sums.map(|wide| wide[lane]));
        all &= terms.total() > cutoff;
    }
    all
}

impl CostModel {
    /// [`CostModel::clearance`] at a fine sample.
    #[inline(always)]
    fn clearances<S: Simd>(&self, simd: S, at: &Place<S>, index: usize) -> Clearances<S> {
        let agl_m = at[2] - self.relief.heights_m(simd, at[0], at[1]);
        let below_m = (splat(simd, self.wanted_agl_m[index]) - agl_m).max(0.0);
        let above_m = (at[2] - self.max_amsl_m).max(0.0);
        Clearances {
            altitude_km: (agl_m - self.min_agl_m).max(0.0) * 1e-3,
            deficit: (below_m + above_m) * self.per_depth,
        }
    }

    /// [`CostModel::slope_excess`].
    #[inline(always)]
    fn slope_excesses<S: Simd>(
        &self,
        simd: S,
        a: &Place<S>,
        b: &Place<S>,
        step: &Steps<S>,
    ) -> V<S> {
        let zero = splat(simd, 0.0);
        let limit = self.slope_limits(simd, (a[2] + b[2]) * 0.5, step.rise_m);
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

    /// The limit by shape at an altitude, up or down as the rise is.
    #[inline(always)]
    pub(super) fn slope_limits<S: Simd>(&self, simd: S, amsl_m: V<S>, rise_m: V<S>) -> V<S> {
        let (up, down) = (
            self.limits.climb.polynomial(),
            self.limits.descent.polynomial(),
        );
        let rises = rise_m.simd_ge(0.0);
        let pick = |i: usize| rises.select(splat(simd, up[i]), splat(simd, down[i]));
        if self.limits.are_even() {
            return pick(2);
        }
        let z_m = amsl_m.max(0.0).min(crate::path::POLYNOMIAL_TOP_M);
        ((pick(0) * z_m + pick(1)) * z_m + pick(2)).max(0.0)
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

/// Threats, zones and area for the pieces of one block, added to `sum`.
#[inline(always)]
fn add_threats<S: Simd>(
    simd: S,
    model: &CostModel,
    scratch: &mut Scratch,
    (start, end): (usize, usize),
    (low, high): (&[V<S>; 2], &[V<S>; 2]),
    mut sum: V<S>,
) -> V<S> {
    let hazards = &model.hazards;
    let (zones, outside) = near_hazards(simd, hazards, low, high, &mut scratch.near);
    if scratch.near.is_empty() && zones | outside == 0 {
        return sum;
    }
    let substeps = model.path.substeps;
    let mut a = load_place(simd, &scratch.curve[start * substeps]);
    for k in start..end {
        let b = load_place(simd, &scratch.curve[(k + 1) * substeps]);
        let step = steps::<S>(&a, &b);
        let mut exposure = splat(simd, 0.0);
        for &index in &scratch.near {
            exposure += hazards.threats[index].exposures(simd, &a, &step);
        }
        let mut lanes = zones | outside;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            let piece = segment(&scratch.curve, k * substeps, (k + 1) * substeps, lane);
            exposure[lane] = hazards.add_polygons(&piece, exposure[lane], &mut scratch.crossings);
            lanes &= lanes - 1;
        }
        sum += exposure * step.length_km;
        a = b;
    }
    sum
}

/// Separation of one lane from earlier flights, until its total is above the cutoff.
fn add_collisions(model: &CostModel, scratch: &Scratch, lane: usize, cutoff: f64, sums: &mut Sums) {
    let (last, substeps) = (model.path.samples - 1, model.path.substeps);
    let piece = |k: usize| segment(&scratch.curve, k * substeps, (k + 1) * substeps, lane);
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

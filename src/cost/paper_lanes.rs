//! The paper's objective, lane by lane, in one pass over the candidates.

use fearless_simd::prelude::*;

use super::CostTerms;
use super::hazards::Threat;
use super::lanes::{
    BLOCK, BlockBox, MOST_LANES, Place, Scratch, Steps, V, Wide, load_place, near_hazards, point,
    segment, splat, steps, store, store_place,
};
use super::model::CostModel;
use super::paper::{Paper, PaperSums, ThreatForm};

/// Terms of the candidates in the lanes of `scratch`, as many as `out` has.
#[inline(always)]
pub(super) fn terms<S: Simd>(
    simd: S,
    model: &CostModel,
    scratch: &mut Scratch,
    out: &mut [CostTerms],
) {
    let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
    let (paper, segments) = (&model.paper, model.path.samples - 1);
    let mut along_m = zero;
    let mut a = point(simd, &model.path.rows[0], &scratch.controls);
    let (altitude, terrain) = paper.height_lanes(simd, model, &a, 0);
    let mut sums = PaperSums {
        length_km: zero,
        altitude,
        threat: zero,
        terrain,
        turns: zero,
        climb: zero,
        collision: zero,
    };
    store::<S>(along_m, &mut scratch.along_m[0]);
    store_place::<S>(&a, &mut scratch.curve[0]);
    let mut before: Option<Steps<S>> = None;
    for (block, start) in (0..segments).step_by(BLOCK).enumerate() {
        let end = (start + BLOCK).min(segments);
        let (mut low, mut high) = ([a[0], a[1]], [a[0], a[1]]);
        for k in start..end {
            let b = point(simd, &model.path.rows[k + 1], &scratch.controls);
            store_place::<S>(&b, &mut scratch.curve[k + 1]);
            for axis in 0..2 {
                low[axis] = low[axis].min(b[axis]);
                high[axis] = high[axis].max(b[axis]);
            }
            let (high_km, deep_km) = paper.height_lanes(simd, model, &b, k + 1);
            sums.altitude += high_km;
            sums.terrain += deep_km;
            let step = steps::<S>(&a, &b);
            along_m += step.run_m;
            store::<S>(along_m, &mut scratch.along_m[k + 1]);
            sums.length_km += step.length_km;
            sums.climb += slope_excesses(simd, model, &a, &step);
            if let Some(before) = &before {
                let tight = model.too_tight(simd, before, &step);
                sums.turns += tight.select(one, zero);
            }
            before = Some(step);
            a = b;
        }
        BlockBox::store::<S>(&low, &high, &mut scratch.boxes[block]);
        let range = (start, end);
        sums.threat = add_threats(simd, model, scratch, range, (&low, &high), sums.threat);
    }
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
        *terms = paper.weigh(model, &sums);
    }
}

impl Paper {
    /// [`Paper::heights`] in every lane.
    #[inline(always)]
    fn height_lanes<S: Simd>(
        &self,
        simd: S,
        model: &CostModel,
        at: &Place<S>,
        index: usize,
    ) -> (V<S>, V<S>) {
        let ground_m = model.relief.heights_m(simd, at[0], at[1]);
        let over_m = if self.options.altitude_over_ground {
            at[2] - ground_m
        } else {
            at[2]
        };
        let mut high_m = over_m - model.min_agl_m;
        if !self.options.altitude_unclamped {
            high_m = high_m.max(0.0);
        }
        let below_m = (ground_m + self.wanted_m(model, index) - at[2]).max(0.0);
        let deep_m = below_m + (at[2] - model.max_amsl_m).max(0.0);
        (high_m * 1e-3, deep_m * 1e-3)
    }
}

/// Eq. 26 in every lane.
#[inline(always)]
fn slope_excesses<S: Simd>(simd: S, model: &CostModel, a: &Place<S>, step: &Steps<S>) -> V<S> {
    let limit = model.slope_limits(simd, a[2], step.rise_m);
    let excess_m = step.rise_m.abs() - limit * model.slope_share * step.run_m;
    let is_steep = excess_m.simd_gt(0.0);
    if is_steep.any_true() {
        is_steep.select(excess_m / step.run_m.max(1e-3), splat(simd, 0.0))
    } else {
        splat(simd, 0.0)
    }
}

/// Eq. 24 for the pieces of one block, with zones and area, added to `sum`.
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
    let form = model.paper.options.threat_form;
    let mut a = load_place(simd, &scratch.curve[start]);
    for k in start..end {
        let b = load_place(simd, &scratch.curve[k + 1]);
        let middle = [(a[0] + b[0]) * 0.5, (a[1] + b[1]) * 0.5];
        let mut exposure = splat(simd, 0.0);
        for &index in &scratch.near {
            exposure += dangers(simd, &hazards.threats[index], form, &middle);
        }
        let mut lanes = zones | outside;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            let piece = segment(&scratch.curve, k, k + 1, lane);
            exposure[lane] = hazards.add_polygons(&piece, exposure[lane], &mut scratch.crossings);
            lanes &= lanes - 1;
        }
        sum += exposure * steps::<S>(&a, &b).length_km;
        a = b;
    }
    sum
}

/// `T_de` of one threat in every lane.
#[inline(always)]
fn dangers<S: Simd>(simd: S, threat: &Threat, form: ThreatForm, at: &[V<S>; 2]) -> V<S> {
    let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
    let (east_m, north_m) = (at[0] - threat.center[0], at[1] - threat.center[1]);
    let apart_sq = east_m * east_m + north_m * north_m;
    let radius_sq = threat.radius_m * threat.radius_m;
    if !apart_sq.simd_lt(radius_sq).any_true() {
        return zero;
    }
    let share_sq = apart_sq / radius_sq;
    let danger = match form {
        ThreatForm::Quartic => one / (share_sq * share_sq + 1.0),
        ThreatForm::Linear => one - share_sq.sqrt(),
    };
    share_sq.simd_lt(1.0).select(danger, zero)
}

/// Eq. 28 to 30: blocks that are near no earlier flight are passed over.
#[inline(always)]
fn add_collisions<S: Simd>(
    simd: S,
    model: &CostModel,
    scratch: &Scratch,
    used: usize,
    sums: &mut [f64; MOST_LANES],
) {
    let last = model.path.samples - 1;
    for (block, start) in (0..last).step_by(BLOCK).enumerate() {
        let own = &scratch.boxes[block];
        let side = |wide: &Wide| super::lanes::load(simd, wide);
        let (low, high) = (
            [side(&own.low[0]), side(&own.low[1])],
            [side(&own.high[0]), side(&own.high[1])],
        );
        let mut meets = 0;
        for [east_m, north_m] in model.paper.wide_boxes() {
            let near = high[0].simd_ge(east_m[0])
                & low[0].simd_le(east_m[1])
                & high[1].simd_ge(north_m[0])
                & low[1].simd_le(north_m[1]);
            meets |= near.to_bitmask();
        }
        // The last sample of a block is the first of the next.
        let end = (start + BLOCK).min(last);
        let samples = start..if end == last { end + 1 } else { end };
        for (lane, sum) in sums.iter_mut().enumerate().take(used) {
            if meets >> lane & 1 == 1 {
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

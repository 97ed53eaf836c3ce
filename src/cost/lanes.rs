//! Several candidates side by side, one in each lane of a vector.
//!
//! Every lane does what the plain reference does, in its order and without fused
//! multiply-add, so results are the same to the bit with any number of lanes. What
//! is rare is left to the scalar code, lane by lane. All functions are inlined into
//! one caller that is compiled for the instructions at hand.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use fearless_simd::prelude::*;

use super::hazards::{FORBIDDEN, Hazards, Segment, Threat};
use super::model::CostModel;
use crate::numeric::angle::{ATAN, TAN_PI_8};

/// Lanes of the widest vectors.
pub(super) const MOST_LANES: usize = 8;
/// One number for each lane; narrower vectors use the first ones.
pub(super) type Wide = [f64; MOST_LANES];
/// A vector of the instructions at hand.
pub(super) type V<S> = <S as Simd>::f64s;
/// A point of every lane: east, north, altitude.
pub(super) type Place<S> = [V<S>; 3];

/// Segments for which hazards are culled together, and between two looks at the cutoff.
pub(super) const BLOCK: usize = 10;

/// Buffers of an evaluation; they grow on first use and are then reused.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    /// Control points of each lane: east, north, altitude.
    pub(super) controls: Vec<[Wide; 3]>,
    /// The curves at the fine samples.
    pub(super) curve: Vec<[Wide; 3]>,
    /// Horizontal distance along the routes at the samples, metres.
    pub(super) along_m: Vec<Wide>,
    /// Boxes of the blocks.
    pub(super) boxes: Vec<BlockBox>,
    /// Threats near the block at hand.
    pub(super) near: Vec<usize>,
    pub(super) crossings: Vec<(f64, i32)>,
}

/// Least and greatest east and north of every lane.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BlockBox {
    pub(super) low: [Wide; 2],
    pub(super) high: [Wide; 2],
}

/// A step of every lane; see [`super::operational::Step`].
#[derive(Clone, Copy)]
pub(super) struct Steps<S: Simd> {
    pub(super) east_m: V<S>,
    pub(super) north_m: V<S>,
    pub(super) rise_m: V<S>,
    pub(super) run_sq: V<S>,
    pub(super) run_m: V<S>,
    pub(super) length_km: V<S>,
}

#[inline(always)]
pub(super) fn splat<S: Simd>(simd: S, value: f64) -> V<S> {
    V::<S>::splat(simd, value)
}

#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, wide: &Wide) -> V<S> {
    V::<S>::from_slice(simd, &wide[..V::<S>::LEN])
}

#[inline(always)]
pub(super) fn store<S: Simd>(value: V<S>, wide: &mut Wide) {
    value.store_slice(&mut wide[..V::<S>::LEN]);
}

#[inline(always)]
pub(super) fn load_place<S: Simd>(simd: S, place: &[Wide; 3]) -> Place<S> {
    [
        load(simd, &place[0]),
        load(simd, &place[1]),
        load(simd, &place[2]),
    ]
}

#[inline(always)]
pub(super) fn store_place<S: Simd>(place: &Place<S>, to: &mut [Wide; 3]) {
    for axis in 0..3 {
        store::<S>(place[axis], &mut to[axis]);
    }
}

/// A point of the curves from a row of the basis.
#[inline(always)]
pub(super) fn point<S: Simd>(
    simd: S,
    (first, weights): &(usize, [f64; 4]),
    controls: &[[Wide; 3]],
) -> Place<S> {
    let four = &controls[*first..][..4];
    let weights = [
        splat(simd, weights[0]),
        splat(simd, weights[1]),
        splat(simd, weights[2]),
        splat(simd, weights[3]),
    ];
    let mut place = [splat(simd, 0.0); 3];
    for (axis, value) in place.iter_mut().enumerate() {
        *value = weights[0] * load(simd, &four[0][axis])
            + weights[1] * load(simd, &four[1][axis])
            + weights[2] * load(simd, &four[2][axis])
            + weights[3] * load(simd, &four[3][axis]);
    }
    place
}

/// The step between two points.
#[inline(always)]
pub(super) fn steps<S: Simd>(a: &Place<S>, b: &Place<S>) -> Steps<S> {
    let (east_m, north_m, rise_m) = (b[0] - a[0], b[1] - a[1], b[2] - a[2]);
    let run_sq = east_m * east_m + north_m * north_m;
    Steps {
        east_m,
        north_m,
        rise_m,
        run_sq,
        run_m: run_sq.sqrt(),
        length_km: (run_sq + rise_m * rise_m).sqrt() * 1e-3,
    }
}

/// [`quadrant_angle`](crate::numeric::angle::quadrant_angle) in every lane.
#[inline(always)]
pub(super) fn quadrant_angles<S: Simd>(simd: S, opposite: V<S>, adjacent: V<S>) -> V<S> {
    let is_steep = opposite.simd_gt(adjacent);
    let low = is_steep.select(adjacent, opposite);
    let high = is_steep.select(opposite, adjacent);
    let is_far = low.simd_gt(high * TAN_PI_8);
    let z = is_far.select(low - high, low) / is_far.select(low + high, high);
    let w = z * z;
    let mut sum = splat(simd, ATAN[10]);
    for coefficient in ATAN[..10].iter().rev() {
        sum = sum * w + *coefficient;
    }
    let angle = z + z * (w * sum);
    let angle = is_far.select(splat(simd, FRAC_PI_4) + angle, angle);
    is_steep.select(splat(simd, FRAC_PI_2) - angle, angle)
}

/// The piece of one lane between two fine samples.
#[inline]
pub(super) fn segment(curve: &[[Wide; 3]], from: usize, to: usize, lane: usize) -> Segment {
    let (a, b) = (&curve[from], &curve[to]);
    Segment {
        a: [a[0][lane], a[1][lane]],
        b: [b[0][lane], b[1][lane]],
        amsl_a_m: a[2][lane],
        amsl_b_m: b[2][lane],
    }
}

impl CostModel {
    /// Which lanes turn more tightly than they may; see [`CostModel::is_too_tight`].
    #[inline(always)]
    pub(super) fn too_tight<S: Simd>(
        &self,
        simd: S,
        into: &Steps<S>,
        out: &Steps<S>,
    ) -> <V<S> as SimdBase<S>>::Mask {
        let ratio = into.run_m.min(out.run_m) * self.per_turn_radius;
        let cosine_limit = (splat(simd, 1.0) - ratio * 0.5 * ratio).max(-1.0);
        let dot = into.east_m * out.east_m + into.north_m * out.north_m;
        dot.simd_lt(into.run_m * out.run_m * cosine_limit)
    }
}

impl BlockBox {
    #[inline(always)]
    pub(super) fn store<S: Simd>(low: &[V<S>; 2], high: &[V<S>; 2], to: &mut Self) {
        for axis in 0..2 {
            store::<S>(low[axis], &mut to.low[axis]);
            store::<S>(high[axis], &mut to.high[axis]);
        }
    }

    /// The corners of one lane.
    pub(super) fn lane(&self, lane: usize) -> ([f64; 2], [f64; 2]) {
        (
            [self.low[0][lane], self.low[1][lane]],
            [self.high[0][lane], self.high[1][lane]],
        )
    }
}

/// What of the hazards may matter to a block: `near` is filled with the threats, and
/// told are the lanes that need a look at zones and at the edge of the area.
#[inline(always)]
pub(super) fn near_hazards<S: Simd>(
    simd: S,
    hazards: &Hazards,
    low: &[V<S>; 2],
    high: &[V<S>; 2],
    near: &mut Vec<usize>,
) -> (u64, u64) {
    near.clear();
    for (index, threat) in hazards.threats.iter().enumerate() {
        if threat.may_reach(simd, low, high) {
            near.push(index);
        }
    }
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
        gap_sq
            .simd_le(self.radius_m * self.radius_m * (1.0 + 1e-9))
            .any_true()
    }

    /// What one kilometre of the piece of each lane costs for this threat; see
    /// [`Threat::exposure`].
    #[inline(always)]
    pub(super) fn exposures<S: Simd>(&self, simd: S, a: &Place<S>, step: &Steps<S>) -> V<S> {
        let zero = splat(simd, 0.0);
        let from = [a[0] - self.center[0], a[1] - self.center[1]];
        let square = step.run_sq;
        let outside = from[0] * from[0] + from[1] * from[1] - self.radius_m * self.radius_m;
        let half = from[0] * step.east_m + from[1] * step.north_m;
        let discriminant = half * half - square * outside;
        let points = square.simd_le(0.0) & outside.simd_lt(0.0);
        let root = discriminant.max(zero).sqrt();
        let (first, last) = (-half - root, -half + root);
        let meets = discriminant.simd_gt(0.0) & last.simd_gt(0.0) & first.simd_lt(square);
        if !(meets | points).any_true() {
            return zero;
        }
        let enter = (first / square).max(0.0);
        let leave = (last / square).min(1.0);
        let nearest = (-half / square).max(0.0).min(1.0);
        let gap = [
            from[0] + nearest * step.east_m,
            from[1] + nearest * step.north_m,
        ];
        let closest = (gap[0] * gap[0] + gap[1] * gap[1]).sqrt();
        let through = (leave - enter) * (splat(simd, FORBIDDEN) - closest / self.radius_m);
        let through = (meets & leave.simd_gt(enter)).select(through, zero);
        if !points.any_true() {
            return through;
        }
        // A piece that goes nowhere, or straight up.
        let stays = (from[0] * from[0] + from[1] * from[1]).sqrt();
        let over = splat(simd, FORBIDDEN) - stays / self.radius_m;
        points.select(over, through)
    }
}

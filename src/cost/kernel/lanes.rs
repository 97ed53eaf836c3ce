//! Several candidates side by side, one in each lane of a vector.
//!
//! Every lane does what the plain reference does, in its order and without fused
//! multiply-add, so results are the same to the bit with any number of lanes. What
//! is rare is left to the scalar code, lane by lane. All functions are inlined into
//! one caller that is compiled for the instructions at hand.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use fearless_simd::prelude::*;

use crate::numeric::angle::{ATAN, TAN_PI_8};

/// Lanes of the widest vectors.
pub(crate) const MAX_LANES: usize = 8;
/// One number for each lane; narrower vectors use the first ones.
pub(crate) type Wide = [f64; MAX_LANES];
/// A vector of the instructions at hand.
pub(crate) type V<S> = <S as Simd>::f64s;
/// A choice of lanes.
pub(crate) type Lanes<S> = <V<S> as SimdBase<S>>::Mask;
/// A point of every lane: east, north, altitude.
pub(crate) type Position<S> = [V<S>; 3];

/// A step of every lane; see [`crate::cost::operational::Step`].
#[derive(Clone, Copy)]
pub(crate) struct Steps<S: Simd> {
    pub(crate) east_m: V<S>,
    pub(crate) north_m: V<S>,
    pub(crate) rise_m: V<S>,
    pub(crate) run_sq: V<S>,
    pub(crate) length_km: V<S>,
}

impl<S: Simd> Steps<S> {
    /// Horizontal lengths: a root, which most pieces do not need.
    #[inline(always)]
    pub(crate) fn run_m(&self) -> V<S> {
        self.run_sq.sqrt()
    }
}

#[inline(always)]
pub(crate) fn splat<S: Simd>(simd: S, value: f64) -> V<S> {
    V::<S>::splat(simd, value)
}

#[inline(always)]
pub(crate) fn load<S: Simd>(simd: S, wide: &Wide) -> V<S> {
    V::<S>::from_slice(simd, &wide[..V::<S>::LEN])
}

#[inline(always)]
pub(crate) fn store<S: Simd>(value: V<S>, wide: &mut Wide) {
    value.store_slice(&mut wide[..V::<S>::LEN]);
}

#[inline(always)]
pub(crate) fn store_position<S: Simd>(position: &Position<S>, to: &mut [Wide; 3]) {
    for axis in 0..3 {
        store::<S>(position[axis], &mut to[axis]);
    }
}

/// A point of the curves from a row of the basis.
#[inline(always)]
pub(crate) fn point<S: Simd>(
    simd: S,
    (first, weights): &(usize, [f64; 4]),
    controls: &[[Wide; 3]],
) -> Position<S> {
    let four = &controls[*first..][..4];
    let weights = [
        splat(simd, weights[0]),
        splat(simd, weights[1]),
        splat(simd, weights[2]),
        splat(simd, weights[3]),
    ];
    let mut position = [splat(simd, 0.0); 3];
    for (axis, value) in position.iter_mut().enumerate() {
        *value = weights[0] * load(simd, &four[0][axis])
            + weights[1] * load(simd, &four[1][axis])
            + weights[2] * load(simd, &four[2][axis])
            + weights[3] * load(simd, &four[3][axis]);
    }
    position
}

/// The same of several rows.
#[inline(always)]
pub(crate) fn points<S: Simd>(
    simd: S,
    rows: &[(usize, [f64; 4])],
    controls: &[[Wide; 3]],
    positions: &mut [Position<S>],
) {
    for (row, position) in rows.iter().zip(positions) {
        *position = point(simd, row, controls);
    }
}

/// The step between two points.
#[inline(always)]
pub(crate) fn steps<S: Simd>(a: &Position<S>, b: &Position<S>) -> Steps<S> {
    let (east_m, north_m, rise_m) = (b[0] - a[0], b[1] - a[1], b[2] - a[2]);
    let run_sq = east_m * east_m + north_m * north_m;
    Steps {
        east_m,
        north_m,
        rise_m,
        run_sq,
        length_km: (run_sq + rise_m * rise_m).sqrt() * 1e-3,
    }
}

/// [`quadrant_angle`](crate::numeric::angle::quadrant_angle) in every lane.
#[inline(always)]
pub(crate) fn quadrant_angles<S: Simd>(simd: S, opposite: V<S>, adjacent: V<S>) -> V<S> {
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

/// Products of the horizontal vectors.
#[inline(always)]
pub(crate) fn dot<S: Simd>(into: &Steps<S>, out: &Steps<S>) -> V<S> {
    into.east_m * out.east_m + into.north_m * out.north_m
}

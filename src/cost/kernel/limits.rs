//! The limits on slopes and turns in every lane.
//!
//! Hardly a piece breaks one, so all are looked at from afar first: by squares instead of
//! roots, and against the lowest slope limit of any altitude.

use fearless_simd::prelude::*;

use super::lanes::{Lanes, Steps, V, dot, splat};
use crate::cost::model::CostModel;
use crate::path::{POLYNOMIAL_TOP_M, SlopeLimit};

/// More than rounding makes of a comparison, as a share.
const ROUNDING: f64 = 1e-9;

/// The limits on slopes and turns in every lane.
#[derive(Clone, Copy)]
pub(crate) struct LimitLanes<S: Simd> {
    simd: S,
    /// Coefficients up and down, and limits by vertical speed.
    up: [V<S>; 3],
    down: [V<S>; 3],
    by_speed: [V<S>; 2],
    /// Whether they are the same at all altitudes.
    are_even: bool,
    share: V<S>,
    /// A little less than that.
    share_within: V<S>,
    /// Squares of slopes up and down that are within the limits up to the ceiling.
    allowed_sq: [V<S>; 2],
    max_amsl_m: V<S>,
    /// A little more than one, and half the square of one over the turn radius.
    one: V<S>,
    per_square: V<S>,
}

impl<S: Simd> LimitLanes<S> {
    /// By shape alone, or by vertical speed too.
    #[inline(always)]
    pub(crate) fn new(simd: S, model: &CostModel, by_speed: bool) -> Self {
        let wide = |of: [f64; 3]| [splat(simd, of[0]), splat(simd, of[1]), splat(simd, of[2])];
        let (climb, descent) = (&model.limits.climb, &model.limits.descent);
        let speeds = if by_speed {
            [climb.by_speed(), descent.by_speed()]
        } else {
            [f64::INFINITY; 2]
        };
        let share_within = (model.slope_share * (1.0 - ROUNDING)).max(0.0);
        let allowed_sq = |limit: &SlopeLimit, by_speed: f64| {
            let slope = limit.min_by_shape(model.max_amsl_m).min(by_speed) * share_within;
            splat(simd, slope * slope)
        };
        let per_radius = model.per_turn_radius;
        Self {
            simd,
            up: wide(climb.polynomial()),
            down: wide(descent.polynomial()),
            by_speed: [splat(simd, speeds[0]), splat(simd, speeds[1])],
            are_even: model.limits.are_even(),
            share: splat(simd, model.slope_share),
            share_within: splat(simd, share_within),
            allowed_sq: [allowed_sq(climb, speeds[0]), allowed_sq(descent, speeds[1])],
            max_amsl_m: splat(simd, model.max_amsl_m),
            one: splat(simd, 1.0 + ROUNDING),
            per_square: splat(simd, 0.5 * per_radius * per_radius),
        }
    }

    /// Which steps may be beyond the slope limits of some altitude up to the ceiling.
    #[inline(always)]
    pub(crate) fn may_be_steep(&self, step: &Steps<S>) -> Lanes<S> {
        let rises = step.rise_m.simd_ge(0.0);
        let allowed_sq = rises.select(self.allowed_sq[0], self.allowed_sq[1]);
        (step.rise_m * step.rise_m).simd_ge(allowed_sq * step.run_sq)
    }

    /// Which altitudes are above the ceiling, where [`Self::may_be_steep`] says nothing.
    #[inline(always)]
    pub(crate) fn are_above(&self, amsl_m: V<S>) -> Lanes<S> {
        amsl_m.simd_gt(self.max_amsl_m)
    }

    /// Which steps may be beyond their limits at an altitude: all that are, and those within
    /// rounding.
    #[inline(always)]
    fn may_be_steep_at(&self, amsl_m: V<S>, step: &Steps<S>) -> Lanes<S> {
        let limit = self.at(amsl_m, step.rise_m) * self.share_within;
        (step.rise_m * step.rise_m).simd_ge(limit * limit * step.run_sq)
    }

    /// By how much slopes, rise over run, are beyond their limits at an altitude; none if no
    /// lane's is.
    #[inline(always)]
    pub(crate) fn excesses(&self, amsl_m: V<S>, step: &Steps<S>) -> Option<V<S>> {
        if !self.may_be_steep_at(amsl_m, step).any_true() {
            return None;
        }
        let run_m = step.run_m();
        let excess_m = step.rise_m.abs() - self.at(amsl_m, step.rise_m) * self.share * run_m;
        let is_steep = excess_m.simd_gt(0.0);
        let zero = splat(self.simd, 0.0);
        (is_steep.any_true()).then(
            #[inline(always)]
            || is_steep.select(excess_m / run_m.max(1e-3), zero),
        )
    }

    /// The limits at an altitude, up or down as the rise is.
    #[inline(always)]
    fn at(&self, amsl_m: V<S>, rise_m: V<S>) -> V<S> {
        let rises = rise_m.simd_ge(0.0);
        let constant = rises.select(self.up[2], self.down[2]);
        let by_speed = rises.select(self.by_speed[0], self.by_speed[1]);
        if self.are_even {
            return constant.min(by_speed);
        }
        let z_m = amsl_m.max(0.0).min(POLYNOMIAL_TOP_M);
        let square = rises.select(self.up[0], self.down[0]);
        let linear = rises.select(self.up[1], self.down[1]);
        let by_shape = ((square * z_m + linear) * z_m + constant).max(0.0);
        by_shape.min(by_speed)
    }

    /// Which lanes may turn more tightly than they may, by the squares of both sides: all that
    /// do, and those within rounding.
    #[inline(always)]
    pub(crate) fn may_be_tight(&self, into: &Steps<S>, out: &Steps<S>) -> Lanes<S> {
        let cosine = (self.one - into.run_sq.min(out.run_sq) * self.per_square).max(0.0);
        let dot = dot(into, out);
        (dot * dot.abs()).simd_le(into.run_sq * out.run_sq * (cosine * cosine))
    }
}

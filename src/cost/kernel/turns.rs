//! Turns that may be too tight: there are hardly two at the same place of the paths, so here
//! the lanes are not candidates but turns of any of them.

use std::f64::consts::PI;

use fearless_simd::prelude::*;

use super::lanes::{Lanes, MAX_LANES, Steps, V, Wide, dot, load, quadrant_angles, splat};
use crate::cost::model::CostModel;

/// Turns that wait until there is one for every lane, and what others cost each candidate.
pub(crate) struct TightTurns {
    /// East, north and square of the length of the pieces before and after each.
    into: [Wide; 3],
    out: [Wide; 3],
    /// Lanes of their candidates.
    of: [u8; MAX_LANES],
    count: usize,
    sums: Wide,
}

impl TightTurns {
    /// No turns.
    #[inline(always)]
    pub(crate) fn none() -> Self {
        Self {
            into: [[0.0; MAX_LANES]; 3],
            out: [[0.0; MAX_LANES]; 3],
            of: [0; MAX_LANES],
            count: 0,
            sums: [0.0; MAX_LANES],
        }
    }

    /// Adds a turn of the candidate in one lane, behind those of its that were added; whether
    /// there is one for every lane then.
    #[expect(clippy::cast_possible_truncation, reason = "there are few lanes")]
    #[inline(always)]
    pub(crate) fn push<S: Simd>(
        &mut self,
        (into, out): (&Steps<S>, &Steps<S>),
        lane: usize,
    ) -> bool {
        let at = self.count % V::<S>::LEN;
        for (step, to) in [(into, &mut self.into), (out, &mut self.out)] {
            to[0][at] = step.east_m.as_slice()[lane];
            to[1][at] = step.north_m.as_slice()[lane];
            to[2][at] = step.run_sq.as_slice()[lane];
        }
        self.of[at] = lane as u8;
        self.count = at + 1;
        self.count == V::<S>::LEN
    }

    /// Adds what the turns that wait cost, each at least 0.
    #[inline(always)]
    pub(crate) fn flush<S: Simd>(&mut self, simd: S, cost: impl Fn(&Steps<S>, &Steps<S>) -> V<S>) {
        if self.count == 0 {
            return;
        }
        let costs = cost(&pieces(simd, &self.into), &pieces(simd, &self.out));
        let waiting = self.of.iter().zip(costs.as_slice()).take(self.count);
        for (lane, cost) in waiting {
            self.sums[usize::from(*lane) % MAX_LANES] += *cost;
        }
        self.count = 0;
    }

    /// What the turns cost that do not wait.
    #[inline(always)]
    pub(crate) fn sums<S: Simd>(&self, simd: S) -> V<S> {
        load(simd, &self.sums)
    }
}

/// Pieces by their horizontal parts alone.
#[inline(always)]
fn pieces<S: Simd>(simd: S, [east_m, north_m, run_sq]: &[Wide; 3]) -> Steps<S> {
    Steps {
        east_m: load(simd, east_m),
        north_m: load(simd, north_m),
        run_sq: load(simd, run_sq),
        rise_m: splat(simd, 0.0),
        length_km: splat(simd, 0.0),
    }
}

impl CostModel {
    /// Which lanes turn more tightly than they may; see [`CostModel::is_too_tight`].
    #[inline(always)]
    pub(crate) fn too_tight<S: Simd>(&self, simd: S, into: &Steps<S>, out: &Steps<S>) -> Lanes<S> {
        let (into_m, out_m) = (into.run_m(), out.run_m());
        let ratio = into_m.min(out_m) * self.per_turn_radius;
        let cosine_limit = (splat(simd, 1.0) - ratio * 0.5 * ratio).max(-1.0);
        dot(into, out).simd_lt(into_m * out_m * cosine_limit)
    }

    /// [`CostModel::turn_excess`] in every lane.
    #[inline(always)]
    pub(crate) fn turn_excesses<S: Simd>(&self, simd: S, into: &Steps<S>, out: &Steps<S>) -> V<S> {
        let ratio = into.run_m().min(out.run_m()) * self.per_turn_radius;
        let dot = dot(into, out);
        let cross = into.east_m * out.north_m - into.north_m * out.east_m;
        let sharp_rad = quadrant_angles(simd, cross.abs(), dot.abs());
        let turn_rad = dot
            .simd_lt(0.0)
            .select(splat(simd, PI) - sharp_rad, sharp_rad);
        let one = splat(simd, 1.0);
        let sine = (ratio * 0.5).min(one);
        let limit_rad = quadrant_angles(simd, sine, ((one - sine) * (one + sine)).sqrt()) * 2.0;
        let excess = (turn_rad / limit_rad - 1.0).max(0.0);
        let tight = self.too_tight(simd, into, out);
        tight.select(excess, splat(simd, 0.0))
    }
}

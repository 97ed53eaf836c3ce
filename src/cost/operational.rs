//! The pieces of the operational objective (design, section 4).

use std::f64::consts::PI;

use super::CostTerms;
use super::hazards::Piece;
use super::model::CostModel;
use crate::geodesy::Amsl;
use crate::numeric::angle::quadrant_angle;

/// The terms before weights: lengths in km, the rest in km times something
/// without dimension, turns a plain sum over samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sums<T = f64> {
    pub(super) length_km: T,
    pub(super) altitude: T,
    pub(super) threat: T,
    pub(super) terrain: T,
    pub(super) turn: T,
    pub(super) climb: T,
    pub(super) collision: T,
}

impl<T: Copy> Sums<T> {
    /// The same of each sum.
    #[inline(always)]
    pub(super) fn map<U>(&self, of: impl Fn(T) -> U) -> Sums<U> {
        Sums {
            length_km: of(self.length_km),
            altitude: of(self.altitude),
            threat: of(self.threat),
            terrain: of(self.terrain),
            turn: of(self.turn),
            climb: of(self.climb),
            collision: of(self.collision),
        }
    }
}

/// A piece with its lengths.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub(super) east_m: f64,
    pub(super) north_m: f64,
    pub(super) rise_m: f64,
    /// Horizontal length.
    pub(super) run_m: f64,
    /// Length in three dimensions, km.
    pub(super) length_km: f64,
}

/// Ground clearance of one fine sample: what counts as altitude (km), and how far
/// it is below what is wanted or above the ceiling, in depths.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clearance {
    pub(super) altitude_km: f64,
    pub(super) deficit: f64,
}

impl Step {
    #[inline]
    pub(super) fn of(piece: &Piece) -> Self {
        let (east_m, north_m) = (piece.b[0] - piece.a[0], piece.b[1] - piece.a[1]);
        let rise_m = piece.amsl_b_m - piece.amsl_a_m;
        let run_sq = east_m * east_m + north_m * north_m;
        Self {
            east_m,
            north_m,
            rise_m,
            run_m: run_sq.sqrt(),
            length_km: (run_sq + rise_m * rise_m).sqrt() * 1e-3,
        }
    }
}

impl CostModel {
    /// Raw sums to weighted terms (design, section 4; S cancels except in the turns).
    pub(super) fn weigh(&self, sums: &Sums) -> CostTerms {
        let weights = &self.weights;
        #[expect(clippy::cast_precision_loss, reason = "few samples")]
        let samples = self.path.samples as f64;
        CostTerms {
            length: weights.length * sums.length_km,
            altitude: weights.altitude * sums.altitude,
            threat: weights.threat * (100.0 * sums.threat),
            terrain: weights.terrain * (100.0 * sums.terrain),
            turn: weights.turn * (100.0 * self.straight_km * (sums.turn / samples)),
            climb: weights.climb * (100.0 * sums.climb),
            collision: weights.collision * (100.0 * sums.collision),
        }
    }

    /// Clearance at an altitude over ground, where so much height is wanted, and no more.
    #[inline]
    pub(super) fn clearance(
        &self,
        amsl_m: f64,
        ground_m: f64,
        [floor_agl_m, ceiling_agl_m]: [f64; 2],
    ) -> Clearance {
        let agl_m = amsl_m - ground_m;
        let mut below_m = (floor_agl_m - agl_m).max(0.0);
        let mut above_m = (amsl_m - self.max_amsl_m).max(0.0);
        if self.is_layered {
            below_m = below_m.max(self.min_amsl_m - amsl_m);
            above_m = above_m.max(agl_m - ceiling_agl_m);
        }
        Clearance {
            altitude_km: (agl_m - self.min_agl_m).max(0.0) * 1e-3,
            deficit: (below_m + above_m) * self.per_depth,
        }
    }

    /// How far the slope of a piece, rise over run, is beyond its limit.
    #[inline]
    pub(super) fn slope_excess(&self, step: &Step, piece: Piece) -> f64 {
        let middle = Amsl(0.5 * (piece.amsl_a_m + piece.amsl_b_m));
        let limit = if step.rise_m >= 0.0 {
            self.limits.climb.at(middle)
        } else {
            self.limits.descent.at(middle)
        };
        let excess_m = step.rise_m.abs() - limit * self.slope_share * step.run_m;
        if excess_m > 0.0 {
            // A vertical piece has a large slope, not an infinite one.
            excess_m / step.run_m.max(1e-3)
        } else {
            0.0
        }
    }

    /// Whether the turn between two pieces exceeds `phi_max = 2 asin(min(1, l / (2 R)))`,
    /// l the shorter of the two: as `cos(phi_max) = 1 - l^2 / (2 R^2)`, this needs no angle.
    #[inline]
    pub(super) fn is_too_tight(&self, into: &Step, out: &Step) -> bool {
        let ratio = into.run_m.min(out.run_m) * self.per_turn_radius;
        let cosine_limit = (1.0 - 0.5 * ratio * ratio).max(-1.0);
        let dot = into.east_m * out.east_m + into.north_m * out.north_m;
        dot < into.run_m * out.run_m * cosine_limit
    }

    /// By which fraction of phi_max a turn exceeds it.
    #[inline]
    pub(super) fn turn_excess(&self, into: &Step, out: &Step) -> f64 {
        if !self.is_too_tight(into, out) {
            return 0.0;
        }
        let ratio = into.run_m.min(out.run_m) * self.per_turn_radius;
        let dot = into.east_m * out.east_m + into.north_m * out.north_m;
        let cross = into.east_m * out.north_m - into.north_m * out.east_m;
        let sharp_rad = quadrant_angle(cross.abs(), dot.abs());
        let turn_rad = if dot < 0.0 { PI - sharp_rad } else { sharp_rad };
        let sine = (0.5 * ratio).min(1.0);
        let limit_rad = 2.0 * quadrant_angle(sine, ((1.0 - sine) * (1.0 + sine)).sqrt());
        (turn_rad / limit_rad - 1.0).max(0.0)
    }
}

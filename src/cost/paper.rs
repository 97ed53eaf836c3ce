//! The paper's objective (Eq. 20 to 30): seven sums over samples, in km and minutes.
//!
//! The printed formulas leave gaps; each is closed as stated at its option. Sums
//! that grow with the number of samples k are scaled by 101 / k, so that paths
//! read at 101 and 2001 samples compare. Not in the paper, but in the term they
//! belong to: lengths outside the area and inside zones (threat), height above
//! the ceiling and ground without data (terrain).

use super::{CostTerms, RouteEnds};
use crate::path::Flight;
use crate::spec::Weights;

/// How the danger of a threat falls with distance `d < R` (`T_de` of Eq. 24 is misprinted).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThreatForm {
    /// `R^4 / (R^4 + d^4)`, the usual radar model.
    Quartic,
    /// `1 - d / R`.
    Linear,
}

/// What the paper does not print. The default closes its gaps so that limits are kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperOptions {
    /// Eq. 21 with height above ground instead of sea.
    pub altitude_over_ground: bool,
    /// Eq. 21 to the letter: no clamp, heights below h_min are rewarded.
    pub altitude_unclamped: bool,
    /// `T_de` of Eq. 24.
    pub threat_form: ThreatForm,
    /// Factor on `T_de`, per km.
    pub threat_per_km: f64,
    /// Factor on Eq. 23: with 1, tunnelling costs no more than skimming a ridge.
    pub terrain_per_km: f64,
    /// Whether Eq. 23 counts from h_min above ground instead of from the ground.
    pub terrain_from_min_agl: bool,
    /// What the doubling of Eq. 25 starts from; printed is 0, which stays 0.
    pub turn_start: f64,
    /// Factor on the slope excess of Eq. 26, whose cases are lost.
    pub climb_factor: f64,
    /// PC times C of Eq. 28 and 29.
    pub collision_factor: f64,
    /// Two points are a possible collision below this distance, km.
    pub collision_km: f64,
    /// Differences in time from here on are safe, minutes.
    pub collision_min: f64,
    /// Own points this near to the goal do not count, km: the paper's goal is shared.
    pub goal_km: f64,
    /// Eq. 29 and 30 to the letter: `t = v / |gap|`, `C t^3` for t below the limit.
    pub collision_literal: bool,
}

impl Default for PaperOptions {
    fn default() -> Self {
        Self {
            altitude_over_ground: false,
            altitude_unclamped: false,
            threat_form: ThreatForm::Quartic,
            threat_per_km: 10.0,
            terrain_per_km: 200.0,
            terrain_from_min_agl: true,
            turn_start: 1.0,
            climb_factor: 100.0,
            collision_factor: 10.0,
            collision_km: 1.0,
            collision_min: 0.5,
            goal_km: 3.0,
            collision_literal: false,
        }
    }
}

impl PaperOptions {
    /// The formulas as printed, with factors 1 where none is printed.
    #[must_use]
    pub fn literal() -> Self {
        Self {
            altitude_unclamped: true,
            threat_per_km: 1.0,
            terrain_per_km: 1.0,
            terrain_from_min_agl: false,
            turn_start: 0.0,
            climb_factor: 1.0,
            collision_factor: 1.0,
            collision_literal: true,
            ..Self::default()
        }
    }
}

/// What the paper's objective needs besides the model.
#[derive(Clone, Debug)]
pub(super) struct Paper {
    pub(super) options: PaperOptions,
    goal_m: [f64; 2],
    /// Points of earlier flights from west to east.
    pub(super) others: Vec<Other>,
    /// Boxes around runs of points that follow each other: east and north, from and to.
    boxes: Vec<[[f64; 2]; 2]>,
}

/// A point of an earlier flight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Other {
    position: [f64; 3],
    t_s: f64,
    /// 101 over the points of its flight.
    weight: f64,
}

/// Points of an earlier flight that share a box.
const RUN: usize = 8;

/// The sums before factors and weights.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PaperSums<T = f64> {
    pub(super) length_km: T,
    pub(super) altitude: T,
    pub(super) threat: T,
    pub(super) terrain: T,
    pub(super) turns: T,
    pub(super) climb: T,
    pub(super) collision: T,
}

impl<T: Copy> PaperSums<T> {
    /// Every sum at one value.
    #[inline(always)]
    pub(super) fn all(value: T) -> Self {
        Self {
            length_km: value,
            altitude: value,
            threat: value,
            terrain: value,
            turns: value,
            climb: value,
            collision: value,
        }
    }
}

impl Paper {
    pub(super) fn new(options: PaperOptions, ends: &RouteEnds, earlier: &[Flight]) -> Self {
        let mut all: Vec<Other> = earlier.iter().flat_map(others).collect();
        all.sort_by(|a, b| a.position[0].total_cmp(&b.position[0]));
        Self {
            options,
            goal_m: [ends.to.at.east_m, ends.to.at.north_m],
            others: all,
            boxes: earlier.iter().flat_map(boxes).collect(),
        }
    }

    /// Boxes that hold every own point with a collision: east and north, from and to.
    pub(super) fn wide_boxes(&self) -> impl Iterator<Item = [[f64; 2]; 2]> {
        // A little more than the limit, so that rounding never hides a point.
        let widen_m = self.options.collision_km * 1e3 * (1.0 + 1e-9) + 1e-6;
        let widen = move |[low_m, high_m]: [f64; 2]| [low_m - widen_m, high_m + widen_m];
        self.boxes.iter().map(move |sides| sides.map(widen))
    }

    /// Raw sums to weighted terms.
    pub(super) fn weigh(&self, weights: &Weights, samples: usize, sums: &PaperSums) -> CostTerms {
        let options = &self.options;
        let scale = per_101(samples);
        // CT doubles at each violation: c0 (2^m - 1).
        let doubled = doublings(sums.turns * scale).exp2() - 1.0;
        CostTerms {
            length: weights.length * sums.length_km,
            altitude: weights.altitude * (sums.altitude * scale),
            threat: weights.threat * (sums.threat * options.threat_per_km),
            terrain: weights.terrain * (sums.terrain * options.terrain_per_km * scale),
            turn: weights.turn * (options.turn_start * doubled),
            climb: weights.climb * (sums.climb * options.climb_factor * scale),
            collision: weights.collision * (sums.collision * scale),
        }
    }

    /// Whether there are earlier flights.
    pub(super) fn has_others(&self) -> bool {
        !self.others.is_empty()
    }

    /// Eq. 28 to 30 for one own point and points of earlier flights.
    pub(super) fn collision(&self, own: [f64; 3], own_s: f64, others: &[Other]) -> f64 {
        let to_goal = [own[0] - self.goal_m[0], own[1] - self.goal_m[1]];
        let goal_m = self.options.goal_km * 1e3;
        if to_goal[0] * to_goal[0] + to_goal[1] * to_goal[1] < goal_m * goal_m {
            return 0.0;
        }
        others.iter().fold(0.0, |sum, other| {
            sum + other.weight * self.risk(own, own_s, other)
        })
    }

    /// The points of earlier flights that are not too far east or west.
    pub(super) fn near(&self, east_m: f64) -> &[Other] {
        let limit_m = self.options.collision_km * 1e3;
        let from = self
            .others
            .partition_point(|other| other.position[0] <= east_m - limit_m);
        let rest = &self.others[from..];
        &rest[..rest.partition_point(|other| other.position[0] < east_m + limit_m)]
    }

    /// Eq. 29 and 30 for two points.
    fn risk(&self, own: [f64; 3], own_s: f64, other: &Other) -> f64 {
        let options = &self.options;
        let position = other.position;
        let apart = [
            own[0] - position[0],
            own[1] - position[1],
            own[2] - position[2],
        ];
        let apart_sq = apart[0] * apart[0] + apart[1] * apart[1] + apart[2] * apart[2];
        let limit_m = options.collision_km * 1e3;
        if apart_sq >= limit_m * limit_m {
            return 0.0;
        }
        let gap_min = (own_s - other.t_s).abs() / 60.0;
        let cubed = if options.collision_literal {
            // v / |dis1 - dis2| is one over the gap in minutes.
            let t = 1.0 / gap_min;
            if t < options.collision_min { t } else { 0.0 }
        } else {
            (1.0 - gap_min / options.collision_min).max(0.0)
        };
        options.collision_factor * cubed * cubed * cubed
    }
}

/// The points of a flight.
fn others(flight: &Flight) -> impl Iterator<Item = Other> + '_ {
    let weight = per_101(flight.points.len());
    flight.points.iter().map(move |timed| {
        let at = timed.point.at;
        Other {
            position: [at.east_m, at.north_m, timed.point.amsl.0],
            t_s: timed.t_s,
            weight,
        }
    })
}

/// Boxes around the points of a flight, several in each.
fn boxes(flight: &Flight) -> Vec<[[f64; 2]; 2]> {
    let points: Vec<Other> = others(flight).collect();
    let around = |run: &[Other], axis: usize| {
        let values = run.iter().map(|other| other.position[axis]);
        let low_m = values.clone().fold(f64::INFINITY, f64::min);
        [low_m, values.fold(f64::NEG_INFINITY, f64::max)]
    };
    points
        .chunks(RUN)
        .map(|run| [around(run, 0), around(run, 1)])
        .collect()
}

/// How often CT doubles: for every violating point, scaled because finer sampling has more.
fn doublings(points_of_101: f64) -> f64 {
    points_of_101.ceil().min(30.0)
}

fn per_101(count: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "few points")]
    let count = count.max(1) as f64;
    101.0 / count
}

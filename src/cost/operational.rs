//! The operational objective (design, section 4), in one pass over a candidate.

use super::CostTerms;
use super::hazards::{Segment, Threat};
use super::model::{CostModel, Scratch};
use crate::geodesy::Amsl;
use crate::numeric::geometry::Point;

/// The terms before weights: lengths in km, the rest in km times something
/// without dimension, turns a plain sum over samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sums {
    pub(super) length_km: f64,
    pub(super) altitude: f64,
    pub(super) threat: f64,
    pub(super) terrain: f64,
    pub(super) turn: f64,
    pub(super) climb: f64,
    pub(super) collision: f64,
}

/// Segments between two looks at the cutoff, and for which hazards are culled together.
const BLOCK: usize = 10;

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
    pub(super) fn of(segment: &Segment) -> Self {
        let (east_m, north_m) = (segment.b[0] - segment.a[0], segment.b[1] - segment.a[1]);
        let rise_m = segment.amsl_b_m - segment.amsl_a_m;
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

/// Terms of the sampled candidate in `scratch`; once their sum is above `cutoff`,
/// only so many that it is.
pub(super) fn terms(model: &CostModel, cutoff: f64, scratch: &mut Scratch) -> CostTerms {
    let mut sums = Sums::default();
    let (segments, substeps) = (model.path.samples - 1, model.path.substeps);
    let mut before = None;
    let mut along_m = 0.0;
    let mut start = 0;
    while start < segments {
        let end = (start + BLOCK).min(segments);
        read_ground(model, scratch, (start, end));
        for k in start..end {
            let segment = scratch.segment(k, substeps);
            let step = Step::of(&segment);
            along_m += step.run_m;
            scratch.along_m[k + 1] = along_m;
            sums.length_km += step.length_km;
            add_ground(model, scratch, k, &step, &mut sums);
            sums.climb += model.slope_excess(&step, segment) * step.length_km;
            if let Some(before) = before {
                sums.turn += model.turn_excess(&before, &step);
            }
            before = Some(step);
        }
        add_hazards(model, scratch, (start, end), &mut sums);
        let so_far = model.weigh(&sums);
        if so_far.total() > cutoff {
            return so_far;
        }
        start = end;
    }
    if !model.traffic.is_empty() {
        add_collisions(model, scratch, cutoff, &mut sums);
    }
    model.weigh(&sums)
}

impl CostModel {
    /// Clearance at an altitude over ground, where so much height is wanted.
    #[inline]
    pub(super) fn clearance(&self, amsl_m: f64, ground_m: f64, wanted_agl_m: f64) -> Clearance {
        let agl_m = amsl_m - ground_m;
        let below_m = (wanted_agl_m - agl_m).max(0.0);
        let above_m = (amsl_m - self.max_amsl_m).max(0.0);
        Clearance {
            altitude_km: (agl_m - self.min_agl_m).max(0.0) * 1e-3,
            deficit: (below_m + above_m) * self.per_depth,
        }
    }

    /// One over the ground readings of each piece.
    #[inline]
    pub(super) fn per_substep(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "few steps")]
        let substeps = self.path.substeps as f64;
        1.0 / substeps
    }

    /// How far the slope of a piece, rise over run, is beyond its limit.
    #[inline]
    pub(super) fn slope_excess(&self, step: &Step, segment: Segment) -> f64 {
        let middle = Amsl(0.5 * (segment.amsl_a_m + segment.amsl_b_m));
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

    /// By which fraction of phi_max the turn between two pieces exceeds it, where
    /// `phi_max = 2 asin(min(1, l / (2 R)))`, l the shorter of the two.
    ///
    /// As `cos(phi_max) = 1 - l^2 / (2 R^2)`, turns within the limit need no angle.
    #[inline]
    pub(super) fn turn_excess(&self, into: &Step, out: &Step) -> f64 {
        let least_m = into.run_m.min(out.run_m);
        let ratio = least_m / self.turn_radius_m;
        let cosine_limit = (1.0 - 0.5 * ratio * ratio).max(-1.0);
        let dot = into.east_m * out.east_m + into.north_m * out.north_m;
        if dot >= into.run_m * out.run_m * cosine_limit {
            return 0.0;
        }
        let cross = into.east_m * out.north_m - into.north_m * out.east_m;
        let turn_rad = cross.abs().atan2(dot);
        let limit_rad = 2.0 * (0.5 * ratio).min(1.0).asin();
        (turn_rad / limit_rad - 1.0).max(0.0)
    }
}

/// Clearances at the fine samples of one block. First all lookups, then all
/// arithmetic: the latter is the same for every sample and needs no branch.
fn read_ground(model: &CostModel, scratch: &mut Scratch, (start, end): (usize, usize)) {
    let range = start * model.path.substeps..end * model.path.substeps + 1;
    let (east_m, north_m) = (
        &scratch.east_m[range.clone()],
        &scratch.north_m[range.clone()],
    );
    let ground_m = &mut scratch.high_km[range.clone()];
    for ((ground_m, east_m), north_m) in ground_m.iter_mut().zip(east_m).zip(north_m) {
        *ground_m = model.relief.height_m(*east_m, *north_m);
    }
    let amsl_m = &scratch.amsl_m[range.clone()];
    let wanted_m = &model.wanted_agl_m[range.clone()];
    let deficit = &mut scratch.deficit[range];
    for (((high, deficit), amsl_m), wanted_m) in
        ground_m.iter_mut().zip(deficit).zip(amsl_m).zip(wanted_m)
    {
        let clearance = model.clearance(*amsl_m, *high, *wanted_m);
        *high = clearance.altitude_km;
        *deficit = clearance.deficit;
    }
}

/// Altitude and terrain of piece `k` by the trapezoidal rule over its fine samples.
#[inline]
fn add_ground(model: &CostModel, scratch: &Scratch, k: usize, step: &Step, sums: &mut Sums) {
    let (from, to) = (k * model.path.substeps, (k + 1) * model.path.substeps);
    let trapezoid = |values: &[f64]| {
        let inner = values[1..values.len() - 1].iter();
        inner.fold(0.5 * values[0], |sum, value| sum + value) + 0.5 * values[values.len() - 1]
    };
    let piece_km = step.length_km * model.per_substep();
    sums.altitude += trapezoid(&scratch.high_km[from..=to]) * piece_km;
    sums.terrain += trapezoid(&scratch.deficit[from..=to]) * piece_km;
}

/// Threats, zones and area for the pieces of one block.
fn add_hazards(
    model: &CostModel,
    scratch: &mut Scratch,
    (start, end): (usize, usize),
    sums: &mut Sums,
) {
    let substeps = model.path.substeps;
    let (low, high) = block_box(scratch, start * substeps, end * substeps, substeps);
    let hazards = &model.hazards;
    scratch.near.clear();
    let near = |&(_, threat): &(usize, &Threat)| !threat.misses_box(low, high);
    let threats = hazards.threats.iter().enumerate().filter(near);
    scratch.near.extend(threats.map(|(index, _)| index));
    let zones_near = hazards.zones.iter().any(|zone| !zone.misses_box(low, high));
    let inside = hazards.bounds.holds_box(low, high);
    if scratch.near.is_empty() && !zones_near && inside {
        return;
    }
    for k in start..end {
        let segment = scratch.segment(k, substeps);
        let mut exposure = 0.0;
        for &index in &scratch.near {
            exposure += hazards.threats[index].exposure(&segment);
        }
        if zones_near {
            for zone in &hazards.zones {
                exposure += zone.exposure(&segment, &mut scratch.crossings);
            }
        }
        if !inside {
            exposure += hazards.bounds.exposure(&segment, &mut scratch.crossings);
        }
        if exposure > 0.0 {
            sums.threat += exposure * Step::of(&segment).length_km;
        }
    }
}

/// The box of the samples of a block.
fn block_box(scratch: &Scratch, from: usize, to: usize, stride: usize) -> (Point, Point) {
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    let east_m = scratch.east_m[from..=to].iter().step_by(stride);
    let north_m = scratch.north_m[from..=to].iter().step_by(stride);
    for (&east_m, &north_m) in east_m.zip(north_m) {
        low = [low[0].min(east_m), low[1].min(north_m)];
        high = [high[0].max(east_m), high[1].max(north_m)];
    }
    (low, high)
}

/// Separation from earlier flights, until the total is above the cutoff.
fn add_collisions(model: &CostModel, scratch: &mut Scratch, cutoff: f64, sums: &mut Sums) {
    let (last, substeps) = (model.path.samples - 1, model.path.substeps);
    let length_m = scratch.along_m[last];
    let profile = model.timing.profile(length_m);
    for (time_s, along_m) in scratch.times_s.iter_mut().zip(&scratch.along_m) {
        *time_s = model.timing.start_s + profile.time_at_s(*along_m);
    }
    let is_clear = |from: usize, to: usize| {
        let (low, high) = block_box(scratch, from * substeps, to * substeps, substeps);
        model.traffic.is_clear(&[
            (scratch.times_s[from], scratch.times_s[to]),
            (low[0], high[0]),
            (low[1], high[1]),
        ])
    };
    for start in (0..last).step_by(BLOCK) {
        let end = (start + BLOCK).min(last);
        if is_clear(start, end) {
            continue;
        }
        for k in (start..end).filter(|&k| !is_clear(k, k + 1)) {
            let segment = scratch.segment(k, substeps);
            let reach_m = (scratch.along_m[k], scratch.along_m[k + 1]);
            let mut mean = 0.0;
            model
                .timing
                .motions(&segment, reach_m, &profile, |motion, share| {
                    mean += model.traffic.mean_severity(&motion) * share;
                });
            sums.collision += mean * Step::of(&segment).length_km;
        }
        if model.weigh(sums).total() > cutoff {
            return;
        }
    }
    let end = scratch.segment(last - 1, substeps);
    let place = [end.b[0], end.b[1], end.amsl_b_m];
    if let Some(motion) = model.timing.motion_after(place, length_m) {
        sums.collision += model.traffic.mean_severity(&motion) * model.timing.after_km;
    }
}

//! The operational objective, lane by lane, in one pass over the candidates.

use fearless_simd::prelude::*;

use super::block::{BLOCK, Block};
use super::exposure::add_threats;
use super::lanes::{MAX_LANES, V, Wide, point, splat, store};
use super::limits::LimitLanes;
use super::scratch::Scratch;
use super::threats::Chords;
use super::turns::TightTurns;
use crate::cost::model::CostModel;
use crate::cost::operational::Sums;
use crate::cost::relief::{CellLanes, Corners, ReliefLanes};
use crate::cost::{Batch, CostTerms};

/// Clearance of every lane; see [`crate::cost::operational::Clearance`].
#[derive(Clone, Copy)]
struct Clearances<S: Simd> {
    altitude_km: V<S>,
    deficit: V<S>,
}

/// Terms of the first candidates, as many as `out` has.
#[inline(always)]
pub(crate) fn terms<S: Simd>(
    simd: S,
    model: &CostModel,
    batch: &Batch,
    scratch: &mut Scratch,
    out: &mut [CostTerms],
) {
    let pass = Pass {
        model,
        ground: GroundLanes::new(simd, model),
        limits: LimitLanes::new(simd, model, true),
    };
    let mut block = Block::new(simd, model.path.substeps);
    let lanes = V::<S>::LEN;
    for (group, out) in out.chunks_mut(lanes).enumerate() {
        scratch.load::<S>(batch, group * lanes, out.len());
        pass.terms(group, &mut block, scratch, out);
    }
}

/// What is the same for all candidates.
struct Pass<'a, S: Simd> {
    model: &'a CostModel,
    ground: GroundLanes<'a, S>,
    limits: LimitLanes<S>,
}

impl<S: Simd> Pass<'_, S> {
    /// Terms of the candidates in the lanes of `scratch`.
    #[inline(always)]
    fn terms(
        &self,
        group: usize,
        block: &mut Block<S>,
        scratch: &mut Scratch,
        out: &mut [CostTerms],
    ) {
        let (model, simd) = (self.model, self.ground.simd);
        let zero = splat(simd, 0.0);
        let segments = model.path.samples - 1;
        let mut sums = Sums {
            length_km: zero,
            altitude: zero,
            threat: zero,
            terrain: zero,
            turn: zero,
            climb: zero,
            collision: zero,
        };
        let mut turns = TightTurns::none();
        let mut before = self.begin(block, scratch);
        for start in (0..segments).step_by(BLOCK) {
            let end = segments.min(start + BLOCK);
            self.add_ground(block, (start, end), scratch, (&mut before, &mut sums));
            if !model.traffic.is_empty() {
                scratch.keep(block);
            }
            self.add_limits(block, &mut turns, &mut sums);
            sums.threat = add_threats(simd, block, &model.hazards, Chords, (scratch, sums.threat));
            if end == segments || scratch.runs_up {
                self.flush(&mut turns);
                sums.turn = turns.sums(simd);
            }
            if scratch.runs_up {
                let at = group * segments.div_ceil(BLOCK) + start / BLOCK;
                store::<S>(total::<S>(model, &sums), &mut scratch.running[at]);
            }
        }
        let sums = spread::<S>(&sums);
        for (lane, terms) in out.iter_mut().enumerate() {
            let mut sums = sums.map(|wide| wide[lane]);
            if !model.traffic.is_empty() {
                add_collisions(model, scratch, lane, &mut sums);
            }
            *terms = model.weigh(&sums);
        }
    }

    /// Goes to where the paths begin: the clearance there.
    #[inline(always)]
    fn begin(&self, block: &mut Block<S>, scratch: &mut Scratch) -> Clearances<S> {
        let (model, ground) = (self.model, &self.ground);
        let first = point(ground.simd, &model.path.rows[0], &scratch.controls);
        block.begin(ground.simd, first);
        let cell = ground.relief.cell(first[0], first[1]);
        let corners = &mut scratch.corners[0];
        ground.relief.fetch(&cell, corners);
        ground.clearances(first[2], (&cell, corners), model.agl_m[0])
    }

    /// Goes on to the pieces between two samples and adds length, altitude and terrain; see
    /// [`GroundLanes::add`].
    #[inline(always)]
    fn add_ground(
        &self,
        block: &mut Block<S>,
        (start, end): (usize, usize),
        scratch: &mut Scratch,
        (before, sums): (&mut Clearances<S>, &mut Sums<V<S>>),
    ) {
        let (path, ground) = (&self.model.path, &self.ground);
        let within = start * path.substeps + 1..end * path.substeps + 1;
        let rows = &path.rows[within.clone()];
        block.sample(ground.simd, rows, end - start, &scratch.controls);
        // Cells first: a loop of both waits for one height after the other.
        block.find(&ground.relief);
        block.measure(
            ground.simd,
            &self.limits,
            &ground.relief,
            &mut scratch.corners,
        );
        let readings = (&scratch.corners[..], &self.model.agl_m[within]);
        ground.add(block, readings, before, sums);
    }

    /// Adds what is too steep or turns too tightly; what turns cost is not yet in `sums`.
    #[inline(always)]
    fn add_limits(&self, block: &Block<S>, turns: &mut TightTurns, sums: &mut Sums<V<S>>) {
        for piece in block.steep() {
            if let Some(excess) = self.limits.excesses(piece.middle_m(), piece.step) {
                sums.climb += excess * piece.step.length_km;
            }
        }
        for (turn, lane) in block.tight() {
            if turns.push(turn, lane) {
                self.flush(turns);
            }
        }
    }

    #[inline(always)]
    fn flush(&self, turns: &mut TightTurns) {
        let simd = self.ground.simd;
        turns.flush(
            simd,
            #[inline(always)]
            |into, out| self.model.turn_excesses(simd, into, out),
        );
    }
}

/// The sums of all lanes as numbers.
#[inline(always)]
fn spread<S: Simd>(sums: &Sums<V<S>>) -> Sums<Wide> {
    sums.map(
        #[inline(always)]
        |values| {
            let mut wide = [0.0; MAX_LANES];
            store::<S>(values, &mut wide);
            wide
        },
    )
}

impl CostModel {
    /// [`CostModel::weigh`] in every lane, in the order of the fields of [`CostTerms`].
    #[inline(always)]
    fn weigh_lanes<S: Simd>(&self, sums: &Sums<V<S>>) -> [V<S>; 7] {
        let weights = &self.weights;
        #[expect(clippy::cast_precision_loss, reason = "few samples")]
        let samples = self.path.samples as f64;
        [
            sums.length_km * weights.length,
            sums.altitude * weights.altitude,
            sums.threat * 100.0 * weights.threat,
            sums.terrain * 100.0 * weights.terrain,
            (sums.turn / samples) * (100.0 * self.straight_km) * weights.turn,
            sums.climb * 100.0 * weights.climb,
            sums.collision * 100.0 * weights.collision,
        ]
    }
}

/// The totals so far, summed in the order of [`CostTerms::total`].
#[inline(always)]
fn total<S: Simd>(model: &CostModel, sums: &Sums<V<S>>) -> V<S> {
    let terms = model.weigh_lanes::<S>(sums);
    terms.iter().skip(1).fold(
        terms[0],
        #[inline(always)]
        |sum, term| sum + *term,
    )
}

/// The ground and what clearance counts from, in every lane.
#[derive(Clone, Copy)]
struct GroundLanes<'a, S: Simd> {
    simd: S,
    relief: ReliefLanes<'a, S>,
    min_agl_m: V<S>,
    max_amsl_m: V<S>,
    min_amsl_m: V<S>,
    is_layered: bool,
    /// One over what altitudes and deficits are measured in; half of that where no ground is
    /// read between the ends of a piece, which count half.
    per_km: V<S>,
    per_depth: V<S>,
    per_substep: V<S>,
}

impl<'a, S: Simd> GroundLanes<'a, S> {
    #[inline(always)]
    fn new(simd: S, model: &'a CostModel) -> Self {
        let share = if model.path.substeps == 1 { 0.5 } else { 1.0 };
        Self {
            simd,
            relief: model.relief.lanes(simd),
            min_agl_m: splat(simd, model.min_agl_m),
            max_amsl_m: splat(simd, model.max_amsl_m),
            min_amsl_m: splat(simd, model.min_amsl_m),
            is_layered: model.is_layered,
            per_km: splat(simd, 1e-3 * share),
            per_depth: splat(simd, model.per_depth * share),
            per_substep: splat(simd, model.per_substep),
        }
    }

    /// [`CostModel::clearance`] at a fine sample.
    #[inline(always)]
    fn clearances(
        &self,
        amsl_m: V<S>,
        (cell, corners): (&CellLanes<S>, &Corners),
        [floor_agl_m, ceiling_agl_m]: [f64; 2],
    ) -> Clearances<S> {
        let agl_m = amsl_m - self.relief.heights_in(cell, corners);
        let mut below_m = (splat(self.simd, floor_agl_m) - agl_m).max(0.0);
        let mut above_m = (amsl_m - self.max_amsl_m).max(0.0);
        if self.is_layered {
            below_m = below_m.max(self.min_amsl_m - amsl_m);
            above_m = above_m.max(agl_m - ceiling_agl_m);
        }
        Clearances {
            altitude_km: (agl_m - self.min_agl_m).max(0.0) * self.per_km,
            deficit: (below_m + above_m) * self.per_depth,
        }
    }

    /// Length, altitude and terrain of a block, whose pieces' ends count half; `before` is the
    /// reading at the end of the block before, and then at that of this one.
    #[inline(always)]
    fn add(
        &self,
        block: &Block<S>,
        (corners, agl_m): (&[Corners], &[[f64; 2]]),
        before: &mut Clearances<S>,
        sums: &mut Sums<V<S>>,
    ) {
        let mut sum = [sums.length_km, sums.altitude, sums.terrain];
        let mut last = *before;
        let readings = block.grounds().zip(corners).zip(agl_m).map(
            #[inline(always)]
            |(((at, cell), corners), required_agl_m)| {
                self.clearances(at[2], (cell, corners), *required_agl_m)
            },
        );
        if block.substeps() == 1 {
            for (step, of) in block.steps().iter().zip(readings) {
                let length_km = step.length_km;
                sum[0] += length_km;
                sum[1] += (last.altitude_km + of.altitude_km) * length_km;
                sum[2] += (last.deficit + of.deficit) * length_km;
                last = of;
            }
        } else {
            let mut readings = readings;
            for step in block.steps() {
                let (mut high_km, mut deficit) = (last.altitude_km * 0.5, last.deficit * 0.5);
                let within = block.substeps() - 1;
                for of in readings.by_ref().take(within) {
                    high_km += of.altitude_km;
                    deficit += of.deficit;
                }
                if let Some(of) = readings.next() {
                    last = of;
                }
                high_km += last.altitude_km * 0.5;
                deficit += last.deficit * 0.5;
                let piece_km = step.length_km * self.per_substep;
                sum[1] += high_km * piece_km;
                sum[2] += deficit * piece_km;
                sum[0] += step.length_km;
            }
        }
        [sums.length_km, sums.altitude, sums.terrain] = sum;
        *before = last;
    }
}

/// Separation of one lane from earlier flights.
fn add_collisions(model: &CostModel, scratch: &Scratch, lane: usize, sums: &mut Sums) {
    let last = model.path.samples - 1;
    let piece = |k: usize| scratch.piece(k, lane);
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
                .segments(&piece, reach_m, &profile, |segment, share| {
                    mean += model.traffic.mean_severity(&segment) * share;
                });
            sums.collision += mean * crate::cost::operational::Step::of(&piece).length_km;
        }
    }
    let end = piece(last - 1);
    let position = [end.b[0], end.b[1], end.amsl_b_m];
    if let Some(segment) = model.timing.segment_after(position, length_m) {
        sums.collision += model.traffic.mean_severity(&segment) * model.timing.after_km;
    }
}

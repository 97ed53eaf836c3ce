//! What the objective of one route needs, owned and laid out for its loops.

use super::hazards::Hazards;
use super::kernel::batch::{Batch, Dispatch};
use super::kernel::block::BLOCK;
use super::kernel::boxes::BlockBox;
use super::kernel::lanes::{Scratch, V, Wide};
use super::kernel::{operational as operational_lanes, paper as paper_lanes};
use super::operational::Sums;
use super::paper::{Paper, PaperOptions};
use super::reference::{self, Curve};
use super::relief::Relief;
use super::sampling::Sampling;
use super::timing::Timing;
use super::traffic::Traffic;
use super::{Controls, CostTerms, Margins, RouteEnds};
use fearless_simd::{dispatch, prelude::*};

use crate::path::{Flight, VehicleLimits};
use crate::spec::{MissionSpec, Objective, Weights};
use crate::world::World;

/// The objective of one route of one vehicle.
///
/// Lengths enter in km. With S the straight distance of the leg (at least
/// 0.1 km, so that a violated limit costs something on the shortest leg), the
/// operational total is `length + altitude + 100 S (v_threat + v_terrain +
/// v_turn + v_climb + v_collision)` of the design, section 4, where besides
/// - ground is read also between samples, on the spline, at least as densely as
///   its grid where that takes no more than four readings a piece;
/// - height above the ceiling counts as terrain, in the same measure;
/// - ground without data is a wall beyond the ceiling;
/// - a zone with a height is closed below it only;
/// - collision is read at the closest approach within each piece too, so that no
///   crossing hides between samples; a landing or endless loiter after the
///   route counts like a piece as long as the separation.
#[derive(Clone, Debug)]
pub struct CostModel {
    pub(super) objective: Objective,
    pub(super) weights: Weights,
    pub(super) path: Sampling,
    pub(super) relief: Relief,
    pub(super) hazards: Hazards,
    pub(super) traffic: Traffic,
    pub(super) timing: Timing,
    pub(super) paper: Paper,
    pub(super) limits: VehicleLimits,
    /// One over the turn radius with its margin, 1/m.
    pub(super) per_turn_radius: f64,
    /// One over the ground readings of each piece.
    pub(super) per_substep: f64,
    /// What is left of slope limits after their margin.
    pub(super) slope_share: f64,
    pub(super) min_agl_m: f64,
    pub(super) max_amsl_m: f64,
    /// Height above ground wanted at each fine sample, metres.
    pub(super) floor_agl_m: Vec<f64>,
    /// 1 / max(h_min, 10 m).
    pub(super) per_depth: f64,
    pub(super) straight_km: f64,
    pub(super) dispatch: Dispatch,
}

/// How far above the ceiling a void reaches, metres: no altitude is allowed over it.
const WALL_OVER_CEILING_M: f64 = 1000.0;

impl CostModel {
    /// The objective of one route of vehicle number `vehicle`, read at ascending
    /// spline `parameters` from 0 to 1; `earlier` are the flights it has to keep apart from.
    ///
    /// # Panics
    /// When there is no such vehicle, or the spec has fewer than 2 free control
    /// points or there are fewer than 2 parameters: no checked spec is so.
    #[must_use]
    pub fn new(
        world: &World,
        spec: &MissionSpec,
        vehicle: usize,
        ends: RouteEnds,
        earlier: &[Flight],
        margins: Margins,
        parameters: &[f64],
    ) -> Self {
        assert!(parameters.len() >= 2, "a path has two ends");
        let limits = VehicleLimits::of(&spec.vehicles[vehicle]);
        let straight_m = ends.from.distance_m(ends.to);
        let path = Sampling::new(spec, parameters, straight_m, world.ground.spacing_m);
        let relief = Relief::new(&world.ground, world.max_amsl.0 + WALL_OVER_CEILING_M);
        let floor_agl_m = floor_agl_m(world, &relief, &ends, &margins, path.fine.samples());
        Self {
            objective: spec.planner.objective,
            weights: spec.planner.weights,
            hazards: Hazards::new(world, &ends, &margins),
            traffic: Traffic::new(&spec.separation, &margins, earlier),
            timing: Timing::new(world, spec, vehicle, &ends),
            paper: Paper::new(PaperOptions::default(), &ends, earlier),
            per_turn_radius: 1.0 / (limits.turn_radius_m * (1.0 + margins.turn_fraction)),
            per_substep: path.per_substep(),
            slope_share: 1.0 - margins.climb_fraction,
            limits,
            min_agl_m: world.min_agl.0,
            max_amsl_m: world.max_amsl.0,
            floor_agl_m,
            per_depth: 1.0 / world.min_agl.0.max(10.0),
            straight_km: (straight_m / 1000.0).max(0.1),
            path,
            relief,
            dispatch: Dispatch::best(),
        }
    }

    /// The same model worked off with other instructions: the same bits, at another speed.
    #[must_use]
    pub fn with_dispatch(mut self, dispatch: Dispatch) -> Self {
        self.dispatch = dispatch;
        self
    }

    /// The same model with violated limits so many times dearer: for a search that must
    /// not buy a shorter way with a violation.
    #[must_use]
    pub fn with_penalties(mut self, factor: f64) -> Self {
        let weights = &mut self.weights;
        for penalty in [
            &mut weights.threat,
            &mut weights.terrain,
            &mut weights.turn,
            &mut weights.climb,
            &mut weights.collision,
        ] {
            *penalty *= factor;
        }
        self
    }

    /// The same model with other options for the paper's objective.
    #[must_use]
    pub fn with_paper(mut self, options: PaperOptions) -> Self {
        self.paper.options = options;
        self
    }

    /// The same model with the ground read at the samples alone, however fine its grid is.
    #[must_use]
    pub fn with_one_reading(mut self) -> Self {
        let substeps = self.path.substeps;
        self.floor_agl_m = self.floor_agl_m.into_iter().step_by(substeps).collect();
        self.path.fine = self.path.fine.every(substeps);
        self.path.rows = self.path.rows.into_iter().step_by(substeps).collect();
        self.path.substeps = 1;
        self.per_substep = 1.0;
        self
    }

    /// Number of control points of a candidate, ends included.
    #[must_use]
    pub fn control_points(&self) -> usize {
        self.path.fine.control_points()
    }

    /// Number of samples k.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.path.samples
    }

    /// The seven terms of a candidate, weighted as they enter the total: the
    /// plain reference, one term after the other.
    ///
    /// # Panics
    /// When a coordinate has fewer than [`Self::control_points`] numbers.
    #[must_use]
    pub fn terms(&self, controls: &Controls<'_>) -> CostTerms {
        let curve = Curve::new(self, controls);
        match self.objective {
            Objective::Operational => self.weigh(&reference::sums(self, &curve)),
            Objective::Paper => self.paper.terms(self, &curve),
        }
    }

    /// The totals of a batch: each equal to `terms(controls).total()` to the bit.
    ///
    /// Allocates nothing once the scratch has grown.
    ///
    /// # Panics
    /// When the batch has control points in another number than [`Self::control_points`].
    pub fn totals(&self, batch: &Batch, scratch: &mut Scratch, totals: &mut [f64]) {
        let mut terms = std::mem::take(&mut scratch.terms);
        terms.resize(totals.len(), CostTerms::default());
        self.evaluate(batch, scratch, &mut terms);
        for (total, terms) in totals.iter_mut().zip(&terms) {
            *total = terms.total();
        }
        scratch.terms = terms;
    }

    /// The terms of a batch: the same as those of [`Self::terms`], to the bit, by the
    /// fast way.
    ///
    /// # Panics
    /// When the batch has control points in another number than [`Self::control_points`].
    #[must_use]
    pub fn judge(&self, batch: &Batch) -> Vec<CostTerms> {
        let mut terms = vec![CostTerms::default(); batch.len()];
        self.evaluate(batch, &mut Scratch::default(), &mut terms);
        terms
    }

    /// The terms of the first candidates, as many as `out` has, as many at once as the vectors
    /// have lanes.
    pub(super) fn evaluate(&self, batch: &Batch, scratch: &mut Scratch, out: &mut [CostTerms]) {
        assert_eq!(batch.controls(), self.control_points(), "control points");
        dispatch!(self.dispatch.0, simd => self.evaluate_by(simd, batch, scratch, out));
    }

    #[inline(always)]
    fn evaluate_by<S: Simd>(
        &self,
        simd: S,
        batch: &Batch,
        scratch: &mut Scratch,
        out: &mut [CostTerms],
    ) {
        scratch.grow(&self.path, out.len().div_ceil(V::<S>::LEN));
        match self.objective {
            Objective::Operational => {
                operational_lanes::terms(simd, self, batch, scratch, out);
            }
            Objective::Paper => paper_lanes::terms(simd, self, batch, scratch, out),
        }
    }

    /// The same in every lane, in the order of the fields of [`CostTerms`].
    #[inline(always)]
    pub(super) fn weigh_lanes<S: Simd>(&self, sums: &Sums<V<S>>) -> [V<S>; 7] {
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
}

/// Height above ground wanted at each fine sample: the limit and its margin,
/// which grows from what the ends keep to the full over the first and last
/// twentieth of the parameter.
fn floor_agl_m(
    world: &World,
    relief: &Relief,
    ends: &RouteEnds,
    margins: &Margins,
    count: usize,
) -> Vec<f64> {
    let limit_m = world.min_agl.0;
    let margin_m = |end: crate::geodesy::PlanPoint| {
        let agl_m = end.amsl.0 - relief.height_m(end.at.east_m, end.at.north_m);
        (agl_m - limit_m).clamp(0.0, margins.clearance_m.max(0.0))
    };
    let (from_m, to_m) = (margin_m(ends.from), margin_m(ends.to));
    let ramp = |end_m: f64, away: f64| {
        let share = (away * 20.0).min(1.0);
        end_m + (margins.clearance_m - end_m) * share
    };
    (0..count)
        .map(|index| {
            #[expect(clippy::cast_precision_loss, reason = "few samples")]
            let at = index as f64 / (count - 1).max(1) as f64;
            limit_m + ramp(from_m, at).min(ramp(to_m, 1.0 - at))
        })
        .collect()
}

impl Scratch {
    /// Makes room for so many groups of candidates, one in each lane.
    fn grow(&mut self, path: &Sampling, groups: usize) {
        let blocks = (path.samples - 1).div_ceil(BLOCK);
        self.controls
            .resize(path.fine.control_points(), Default::default());
        self.curve.resize(path.samples, Default::default());
        self.along_m.resize(path.samples, Default::default());
        self.boxes.resize(blocks, BlockBox::default());
        if self.runs_up {
            self.running.clear();
            self.running.resize(blocks * groups, Wide::default());
        }
    }

    /// Puts `used` candidates from number `first` on into the lanes; the last of them also
    /// fills the lanes that are left.
    #[inline(always)]
    pub(super) fn load<S: Simd>(&mut self, batch: &Batch, first: usize, used: usize) {
        for lane in 0..V::<S>::LEN {
            let of = batch.candidate(first + lane.min(used - 1));
            let positions = of.east_m.iter().zip(of.north_m).zip(of.amsl_m);
            for (wide, ((east_m, north_m), amsl_m)) in self.controls.iter_mut().zip(positions) {
                (wide[0][lane], wide[1][lane], wide[2][lane]) = (*east_m, *north_m, *amsl_m);
            }
        }
    }
}

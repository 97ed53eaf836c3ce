//! What the objective of one route needs, owned and laid out for its loops.

use super::hazards::Hazards;
use super::kernel::batch::Dispatch;
use super::paper::{Paper, PaperOptions};
use super::relief::Relief;
use super::sampling::Sampling;
use super::timing::Timing;
use super::traffic::{EarlierFlights, Traffic};
use super::{Margins, RouteEnds};
use crate::path::{Flight, VehicleLimits};
use crate::spec::{MissionSpec, Objective, Weights};
use crate::world::{Layer, World};

/// The objective of one route of one vehicle.
///
/// Lengths enter in km. With S the straight distance of the leg (at least
/// 0.1 km, so that a violated limit costs something on the shortest leg), the
/// operational total is `length + altitude + 100 S (v_threat + v_terrain +
/// v_turn + v_climb + v_collision)` of the design, section 4, where besides
/// - ground is read also between samples, on the spline, at least as densely as
///   its grid where that takes no more than four readings a piece;
/// - height above the ceiling or above the greatest height over ground, and below the least
///   altitude, counts as terrain, in the same measure;
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
    /// Least altitude, metres above mean sea level.
    pub(super) min_amsl_m: f64,
    /// Least and greatest height above ground wanted at each fine sample, metres.
    pub(super) agl_m: Vec<[f64; 2]>,
    /// Whether the least altitude and the greatest height above ground limit anything.
    pub(super) is_layered: bool,
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
        earlier: &EarlierFlights,
        margins: Margins,
        parameters: &[f64],
    ) -> Self {
        assert!(parameters.len() >= 2, "a path has two ends");
        let limits = VehicleLimits::of(&spec.vehicles[vehicle]);
        let straight_m = ends.from.distance_m(ends.to);
        let path = Sampling::new(spec, parameters, straight_m, world.ground.spacing_m);
        // The operational objective never reads the paper's collision term.
        let in_paper: &[Flight] = match spec.planner.objective {
            Objective::Operational => &[],
            Objective::Paper => earlier,
        };
        let relief = Relief::new(&world.ground, world.max_amsl.0 + WALL_OVER_CEILING_M);
        let layer = world.layer(vehicle);
        let heights = Heights::new((world, layer), &relief, &ends, &margins);
        Self {
            objective: spec.planner.objective,
            weights: spec.planner.weights,
            hazards: Hazards::new((world, &relief), &ends, &margins),
            traffic: Traffic::new(&spec.buffered_separation(), &margins, earlier),
            timing: Timing::new(world, spec, vehicle, &ends),
            paper: Paper::new(PaperOptions::default(), &ends, in_paper),
            per_turn_radius: 1.0 / (limits.turn_radius_m * (1.0 + margins.turn_fraction)),
            per_substep: path.per_substep(),
            slope_share: 1.0 - margins.climb_fraction,
            limits,
            min_agl_m: world.min_agl.0,
            max_amsl_m: world.max_amsl.0,
            min_amsl_m: layer.min_amsl_m,
            agl_m: heights.at_samples(path.fine.samples()),
            is_layered: !layer.is_unlimited(),
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

    /// The same model with violated limits `factor` times dearer: for a search that must
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
        self.agl_m = self.agl_m.into_iter().step_by(substeps).collect();
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

    /// Height above ground from which Eq. 23 counts at a sample, metres.
    pub(super) fn paper_agl_m(&self, index: usize) -> f64 {
        if self.paper.options.terrain_from_min_agl {
            self.agl_m[index][0]
        } else {
            0.0
        }
    }

    /// Number of samples k.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.path.samples
    }
}

/// Heights above ground wanted along a route: the limits and their margins, which grow from what
/// the ends keep to the full over the first and last twentieth of the parameter.
struct Heights {
    min_m: f64,
    max_m: f64,
    /// Of both ends above the relief: allowed by the terrain itself, from which a grid of it
    /// differs by millimetres, metres.
    ends_m: [f64; 2],
    /// Margins of both at the start, on the way, and at the end, metres.
    margins_m: [[f64; 3]; 2],
}

impl Heights {
    fn new(
        (world, layer): (&World, Layer),
        relief: &Relief,
        ends: &RouteEnds,
        margins: &Margins,
    ) -> Self {
        let (min_m, max_m) = (world.min_agl.0, layer.max_agl_m);
        let (above_m, below_m) = margins.within_m(max_m - min_m);
        let agl_m = [ends.from, ends.to]
            .map(|end| end.amsl.0 - relief.height_m(end.at.east_m, end.at.north_m));
        let over_m = |agl_m: f64| (agl_m - min_m).clamp(0.0, above_m.max(0.0));
        let under_m = |agl_m: f64| (max_m - agl_m).clamp(0.0, below_m.max(0.0));
        Self {
            min_m,
            max_m,
            ends_m: agl_m,
            margins_m: [
                [over_m(agl_m[0]), above_m, over_m(agl_m[1])],
                [under_m(agl_m[0]), below_m, under_m(agl_m[1])],
            ],
        }
    }

    /// The least and the greatest height at each of a number of samples.
    fn at_samples(&self, count: usize) -> Vec<[f64; 2]> {
        let ramp = |end_m: f64, full_m: f64, away: f64| {
            let share = (away * 20.0).min(1.0);
            end_m + (full_m - end_m) * share
        };
        let margin_m = |[from_m, full_m, to_m]: [f64; 3], at: f64| {
            ramp(from_m, full_m, at).min(ramp(to_m, full_m, 1.0 - at))
        };
        let mut heights: Vec<[f64; 2]> = (0..count)
            .map(|index| {
                #[expect(clippy::cast_precision_loss, reason = "few samples")]
                let at = index as f64 / (count - 1).max(1) as f64;
                let [above_m, below_m] = self.margins_m.map(|margins| margin_m(margins, at));
                [self.min_m + above_m, self.max_m - below_m]
            })
            .collect();
        for (end, agl_m) in [0, count.saturating_sub(1)].into_iter().zip(self.ends_m) {
            if let Some([min_m, max_m]) = heights.get_mut(end) {
                *min_m = min_m.min(agl_m);
                *max_m = max_m.max(agl_m);
            }
        }
        heights
    }
}

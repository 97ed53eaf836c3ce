//! The operational objective plainly: one candidate, term after term, nothing
//! culled, nothing cut short. Sums run in the same order as in the fast form.

pub(super) mod paper;

use super::Controls;
use super::hazards::Piece;
use super::model::CostModel;
use super::operational::{Step, Sums};

/// One candidate at the fine samples.
#[derive(Clone, Debug, Default)]
pub(super) struct Curve {
    pub(super) east_m: Vec<f64>,
    pub(super) north_m: Vec<f64>,
    pub(super) amsl_m: Vec<f64>,
}

impl Curve {
    /// Reads a candidate's spline.
    pub(super) fn new(model: &CostModel, controls: &Controls<'_>) -> Self {
        let basis = &model.path.fine;
        Self {
            east_m: basis.sampled(controls.east_m),
            north_m: basis.sampled(controls.north_m),
            amsl_m: basis.sampled(controls.amsl_m),
        }
    }

    /// The piece from sample `k` to the next, `substeps` fine samples on.
    pub(super) fn piece(&self, k: usize, substeps: usize) -> Piece {
        let (from, to) = (k * substeps, (k + 1) * substeps);
        Piece {
            a: [self.east_m[from], self.north_m[from]],
            b: [self.east_m[to], self.north_m[to]],
            amsl_a_m: self.amsl_m[from],
            amsl_b_m: self.amsl_m[to],
        }
    }

    /// Horizontal distances along it at the samples, metres.
    pub(super) fn along_m(steps: &[Step]) -> Vec<f64> {
        let mut along_m = vec![0.0];
        let mut sum_m = 0.0;
        for step in steps {
            sum_m += step.run_m;
            along_m.push(sum_m);
        }
        along_m
    }
}

/// All sums of a candidate.
pub(super) fn sums(model: &CostModel, curve: &Curve) -> Sums {
    let segments = model.path.samples - 1;
    let steps: Vec<Step> = (0..segments)
        .map(|k| Step::of(&curve.piece(k, model.path.substeps)))
        .collect();
    let (altitude, terrain) = ground(model, curve, &steps);
    Sums {
        length_km: steps.iter().fold(0.0, |sum, step| sum + step.length_km),
        altitude,
        threat: threat(model, curve, &steps),
        terrain,
        turn: steps
            .windows(2)
            .fold(0.0, |sum, pair| sum + model.turn_excess(&pair[0], &pair[1])),
        climb: steps.iter().enumerate().fold(0.0, |sum, (k, step)| {
            let piece = curve.piece(k, model.path.substeps);
            sum + model.slope_excess(step, piece) * step.length_km
        }),
        collision: collision(model, curve, &steps),
    }
}

fn ground(model: &CostModel, curve: &Curve, steps: &[Step]) -> (f64, f64) {
    let substeps = model.path.substeps;
    let (mut altitude, mut terrain) = (0.0, 0.0);
    for (k, step) in steps.iter().enumerate() {
        let (mut high, mut deficit) = (0.0, 0.0);
        for index in k * substeps..=(k + 1) * substeps {
            let is_end = index == k * substeps || index == (k + 1) * substeps;
            let share = if is_end { 0.5 } else { 1.0 };
            let ground_m = model
                .relief
                .height_m(curve.east_m[index], curve.north_m[index]);
            let clearance = model.clearance(curve.amsl_m[index], ground_m, model.agl_m[index]);
            high += share * clearance.altitude_km;
            deficit += share * clearance.deficit;
        }
        let piece_km = step.length_km * model.per_substep;
        altitude += high * piece_km;
        terrain += deficit * piece_km;
    }
    (altitude, terrain)
}

fn threat(model: &CostModel, curve: &Curve, steps: &[Step]) -> f64 {
    let hazards = &model.hazards;
    let mut crossings = Vec::new();
    let mut sum = 0.0;
    for (k, step) in steps.iter().enumerate() {
        let piece = curve.piece(k, model.path.substeps);
        let mut exposure = 0.0;
        for threat in &hazards.threats {
            exposure += threat.exposure(&piece);
        }
        for zone in &hazards.zones {
            exposure += zone.exposure(&piece, &hazards.relief, &mut crossings);
        }
        exposure += hazards.bounds.exposure(&piece, &mut crossings);
        sum += exposure * step.length_km;
    }
    sum
}

fn collision(model: &CostModel, curve: &Curve, steps: &[Step]) -> f64 {
    if model.traffic.is_empty() {
        return 0.0;
    }
    let along_m = Curve::along_m(steps);
    let length_m = along_m[steps.len()];
    let profile = model.timing.profile(length_m);
    let mut sum = 0.0;
    for (k, step) in steps.iter().enumerate() {
        let piece = curve.piece(k, model.path.substeps);
        let reach_m = (along_m[k], along_m[k + 1]);
        let mut mean = 0.0;
        model
            .timing
            .segments(&piece, reach_m, &profile, |segment, share| {
                mean += model.traffic.mean_severity_by_all(&segment) * share;
            });
        sum += mean * step.length_km;
    }
    let end = curve.piece(steps.len() - 1, model.path.substeps);
    let position = [end.b[0], end.b[1], end.amsl_b_m];
    if let Some(segment) = model.timing.segment_after(position, length_m) {
        sum += model.traffic.mean_severity_by_all(&segment) * model.timing.after_km;
    }
    sum
}

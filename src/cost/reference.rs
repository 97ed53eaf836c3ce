//! The operational objective once more, plainly: term after term, nothing
//! culled, nothing cut short. Sums run in the same order as in the fast form.

use super::model::{CostModel, Scratch};
use super::operational::{Step, Sums};

/// All sums of the sampled candidate in `scratch`.
pub(super) fn sums(model: &CostModel, scratch: &mut Scratch) -> Sums {
    let segments = model.path.samples - 1;
    let steps: Vec<Step> = (0..segments)
        .map(|k| Step::of(&scratch.segment(k, model.path.substeps)))
        .collect();
    let (altitude, terrain) = ground(model, scratch, &steps);
    Sums {
        length_km: steps.iter().fold(0.0, |sum, step| sum + step.length_km),
        altitude,
        threat: threat(model, scratch, &steps),
        terrain,
        turn: steps
            .windows(2)
            .fold(0.0, |sum, pair| sum + model.turn_excess(&pair[0], &pair[1])),
        climb: steps.iter().enumerate().fold(0.0, |sum, (k, step)| {
            let segment = scratch.segment(k, model.path.substeps);
            sum + model.slope_excess(step, segment) * step.length_km
        }),
        collision: collision(model, scratch, &steps),
    }
}

fn ground(model: &CostModel, scratch: &Scratch, steps: &[Step]) -> (f64, f64) {
    let substeps = model.path.substeps;
    let (mut altitude, mut terrain) = (0.0, 0.0);
    for (k, step) in steps.iter().enumerate() {
        let (mut high, mut deficit) = (0.0, 0.0);
        for index in k * substeps..=(k + 1) * substeps {
            let is_end = index == k * substeps || index == (k + 1) * substeps;
            let share = if is_end { 0.5 } else { 1.0 };
            let ground_m = model
                .relief
                .height_m(scratch.east_m[index], scratch.north_m[index]);
            let clearance =
                model.clearance(scratch.amsl_m[index], ground_m, model.wanted_agl_m[index]);
            high += share * clearance.altitude_km;
            deficit += share * clearance.deficit;
        }
        let piece_km = step.length_km * model.per_substep();
        altitude += high * piece_km;
        terrain += deficit * piece_km;
    }
    (altitude, terrain)
}

fn threat(model: &CostModel, scratch: &mut Scratch, steps: &[Step]) -> f64 {
    let hazards = &model.hazards;
    let mut sum = 0.0;
    for (k, step) in steps.iter().enumerate() {
        let segment = scratch.segment(k, model.path.substeps);
        let mut exposure = 0.0;
        for threat in &hazards.threats {
            exposure += threat.exposure(&segment);
        }
        for zone in &hazards.zones {
            exposure += zone.exposure(&segment, &mut scratch.crossings);
        }
        exposure += hazards.bounds.exposure(&segment, &mut scratch.crossings);
        sum += exposure * step.length_km;
    }
    sum
}

fn collision(model: &CostModel, scratch: &mut Scratch, steps: &[Step]) -> f64 {
    scratch.along_m[0] = 0.0;
    for (k, step) in steps.iter().enumerate() {
        scratch.along_m[k + 1] = scratch.along_m[k] + step.run_m;
    }
    let length_m = scratch.along_m[steps.len()];
    let profile = model.timing.profile(length_m);
    let mut sum = 0.0;
    for (k, step) in steps.iter().enumerate() {
        let segment = scratch.segment(k, model.path.substeps);
        let reach_m = (scratch.along_m[k], scratch.along_m[k + 1]);
        let mut mean = 0.0;
        model
            .timing
            .motions(&segment, reach_m, &profile, |motion, share| {
                mean += model.traffic.mean_severity_by_all(&motion) * share;
            });
        sum += mean * step.length_km;
    }
    let end = scratch.segment(steps.len() - 1, model.path.substeps);
    let place = [end.b[0], end.b[1], end.amsl_b_m];
    if let Some(motion) = model.timing.motion_after(place, length_m) {
        sum += model.traffic.mean_severity_by_all(&motion) * model.timing.after_km;
    }
    sum
}

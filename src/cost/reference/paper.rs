//! The paper's objective plainly: one candidate, sample after sample.

use super::Curve;
use crate::cost::CostTerms;
use crate::cost::model::CostModel;
use crate::cost::operational::Step;
use crate::cost::paper::{PaperSums, ThreatForm};
use crate::geodesy::Amsl;

/// The weighted terms of a candidate: the plain reference.
pub(crate) fn terms(model: &CostModel, curve: &Curve) -> CostTerms {
    let paper = &model.paper;
    let mut sums = PaperSums::default();
    for index in 0..model.path.samples {
        let (high_km, deep_km) = heights(model, curve, index);
        sums.altitude += high_km;
        sums.terrain += deep_km;
    }
    let mut before: Option<Step> = None;
    let mut steps = Vec::new();
    for k in 0..model.path.samples - 1 {
        let step = Step::of(&curve.piece(k, 1));
        steps.push(step);
        sums.length_km += step.length_km;
        sums.threat += exposure_per_km(model, curve, k) * step.length_km;
        sums.climb += slope_excess(model, &step, curve.amsl_m[k]);
        if before.is_some_and(|before| model.is_too_tight(&before, &step)) {
            sums.turns += 1.0;
        }
        before = Some(step);
    }
    let along_m = Curve::along_m(&steps);
    let profile = model.timing.profile(along_m[steps.len()]);
    for (index, along_m) in along_m.iter().enumerate() {
        let own = [
            curve.east_m[index],
            curve.north_m[index],
            curve.amsl_m[index],
        ];
        let own_s = model.timing.start_s + profile.time_at_s(*along_m);
        sums.collision += paper.collision(own, own_s, &paper.others);
    }
    paper.weigh(&model.weights, model.path.samples, &sums)
}

/// Terms of Eq. 21 and 23 at one sample, km.
fn heights(model: &CostModel, curve: &Curve, index: usize) -> (f64, f64) {
    let amsl_m = curve.amsl_m[index];
    let ground_m = model
        .relief
        .height_m(curve.east_m[index], curve.north_m[index]);
    let over_m = if model.paper.options.altitude_over_ground {
        amsl_m - ground_m
    } else {
        amsl_m
    };
    let high_m = over_m - model.min_agl_m;
    let high_m = if model.paper.options.altitude_unclamped {
        high_m
    } else {
        high_m.max(0.0)
    };
    let required_agl_m = model.paper_agl_m(index);
    let mut below_m = (ground_m + required_agl_m - amsl_m).max(0.0);
    let mut above_m = (amsl_m - model.max_amsl_m).max(0.0);
    if model.is_layered {
        below_m = below_m.max(model.min_amsl_m - amsl_m);
        above_m = above_m.max(amsl_m - ground_m - model.agl_m[index][1]);
    }
    let deep_m = below_m + above_m;
    (high_m * 1e-3, deep_m * 1e-3)
}

/// Sum of `T_de` at the middle of a piece (Eq. 24), with zones and area.
fn exposure_per_km(model: &CostModel, curve: &Curve, k: usize) -> f64 {
    let piece = curve.piece(k, 1);
    let middle = [
        0.5 * (piece.a[0] + piece.b[0]),
        0.5 * (piece.a[1] + piece.b[1]),
    ];
    let hazards = &model.hazards;
    let mut exposure = 0.0;
    for threat in &hazards.threats {
        let (east_m, north_m) = (middle[0] - threat.center[0], middle[1] - threat.center[1]);
        let share_sq = (east_m * east_m + north_m * north_m) / (threat.radius_m * threat.radius_m);
        if share_sq < 1.0 {
            exposure += match model.paper.options.threat_form {
                ThreatForm::Quartic => 1.0 / (1.0 + share_sq * share_sq),
                ThreatForm::Linear => 1.0 - share_sq.sqrt(),
            };
        }
    }
    hazards.add_polygons(&piece, exposure, &mut Vec::new())
}

/// Eq. 26 and 27 for one piece: slope beyond the limit by angle or polynomial,
/// which are those at its first point.
fn slope_excess(model: &CostModel, step: &Step, amsl_m: f64) -> f64 {
    let limit = if step.rise_m >= 0.0 {
        model.limits.climb.by_shape(Amsl(amsl_m))
    } else {
        model.limits.descent.by_shape(Amsl(amsl_m))
    };
    let excess_m = step.rise_m.abs() - limit * model.slope_share * step.run_m;
    if excess_m > 0.0 {
        excess_m / step.run_m.max(1e-3)
    } else {
        0.0
    }
}

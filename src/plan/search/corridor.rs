//! Routes through corridors: what is searched where the default finds no path that keeps the
//! limits.
//!
//! The classes come from free space alone. Each is fitted with as many control points as its bends
//! need, drawn tight and judged; the fewest control points with a clean fit are searched. It runs
//! only after the default search, so the plans that this finds keep their bytes.

use rayon::prelude::*;

use super::fit::{Fitter, Line, Warp};
use super::problem::Sampled;
use super::tighten::{FieldCost, Tightener};
use super::{Found, Run, fine, found_among, swarms};
use crate::cost::CostTerms;
use crate::geodesy::EastNorth;
use crate::path::VehicleLimits;
use crate::plan::classes::HomotopyClass;
use crate::plan::classes::corridors::corridors;
use crate::plan::classes::routes::HomotopyClasses;
use crate::plan::route_context::{RouteContext, with_free_controls};
use crate::plan::spline::Spline;
use crate::spec::{Algorithm, Objective};

/// Control points for each bend of a corridor by a right angle: before it, in it, after it.
const PER_BEND: f64 = 3.0;
/// How many more control points the next attempt has.
const MORE: f64 = 1.5;
/// Most control points between the ends: the altitudes of more are slow to decode.
const MAX_CONTROLS: usize = 400;
/// Classes of which fits are judged.
const JUDGED_CLASSES: usize = 6;
/// Evaluations times control points: decoding altitudes takes longer with more of these.
const MAX_WORK: usize = 1_000_000;

/// What was found, or where that violates a limit that no other vehicle sets, what is found
/// through corridors, if it keeps all limits.
pub(super) fn or_through_corridors(
    context: &RouteContext<'_>,
    run: Run<'_>,
    first: Found,
) -> Found {
    let planner = &context.spec.planner;
    let is_default = (planner.algorithm, planner.objective)
        == (Algorithm::Msfoa, Objective::Operational)
        && context.options.classes;
    if !is_default || keeps_static_limits(&first.strict) {
        return first;
    }
    let Some(homotopy) = corridors(context) else {
        return first;
    };
    let mut controls = needed_controls(context, &homotopy);
    loop {
        let spec = with_free_controls(context.spec, controls);
        let context = RouteContext {
            spec: &spec,
            ..*context
        };
        let fits = fits(&context, &homotopy);
        let fitted = found_among(&context, fits.clone(), first.evaluations);
        if keeps_static_limits(&fitted.strict) {
            return searched_from(&context, run, &homotopy, fits, first.evaluations);
        }
        if controls == MAX_CONTROLS {
            return first;
        }
        controls = times_more(controls).min(MAX_CONTROLS);
    }
}

/// The best of clean fits and of what is found from them.
fn searched_from(
    context: &RouteContext<'_>,
    run: Run<'_>,
    homotopy: &HomotopyClasses,
    fits: Vec<Spline>,
    before: usize,
) -> Found {
    let budget = run.budget.min(MAX_WORK / context.controls());
    let (mut splines, evaluations) = swarms(context, Run { budget, ..run }, homotopy);
    splines.extend(fits);
    let found = found_among(context, splines, before + evaluations);
    found
}

/// Splines along the cheapest classes, drawn tight.
fn fits(context: &RouteContext<'_>, homotopy: &HomotopyClasses) -> Vec<Spline> {
    let parameters = context.parameters(context.samples());
    let rows = Sampled::new(context, context.margins, &parameters).rows();
    let fitter = Fitter::new(rows, parameters, context.controls());
    let tightener = Tightener::new(&fitter, context.ends_at());
    let fine = fine(context);
    let fitted = |class: &HomotopyClass| {
        let field_cost = FieldCost {
            ground: &homotopy.grounds[class.field],
            threats: &[],
            wider_m: 0.0,
            price: (0.0, 0.0),
        };
        let line = Line::new(class.line.clone());
        let loose: Vec<EastNorth> = fitter.fit(&line, &Warp::even());
        let tight = tightener.tighten(&field_cost, &loose);
        [loose, tight].map(|free| fine.spline(free.into_iter()))
    };
    let classes = homotopy.classes.par_iter().take(JUDGED_CLASSES);
    classes.flat_map_iter(fitted).collect()
}

/// Whether a path keeps all limits but the distance from other vehicles.
fn keeps_static_limits(strict: &CostTerms) -> bool {
    let alone = CostTerms {
        collision: 0.0,
        ..*strict
    };
    alone.is_clean()
}

/// Control points that the bends of the cheapest corridor need, at least those of the spec.
fn needed_controls(context: &RouteContext<'_>, homotopy: &HomotopyClasses) -> usize {
    let radius_m = VehicleLimits::of(context.vehicle()).turn_radius_m;
    let bends = homotopy.classes.first().map_or(0.0, |class| {
        let line = Line::new(class.line.clone());
        line.turned_rad(0.5 * radius_m) / std::f64::consts::FRAC_PI_2
    });
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to a few hundred"
    )]
    let needed = (PER_BEND * bends).clamp(0.0, 400.0) as usize;
    (needed + 4).clamp(context.spec.planner.control_points, MAX_CONTROLS)
}

fn times_more(controls: usize) -> usize {
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a few hundred"
    )]
    let more = (MORE * controls as f64).ceil() as usize;
    more
}

//! Judgement of splines at fine sampling, and of routes that need no search.

use super::Found;
use super::problem::Sampled;
use crate::cost::{Batch, CostTerms, Margins};
use crate::geodesy::{EastNorth, PlanPoint};
use crate::optimize::Candidate;
use crate::plan::route_context::{RouteContext, with_free_controls};
use crate::plan::spline::Spline;
use crate::spec::MAX_CONTROL_POINTS;

/// Samples at which results are judged.
pub(in crate::plan) const JUDGED_SAMPLES: usize = 2001;
/// Metres over the floor in the altitudes of what is judged, where samples are so near to
/// each other that little can rise between them; the search keeps more.
pub(super) const JUDGED_ABOVE_M: f64 = 0.1;
/// Finalists that are judged.
const JUDGED: usize = 24;

/// The finalists worth a judgement, best first.
pub(super) fn most_promising(mut finalists: Vec<Candidate>) -> Vec<Candidate> {
    finalists.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    finalists.dedup_by(|a, b| a.position == b.position);
    finalists.truncate(JUDGED);
    finalists
}

/// The best of some splines, and the number of evaluations that were spent on them.
pub(super) fn found_among(
    context: &RouteContext<'_>,
    splines: Vec<Spline>,
    evaluations: usize,
) -> Found {
    Found {
        evaluations,
        ..judge(context, splines)
    }
}

/// The best of some splines at fine sampling. Chosen with the margins that verification
/// asked for, reported without.
fn judge(context: &RouteContext<'_>, splines: Vec<Spline>) -> Found {
    let strict = judged(context, &splines, context.margins);
    let (spline, strict) = splines
        .into_iter()
        .zip(strict)
        .min_by(|(_, a), (_, b)| {
            let broken = |terms: &CostTerms| u8::from(!terms.is_clean());
            (broken(a).cmp(&broken(b))).then(a.total().total_cmp(&b.total()))
        })
        .unwrap_or_else(|| (context.straight(), CostTerms::default()));
    let plain = judged(context, std::slice::from_ref(&spline), Margins::default());
    Found {
        spline,
        terms: plain.first().copied().unwrap_or_default(),
        strict,
        evaluations: 0,
    }
}

/// Terms of splines at fine sampling, with some margins.
pub(super) fn judged(
    context: &RouteContext<'_>,
    splines: &[Spline],
    margins: Margins,
) -> Vec<CostTerms> {
    let mut batch = Batch::new(context.controls());
    for spline in splines {
        batch.push(&spline.controls());
    }
    context
        .model(margins, &context.parameters(JUDGED_SAMPLES))
        .judge(&batch)
}

/// A planned route, given by its control points, judged anew.
pub(in crate::plan) fn judged_route(context: &RouteContext<'_>, points: &[PlanPoint]) -> Found {
    let spec = with_free_controls(context.spec, points.len().saturating_sub(2));
    let context = &RouteContext {
        spec: &spec,
        ..*context
    };
    let spline = Spline {
        east_m: points.iter().map(|point| point.at.east_m).collect(),
        north_m: points.iter().map(|point| point.at.north_m).collect(),
        amsl_m: points.iter().map(|point| point.amsl.0).collect(),
    };
    judge(context, vec![spline])
}

/// The straight route between the ends at the altitudes that its margins ask for, whatever limits
/// that breaks.
pub(in crate::plan) fn straight(context: &RouteContext<'_>) -> Found {
    /// Length of a straight route for each of its control points, metres.
    const EACH_M: f64 = 40.0;
    /// Fewest control points besides the ends.
    const FEWEST: usize = 4;
    let (from, to) = context.ends_at();
    let pieces = (from.distance_m(to) / EACH_M).clamp(0.0, 1000.0);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "limited to the range before"
    )]
    let free = (pieces as usize).clamp(FEWEST, MAX_CONTROL_POINTS);
    #[expect(clippy::cast_precision_loss, reason = "few control points")]
    let point = |number: usize| {
        let share = number as f64 / (free + 1) as f64;
        EastNorth {
            east_m: from.east_m + share * (to.east_m - from.east_m),
            north_m: from.north_m + share * (to.north_m - from.north_m),
        }
    };
    let outline: Vec<EastNorth> = (1..=free).map(point).collect();
    along(context, &outline)
}

/// The way of free control points at the altitudes that the route's margins ask for.
pub(super) fn along(context: &RouteContext<'_>, outline: &[EastNorth]) -> Found {
    let spec = with_free_controls(context.spec, outline.len());
    let context = &RouteContext {
        spec: &spec,
        ..*context
    };
    let spline = fine(context).spline(outline.iter().copied());
    let splines = std::slice::from_ref(&spline);
    let first = |terms: Vec<CostTerms>| terms.first().copied().unwrap_or_default();
    let strict = first(judged(context, splines, context.margins));
    let terms = first(judged(context, splines, Margins::default()));
    Found {
        terms,
        strict,
        spline,
        evaluations: 1,
    }
}

/// The route as results are judged.
pub(super) fn fine<'a>(context: &RouteContext<'a>) -> Sampled<'a> {
    Sampled::above(
        context,
        context.margins,
        &context.parameters(JUDGED_SAMPLES),
        JUDGED_ABOVE_M,
    )
}

//! A found path drawn taut: straight past the corners of what is closed, with turns as tight as the
//! vehicle may fly.
//!
//! A spline of few control points rounds corners more widely than need be. Here the shortest line
//! along the path gets as many control points as its corners need. What was found stands unless that
//! keeps all limits and costs less.

mod belt;
pub(super) mod climbs;
mod mend;

use rayon::prelude::*;

use mend::Rounded;

use super::Found;
use super::fit::Line;
use super::judgement::{JUDGED_SAMPLES, along};
use super::polish::{fits_items, is_for_polish, plane};
use crate::cost::CostTerms;
use crate::geodesy::EastNorth;
use crate::numeric::as_f64;
use crate::numeric::bspline::uniform_parameters;
use crate::path::VehicleLimits;
use crate::plan::classes::taut_line::taut_line;
use crate::plan::route_context::RouteContext;
use crate::spec::Airframe;

/// How much wider turns are than they have to be, tightest first.
const WIDER: [f64; 5] = [1.03, 1.08, 1.13, 1.2, 1.35];
/// Fewest spans of a straight line.
const SPANS: usize = 20;
/// Length of the pieces of the line of a class, metres, and most of them.
const FINE_M: f64 = 5.0;
const MAX_PIECES: f64 = 4000.0;
/// Distance of the samples at which mended paths are judged, metres, and how many times more they are at most.
const CHORD_M: f64 = 0.8;
const MAX_FINER: f64 = 8.0;
/// Most control points between the ends.
const MAX_CONTROLS: usize = 800;

/// A found route, or one along the shortest line near it that keeps all limits and costs less.
pub(super) fn taut(context: &RouteContext<'_>, found: Found) -> Found {
    if context.vehicle().airframe != Airframe::Copter
        || context.is_cancelled()
        || !is_for_polish(context)
    {
        return found;
    }
    let path = plane(&found.spline);
    let max_m = Line::new(path.clone()).length_m();
    let max_cost = found.strict.total();
    let is_better = |strict: &CostTerms| strict.is_clean() && strict.total() < max_cost;
    match drawn(context, &path, max_m, (&is_better, false)) {
        Some(drawn) => Found {
            evaluations: found.evaluations,
            ..drawn
        },
        None => found,
    }
}

/// The cheapest path along some lines, each drawn taut, that keeps all limits; where none does, one that
/// keeps those that no other vehicle sets.
pub(super) fn along_lines(context: &RouteContext<'_>, lines: &[Vec<EastNorth>]) -> Option<Found> {
    if context.vehicle().airframe != Airframe::Copter || !is_for_polish(context) {
        return None;
    }
    let any_m = f64::INFINITY;
    let along = |line: &Vec<EastNorth>| {
        let is_good: &(dyn Fn(&CostTerms) -> bool + Sync) = &CostTerms::keeps_static_limits;
        drawn(context, &finely(line), any_m, (is_good, true))
    };
    let drawn: Vec<Found> = lines.par_iter().filter_map(along).collect();
    drawn.into_iter().min_by(Found::by_limits)
}

/// A line with a point every few metres.
pub(super) fn finely(line: &[EastNorth]) -> Vec<EastNorth> {
    let line = Line::new(line.to_vec());
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "limited to the range before"
    )]
    let pieces = (line.length_m() / FINE_M).ceil().clamp(1.0, MAX_PIECES) as usize;
    let at = |piece: usize| line.at(as_f64(piece) / as_f64(pieces));
    (0..=pieces).map(at).collect()
}

/// The path along the shortest line near another one, shorter than `max_m`, with the tightest turns
/// with which it is good.
fn drawn(
    context: &RouteContext<'_>,
    path: &[EastNorth],
    max_m: f64,
    (is_good, mends): (&(dyn Fn(&CostTerms) -> bool + Sync), bool),
) -> Option<Found> {
    let limits = VehicleLimits::of(context.vehicle());
    let radius_m = limits.turn_radius_m * (1.0 + context.margins.turn_fraction);
    let (line, closed) = taut_line(context, path, radius_m)?;
    let line_m = Line::new(line.iter().map(|bend| bend.at).collect()).length_m();
    if line_m >= max_m {
        return None;
    }
    // Further samples were for another path: as they lie uneven they would call turns too tight.
    let anew = RouteContext {
        extra: &[],
        ..*context
    };
    let span_m = line_m / as_f64(SPANS.max(context.controls() - 3));
    for wider in WIDER {
        let Some(free) = belt::controls(&line, &vec![wider * radius_m; line.len()], span_m) else {
            continue;
        };
        if free.len() > MAX_CONTROLS {
            continue;
        }
        let drawn = along(&anew, &free);
        if is_good(&drawn.strict) && fits_items(context, &drawn.spline) {
            return Some(drawn);
        }
    }
    if !mends {
        return None;
    }
    let judged = |context: &RouteContext<'_>, free: &[EastNorth]| {
        let finer = finer(Line::new(free.to_vec()).length_m());
        let anew = RouteContext {
            extra: &finer,
            ..*context
        };
        let drawn = along(&anew, free);
        (is_good(&drawn.strict) && fits_items(context, &drawn.spline)).then_some(drawn)
    };
    let mut rounded = Rounded::new(&line, radius_m);
    let mended = rounded.mend(radius_m, span_m);
    if let Some(mended) = mended.and_then(|free| judged(context, &free)) {
        return Some(mended);
    }
    let at_edges = &RouteContext {
        at_edges: true,
        ..*context
    };
    let free = climbs::long_enough(at_edges, (rounded, closed), (radius_m, span_m))?;
    judged(at_edges, &free)
}

/// Even parameters among those at which results are judged, so that chords cut no corner: for paths of some length.
fn finer(length_m: f64) -> Vec<f64> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "limited to the range before"
    )]
    let times = (length_m / CHORD_M / as_f64(JUDGED_SAMPLES))
        .ceil()
        .clamp(1.0, MAX_FINER) as usize;
    uniform_parameters(times * (JUDGED_SAMPLES - 1) + 1)
}

#[cfg(test)]
mod tests;

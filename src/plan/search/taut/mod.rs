//! A found path drawn taut: straight past the corners of what is closed, with turns as tight as the
//! vehicle may fly.
//!
//! A spline of few control points rounds corners more widely than need be. Here the shortest line
//! along the path gets as many control points as its corners need. What was found stands unless that
//! keeps all limits and costs less.

mod belt;

use super::fit::Line;
use super::polish::{fits_items, is_for_polish, plane};
use super::{Found, along};
use crate::numeric::as_f64;
use crate::path::VehicleLimits;
use crate::plan::classes::taut_line::taut_line;
use crate::plan::route_context::RouteContext;
use crate::spec::Airframe;

/// How much wider turns are than they have to be, tightest first.
const WIDER: [f64; 5] = [1.03, 1.08, 1.13, 1.2, 1.35];
/// Fewest spans of a straight line.
const SPANS: usize = 20;
/// Most control points between the ends.
const MAX_CONTROLS: usize = 300;

/// A found route, or one along the shortest line near it that keeps all limits and costs less.
pub(super) fn taut(context: &RouteContext<'_>, found: Found) -> Found {
    if context.vehicle().airframe != Airframe::Copter
        || context.is_cancelled()
        || !is_for_polish(context)
    {
        return found;
    }
    let limits = VehicleLimits::of(context.vehicle());
    let radius_m = limits.turn_radius_m * (1.0 + context.margins.turn_fraction);
    let path = plane(&found.spline);
    let Some(line) = taut_line(context, &path, radius_m) else {
        return found;
    };
    let line_m = Line::new(line.iter().map(|bend| bend.at).collect()).length_m();
    if line_m >= Line::new(path).length_m() {
        return found;
    }
    // Further samples were for another path: as they lie uneven they would call turns too tight.
    let anew = RouteContext {
        extra: &[],
        ..*context
    };
    let span_m = line_m / as_f64(SPANS.max(context.controls() - 3));
    for wider in WIDER {
        let Some(free) = belt::controls(&line, wider * radius_m, span_m) else {
            continue;
        };
        if free.len() > MAX_CONTROLS {
            continue;
        }
        let drawn = along(&anew, &free);
        let costs_less = drawn.strict.total() < found.strict.total();
        if drawn.strict.is_clean() && costs_less && fits_items(context, &drawn.spline) {
            return Found {
                evaluations: found.evaluations,
                ..drawn
            };
        }
    }
    found
}

#[cfg(test)]
mod tests;

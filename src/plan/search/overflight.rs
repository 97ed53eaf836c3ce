//! Routes over, under and around zones with heights, each as a class of its own.
//!
//! The default search decodes the altitudes of few control points at samples that miss the edges
//! of zones, and stays in one valley of the plane. Here lines that pass the corners of zones exactly are laid as
//! splines with control points at each bend, at altitudes that are over zones from edge to edge.
//! What the default found stands unless one of these keeps all limits and costs less.

use rayon::prelude::*;

use super::corridor::stands;
use super::fit::Line;
use super::judgement::along;
use super::{Found, polish};
use crate::geodesy::EastNorth;
use crate::path::VehicleLimits;
use crate::plan::classes::overflights::{AWAY_M, has_overflights, overflight_lines};
use crate::plan::route_context::{RouteContext, with_free_controls};
use crate::spec::{Algorithm, Objective};

/// Lines that are laid as splines, and splines that are polished.
const LINES: usize = 24;
const POLISHED: usize = 4;
/// What does not cost less than a clean route by this share is no other class of it.
const GAIN: f64 = 5e-3;
/// Most control points between the ends.
const MAX_CONTROLS: usize = 120;
/// Spans of a straight line.
const SPANS: f64 = 20.0;
/// Least distance of control points around a bend, metres, and most, as a share of the legs.
const MIN_BEND_M: f64 = 8.0;
const BEND_SHARE: f64 = 0.3;
/// Distance of control points around a bend, in turn radii and radians: a spline bends twice as
/// wide as it has to.
const WIDE: f64 = 3.0;

/// What was found, polished, or a cheaper route over, under and around zones.
pub(super) fn polished_or_overflight(context: &RouteContext<'_>, found: Found) -> Found {
    let outline = inner(&found);
    let first = polish::polished(context, found);
    let planner = &context.spec.planner;
    let is_default = (planner.algorithm, planner.objective)
        == (Algorithm::Msfoa, Objective::Operational)
        && context.options.classes;
    if !is_default || context.is_cancelled() || !has_overflights(context) {
        return first;
    }
    let mut most = f64::INFINITY;
    let context = &RouteContext {
        at_edges: true,
        ..*context
    };
    let mut laid = Vec::new();
    if stands(context, &first) {
        // To other vehicles it gives way by other means.
        most = (1.0 - GAIN) * (first.terms.total() - first.terms.collision);
    } else {
        laid.push(along(context, &outline));
    }
    laid.extend(splines(context, most));
    laid.sort_by(Found::by_limits);
    laid.truncate(POLISHED);
    let evaluations = first.evaluations;
    let polished = laid.into_par_iter().map(|found| {
        let spec = with_free_controls(context.spec, found.spline.east_m.len() - 2);
        let context = RouteContext {
            spec: &spec,
            ..*context
        };
        polish::polished(&context, found)
    });
    let polished: Vec<Found> = polished.collect();
    let best = polished.into_iter().min_by(Found::by_limits);
    let better = best.filter(|best| best.strict.is_clean() && best.strict.total() < most);
    Found {
        evaluations,
        ..better.unwrap_or(first)
    }
}

/// The cheapest lines below a cost as splines.
fn splines(context: &RouteContext<'_>, most: f64) -> Vec<Found> {
    let limits = VehicleLimits::of(context.vehicle());
    let radius_m = limits.turn_radius_m * (1.0 + context.margins.turn_fraction);
    let lines = overflight_lines(context, LINES, (most, AWAY_M)).into_par_iter();
    lines
        .map(|line| along(context, &controls(&line, radius_m)))
        .collect()
}

/// The free control points of a route in the plane.
fn inner(found: &Found) -> Vec<EastNorth> {
    let (east, north) = (&found.spline.east_m, &found.spline.north_m);
    let all = east.iter().zip(north);
    let all = all.map(|(&east_m, &north_m)| EastNorth { east_m, north_m });
    all.skip(1).take(east.len().saturating_sub(2)).collect()
}

/// The free control points of a spline along a line: three at each bend, so that it passes the
/// corner there, and others evenly between them.
fn controls(line: &[EastNorth], radius_m: f64) -> Vec<EastNorth> {
    let (Some(&start), Some(&goal)) = (line.first(), line.last()) else {
        return Vec::new();
    };
    let spacing_m = Line::new(line.to_vec()).length_m() / SPANS;
    let mut anchors = vec![start];
    for three in line.windows(3) {
        anchors.extend(bend([three[0], three[1], three[2]], radius_m));
    }
    anchors.push(goal);
    let mut free = Vec::new();
    for pair in anchors.windows(2) {
        let leg = Line::new(pair.to_vec());
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a few dozen"
        )]
        let pieces = (leg.length_m() / spacing_m.max(1e-9)).ceil().max(1.0) as usize;
        #[expect(clippy::cast_precision_loss, reason = "a few dozen")]
        free.extend((1..=pieces).map(|k| leg.at(k as f64 / pieces as f64)));
    }
    free.pop();
    free.truncate(MAX_CONTROLS);
    free
}

/// Control points around a bend: on the legs before and behind it, and between them so far out
/// that the spline passes the corner.
fn bend([before, at, after]: [EastNorth; 3], radius_m: f64) -> [EastNorth; 3] {
    let (into_m, out_m) = (before.distance_m(at), at.distance_m(after));
    let toward = |end: EastNorth, length_m: f64, by_m: f64| {
        let share = by_m / length_m.max(1e-9);
        EastNorth {
            east_m: at.east_m + share * (end.east_m - at.east_m),
            north_m: at.north_m + share * (end.north_m - at.north_m),
        }
    };
    // Between points a metre before and behind the corner there are twice the cosine of half the turn.
    let apart_m = toward(before, into_m, 1.0).distance_m(toward(after, out_m, 1.0));
    let turn_rad = 2.0 * (0.5 * apart_m).clamp(0.0, 1.0).acos();
    let near_m = (WIDE * turn_rad * radius_m)
        .max(MIN_BEND_M)
        .min(BEND_SHARE * into_m.min(out_m));
    let (first, last) = (toward(before, into_m, near_m), toward(after, out_m, near_m));
    // A spline passes its control points by a sixth of the second difference.
    let out = |first: f64, at: f64, last: f64| at - 0.25 * (first + last - 2.0 * at);
    let middle = EastNorth {
        east_m: out(first.east_m, at.east_m, last.east_m),
        north_m: out(first.north_m, at.north_m, last.north_m),
    };
    [first, middle, last]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::Basis;

    #[test]
    fn a_spline_along_a_line_passes_its_corners_and_bends_as_wide_as_it_has_to() {
        const RADIUS_M: f64 = 25.0;
        let at = |east_m, north_m| EastNorth { east_m, north_m };
        let line = [
            at(0.0, 0.0),
            at(2000.0, 300.0),
            at(2600.0, 300.0),
            at(5000.0, -900.0),
        ];
        let free = controls(&line, RADIUS_M);
        let all = [&line[..1], &free, &line[3..]].concat();
        let basis = Basis::uniform(all.len(), 20_001);
        let sampled =
            |of: fn(&EastNorth) -> f64| basis.sampled(&all.iter().map(of).collect::<Vec<f64>>());
        let (east, north) = (sampled(|at| at.east_m), sampled(|at| at.north_m));
        let path: Vec<EastNorth> = east.into_iter().zip(north).map(|(e, n)| at(e, n)).collect();
        for corner in &line[1..3] {
            let nearest_m = path.iter().map(|at| at.distance_m(*corner));
            assert!(nearest_m.fold(f64::INFINITY, f64::min) < 0.5);
        }
        for three in path.windows(3) {
            let (into, out) = (three[0].distance_m(three[1]), three[1].distance_m(three[2]));
            let across = three[0].distance_m(three[2]);
            // Menger's curvature of three points by Heron's formula.
            let half = 0.5 * (into + out + across);
            let area_sq = half * (half - into) * (half - out) * (half - across);
            let per_m = 4.0 * area_sq.max(0.0).sqrt() / (into * out * across);
            assert!(per_m < 1.0 / RADIUS_M, "{per_m} at {three:?}");
        }
    }
}

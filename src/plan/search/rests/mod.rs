//! Ways of straight legs on which a copter rests where they bend.
//!
//! A copter that comes to rest at a corner needs no space to turn there, so that the exact line past the corners
//! of what is closed is flown as it is: through streets, slots and tubes too narrow for turns at full speed. Where it is too
//! short for climbs and descents, legs to and fro make it longer ([`zigzag`]).

mod zigzag;

use rayon::prelude::*;

use super::Found;
use super::corridor::passings;
use super::fit::Line;
use super::judgement::along;
use super::polish::is_for_polish;
use super::taut::finely;
use crate::cost::Margins;
use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::path::VehicleLimits;
use crate::plan::classes::corridors::corridors_of_gaps;
use crate::plan::classes::overflights::overflight_lines;
use crate::plan::classes::taut_line::{Closed, cornered_line};
use crate::plan::route_context::RouteContext;
use crate::spec::Airframe;

/// Longest distance of control points on a leg, metres, and most of them on a way.
const SPAN_M: f64 = 40.0;
const MAX_CONTROLS: usize = 1200;
/// A spline passes a control point that it has so often.
const AT_CORNER: usize = 3;
/// Lines of each kind that are tried.
const LINES: usize = 8;
/// They pass corners at this distance, metres.
const AWAY_M: f64 = 0.05;

/// What ways that are made longer have more room for, metres and as a share of slopes.
const ROOM_M: f64 = 0.3;
const ROOM_SLOPE: f64 = 0.05;

/// A way with rests between its ends.
#[derive(Clone, Debug)]
pub(crate) struct Rests {
    /// Where it bends, in order.
    pub at: Vec<PlanPoint>,
    /// What it costs.
    pub cost: f64,
}

/// The cheapest way with rests along lines that are exact in the plane, among those that cost less than `most`; none
/// where none keeps the limits.
pub(crate) fn rests(context: &RouteContext<'_>, most: f64) -> Option<Rests> {
    if context.vehicle().airframe != Airframe::Copter || !is_for_polish(context) {
        return None;
    }
    let exact = &context.as_exact();
    let lines = lines(exact, most);
    let plain = |line: &[EastNorth], _: &Closed| along_line(exact, line);
    cheapest(exact, (&lines, most), plain).or_else(|| {
        let roomier = &roomier(exact);
        let longer = |line: &[EastNorth], closed: &Closed| {
            along_line(roomier, &zigzag::long_enough(roomier, line, closed)?)
        };
        cheapest(roomier, (&lines, most), longer)
    })
}

/// The same with room for what encoding changes of slopes and heights between places that are given.
fn roomier<'a>(context: &RouteContext<'a>) -> RouteContext<'a> {
    let margins = &context.margins;
    RouteContext {
        margins: Margins {
            threat_m: margins.threat_m + ROOM_M,
            climb_fraction: margins.climb_fraction + ROOM_SLOPE,
            ..*margins
        },
        ..*context
    }
}

/// The cheapest way that a function makes of the corners of lines, among those that cost less than `most`.
fn cheapest(
    context: &RouteContext<'_>,
    (lines, most): (&[Vec<EastNorth>], f64),
    way: impl Fn(&[EastNorth], &Closed) -> Option<Rests> + Sync,
) -> Option<Rests> {
    let mut cornered: Vec<(Vec<EastNorth>, Closed)> = (lines.par_iter())
        .filter_map(|line| cornered(context, line))
        .collect();
    cornered.dedup_by(|a, b| a.0 == b.0);
    let ways = (cornered.par_iter()).filter_map(|(line, closed)| way(line, closed));
    let ways: Vec<Rests> = ways.filter(|way| way.cost < most).collect();
    ways.into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost))
}

/// The shortest line near one, as its corners.
fn cornered(context: &RouteContext<'_>, line: &[EastNorth]) -> Option<(Vec<EastNorth>, Closed)> {
    let radius_m = VehicleLimits::of(context.vehicle()).turn_radius_m;
    cornered_line(context, &finely(line), radius_m)
}

/// Lines that are exact in the plane, then those through free space.
fn lines(context: &RouteContext<'_>, most: f64) -> Vec<Vec<EastNorth>> {
    let world = context.world;
    let mut lines = match world.zones.is_empty() {
        true => Vec::new(),
        false => overflight_lines(context, LINES, (most, AWAY_M)),
    };
    for passing in passings(world) {
        let found = corridors_of_gaps(context, passing);
        let classes = found.into_iter().flat_map(|found| found.classes);
        lines.extend(classes.take(LINES).map(|class| class.line));
    }
    lines
}

/// The way along a line.
fn along_line(context: &RouteContext<'_>, corners: &[EastNorth]) -> Option<Rests> {
    let (outline, numbers) = outline(corners);
    if outline.len() > MAX_CONTROLS {
        return None;
    }
    let found = along(context, &outline);
    keeps_all_but_turns(&found).then(|| Rests {
        at: numbers
            .iter()
            .map(|&number| at_corner(&found, number))
            .collect(),
        cost: found.strict.length + found.strict.altitude,
    })
}

fn keeps_all_but_turns(found: &Found) -> bool {
    let terms = found.strict;
    // Steps as steep as they may be are off by rounding.
    const ROUNDING: f64 = 1e-6;
    terms.threat + terms.terrain + terms.collision <= 0.0 && terms.climb <= ROUNDING
}

/// Where a spline passes a corner that is three of its control points, the middle one by its number.
fn at_corner(found: &Found, number: usize) -> PlanPoint {
    let spline = &found.spline;
    let amsl_m = &spline.amsl_m[number - 1..=number + 1];
    let at = (amsl_m[0] + 4.0 * amsl_m[1] + amsl_m[2]) / 6.0;
    PlanPoint::new(spline.east_m[number], spline.north_m[number], Amsl(at))
}

/// Control points of a spline along a line, and the numbers of those in the middle of each corner, the first end counted.
fn outline(line: &[EastNorth]) -> (Vec<EastNorth>, Vec<usize>) {
    let (mut free, mut numbers) = (Vec::new(), Vec::new());
    // A cubic along one leg has two free control points at least.
    let least = if line.len() > 2 { 2.0 } else { 3.0 };
    for (index, pair) in line.windows(2).enumerate() {
        let leg = Line::new(pair.to_vec());
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "limited to the range before"
        )]
        let pieces = (leg.length_m() / SPAN_M).ceil().clamp(least, 1000.0) as usize;
        #[expect(clippy::cast_precision_loss, reason = "at most a thousand")]
        free.extend((1..pieces).map(|piece| leg.at(piece as f64 / pieces as f64)));
        if index + 2 < line.len() {
            free.extend([pair[1]; AT_CORNER]);
            numbers.push(free.len() - 1);
        }
    }
    (free, numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spline_along_the_shortest_line_has_enough_control_points() {
        let at = |east_m: f64| EastNorth {
            east_m,
            north_m: 0.0,
        };
        for (line, corners) in [
            (vec![at(0.0), at(0.5)], 0),
            (vec![at(0.0), at(0.5), at(1.0)], 1),
        ] {
            let (free, numbers) = outline(&line);
            assert!(free.len() >= 2, "{free:?}");
            assert_eq!(numbers.len(), corners);
        }
    }
}

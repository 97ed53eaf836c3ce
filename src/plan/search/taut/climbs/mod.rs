//! A line made longer where a vehicle cannot climb or descend fast enough along it.
//!
//! Between the highest and the lowest flight along a line lie all others. Where the highest is too low for what the
//! line crosses, or the lowest too high for what it passes under, the line before that place is too short, by what the
//! missing metres take at the steepest slope: a bend aside or circles make it as long as it has to be.

mod longer;
mod short;

use super::mend::{self, Rounded};
use crate::geodesy::EastNorth;
use crate::plan::altitude::Demand;
use crate::plan::altitude::floor::{FloorMaker, SampledLine};
use crate::plan::classes::taut_line::Closed;
use crate::plan::route_context::RouteContext;
use crate::plan::search::fit::Line;
use crate::plan::search::judgement::JUDGED_ABOVE_M;
pub(in crate::plan::search) use short::Short;

/// Most rounds in which a line is made longer.
const MAX_ROUNDS: usize = 60;
/// Turns that are made are wider than the tightest by this.
const WIDER: f64 = 1.06;
/// Turns tighter than this share of the tightest one count.
const TIGHT: f64 = 0.95;
/// What of the slopes of the vehicle is not used: where heights bend a spline takes a while.
const SPARE_SLOPE: f64 = 0.015;
/// Distance of control points on straight legs, metres, as far as there are not more than some: heights bend there.
const SPAN_M: f64 = 30.0;
const MAX_SPANS: f64 = 300.0;

/// What lines are held against.
struct Climbs<'a> {
    context: &'a RouteContext<'a>,
    floor: FloorMaker<'a>,
    closed: Closed,
    /// The tightest turn, and that of turns that are made, metres.
    tightest_m: f64,
    radius_m: f64,
    span_m: f64,
}

/// A line with where it is too short, and the number of samples at which it turns too tightly.
struct Held {
    line: Rounded,
    short: Option<Short>,
    tight: usize,
}

/// Control points of a spline along a line that is made as long as climbs and descents take; none where it is long
/// enough, or where there is no space for that.
pub(super) fn long_enough(
    context: &RouteContext<'_>,
    (line, closed): (Rounded, Closed),
    (radius_m, span_m): (f64, f64),
) -> Option<Vec<EastNorth>> {
    let length_m = Line::new(line.line.iter().map(|bend| bend.at).collect()).length_m();
    let climbs = Climbs {
        context,
        floor: floor_of(context),
        closed,
        tightest_m: radius_m,
        radius_m: WIDER * radius_m,
        span_m: span_m.min(SPAN_M.max(length_m / MAX_SPANS)),
    };
    let mut held = climbs.held(line)?;
    held.short.as_ref()?;
    for _ in 0..MAX_ROUNDS {
        held = match &held.short {
            Some(short) => climbs.longer(&held, short)?,
            None => {
                let before = held.line.controls(climbs.span_m);
                if held.line.mend(radius_m, climbs.span_m).is_none() {
                    return before;
                }
                // Where turns were mended it may be a little shorter.
                let mended = climbs.held(held.line)?;
                if mended.short.is_none() {
                    return mended.line.controls(climbs.span_m);
                }
                mended
            }
        };
    }
    None
}

impl Climbs<'_> {
    /// A line held against the limits; none where it has no spline, or where nothing passes.
    fn held(&self, line: Rounded) -> Option<Held> {
        let free = line.controls(self.span_m)?;
        let (short, path) = short_along(self.context, &self.floor, &free)?;
        let is_tight = |three: &&[EastNorth]| mend::radius_of(three) < TIGHT * self.tightest_m;
        Some(Held {
            line,
            short,
            tight: path.windows(3).filter(is_tight).count(),
        })
    }
}

/// What lines are held against that are made long enough: slopes somewhat flatter than the vehicle's.
pub(in crate::plan::search) fn floor_of<'a>(context: &RouteContext<'a>) -> FloorMaker<'a> {
    context.floor(JUDGED_ABOVE_M, context.margins.climb_fraction + SPARE_SLOPE)
}

/// Where the spline of some control points is too short for its climbs and descents, and its samples; none where
/// nothing passes.
pub(in crate::plan::search) fn short_along(
    context: &RouteContext<'_>,
    floor: &FloorMaker<'_>,
    free: &[EastNorth],
) -> Option<(Option<Short>, Vec<EastNorth>)> {
    let ends = context.ends;
    let path = mend::sampled((ends.from.at, ends.to.at), free);
    let (east_m, north_m): (Vec<f64>, Vec<f64>) =
        path.iter().map(|at| (at.east_m, at.north_m)).unzip();
    let ends_m = (ends.from.amsl.0, ends.to.amsl.0);
    let sampled = SampledLine {
        east_m: &east_m,
        north_m: &north_m,
        ends_m,
    };
    let (mut demand, mut lengths_m) = (Demand::default(), Vec::new());
    floor.fill(&sampled, &mut demand, &mut lengths_m);
    let roofs_m = floor.roofs_m((&east_m, &north_m), &demand.ground_m);
    let short = short::short(&demand, (&roofs_m, &lengths_m), ends_m)?;
    Some((short, path))
}

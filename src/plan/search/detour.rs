//! Detours: how a way that would meet earlier flights gives way to them.
//!
//! A path that lies straight in the way of another gains nothing by moving a little aside:
//! it gets later only with the square of that. So a swarm that begins on it is long in
//! conflict, and the race drops it for one that takes a far longer way of its own. Detours
//! are what it would find: a detour before the conflict, after which the others have
//! passed, or a way beside them.

use std::f64::consts::PI;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::fit::Line;
use crate::geodesy::EastNorth;
use crate::path::way_speed_mps;
use crate::plan::route_context::RouteContext;

/// Pieces of a line that is looked along.
const PIECES: usize = 256;
/// How much nearer than the separation the line may come, on time, before it is a conflict:
/// the path will be a little off.
const WARY: f64 = 1.2;
/// Least span of a detour, in distances between control points: shorter ones cannot be fitted.
const MIN_SPAN: f64 = 4.0;
/// Least delay, in units of the distance between two vehicles, and ratio of the longest to it.
const MIN_DELAY: f64 = 0.5;
const DELAYS: f64 = 12.0;
/// One detour in this many lies anywhere, the others before the conflict.
const ANYWHERE: u8 = 3;

/// How far along a line its first conflict with an earlier flight begins, metres.
pub(crate) fn conflict_m(context: &RouteContext<'_>, line: &Line) -> Option<f64> {
    let speed_mps = speed_mps(context);
    let near_m = WARY * apart_m(context);
    let along_m = |piece: usize| share(piece) * line.length_m();
    (0..=PIECES)
        .find(|&piece| {
            let (at, t_s) = (
                line.at(share(piece)),
                context.ends.start_s + along_m(piece) / speed_mps,
            );
            context.earlier.iter().any(|flight| {
                flight
                    .position(t_s)
                    .is_some_and(|other| other.at.distance_m(at) < near_m)
            })
        })
        .map(along_m)
}

/// A line that detours to one side, mostly before its conflict.
pub(crate) fn detour(
    context: &RouteContext<'_>,
    line: &Line,
    conflict_m: Option<f64>,
    to_left: bool,
    rng: &mut ChaCha8Rng,
) -> Line {
    let (length_m, apart_m) = (line.length_m(), apart_m(context));
    #[expect(clippy::cast_precision_loss, reason = "a number of control points")]
    let min_m = (MIN_SPAN * length_m / (context.controls() - 1) as f64).min(length_m);
    let anywhere = rng.random_range(0..ANYWHERE) == 0;
    let until_m = conflict_m
        .filter(|_| !anywhere)
        .map_or(length_m, |first_m| {
            (first_m + apart_m).clamp(min_m, length_m)
        });
    let span_m = min_m * (until_m / min_m).powf(rng.random_range(0.0..1.0));
    let delay_m = MIN_DELAY * apart_m * DELAYS.powf(rng.random_range(0.0..1.0));
    let first_m = rng.random_range(0.0..=1.0) * (until_m - span_m);
    // Half a wave of this height over a straight span is longer by the delay.
    let height_m = 2.0 / PI * (delay_m * span_m).sqrt();
    let height_m = if to_left { height_m } else { -height_m };
    let at = |piece: usize| {
        let position = line.at(share(piece));
        let within = (share(piece) * length_m - first_m) / span_m;
        if !(0.0..=1.0).contains(&within) {
            return position;
        }
        let before = line.at(share(piece.saturating_sub(1)));
        let after = line.at(share((piece + 1).min(PIECES)));
        let off = height_m * (PI * within).sin() / before.distance_m(after).max(1e-9);
        EastNorth {
            east_m: position.east_m - off * (after.north_m - before.north_m),
            north_m: position.north_m + off * (after.east_m - before.east_m),
        }
    };
    Line::new((0..=PIECES).map(at).collect())
}

fn share(piece: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "at most PIECES")]
    let share = piece as f64 / PIECES as f64;
    share
}

fn speed_mps(context: &RouteContext<'_>) -> f64 {
    way_speed_mps(context.vehicle(), context.ends.from, context.ends.to)
}

/// Way between two that follow each other, metres.
fn apart_m(context: &RouteContext<'_>) -> f64 {
    let separation = context.margins.beyond(&context.spec.buffered_separation());
    separation.distance_m + separation.time_slack_s * speed_mps(context)
}

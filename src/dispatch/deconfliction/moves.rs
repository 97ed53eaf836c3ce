//! Other shapes of the path that a vehicle would fly alone: bent aside, and raised for a while.

use std::f64::consts::TAU;
use std::iter::once;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::geodesy::PlanPoint;
use crate::plan::{Shape, VehiclePlan};
use crate::spec::Separation;

/// How far a path is bent to either side, in separations.
const ASIDE: [f64; 8] = [0.4, 0.8, 1.2, 1.7, 2.3, 3.0, 4.0, 5.5];
/// Where on a route it is furthest aside, as a share of it.
const PEAKS: [f64; 3] = [0.5, 0.3, 0.7];
/// How far a path is raised, in vertical separations.
const RAISED: [f64; 6] = [1.15, 1.5, 2.3, 2.8, 3.5, 4.6];
/// Where on a route it is raised, as the middle and half of the length, as shares of it.
const RAISED_FROM: [(f64, f64); 4] = [(0.5, 0.1), (0.28, 0.1), (0.72, 0.1), (0.5, 0.3)];
/// The same where a rule raises it over most of its length.
const RAISED_WIDE: (f64, f64) = (0.5, 0.2);
/// How far a path that is raised is bent at the same time, in separations.
const BOTH: [f64; 4] = [-2.0, -1.0, 1.0, 2.0];
/// Highest that is combined with a bend, in vertical separations.
const BOTH_UP_TO: f64 = 3.0;

/// Parts of a route in which it leads aside to be later, by their middle and half of their length, as
/// shares of it, and how far, in separations.
const DELAYED_AT: [(f64, f64); 8] = [
    (0.05, 0.045),
    (0.07, 0.065),
    (0.09, 0.085),
    (0.13, 0.12),
    (0.2, 0.15),
    (0.35, 0.2),
    (0.5, 0.2),
    (0.7, 0.2),
];
const DELAYED_BY: [f64; 8] = [1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 9.0, 13.0];

/// How soon in its part it is furthest aside: a third of the part is level.
const STEEP: f64 = 1.5;

/// Least share of a route over which it rises, and metres for each metre that it rises.
const RAMP: f64 = 0.12;
const GENTLE: f64 = 11.0;

/// How a rule changes the path of one vehicle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ruled {
    /// How far it is bent to the left, in separations.
    pub(super) aside: f64,
    /// How far it is raised, in steps of a vertical separation.
    pub(super) up: f64,
    /// Whether it is raised over most of its length.
    pub(super) is_wide: bool,
    /// Its departure, as a share of its window; none for the specified one.
    pub(super) window: Option<f64>,
}

/// Most that a path sways to either side, in separations.
const MAX_SWAY: f64 = 4.0;

/// Shares of the way to a cheaper shape that are tried.
const SHARES: [f64; 4] = [0.7, 0.4, 0.2, 0.08];

/// How far control points move, metres.
#[derive(Clone, Copy)]
struct Move {
    aside_m: f64,
    /// Share of the route at which it is furthest aside.
    peak: f64,
    up_m: f64,
    /// Middle and half of the length over which it is raised.
    raised: (f64, f64),
    /// How far it sways, to one side and then to the other: later from the middle on, and not
    /// elsewhere.
    sway_m: f64,
}

/// The shape itself and others around it.
pub(super) fn shapes(shape: &Shape, separation: &Separation) -> Vec<Shape> {
    let (side_m, up_m) = units(separation);
    let still = Move {
        aside_m: 0.0,
        peak: 0.5,
        up_m: 0.0,
        raised: RAISED_FROM[0],
        sway_m: 0.0,
    };
    let mut moves = Vec::new();
    for aside in ASIDE.into_iter().flat_map(|aside| [aside, -aside]) {
        moves.extend(PEAKS.map(|peak| Move {
            aside_m: aside * side_m,
            peak,
            ..still
        }));
    }
    for raised in RAISED_FROM {
        for up in RAISED {
            let level = Move {
                up_m: up * up_m,
                raised,
                ..still
            };
            moves.push(level);
            if up < BOTH_UP_TO {
                moves.extend(BOTH.map(|aside| Move {
                    aside_m: aside * side_m,
                    ..level
                }));
            }
        }
    }
    let routes = 0..shape.control_points.len();
    let moved = routes.flat_map(|route| {
        let moves = moves.iter();
        moves.map(move |change| moved(shape, route, change))
    });
    once(shape.clone()).chain(moved).collect()
}

/// Shapes that lead aside over a part of a route, so that the rest is flown later, when others have
/// passed.
pub(super) fn delayed(shape: &Shape, separation: &Separation) -> Vec<Shape> {
    let (side_m, _) = units(separation);
    let mut all = Vec::new();
    for route in 0..shape.control_points.len() {
        for part in DELAYED_AT {
            let asides = DELAYED_BY.into_iter().flat_map(|aside| [aside, -aside]);
            all.extend(asides.map(|aside| led_aside(shape, route, part, aside * side_m)));
        }
    }
    all
}

/// A shape with one route bent over a part of it, level in the middle of the part.
fn led_aside(shape: &Shape, route: usize, part: (f64, f64), aside_m: f64) -> Shape {
    let mut shape = shape.clone();
    lead(
        &mut shape.control_points[route],
        (part, STEEP),
        (aside_m, 0.0),
    );
    shape
}

/// Moves the inner control points of a route to the left and up over a part of it, given by its middle
/// and half of its length as shares of the route, the more the nearer to the middle.
fn lead(
    points: &mut [PlanPoint],
    ((middle, half), steep): ((f64, f64), f64),
    (aside_m, up_m): (f64, f64),
) {
    let Some((left_east, left_north)) = across(points) else {
        return;
    };
    let shares = shares(points);
    let last = points.len() - 1;
    for (point, share) in points.iter_mut().zip(shares).take(last).skip(1) {
        let bump = (steep * (1.0 - (share - middle).abs() / half)).clamp(0.0, 1.0);
        point.at.east_m += bump * aside_m * left_east;
        point.at.north_m += bump * aside_m * left_north;
        point.amsl.0 += bump * up_m;
    }
}

/// One more shape around a shape, bent, swaying and raised at random.
pub(super) fn random(shape: &Shape, separation: &Separation, rng: &mut ChaCha8Rng) -> Shape {
    let (side_m, up_m) = units(separation);
    let is = |rng: &mut ChaCha8Rng, share: f64| f64::from(u8::from(rng.random_bool(share)));
    let max_aside = *ASIDE.last().unwrap_or(&0.0) * side_m;
    let change = Move {
        aside_m: is(rng, 0.7) * rng.random_range(-max_aside..max_aside),
        peak: rng.random_range(0.2..0.8),
        up_m: is(rng, 0.7) * rng.random_range(RAISED[0]..RAISED[RAISED.len() - 1]) * up_m,
        raised: (rng.random_range(0.25..0.75), rng.random_range(0.05..0.35)),
        sway_m: is(rng, 0.5) * rng.random_range(-MAX_SWAY..MAX_SWAY) * side_m,
    };
    moved(
        shape,
        rng.random_range(0..shape.control_points.len()),
        &change,
    )
}

/// A shape moved a little at random: one route is bent, and sometimes raised, over a part of it, by
/// up to `most` separations.
pub(super) fn nudged(
    shape: &Shape,
    separation: &Separation,
    most: f64,
    rng: &mut ChaCha8Rng,
) -> Shape {
    let (side_m, up_m) = units(separation);
    let mut shape = shape.clone();
    let route = rng.random_range(0..shape.control_points.len());
    let (middle, half) = (rng.random_range(0.1..0.9), rng.random_range(0.1..0.6));
    let aside_m = rng.random_range(-most..most) * side_m;
    let raises = rng.random_bool(0.3);
    let raised_m = rng.random_range(-most..most) * up_m * f64::from(u8::from(raises));
    lead(
        &mut shape.control_points[route],
        ((middle, half), 1.0),
        (aside_m, raised_m),
    );
    shape
}

/// A shape with all routes moved by a rule.
pub(super) fn ruled(shape: &Shape, separation: &Separation, rule: Ruled) -> Shape {
    let (side_m, up_m) = units(separation);
    let change = Move {
        aside_m: rule.aside * side_m,
        peak: PEAKS[0],
        up_m: rule.up * RAISED[0] * up_m,
        raised: if rule.is_wide {
            RAISED_WIDE
        } else {
            RAISED_FROM[0]
        },
        sway_m: 0.0,
    };
    let routes = 0..shape.control_points.len();
    routes.fold(shape.clone(), |shape, route| moved(&shape, route, &change))
}

/// What paths are moved by, aside and up, metres.
fn units(separation: &Separation) -> (f64, f64) {
    let side_m = separation.distance_m;
    (side_m, separation.vertical_m.unwrap_or(side_m))
}

/// The shape with the control points of each route evenly apart along its path.
pub(super) fn even(plan: &VehiclePlan) -> Option<Shape> {
    let mut shape = plan.shape();
    for (points, route) in shape.control_points.iter_mut().zip(&plan.routes) {
        let path = route.points();
        let along = shares(&path);
        let last = points.len().checked_sub(1).filter(|&last| last > 0)?;
        for (step, point) in points.iter_mut().enumerate().take(last).skip(1) {
            #[expect(clippy::cast_precision_loss, reason = "few control points")]
            let share = step as f64 / last as f64;
            let after = along.partition_point(|&at| at < share);
            let (from, to) = (after.checked_sub(1)?, after.min(path.len() - 1));
            let gap = (along[to] - along[from]).max(1e-12);
            *point = path[from].toward(path[to], ((share - along[from]) / gap).clamp(0.0, 1.0));
        }
    }
    Some(shape)
}

/// How far along the way through some points each is, as a share of the whole.
fn shares(points: &[PlanPoint]) -> Vec<f64> {
    let mut gone_m = vec![0.0];
    for pair in points.windows(2) {
        let before_m = gone_m[gone_m.len() - 1];
        gone_m.push(before_m + pair[0].at.distance_m(pair[1].at));
    }
    let whole_m = gone_m[gone_m.len() - 1].max(1e-9);
    gone_m.into_iter().map(|gone_m| gone_m / whole_m).collect()
}

/// The unit vector to the left of the straight line from the first to the last of some points.
fn across(points: &[PlanPoint]) -> Option<(f64, f64)> {
    points
        .first()
        .zip(points.last())
        .map(|(first, last)| left(*first, *last))
}

/// Shapes between one and a cheaper one, the nearest to the cheaper one first.
pub(super) fn between(shape: &Shape, cheaper: &Shape) -> Vec<Shape> {
    SHARES.map(|share| blend(shape, cheaper, share)).to_vec()
}

pub(super) fn blend(shape: &Shape, cheaper: &Shape, share: f64) -> Shape {
    let mut blended = shape.clone();
    let routes = (blended.control_points.iter_mut()).zip(&cheaper.control_points);
    for (point, to) in routes.flat_map(|(own, other)| own.iter_mut().zip(other)) {
        point.at.east_m += share * (to.at.east_m - point.at.east_m);
        point.at.north_m += share * (to.at.north_m - point.at.north_m);
        point.amsl.0 += share * (to.amsl.0 - point.amsl.0);
    }
    blended
}

/// A shape with the inner control points of one route moved.
fn moved(shape: &Shape, route: usize, change: &Move) -> Shape {
    let mut shape = shape.clone();
    let points = &mut shape.control_points[route];
    let (Some(first), Some(last)) = (points.first().copied(), points.last().copied()) else {
        return shape;
    };
    let (left_east, left_north) = left(first, last);
    let length_m = first.at.distance_m(last.at);
    let shares = shares(points);
    let inner = points.len() - 1;
    for (point, share) in points.iter_mut().zip(shares).take(inner).skip(1) {
        let bend = (share / change.peak).min((1.0 - share) / (1.0 - change.peak));
        let aside_m = change.aside_m * bend + change.sway_m * (TAU * share).sin();
        point.at.east_m += aside_m * left_east;
        point.at.north_m += aside_m * left_north;
        let (middle, half) = change.raised;
        let ramp = (GENTLE * change.up_m / length_m.max(1.0)).max(RAMP);
        let up = ((half + ramp - (share - middle).abs()) / ramp).clamp(0.0, 1.0);
        point.amsl.0 += up * change.up_m;
    }
    shape
}

/// The unit vector to the left of the straight line between two points; north over one place.
fn left(from: PlanPoint, to: PlanPoint) -> (f64, f64) {
    let (east_m, north_m) = (
        to.at.east_m - from.at.east_m,
        to.at.north_m - from.at.north_m,
    );
    let length_m = east_m.hypot(north_m);
    if length_m > 0.0 {
        (-north_m / length_m, east_m / length_m)
    } else {
        (0.0, 1.0)
    }
}

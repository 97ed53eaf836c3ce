//! The track of a vehicle as it is drawn: fixes, end, and the ground below.

use serde::Serialize;

use super::simplify::Fix;
use crate::geodesy::{Amsl, EastNorth};
use crate::report::ReviewInput;
use crate::report::documents::{rounded, whole_path};
use crate::spec::{Finish, Vehicle};
use crate::verify::{Moment, Track};
use crate::world::World;

/// How the motion of a vehicle ends, seconds after T0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::report) enum Ending {
    /// On the ground.
    Down { t_s: f64 },
    /// It reaches its last place then, and stays there in the air.
    Stays { from_s: f64 },
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(in crate::report) struct TrackShape {
    pub(in crate::report) e: Vec<f64>,
    pub(in crate::report) n: Vec<f64>,
    pub(in crate::report) z: Vec<f64>,
    pub(in crate::report) t: Vec<f64>,
    pub(in crate::report) item: Vec<usize>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(super) struct GroundShape {
    pub(super) step_m: f64,
    pub(super) amsl_m: Vec<Option<f64>>,
}

impl TrackShape {
    pub(super) fn new(fixes: &[Fix]) -> Self {
        let column = |value: fn(&Fix) -> f64| fixes.iter().map(|fix| metres(value(fix))).collect();
        Self {
            e: column(|fix| fix.east_m),
            n: column(|fix| fix.north_m),
            z: column(|fix| fix.amsl_m),
            t: column(|fix| fix.t_s),
            item: fixes.iter().map(|fix| fix.item).collect(),
        }
    }
}

/// The fixes of a vehicle: those of the review, else of the plan, else none.
pub(super) fn fixes(input: &ReviewInput<'_>, index: usize, vehicle: &Vehicle) -> Vec<Fix> {
    let world = input.world;
    let fix = |at: EastNorth, amsl: Amsl, t_s: f64, item: usize| Fix {
        east_m: at.east_m,
        north_m: at.north_m,
        amsl_m: amsl.0,
        t_s,
        item,
    };
    let of_moment = |moment: &Moment| {
        fix(
            world.frame.to_plan(moment.place),
            moment.amsl,
            moment.t_s,
            moment.item,
        )
    };
    let reviewed = |track: &&Track| track.vehicle == vehicle.id && !track.moments.is_empty();
    let found: Vec<Fix> = match input.review.tracks.iter().find(reviewed) {
        Some(track) => track.moments.iter().map(of_moment).collect(),
        None => input
            .plan
            .and_then(|plan| plan.vehicles.get(index))
            .map_or_else(Vec::new, |planned| {
                whole_path(&planned.routes)
                    .map(|timed| fix(timed.point.at, timed.point.amsl, timed.t_s, 0))
                    .collect()
            }),
    };
    let is_finite = |fix: &Fix| {
        [fix.east_m, fix.north_m, fix.amsl_m, fix.t_s]
            .iter()
            .all(|value| value.is_finite())
    };
    found.into_iter().filter(is_finite).collect()
}

/// A vehicle that ends higher above ground than this is in the air, metres.
const ON_GROUND_M: f64 = 2.0;
/// A fix nearer to the last one than this is at the same place, metres.
const SAME_PLACE_M: f64 = 0.5;

/// The end that the track shows; over unknown ground, the one of the spec.
pub(super) fn ending(fixes: &[Fix], world: &World, vehicle: &Vehicle) -> Option<Ending> {
    let last = fixes.last()?;
    let at = |fix: &Fix| EastNorth {
        east_m: fix.east_m,
        north_m: fix.north_m,
    };
    let stays = match ground_m(world, at(last)) {
        Some(ground_m) => last.amsl_m - ground_m > ON_GROUND_M,
        None => vehicle.finish == Finish::Loiter,
    };
    if !stays {
        return Some(Ending::Down { t_s: last.t_s });
    }
    let is_same =
        |fix: &&Fix| at(fix).distance_m(at(last)).hypot(fix.amsl_m - last.amsl_m) < SAME_PLACE_M;
    let arrival = fixes.iter().rev().take_while(is_same).last()?;
    Some(Ending::Stays {
        from_s: arrival.t_s,
    })
}

/// The ground along the drawn track, at most `max_samples` heights.
pub(super) fn ground_under(track: &TrackShape, world: &World, max_samples: usize) -> GroundShape {
    let leg_m = |at: usize| (track.e[at] - track.e[at - 1]).hypot(track.n[at] - track.n[at - 1]);
    let length_m: f64 = (1..track.e.len()).map(leg_m).sum();
    let steps = u32::try_from(max_samples).unwrap_or(u32::MAX).max(2) - 1;
    let step_m = (length_m / f64::from(steps)).max(1.0);
    let mut ground = GroundShape {
        step_m,
        amsl_m: Vec::with_capacity(max_samples),
    };
    let mut next_m = 0.0;
    let mut begin_m = 0.0;
    for at in 1..track.e.len() {
        let leg_m = leg_m(at);
        while next_m <= begin_m + leg_m && leg_m > 0.0 {
            let share = (next_m - begin_m) / leg_m;
            let place = EastNorth {
                east_m: track.e[at - 1] + (track.e[at] - track.e[at - 1]) * share,
                north_m: track.n[at - 1] + (track.n[at] - track.n[at - 1]) * share,
            };
            ground.amsl_m.push(ground_m(world, place));
            next_m += step_m;
        }
        begin_m += leg_m;
    }
    if let (Some(e), Some(n)) = (track.e.last(), track.n.last()) {
        let place = EastNorth {
            east_m: *e,
            north_m: *n,
        };
        ground.amsl_m.push(ground_m(world, place));
    }
    ground
}

fn ground_m(world: &World, at: EastNorth) -> Option<f64> {
    let amsl = world.terrain.height_at(&world.frame, at).ok()?;
    rounded(amsl.0, 10.0)
}

/// Rounded to the decimetre; 0 for a value that is not finite.
pub(super) fn metres(value: f64) -> f64 {
    rounded(value, 10.0).unwrap_or(0.0)
}

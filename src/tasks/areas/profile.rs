//! The lowest altitudes along straight legs that keep a height above the ground and slopes.

use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::world::World;

/// Distance of samples, metres.
const EVERY_M: f64 = 15.0;

/// A straight leg over the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::tasks) struct Sampled {
    /// Where it begins.
    pub(in crate::tasks) from: EastNorth,
    /// Where it ends.
    pub(in crate::tasks) to: EastNorth,
    /// Least height above the ground, metres.
    pub(in crate::tasks) above_m: f64,
}

/// Points along legs that follow each other without a gap, at the lowest altitudes that
/// no steeper climb and descent (rise over run) allow. Begins and ends of legs are among them, in
/// order. Ground without data counts as the highest known one.
#[must_use]
pub(in crate::tasks) fn lifted(
    legs: &[Sampled],
    world: &World,
    (climb, descent): (f64, f64),
) -> Vec<PlanPoint> {
    let mut points: Vec<(EastNorth, f64)> = Vec::new();
    for leg in legs {
        let length_m = leg.from.distance_m(leg.to);
        let pieces = (length_m / EVERY_M).ceil().clamp(1.0, 1e4);
        let floor_m = |share: f64| {
            let mix = |from: f64, to: f64| from + share * (to - from);
            let at = EastNorth {
                east_m: mix(leg.from.east_m, leg.to.east_m),
                north_m: mix(leg.from.north_m, leg.to.north_m),
            };
            let ground = world.terrain.height_at(&world.frame, at);
            (
                at,
                ground.map_or(f64::NEG_INFINITY, |ground| ground.0 + leg.above_m),
            )
        };
        let mut share = 0.0;
        let first = floor_m(0.0);
        match points.last_mut() {
            Some(last) if last.0.distance_m(first.0) < 1e-6 => last.1 = last.1.max(first.1),
            _ => points.push(first),
        }
        while share < 1.0 {
            share = (share + 1.0 / pieces).min(1.0);
            if 1.0 - share < 1e-9 {
                share = 1.0;
            }
            points.push(floor_m(share));
        }
    }
    for index in 1..points.len() {
        let run_m = points[index].0.distance_m(points[index - 1].0);
        points[index].1 = points[index].1.max(points[index - 1].1 - descent * run_m);
    }
    for index in (1..points.len()).rev() {
        let run_m = points[index].0.distance_m(points[index - 1].0);
        points[index - 1].1 = points[index - 1].1.max(points[index].1 - climb * run_m);
    }
    let lifted = points.into_iter();
    lifted
        .map(|(at, amsl_m)| PlanPoint {
            at,
            amsl: Amsl(amsl_m),
        })
        .collect()
}

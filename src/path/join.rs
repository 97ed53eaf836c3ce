//! The turns of a wing from one course to another: the shortest that are clear of obstacles.

use std::f64::consts::TAU;

use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::numeric::geometry;
use crate::spec::Vehicle;
use crate::world::VehicleSites;

use super::VehicleLimits;
use super::course::{along, heading_rad};
use super::dubins::{Pose, Turns, all_turns, turns};

/// Turns between waypoints are planned this much wider than the turn radius, so that
/// encoding leaves them wide enough.
const WIDER: f64 = 1.05;
/// Straight before the first turn of a way and after its last, metres: places are encoded to
/// a centimetre, and the height of a climb may be reached a little later than planned.
const LEAD_M: f64 = 15.0;
/// Longer straights before and after the turns, tried where the shortest way is blocked, in turn radii.
const LONGER: [f64; 4] = [0.0, 1.0, 2.0, 4.0];
/// Clearances asked of a way, the most first: to either side, in turn radii (wings swing out of corners), and below, in lags of
/// the climb before it (wings come late to their altitude).
const SPACE: [(f64, f64); 3] = [(0.25, 1.0), (0.0, 1.0), (0.0, 0.0)];
/// A wing has its altitude after this many lags.
const LAGS: f64 = 3.0;
/// Spacing of the points at which a way is checked, metres.
const APART_M: f64 = 20.0;
/// Places nearer than this are one, metres.
const SAME_M: f64 = 1e-3;
/// Courses that are tried where any will do.
const COURSES: u32 = 72;

/// Whether nothing is in the way at a point.
pub type IsFree<'a> = dyn Fn(PlanPoint) -> bool + 'a;

/// A vehicle's sites, and the space between them.
#[derive(Clone, Copy)]
pub struct Among<'a> {
    /// Where it begins, stops and ends.
    pub sites: &'a VehicleSites,
    /// Where its turns may lead.
    pub is_free: &'a IsFree<'a>,
}

/// A place and a course, radians clockwise from north; none where any will do.
type End = (EastNorth, Option<f64>);

/// Corners of the way from a place to another, level at an altitude, with turns that the vehicle can fly: of the shortest
/// way that is clear, or of the shortest one if none is.
#[must_use]
pub fn join(
    vehicle: &Vehicle,
    (from, leave_rad): End,
    (to, arrive_rad): End,
    (amsl, is_free): (Amsl, &IsFree<'_>),
) -> Vec<EastNorth> {
    if from.distance_m(to) < SAME_M && (leave_rad.is_none() || arrive_rad.is_none()) {
        return Vec::new();
    }
    let radius_m = WIDER * VehicleLimits::of(vehicle).turn_radius_m;
    let ahead_rad = heading_rad(from, to);
    let mut all = Vec::new();
    for leave_rad in courses(leave_rad, ahead_rad) {
        for arrive_rad in courses(arrive_rad, ahead_rad) {
            all.push([(from, leave_rad), (to, arrive_rad)]);
        }
    }
    let shortest = all.iter().map(|ends| {
        let [leaves, arrives] = poses(ends, [0.0; 2]);
        turns(leaves, arrives, radius_m)
    });
    let shortest = shortest.min_by(|a, b| a.length_m.total_cmp(&b.length_m));
    let (lag_m, level_after_m) = lag(vehicle, amsl);
    let is_clear = |way: &Turns, (aside, below): (f64, f64)| {
        let inner = way.corners.iter().copied();
        let points = [from].into_iter().chain(inner).chain([to]);
        let is_free = |at: EastNorth, gone_m: f64| {
            let left_m = lag_m * (1.0 - gone_m / level_after_m).max(0.0);
            let amsl = Amsl(amsl.0 - below * left_m);
            is_free(PlanPoint { at, amsl })
        };
        is_clear(&points.collect::<Vec<_>>(), aside * radius_m, &is_free)
    };
    let Some(way) = &shortest else {
        return Vec::new();
    };
    if is_clear(way, SPACE[0]) {
        return way.corners.clone();
    }
    let around = longer_ways(&all, radius_m);
    let found = SPACE.into_iter().find_map(|space| {
        let mut ways = [way].into_iter().chain(&around);
        ways.find(|way| is_clear(way, space))
    });
    found.unwrap_or(way).corners.clone()
}

/// How far below its altitude a wing is at the end of its climb to it, and after how long a way it is there, metres.
fn lag(vehicle: &Vehicle, amsl: Amsl) -> (f64, f64) {
    let figure = vehicle.facts().behaviour.altitude_lag_s;
    let lag_way_m = figure.value(vehicle.autopilot_version) * vehicle.speed_mps;
    let slope = VehicleLimits::of(vehicle).climb.at(amsl);
    (lag_way_m * slope, (LAGS * lag_way_m).max(1.0))
}

fn courses(given_rad: Option<f64>, ahead_rad: f64) -> Vec<f64> {
    let all = (0..COURSES).map(|step| f64::from(step) * TAU / f64::from(COURSES));
    match given_rad {
        Some(course_rad) => vec![course_rad],
        None => [ahead_rad].into_iter().chain(all).collect(),
    }
}

/// The ends of the turns between two courses, with the straight before and after them longer by some metres.
fn poses(ends: &[(EastNorth, f64); 2], [after_m, before_m]: [f64; 2]) -> [Pose; 2] {
    let pose = |(at, heading_rad), lead_m| Pose {
        at: along(at, heading_rad, lead_m),
        heading_rad,
    };
    [
        pose(ends[0], LEAD_M + after_m),
        pose(ends[1], -LEAD_M - before_m),
    ]
}

/// Ways with turns to either side, and with more straight before and after them: the shortest first.
fn longer_ways(all: &[[(EastNorth, f64); 2]], radius_m: f64) -> Vec<Turns> {
    let mut ways = Vec::new();
    for ends in all {
        for after_m in LONGER.map(|longer| longer * radius_m) {
            for before_m in LONGER.map(|longer| longer * radius_m) {
                let [leaves, arrives] = poses(ends, [after_m, before_m]);
                let turned = all_turns(leaves, arrives, radius_m).into_iter();
                ways.extend(turned.map(|way| Turns {
                    length_m: way.length_m + after_m + before_m,
                    ..way
                }));
            }
        }
    }
    ways.sort_by(|a, b| a.length_m.total_cmp(&b.length_m));
    ways
}

/// Whether a polyline and a strip on either side of it are clear; `is_free` also gets the distance along the polyline, metres.
fn is_clear(points: &[EastNorth], aside_m: f64, is_free: &dyn Fn(EastNorth, f64) -> bool) -> bool {
    let mut gone_m = 0.0;
    points.windows(2).all(|leg| {
        let (from, to) = (leg[0], leg[1]);
        let (length_m, course_rad) = (from.distance_m(to), heading_rad(from, to));
        let before_m = gone_m;
        gone_m += length_m;
        let steps = geometry::steps(length_m, APART_M, (1, 10_000));
        (0..=steps).all(|step| {
            let along_m = length_m * f64::from(step) / f64::from(steps);
            let at = along(from, course_rad, along_m);
            let mut aside = [0.0, -aside_m, aside_m].into_iter();
            aside.all(|aside_m| {
                let at = along(at, course_rad + 0.25 * TAU, aside_m);
                is_free(at, before_m + along_m)
            })
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::SpecFile;
    use proptest::prelude::*;

    fn plane() -> Vehicle {
        let path = std::path::Path::new("missions/plane-ardupilot.yaml");
        let text = include_str!("../../missions/plane-ardupilot.yaml").to_owned();
        let file = SpecFile::parse(path, text).expect("a shipped mission");
        file.spec.vehicles[0].clone()
    }

    fn at(east_m: f64, north_m: f64) -> EastNorth {
        EastNorth { east_m, north_m }
    }

    /// Places along a way with its ends, 1 m apart.
    fn along_way(corners: &[EastNorth], ends: [EastNorth; 2]) -> Vec<EastNorth> {
        let mut along = Vec::new();
        let points: Vec<EastNorth> = (ends[..1].iter().chain(corners).chain(&ends[1..]))
            .copied()
            .collect();
        for leg in points.windows(2) {
            let length_m = leg[0].distance_m(leg[1]);
            let steps = geometry::steps(length_m, 1.0, (1, 10_000));
            along.extend((0..=steps).map(|step| {
                let along_m = length_m * f64::from(step) / f64::from(steps);
                super::along(leg[0], heading_rad(leg[0], leg[1]), along_m)
            }));
        }
        along
    }

    proptest! {
        #[test]
        fn what_is_in_the_shortest_way_is_passed_where_there_is_space(
            (east_m, north_m) in (-900.0..900.0_f64, -900.0..900.0_f64),
            (leave_rad, arrive_rad) in (0.0..TAU, 0.0..TAU),
            share in 2..9_usize,
        ) {
            let vehicle = plane();
            let ends = [at(0.0, 0.0), at(east_m, north_m)];
            let joined = |is_free: &IsFree<'_>| {
                let amsl = Amsl(500.0);
                join(&vehicle, (ends[0], Some(leave_rad)), (ends[1], Some(arrive_rad)), (amsl, is_free))
            };
            let shortest = joined(&|_| true);
            prop_assert_eq!(&joined(&|_| false), &shortest, "where nothing is free, the shortest");
            let all = along_way(&shortest, ends);
            let mast = all[all.len() * share / 10];
            // Nearer to an end no turn could avoid it.
            prop_assume!(ends.iter().all(|end| end.distance_m(mast) > 130.0));
            let around = joined(&|point| point.at.distance_m(mast) > 30.0);
            let nearest_m = along_way(&around, ends).iter().map(|at| at.distance_m(mast)).fold(f64::INFINITY, f64::min);
            prop_assert!(nearest_m > 20.0, "{around:?} {mast:?}");
        }
    }

    #[test]
    fn a_wing_below_its_altitude_does_not_turn_over_a_hill() {
        let vehicle = plane();
        let (lag_m, _) = lag(&vehicle, Amsl(500.0));
        assert!(lag_m > 2.0, "{lag_m}");
        // To the right there is a hill up to a fifth of the lag below the way.
        let is_free =
            |point: PlanPoint| point.at.east_m < 20.0 || point.amsl.0 > 500.0 - 0.2 * lag_m;
        let back = (at(-1.0, -400.0), Some(0.5 * TAU));
        let from = (at(0.0, 0.0), Some(0.0));
        let flat = join(&vehicle, from, back, (Amsl(500.0), &|_| true));
        let right = |corners: &[EastNorth]| corners.iter().any(|corner| corner.east_m > 20.0);
        let mirrored = join(
            &vehicle,
            from,
            (at(1.0, -400.0), Some(0.5 * TAU)),
            (Amsl(500.0), &is_free),
        );
        assert!(!right(&flat) && !right(&mirrored), "{flat:?} {mirrored:?}");
    }
}

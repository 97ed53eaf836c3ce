//! What a wing adds to a path: the run and climb of a takeoff along a course, turns onto a
//! route and off it ([`super::join`]), the approach to a landing.
//!
//! Assumed, and not measured on an autopilot: a plane climbs out straight, at its planned
//! speed and its steepest allowed slope, until it has the height of the start; it turns
//! with its turn radius; it glides straight to its place of touchdown.

use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::spec::{Airframe, Finish, Vehicle};
use crate::world::{Departure, VehicleSites};

use super::VehicleLimits;
use super::course::{along, heading_rad};
use super::join::{Among, join};

/// A takeoff along a course.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClimbOut {
    /// Where the wheels leave the ground.
    pub lift_off: EastNorth,
    /// How long the run to there takes, seconds.
    pub run_s: f64,
    /// Where a climb from there has the height that it is for.
    pub top: PlanPoint,
}

/// Run and climb of a plane from `home` along `heading_rad` to a height; the ground at
/// lift-off is at `ground`.
#[must_use]
pub fn climb_out(
    vehicle: &Vehicle,
    home: EastNorth,
    heading_rad: f64,
    ground: impl FnOnce(EastNorth) -> Amsl,
    top: Amsl,
) -> ClimbOut {
    let limits = VehicleLimits::of(vehicle);
    let speed_mps = speed_on(vehicle, heading_rad, top);
    let run_m = speed_mps * speed_mps / (2.0 * limits.accel_mps2);
    let lift_off = along(home, heading_rad, run_m);
    let rise_m = (top.0 - ground(lift_off).0).max(0.0);
    ClimbOut {
        lift_off,
        run_s: 2.0 * run_m / speed_mps,
        top: PlanPoint {
            at: along(lift_off, heading_rad, rise_m / limits.climb.at(top)),
            amsl: top,
        },
    }
}

/// The straight way to a landing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// Where the planned path ends, before the turn onto the approach.
    pub gate: PlanPoint,
    /// Where the straight way begins, at the height of the gate.
    pub entry: PlanPoint,
    /// Where a plane touches down, or a vtol descends.
    pub touchdown: PlanPoint,
    /// Course, radians clockwise from north.
    pub heading_rad: f64,
}

/// The approach on a course to a landing at `touchdown`, on the ground, from the height `from`; none
/// for a copter, for a vtol that may come from anywhere, and for who loiters.
#[must_use]
pub(super) fn approach(
    vehicle: &Vehicle,
    heading_rad: Option<f64>,
    touchdown: PlanPoint,
    from: Amsl,
) -> Option<Approach> {
    let heading_rad = heading_rad?;
    let lengths = vehicle.approach_lengths(from.0 - touchdown.amsl.0)?;
    let before = |distance_m: f64| PlanPoint {
        at: along(touchdown.at, heading_rad, -distance_m),
        amsl: from,
    };
    (vehicle.finish != Finish::Loiter).then(|| Approach {
        gate: before(lengths.straight_m + lengths.gate_m),
        entry: before(lengths.straight_m),
        touchdown,
        heading_rad,
    })
}

/// Where a vehicle touches down at the end, and its approach to there, if it needs one.
#[must_use]
pub fn landing(vehicle: &Vehicle, sites: &VehicleSites) -> (PlanPoint, Option<Approach>) {
    let (touchdown, from) = sites.touchdown(vehicle.finish);
    (
        touchdown,
        approach(vehicle, sites.landing_rad, touchdown, from),
    )
}

/// Where the way home of a vehicle that returns ends: over home at the height of the
/// start, or before its approach.
#[must_use]
pub fn homeward_end(vehicle: &Vehicle, sites: &VehicleSites) -> PlanPoint {
    let over_home = PlanPoint {
        at: sites.home.at,
        amsl: sites.start.amsl,
    };
    let (home, from) = (sites.home, sites.start.amsl);
    approach(vehicle, sites.landing_rad, home, from).map_or(over_home, |approach| approach.gate)
}

/// The speed over the ground to plan with on a course, m/s; the planned one where the wind
/// is too strong for any.
fn speed_on(vehicle: &Vehicle, course_rad: f64, at: Amsl) -> f64 {
    let speed_mps = vehicle.speed_mps;
    vehicle
        .ground_speed_mps(speed_mps, at, course_rad)
        .unwrap_or(speed_mps)
}

/// The speed over the ground to plan a way between two points with, m/s: that on the
/// straight one, halfway up.
#[must_use]
pub fn way_speed_mps(vehicle: &Vehicle, from: PlanPoint, to: PlanPoint) -> f64 {
    let halfway = Amsl(0.5 * (from.amsl.0 + to.amsl.0));
    speed_on(vehicle, heading_rad(from.at, to.at), halfway)
}

/// Everything that a plane or vtol flies from its climb to its touchdown, as a polyline.
pub(super) struct Way {
    /// How a plane takes off; a vtol rises straight up.
    pub(super) climb: Option<ClimbOut>,
    /// From lift-off or over home to touchdown, over the place of a vtol's landing, or to the goal.
    pub(super) points: Vec<PlanPoint>,
    /// Where it touches down, if it does.
    pub(super) touchdown: PlanPoint,
    /// Where it circles on its way, by the index of the point in the middle, and how long, seconds.
    pub(super) circles: Vec<(usize, f64)>,
}

/// Where a wing is when it begins with its routes.
fn lifted(sites: &VehicleSites, climb: Option<&ClimbOut>) -> PlanPoint {
    let over_home = PlanPoint {
        at: sites.home.at,
        ..sites.start
    };
    match sites.departure {
        Departure::Airborne { point, .. } => point,
        Departure::Ground => climb.map_or(over_home, |climb| climb.top),
    }
}

/// The takeoff of a plane on a course.
fn climb_on(vehicle: &Vehicle, sites: &VehicleSites, course_rad: Option<f64>) -> Option<ClimbOut> {
    let course_rad = course_rad.filter(|_| vehicle.airframe == Airframe::Plane)?;
    let (home, ground) = (sites.home.at, |_| sites.home.amsl);
    Some(climb_out(
        vehicle,
        home,
        course_rad,
        ground,
        sites.start.amsl,
    ))
}

/// The way along some routes, each of at least two points.
pub(super) fn way(vehicle: &Vehicle, among: Among<'_>, routes: &[Vec<PlanPoint>]) -> Way {
    let Among { sites, is_free } = among;
    let takeoff_rad = vehicle
        .wing
        .and_then(|wing| wing.takeoff_heading_rad)
        .filter(|_| !sites.departure.is_airborne());
    let climb = climb_on(vehicle, sites, takeoff_rad);
    let first = lifted(sites, climb.as_ref());
    let (mut at, mut course) = (first.at, takeoff_rad);
    let mut points = vec![first];
    let mut circles = Vec::new();
    let level = |from, to, amsl| {
        let corners = join(vehicle, from, to, (amsl, is_free));
        corners.into_iter().map(move |at| PlanPoint { at, amsl })
    };
    for (number, route) in routes.iter().enumerate() {
        let [first, second, ..] = route.as_slice() else {
            continue;
        };
        let stop = number
            .checked_sub(1)
            .filter(|stop| *stop < vehicle.stops.len());
        if let Some(stop) = stop {
            if !vehicle.passes_after(stop) {
                circles.push((points.len() - 1, vehicle.rest_after_s(stop)));
            }
            points.extend(&route[1..]);
        } else {
            let onto = (first.at, Some(heading_rad(first.at, second.at)));
            points.extend(level((at, course), onto, first.amsl));
            points.extend(route);
        }
        if let [.., before, last] = route.as_slice() {
            (at, course) = (last.at, Some(heading_rad(before.at, last.at)));
        }
    }
    let (touchdown, approach) = landing(vehicle, sites);
    if let Some(approach) = approach {
        let onto = (approach.entry.at, Some(approach.heading_rad));
        points.extend(level((at, course), onto, approach.entry.amsl));
        points.push(approach.entry);
        points.push(match vehicle.airframe {
            Airframe::Plane => touchdown,
            Airframe::Copter | Airframe::Vtol => PlanPoint {
                at: touchdown.at,
                ..approach.entry
            },
        });
    }
    Way {
        climb,
        points,
        touchdown,
        circles,
    }
}

//! When a vehicle is where, from standing at home to touchdown.
//!
//! Assumed, and not measured on an autopilot: a copter keeps its planned ground
//! speed along a route, corners included, and speeds up and slows down only at
//! its two ends; it climbs and descends vertically at constant speed. Planned turns are spread over
//! waypoints with changes of course so small that copters do not slow down for them
//! ([`crate::autopilot::Cornering`]).

use crate::autopilot::{Airframe, SLOW_LANDING_M};
use crate::geodesy::{Amsl, PlanPoint};
use crate::numeric::approach::Segment;
use crate::numeric::tracks::{Ends, Track};
use crate::numeric::{SpeedProfile, geometry};
use crate::path::{Among, TimedPoint, landing_shift_s, wing};
use crate::spec::{Finish, Span, Vehicle};
use crate::world::{Departure, VehicleSites};

/// Longest piece of a motion while the speed changes, seconds: between its ends
/// such a piece leaves constant speed by at most `accel * 2^2 / 8`.
const RAMP_PIECE_S: f64 = 2.0;
/// Heights that a vehicle lingers at are so far apart at most, metres: half of it counts as none.
const LINGER_M: f64 = 10.0;

/// The whole flight of one vehicle, straight and of constant speed between its points.
#[derive(Clone, Debug, PartialEq)]
pub struct Flight {
    /// From takeoff to touchdown, in order of time. With [`Self::loiters`] the
    /// last point repeats the place of the one before at time infinity.
    pub points: Vec<TimedPoint>,
    /// When each route begins, seconds after T0.
    pub route_starts_s: Vec<f64>,
    /// Whether the vehicle stays at its last point for ever.
    pub loiters: bool,
    /// Where it may be at other times as well, as motions at rest: along a landing whose slow end begins
    /// sooner or later than over the ground, see [`landing_shift_s`].
    pub lingers: Vec<Segment>,
}

/// The times of a route that is flown from rest to rest at a constant ground
/// speed: one point for each point given.
#[must_use]
pub fn time_route(
    points: &[PlanPoint],
    t0_s: f64,
    speed_mps: f64,
    accel_mps2: f64,
) -> Vec<TimedPoint> {
    time_route_from(points, (t0_s, 0.0), speed_mps, accel_mps2)
}

/// The same for a route that begins at a time and at an initial ground speed, seconds and m/s.
#[must_use]
pub fn time_route_from(
    points: &[PlanPoint],
    (t0_s, initial_mps): (f64, f64),
    speed_mps: f64,
    accel_mps2: f64,
) -> Vec<TimedPoint> {
    let along_m = distances_m(points);
    let profile = SpeedProfile::from_speed(
        along_m.last().copied().unwrap_or(0.0),
        initial_mps,
        speed_mps,
        accel_mps2,
    );
    points
        .iter()
        .zip(&along_m)
        .map(|(&point, &along_m)| TimedPoint {
            point,
            t_s: t0_s + profile.time_at_s(along_m),
        })
        .collect()
}

/// When the first route of a vehicle begins, seconds after T0: in the air at once, else after its
/// departure, its climb over home, and its path from there to the start.
#[must_use]
pub fn route_start_s(vehicle: &Vehicle, sites: &VehicleSites) -> f64 {
    if let Departure::Airborne { at_s, .. } = sites.departure {
        return at_s;
    }
    if vehicle.airframe.has_wing() {
        // The turn onto the route is that onto a straight one.
        let straight = vec![sites.start, sites.goal];
        let flown = flight(vehicle, sites, &[straight]);
        return flown
            .route_starts_s
            .first()
            .copied()
            .unwrap_or(vehicle.depart_s);
    }
    let mut points = Vec::new();
    take_off(&mut points, vehicle, sites);
    points.last().map_or(vehicle.depart_s, |last| last.t_s)
}

/// The flight of a vehicle along its routes, which are those between [`super::route_ends`]; it
/// rests at its stops. Its turns onto them are the shortest.
#[must_use]
pub fn flight(vehicle: &Vehicle, sites: &VehicleSites, routes: &[Vec<PlanPoint>]) -> Flight {
    let is_free = &|_| true;
    flight_among(vehicle, Among { sites, is_free }, routes)
}

/// The same, with turns of wings that keep clear of obstacles.
#[must_use]
pub fn flight_among(vehicle: &Vehicle, among: Among<'_>, routes: &[Vec<PlanPoint>]) -> Flight {
    if vehicle.airframe.has_wing() {
        return winged(vehicle, among, routes);
    }
    let sites = among.sites;
    let mut points = Vec::new();
    take_off(&mut points, vehicle, sites);
    let mut route_starts_s = Vec::with_capacity(routes.len());
    for (index, route) in routes.iter().enumerate() {
        let t0_s = points.last().map_or(vehicle.depart_s, |last| last.t_s);
        route_starts_s.push(t0_s);
        append_route(
            &mut points,
            route,
            &vehicle.on_route(index),
            sites.departure,
        );
        rest(&mut points, vehicle.rest_after_s(index));
    }
    let loiters = vehicle.finish == Finish::Loiter;
    let mut lingers = Vec::new();
    if let Some(&last) = points.last() {
        match vehicle.finish {
            Finish::Loiter => points.push(TimedPoint {
                t_s: f64::INFINITY,
                ..last
            }),
            Finish::Land => lingers = land(&mut points, (sites.home, sites.goal_ground), vehicle),
            Finish::Return => lingers = land(&mut points, (sites.home, sites.home.amsl), vehicle),
        }
    }
    Flight {
        points,
        route_starts_s,
        loiters,
        lingers,
    }
}

/// The flight of a plane or vtol: turns join the routes to takeoff, approach and each
/// other, here along the tangents of their arcs. Circling for ever is staying at the middle.
fn winged(vehicle: &Vehicle, among: Among<'_>, routes: &[Vec<PlanPoint>]) -> Flight {
    let sites = among.sites;
    let mut points = vec![begin(vehicle, sites)];
    let way = wing::way(vehicle, among, routes);
    let loiters = vehicle.finish == Finish::Loiter;
    if let Some(climb) = &way.climb {
        points.push(TimedPoint {
            point: PlanPoint {
                at: climb.lift_off,
                ..sites.home
            },
            t_s: vehicle.depart_s + climb.run_s,
        });
    } else if !sites.departure.is_airborne() {
        lift(&mut points, sites.start.amsl, vehicle.climb_mps);
    }
    let is_plane = vehicle.airframe == Airframe::Plane;
    let mut from = 0;
    let end = way.points.len().saturating_sub(1);
    let stays = way.circles.iter().copied().chain([(end, 0.0)]);
    for (to, circling_s) in stays {
        // On its circle it is taken to be in the middle.
        let part = way.points.get(from..=to).unwrap_or_default();
        if is_plane {
            append_at_speed(
                &mut points,
                part.get(from.min(1)..).unwrap_or_default(),
                vehicle,
            );
        } else {
            append_route(&mut points, part, vehicle, sites.departure);
        }
        rest(&mut points, circling_s);
        from = to;
    }
    let route_starts_s = routes
        .iter()
        .filter_map(|route| {
            let at_start = |timed: &&TimedPoint| Some(&timed.point) == route.first();
            points.iter().find(at_start).map(|timed| timed.t_s)
        })
        .collect();
    let mut lingers = Vec::new();
    if let Some(&last) = points.last() {
        if loiters {
            points.push(TimedPoint {
                t_s: f64::INFINITY,
                ..last
            });
        } else if !is_plane {
            lingers = land(&mut points, (sites.home, way.touchdown.amsl), vehicle);
        }
    }
    Flight {
        points,
        route_starts_s,
        loiters,
        lingers,
    }
}

/// A polyline at constant speed, begun where the last point is.
fn append_at_speed(points: &mut Vec<TimedPoint>, way: &[PlanPoint], vehicle: &Vehicle) {
    for &point in way {
        if let Some(&last) = points.last() {
            let speed_mps = wing::way_speed_mps(vehicle, last.point, point);
            let t_s = last.t_s + last.point.at.distance_m(point.at) / speed_mps;
            points.push(TimedPoint { point, t_s });
        }
    }
}

impl Flight {
    /// The straight motions from point to point, and where it lingers; the third coordinate is the altitude.
    pub fn segments(&self) -> impl Iterator<Item = Segment> + '_ {
        self.points
            .windows(2)
            .map(|pair| Segment::between(pair[0].placed(), pair[1].placed()))
            .chain(self.lingers.iter().copied())
    }

    /// Its motions as conflicts with others are looked for.
    #[must_use]
    pub fn track(&self) -> Track {
        Track::new(self.segments().collect()).standing_at(self.ends())
    }

    /// Where the vehicle stands until it departs, and from its landing on.
    #[must_use]
    pub fn ends(&self) -> Option<Ends> {
        let last = self.points.last().map(TimedPoint::placed);
        Some(Ends {
            begin: self.points.first().map(TimedPoint::placed)?,
            end: last.filter(|(t_s, _)| t_s.is_finite()),
        })
    }

    /// Where the vehicle is at a time; `None` while it stands on the ground.
    #[must_use]
    pub fn position(&self, t_s: f64) -> Option<PlanPoint> {
        let after = self.points.partition_point(|point| point.t_s <= t_s);
        let from = self.points.get(after.checked_sub(1)?)?;
        let Some(to) = self.points.get(after) else {
            return (from.t_s >= t_s).then_some(from.point);
        };
        if to.t_s.is_infinite() {
            return Some(from.point);
        }
        let share = (t_s - from.t_s) / (to.t_s - from.t_s);
        Some(from.point.toward(to.point, share))
    }
}

/// Where and when a vehicle begins: at home at its departure, or in the air.
fn begin(vehicle: &Vehicle, sites: &VehicleSites) -> TimedPoint {
    match sites.departure {
        Departure::Ground => TimedPoint {
            point: sites.home,
            t_s: vehicle.depart_s,
        },
        Departure::Airborne { point, at_s, .. } => TimedPoint { point, t_s: at_s },
    }
}

fn take_off(points: &mut Vec<TimedPoint>, vehicle: &Vehicle, sites: &VehicleSites) {
    points.push(begin(vehicle, sites));
    if sites.departure.is_airborne() {
        return;
    }
    lift(points, sites.start.amsl, vehicle.climb_mps);
    let over_home = PlanPoint {
        at: sites.home.at,
        amsl: sites.start.amsl,
    };
    if sites.home.at.distance_m(sites.start.at) > 0.0 {
        append_route(
            points,
            &[over_home, sites.start],
            vehicle,
            Departure::Ground,
        );
    }
    let start = vehicle.start_stop();
    rest(points, start.map_or(0.0, |stop| vehicle.stay_s(&stop)));
}

/// Vertically to the ground, the last metres slowly. Returns where the vehicle lingers if it takes its height
/// above home for that above the ground.
fn land(
    points: &mut Vec<TimedPoint>,
    (home, ground): (PlanPoint, Amsl),
    vehicle: &Vehicle,
) -> Vec<Segment> {
    let slow_from = Amsl(ground.0 + SLOW_LANDING_M);
    let first = points.len().saturating_sub(1);
    if points
        .last()
        .is_some_and(|last| last.point.amsl > slow_from)
    {
        lift(points, slow_from, vehicle.descent_mps);
    }
    lift(points, ground, vehicle.slow_descent_mps());
    let descent = points.get(first..).unwrap_or_default();
    let speeds_mps = (vehicle.descent_mps, vehicle.slow_descent_mps());
    let Some(top) = descent.first() else {
        return Vec::new();
    };
    let heights = (top.point.amsl, home.amsl, ground);
    lingering(
        descent,
        landing_shift_s(heights, SLOW_LANDING_M, speeds_mps),
    )
}

/// A vertical motion at any time of a span later or earlier, as motions at rest of some metres each.
fn lingering(motion: &[TimedPoint], shift_s: Span) -> Vec<Segment> {
    if shift_s.most - shift_s.least <= 0.0 {
        return Vec::new();
    }
    let part = |pair: &[TimedPoint]| {
        let (from, to) = (pair[0], pair[1]);
        let parts = geometry::steps(from.point.distance_m(to.point), LINGER_M, (1, u16::MAX));
        let share = move |share: f64| TimedPoint {
            point: from.point.toward(to.point, share),
            t_s: from.t_s + share * (to.t_s - from.t_s),
        };
        (0..parts).map(move |part| {
            let [first, last] =
                [part, part + 1].map(|end| share(f64::from(end) / f64::from(parts)));
            let at = first.point.toward(last.point, 0.5);
            let place = at.axes_m();
            let (from_s, to_s) = (first.t_s + shift_s.least, last.t_s + shift_s.most);
            Segment::between((from_s, place), (to_s, place))
        })
    };
    motion.windows(2).flat_map(part).collect()
}

/// Stays where it is for a time.
fn rest(points: &mut Vec<TimedPoint>, rest_s: f64) {
    if let Some(&last) = points.last()
        && rest_s > 0.0
    {
        points.push(TimedPoint {
            t_s: last.t_s + rest_s,
            ..last
        });
    }
}

/// Vertically to another altitude at constant speed.
fn lift(points: &mut Vec<TimedPoint>, amsl: Amsl, speed_mps: f64) {
    let Some(&last) = points.last() else {
        return;
    };
    points.push(TimedPoint {
        point: PlanPoint {
            at: last.point.at,
            amsl,
        },
        t_s: last.t_s + (amsl.0 - last.point.amsl.0).abs() / speed_mps,
    });
}

/// A route to rest, begun when the last point is reached, with points added where the speed changes.
fn append_route(
    points: &mut Vec<TimedPoint>,
    route: &[PlanPoint],
    vehicle: &Vehicle,
    departure: Departure,
) {
    let t0_s = points.last().map_or(vehicle.depart_s, |last| last.t_s);
    let along_m = distances_m(route);
    let first = route.first().copied();
    let profile = SpeedProfile::from_speed(
        along_m.last().copied().unwrap_or(0.0),
        first.map_or(0.0, |first| departure.speed_at_mps(first)),
        speed_between(vehicle, route),
        vehicle.accel_mps2,
    );
    for (leg, reach_m) in route.windows(2).zip(along_m.windows(2)) {
        let length_m = reach_m[1] - reach_m[0];
        for distance_m in ramp_stops_m(&profile, reach_m[0], reach_m[1]) {
            points.push(TimedPoint {
                point: leg[0].toward(leg[1], (distance_m - reach_m[0]) / length_m),
                t_s: t0_s + profile.time_at_s(distance_m),
            });
        }
        points.push(TimedPoint {
            point: leg[1],
            t_s: t0_s + profile.time_at_s(reach_m[1]),
        });
    }
}

/// The speed over the ground to plan a route with, m/s.
fn speed_between(vehicle: &Vehicle, route: &[PlanPoint]) -> f64 {
    match route {
        [first, .., last] => wing::way_speed_mps(vehicle, *first, *last),
        _ => vehicle.speed_mps,
    }
}

/// Distances strictly between `from_m` and `to_m` at which a leg is cut,
/// so that the speed is near constant on every piece; none while cruising.
pub fn ramp_stops_m(
    profile: &SpeedProfile,
    from_m: f64,
    to_m: f64,
) -> impl Iterator<Item = f64> + use<> {
    let profile = *profile;
    let (t0_s, t1_s) = (profile.time_at_s(from_m), profile.time_at_s(to_m));
    let ramp_m = profile.ramp_m();
    let changes = from_m < ramp_m || to_m > profile.length_m() - ramp_m;
    let pieces = if changes {
        ((t1_s - t0_s) / RAMP_PIECE_S).ceil().clamp(1.0, 1000.0)
    } else {
        1.0
    };
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 1 and 1000"
    )]
    let count = pieces as u32;
    (1..count)
        .map(move |piece| profile.distance_at_m(t0_s + (t1_s - t0_s) * f64::from(piece) / pieces))
        .filter(move |&distance_m| from_m < distance_m && distance_m < to_m)
}

/// Horizontal distance along a polyline up to each of its points, metres.
fn distances_m(points: &[PlanPoint]) -> Vec<f64> {
    let mut sum_m = 0.0;
    let mut before = points.first().copied();
    points
        .iter()
        .map(|point| {
            sum_m += before.map_or(0.0, |before| before.at.distance_m(point.at));
            before = Some(*point);
            sum_m
        })
        .collect()
}

#[cfg(test)]
mod tests;

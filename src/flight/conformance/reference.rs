//! The planned flight of one vehicle, as what is flown is held against it.

use super::COLUMN_M;
use crate::flight::record::fix::Fix;
use crate::geodesy::{AboveHome, Agl, Amsl, EastNorth, LatLon, LocalFrame, PlanPoint};
use crate::mission::{Item, VehicleMission, command, frame};
use crate::spec::{Airframe, Autopilot};
use crate::verify::Track;
use crate::world::World;

/// A place that the mission goes to, and when.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoint {
    /// Row of the `.waypoints` file; home is 0.
    pub item: usize,
    /// Where, and how high.
    pub point: PlanPoint,
    /// When the plan has it there, seconds after T0.
    pub t_s: f64,
    /// A wing circles around it, metres; 0 for a place that is flown to.
    pub radius_m: f64,
    /// By how much the verdict lets it be later there, seconds, beyond what its takeoff is late.
    pub late_s: f64,
}

/// A wing is on a circle that is flown this share of its radius too wide, and this far, metres.
const WIDE_SHARE: f64 = 0.25;
const WIDE_M: f64 = 20.0;

/// The waypoints of a mission in order of time, from its takeoff.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceTrajectory {
    /// Home, the top of the takeoff, and every place after it.
    pub waypoints: Vec<Waypoint>,
    /// When the planned flight ends; a stay for ever, when it begins. Seconds after T0.
    pub end_s: f64,
    /// Whether it ends on the ground.
    pub lands: bool,
    /// Whether an item is above the ground below it: between its places the altitude is then not
    /// that of a straight line.
    follows_ground: bool,
    frame: LocalFrame,
}

impl ReferenceTrajectory {
    /// From the encoded mission, and where the verdict's model has the vehicle over time.
    #[must_use]
    pub fn new(mission: &VehicleMission, track: &Track, world: &World) -> Self {
        let home = mission.home_point(&world.frame);
        let mut waypoints = vec![Waypoint {
            item: 0,
            point: home,
            t_s: track.moments.first().map_or(0.0, |moment| moment.t_s),
            radius_m: 0.0,
            late_s: 0.0,
        }];
        let mut lands = false;
        for (index, item) in mission.items.iter().enumerate() {
            let before = waypoints.last().map_or(home, |last| last.point);
            let Some(point) = point(item, before, home, (mission.airframe, world)) else {
                continue;
            };
            lands = [command::NAV_LAND, command::NAV_VTOL_LAND].contains(&item.command);
            let glides = mission.airframe == Airframe::Plane;
            if lands && !glides && point.at.distance_m(before.at) > 1.0 {
                // It flies there at the altitude it has, then comes down.
                waypoints.push(Waypoint {
                    item: index + 1,
                    point: PlanPoint {
                        amsl: before.amsl,
                        ..point
                    },
                    t_s: f64::NAN,
                    radius_m: 0.0,
                    late_s: 0.0,
                });
            }
            waypoints.push(Waypoint {
                item: index + 1,
                point,
                t_s: f64::NAN,
                radius_m: circle_m(item, mission),
                late_s: 0.0,
            });
        }
        let mut reference = Self {
            waypoints,
            end_s: 0.0,
            lands,
            follows_ground: mission.items.iter().any(follows_ground),
            frame: world.frame,
        };
        reference.take_times(track, world);
        reference
    }

    /// Whether a place is in the column of an item on a way straight down from one waypoint and up again to
    /// another one: it puts down a load, or comes to a place below the least height above ground.
    pub(crate) fn dips_at(&self, item: usize, at: EastNorth) -> bool {
        let is_near =
            |one: &Waypoint, two: &Waypoint| one.point.at.distance_m(two.point.at) < CHORD_M;
        let highest_m = |part: &[Waypoint]| {
            let amsl_m = part.iter().map(|of| of.point.amsl.0);
            amsl_m.fold(f64::NEG_INFINITY, f64::max)
        };
        self.waypoints.chunk_by(is_near).any(|column| {
            let next = column.iter().position(|of| of.item == item);
            let Some(next) = next.filter(|next| *next > 0) else {
                return false;
            };
            let low_m = column[next - 1].point.amsl.0.min(column[next].point.amsl.0);
            highest_m(&column[..next]) > low_m
                && highest_m(&column[next..]) > low_m
                && column[next].point.at.distance_m(at) < COLUMN_M
        })
    }

    /// Whether a place is about on the circle that the flight ends with.
    pub(crate) fn is_on_circle(&self, at: EastNorth) -> bool {
        self.waypoints.last().is_some_and(|last| {
            last.radius_m > 0.0
                && last.point.at.distance_m(at) <= (1.0 + WIDE_SHARE) * last.radius_m + WIDE_M
        })
    }

    /// From waypoints whose times are known.
    #[must_use]
    pub fn of_waypoints(
        waypoints: Vec<Waypoint>,
        (end_s, lands): (f64, bool),
        frame: LocalFrame,
    ) -> Self {
        Self {
            waypoints,
            end_s,
            lands,
            follows_ground: false,
            frame,
        }
    }

    pub(crate) fn follows_ground(&self) -> bool {
        self.follows_ground
    }

    pub(crate) fn frame(&self) -> &LocalFrame {
        &self.frame
    }

    /// When the planned flight passes each waypoint: where its track is nearest to it,
    /// on the legs before and after.
    fn take_times(&mut self, flown: &Track, world: &World) {
        let track: Vec<(PlanPoint, f64, usize)> = flown
            .moments
            .iter()
            .map(|moment| {
                let point = PlanPoint {
                    at: world.frame.to_plan(moment.place),
                    amsl: moment.amsl,
                };
                (point, moment.t_s, moment.item)
            })
            .collect();
        let late_s = |t_s: f64| {
            let until = flown.moments.partition_point(|moment| moment.t_s <= t_s);
            let late_s = flown.late_s.get(until).or(flown.late_s.last());
            late_s.copied().unwrap_or(0.0)
        };
        let mut last_s = self.waypoints.first().map_or(0.0, |first| first.t_s);
        let items: Vec<usize> = self.waypoints.iter().map(|w| w.item).collect();
        for (index, waypoint) in self.waypoints.iter_mut().enumerate().skip(1) {
            let next = items.get(index + 1).copied().unwrap_or(usize::MAX);
            let nearest = track
                .windows(2)
                .filter(|pair| pair[1].2 >= waypoint.item && pair[0].2 <= next)
                .filter(|pair| pair[1].1 >= last_s)
                .map(|pair| {
                    let (distance_m, share) = to_segment(waypoint.point, pair[0].0, pair[1].0);
                    // A circle is reached where its rim is.
                    let distance_m = (distance_m - waypoint.radius_m).max(CHORD_M);
                    (distance_m, pair[0].1 + share * (pair[1].1 - pair[0].1))
                })
                .min_by(|a, b| a.0.total_cmp(&b.0));
            if let Some((_, t_s)) = nearest {
                last_s = t_s.max(last_s);
            }
            waypoint.t_s = last_s;
            waypoint.late_s = late_s(last_s);
        }
        let track_end_s = track.last().map_or(last_s, |last| last.1);
        self.end_s = if self.lands { track_end_s } else { last_s };
        if let (true, Some(last)) = (self.lands, self.waypoints.last_mut()) {
            last.t_s = track_end_s;
            last.late_s = late_s(track_end_s);
        }
    }

    /// When the plan has a vehicle where it is now, seconds after T0.
    #[must_use]
    pub fn planned_s(&self, fix: &Fix) -> Option<f64> {
        let point = PlanPoint {
            at: self.frame.to_plan(fix.place),
            amsl: fix.amsl,
        };
        Some(self.deviation(fix.item, point)?.t_s)
    }

    /// How far a point is from the way to an item: the nearest of the legs around it.
    #[must_use]
    pub fn deviation(&self, item: usize, point: PlanPoint) -> Option<Deviation> {
        self.deviations(item, point)
            .min_by(|a, b| a.distance_m().total_cmp(&b.distance_m()))
    }

    /// Cross-track error of a point from the nearest leg of the whole path, metres.
    pub(crate) fn whole_cross_track_m(&self, point: PlanPoint) -> f64 {
        let legs = self.waypoints.windows(2);
        let errors_m = legs.map(|pair| Deviation::of(point, &pair[0], &pair[1]).cross_track_m);
        errors_m.fold(f64::INFINITY, f64::min)
    }

    /// How far a point is from each of the legs around the way to an item.
    pub(crate) fn deviations(
        &self,
        item: usize,
        point: PlanPoint,
    ) -> impl Iterator<Item = Deviation> {
        let ahead = self.waypoints.iter().position(|w| w.item >= item);
        let ahead = ahead.unwrap_or(self.waypoints.len().saturating_sub(1));
        let from = ahead.saturating_sub(2);
        let to = (ahead + 2).min(self.waypoints.len());
        self.waypoints
            .get(from..to)
            .unwrap_or_default()
            .windows(2)
            .map(move |pair| Deviation::of(point, &pair[0], &pair[1]))
    }
}

/// The chords of a circle are no further off than this, metres.
const CHORD_M: f64 = 1.0;

/// How far a point is from a leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Beside it, metres.
    pub cross_track_m: f64,
    /// Above it, metres; negative below.
    pub above_m: f64,
    /// When the plan passes the nearest point of the leg, seconds after T0.
    pub t_s: f64,
    /// Radius of the circle that the leg leads to, metres; 0 for one that leads to a place. It is
    /// entered between its tangent and the straight way to its middle.
    pub circle_m: f64,
}

impl Deviation {
    fn of(point: PlanPoint, from: &Waypoint, to: &Waypoint) -> Self {
        let length_m = from.point.at.distance_m(to.point.at);
        let upright = length_m < 1.0;
        let share = if upright {
            let rise_m = to.point.amsl.0 - from.point.amsl.0;
            if rise_m.abs() > 0.1 {
                ((point.amsl.0 - from.point.amsl.0) / rise_m).clamp(0.0, 1.0)
            } else {
                1.0
            }
        } else {
            let (east, north) = (
                to.point.at.east_m - from.point.at.east_m,
                to.point.at.north_m - from.point.at.north_m,
            );
            let gone = (point.at.east_m - from.point.at.east_m) * east
                + (point.at.north_m - from.point.at.north_m) * north;
            (gone / (length_m * length_m)).clamp(0.0, 1.0)
        };
        let mix = |a: f64, b: f64| a + (b - a) * share;
        let foot = EastNorth {
            east_m: mix(from.point.at.east_m, to.point.at.east_m),
            north_m: mix(from.point.at.north_m, to.point.at.north_m),
        };
        // A wing leaves a circle beside its middle.
        let aside_m = from.radius_m * (1.0 - share);
        let straight = Self {
            cross_track_m: (point.at.distance_m(foot) - aside_m).max(0.0),
            above_m: point.amsl.0 - mix(from.point.amsl.0, to.point.amsl.0),
            t_s: mix(from.t_s, to.t_s),
            circle_m: to.radius_m,
        };
        if to.radius_m <= 0.0 {
            return straight;
        }
        let round = Self {
            cross_track_m: (point.at.distance_m(to.point.at) - to.radius_m).abs(),
            above_m: point.amsl.0 - to.point.amsl.0,
            t_s: to.t_s,
            circle_m: 0.0,
        };
        if round.distance_m() < straight.distance_m() {
            round
        } else {
            straight
        }
    }

    pub(crate) fn distance_m(&self) -> f64 {
        self.cross_track_m.hypot(self.above_m)
    }
}

/// Distance of a point from a segment, and where on it.
pub(crate) fn to_segment(point: PlanPoint, from: PlanPoint, to: PlanPoint) -> (f64, f64) {
    let (p, a, b) = (point.axes_m(), from.axes_m(), to.axes_m());
    let dot = |f: &dyn Fn(usize) -> f64, g: &dyn Fn(usize) -> f64| {
        (0..3).map(|axis| f(axis) * g(axis)).sum::<f64>()
    };
    let along = |axis: usize| b[axis] - a[axis];
    let gone = |axis: usize| p[axis] - a[axis];
    let length_sq = dot(&along, &along);
    let share = if length_sq > 0.0 {
        (dot(&gone, &along) / length_sq).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let off = |axis: usize| gone(axis) - share * along(axis);
    (dot(&off, &off).sqrt(), share)
}

/// The radius of the circle that a wing stays on at an item, metres; 0 where it does not.
fn circle_m(item: &Item, mission: &VehicleMission) -> f64 {
    let circles = [command::NAV_LOITER_UNLIM, command::NAV_LOITER_TIME];
    if !mission.airframe.has_wing() || !circles.contains(&item.command) {
        return 0.0;
    }
    let is_sign =
        mission.autopilot == Autopilot::ArduPilot && item.command == command::NAV_LOITER_TIME;
    let own_m = match is_sign {
        true => 0.0,
        false => f64::from(item.params[2]).abs(),
    };
    let names = ["WP_LOITER_RAD", "NAV_LOITER_RAD"];
    let mut params = mission.params.iter();
    match params.find(|param| names.contains(&param.name.as_str())) {
        Some(param) if own_m.is_nan() || own_m <= 0.0 => f64::from(param.value).abs(),
        _ => own_m,
    }
}

fn follows_ground(item: &Item) -> bool {
    item.place().is_some() && frame::canonical(item.frame) == frame::GLOBAL_TERRAIN_ALT
}

/// Where an item goes; `None` for one that goes nowhere.
fn point(
    item: &Item,
    before: PlanPoint,
    home: PlanPoint,
    (airframe, world): (Airframe, &World),
) -> Option<PlanPoint> {
    let place = || item.place().filter(|_| (item.x, item.y) != (0, 0));
    let ground = |place: LatLon| world.terrain.height(place).ok();
    let amsl = |at: Option<LatLon>| {
        let z_m = f64::from(item.z);
        match frame::canonical(item.frame) {
            frame::GLOBAL => Some(Amsl(z_m)),
            frame::GLOBAL_RELATIVE_ALT => Some(AboveHome(z_m).over(home.amsl)),
            frame::GLOBAL_TERRAIN_ALT => Some(Agl(z_m).over(ground(at?)?)),
            _ => None,
        }
    };
    match item.command {
        command::NAV_TAKEOFF | command::NAV_VTOL_TAKEOFF => Some(PlanPoint {
            at: match (airframe, place()) {
                // It climbs out on the way there.
                (Airframe::Plane, Some(place)) => world.frame.to_plan(place),
                _ => home.at,
            },
            amsl: amsl(Some(world.frame.from_plan(home.at)))?,
        }),
        command::NAV_WAYPOINT | command::NAV_LOITER_TIME | command::NAV_LOITER_UNLIM => {
            let place = place()?;
            Some(PlanPoint {
                at: world.frame.to_plan(place),
                amsl: amsl(Some(place))?,
            })
        }
        // Down to the ground, from the waypoint before it to the one after it.
        command::NAV_LAND | command::NAV_VTOL_LAND | command::NAV_PAYLOAD_PLACE => {
            let at = place().map_or(before.at, |place| world.frame.to_plan(place));
            let amsl = ground(world.frame.from_plan(at))?;
            Some(PlanPoint { at, amsl })
        }
        _ => None,
    }
}

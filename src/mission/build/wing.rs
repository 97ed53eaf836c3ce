//! The items of planes and vtol: takeoff along a course or on rotors, turns onto the routes
//! and off them, circles, glides.

use super::stops::{FIRST_REST_S, trigger};
use super::{ItemWriter, float};
use crate::autopilot::command;
use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::mission::item::Item;
use crate::path::{
    Approach, TimedPoint, VehicleLimits, along, climb_out, heading_rad, join, landing,
};
use crate::spec::{Airframe, Autopilot, Finish, Stop, Vehicle};
use crate::world::{Departure, NoData, VehicleSites};

/// A route that ends in a circle ends this many radii before its middle: from there the
/// vehicle flies to the rim.
const OUTSIDE: f64 = 3.0;

/// So far upwind of its home a VTOL of PX4 has the place of its takeoff, metres: it turns its nose there before its
/// transition, and gives its mission up where the wind keeps it from doing so. Nearer than 20 m the verdict judges any course.
const UPWIND_M: f64 = 15.0;

/// The way of a mission so far, and the items that make it.
struct ItemList {
    items: Vec<Item>,
    at: EastNorth,
    /// Course there, radians clockwise from north; none where any will do.
    course_rad: Option<f64>,
    /// Whether it circles there, and heads for the next place from its circle.
    leaves_circle: bool,
}

/// Routes that meet at stops that are flown past, as one path.
#[derive(Default)]
struct Chain {
    /// The first of them.
    first: usize,
    path: Vec<TimedPoint>,
    /// Where in the path the stops are.
    stops: Vec<usize>,
}

impl Chain {
    fn append(&mut self, number: usize, route: &[TimedPoint]) {
        if self.path.is_empty() {
            self.first = number;
            self.path.extend(route);
        } else {
            self.stops.push(self.path.len() - 1);
            self.path.extend(route.iter().skip(1));
        }
    }
}

impl ItemWriter<'_> {
    /// The items of a plane or vtol.
    pub(crate) fn winged_items(
        &self,
        sites: &VehicleSites,
        routes: &[Vec<TimedPoint>],
    ) -> Result<Vec<Item>, NoData> {
        let mut list = self.winged_takeoff(sites)?;
        list.items.extend(self.speed());
        let (touchdown, approach) = landing(self.vehicle, sites);
        let radius_m = self.vehicle.wing.map_or(0.0, |wing| wing.loiter_radius_m);
        let circles = self.vehicle.finish == Finish::Loiter;
        let speed_mps = self.vehicle.fastest_mps();
        // Before a circle the way turns to its rim. A vtol must not pass the place of its
        // landing: it slows down on its way there, at the height it has.
        let left_out_m = match (circles, &approach) {
            (true, _) => OUTSIDE * radius_m,
            (false, None) => speed_mps * speed_mps / (2.0 * self.vehicle.accel_mps2),
            (false, Some(_)) => 0.0,
        };
        let mut chain = Chain::default();
        for (index, route) in routes.iter().enumerate() {
            let circled = self.circled_after(index);
            let mut route = match route.last() {
                Some(end) if index + 1 == routes.len() => outside(route, end.point.at, left_out_m),
                Some(end) if circled.is_some() => outside(route, end.point.at, OUTSIDE * radius_m),
                _ => route.clone(),
            };
            let from = index
                .checked_sub(1)
                .and_then(|before| self.circled_after(before));
            if let (Some(_), Some(begin)) = (from, route.first().copied()) {
                // It leaves the circle for the first place of the route that is outside.
                route.reverse();
                route = outside(&route, begin.point.at, OUTSIDE * radius_m);
                route.reverse();
            }
            chain.append(index, &route);
            if !self.vehicle.passes_after(index) {
                self.fly(&mut list, &chain)?;
                chain = Chain::default();
            }
            if let Some(stop) = circled {
                let point = sites.stops.get(index).copied().unwrap_or(sites.goal);
                list.items.extend(self.circles(stop, point)?);
                (list.at, list.course_rad, list.leaves_circle) = (point.at, None, true);
            }
            if index == self.vehicle.stops.len() {
                list.items.extend(self.at_goal()?);
                list.items.extend(self.trigger_off());
            }
        }
        if circles {
            let item = self.at(command::NAV_LOITER_UNLIM, 0.0, sites.goal)?;
            list.items.push(with(item, 2, float(radius_m.ceil())));
        } else {
            self.winged_landing(&mut list, touchdown, approach)?;
        }
        Ok(list.items)
    }

    /// Up, to where the way to the route begins.
    fn winged_takeoff(&self, sites: &VehicleSites) -> Result<ItemList, NoData> {
        if let Departure::Airborne { point, .. } = sites.departure {
            return Ok(ItemList {
                items: Vec::new(),
                at: point.at,
                course_rad: None,
                leaves_circle: false,
            });
        }
        let (home, start) = (sites.home, sites.start);
        let course_rad = self.vehicle.wing.and_then(|wing| wing.takeoff_heading_rad);
        if let (Airframe::Plane, Some(course_rad)) = (self.vehicle.airframe, course_rad) {
            let ground = |at| {
                let below = PlanPoint { at, ..home };
                self.encoder.ground(below).unwrap_or(home.amsl)
            };
            let climb = climb_out(self.vehicle, home.at, course_rad, ground, start.amsl);
            let item = self.at(command::NAV_TAKEOFF, 0.0, climb.top)?;
            let slope = VehicleLimits::of(self.vehicle).climb.at(start.amsl);
            // ArduPlane keeps whole degrees of pitch, and takes 0 for 4; PX4 has a parameter.
            let pitch_deg = match self.vehicle.autopilot {
                Autopilot::ArduPilot => slope.atan().to_degrees().floor().max(1.0),
                Autopilot::Px4 => 0.0,
            };
            return Ok(ItemList {
                items: vec![with(item, 0, float(pitch_deg))],
                at: climb.top.at,
                course_rad: Some(course_rad),
                leaves_circle: false,
            });
        }
        let upwind = (self.vehicle.carried_by())
            .filter(|_| self.vehicle.autopilot == Autopilot::Px4)
            .map(|wind| along(home.at, wind.from_rad, UPWIND_M));
        let takeoff = PlanPoint {
            at: upwind.unwrap_or(home.at),
            amsl: start.amsl,
        };
        let rules = &self.vehicle.facts().acceptance;
        let mut items = if rules.never_waits {
            Vec::new()
        } else {
            self.departure()
        };
        let item = self.at(command::NAV_VTOL_TAKEOFF, 0.0, takeoff)?;
        items.push(if rules.takeoff_above_home {
            self.encoder.above_home(item, start.amsl)
        } else {
            item
        });
        Ok(ItemList {
            items,
            at: home.at,
            course_rad,
            leaves_circle: false,
        })
    }

    /// The stop at the end of a route around which the vehicle circles for a time.
    fn circled_after(&self, route: usize) -> Option<&Stop> {
        let stop = self.vehicle.stops.get(route)?;
        (!self.vehicle.passes_after(route)).then_some(stop)
    }

    /// The items of a stop that is circled around: with actions two circles, and these in between.
    fn circles(&self, stop: &Stop, point: PlanPoint) -> Result<Vec<Item>, NoData> {
        let actions = self.actions(stop)?;
        if actions.is_empty() {
            return Ok(vec![self.circle(stop.rest_s(), point, true)?]);
        }
        let mut items = vec![self.circle(FIRST_REST_S, point, false)?];
        items.extend(actions);
        items.push(self.circle(stop.rest_s() - FIRST_REST_S, point, true)?);
        Ok(items)
    }

    /// What is done at the goal: where the route to it ends, before the landing or the circle there.
    fn at_goal(&self) -> Result<Vec<Item>, NoData> {
        match self.vehicle.goal_stop() {
            Some(stop) => self.actions(&stop),
            None => Ok(Vec::new()),
        }
    }

    /// Circles clockwise for a time, and until the vehicle heads for the next place.
    fn circle(&self, hold_s: f64, point: PlanPoint, heads_on: bool) -> Result<Item, NoData> {
        let radius_m = self.vehicle.wing.map_or(0.0, |wing| wing.loiter_radius_m);
        let item = self.encoder.item(
            command::NAV_LOITER_TIME,
            match self.vehicle.autopilot {
                // It keeps the sign of the radius alone, which is that of its parameters.
                Autopilot::ArduPilot => [float(hold_s), 0.0, 1.0, 1.0],
                Autopilot::Px4 => [
                    float(hold_s),
                    f32::from(u8::from(heads_on)),
                    float(radius_m.ceil()),
                    1.0,
                ],
            },
            point,
        )?;
        Ok(item)
    }

    /// Turns onto a chain of routes and flies it.
    fn fly(&self, list: &mut ItemList, chain: &Chain) -> Result<(), NoData> {
        let chosen = self.waypoints(chain.first, &chain.path, &chain.stops)?;
        let route: Vec<PlanPoint> = chosen.iter().map(|&at| chain.path[at].point).collect();
        let [first, second, ..] = route.as_slice() else {
            return Ok(());
        };
        if !std::mem::take(&mut list.leaves_circle) {
            self.turn(list, first.at, heading_rad(first.at, second.at), first.amsl)?;
        }
        let is_here = list.at.distance_m(first.at) <= 0.0;
        if is_here && chain.first == 0 {
            list.items.extend(self.begin()?);
        }
        for (&index, &point) in chosen.iter().zip(&route).skip(usize::from(is_here)) {
            list.items.push(self.at(command::NAV_WAYPOINT, 0.0, point)?);
            if index == 0 && chain.first == 0 {
                list.items.extend(self.begin()?);
            }
            let passed = chain.stops.iter().position(|&stop| stop == index);
            if let Some(stop) = passed.and_then(|at| self.vehicle.stops.get(chain.first + at)) {
                list.items.extend(self.actions(stop)?);
            }
        }
        if let [.., before, last] = route.as_slice() {
            list.at = last.at;
            list.course_rad = Some(heading_rad(before.at, last.at));
        }
        Ok(())
    }

    /// What is done at the start.
    fn begin(&self) -> Result<Vec<Item>, NoData> {
        let mut items = match self.vehicle.start_stop() {
            Some(stop) => self.actions(&stop)?,
            None => Vec::new(),
        };
        items.extend(self.vehicle.on_way.trigger_m.map(trigger));
        Ok(items)
    }

    /// Waypoints of the turns that lead to a place on a course, level.
    fn turn(
        &self,
        list: &mut ItemList,
        to: EastNorth,
        course_rad: f64,
        amsl: Amsl,
    ) -> Result<(), NoData> {
        let (from, onto) = ((list.at, list.course_rad), (to, Some(course_rad)));
        let is_free = |point| self.limits.0.is_free(point);
        for at in join(self.vehicle, from, onto, (amsl, &is_free)) {
            let corner = PlanPoint { at, amsl };
            list.items
                .push(self.at(command::NAV_WAYPOINT, 0.0, corner)?);
        }
        Ok(())
    }

    fn winged_landing(
        &self,
        list: &mut ItemList,
        touchdown: PlanPoint,
        approach: Option<Approach>,
    ) -> Result<(), NoData> {
        if let Some(approach) = approach {
            let entry = approach.entry;
            self.turn(list, entry.at, approach.heading_rad, entry.amsl)?;
            list.items.push(self.at(command::NAV_WAYPOINT, 0.0, entry)?);
        }
        let command = match self.vehicle.airframe {
            Airframe::Vtol => command::NAV_VTOL_LAND,
            Airframe::Plane | Airframe::Copter => command::NAV_LAND,
        };
        list.items.push(self.at(command, 0.0, touchdown)?);
        Ok(())
    }
}

/// The course on which a wing lands where the spec leaves it open, in words.
#[must_use]
pub fn landing_course_note(vehicle: &Vehicle, sites: &VehicleSites) -> Option<String> {
    let (wind, course_rad) = (vehicle.approach_wind()?, sites.landing_rad?);
    let off_deg = (course_rad - wind.from_rad).cos().acos().to_degrees();
    let course_deg = course_rad.to_degrees().round().rem_euclid(360.0);
    Some(match off_deg < 1.0 {
        true => format!("lands on a course of {course_deg:.0} degrees, into the wind"),
        false => format!(
            "lands on a course of {course_deg:.0} degrees, {off_deg:.0} off the wind: nearer to it something is in the way"
        ),
    })
}

/// The part of a route before it stays within a distance of a place; at least the very
/// beginning of it.
fn outside(route: &[TimedPoint], place: EastNorth, distance_m: f64) -> Vec<TimedPoint> {
    let away_m = |timed: &TimedPoint| timed.point.at.distance_m(place);
    let is_far = |timed: &TimedPoint| away_m(timed) >= distance_m;
    let last = route.iter().rposition(is_far).unwrap_or(0);
    let mut part = route[..(last + 1).min(route.len())].to_vec();
    if let (Some(&from), Some(&to)) = (route.get(last), route.get(last + 1)) {
        // On so short a piece the distance is as good as linear.
        let share = (away_m(&from) - distance_m) / (away_m(&from) - away_m(&to)).max(1e-9);
        let least = if last == 0 { 0.01 } else { 0.0 };
        part.push(between(from, to, share.clamp(least, 1.0)));
    }
    part
}

fn between(from: TimedPoint, to: TimedPoint, share: f64) -> TimedPoint {
    let mix = |a: f64, b: f64| a + (b - a) * share;
    let (a, b) = (from.point, to.point);
    TimedPoint {
        point: PlanPoint::new(
            mix(a.at.east_m, b.at.east_m),
            mix(a.at.north_m, b.at.north_m),
            Amsl(mix(a.amsl.0, b.amsl.0)),
        ),
        t_s: mix(from.t_s, to.t_s),
    }
}

/// An item with one parameter set.
fn with(mut item: Item, index: usize, value: f32) -> Item {
    item.params[index] = value;
    item
}

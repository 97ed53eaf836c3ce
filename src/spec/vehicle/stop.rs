//! Places that a vehicle visits between start and goal.

use std::borrow::Cow;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::action::RELEASE_S;
use super::{EndPoint, Placement, Span, StopAction, Vehicle};
use crate::geodesy::{Agl, Amsl, PlanPoint};
use crate::spec::keys::words;

/// A copter rests at least this long where it stops, seconds: a hold makes both autopilots come to
/// rest instead of cutting the corner.
const MIN_REST_S: f64 = 1.0;

/// A copter that turns its nose there rests at least this long: 1 s to come to rest, and 180 degrees
/// at 45 degrees a second.
const MIN_TURN_S: f64 = 5.0;

/// Time for an action to begin, seconds: ArduPilot runs commands one after the other while it holds
/// at the waypoint after them, and drops those that have not run when that hold ends.
pub const ACTION_S: f64 = 0.5;

/// How near a wing comes to a stop by default, metres: it turns onto its legs, and off them.
const WING_RADIUS_M: f64 = 20.0;

/// Most stops of one vehicle.
pub const MAX_STOPS: usize = 100;

/// A place that a vehicle visits.
#[derive(Clone, Debug, PartialEq)]
pub struct Stop {
    /// Unique among the stops of its vehicle.
    pub id: String,
    /// Where, and how high.
    pub end: EndPoint,
    /// Depth of a drop below `end`, metres: the copter descends vertically, holds and acts at the bottom, and
    /// climbs back. 0 for a stop at `end` itself.
    pub drop_m: f64,
    /// How long the vehicle stays there, seconds; [`Stop::rest_s`] is what is encoded.
    pub hold_s: f64,
    /// How near it must come, metres; absent: `mission.tolerance_m`.
    pub acceptance_radius_m: Option<f64>,
    /// Where its nose points while it stays, radians clockwise from north; absent: anywhere.
    pub heading_rad: Option<f64>,
    /// What it does there, in this order.
    pub actions: Vec<StopAction>,
    /// Planned speed from there on, m/s; absent: as before.
    pub speed_mps: Option<f64>,
    /// Of a task: when what is done there may begin, seconds after T0.
    pub window_s: Option<Span>,
    /// Of a task: how long the vehicle waits there before, seconds; whole ones.
    pub wait_s: f64,
    /// Of a task with lines: how the route to it is flown.
    pub arrives: Arrival,
    /// Of a task with lines: pictures are taken at this distance from there on, metres; 0: no
    /// longer, after a last one.
    pub trigger_m: Option<f64>,
}

/// How the route to a stop is flown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Arrival {
    /// As planned.
    #[default]
    Planned,
    /// Straight where nothing is in the way.
    Straight,
    /// On a line over the ground, at least this high above it.
    OnLine(Agl),
    /// Straight, as near to what is closed as its ends are; so is the route from there on. The vehicle rests there
    /// because it has no space to turn.
    Exact,
}

impl Stop {
    /// How long a copter rests there, seconds: whole ones, which ArduPilot keeps, at least 1, and
    /// at least 5 with a heading, and more by 0.5 for each action.
    #[must_use]
    pub fn rest_s(&self) -> f64 {
        let min_s = match self.heading_rad {
            Some(_) => MIN_TURN_S,
            None => MIN_REST_S,
        };
        let count = u32::try_from(self.actions.len()).unwrap_or(u32::MAX);
        let acting_s = match count {
            0 => 0.0,
            _ => 1.0 + ACTION_S * f64::from(count),
        };
        self.wait_s + self.hold_s.max(min_s + acting_s).ceil()
    }
}

impl Stop {
    /// Where the vehicle holds and acts: at the bottom, if it is a drop.
    #[must_use]
    pub fn place(&self) -> EndPoint {
        match self.end.altitude {
            Placement::Agl(Agl(agl_m)) => EndPoint {
                altitude: Placement::Agl(Agl(agl_m - self.drop_m)),
                ..self.end
            },
            Placement::Amsl(_) => self.end,
        }
    }

    /// The same as a point, from that of its end.
    #[must_use]
    pub fn below(&self, end: PlanPoint) -> PlanPoint {
        PlanPoint {
            amsl: Amsl(end.amsl.0 - self.drop_m),
            ..end
        }
    }

    /// A stop at which nothing is done.
    #[must_use]
    pub fn passing(id: &str, end: EndPoint) -> Self {
        Self {
            id: id.to_owned(),
            end,
            drop_m: 0.0,
            hold_s: 0.0,
            acceptance_radius_m: None,
            heading_rad: None,
            actions: Vec::new(),
            speed_mps: None,
            window_s: None,
            wait_s: 0.0,
            arrives: Arrival::default(),
            trigger_m: None,
        }
    }

    /// Makes it one stop with another at the same place, which is made after it.
    pub fn join(&mut self, other: &Self) {
        self.id = format!("{} + {}", self.id, other.id);
        self.hold_s += other.hold_s;
        self.actions.extend(other.actions.iter().cloned());
        self.wait_s = self.wait_s.max(other.wait_s);
        self.window_s = match (self.window_s, other.window_s) {
            (Some(one), Some(two)) => Some(Span {
                least: one.least.max(two.least),
                most: one.most.min(two.most),
            }),
            (one, two) => one.or(two),
        };
    }
}

/// Ids of stops that a vehicle does not have yet: `KIND-1` and so on.
pub fn new_stop_ids(stops: &[Stop], kind: &'static str) -> impl Iterator<Item = String> {
    let is_new = |id: &String| stops.iter().all(|stop| stop.id != *id);
    (1..)
        .map(move |number| format!("{kind}-{number}"))
        .filter(is_new)
}

/// Makes the waits of stops anew for a departure that is later by some seconds than the one that they are
/// for: a vehicle that comes later waits less, whole seconds each.
pub fn wait_less(stops: &mut [Stop], later_s: f64) {
    /// Whole numbers of seconds are no longer for what arithmetic adds.
    const EPSILON_S: f64 = 1e-6;
    let mut later_s = later_s.max(0.0);
    for stop in stops {
        // Never -0, which a maximum may leave.
        let wait_s = (stop.wait_s - later_s - EPSILON_S).ceil().max(0.0).abs();
        let wait_s = wait_s.min(stop.wait_s);
        later_s -= stop.wait_s - wait_s;
        stop.wait_s = wait_s;
    }
}

/// What is done at start and goal, and on the way between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OnWay {
    /// At the start, in this order.
    pub start: Vec<StopAction>,
    /// At the goal.
    pub goal: Vec<StopAction>,
    /// Distance from one picture to the next, metres; none: no pictures.
    pub trigger_m: Option<f64>,
}

/// In which order stops are visited.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[schemars(transform = words)]
pub enum Order {
    /// As they are listed.
    #[default]
    Fixed,
    /// In the order that costs least; the planner finds it.
    Free,
}

/// An end of the path as a stop, if something is done there.
fn acting(id: &str, end: EndPoint, actions: &[StopAction]) -> Option<Stop> {
    (!actions.is_empty()).then(|| Stop {
        actions: actions.to_vec(),
        ..Stop::passing(id, end)
    })
}

impl Vehicle {
    /// The vehicle as it flies a route: at the speed of the last stop before it that has one.
    /// Route 0 begins at the start, route `k` at stop `k - 1`.
    #[must_use]
    pub fn on_route(&self, route: usize) -> Cow<'_, Self> {
        let before = self.stops.iter().take(route).rev();
        match before.filter_map(|stop| stop.speed_mps).next() {
            Some(speed_mps) => Cow::Owned(Self {
                speed_mps,
                ..self.clone()
            }),
            None => Cow::Borrowed(self),
        }
    }

    /// How each of its routes is flown.
    #[must_use]
    pub fn arrivals(&self, routes: usize) -> Vec<Arrival> {
        let arrival = |route: usize| self.stops.get(route).map(|stop| stop.arrives);
        let follows_rest = |route: usize| {
            let before = route.checked_sub(1).and_then(arrival);
            before == Some(Arrival::Exact)
        };
        let each = (0..routes).map(|route| match follows_rest(route) {
            true => Arrival::Exact,
            false => arrival(route).unwrap_or_default(),
        });
        each.collect()
    }

    /// Puts its stops in another order, given by their indices; none changes nothing.
    pub fn visit_in(&mut self, order: &[usize]) {
        if !order.is_empty() {
            let stops = order.iter().filter_map(|&index| self.stops.get(index));
            self.stops = stops.cloned().collect();
        }
    }

    /// How long the vehicle stays at the stop or goal at the end of a route, seconds: a copter rests,
    /// a wing circles. 0 where there is none.
    #[must_use]
    pub fn rest_after_s(&self, route: usize) -> f64 {
        match self.stops.get(route) {
            Some(stop) => self.stay_s(stop),
            None if route == self.stops.len() => {
                let stop = self.goal_stop();
                stop.map_or(0.0, |stop| self.stay_s(&stop))
            }
            None => 0.0,
        }
    }

    /// Its start as a stop, if something is done there.
    #[must_use]
    pub fn start_stop(&self) -> Option<Stop> {
        acting("start", self.start, &self.on_way.start)
    }

    /// Its goal as a stop, if something is done there.
    #[must_use]
    pub fn goal_stop(&self) -> Option<Stop> {
        acting("goal", self.goal, &self.on_way.goal)
    }

    /// How long the vehicle stays at a stop, seconds; 0 where it flies past it.
    #[must_use]
    pub fn stay_s(&self, stop: &Stop) -> f64 {
        match (self.wing, stop.hold_s > 0.0) {
            (None, _) => stop.rest_s() + self.placing_s(stop) + self.dropping_s(stop),
            (Some(_), false) => 0.0,
            (Some(_), true) => stop.rest_s(),
        }
    }

    /// How long the vehicle is below a stop to place loads on the ground, seconds.
    fn placing_s(&self, stop: &Stop) -> f64 {
        let is_placing = |action: &&StopAction| matches!(action, StopAction::PayloadPlace { .. });
        let loads = stop.actions.iter().filter(is_placing).count();
        // The check asks for a height above ground.
        let Placement::Agl(Agl(agl_m)) = stop.place().altitude else {
            return 0.0;
        };
        let each_s = agl_m / self.slow_descent_mps() + RELEASE_S + agl_m / self.climb_mps;
        f64::from(u32::try_from(loads).unwrap_or(u32::MAX)) * each_s
    }

    /// How long it takes to come down to a drop, and up from there; above it, it rests twice, seconds.
    fn dropping_s(&self, stop: &Stop) -> f64 {
        match stop.drop_m > 0.0 {
            true => {
                2.0 * MIN_REST_S + stop.drop_m * (1.0 / self.descent_mps + 1.0 / self.climb_mps)
            }
            false => 0.0,
        }
    }

    /// How fast it comes down at the end of a landing and to place a load, m/s.
    #[must_use]
    pub fn slow_descent_mps(&self) -> f64 {
        let slow_mps = self.facts().behaviour.slow_landing_mps;
        slow_mps.min(self.descent_mps)
    }

    /// Whether a route ends at a stop that the vehicle flies past.
    #[must_use]
    pub fn passes_after(&self, route: usize) -> bool {
        self.wing.is_some() && self.stops.get(route).is_some_and(|stop| stop.hold_s <= 0.0)
    }

    /// How near the vehicle must come to a stop, metres, where the tolerance of the mission is
    /// `tolerance_m`.
    #[must_use]
    pub fn radius_at_m(&self, stop: &Stop, tolerance_m: f64) -> f64 {
        let usual_m = match self.wing {
            Some(_) => tolerance_m.max(WING_RADIUS_M),
            None => tolerance_m,
        };
        stop.acceptance_radius_m.unwrap_or(usual_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geodesy::LatLon;

    #[test]
    fn a_vehicle_that_departs_later_waits_less_until_the_delay_is_made_up_for() {
        let end = EndPoint {
            place: LatLon {
                lat_deg: 0.0,
                lon_deg: 0.0,
            },
            altitude: Placement::Agl(Agl(50.0)),
        };
        let waiting = |wait_s| Stop {
            wait_s,
            ..Stop::passing("stop", end)
        };
        let waits_s = |later_s| {
            let mut stops = [30.0, 0.0, 50.0].map(waiting);
            wait_less(&mut stops, later_s);
            stops.map(|stop| stop.wait_s.to_string())
        };
        assert_eq!(waits_s(-5.0), ["30", "0", "50"]);
        assert_eq!(waits_s(0.0), ["30", "0", "50"]);
        assert_eq!(waits_s(12.5), ["18", "0", "50"]);
        assert_eq!(waits_s(40.0), ["0", "0", "40"]);
        assert_eq!(waits_s(400.0), ["0", "0", "0"]);
    }
}

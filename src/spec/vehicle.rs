//! A vehicle of the checked spec: identity, route and performance.

mod action;
mod endurance;
mod region;
mod stop;

pub use action::{RELEASE_S, StopAction};
pub use endurance::{Capacity, Endurance, Energy};
pub use region::TakeoffRegion;
pub use stop::{ACTION_S, Arrival, MAX_STOPS, OnWay, Order, Stop, new_stop_ids, wait_less};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::autopilot::{Airframe, Autopilot, Facts, MAX_LEAN_DEG, Version, facts};
use crate::geodesy::{Agl, Amsl, LatLon, true_airspeed_ratio};

use super::keys::words;
use super::wind::Wind;

/// One vehicle of the fleet.
#[derive(Clone, Debug, PartialEq)]
pub struct Vehicle {
    /// Unique name; file names begin with it.
    pub id: String,
    /// MAVLink system id, 1 to 255: unique, in a fleet of more than 240 on its link.
    pub sysid: u8,
    /// Which autopilot will read the mission.
    pub autopilot: Autopilot,
    /// Its firmware version; absent: every supported one.
    pub autopilot_version: Option<Version>,
    /// What flies.
    pub airframe: Airframe,
    /// How to reach it.
    pub link: Link,
    /// Where it stands on the ground.
    pub home: LatLon,
    /// Where the planned path begins, airborne.
    pub start: EndPoint,
    /// Where the planned path ends, airborne. A plane that lands touches down at this place,
    /// and its glide begins at this height.
    pub goal: EndPoint,
    /// Places to visit between start and goal. With [`Order::Free`] as they are listed, until the
    /// planner has put them in order.
    pub stops: Vec<Stop>,
    /// In which order they are visited.
    pub order: Order,
    /// What is done at start and goal, and on the way.
    pub on_way: OnWay,
    /// What happens at the goal.
    pub finish: Finish,
    /// Planned speed, m/s: over the ground, on a wing the indicated airspeed.
    pub speed_mps: f64,
    /// Turn overload n_max; the turn radius is `v^2 / (g sqrt(n^2 - 1))`.
    pub max_load_factor: f64,
    /// Steepest climb, radians; absent: the slope polynomial of the paper (Eq. 27).
    pub max_climb_rad: Option<f64>,
    /// Steepest descent, radians, positive; absent: the paper's polynomial.
    pub max_descent_rad: Option<f64>,
    /// Vertical speed up, m/s; the autopilot's default if the spec has none.
    pub climb_mps: f64,
    /// Vertical speed down, m/s, positive; likewise.
    pub descent_mps: f64,
    /// Horizontal acceleration, m/s^2; likewise.
    pub accel_mps2: f64,
    /// Greatest speed through the air that this copter was flown at, m/s; none: that of a stock one
    /// of its autopilot.
    pub max_airspeed_mps: Option<f64>,
    /// Takeoff starts this long after the fleet's T0, unless another time of its retiming is
    /// better.
    pub depart_s: f64,
    /// What else the planner may choose.
    pub retiming: Retiming,
    /// Its limits of altitude besides `min_agl` and the ceiling of the area.
    pub altitudes: AltitudeLimits,
    /// Fence items that it keeps; none: [`crate::autopilot::Capacity::fence`].
    pub fence_points: Option<usize>,
    /// How long or how far it flies; none: not judged.
    pub endurance: Option<Endurance>,
    /// Only with it may NAV_RETURN_TO_LAUNCH be written.
    pub return_amsl: Option<Amsl>,
    /// The wind of the spec: it carries what holds its airspeed.
    pub wind: Option<Wind>,
    /// What only planes and vtol have; none for a copter.
    pub wing: Option<Wing>,
}

/// Limits of altitude on the routes of a vehicle, those of the area included.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AltitudeLimits {
    /// Greatest height above ground.
    pub max_agl: Option<Agl>,
    /// Least altitude.
    pub min_amsl: Option<Amsl>,
}

impl AltitudeLimits {
    /// The tighter of two, limit by limit.
    #[must_use]
    pub fn tighter(self, other: Self) -> Self {
        let either = |a: Option<f64>, b: Option<f64>, of: fn(f64, f64) -> f64| match (a, b) {
            (Some(a), Some(b)) => Some(of(a, b)),
            (a, b) => a.or(b),
        };
        let agl_m = |of: Self| of.max_agl.map(|agl| agl.0);
        let amsl_m = |of: Self| of.min_amsl.map(|amsl| amsl.0);
        Self {
            max_agl: either(agl_m(self), agl_m(other), f64::min).map(Agl),
            min_amsl: either(amsl_m(self), amsl_m(other), f64::max).map(Amsl),
        }
    }
}

/// Departures and speeds that the planner may choose instead of a detour around other vehicles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Retiming {
    /// Departures, seconds after T0; none: `depart_s` alone.
    pub depart_s: Option<Span>,
    /// Speeds, m/s; none: `speed_mps` alone.
    pub speed_mps: Option<Span>,
}

impl Retiming {
    /// Whether another departure or speed is allowed.
    #[must_use]
    pub fn is_allowed(&self) -> bool {
        self.depart_s.is_some() || self.speed_mps.is_some()
    }

    /// The first departure that it allows, seconds after T0.
    pub(super) fn opens_s(&self) -> f64 {
        self.depart_s.map_or(0.0, |window| window.least)
    }
}

/// All numbers from one to another, both included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The least.
    pub least: f64,
    /// The greatest.
    pub most: f64,
}

impl Span {
    /// How far a number lies outside; 0 within.
    #[must_use]
    pub fn miss(self, value: f64) -> f64 {
        (self.least - value).max(value - self.most).max(0.0)
    }
}

/// How a plane or vtol takes off, circles and lands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wing {
    /// Course of the takeoff run and climb, radians clockwise from north. Every plane has
    /// one; a vtol without one leaves its vertical climb in whichever direction is best.
    pub takeoff_heading_rad: Option<f64>,
    /// Every plane that lands has one; a vtol without one lands from whichever direction it comes. In
    /// version 2 a vtol that lands in wind has one.
    pub landing: Option<Landing>,
    /// Radius of circling, metres, not below the turn radius.
    pub loiter_radius_m: f64,
    /// The ceiling of the area, where a wing is fastest at its indicated airspeed.
    pub ceiling: Amsl,
}

/// The straight approach to a landing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landing {
    /// Course of the approach, radians clockwise from north; none: into the wind, or the nearest to it
    /// that is free ([`crate::world::VehicleSites::landing_rad`]).
    pub heading_rad: Option<f64>,
    /// Angle of a plane's glide, radians, positive.
    pub glide_rad: f64,
}

/// The last part of a path to a landing, both lengths in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ApproachLengths {
    /// The straight leg on the course of the landing: a plane's glide, or the distance in
    /// which a vtol slows down.
    pub straight_m: f64,
    /// Before it, for the turn onto that course: here the planned path ends.
    pub gate_m: f64,
}

impl Vehicle {
    /// What its autopilot does on its airframe.
    #[must_use]
    pub fn facts(&self) -> &'static Facts {
        facts(self.autopilot, self.airframe)
    }

    /// Fence items that it keeps: what the spec states, or what its autopilot keeps.
    #[must_use]
    pub fn fence_capacity(&self) -> usize {
        self.fence_points.unwrap_or(self.facts().capacity.fence)
    }

    /// The greatest speed over the ground that the spec lets it have, m/s.
    #[must_use]
    pub fn top_speed_mps(&self) -> f64 {
        let stated_mps = self.max_airspeed_mps.unwrap_or(0.0);
        let ceiling = self.wing.map_or(Amsl(0.0), |wing| wing.ceiling);
        self.fastest_at_mps(self.speeds().most, ceiling)
            .max(stated_mps)
    }

    /// Whether it may come straight down to a goal below the least height above ground: it does so
    /// where it lands.
    #[must_use]
    pub fn can_drop(&self) -> bool {
        self.airframe != Airframe::Plane && self.finish == Finish::Land
    }

    /// The greatest speed through the air that a copter is known to fly with a greatest lean angle
    /// (degrees; none: the stock one), m/s. None on a wing, and where no figure is known.
    #[must_use]
    pub fn flyable_mps(&self, lean_deg: Option<f64>) -> Option<f64> {
        let behaviour = &self.facts().behaviour;
        let stock_deg = behaviour.lean_deg;
        let reached = || {
            let lean_deg = lean_deg.unwrap_or(stock_deg).min(MAX_LEAN_DEG);
            behaviour.speed_at_lean_mps(self.autopilot_version, lean_deg)
        };
        let is_copter = self.airframe == Airframe::Copter;
        is_copter.then(|| self.max_airspeed_mps.or_else(reached))?
    }

    /// The lean angle that a copter must be allowed for a speed through the air, degrees: at least
    /// the stock one, at most [`MAX_LEAN_DEG`]. None where the spec states what this copter flies.
    #[must_use]
    pub fn lean_for_speed_deg(&self, speed_mps: f64) -> Option<f64> {
        let behaviour = &self.facts().behaviour;
        let is_stock = self.airframe == Airframe::Copter && self.max_airspeed_mps.is_none();
        let needed = || behaviour.lean_for_speed_deg(self.autopilot_version, speed_mps);
        is_stock.then(needed)?.map(|deg| deg.min(MAX_LEAN_DEG))
    }

    /// The departures that the spec allows, seconds after T0.
    #[must_use]
    pub fn departures(&self) -> Span {
        self.retiming.depart_s.unwrap_or(Span {
            least: self.depart_s,
            most: self.depart_s,
        })
    }

    /// The speeds that the spec allows, m/s.
    #[must_use]
    pub fn speeds(&self) -> Span {
        self.retiming.speed_mps.unwrap_or(Span {
            least: self.speed_mps,
            most: self.speed_mps,
        })
    }

    /// A warning where a wing is to fly slower or faster than the default parameters of its autopilot
    /// let it: it then keeps to those.
    #[must_use]
    pub fn airspeed_note(&self) -> Option<String> {
        self.wing.as_ref()?;
        let facts = self.facts();
        let default = |name: Option<&'static str>| facts.parameter(name?);
        let [least, most] = facts.defaults.speed_parameters.map(default);
        let speeds = self.speeds();
        let slow = least.filter(|row| speeds.least < row.default_si());
        let fast = most.filter(|row| speeds.most > row.default_si());
        let (row, planned_mps, than) = match (slow, fast) {
            (Some(row), _) => (row, speeds.least, "slower"),
            (None, Some(row)) => (row, speeds.most, "faster"),
            (None, None) => return None,
        };
        Some(format!(
            "{}: {planned_mps} m/s is planned, and {} flies no {than} than {}, by default {} m/s: set that, if the aircraft \
             can fly so",
            self.id,
            self.autopilot.name(),
            row.name,
            row.default_si()
        ))
    }

    /// Greatest speed over the ground, m/s: the planned one, on a wing that at the ceiling of
    /// the area, and the wind's.
    #[must_use]
    pub fn fastest_mps(&self) -> f64 {
        match self.wing {
            Some(wing) => self.fastest_at_mps(self.speed_mps, wing.ceiling),
            None => self.speed_mps,
        }
    }

    /// Greatest speed over the ground at a commanded speed and an altitude, m/s.
    #[must_use]
    pub fn fastest_at_mps(&self, speed_mps: f64, at: Amsl) -> f64 {
        let wind_mps = self.carried_by().map_or(0.0, |wind| wind.speed_mps);
        self.through_air_mps(speed_mps, at) + wind_mps
    }

    /// Speed through the air at a commanded speed and an altitude, m/s. The command of a wing is
    /// an indicated airspeed; its true airspeed grows with altitude.
    pub(crate) fn through_air_mps(&self, speed_mps: f64, at: Amsl) -> f64 {
        match self.wing {
            Some(_) => speed_mps * true_airspeed_ratio(at),
            None => speed_mps,
        }
    }

    /// Speed over the ground on a course (radians clockwise from north) at an altitude and a
    /// commanded speed: on a wing an indicated airspeed. None if the wind is too strong to
    /// hold that course.
    #[must_use]
    pub fn ground_speed_mps(&self, speed_mps: f64, at: Amsl, course_rad: f64) -> Option<f64> {
        let through_mps = self.through_air_mps(speed_mps, at);
        match self.carried_by() {
            Some(wind) => wind.ground_speed_mps(through_mps, course_rad),
            None => Some(through_mps),
        }
    }

    /// The wind that carries it, if any does: a copter holds its ground speed.
    #[must_use]
    pub fn carried_by(&self) -> Option<Wind> {
        self.wing?;
        self.wind.filter(|wind| wind.speed_mps > 0.0)
    }

    /// The wind into which it lands on a course that the spec leaves open; none where there is no such
    /// course to find.
    #[must_use]
    pub fn approach_wind(&self) -> Option<Wind> {
        let landing = self.wing?.landing?;
        let is_open = landing.heading_rad.is_none() && self.finish != Finish::Loiter;
        self.carried_by().filter(|_| is_open)
    }

    /// How long the approach from a height above touchdown is; none for a copter, and for a
    /// vtol that may come from any direction.
    #[must_use]
    pub fn approach_lengths(&self, height_m: f64) -> Option<ApproachLengths> {
        let wing = self.wing?;
        let landing = wing.landing?;
        let straight_m = match self.airframe {
            Airframe::Copter => return None,
            Airframe::Plane => height_m.max(0.0) / landing.glide_rad.tan(),
            Airframe::Vtol => self.fastest_mps() * self.fastest_mps() / (2.0 * self.accel_mps2),
        };
        Some(ApproachLengths {
            straight_m,
            gate_m: 3.0 * wing.loiter_radius_m,
        })
    }
}

/// Standard gravity, m/s^2.
pub const GRAVITY_MPS2: f64 = 9.806_65;

/// Turn radius at a speed and load factor, `v^2 / (g sqrt(n^2 - 1))`, metres.
#[must_use]
pub fn turn_radius_by_load_m(speed_mps: f64, load_factor: f64) -> f64 {
    speed_mps * speed_mps / (GRAVITY_MPS2 * (load_factor * load_factor - 1.0).sqrt())
}

/// A point of the path, with its altitude as the spec states it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndPoint {
    /// Where.
    pub place: LatLon,
    /// How high.
    pub altitude: Placement,
}

/// An altitude over ground or over the sea.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Placement {
    /// Over the terrain at that place.
    Agl(Agl),
    /// Over mean sea level.
    Amsl(Amsl),
}

/// How a vehicle is reached.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Link {
    /// A simulated vehicle inside this process, over real UDP on loopback.
    Sim,
    /// Send to this address, listen for the answers.
    UdpOut(String),
    /// Bind this address, wait for the vehicle to speak.
    UdpIn(String),
    /// Connect to this address.
    Tcp(String),
    /// Bind this address, wait for one connection.
    TcpIn(String),
    /// A serial port.
    Serial {
        /// Device.
        device: String,
        /// Baud rate.
        baud: u32,
    },
}

/// What happens at the goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[schemars(transform = words)]
pub enum Finish {
    /// Land there.
    Land,
    /// Stay there until commanded otherwise.
    Loiter,
    /// Fly a planned path home and land there.
    Return,
}

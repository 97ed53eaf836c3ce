//! The autopilot in flight: modes, the mission it holds, one step of time after the other.
//!
//! It reads its items itself, as integers, and shares nothing with the model of the
//! verdict: what one of them has wrong, the other shows.

mod camera;
mod mission;
mod orders;
mod payload;
mod wing;

use super::dynamics::body::{Body, Weathering};
use super::dynamics::steering;
use super::dynamics::steering::Leg;
use super::dynamics::wing::Wing;
use super::environment::Surroundings;
use super::mode::Mode;
use super::parameters::{Limits, Settings};
use super::profile::Profile;
use crate::geodesy::{Amsl, EastNorth, LatLon, LocalFrame};
use crate::link::{LandedState, Time};
use crate::mission::{Home, Item};
use crate::spec::{Airframe, Wind};
use wing::Winged;

/// One step, milliseconds.
pub(crate) const STEP_MS: u64 = 50;
/// The same, seconds.
const STEP_S: f64 = 0.05;
/// From touchdown until the motors stop, milliseconds.
const DISARM_MS: u64 = 1500;
/// A place is reached this near, metres.
const REACHED_M: f64 = 0.7;

/// What the vehicle is doing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Doing {
    /// Stands on the ground.
    Standing,
    /// Waits, on the ground or where it is in the air.
    Waiting { until: Time },
    /// Climbs straight up to an altitude.
    Rising { amsl_m: f64 },
    /// Flies a leg; the time it stays at its end, or for ever.
    Flying { leg: Leg, hold: Hold },
    /// Stays at a point.
    Holding { at_m: [f64; 3], until: Option<Time> },
    /// Goes down to the ground below a point.
    Sinking { at_m: [f64; 3] },
    /// Places a load on the ground.
    Placing(payload::Placing),
    /// Has touched down.
    Landed { at: Time },
    /// Is carried by its wing, or about to be.
    OnWing(Winged),
}

/// What happens at the end of a leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Hold {
    /// The next item.
    Pass,
    /// It stays for a time, milliseconds.
    For(u64),
    /// It stays.
    Ever,
    /// It lands.
    Land,
    /// It places a load there.
    Place,
}

/// Reports of the pilot for the ground station.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Event {
    /// An item was done: its index without home.
    Reached(usize),
    /// A text.
    Says(&'static str),
    /// A picture was taken: its number, from 1.
    Picture(u32),
}

/// The autopilot and its vehicle.
#[derive(Clone, Debug)]
pub(crate) struct Pilot {
    profile: Profile,
    airframe: Airframe,
    pub(crate) settings: Settings,
    surroundings: Surroundings,
    weathering: Weathering,
    frame: LocalFrame,
    home_m: f64,
    /// East and north of its rally points, metres.
    rally_m: Vec<[f64; 2]>,
    body: Body,
    /// What carries it, while a wing does.
    wing: Option<Wing>,
    pub(crate) custom_mode: u32,
    pub(crate) armed: bool,
    armed_at: Time,
    airborne: bool,
    doing: Doing,
    /// The mission item at work, without home.
    at: usize,
    /// Whether the mission was begun and is not ended.
    under_way: bool,
    /// Speed that the mission asked for.
    speed_mps: Option<f64>,
    clock: Time,
    events: Vec<Event>,
    camera: camera::Camera,
    /// A wind that it cannot hold its speed in, to the east and the north, and its greatest
    /// airspeed, m/s.
    gale: Option<([f64; 2], f64)>,
}

impl Pilot {
    /// A vehicle that stands at its home.
    pub(crate) fn new(
        profile: Profile,
        sysid: u8,
        home: Home,
        surroundings: Surroundings,
        now: Time,
    ) -> Self {
        let home_m = f64::from(home.amsl_m);
        let mut pilot = Self {
            profile,
            airframe: Airframe::Copter,
            settings: Settings::of(profile, Airframe::Copter),
            weathering: Weathering::new(
                surroundings.wind,
                surroundings.noise_m,
                surroundings.seed,
                sysid,
            ),
            surroundings,
            frame: LocalFrame::new(LatLon::of_e7(home.x, home.y)),
            home_m,
            rally_m: Vec::new(),
            body: Body {
                at_m: [0.0, 0.0, home_m],
                velocity_mps: [0.0; 3],
            },
            wing: None,
            custom_mode: Mode::first(profile),
            armed: false,
            armed_at: now,
            airborne: false,
            doing: Doing::Standing,
            at: 0,
            under_way: false,
            speed_mps: None,
            clock: now,
            camera: camera::Camera::default(),
            events: Vec::new(),
            gale: None,
        };
        pilot.set_up();
        pilot
    }

    /// The same on another airframe.
    pub(crate) fn on(mut self, airframe: Airframe) -> Self {
        self.airframe = airframe;
        self.settings = Settings::of(self.profile, airframe);
        self.set_up();
        self
    }

    /// Parameters other than those it comes with.
    fn set_up(&mut self) {
        for (name, value) in &self.surroundings.params {
            self.settings.set(name, *value);
        }
    }

    /// A wind comes up that it cannot hold its speed in.
    pub(crate) fn blow(&mut self, wind: Wind, airspeed_mps: f64) {
        self.gale = Some((wind.velocity_mps(), airspeed_mps));
    }

    /// The speed that it can make along a leg, m/s.
    pub(crate) fn reachable_mps(&self, leg: Leg, planned_mps: f64) -> f64 {
        let Some(([east, north], airspeed_mps)) = self.gale else {
            return planned_mps;
        };
        let along = [leg.to_m[0] - leg.from_m[0], leg.to_m[1] - leg.from_m[1]];
        let length_m = along[0].hypot(along[1]).max(1e-6);
        let tail = (east * along[0] + north * along[1]) / length_m;
        let cross = (east * along[1] - north * along[0]) / length_m;
        let made = (airspeed_mps * airspeed_mps - cross * cross)
            .max(0.0)
            .sqrt()
            + tail;
        planned_mps.min(made.max(0.2))
    }

    /// What it does in its mode.
    pub(crate) fn mode(&self) -> Mode {
        Mode::of(self.profile, self.airframe, self.custom_mode)
    }

    /// The number of a mode.
    pub(crate) fn number(&self, mode: Mode) -> u32 {
        mode.number(self.profile, self.airframe)
    }

    /// The item at work, without home.
    pub(crate) fn at(&self) -> usize {
        self.at
    }

    /// Where it thinks it is, how high above the sea, metres, and its velocity east, north, up.
    /// `off_m` is what a fault of its GPS adds to the east and the north.
    pub(crate) fn position(&self, off_m: [f64; 2]) -> (LatLon, f64, [f64; 3]) {
        let [east_m, north_m, amsl_m] = self.sensed();
        let (east_m, north_m) = (east_m + off_m[0], north_m + off_m[1]);
        let place = self.frame.from_plan(EastNorth { east_m, north_m });
        (place, amsl_m, self.body.velocity_mps)
    }

    /// `MAV_LANDED_STATE`.
    pub(crate) fn landed_state(&self) -> LandedState {
        match self.doing {
            Doing::Rising { .. } => LandedState::TAKEOFF,
            Doing::Sinking { .. } => LandedState::LANDING,
            Doing::OnWing(winged) => winged.landed_state(),
            _ if self.airborne => LandedState::IN_AIR,
            _ => LandedState::ON_GROUND,
        }
    }

    /// What it has to tell since the last time.
    pub(crate) fn events(&mut self) -> Vec<Event> {
        std::mem::take(&mut self.events)
    }

    /// When [`Self::advance`] has something to do; none on the ground with motors off.
    pub(crate) fn due(&self) -> Option<Time> {
        self.armed.then_some(self.clock + STEP_MS)
    }

    /// Flies up to a time.
    pub(crate) fn advance(&mut self, now: Time, items: &[Item]) {
        while self.armed && self.clock + STEP_MS <= now {
            self.clock = self.clock + STEP_MS;
            self.weathering.step(STEP_S);
            self.step(items);
            self.watch_camera();
        }
        if !self.armed {
            self.clock = now;
        }
    }

    fn step(&mut self, items: &[Item]) {
        let limits = self.settings.limits();
        let at_m = self.sensed();
        let demand = match self.doing {
            Doing::Standing => return self.idle(&limits),
            Doing::Landed { at } => {
                if self.clock >= at + self.disarm_ms() {
                    self.armed = false;
                    self.stand();
                }
                return;
            }
            Doing::Waiting { until } => {
                if self.clock >= until {
                    self.complete(items);
                }
                if !self.airborne {
                    return;
                }
                steering::hold_mps(at_m, at_m, &limits)
            }
            Doing::Rising { amsl_m } => {
                self.airborne = true;
                if amsl_m - at_m[2] < REACHED_M {
                    self.complete(items);
                }
                let climb = steering::closing_mps(amsl_m - at_m[2], 0.7 * limits.accel_z_mps2);
                [0.0, 0.0, climb.clamp(0.0, limits.takeoff_mps)]
            }
            Doing::Flying { leg, hold } => {
                let demand = self.along(leg, hold, at_m, items, &limits);
                self.arrive(leg, hold, at_m, items, &limits);
                demand
            }
            Doing::Holding { at_m: place, until } => {
                if until.is_some_and(|until| self.clock >= until) {
                    self.complete(items);
                }
                steering::hold_mps(at_m, place, &limits)
            }
            Doing::Sinking { at_m: place } => self.sink(place, at_m, &limits),
            Doing::Placing(placing) => self.step_placing(placing, at_m, items, &limits),
            Doing::OnWing(winged) => return self.step_winged(winged, at_m, items),
        };
        if matches!(self.doing, Doing::Landed { .. }) {
            return;
        }
        self.body
            .step(demand, &limits, self.weathering.gust(), STEP_S);
    }

    /// From touchdown until the motors stop, milliseconds.
    fn disarm_ms(&self) -> u64 {
        match self.airframe {
            Airframe::Plane => self.settings.wing().disarm_ms,
            Airframe::Copter | Airframe::Vtol => DISARM_MS,
        }
    }

    /// Motors that run for nothing are stopped.
    fn idle(&mut self, limits: &Limits) {
        let idle_s = limits.idle_s.unwrap_or(f64::INFINITY);
        #[expect(clippy::cast_precision_loss, reason = "milliseconds of one flight")]
        let since_s = (self.clock - self.armed_at) as f64 / 1000.0;
        if since_s >= idle_s {
            self.armed = false;
            self.events.push(Event::Says("Disarmed: no takeoff"));
        }
    }

    fn sink(&mut self, place: [f64; 3], at_m: [f64; 3], limits: &Limits) -> [f64; 3] {
        let over_m = at_m[2] - self.ground_m(at_m);
        if over_m <= 0.05 {
            self.airborne = false;
            self.under_way = false;
            self.body.velocity_mps = [0.0; 3];
            self.doing = Doing::Landed { at: self.clock };
            if self.mode() == Mode::Mission {
                self.events.push(Event::Reached(self.at));
            }
            return [0.0; 3];
        }
        // It begins to slow down before, so that it is slow there.
        let fast = limits.descent_mps.max(limits.slow_landing_mps);
        let slow = limits.slow_landing_mps;
        let spare_m = (over_m - limits.slow_landing_m).max(0.0);
        let descent = (slow * slow + 2.0 * limits.accel_z_mps2 * spare_m)
            .sqrt()
            .min(fast);
        let [east, north, _] = steering::hold_mps(at_m, [place[0], place[1], at_m[2]], limits);
        [east, north, -descent]
    }

    /// The ground below; that of home where it is not known.
    fn ground_m(&self, at_m: [f64; 3]) -> f64 {
        let place = self.frame.from_plan(EastNorth {
            east_m: at_m[0],
            north_m: at_m[1],
        });
        let known = self.surroundings.terrain.as_ref();
        known
            .and_then(|terrain| terrain.height(place).ok())
            .map_or(self.home_m, |Amsl(amsl_m)| amsl_m)
    }

    fn stand(&mut self) {
        self.doing = Doing::Standing;
        self.under_way = false;
        self.at = 0;
    }

    fn sensed(&self) -> [f64; 3] {
        if self.airborne {
            self.weathering.sensed(self.body.at_m)
        } else {
            self.body.at_m
        }
    }
}

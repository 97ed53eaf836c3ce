//! The autopilot of a plane, and of a VTOL on its wing.

mod items;
mod landing;

use super::mission::place;
use super::{Doing, Event, Pilot, STEP_S};
use crate::geodesy::{Amsl, true_airspeed_ratio};
use crate::link::LandedState;
use crate::link::Time;
use crate::mission::Item;
use crate::simulator::dynamics::guidance::{Motion, wrapped};
use crate::simulator::dynamics::steering;
use crate::simulator::dynamics::steering::Leg;
use crate::simulator::dynamics::wing::{Demand, Wing};
use crate::simulator::mode::Mode;
use crate::simulator::parameters::{Passes, WingLimits};
use crate::simulator::profile::Profile;
use crate::spec::Airframe;

/// A circle is left when the nose points this near to the next place, radians.
const LINED_UP_RAD: f64 = 10.0 * std::f64::consts::PI / 180.0;
/// ArduPlane climbs out with all its thrust, whatever climb and speed are planned: its simulated plane
/// made 9.3 to 10.4 m/s up and 25 to 30 m/s ahead (4.6.3, 24 flights).
const CLIMB_OUT_MPS: f64 = 10.0;
const CLIMB_OUT_AIRSPEED_MPS: f64 = 27.0;
/// Slower than this on its wheels it stands, m/s.
const STANDS_MPS: f64 = 0.1;

/// What a wing is doing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::simulator) enum Winged {
    /// Runs along the ground until it is fast enough.
    Running(Takeoff),
    /// Climbs straight ahead.
    ClimbingOut(Takeoff),
    /// Follows a leg.
    Following(Following),
    /// Circles around a point, onto whose altitude a leg leads, if one does; clockwise with a
    /// positive radius. On its way down it ends on the ground.
    Circling(Circle),
    /// Glides to the ground at the end of a leg; since its flare from a height, with a sink.
    Gliding { leg: Leg, flare: Option<(f64, f64)> },
    /// Runs out on its wheels.
    RunningOut,
}

/// A circle around the end of a leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::simulator) struct Circle {
    leg: Leg,
    radius_m: f64,
    lands: bool,
    /// How long, since when it is on its circle; none: for ever.
    stay: Option<Stay>,
}

/// A circle that is left again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::simulator) struct Stay {
    /// Milliseconds.
    time_ms: u64,
    /// When the time is over, once it runs.
    until: Option<Time>,
}

/// A takeoff along a course.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::simulator) struct Takeoff {
    /// From home, along the course.
    line: Leg,
    pitch_rad: f64,
    /// Until this altitude.
    amsl_m: f64,
}

/// A leg on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::simulator) struct Following {
    leg: Leg,
    /// Whether it is at the altitude of its end at once.
    at_once: bool,
    /// The least distance to its end so far, metres.
    nearest_m: f64,
    /// Whether it circles at its end for the altitude.
    circles: bool,
    /// At its end it goes over to its rotors and lands.
    descends: bool,
}

impl Stay {
    /// One of this many milliseconds, which do not run yet.
    pub(super) fn of(time_ms: u64) -> Self {
        Self {
            time_ms,
            until: None,
        }
    }
}

impl Winged {
    pub(crate) fn landed_state(&self) -> LandedState {
        match self {
            Self::Running(_) | Self::RunningOut => LandedState::ON_GROUND,
            Self::ClimbingOut(_) => LandedState::TAKEOFF,
            Self::Gliding { .. } => LandedState::LANDING,
            Self::Following(_) | Self::Circling(_) => LandedState::IN_AIR,
        }
    }

    /// Where the leg after it begins: ArduPlane's after a takeoff where it is.
    pub(crate) fn end_m(&self, profile: Profile, at_m: [f64; 3]) -> [f64; 3] {
        match self {
            Self::ClimbingOut(takeoff) if profile == Profile::Px4 => takeoff.line.to_m,
            Self::Following(following) => following.leg.to_m,
            _ => at_m,
        }
    }
}

impl Pilot {
    /// How the air moves: east, north.
    fn air_mps(&self) -> [f64; 2] {
        let gust = self.weathering.gust_mps();
        let wind = self.surroundings.wind;
        let wind = wind.map_or([0.0; 2], |wind| wind.velocity_mps());
        [0, 1].map(|axis| wind[axis] + gust[axis])
    }

    fn motion(&self, at_m: [f64; 3]) -> Motion {
        let [east, north, _] = self.body.velocity_mps;
        Motion {
            at_m: [at_m[0], at_m[1]],
            velocity_mps: [east, north],
        }
    }

    /// Takes up another mode in the air.
    pub(crate) fn enter_winged(&mut self, mode: Mode) {
        let here = self.sensed();
        match mode {
            Mode::Mission => {}
            Mode::Land if self.airframe == Airframe::Vtol => {
                self.wing = None;
                let at_m = self.stopping_point();
                self.doing = Doing::Sinking { at_m };
            }
            Mode::Return => {
                let amsl_m = self.home_m + self.settings.wing().return_m;
                self.circle([0.0, 0.0, amsl_m], false);
            }
            Mode::Hold => self.circle(here, false),
            Mode::Land => self.circle(here, true),
        }
    }

    /// Circles around a point, or down to the ground.
    fn circle(&mut self, middle_m: [f64; 3], lands: bool) {
        let leg = Leg {
            from_m: middle_m,
            to_m: middle_m,
        };
        let radius_m = self.settings.wing().loiter_radius_m;
        self.carry(None);
        self.doing = Doing::OnWing(Winged::Circling(Circle {
            leg,
            radius_m,
            lands,
            stay: None,
        }));
    }

    /// The wing carries from now on, if it does not yet; its nose towards a point, or where
    /// it goes.
    fn carry(&mut self, towards_m: Option<[f64; 3]>) {
        if self.wing.is_some() {
            return;
        }
        let [east, north, _] = self.body.velocity_mps;
        let heading_rad = match towards_m {
            Some(to) => {
                let at = self.body.at_m;
                (to[0] - at[0]).atan2(to[1] - at[1])
            }
            None => east.atan2(north),
        };
        self.wing = Some(Wing::of(&self.body, heading_rad, self.air_mps()));
    }

    /// One step of what it does.
    pub(crate) fn step_winged(&mut self, winged: Winged, at_m: [f64; 3], items: &[Item]) {
        let limits = self.settings.wing();
        match winged {
            Winged::Running(takeoff) => self.run(takeoff, &limits),
            Winged::ClimbingOut(takeoff) => self.climb_out(takeoff, at_m, items, &limits),
            Winged::Following(following) => self.follow(following, at_m, items, &limits),
            Winged::Circling(circle) => self.go_round(circle, at_m, items, &limits),
            Winged::Gliding { leg, flare } => self.glide(leg, flare, at_m, &limits),
            Winged::RunningOut => self.run_out(),
        }
        let may_touch = matches!(
            self.doing,
            Doing::OnWing(Winged::ClimbingOut(_) | Winged::Following(_))
        );
        if may_touch && self.body.at_m[2] < self.ground_m(self.body.at_m) {
            self.events.push(Event::Says("Crash: disarming"));
            self.airborne = false;
            self.armed = false;
            self.wing = None;
            self.body.velocity_mps = [0.0; 3];
            self.stand();
        }
    }

    /// Flies on with an acceleration across and a climb, at an equivalent airspeed.
    fn fly_on(&mut self, across_mps2: f64, climb_mps: f64, airspeed_mps: f64) {
        let Some(mut wing) = self.wing else { return };
        let demand = Demand {
            across_mps2,
            bank_rad: self.settings.wing().bank_rad,
            climb_mps,
            airspeed_mps: airspeed_mps * true_airspeed_ratio(Amsl(self.body.at_m[2])),
        };
        let air_mps = self.air_mps();
        wing.step(&mut self.body, &demand, air_mps, STEP_S);
        self.wing = Some(wing);
    }

    /// The same towards an altitude.
    fn fly_at(&mut self, across_mps2: f64, amsl_m: f64, at_m: [f64; 3], on_approach: bool) {
        let limits = self.settings.wing();
        let airspeed_mps = if on_approach {
            limits.approach_mps
        } else {
            self.speed_mps.unwrap_or(limits.airspeed_mps)
        };
        let Some(wing) = &mut self.wing else { return };
        let climb_mps = wing
            .height
            .climb_mps(amsl_m, at_m[2], on_approach, &limits, STEP_S);
        self.fly_on(across_mps2, climb_mps, airspeed_mps);
    }

    fn run(&mut self, takeoff: Takeoff, limits: &WingLimits) {
        let (from, to) = (takeoff.line.from_m, takeoff.line.to_m);
        let heading_rad = (to[0] - from[0]).atan2(to[1] - from[1]);
        let air_mps = self.air_mps();
        let standing = Wing::of(&self.body, heading_rad, air_mps);
        let mut wing = self.wing.unwrap_or(standing);
        wing.roll(&mut self.body, f64::INFINITY, air_mps, STEP_S);
        self.body.at_m[2] = self.ground_m(self.body.at_m);
        let ratio = true_airspeed_ratio(Amsl(self.body.at_m[2]));
        if wing.airspeed_mps >= limits.min_airspeed_mps * ratio {
            self.airborne = true;
            wing = Wing::of(&self.body, heading_rad, air_mps);
            self.doing = Doing::OnWing(Winged::ClimbingOut(takeoff));
        }
        self.wing = Some(wing);
    }

    fn climb_out(&mut self, takeoff: Takeoff, at_m: [f64; 3], items: &[Item], limits: &WingLimits) {
        let across_mps2 = self.motion(at_m).along(&takeoff.line, limits);
        let (climb_mps, airspeed_mps) = match self.profile {
            Profile::ArduPilot => (CLIMB_OUT_MPS, CLIMB_OUT_AIRSPEED_MPS),
            Profile::Px4 | Profile::Generic => {
                let airspeed_mps = self.wing.map_or(0.0, |wing| wing.airspeed_mps);
                let climb_mps = airspeed_mps * takeoff.pitch_rad.sin();
                (climb_mps.min(limits.climb_mps), limits.airspeed_mps)
            }
        };
        self.fly_on(across_mps2, climb_mps, airspeed_mps);
        if at_m[2] >= takeoff.amsl_m {
            if let Some(wing) = &mut self.wing {
                wing.height = crate::simulator::dynamics::altitude::Height::at(at_m[2]);
            }
            self.complete(items);
        }
    }

    fn follow(
        &mut self,
        mut following: Following,
        at_m: [f64; 3],
        items: &[Item],
        limits: &WingLimits,
    ) {
        let leg = following.leg;
        let motion = self.motion(at_m);
        let away_m = steering::across_m(at_m, leg.to_m);
        following.nearest_m = following.nearest_m.min(away_m).min(leg.length_m());
        following.circles = self.waits_for_altitude(&following, at_m, limits);
        self.doing = Doing::OnWing(Winged::Following(following));
        let (mut across_mps2, mut amsl_m) = (
            motion.along(&leg, limits),
            altitude_m(&following, at_m, limits),
        );
        if following.circles {
            let middle_m = [leg.to_m[0], leg.to_m[1]];
            (across_mps2, _) = motion.around(middle_m, limits.loiter_radius_m, limits);
            amsl_m = leg.to_m[2];
        }
        self.fly_at(across_mps2, amsl_m, at_m, false);
        if following.descends {
            let rotors = self.settings.limits();
            let speed = motion.speed_mps();
            // With the same hand in reserve as a copter that comes to a stop.
            let stop_m = speed * speed / (2.0 * 0.7 * rotors.accel_mps2);
            if away_m <= stop_m || leg.left_m(at_m) <= 0.0 {
                self.wing = None;
                self.doing = self.onto_rotors(leg.to_m);
            }
        } else if self.is_passed(&following, at_m, items, limits) {
            self.complete(items);
        }
    }

    /// PX4 circles at a waypoint until it has its altitude.
    fn waits_for_altitude(
        &self,
        following: &Following,
        at_m: [f64; 3],
        limits: &WingLimits,
    ) -> bool {
        let Passes::Within { height_m, .. } = limits.passes else {
            return false;
        };
        let to_m = following.leg.to_m;
        let is_off = (at_m[2] - to_m[2]).abs() > height_m;
        let is_there = steering::across_m(at_m, to_m) <= self.accepted_m(limits);
        !following.descends && is_off && (is_there || following.circles)
    }

    fn go_round(
        &mut self,
        mut circle: Circle,
        at_m: [f64; 3],
        items: &[Item],
        limits: &WingLimits,
    ) {
        let ratio = true_airspeed_ratio(Amsl(at_m[2]));
        let (leg, radius_m) = (&mut circle.leg, limits.circle_m(circle.radius_m, ratio));
        let middle_m = [leg.to_m[0], leg.to_m[1]];
        let (across_mps2, circles) = self.motion(at_m).around(middle_m, radius_m, limits);
        if circles {
            leg.from_m[2] = leg.to_m[2];
        }
        let leg = *leg;
        let following = Following::new(leg, self.profile == Profile::Px4);
        if circle.lands {
            let ground_m = self.ground_m(at_m);
            self.fly_at(across_mps2, ground_m - 10.0, at_m, true);
            if self.body.at_m[2] <= ground_m {
                return self.touch_down();
            }
        } else {
            let amsl_m = altitude_m(&following, at_m, limits);
            self.fly_at(across_mps2, amsl_m, at_m, false);
        }
        if let Some(stay) = &mut circle.stay {
            if circles {
                stay.until.get_or_insert(self.clock + stay.time_ms);
            }
            if stay.until.is_some_and(|until| self.clock >= until) && self.heads_on(leg, items) {
                self.complete(items);
                return;
            }
        }
        self.doing = Doing::OnWing(Winged::Circling(circle));
    }

    /// Whether a wing that circles heads for the next place, within 10 degrees; where that is within
    /// its circle it goes on at once (`ModeLoiter::isHeadingLinedUp`).
    fn heads_on(&self, leg: Leg, items: &[Item]) -> bool {
        let mut ahead = items.iter().skip(self.at + 1);
        let next = ahead.find_map(|item| place(item).and_then(|_| self.point_m(item, leg.to_m)));
        let Some(next_m) = next else { return true };
        let within_m = 1.05 * self.settings.wing().loiter_radius_m.abs();
        if steering::across_m(leg.to_m, next_m) < within_m {
            return true;
        }
        let at_m = self.body.at_m;
        let bearing_rad = (next_m[0] - at_m[0]).atan2(next_m[1] - at_m[1]);
        let [east, north, _] = self.body.velocity_mps;
        wrapped(bearing_rad - east.atan2(north)).abs() <= LINED_UP_RAD
    }
}

impl Following {
    fn new(leg: Leg, at_once: bool) -> Self {
        Self {
            leg,
            at_once,
            nearest_m: f64::INFINITY,
            circles: false,
            descends: false,
        }
    }
}

/// The altitude demand on a leg.
fn altitude_m(following: &Following, at_m: [f64; 3], limits: &WingLimits) -> f64 {
    let leg = &following.leg;
    let (from_m, to_m) = (leg.from_m[2], leg.to_m[2]);
    let length_m = leg.length_m();
    let change_m = to_m - from_m;
    let share = match limits.passes {
        _ if following.at_once => 1.0,
        Passes::Turning { .. } if change_m.abs() < limits.slope_min_m || leg.is_upright() => 1.0,
        Passes::Turning { .. } => 1.0 - leg.left_m(at_m) / length_m,
        // As early as a circle around the end of the leg would begin.
        Passes::Within { radius_m, .. } => {
            let early_m = radius_m.max(limits.loiter_radius_m.abs());
            if length_m <= early_m {
                1.0
            } else {
                1.0 - (following.nearest_m - early_m) / (length_m - early_m)
            }
        }
    };
    from_m + change_m * share.clamp(0.0, 1.0)
}

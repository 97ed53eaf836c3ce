//! How high a vehicle is whose place is not known any more.

use super::FlightVehicle;
use crate::geodesy::Amsl;
use crate::link::{LandedState, Position, Time};

/// An altitude that stays exactly the same while the height above home changes by more than this, metres, is one
/// of before, and so is the place.
const LOST_M: f64 = 1.0;

/// What it said of ground and air counts for this long, milliseconds: it says so each second.
const SAID_MS: u64 = 3000;

/// Place, altitude and height above home as they are sent. An `ArduPilot` without a place repeats the last one and its
/// altitude, and goes on with the height above home.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Height {
    /// The place and altitude as they were sent, and the height above home when they came first, metres.
    still: Option<([i32; 3], f64)>,
    /// When it was last known where it is, seconds after T0; and whether that is now.
    placed_s: f64,
    is_placed: bool,
    /// When it was last known how high it is, seconds after T0, and that height above the ground, metres.
    pub(super) known_s: f64,
    pub(super) known_m: Option<f64>,
    /// Whether it said that it is on the ground, and whether that was before its last armed heartbeat.
    says_grounded: bool,
    is_grounded: bool,
    /// What it said last of ground and air, and when.
    landed: Option<(LandedState, Time)>,
    /// Its height above home while it stood with its motors, metres.
    stood_m: f64,
    /// Whether its last position shows it in the air.
    pub(super) is_up: bool,
}

impl Height {
    /// The altitude of a position that came `t_s` after T0: by the height above home where its own stands still.
    pub(super) fn take(&mut self, position: &Position, t_s: f64) -> Amsl {
        let sent = [position.x, position.y, position.amsl_mm];
        let now_m = position.above_home_m();
        let first_m = match self.still {
            Some((before, first_m)) if before == sent => first_m,
            _ => now_m,
        };
        self.still = Some((sent, first_m));
        let risen_m = now_m - first_m;
        self.is_placed = risen_m.abs() <= LOST_M;
        if self.is_placed {
            self.placed_s = t_s;
        }
        Amsl(position.amsl().0 + risen_m)
    }

    /// A vehicle that says so before its motors stop is on the ground; what it says after that shows nothing.
    pub(super) fn take_landed(&mut self, state: LandedState, now: Time) {
        self.landed = Some((state, now));
        self.says_grounded = state == LandedState::ON_GROUND;
        self.is_grounded &= self.says_grounded;
    }

    pub(super) fn take_armed(&mut self) {
        self.is_grounded = self.says_grounded;
    }

    /// What it says of ground and air, if that is not too old.
    pub(super) fn landed_state(&self, now: Time) -> Option<LandedState> {
        let fresh = self.landed.filter(|(_, at)| now - *at <= SAID_MS);
        fresh.map(|(state, _)| state)
    }

    /// When it last said whether it is on the ground.
    pub(super) fn landed_at(&self) -> Option<Time> {
        self.landed.map(|(_, at)| at)
    }

    /// It stands at that height above home.
    pub(super) fn stand(&mut self, above_m: f64) {
        self.stood_m = above_m;
    }

    /// How much higher a position is than where it stood, metres.
    pub(super) fn risen_m(&self, position: &Position) -> f64 {
        position.above_home_m() - self.stood_m
    }

    /// Whether it was on the ground by its own word, while its motors ran.
    pub(super) fn is_grounded(&self) -> bool {
        self.is_grounded
    }

    pub(super) fn is_placed(&self) -> bool {
        self.is_placed
    }

    /// What is said with a distance from its last place, if that is not where it is now.
    pub(super) fn of_place(&self) -> String {
        match self.is_placed {
            true => String::new(),
            false => format!(" by its last place, of T0+{:.0} s", self.placed_s),
        }
    }
}

impl FlightVehicle<'_> {
    /// Takes in a position without a place.
    pub(super) fn take_placeless(&mut self, t_s: f64, position: &Position) {
        self.motors.height.is_placed = false;
        self.take_height(t_s, Some(position.above_home_m()));
    }

    /// Takes in how high it is above the ground, if that is known.
    pub(in crate::flight) fn take_height(&mut self, t_s: f64, agl_m: Option<f64>) {
        self.motors.agl_m = agl_m;
        if agl_m.is_some() {
            (self.motors.height.known_s, self.motors.height.known_m) = (t_s, agl_m);
        }
    }
}

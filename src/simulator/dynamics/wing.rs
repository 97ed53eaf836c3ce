//! A wing (a plane, or a VTOL between its takeoff and landing) in the air: it goes where its nose
//! points, turns by banking, and is carried by the wind.
//!
//! A point with an airspeed, a heading and a bank; its turns are coordinated, and its motor
//! and rudders follow commands as assumed here, not as measured on an aircraft.

use crate::spec::GRAVITY_MPS2;

use super::altitude::Height;
use super::body::Body;

/// How fast the motor and the drag change the airspeed, m/s^2.
const ACCEL_MPS2: f64 = 2.5;
/// How long errors of bank, of airspeed and of climb last, seconds.
const ROLL_S: f64 = 0.5;
const SPEED_S: f64 = 2.0;
const CLIMB_S: f64 = 0.5;
/// The fastest roll, rad/s.
const ROLL_RATE: f64 = 1.0;
/// How long what a hover leaves across the nose lasts, seconds.
const SLIP_S: f64 = 2.0;
/// Below this a heading changes no faster than at it, m/s: the rudders have no more hold.
const SLOW_MPS: f64 = 8.0;

/// The state of a wing, besides that of its [`Body`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Wing {
    /// True airspeed, m/s.
    pub(crate) airspeed_mps: f64,
    /// Where the nose points, radians clockwise from north.
    pub(crate) heading_rad: f64,
    /// To the right.
    bank_rad: f64,
    climb_mps: f64,
    /// What of its motion over the ground is neither from wind nor from wing.
    slip_mps: [f64; 2],
    pub(crate) height: Height,
}

/// What the autopilot wants of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Demand {
    /// To the right, m/s^2.
    pub(crate) across_mps2: f64,
    /// The steepest bank, radians.
    pub(crate) bank_rad: f64,
    pub(crate) climb_mps: f64,
    /// True airspeed, m/s.
    pub(crate) airspeed_mps: f64,
}

impl Wing {
    /// A wing that begins to carry with its nose on a heading, in an air that moves.
    pub(crate) fn of(body: &Body, heading_rad: f64, air_mps: [f64; 2]) -> Self {
        let (sin, cos) = heading_rad.sin_cos();
        let through = [0, 1].map(|axis| body.velocity_mps[axis] - air_mps[axis]);
        let airspeed_mps = (through[0] * sin + through[1] * cos).max(0.0);
        Self {
            airspeed_mps,
            heading_rad,
            bank_rad: 0.0,
            climb_mps: body.velocity_mps[2],
            slip_mps: [
                through[0] - airspeed_mps * sin,
                through[1] - airspeed_mps * cos,
            ],
            height: Height::at(body.at_m[2]),
        }
    }

    /// Flies for a while.
    pub(crate) fn step(&mut self, body: &mut Body, demand: &Demand, air_mps: [f64; 2], dt_s: f64) {
        let bank_rad = (demand.across_mps2 / GRAVITY_MPS2).atan();
        let bank_rad = bank_rad.clamp(-demand.bank_rad, demand.bank_rad);
        let roll = ((bank_rad - self.bank_rad) / ROLL_S).clamp(-ROLL_RATE, ROLL_RATE);
        self.bank_rad += roll * dt_s;
        let turn = GRAVITY_MPS2 * self.bank_rad.tan() / self.airspeed_mps.max(SLOW_MPS);
        self.heading_rad += turn * dt_s;
        let faster = (demand.airspeed_mps - self.airspeed_mps) / SPEED_S;
        self.airspeed_mps += faster.clamp(-ACCEL_MPS2, ACCEL_MPS2) * dt_s;
        self.climb_mps += (demand.climb_mps - self.climb_mps) * (dt_s / CLIMB_S);
        let keep = (-dt_s / SLIP_S).exp();
        self.slip_mps = self.slip_mps.map(|slip| keep * slip);
        let (sin, cos) = self.heading_rad.sin_cos();
        // Along the nose the airspeed climbs too.
        let level = (self.airspeed_mps.powi(2) - self.climb_mps.powi(2))
            .max(0.0)
            .sqrt();
        let before = body.velocity_mps;
        body.velocity_mps = [
            level * sin + air_mps[0] + self.slip_mps[0],
            level * cos + air_mps[1] + self.slip_mps[1],
            self.climb_mps,
        ];
        for ((at, old), new) in body.at_m.iter_mut().zip(before).zip(body.velocity_mps) {
            *at += 0.5 * (old + new) * dt_s;
        }
    }

    /// Rolls on its wheels for a while, along its heading, towards a speed over the ground.
    pub(crate) fn roll(&mut self, body: &mut Body, ground_mps: f64, air_mps: [f64; 2], dt_s: f64) {
        let (sin, cos) = self.heading_rad.sin_cos();
        let speed = body.velocity_mps[0] * sin + body.velocity_mps[1] * cos;
        let most = ACCEL_MPS2 * dt_s;
        let new = speed + (ground_mps - speed).clamp(-most, most);
        body.velocity_mps = [new * sin, new * cos, 0.0];
        body.at_m[0] += 0.5 * (speed + new) * sin * dt_s;
        body.at_m[1] += 0.5 * (speed + new) * cos * dt_s;
        self.airspeed_mps = (new - air_mps[0] * sin - air_mps[1] * cos).max(0.0);
        (self.bank_rad, self.climb_mps, self.slip_mps) = (0.0, 0.0, [0.0; 2]);
    }

    /// The rate of climb, m/s.
    pub(crate) fn climb_mps(&self) -> f64 {
        self.climb_mps
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_steady_turn_has_the_radius_of_its_bank_and_drifts_with_the_wind() {
        for air_mps in [[0.0, 0.0], [4.0, -3.0]] {
            let mut body = Body {
                at_m: [0.0; 3],
                velocity_mps: [air_mps[0], 18.0 + air_mps[1], 0.0],
            };
            let mut wing = Wing::of(&body, 0.0, air_mps);
            let demand = Demand {
                across_mps2: 100.0,
                bank_rad: 0.5,
                climb_mps: 0.0,
                airspeed_mps: 18.0,
            };
            let dt_s = 0.01;
            for _ in 0..1000 {
                wing.step(&mut body, &demand, air_mps, dt_s);
            }
            // From here on, half a turn through the air, and what the wind adds.
            let radius_m = 18.0_f64.powi(2) / (GRAVITY_MPS2 * 0.5_f64.tan());
            let half_s = std::f64::consts::PI * radius_m / 18.0;
            let begin = (body.at_m, wing.heading_rad);
            let mut t_s = 0.0;
            while t_s < half_s {
                wing.step(&mut body, &demand, air_mps, dt_s);
                t_s += dt_s;
            }
            let gone = [0, 1].map(|axis| body.at_m[axis] - begin.0[axis] - air_mps[axis] * t_s);
            assert!((gone[0].hypot(gone[1]) - 2.0 * radius_m).abs() < 0.5);
            assert!((wing.heading_rad - begin.1 - std::f64::consts::PI).abs() < 0.01);
        }
    }
}

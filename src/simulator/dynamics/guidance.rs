//! Guidance of a wing onto legs and circles: the acceleration across its way.
//!
//! The L1 law of Park, Deyst and How (2004) as ArduPlane has it; PX4's NPFG is taken to be the
//! same law with its own period and damping.

use std::f64::consts::{FRAC_1_PI, FRAC_1_SQRT_2, FRAC_PI_2, PI, TAU};

use super::steering::Leg;
use crate::simulator::parameters::WingLimits;

/// Beyond the end of a leg the path leads back to it after this time, seconds.
const BEYOND_S: f64 = 3.0;

/// Where a wing is, and how it moves over the ground: east, north.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Motion {
    pub(crate) at_m: [f64; 2],
    pub(crate) velocity_mps: [f64; 2],
}

impl Motion {
    pub(crate) fn speed_mps(&self) -> f64 {
        self.velocity_mps[0].hypot(self.velocity_mps[1])
    }

    /// The distance ahead that is aimed at, metres.
    pub(crate) fn ahead_m(&self, limits: &WingLimits) -> f64 {
        (FRAC_1_PI * limits.damping * limits.period_s * self.speed_mps()).max(1.0)
    }

    /// The acceleration to the right that turns by an angle, m/s^2.
    fn turn(&self, angle_rad: f64, limits: &WingLimits) -> f64 {
        let gain = 4.0 * limits.damping * limits.damping;
        let speed = self.speed_mps();
        gain * speed * speed / self.ahead_m(limits) * angle_rad.clamp(-FRAC_PI_2, FRAC_PI_2).sin()
    }

    /// The same towards a point.
    fn towards(&self, to_m: [f64; 2], limits: &WingLimits) -> f64 {
        let course = |v: [f64; 2]| v[0].atan2(v[1]);
        let way = [to_m[0] - self.at_m[0], to_m[1] - self.at_m[1]];
        self.turn(wrapped(course(way) - course(self.velocity_mps)), limits)
    }

    /// Onto a leg and along it.
    pub(crate) fn along(&self, leg: &Leg, limits: &WingLimits) -> f64 {
        let [from, to] = [leg.from_m, leg.to_m].map(|point| [point[0], point[1]]);
        let length_m = leg.length_m();
        if leg.is_upright() {
            return self.towards(to, limits);
        }
        let unit = [0, 1].map(|axis| (to[axis] - from[axis]) / length_m);
        let gone = [0, 1].map(|axis| self.at_m[axis] - from[axis]);
        let ahead = |v: [f64; 2]| v[0] * unit[0] + v[1] * unit[1];
        let right = |v: [f64; 2]| v[0] * unit[1] - v[1] * unit[0];
        let far_m = gone[0].hypot(gone[1]);
        if far_m > self.ahead_m(limits) && ahead(gone) < -FRAC_1_SQRT_2 * far_m {
            return self.towards(from, limits);
        }
        if ahead(gone) > length_m + BEYOND_S * self.speed_mps() {
            return self.towards(to, limits);
        }
        let aside = (right(gone) / self.ahead_m(limits)).clamp(-FRAC_1_SQRT_2, FRAC_1_SQRT_2);
        let off_rad = right(self.velocity_mps).atan2(ahead(self.velocity_mps));
        self.turn(-(aside.asin() + off_rad), limits)
    }

    /// Onto a circle and around it, clockwise with a positive radius; and whether it circles
    /// already.
    pub(crate) fn around(
        &self,
        middle_m: [f64; 2],
        radius_m: f64,
        limits: &WingLimits,
    ) -> (f64, bool) {
        let side = radius_m.signum();
        let out = [0, 1].map(|axis| self.at_m[axis] - middle_m[axis]);
        let away_m = out[0].hypot(out[1]).max(0.1);
        let unit = out.map(|part| part / away_m);
        let outwards = self.velocity_mps[0] * unit[0] + self.velocity_mps[1] * unit[1];
        // Clockwise is to the right of the way outwards.
        let clockwise = self.velocity_mps[0] * unit[1] - self.velocity_mps[1] * unit[0];
        let tangent = clockwise * side;
        let error_m = away_m - radius_m.abs();
        let frequency = TAU / limits.period_s;
        let mut pull =
            error_m * frequency * frequency + outwards * 2.0 * limits.damping * frequency;
        if outwards > 0.0 && tangent < 0.0 {
            pull = pull.max(0.0);
        }
        let center = tangent * tangent / (0.5 * radius_m.abs()).max(radius_m.abs() + error_m);
        let circling = side * (pull + center);
        let capture = self.towards(middle_m, limits);
        if error_m > 0.0 && side * capture < side * circling {
            (capture, false)
        } else {
            (circling, true)
        }
    }
}

/// An angle between -pi and pi.
pub(crate) fn wrapped(angle_rad: f64) -> f64 {
    (angle_rad + PI).rem_euclid(TAU) - PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulator::dynamics::body::Body;
    use crate::simulator::dynamics::wing::{Demand, Wing};
    use crate::simulator::parameters::Settings;
    use crate::simulator::profile::Profile;
    use crate::spec::Airframe;

    const STEP_S: f64 = 0.05;

    /// Flies for a while from the origin northward in moving air; returns where it ends.
    fn flown(
        profile: Profile,
        air_mps: [f64; 2],
        seconds: f64,
        across: impl Fn(&Motion, &WingLimits) -> f64,
    ) -> [f64; 2] {
        let limits = Settings::of(profile, Airframe::Plane).wing();
        let mut body = Body {
            at_m: [0.0; 3],
            velocity_mps: [air_mps[0], 18.0 + air_mps[1], 0.0],
        };
        let mut wing = Wing::of(&body, 0.0, air_mps);
        let mut t_s = 0.0;
        while t_s < seconds {
            let motion = Motion {
                at_m: [body.at_m[0], body.at_m[1]],
                velocity_mps: [body.velocity_mps[0], body.velocity_mps[1]],
            };
            let demand = Demand {
                across_mps2: across(&motion, &limits),
                bank_rad: limits.bank_rad,
                climb_mps: 0.0,
                airspeed_mps: 18.0,
            };
            wing.step(&mut body, &demand, air_mps, STEP_S);
            t_s += STEP_S;
        }
        [body.at_m[0], body.at_m[1]]
    }

    #[test]
    fn a_leg_is_found_from_off_it_and_held_in_a_wind_from_anywhere() {
        for profile in [Profile::ArduPilot, Profile::Px4] {
            for air_mps in [[0.0, 0.0], [6.0, 0.0], [-4.0, 5.0], [0.0, -6.0]] {
                for cross_track_m in [-150.0, 40.0, 300.0] {
                    let leg = Leg {
                        from_m: [cross_track_m, -100.0, 0.0],
                        to_m: [cross_track_m, 5000.0, 0.0],
                    };
                    let at_m = flown(profile, air_mps, 90.0, |motion, limits| {
                        motion.along(&leg, limits)
                    });
                    assert!(
                        (at_m[0] - cross_track_m).abs() < 0.5,
                        "{profile:?} {air_mps:?}: {at_m:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_circle_is_found_and_held_to_either_side() {
        for profile in [Profile::ArduPilot, Profile::Px4] {
            for air_mps in [[0.0, 0.0], [5.0, 0.0]] {
                for radius_m in [100.0, -100.0] {
                    for seconds in [100.0, 107.0, 120.0] {
                        let middle_m = [50.0, 600.0];
                        let at_m = flown(profile, air_mps, seconds, |motion, limits| {
                            motion.around(middle_m, radius_m, limits).0
                        });
                        let away_m = (at_m[0] - middle_m[0]).hypot(at_m[1] - middle_m[1]);
                        assert!(
                            (away_m - 100.0).abs() < 8.0,
                            "{profile:?} {air_mps:?} {radius_m}: {away_m}"
                        );
                    }
                }
            }
        }
    }
}

//! The items of a mission as a wing flies them.

use super::{Circle, Following, Stay, Takeoff, Winged};
use crate::geodesy::{Amsl, true_airspeed_ratio};
use crate::mission::{Item, command};
use crate::simulator::dynamics::steering;
use crate::simulator::dynamics::steering::Leg;
use crate::simulator::mode::Mode;
use crate::simulator::parameters::{Passes, WingLimits};
use crate::simulator::pilot::mission::{milliseconds, place};
use crate::simulator::pilot::{Doing, Pilot};
use crate::simulator::profile::Profile;
use crate::spec::Airframe;

/// The line of a takeoff along a heading, metres.
const AHEAD_M: f64 = 10_000.0;

impl Pilot {
    /// Begins the item at `self.at`, and those after it that take no time.
    pub(in crate::simulator::pilot) fn begin_winged(&mut self, items: &[Item], from_m: [f64; 3]) {
        let after_takeoff = matches!(self.doing, Doing::OnWing(Winged::ClimbingOut(_)));
        while let Some(item) = items.get(self.at) {
            if let Some(doing) = self.winged(item, from_m, after_takeoff) {
                if let Doing::OnWing(Winged::Following(following)) = doing {
                    self.carry(Some(following.leg.to_m));
                }
                self.doing = doing;
                return;
            }
            self.act(item);
            self.pass_item();
        }
        self.at = items.len().saturating_sub(1);
        if !self.airborne {
            self.under_way = false;
            self.doing = Doing::Standing;
        } else if self.profile == Profile::ArduPilot {
            self.custom_mode = self.number(Mode::Return);
            self.enter_winged(Mode::Return);
        } else {
            self.enter_winged(Mode::Hold);
        }
    }

    /// What an item makes it do; none for one that takes no time.
    fn winged(&mut self, item: &Item, from_m: [f64; 3], after_takeoff: bool) -> Option<Doing> {
        let is_vtol = self.airframe == Airframe::Vtol;
        match item.command {
            command::NAV_TAKEOFF if !self.airborne && !is_vtol => self.takeoff(item),
            command::NAV_VTOL_TAKEOFF if !self.airborne && is_vtol => self
                .altitude_m(item, from_m)
                .map(|amsl_m| Doing::Rising { amsl_m }),
            command::NAV_DELAY if self.profile == Profile::Px4 && item.params[0] > 0.0 => {
                let until = self.clock + milliseconds(item.params[0]);
                Some(Doing::Waiting { until })
            }
            command::NAV_WAYPOINT if self.airborne => {
                let to_m = self.point_m(item, from_m)?;
                // PX4 makes no slope of the way from a takeoff.
                let at_once = after_takeoff && self.profile == Profile::Px4;
                let following = Following::new(Leg { from_m, to_m }, at_once);
                Some(Doing::OnWing(Winged::Following(following)))
            }
            command::NAV_LOITER_UNLIM | command::NAV_LOITER_TIME if self.airborne => {
                self.circling(item, from_m)
            }
            command::NAV_LAND if self.airborne && !is_vtol => {
                let to_m = self.point_m(item, from_m)?;
                self.carry(Some(to_m));
                let leg = Leg { from_m, to_m };
                Some(Doing::OnWing(Winged::Gliding { leg, flare: None }))
            }
            command::NAV_VTOL_LAND if self.airborne && is_vtol => {
                let [east, north, _] = self.point_m(item, from_m)?;
                let to_m = [east, north, from_m[2]];
                if self.wing.is_none() {
                    return Some(self.onto_rotors(to_m));
                }
                Some(Doing::OnWing(Winged::Following(Following {
                    descends: true,
                    ..Following::new(Leg { from_m, to_m }, true)
                })))
            }
            command::NAV_RETURN_TO_LAUNCH if self.airborne => {
                self.enter_winged(Mode::Return);
                Some(self.doing)
            }
            command::DO_CHANGE_SPEED => {
                let [kind, speed, ..] = item.params.map(f64::from);
                if kind.trunc().abs() < 0.5 && speed > 0.0 {
                    self.speed_mps = Some(speed);
                }
                None
            }
            _ => None,
        }
    }

    /// Circles around the place of an item, with its radius or that of the parameters.
    fn circling(&mut self, item: &Item, from_m: [f64; 3]) -> Option<Doing> {
        let to_m = self.point_m(item, from_m)?;
        let own_m = match (self.profile, item.command) {
            // It keeps the sign alone.
            (Profile::ArduPilot, command::NAV_LOITER_TIME) => 0.0,
            _ => f64::from(item.params[2]),
        };
        let is_timed = item.command == command::NAV_LOITER_TIME;
        self.carry(Some(to_m));
        Some(Doing::OnWing(Winged::Circling(Circle {
            leg: Leg { from_m, to_m },
            radius_m: if own_m.is_finite() && own_m.abs() > 0.0 {
                own_m
            } else {
                self.settings.wing().loiter_radius_m
            },
            lands: false,
            stay: is_timed.then(|| Stay::of(milliseconds(item.params[0]))),
        })))
    }

    /// ArduPlane runs where it points, PX4 towards the place of the item.
    fn takeoff(&mut self, item: &Item) -> Option<Doing> {
        let from_m = self.body.at_m;
        let to_m = match self.profile {
            Profile::Px4 => self.point_m(item, from_m)?,
            Profile::ArduPilot | Profile::Generic => {
                let (sin, cos) = self.surroundings.heading_rad.sin_cos();
                [
                    from_m[0] + AHEAD_M * sin,
                    from_m[1] + AHEAD_M * cos,
                    from_m[2],
                ]
            }
        };
        let amsl_m = self.altitude_m(item, from_m)?;
        let own_rad = f64::from(item.params[0]).to_radians();
        let is_stated = self.profile == Profile::ArduPilot && own_rad > 0.0;
        let takeoff = Takeoff {
            line: Leg { from_m, to_m },
            pitch_rad: if is_stated {
                own_rad
            } else {
                self.settings.wing().takeoff_pitch_rad
            },
            amsl_m,
        };
        Some(Doing::OnWing(Winged::Running(takeoff)))
    }

    /// Whether it turns to the next leg.
    pub(crate) fn is_passed(
        &self,
        following: &Following,
        at_m: [f64; 3],
        items: &[Item],
        limits: &WingLimits,
    ) -> bool {
        let leg = &following.leg;
        let away_m = steering::across_m(at_m, leg.to_m);
        let item = items.get(self.at);
        let own_m = item.map_or(0.0, |item| f64::from(item.params[1]));
        match limits.passes {
            Passes::Turning { radius_m } => {
                let ratio = true_airspeed_ratio(Amsl(at_m[2]));
                let quarter_m = (radius_m * ratio * ratio).min(self.motion(at_m).ahead_m(limits));
                let share = self.next_turn_deg(leg, items).min(90.0) / 90.0;
                let before_m = if own_m > 0.0 {
                    own_m
                } else {
                    quarter_m * share
                };
                away_m <= before_m || leg.left_m(at_m) <= 0.0
            }
            Passes::Within {
                height_m,
                landing_height_m,
                ..
            } => {
                let next = items.get(self.at + 1);
                let lands = next.is_some_and(|next| next.command == command::NAV_LAND);
                let height_m = if lands { landing_height_m } else { height_m };
                away_m <= self.accepted_m(limits).max(own_m)
                    && (at_m[2] - leg.to_m[2]).abs() <= height_m
            }
        }
    }

    /// PX4: this near a waypoint it is there, metres.
    pub(crate) fn accepted_m(&self, limits: &WingLimits) -> f64 {
        match limits.passes {
            Passes::Within {
                radius_m, speed_s, ..
            } => radius_m.max(speed_s * self.motion(self.body.at_m).speed_mps()),
            Passes::Turning { .. } => 0.0,
        }
    }

    /// The change of course at the end of a leg, degrees; a right angle where none is known.
    fn next_turn_deg(&self, leg: &Leg, items: &[Item]) -> f64 {
        let mut ahead = items.iter().skip(self.at + 1);
        let next = ahead.find_map(|item| place(item).and_then(|_| self.point_m(item, leg.to_m)));
        next.map_or(90.0, |next| {
            let half = steering::half_turn_rad(leg.from_m, leg.to_m, next);
            2.0 * half.to_degrees()
        })
    }
}

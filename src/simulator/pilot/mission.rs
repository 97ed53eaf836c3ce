//! The items of the mission on board, one after the other.

use super::payload::Placing;
use super::{Doing, Event, Hold, Pilot, REACHED_M};
use crate::geodesy::LatLon;
use crate::mission::{Item, command, frame};
use crate::simulator::dynamics::steering;
use crate::simulator::dynamics::steering::{Gate, Leg};
use crate::simulator::mode::Mode;
use crate::simulator::parameters::Limits;
use crate::simulator::profile::Profile;

/// Most corners that are looked ahead for.
const GATES: usize = 12;

impl Pilot {
    /// Begins the item at `self.at`, and those after it that take no time.
    ///
    /// A leg begins at the end of the one before it; without one, where the vehicle is.
    pub(crate) fn begin(&mut self, items: &[Item], from_m: Option<[f64; 3]>) {
        let here = self.sensed();
        let from_m = from_m.unwrap_or(here);
        if self.airframe.has_wing() {
            return self.begin_winged(items, from_m);
        }
        while let Some(item) = items.get(self.at) {
            let doing = match item.command {
                command::NAV_TAKEOFF if !self.airborne => self
                    .altitude_m(item, here)
                    .map(|amsl_m| Doing::Rising { amsl_m }),
                command::NAV_DELAY => (item.params[0] > 0.0).then(|| Doing::Waiting {
                    until: self.clock + milliseconds(item.params[0]),
                }),
                command::NAV_LAND if self.airborne => Some(self.to_landing(item, from_m)),
                command::NAV_RETURN_TO_LAUNCH if self.airborne => {
                    self.return_home(here);
                    return;
                }
                command::NAV_WAYPOINT | command::NAV_LOITER_TIME | command::NAV_LOITER_UNLIM
                    if self.airborne =>
                {
                    self.point_m(item, from_m).map(|to_m| Doing::Flying {
                        leg: Leg { from_m, to_m },
                        hold: stay(item),
                    })
                }
                command::NAV_PAYLOAD_PLACE
                    if self.airborne && self.profile == Profile::ArduPilot =>
                {
                    Some(self.to_placing(item, from_m))
                }
                command::DO_CHANGE_SPEED => {
                    let speed = f64::from(item.params[1]);
                    if speed > 0.0 {
                        self.speed_mps = Some(speed);
                    }
                    None
                }
                _ => None,
            };
            if let Some(doing) = doing {
                self.doing = doing;
                return;
            }
            self.act(item);
            self.pass_item();
        }
        // The mission is over. In the air, the vehicle stays where it came to.
        self.at = items.len().saturating_sub(1);
        self.doing = if self.airborne {
            let at_m = from_m;
            Doing::Holding { at_m, until: None }
        } else {
            self.under_way = false;
            Doing::Standing
        };
    }

    /// An item that took no time is done.
    pub(crate) fn pass_item(&mut self) {
        // ArduPilot reports every completed item, PX4 those with a location.
        if self.profile == Profile::ArduPilot {
            self.events.push(Event::Reached(self.at));
        }
        self.at += 1;
    }

    /// The item at work is done. Outside of a mission there is no next one.
    pub(crate) fn complete(&mut self, items: &[Item]) {
        let at_m = self.sensed();
        if self.mode() != Mode::Mission {
            self.doing = Doing::Holding { at_m, until: None };
            return;
        }
        let from_m = match self.doing {
            Doing::OnWing(winged) => winged.end_m(self.profile, at_m),
            Doing::Flying { leg, .. } => leg.to_m,
            Doing::Holding { at_m, .. } => at_m,
            Doing::Placing(placing) => placing.top_m,
            Doing::Rising { amsl_m } => [at_m[0], at_m[1], amsl_m],
            _ => at_m,
        };
        self.events.push(Event::Reached(self.at));
        self.at += 1;
        self.begin(items, Some(from_m));
    }

    /// The leg to where a landing goes down: at the altitude of the leg before.
    fn to_landing(&self, item: &Item, from_m: [f64; 3]) -> Doing {
        let leg = self.level_leg(item, from_m);
        if leg.is_upright() {
            Doing::Sinking { at_m: leg.to_m }
        } else {
            let hold = Hold::Land;
            Doing::Flying { leg, hold }
        }
    }

    /// The leg to where a load is placed, at the altitude of the leg before.
    fn to_placing(&self, item: &Item, from_m: [f64; 3]) -> Doing {
        let leg = self.level_leg(item, from_m);
        if leg.is_upright() {
            Doing::Placing(Placing::new(item, leg.to_m))
        } else {
            let hold = Hold::Place;
            Doing::Flying { leg, hold }
        }
    }

    /// The leg to the place of an item, at the present altitude.
    fn level_leg(&self, item: &Item, from_m: [f64; 3]) -> Leg {
        let to_m = match place(item) {
            Some(place) => {
                let to = self.frame.to_plan(place);
                [to.east_m, to.north_m, from_m[2]]
            }
            None => from_m,
        };
        Leg { from_m, to_m }
    }

    /// The velocity along a leg, with the corners and stops ahead in mind.
    pub(crate) fn along(
        &self,
        leg: Leg,
        hold: Hold,
        at_m: [f64; 3],
        items: &[Item],
        limits: &Limits,
    ) -> [f64; 3] {
        let speed_mps = self.speed_mps.unwrap_or(limits.speed_mps);
        let speed_mps = self.reachable_mps(leg, speed_mps);
        let gates = self.gates(leg, hold, at_m, items, limits);
        leg.velocity_mps(at_m, speed_mps, &gates, limits)
    }

    /// The corners and the stop ahead, as far as they matter.
    fn gates(
        &self,
        leg: Leg,
        hold: Hold,
        at_m: [f64; 3],
        items: &[Item],
        limits: &Limits,
    ) -> Vec<Gate> {
        let mut gates = Vec::new();
        let cruise_mps = self.speed_mps.unwrap_or(limits.speed_mps);
        let (mut leg, mut hold, mut index) = (leg, hold, self.at);
        let mut distance_m = leg.left_m(at_m);
        loop {
            let next = match hold {
                Hold::Pass => self.next_leg(index, leg.to_m, items),
                Hold::For(_) | Hold::Ever | Hold::Land | Hold::Place => None,
            };
            let Some((at, after, stays)) = next else {
                let speed_mps = 0.0;
                gates.push(Gate {
                    distance_m,
                    speed_mps,
                });
                return gates;
            };
            let half = steering::half_turn_rad(leg.from_m, leg.to_m, after.to_m);
            let speed_mps = if leg.is_upright() || after.is_upright() {
                0.0
            } else {
                steering::corner_mps(half, cruise_mps, limits)
            };
            gates.push(Gate {
                distance_m,
                speed_mps,
            });
            if gates.len() >= GATES || speed_mps <= 0.0 {
                return gates;
            }
            distance_m += after.length_m();
            (leg, hold, index) = (after, stays, at);
        }
    }

    /// The leg after one that ends at a point: its item, itself, and what is at its end.
    /// `None` when the vehicle comes to rest there.
    fn next_leg(
        &self,
        index: usize,
        from_m: [f64; 3],
        items: &[Item],
    ) -> Option<(usize, Leg, Hold)> {
        if self.mode() != Mode::Mission {
            return None;
        }
        let stops = self.profile.facts(self.airframe).stops;
        let over_ground = |item: &Item| frame::canonical(item.frame) == frame::GLOBAL_TERRAIN_ALT;
        let is_over_ground = items.get(index).is_some_and(over_ground);
        for (at, item) in items.iter().enumerate().skip(index + 1) {
            match item.command {
                command::NAV_WAYPOINT | command::NAV_LOITER_TIME | command::NAV_LOITER_UNLIM
                    if stops.between_altitude_kinds && over_ground(item) != is_over_ground =>
                {
                    return None;
                }
                command::NAV_WAYPOINT | command::NAV_LOITER_TIME | command::NAV_LOITER_UNLIM => {
                    let to_m = self.point_m(item, from_m)?;
                    return Some((at, Leg { from_m, to_m }, stay(item)));
                }
                command::NAV_LAND if stops.before_landing => return None,
                command::NAV_LAND => {
                    return match self.to_landing(item, from_m) {
                        Doing::Flying { leg, hold } => Some((at, leg, hold)),
                        _ => None,
                    };
                }
                command::NAV_DELAY | command::NAV_RETURN_TO_LAUNCH | command::NAV_PAYLOAD_PLACE => {
                    return None;
                }
                _ => {}
            }
        }
        None
    }

    /// Goes on at the end of a leg, or where its corner begins.
    pub(crate) fn arrive(
        &mut self,
        leg: Leg,
        hold: Hold,
        at_m: [f64; 3],
        items: &[Item],
        limits: &Limits,
    ) {
        let left_m = leg.left_m(at_m);
        let is_level = (at_m[2] - leg.to_m[2]).abs() < REACHED_M;
        let is_there = left_m < REACHED_M && is_level;
        match hold {
            Hold::Pass => {
                let next = self.next_leg(self.at, leg.to_m, items);
                let is_passed = match next {
                    Some((_, after, _)) if !leg.is_upright() && !after.is_upright() => {
                        let off_m = (at_m[2] - leg.to_m[2]).abs();
                        let is_level = limits.level_m.is_none_or(|level_m| off_m <= level_m);
                        left_m <= self.corner_m(leg, after, limits) && is_level
                    }
                    _ => is_there,
                };
                if is_passed {
                    self.complete(items);
                }
            }
            Hold::For(time) if is_there => {
                let until = Some(self.clock + time);
                let at_m = leg.to_m;
                self.doing = Doing::Holding { at_m, until };
            }
            Hold::Ever if is_there => {
                let at_m = leg.to_m;
                self.doing = Doing::Holding { at_m, until: None };
                if self.mode() == Mode::Mission {
                    self.events.push(Event::Reached(self.at));
                }
            }
            Hold::Land if is_there => self.doing = Doing::Sinking { at_m: leg.to_m },
            Hold::Place if is_there => self.place_payload(items, leg.to_m),
            Hold::For(_) | Hold::Ever | Hold::Land | Hold::Place => {}
        }
    }

    /// How far before a corner the vehicle turns to the next leg, metres: half of the way
    /// that it flies while the velocity changes from one to the other.
    fn corner_m(&self, leg: Leg, after: Leg, limits: &Limits) -> f64 {
        let [east, north, _] = self.body.velocity_mps;
        let speed = east.hypot(north);
        let half = steering::half_turn_rad(leg.from_m, leg.to_m, after.to_m);
        let level_m = speed * speed * half.sin() / limits.corner_accel_mps2;
        let kink_mps = (after.slope() - leg.slope()).abs() * speed;
        let upright_m = 0.5 * speed * kink_mps / limits.accel_z_mps2;
        let max_m = 0.5 * leg.length_m().min(after.length_m());
        level_m
            .max(upright_m)
            .max(REACHED_M)
            .min(max_m.max(REACHED_M))
    }

    /// An item's point: east, north, altitude.
    pub(crate) fn point_m(&self, item: &Item, before_m: [f64; 3]) -> Option<[f64; 3]> {
        let to = self.frame.to_plan(place(item)?);
        let at_m = [to.east_m, to.north_m, before_m[2]];
        let amsl_m = self.altitude_m(item, at_m)?;
        Some([to.east_m, to.north_m, amsl_m])
    }

    /// An item's altitude above the sea, over a place.
    pub(crate) fn altitude_m(&self, item: &Item, at_m: [f64; 3]) -> Option<f64> {
        let z_m = f64::from(item.z);
        match frame::canonical(item.frame) {
            frame::GLOBAL => Some(z_m),
            frame::GLOBAL_RELATIVE_ALT => Some(self.home_m + z_m),
            frame::GLOBAL_TERRAIN_ALT => Some(self.ground_m(at_m) + z_m),
            _ => None,
        }
    }
}

/// The place of an item; to an autopilot 0, 0 is none.
pub(crate) fn place(item: &Item) -> Option<LatLon> {
    if (item.x, item.y) == (0, 0) {
        return None;
    }
    item.place()
}

fn stay(item: &Item) -> Hold {
    match item.command {
        command::NAV_LOITER_UNLIM => Hold::Ever,
        _ if item.params[0] > 0.0 => Hold::For(milliseconds(item.params[0])),
        _ => Hold::Pass,
    }
}

pub(crate) fn milliseconds(seconds: f32) -> u64 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "`as` saturates, and a negative or absent time is none"
    )]
    let milliseconds = (f64::from(seconds) * 1000.0).round() as u64;
    milliseconds
}

//! How a flight comes to its end: on the ground, or where it stays in the air.

use super::arming::HEARTBEATS;
use super::height::Height;
use super::{FlightVehicle, Instruction, Stage};
use crate::flight::record::Fix;
use crate::flight::session::arrival;
use crate::flight::session::end::End;
use crate::flight::session::modes;
use crate::flight::session::orbit::Orbit;

/// A heartbeat that shows the motors to stand, and none after it for this long, is the last, milliseconds.
const SILENT_MS: u64 = 2500;

/// Motors that stop higher above the ground than this did not stop on it, metres: as for the verdict.
pub(super) const HIGH_M: f64 = 10.0;
/// Heartbeats in a row: one alone may be of another component, or wrong.
#[derive(Clone, Debug, Default)]
pub(crate) struct Motors {
    /// How high it is said to be.
    pub(super) height: Height,
    /// Height of its last position above the ground, metres, where the ground is known; above its home where its place is
    /// not known any more.
    pub(crate) agl_m: Option<f64>,
    /// Whether it was reported that it may be armed at the end.
    pub(crate) is_warned: bool,
    /// Whether it was reported that they must run for longer before it takes off.
    pub(crate) is_awaited: bool,
    /// Whether it was not heard since its flight was taken over; and whether its end was recorded before.
    pub(super) is_unheard: bool,
    pub(super) is_recorded: bool,
    stand: u8,
    pub(super) run: u8,
    /// Whether its flight ended because they stood, or were ordered to on the ground.
    pub(super) ended: bool,
    /// When the first heartbeat showed them to stand, seconds after T0.
    stood_s: Option<f64>,
    /// How high above the ground it was then, metres; and whether that was not known.
    stood_agl_m: Option<f64>,
    stood_unknown: bool,
    /// Since when it has rested on the ground, seconds after T0, and its altitude there, metres.
    pub(super) rests: Option<(f64, f64)>,
    /// Whether it was high above the ground.
    pub(super) was_high: bool,
    /// Since when it has been as low as the ground again, and hardly moves, seconds after T0, and its altitude there, metres.
    pub(super) low: Option<(f64, f64)>,
    /// Whether its motors ran on after that.
    pub(super) run_on: bool,
    /// What it is ordered to do if it is heard to fly after that.
    pub(super) if_airborne: Option<Instruction>,
    /// Positions since the first heartbeat that shows them to stand: of the flight if it goes on.
    since: Vec<Fix>,
}

impl FlightVehicle<'_> {
    /// Whether heartbeats show that its motors stand; one comes at a time in seconds after T0.
    pub(super) fn has_stopped(&mut self, is_armed: bool, t_s: f64) -> bool {
        let (stand, run) = (self.motors.stand, self.motors.run);
        (self.motors.stand, self.motors.run) = match is_armed {
            true => (0, run.saturating_add(1)),
            false => (stand.saturating_add(1), 0),
        };
        if stand == 0 && !is_armed {
            (self.motors.stood_s, self.motors.stood_agl_m) = (Some(t_s), self.motors.agl_m);
            self.motors.stood_unknown = self.is_of_unknown_height();
        }
        if is_armed {
            self.motors.height.take_armed();
            for fix in std::mem::take(&mut self.motors.since) {
                self.add_fix(fix);
            }
        }
        self.motors.stand >= HEARTBEATS
    }

    /// Takes a position into the record of its flight, unless its motors may stand by then.
    pub(super) fn record_fix(&mut self, fix: Fix) {
        let may_stand = matches!(self.stage, Stage::Flying) && self.motors.stand > 0;
        match may_stand {
            true => self.motors.since.push(fix),
            false => self.add_fix(fix),
        }
    }

    fn add_fix(&mut self, fix: Fix) {
        self.flown.fixes.push(fix);
        self.progress.take(&fix);
    }

    /// It stopped its motors: how its flight ended.
    pub(super) fn stopped(&mut self, custom_mode: u32) {
        let high_m = self.motors.stood_agl_m.filter(|agl_m| *agl_m > HIGH_M);
        let end = match (self.airborne, self.instruction) {
            (false, _) => End::Failed("stopped its motors before it took off".to_owned()),
            (true, _) if self.motors.stood_unknown && !self.motors.height.is_grounded() => {
                End::Failed(format!(
                    "stopped its motors; its height is not known since T0+{:.0} s",
                    self.motors.height.known_s
                ))
            }
            (true, _) if let Some(high_m) = high_m.filter(|_| !self.motors.stood_unknown) => {
                End::Failed(format!("stopped its motors {high_m:.0} m over the ground"))
            }
            (true, _) => self.on_ground(custom_mode),
        };
        self.end(end);
        self.flown.until_s = self.motors.stood_s;
        self.motors.ended = true;
    }

    /// Whether its height came before, and does not any more or is one of before.
    fn is_of_unknown_height(&self) -> bool {
        let was_high = self
            .motors
            .height
            .known_m
            .is_some_and(|agl_m| agl_m > HIGH_M);
        was_high && (self.motors.agl_m.is_none() || !self.is_positioned())
    }

    /// It stopped its motors on the ground: how its flight ended.
    fn on_ground(&self, custom_mode: u32) -> End {
        match (self.airborne, self.instruction) {
            (true, Some(Instruction::Hold)) if self.hold.was_in_mode() => End::StoppedAfterHold,
            (true, Some(Instruction::Land))
                if self.hold.was_in_mode() || modes::is_land(self.of.mission, custom_mode) =>
            {
                match self.hold.is_of_others {
                    true => self.landing(),
                    false => End::LandedEarly,
                }
            }
            (true, Some(Instruction::Return)) if self.hold.was_in_mode() => self.returned(),
            _ => self.landing(),
        }
    }

    /// Its time is over: in the air it is left to itself, on the ground its motors are stopped.
    pub(in crate::flight) fn give_up(&mut self, why: String, is_lost: bool) {
        let is_armed = self
            .heartbeat_now()
            .is_some_and(|heartbeat| heartbeat.is_armed());
        let was_started = matches!(self.stage, Stage::Armed | Stage::Starting | Stage::Flying);
        let is_down = !self.airborne || self.is_down();
        if was_started && is_armed && is_down && !is_lost {
            let what = match self.airborne {
                true => "its motors still ran on the ground",
                false => "has not taken off",
            };
            return self.disarm(Some(End::Failed(format!("{why}, and {what}"))));
        }
        self.watch_no_more(End::Failed(why), is_lost);
    }

    /// It stopped its motors by itself: where it should, or elsewhere.
    pub(crate) fn landing(&self) -> End {
        let reference = &self.of.reference;
        let away_m = self.latest.map_or(f64::INFINITY, |(_, fix)| {
            arrival::away_m(reference, fix.place)
        });
        let near_m = arrival::landing_m(self.of.mission.airframe);
        if reference.lands && away_m <= near_m {
            End::Landed
        } else {
            let of_place = self.motors.height.of_place();
            End::Failed(format!(
                "stopped its motors {away_m:.0} m from the end of its mission{of_place}"
            ))
        }
    }

    /// It stopped its motors after it was ordered to return: at home, at a rally point, or elsewhere.
    pub(crate) fn returned(&self) -> End {
        let near_m = arrival::landing_m(self.of.mission.airframe);
        let away_m = self.latest.map(|(_, fix)| self.away_from_returns_m(fix));
        let (home_m, rally_m) = away_m.unwrap_or((f64::INFINITY, f64::INFINITY));
        if home_m <= near_m {
            End::Returned
        } else if rally_m <= near_m {
            End::ReturnedToRally
        } else {
            let of_place = self.motors.height.of_place();
            End::Failed(format!(
                "stopped its motors {home_m:.0} m from its home{of_place}"
            ))
        }
    }

    /// How far it is over the ground from its home, and from the nearest rally point, metres.
    pub(super) fn away_from_returns_m(&self, fix: Fix) -> (f64, f64) {
        let frame = self.of.reference.frame();
        let at = frame.to_plan(fix.place);
        let home_m = self.of.mission.home_point(frame).at.distance_m(at);
        let rally = self.of.mission.rally_points(frame);
        let rally_m = rally.map(|place| place.distance_m(at));
        (home_m, rally_m.fold(f64::INFINITY, f64::min))
    }

    /// Whether it was ordered to land, and does so at the end of its mission.
    pub(crate) fn lands_as_planned(&self) -> bool {
        self.hold.lands_as_planned
    }

    /// Whether an order to land has it circle where it is: a plane without a landing in its mission.
    pub(crate) fn lands_by_circling(&self) -> bool {
        modes::land(self.of.mission).is_none() && !self.of.reference.lands
    }

    /// A plane comes down on the approach of its mission, the only one that was judged.
    pub(crate) fn land_by_mission(&mut self) {
        if self.of.reference.lands {
            self.news
                .push_back("lands as planned, at the end of its mission".to_owned());
            // Its last heartbeat may be older than the order to hold that this one comes after.
            let is_on_mission = self.in_mission && self.instruction.is_none();
            (self.instruction, self.holds) = (None, false);
            self.hold.lands_as_planned = true;
            match is_on_mission {
                true => self.command([]),
                false => self.command([modes::start(self.of.mission)]),
            }
        } else {
            self.news
                .push_back("has no landing in its mission: it circles where it is".to_owned());
            self.instruct(Instruction::Hold);
        }
    }

    /// Whether it stays at the end of its mission, or where it was ordered to.
    pub(in crate::flight) fn check_ending(&mut self, t_s: f64) {
        let Some((_, fix)) = self.latest else { return };
        let is_silent = self.now - self.heartbeat_at > SILENT_MS;
        if matches!(self.stage, Stage::Flying) && self.motors.stand > 0 && is_silent {
            let mode = self
                .heartbeat_now()
                .map_or(0, |heartbeat| heartbeat.custom_mode);
            return self.stopped(mode);
        }
        if !matches!(self.stage, Stage::Flying) || !self.airborne {
            return;
        }
        self.check_motors(fix);
        match self.instruction {
            Some(Instruction::Hold) => return self.check_hold(t_s, fix),
            Some(Instruction::Land | Instruction::Return) => {
                return self.check_landing_or_return(t_s, fix);
            }
            None => {}
        }
        // Another mission may have been given to it meanwhile.
        let rows = self.total.now.unwrap_or(self.of.mission.items.len());
        if self.of.reference.lands || !self.in_mission || self.item < rows {
            self.orbit = Orbit::default();
            (self.stay.loiters, self.stay.is_shown) = (false, false);
            return;
        }
        let has_wing = self.of.mission.airframe.has_wing();
        let (comes, is_off) = if has_wing {
            let at = self.of.reference.frame().to_plan(fix.place);
            let is_on = self.of.reference.is_on_circle(at);
            (self.has_circled(fix, is_on), !is_on)
        } else {
            let away_m = arrival::away_m(&self.of.reference, fix.place);
            let comes = arrival::hovers(&self.of.reference, &fix);
            (comes, away_m > arrival::LEFT_M)
        };
        match (self.stay.loiters, comes, is_off) {
            (false, true, _) => self.news.push_back(End::Loitering.sentence()),
            (true, _, true) => {
                let text = "does not stay at the end of its mission any more";
                self.news.push_back(text.to_owned());
            }
            _ => {}
        }
        self.stay.loiters = (self.stay.loiters || comes) && !is_off;
        self.stay.is_shown = self.stay.loiters && comes;
    }

    /// The flight of a vehicle that stays at the end of its mission is over when no other flies.
    pub(in crate::flight) fn end_loitering(&mut self) {
        self.say_what_was_dropped();
        self.flown.end = End::Loitering;
        self.stage = Stage::Ended;
    }

    /// A wing stays where it has flown a whole circle.
    pub(super) fn has_circled(&mut self, fix: Fix, circles: bool) -> bool {
        if !circles {
            self.orbit = Orbit::default();
            return false;
        }
        self.orbit
            .is_whole_with(self.of.reference.frame().to_plan(fix.place))
    }

    /// Ends its monitoring: with a hold if it holds, else with `other`.
    pub(in crate::flight) fn watch_no_more(&mut self, other: End, is_lost: bool) {
        match self.stage {
            Stage::Disarming(_) => return self.stop_disarming(),
            // It would take off, or stay armed, with nobody who watches.
            Stage::Armed => {
                let end = matches!(other, End::Failed(_)).then_some(other);
                return self.disarm(end);
            }
            _ => {}
        }
        let end = match (self.holds, is_lost) {
            (true, false) => End::Held,
            (true, true) => End::Failed("held, and was not heard of since".to_owned()),
            (false, false) if self.stay.loiters => return self.end_loitering(),
            (false, _) => match other {
                End::Failed(why) if self.misses_its_hold() => {
                    End::Failed(format!("{why}; hold not confirmed"))
                }
                other => other,
            },
        };
        self.end(end);
    }
}

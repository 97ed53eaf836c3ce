//! How a flight comes to its end: on the ground, or where it stays in the air.

use super::arming::BEATS;
use super::{AIRBORNE_M, FlightVehicle, Instruction, Stage};
use crate::flight::record::Fix;
use crate::flight::session::arrival;
use crate::flight::session::end::End;
use crate::flight::session::modes;
use crate::flight::session::orbit::Orbit;

/// A heartbeat that shows the motors to stand, and none after it for this long, is the last, milliseconds.
const SILENT_MS: u64 = 2500;

/// Heartbeats in a row: one alone may be of another component, or wrong.
#[derive(Clone, Debug, Default)]
pub(super) struct Motors {
    stand: u8,
    run: u8,
    /// Whether its flight ended because they stood.
    ended: bool,
    /// When the first heartbeat showed them to stand, seconds after T0.
    stood_s: Option<f64>,
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
            self.motors.stood_s = Some(t_s);
        }
        if is_armed {
            for fix in std::mem::take(&mut self.motors.since) {
                self.add_fix(fix);
            }
        }
        self.motors.stand >= BEATS
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
        let end = match (self.airborne, self.instruction) {
            (false, _) => End::Failed("stopped its motors before it took off".to_owned()),
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
            (true, _) => self.landing(),
        };
        self.end(end);
        self.flown.until_s = self.motors.stood_s;
        self.motors.ended = true;
    }

    /// Its motors were seen to stand, and it flies: it is watched again.
    pub(super) fn flies_on(&mut self) {
        let home_m = f64::from(self.of.mission.home.amsl_m);
        let is_up = |(_, fix): (f64, Fix)| fix.amsl.0 - home_m > AIRBORNE_M;
        if !self.motors.ended || self.motors.run < BEATS || !self.latest.is_some_and(is_up) {
            return;
        }
        self.said
            .push_back("its motors run, and it is in the air: it is watched again".to_owned());
        self.motors = Motors::default();
        (self.flown.end, self.flown.until_s) = (End::default(), None);
        self.airborne = true;
        self.stage = Stage::Flying;
    }

    /// Its time is over: in the air it is left to itself, on the ground its motors are stopped.
    pub(in crate::flight) fn give_up(&mut self, why: String, is_lost: bool) {
        let is_armed = self.heartbeat_now().is_some_and(|beat| beat.is_armed());
        let was_started = matches!(self.stage, Stage::Armed | Stage::Starting | Stage::Flying);
        if was_started && is_armed && !self.airborne && !is_lost {
            let why = format!("{why}, and has not taken off");
            return self.disarm(Some(End::Failed(why)));
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
            End::Failed(format!(
                "stopped its motors {away_m:.0} m from the end of its mission"
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
            End::Failed(format!("stopped its motors {home_m:.0} m from its home"))
        }
    }

    /// How far it is over the ground from its home, and from the nearest rally point, metres.
    pub(super) fn away_from_returns_m(&self, fix: Fix) -> (f64, f64) {
        let frame = self.of.reference.frame();
        let at = frame.to_plan(fix.place);
        let home = self.of.reference.waypoints.first();
        let home_m = home.map_or(f64::INFINITY, |home| home.point.at.distance_m(at));
        let rally = self.of.mission.rally_points(frame);
        let rally_m = rally.map(|place| place.distance_m(at));
        (home_m, rally_m.fold(f64::INFINITY, f64::min))
    }

    /// A plane comes down on the approach of its mission, the only one that was judged.
    pub(crate) fn land_by_mission(&mut self) {
        if self.of.reference.lands {
            self.said
                .push_back("lands as planned, at the end of its mission".to_owned());
            (self.instruction, self.holds) = (None, false);
            if !self.in_mission {
                self.command([modes::start(self.of.mission)]);
            }
        } else {
            self.said
                .push_back("has no landing in its mission: it circles where it is".to_owned());
            self.instruct(Instruction::Hold);
        }
    }

    /// Whether it stays at the end of its mission, or where it was ordered to.
    pub(in crate::flight) fn check_ending(&mut self, t_s: f64) {
        let Some((_, fix)) = self.latest else { return };
        let is_silent = self.now - self.beat_at > SILENT_MS;
        if matches!(self.stage, Stage::Flying) && self.motors.stand > 0 && is_silent {
            let mode = self.heartbeat_now().map_or(0, |beat| beat.custom_mode);
            return self.stopped(mode);
        }
        if !matches!(self.stage, Stage::Flying) || !self.airborne {
            return;
        }
        match self.instruction {
            Some(Instruction::Hold) => return self.check_hold(t_s, fix),
            Some(Instruction::Land | Instruction::Return) => {
                return self.check_landing_or_return(t_s, fix);
            }
            None => {}
        }
        // Another mission may have been given to it meanwhile.
        let rows = self.total.unwrap_or(self.of.mission.items.len());
        if self.of.reference.lands || !self.in_mission || self.item < rows {
            self.orbit = Orbit::default();
            return;
        }
        let stays = if self.of.mission.airframe.has_wing() {
            let at = self.of.reference.frame().to_plan(fix.place);
            self.has_circled(fix, self.of.reference.is_on_circle(at))
        } else {
            arrival::hovers(&self.of.reference, &fix)
        };
        if stays {
            self.end(End::Loitering);
        }
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
        if matches!(self.stage, Stage::Disarming(_)) {
            return self.stop_disarming();
        }
        let end = match (self.holds, is_lost) {
            (true, false) => End::Held,
            (true, true) => End::Failed("held, and was not heard of since".to_owned()),
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

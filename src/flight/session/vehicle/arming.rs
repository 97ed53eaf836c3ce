//! The motors of a vehicle on the ground. They run, or stand, when the heartbeat shows it: an
//! answer to a command only says that the command was taken.

use super::{FlightVehicle, Instruction, Stage};
use crate::autopilot::parameter;
use crate::flight::session::end::End;
use crate::flight::session::modes;
use crate::link::{FlightMessage, Heartbeat, Message, Time, as_line};

/// How long arming is tried, milliseconds: position estimates settle after a start.
pub(in crate::flight::session) const ARMING_MS: u64 = 20_000;
/// How long disarming is tried, milliseconds.
const DISARMING_MS: u64 = 20_000;
/// Between two tries, milliseconds.
const AGAIN_MS: u64 = 1000;
/// A heartbeat may have been under way when the command was answered: this many in a row count.
pub(super) const HEARTBEATS: u8 = 2;
/// A heartbeat is fresh for this long, milliseconds.
const FRESH_MS: f64 = 2000.0;
/// A clock that goes back by more was started again, milliseconds.
const RESTART_MS: u32 = 1000;
/// A vehicle runs for so much longer before it takes off than its control needs, seconds.
const SETTLED_S: f64 = 15.0;
/// Texts that are remembered while it is armed, at most.
const MAX_WARNINGS: usize = 5;

/// The attempt to arm a vehicle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arming {
    until: Time,
    /// When the next try begins.
    again: Time,
    /// Whether it is disarmed first.
    disarms: bool,
    /// Whether the vehicle accepted the command.
    accepted: bool,
    /// Heartbeats since then that show it disarmed.
    unarmed: u8,
}

/// The attempt to disarm a vehicle.
#[derive(Clone, Debug)]
pub(crate) struct Disarming {
    until: Time,
    again: Time,
    /// Heartbeats since the order: whether one showed it armed, and how many since show it
    /// disarmed.
    was_armed: bool,
    unarmed: u8,
    /// Its answer, if it refused.
    refusal: Option<String>,
    /// How its flight ends then; none where it was not to fly.
    end: Option<End>,
    /// What it is ordered to do if it takes off all the same.
    pub(super) if_airborne: Option<Instruction>,
}

/// When a vehicle was last seen disarmed: on the fleet's clock, and by its own, milliseconds.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeenDisarmed {
    flight_ms: f64,
    own_ms: Option<f64>,
}

impl FlightVehicle<'_> {
    pub(in crate::flight) fn arm(&mut self, now: Time) {
        self.begin_arming(now, false);
        self.command(modes::arm(self.of.mission));
    }

    /// Disarms it, and arms it again once a heartbeat shows it disarmed: so it counts the time until it
    /// disarms itself anew.
    pub(in crate::flight) fn arm_again(&mut self, now: Time) {
        self.begin_arming(now, true);
        self.command([modes::disarm()]);
    }

    fn begin_arming(&mut self, now: Time, disarms: bool) {
        self.stage = Stage::Arming;
        self.arming = Some(Arming {
            until: now + ARMING_MS,
            again: Time(u64::MAX),
            disarms,
            accepted: false,
            unarmed: 0,
        });
    }

    /// Whether it was ordered to arm.
    pub(in crate::flight) fn may_be_armed(&self) -> bool {
        self.arming.is_some() && !matches!(self.stage, Stage::Ended)
    }

    /// Whether its last heartbeat shows it armed, and is fresh.
    pub(in crate::flight) fn is_armed_now(&self, now: Time, speedup: f64) -> bool {
        #[expect(clippy::cast_precision_loss, reason = "milliseconds of one flight")]
        let age_ms = (now - self.heartbeat_at) as f64 * speedup.min(1.0);
        matches!(self.stage, Stage::Armed) && age_ms <= FRESH_MS
    }

    /// After how long on the ground it disarms itself, seconds; none: it does not. What it said counts,
    /// else the parameters of its plan, else the default.
    pub(in crate::flight) fn disarms_after_s(&self) -> Option<f64> {
        let row = self.of.mission.facts().disarms_after()?;
        let planned_s = self.of.mission.param_si(row.name);
        let after_s = self.disarm_s.or(planned_s).unwrap_or(row.default_si());
        (after_s > 0.0).then_some(after_s)
    }

    /// The name of the parameter that has it.
    pub(super) fn disarm_parameter(&self) -> Option<&'static str> {
        let row = self.of.mission.facts().disarms_after();
        row.map(|row| row.name)
    }

    /// Requests that parameter: a plan that departs at T0 has none of its own.
    pub(super) fn request_disarm_parameter(&mut self) {
        if let (Some(name), Some((target, _))) = (self.disarm_parameter(), self.vehicle) {
            let name = name.to_owned();
            let read = FlightMessage::ParamRead { target, name };
            self.outbox.push_back(Message::Flight(read));
        }
    }

    /// A vehicle whose clock goes back was started again: what was read of it before does not count.
    pub(super) fn heed_restart(&mut self, boot_ms: u32) {
        let goes_back = |(before_ms, _): (u32, f64)| boot_ms.saturating_add(RESTART_MS) < before_ms;
        let is_checked = matches!(
            self.stage,
            Stage::Checking { .. } | Stage::Ready | Stage::Arming | Stage::Armed
        );
        if is_checked && self.own_clock.is_some_and(goes_back) {
            let why = "was started again after its mission was read: run `sortie fly` again";
            self.stage = Stage::Refused(vec![why.to_owned()]);
        }
    }

    /// A vehicle that holds another number of items than when they were read is not started.
    pub(super) fn heed_total(&mut self, has_begun: bool) {
        let is_checked = matches!(self.stage, Stage::Ready | Stage::Arming | Stage::Armed);
        let read = self.of.mission.items.len();
        let why = match (self.total.now, self.total.ready) {
            _ if !is_checked => return,
            (Some(now), _) if now != read => format!(
                "its mission was changed on board after it was read: {now} items in place of {read}"
            ),
            // ArduPilot says 0 of no items, PX4 65535, which others say of any number.
            (None, Some(_)) => "its mission was cleared on board after it was read".to_owned(),
            (now, ready) => {
                self.total.ready = ready.or(now);
                return;
            }
        };
        match has_begun {
            true => self.disarm(Some(End::Failed(why))),
            false => self.stage = Stage::Refused(vec![why]),
        }
    }

    /// Its own clock at a time on the fleet's, milliseconds.
    fn own_ms(&self, flight_ms: f64) -> Option<f64> {
        let (boot_ms, heard_ms) = self.own_clock?;
        Some(f64::from(boot_ms) + (flight_ms - heard_ms).max(0.0))
    }

    /// How long it must still run before it may take off, seconds by its own clock: see
    /// [`crate::autopilot::Facts::rises_from_boot`].
    pub(in crate::flight) fn needs_more_s(&self, flight_ms: f64) -> Option<f64> {
        let mission = self.of.mission;
        let name = mission.facts().rises_from_boot?;
        let stock_mps = parameter(name).map_or(f64::INFINITY, |row| row.default_si());
        let climb_mps = mission
            .param_si(name)
            .map_or(stock_mps, |mps| mps.min(stock_mps));
        let needs_s = SETTLED_S + f64::from(mission.home.amsl_m) / climb_mps;
        let left_s = needs_s - self.own_ms(flight_ms)? / 1000.0;
        (left_s > 0.0).then_some(left_s)
    }

    /// For how long it may have been armed by its own clock, seconds: since it was last seen disarmed.
    pub(in crate::flight) fn armed_for_s(&self, flight_ms: f64) -> f64 {
        let Some(seen) = self.seen_disarmed else {
            return f64::INFINITY;
        };
        let own_ms = seen.own_ms.zip(self.own_ms(flight_ms));
        let own_ms = own_ms.map(|(from_ms, to_ms)| to_ms - from_ms);
        own_ms.unwrap_or(flight_ms - seen.flight_ms) / 1000.0
    }

    /// Whether it stays armed for a time, seconds by its own clock; half of the time that it has in
    /// all is enough. A vehicle that waits for its departure is set to stay armed.
    pub(in crate::flight) fn stays_armed(&self, flight_ms: f64, for_s: f64) -> bool {
        let armed_s = self.armed_for_s(flight_ms);
        let stays = |after_s: f64| armed_s <= after_s - for_s.min(0.5 * after_s);
        self.disarms_after_s().is_none_or(stays)
    }

    /// It accepted all commands that arm it.
    pub(super) fn accept_arming(&mut self) {
        match &mut self.arming {
            Some(arming) if arming.disarms => arming.again = self.now + AGAIN_MS,
            Some(arming) => (arming.accepted, arming.unarmed) = (true, 0),
            None => {}
        }
    }

    /// It did not arm: tries again within the window, or refuses it.
    pub(super) fn retry_arming(&mut self, what: &str) {
        match &mut self.arming {
            Some(arming) if self.now < arming.until => {
                (arming.accepted, arming.again) = (false, self.now + AGAIN_MS);
                self.stage = Stage::Arming;
            }
            _ => {
                let warnings = std::mem::take(&mut self.warnings);
                let why = std::iter::once(what.to_owned()).chain(warnings);
                self.stage = Stage::Refused(vec![why.collect::<Vec<_>>().join("; ")]);
            }
        }
    }

    /// Remembers a text that it sent while it was armed.
    pub(crate) fn warn(&mut self, text: &str) {
        let text = as_line(text);
        if !self.warnings.contains(&text) && self.warnings.len() < MAX_WARNINGS {
            self.warnings.push(text);
        }
    }

    /// Orders it to stop its motors on the ground, until its heartbeat shows it.
    pub(in crate::flight) fn disarm(&mut self, end: Option<End>) {
        self.stage = Stage::Disarming(Disarming {
            until: self.now + DISARMING_MS,
            again: self.now + AGAIN_MS,
            was_armed: false,
            unarmed: 0,
            refusal: None,
            end,
            if_airborne: None,
        });
        self.command([modes::disarm()]);
    }

    /// What a heartbeat shows of the motors on the ground.
    pub(super) fn heed_motors(&mut self, heartbeat: Heartbeat, flight_ms: f64, has_begun: bool) {
        let is_armed = heartbeat.is_armed();
        if !is_armed {
            let own_ms = self.own_ms(flight_ms);
            self.seen_disarmed = Some(SeenDisarmed { flight_ms, own_ms });
        }
        match &mut self.stage {
            Stage::Arming if self.arming.is_some_and(|of| of.disarms) => {
                if let Some(arming) = self.arming.as_mut().filter(|_| !is_armed) {
                    arming.disarms = false;
                    self.command(modes::arm(self.of.mission));
                }
            }
            Stage::Arming => {
                let Some(arming) = self.arming.as_mut().filter(|of| of.accepted) else {
                    return;
                };
                arming.unarmed += 1;
                if is_armed {
                    self.stage = Stage::Armed;
                } else if arming.unarmed >= HEARTBEATS {
                    self.retry_arming("accepted the command to arm, and is not armed");
                }
            }
            Stage::Armed if is_armed => {}
            Stage::Armed if has_begun => {
                self.end(End::Failed(
                    "stopped its motors before its mission was started".to_owned(),
                ));
            }
            Stage::Armed => {
                let what = "disarmed itself before all were armed";
                self.news.push_back(what.to_owned());
                self.retry_arming(what);
            }
            Stage::Disarming(disarming) => {
                if is_armed {
                    (disarming.was_armed, disarming.unarmed) = (true, 0);
                    return;
                }
                disarming.unarmed += 1;
                if disarming.unarmed >= HEARTBEATS {
                    let end = disarming.end.take();
                    self.news.push_back("is disarmed".to_owned());
                    self.finish_disarming(end);
                }
            }
            _ => {}
        }
    }

    /// It is in the air: one that refused its start flies all the same.
    pub(super) fn heed_takeoff(&mut self) {
        if let Stage::Disarming(Disarming {
            end: Some(end),
            if_airborne,
            ..
        }) = &self.stage
        {
            let instruction = *if_airborne;
            let text = format!("{}, and flies all the same", end.sentence());
            self.news.push_back(text);
            self.stage = Stage::Flying;
            self.command([]);
            if let Some(instruction) = instruction {
                self.instruct(instruction);
            }
        }
    }

    /// Gives the commands that are due to arm or to disarm it.
    pub(super) fn order_motors(&mut self) {
        let (now, is_idle) = (self.now, self.pending.is_none() && self.orders.is_empty());
        match &mut self.stage {
            Stage::Arming => {
                let due = self.arming.as_mut().filter(|of| is_idle && now >= of.again);
                if let Some(arming) = due {
                    arming.again = Time(u64::MAX);
                    match arming.disarms {
                        true => self.command([modes::disarm()]),
                        false => self.command(modes::arm(self.of.mission)),
                    }
                }
            }
            Stage::Disarming(disarming) if now >= disarming.until => self.stop_disarming(),
            Stage::Disarming(disarming) if is_idle && now >= disarming.again => {
                disarming.again = now + AGAIN_MS;
                self.command([modes::disarm()]);
            }
            _ => {}
        }
    }

    /// Remembers why it does not disarm.
    pub(super) fn refuse_to_disarm(&mut self, what: &str) {
        if let Stage::Disarming(disarming) = &mut self.stage {
            disarming.refusal = Some(what.to_owned());
        }
    }

    /// Disarming takes no more tries: what is known of the motors becomes its last line.
    pub(in crate::flight) fn stop_disarming(&mut self) {
        let Stage::Disarming(disarming) = &mut self.stage else {
            return;
        };
        let is_armed = self
            .vehicle
            .is_some_and(|(_, heartbeat)| heartbeat.is_armed());
        let (id, refusal) = (self.of.vehicle, disarming.refusal.take());
        let refusal = refusal.unwrap_or_else(|| "its heartbeat shows it".to_owned());
        let silence = "nothing was heard of it since it was ordered to disarm";
        let text = match (disarming.was_armed, is_armed) {
            (true, true) => format!("{id} IS STILL ARMED: {refusal}"),
            (_, true) => format!("{id} IS STILL ARMED by its last heartbeat: {silence}"),
            (_, false) => format!("{id} MAY BE ARMED: it was ordered to arm, {silence}"),
        };
        let end = disarming.end.take().map(|end| {
            let why = end.sentence();
            End::Failed(format!("{why}; {text}"))
        });
        self.still_armed = Some(text);
        self.finish_disarming(end);
    }

    fn finish_disarming(&mut self, end: Option<End>) {
        if let Stage::Disarming(disarming) = &self.stage {
            self.motors.if_airborne = disarming.if_airborne;
        }
        self.motors.ended = true;
        self.command([]);
        match end {
            Some(end) => self.end(end),
            None => self.stage = Stage::Ended,
        }
    }

    /// This program was stopped: what was waited for is waited for as long again.
    pub(in crate::flight) fn postpone(&mut self, now: Time, ms: u64) {
        self.now = now;
        self.heard = (self.heard + ms).min(self.now);
        self.heartbeat_at = (self.heartbeat_at + ms).min(self.now);
        if let Some(arming) = &mut self.arming {
            arming.until = arming.until + ms;
        }
        if let Stage::Disarming(disarming) = &mut self.stage {
            disarming.until = disarming.until + ms;
        }
    }
}

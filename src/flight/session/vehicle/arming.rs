//! The motors of a vehicle on the ground. They run, or stand, when the heartbeat shows it: an
//! answer to a command only says that the command was taken.

use super::{FlightVehicle, Stage};
use crate::flight::session::end::End;
use crate::flight::session::modes;
use crate::link::{Heartbeat, Time};

/// How long arming is tried, milliseconds: position estimates settle after a start.
pub(in crate::flight::session) const ARMING_MS: u64 = 20_000;
/// How long disarming is tried, milliseconds.
const DISARMING_MS: u64 = 20_000;
/// Between two tries, milliseconds.
const AGAIN_MS: u64 = 1000;
/// A heartbeat may have been under way when the command was answered: this many in a row count.
const BEATS: u8 = 2;
/// A heartbeat is fresh for this long, milliseconds.
const FRESH_MS: f64 = 2000.0;
/// Texts that are remembered while it is armed, at most.
const MAX_WARNINGS: usize = 5;

/// The attempt to arm a vehicle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arming {
    until: Time,
    /// When the next try begins.
    again: Time,
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
}

impl FlightVehicle<'_> {
    pub(in crate::flight) fn arm(&mut self, now: Time) {
        self.stage = Stage::Arming;
        self.arming = Some(Arming {
            until: now + ARMING_MS,
            again: Time(u64::MAX),
            accepted: false,
            unarmed: 0,
        });
        self.command(modes::arm(self.of.mission));
    }

    /// Whether it was ordered to arm.
    pub(in crate::flight) fn may_be_armed(&self) -> bool {
        self.arming.is_some() && !matches!(self.stage, Stage::Ended)
    }

    /// Whether its last heartbeat shows it armed, and is fresh.
    pub(in crate::flight) fn is_armed_now(&self, now: Time, speedup: f64) -> bool {
        #[expect(clippy::cast_precision_loss, reason = "milliseconds of one flight")]
        let age_ms = (now - self.beat_at) as f64 * speedup.min(1.0);
        matches!(self.stage, Stage::Armed) && age_ms <= FRESH_MS
    }

    /// It accepted all commands that arm it.
    pub(super) fn accept_arming(&mut self) {
        if let Some(arming) = &mut self.arming {
            (arming.accepted, arming.unarmed) = (true, 0);
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
                let said = std::mem::take(&mut self.warnings);
                let why = std::iter::once(what.to_owned()).chain(said);
                self.stage = Stage::Refused(vec![why.collect::<Vec<_>>().join("; ")]);
            }
        }
    }

    /// Remembers a text that it sent while it was armed.
    pub(crate) fn warn(&mut self, text: &str) {
        let is_known = self.warnings.iter().any(|known| known == text);
        if !is_known && self.warnings.len() < MAX_WARNINGS {
            self.warnings.push(text.to_owned());
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
        });
        self.command([modes::disarm()]);
    }

    /// What a heartbeat shows of the motors on the ground.
    pub(super) fn heed_motors(&mut self, beat: Heartbeat, has_begun: bool) {
        let is_armed = beat.is_armed();
        match &mut self.stage {
            Stage::Arming => {
                let Some(arming) = self.arming.as_mut().filter(|of| of.accepted) else {
                    return;
                };
                arming.unarmed += 1;
                if is_armed {
                    self.stage = Stage::Armed;
                } else if arming.unarmed >= BEATS {
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
                self.said.push_back(what.to_owned());
                self.retry_arming(what);
            }
            Stage::Disarming(disarming) => {
                if is_armed {
                    (disarming.was_armed, disarming.unarmed) = (true, 0);
                    return;
                }
                disarming.unarmed += 1;
                if disarming.unarmed >= BEATS {
                    let end = disarming.end.take();
                    self.said.push_back("is disarmed".to_owned());
                    self.finish_disarming(end);
                }
            }
            _ => {}
        }
    }

    /// It is in the air: one that refused its start flies all the same.
    pub(super) fn heed_takeoff(&mut self) {
        if let Stage::Disarming(Disarming { end: Some(end), .. }) = &self.stage {
            let text = format!("{}, and flies all the same", end.sentence());
            self.said.push_back(text);
            self.stage = Stage::Flying;
            self.command([]);
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
                    self.command(modes::arm(self.of.mission));
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
        let is_armed = self.vehicle.is_some_and(|(_, beat)| beat.is_armed());
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
        self.beat_at = (self.beat_at + ms).min(self.now);
        if let Some(arming) = &mut self.arming {
            arming.until = arming.until + ms;
        }
        if let Stage::Disarming(disarming) = &mut self.stage {
            disarming.until = disarming.until + ms;
        }
    }
}

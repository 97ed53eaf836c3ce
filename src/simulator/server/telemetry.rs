//! What the vehicle says of itself: heartbeat, home, position, mission.

use super::{HEALTH_MS, HEARTBEAT_MS, STATE_BOOT, Vehicle};
use crate::link::{
    FlightMessage, Heartbeat, MODE_ARMED, Message, MissionType, Position, STATE_ACTIVE,
    STATE_STANDBY, Time,
};
use crate::simulator::mode::Mode;
use crate::simulator::pilot::Event;
use crate::simulator::profile::Profile;
use crate::simulator::rules;

/// `MAV_MODE_FLAG`s: the mode is the autopilot's own; it stabilises; it flies by itself.
const CUSTOM_MODE_ENABLED: u8 = 1;
const AUTO_ENABLED: u8 = 4;
const GUIDED_ENABLED: u8 = 8;
const STABILIZE_ENABLED: u8 = 16;
/// How often PX4 says that an item was reached.
const PX4_REACHED: u8 = 10;

/// It has been running for this long, milliseconds.
const RUNS_SINCE_MS: u64 = 3_600_000;

impl Vehicle {
    /// What is said once a second.
    pub(crate) fn heartbeat_is_due(&mut self, now: Time) {
        let system_status = match (self.profile, self.is_armed()) {
            (Profile::Generic, _) => 0,
            _ if self.is_booting(now) => STATE_BOOT,
            (_, true) => STATE_ACTIVE,
            (_, false) => STATE_STANDBY,
        };
        self.outbox.push_back(Message::Heartbeat(Heartbeat {
            kind: self.profile.kind(self.airframe),
            autopilot: self.profile.autopilot(),
            base_mode: self.base_mode(),
            custom_mode: self.pilot.as_ref().map_or(0, |pilot| pilot.custom_mode),
            system_status,
        }));
        self.tell_current();
        // A generic one, as MAVSDK's mission server, says nothing about its place.
        if let Some(pilot) = &self.pilot {
            let landed = pilot.landed_state();
            self.tell_home();
            self.tell(FlightMessage::Landed(landed));
        }
    }

    /// What it reports of its own health, as often as ground stations ask for it, once one did.
    pub(crate) fn health_is_due(&mut self, now: Time) {
        #[expect(clippy::cast_precision_loss, reason = "milliseconds of one flight")]
        let since_s = (now - self.health_at) as f64 / 1000.0;
        self.faults.pass(since_s);
        (self.health_at, self.health_due) = (now, now + HEALTH_MS);
        if self.pilot.is_some() && self.reports_health {
            for report in self.faults.reports(self.profile) {
                self.tell(FlightMessage::Health(report));
            }
        }
    }

    fn base_mode(&self) -> u8 {
        let armed = if self.is_armed() { MODE_ARMED } else { 0 };
        let Some(pilot) = &self.pilot else {
            return armed;
        };
        let by_itself = match (self.profile, pilot.mode()) {
            (Profile::Px4, _) => AUTO_ENABLED | GUIDED_ENABLED,
            (_, Mode::Mission | Mode::Return) => GUIDED_ENABLED,
            _ => 0,
        };
        armed | by_itself | STABILIZE_ENABLED | CUSTOM_MODE_ENABLED
    }

    pub(crate) fn tell_current(&mut self) {
        let total = u16::try_from(self.items(MissionType::Mission).len()).unwrap_or(u16::MAX);
        let at = self.pilot.as_ref().map_or(0, |pilot| pilot.at());
        let seq = match self.pilot {
            Some(_) => self.seq(at),
            None => 0,
        };
        self.outbox.push_back(Message::MissionCurrent {
            seq,
            total,
            opaque_ids: MissionType::ALL.map(|list| self.opaque_id(list)),
        });
    }

    /// The sequence number of an item: ArduPilot counts home as 0.
    fn seq(&self, index: usize) -> u16 {
        let first = u16::from(self.profile == Profile::ArduPilot);
        u16::try_from(index)
            .unwrap_or(u16::MAX)
            .saturating_add(first)
    }

    pub(crate) fn tell_home(&mut self) {
        let Some(home) = self.home else { return };
        self.outbox.push_back(Message::HomePosition {
            x: home.x,
            y: home.y,
            amsl_mm: millimetres(f64::from(home.amsl_m)),
        });
    }

    /// Its time since it began to run, milliseconds.
    pub(crate) fn boot_ms(&self, now: Time) -> u32 {
        u32::try_from(RUNS_SINCE_MS + now.0).unwrap_or(u32::MAX)
    }

    pub(crate) fn tell_position(&mut self, now: Time) {
        let (Some(pilot), Some(home)) = (&self.pilot, self.home) else {
            return;
        };
        let (place, amsl_m, [east, north, up]) = pilot.position(self.faults.off_m);
        let mut position = Position {
            boot_ms: self.boot_ms(now),
            x: degrees(place.lat_deg),
            y: degrees(place.lon_deg),
            amsl_mm: millimetres(amsl_m),
            above_home_mm: millimetres(amsl_m - f64::from(home.amsl_m)),
            velocity_cmps: [north, east, -up].map(centimetres),
        };
        if self.faults.is_frozen {
            let frozen = *self.frozen.get_or_insert(position);
            position = Position {
                boot_ms: position.boot_ms,
                ..frozen
            };
        }
        self.tell(FlightMessage::Position(position));
    }

    /// What an autopilot says when it has taken a picture.
    fn tell_picture(&mut self, number: u32) {
        let Some(pilot) = &self.pilot else { return };
        let message = match self.profile {
            Profile::Px4 => FlightMessage::CameraTrigger { seq: number },
            Profile::ArduPilot | Profile::Generic => {
                let (place, amsl_m, _) = pilot.position(self.faults.off_m);
                #[expect(clippy::cast_possible_truncation, reason = "the message has float32")]
                FlightMessage::CameraFeedback {
                    index: u16::try_from(number).unwrap_or(u16::MAX),
                    x: degrees(place.lat_deg),
                    y: degrees(place.lon_deg),
                    amsl_m: amsl_m as f32,
                }
            }
        };
        self.tell(message);
    }

    /// Positions as often as they were asked for; on the ground once a second.
    pub(crate) fn position_interval_ms(&self) -> u64 {
        if self.is_armed() || self.position_ms == u64::MAX {
            self.position_ms
        } else {
            self.position_ms.max(HEARTBEAT_MS)
        }
    }

    /// What is due of positions, and of items that PX4 says again that it reached.
    pub(crate) fn position_is_due(&mut self, now: Time) {
        self.position_due = now + self.position_interval_ms().min(u64::MAX / 2);
        if self.position_ms != u64::MAX {
            self.tell_position(now);
        }
        if let Some((seq, left)) = &mut self.reached {
            let seq = *seq;
            *left -= 1;
            if *left == 0 {
                self.reached = None;
            }
            self.tell(FlightMessage::ItemReached { seq });
        }
    }

    /// Reports the events in flight since the last report.
    pub(crate) fn report(&mut self) {
        let events = self.pilot.as_mut().map_or_else(Vec::new, |p| p.events());
        let mut changed = false;
        for event in events {
            match event {
                Event::Says(text) => self.warn(text),
                Event::Picture(number) => self.tell_picture(number),
                Event::Reached(index) => {
                    let seq = self.seq(index);
                    self.tell(FlightMessage::ItemReached { seq });
                    if self.profile == Profile::Px4 {
                        self.reached = Some((seq, PX4_REACHED));
                    }
                    changed = true;
                }
            }
        }
        if changed {
            self.tell_current();
        }
    }

    pub(crate) fn opaque_id(&self, list: MissionType) -> u32 {
        match self.profile {
            Profile::Px4 => rules::opaque_id(self.rows(list)),
            Profile::ArduPilot | Profile::Generic => 0,
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "`as` saturates, two thousand kilometres up"
)]
fn millimetres(metres: f64) -> i32 {
    (metres * 1000.0).round() as i32
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "a latitude or longitude is within 1.8e9"
)]
fn degrees(degrees: f64) -> i32 {
    (degrees * 1e7).round() as i32
}

#[expect(clippy::cast_possible_truncation, reason = "`as` saturates at 327 m/s")]
fn centimetres(metres: f64) -> i16 {
    (metres * 100.0).round() as i16
}

//! A flight out of a capture of its links (`.tlog`).

use std::collections::BTreeMap;

use super::{Fix, Flight, Flown, Plan, Record};
use crate::flight::itinerary::stops::Itinerary;
use crate::flight::session::arrival;
use crate::flight::session::clock::Offset;
use crate::flight::session::end::End;
use crate::link::{Decoder, FlightMessage, Heartbeat, Message, Position};
use crate::spec::{Airframe, Autopilot};

/// Bytes of the time before each frame.
const STAMP: usize = 8;
/// Lengths of a frame besides its payload: MAVLink 1, MAVLink 2, and a signature.
const FRAME_1: usize = 8;
const FRAME_2: usize = 12;
const SIGNATURE: usize = 13;
/// What is known of a vehicle whose messages are in a capture.
#[derive(Clone, Debug, PartialEq)]
pub struct Capture {
    /// Id in the spec.
    pub vehicle: String,
    /// Its system id.
    pub sysid: u8,
    /// Who flies it.
    pub autopilot: Autopilot,
    /// What it is.
    pub airframe: Airframe,
    /// What it was to fly.
    pub plan: Plan,
}

/// The flight of one vehicle so far.
struct Reading {
    capture: Capture,
    offset: Offset,
    item: usize,
    items: usize,
    armed: bool,
    flown: Flown,
}

/// Reads the flight of some vehicles. T0 is when the first of them is armed; times are those
/// of the vehicles' own clocks, which must go as fast as that of the capture.
///
/// # Errors
/// A sentence: what has no frame at all is no capture, and a capture without an armed vehicle
/// is no flight.
pub fn read_tlog(bytes: &[u8], captures: &[Capture]) -> Result<Record, String> {
    let of = |capture: &Capture| {
        let reading = Reading {
            capture: capture.clone(),
            offset: Offset::default(),
            item: 0,
            items: 0,
            armed: false,
            flown: Flown::default(),
        };
        (capture.sysid, reading)
    };
    let mut readings: BTreeMap<u8, Reading> = captures.iter().map(of).collect();
    let mut t0_us: Option<u64> = None;
    let mut decoder = Decoder::default();
    let mut rest = bytes;
    let mut frames = 0_usize;
    while let Some((at_us, frame, after)) = next_frame(rest) {
        rest = after;
        frames += 1;
        decoder.push(frame);
        while let Some((from, message)) = decoder.next_message() {
            let Some(reading) = readings.get_mut(&from.system) else {
                continue;
            };
            // A companion computer may have positions of its own.
            if from.component != 1 {
                continue;
            }
            if let Message::Heartbeat(heartbeat) = &message {
                if heartbeat.is_armed() {
                    t0_us.get_or_insert(at_us);
                }
                reading.heartbeat(*heartbeat, milliseconds(at_us, t0_us.unwrap_or(at_us)));
            }
            if let Some(t0_us) = t0_us {
                reading.take(milliseconds(at_us, t0_us), &message);
            }
        }
    }
    if frames == 0 {
        return Err("holds no frame: not a .tlog".to_owned());
    }
    let t0_us = t0_us.ok_or("no vehicle of the spec is armed in it: nothing was flown")?;
    let flights = captures.iter().filter_map(|capture| {
        let reading = readings.remove(&capture.sysid)?;
        Some(reading.flight())
    });
    Ok(Record {
        t0_unix_s: t0_us / 1_000_000,
        speedup: 1.0,
        flights: flights.collect(),
        ..Record::default()
    })
}

/// The next frame with its time, and what comes after it; bytes that begin none are passed over.
fn next_frame(mut bytes: &[u8]) -> Option<(u64, &[u8], &[u8])> {
    loop {
        let stamp: [u8; STAMP] = bytes.get(..STAMP)?.try_into().ok()?;
        let frame = &bytes[STAMP..];
        let length = match frame.first()? {
            0xFE => FRAME_1 + usize::from(*frame.get(1)?),
            0xFD => {
                let signed = frame.get(2)? & 1 == 1;
                FRAME_2 + usize::from(*frame.get(1)?) + if signed { SIGNATURE } else { 0 }
            }
            _ => {
                bytes = &bytes[1..];
                continue;
            }
        };
        let (frame, after) = frame.split_at_checked(length)?;
        return Some((u64::from_be_bytes(stamp), frame, after));
    }
}

fn milliseconds(at_us: u64, t0_us: u64) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "microseconds of one flight")]
    let since_us = at_us.saturating_sub(t0_us) as f64;
    since_us / 1000.0
}

impl Reading {
    fn heartbeat(&mut self, heartbeat: Heartbeat, at_ms: f64) {
        let was_armed = std::mem::replace(&mut self.armed, heartbeat.is_armed());
        if self.armed {
            self.flown.since_s.get_or_insert(at_ms / 1000.0);
        }
        if self.armed || was_armed {
            self.flown.until_s = Some(at_ms / 1000.0);
        }
    }

    fn row(&self, seq: u16) -> usize {
        usize::from(seq) + usize::from(self.capture.autopilot.first_row())
    }

    /// Takes in a message, some milliseconds after T0.
    fn take(&mut self, at_ms: f64, message: &Message) {
        match message {
            Message::MissionCurrent { seq, total, .. } => {
                self.item = self.row(*seq);
                let is_known = (1..u16::MAX).contains(total);
                self.items = if is_known { usize::from(*total) } else { 0 };
            }
            Message::Flight(FlightMessage::ItemReached { seq }) if self.armed => {
                let row = self.row(*seq);
                self.flown.reach(row, at_ms / 1000.0);
            }
            Message::Flight(FlightMessage::Position(position)) if self.armed => {
                self.position(at_ms, position);
            }
            _ => {}
        }
    }

    fn position(&mut self, at_ms: f64, position: &Position) {
        if !position.is_known() {
            return;
        }
        let aligned = self.offset.align(f64::from(position.boot_ms), at_ms);
        let Some(aligned) = aligned else { return };
        let fix = Fix {
            t_s: aligned.at_ms / 1000.0,
            place: position.place(),
            amsl: position.amsl(),
            speed_mps: position.ground_speed_mps(),
            item: self.item,
            items: self.items,
            boot_ms: Some(position.boot_ms),
        };
        let fixes = &mut self.flown.fixes;
        let is_later = fixes.last().is_none_or(|last| fix.t_s > last.t_s);
        if is_later && fix.t_s >= 0.0 {
            fixes.push(fix);
        }
    }

    /// The flight, and how it ended: motors off is landed, at the end of the plan or elsewhere.
    fn flight(mut self) -> Flight {
        let reference = &self.capture.plan.reference;
        let (airframe, fixes) = (self.capture.airframe, &self.flown.fixes);
        let last = fixes.last();
        let away_m = last.map_or(f64::INFINITY, |fix| arrival::away_m(reference, fix.place));
        let stays = !reference.lands && arrival::stays(reference, airframe, fixes);
        self.flown.end = match (last.is_some(), self.armed) {
            (false, _) => End::NotFlown,
            (true, false) if reference.lands && away_m <= arrival::landing_m(airframe) => {
                End::Landed
            }
            (true, false) => End::Failed(format!(
                "stopped its motors {away_m:.0} m from the end of its mission"
            )),
            (true, true) if stays => End::Loitering,
            (true, true) => End::LeftFlying,
        };
        Flight {
            vehicle: self.capture.vehicle,
            plans: vec![self.capture.plan],
            flown: self.flown,
            itinerary: Itinerary::default(),
        }
    }
}

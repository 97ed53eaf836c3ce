//! A record made of its lines again.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;

use super::invalid_line;
use super::lines::{FixLine, Line, place};
use super::{Fix, Flight, RaisedAlarm, Record};
use crate::flight::itinerary::stops::Itinerary;
use crate::flight::session::end::End;
use crate::geodesy::{Amsl, LocalFrame};
use crate::spec::Action;

/// How much faster than the clock simulated vehicles may fly.
pub const SPEEDUP: RangeInclusive<f64> = 0.1..=100.0;
/// A threat is recorded so soon after the last position at the latest, on the wall's clock, seconds.
const AHEAD_S: f64 = 10.0;

/// A line that says nothing, or what cannot be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {why}")]
pub struct Broken {
    /// From 1.
    pub line: usize,
    /// What is wrong.
    pub why: String,
}

/// Reads a record; `frame` is that of the spec.
///
/// # Errors
/// [`Broken`], with the first line that is none of a record: also a second line of what
/// can stand once, and a line after the end of a vehicle's flight. A last line that was cut
/// off is left out: so does a flight end whose computer stopped. A position that is none on
/// earth counts for nothing.
pub fn read_record(text: &str, frame: LocalFrame) -> Result<Record, Broken> {
    let mut reading = Reading {
        frame,
        record: Record {
            speedup: 1.0,
            ..Record::default()
        },
        indices: BTreeMap::new(),
        once: BTreeSet::new(),
        fleet: None,
        latest_s: 0.0,
    };
    let count = text.lines().count();
    for (index, text) in text.lines().enumerate() {
        if text.trim().is_empty() {
            continue;
        }
        let broken = |why: String| Broken {
            line: index + 1,
            why,
        };
        match serde_json::from_str::<Line>(text) {
            Ok(line) => reading.take(line).map_err(broken)?,
            Err(_) if index + 1 == count && count > 1 && invalid_line::is_cut_off(text) => {}
            Err(_) => return Err(broken(invalid_line::why(text))),
        }
    }
    if reading.record.flights.is_empty() {
        let why = "no position of any vehicle".to_owned();
        return Err(Broken { line: 1, why });
    }
    Ok(reading.record)
}

fn end_of(vehicle: &str) -> String {
    format!("the end of {vehicle}")
}

struct Reading {
    frame: LocalFrame,
    record: Record,
    indices: BTreeMap<String, usize>,
    /// Lines that can stand once: the header, T0, the end of each vehicle.
    once: BTreeSet<String>,
    /// The latest position so far, seconds after T0.
    latest_s: f64,
    /// Who flies, by the header.
    fleet: Option<BTreeSet<String>>,
}

impl Reading {
    fn of(&mut self, vehicle: &str) -> &mut Flight {
        let flights = &mut self.record.flights;
        let index = *self.indices.entry(vehicle.to_owned()).or_insert_with(|| {
            flights.push(Flight {
                vehicle: vehicle.to_owned(),
                plans: Vec::new(),
                flown: crate::flight::Flown::default(),
                itinerary: Itinerary::default(),
            });
            flights.len() - 1
        });
        &mut flights[index]
    }

    /// Rejects a second line of these.
    fn once(&mut self, what: String) -> Result<(), String> {
        if self.once.contains(&what) {
            return Err(format!("{what} was recorded before"));
        }
        self.once.insert(what);
        Ok(())
    }

    /// Rejects a line of a stranger, and one before T0 or after the end of its vehicle.
    fn check(&self, t_s: f64, vehicle: &str) -> Result<(), String> {
        let is_stranger = |fleet: &BTreeSet<String>| !fleet.contains(vehicle);
        if self.fleet.as_ref().is_some_and(is_stranger) {
            return Err(format!(
                "{vehicle} is none of the vehicles of the first line"
            ));
        }
        if self.once.contains(&end_of(vehicle)) {
            return Err(format!("comes after the end of {vehicle}"));
        }
        if t_s < 0.0 {
            return Err(format!("{t_s} s is before T0"));
        }
        Ok(())
    }

    fn header(&mut self, speedup: f64, vehicles: Vec<String>) -> Result<(), String> {
        if !SPEEDUP.contains(&speedup) {
            let (least, most) = (SPEEDUP.start(), SPEEDUP.end());
            return Err(format!("`speedup` {speedup} (allowed: {least} to {most})"));
        }
        self.record.speedup = speedup;
        for vehicle in &vehicles {
            self.of(vehicle);
        }
        let count = vehicles.len();
        let fleet: BTreeSet<String> = vehicles.into_iter().collect();
        if fleet.len() < count {
            return Err("a vehicle is in the header twice".to_owned());
        }
        self.fleet = Some(fleet);
        Ok(())
    }

    /// A position that is none on earth says nothing, and is a gap: vehicles send such.
    fn fix(&mut self, line: &FixLine) -> Result<(), String> {
        let Ok(place) = place(line.lat_deg, line.lon_deg) else {
            return Ok(());
        };
        let fix = Fix {
            t_s: line.t_s,
            place,
            amsl: Amsl(line.amsl_m),
            speed_mps: line.speed_mps,
            item: line.item,
            items: line.items,
            boot_ms: line.boot_ms,
        };
        let fixes = &mut self.of(&line.vehicle).flown.fixes;
        if fixes.last().is_some_and(|last| last.t_s >= fix.t_s) {
            return Err(format!("{} is not later than the line before", line.t_s));
        }
        fixes.push(fix);
        self.latest_s = self.latest_s.max(fix.t_s);
        Ok(())
    }

    fn itinerary(&mut self, vehicle: &str, itinerary: Itinerary) -> Result<(), String> {
        self.check(0.0, vehicle)?;
        if let Some(problem) = itinerary.problem() {
            return Err(problem);
        }
        self.once(format!("the itinerary of {vehicle}"))?;
        self.of(vehicle).itinerary = itinerary;
        Ok(())
    }

    fn stop(&mut self, t_s: f64, stopped_s: f64) -> Result<(), String> {
        if t_s < 0.0 || !(0.0..=t_s.max(0.0)).contains(&stopped_s) {
            return Err(format!("a stop of {stopped_s} s until {t_s} s cannot be"));
        }
        self.record.stops.push((t_s - stopped_s, t_s));
        Ok(())
    }

    fn alarm(&mut self, line: Line) {
        if let Line::Alarm {
            t_s,
            vehicle,
            other,
            alarm: kind,
            raised,
            event: text,
        } = line
        {
            let until_s = None;
            let of = RaisedAlarm {
                t_s,
                until_s,
                vehicle,
                other,
                kind,
                text,
            };
            self.record.take_alarm(of, raised);
        }
    }

    fn order(&mut self, t_s: f64, vehicle: &str, order: Action) -> Result<(), String> {
        self.check(t_s, vehicle)?;
        let flown = &mut self.of(vehicle).flown;
        flown.take_order(order, t_s);
        Ok(())
    }

    fn take(&mut self, line: Line) -> Result<(), String> {
        match line {
            Line::Head {
                spec_sha256,
                speedup,
                vehicles,
                ..
            } => {
                self.once("the header".to_owned())?;
                self.record.spec_sha256 = spec_sha256;
                self.header(speedup, vehicles)?;
            }
            Line::Start { t0_unix_s } => {
                self.once("T0".to_owned())?;
                self.record.t0_unix_s = t0_unix_s;
            }
            Line::Plan { t_s, vehicle, plan } => {
                self.check(t_s, &vehicle)?;
                let plan = plan.plan(self.frame, t_s)?;
                self.of(&vehicle).plans.push(plan);
            }
            Line::Itinerary { vehicle, itinerary } => self.itinerary(&vehicle, itinerary)?,
            Line::Threat { t_s, threat } => {
                let mut popup = threat.popup(t_s)?;
                // A record is written as things happen: no threat comes up long after the
                // positions before it, to count for none of those behind it.
                let until_s = self.latest_s + AHEAD_S * self.record.speedup.max(1.0);
                popup.from_s = popup.from_s.min(until_s);
                self.record.popups.push(popup);
            }
            Line::Fix(line) => {
                self.check(line.t_s, &line.vehicle)?;
                self.fix(&line)?;
            }
            Line::Reached {
                t_s,
                vehicle,
                reached,
            } => {
                self.check(t_s, &vehicle)?;
                self.of(&vehicle).flown.reached.push((reached, t_s));
            }
            Line::Stop { t_s, stopped_s } => self.stop(t_s, stopped_s)?,
            Line::Order {
                t_s,
                vehicle,
                order,
            } => self.order(t_s, &vehicle, order)?,
            Line::End { vehicle, end, t_s } => {
                self.check(t_s.unwrap_or(0.0), &vehicle)?;
                self.once(end_of(&vehicle))?;
                let flown = &mut self.of(&vehicle).flown;
                (flown.end, flown.until_s) = (End::of_words(&end), t_s);
            }
            Line::Alarm { .. } => self.alarm(line),
            Line::Event { .. } => {}
        }
        Ok(())
    }
}

//! Where every vehicle of a fleet in flight is, for the screen.

use super::end::End;
use super::monitor::silence_s;
use super::vehicle::{FlightVehicle, Instruction, Stage};
use super::{Fleet, modes};
use crate::flight::record::Fix;
use crate::link::Time;
use crate::spec::AlarmKind;

/// Where one vehicle is, for a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Status {
    /// Id in the spec.
    pub vehicle: String,
    /// What it is doing.
    pub stage: &'static str,
    /// Row it flies to, and the last one.
    pub item: (usize, usize),
    /// Seconds behind the plan; negative ahead. None when it is on no leg of it.
    pub behind_s: Option<f64>,
    /// The nearest other vehicle in the air and its distance, metres.
    pub closest: Option<(String, f64)>,
    /// Since when nothing was heard of it, seconds, if it is lost.
    pub lost_s: Option<f64>,
    /// Share of the planned flight, 0 to 1.
    pub progress: f64,
    /// The flight mode by its name in the autopilot; none before the first heartbeat.
    pub mode: Option<String>,
    /// Whether its heartbeat shows it armed.
    pub is_armed: bool,
    /// `GPS_FIX_TYPE`, if it says so.
    pub gps_fix: Option<u8>,
    /// Percent of its battery left, if it says so.
    pub battery_percent: Option<i8>,
    /// Altitude above mean sea level, metres.
    pub amsl_m: Option<f64>,
    /// Age of its position, seconds of flight.
    pub age_s: Option<f64>,
    /// Stops and tasks that it was seen to do, and all of them.
    pub done: (usize, usize),
    /// The alarms that stand.
    pub alarms: Vec<AlarmKind>,
}

impl Fleet<'_> {
    /// What a vehicle reports of itself; nothing of its plan.
    fn instruments(&self, index: usize, now: Time) -> Status {
        let vehicle = &self.vehicles[index];
        let heartbeat = vehicle.heartbeat_now();
        let reported = self.alarms.as_ref().map(|alarms| alarms.reported(index));
        let (battery_percent, gps_fix) = reported.unwrap_or_default();
        let age_s = vehicle
            .latest
            .map(|(at_ms, _)| (self.flight_ms(now) - at_ms) / 1000.0);
        Status {
            vehicle: String::new(),
            stage: "",
            item: (0, 0),
            behind_s: None,
            closest: None,
            lost_s: None,
            progress: 0.0,
            mode: heartbeat.map(|heartbeat| modes::name(vehicle.of.mission, heartbeat.custom_mode)),
            is_armed: heartbeat.is_some_and(|heartbeat| heartbeat.is_armed()),
            gps_fix,
            battery_percent,
            amsl_m: vehicle.latest.map(|(_, fix)| fix.amsl.0),
            age_s: age_s.map(|age_s| age_s.max(0.0)),
            done: vehicle.progress.done_of(),
            alarms: self
                .alarms
                .as_ref()
                .map_or_else(Vec::new, |a| a.standing_of(index)),
        }
    }

    /// Where every vehicle is.
    #[must_use]
    pub fn status(&self, now: Time) -> Vec<Status> {
        let t_s = self.t_s(now).unwrap_or(0.0);
        let fixes: Vec<Option<Fix>> = self
            .vehicles
            .iter()
            .map(|vehicle| {
                let flies = matches!(vehicle.stage, Stage::Flying);
                vehicle.latest.map(|(_, fix)| fix).filter(|_| flies)
            })
            .collect();
        let distance_m = |a: &Fix, b: &Fix| a.place.chord_m(b.place).hypot(a.amsl.0 - b.amsl.0);
        let rows = self.vehicles.iter().enumerate();
        rows.map(|(index, vehicle)| {
            let others = fixes
                .iter()
                .enumerate()
                .filter(|(other, _)| *other != index);
            let closest = fixes[index].and_then(|here| {
                others
                    .filter_map(|(other, fix)| Some((other, distance_m(&here, fix.as_ref()?))))
                    .min_by(|a, b| a.1.total_cmp(&b.1))
            });
            let reference = &vehicle.of.reference;
            let behind_s = fixes[index].and_then(|fix| reference.planned_s(&fix));
            Status {
                vehicle: vehicle.of.vehicle.to_owned(),
                stage: stage_word(vehicle),
                item: (vehicle.item, vehicle.of.mission.items.len()),
                behind_s: behind_s.map(|planned_s| t_s - planned_s),
                closest: closest.map(|(other, m)| (self.vehicles[other].of.vehicle.to_owned(), m)),
                lost_s: silence_s(vehicle, now, self.options.speedup).filter(|_| self.lost[index]),
                progress: (behind_s.unwrap_or(0.0) / reference.end_s.max(1.0)).clamp(0.0, 1.0),
                ..self.instruments(index, now)
            }
        })
        .collect()
    }
}

fn stage_word(vehicle: &FlightVehicle<'_>) -> &'static str {
    match (&vehicle.stage, vehicle.instruction) {
        (Stage::Sending(_), _) => "receives",
        (Stage::Reading(_) | Stage::Checking { .. }, _) => "is checked",
        (Stage::Ready, _) => "ready",
        (Stage::Refused(_), _) => "not ready",
        (Stage::Arming, _) => "arms",
        (Stage::Armed, _) => "armed",
        (Stage::Disarming(_), _) => "disarms",
        (Stage::Rejoining { .. }, _) => "is awaited",
        (Stage::Starting, _) => "starts",
        (Stage::Flying, Some(Instruction::Hold)) if vehicle.misses_its_hold() => "no hold yet",
        (Stage::Flying, Some(Instruction::Hold)) if vehicle.of.mission.airframe.has_wing() => {
            "circles"
        }
        (Stage::Flying, Some(Instruction::Hold)) if vehicle.holds => "holds",
        (Stage::Flying, Some(Instruction::Hold)) => "stops",
        (Stage::Flying, Some(Instruction::Land)) if vehicle.misses_its_landing() => "not landing",
        (Stage::Flying, Some(Instruction::Return)) if vehicle.misses_its_order() => "no return yet",
        (Stage::Flying, Some(Instruction::Land)) => "lands",
        (Stage::Flying, Some(Instruction::Return)) => "returns",
        (Stage::Flying, None) if vehicle.stay.loiters => "loiters",
        (Stage::Flying, None) if vehicle.in_mission => "flies",
        (Stage::Flying, None) => "off mission",
        (Stage::Ended, _) => match vehicle.flown.end {
            End::Landed | End::LandedEarly | End::Returned | End::ReturnedToRally => "landed",
            End::Loitering => "loiters",
            End::Held => "holds",
            End::StoppedAfterHold => "stopped",
            End::LeftFlying => "left",
            End::NotFlown => "not flown",
            End::Failed(_) => "failed",
        },
    }
}

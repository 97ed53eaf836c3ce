//! `flight.json`.

use schemars::JsonSchema;
use serde::Serialize;

use super::conformance::report::{
    ErrorPercentiles, FlightReport, MadeStop, Passage, VehicleReport,
};
use super::itinerary::state::{Served, ServiceState};
use super::itinerary::stops::ServiceKind;
use super::record::{RaisedAlarm, Record};
use crate::report::{MarginEntry, review_json};
use crate::spec::AlarmKind;
use crate::verify::Review;

/// How well a flight went: `flight.json`.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FlightDocument {
    /// Version of Sortie.
    pub sortie: &'static str,
    /// SHA-256 of the spec file, hexadecimal.
    pub spec_sha256: String,
    /// `pass` when every limit was kept in flight and every vehicle ended as planned.
    pub verdict: &'static str,
    /// Seconds since 1970 at T0.
    pub t0_unix_s: u64,
    /// How much faster than the wall's clock the vehicles' time went.
    pub speedup: f64,
    /// Stops of vehicles, if they have any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stops: Option<DoneCount>,
    /// Tasks as each vehicle has its part in them, if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tasks: Option<DoneCount>,
    /// In the order of the spec.
    pub vehicles: Vec<FlownVehicle>,
    /// The limits, as in `review.json`.
    pub margins: Vec<MarginEntry>,
    /// Alarms in flight, in order of time.
    pub alarms: Vec<AlarmEntry>,
}

/// How many stops or tasks were seen done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct DoneCount {
    /// Those that were seen done.
    pub done: usize,
    /// All of them.
    pub of: usize,
}

/// An alarm of `flight.json`.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct AlarmEntry {
    /// When it was raised, seconds after T0.
    pub t_s: f64,
    /// When it was over; null for one that was not.
    pub until_s: Option<f64>,
    /// Id in the spec.
    pub vehicle: String,
    /// The other vehicle of a separation; null for other alarms.
    pub other: Option<String>,
    /// What it is about, as in `on_alarm`.
    pub alarm: AlarmKind,
    /// In words.
    pub text: String,
}

/// One vehicle of `flight.json`.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FlownVehicle {
    /// Name in the spec.
    pub id: String,
    /// How its flight ended.
    pub end: String,
    /// Positions recorded.
    pub fixes: usize,
    /// Beside the planned legs, metres.
    pub cross_track_m: Option<SpreadEntry>,
    /// Over or under them, without sign, metres.
    pub altitude_error_m: Option<SpreadEntry>,
    /// Later than planned at the waypoints, without sign, seconds.
    pub time_error_s: Option<SpreadEntry>,
    /// Each waypoint that was passed.
    pub waypoints: Vec<PassageEntry>,
    /// Each stop of its own, if it has any.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub stops: Vec<StopEntry>,
    /// Each task that it does, if it does any.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tasks: Vec<TaskEntry>,
}

/// A stop of the spec, and when the vehicle was nearest to it.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct StopEntry {
    /// Name in the spec.
    pub id: String,
    /// Seconds after T0.
    pub flown_s: f64,
    /// How near it came, metres.
    pub distance_m: f64,
    /// What was seen of it; absent where the record does not have the stops of the plan.
    #[serde(flatten)]
    pub seen: Option<SeenEntry>,
}

/// A task of the spec, and what was seen of it.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TaskEntry {
    /// Name in the spec.
    pub id: String,
    /// `visit`, `delivery`, `area`, `corridor` or `search`.
    pub kind: ServiceKind,
    /// What was seen of it.
    #[serde(flatten)]
    pub seen: SeenEntry,
}

/// What was seen of a stop or a task.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SeenEntry {
    /// `done`, `left` or `missed`: it went on without being seen to do it.
    pub state: &'static str,
    /// When it came to rest there, or passed it, seconds after T0; null where it was not seen to.
    pub from_s: Option<f64>,
    /// When it was done, seconds after T0; null where it was not seen done.
    pub until_s: Option<f64>,
}

/// Median, 95 % and worst.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct SpreadEntry {
    /// As in [`ErrorPercentiles`].
    pub median: f64,
    /// As in [`ErrorPercentiles`].
    pub p95: f64,
    /// As in [`ErrorPercentiles`].
    pub worst: f64,
}

/// A waypoint that was passed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PassageEntry {
    /// Row of the `.waypoints` file.
    pub item: usize,
    /// Seconds after T0 as planned.
    pub planned_s: f64,
    /// Seconds after T0 as flown.
    pub flown_s: f64,
    /// Seconds later than planned; negative earlier.
    pub late_s: f64,
    /// How near it came, metres.
    pub distance_m: f64,
}

/// The document of a flight that was judged by its record.
#[must_use]
pub fn flight_json(record: &Record, report: &FlightReport) -> FlightDocument {
    let margins = Review {
        margins: report.margins.clone(),
        tracks: Vec::new(),
        assumptions: Vec::new(),
    };
    FlightDocument {
        sortie: env!("CARGO_PKG_VERSION"),
        spec_sha256: record.spec_sha256.clone(),
        verdict: if report.passes() { "pass" } else { "fail" },
        t0_unix_s: record.t0_unix_s,
        speedup: record.speedup,
        stops: done_count(report, true),
        tasks: done_count(report, false),
        vehicles: report.vehicles.iter().map(vehicle).collect(),
        margins: review_json(&margins, None).margins,
        alarms: record.alarms.iter().map(alarm).collect(),
    }
}

fn alarm(of: &RaisedAlarm) -> AlarmEntry {
    AlarmEntry {
        t_s: rounded(of.t_s),
        until_s: of.until_s.map(rounded),
        vehicle: of.vehicle.clone(),
        other: of.other.clone(),
        alarm: of.kind,
        text: of.text.clone(),
    }
}

fn vehicle(report: &VehicleReport) -> FlownVehicle {
    let late = report.late_s().map(f64::abs);
    FlownVehicle {
        id: report.vehicle.clone(),
        end: report.end.clone(),
        fixes: report.fixes,
        cross_track_m: report.cross_track_m.map(spread),
        altitude_error_m: report.altitude_error_m.map(spread),
        time_error_s: ErrorPercentiles::of(late.collect()).map(spread),
        waypoints: report.passages.iter().map(passage).collect(),
        stops: report
            .stops
            .iter()
            .map(|of| stop(of, &report.served))
            .collect(),
        tasks: tasks(&report.served),
    }
}

fn done_count(report: &FlightReport, are_stops: bool) -> Option<DoneCount> {
    let served = report.vehicles.iter().flat_map(|of| &of.served);
    let own = served.filter(|of| (of.kind == ServiceKind::Stop) == are_stops);
    let of = own.clone().count();
    let done = own.filter(|of| of.state == ServiceState::Done).count();
    (of > 0).then_some(DoneCount { done, of })
}

fn tasks(served: &[Served]) -> Vec<TaskEntry> {
    let tasks = served.iter().filter(|of| of.kind != ServiceKind::Stop);
    let task = |of: &Served| TaskEntry {
        id: of.id.clone(),
        kind: of.kind,
        seen: seen(of),
    };
    tasks.map(task).collect()
}

fn seen(of: &Served) -> SeenEntry {
    SeenEntry {
        state: of.state.word(),
        from_s: of.from_s.map(rounded),
        until_s: of.until_s.map(rounded),
    }
}

fn stop(of: &MadeStop, served: &[Served]) -> StopEntry {
    let mut stops = served.iter().filter(|of| of.kind == ServiceKind::Stop);
    let found = stops.find(|served| served.id == of.id);
    StopEntry {
        id: of.id.clone(),
        flown_s: rounded(of.flown_s),
        distance_m: rounded(of.distance_m),
        seen: found.map(seen),
    }
}

fn spread(of: ErrorPercentiles) -> SpreadEntry {
    SpreadEntry {
        median: rounded(of.median),
        p95: rounded(of.p95),
        worst: rounded(of.worst),
    }
}

fn passage(of: &Passage) -> PassageEntry {
    PassageEntry {
        item: of.item,
        planned_s: rounded(of.planned_s),
        flown_s: rounded(of.flown_s),
        late_s: rounded(of.late_s()),
        distance_m: rounded(of.distance_m),
    }
}

/// To thousandths: millimetres and milliseconds.
pub(super) fn rounded(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}

//! The stops of a vehicle in the order in which it makes them, and what they are for.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::geodesy::LatLon;

/// The action that puts a load down on the ground.
const PAYLOAD_PLACE: &str = "payload_place";

/// The stops of a vehicle and what they are for.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Itinerary {
    /// In the order in which they are made.
    pub stops: Vec<ItineraryStop>,
    /// Stops of its own, and tasks, in the order in which they begin.
    pub services: Vec<Service>,
}

/// A stop on the path of a vehicle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ItineraryStop {
    /// Name in the spec, or of a part of a task.
    pub id: String,
    /// Degrees north, WGS84.
    pub lat_deg: f64,
    /// Degrees east, WGS84.
    pub lon_deg: f64,
    /// How long the vehicle stays there, seconds; 0 where it flies past.
    pub rest_s: f64,
    /// How near a copter must come, metres; none where that is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub near_m: Option<f64>,
    /// What it does there, by the keys of the spec.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub actions: Vec<String>,
}

impl ItineraryStop {
    /// Whether a load is put down on the ground there.
    pub(super) fn puts_down(&self) -> bool {
        self.actions.iter().any(|action| action == PAYLOAD_PLACE)
    }
}

/// A stop of its own or a task, and the stops that are made for it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Service {
    /// Name in the spec.
    pub id: String,
    /// Which.
    pub kind: ServiceKind,
    /// Indices of its stops, ascending.
    pub stops: Vec<usize>,
}

/// What a service is: a stop of the vehicle, or a kind of task.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ServiceKind {
    /// A stop of its own.
    Stop,
    /// A task with one place.
    Visit,
    /// A task that picks up at one place and drops at another.
    Delivery,
    /// Lines over an area.
    Area,
    /// Lines along a strip.
    Corridor,
    /// A search pattern.
    Search,
}

impl ServiceKind {
    /// As in documents.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Stop => "stop",
            Self::Visit => "visit",
            Self::Delivery => "delivery",
            Self::Area => "area",
            Self::Corridor => "corridor",
            Self::Search => "search",
        }
    }

    /// What one of this name is called.
    pub(super) fn label(self, id: &str) -> String {
        match self {
            Self::Stop => format!("stop {id}"),
            kind => format!("task {id} ({})", kind.word()),
        }
    }
}

impl Service {
    /// What it is called in messages.
    #[must_use]
    pub fn label(&self) -> String {
        self.kind.label(&self.id)
    }
}

impl Itinerary {
    /// What cannot be in it, in words; none where all can.
    pub(crate) fn problem(&self) -> Option<String> {
        let is_place = |stop: &ItineraryStop| LatLon::new(stop.lat_deg, stop.lon_deg).is_ok();
        if let Some(stop) = self.stops.iter().find(|stop| !is_place(stop)) {
            return Some(format!("the stop {} is at no place on earth", stop.id));
        }
        let count = self.stops.len();
        let is_known = |of: &&Service| !of.stops.is_empty() && of.stops.iter().all(|s| *s < count);
        let unknown = self.services.iter().find(|of| !is_known(of));
        unknown.map(|of| format!("{} is for stops that are not there", of.label()))
    }

    /// The place of each stop.
    pub(crate) fn sites(&self) -> Vec<LatLon> {
        let place = |stop: &ItineraryStop| LatLon {
            lat_deg: stop.lat_deg,
            lon_deg: stop.lon_deg,
        };
        self.stops.iter().map(place).collect()
    }
}

/// How many stops and how many tasks, in words: `2 stops, 1 task`; `-` without any.
#[must_use]
pub fn count_words(services: &[Service]) -> String {
    let stops = services.iter().filter(|of| of.kind == ServiceKind::Stop);
    let stops = stops.count();
    let of = |count: usize, one: &str| {
        let plural = if count == 1 { "" } else { "s" };
        (count > 0).then(|| format!("{count} {one}{plural}"))
    };
    let parts = [of(stops, "stop"), of(services.len() - stops, "task")];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    match parts.is_empty() {
        true => "-".to_owned(),
        false => parts.join(", "),
    }
}

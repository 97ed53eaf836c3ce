//! What was seen of the services of a vehicle.

use super::stops::{Itinerary, Service, ServiceKind};

/// Whether a service was seen done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ServiceState {
    /// It was seen done.
    Done,
    /// It is ahead, or under way.
    Left,
    /// The vehicle went on without being seen to do it.
    Missed,
}

/// A service, and what was seen of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Served {
    /// Name in the spec.
    pub id: String,
    /// Which.
    pub kind: ServiceKind,
    /// Whether it was seen done.
    pub state: ServiceState,
    /// When the vehicle came to rest at its first stop, or passed it, seconds after T0.
    pub from_s: Option<f64>,
    /// When it was done, seconds after T0.
    pub until_s: Option<f64>,
}

/// What was seen of one stop, seconds after T0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Seen {
    pub(crate) begun_s: Option<f64>,
    pub(crate) done_s: Option<f64>,
    pub(crate) is_missed: bool,
}

impl ServiceState {
    /// As in documents.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Left => "left",
            Self::Missed => "missed",
        }
    }
}

impl Served {
    /// What it is called in messages and on pages.
    #[must_use]
    pub fn label(&self) -> String {
        self.kind.label(&self.id)
    }

    /// By what was seen of each stop of the itinerary.
    pub(crate) fn of(service: &Service, seen: &[Seen]) -> Self {
        let own = service.stops.iter().filter_map(|stop| seen.get(*stop));
        let done_s: Vec<f64> = own.clone().filter_map(|stop| stop.done_s).collect();
        let begun = own.clone().filter_map(|stop| stop.begun_s);
        let is_done = done_s.len() == service.stops.len();
        Self {
            id: service.id.clone(),
            kind: service.kind,
            state: match own.clone().any(|stop| stop.is_missed) {
                true => ServiceState::Missed,
                false if is_done => ServiceState::Done,
                false => ServiceState::Left,
            },
            from_s: begun.reduce(f64::min),
            until_s: done_s.into_iter().reduce(f64::max).filter(|_| is_done),
        }
    }
}

/// How many services were seen done, of how many, in words: `2 of 4 stops, 1 of 1 tasks`; empty
/// without any.
#[must_use]
pub fn done_words(served: &[Served]) -> String {
    let of = |is_stop: bool, name: &str| {
        let own = served
            .iter()
            .filter(|of| (of.kind == ServiceKind::Stop) == is_stop);
        let all = own.clone().count();
        let done = own.filter(|of| of.state == ServiceState::Done).count();
        (all > 0).then(|| format!("{done} of {all} {name}"))
    };
    let parts: Vec<String> = [of(true, "stops"), of(false, "tasks")]
        .into_iter()
        .flatten()
        .collect();
    parts.join(", ")
}

impl Itinerary {
    /// Its services by what was seen of each stop.
    pub(crate) fn served(&self, seen: &[Seen]) -> Vec<Served> {
        let services = self.services.iter();
        services.map(|service| Served::of(service, seen)).collect()
    }
}

//! The last look at all lists: a list that was verified may have changed while the next ones were
//! transferred.

use super::{ORDER, Session, Stage};
use crate::link::codec::Version;
use crate::link::message::{
    AUTOPILOT_GENERIC, Address, Body, Heartbeat, MissionMessage, MissionResult, MissionType, Route,
};
use crate::link::time::Time;
use crate::link::transfer::discovery::Discovery;
use crate::link::transfer::download::Download;
use crate::link::transfer::report::{Failure, Verdict};
use crate::link::transfer::state_machine::Task;

/// Items that are requested at once of a vehicle that gives them in any order.
const WINDOW: usize = 8;
/// Messages that overtake each other are not this far apart, milliseconds.
const OVERTAKES_MS: u32 = 2000;

/// Another station that writes to the vehicle: the first that was overheard, and its list (none
/// for all lists at once).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Foreign(pub(super) Option<(u8, Option<MissionType>)>);

/// The time since boot of the vehicle, milliseconds, as far as it reports it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Boot(u32);

impl Boot {
    /// Takes in a time since boot. Whether the vehicle was started again since the last one.
    pub(super) fn is_restart(&mut self, boot_ms: u32) -> bool {
        let before_ms = std::mem::replace(&mut self.0, boot_ms);
        boot_ms.saturating_add(OVERTAKES_MS) < before_ms
    }
}

impl Session<'_> {
    /// The index of the first list that is transferred. MAVLink 1 knows missions alone.
    pub(super) fn first_list(&self) -> usize {
        match self.version {
            Version::One => ORDER.len() - 1,
            Version::Two => 0,
        }
    }

    /// The vehicle was started again and may have lost what it confirmed.
    pub(super) fn restarted(&mut self, now: Time) {
        if let Some(vehicle) = self.vehicle
            && !matches!(self.stage, Stage::Discovery(_))
        {
            self.stage = Stage::Discovery(Discovery::again(vehicle, now));
        }
    }

    /// Notes another station that writes to the vehicle: what it sends to the vehicle, or what
    /// the vehicle confirms to it.
    pub(super) fn look_for_foreign(&mut self, from: Address, message: &MissionMessage) {
        let Some((vehicle, _)) = self.vehicle else {
            return;
        };
        if matches!(self.stage, Stage::Discovery(_)) || self.foreign.0.is_some() {
            return;
        }
        let station = match message.body {
            Body::Count { .. } | Body::Item { .. } | Body::ItemInt { .. } | Body::ClearAll => from,
            Body::Ack {
                result: MissionResult::ACCEPTED,
                ..
            } if from == vehicle => message.target,
            _ => return,
        };
        if message.is_of_stranger(station, (from, vehicle), self.us) {
            self.foreign = Foreign(Some((
                station.system,
                MissionType::of(message.mission_type),
            )));
        }
    }

    /// Begins the last look.
    pub(super) fn look_again(&mut self, now: Time) {
        self.is_last_look = true;
        self.at = self.first_list();
        self.look_at_list(now);
    }

    /// Looks at one list. A vehicle that gives it the id that it had holds the same items; of
    /// others every item is read.
    pub(super) fn look_at_list(&mut self, now: Time) {
        if let Some(route) = self.route() {
            let id = self.plan_ids[usize::from(route.list.mission_type())];
            let download = self.download(route, now);
            self.work(Task::Download(download.unless_id(id)));
        }
    }

    /// The reading of a list, several items at once where the autopilot allows it.
    pub(super) fn download(&self, route: Route, now: Time) -> Download {
        let conventions = self.expected().autopilot.conventions();
        let is_known = |(_, heartbeat): (_, Heartbeat)| heartbeat.autopilot != AUTOPILOT_GENERIC;
        let is_any = self.vehicle.is_some_and(is_known) && conventions.gives_any_order;
        let window = if is_any { WINDOW } else { 1 };
        Download::new(route, self.deadline, now).with_window(window)
    }

    /// Every list was as sent when it was read, and is so still.
    pub(super) fn conclude(&mut self, now: Time) {
        let rejection = self.rejection.take();
        let failure = rejection.map(|text| Failure::WillNotFly { text });
        let foreign = self.foreign.0;
        let changed = foreign.map(|(system, list)| Failure::ChangedBy { list, system });
        let verdict = changed
            .or(failure)
            .map_or(Verdict::Verified, Verdict::Failed);
        self.end(now, verdict);
    }
}

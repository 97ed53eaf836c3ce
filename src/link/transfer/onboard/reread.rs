//! Lists that change while they are read: what was read of two is none that the vehicle ever held.

use super::{ORDER, Reading, Stage};
use crate::link::message::{
    AUTOPILOT_GENERIC, Address, Body, MissionMessage, MissionResult, MissionType,
};
use crate::link::time::Time;
use crate::link::transfer::download::DownloadError;
use crate::link::transfer::report::Failure;
use crate::mission::Item;
use crate::spec::Autopilot;

/// How often lists that change are read anew.
const MAX_AGAIN: u32 = 3;
/// Nobody was heard to write for this long before they are read anew, milliseconds: twice as long as a vehicle
/// waits before it requests an item again.
const QUIET_MS: u64 = 2000;
/// And no longer is waited for that, milliseconds.
const LOUD_MS: u64 = 30_000;
/// Items that are requested at once of a vehicle that gives them in any order.
const WINDOW: usize = 8;

impl Reading {
    /// Heeds another station that writes to the vehicle: what it sends to the vehicle, and what the vehicle requests
    /// of it or confirms to it.
    pub(super) fn look_for_foreign(&mut self, now: Time, from: Address, message: &MissionMessage) {
        let Some((vehicle, _)) = self.vehicle else {
            return;
        };
        let is_over = self.outcome.is_some();
        if is_over || matches!(self.stage, Stage::Discovery { .. }) {
            return;
        }
        let is_confirmed = message.accepted_from_other(self.us).is_some() && from == vehicle;
        let station = match message.body {
            Body::Count { .. } | Body::Item { .. } | Body::ItemInt { .. } | Body::ClearAll => from,
            Body::Request { .. } | Body::RequestInt { .. } if from == vehicle => message.target,
            _ if is_confirmed => message.target,
            _ => return,
        };
        if !message.is_of_stranger(station, (from, vehicle), self.us) {
            return;
        }
        self.foreign = Some((station.system, MissionType::of(message.mission_type)));
        match &mut self.stage {
            Stage::Quiet { until, latest } => *until = (now + QUIET_MS).min(*latest),
            _ if is_confirmed => self.begin_anew(now),
            _ => {}
        }
    }

    /// What was read may be of two lists.
    pub(super) fn begin_anew(&mut self, now: Time) {
        self.again += 1;
        if self.again > MAX_AGAIN {
            let (system, list) = self.foreign.unzip();
            let list = list.unwrap_or_else(|| ORDER.get(self.at).copied());
            return self.fail(Failure::ChangedWhileRead { list, system });
        }
        self.stage = Stage::Quiet {
            until: now + QUIET_MS,
            latest: now + LOUD_MS,
        };
    }

    /// Reads all lists from the first on.
    pub(super) fn read_anew(&mut self, now: Time) {
        (self.at, self.is_last_look, self.foreign) = (0, false, None);
        self.lists.clear();
        self.ids.clear();
        self.unknown.clear();
        self.read(now);
    }

    /// A list was read once more.
    pub(super) fn looked(&mut self, now: Time, ended: Result<Vec<Item>, DownloadError>) {
        let Some(&list) = ORDER.get(self.at) else {
            return;
        };
        let is_unknown = self.unknown.contains(&list);
        let items = match ended {
            Ok(items) => items,
            Err(DownloadError::Refused {
                result: MissionResult::UNSUPPORTED,
            }) if is_unknown => Vec::new(),
            Err(error) => return self.fail(Failure::ReadBack { list, error }),
        };
        // Home may move meanwhile.
        let home_rows = usize::from(list == MissionType::Mission && self.counts_home());
        let known = self.lists.get(self.at).map_or(&[][..], Vec::as_slice);
        let is_same = items.len() == known.len() && {
            let mut pairs = items.iter().zip(known).skip(home_rows);
            pairs.all(|(a, b)| is_same(a, b))
        };
        match is_same {
            true => self.next(now),
            false => self.begin_anew(now),
        }
    }

    /// How many items are requested at once.
    pub(super) fn window(&self) -> usize {
        let heartbeat = self.vehicle.map(|(_, heartbeat)| heartbeat);
        let heartbeat = heartbeat.filter(|heartbeat| heartbeat.autopilot != AUTOPILOT_GENERIC);
        let autopilot = heartbeat.and_then(|heartbeat| Autopilot::of_mavlink(heartbeat.autopilot));
        let is_any = autopilot.is_some_and(|of| of.conventions().gives_any_order);
        if is_any { WINDOW } else { 1 }
    }
}

/// Bit by bit: a parameter may be no number.
fn is_same(a: &Item, b: &Item) -> bool {
    let without = |of: &Item| Item {
        params: [0.0; 4],
        ..*of
    };
    a.params.map(f32::to_bits) == b.params.map(f32::to_bits) && without(a) == without(b)
}

//! Discovery: waits for the vehicle of an order, until it accepts missions.

use super::identity;
use super::order::Order;
use super::report::{Failure, Refusal, Verdict};
use crate::link::message::{AUTOPILOT_GENERIC, Address, Heartbeat, STATE_STANDBY};
use crate::link::time::Time;

/// Wait for the first heartbeat of the vehicle, milliseconds.
const NOBODY_MS: u64 = 10_000;
/// Wait for the autopilot's own component when another one of the vehicle claims to be the
/// autopilot, milliseconds: two heartbeats, and one that was lost.
pub(crate) const COMPANION_MS: u64 = 2500;
/// Wait for a vehicle that is starting, milliseconds.
const STARTING_MS: u64 = 30_000;

/// The discovery of one vehicle.
#[derive(Debug)]
pub(crate) struct Discovery {
    until: Time,
    /// The vehicle, once it has been heard and identified.
    vehicle: Option<(Address, Heartbeat)>,
    heard: Vec<(Address, Heartbeat)>,
    /// When another component of the vehicle was first heard.
    companion: Option<Time>,
}

/// Result of a heartbeat or a timeout.
#[derive(Debug)]
pub(crate) enum Discovered {
    /// The vehicle was not heard yet, or is not ready.
    Pending,
    /// The vehicle is ready.
    Ready(Address, Heartbeat),
    /// It is another vehicle, or none.
    Failed(Verdict),
}

impl Discovery {
    /// For a vehicle that has not been heard yet.
    pub(crate) fn first(now: Time) -> Self {
        Self {
            until: now + NOBODY_MS,
            vehicle: None,
            heard: Vec::new(),
            companion: None,
        }
    }

    /// For a known vehicle that started again.
    pub(crate) fn again(vehicle: (Address, Heartbeat), now: Time) -> Self {
        Self {
            until: now + STARTING_MS,
            vehicle: Some(vehicle),
            heard: Vec::new(),
            companion: None,
        }
    }

    /// When [`Discovery::timeout`] is due.
    pub(crate) fn until(&self) -> Time {
        self.until
    }

    /// The vehicle, if it has been heard.
    pub(crate) fn vehicle(&self) -> Option<(Address, Heartbeat)> {
        self.vehicle
    }

    /// Takes in a heartbeat of some vehicle.
    pub(crate) fn heartbeat(
        &mut self,
        order: &Order<'_>,
        now: Time,
        from: Address,
        heartbeat: Heartbeat,
    ) -> Discovered {
        match self.vehicle {
            Some((vehicle, _)) if vehicle == from => {
                self.vehicle = Some((from, heartbeat));
                if is_ready(&heartbeat) {
                    return Discovered::Ready(from, heartbeat);
                }
                Discovered::Pending
            }
            Some((vehicle, _)) => {
                let is_same = vehicle.system == from.system;
                if is_same && identity::is_first_choice(from) {
                    return self.identify(order, now, from, heartbeat);
                }
                Discovered::Pending
            }
            None => {
                self.heard.retain(|(address, _)| *address != from);
                self.heard.push((from, heartbeat));
                let is_ours = from.system == order.sysid;
                let since = match self.companion {
                    None if is_ours => *self.companion.insert(now),
                    since => since.unwrap_or(now),
                };
                if is_ours && (identity::is_first_choice(from) || now - since >= COMPANION_MS) {
                    return self.identify(order, now, from, heartbeat);
                }
                Discovered::Pending
            }
        }
    }

    /// No vehicle came, or it did not get ready. With `force`, a single stranger is accepted.
    pub(crate) fn timeout(&mut self, order: &Order<'_>, now: Time) -> Discovered {
        if let Some((_, heartbeat)) = self.vehicle {
            return Discovered::Failed(Verdict::Failed(Failure::NotReady {
                status: heartbeat.system_status,
                after_s: STARTING_MS / 1000,
            }));
        }
        let expected = order.sysid;
        let strangers: Vec<(Address, Heartbeat)> = self
            .heard
            .iter()
            .filter(|(address, _)| address.system != expected)
            .filter(|(address, _)| !order.others.contains(&address.system))
            .copied()
            .collect();
        match strangers.as_slice() {
            [(address, heartbeat)] if order.force => {
                self.identify(order, now, *address, *heartbeat)
            }
            [(address, _)] => {
                let found = address.system;
                Discovered::Failed(Verdict::Refused(Refusal::System { expected, found }))
            }
            _ => {
                let mut heard: Vec<u8> = self.heard.iter().map(|(from, _)| from.system).collect();
                heard.sort_unstable();
                heard.dedup();
                Discovered::Failed(Verdict::Failed(Failure::Nobody {
                    sysid: expected,
                    after_s: NOBODY_MS / 1000,
                    heard,
                }))
            }
        }
    }

    fn identify(
        &mut self,
        order: &Order<'_>,
        now: Time,
        from: Address,
        heartbeat: Heartbeat,
    ) -> Discovered {
        self.vehicle = Some((from, heartbeat));
        let mission = order.mission;
        match identity::check(&heartbeat, mission.autopilot, mission.airframe) {
            Err(refusal) if !order.force => Discovered::Failed(Verdict::Refused(refusal)),
            _ if is_ready(&heartbeat) => Discovered::Ready(from, heartbeat),
            _ => {
                self.until = now + STARTING_MS;
                Discovered::Pending
            }
        }
    }
}

/// Whether a vehicle accepts missions. A generic autopilot may report "state unknown" (0).
pub(crate) fn is_ready(heartbeat: &Heartbeat) -> bool {
    heartbeat.system_status >= STATE_STANDBY
        || (heartbeat.autopilot == AUTOPILOT_GENERIC && heartbeat.system_status == 0)
}

//! The new missions on their way to the vehicles.

use std::collections::BTreeMap;
use std::time::Duration;

use super::Decision;
use super::look::Clock;
use crate::cli::fly::Sorties;
use crate::flight::{Diversion, Onward};
use crate::link::{Arrival, Command, FlightMessage, Links, Message};

/// How often the vehicles on their way to a new path say where they are, microseconds.
const INTERVAL_US: f32 = 200_000.0;
/// `GLOBAL_POSITION_INT`.
const POSITION: f32 = 33.0;

/// Transfers the new missions, and has the vehicles go on with them.
pub(super) fn divert(
    open: &Links,
    clock: &Clock,
    sorties: &Sorties,
    decision: &Decision,
) -> BTreeMap<usize, Result<(), String>> {
    let fleet = &sorties.file.spec.vehicles;
    let systems: Vec<u8> = fleet.iter().map(|vehicle| vehicle.sysid).collect();
    let mut diversions: BTreeMap<usize, Diversion<'_>> = BTreeMap::new();
    for renewed in &decision.replanned.renewed {
        let this = &fleet[renewed.vehicle];
        let Some(seen) = decision.sight.vehicles.get(&renewed.vehicle) else {
            continue;
        };
        let order = Command::new(Command::SET_MESSAGE_INTERVAL, [POSITION, INTERVAL_US]);
        let target = seen.address;
        let message = FlightMessage::Command { target, order };
        open.send(this.sysid, Message::Flight(message));
        let onward = Onward {
            vehicle: &this.id,
            mission: &renewed.mission,
            origin: sorties.world.frame.from_plan(renewed.origin.at),
            ahead: renewed.ahead,
            new: renewed.new,
        };
        let others = systems.iter().copied().filter(|id| *id != this.sysid);
        let vehicle = (seen.address, seen.beat);
        let (us, now) = (open.us(), clock.now());
        let diversion = Diversion::new(onward, vehicle, others.collect(), us, now);
        diversions.insert(renewed.vehicle, diversion);
    }
    while diversions
        .values()
        .any(|diversion| diversion.outcome().is_none())
    {
        for (index, diversion) in &mut diversions {
            diversion.handle_timeout(clock.now());
            while let Some(message) = diversion.poll_transmit(clock.now()) {
                open.send(fleet[*index].sysid, message);
            }
        }
        let mut arrival = open.receive(Duration::from_millis(5));
        for _ in 0..1000 {
            let Some(Arrival::Message(link, from, message)) = arrival else {
                break;
            };
            for (index, diversion) in &mut diversions {
                if open.number(fleet[*index].sysid) != Some(link) {
                    continue;
                }
                diversion.handle(clock.now(), from, &message);
                // What is due goes out before the next message is looked at.
                while let Some(message) = diversion.poll_transmit(clock.now()) {
                    open.send(fleet[*index].sysid, message);
                }
            }
            arrival = open.receive(Duration::ZERO);
        }
    }
    diversions
        .into_iter()
        .map(|(index, of)| (index, of.outcome().cloned().unwrap_or(Ok(()))))
        .collect()
}

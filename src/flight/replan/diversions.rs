//! The new missions on their way to the vehicles.

use std::collections::BTreeMap;
use std::time::Duration;

use super::Outcomes;
use super::new_mission::NewMission;
use super::observation::Observation;
use crate::flight::clock::Clock;
use crate::flight::launch::plan::FlightPlan;
use crate::flight::session::diversion::{Diversion, Onward};
use crate::link::{Arrival, Command, FlightMessage, Links, Message};

/// Between two positions, and two current items, of a vehicle that is diverted, microseconds.
const INTERVAL_US: f32 = 200_000.0;
/// `GLOBAL_POSITION_INT` and `MISSION_CURRENT`.
const STREAMED: [f32; 2] = [33.0, 42.0];
/// Messages that are handled before timeouts have their turn again.
const BURST: usize = 1000;

/// Transfers the new missions, and has the vehicles go on with them.
pub(super) fn divert(
    links: &Links,
    clock: &Clock,
    plan: &FlightPlan,
    (missions, observation): (&[NewMission], &Observation),
) -> Outcomes {
    let mut diversions = begin(links, clock, plan, (missions, observation));
    let sysid = |index: usize| plan.vehicle(index).sysid;
    while diversions.values().any(|of| of.outcome().is_none()) {
        for (index, diversion) in &mut diversions {
            diversion.handle_timeout(clock.now());
            while let Some(message) = diversion.poll_transmit(clock.now()) {
                links.send(sysid(*index), message);
            }
        }
        let mut arrival = links.receive(Duration::from_millis(5));
        for _ in 0..BURST {
            let Some(Arrival::Message(link, from, message)) = arrival else {
                break;
            };
            for (index, diversion) in &mut diversions {
                if links.number(sysid(*index)) != Some(link) {
                    continue;
                }
                diversion.handle(clock.now(), from, &message);
                // The answer goes out before the next message is looked at.
                while let Some(message) = diversion.poll_transmit(clock.now()) {
                    links.send(sysid(*index), message);
                }
            }
            arrival = links.receive(Duration::ZERO);
        }
    }
    diversions
        .into_iter()
        .map(|(index, of)| (index, of.outcome().cloned().unwrap_or(Ok(()))))
        .collect()
}

/// Requests positions of each vehicle and begins its transfer.
fn begin<'a>(
    links: &Links,
    clock: &Clock,
    plan: &'a FlightPlan,
    (missions, observation): (&'a [NewMission], &Observation),
) -> BTreeMap<usize, Diversion<'a>> {
    let fleet = &plan.spec().vehicles;
    let mut diversions = BTreeMap::new();
    for new in missions {
        let this = plan.vehicle(new.vehicle);
        let Some(observed) = observation.vehicles.get(&new.vehicle) else {
            continue;
        };
        let target = observed.address;
        for id in STREAMED {
            let order = Command::new(Command::SET_MESSAGE_INTERVAL, [id, INTERVAL_US]);
            let message = FlightMessage::Command { target, order };
            links.send(this.sysid, Message::Flight(message));
        }
        let onward = Onward {
            vehicle: &this.id,
            mission: &new.mission,
            origin: plan.world.frame.from_plan(new.origin.at),
            ahead: new.ahead,
            new: new.new,
            held: new.held,
        };
        let others = fleet.iter().map(|vehicle| vehicle.sysid);
        let others = others.filter(|id| *id != this.sysid).collect();
        let vehicle = (observed.address, observed.heartbeat);
        let mut diversion = Diversion::new(onward, vehicle, others, links.us(), clock.now());
        // A transfer may be over before the next position comes.
        let position = FlightMessage::Position(observed.position);
        let message = Message::Flight(position);
        diversion.handle(clock.now(), observed.address, &message);
        diversions.insert(new.vehicle, diversion);
    }
    diversions
}

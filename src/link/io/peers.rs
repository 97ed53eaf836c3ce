//! Who speaks on one link: a decoder for each address, an address for each system.

use std::collections::{BTreeMap, BTreeSet};
use std::net::SocketAddr;

use super::sequences::Sequences;
use super::shared_id::SharedId;
use crate::link::codec::{Decoder, Frame};
use crate::link::message::Message;
use crate::link::message::flight::FlightMessage;
use crate::link::time::Time;

/// Most addresses that are remembered: twice as many as there are system ids, so that one
/// without a system can always be forgotten.
const MAX_PEERS: usize = 512;
/// A system that was silent at one address for so long may speak from another,
/// milliseconds. Two live ones are heard in turn each second, and a vehicle that changed its
/// port is found before it counts as lost.
const MOVED_MS: u64 = 1500;

/// The peers of one link.
#[derive(Default)]
pub(crate) struct Peers {
    decoders: BTreeMap<SocketAddr, Peer>,
    routes: BTreeMap<u8, Route>,
    /// The positions and the numbers of the frames of each system, of the component that sent the first position.
    positions: BTreeMap<u8, (u8, SharedId, Sequences)>,
    receptions: u64,
}

#[derive(Default)]
struct Peer {
    decoder: Decoder,
    /// Number of the reception that last came from it.
    used: u64,
}

/// Where a system is.
struct Route {
    at: SocketAddr,
    heard: Time,
    /// Another address that speaks in its name, heard while it was there.
    rival: Option<SocketAddr>,
}

impl Peers {
    /// The frames that bytes from an address complete.
    pub(crate) fn frames(&mut self, from: SocketAddr, bytes: &[u8]) -> Vec<Frame> {
        if self.decoders.len() >= MAX_PEERS && !self.decoders.contains_key(&from) {
            self.forget_one();
        }
        self.receptions += 1;
        let peer = self.decoders.entry(from).or_default();
        peer.used = self.receptions;
        peer.decoder.push(bytes);
        std::iter::from_fn(|| peer.decoder.next_frame()).collect()
    }

    /// Drops the decoder that was used least recently and is of no system.
    fn forget_one(&mut self) {
        let proven: BTreeSet<SocketAddr> = self.routes.values().map(|route| route.at).collect();
        let unproven = self.decoders.iter().filter(|(at, _)| !proven.contains(at));
        if let Some((&at, _)) = unproven.min_by_key(|(_, peer)| peer.used) {
            self.decoders.remove(&at);
        }
    }

    /// Whether positions with one system id come from two vehicles, by a frame of it.
    pub(crate) fn are_two(&mut self, frame: &Frame) -> bool {
        let from = frame.from;
        let position = match &frame.message {
            Some(Message::Flight(FlightMessage::Position(position))) => Some(position),
            _ => None,
        };
        if position.is_some() {
            let first = || (from.component, SharedId::default(), Sequences::default());
            self.positions.entry(from.system).or_insert_with(first);
        }
        // Numbers of who sends no positions do not matter.
        let known = self.positions.get_mut(&from.system);
        let Some((_, shared_id, sequences)) = known.filter(|of| of.0 == from.component) else {
            return false;
        };
        let are_apart = position.is_some_and(|position| shared_id.take(position));
        sequences.take(frame.number, position) || are_apart
    }

    /// Where a system was heard.
    pub(crate) fn address(&self, system: u8) -> Option<SocketAddr> {
        self.routes.get(&system).map(|route| route.at)
    }

    /// Notes where a system speaks from. `Some` when it is known elsewhere and the frame
    /// must be ignored; with both addresses, once both of them are known to be alive.
    pub(crate) fn route(
        &mut self,
        system: u8,
        from: SocketAddr,
        now: Time,
    ) -> Option<Option<[SocketAddr; 2]>> {
        let route = self.routes.entry(system).or_insert(Route {
            at: from,
            heard: now,
            rival: None,
        });
        if route.at == from {
            route.heard = now;
            return route.rival.take().map(|rival| Some([from, rival]));
        }
        if now - route.heard >= MOVED_MS {
            (route.at, route.heard, route.rival) = (from, now, None);
            return None;
        }
        route.rival = Some(from);
        Some(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::codec::Encoder;
    use crate::link::message::{Address, Heartbeat, Message};

    fn at(port: u16) -> SocketAddr {
        ([127, 0, 0, 1], port).into()
    }

    #[test]
    fn two_addresses_of_one_system_are_duplicates_and_one_that_moved_is_not() {
        let mut peers = Peers::default();
        assert_eq!(peers.route(1, at(1), Time(0)), None);
        assert_eq!(peers.route(2, at(2), Time(0)), None, "another system");
        assert_eq!(peers.route(1, at(3), Time(100)), Some(None));
        let both = Some(Some([at(1), at(3)]));
        assert_eq!(peers.route(1, at(1), Time(200)), both);
        // The second one started again and has another port now.
        assert_eq!(peers.route(2, at(4), Time(1499)), Some(None));
        assert_eq!(peers.route(2, at(4), Time(1500)), None);
        assert_eq!(peers.route(2, at(4), Time(1501)), None);
    }

    #[test]
    fn spoofed_addresses_are_bounded_and_displace_no_vehicle() {
        let vehicle = Address {
            system: 1,
            component: 1,
        };
        let frame = Encoder::new(vehicle).encode(&Message::Heartbeat(Heartbeat::OURS));
        let (whole, half) = (&frame[..], &frame[..9]);
        let mut peers = Peers::default();
        assert_eq!(peers.frames(at(1), whole).len(), 1);
        assert_eq!(peers.route(1, at(1), Time(0)), None);
        assert!(peers.frames(at(1), half).is_empty());
        for port in 1000..60_000 {
            assert!(peers.frames(at(port), half).is_empty());
        }
        assert_eq!(peers.decoders.len(), MAX_PEERS);
        assert_eq!(peers.frames(at(1), &frame[9..]).len(), 1, "the other half");
    }
}

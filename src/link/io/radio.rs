//! One open link with its clock: bytes out, messages in, told apart by system id.

use std::collections::BTreeMap;
use std::io;
use std::net::SocketAddr;
use std::time::{Duration, Instant};

use super::socket::Wire;
use super::tlog::Tlog;
use crate::link::codec::{Decoder, Encoder, Version};
use crate::link::message::{Address, Message};
use crate::link::time::Time;
use crate::spec::Link;

/// Longest wait on a socket, milliseconds.
const LONGEST_WAIT_MS: u64 = 200;
/// A system that was silent at one address for so long may speak from another, milliseconds.
const MOVED_MS: u64 = 5000;

/// An open link.
pub(crate) struct Radio<'a> {
    wire: Wire,
    encoder: Encoder,
    decoders: BTreeMap<SocketAddr, Decoder>,
    routes: BTreeMap<u8, Route>,
    began: Instant,
    tlog: Option<&'a Tlog>,
}

/// Where a system is.
struct Route {
    at: SocketAddr,
    heard: Time,
    /// Another address that speaks in its name, heard while it was there.
    rival: Option<SocketAddr>,
}

/// What came in.
pub(crate) enum Heard {
    /// A message, and in which MAVLink it was.
    Message(Address, Version, Message),
    /// One system id at two addresses at the same time.
    Twins(u8, [SocketAddr; 2]),
}

impl<'a> Radio<'a> {
    /// Opens a link in the name of `us`.
    pub(crate) fn open(link: &Link, us: Address, tlog: Option<&'a Tlog>) -> io::Result<Self> {
        let wire = Wire::open(link)?;
        #[allow(
            clippy::disallowed_methods,
            reason = "real vehicles answer in real time; the machines get it as a value"
        )]
        let began = Instant::now();
        Ok(Self {
            wire,
            encoder: Encoder::new(us),
            decoders: BTreeMap::new(),
            routes: BTreeMap::new(),
            began,
            tlog,
        })
    }

    /// Since the link was opened.
    pub(crate) fn now(&self) -> Time {
        Time(u64::try_from(self.began.elapsed().as_millis()).unwrap_or(u64::MAX))
    }

    /// Whether anyone may speak on this link, and not one peer alone.
    pub(crate) fn is_open(&self) -> bool {
        self.wire.remote().is_none()
    }

    /// Waits for messages, at most until `due`.
    pub(crate) fn receive(&mut self, due: Time) -> io::Result<Vec<Heard>> {
        let mut buffer = [0; 2048];
        let wait = Duration::from_millis((due - self.now()).min(LONGEST_WAIT_MS));
        let Some((length, from)) = self.wire.receive(&mut buffer, wait)? else {
            return Ok(Vec::new());
        };
        let now = self.now();
        let decoder = self.decoders.entry(from).or_default();
        decoder.push(buffer.get(..length).unwrap_or_default());
        let mut heard = Vec::new();
        while let Some(frame) = decoder.next_frame() {
            if let Some(tlog) = self.tlog {
                tlog.record(&frame.bytes);
            }
            let system = frame.from.system;
            match route(&mut self.routes, system, from, now) {
                Some(twins) => heard.extend(twins.map(|at| Heard::Twins(system, at))),
                None => heard.extend(
                    frame
                        .message
                        .map(|message| Heard::Message(frame.from, frame.version, message)),
                ),
            }
        }
        Ok(heard)
    }

    /// Sends a message to where a system was heard, or to where the link leads.
    pub(crate) fn send(
        &mut self,
        system: u8,
        version: Version,
        message: &Message,
    ) -> io::Result<()> {
        let at = self.routes.get(&system).map(|route| route.at);
        let Some(to) = at.or(self.wire.remote()) else {
            return Ok(());
        };
        let frame = self.encoder.encode_in(version, message);
        if let Some(tlog) = self.tlog {
            tlog.record(&frame);
        }
        self.wire.send(&frame, to)
    }
}

/// Keeps where a system is. `Some` when the frame comes from elsewhere and must not
/// be listened to; with both addresses, once both of them are known to be alive.
fn route(
    routes: &mut BTreeMap<u8, Route>,
    system: u8,
    from: SocketAddr,
    now: Time,
) -> Option<Option<[SocketAddr; 2]>> {
    let route = routes.entry(system).or_insert(Route {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn at(port: u16) -> SocketAddr {
        ([127, 0, 0, 1], port).into()
    }

    #[test]
    fn two_addresses_under_one_system_id_are_twins_and_one_that_moved_is_not() {
        let mut routes = BTreeMap::new();
        assert_eq!(route(&mut routes, 1, at(1), Time(0)), None);
        assert_eq!(
            route(&mut routes, 2, at(2), Time(0)),
            None,
            "another system"
        );
        assert_eq!(route(&mut routes, 1, at(3), Time(100)), Some(None));
        let twins = Some(Some([at(1), at(3)]));
        assert_eq!(route(&mut routes, 1, at(1), Time(200)), twins);
        // The second one started again and has another port now.
        assert_eq!(route(&mut routes, 2, at(4), Time(5000)), None);
        assert_eq!(route(&mut routes, 2, at(4), Time(5001)), None);
    }
}

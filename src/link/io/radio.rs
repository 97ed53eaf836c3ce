//! One open link with its clock: bytes out, messages in, sorted by system id.

use std::io;
use std::net::SocketAddr;
use std::time::{Duration, Instant};

use super::peers::Peers;
use super::socket::Wire;
use super::tlog::Tlog;
use crate::link::codec::{Encoder, Version};
use crate::link::message::{Address, Message};
use crate::link::time::Time;
use crate::spec::Link;

/// Longest wait on a socket, milliseconds.
const MAX_WAIT_MS: u64 = 200;

/// An open link.
pub(crate) struct Radio<'a> {
    wire: Wire,
    encoder: Encoder,
    peers: Peers,
    began: Instant,
    tlog: Option<&'a Tlog>,
}

/// Something that came in.
pub(crate) enum Received {
    /// A message, its sender, and its MAVLink version.
    Message(Address, Version, Message),
    /// One system id speaks from two addresses at the same time, or for two vehicles from one.
    DuplicateSystem(u8, [SocketAddr; 2]),
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
            peers: Peers::default(),
            began,
            tlog,
        })
    }

    /// Since the link was opened.
    pub(crate) fn now(&self) -> Time {
        Time(u64::try_from(self.began.elapsed().as_millis()).unwrap_or(u64::MAX))
    }

    /// Whether any peer may speak on this link, and not one alone.
    pub(crate) fn is_open(&self) -> bool {
        self.wire.remote().is_none()
    }

    /// Waits for messages, at most until `due`.
    pub(crate) fn receive(&mut self, due: Time) -> io::Result<Vec<Received>> {
        let mut buffer = [0; 2048];
        let wait = Duration::from_millis((due - self.now()).min(MAX_WAIT_MS));
        let Some((length, from)) = self.wire.receive(&mut buffer, wait)? else {
            return Ok(Vec::new());
        };
        let now = self.now();
        let mut received = Vec::new();
        let bytes = buffer.get(..length).unwrap_or_default();
        for frame in self.peers.frames(from, bytes) {
            if let Some(tlog) = self.tlog {
                tlog.record(&frame.bytes);
            }
            let system = frame.from.system;
            match self.peers.route(system, from, now) {
                Some(both) => {
                    received.extend(both.map(|at| Received::DuplicateSystem(system, at)));
                }
                None => {
                    if self.peers.are_two(&frame) {
                        received.push(Received::DuplicateSystem(system, [from; 2]));
                    }
                    let Some(message) = frame.message else {
                        continue;
                    };
                    received.push(Received::Message(frame.from, frame.version, message));
                }
            }
        }
        Ok(received)
    }

    /// Sends a message to where a system was heard, or to where the link leads.
    pub(crate) fn send(
        &mut self,
        system: u8,
        version: Version,
        message: &Message,
    ) -> io::Result<()> {
        let Some(to) = self.peers.address(system).or(self.wire.remote()) else {
            return Ok(());
        };
        let frame = self.encoder.encode_in(version, message);
        if let Some(tlog) = self.tlog {
            tlog.record(&frame);
        }
        self.wire.send(&frame, to)
    }
}

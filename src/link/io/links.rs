//! All links of a fleet, open at once: a thread for each, one queue of what comes in.

use std::collections::BTreeMap;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::time::Duration;

use super::radio::{Heard, Radio};
use crate::link::codec::Version;
use crate::link::fleet::ground_station;
use crate::link::message::{Address, Message};
use crate::spec::Link;

/// Longest wait on a socket before what is to be sent goes out, milliseconds.
const TURN_MS: u64 = 4;

/// Open links to a fleet. They are closed when this is dropped.
#[derive(Debug)]
pub struct Links {
    us: Address,
    inbox: Receiver<Arrival>,
    outboxes: Vec<Sender<(u8, Message)>>,
    /// The link of each system id.
    of: BTreeMap<u8, usize>,
}

/// What came in over one of the links.
#[derive(Clone, Debug, PartialEq)]
pub enum Arrival {
    /// A message, the number of the link that it came over (see [`Links::number`]), its sender.
    Message(usize, Address, Message),
    /// One system id speaks from two addresses at once.
    Twins(u8),
    /// A link has failed: which, and why.
    Failed(String, String),
}

impl Links {
    /// Opens the links of these vehicles, by system id. [`Link::Sim`] must have been
    /// replaced by the address of a running vehicle.
    ///
    /// # Errors
    /// The link that cannot be opened, and why.
    pub fn open(vehicles: &[(u8, &Link)]) -> Result<Self, (String, std::io::Error)> {
        let systems: Vec<u8> = vehicles.iter().map(|(system, _)| *system).collect();
        let us = ground_station(&systems);
        let (send, inbox) = channel();
        let mut links = Self {
            us,
            inbox,
            outboxes: Vec::new(),
            of: BTreeMap::new(),
        };
        let mut names: Vec<String> = Vec::new();
        for (system, link) in vehicles {
            let name = link.to_string();
            let known = names.iter().position(|other| *other == name);
            let index = match known {
                Some(index) => index,
                None => {
                    let radio =
                        Radio::open(link, us, None).map_err(|error| (name.clone(), error))?;
                    let (outbox, messages) = channel();
                    let (inbox, name_of) = (send.clone(), name.clone());
                    let number = names.len();
                    std::thread::spawn(move || {
                        if let Err(error) = serve(radio, number, &messages, &inbox) {
                            // Nobody listens any more: then it does not matter either.
                            let _ = inbox.send(Arrival::Failed(name_of, error.to_string()));
                        }
                    });
                    links.outboxes.push(outbox);
                    names.push(name);
                    names.len() - 1
                }
            };
            links.of.insert(*system, index);
        }
        Ok(links)
    }

    /// Who we are to the vehicles.
    #[must_use]
    pub fn us(&self) -> Address {
        self.us
    }

    /// The number of a system's link, if it has one; two that share a link have the same.
    #[must_use]
    pub fn number(&self, system: u8) -> Option<usize> {
        self.of.get(&system).copied()
    }

    /// Sends a message to a system, if it has a link.
    pub fn send(&self, system: u8, message: Message) {
        if let Some(outbox) = self.of.get(&system).and_then(|&at| self.outboxes.get(at)) {
            // A link that has failed has said so.
            let _ = outbox.send((system, message));
        }
    }

    /// Waits for something to come in.
    #[must_use]
    pub fn receive(&self, wait: Duration) -> Option<Arrival> {
        self.inbox.recv_timeout(wait).ok()
    }
}

/// One link until nobody wants it any more.
fn serve(
    mut radio: Radio<'static>,
    number: usize,
    messages: &Receiver<(u8, Message)>,
    inbox: &Sender<Arrival>,
) -> std::io::Result<()> {
    loop {
        loop {
            match messages.try_recv() {
                Ok((system, message)) => radio.send(system, Version::Two, &message)?,
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => return Ok(()),
            }
        }
        for heard in radio.receive(radio.now() + TURN_MS)? {
            let arrival = match heard {
                Heard::Message(from, _, message) => Arrival::Message(number, from, message),
                Heard::Twins(system, _) => Arrival::Twins(system),
            };
            if inbox.send(arrival).is_err() {
                return Ok(());
            }
        }
    }
}

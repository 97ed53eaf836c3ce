//! All links of a fleet, open at once: a thread for each, one queue of arrivals.

use std::collections::BTreeMap;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::time::Duration;

use super::radio::{Radio, Received};
use crate::link::codec::Version;
use crate::link::ground_station::address;
use crate::link::message::{Address, Message};
use crate::link::time::Time;
use crate::spec::Link;

/// Longest wait on a socket before queued messages go out, milliseconds.
const TURN_MS: u64 = 4;
/// One that fails again within this time, milliseconds, has the same outage: it may hear and not send.
const OUTAGE_MS: u64 = 5000;
/// Between two attempts on a link that fails.
const FAILED_WAIT: Duration = Duration::from_millis(20);

/// Open links to a fleet. They are closed when this is dropped.
#[derive(Debug)]
pub struct Links {
    us: Address,
    inbox: Receiver<Arrival>,
    outboxes: Vec<Sender<(u8, Message)>>,
    /// The link of each system id.
    of: BTreeMap<u8, usize>,
}

/// Something that came in over one of the links.
#[derive(Clone, Debug, PartialEq)]
pub enum Arrival {
    /// A message, the number of the link that it came over (see [`Links::number`]), its sender.
    Message(usize, Address, Message),
    /// One system id speaks from two addresses at once, or for two vehicles from one: in words.
    DuplicateSystem(u8, &'static str),
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
        let us = address(&systems);
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
                        serve(radio, (number, &name_of), &messages, &inbox);
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

    /// Our address.
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

/// Serves one link until [`Links`] is dropped. One that fails is reported once for each outage and tried on.
fn serve(
    mut radio: Radio<'static>,
    (number, name): (usize, &str),
    messages: &Receiver<(u8, Message)>,
    inbox: &Sender<Arrival>,
) {
    let mut failed: Option<Time> = None;
    loop {
        let turn = turn(&mut radio, messages);
        let now = radio.now();
        let arrivals = match turn {
            Ok(None) => return,
            Ok(Some(received)) => {
                failed.take_if(|at| !received.is_empty() && now - *at > OUTAGE_MS);
                let arrivals = received.into_iter().map(|of| arrival(number, of));
                arrivals.collect()
            }
            Err(error) => {
                std::thread::sleep(FAILED_WAIT);
                let is_new = failed.replace(now).is_none();
                let arrival = Arrival::Failed(name.to_owned(), error.to_string());
                Vec::from_iter(is_new.then_some(arrival))
            }
        };
        for arrival in arrivals {
            if inbox.send(arrival).is_err() {
                return;
            }
        }
    }
}

/// Sends what is queued and takes in what comes; none where nobody needs it any more.
fn turn(
    radio: &mut Radio<'static>,
    messages: &Receiver<(u8, Message)>,
) -> std::io::Result<Option<Vec<Received>>> {
    loop {
        match messages.try_recv() {
            Ok((system, message)) => radio.send(system, Version::Two, &message)?,
            Err(TryRecvError::Empty) => break,
            Err(TryRecvError::Disconnected) => return Ok(None),
        }
    }
    radio.receive(radio.now() + TURN_MS).map(Some)
}

fn arrival(number: usize, received: Received) -> Arrival {
    match received {
        Received::Message(from, _, message) => Arrival::Message(number, from, message),
        Received::DuplicateSystem(system, [one, two]) => {
            let what = match one == two {
                true => "another vehicle speaks with its system id: what is known of it is of both",
                false => "speaks from two addresses at once",
            };
            Arrival::DuplicateSystem(system, what)
        }
    }
}

//! The upload, download and clear machines alone, told anything in any order at any
//! time: no panic, an end within the deadline, and no success without its reasons.
#![no_main]

use std::collections::BTreeSet;

use libfuzzer_sys::fuzz_target;
use sortie::link::{
    Address, Body, Clear, Download, MissionType, Message, MissionMessage, MissionResult, Route, Time,
    Upload,
};
use sortie::mission::Item;

const US: Address = Address {
    system: 245,
    component: 190,
};
const VEHICLE: Address = Address {
    system: 1,
    component: 1,
};
const STRANGER: Address = Address {
    system: 255,
    component: 190,
};
const DEADLINE: Time = Time(60_000);

enum Machine {
    Upload(Upload),
    Download(Download),
    Clear(Clear),
}

/// What the script says, byte by byte; zeros at its end.
struct Script<'a>(std::slice::Iter<'a, u8>);

impl Script<'_> {
    fn byte(&mut self) -> u8 {
        self.0.next().copied().unwrap_or(0)
    }

    fn number(&mut self) -> u16 {
        u16::from_le_bytes([self.byte(), self.byte()])
    }

    /// Small as a rule, so that it means something.
    fn seq(&mut self) -> u16 {
        match self.byte() {
            255 => self.number(),
            small => u16::from(small % 16),
        }
    }

    fn body(&mut self) -> Body {
        let opaque_id = u32::from(self.byte() & 1);
        match self.byte() % 9 {
            0 => Body::Count {
                count: self.seq(),
                opaque_id,
            },
            1 | 2 => Body::Request { seq: self.seq() },
            3 => Body::RequestInt { seq: self.seq() },
            4 => Body::ItemInt {
                seq: self.seq(),
                current: 0,
                item: item(self.seq()),
            },
            5 | 6 => Body::Ack {
                result: MissionResult(self.byte() % 18),
                opaque_id,
            },
            7 => Body::RequestList,
            _ => Body::ClearAll,
        }
    }
}

fn item(n: u16) -> Item {
    Item {
        x: i32::from(n),
        ..Item::without_place(16, [0.0; 4])
    }
}

/// What went out and came in, as a witness of the end.
#[derive(Default)]
struct Witness {
    sent: BTreeSet<u16>,
    accepted: bool,
    counts: BTreeSet<u16>,
}

impl Witness {
    fn saw_sent(&mut self, message: &Message) {
        let Message::Mission(mission) = message else {
            panic!("{message:?} is no message of the mission protocol");
        };
        assert_eq!((mission.target, mission.mission_type), (VEHICLE, 0));
        match mission.body {
            Body::ItemInt { seq, .. } => drop(self.sent.insert(seq)),
            // A new run: what went out before does not count.
            Body::Count { .. } => self.sent.clear(),
            _ => {}
        }
    }

    fn saw_heard(&mut self, body: Body) {
        match body {
            Body::Ack {
                result: MissionResult::ACCEPTED,
                ..
            } => self.accepted = true,
            Body::Count { count, .. } => drop(self.counts.insert(count)),
            _ => {}
        }
    }
}

impl Machine {
    fn handle(&mut self, now: Time, from: Address, message: &Message) {
        match self {
            Self::Upload(upload) => upload.handle(now, from, message),
            Self::Download(download) => download.handle(now, from, message),
            Self::Clear(clear) => clear.handle(now, from, message),
        }
    }

    fn handle_timeout(&mut self, now: Time) {
        match self {
            Self::Upload(upload) => upload.handle_timeout(now),
            Self::Download(download) => download.handle_timeout(now),
            Self::Clear(clear) => clear.handle_timeout(now),
        }
    }

    fn poll_transmit(&mut self) -> Option<Message> {
        match self {
            Self::Upload(upload) => upload.poll_transmit(),
            Self::Download(download) => download.poll_transmit(),
            Self::Clear(clear) => clear.poll_transmit(),
        }
    }

    fn poll_timeout(&self) -> Option<Time> {
        match self {
            Self::Upload(upload) => upload.poll_timeout(),
            Self::Download(download) => download.poll_timeout(),
            Self::Clear(clear) => clear.poll_timeout(),
        }
    }

    fn is_over(&self) -> bool {
        match self {
            Self::Upload(upload) => upload.outcome().is_some(),
            Self::Download(download) => download.outcome().is_some(),
            Self::Clear(clear) => clear.outcome().is_some(),
        }
    }

    fn judge(&self, items: u16, witness: &Witness) {
        match self {
            Self::Upload(upload) => {
                if let Some(Ok(sent)) = upload.outcome() {
                    assert_eq!(witness.sent.len(), usize::from(items));
                    assert!(witness.accepted || !sent.acknowledged);
                }
            }
            Self::Download(download) => {
                if let Some(Ok(items)) = download.outcome() {
                    let count = u16::try_from(items.len()).expect("a count has 16 bits");
                    assert!(witness.counts.contains(&count));
                }
            }
            Self::Clear(clear) => {
                if let Some(Ok(cleared)) = clear.outcome() {
                    assert!(witness.accepted || !cleared.acknowledged);
                }
            }
        }
    }
}

fuzz_target!(|data: &[u8]| {
    let mut script = Script(data.iter());
    let items = u16::from(script.byte() % 8) + 1;
    let route = Route {
        us: US,
        vehicle: VEHICLE,
        list: MissionType::Mission,
    };
    let mut machine = match script.byte() % 4 {
        0 | 1 => {
            let rows = (0..items).map(|n| (item(n), u8::from(n == 0))).collect();
            let upload = Upload::new(route, rows, 5000, DEADLINE, Time(0));
            let room_ms = u64::from(script.byte() % 2) * 800;
            Machine::Upload(upload.with_min_gap(room_ms))
        }
        2 => Machine::Download(Download::new(route, DEADLINE, Time(0))),
        _ => Machine::Clear(Clear::new(route, DEADLINE, Time(0))),
    };
    let mut witness = Witness::default();
    let mut now = Time(0);
    while script.0.len() > 0 && !machine.is_over() {
        while let Some(message) = machine.poll_transmit() {
            witness.saw_sent(&message);
        }
        match script.byte() {
            // What is due, when it is due or somewhat late.
            late @ 0..=63 => {
                now = machine.poll_timeout().unwrap_or(now).max(now) + u64::from(late % 8);
                machine.handle_timeout(now);
            }
            ms @ 64..=127 => now = now + u64::from(ms - 64) * 30,
            kind => {
                let body = script.body();
                let is_ours = kind < 250;
                let from = if is_ours { VEHICLE } else { STRANGER };
                let message = Message::Mission(MissionMessage {
                    target: US,
                    mission_type: if kind == 249 { 1 } else { 0 },
                    body,
                });
                if is_ours && kind != 249 {
                    witness.saw_heard(body);
                }
                machine.handle(now, from, &message);
            }
        }
    }
    // Left alone, it ends by itself within its deadline.
    for _ in 0..10_000 {
        while let Some(message) = machine.poll_transmit() {
            witness.saw_sent(&message);
        }
        let Some(due) = machine.poll_timeout() else {
            break;
        };
        assert!(due <= DEADLINE);
        now = now.max(due);
        machine.handle_timeout(now);
    }
    assert!(machine.is_over() && machine.poll_timeout().is_none());
    machine.judge(items, &witness);
});

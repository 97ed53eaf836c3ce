//! Radio in virtual time: loss, duplication, reordering, delay and corruption of
//! every frame in every direction, from a seed.
#![allow(dead_code, unreachable_pub, missing_docs)]

use std::collections::BTreeMap;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use sortie::link::{Address, Decoder, Encoder, Message, Time};
use sortie::numeric::Seed;

/// What happens to a frame on its way to one receiver.
#[derive(Clone, Copy, Debug)]
pub struct Weather {
    pub loss: f64,
    pub duplication: f64,
    pub corruption: f64,
    /// Every copy takes its own time between these, so frames overtake each other.
    pub delay_ms: (u64, u64),
}

pub const CLEAR: Weather = Weather {
    loss: 0.0,
    duplication: 0.0,
    corruption: 0.0,
    delay_ms: (2, 2),
};

/// Everybody who is on the air, by number.
pub type Party = usize;

pub struct Ether {
    pub now: Time,
    pub weather: Weather,
    rng: ChaCha8Rng,
    flying: BTreeMap<(Time, u64), (Party, Party, Vec<u8>)>,
    serial: u64,
    encoders: BTreeMap<(Party, Address), Encoder>,
    decoders: BTreeMap<(Party, Party), Decoder>,
    /// Frames that were put on the air.
    pub frames: u64,
}

impl Ether {
    pub fn new(seed: u64, weather: Weather) -> Self {
        Self {
            now: Time(0),
            weather,
            rng: Seed(seed).stream("ether", 0),
            flying: BTreeMap::new(),
            serial: 0,
            encoders: BTreeMap::new(),
            decoders: BTreeMap::new(),
            frames: 0,
        }
    }

    /// One message from one party to others, in the name of an address.
    pub fn send(&mut self, from: Party, name: Address, to: &[Party], message: &Message) {
        let encoder = self
            .encoders
            .entry((from, name))
            .or_insert_with(|| Encoder::new(name));
        let frame = encoder.encode(message);
        self.frames += 1;
        for &receiver in to {
            let copies = 1 + usize::from(self.rng.random_bool(self.weather.duplication));
            for _ in 0..copies {
                self.fly(from, receiver, frame.clone());
            }
        }
    }

    fn fly(&mut self, from: Party, receiver: Party, mut frame: Vec<u8>) {
        let (least, most) = self.weather.delay_ms;
        let arrival = self.now + self.rng.random_range(least..=most);
        if self.rng.random_bool(self.weather.loss) {
            return;
        }
        if self.rng.random_bool(self.weather.corruption) {
            let at = self.rng.random_range(0..frame.len());
            frame[at] ^= u8::try_from(self.rng.random_range(1..256_u32)).expect("a byte");
            let cut = self.rng.random_bool(0.25);
            frame.truncate(if cut { at } else { frame.len() });
        }
        self.serial += 1;
        self.flying
            .insert((arrival, self.serial), (from, receiver, frame));
    }

    pub fn next_arrival(&self) -> Option<Time> {
        self.flying.keys().next().map(|(time, _)| *time)
    }

    /// Everything that has arrived by now: receiver, sender's address, message.
    pub fn deliver(&mut self) -> Vec<(Party, Address, Message)> {
        let mut arrived = Vec::new();
        while let Some(entry) = self.flying.first_entry() {
            if entry.key().0 > self.now {
                break;
            }
            let (from, receiver, frame) = entry.remove();
            let decoder = self.decoders.entry((receiver, from)).or_default();
            decoder.push(&frame);
            while let Some((address, message)) = decoder.next_message() {
                arrived.push((receiver, address, message));
            }
        }
        arrived
    }
}

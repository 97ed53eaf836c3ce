//! A bad radio between real sockets on loopback: it loses, doubles and delays
//! datagrams both ways, from a seed.
#![allow(dead_code, unreachable_pub, missing_docs)]

use std::collections::BTreeMap;
use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use sortie::numeric::Seed;

/// What happens to a datagram, in each direction.
#[derive(Clone, Copy, Debug)]
pub struct Radio {
    pub loss: f64,
    pub duplication: f64,
    /// Each copy takes its own time up to this, so they overtake each other.
    pub delay_ms: u64,
    pub seed: u64,
}

impl Radio {
    /// Loss in percent, and a little of everything else.
    pub fn losing(percent: u32, seed: u64) -> Self {
        let is_bad = percent > 0;
        Self {
            loss: f64::from(percent) / 100.0,
            duplication: if is_bad { 0.02 } else { 0.0 },
            delay_ms: if is_bad { 3 } else { 0 },
            seed,
        }
    }
}

/// A proxy that runs until it is dropped. Whoever speaks first from another address
/// than `far` is the near side.
pub struct LossyProxy {
    pub near: SocketAddr,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl LossyProxy {
    /// Between whoever speaks to `near` and a peer that listens at `far`.
    pub fn to(far: SocketAddr, radio: Radio) -> Self {
        let near = UdpSocket::bind("127.0.0.1:0").expect("a free port");
        let there = UdpSocket::bind("127.0.0.1:0").expect("a free port");
        let address = near.local_addr().expect("bound");
        let stop = Arc::new(AtomicBool::new(false));
        let air = Air {
            sockets: [near, there],
            peers: [None, Some(far)],
            radio,
            rng: Seed(radio.seed).stream("proxy", 0),
            flying: BTreeMap::new(),
            serial: 0,
        };
        let told = Arc::clone(&stop);
        Self {
            near: address,
            stop,
            thread: Some(std::thread::spawn(move || air.run(&told))),
        }
    }
}

impl Drop for LossyProxy {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.join().expect("the proxy does not panic");
        }
    }
}

struct Air {
    /// Near side, far side.
    sockets: [UdpSocket; 2],
    peers: [Option<SocketAddr>; 2],
    radio: Radio,
    rng: ChaCha8Rng,
    /// Until when, in which order, from which side, what.
    flying: BTreeMap<(Instant, u64), (usize, Vec<u8>)>,
    serial: u64,
}

impl Air {
    fn run(mut self, stop: &AtomicBool) {
        for socket in &self.sockets {
            socket.set_nonblocking(true).expect("a socket");
        }
        while !stop.load(Ordering::Relaxed) {
            let heard = [0, 1].map(|side| self.hear(side));
            self.deliver();
            if heard == [false, false] {
                std::thread::sleep(Duration::from_micros(500));
            }
        }
    }

    fn hear(&mut self, side: usize) -> bool {
        let mut buffer = [0; 2048];
        let Ok((length, from)) = self.sockets[side].recv_from(&mut buffer) else {
            return false;
        };
        self.peers[side] = Some(from);
        let copies = 1 + usize::from(self.rng.random_bool(self.radio.duplication));
        for _ in 0..copies {
            let delay_ms = self.rng.random_range(0..=self.radio.delay_ms);
            if !self.rng.random_bool(self.radio.loss) {
                let arrival = now() + Duration::from_millis(delay_ms);
                self.serial += 1;
                let frame = buffer[..length].to_vec();
                self.flying.insert((arrival, self.serial), (side, frame));
            }
        }
        true
    }

    fn deliver(&mut self) {
        let now = now();
        while let Some(first) = self.flying.first_entry() {
            if first.key().0 > now {
                return;
            }
            let (side, frame) = first.remove();
            if let Some(to) = self.peers[1 - side] {
                // Nobody there is as good as lost.
                let _ = self.sockets[1 - side].send_to(&frame, to);
            }
        }
    }
}

#[allow(clippy::disallowed_methods, reason = "real sockets live in real time")]
fn now() -> Instant {
    Instant::now()
}

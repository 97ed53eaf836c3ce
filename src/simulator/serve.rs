//! A simulated vehicle on a real socket.

use std::collections::BTreeMap;
use std::io;
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::air::{Air, Weather};
use super::environment::Surroundings;
use super::profile::Profile;
use super::server::Vehicle;
use crate::link::{Address, Decoder, Encoder, FlightMessage, Message, MissionType, Time};
use crate::mission::{Home, Item};
use crate::spec::Airframe;

/// Longest wait on the socket, so that a stop is noticed.
const LONGEST_WAIT: Duration = Duration::from_millis(20);
/// Between two moments of a vehicle, milliseconds of its own time.
const LIVED_MS: u64 = 100;
/// Most ground stations that are answered at once; one more takes the place of the
/// one that was silent for longest.
const MAX_PARTNERS: usize = 16;

/// What a simulated vehicle is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Simulated {
    /// Which autopilot it plays.
    pub profile: Profile,
    /// What flies.
    pub airframe: Airframe,
    /// Fence items that it keeps; none: those of its autopilot.
    pub fence_points: Option<usize>,
    /// Its system id.
    pub sysid: u8,
    /// Its home, once it has one.
    pub home: Option<Home>,
    /// Where it listens; port 0 takes any free one.
    pub listen: SocketAddr,
    /// A ground station that it speaks to before it is spoken to.
    pub speak_to: Option<SocketAddr>,
    /// What happens to its frames, and to those for it.
    pub weather: Weather,
}

impl Simulated {
    /// A copter on a free loopback port that waits to be spoken to.
    #[must_use]
    pub fn on_loopback(profile: Profile, sysid: u8, home: Option<Home>) -> Self {
        Self {
            profile,
            airframe: Airframe::Copter,
            fence_points: None,
            sysid,
            home,
            listen: (Ipv4Addr::LOCALHOST, 0).into(),
            speak_to: None,
            weather: Weather::default(),
        }
    }
}

/// A simulated vehicle in a thread of its own; it stops when this is dropped.
#[derive(Debug)]
pub struct Running {
    address: SocketAddr,
    vehicle: Arc<Mutex<Vehicle>>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// Starts a simulated vehicle.
///
/// # Errors
/// When the address cannot be bound.
pub fn spawn(simulated: &Simulated) -> io::Result<Running> {
    spawn_in(simulated, Surroundings::default(), 1.0)
}

/// Starts a simulated vehicle in given surroundings, with a clock of its own that goes
/// `speedup` times as fast as the wall's: flight and timers alike, as in ArduPilot's simulator.
///
/// # Errors
/// When the address cannot be bound.
pub fn spawn_in(
    simulated: &Simulated,
    surroundings: Surroundings,
    speedup: f64,
) -> io::Result<Running> {
    let socket = UdpSocket::bind(simulated.listen)?;
    let address = socket.local_addr()?;
    let vehicle = Vehicle::within(
        simulated.profile,
        simulated.sysid,
        simulated.home,
        surroundings,
        Time::default(),
    )
    .on(simulated.airframe)
    .keeps(simulated.fence_points);
    let vehicle = Arc::new(Mutex::new(vehicle));
    let stop = Arc::new(AtomicBool::new(false));
    let server = Server {
        socket,
        partners: simulated
            .speak_to
            .map(|at| (at, Partner::default()))
            .into_iter()
            .collect(),
        up: Air::new(simulated.weather, simulated.sysid, "up"),
        down: Air::new(simulated.weather, simulated.sysid, "down"),
        vehicle: Arc::clone(&vehicle),
        stop: Arc::clone(&stop),
        speedup,
        lived: Time::default(),
    };
    let thread = std::thread::Builder::new()
        .name(format!("vehicle {}", simulated.sysid))
        .spawn(move || server.run())?;
    Ok(Running {
        address,
        vehicle,
        stop,
        thread: Some(thread),
    })
}

impl Running {
    /// Where it can be reached.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// What it holds, without home.
    #[must_use]
    pub fn items(&self, list: MissionType) -> Vec<Item> {
        lock(&self.vehicle).items(list).to_vec()
    }

    /// Starts the motors, or stops them.
    pub fn set_armed(&self, armed: bool) {
        lock(&self.vehicle).set_armed(armed);
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A panic in there has been printed already.
            let _ = thread.join();
        }
    }
}

fn lock(vehicle: &Mutex<Vehicle>) -> MutexGuard<'_, Vehicle> {
    vehicle.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A ground station: what it sent, and who it says it is.
#[derive(Default)]
struct Partner {
    decoder: Decoder,
    names: Vec<Address>,
    heard: Time,
}

struct Server {
    socket: UdpSocket,
    partners: BTreeMap<SocketAddr, Partner>,
    /// Frames from ground stations.
    up: Air,
    /// Frames to them.
    down: Air,
    vehicle: Arc<Mutex<Vehicle>>,
    stop: Arc<AtomicBool>,
    speedup: f64,
    /// Until when the vehicle has lived.
    lived: Time,
}

impl Server {
    fn run(mut self) {
        #[allow(
            clippy::disallowed_methods,
            reason = "a vehicle on a real socket lives in real time"
        )]
        let began = Instant::now();
        let speedup = self.speedup;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "milliseconds of one run"
        )]
        let now = || Time((began.elapsed().as_secs_f64() * 1000.0 * speedup) as u64);
        let mut encoder = Encoder::new(lock(&self.vehicle).address());
        let mut buffer = [0; 2048];
        while !self.stop.load(Ordering::Relaxed) {
            let due = lock(&self.vehicle).poll_timeout();
            let due = [self.up.next_arrival(), self.down.next_arrival()]
                .into_iter()
                .flatten()
                .fold(due, Time::min);
            #[expect(clippy::cast_precision_loss, reason = "milliseconds of one run")]
            let wait = Duration::from_secs_f64((due - now()) as f64 / 1000.0 / speedup);
            // A read timeout of zero would mean "for ever".
            let wait = wait.clamp(Duration::from_millis(1), LONGEST_WAIT);
            if self.socket.set_read_timeout(Some(wait)).is_err() {
                return;
            }
            if let Ok((length, from)) = self.socket.recv_from(&mut buffer) {
                let frame = buffer.get(..length).unwrap_or_default();
                self.up.send(now(), from, frame.to_vec());
            }
            while let Some((from, frame)) = self.up.arrived(now()) {
                self.receive(now(), from, &frame);
            }
            self.live_until(now(), &mut encoder);
            while let Some((to, frame)) = self.down.arrived(now()) {
                // A partner that is gone does not receive it, as on any radio.
                let _ = self.socket.send_to(&frame, to);
            }
        }
    }

    /// The vehicle lives all of its time: after a stall of the machine it says what it would have
    /// said meanwhile.
    fn live_until(&mut self, now: Time, encoder: &mut Encoder) {
        loop {
            self.lived = (self.lived + LIVED_MS).min(now);
            let lived = self.lived;
            lock(&self.vehicle).handle_timeout(lived);
            loop {
                let message = lock(&self.vehicle).poll_transmit();
                let Some(message) = message else { break };
                self.send(now, encoder, &message);
            }
            if lived >= now {
                return;
            }
        }
    }

    fn receive(&mut self, now: Time, from: SocketAddr, bytes: &[u8]) {
        if !self.partners.contains_key(&from) && self.partners.len() >= MAX_PARTNERS {
            let silent = self.partners.iter().min_by_key(|(_, other)| other.heard);
            if let Some(silent) = silent.map(|(address, _)| *address) {
                self.partners.remove(&silent);
            }
        }
        let partner = self.partners.entry(from).or_default();
        partner.heard = now;
        partner.decoder.push(bytes);
        while let Some((name, message)) = partner.decoder.next_message() {
            if !partner.names.contains(&name) {
                partner.names.push(name);
            }
            lock(&self.vehicle).handle(now, name, &message);
        }
    }

    /// A message for one ground station goes only there, everything else to all.
    fn send(&mut self, now: Time, encoder: &mut Encoder, message: &Message) {
        let frame = encoder.encode(message);
        for (address, partner) in &self.partners {
            let is_meant = match message {
                Message::Mission(mission) => partner.names.contains(&mission.target),
                Message::Flight(FlightMessage::CommandAck { target, .. }) => {
                    partner.names.contains(target)
                }
                _ => true,
            };
            if is_meant {
                self.down.send(now, *address, frame.clone());
            }
        }
    }
}

//! Five vehicles on real sockets at four times real time, each behind a hostile peer, and the program as a process of its
//! own: everything that goes wrong at once, and every line that the operator reads is held against what the vehicles said.
#![cfg(unix)]
#![allow(clippy::disallowed_methods, reason = "real sockets live in real time")]

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::net::{SocketAddr, UdpSocket};
use std::path::Path;
use std::process::{Child, Command as Process, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use assert_cmd::cargo::cargo_bin;
use sortie::dispatch::dispatch;
use sortie::link::*;
use sortie::mission::VehicleMission;
use sortie::simulator::{Running, Simulated, Surroundings, spawn_in};
use sortie::spec::SpecFile;

use crate::support::in_flight::planned;
use crate::support::ports;
use crate::support::sky::{US, parameters};

const IDS: [&str; 5] = ["alpha", "bravo", "charlie", "delta", "echo"];
const SPEEDUP: f64 = 4.0;
/// Echo is not heard from and to these times after its start, seconds of its own time.
const CUTS_S: [(f64, f64); 2] = [(20.0, 36.0), (52.0, 66.0)];
/// Until a link is said to be lost or back, seconds of the vehicles' time: a machine may be busy.
const NOTICED_S: f64 = 25.0;
/// From here on a vehicle has an emergency, and takes no order; another one's battery is empty.
const EMERGENCY_S: f64 = 30.0;
/// Bravo refuses to arm for so long, and the others, once armed, disarm themselves after 10 s.
const REFUSES_S: f64 = 13.0;
const ARMED: u8 = 128;

/// Lanes of a kilometre, 900 m apart; copters of ArduPilot and PX4 take turns.
fn spec() -> String {
    let mut text = "
sortie: 2
name: five
area: {south_west: {lat: 36.27, lon: -84.30}, north_east: {lat: 36.35, lon: -84.20}, min_agl_m: 30, max_amsl_m: 900}
terrain: {flat: {amsl_m: 400}}
separation: {distance_m: 100, time_slack_s: 5}
on_alarm: {text: {who: vehicle, do: hold}}
planner: {algorithm: msfoa, seed: 1, evaluations: 1000}
vehicles:
"
    .to_owned();
    for (id, sysid) in IDS.iter().zip(1_u8..) {
        let lat_deg = 36.276 + 0.008 * f64::from(sysid);
        let autopilot = ["px4", "ardupilot"][usize::from(sysid % 2)];
        text += &format!(
            "  - {{id: {id}, sysid: {sysid}, autopilot: {autopilot}, link: sim, speed_mps: 8, climb_mps: 3, descent_mps: 2,
     start: {{lat: {lat_deg:.3}, lon: -84.265, agl_m: 60}}, goal: {{lat: {lat_deg:.3}, lon: -84.260, agl_m: 60}}, finish: land}}\n"
        );
    }
    text
}

/// What the vehicles themselves said, and when they were started.
#[derive(Default)]
struct Truth {
    armed: [bool; 5],
    first_arming: Option<Instant>,
    started: [Option<Instant>; 5],
}

impl Truth {
    /// Seconds of a vehicle's time since its start; below 0 before it.
    fn t_s(&self, index: usize) -> f64 {
        let started = self.started[index];
        started.map_or(-1.0, |at| SPEEDUP * at.elapsed().as_secs_f64())
    }
}

fn is_within(spans: &[(f64, f64)], t_s: f64, more_s: f64) -> bool {
    let is_in = |(from_s, to_s): &(f64, f64)| (*from_s..to_s + more_s).contains(&t_s);
    spans.iter().any(is_in)
}

fn ack(target: Address, command: u16, result: CommandResult) -> Message {
    Message::Flight(FlightMessage::CommandAck {
        target,
        command,
        result,
    })
}

fn of_list(system: u8, result: MissionResult) -> Message {
    let (target, opaque_id) = (Address { system, ..US }, 0);
    Message::Mission(MissionMessage {
        target,
        mission_type: 0,
        body: Body::Ack { result, opaque_id },
    })
}

fn said(severity: u8, text: &str) -> Message {
    Message::StatusText {
        severity,
        text: text.to_owned(),
    }
}

/// Between the program and one vehicle.
struct Peer {
    index: usize,
    autopilot: Address,
    /// Where the program listens, if it does not speak first.
    listens: Option<SocketAddr>,
    truth: Arc<Mutex<Truth>>,
    number: u32,
    /// Of its positions; every tenth comes with an impossible one.
    positions: u32,
    encoders: BTreeMap<Address, Encoder>,
}

impl Peer {
    /// What is answered to a message in place of the vehicle, which never gets it; none passes it on.
    fn answer(&self, message: &Message) -> Option<Message> {
        let Message::Flight(FlightMessage::Command { order, .. }) = message else {
            return None;
        };
        let mut truth = self.truth.lock().expect("no panic");
        let arms = order.command == Command::COMPONENT_ARM_DISARM && order.params[0] > 0.5;
        let now = Instant::now();
        if arms {
            let first = *truth.first_arming.get_or_insert(now);
            let is_refused = SPEEDUP * first.elapsed().as_secs_f64() < REFUSES_S;
            let refused = ack(US, order.command, CommandResult::FAILED);
            return (self.index == 1 && is_refused).then_some(refused);
        }
        let starts = [Command::DO_SET_MODE, Command::MISSION_START].contains(&order.command);
        let is_armed = truth.armed[self.index];
        let denied = Some(ack(US, order.command, CommandResult::DENIED));
        match self.index {
            // It refuses its start after T0.
            3 if starts && is_armed => return denied,
            2 if starts && truth.t_s(2) > EMERGENCY_S => return denied,
            _ => {}
        }
        if starts && is_armed {
            truth.started[self.index].get_or_insert(now);
        }
        None
    }

    /// What is heard besides a message of the vehicle, and the message itself, unless nothing is heard.
    fn heard(&mut self, message: Message) -> Vec<(Address, Message)> {
        let mut truth = self.truth.lock().expect("no panic");
        if let Message::Heartbeat(beat) = &message {
            truth.armed[self.index] = beat.base_mode & ARMED != 0;
        }
        let (t_s, is_armed) = (truth.t_s(self.index), truth.armed[self.index]);
        drop(truth);
        if self.index == 4 && is_within(&CUTS_S, t_s, 0.0) {
            return Vec::new();
        }
        self.number += 1;
        let is_position = matches!(message, Message::Flight(FlightMessage::Position(_)));
        self.positions += u32::from(is_position);
        let mut all = self.forged(&message);
        all.extend(self.injured(&message, t_s, is_armed));
        let changed = match message {
            Message::Heartbeat(beat) if self.index == 2 && t_s > EMERGENCY_S && is_armed => {
                Message::Heartbeat(Heartbeat {
                    system_status: 6,
                    ..beat
                })
            }
            Message::Flight(FlightMessage::Health(Health::System(status)))
                if self.index == 0 && t_s > EMERGENCY_S =>
            {
                Message::Flight(FlightMessage::Health(Health::System(SystemStatus {
                    remaining: 3,
                    ..status
                })))
            }
            other => other,
        };
        all.push((self.autopilot, changed));
        all
    }

    /// Answers to others and from others, positions of a companion and impossible ones.
    fn forged(&self, message: &Message) -> Vec<(Address, Message)> {
        let mut all = Vec::new();
        let companion = Address {
            component: 191,
            ..self.autopilot
        };
        let other = Address {
            system: 255,
            component: 190,
        };
        if self.number.is_multiple_of(13) {
            for command in [
                Command::COMPONENT_ARM_DISARM,
                Command::DO_SET_MODE,
                Command::MISSION_START,
            ] {
                let accepted = CommandResult::ACCEPTED;
                all.push((self.autopilot, ack(other, command, accepted)));
                all.push((companion, ack(US, command, accepted)));
            }
        }
        if let Message::Flight(FlightMessage::Position(position)) = message {
            let at = |x| Message::Flight(FlightMessage::Position(Position { x, ..*position }));
            all.push((companion, at(position.x + 50_000)));
            if self.positions.is_multiple_of(10) {
                all.push((self.autopilot, at(900_000_001)));
            }
        }
        all
    }

    /// Texts with a forged line, another station that writes, a storm of cancellations.
    fn injured(&self, message: &Message, t_s: f64, is_armed: bool) -> Vec<(Address, Message)> {
        let mut all = Vec::new();
        if self.index == 0 {
            // More than are shown of one vehicle, half of the time.
            if self.number % 500 >= 250 {
                all.extend(vec![(self.autopilot, said(6, "noise")); 3]);
            }
            if self.number.is_multiple_of(97) {
                let forged = "\u{1b}[2Jlanded as planned\nall have landed";
                all.push((self.autopilot, said(6, forged)));
            }
        }
        let is_beat = matches!(message, Message::Heartbeat(_));
        if self.index == 2 && is_beat && is_armed && (30.0..32.0).contains(&t_s) {
            all.push((self.autopilot, said(2, "Engine failed")));
        }
        if self.index == 1 && is_beat && is_armed && t_s > EMERGENCY_S {
            let written = of_list(254, MissionResult::ACCEPTED);
            let storm = of_list(US.system, MissionResult::OPERATION_CANCELLED);
            all.push((self.autopilot, written));
            all.extend(vec![(self.autopilot, storm); 50]);
        }
        all
    }

    fn bytes(&mut self, from: Address, message: &Message) -> Vec<u8> {
        let encoder = self.encoders.entry(from);
        encoder
            .or_insert_with(|| Encoder::new(from))
            .encode(message)
    }

    /// Passes on, changes, withholds and adds, until it is stopped. Where the program listens, it speaks from one port and
    /// from another in turns.
    fn run(mut self, nears: &[UdpSocket], there: &UdpSocket, stop: &AtomicBool) {
        let (mut station, mut buffer) = (self.listens, [0; 2048]);
        let (mut up, mut down) = (Decoder::default(), Decoder::default());
        if self.listens.is_some() {
            // Its vehicle waits until it is spoken to.
            let beat = Heartbeat {
                kind: 6,
                autopilot: 8,
                base_mode: 0,
                custom_mode: 0,
                system_status: 4,
            };
            let bytes = self.bytes(US, &Message::Heartbeat(beat));
            there.send(&bytes).expect("sent");
        }
        while !stop.load(Ordering::Relaxed) {
            let from = &nears[usize::try_from(self.number).expect("small") / 400 % nears.len()];
            let mut replies = Vec::new();
            let mut is_idle = true;
            for near in nears {
                let Ok((length, at)) = near.recv_from(&mut buffer) else {
                    continue;
                };
                (station, is_idle) = (Some(at), false);
                up.push(&buffer[..length]);
                while let Some((name, message)) = up.next_message() {
                    match self.answer(&message) {
                        Some(answer) => replies.push((self.autopilot, answer)),
                        None => {
                            let bytes = self.bytes(name, &message);
                            let _ = there.send(&bytes);
                        }
                    }
                }
            }
            while let Ok(length) = there.recv(&mut buffer) {
                is_idle = false;
                down.push(&buffer[..length]);
                while let Some((_, message)) = down.next_message() {
                    replies.extend(self.heard(message));
                }
            }
            for (name, reply) in replies {
                let bytes = self.bytes(name, &reply);
                if let Some(station) = station {
                    let _ = from.send_to(&bytes, station);
                }
            }
            if is_idle {
                std::thread::sleep(Duration::from_micros(500));
            }
        }
    }
}

/// All of them; they stop when this is dropped.
struct Peers {
    stop: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

impl Drop for Peers {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            // A panic in there has been printed already.
            let _ = thread.join();
        }
    }
}

/// The vehicles of a spec, each with the parameters of its plan.
fn vehicles(spec: &Path) -> Vec<Running> {
    let file = SpecFile::read(spec).expect("the spec");
    let world = sortie::world::load(&file).expect("flat");
    let dispatched = dispatch(&file.spec, &world, file.spec.planner.seed, &|_| {});
    let vehicle = |(index, mission): &(usize, VehicleMission)| {
        let this = &file.spec.vehicles[*index];
        let surroundings = Surroundings {
            params: parameters(mission),
            ..Surroundings::default()
        };
        let home = Some(mission.home);
        let simulated = Simulated::on_loopback(this.autopilot.into(), this.sysid, home);
        spawn_in(&simulated, surroundings, SPEEDUP).expect("a vehicle")
    };
    dispatched.missions.iter().map(vehicle).collect()
}

/// A hostile peer before each vehicle, and the links to them.
fn peers(vehicles: &[Running], truth: &Arc<Mutex<Truth>>) -> (Peers, Vec<String>) {
    let stop = Arc::new(AtomicBool::new(false));
    let (mut threads, mut links) = (Vec::new(), Vec::new());
    for ((index, id), vehicle) in IDS.iter().enumerate().zip(vehicles) {
        let bind = || {
            let socket = UdpSocket::bind("127.0.0.1:0").expect("a free port");
            socket.set_nonblocking(true).expect("a socket");
            socket
        };
        let there = bind();
        there.connect(vehicle.address()).expect("a vehicle");
        // Delta speaks first, from two ports.
        let listens = (index == 3).then(ports::unshared);
        let nears: Vec<UdpSocket> = match listens {
            Some(_) => vec![bind(), bind()],
            None => vec![bind()],
        };
        links.push(match listens {
            Some(address) => format!("--link={id}=udpin:{address}"),
            None => format!(
                "--link={id}=udpout:{}",
                nears[0].local_addr().expect("bound")
            ),
        });
        let peer = Peer {
            index,
            autopilot: Address {
                system: u8::try_from(index + 1).expect("five"),
                component: 1,
            },
            listens,
            truth: Arc::clone(truth),
            number: 0,
            positions: 0,
            encoders: BTreeMap::new(),
        };
        let stop = Arc::clone(&stop);
        threads.push(std::thread::spawn(move || peer.run(&nears, &there, &stop)));
    }
    (Peers { stop, threads }, links)
}

fn begin(folder: &Path, links: &[String]) -> Child {
    Process::new(cargo_bin("sortie"))
        .current_dir(folder)
        .args(["fly", "five.yaml", "--upload", "--speedup", "4"])
        .args(links)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("sortie runs")
}

/// Whether a line may be read now.
fn is_true(line: &str, truth: &Truth) -> bool {
    let of = IDS.iter().position(|id| line.contains(&format!("{id}: ")));
    let index = of.unwrap_or(0);
    if line.contains(" says: ") {
        // What a vehicle says is printed as what it says, and by whom.
        let own = line.ends_with("says: Disarmed: no takeoff") && of == Some(3);
        return of == Some(0) || of == Some(2) || own;
    }
    if line.ends_with(": T0") {
        return truth.armed.iter().all(|is_armed| *is_armed);
    }
    if line.contains("landed") || line.contains("stopped its motors") {
        return of.is_some() && !truth.armed[index];
    }
    if line.contains("not confirmed") {
        return of == Some(2);
    }
    let is_cut = is_within(&CUTS_S, truth.t_s(4), NOTICED_S);
    if line.contains("link lost") || line.contains("link is back") {
        return of == Some(4) && is_cut;
    }
    let Some((_, alarm)) = line.split_once("ALARM ") else {
        return true;
    };
    let kind = alarm.split(':').next().unwrap_or_default();
    match kind {
        "battery" => of == Some(0) && truth.t_s(0) > EMERGENCY_S,
        "mission" => of == Some(1) && truth.t_s(1) > EMERGENCY_S,
        "text" => of == Some(2) && truth.t_s(2) > EMERGENCY_S,
        // It has not taken off, and is armed or was.
        "late" => of == Some(3),
        "link" | "position" => of == Some(4) && is_cut,
        _ => false,
    }
}

#[test]
fn every_line_of_a_flight_over_hostile_sockets_is_true() {
    let (folder, _) = planned("five", &spec());
    let vehicles = vehicles(&folder.path().join("five.yaml"));
    let truth = Arc::new(Mutex::new(Truth::default()));
    let (_peers, links) = peers(&vehicles, &truth);
    let mut flight = begin(folder.path(), &links);
    let shown = BufReader::new(flight.stdout.take().expect("piped"));
    let mut lines: Vec<String> = Vec::new();
    let mut untrue = Vec::new();
    for line in shown.lines() {
        let line = line.expect("text");
        // The table after the flight tells of it, and not of now.
        let is_event = line.starts_with("T0") || lines.iter().all(|of| !of.starts_with("T0"));
        let is_clean = !line.contains(|sign: char| sign.is_control());
        if !is_clean || is_event && !is_true(&line, &truth.lock().expect("no panic")) {
            untrue.push(line.clone());
        }
        lines.push(line);
    }
    let output = flight.wait_with_output().expect("it ends");
    let all = lines.join("\n") + &String::from_utf8_lossy(&output.stderr);
    assert_eq!(untrue, [""; 0], "{all}");
    assert_eq!(output.status.code(), Some(5), "{all}");
    let count = |text: &str| lines.iter().filter(|line| line.contains(text)).count();
    assert_eq!(count("all are armed: T0"), 1, "{all}");
    assert_eq!(count("link lost"), 2, "{all}");
    for (id, text) in [
        ("alpha", "disarmed itself"),
        ("alpha", "ALARM battery"),
        (
            "alpha",
            "says: \\u{1b}[2Jlanded as planned\\nall have landed",
        ),
        ("alpha", "landed, motors stopped"),
        ("bravo", "ALARM mission"),
        ("bravo", "landed, motors stopped"),
        ("charlie", "ALARM text"),
        ("charlie", "hold not confirmed"),
        ("delta", "stopped its motors before it took off"),
        ("echo", "landed, motors stopped"),
    ] {
        let is_it = |line: &&String| line.contains(&format!("{id}: ")) && line.contains(text);
        assert!(
            lines.iter().any(|line| is_it(&line)),
            "{id}: {text} in {all}"
        );
    }
    for id in IDS {
        let text = format!("{id}: sent a position that cannot be");
        assert!(count(&text) > 0, "{text} in {all}");
    }
    assert!(!truth.lock().expect("no panic").armed[3], "{all}");
}

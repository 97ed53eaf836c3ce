//! Transfers to many vehicles at once: a thread for each link, any number of
//! vehicles on each, told apart by system id.

use std::collections::BTreeMap;
use std::io;
use std::net::SocketAddr;
use std::time::{Duration, Instant};

use super::codec::{Decoder, Encoder};
use super::message::{Address, Message};
use super::report::{Failure, TransferReport, Verdict};
use super::session::{Order, Progress, Session};
use super::socket::Wire;
use super::time::Time;
use crate::mission::VehicleMission;
use crate::spec::Link;

/// Our system id, if no vehicle has it. Not 255, which other ground stations use:
/// answers to them must not be taken for answers to us.
const GROUND_STATION: u8 = 245;
/// Our component id, `MAV_COMP_ID_MISSIONPLANNER`.
const COMPONENT: u8 = 190;
/// Longest wait on a socket.
const LONGEST_WAIT: Duration = Duration::from_millis(200);

/// One vehicle's transfer.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    /// Id in the spec.
    pub vehicle: &'a str,
    /// System id in the spec.
    pub sysid: u8,
    /// How it is reached. [`Link::Sim`] must have been replaced by the address of a running vehicle.
    pub link: &'a Link,
    /// What it shall hold.
    pub mission: &'a VehicleMission,
    /// Whether refusals (armed, another vehicle than in the spec) are overridden.
    pub force: bool,
}

/// Transfers all missions at once, reads them back and compares. The reports come
/// in the order of the jobs. `progress` is told the vehicle's id and where it is,
/// from several threads, whenever that changes.
#[must_use]
pub fn upload_fleet(
    jobs: &[Job<'_>],
    progress: &(dyn Fn(&str, Progress) + Sync),
) -> Vec<TransferReport> {
    let mut links: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (index, job) in jobs.iter().enumerate() {
        links.entry(job.link.to_string()).or_default().push(index);
    }
    let us = ground_station(jobs);
    let mut reports: Vec<(usize, TransferReport)> = std::thread::scope(|scope| {
        let threads: Vec<_> = links
            .values()
            .map(|indices| {
                let shared: Vec<Job<'_>> = indices.iter().map(|&index| jobs[index]).collect();
                scope.spawn(move || (indices, run_link(&shared, us, progress)))
            })
            .collect();
        threads
            .into_iter()
            .flat_map(|thread| {
                let (indices, reports) = thread
                    .join()
                    .unwrap_or_else(|panic| std::panic::resume_unwind(panic));
                indices.iter().copied().zip(reports)
            })
            .collect()
    });
    reports.sort_by_key(|(index, _)| *index);
    reports.into_iter().map(|(_, report)| report).collect()
}

/// A system id for us that no vehicle has.
fn ground_station(jobs: &[Job<'_>]) -> Address {
    let system = (1..=GROUND_STATION)
        .rev()
        .find(|system| jobs.iter().all(|job| job.sysid != *system))
        .unwrap_or(GROUND_STATION);
    Address {
        system,
        component: COMPONENT,
    }
}

/// All vehicles of one link.
fn run_link(
    jobs: &[Job<'_>],
    us: Address,
    progress: &(dyn Fn(&str, Progress) + Sync),
) -> Vec<TransferReport> {
    let Some(first) = jobs.first() else {
        return Vec::new();
    };
    let failure = |error: io::Error| Failure::Link {
        link: first.link.to_string(),
        error: error.to_string(),
    };
    let wire = match Wire::open(first.link) {
        Ok(wire) => wire,
        Err(error) => {
            let verdict = Verdict::Failed(failure(error));
            return jobs
                .iter()
                .map(|job| TransferReport::nothing(job.vehicle, job.sysid, verdict.clone()))
                .collect();
        }
    };
    let mut driver = Driver::new(wire, jobs, us);
    if let Err(error) = driver.run(progress) {
        let (now, failure) = (driver.now(), failure(error));
        for session in &mut driver.sessions {
            session.abort(now, failure.clone());
        }
    }
    driver
        .sessions
        .iter()
        .filter_map(|session| session.report().cloned())
        .collect()
}

/// Sockets and clock for the sessions of one link.
struct Driver<'a> {
    wire: Wire,
    sessions: Vec<Session<'a>>,
    jobs: Vec<Job<'a>>,
    shown: Vec<Option<Progress>>,
    encoder: Encoder,
    decoders: BTreeMap<SocketAddr, Decoder>,
    /// Where each system was last heard.
    routes: BTreeMap<u8, SocketAddr>,
    began: Instant,
}

impl<'a> Driver<'a> {
    fn new(wire: Wire, jobs: &[Job<'a>], us: Address) -> Self {
        let sysids: Vec<u8> = jobs.iter().map(|job| job.sysid).collect();
        let sessions = jobs.iter().map(|job| {
            let order = Order {
                vehicle: job.vehicle,
                sysid: job.sysid,
                mission: job.mission,
                force: job.force,
                others: sysids
                    .iter()
                    .copied()
                    .filter(|id| *id != job.sysid)
                    .collect(),
            };
            Session::new(order, us, Time::default())
        });
        #[allow(
            clippy::disallowed_methods,
            reason = "real vehicles answer in real time; the sessions get it as a value"
        )]
        let began = Instant::now();
        Self {
            wire,
            sessions: sessions.collect(),
            jobs: jobs.to_vec(),
            shown: vec![None; jobs.len()],
            encoder: Encoder::new(us),
            decoders: BTreeMap::new(),
            routes: BTreeMap::new(),
            began,
        }
    }

    fn now(&self) -> Time {
        Time(u64::try_from(self.began.elapsed().as_millis()).unwrap_or(u64::MAX))
    }

    /// Until every session has its report.
    fn run(&mut self, progress: &(dyn Fn(&str, Progress) + Sync)) -> io::Result<()> {
        let mut buffer = [0; 2048];
        loop {
            let now = self.now();
            for session in &mut self.sessions {
                if session.poll_timeout().is_some_and(|due| now >= due) {
                    session.handle_timeout(now);
                }
            }
            self.transmit()?;
            self.show(progress);
            let due = self.sessions.iter().filter_map(Session::poll_timeout).min();
            let Some(due) = due else { return Ok(()) };
            let wait = Duration::from_millis(due - self.now()).min(LONGEST_WAIT);
            if let Some((length, from)) = self.wire.receive(&mut buffer, wait)? {
                self.receive(from, buffer.get(..length).unwrap_or_default());
            }
        }
    }

    fn receive(&mut self, from: SocketAddr, bytes: &[u8]) {
        let now = self.now();
        let decoder = self.decoders.entry(from).or_default();
        decoder.push(bytes);
        while let Some((sender, message)) = decoder.next_message() {
            self.routes.insert(sender.system, from);
            for session in &mut self.sessions {
                session.handle(now, sender, &message);
            }
        }
    }

    fn transmit(&mut self) -> io::Result<()> {
        for (session, job) in self.sessions.iter_mut().zip(&self.jobs) {
            while let Some(message) = session.poll_transmit() {
                let system = match &message {
                    Message::Mission(mission) => mission.target.system,
                    _ => job.sysid,
                };
                let frame = self.encoder.encode(&message);
                let to = self.routes.get(&system).copied();
                if let Some(to) = to.or(self.wire.remote()) {
                    self.wire.send(&frame, to)?;
                }
            }
        }
        Ok(())
    }

    fn show(&mut self, progress: &(dyn Fn(&str, Progress) + Sync)) {
        for ((session, job), shown) in self.sessions.iter().zip(&self.jobs).zip(&mut self.shown) {
            let is = session.progress();
            if *shown != Some(is) {
                *shown = Some(is);
                progress(job.vehicle, is);
            }
        }
    }
}

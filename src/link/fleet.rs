//! Transfers to many vehicles at once: a thread for each link, any number of vehicles on
//! each, distinguished by system id.

use std::collections::BTreeMap;
use std::io;
use std::net::SocketAddr;

use super::codec::Version;
use super::ground_station::{address, free_address};
use super::io::radio::{Radio, Received};
use super::io::tlog::Tlog;
use super::message::MissionType;
use super::message::{Address, Message};
use super::time::Time;
use super::transfer::onboard::{Onboard, Reading};
use super::transfer::order::Order;
use super::transfer::report::{Failure, TransferReport, Verdict};
use super::transfer::session::{Progress, Session};
use crate::mission::VehicleMission;
use crate::spec::Link;

/// Within this time two vehicles that speak once a second are both heard, and the first
/// of them again, milliseconds.
const WATCH_MS: u64 = 2200;

/// One vehicle's transfer.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    /// Id in the spec.
    pub vehicle: &'a str,
    /// System id in the spec.
    pub sysid: u8,
    /// How it is reached. [`Link::Sim`] must have been replaced by the address of a running vehicle.
    pub link: &'a Link,
    /// The mission to transfer.
    pub mission: &'a VehicleMission,
    /// Whether refusals (armed, another vehicle than in the spec) are overridden.
    pub force: bool,
}

/// Transfers all missions at once, reads them back and compares. The reports come
/// in the order of the jobs. `progress` gets the vehicle's id and its progress, from
/// several threads, at every change.
#[must_use]
pub fn upload_fleet(
    jobs: &[Job<'_>],
    progress: &(dyn Fn(&str, Progress) + Sync),
) -> Vec<TransferReport> {
    upload_fleet_captured(jobs, None, progress)
}

/// [`upload_fleet`] with a capture of every frame sent and received.
#[must_use]
pub fn upload_fleet_captured(
    jobs: &[Job<'_>],
    tlog: Option<&Tlog>,
    progress: &(dyn Fn(&str, Progress) + Sync),
) -> Vec<TransferReport> {
    let mut links: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (index, job) in jobs.iter().enumerate() {
        links.entry(job.link.to_string()).or_default().push(index);
    }
    let all: Vec<u8> = jobs.iter().map(|job| job.sysid).collect();
    let us = |of_link: &[Job<'_>]| {
        // A fleet that has every system id leaves one free on each link.
        let own: Vec<u8> = of_link.iter().map(|job| job.sysid).collect();
        free_address(&all).unwrap_or_else(|| address(&own))
    };
    let mut reports: Vec<(usize, TransferReport)> = std::thread::scope(|scope| {
        let threads: Vec<_> = links
            .values()
            .map(|indices| {
                let shared: Vec<Job<'_>> = indices.iter().map(|&index| jobs[index]).collect();
                let us = us(&shared);
                scope.spawn(move || (indices, run_link(&shared, us, tlog, progress)))
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

/// Reads everything that one vehicle holds. Without a system id it must be the only
/// one on the link. `progress` gets the current list and the number of items read.
///
/// # Errors
/// When the vehicle does not speak, or does not give one of its lists.
pub fn download(
    link: &Link,
    sysid: Option<u8>,
    progress: &dyn Fn(MissionType, usize),
) -> Result<Onboard, Failure> {
    let us = address(sysid.as_slice());
    let failure = |error: io::Error| Failure::Link {
        link: link.to_string(),
        error: error.to_string(),
    };
    let mut radio = Radio::open(link, us, None).map_err(failure)?;
    let mut reading = Reading::new(sysid, us, radio.now());
    let mut system = sysid.unwrap_or(0);
    loop {
        reading.handle_timeout(radio.now());
        while let Some(message) = reading.poll_transmit() {
            if let Message::Mission(mission) = &message {
                system = mission.target.system;
            }
            radio
                .send(system, Version::Two, &message)
                .map_err(failure)?;
        }
        if let Some((list, items)) = reading.progress() {
            progress(list, items);
        }
        if let Some(outcome) = reading.outcome() {
            return outcome.clone();
        }
        let due = reading.poll_timeout().unwrap_or_default();
        for received in radio.receive(due).map_err(failure)? {
            match received {
                Received::Message(from, _, message) => {
                    reading.handle(radio.now(), from, &message);
                }
                Received::DuplicateSystem(sysid, at) if sysid == system => {
                    reading.abort(Failure::DuplicateSystem { sysid, at });
                }
                Received::DuplicateSystem(..) => {}
            }
        }
    }
}

/// All vehicles of one link.
fn run_link(
    jobs: &[Job<'_>],
    us: Address,
    tlog: Option<&Tlog>,
    progress: &(dyn Fn(&str, Progress) + Sync),
) -> Vec<TransferReport> {
    let Some(first) = jobs.first() else {
        return Vec::new();
    };
    let failure = |error: io::Error| Failure::Link {
        link: first.link.to_string(),
        error: error.to_string(),
    };
    let radio = match Radio::open(first.link, us, tlog) {
        Ok(radio) => radio,
        Err(error) => {
            let verdict = Verdict::Failed(failure(error));
            return jobs
                .iter()
                .map(|job| TransferReport::nothing(job.vehicle, job.sysid, verdict.clone()))
                .collect();
        }
    };
    let mut driver = Driver::new(radio, jobs, us);
    let ran = driver.run(progress).and_then(|()| driver.watch());
    if let Err(error) = ran {
        let (now, failure) = (driver.radio.now(), failure(error));
        for session in &mut driver.sessions {
            session.abort(now, failure.clone());
        }
    }
    driver.reports()
}

/// The sessions of one link.
struct Driver<'a> {
    radio: Radio<'a>,
    sessions: Vec<Session<'a>>,
    jobs: Vec<Job<'a>>,
    shown: Vec<Option<Progress>>,
    /// When the first message came.
    heard: Option<Time>,
    /// System ids that spoke from two addresses after the transfers.
    duplicates: BTreeMap<u8, [SocketAddr; 2]>,
}

impl<'a> Driver<'a> {
    fn new(radio: Radio<'a>, jobs: &[Job<'a>], us: Address) -> Self {
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
        Self {
            radio,
            sessions: sessions.collect(),
            jobs: jobs.to_vec(),
            shown: vec![None; jobs.len()],
            heard: None,
            duplicates: BTreeMap::new(),
        }
    }

    /// Until every session has its report.
    fn run(&mut self, progress: &(dyn Fn(&str, Progress) + Sync)) -> io::Result<()> {
        loop {
            let now = self.radio.now();
            for session in &mut self.sessions {
                if session.poll_timeout().is_some_and(|due| now >= due) {
                    session.handle_timeout(now);
                }
            }
            self.transmit()?;
            self.show(progress);
            let due = self.sessions.iter().filter_map(Session::poll_timeout).min();
            let Some(due) = due else { return Ok(()) };
            for received in self.radio.receive(due)? {
                self.handle(received);
            }
        }
    }

    /// Listens after the transfers on a link where any peer may speak: a transfer may end
    /// before a second vehicle with the same system id has sent its first heartbeat.
    fn watch(&mut self) -> io::Result<()> {
        let is_loaded =
            |session: &Session<'_>| session.report().is_some_and(TransferReport::is_verified);
        let Some(heard) = self.heard.filter(|_| self.radio.is_open()) else {
            return Ok(());
        };
        let until = Time(heard.0 + WATCH_MS);
        while self.sessions.iter().any(is_loaded) && self.radio.now() < until {
            for received in self.radio.receive(until)? {
                if let Received::DuplicateSystem(sysid, at) = received {
                    self.duplicates.insert(sysid, at);
                }
            }
        }
        Ok(())
    }

    /// The report of each vehicle.
    fn reports(&self) -> Vec<TransferReport> {
        let mut reports = Vec::new();
        for (session, job) in self.sessions.iter().zip(&self.jobs) {
            let mut report = session.report().cloned();
            let duplicates = self.duplicates.get(&job.sysid).filter(|_| !job.force);
            if let (Some(report), Some(&at)) = (&mut report, duplicates)
                && report.is_verified()
            {
                let sysid = job.sysid;
                report.verdict = Verdict::Failed(Failure::DuplicateSystem { sysid, at });
            }
            reports.extend(report);
        }
        reports
    }

    fn handle(&mut self, received: Received) {
        let now = self.radio.now();
        self.heard.get_or_insert(now);
        match received {
            Received::Message(sender, version, message) => {
                for session in &mut self.sessions {
                    session.hear_version(now, sender, version);
                    session.handle(now, sender, &message);
                }
            }
            Received::DuplicateSystem(sysid, at) => {
                for (session, job) in self.sessions.iter_mut().zip(&self.jobs) {
                    if job.sysid == sysid && !job.force {
                        session.abort(now, Failure::DuplicateSystem { sysid, at });
                    }
                }
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
                self.radio.send(system, session.version(), &message)?;
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

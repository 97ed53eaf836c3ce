//! The one machine that is at work in a session.

use super::clear::{Clear, Cleared};
use super::download::{Download, DownloadError};
use super::message::{Address, Message, MissionResult};
use super::time::Time;
use super::upload::{Sent, Upload, UploadError};
use crate::mission::Item;

/// A machine at work. Same driver contract as [`Upload`].
#[derive(Debug)]
pub(super) enum Task {
    Upload(Upload),
    Clear(Clear),
    Download(Download),
}

/// How a machine ended.
#[derive(Debug)]
pub(super) enum Ended {
    Sent(Result<Sent, UploadError>),
    Cleared(Result<Cleared, MissionResult>),
    /// With the vehicle's own id of the list.
    Read(Result<Vec<Item>, DownloadError>, u32),
}

impl Task {
    pub(super) fn handle(&mut self, now: Time, from: Address, message: &Message) {
        match self {
            Self::Upload(upload) => upload.handle(now, from, message),
            Self::Clear(clear) => clear.handle(now, from, message),
            Self::Download(download) => download.handle(now, from, message),
        }
    }

    pub(super) fn handle_timeout(&mut self, now: Time) {
        match self {
            Self::Upload(upload) => upload.handle_timeout(now),
            Self::Clear(clear) => clear.handle_timeout(now),
            Self::Download(download) => download.handle_timeout(now),
        }
    }

    pub(super) fn poll_transmit(&mut self) -> Option<Message> {
        match self {
            Self::Upload(upload) => upload.poll_transmit(),
            Self::Clear(clear) => clear.poll_transmit(),
            Self::Download(download) => download.poll_transmit(),
        }
    }

    pub(super) fn poll_timeout(&self) -> Option<Time> {
        match self {
            Self::Upload(upload) => upload.poll_timeout(),
            Self::Clear(clear) => clear.poll_timeout(),
            Self::Download(download) => download.poll_timeout(),
        }
    }

    /// How it ended, once it has.
    pub(super) fn ended(&self) -> Option<Ended> {
        match self {
            Self::Upload(upload) => upload.outcome().map(Ended::Sent),
            Self::Clear(clear) => clear.outcome().map(Ended::Cleared),
            Self::Download(download) => {
                let outcome = download.outcome().cloned();
                outcome.map(|outcome| Ended::Read(outcome, download.opaque_id()))
            }
        }
    }

    /// Starts of a list, and messages that were repeated.
    pub(super) fn effort(&self) -> (u32, u32) {
        match self {
            Self::Upload(upload) => upload.effort(),
            Self::Clear(clear) => (1, clear.repeats()),
            Self::Download(download) => (0, download.repeats()),
        }
    }

    /// What it does, and how many items are done.
    pub(super) fn progress(&self) -> (&'static str, usize) {
        match self {
            Self::Upload(upload) => ("sending", upload.progress()),
            Self::Clear(_) => ("clearing", 0),
            Self::Download(download) => ("reading", download.progress()),
        }
    }
}

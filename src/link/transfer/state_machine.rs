//! The current machine of a session.

use super::clear::{Clear, Cleared};
use super::download::{Download, DownloadError};
use super::upload::{Sent, Upload, UploadError};
use crate::link::message::{Address, Message, MissionResult};
use crate::link::time::Time;
use crate::mission::Item;

/// The current machine; see the [driver contract](crate::link#driver-contract).
#[derive(Debug)]
pub(crate) enum Task {
    Upload(Upload),
    Clear(Clear),
    Download(Download),
}

/// How a machine ended.
#[derive(Debug)]
pub(crate) enum Ended {
    Sent(Result<Sent, UploadError>),
    Cleared(Result<Cleared, MissionResult>),
    /// With the vehicle's own id of the list.
    Read(Result<Vec<Item>, DownloadError>, u32),
    /// The vehicle gives the list the known id.
    Unchanged,
}

impl Task {
    pub(crate) fn handle(&mut self, now: Time, from: Address, message: &Message) {
        match self {
            Self::Upload(upload) => upload.handle(now, from, message),
            Self::Clear(clear) => clear.handle(now, from, message),
            Self::Download(download) => download.handle(now, from, message),
        }
    }

    pub(crate) fn handle_timeout(&mut self, now: Time) {
        match self {
            Self::Upload(upload) => upload.handle_timeout(now),
            Self::Clear(clear) => clear.handle_timeout(now),
            Self::Download(download) => download.handle_timeout(now),
        }
    }

    pub(crate) fn poll_transmit(&mut self) -> Option<Message> {
        match self {
            Self::Upload(upload) => upload.poll_transmit(),
            Self::Clear(clear) => clear.poll_transmit(),
            Self::Download(download) => download.poll_transmit(),
        }
    }

    pub(crate) fn poll_timeout(&self) -> Option<Time> {
        match self {
            Self::Upload(upload) => upload.poll_timeout(),
            Self::Clear(clear) => clear.poll_timeout(),
            Self::Download(download) => download.poll_timeout(),
        }
    }

    /// How it ended, once it has.
    pub(crate) fn ended(&self) -> Option<Ended> {
        match self {
            Self::Upload(upload) => upload.outcome().map(Ended::Sent),
            Self::Clear(clear) => clear.outcome().map(Ended::Cleared),
            Self::Download(download) if download.is_unchanged() => Some(Ended::Unchanged),
            Self::Download(download) => {
                let outcome = download.outcome().cloned();
                outcome.map(|outcome| Ended::Read(outcome, download.opaque_id()))
            }
        }
    }

    /// Whether every item of the list that is sent went out.
    pub(crate) fn is_all_sent(&self) -> bool {
        matches!(self, Self::Upload(upload) if upload.all_sent())
    }

    /// Starts of a list, and messages that were repeated.
    pub(crate) fn effort(&self) -> (u32, u32) {
        match self {
            Self::Upload(upload) => upload.effort(),
            Self::Clear(clear) => (1, clear.repeats()),
            Self::Download(download) => (0, download.repeats()),
        }
    }

    /// Its stage, and the number of items done.
    pub(crate) fn progress(&self) -> (&'static str, usize) {
        match self {
            Self::Upload(upload) => ("sending", upload.progress()),
            Self::Clear(_) => ("clearing", 0),
            Self::Download(download) => ("reading", download.progress()),
        }
    }
}

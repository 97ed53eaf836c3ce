//! Where the system has no local sockets a flight has no session.

use std::io;
use std::path::Path;

use crate::cli::print::failure::Failure;
use crate::flight::Intervention;

/// No session.
pub(super) enum Socket {}

impl Socket {
    pub(super) fn open(_folder: &Path) -> io::Result<Self> {
        let why = "it is not available on this system";
        Err(io::Error::new(io::ErrorKind::Unsupported, why))
    }

    pub(super) fn show(&mut self, _line: &str) {
        match *self {}
    }

    pub(super) fn restore(&mut self, _folder: &Path) -> bool {
        match *self {}
    }

    pub(super) fn set_table(&mut self, _table: Vec<String>) {
        match *self {}
    }

    pub(super) fn poll(&mut self, _has_terminal: bool) -> Option<Intervention> {
        match *self {}
    }

    pub(super) fn rest(&mut self) {
        match *self {}
    }

    pub(super) fn finish(self, _code: i32, _message: &str) {
        match self {}
    }
}

/// Attaches to nothing: there are no sessions.
pub(in crate::cli) fn attach(_folder: &Path) -> Result<bool, Failure> {
    Ok(false)
}

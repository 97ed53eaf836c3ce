//! A capture of what went over the links, as ground stations keep it (`.tlog`): each
//! frame behind the microseconds since 1970 as eight bytes, big endian.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

/// A `.tlog` file that the links of one command share, both directions.
#[derive(Debug)]
pub struct Tlog {
    writing: Mutex<Writing>,
}

#[derive(Debug)]
struct Writing {
    out: BufWriter<File>,
    /// When the last frame was, microseconds since 1970.
    last_us: u64,
    /// The first thing that went wrong; a transfer does not stop for it.
    error: Option<io::Error>,
}

impl Tlog {
    /// Begins a capture.
    ///
    /// # Errors
    /// When the file cannot be created.
    pub fn create(path: &Path) -> io::Result<Self> {
        let out = BufWriter::new(File::create(path)?);
        Ok(Self {
            writing: Mutex::new(Writing {
                out,
                last_us: 0,
                error: None,
            }),
        })
    }

    /// Ends it.
    ///
    /// # Errors
    /// When a part of it could not be written.
    pub fn finish(self) -> io::Result<()> {
        let mut writing = self
            .writing
            .into_inner()
            .unwrap_or_else(PoisonError::into_inner);
        match writing.error.take() {
            Some(error) => Err(error),
            None => writing.out.flush(),
        }
    }

    /// One frame, sent or received, now; never before the last one, whatever links and clocks do.
    #[allow(
        clippy::disallowed_methods,
        reason = "a capture carries the time of each frame"
    )]
    pub(crate) fn record(&self, frame: &[u8]) {
        let mut writing = self.writing.lock().unwrap_or_else(PoisonError::into_inner);
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        let us = since.map_or(0, |since| {
            u64::try_from(since.as_micros()).unwrap_or(u64::MAX)
        });
        let us = us.max(writing.last_us);
        writing.last_us = us;
        if writing.error.is_some() {
            return;
        }
        let written = writing
            .out
            .write_all(&us.to_be_bytes())
            .and_then(|()| writing.out.write_all(frame));
        writing.error = written.err();
    }
}

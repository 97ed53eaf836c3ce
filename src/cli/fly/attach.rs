//! A terminal that is attached to the session of a flight.

use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

use super::socket::{self, ASK, END, KEEPALIVE, LINE, OLD_MS, REST};
use crate::cli::print::console::{note, out};
use crate::cli::print::failure::{Code, Failure};
use crate::flight::steady_ms;

/// The process of a flight that is not heard for as long stands still, seconds; and that is said again after as long.
const SILENT_S: u64 = 3;
const AGAIN_S: u64 = 30;

/// Whether the process of the flight goes on, as far as it says so; one of an older version does not.
struct Keepalives {
    /// Whether keepalives come, or may still come.
    is_heard: bool,
    /// Whether anything came: a keepalive does first.
    has_begun: bool,
    /// Seconds since anything was heard.
    silent_s: u64,
}

/// That a process sends no keepalives.
const NO_KEEPALIVES: u64 = u64::MAX;

impl Keepalives {
    /// From the connection on: a process that stands still already says nothing at all.
    fn begin() -> Self {
        Self {
            is_heard: true,
            has_begun: false,
            silent_s: 0,
        }
    }

    /// Takes in that nothing came for another second.
    fn miss(&mut self) -> Result<(), Failure> {
        if !self.is_heard {
            return Ok(());
        }
        self.silent_s += 1;
        let silent_s = self.silent_s;
        if silent_s == SILENT_S || silent_s.is_multiple_of(AGAIN_S) {
            out(&format!(
                "nothing heard of the process of the flight for {silent_s} s: nobody watches the fleet"
            ))?;
        }
        Ok(())
    }

    /// Takes in that something came, a keepalive or not.
    fn hear(&mut self, is_keepalive: bool) -> Result<(), Failure> {
        if !std::mem::replace(&mut self.has_begun, true) {
            self.is_heard = is_keepalive;
        }
        let silent_s = std::mem::take(&mut self.silent_s);
        if silent_s >= SILENT_S {
            out(&format!(
                "the process of the flight goes on, after about {silent_s} s"
            ))?;
        }
        Ok(())
    }

    /// Its silence for the keyboard, seconds.
    fn silence(&self) -> u64 {
        if self.is_heard {
            self.silent_s
        } else {
            NO_KEEPALIVES
        }
    }
}

/// Attaches to the session of a flight, if one answers: its lines are shown, lines of the keyboard
/// are its orders. Returns when the flight has ended well (true), or at once if no session answers (false).
///
/// # Errors
/// The failure of the flight, or a session that ended without a verdict.
pub(in crate::cli) fn attach(folder: &Path) -> Result<bool, Failure> {
    let Ok(stream) = UnixStream::connect(socket::path(folder)) else {
        return Ok(false);
    };
    let silence_s = Arc::new(AtomicU64::new(0));
    let mut answers = stream.try_clone().ok();
    if let Ok(orders) = stream.try_clone() {
        note("[h]old, [l]and, [q]uit and leave flying; Ctrl-C detaches");
        let silence_s = Arc::clone(&silence_s);
        std::thread::spawn(move || pass_orders(orders, &silence_s));
    }
    let lines = read_lines(stream);
    let mut keepalives = Keepalives::begin();
    loop {
        let line = match lines.recv_timeout(Duration::from_secs(1)) {
            Ok(line) => line,
            Err(RecvTimeoutError::Timeout) => {
                keepalives.miss()?;
                silence_s.store(keepalives.silence(), Ordering::Relaxed);
                continue;
            }
            Err(RecvTimeoutError::Disconnected) => break,
        };
        keepalives.hear(line.starts_with(KEEPALIVE))?;
        let mut signs = line.chars();
        match signs.next() {
            Some(LINE) => out(signs.as_str())?,
            Some(KEEPALIVE) => {
                keepalives.is_heard = signs.as_str() != REST;
                // A terminal that stands still, or takes no more lines, does not get here.
                if signs.as_str() == ASK
                    && let Some(session) = &mut answers
                {
                    // One that is gone is noticed when it is read.
                    let _ = writeln!(session, "{KEEPALIVE}");
                }
            }
            Some(END) => {
                let code = signs.as_str().parse().unwrap_or(1);
                return match code {
                    0 => Ok(true),
                    code => Err(Failure::new(Code::of(code), "")),
                };
            }
            _ => {}
        }
        silence_s.store(keepalives.silence(), Ordering::Relaxed);
    }
    let message = "the session of the flight ended without a verdict; take the flight over with `sortie watch`";
    Err(Failure::new(Failure::TRANSFER, message))
}

/// The lines of a session, until it ends.
fn read_lines(stream: UnixStream) -> Receiver<String> {
    let (send, lines) = channel();
    std::thread::spawn(move || {
        for line in BufReader::new(stream).lines() {
            let Ok(line) = line else { return };
            if send.send(line).is_err() {
                return;
            }
        }
    });
    lines
}

/// Passes lines of the keyboard on, until either side ends.
fn pass_orders(mut session: UnixStream, silence_s: &AtomicU64) {
    for line in std::io::stdin().lock().lines() {
        let Ok(line) = line else { return };
        let order = match line.trim().to_ascii_lowercase().as_str() {
            "h" | "hold" => "hold",
            "l" | "land" => "land",
            "q" | "quit" | "leave" => "leave",
            "" => continue,
            other => {
                note(&format!(
                    "{other:?} is none of h, l and q: nothing was changed"
                ));
                continue;
            }
        };
        let silence_s = silence_s.load(Ordering::Relaxed);
        let line = match silence_s {
            // One of an older version knows no times of orders.
            NO_KEEPALIVES => order.to_owned(),
            _ => format!("{order} {}", steady_ms()),
        };
        if (SILENT_S..NO_KEEPALIVES).contains(&silence_s) {
            let within_s = OLD_MS / 1000;
            note(&format!(
                "nothing heard of the process of the flight for {silence_s} s: it carries out the order to {order} only if it goes on within {within_s} s"
            ));
        }
        if writeln!(session, "{line}").is_err() {
            return;
        }
    }
}

//! A terminal that is attached to the session of a flight.

use std::io::{BufRead, BufReader, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;

use super::socket::{self, END, LINE};
use crate::cli::print::console::{note, out};
use crate::cli::print::failure::{Code, Failure};

/// Attaches to the session of a flight, if one answers: its lines are shown, lines of the keyboard
/// are its orders. Returns when the flight is over.
///
/// # Errors
/// The failure of the flight, or a session that ended without a verdict.
pub(in crate::cli) fn attach(folder: &Path) -> Result<bool, Failure> {
    let Ok(stream) = UnixStream::connect(socket::path(folder)) else {
        return Ok(false);
    };
    if let Ok(orders) = stream.try_clone() {
        note("[h]old, [l]and, [q]uit and leave flying; Ctrl-C detaches");
        std::thread::spawn(move || pass_orders(orders));
    }
    for line in BufReader::new(stream).lines() {
        let Ok(line) = line else { break };
        let mut signs = line.chars();
        match signs.next() {
            Some(LINE) => out(signs.as_str())?,
            Some(END) => {
                let code = signs.as_str().parse().unwrap_or(1);
                return match code {
                    0 => Ok(true),
                    code => Err(Failure::new(Code::of(code), "")),
                };
            }
            _ => {}
        }
    }
    let message = "the session of the flight ended without a verdict; take the flight over with `sortie watch`";
    Err(Failure::new(Failure::TRANSFER, message))
}

/// Passes lines of the keyboard on, until either side ends.
fn pass_orders(mut session: UnixStream) {
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
        if writeln!(session, "{order}").is_err() {
            return;
        }
    }
}

//! The session of a flight: a local socket in the folder of its records, mode 0600, that
//! terminals attach to with `sortie watch`. One of them commands, the others watch.
//!
//! Lines to a terminal begin with a mark: [`LINE`] is shown, [`END`] carries the exit code of the
//! flight, [`KEEPALIVE`] comes each second while the flight is watched, with [`ASK`] where an answer is waited for, and with
//! [`REST`] when that is over. Lines from a terminal are such answers, a [`KEEPALIVE`] alone, and orders: `hold`, `land`,
//! `leave`, and when they were given, milliseconds on the clock of the computer that nobody sets.

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::os::unix::fs::{DirBuilderExt, PermissionsExt};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};

use crate::flight::{Intervention, steady_ms};
use crate::numeric::text::escaped;

/// Marks of lines to a terminal.
pub(super) const LINE: char = '=';
pub(super) const END: char = '!';
pub(super) const KEEPALIVE: char = '~';
pub(super) const ASK: &str = "?";
pub(super) const REST: &str = "rest";
/// A terminal that commands and has answered no keepalive for this long stands still: another one commands if it orders
/// something, milliseconds.
const SILENT_MS: u64 = 5000;
/// Between two keepalives, milliseconds.
const KEEPALIVE_MS: u64 = 1000;
/// An order that was given longer ago is not carried out, milliseconds: the process of the flight stood still, and the
/// fleet is elsewhere.
pub(super) const OLD_MS: u64 = 5000;
/// Terminals that are attached at once, at most.
const MAX_CLIENTS: usize = 16;
/// Bytes that wait for a terminal, at most: one that does not read is let go of.
const MAX_WAITING: usize = 256 * 1024;
/// Longest order, bytes.
const MAX_ORDER: usize = 256;
/// Lines that a terminal gets when it attaches, at most.
const MAX_HISTORY: usize = 200;

/// Where the session of a flight is reached.
pub(super) fn path(folder: &Path) -> PathBuf {
    folder.join("session.sock")
}

/// The session of a flight.
pub(super) struct Socket {
    listener: UnixListener,
    path: PathBuf,
    clients: Vec<Client>,
    history: VecDeque<String>,
    /// The table of the fleet, for a terminal that attaches.
    table: Vec<String>,
    /// When the last keepalive was sent, milliseconds.
    keepalive_ms: u64,
}

/// An attached terminal.
struct Client {
    stream: UnixStream,
    inbox: Vec<u8>,
    outbox: VecDeque<u8>,
    is_gone: bool,
    /// Whether it was informed that it commands.
    commands: bool,
    /// When it was heard last, milliseconds; none before it has answered a keepalive, as older ones never do.
    heard_ms: Option<u64>,
}

impl Socket {
    /// Opens the session. The caller holds the flight, so that a socket that is there already is
    /// one that a crash left.
    pub(super) fn open(folder: &Path) -> io::Result<Self> {
        Ok(Self {
            listener: listen(folder)?,
            path: path(folder),
            clients: Vec::new(),
            history: VecDeque::new(),
            table: Vec::new(),
            keepalive_ms: 0,
        })
    }

    /// Opens it again where its folder was moved or deleted; whether it was.
    pub(super) fn restore(&mut self, folder: &Path) -> bool {
        if std::fs::symlink_metadata(&self.path).is_ok() {
            return false;
        }
        // Without the folder there is no session, until it is there again.
        match listen(folder) {
            Ok(listener) => {
                self.listener = listener;
                true
            }
            Err(_) => false,
        }
    }

    /// Shows a line to every terminal.
    pub(super) fn show(&mut self, line: &str) {
        let line = format!("{LINE}{}\n", escaped(line));
        for client in &mut self.clients {
            client.send(&line);
        }
        self.history.push_back(line);
        if self.history.len() > MAX_HISTORY {
            self.history.pop_front();
        }
    }

    /// Sets the table of the fleet.
    pub(super) fn set_table(&mut self, table: Vec<String>) {
        self.table = table;
    }

    /// Admits terminals, and takes the order of the one that commands. While the flight has a
    /// terminal of its own, that one does.
    pub(super) fn poll(&mut self, has_terminal: bool) -> Option<Intervention> {
        self.admit();
        let now_ms = steady_ms();
        if now_ms.abs_diff(self.keepalive_ms) >= KEEPALIVE_MS {
            self.keepalive_ms = now_ms;
            self.send_keepalive(ASK);
        }
        let has_commander = has_terminal || self.clients.iter().any(|of| of.commands);
        if let Some(first) = self.clients.first_mut().filter(|_| !has_commander) {
            first.commands = true;
            first.send(&format!("{LINE}this terminal commands the flight\n"));
        }
        self.take_orders(now_ms, has_terminal)
    }

    /// Whether the terminal that commands stands still.
    fn is_commander_silent(&self, now_ms: u64) -> bool {
        let commander = self.clients.iter().find(|of| of.commands);
        let heard_ms = commander.and_then(|of| of.heard_ms);
        heard_ms.is_some_and(|heard_ms| now_ms.saturating_sub(heard_ms) > SILENT_MS)
    }

    fn take_orders(&mut self, now_ms: u64, has_terminal: bool) -> Option<Intervention> {
        let mut order = None;
        let mut passes_to = None;
        let is_free = !has_terminal && self.is_commander_silent(now_ms);
        for (index, client) in self.clients.iter_mut().enumerate() {
            client.flush();
            for line in client.orders() {
                if line.starts_with(KEEPALIVE) {
                    client.heard_ms = Some(now_ms);
                    continue;
                }
                let (what, given_ms) = order_of(&line);
                let wants = match what {
                    "hold" => Intervention::Hold,
                    "land" => Intervention::Land,
                    "leave" => Intervention::Leave,
                    _ => {
                        client.send(&format!("{LINE}an order is hold, land or leave\n"));
                        continue;
                    }
                };
                let age_ms = given_ms.map_or(0, |given_ms| now_ms.saturating_sub(given_ms));
                if age_ms > OLD_MS {
                    let age_s = age_ms / 1000;
                    client.send(&format!(
                        "{LINE}the order to {what} was given {age_s} s ago, while this flight stood still: it is not carried out, give it again\n"
                    ));
                } else if client.commands && !has_terminal {
                    order = order.or(Some(wants));
                } else if is_free && passes_to.is_none() {
                    (passes_to, order) = (Some(index), order.or(Some(wants)));
                } else {
                    client.send(&format!("{LINE}another terminal commands this flight\n"));
                }
            }
        }
        if let Some(index) = passes_to {
            self.pass_command_to(index);
        }
        self.clients.retain(|client| !client.is_gone);
        order
    }

    fn pass_command_to(&mut self, index: usize) {
        let silent_s = SILENT_MS / 1000;
        self.show(&format!(
            "the terminal that commanded has not answered for more than {silent_s} s: another one commands"
        ));
        for (at, client) in self.clients.iter_mut().enumerate() {
            client.commands = at == index;
        }
        if let Some(client) = self.clients.get_mut(index) {
            client.send(&format!("{LINE}this terminal commands the flight\n"));
        }
    }

    fn send_keepalive(&mut self, what: &str) {
        for client in &mut self.clients {
            client.send(&format!("{KEEPALIVE}{what}\n"));
        }
    }

    /// The flight is over, and no keepalive comes while it is judged.
    pub(super) fn rest(&mut self) {
        self.send_keepalive(REST);
    }

    fn admit(&mut self) {
        while let Ok((stream, _)) = self.listener.accept() {
            if self.clients.len() >= MAX_CLIENTS || stream.set_nonblocking(true).is_err() {
                continue;
            }
            let mut client = Client {
                stream,
                inbox: Vec::new(),
                outbox: VecDeque::new(),
                is_gone: false,
                commands: false,
                heard_ms: None,
            };
            client.send(&format!("{KEEPALIVE}{ASK}\n"));
            let table = self.table.iter();
            let table = table.map(|row| format!("{LINE}{}\n", escaped(row)));
            for line in self.history.iter().cloned().chain(table) {
                client.send(&line);
            }
            client.send(&format!(
                "{LINE}attached: Ctrl-C detaches, the flight goes on\n"
            ));
            self.clients.push(client);
        }
    }

    /// Ends the session with the exit code of the flight.
    pub(super) fn finish(mut self, code: i32, message: &str) {
        if !message.is_empty() {
            self.show(message);
        }
        for client in &mut self.clients {
            client.send(&format!("{END}{code}\n"));
            // The last lines are waited for, but not without end.
            let wait = Some(std::time::Duration::from_secs(2));
            let _ = client.stream.set_nonblocking(false);
            let _ = client.stream.set_write_timeout(wait);
            client.flush();
        }
    }
}

/// Listens in the folder of the records.
fn listen(folder: &Path) -> io::Result<UnixListener> {
    let path = path(folder);
    // Nobody else enters the folder in which it is made, until its mode is set.
    let closed = folder.join(format!(".session.{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&closed);
    std::fs::DirBuilder::new().mode(0o700).create(&closed)?;
    let made = closed.join("s");
    let opened = UnixListener::bind(&made).and_then(|listener| {
        std::fs::set_permissions(&made, std::fs::Permissions::from_mode(0o600))?;
        listener.set_nonblocking(true)?;
        std::fs::rename(&made, &path)?;
        Ok(listener)
    });
    let _ = std::fs::remove_dir_all(&closed);
    opened
}

/// An order and when it was given; older terminals do not say that.
fn order_of(line: &str) -> (&str, Option<u64>) {
    let mut words = line.split_whitespace();
    let what = words.next().unwrap_or_default();
    (what, words.next().and_then(|word| word.parse().ok()))
}

impl Drop for Socket {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.path);
    }
}

impl Client {
    fn send(&mut self, line: &str) {
        if self.outbox.len() + line.len() > MAX_WAITING {
            self.is_gone = true;
        } else {
            self.outbox.extend(line.as_bytes());
            self.flush();
        }
    }

    fn flush(&mut self) {
        while !self.outbox.is_empty() && !self.is_gone {
            let (front, _) = self.outbox.as_slices();
            match self.stream.write(front) {
                Ok(0) => self.is_gone = true,
                Ok(count) => drop(self.outbox.drain(..count)),
                Err(error) if error.kind() == ErrorKind::WouldBlock => return,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => self.is_gone = true,
            }
        }
    }

    /// Whole lines that came in.
    fn orders(&mut self) -> Vec<String> {
        let mut buffer = [0; MAX_ORDER];
        match self.stream.read(&mut buffer) {
            Ok(0) => self.is_gone = true,
            Ok(count) => self.inbox.extend(buffer.iter().take(count)),
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(_) => self.is_gone = true,
        }
        let mut orders = Vec::new();
        while let Some(end) = self.inbox.iter().position(|byte| *byte == b'\n') {
            let line: Vec<u8> = self.inbox.drain(..=end).collect();
            orders.push(String::from_utf8_lossy(&line).trim().to_owned());
        }
        self.is_gone |= self.inbox.len() > MAX_ORDER;
        orders
    }
}

//! A serial line that is opened again when it fails: a plug that was pulled, a radio that was started again.

use std::io::{self, Read, Write};
use std::time::Duration;

use serialport::SerialPort;

use super::tcp::{closed, is_later};

/// Longest wait for the line to take what we send.
const WRITE_WAIT: Duration = Duration::from_secs(2);
/// Attempts to open a failed line before it counts as closed, and the pause between two.
const MAX_REOPENS: u32 = 10;
const REOPEN_WAIT: Duration = Duration::from_millis(300);

/// A line to one peer.
pub(crate) struct Line {
    device: String,
    baud: u32,
    /// `None` while it has failed.
    port: Option<Box<dyn SerialPort>>,
    reopens: u32,
}

impl Line {
    /// Opens a device.
    pub(crate) fn open(device: &str, baud: u32) -> io::Result<Self> {
        Ok(Self {
            device: device.to_owned(),
            baud,
            port: Some(opened(device, baud)?),
            reopens: 0,
        })
    }

    /// Waits for bytes; `None` when none came in time, or while the line has failed.
    ///
    /// # Errors
    /// When it cannot be opened again; the next call tries anew.
    pub(crate) fn receive(
        &mut self,
        buffer: &mut [u8],
        wait: Duration,
    ) -> io::Result<Option<usize>> {
        let Some(port) = &mut self.port else {
            self.reopen()?;
            return Ok(None);
        };
        let waiting = port.set_timeout(wait).map_err(io::Error::from);
        match waiting.and_then(|()| port.read(buffer)) {
            Ok(length) if length > 0 => {
                self.reopens = 0;
                return Ok(Some(length));
            }
            Err(error) if is_later(&error) => {}
            _ => self.port = None,
        }
        Ok(None)
    }

    /// Sends one frame. While the line has failed it is lost; the machines repeat it.
    pub(crate) fn send(&mut self, frame: &[u8]) {
        if let Some(port) = &mut self.port {
            let waiting = port.set_timeout(WRITE_WAIT).map_err(io::Error::from);
            let sent = waiting.and_then(|()| port.write_all(frame));
            if sent.is_err_and(|error| !is_later(&error)) {
                self.port = None;
            }
        }
    }

    fn reopen(&mut self) -> io::Result<()> {
        if self.reopens >= MAX_REOPENS {
            self.reopens = 0;
            return Err(closed());
        }
        self.reopens += 1;
        match opened(&self.device, self.baud) {
            Ok(port) => self.port = Some(port),
            Err(_) => std::thread::sleep(REOPEN_WAIT),
        }
        Ok(())
    }
}

fn opened(device: &str, baud: u32) -> io::Result<Box<dyn SerialPort>> {
    Ok(serialport::new(device, baud).timeout(WRITE_WAIT).open()?)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use serialport::TTYPort;

    #[test]
    fn a_line_that_fails_is_opened_again_when_its_device_is_there_again() {
        let folder = tempfile::tempdir().expect("a folder");
        let device = folder.path().join("radio");
        let plug_in = || {
            let (radio, port) = TTYPort::pair().expect("a pseudo terminal");
            let _ = std::fs::remove_file(&device);
            let name = port.name().expect("its name");
            std::os::unix::fs::symlink(name, &device).expect("a link");
            (radio, port)
        };
        let (mut radio, port) = plug_in();
        drop(port);
        let mut line = Line::open(&device.display().to_string(), 57_600).expect("open");
        let mut hears = |radio: &mut TTYPort| {
            let mut buffer = [0; 64];
            let wait = Duration::from_millis(20);
            (0..50).any(|_| {
                // Nobody may have opened it yet.
                let _ = radio.write_all(b"heartbeat");
                let heard = line.receive(&mut buffer, wait);
                heard.is_ok_and(|length| length.is_some())
            })
        };
        assert!(hears(&mut radio));
        drop(radio);
        let (mut radio, port) = plug_in();
        drop(port);
        assert!(hears(&mut radio));
    }
}

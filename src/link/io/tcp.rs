//! A TCP connection that is opened again when it is cut.

use std::io::{self, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::time::Duration;

/// Wait for a connection to a peer.
const CONNECT_WAIT: Duration = Duration::from_secs(5);
/// Looks for an incoming connection, and the pause between two.
const ACCEPTS: u32 = 500;
const ACCEPT_WAIT: Duration = Duration::from_millis(20);
/// Attempts to open a cut connection before it counts as closed, and the pause between two.
const MAX_REOPENS: u32 = 10;
const REOPEN_WAIT: Duration = Duration::from_millis(300);
/// Longest wait for a peer to take what we send.
const WRITE_WAIT: Duration = Duration::from_secs(2);

/// A connection to one peer.
pub(crate) struct Connection {
    /// `None` while it is cut.
    stream: Option<TcpStream>,
    /// The first peer, which stands for the later ones.
    peer: SocketAddr,
    /// Where connections come in; `None` if we connect to the peer.
    listener: Option<TcpListener>,
    reopens: u32,
}

impl Connection {
    /// Connects to a peer.
    pub(crate) fn connect(peer: SocketAddr) -> io::Result<Self> {
        let stream = TcpStream::connect_timeout(&peer, CONNECT_WAIT)?;
        Self::new(stream, peer, None)
    }

    /// Waits for the first connection that comes in.
    pub(crate) fn accept(address: &str) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        for _ in 0..ACCEPTS {
            match listener.accept() {
                Err(error) if is_later(&error) => std::thread::sleep(ACCEPT_WAIT),
                Err(error) => return Err(error),
                Ok((stream, peer)) => return Self::new(stream, peer, Some(listener)),
            }
        }
        Err(io::Error::new(
            io::ErrorKind::TimedOut,
            "nobody connected within 10 s",
        ))
    }

    fn new(stream: TcpStream, peer: SocketAddr, listener: Option<TcpListener>) -> io::Result<Self> {
        Ok(Self {
            stream: Some(prepared(stream)?),
            peer,
            listener,
            reopens: 0,
        })
    }

    pub(crate) fn peer(&self) -> SocketAddr {
        self.peer
    }

    /// Waits for bytes; `None` when none came in time, or while the connection is cut.
    ///
    /// # Errors
    /// When it cannot be opened again; the next call tries anew.
    pub(crate) fn receive(
        &mut self,
        buffer: &mut [u8],
        wait: Duration,
    ) -> io::Result<Option<usize>> {
        let Some(stream) = &mut self.stream else {
            self.reopen()?;
            return Ok(None);
        };
        let read = stream
            .set_read_timeout(Some(wait))
            .and_then(|()| stream.read(buffer));
        match read {
            Ok(length) if length > 0 => {
                self.reopens = 0;
                return Ok(Some(length));
            }
            Err(error) if is_later(&error) => {}
            _ => self.stream = None,
        }
        Ok(None)
    }

    /// Sends one frame. While the connection is cut it is lost; the machines repeat it.
    pub(crate) fn send(&mut self, frame: &[u8]) {
        if let Some(stream) = &mut self.stream
            && stream.write_all(frame).is_err()
        {
            self.stream = None;
        }
    }

    fn reopen(&mut self) -> io::Result<()> {
        if self.reopens >= MAX_REOPENS {
            self.reopens = 0;
            return Err(closed());
        }
        self.reopens += 1;
        let opened = match &self.listener {
            Some(listener) => listener.accept().map(|(stream, _)| stream),
            None => TcpStream::connect_timeout(&self.peer, REOPEN_WAIT),
        };
        match opened.and_then(prepared) {
            Ok(stream) => self.stream = Some(stream),
            Err(_) => std::thread::sleep(REOPEN_WAIT),
        }
        Ok(())
    }
}

/// The error of a stream at its end.
pub(super) fn closed() -> io::Error {
    io::Error::new(io::ErrorKind::UnexpectedEof, "closed by the other side")
}

fn prepared(stream: TcpStream) -> io::Result<TcpStream> {
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(WRITE_WAIT))?;
    Ok(stream)
}

pub(super) fn is_later(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted
    )
}

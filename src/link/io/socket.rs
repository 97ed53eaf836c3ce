//! UDP, TCP and serial lines behind one face.

use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener, TcpStream, ToSocketAddrs, UdpSocket};
use std::time::Duration;

use serialport::SerialPort;

use crate::spec::Link;

/// Wait for a TCP connection to somebody.
const CONNECT_WAIT: Duration = Duration::from_secs(5);
/// Looks for a TCP connection of somebody, and the pause between two.
const ACCEPTS: u32 = 500;
const ACCEPT_WAIT: Duration = Duration::from_millis(20);
/// Longest wait for a TCP peer to take what we send.
const WRITE_WAIT: Duration = Duration::from_secs(2);

/// An open link.
pub(crate) enum Wire {
    /// Datagrams; `remote` is where to speak before anybody was heard.
    Udp {
        socket: UdpSocket,
        remote: Option<SocketAddr>,
    },
    /// A stream to one peer.
    Tcp { stream: TcpStream, peer: SocketAddr },
    /// A line to one peer.
    Serial(Box<dyn SerialPort>),
}

/// Stands for whoever is at the other end of a serial line.
const LINE_END: SocketAddr = SocketAddr::new(std::net::IpAddr::V4(Ipv4Addr::UNSPECIFIED), 0);

impl Wire {
    /// Opens a link of a spec.
    pub(crate) fn open(link: &Link) -> io::Result<Self> {
        match link {
            Link::UdpIn(address) => Ok(Self::Udp {
                socket: UdpSocket::bind(address)?,
                remote: None,
            }),
            Link::UdpOut(address) => {
                let remote = resolve(address)?;
                let any: SocketAddr = match remote {
                    SocketAddr::V4(_) => (Ipv4Addr::UNSPECIFIED, 0).into(),
                    SocketAddr::V6(_) => (Ipv6Addr::UNSPECIFIED, 0).into(),
                };
                Ok(Self::Udp {
                    socket: UdpSocket::bind(any)?,
                    remote: Some(remote),
                })
            }
            Link::Tcp(address) => {
                let peer = resolve(address)?;
                let stream = TcpStream::connect_timeout(&peer, CONNECT_WAIT)?;
                Self::tcp(stream, peer)
            }
            Link::TcpIn(address) => {
                let (stream, peer) = accept(&TcpListener::bind(address)?)?;
                Self::tcp(stream, peer)
            }
            Link::Serial { device, baud } => {
                let port = serialport::new(device, *baud).timeout(WRITE_WAIT);
                Ok(Self::Serial(port.open()?))
            }
            Link::Sim => Err(io::Error::new(
                io::ErrorKind::Unsupported,
                "no simulated vehicle was started for it",
            )),
        }
    }

    fn tcp(stream: TcpStream, peer: SocketAddr) -> io::Result<Self> {
        stream.set_nonblocking(false)?;
        stream.set_nodelay(true)?;
        stream.set_write_timeout(Some(WRITE_WAIT))?;
        Ok(Self::Tcp { stream, peer })
    }

    /// Where to speak to before anybody was heard.
    pub(crate) fn remote(&self) -> Option<SocketAddr> {
        match self {
            Self::Udp { remote, .. } => *remote,
            Self::Tcp { peer, .. } => Some(*peer),
            Self::Serial(_) => Some(LINE_END),
        }
    }

    /// Waits for bytes; `None` when none came in time.
    pub(crate) fn receive(
        &mut self,
        buffer: &mut [u8],
        wait: Duration,
    ) -> io::Result<Option<(usize, SocketAddr)>> {
        // A read timeout of zero would mean "for ever".
        let wait = wait.max(Duration::from_millis(1));
        let received = match self {
            Self::Udp { socket, .. } => {
                socket.set_read_timeout(Some(wait))?;
                socket.recv_from(buffer)
            }
            Self::Tcp { stream, peer } => {
                stream.set_read_timeout(Some(wait))?;
                whole(stream.read(buffer), *peer)
            }
            Self::Serial(port) => {
                port.set_timeout(wait)?;
                whole(port.read(buffer), LINE_END)
            }
        };
        match received {
            Ok(received) => Ok(Some(received)),
            Err(error) if is_passing(&error) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Sends one frame.
    pub(crate) fn send(&mut self, frame: &[u8], to: SocketAddr) -> io::Result<()> {
        let sent = match self {
            Self::Udp { socket, .. } => socket.send_to(frame, to).map(|_| ()),
            Self::Tcp { stream, .. } => return stream.write_all(frame),
            Self::Serial(port) => {
                port.set_timeout(WRITE_WAIT)?;
                return port.write_all(frame);
            }
        };
        // A datagram that cannot go now is a lost one; the machines send it again.
        match sent {
            Err(error) if !is_passing(&error) && !is_unreachable(&error) => Err(error),
            _ => Ok(()),
        }
    }
}

/// Nothing there yet, or the news that nobody listens there yet.
fn is_passing(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock
            | io::ErrorKind::TimedOut
            | io::ErrorKind::Interrupted
            | io::ErrorKind::ConnectionRefused
            | io::ErrorKind::ConnectionReset
    )
}

fn is_unreachable(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::HostUnreachable
            | io::ErrorKind::NetworkUnreachable
            | io::ErrorKind::NetworkDown
    )
}

fn resolve(address: &str) -> io::Result<SocketAddr> {
    address.to_socket_addrs()?.next().ok_or_else(|| {
        io::Error::new(
            io::ErrorKind::NotFound,
            format!("{address} has no network address"),
        )
    })
}

/// The first connection that comes.
fn accept(listener: &TcpListener) -> io::Result<(TcpStream, SocketAddr)> {
    listener.set_nonblocking(true)?;
    for _ in 0..ACCEPTS {
        match listener.accept() {
            Err(error) if is_passing(&error) => std::thread::sleep(ACCEPT_WAIT),
            other => return other,
        }
    }
    Err(io::Error::new(
        io::ErrorKind::TimedOut,
        "nobody connected within 10 s",
    ))
}

/// What a stream gave; nothing at all is its end.
fn whole(read: io::Result<usize>, peer: SocketAddr) -> io::Result<(usize, SocketAddr)> {
    match read {
        Ok(0) => Err(io::Error::new(
            io::ErrorKind::UnexpectedEof,
            "closed by the other side",
        )),
        other => other.map(|length| (length, peer)),
    }
}

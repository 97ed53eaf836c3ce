//! UDP and TCP behind one face.

use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, TcpStream, ToSocketAddrs, UdpSocket};
use std::time::Duration;

use crate::spec::Link;

/// Wait for a TCP connection.
const CONNECT_WAIT: Duration = Duration::from_secs(5);
/// Longest wait for a TCP peer to take what we send.
const WRITE_WAIT: Duration = Duration::from_secs(2);

/// An open link.
#[derive(Debug)]
pub(super) enum Wire {
    /// Datagrams; `remote` is where to speak before anybody was heard.
    Udp {
        socket: UdpSocket,
        remote: Option<SocketAddr>,
    },
    /// A stream to one peer.
    Tcp { stream: TcpStream, peer: SocketAddr },
}

impl Wire {
    /// Opens a link of a spec.
    pub(super) fn open(link: &Link) -> io::Result<Self> {
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
                stream.set_nodelay(true)?;
                stream.set_write_timeout(Some(WRITE_WAIT))?;
                Ok(Self::Tcp { stream, peer })
            }
            Link::Serial { .. } => Err(unsupported("serial links come later")),
            Link::Sim => Err(unsupported("no simulated vehicle was started for it")),
        }
    }

    /// Where to speak to before anybody was heard.
    pub(super) fn remote(&self) -> Option<SocketAddr> {
        match self {
            Self::Udp { remote, .. } => *remote,
            Self::Tcp { peer, .. } => Some(*peer),
        }
    }

    /// Waits for bytes; `None` when none came in time.
    pub(super) fn receive(
        &mut self,
        buffer: &mut [u8],
        wait: Duration,
    ) -> io::Result<Option<(usize, SocketAddr)>> {
        // A read timeout of zero would mean "for ever".
        let wait = Some(wait.max(Duration::from_millis(1)));
        let received = match self {
            Self::Udp { socket, .. } => {
                socket.set_read_timeout(wait)?;
                socket.recv_from(buffer)
            }
            Self::Tcp { stream, peer } => {
                stream.set_read_timeout(wait)?;
                match stream.read(buffer) {
                    Ok(0) => Err(io::Error::new(
                        io::ErrorKind::UnexpectedEof,
                        "closed by the other side",
                    )),
                    other => other.map(|length| (length, *peer)),
                }
            }
        };
        match received {
            Ok(received) => Ok(Some(received)),
            Err(error) if is_passing(&error) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Sends one frame.
    pub(super) fn send(&mut self, frame: &[u8], to: SocketAddr) -> io::Result<()> {
        let sent = match self {
            Self::Udp { socket, .. } => socket.send_to(frame, to).map(|_| ()),
            Self::Tcp { stream, .. } => return stream.write_all(frame),
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

fn unsupported(why: &str) -> io::Error {
    io::Error::new(io::ErrorKind::Unsupported, why)
}

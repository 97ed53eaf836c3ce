//! UDP, TCP and serial lines behind one interface.

use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, ToSocketAddrs, UdpSocket};
use std::time::Duration;

use super::serial::Line;
use super::tcp::Connection;
use crate::spec::Link;

/// An open link.
pub(crate) enum Wire {
    /// Datagrams; `remote` is where to speak to before any peer was heard. On loopback it is the
    /// only one that is heard: ports there go from one program to the next, and what was spoken
    /// to the one before is not of this link.
    Udp {
        socket: UdpSocket,
        remote: Option<SocketAddr>,
    },
    /// A stream to one peer.
    Tcp(Connection),
    /// A line to one peer.
    Serial(Line),
}

/// Stands for the peer at the other end of a serial line.
const LINE_END: SocketAddr = SocketAddr::new(IpAddr::V4(Ipv4Addr::UNSPECIFIED), 0);

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
                let socket = UdpSocket::bind(any)?;
                if remote.ip().is_loopback() {
                    socket.connect(remote)?;
                }
                Ok(Self::Udp {
                    socket,
                    remote: Some(remote),
                })
            }
            Link::Tcp(address) => Ok(Self::Tcp(Connection::connect(resolve(address)?)?)),
            Link::TcpIn(address) => Ok(Self::Tcp(Connection::accept(address)?)),
            Link::Serial { device, baud } => Ok(Self::Serial(Line::open(device, *baud)?)),
            Link::Sim => Err(io::Error::new(
                io::ErrorKind::Unsupported,
                "no simulated vehicle was started for it",
            )),
        }
    }

    /// Where to speak to before any peer was heard.
    pub(crate) fn remote(&self) -> Option<SocketAddr> {
        match self {
            Self::Udp { remote, .. } => *remote,
            Self::Tcp(connection) => Some(connection.peer()),
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
            Self::Tcp(connection) => {
                let length = connection.receive(buffer, wait)?;
                return Ok(length.map(|length| (length, connection.peer())));
            }
            Self::Serial(line) => {
                let length = line.receive(buffer, wait)?;
                return Ok(length.map(|length| (length, LINE_END)));
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
            Self::Udp { socket, remote } => match remote.filter(|at| at.ip().is_loopback()) {
                Some(_) => socket.send(frame).map(|_| ()),
                None => socket.send_to(frame, to).map(|_| ()),
            },
            Self::Tcp(connection) => {
                connection.send(frame);
                return Ok(());
            }
            Self::Serial(line) => {
                line.send(frame);
                return Ok(());
            }
        };
        // A datagram that cannot go now is a lost one; the machines send it again.
        match sent {
            Err(error) if !is_passing(&error) && !is_unreachable(&error) => Err(error),
            _ => Ok(()),
        }
    }
}

/// No data yet, or the notice that no socket is open at the peer yet.
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

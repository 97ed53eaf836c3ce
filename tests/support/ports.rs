//! Ports for who binds them later: nobody else gets them in between.
#![allow(dead_code, unreachable_pub, missing_docs)]

use std::net::{SocketAddr, TcpListener, UdpSocket};
use std::sync::atomic::{AtomicU32, Ordering};

/// Below those that the system gives to sockets that ask for any port, 32768 and up: such a
/// socket, of another thread or of a peer, can take a port that was only seen to be free.
const FIRST: u32 = 20_000;
const PORTS: u32 = 12_000;

/// An address on loopback with a port that nobody has, for UDP and TCP; no other call in this
/// process gives the same one.
pub fn unshared() -> SocketAddr {
    static GIVEN: AtomicU32 = AtomicU32::new(0);
    loop {
        let nth = std::process::id().wrapping_add(GIVEN.fetch_add(1, Ordering::Relaxed));
        let port = u16::try_from(FIRST + nth % PORTS).expect("a port");
        let address = SocketAddr::from(([127, 0, 0, 1], port));
        if UdpSocket::bind(address).is_ok() && TcpListener::bind(address).is_ok() {
            return address;
        }
    }
}

//! Links that change under a flight: another port, a connection that was cut.

use crate::support::ports;
use sortie::link::{Address, Arrival, Encoder, Heartbeat, Links, Message};
use sortie::spec::Link;
use std::io::Write;
use std::net::{TcpListener, UdpSocket};
use std::time::{Duration, Instant};

/// A heartbeat of system 1 as it goes over a link.
fn beat() -> Vec<u8> {
    let vehicle = Address {
        system: 1,
        component: 1,
    };
    Encoder::new(vehicle).encode(&Message::Heartbeat(Heartbeat::OURS))
}

/// Whether a heartbeat comes in while `speak` is called ten times a second, and after how long.
fn heard(links: &Links, mut speak: impl FnMut()) -> Option<Duration> {
    #[allow(clippy::disallowed_methods)]
    let began = Instant::now();
    while began.elapsed() < Duration::from_secs(10) {
        speak();
        let arrival = links.receive(Duration::from_millis(100));
        if matches!(arrival, Some(Arrival::Message(..))) {
            return Some(began.elapsed());
        }
    }
    None
}

#[test]
fn a_vehicle_that_changes_its_port_in_flight_is_heard_and_answered_before_it_counts_as_lost() {
    let ours = ports::unshared();
    let link = Link::UdpIn(ours.to_string());
    let links = Links::open(&[(1, &link)]).expect("open");
    let sockets = [0, 1].map(|_| UdpSocket::bind(("127.0.0.1", 0)).expect("a socket"));
    for socket in &sockets {
        let after = heard(&links, || drop(socket.send_to(&beat(), ours))).expect("heard");
        assert!(after < Duration::from_millis(2400), "{after:?}");
        socket
            .set_read_timeout(Some(Duration::from_secs(5)))
            .expect("set");
        links.send(1, Message::Heartbeat(Heartbeat::OURS));
        assert!(socket.recv(&mut [0; 100]).is_ok(), "it is answered");
        // What is still under way of this one.
        while links.receive(Duration::from_millis(50)).is_some() {}
    }
}

#[test]
fn who_spoke_to_the_program_that_had_a_port_before_is_not_heard_on_loopback() {
    let [vehicle, stranger] = [0, 1].map(|_| UdpSocket::bind(("127.0.0.1", 0)).expect("a socket"));
    let link = Link::UdpOut(vehicle.local_addr().expect("bound").to_string());
    let links = Links::open(&[(1, &link)]).expect("open");
    links.send(1, Message::Heartbeat(Heartbeat::OURS));
    let (_, ours) = vehicle.recv_from(&mut [0; 100]).expect("it is spoken to");
    let mut heard = Vec::new();
    for _ in 0..5 {
        for socket in [&stranger, &vehicle] {
            socket.send_to(&beat(), ours).expect("sent");
        }
        heard.extend(links.receive(Duration::from_millis(500)));
    }
    while let Some(more) = links.receive(Duration::from_millis(100)) {
        heard.push(more);
    }
    let are_messages = heard.iter().all(|of| matches!(of, Arrival::Message(..)));
    assert!(are_messages && heard.len() == 5, "{heard:?}");
}

#[test]
fn a_cut_connection_of_a_vehicle_in_flight_is_opened_again() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a listener");
    let address = listener.local_addr().expect("an address");
    let link = Link::Tcp(address.to_string());
    let links = Links::open(&[(1, &link)]).expect("open");
    for _ in 0..3 {
        let (mut stream, _) = listener.accept().expect("it connects");
        let after = heard(&links, || drop(stream.write_all(&beat()))).expect("heard");
        assert!(after < Duration::from_secs(2), "{after:?}");
        // Cut without a word.
        drop(stream);
    }
}

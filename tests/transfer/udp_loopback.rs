//! Transfers over real sockets on loopback, to simulated vehicles.

use crate::support::{ports, transfers};
use std::io::{Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::thread;
use std::time::Duration;

use serialport::{SerialPort, TTYPort};

use sortie::link::{
    Decoder, Encoder, Failure, Job, MissionType, Refusal, Time, TransferReport, Verdict, Version,
    upload_fleet,
};
use sortie::mission::VehicleMission;
use sortie::simulator::{Profile, Running, Simulated, Vehicle, Weather, spawn};
use sortie::spec::{Autopilot, Link};
use transfers::{HOME, corner, rally, upload, waypoint};

/// Waypoints, a fence of three corners and a rally point.
fn mission(autopilot: Autopilot, items: i32) -> VehicleMission {
    VehicleMission {
        fence: [100, 5000, -3000].map(|n| corner(n, 3)).to_vec(),
        rally: vec![rally(30)],
        ..transfers::mission(autopilot, (1..=items).map(waypoint).collect())
    }
}

fn start(profile: Profile, sysid: u8) -> Running {
    spawn(&Simulated::on_loopback(profile, sysid, Some(HOME))).expect("a free port")
}

fn to(address: SocketAddr) -> Link {
    Link::UdpOut(address.to_string())
}

#[test]
fn three_vehicles_of_all_profiles_are_loaded_at_once_and_read_back() {
    let profiles = [Profile::ArduPilot, Profile::Px4, Profile::Generic];
    let vehicles: Vec<Running> = (1..).zip(profiles).map(|(id, p)| start(p, id)).collect();
    let missions = [Autopilot::ArduPilot, Autopilot::Px4, Autopilot::Px4].map(|a| mission(a, 40));
    let links: Vec<Link> = vehicles.iter().map(|v| to(v.address())).collect();
    let names = ["alpha", "bravo", "charlie"];
    let jobs: Vec<Job<'_>> = (0..3)
        .map(|n| Job {
            vehicle: names[n],
            sysid: u8::try_from(n).expect("small") + 1,
            link: &links[n],
            mission: &missions[n],
            force: false,
        })
        .collect();
    let shown = std::sync::atomic::AtomicUsize::new(0);
    let reports = upload_fleet(&jobs, &|_, _| {
        shown.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    });
    for ((report, vehicle), mission) in reports.iter().zip(&vehicles).zip(&missions) {
        assert_eq!(report.verdict, Verdict::Verified, "{report:?}");
        assert_eq!((report.items, report.fence, report.rally), (40, 3, 1));
        assert_eq!((report.hash.len(), report.attempts), (64, 3));
        assert_eq!(
            vehicle.items(MissionType::Mission).len(),
            mission.items.len()
        );
        assert_eq!(vehicle.items(MissionType::Fence).len(), 3);
        assert!(report.seconds < 5.0, "{report:?}");
    }
    assert_eq!(reports[2].autopilot, "generic autopilot vehicle");
    assert_eq!(vehicles[2].items(MissionType::Mission), missions[2].items);
    assert!(shown.into_inner() > 9);
}

#[test]
fn vehicles_behind_one_port_are_told_apart_by_system_id() {
    let ground = ports::unshared();
    let vehicles: Vec<Running> = (1..=3)
        .map(|sysid| {
            spawn(&Simulated {
                speak_to: Some(ground),
                ..Simulated::on_loopback(Profile::ArduPilot, sysid, Some(HOME))
            })
            .expect("a free port")
        })
        .collect();
    let link = Link::UdpIn(ground.to_string());
    let missions = [5, 6, 7].map(|items| mission(Autopilot::ArduPilot, items));
    let jobs: Vec<Job<'_>> = (1..=3_u8)
        .zip(&missions)
        .map(|(sysid, mission)| Job {
            vehicle: "one of three",
            sysid,
            link: &link,
            mission,
            force: false,
        })
        .collect();
    let reports = upload_fleet(&jobs, &|_, _| {});
    for (n, (report, vehicle)) in reports.iter().zip(&vehicles).enumerate() {
        assert_eq!(report.verdict, Verdict::Verified, "{report:?}");
        assert_eq!(vehicle.items(MissionType::Mission), missions[n].items);
    }
}

#[test]
fn an_old_fence_does_not_stay_silently() {
    for profile in [Profile::ArduPilot, Profile::Px4] {
        let vehicle = start(profile, 1);
        let autopilot = match profile {
            Profile::Px4 => Autopilot::Px4,
            _ => Autopilot::ArduPilot,
        };
        let fenced = mission(autopilot, 5);
        let link = to(vehicle.address());
        assert!(upload(1, &link, &fenced, false).is_verified());
        let free = VehicleMission {
            fence: Vec::new(),
            rally: Vec::new(),
            ..fenced
        };
        assert!(upload(1, &link, &free, false).is_verified());
        assert_eq!(vehicle.items(MissionType::Fence), []);
        assert_eq!(vehicle.items(MissionType::Rally), []);
        assert_eq!(vehicle.items(MissionType::Mission).len(), 5);
    }
}

#[test]
fn an_armed_vehicle_is_refused_unless_forced() {
    let vehicle = start(Profile::ArduPilot, 1);
    vehicle.set_armed(true);
    let mission = mission(Autopilot::ArduPilot, 5);
    let report = upload(1, &to(vehicle.address()), &mission, false);
    assert_eq!(report.verdict, Verdict::Refused(Refusal::Armed));
    assert_eq!(vehicle.items(MissionType::Mission), []);
    assert!(upload(1, &to(vehicle.address()), &mission, true).is_verified());
}

#[test]
fn another_autopilot_than_in_the_spec_is_refused() {
    let vehicle = start(Profile::Px4, 1);
    let mission = mission(Autopilot::ArduPilot, 5);
    let report = upload(1, &to(vehicle.address()), &mission, false);
    let Verdict::Refused(refusal) = report.verdict else {
        panic!("{report:?}");
    };
    assert_eq!(
        refusal.to_string(),
        "the spec says ArduPilot, the vehicle says PX4"
    );
    assert_eq!(vehicle.items(MissionType::Fence), []);
}

#[test]
fn another_system_id_is_refused_and_nobody_at_all_is_a_failure_within_the_deadline() {
    let vehicle = start(Profile::ArduPilot, 7);
    let mission = mission(Autopilot::ArduPilot, 5);
    let silent = UdpSocket::bind("127.0.0.1:0").expect("a free port");
    let links = [
        to(vehicle.address()),
        to(silent.local_addr().expect("bound")),
    ];
    let jobs = [0, 1].map(|n| Job {
        vehicle: ["alpha", "bravo"][n],
        sysid: u8::try_from(n).expect("small") + 1,
        link: &links[n],
        mission: &mission,
        force: false,
    });
    let reports = upload_fleet(&jobs, &|_, _| {});
    let refused = Refusal::System {
        expected: 1,
        found: 7,
    };
    assert_eq!(reports[0].verdict, Verdict::Refused(refused));
    let Verdict::Failed(failure) = &reports[1].verdict else {
        panic!("{:?}", reports[1]);
    };
    assert_eq!(
        failure.to_string(),
        "no heartbeat from system 2 within 10 s"
    );
    assert!(reports.iter().all(|report| report.seconds < 12.0));
    assert_eq!(vehicle.items(MissionType::Mission), []);
}

#[test]
fn a_link_that_cannot_be_opened_says_why() {
    let mission = mission(Autopilot::ArduPilot, 1);
    for link in [
        Link::UdpOut("127.0.0.1".to_owned()),
        Link::Tcp("127.0.0.1:1".to_owned()),
        Link::Sim,
        Link::TcpIn("192.0.2.1:5760".to_owned()),
        Link::Serial {
            device: "/dev/no-such-line".to_owned(),
            baud: 57600,
        },
    ] {
        let report = upload(1, &link, &mission, false);
        assert!(
            matches!(&report.verdict, Verdict::Failed(Failure::Link { error, .. }) if !error.is_empty()),
            "{report:?}"
        );
    }
}

/// Between a stream and a vehicle that speaks UDP, until the stream ends.
fn bridge(mut stream: impl Stream, vehicle: SocketAddr) {
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a free port");
    socket.connect(vehicle).expect("an address");
    let pause = Duration::from_millis(1);
    stream.wait_at_most(pause);
    socket.set_read_timeout(Some(pause)).expect("a socket");
    let mut buffer = [0; 512];
    loop {
        match stream.read(&mut buffer) {
            Ok(0) => return,
            // Pieces of 7 bytes: a stream knows no frames.
            Ok(length) => buffer[..length].chunks(7).for_each(|piece| {
                let _ = socket.send(piece);
            }),
            Err(_) => {}
        }
        if let Ok(length) = socket.recv(&mut buffer)
            && stream.write_all(&buffer[..length]).is_err()
        {
            return;
        }
    }
}

/// A TCP connection or a terminal.
trait Stream: Read + Write {
    fn wait_at_most(&mut self, pause: Duration);
}

impl Stream for TcpStream {
    fn wait_at_most(&mut self, pause: Duration) {
        self.set_read_timeout(Some(pause)).expect("a socket");
    }
}

impl Stream for TTYPort {
    fn wait_at_most(&mut self, pause: Duration) {
        self.set_timeout(pause).expect("a terminal");
    }
}

/// A TCP port in front of a vehicle that speaks UDP, for one connection.
fn tcp_bridge(vehicle: SocketAddr) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = listener.local_addr().expect("bound");
    std::thread::spawn(move || {
        let (stream, _) = listener.accept().expect("a connection");
        bridge(stream, vehicle);
    });
    address
}

#[test]
fn a_vehicle_behind_tcp_is_loaded_too() {
    let vehicle = start(Profile::Px4, 1);
    let mission = mission(Autopilot::Px4, 12);
    let link = Link::Tcp(tcp_bridge(vehicle.address()).to_string());
    let report = upload(1, &link, &mission, false);
    assert_eq!(report.verdict, Verdict::Verified, "{report:?}");
    assert_eq!(vehicle.items(MissionType::Mission).len(), 12);
}

#[test]
fn a_cut_connection_is_opened_again_and_the_transfer_goes_on() {
    let vehicle = start(Profile::Px4, 1);
    let address = vehicle.address();
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let link = Link::Tcp(listener.local_addr().expect("bound").to_string());
    std::thread::spawn(move || {
        let (first, _) = listener.accept().expect("a connection");
        let cut = first.try_clone().expect("a stream");
        std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(700));
            let _ = cut.shutdown(std::net::Shutdown::Both);
        });
        bridge(first, address);
        let (second, _) = listener.accept().expect("another connection");
        bridge(second, address);
    });
    let mission = mission(Autopilot::Px4, 12);
    let report = upload(1, &link, &mission, false);
    assert_eq!(report.verdict, Verdict::Verified, "{report:?}");
    assert!(report.seconds > 0.7, "over before the cut: {report:?}");
}

#[test]
fn a_vehicle_that_connects_to_us_is_loaded_too() {
    let vehicle = start(Profile::ArduPilot, 1);
    let ground = ports::unshared();
    let address = vehicle.address();
    std::thread::spawn(move || {
        let stream = std::iter::repeat_with(|| {
            std::thread::sleep(Duration::from_millis(10));
            TcpStream::connect(ground)
        });
        bridge(stream.flatten().next().expect("a connection"), address);
    });
    let mission = mission(Autopilot::ArduPilot, 12);
    let report = upload(1, &Link::TcpIn(ground.to_string()), &mission, false);
    assert_eq!(report.verdict, Verdict::Verified, "{report:?}");
    assert_eq!(vehicle.items(MissionType::Mission).len(), 12);
}

#[test]
fn a_vehicle_behind_a_serial_line_is_loaded_too() {
    let vehicle = start(Profile::Px4, 1);
    let (theirs, ours) = TTYPort::pair().expect("a pair of terminals");
    let device = ours.name().expect("a name");
    let address = vehicle.address();
    std::thread::spawn(move || bridge(theirs, address));
    let mission = mission(Autopilot::Px4, 12);
    let link = Link::Serial {
        device,
        baud: 57600,
    };
    drop(ours);
    let report = upload(1, &link, &mission, false);
    assert_eq!(report.verdict, Verdict::Verified, "{report:?}");
    assert_eq!(vehicle.items(MissionType::Mission).len(), 12);
}

#[test]
fn a_closed_connection_is_a_failure_of_the_link() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let link = Link::Tcp(listener.local_addr().expect("bound").to_string());
    let closing = std::thread::spawn(move || drop(listener.accept()));
    let report = upload(1, &link, &mission(Autopilot::Px4, 1), false);
    closing.join().expect("no panic");
    let Verdict::Failed(failure) = &report.verdict else {
        panic!("{report:?}");
    };
    let text = failure.to_string();
    assert!(text.starts_with("tcp:127.0.0.1:"), "{text}");
    assert!(text.ends_with("closed by the other side"), "{text}");
}

#[test]
fn with_force_a_single_stranger_is_loaded_by_its_own_rules() {
    // The spec says system 1 and ArduPilot; system 7 with PX4 is there.
    let vehicle = start(Profile::Px4, 7);
    let mission = mission(Autopilot::ArduPilot, 5);
    let report = upload(1, &to(vehicle.address()), &mission, true);
    assert_eq!(report.verdict, Verdict::Verified, "{report:?}");
    assert_eq!((report.sysid, report.items), (7, 5));
    assert_eq!(
        vehicle.items(MissionType::Mission).len(),
        5,
        "no home row for PX4"
    );
}

#[test]
fn a_simulated_vehicle_stops_when_it_is_dropped() {
    let address = ports::unshared();
    let vehicle = spawn(&Simulated {
        listen: address,
        ..Simulated::on_loopback(Profile::ArduPilot, 1, Some(HOME))
    })
    .expect("a free port");
    assert!(UdpSocket::bind(address).is_err(), "it has the port");
    drop(vehicle);
    UdpSocket::bind(address).expect("the port is free again");
}

/// An upload to a port to which two vehicles of one system id speak, the second one so much later.
fn uploaded_to_twins(second_after: Duration) -> TransferReport {
    let ground = ports::unshared();
    let vehicle = move || {
        spawn(&Simulated {
            speak_to: Some(ground),
            ..Simulated::on_loopback(Profile::ArduPilot, 1, Some(HOME))
        })
        .expect("a free port")
    };
    let _first = vehicle();
    let second = thread::spawn(move || {
        thread::sleep(second_after);
        vehicle()
    });
    let mission = mission(Autopilot::ArduPilot, 300);
    let report = upload(1, &Link::UdpIn(ground.to_string()), &mission, false);
    drop(second.join());
    report
}

#[test]
fn two_vehicles_with_one_system_id_on_one_link_are_never_called_loaded() {
    // Together, and when the first is loaded already.
    for second_after in [Duration::ZERO, Duration::from_millis(700)] {
        let report = uploaded_to_twins(second_after);
        let Verdict::Failed(failure) = report.verdict else {
            panic!("{second_after:?}: {report:?}");
        };
        let text = failure.to_string();
        assert!(
            text.starts_with("system 1 speaks from 127.0.0.1:"),
            "{text}"
        );
    }
}

/// A vehicle that neither reads nor writes MAVLink 2, until its socket is gone.
fn spawn_mavlink_1() -> SocketAddr {
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a free port");
    let address = socket.local_addr().expect("bound");
    let mut vehicle = Vehicle::new(Profile::ArduPilot, 1, Some(HOME), Time(0));
    let mut encoder = Encoder::new(vehicle.address());
    let mut decoder = Decoder::default();
    socket
        .set_read_timeout(Some(Duration::from_millis(5)))
        .expect("a timeout");
    std::thread::spawn(move || {
        #[allow(clippy::disallowed_methods, reason = "real sockets live in real time")]
        let began = std::time::Instant::now();
        let (mut partner, mut buffer, mut ms) = (None, [0; 512], 0);
        // Longer than the test.
        while ms < 30_000 {
            ms = u64::try_from(began.elapsed().as_millis()).expect("milliseconds");
            if let Ok((length, from)) = socket.recv_from(&mut buffer) {
                partner = Some(from);
                if buffer[0] == 0xfe {
                    decoder.push(&buffer[..length]);
                }
            }
            while let Some((from, message)) = decoder.next_message() {
                vehicle.handle(Time(ms), from, &message);
            }
            vehicle.handle_timeout(Time(ms));
            while let Some(message) = vehicle.poll_transmit() {
                let frame = encoder.encode_in(Version::One, &message);
                if let Some(partner) = partner {
                    socket.send_to(&frame, partner).expect("sent");
                }
            }
        }
    });
    address
}

#[test]
fn a_mavlink_1_vehicle_is_refused_fence_and_rally_and_takes_a_mission() {
    let fenced = mission(Autopilot::ArduPilot, 5);
    let plain = VehicleMission {
        fence: Vec::new(),
        rally: Vec::new(),
        ..fenced.clone()
    };
    let link = to(spawn_mavlink_1());
    let report = upload(1, &link, &fenced, false);
    let only = Failure::OnlyMavlink1 { fence: 3, rally: 1 };
    assert_eq!(report.verdict, Verdict::Failed(only));
    let report = upload(1, &link, &plain, false);
    assert_eq!(report.verdict, Verdict::Verified, "{report:?}");
    assert_eq!(report.items, 5);
    let said = "ArduPilot quadrotor, MAVLink 1: fence and rally cannot be asked";
    assert_eq!(report.autopilot, said);
}

#[test]
fn a_vehicle_answers_however_many_ground_stations_were_there_before() {
    let vehicle = start(Profile::Px4, 1);
    let past: Vec<UdpSocket> = (0..20)
        .map(|_| UdpSocket::bind("127.0.0.1:0").expect("a free port"))
        .collect();
    for socket in &past {
        socket.send_to(b"?", vehicle.address()).expect("sent");
    }
    let mission = mission(Autopilot::Px4, 5);
    assert!(upload(1, &to(vehicle.address()), &mission, false).is_verified());
}

#[test]
fn thirty_vehicles_are_loaded_at_once_at_5_percent_loss_each_way() {
    let vehicles: Vec<Running> = (1..=30)
        .map(|sysid| {
            let profile = [Profile::ArduPilot, Profile::Px4][usize::from(sysid % 2)];
            let loopback = Simulated::on_loopback(profile, sysid, Some(HOME));
            let weather = Weather {
                loss: 0.05,
                delay_ms: 1,
                seed: 1,
            };
            spawn(&Simulated {
                weather,
                ..loopback
            })
            .expect("a free port")
        })
        .collect();
    let autopilot = |n: usize| [Autopilot::Px4, Autopilot::ArduPilot][n % 2];
    let missions: Vec<VehicleMission> = (0..30).map(|n| mission(autopilot(n), 30)).collect();
    let links: Vec<Link> = vehicles.iter().map(|v| to(v.address())).collect();
    let jobs: Vec<Job<'_>> = (1..=30_u8)
        .zip(missions.iter().zip(&links))
        .map(|(sysid, (mission, link))| Job {
            vehicle: "one of thirty",
            sysid,
            link,
            mission,
            force: false,
        })
        .collect();
    for (report, vehicle) in upload_fleet(&jobs, &|_, _| {}).iter().zip(&vehicles) {
        assert_eq!(report.verdict, Verdict::Verified, "{report:?}");
        assert_eq!(vehicle.items(MissionType::Mission).len(), 30);
    }
}

//! MAVProxy as the ground station of a simulated vehicle, by its own command line.

use crate::support::{peers, transfers};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use sortie::link::MissionType;
use sortie::mission::{Item, command};
use sortie::simulator::{Profile, Simulated, spawn};
use tempfile::TempDir;
use transfers::HOME;

/// Home, takeoff, two waypoints, landing.
const WAYPOINTS: &str = "QGC WPL 110\n\
    0\t1\t0\t16\t0\t0\t0\t0\t36.3\t-84.25\t400.5\t1\n\
    1\t0\t3\t22\t0\t0\t0\t0\t36.3\t-84.25\t80\t1\n\
    2\t0\t3\t16\t0\t0\t0\t0\t36.31\t-84.26\t80.5\t1\n\
    3\t0\t3\t16\t0\t0\t0\t0\t36.32\t-84.26\t80.5\t1\n\
    4\t0\t3\t21\t0\t0\t0\t0\t36.32\t-84.2\t0\t1\n";

/// MAVProxy at a UDP port of this machine; it ends when this is dropped.
struct Station {
    process: Child,
    lines: Receiver<String>,
    _folder: TempDir,
}

impl Station {
    fn start(python: &Path, script: &Path, port: u16) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("m.waypoints"), WAYPOINTS).expect("a file");
        let mut process = Command::new(python)
            .current_dir(&folder)
            .env("MAVLINK20", "1")
            .env("PYTHONUNBUFFERED", "1")
            .arg(script)
            .arg(format!("--master=udpout:127.0.0.1:{port}"))
            .args(["--default-modules=wp", "--state-basedir=."])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("python starts");
        let output = BufReader::new(process.stdout.take().expect("piped"));
        let (send, lines) = channel();
        std::thread::spawn(move || {
            for line in output.lines().map_while(Result::ok) {
                if send.send(line).is_err() {
                    return;
                }
            }
        });
        Self {
            process,
            lines,
            _folder: folder,
        }
    }

    fn command(&mut self, text: &str) {
        let input = self.process.stdin.as_mut().expect("piped");
        writeln!(input, "{text}").expect("it listens");
    }

    /// Everything it says, until it says this.
    fn until(&self, text: &str) -> Vec<String> {
        let mut said = Vec::new();
        while !said.last().is_some_and(|line: &String| line.contains(text)) {
            match self.lines.recv_timeout(Duration::from_secs(30)) {
                Ok(line) => said.push(line),
                Err(_) => panic!("no `{text}` in {said:#?}"),
            }
        }
        said
    }
}

impl Drop for Station {
    fn drop(&mut self) {
        // Already gone is as good.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

#[test]
fn mavproxy_loads_lists_and_clears_the_simulated_vehicles() {
    let Some((python, script)) = peers::mavproxy() else {
        return;
    };
    for profile in [Profile::ArduPilot, Profile::Px4] {
        let vehicle = spawn(&Simulated::on_loopback(profile, 3, Some(HOME))).expect("a free port");
        let mut station = Station::start(&python, &script, vehicle.address().port());
        station.until("online system 3");
        station.command("wp load m.waypoints");
        station.until("MISSION_ACK: TYPE_MISSION: ACCEPTED");
        let held: Vec<Item> = vehicle.items(MissionType::Mission);
        let commands: Vec<u16> = held.iter().map(|item| item.command).collect();
        let sent = [
            command::NAV_TAKEOFF,
            command::NAV_WAYPOINT,
            command::NAV_WAYPOINT,
            command::NAV_LAND,
        ];
        assert!(commands.ends_with(&sent), "{profile:?}: {commands:?}");
        // MAVProxy sends row 0, home, to a PX4 as well, which takes it for an item.
        let extra = usize::from(profile == Profile::Px4);
        assert_eq!(held.len(), 4 + extra, "{profile:?}");
        assert_eq!(
            (held[1 + extra].x, held[1 + extra].y),
            (363_100_000, -842_600_000)
        );
        if profile == Profile::ArduPilot {
            // A PX4 refuses to give several items at once, as MAVProxy asks for them.
            station.command("wp list");
            let said = station.until("Saved 5 waypoints");
            assert!(
                said.iter().any(|line| line.starts_with("21 3 36.32")),
                "{said:#?}"
            );
        }
        station.command("wp clear");
        station.until("MISSION_ACK: TYPE_MISSION: ACCEPTED");
        assert_eq!(vehicle.items(MissionType::Mission), [], "{profile:?}");
    }
}

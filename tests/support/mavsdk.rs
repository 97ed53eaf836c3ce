//! A vehicle by MAVSDK: its `MissionRawServer`.
#![allow(dead_code, unreachable_pub, missing_docs)]

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use serde_json::Value;

/// MAVSDK in a process of its own; it ends when this is dropped.
pub struct Peer {
    process: Child,
    lines: Receiver<String>,
}

impl Peer {
    /// Speaks to a UDP port of this machine.
    pub fn start(python: &Path, port: u16, sysid: u8) -> Self {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/peers/vehicle_mavsdk.py");
        let mut process = Command::new(python)
            .arg(script)
            .args([port.to_string(), sysid.to_string()])
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
        let peer = Self { process, lines };
        while peer.line() != "ready" {}
        peer
    }

    fn line(&self) -> String {
        self.lines
            .recv_timeout(Duration::from_secs(20))
            .expect("the peer says something")
    }

    /// The next list that it took.
    pub fn list(&self) -> Value {
        loop {
            if let Ok(list) = serde_json::from_str::<Value>(&self.line()) {
                assert_eq!(list["result"], 1, "RESULT_SUCCESS in {list}");
                return list["items"].clone();
            }
        }
    }
}

impl Peer {
    /// The next list that it took whole; transfers that it gave up do not count.
    pub fn whole_list(&self) -> Value {
        loop {
            match serde_json::from_str::<Value>(&self.line()) {
                Ok(list) if list["result"] == 1 => return list["items"].clone(),
                _ => {}
            }
        }
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // Already gone is as good.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

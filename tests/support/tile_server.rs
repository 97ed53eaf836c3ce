//! A server of elevation tiles on this machine, which breaks off when told to.

use std::collections::{BTreeMap, VecDeque};
use std::io::{BufRead, BufReader, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::{Arc, Mutex};
use std::thread;

#[derive(Default)]
pub struct State {
    /// Content and version of each path; without a version the server tells none.
    pub files: BTreeMap<String, (Vec<u8>, Option<&'static str>)>,
    /// How many bytes of the next answers are sent before the line goes dead.
    pub cuts: VecDeque<usize>,
    /// What was asked: path, first byte, status.
    pub log: Vec<(String, usize, u16)>,
    /// What is answered instead of a file.
    pub status: Option<u16>,
}

pub struct TileServer {
    pub address: SocketAddr,
    pub state: Arc<Mutex<State>>,
}

impl TileServer {
    pub fn start() -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = listener.local_addr().expect("an address");
        let state = Arc::new(Mutex::new(State::default()));
        let shared = Arc::clone(&state);
        thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                // A client that hangs up is its own affair.
                let _ = answer(stream, &shared);
            }
        });
        Self { address, state }
    }

    pub fn put(&self, path: &str, bytes: Vec<u8>, version: Option<&'static str>) {
        let mut state = self.state.lock().expect("not poisoned");
        state.files.insert(path.to_owned(), (bytes, version));
    }

    pub fn cut(&self, after: usize) {
        self.state
            .lock()
            .expect("not poisoned")
            .cuts
            .push_back(after);
    }

    /// Takes the log.
    pub fn asked(&self) -> Vec<(String, usize, u16)> {
        std::mem::take(&mut self.state.lock().expect("not poisoned").log)
    }
}

fn answer(mut stream: TcpStream, state: &Mutex<State>) -> std::io::Result<()> {
    let mut lines = BufReader::new(stream.try_clone()?).lines();
    let first = lines.next().transpose()?.unwrap_or_default();
    let path = first.split(' ').nth(1).unwrap_or_default().to_owned();
    let mut range = None;
    let mut wanted = None;
    for line in lines {
        let line = line?;
        let Some((name, value)) = line.split_once(':') else {
            break;
        };
        match name.to_ascii_lowercase().as_str() {
            "range" => {
                let first = value.trim().strip_prefix("bytes=");
                range = first.and_then(|range| range.strip_suffix('-')?.parse::<usize>().ok());
            }
            "if-range" => wanted = Some(value.trim().to_owned()),
            _ => {}
        }
    }
    let mut state = state.lock().expect("not poisoned");
    let Some((bytes, version)) = state.files.get(&path).cloned() else {
        state.log.push((path, 0, 404));
        return stream.write_all(
            b"HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\nConnection: close\r\n\r\n",
        );
    };
    let same = version.is_some() && wanted.as_deref() == version;
    let start = range.filter(|_| same).unwrap_or(0);
    let status = state.status.unwrap_or(if start > 0 { 206 } else { 200 });
    state.log.push((path, start, status));
    let cut = state.cuts.pop_front().unwrap_or(usize::MAX);
    drop(state);
    let rest = &bytes[start..];
    let mut head = format!(
        "HTTP/1.1 {status} Such\r\nContent-Length: {}\r\nConnection: close\r\n",
        rest.len()
    );
    if let Some(version) = version {
        head += &format!("ETag: {version}\r\n");
    }
    if status == 206 {
        let last = bytes.len() - 1;
        head += &format!("Content-Range: bytes {start}-{last}/{}\r\n", bytes.len());
    }
    stream.write_all(format!("{head}\r\n").as_bytes())?;
    stream.write_all(&rest[..rest.len().min(cut)])?;
    stream.flush()
}

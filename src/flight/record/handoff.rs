//! What a flight under way and `sortie replan` exchange, as two files in the folder of the
//! flight's record: `fly` writes how the vehicles are reached and when T0 was, `replan` writes
//! lines for the record.

use std::collections::BTreeMap;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::lines::Line;
use super::read::SPEEDUP;
use crate::flight::clock::{BootTime, steady_ms, unix_ms};
use crate::flight::error::FlightError;
use crate::formats::write_file;
use crate::numeric::text::read_regular;
use crate::report;
use crate::spec::{Link, Threat};

/// The two files: what `fly` writes, and what `replan` writes.
const NOTICE: &str = "links.json";
const UNDERWAY: &str = "underway.jsonl";

/// No flight takes longer, milliseconds.
const LONGEST_MS: u64 = 48 * 3600 * 1000;
/// A clock that is off by more than this was set, milliseconds: else it was only corrected.
const SET_MS: i128 = 1000;

/// The exchange files of one flight.
#[derive(Debug)]
pub struct FlightHandoff {
    folder: PathBuf,
    /// The content of `links.json`.
    pub notice: Notice,
    /// Both files of an earlier flight that was cut off: its vehicles may still be in the air.
    earlier: [(&'static str, Option<String>); 2],
}

/// The content of `links.json`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Notice {
    /// Where each vehicle is reached, by its id.
    pub links: BTreeMap<String, String>,
    /// How much faster than the wall's clock the vehicles' time goes.
    pub speedup: f64,
    /// Milliseconds since 1970 at T0; none before it.
    pub t0_unix_ms: Option<u64>,
    /// T0 on the clock of that start of the computer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub boot: Option<BootTime>,
    /// What distinguishes this flight from all others of this computer; empty where it was begun by an older version.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub flight: String,
    /// File name of the record; empty where there is none.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub record: String,
    /// The vehicles whose flight is over and whose motors stand, by id.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub ended: BTreeMap<String, Ended>,
    /// Whether its vehicles end with the process of `fly`.
    #[serde(
        default,
        rename = "simulated",
        skip_serializing_if = "std::ops::Not::not"
    )]
    pub is_simulated: bool,
}

/// When a flight began.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct T0 {
    /// Milliseconds since 1970 on the clock of the wall.
    pub unix_ms: u64,
    /// The same on a clock that nobody sets.
    pub boot: Option<BootTime>,
}

impl T0 {
    /// Now.
    pub(crate) fn now() -> Self {
        Self {
            unix_ms: unix_ms(),
            boot: BootTime::now(),
        }
    }
}

/// How the flight of a vehicle ended while others still fly.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ended {
    /// In the words of [`crate::flight::End::words`].
    pub end: String,
    /// When, seconds after T0; none where nobody saw it.
    pub t_s: Option<f64>,
}

impl Default for Notice {
    /// Of vehicles that no `fly` monitors: T0 is not known.
    fn default() -> Self {
        Self {
            links: BTreeMap::new(),
            speedup: 1.0,
            t0_unix_ms: None,
            boot: None,
            flight: String::new(),
            record: String::new(),
            ended: BTreeMap::new(),
            is_simulated: false,
        }
    }
}

impl Notice {
    /// Seconds after T0 of a time on the steady clock, milliseconds; 0 where T0 is not known.
    #[must_use]
    pub fn t_s(&self, steady_ms: u64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "milliseconds of one flight")]
        let since_ms = self.since_t0_ms(steady_ms) as f64;
        since_ms / 1000.0 * self.speedup
    }

    /// T0, if there was one.
    #[must_use]
    pub fn t0(&self) -> Option<T0> {
        self.t0_unix_ms.map(|unix_ms| T0 {
            unix_ms,
            boot: self.boot.clone(),
        })
    }

    /// T0 on the clock of this start of the computer, if it was in it.
    fn t0_here(&self) -> Option<u64> {
        let (t0, now) = (self.boot.as_ref()?, BootTime::now()?);
        (t0.id == now.id && t0.ms <= now.ms).then_some(t0.ms)
    }

    /// Milliseconds since T0 at a time on the steady clock, and 0 without T0. Of T0 in another start of the computer, or
    /// where it has no such clock, that of the wall says when it was.
    pub(crate) fn since_t0_ms(&self, at_ms: u64) -> u64 {
        let (Some(t0_unix_ms), here) = (self.t0_unix_ms, self.t0_here()) else {
            return 0;
        };
        let ago_ms = i128::from(steady_ms()) - i128::from(at_ms);
        let by_wall_ms = || i128::from(unix_ms()) - i128::from(t0_unix_ms) - ago_ms;
        let since_ms = here.map_or_else(by_wall_ms, |t0_ms| i128::from(at_ms) - i128::from(t0_ms));
        u64::try_from(since_ms).unwrap_or(0)
    }

    /// What an operator must know of the time since T0: that a clock was set, or that nobody knows.
    pub(crate) fn clock_words(&self) -> Option<String> {
        let t0_unix_ms = self.t0_unix_ms?;
        if self.t0_here().is_none() {
            let why = match (&self.boot, BootTime::now()) {
                (Some(_), Some(_)) => "this computer was started again since T0",
                _ => "no other clock says when T0 was",
            };
            return Some(format!(
                "{why}: the time since T0 is that of its clock, and wrong by as much as that was set meanwhile"
            ));
        }
        let by_wall_ms = i128::from(unix_ms()) - i128::from(t0_unix_ms);
        let set_ms = by_wall_ms - i128::from(self.since_t0_ms(steady_ms()));
        #[expect(clippy::cast_precision_loss, reason = "milliseconds of years")]
        let set_s = set_ms as f64 / 1000.0;
        (set_ms.abs() > SET_MS).then(|| {
            format!(
                "the clock of this computer was set by {set_s:+.1} s since T0: times are by one that nobody sets"
            )
        })
    }

    /// The first problem of a notice that was read, in words.
    fn problem(&self) -> Option<String> {
        let now_ms = unix_ms();
        let is_now = |t0_ms: &u64| (now_ms.saturating_sub(LONGEST_MS)..=now_ms).contains(t0_ms);
        let is_known = self.t0_here().is_some() && self.since_t0_ms(steady_ms()) <= LONGEST_MS;
        if !is_known && self.t0_unix_ms.as_ref().is_some_and(|t0_ms| !is_now(t0_ms)) {
            let text = "`t0_unix_ms` is not within the last two days by the clock of this computer: set that right";
            return Some(text.to_owned());
        }
        let mut links = self.links.iter();
        if let Some((vehicle, link)) = links.find(|(_, link)| Link::parse(link).is_none()) {
            return Some(format!(
                "`links.{vehicle}` {link:?} is no address (allowed: sim, udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT)"
            ));
        }
        (!SPEEDUP.contains(&self.speedup)).then(|| {
            let (least, most) = (SPEEDUP.start(), SPEEDUP.end());
            format!("`speedup` {} (allowed: {least} to {most})", self.speedup)
        })
    }
}

impl FlightHandoff {
    /// The files of a flight that begins; `links` are the addresses of the vehicles by id.
    #[must_use]
    pub fn new(folder: PathBuf, links: BTreeMap<String, String>, speedup: f64) -> Self {
        Self {
            earlier: [NOTICE, UNDERWAY].map(|name| (name, read_regular(&folder.join(name)).ok())),
            folder,
            notice: Notice {
                links,
                speedup,
                ..Notice::default()
            },
        }
    }

    /// The files of the flight under way, if there is one.
    ///
    /// # Errors
    /// [`FlightError::Input`]: the file is not as `fly` writes it.
    pub fn find(folder: PathBuf) -> Result<Option<Self>, FlightError> {
        let path = folder.join(NOTICE);
        let unusable = |why: String| {
            FlightError::Input(format!(
                "{}: {why}; `sortie fly` writes it, nothing was sent",
                path.display()
            ))
        };
        let text = match read_regular(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(unusable(error.to_string())),
        };
        let notice: Notice =
            serde_json::from_str(&text).map_err(|error| unusable(error.to_string()))?;
        if let Some(problem) = notice.problem() {
            return Err(unusable(problem));
        }
        Ok(Some(Self {
            folder,
            notice,
            earlier: [(NOTICE, None), (UNDERWAY, None)],
        }))
    }

    /// The record of a flight that broke off after T0 and was not taken over to its end, if there is one.
    #[must_use]
    pub fn broken_off(folder: &Path) -> Option<PathBuf> {
        let notice = Self::find(folder.to_owned()).ok()??.notice;
        let name = Path::new(&notice.record).file_name()?;
        let record = folder.join(name);
        let has_begun = notice.t0_unix_ms.is_some() && !notice.is_simulated;
        (has_begun && record.is_file()).then_some(record)
    }

    /// Writes `links.json`, before T0, again at T0, and when the flight of a vehicle is over: those are `ended`.
    ///
    /// # Errors
    /// [`FlightError::Record`]
    pub fn announce(
        &self,
        t0: Option<&T0>,
        ended: BTreeMap<String, Ended>,
    ) -> Result<(), FlightError> {
        let notice = Notice {
            t0_unix_ms: t0.map(|t0| t0.unix_ms),
            boot: t0.and_then(|t0| t0.boot.clone()),
            ended,
            ..self.notice.clone()
        };
        if t0.is_none() {
            // Lines for an earlier flight do not count for this one.
            let _ = std::fs::remove_file(self.handoff());
        }
        let text = report::json_text(&notice);
        write_file(&self.folder.join(NOTICE), text.as_bytes())?;
        Ok(())
    }

    /// Removes both files after the flight. A flight that never began gives back those of the
    /// flight before it.
    pub fn withdraw(&self, has_begun: bool) {
        for (name, earlier) in &self.earlier {
            let path = self.folder.join(name);
            match earlier.as_ref().filter(|_| !has_begun) {
                // Files that cannot be given back are lost: there is nobody else to write them.
                Some(text) => drop(write_file(&path, text.as_bytes())),
                // A file that is gone already is as good.
                None => drop(std::fs::remove_file(&path)),
            }
        }
    }

    fn handoff(&self) -> PathBuf {
        self.folder.join(UNDERWAY)
    }

    /// Appends lines for the record.
    ///
    /// # Errors
    /// [`FlightError::Transfer`]: the file cannot be written, and nothing is sent without a record.
    pub fn append(&self, lines: &[Line]) -> Result<(), FlightError> {
        let path = self.handoff();
        let append = || {
            let text: String = lines.iter().map(|line| line.text() + "\n").collect();
            let mut file = OpenOptions::new().create(true).append(true).open(&path)?;
            file.write_all(text.as_bytes())
        };
        append().map_err(|error: std::io::Error| {
            FlightError::Transfer(format!(
                "cannot write {}: {error}; nothing was sent, and the threat is not recorded: give it again",
                path.display()
            ))
        })
    }

    /// Writes the lines of `replan` again, which were moved away or deleted with their folder.
    pub(crate) fn restore(&self, lines: &str) -> Result<(), FlightError> {
        let path = self.handoff();
        if lines.is_empty() || path.exists() {
            return Ok(());
        }
        Ok(write_file(&path, lines.as_bytes())?)
    }

    /// The first threats and plans, which are in the record already, and how those were taken.
    #[must_use]
    pub(crate) fn first(&self, lines: usize) -> String {
        let text = read_regular(&self.handoff()).unwrap_or_default();
        let is_counted = |line: &str| {
            serde_json::from_str(line.trim_end()).is_ok_and(|of: Line| of.is_of_replan())
        };
        let (mut left, mut first) = (lines, String::new());
        if lines == 0 {
            return first;
        }
        for line in text.split_inclusive('\n') {
            let counts = is_counted(line);
            if counts && left == 0 {
                break;
            }
            left -= usize::from(counts);
            first += line;
        }
        first
    }

    /// The threats that came up so far.
    #[must_use]
    pub fn popups(&self) -> Vec<Threat> {
        let lines = self.lines_after(0);
        let popup = |line: &str| match serde_json::from_str(line).ok()? {
            Line::Threat { t_s, threat } => threat.popup(t_s).ok().map(|popup| popup.threat),
            _ => None,
        };
        lines.lines().filter_map(popup).collect()
    }

    /// Whole lines after the first `taken` bytes.
    pub(crate) fn lines_after(&self, taken: usize) -> String {
        let path = self.handoff();
        let has_more = std::fs::metadata(&path).is_ok_and(|of| of.len() > taken as u64);
        if !has_more {
            return String::new();
        }
        let text = read_regular(&path).unwrap_or_default();
        let fresh = text.get(taken..).unwrap_or_default();
        let whole = fresh.rfind('\n').map_or("", |end| &fresh[..=end]);
        whole.to_owned()
    }
}

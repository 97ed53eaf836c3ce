//! What a flight under way lays open beside its record, for `replan`: where the vehicles are
//! reached, when T0 was; and what `replan` lays down there for the record.

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::Sorties;
use crate::cli::folder::{replace, runs};
use crate::cli::print::failure::Failure;
use crate::cli::transfer::delivery;
use crate::flight::{Line, SPEEDUP};
use crate::report;
use crate::spec::{Link, Threat};

/// The two files: what the flight says, and what is laid down for it.
const SAID: &str = "links.json";
const UNDERWAY: &str = "underway.jsonl";

/// No flight takes longer, milliseconds.
const LONGEST_MS: u64 = 48 * 3600 * 1000;

/// What the first of them says.
pub(in crate::cli) struct Call {
    runs: PathBuf,
    said: Said,
    /// Both as a flight left them that was cut off: its vehicles may still be in the air.
    left: [(&'static str, Option<Vec<u8>>); 2],
}

/// What `links.json` says.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(in crate::cli) struct Said {
    /// Where each vehicle is reached, by its id.
    pub(in crate::cli) links: std::collections::BTreeMap<String, String>,
    /// How much faster than the wall's clock the vehicles' time goes.
    pub(in crate::cli) speedup: f64,
    /// Milliseconds since 1970 at T0; none before it.
    pub(in crate::cli) t0_unix_ms: Option<u64>,
}

impl Call {
    pub(super) fn new(sorties: &Sorties, links: &[Link], speedup: f64) -> Self {
        let fleet = &sorties.file.spec.vehicles;
        let missions = sorties.missions.iter().zip(links);
        let links = missions.map(|((index, _), link)| (fleet[*index].id.clone(), link.to_string()));
        let runs = runs::folder(&sorties.folder);
        Self {
            left: [SAID, UNDERWAY].map(|name| (name, std::fs::read(runs.join(name)).ok())),
            runs,
            said: Said {
                links: links.collect(),
                speedup,
                t0_unix_ms: None,
            },
        }
    }

    /// What the flight under way says, if there is one.
    ///
    /// # Errors
    /// What is there is not what `fly` writes.
    pub(in crate::cli) fn heard(sorties: &Sorties) -> Result<Option<(Self, Said)>, Failure> {
        let folder = runs::folder(&sorties.folder);
        let path = folder.join(SAID);
        let unusable = |why: String| {
            let message = format!(
                "{}: {why}; `sortie fly` writes it, nothing was sent",
                path.display()
            );
            Failure::new(Failure::INPUT, message)
        };
        let bytes = match std::fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(unusable(error.to_string())),
        };
        let said: Said =
            serde_json::from_slice(&bytes).map_err(|error| unusable(error.to_string()))?;
        let now_ms = delivery::milliseconds_since_1970();
        let is_now = |t0_ms: &u64| (now_ms.saturating_sub(LONGEST_MS)..=now_ms).contains(t0_ms);
        if said.t0_unix_ms.as_ref().is_some_and(|t0_ms| !is_now(t0_ms)) {
            return Err(unusable(
                "`t0_unix_ms` is not within the last two days".to_owned(),
            ));
        }
        let broken = said
            .links
            .iter()
            .find(|(_, link)| Link::parse(link).is_none());
        if let Some((vehicle, link)) = broken {
            return Err(unusable(format!(
                "`links.{vehicle}` {link:?} is no address (allowed: sim, udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT)"
            )));
        }
        if !SPEEDUP.contains(&said.speedup) {
            let (least, most) = (SPEEDUP.start(), SPEEDUP.end());
            return Err(unusable(format!(
                "`speedup` {} (allowed: {least} to {most})",
                said.speedup
            )));
        }
        let call = Self {
            runs: folder,
            said: said.clone(),
            left: [(SAID, None), (UNDERWAY, None)],
        };
        Ok(Some((call, said)))
    }

    /// Lays it open, before T0 and again at T0.
    pub(super) fn announce(&self, t0_unix_ms: Option<u64>) -> Result<(), Failure> {
        let said = Said {
            t0_unix_ms,
            ..self.said.clone()
        };
        if t0_unix_ms.is_none() {
            // What was laid down for another flight is not held against this one.
            let _ = std::fs::remove_file(self.underway());
        }
        let text = report::json_text(&said);
        replace::write_file(&self.runs.join(SAID), text.as_bytes())?;
        Ok(())
    }

    /// The flight is over; of one that never began nothing stays, and what was there before does.
    pub(super) fn withdraw(&self, has_begun: bool) {
        for (name, left) in &self.left {
            let path = self.runs.join(name);
            match left.as_ref().filter(|_| !has_begun) {
                // What cannot be given back is lost; the vehicles are where they are.
                Some(bytes) => drop(replace::write_file(&path, bytes)),
                // Gone already is as good.
                None => drop(std::fs::remove_file(&path)),
            }
        }
    }

    fn underway(&self) -> PathBuf {
        self.runs.join(UNDERWAY)
    }

    /// Lays lines down for the record.
    ///
    /// # Errors
    /// The file that cannot be written, and why.
    pub(in crate::cli) fn lay_down(&self, lines: &[Line]) -> Result<(), (PathBuf, io::Error)> {
        let path = self.underway();
        let append = || {
            let mut text = String::new();
            for line in lines {
                text.push_str(&serde_json::to_string(line)?);
                text.push('\n');
            }
            let mut file = OpenOptions::new().create(true).append(true).open(&path)?;
            file.write_all(text.as_bytes())
        };
        append().map_err(|error| (path.clone(), error))
    }

    /// The threats that were laid down so far.
    pub(in crate::cli) fn popups(&self) -> Vec<Threat> {
        let (lines, _) = self.taken_up(0);
        let popup = |line: &String| match serde_json::from_str(line).ok()? {
            Line::Threat { t_s, threat } => threat.popup(t_s).ok().map(|popup| popup.threat),
            _ => None,
        };
        lines.iter().filter_map(popup).collect()
    }

    /// Whole lines that were laid down after the first `taken` bytes, and how many bytes
    /// have then been taken.
    pub(super) fn taken_up(&self, taken: usize) -> (Vec<String>, usize) {
        let text = std::fs::read_to_string(self.underway()).unwrap_or_default();
        let fresh = text.get(taken..).unwrap_or_default();
        let whole = fresh.rfind('\n').map_or("", |end| &fresh[..=end]);
        let lines = whole.lines().map(str::to_owned).collect();
        (lines, taken + whole.len())
    }
}

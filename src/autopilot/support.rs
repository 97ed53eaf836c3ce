//! What is supported, and on which evidence: printed as the tables of the README and the guide.

use std::fmt;

use super::{Airframe, Autopilot, facts};

/// How a feature is known to work on one autopilot and airframe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evidence {
    /// Flown in that autopilot's own simulator, of this version.
    Measured(&'static str),
    /// By the autopilot's sources; not flown.
    Sources,
    /// Not supported.
    No,
}

impl fmt::Display for Evidence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Measured(version) => write!(f, "measured on {version}"),
            Self::Sources => f.write_str("from the sources"),
            Self::No => f.write_str("no"),
        }
    }
}

/// The evidence for each feature.
#[derive(Clone, Copy, Debug)]
pub struct Support {
    /// Planning and the verdict: whether flights kept to the flight model.
    pub plan: Evidence,
    /// Transfer and read-back.
    pub upload: Evidence,
    /// Launch, monitoring, record and judgement of a flight.
    pub fly: Evidence,
    /// New paths in flight.
    pub replan: Evidence,
}

impl Support {
    /// The same evidence for every feature.
    pub(super) const fn all(evidence: Evidence) -> Self {
        Self {
            plan: evidence,
            upload: evidence,
            fly: evidence,
            replan: evidence,
        }
    }
}

/// Every autopilot and airframe, in the order of documents.
fn kinds() -> impl Iterator<Item = (Airframe, Autopilot)> {
    let of = |airframe| Autopilot::ALL.map(|autopilot| (airframe, autopilot));
    Airframe::ALL.into_iter().flat_map(of)
}

/// The support matrix as a Markdown table.
#[must_use]
pub fn support_table() -> String {
    let mut table = String::from(
        "| airframe | autopilot | plan, verify | upload | fly | replan |\n|---|---|---|---|---|---|\n",
    );
    for (airframe, autopilot) in kinds() {
        let Support {
            plan,
            upload,
            fly,
            replan,
        } = facts(autopilot, airframe).support;
        let (airframe, autopilot) = (airframe.name(), autopilot.name());
        table += &format!("| {airframe} | {autopilot} | {plan} | {upload} | {fly} | {replan} |\n");
    }
    table
}

/// The figures of behaviour that the verdict assumes, as a Markdown table: the worst of each
/// autopilot and airframe. A figure that another autopilot or airframe shares stands once.
#[must_use]
pub fn behaviour_table() -> String {
    let mut table = String::from(
        "| figure | of | value | version | samples | source |\n|---|---|--:|---|--:|---|\n",
    );
    let names = facts(Autopilot::ArduPilot, Airframe::Copter).behaviour;
    for (index, (name, _)) in names.figures().into_iter().enumerate() {
        let mut rows: Vec<(String, &super::Measured)> = Vec::new();
        for (airframe, autopilot) in kinds() {
            let facts = facts(autopilot, airframe);
            let Some(figure) = facts.behaviour.figures()[index].1.of(None) else {
                continue;
            };
            match rows.iter_mut().find(|(_, known)| *known == figure) {
                Some((of, _)) => *of += &format!(", {}", facts.firmware),
                None => rows.push((facts.firmware.to_owned(), figure)),
            }
        }
        for (of, figure) in rows {
            let (version, samples, source) = (figure.version, figure.samples, figure.source);
            table +=
                &format!("| `{name}` | {of} | {figure} | {version} | {samples} | {source} |\n");
        }
    }
    table
}

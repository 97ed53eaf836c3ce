//! What `check` finds in a spec.

use schemars::JsonSchema;
use serde::Serialize;

use super::verdict;
use crate::mission;
use crate::spec::{Airframe, AirspaceImport, Autopilot, Issue, MissionSpec, Vehicle, dome_of};

/// What `check` finds in a spec.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct CheckDocument {
    /// Version of Sortie.
    pub sortie: &'static str,
    /// `pass` for a good spec, or `fail`.
    pub verdict: &'static str,
    /// What is wrong; nothing in a good spec.
    pub issues: Vec<IssueEntry>,
    /// What may not be meant.
    pub warnings: Vec<String>,
    /// `mission`, or `scenario` of the study; null where the spec cannot be read.
    pub kind: Option<&'static str>,
    /// Threats, domes among them.
    pub threats: usize,
    /// No-fly zones, those of airspace files and obstacles among them.
    pub zones: usize,
    /// Items that a fence needs with everything in it; 0 without a fence.
    pub fence_needs: usize,
    /// In the order of the spec; none of a scenario.
    pub vehicles: Vec<CheckedVehicle>,
    /// What became of the files of airspace and obstacles.
    pub airspace: Vec<ImportEntry>,
}

/// One problem of a spec.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct IssueEntry {
    /// Path of the key; empty for the whole file.
    pub path: String,
    /// The table in which the problem stands; null: in the spec itself.
    pub table: Option<String>,
    /// From 1; in a table the row. Null if unknown.
    pub line: Option<usize>,
    /// From 1; in a table the number of the column, 0 for the whole row.
    pub column: Option<usize>,
    /// What was found.
    pub found: String,
    /// What is allowed; empty where `found` says it all.
    pub allowed: String,
}

/// A vehicle, and what its autopilot keeps.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct CheckedVehicle {
    /// Id in the spec.
    pub id: String,
    /// MAVLink system id.
    pub sysid: u8,
    /// As in the spec.
    pub autopilot: Autopilot,
    /// As in the spec.
    pub airframe: Airframe,
    /// Fence items that it keeps.
    pub fence_keeps: usize,
    /// What was found of its landing; null where there is nothing to say.
    pub landing: Option<String>,
}

/// What became of the shapes of a file of airspace or obstacles.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ImportEntry {
    /// As the spec names it.
    pub file: String,
    /// Ids of its zones.
    pub zones: Vec<String>,
    /// Shapes that no vehicle can reach.
    pub out_of_reach: usize,
    /// Shapes that `only` or `skip` leaves out.
    pub left_out: usize,
    /// Shapes that forbid nothing.
    pub unrestricted: usize,
    /// Lines and points, which enclose nothing.
    pub without_area: usize,
}

impl CheckDocument {
    /// Of a spec that is read; its vehicles, warnings and files are added by who knows the ground.
    #[must_use]
    pub fn new(kind: &'static str) -> Self {
        Self {
            sortie: env!("CARGO_PKG_VERSION"),
            verdict: verdict(true),
            kind: Some(kind),
            ..Self::default()
        }
    }

    /// Of a spec with problems.
    #[must_use]
    pub fn of_issues(issues: &[Issue]) -> Self {
        Self {
            sortie: env!("CARGO_PKG_VERSION"),
            verdict: verdict(issues.is_empty()),
            issues: issues.iter().map(issue_entry).collect(),
            ..Self::default()
        }
    }

    /// Counts threats, zones and fence items of a mission. A dome is one threat, and its layers are no zones.
    pub fn count(&mut self, spec: &MissionSpec) {
        let mut domes: Vec<&str> = spec.no_fly.iter().filter_map(dome_of).collect();
        domes.sort_unstable();
        domes.dedup();
        self.threats = spec.threats.len() + domes.len();
        let zones = spec.no_fly.iter().filter(|zone| dome_of(zone).is_none());
        self.zones = zones.count();
        self.fence_needs = mission::fence_needs(spec);
    }
}

impl CheckedVehicle {
    /// Of a vehicle, with what was found of its landing.
    #[must_use]
    pub fn new(vehicle: &Vehicle, landing: Option<String>) -> Self {
        Self {
            id: vehicle.id.clone(),
            sysid: vehicle.sysid,
            autopilot: vehicle.autopilot,
            airframe: vehicle.airframe,
            fence_keeps: vehicle.fence_capacity(),
            landing,
        }
    }
}

impl From<&AirspaceImport> for ImportEntry {
    fn from(import: &AirspaceImport) -> Self {
        Self {
            file: import.file.clone(),
            zones: import.zones.clone(),
            out_of_reach: import.out_of_reach,
            left_out: import.left_out,
            unrestricted: import.unrestricted,
            without_area: import.without_area,
        }
    }
}

fn issue_entry(issue: &Issue) -> IssueEntry {
    let position = issue.position;
    IssueEntry {
        path: issue.path.clone(),
        table: issue.table.clone(),
        line: position.map(|(line, _)| line),
        column: position.map(|(_, column)| column),
        found: issue.found.clone(),
        allowed: issue.allowed.clone(),
    }
}

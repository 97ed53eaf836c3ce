//! The best known costs; updates only lower them.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::PlannerRun;
use crate::study::store::{StoreError, io_at, write_whole};

/// The best plan known of one mission.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Known {
    /// Sum of the vehicles' costs, judged at 2001 samples; no limit is violated.
    pub total: f64,
    /// Cost of each vehicle, in the order of the spec.
    pub vehicles: Vec<f64>,
    /// The planner that found it.
    pub method: String,
    /// Evaluations for each vehicle.
    pub evaluations: usize,
    /// Its seed.
    pub seed: u64,
}

/// The best plan known of each mission, by its name.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct BestKnown(pub BTreeMap<String, Known>);

impl BestKnown {
    /// Reads a file; a missing file is an empty one.
    ///
    /// # Errors
    /// A file that cannot be read or has other content.
    pub fn read(path: &Path) -> Result<Self, StoreError> {
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                return Ok(Self::default());
            }
            Err(error) => return Err(io_at(path)(error)),
        };
        serde_json::from_str(&text).map_err(|error| StoreError::Content {
            path: path.to_owned(),
            line: error.line(),
            reason: error.to_string(),
        })
    }

    /// Writes the file; it appears whole or not at all.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), StoreError> {
        let text = serde_json::to_string_pretty(self).unwrap_or_default();
        write_whole(path, &(text + "\n"))
    }

    /// Takes over runs that keep every limit and cost less than the best known, by more than
    /// rounding. Returns the names of their missions.
    pub fn lower<'a>(&mut self, runs: impl Iterator<Item = &'a PlannerRun>) -> Vec<String> {
        const ROUNDING: f64 = 1e-9;
        let mut lowered = Vec::new();
        for run in runs.filter(|run| run.clean) {
            let known = self.0.get(&run.mission);
            if known.is_none_or(|known| run.total < known.total * (1.0 - ROUNDING)) {
                lowered.push(run.mission.clone());
                let known = Known {
                    total: run.total,
                    vehicles: run.vehicles.clone(),
                    method: format!("sortie, {}", run.variant),
                    evaluations: run.evaluations,
                    seed: run.seed,
                };
                self.0.insert(run.mission.clone(), known);
            }
        }
        lowered.sort();
        lowered.dedup();
        lowered
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(total: f64, clean: bool) -> PlannerRun {
        PlannerRun {
            config: String::new(),
            variant: "planner".to_owned(),
            mission: "m".to_owned(),
            evaluations: 100,
            seed: 3,
            total,
            clean,
            vehicles: vec![total],
            spent: vec![100],
        }
    }

    #[test]
    fn only_clean_runs_lower_the_best_known_cost() {
        let mut best = BestKnown::default();
        assert_eq!(best.lower([run(5.0, true)].iter()), ["m"]);
        let none: [&str; 0] = [];
        assert_eq!(best.lower([run(6.0, true), run(4.0, false)].iter()), none);
        assert_eq!(best.lower([run(4.5, true), run(4.7, true)].iter()), ["m"]);
        assert!((best.0["m"].total - 4.5).abs() < 1e-12);
    }
}

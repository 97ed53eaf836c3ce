//! The runs by contestant and map: Tables 2 and 3 as CSV, and the tests the paper does not have.

use std::fmt::Write;

use super::config::{Config, ConfigError};
use super::contestants::{Contestant, Protocol};
use super::record::Record;
use super::{MAPS_8, shipped_maps};
use crate::study::stats::{Summary, friedman, rank_sum_p};

/// The runs of a whole study, sorted into a table of contestants and maps.
pub struct Results<'a> {
    /// The configuration.
    pub config: &'a Config,
    /// Names of the maps.
    pub maps: Vec<String>,
    /// The contestants, in the order of the tables.
    pub contestants: Vec<Contestant>,
    records: &'a [Record],
}

/// A contestant by name and protocol.
pub(super) type Interpretation = (&'static str, Protocol);

/// The readings of the paper's MSFOA.
pub(super) const INTERPRETATIONS: [Interpretation; 4] = [
    ("msfoa-literal", Protocol::Iterations),
    ("msfoa-dwindle", Protocol::Iterations),
    ("msfoa-literal", Protocol::Evaluations),
    ("msfoa-dwindle", Protocol::Evaluations),
];
/// The paper's other algorithms.
pub(super) const OTHERS: [&str; 6] = ["foa", "pso", "de", "abc", "iffo", "mfoa"];

impl<'a> Results<'a> {
    /// Takes all runs of a study.
    ///
    /// # Errors
    /// An invalid configuration.
    pub fn new(config: &'a Config, records: &'a [Record]) -> Result<Self, ConfigError> {
        let maps = config.scenarios()?;
        Ok(Self {
            config,
            maps: maps.into_iter().map(|map| map.name).collect(),
            contestants: config.contestants(),
            records,
        })
    }

    /// The runs of one contestant on one map.
    pub(super) fn cell<'b>(
        &'b self,
        contestant: &'b Contestant,
        map: &'b str,
    ) -> impl Iterator<Item = &'a Record> + 'b {
        self.records.iter().filter(move |record| {
            record.scenario == map
                && record.algorithm == contestant.name
                && record.protocol == contestant.protocol.name()
        })
    }

    /// Their totals.
    pub(super) fn totals(&self, contestant: &Contestant, map: &str) -> Vec<f64> {
        self.cell(contestant, map)
            .map(|record| record.total)
            .collect()
    }

    /// Their summary.
    pub(super) fn summary(&self, contestant: &Contestant, map: &str) -> Option<Summary> {
        Summary::of(&self.totals(contestant, map))
    }

    /// The run of the least total.
    pub(super) fn best(&self, contestant: &Contestant, map: &str) -> Option<&'a Record> {
        self.cell(contestant, map)
            .min_by(|a, b| a.total.total_cmp(&b.total))
    }

    /// Index of the paper's scenario that a map stands for, from 0: a shipped map, with
    /// either number of control points.
    pub(super) fn scenario(&self, map: &str) -> Option<usize> {
        let index = self.maps.iter().position(|name| name == map)?;
        let text = &self.config.maps.get(index)?.text;
        let mut shipped = shipped_maps().into_iter().zip(MAPS_8);
        shipped.position(|((_, five), (_, eight))| text == five || text == eight)
    }

    /// Averages of one contestant over those of another, map by map.
    pub(super) fn ratios(&self, one: &Contestant, other: &Contestant) -> Vec<f64> {
        let average = |of, map: &str| self.summary(of, map).map(|summary| summary.average);
        self.maps
            .iter()
            .filter_map(|map| Some(average(one, map)? / average(other, map)?))
            .collect()
    }

    /// Number of runs that are safe at 2001 samples.
    pub(super) fn safe(&self, contestant: &Contestant, map: &str) -> usize {
        self.cell(contestant, map)
            .filter(|record| record.safe)
            .count()
    }

    /// A contestant by name and protocol.
    pub(super) fn find(&self, name: &str, protocol: Protocol) -> Option<&Contestant> {
        self.contestants
            .iter()
            .find(|contestant| contestant.name == name && contestant.protocol == protocol)
    }

    /// One reading of MSFOA and the six others.
    pub(super) fn contestants(&self, reading: Interpretation) -> Vec<&Contestant> {
        let others = OTHERS.map(|name| (name, Protocol::Evaluations));
        std::iter::once(reading)
            .chain(others)
            .filter_map(|(name, protocol)| self.find(name, protocol))
            .collect()
    }

    /// p of the rank-sum test of a contestant against another on a map.
    pub(super) fn p(&self, one: &Contestant, other: &Contestant, map: &str) -> Option<f64> {
        rank_sum_p(&self.totals(one, map), &self.totals(other, map))
    }

    /// Friedman's mean ranks of the seven, blocks being run numbers on maps, and p.
    pub(super) fn friedman(&self, reading: Interpretation) -> Option<(Vec<f64>, f64)> {
        let contestants = self.contestants(reading);
        let mut rows = Vec::new();
        for map in &self.maps {
            let columns: Vec<Vec<f64>> = contestants
                .iter()
                .map(|one| self.totals(one, map))
                .collect();
            for run in 0..self.config.runs {
                rows.push(
                    columns
                        .iter()
                        .filter_map(|column| column.get(run).copied())
                        .collect(),
                );
            }
        }
        friedman(&rows)
    }

    /// Table 2: the vehicles of the best run and their sum.
    #[must_use]
    pub fn table_2(&self) -> String {
        let mut text =
            "scenario,algorithm,protocol,evaluations,run,vehicle,total,fine_total,safe\n"
                .to_owned();
        for (map, contestant) in self.cells() {
            let Some(best) = self.best(contestant, map) else {
                continue;
            };
            let mut line = |evaluations: usize, vehicle: &str, total: f64, fine: f64, safe| {
                let _ = writeln!(
                    text,
                    "{map},{},{},{evaluations},{},{vehicle},{total},{fine},{safe}",
                    contestant.name,
                    contestant.protocol.name(),
                    best.run
                );
            };
            for (number, vehicle) in (1..).zip(&best.vehicles) {
                line(
                    vehicle.evaluations,
                    &number.to_string(),
                    vehicle.total,
                    vehicle.fine_total,
                    vehicle.safe,
                );
            }
            let spent = best
                .vehicles
                .iter()
                .map(|vehicle| vehicle.evaluations)
                .sum();
            line(spent, "sum", best.total, best.fine_total, best.safe);
        }
        text
    }

    /// Table 3: spread over the runs, safety, and tests against each reading of MSFOA.
    #[must_use]
    pub fn table_3(&self) -> String {
        let mut text = "scenario,algorithm,protocol,runs,best,average,median,deviation,worst,\
                        fine_average,safe,unsafe"
            .to_owned();
        for (name, protocol) in INTERPRETATIONS {
            let _ = write!(text, ",p_{name}_{}", protocol.name());
        }
        text.push('\n');
        for (map, contestant) in self.cells() {
            let Some(of) = self.summary(contestant, map) else {
                continue;
            };
            let fine: Vec<f64> = self
                .cell(contestant, map)
                .map(|record| record.fine_total)
                .collect();
            let (safe, runs) = (self.safe(contestant, map), fine.len());
            let fine = Summary::of(&fine).map_or(f64::NAN, |fine| fine.average);
            let _ = write!(
                text,
                "{map},{},{},{runs},{},{},{},{},{},{fine},{safe},{}",
                contestant.name,
                contestant.protocol.name(),
                of.best,
                of.average,
                of.median,
                of.deviation,
                of.worst,
                runs - safe
            );
            for (name, protocol) in INTERPRETATIONS {
                let p = self
                    .find(name, protocol)
                    .filter(|reading| *reading != contestant)
                    .and_then(|reading| self.p(contestant, reading, map));
                text.push(',');
                if let Some(p) = p {
                    let _ = write!(text, "{p:.3e}");
                }
            }
            text.push('\n');
        }
        text
    }

    /// All cells, map by map.
    fn cells(&self) -> impl Iterator<Item = (&String, &Contestant)> {
        self.maps.iter().flat_map(|map| {
            self.contestants
                .iter()
                .map(move |contestant| (map, contestant))
        })
    }
}

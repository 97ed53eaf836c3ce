//! Time, memory and cost of planning over the size of the fleet.

use std::fmt::Write;

use serde::Serialize;

use crate::numeric::as_f64;
use crate::study::document::Table;

/// A fleet of one size, planned by `sortie plan` from the spec to the files.
#[derive(Clone, Debug, Default, Serialize)]
pub struct FleetRun {
    /// Number of vehicles.
    pub vehicles: usize,
    /// Time of the whole command, seconds.
    pub wall_s: f64,
    /// Time of all processors, seconds; `None` where the system does not report it.
    pub cpu_s: Option<f64>,
    /// Peak memory, MiB; `None` where the system does not report it.
    pub memory_mib: Option<f64>,
    /// Objective evaluations.
    pub evaluations: usize,
    /// Plans after the first of each vehicle.
    pub made_again: usize,
    /// Margins that fail verification.
    pub violations: usize,
    /// Separations among them.
    pub separations: usize,
    /// Sum of the costs.
    pub cost: f64,
    /// Sum of the costs with the evaluations of the reference, where requested.
    pub reference_cost: Option<f64>,
}

impl FleetRun {
    /// Cost above that with the evaluations of the reference, as a fraction.
    #[must_use]
    pub fn above_reference(&self) -> Option<f64> {
        self.reference_cost
            .map(|reference| self.cost / reference - 1.0)
    }
}

/// Size from which a fleet counts for the growth; below, the rest of the command takes longer
/// than planning.
const MIN_SIZE: usize = 10;

/// All runs of a fleet study.
#[derive(Clone, Debug, Serialize)]
pub struct FleetGrowth {
    /// Evaluations of each plan.
    pub evaluations_a_plan: usize,
    /// Evaluations of each plan of the reference.
    pub reference_evaluations: usize,
    /// Threads.
    pub threads: usize,
    /// The runs, in order of size.
    pub runs: Vec<FleetRun>,
    /// Exponent of the growth of wall time with size, from 10 vehicles on.
    pub wall_exponent: Option<f64>,
    /// The same of processor time.
    pub cpu_exponent: Option<f64>,
}

impl FleetGrowth {
    /// Evaluations of each plan that the cost is compared with.
    pub const REFERENCE: usize = 40_000;

    /// Runs in order of size.
    #[must_use]
    pub fn of(evaluations_a_plan: usize, threads: usize, runs: Vec<FleetRun>) -> Self {
        let counted = || runs.iter().filter(|run| run.vehicles >= MIN_SIZE);
        let size = |run: &FleetRun| as_f64(run.vehicles);
        let wall: Vec<(f64, f64)> = counted().map(|run| (size(run), run.wall_s)).collect();
        let cpu: Vec<(f64, f64)> = counted()
            .filter_map(|run| Some((size(run), run.cpu_s?)))
            .collect();
        Self {
            evaluations_a_plan,
            reference_evaluations: Self::REFERENCE,
            threads,
            wall_exponent: exponent(&wall),
            cpu_exponent: exponent(&cpu),
            runs,
        }
    }

    /// The table, in Markdown.
    #[must_use]
    pub fn table(&self) -> String {
        let mut table = Table::new(
            "",
            format!(
                "vehicles | wall, s | processor, s | memory, MiB | evaluations | made again | \
                 violations | of separation | cost | above {} evaluations",
                self.reference_evaluations
            ),
        );
        let known = |value: Option<f64>, digits: usize| {
            value.map_or("n/a".to_owned(), |value| format!("{value:.digits$}"))
        };
        for run in &self.runs {
            let above = run
                .above_reference()
                .map_or("-".to_owned(), |above| format!("{:+.2} %", 100.0 * above));
            table.row(format!(
                "{} | {:.2} | {} | {} | {} | {} | {} | {} | {:.1} | {above}",
                run.vehicles,
                run.wall_s,
                known(run.cpu_s, 2),
                known(run.memory_mib, 0),
                run.evaluations,
                run.made_again,
                run.violations,
                run.separations,
                run.cost,
            ));
        }
        let mut text = table.markdown();
        let exponents = [
            ("wall", self.wall_exponent),
            ("processor", self.cpu_exponent),
        ];
        for (name, exponent) in exponents {
            if let Some(exponent) = exponent {
                let _ = write!(
                    text,
                    "\n{name} time: exponent of growth {exponent:.2}, from {MIN_SIZE} vehicles"
                );
            }
        }
        text.push('\n');
        text
    }
}

/// The exponent of the second number's growth with the first: the slope of the line through
/// their logarithms by least squares. `None` of fewer than two sizes.
fn exponent(points: &[(f64, f64)]) -> Option<f64> {
    let logs: Vec<(f64, f64)> = points
        .iter()
        .filter(|(size, value)| *size > 0.0 && *value > 0.0)
        .map(|(size, value)| (size.ln(), value.ln()))
        .collect();
    let mean = |pick: fn(&(f64, f64)) -> f64| {
        logs.iter().map(pick).sum::<f64>() / as_f64(logs.len().max(1))
    };
    let (x, y) = (mean(|log| log.0), mean(|log| log.1));
    let spread: f64 = logs.iter().map(|log| (log.0 - x).powi(2)).sum();
    let common: f64 = logs.iter().map(|log| (log.0 - x) * (log.1 - y)).sum();
    (spread > 0.0).then(|| common / spread)
}

#[cfg(test)]
mod tests {
    use super::{FleetGrowth, FleetRun, exponent};

    #[test]
    fn the_exponent_of_a_power_is_that_power() {
        let points: Vec<(f64, f64)> = [10.0, 30.0, 100.0, 1000.0_f64]
            .iter()
            .map(|size| (*size, 0.02 * size.powf(1.3)))
            .collect();
        let found = exponent(&points).unwrap();
        assert!((found - 1.3).abs() < 1e-9, "{found}");
        assert_eq!(exponent(&points[..1]), None);
    }

    #[test]
    fn small_fleets_do_not_count_and_missing_values_are_marked() {
        let run = |vehicles: usize, wall_s: f64| FleetRun {
            vehicles,
            wall_s,
            cost: 103.0,
            reference_cost: (vehicles == 10).then_some(100.0),
            ..FleetRun::default()
        };
        let runs = vec![run(1, 5.0), run(10, 1.0), run(100, 10.0)];
        let growth = FleetGrowth::of(1000, 2, runs);
        assert!((growth.wall_exponent.unwrap() - 1.0).abs() < 1e-9);
        assert_eq!(growth.cpu_exponent, None);
        let table = growth.table();
        assert!(table.contains("| 10 | 1.00 | n/a | n/a |"), "{table}");
        assert!(table.contains("| +3.00 % |"), "{table}");
    }
}

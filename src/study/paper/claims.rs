//! The paper's claims about MSFOA: the paper's number, the measured number, and whether the
//! claim holds.

use super::contestants::Contestant;
use super::convergence::Curve;
use super::published::{PUBLISHED, Published};
use super::results::{INTERPRETATIONS, Results};
use crate::study::document::{Table, yes_no};
use crate::study::stats::Summary;

/// Indices of contestants, of [`PUBLISHED`] and of [`Results::contestants`] alike.
const MSFOA: usize = 0;
const FOA: usize = 1;
const ABC: usize = 4;
const MFOA: usize = 6;

/// One reading of MSFOA on a map that stands for one of the paper's scenarios.
struct Case<'a> {
    results: &'a Results<'a>,
    contestants: Vec<&'a Contestant>,
    map: &'a str,
    scenario: usize,
}

/// The paper's number, the measured one, and whether the claim holds.
type Judged = (String, String, bool);

/// A claim and its judgement; `None` where the paper claims nothing.
type Claim = (&'static str, fn(&Case<'_>) -> Option<Judged>);

const CLAIMS: [Claim; 7] = [
    (
        "share of the budget in which MSFOA reaches FOA's last average (abstract)",
        reaches_foa,
    ),
    (
        "place of MSFOA among the seven by average (Table 3)",
        |case| place(case, 1, |of| of.average),
    ),
    (
        "place of MSFOA among the seven by best run (Table 2)",
        |case| place(case, 0, |of| of.best),
    ),
    (
        "highest average of MSFOA, MFOA, ABC over the lowest of DE, FOA, PSO, IFFO (Table 3)",
        leading_group,
    ),
    (
        "MSFOA's average over MFOA's after a tenth of the budget, and at its end (Figure 5)",
        early_and_late,
    ),
    ("algorithm of the highest average (Table 3)", highest),
    (
        "algorithms whose best run is unsafe (section 4)",
        unsafe_best,
    ),
];

/// Every claim for every reading of MSFOA; lists are in the order of the maps.
pub(super) fn claims(results: &Results<'_>) -> Table {
    let mut table = Table::new(
        "Claims, the paper's numbers and those measured, map by map.",
        "claim | reading | paper | measured | holds",
    );
    for (claim, judge) in CLAIMS {
        for reading in INTERPRETATIONS {
            let Some(msfoa) = results.find(reading.0, reading.1) else {
                continue;
            };
            let cases = results.maps.iter().filter_map(|map| {
                Some(Case {
                    results,
                    contestants: results.contestants(reading),
                    map,
                    scenario: results.scenario(map)?,
                })
            });
            let judged: Vec<Judged> = cases.filter_map(|case| judge(&case)).collect();
            let list = |pick: fn(&Judged) -> &str| {
                let all: Vec<&str> = judged.iter().map(pick).collect();
                all.join("; ")
            };
            table.row(format!(
                "{claim} | {} | {} | {} | {}",
                msfoa.title(),
                list(|of| &of.0),
                list(|of| &of.1),
                list(|of| yes_no(of.2)),
            ));
        }
    }
    table
}

impl Case<'_> {
    /// A statistic of the seven; `None` unless all have runs.
    fn measured(&self, value: fn(&Summary) -> f64) -> Option<Vec<f64>> {
        let all = self.contestants.iter();
        let all = all.map(|one| self.results.summary(one, self.map).map(|of| value(&of)));
        all.collect()
    }

    /// Best, average or median of the seven in the paper's Table 3.
    fn published(&self, column: usize) -> Vec<f64> {
        let row = |row: &Published| row.spread(self.scenario)[column];
        PUBLISHED.iter().map(row).collect()
    }

    fn curve(&self, one: usize) -> Curve<'_> {
        Curve::new(self.results, self.contestants[one], self.map)
    }
}

fn reaches_foa(case: &Case<'_>) -> Option<Judged> {
    let foa = case.measured(|of| of.average)?[FOA];
    let share = case.curve(MSFOA).reaches(foa);
    let measured = share.map_or("never".to_owned(), |share| {
        format!("{:.0} %", 100.0 * share)
    });
    let holds = share.is_some_and(|share| share < 1.0);
    Some(("< 100 %".to_owned(), measured, holds))
}

fn place(case: &Case<'_>, column: usize, value: fn(&Summary) -> f64) -> Option<Judged> {
    let place = |all: &[f64]| 1 + all.iter().filter(|other| **other < all[MSFOA]).count();
    let paper = place(&case.published(column));
    let measured = place(&case.measured(value)?);
    Some((paper.to_string(), measured.to_string(), measured <= paper))
}

fn leading_group(case: &Case<'_>) -> Option<Judged> {
    let ratio = |all: &[f64]| {
        let (mut max, mut min_other) = (f64::MIN, f64::MAX);
        for (index, value) in all.iter().enumerate() {
            match index {
                MSFOA | ABC | MFOA => max = max.max(*value),
                _ => min_other = min_other.min(*value),
            }
        }
        max / min_other
    };
    let (paper, measured) = (
        ratio(&case.published(1)),
        ratio(&case.measured(|of| of.average)?),
    );
    Some((
        format!("{paper:.2}"),
        format!("{measured:.2}"),
        measured < 1.0,
    ))
}

fn early_and_late(case: &Case<'_>) -> Option<Judged> {
    let (msfoa, mfoa) = (case.curve(MSFOA).spread, case.curve(MFOA).spread);
    let last = msfoa.len().min(mfoa.len()).checked_sub(1)?;
    let ratio = |k: usize| msfoa[k].average / mfoa[k].average;
    let (early, late) = (ratio(last / 10), ratio(last));
    let paper = case.published(1);
    Some((
        format!("> 1, {:.2}", paper[MSFOA] / paper[MFOA]),
        format!("{early:.2}, {late:.2}"),
        early > 1.0 && late < 1.0,
    ))
}

fn highest(case: &Case<'_>) -> Option<Judged> {
    let highest = |all: &[f64]| {
        let all = PUBLISHED.iter().zip(all);
        let highest = all.max_by(|a, b| a.1.total_cmp(b.1));
        highest.map(|(row, _)| row.label)
    };
    let paper = highest(&case.published(1))?;
    let measured = highest(&case.measured(|of| of.average)?)?;
    Some((paper.to_owned(), measured.to_owned(), paper == measured))
}

/// The paper finds all best runs safe in its first scenario, and all but those of DE and IFFO
/// in its second; it does not say for the third.
fn unsafe_best(case: &Case<'_>) -> Option<Judged> {
    let paper = *["none", "DE, IFFO"].get(case.scenario)?;
    let rows = PUBLISHED.iter().zip(&case.contestants);
    let names: Vec<&str> = rows
        .filter(|(_, one)| {
            case.results
                .best(one, case.map)
                .is_some_and(|best| !best.safe)
        })
        .map(|(row, _)| row.label)
        .collect();
    let measured = match names.is_empty() {
        true => "none".to_owned(),
        false => names.join(", "),
    };
    let holds = measured == paper;
    Some((paper.to_owned(), measured, holds))
}

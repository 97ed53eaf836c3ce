//! What the paper claims of MSFOA, and what of it holds in these runs.

use std::fmt::Write;

use super::account::row_name;
use super::contest::{Contestant, Protocol};
use super::convergence::Curve;
use super::tables::{OTHERS, READINGS, Results};

/// Below this p a difference counts as one.
const SIGNIFICANT: f64 = 0.05;

/// The account of what reproduces, for every reading of MSFOA.
pub(super) fn claims(text: &mut String, results: &Results<'_>) {
    let _ = writeln!(text, "\n## What holds\n");
    verdicts(text, results);
    opponents(text, results);
    let columns = readings(results);
    let names: Vec<String> = columns.iter().map(|one| row_name(one)).collect();
    let _ = writeln!(
        text,
        "\nThe paper's claims one by one, on {}:\n\n| claim, and what is measured | {} |\n|---|{}",
        results.maps.join(", "),
        names.join(" | "),
        "---|".repeat(names.len())
    );
    for (claim, measured) in [
        (
            "\"Superior to the original FOA in terms of convergence\" (abstract): MSFOA has FOA's \
             last average after this share of its evaluations",
            per_reading(results, reaches_foa),
        ),
        (
            "The smallest average on the first and the third map, the second smallest on the \
             second (Table 3): place among the seven by average",
            per_reading(results, |results, msfoa, map| {
                place(results, msfoa, map, |of| of.average)
            }),
        ),
        (
            "The smallest best cost (Table 2): place among the seven by best run",
            per_reading(results, |results, msfoa, map| {
                place(results, msfoa, map, |of| of.best)
            }),
        ),
        (
            "MSFOA, MFOA and ABC ahead of DE, FOA, PSO and IFFO, as the averages of Table 3 have \
             it on every map",
            per_reading(results, leading_group),
        ),
        (
            "\"MFOA achieves a faster convergence speed ... in the early stages. However, in the \
             later iterations ... MSFOA still shows the ability to search for better solutions\" \
             (Figure 5): who has the lower average after a tenth of the budget, and at its end",
            per_reading(results, early_and_late),
        ),
    ] {
        let _ = writeln!(text, "| {claim} | {} |", measured.join(" | "));
    }
    let _ = writeln!(text);
    worst(text, results);
    safety(text, results);
}

/// One line for each reading: whether it is the best of the seven.
fn verdicts(text: &mut String, results: &Results<'_>) {
    for reading in READINGS {
        let Some(msfoa) = results.find(reading.0, reading.1) else {
            continue;
        };
        let places: Vec<usize> = results
            .maps
            .iter()
            .filter_map(|map| rank(results, msfoa, map, |of| of.average))
            .collect();
        let (ranks, _) = results.friedman(reading).unwrap_or_default();
        let seven = results.seven(reading);
        let mut order: Vec<(f64, &str)> = ranks
            .into_iter()
            .zip(seven.iter().map(|one| one.label))
            .collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let order: Vec<&str> = order.into_iter().map(|(_, label)| label).collect();
        let best = if places.iter().all(|place| *place == 1) {
            "the best of the seven on every map"
        } else if places.contains(&1) {
            "the best of the seven on some maps only"
        } else {
            "not the best of the seven on any map"
        };
        let _ = writeln!(
            text,
            "- {}: {best}, by average. By Friedman's ranks: {}.",
            row_name(msfoa),
            order.join(" < ")
        );
    }
}

/// A table of who beats MSFOA.
fn opponents(text: &mut String, results: &Results<'_>) {
    let columns = readings(results);
    let names: Vec<String> = columns.iter().map(|one| row_name(one)).collect();
    let _ = writeln!(
        text,
        "\nMSFOA against each other algorithm, map by map: + it has the lower median, - the \
         higher, = no difference at 5 % (rank sums). The paper claims + throughout, but for \
         MFOA on the second map.\n\n| against | {} |\n|---|{}",
        names.join(" | "),
        "---|".repeat(names.len())
    );
    for name in OTHERS {
        let Some(other) = results.find(name, Protocol::Evaluations) else {
            continue;
        };
        let cells: Vec<String> = columns
            .iter()
            .map(|msfoa| {
                let signs = results
                    .maps
                    .iter()
                    .map(|map| sign(results, msfoa, other, map));
                signs.collect::<Vec<_>>().join(" ")
            })
            .collect();
        let _ = writeln!(text, "| {} | {} |", other.label, cells.join(" | "));
    }
}

fn sign(results: &Results<'_>, msfoa: &Contestant, other: &Contestant, map: &str) -> &'static str {
    let differs = results
        .p(other, msfoa, map)
        .is_some_and(|p| p < SIGNIFICANT);
    let median = |of| results.summary(of, map).map(|summary| summary.median);
    match (differs, median(msfoa) < median(other)) {
        (false, _) => "=",
        (true, true) => "+",
        (true, false) => "-",
    }
}

/// The readings of MSFOA.
fn readings<'a>(results: &'a Results<'_>) -> Vec<&'a Contestant> {
    READINGS
        .iter()
        .filter_map(|(name, protocol)| results.find(name, *protocol))
        .collect()
}

/// Something measured for each reading, map by map.
fn per_reading(
    results: &Results<'_>,
    measure: impl Fn(&Results<'_>, &Contestant, &str) -> Option<String>,
) -> Vec<String> {
    let measured = readings(results).into_iter().map(|msfoa| {
        let maps = results.maps.iter();
        let all: Vec<String> = maps
            .filter_map(|map| measure(results, msfoa, map))
            .collect();
        all.join(", ")
    });
    measured.collect()
}

/// Place among the seven, from 1.
fn rank(
    results: &Results<'_>,
    msfoa: &Contestant,
    map: &str,
    value: impl Fn(&super::stats::Summary) -> f64,
) -> Option<usize> {
    let own = value(&results.summary(msfoa, map)?);
    let others = OTHERS.iter().filter_map(|name| {
        let other = results.find(name, Protocol::Evaluations)?;
        Some(value(&results.summary(other, map)?))
    });
    Some(1 + others.filter(|other| *other < own).count())
}

fn place(
    results: &Results<'_>,
    msfoa: &Contestant,
    map: &str,
    value: impl Fn(&super::stats::Summary) -> f64,
) -> Option<String> {
    rank(results, msfoa, map, value).map(|place| place.to_string())
}

fn reaches_foa(results: &Results<'_>, msfoa: &Contestant, map: &str) -> Option<String> {
    let foa = results.find("foa", Protocol::Evaluations)?;
    let last = results.summary(foa, map)?.average;
    let share = Curve::new(results, msfoa, map).reaches(last);
    Some(share.map_or("never".to_owned(), |share| {
        format!("{:.0} %", 100.0 * share)
    }))
}

fn leading_group(results: &Results<'_>, msfoa: &Contestant, map: &str) -> Option<String> {
    let average = |name: &&str| {
        let other = results.find(name, Protocol::Evaluations)?;
        results.summary(other, map).map(|of| of.average)
    };
    let own = results.summary(msfoa, map)?.average;
    let first = ["mfoa", "abc"]
        .iter()
        .filter_map(average)
        .fold(own, f64::max);
    let second = ["de", "foa", "pso", "iffo"].iter().filter_map(average);
    let holds = first < second.fold(f64::INFINITY, f64::min);
    Some(if holds { "yes" } else { "no" }.to_owned())
}

fn early_and_late(results: &Results<'_>, msfoa: &Contestant, map: &str) -> Option<String> {
    let mfoa = results.find("mfoa", Protocol::Evaluations)?;
    let (own, other) = (
        Curve::new(results, msfoa, map).spread,
        Curve::new(results, mfoa, map).spread,
    );
    let lower = |k: usize| {
        let is_own = own.get(k)?.average < other.get(k)?.average;
        Some(if is_own { "MSFOA" } else { "MFOA" })
    };
    let last = own.len().min(other.len()).checked_sub(1)?;
    Some(format!("{} then {}", lower(last / 10)?, lower(last)?))
}

/// Who is last.
fn worst(text: &mut String, results: &Results<'_>) {
    let last = results.maps.iter().filter_map(|map| {
        let all = results.seven(READINGS[0]).into_iter();
        let averages = all.filter_map(|one| Some((one.label, results.summary(one, map)?.average)));
        averages
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(label, _)| label)
    });
    let last: Vec<&str> = last.collect();
    let _ = writeln!(
        text,
        "- IFFO last, by the geometric mean of Table 3: the highest average has {}.",
        last.join(", ")
    );
}

/// Who is safe: the paper says all on the first map, and all but DE and IFFO on the second.
fn safety(text: &mut String, results: &Results<'_>) {
    let maps = results.maps.iter().map(|map| {
        let unsafe_best: Vec<String> = results
            .contestants
            .iter()
            .filter(|one| one.role == super::contest::Role::Paper)
            .filter(|one| results.best(one, map).is_some_and(|best| !best.safe))
            .map(row_name)
            .collect();
        if unsafe_best.is_empty() {
            format!("on {map} none")
        } else {
            format!("on {map} {}", unsafe_best.join("; "))
        }
    });
    let _ = writeln!(
        text,
        "- \"For the first scenario, all seven tested algorithms find the safe flight path\", and \
         on the second \"DE and IFFO come into the threat areas\": best runs that are not safe at \
         2001 samples are {}.",
        maps.collect::<Vec<_>>().join(", ")
    );
}

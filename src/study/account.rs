//! `RESULTS.md`: what was measured beside what the paper prints, and what of it holds.

use std::fmt::Write;

use super::contest::{Contestant, Role};
use super::printed::{PRINTED, Printed};
use super::stats::number;
use super::tables::{OTHERS, READINGS, Results};

/// Below this p a difference counts as one.
const SIGNIFICANT: f64 = 0.05;

/// The whole document. It depends on the runs alone.
#[must_use]
pub fn results_md(results: &Results<'_>) -> String {
    let mut text = String::new();
    head(&mut text, results);
    let shipped = is_papers(results);
    for (index, map) in results.maps.iter().enumerate() {
        let _ = writeln!(text, "\n## {map}\n");
        best(&mut text, results, map, shipped.then_some(index));
        spread(&mut text, results, map, shipped.then_some(index));
    }
    tests(&mut text, results);
    account(&mut text, results, shipped);
    text
}

/// Whether the maps stand for the paper's three.
fn is_papers(results: &Results<'_>) -> bool {
    results.maps == ["s1", "s2", "s3"]
}

fn head(text: &mut String, results: &Results<'_>) {
    let config = results.config;
    let _ = writeln!(
        text,
        "# The paper's experiment, run again\n\n\
         Written by `sortie study paper`; study {}, sortie {}.\n\n\
         {} runs, population {}, {} iterations, seeds {} and up. Maps, weights and whatever \
         else the paper does not print are ours (the headers of the files in `src/optimize` and \
         `src/cost/paper.rs` say how each gap is read); costs compare with the paper's in ratio \
         only.\n\n\
         - Equal iterations: MSFOA evaluates each fly twice and spends {} evaluations on a \
         vehicle, the others {}. Equal evaluations: {} for all. Only MSFOA differs between the \
         two.\n\
         - Safe: at 2001 samples no threat entered, no ground hit, no turn, slope or collision \
         limit broken by any vehicle. J sums over 101 samples, between which a path can hop \
         over a threat; J at 2001 shows it.",
        config.hash().chars().take(12).collect::<String>(),
        config.version,
        config.runs,
        config.population,
        config.iterations,
        config.seed,
        results.contestants[0].budget(config.population, config.iterations),
        config.population * config.iterations,
        config.population * config.iterations,
    );
    if config.runs < 40 {
        let _ = writeln!(
            text,
            "- The paper makes 40 runs; with {} every test here is weak.",
            config.runs
        );
    }
}

fn protocol(contestant: &Contestant) -> String {
    format!("{}, equal {}", contestant.label, contestant.protocol.name())
}

fn printed(contestant: &Contestant) -> Option<&'static Printed> {
    let name = if contestant.name == "msfoa-literal" || contestant.name == "msfoa-dwindle" {
        "msfoa"
    } else {
        contestant.name
    };
    PRINTED
        .iter()
        .find(|printed| printed.label.eq_ignore_ascii_case(name))
}

/// Table 2.
fn best(text: &mut String, results: &Results<'_>, map: &str, index: Option<usize>) {
    let vehicles = results
        .best(&results.contestants[0], map)
        .map_or(0, |record| record.vehicles.len());
    let names: Vec<String> = (1..=vehicles).map(|k| format!("J{k}")).collect();
    let _ = writeln!(
        text,
        "Best run (Table 2), its vehicles and their sum; in brackets the sum at 2001 samples.\n\n\
         | algorithm | {} | sum | safe | paper: {} | printed sum | sum of its parts |\n\
         |---|{}",
        names.join(" | "),
        names.join(", "),
        "---:|".repeat(vehicles + 5)
    );
    for contestant in &results.contestants {
        let Some(record) = results.best(contestant, map) else {
            continue;
        };
        let parts: Vec<String> = record
            .vehicles
            .iter()
            .map(|vehicle| format!("{:.2}", vehicle.total))
            .collect();
        let theirs = index.and_then(|index| printed(contestant).map(|printed| printed.best[index]));
        let theirs = theirs.map_or(" | | ".to_owned(), |[a, b, c, sum]| {
            format!("{a:.2}, {b:.2}, {c:.2} | {sum:.2} | {:.2}", a + b + c)
        });
        let _ = writeln!(
            text,
            "| {} | {} | {:.2} ({:.2}) | {} | {theirs} |",
            protocol(contestant),
            parts.join(" | "),
            record.total,
            record.fine_total,
            if record.safe { "yes" } else { "no" },
        );
    }
}

/// Table 3.
fn spread(text: &mut String, results: &Results<'_>, map: &str, index: Option<usize>) {
    let _ = writeln!(
        text,
        "\nOver all runs (Table 3).\n\n\
         | algorithm | best | average | median | deviation | worst | safe | unsafe | paper: best, \
         average, median |\n|---|{}",
        "---:|".repeat(8)
    );
    for contestant in &results.contestants {
        let Some(of) = results.summary(contestant, map) else {
            continue;
        };
        let safe = results.safe(contestant, map);
        let theirs =
            index.and_then(|index| printed(contestant).map(|printed| printed.spread[index]));
        let theirs = theirs.map_or(String::new(), |[best, average, median]| {
            format!("{best:.2}, {average:.2}, {median:.2}")
        });
        let _ = writeln!(
            text,
            "| {} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {safe} | {} | {theirs} |",
            protocol(contestant),
            of.best,
            of.average,
            of.median,
            of.deviation,
            of.worst,
            results.totals(contestant, map).len() - safe,
        );
    }
}

/// Mean total of each map over that of another contestant.
fn ratios(results: &Results<'_>, one: &Contestant, other: &Contestant) -> Vec<f64> {
    results
        .maps
        .iter()
        .filter_map(|map| {
            let average = |of| results.summary(of, map).map(|summary| summary.average);
            Some(average(one)? / average(other)?)
        })
        .collect()
}

fn geometric_mean(values: &[f64]) -> f64 {
    (values.iter().map(|value| value.ln()).sum::<f64>() / number(values.len().max(1))).exp()
}

fn two(values: &[f64]) -> String {
    let texts: Vec<String> = values.iter().map(|value| format!("{value:.2}")).collect();
    texts.join(", ")
}

/// Ratios, rank-sum tests and Friedman ranks, reading by reading.
fn tests(text: &mut String, results: &Results<'_>) {
    let _ = writeln!(
        text,
        "\n## Tests\n\nRatio: average over MSFOA's, map by map. p: Wilcoxon's rank-sum test \
         against MSFOA, map by map, both sides, not corrected for their number. Rank: Friedman's \
         mean rank, blocks being runs of one number on one map."
    );
    for reading in READINGS {
        let Some(msfoa) = results.find(reading.0, reading.1) else {
            continue;
        };
        let (ranks, p) = results.friedman(reading).unwrap_or((Vec::new(), f64::NAN));
        let _ = writeln!(
            text,
            "\n{} (Friedman p = {p:.1e}):\n\n| algorithm | ratio | geometric mean | p | rank | \
             paper's ratio |\n|---|---:|---:|---:|---:|---:|",
            protocol(msfoa)
        );
        for (index, one) in results.seven(reading).into_iter().enumerate() {
            let ratios = ratios(results, one, msfoa);
            let p: Vec<String> = results
                .maps
                .iter()
                .map(|map| match results.p(one, msfoa, map) {
                    Some(p) if one != msfoa => format!("{p:.1e}"),
                    _ => "-".to_owned(),
                })
                .collect();
            let theirs = printed(one).map_or(Vec::new(), |printed| {
                let averages = printed.spread.iter().zip(&PRINTED[0].spread);
                averages.map(|(a, b)| a[1] / b[1]).collect()
            });
            let _ = writeln!(
                text,
                "| {} | {} | {:.3} | {} | {:.2} | {} |",
                one.label,
                two(&ratios),
                geometric_mean(&ratios),
                p.join(", "),
                ranks.get(index).copied().unwrap_or(f64::NAN),
                if is_papers(results) {
                    two(&theirs)
                } else {
                    String::new()
                },
            );
        }
    }
}

/// Who beats MSFOA and whom it beats, in sentences.
fn account(text: &mut String, results: &Results<'_>, shipped: bool) {
    let _ = writeln!(text, "\n## What holds\n");
    for reading in READINGS {
        let Some(msfoa) = results.find(reading.0, reading.1) else {
            continue;
        };
        for map in &results.maps {
            sentence(text, results, msfoa, map);
        }
    }
    parts(text, results);
    if shipped {
        let _ = writeln!(
            text,
            "\nThe paper's own Table 2 does not add up in five rows, all three of MSFOA among \
             them, each printed lower than the sum of its parts; by those sums ABC is best on \
             the first map and MFOA on the second. Its rows of PSO and FOA on the second map are \
             the same in Table 3."
        );
    }
}

fn sentence(text: &mut String, results: &Results<'_>, msfoa: &Contestant, map: &str) {
    let Some(own) = results.summary(msfoa, map) else {
        return;
    };
    let (mut better, mut worse, mut even) = (Vec::new(), Vec::new(), Vec::new());
    for name in OTHERS {
        let other = results.find(name, super::contest::Protocol::Evaluations);
        let Some((other, of)) = other.and_then(|of| Some((of, results.summary(of, map)?))) else {
            continue;
        };
        let differs = results
            .p(other, msfoa, map)
            .is_some_and(|p| p < SIGNIFICANT);
        match (differs, of.median < own.median) {
            (false, _) => even.push(other.label),
            (true, true) => better.push(other.label),
            (true, false) => worse.push(other.label),
        }
    }
    let list = |names: &[&str]| {
        if names.is_empty() {
            "none".to_owned()
        } else {
            names.join(", ")
        }
    };
    let verdict = if better.is_empty() && even.is_empty() {
        "best of the seven"
    } else if better.is_empty() && worse.is_empty() {
        "no difference found"
    } else if better.is_empty() {
        "beaten by none"
    } else {
        "not the best"
    };
    let _ = writeln!(
        text,
        "- {map}, {}: {verdict}. Better than MSFOA: {}; worse: {}; no difference at 5 %: {}.",
        protocol(msfoa),
        list(&better),
        list(&worse),
        list(&even)
    );
}

/// What the parts of MSFOA are worth, by the ablations.
fn parts(text: &mut String, results: &Results<'_>) {
    let ablations: Vec<&Contestant> = results
        .contestants
        .iter()
        .filter(|contestant| contestant.role == Role::Ablation)
        .collect();
    if ablations.is_empty() {
        return;
    }
    let _ = writeln!(
        text,
        "\nParts of MSFOA taken away, at equal evaluations: average over that of MSFOA with R \
         from 0.3 (or with R = 0.1 where it is said), map by map; above 1 the part helps.\n"
    );
    for one in ablations {
        let whole = if one.name.starts_with("literal") {
            READINGS[2]
        } else {
            READINGS[3]
        };
        let Some(whole) = results.find(whole.0, whole.1) else {
            continue;
        };
        let _ = writeln!(
            text,
            "- {}: {}",
            one.label,
            two(&ratios(results, one, whole))
        );
    }
}

//! `RESULTS.md`: what was measured beside what the paper prints, and what of it holds.

use std::fmt::Write;

use super::claims::claims;
use super::config::Config;
use super::contest::{Contestant, Role};
use super::parts::{parts, readings};
use super::printed::{Printed, printed, sums};
use super::record::{Record, Terms};
use super::stats::number;
use super::store::Study;
use super::tables::{READINGS, Results};

/// The whole document. It depends on the runs alone.
#[must_use]
pub fn results_md(results: &Results<'_>) -> String {
    let mut text = String::new();
    head(&mut text, results);
    claims(&mut text, results);
    for map in &results.maps {
        let _ = writeln!(text, "\n## {map}\n");
        best(&mut text, results, map);
        spread(&mut text, results, map);
    }
    tests(&mut text, results);
    parts(&mut text, results);
    readings(&mut text, results);
    if results
        .maps
        .iter()
        .any(|map| results.scenario(map).is_some())
    {
        sums(&mut text);
    }
    text
}

/// The command that makes these results.
fn command(config: &Config) -> String {
    let mut command = "sortie study paper".to_owned();
    let shipped = super::shipped_maps();
    let is_default = shipped.len() == config.maps.len()
        && shipped
            .iter()
            .zip(&config.maps)
            .all(|((_, text), map)| map.text == *text);
    for map in config.maps.iter().filter(|_| !is_default) {
        let _ = write!(command, " missions/paper/{}", map.file);
    }
    let _ = write!(command, " --out DIR --runs {}", config.runs);
    for (name, value, default) in [
        ("population", config.population, 100),
        ("iterations", config.iterations, 200),
    ] {
        if value != default {
            let _ = write!(command, " --{name} {value}");
        }
    }
    if let Some(points) = config.control_points {
        let _ = write!(command, " --control-points {points}");
    }
    if config.seed != 1 {
        let _ = write!(command, " --seed {}", config.seed);
    }
    for (name, is_set) in [
        ("ablations", config.ablations),
        ("readings", config.readings),
        ("published-objective", config.published_objective),
    ] {
        if is_set {
            let _ = write!(command, " --{name}");
        }
    }
    command
}

fn head(text: &mut String, results: &Results<'_>) {
    let config = results.config;
    let spent = config.population * config.iterations;
    let _ = writeln!(
        text,
        "# The paper's experiment, run again\n\n\
         Made by `{}` (sortie {}, study {}): the same command gives the same bytes on any \
         number of threads.\n\n\
         {} runs, population {}, {} iterations, seeds from {}. The maps are ours, because the \
         paper's are not printed; so is every choice where a formula is lost (the headers of the \
         files in `src/optimize` and `src/cost/paper.rs` say how each gap is read). Costs \
         therefore compare with the paper's in ratio only.\n\n\
         - J is the paper's cost, a sum over 101 samples, in brackets or as \"finely\" the same \
         path at 2001 samples. Between samples a path can hop over a threat: a J that grows when \
         it is looked at closely was gamed.\n\
         - Safe: at 2001 samples no vehicle enters a threat, hits the ground, or breaks a limit \
         of turn, slope or collision.\n\
         - Equal iterations, the paper's protocol: MSFOA evaluates each fly twice and spends {} \
         evaluations on a vehicle, the others {spent}. Equal evaluations: {spent} for all. Only \
         MSFOA differs between the two.\n\
         - MSFOA is read in two ways: the local step R constant (0.1), as printed, and shrinking \
         from 0.3, as its name \"dwindled\" suggests; the second was chosen for doing well.",
        command(config),
        config.version,
        config.hash().chars().take(12).collect::<String>(),
        config.runs,
        config.population,
        config.iterations,
        config.seed,
        results.contestants[0].budget(config.population, config.iterations),
    );
    if results.contestants.iter().any(|of| of.role == Role::Own) {
        let _ = writeln!(
            text,
            "- The default planner is this program's own search on the same objective and budget, \
             with the first quarter of the seeds; it is no part of the paper."
        );
    }
    if config.published_objective {
        let _ = writeln!(
            text,
            "- Searched is the objective as printed, gaps and all; \"finely\" and \"safe\" are of \
             the objective whose gaps are closed."
        );
    }
    if config.runs < 40 {
        let _ = writeln!(
            text,
            "- The paper makes 40 runs; with {} every test here is weak.",
            config.runs
        );
    }
}

/// Name of a row, with its protocol.
pub(super) fn row_name(contestant: &Contestant) -> String {
    match contestant.role {
        Role::Own => contestant.label.to_owned(),
        _ => format!("{}, equal {}", contestant.label, contestant.protocol.name()),
    }
}

/// The contestants of the main tables.
fn main_rows<'a>(results: &'a Results<'_>) -> impl Iterator<Item = &'a Contestant> {
    let rows = results.contestants.iter();
    rows.filter(|contestant| matches!(contestant.role, Role::Paper | Role::Own))
}

/// Table 2.
fn best(text: &mut String, results: &Results<'_>, map: &str) {
    let vehicles = results
        .best(&results.contestants[0], map)
        .map_or(0, |record| record.vehicles.len());
    let names: Vec<String> = (1..=vehicles).map(|k| format!("J{k}")).collect();
    let _ = writeln!(
        text,
        "Table 2: the best run, its vehicles and their sum.\n\n\
         | algorithm | run | {} | sum (finely) | safe | paper: {} | printed sum | sum of its parts |\n\
         |---|{}",
        names.join(" | "),
        names.join(", "),
        "---:|".repeat(vehicles + 6)
    );
    for contestant in main_rows(results) {
        let Some(record) = results.best(contestant, map) else {
            continue;
        };
        let parts: Vec<String> = record
            .vehicles
            .iter()
            .map(|vehicle| format!("{:.2}", vehicle.total))
            .collect();
        let theirs = theirs(results, contestant, map, |printed, index| {
            let [a, b, c, sum] = printed.best[index];
            format!("{a:.2}, {b:.2}, {c:.2} | {sum:.2} | {:.2}", a + b + c)
        });
        let _ = writeln!(
            text,
            "| {} | {} | {} | {:.2} ({:.2}) | {} | {} |",
            row_name(contestant),
            record.run,
            parts.join(" | "),
            record.total,
            record.fine_total,
            if record.safe { "yes" } else { "no" },
            theirs.unwrap_or_else(|| " | | ".to_owned()),
        );
    }
}

/// What the paper prints for a row of a map, if it is one of its own.
fn theirs(
    results: &Results<'_>,
    contestant: &Contestant,
    map: &str,
    show: impl Fn(&Printed, usize) -> String,
) -> Option<String> {
    let index = results.scenario(map)?;
    printed(contestant).map(|printed| show(printed, index))
}

/// Table 3.
fn spread(text: &mut String, results: &Results<'_>, map: &str) {
    let _ = writeln!(
        text,
        "\nTable 3: all runs, and the limits that unsafe ones break, with the number of runs.\n\n\
         | algorithm | runs | best | average | median | deviation | worst | average, finely | \
         safe | unsafe | because of | paper: best, average, median |\n|---|{}---|---:|",
        "---:|".repeat(9)
    );
    for contestant in main_rows(results) {
        let Some(of) = results.summary(contestant, map) else {
            continue;
        };
        let safe = results.safe(contestant, map);
        let runs = results.totals(contestant, map).len();
        let fine: f64 = results
            .cell(contestant, map)
            .map(|record| record.fine_total)
            .sum();
        let theirs = theirs(results, contestant, map, |printed, index| {
            let [best, average, median] = printed.spread[index];
            format!("{best:.2}, {average:.2}, {median:.2}")
        });
        let _ = writeln!(
            text,
            "| {} | {runs} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {safe} | {} | {} | {} |",
            row_name(contestant),
            of.best,
            of.average,
            of.median,
            of.deviation,
            of.worst,
            fine / number(runs.max(1)),
            runs - safe,
            causes(results, contestant, map),
            theirs.unwrap_or_default(),
        );
    }
}

/// A limit by name, and the term that is above 0 where it is broken.
type Limit = (&'static str, fn(&Terms) -> f64);

/// The limits that runs break at 2001 samples, with the number of runs.
fn causes(results: &Results<'_>, contestant: &Contestant, map: &str) -> String {
    let limits: [Limit; 5] = [
        ("threat", |terms| terms.threat),
        ("ground", |terms| terms.terrain),
        ("turn", |terms| terms.turn),
        ("slope", |terms| terms.climb),
        ("collision", |terms| terms.collision),
    ];
    let broken = limits.into_iter().filter_map(|(name, term)| {
        let breaks = |record: &&Record| {
            record
                .vehicles
                .iter()
                .any(|vehicle| term(&vehicle.fine) > 0.0)
        };
        let count = results.cell(contestant, map).filter(breaks).count();
        (count > 0).then(|| format!("{name} {count}"))
    });
    broken.collect::<Vec<_>>().join(", ")
}

/// Ratios, rank-sum tests and Friedman ranks, reading by reading.
fn tests(text: &mut String, results: &Results<'_>) {
    let _ = writeln!(
        text,
        "\n## Tests\n\nRatio: average over MSFOA's, map by map ({}). p: Wilcoxon's rank-sum test \
         against MSFOA, map by map, both sides, not corrected for their number. Rank: Friedman's \
         mean rank, blocks being runs of one number on one map.",
        results.maps.join(", ")
    );
    for reading in READINGS {
        let Some(msfoa) = results.find(reading.0, reading.1) else {
            continue;
        };
        let (ranks, p) = results.friedman(reading).unwrap_or((Vec::new(), f64::NAN));
        let _ = writeln!(
            text,
            "\n{} (Friedman p = {}):\n\n| algorithm | ratio | geometric mean | p | rank | \
             paper's ratio | its geometric mean |\n|---|---:|---:|---:|---:|---:|---:|",
            row_name(msfoa),
            probability(p)
        );
        for (index, one) in results.seven(reading).into_iter().enumerate() {
            let ratios = results.ratios(one, msfoa);
            let theirs: Vec<f64> = results
                .maps
                .iter()
                .filter_map(|map| {
                    let average = |of| Some(printed(of)?.spread[results.scenario(map)?][1]);
                    Some(average(one)? / average(msfoa)?)
                })
                .collect();
            let _ = writeln!(
                text,
                "| {} | {} | {} | {} | {:.2} | {} | {} |",
                one.label,
                two(&ratios),
                geometric_mean(&ratios),
                probabilities(results, one, msfoa),
                ranks.get(index).copied().unwrap_or(f64::NAN),
                two(&theirs),
                geometric_mean(&theirs),
            );
        }
    }
}

/// p of one contestant against another, map by map.
pub(super) fn probabilities(results: &Results<'_>, one: &Contestant, other: &Contestant) -> String {
    let all = results
        .maps
        .iter()
        .map(|map| match results.p(one, other, map) {
            Some(p) if one != other => probability(p),
            _ => "-".to_owned(),
        });
    all.collect::<Vec<_>>().join(", ")
}

/// A probability, short.
fn probability(p: f64) -> String {
    if p >= 0.001 {
        format!("{p:.3}")
    } else {
        format!("{p:.0e}")
    }
}

/// Geometric mean; nothing of nothing, or where a cost below 0 has none.
pub(super) fn geometric_mean(values: &[f64]) -> String {
    if values.is_empty() || values.iter().any(|value| *value <= 0.0) {
        return String::new();
    }
    let logs: f64 = values.iter().map(|value| value.ln()).sum();
    format!("{:.3}", (logs / number(values.len())).exp())
}

/// Numbers with two digits.
pub(super) fn two(values: &[f64]) -> String {
    let texts: Vec<String> = values.iter().map(|value| format!("{value:.2}")).collect();
    texts.join(", ")
}

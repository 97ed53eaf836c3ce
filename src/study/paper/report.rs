//! The document of the experiment: measured costs and those of the paper, side by side.

use std::fmt::Write;

use super::claims::claims;
use super::config::Config;
use super::contestants::{Contestant, Protocol, Role};
use super::published::{Published, of_contestant};
use super::results::{INTERPRETATIONS, Interpretation, Results};
use super::shipped_maps;
use crate::cost::CostTerms;
use crate::numeric::as_f64;
use crate::study::document::{Document, Table, yes_no};
use crate::study::store::Study;

pub(super) fn document(results: &Results<'_>) -> Document {
    let mut sections = Vec::new();
    let maps = &results.maps;
    let is_paper = maps.iter().any(|map| results.scenario(map).is_some());
    if is_paper {
        sections.push(("Claims of the paper".to_owned(), vec![claims(results)]));
    }
    for map in maps {
        sections.push((map.clone(), vec![best(results, map), spread(results, map)]));
    }
    let tests = INTERPRETATIONS
        .iter()
        .map(|reading| tests(results, *reading));
    sections.push(("Tests".to_owned(), tests.collect()));
    for (role, name) in [
        (Role::Ablation, "Parts of MSFOA taken away"),
        (Role::Interpretation, "Other readings of the paper"),
    ] {
        if results.contestants.iter().any(|one| one.role == role) {
            sections.push((name.to_owned(), vec![variations(results, role)]));
        }
    }
    Document {
        title: "The paper's experiment, run again",
        command: command(results.config),
        notes: notes(results),
        sections,
    }
}

/// The command that makes these results.
fn command(config: &Config) -> String {
    let mut command = "sortie study paper".to_owned();
    let shipped = shipped_maps().map(|(_, text)| text);
    if !config.maps.iter().map(|map| map.text.as_str()).eq(shipped) {
        for map in &config.maps {
            let _ = write!(command, " missions/paper/{}", map.file);
        }
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

/// Definitions.
fn notes(results: &Results<'_>) -> Vec<String> {
    let config = results.config;
    let spent = config.population * config.iterations;
    let hash = &config.hash()[..12];
    let msfoa = results.contestants[0].budget(config.population, config.iterations);
    let searched = if config.published_objective {
        "the objective as published"
    } else {
        "the objective with its gaps closed"
    };
    vec![
        format!(
            "Study {hash}, sortie {}: {} runs (the paper: 40), population {}, {} iterations, \
             seeds from {}; searched: {searched}.",
            config.version, config.runs, config.population, config.iterations, config.seed
        ),
        "Costs compare with the paper's in ratio only: its maps are not published. The headers \
         of `src/optimize` and `src/cost/paper.rs` state how each gap of the paper is read."
            .to_owned(),
        "J: the paper's cost at 101 samples; finely: J of the same path at 2001 samples. Safe: \
         at 2001 samples no vehicle enters a threat, hits the ground, or breaks a limit of turn, \
         slope or collision."
            .to_owned(),
        format!(
            "Equal iterations, the paper's protocol: {msfoa} evaluations for each vehicle for \
             MSFOA, {spent} for the others. Equal evaluations: {spent} for all."
        ),
        "MSFOA, R = 0.1: the published local step. R from 0.3: the step shrinks to 0.".to_owned(),
        "The default planner and all variations run the first quarter of the seeds.".to_owned(),
        "p: Wilcoxon's rank-sum test, two-sided, not corrected for the number of tests. MSFOA \
         better: + and - where p is below 0.05, else =; by the paper + against all, except - \
         against MFOA on its second map. Rank: Friedman's mean rank; blocks are runs of one number on one map. Lists are in the order \
         of the maps."
            .to_owned(),
    ]
}

/// The contestants of the main tables.
fn main_rows<'a>(results: &'a Results<'_>) -> impl Iterator<Item = &'a Contestant> {
    let rows = results.contestants.iter();
    rows.filter(|contestant| matches!(contestant.role, Role::Paper | Role::Own))
}

/// The published row of a contestant and the index of the paper's scenario.
fn published(
    results: &Results<'_>,
    contestant: &Contestant,
    map: &str,
) -> Option<(&'static Published, usize)> {
    of_contestant(contestant).zip(results.scenario(map))
}

fn best(results: &Results<'_>, map: &str) -> Table {
    let first = results.best(&results.contestants[0], map);
    let vehicles = first.map_or(0, |record| record.vehicles.len());
    let names: Vec<String> = (1..=vehicles).map(|k| format!("J{k}")).collect();
    let mut table = Table::new(
        "Table 2: the best run, its vehicles and their sum.",
        format!(
            "algorithm | run | {} | sum (finely) | safe | paper: {} | published sum | sum of its parts",
            names.join(" | "),
            names.join(", ")
        ),
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
        let paper = published(results, contestant, map).map(|(row, index)| {
            let [a, b, c, sum] = row.best[index];
            format!("{a:.2}, {b:.2}, {c:.2} | {sum:.2} | {:.2}", a + b + c)
        });
        table.row(format!(
            "{} | {} | {} | {:.2} ({:.2}) | {} | {}",
            contestant.title(),
            record.run,
            parts.join(" | "),
            record.total,
            record.fine_total,
            yes_no(record.safe),
            paper.unwrap_or_else(|| " |  | ".to_owned()),
        ));
    }
    table
}

fn spread(results: &Results<'_>, map: &str) -> Table {
    let mut table = Table::new(
        "Table 3: all runs, and the number of runs that break each limit at 2001 samples.",
        "algorithm | runs | best | average | median | deviation | worst | average, finely | safe | \
         unsafe | limits broken | paper: best, average, median",
    );
    for contestant in main_rows(results) {
        let Some(of) = results.summary(contestant, map) else {
            continue;
        };
        let safe = results.safe(contestant, map);
        let fine = results
            .cell(contestant, map)
            .map(|record| record.fine_total);
        let (fine, runs): (f64, usize) =
            fine.fold((0.0, 0), |(sum, runs), fine| (sum + fine, runs + 1));
        let paper = published(results, contestant, map).map(|(row, index)| {
            let [best, average, median] = row.spread(index);
            format!("{best:.2}, {average:.2}, {median:.2}")
        });
        table.row(format!(
            "{} | {runs} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {safe} | {} | {} | {}",
            contestant.title(),
            of.best,
            of.average,
            of.median,
            of.deviation,
            of.worst,
            fine / as_f64(runs),
            runs - safe,
            broken_limits(results, contestant, map),
            paper.unwrap_or_default(),
        ));
    }
    table
}

/// A limit by name, and the term that is above 0 where it is broken.
type Limit = (&'static str, fn(&CostTerms) -> f64);

fn broken_limits(results: &Results<'_>, contestant: &Contestant, map: &str) -> String {
    let limits: [Limit; 5] = [
        ("threat", |terms| terms.threat),
        ("ground", |terms| terms.terrain),
        ("turn", |terms| terms.turn),
        ("slope", |terms| terms.climb),
        ("collision", |terms| terms.collision),
    ];
    let counts = limits.into_iter().filter_map(|(name, term)| {
        let runs = results.cell(contestant, map);
        let broken = runs.filter(|run| run.vehicles.iter().any(|of| term(&of.fine) > 0.0));
        let count = broken.count();
        (count > 0).then(|| format!("{name} {count}"))
    });
    counts.collect::<Vec<_>>().join(", ")
}

/// Ratios to one reading of MSFOA, rank-sum tests and Friedman's ranks.
fn tests(results: &Results<'_>, reading: Interpretation) -> Table {
    let msfoa = results.find(reading.0, reading.1);
    let title = msfoa.map_or_else(String::new, Contestant::title);
    let (ranks, p) = results.friedman(reading).unwrap_or_default();
    let mut table = Table::new(
        format!(
            "Averages over those of {title} (Friedman p = {})",
            probability(p)
        ),
        "algorithm | ratio | geometric mean | p | MSFOA better | rank | paper's ratio | its geometric mean",
    );
    let average = |of, map: &String| {
        let (row, index) = published(results, of, map)?;
        Some(row.spread(index)[1])
    };
    for (one, rank) in results.contestants(reading).into_iter().zip(ranks) {
        let Some(msfoa) = msfoa else { continue };
        let ratios = results.ratios(one, msfoa);
        let maps = results.maps.iter();
        let paper: Vec<f64> = maps
            .filter_map(|map| Some(average(one, map)? / average(msfoa, map)?))
            .collect();
        table.row(format!(
            "{} | {} | {} | {} | {} | {rank:.2} | {} | {}",
            one.label,
            list(&ratios),
            geometric_mean(&ratios),
            probabilities(results, one, msfoa),
            signs(results, one, msfoa),
            list(&paper),
            geometric_mean(&paper),
        ));
    }
    table
}

/// Variations of MSFOA and of others, each with the contestant that it varies.
fn variations(results: &Results<'_>, role: Role) -> Table {
    let mut table = Table::new(
        "Ratio: the variation's average over that of the contestant it is compared with.",
        "variation | compared with | average | safe runs | ratio | geometric mean | p",
    );
    let mut row = |one: &Contestant, whole: &Contestant| {
        let maps = || results.maps.iter();
        let averages = maps().filter_map(|map| Some(results.summary(one, map)?.average));
        let safe: Vec<String> = maps()
            .map(|map| results.safe(one, map).to_string())
            .collect();
        let ratios = results.ratios(one, whole);
        table.row(format!(
            "{} | {} | {} | {} | {} | {} | {}",
            one.label,
            whole.title(),
            list(&averages.collect::<Vec<_>>()),
            safe.join(", "),
            list(&ratios),
            geometric_mean(&ratios),
            probabilities(results, one, whole),
        ));
    };
    for one in results.contestants.iter().filter(|one| one.role == role) {
        let family = one.name.split('-').next().unwrap_or_default();
        let whole = match family {
            "literal" | "dwindle" => format!("msfoa-{family}"),
            other => other.to_owned(),
        };
        if let Some(whole) = results.find(&whole, Protocol::Evaluations) {
            row(one, whole);
        }
    }
    if role == Role::Ablation {
        let [(literal, iterations), _, (_, evaluations), (dwindle, _)] = INTERPRETATIONS;
        for (one, whole) in [
            ((literal, evaluations), (dwindle, evaluations)),
            (("literal-no-offspring", evaluations), (literal, iterations)),
        ] {
            if let Some((one, whole)) =
                (results.find(one.0, one.1)).zip(results.find(whole.0, whole.1))
            {
                row(one, whole);
            }
        }
    }
    table
}

/// p of one contestant against another, map by map.
fn probabilities(results: &Results<'_>, one: &Contestant, other: &Contestant) -> String {
    let all = results
        .maps
        .iter()
        .map(|map| match results.p(one, other, map) {
            Some(p) if one != other => probability(p),
            _ => "-".to_owned(),
        });
    all.collect::<Vec<_>>().join(", ")
}

/// Map by map: + the reading of MSFOA has the lower median, - the higher, = not significant.
fn signs(results: &Results<'_>, one: &Contestant, msfoa: &Contestant) -> String {
    /// Below this p a difference is significant.
    const SIGNIFICANT: f64 = 0.05;
    let sign = |map: &String| {
        let median = |of| results.summary(of, map).map(|summary| summary.median);
        let p = results.p(one, msfoa, map).unwrap_or(1.0);
        match (p < SIGNIFICANT, median(msfoa) < median(one)) {
            (false, _) => "=",
            (true, true) => "+",
            (true, false) => "-",
        }
    };
    let signs: Vec<&str> = results.maps.iter().map(sign).collect();
    signs.join(" ")
}

fn probability(p: f64) -> String {
    if p >= 0.001 {
        format!("{p:.3}")
    } else {
        format!("{p:.0e}")
    }
}

/// Geometric mean; empty without values, or where a cost is not above 0.
fn geometric_mean(values: &[f64]) -> String {
    if values.is_empty() || values.iter().any(|value| *value <= 0.0) {
        return String::new();
    }
    let logs: f64 = values.iter().map(|value| value.ln()).sum();
    format!("{:.3}", (logs / as_f64(values.len())).exp())
}

fn list(values: &[f64]) -> String {
    let texts: Vec<String> = values.iter().map(|value| format!("{value:.2}")).collect();
    texts.join(", ")
}

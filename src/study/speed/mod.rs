//! Costs per second of the objective on this machine.
//!
//! The world is the third map of the paper's experiment with a tenth threat, its ground on a
//! grid of 513 nodes a side. The path has 8 free control points and 101 samples, and
//! each reads the ground once unless stated otherwise. Candidates are a [`Population`] around a path
//! found by differential evolution. A rate is that of the fastest of several passes, because
//! other programs slow down the others.

mod course;

use std::time::Instant;

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::Serialize;

use super::document::Table;
use super::setting::controls;
use crate::cost::{Batch, CostModel, Dispatch, Scratch};
use crate::numeric::as_f64;
use crate::spec::{Objective, SpecError};
use course::{BATCH, CANDIDATES};

pub use course::{Population, SpeedCourse};

/// Evaluations per second.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Speed {
    /// By the operational objective.
    #[serde(flatten)]
    pub rates: Rates,
    /// Near candidates with the ground read up to four times a piece, as the planner does.
    pub fast_dense_one_thread: f64,
    /// Local candidates, all threads.
    pub fast_all_threads: f64,
    /// Instructions in use.
    pub dispatch: &'static str,
    /// The processor.
    pub cpu: String,
    /// Threads that `fast_all_threads` uses.
    pub threads: usize,
    /// By the paper's objective.
    pub paper: Rates,
}

/// Evaluations per second by one objective, one thread.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Rates {
    /// Local candidates.
    pub fast_one_thread: f64,
    /// Global candidates.
    pub fast_global_one_thread: f64,
    /// Near candidates.
    pub fast_near_one_thread: f64,
    /// Local candidates with two earlier vehicles in the collision term.
    pub fast_traffic_one_thread: f64,
    /// The plain reference.
    pub reference_one_thread: f64,
    /// By each set of instructions.
    pub levels: Vec<Level>,
}

/// One set of instructions.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Level {
    /// Its name.
    pub dispatch: &'static str,
    /// Local candidates.
    pub fast_one_thread: f64,
    /// Global candidates.
    pub fast_global_one_thread: f64,
}

/// Measures each rate for about `seconds`.
///
/// # Errors
/// None with the shipped map.
pub fn speed(seconds: f64) -> Result<Speed, SpecError> {
    use Population::{Local, Near};
    let operational = SpeedCourse::new(Objective::Operational)?;
    let local = operational.batches(Local);
    let fast_all_threads = rate(seconds, || {
        local.par_iter().for_each(|batch| {
            totals(&operational.model, batch);
        });
    });
    Ok(Speed {
        fast_dense_one_thread: fast(&operational.dense(), &operational.batches(Near), seconds),
        fast_all_threads,
        rates: rates(&operational, seconds),
        dispatch: Dispatch::best().name(),
        cpu: cpu(),
        threads: rayon::current_num_threads(),
        paper: rates(&SpeedCourse::new(Objective::Paper)?, seconds),
    })
}

impl Speed {
    /// The rates as a Markdown table.
    #[must_use]
    pub fn table(&self) -> String {
        let Self {
            cpu,
            dispatch,
            threads,
            ..
        } = self;
        let head = format!("{cpu}, {dispatch} | operational, costs a second | paper");
        let mut table = Table::new("", head);
        let mut row = |name: &str, of: fn(&Rates) -> f64| {
            let (operational, paper) = (of(&self.rates), of(&self.paper));
            table.row(format!("{name} | {operational:.0} | {paper:.0}"));
        };
        row("local candidates", |of| of.fast_one_thread);
        row("global candidates", |of| of.fast_global_one_thread);
        row("local, two earlier vehicles", |of| {
            of.fast_traffic_one_thread
        });
        row("local, plain reference", |of| of.reference_one_thread);
        let all = self.fast_all_threads;
        table.row(format!("local, {threads} threads | {all:.0} | "));
        table.markdown()
    }
}

fn rates(course: &SpeedCourse, seconds: f64) -> Rates {
    use Population::{Global, Local, Near};
    let fast = |model: &CostModel, population| fast(model, &course.batches(population), seconds);
    let splines = course.splines(Local);
    let levels = Dispatch::all().into_iter().map(|dispatch| {
        let model = course.model.clone().with_dispatch(dispatch);
        Level {
            dispatch: dispatch.name(),
            fast_one_thread: fast(&model, Local),
            fast_global_one_thread: fast(&model, Global),
        }
    });
    Rates {
        fast_one_thread: fast(&course.model, Local),
        fast_global_one_thread: fast(&course.model, Global),
        fast_near_one_thread: fast(&course.model, Near),
        fast_traffic_one_thread: fast(&course.among_others(), Local),
        reference_one_thread: rate(seconds, || {
            for spline in &splines {
                std::hint::black_box(course.model.terms(&controls(spline)).total());
            }
        }),
        levels: levels.collect(),
    }
}

/// Candidates per second of the fastest of several passes over all of them.
fn rate(seconds: f64, mut pass: impl FnMut()) -> f64 {
    let (mut spent_s, mut best_s) = (0.0, f64::INFINITY);
    while spent_s < seconds {
        #[expect(clippy::disallowed_methods, reason = "wall time is the result")]
        let started = Instant::now();
        pass();
        let took_s = started.elapsed().as_secs_f64();
        spent_s += took_s;
        best_s = took_s.min(best_s);
    }
    as_f64(CANDIDATES) / best_s
}

fn totals(model: &CostModel, batch: &Batch) -> Vec<f64> {
    let mut costs = vec![0.0; batch.len()];
    model.totals(batch, &mut Scratch::default(), &mut costs);
    costs
}

fn fast(model: &CostModel, batches: &[Batch], seconds: f64) -> f64 {
    let mut scratch = Scratch::default();
    let mut costs = [0.0; BATCH];
    rate(seconds, || {
        for batch in batches {
            model.totals(batch, &mut scratch, &mut costs[..batch.len()]);
            std::hint::black_box(&costs);
        }
    })
}

/// Name of the processor by the system.
fn cpu() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(':'))
        .map(|(_, name)| name.trim().to_owned());
    name.unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}

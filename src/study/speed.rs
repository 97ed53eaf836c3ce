//! How many costs a second the objective gives on this machine.
//!
//! The world is the third map of the paper's experiment with a tenth threat, its
//! ground on a grid of 513 nodes a side; the path has 8 free control points and 101
//! samples, at each of which the ground is read once, unless something else is said. Local
//! are uniform steps of a tenth of the map around a path that was found by differential
//! evolution, near ones of a hundredth, global ones are anywhere. Rates are those of the
//! fastest of several passes, because other programs take their share of the others.

use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use super::speed_course::{BATCH, CANDIDATES, Population, SpeedCourse, controls};
use crate::cost::{Batch, CostModel, Dispatch, Scratch};
use crate::spec::{Objective, SpecError};

/// Evaluations per second.
#[derive(Clone, Debug, Serialize)]
pub struct Speed {
    /// Local candidates, one thread.
    pub fast_one_thread: f64,
    /// Global candidates, one thread.
    pub fast_global_one_thread: f64,
    /// Near candidates, one thread.
    pub fast_near_one_thread: f64,
    /// Near candidates with the ground read up to four times a piece, as the planner does.
    pub fast_dense_one_thread: f64,
    /// Local candidates, all threads.
    pub fast_all_threads: f64,
    /// Local candidates with two earlier vehicles in the collision term.
    pub fast_traffic_one_thread: f64,
    /// The plain reference, one thread.
    pub reference_one_thread: f64,
    /// Instructions in use.
    pub dispatch: &'static str,
    /// The processor.
    pub cpu: String,
    /// Threads that `fast_all_threads` uses.
    pub threads: usize,
    /// Local and global candidates by each set of instructions, one thread.
    pub levels: Vec<Level>,
    /// The same by the paper's objective.
    pub paper: Paper,
}

/// One set of instructions.
#[derive(Clone, Debug, Serialize)]
pub struct Level {
    /// Its name.
    pub dispatch: &'static str,
    /// Local candidates.
    pub fast_one_thread: f64,
    /// Global candidates.
    pub fast_global_one_thread: f64,
}

/// The paper's objective.
#[derive(Clone, Debug, Serialize)]
pub struct Paper {
    /// Local candidates, one thread.
    pub fast_one_thread: f64,
    /// Global candidates, one thread.
    pub fast_global_one_thread: f64,
    /// Near candidates, one thread.
    pub fast_near_one_thread: f64,
    /// Local candidates with two earlier vehicles in the collision term.
    pub fast_traffic_one_thread: f64,
    /// The plain reference, one thread.
    pub reference_one_thread: f64,
    /// Local and global candidates by each set of instructions.
    pub levels: Vec<Level>,
}

/// Measures, each rate for about `seconds`.
///
/// # Errors
/// None with the map that comes with the program.
pub fn speed(seconds: f64) -> Result<Speed, SpecError> {
    use Population::{Global, Local, Near};
    let operational = SpeedCourse::new(Objective::Operational)?;
    let paper = SpeedCourse::new(Objective::Paper)?;
    let rate = |course: &SpeedCourse, population: Population| {
        fast(&course.model, &course.batches(population), seconds)
    };
    let local = operational.batches(Local);
    let threads = rayon::current_num_threads();
    let mut fastest = Meter::new(seconds);
    while fastest.goes_on() {
        fastest.pass(|| {
            local.par_iter().for_each(|batch| {
                totals(&operational.model, batch);
            });
        });
    }
    let fast_all_threads = fastest.rate();
    Ok(Speed {
        fast_one_thread: rate(&operational, Local),
        fast_global_one_thread: rate(&operational, Global),
        fast_near_one_thread: rate(&operational, Near),
        fast_dense_one_thread: fast(&operational.dense(), &operational.batches(Near), seconds),
        fast_all_threads,
        fast_traffic_one_thread: fast(&operational.among_others(), &local, seconds),
        reference_one_thread: plain(&operational, seconds),
        dispatch: Dispatch::best().name(),
        cpu: cpu(),
        threads,
        levels: levels(&operational, seconds),
        paper: Paper {
            fast_one_thread: rate(&paper, Local),
            fast_global_one_thread: rate(&paper, Global),
            fast_near_one_thread: rate(&paper, Near),
            fast_traffic_one_thread: fast(&paper.among_others(), &paper.batches(Local), seconds),
            reference_one_thread: plain(&paper, seconds),
            levels: levels(&paper, seconds),
        },
    })
}

fn levels(course: &SpeedCourse, seconds: f64) -> Vec<Level> {
    let rate = |model: &CostModel, population| fast(model, &course.batches(population), seconds);
    Dispatch::all()
        .into_iter()
        .map(|dispatch| {
            let model = course.model.clone().with_dispatch(dispatch);
            Level {
                dispatch: dispatch.name(),
                fast_one_thread: rate(&model, Population::Local),
                fast_global_one_thread: rate(&model, Population::Global),
            }
        })
        .collect()
}

/// Passes over all candidates against the clock.
struct Meter {
    until_s: f64,
    spent_s: f64,
    best_s: f64,
}

impl Meter {
    fn new(seconds: f64) -> Self {
        Self {
            until_s: seconds,
            spent_s: 0.0,
            best_s: f64::INFINITY,
        }
    }

    fn goes_on(&self) -> bool {
        self.spent_s < self.until_s
    }

    fn pass(&mut self, act: impl FnOnce()) {
        #[expect(
            clippy::disallowed_methods,
            reason = "wall times are what is asked for"
        )]
        let started = Instant::now();
        act();
        let took_s = started.elapsed().as_secs_f64();
        self.spent_s += took_s;
        self.best_s = self.best_s.min(took_s);
    }

    fn rate(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a thousand")]
        let candidates = CANDIDATES as f64;
        candidates / self.best_s
    }
}

fn totals(model: &CostModel, batch: &Batch) -> [f64; BATCH] {
    let mut costs = [0.0; BATCH];
    let costs_of = &mut costs[..batch.len()];
    model.totals(batch, &mut Scratch::default(), costs_of);
    costs
}

fn fast(model: &CostModel, batches: &[Batch], seconds: f64) -> f64 {
    let mut scratch = Scratch::default();
    let mut costs = [0.0; BATCH];
    let mut meter = Meter::new(seconds);
    while meter.goes_on() {
        meter.pass(|| {
            for batch in batches {
                model.totals(batch, &mut scratch, &mut costs[..batch.len()]);
                std::hint::black_box(&costs);
            }
        });
    }
    meter.rate()
}

/// The plain reference.
fn plain(course: &SpeedCourse, seconds: f64) -> f64 {
    let splines = course.splines(Population::Local);
    let mut meter = Meter::new(seconds);
    while meter.goes_on() {
        meter.pass(|| {
            for spline in &splines {
                std::hint::black_box(course.model.terms(&controls(spline)).total());
            }
        });
    }
    meter.rate()
}

/// What the system calls the processor.
fn cpu() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(':'))
        .map(|(_, name)| name.trim().to_owned());
    name.unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}

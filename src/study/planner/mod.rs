//! The default planner against the best known plans: many seeds on many missions, with and
//! without its parts.

mod best;
mod missions;
mod table;

use serde::{Deserialize, Serialize};

use super::paper::{ConfigError, sha256};
use super::store::Study;
use super::workers::{Done, run_all};
use crate::plan::{Request, SearchOptions, plan_fleet_with};

pub use best::{BestKnown, Known};
pub use missions::{Arena, MissionText};
pub use table::{planner_json, planner_md};

/// A study of the planner; with its variants it is the file `study.json`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannerStudy {
    /// Version of the program.
    pub version: String,
    /// Runs of each variant on each mission with each budget.
    pub seeds: usize,
    /// Seed of the first run; each later run has the next.
    pub seed: u64,
    /// Evaluations for each vehicle, in the order of the tables.
    pub evaluations: Vec<usize>,
    /// Whether the planner also runs without its parts.
    pub ablations: bool,
    /// The missions.
    pub missions: Vec<MissionText>,
}

/// One run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlannerJob {
    /// Index of the variant.
    pub variant: usize,
    /// Index of the mission.
    pub mission: usize,
    /// Evaluations for each vehicle.
    pub evaluations: usize,
    /// Its seed.
    pub seed: u64,
}

/// Result of one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannerRun {
    /// Hash of the study.
    pub config: String,
    /// Name in [`variants`].
    pub variant: String,
    /// Name of the mission.
    pub mission: String,
    /// Evaluations allowed for each vehicle.
    pub evaluations: usize,
    /// Its seed.
    pub seed: u64,
    /// Sum of the vehicles' costs, judged at 2001 samples.
    pub total: f64,
    /// Whether every vehicle keeps every limit there.
    pub clean: bool,
    /// Cost of each vehicle.
    pub vehicles: Vec<f64>,
    /// Evaluations spent for each vehicle.
    pub spent: Vec<usize>,
}

/// The planner, and if `ablations` the planner without one part at a time.
#[must_use]
pub fn variants(ablations: bool) -> Vec<(&'static str, SearchOptions)> {
    let all = SearchOptions::default();
    let mut variants = vec![("planner", all)];
    let mut add = |name, change: fn(&mut SearchOptions)| {
        let mut options = all;
        change(&mut options);
        variants.push((name, options));
    };
    if ablations {
        add("no route classes", |of| of.classes = false);
        add("one cost field", |of| of.slope_factors = &[1.0]);
        add("no warps", |of| of.warps = 0);
        add("no tightening", |of| of.tightening = false);
        add("no detours", |of| of.detours = false);
        add("no racing", |of| of.racing = false);
        add("no offspring", |of| of.offspring = false);
        add("no restarts", |of| of.restarts = false);
        add("no redrawing", |of| of.redrawing = false);
        add("no other valleys", |of| of.valleys = false);
        add("no polishing", |of| of.polishing = false);
        add("no windows", |of| of.windows = false);
        add("penalties of the judge", |of| of.penalty = None);
        add("no relaxed problem", |of| of.relaxed_share = 1.0);
    }
    variants
}

impl PlannerStudy {
    /// The missions, loaded.
    ///
    /// # Errors
    /// An invalid mission, two missions of one name.
    pub fn arenas(&self) -> Result<Vec<Arena>, ConfigError> {
        for (index, mission) in self.missions.iter().enumerate() {
            let earlier = &self.missions[..index];
            if earlier.iter().any(|other| other.name == mission.name) {
                return Err(ConfigError::SameName(mission.name.clone()));
            }
        }
        self.missions
            .iter()
            .map(|mission| Ok(mission.arena()?))
            .collect()
    }

    /// All runs, in the order of the results.
    #[must_use]
    pub fn jobs(&self) -> Vec<PlannerJob> {
        let mut jobs = Vec::new();
        for variant in 0..variants(self.ablations).len() {
            for &evaluations in &self.evaluations {
                for mission in 0..self.missions.len() {
                    jobs.extend((self.seed..).take(self.seeds).map(|seed| PlannerJob {
                        variant,
                        mission,
                        evaluations,
                        seed,
                    }));
                }
            }
        }
        jobs
    }
}

impl Study for PlannerStudy {
    type Run = PlannerRun;

    fn hash(&self) -> String {
        sha256(&(self, self.choices()))
    }

    fn choices(&self) -> Vec<String> {
        variants(self.ablations)
            .iter()
            .map(|(name, options)| format!("{name}: {options:?}"))
            .collect()
    }

    fn names(&self) -> Vec<String> {
        let variants = variants(self.ablations);
        self.jobs()
            .into_iter()
            .map(|job| {
                let mission = &self.missions[job.mission].name;
                name(variants[job.variant].0, mission, job.evaluations, job.seed)
            })
            .collect()
    }

    fn name(run: &PlannerRun) -> String {
        name(&run.variant, &run.mission, run.evaluations, run.seed)
    }

    fn hash_of(run: &PlannerRun) -> &str {
        &run.config
    }
}

fn name(variant: &str, mission: &str, evaluations: usize, seed: u64) -> String {
    format!("{variant} on {mission}, {evaluations} evaluations, seed {seed}")
}

/// Makes runs, each on one thread. `done` takes each run and its wall time in seconds, in any
/// order; no run starts after it has returned false.
pub fn run_planner(
    study: &PlannerStudy,
    arenas: &[Arena],
    jobs: &[PlannerJob],
    done: Done<'_, PlannerRun>,
) {
    let (variants, config) = (variants(study.ablations), study.hash());
    let make = |job: &PlannerJob| {
        let (name, options) = variants[job.variant];
        let mut spec = arenas[job.mission].spec.clone();
        spec.planner.evaluations = job.evaluations;
        let request = Request::new(job.seed);
        let plan = plan_fleet_with(&spec, &arenas[job.mission].world, &request, options);
        let vehicles: Vec<f64> = plan.vehicles.iter().map(|of| of.terms.total()).collect();
        PlannerRun {
            config: config.clone(),
            variant: name.to_owned(),
            mission: study.missions[job.mission].name.clone(),
            evaluations: job.evaluations,
            seed: job.seed,
            total: vehicles.iter().sum(),
            clean: plan.vehicles.iter().all(|of| of.terms.is_clean()),
            vehicles,
            spent: plan.vehicles.iter().map(|of| of.evaluations).collect(),
        }
    };
    run_all(jobs, &make, done);
}

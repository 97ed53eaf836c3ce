//! How near the default planner comes to the best paths known: many seeds on many
//! missions, with and without its parts.

mod best;
mod table;

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::config::{ConfigError, sha256};
use super::runner::spread;
use super::scenario::{MOST_DIFFICULT, scenario};
use super::setting::Setting;
use super::store::Study;
use crate::cost::PaperOptions;
use crate::plan::{Request, SearchOptions, plan_fleet_with};
use crate::spec::{Document, Finish, MissionSpec, Objective, Scenario, SpecError};
use crate::world::{self, World};

pub use best::{BestKnown, Known};
pub use table::{planner_json, planner_md};

/// A study of the planner; with the parts that are left out it is the file `study.json`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannerStudy {
    /// Version of the program.
    pub version: String,
    /// Runs of each kind on each mission.
    pub seeds: usize,
    /// Seed of the first run; each later run has the next.
    pub seed: u64,
    /// Evaluations for each vehicle, in the order of the tables.
    pub evaluations: Vec<usize>,
    /// Whether the planner without its parts takes part.
    pub ablations: bool,
    /// The missions.
    pub missions: Vec<MissionText>,
}

/// A mission as it was given.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MissionText {
    /// Its name.
    pub name: String,
    /// Its path, where the terrain that it names is looked for too.
    pub file: String,
    /// The spec, or a scenario of the paper's kind, YAML.
    pub text: String,
    /// How many vehicles it has.
    pub vehicles: usize,
}

/// One run to be made.
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

/// What one run left.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannerRun {
    /// Hash of the study.
    pub config: String,
    /// Which planner, [`variants`].
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
    /// Evaluations that each vehicle took.
    pub spent: Vec<usize>,
}

/// A mission, ready to be planned.
#[derive(Clone, Debug)]
pub struct Arena {
    /// What is planned.
    pub spec: MissionSpec,
    /// Where.
    pub world: World,
}

/// The planner as it is, and without one part at a time if `ablations`.
#[must_use]
pub fn variants(ablations: bool) -> Vec<(&'static str, SearchOptions)> {
    let all = SearchOptions::default();
    let mut variants = vec![("planner", all)];
    if ablations {
        variants.extend([
            (
                "no route classes",
                SearchOptions {
                    classes: false,
                    ..all
                },
            ),
            (
                "one cost field",
                SearchOptions {
                    slope_factors: &[1.0],
                    ..all
                },
            ),
            ("no warps", SearchOptions { warps: 0, ..all }),
            (
                "no tightening",
                SearchOptions {
                    tightening: false,
                    ..all
                },
            ),
            (
                "no detours",
                SearchOptions {
                    detours: false,
                    ..all
                },
            ),
            (
                "no racing",
                SearchOptions {
                    racing: false,
                    ..all
                },
            ),
            (
                "no offspring",
                SearchOptions {
                    offspring: false,
                    ..all
                },
            ),
            (
                "no restarts",
                SearchOptions {
                    restarts: false,
                    ..all
                },
            ),
            (
                "no redrawing",
                SearchOptions {
                    redrawing: false,
                    ..all
                },
            ),
            (
                "no windows",
                SearchOptions {
                    windows: false,
                    ..all
                },
            ),
            (
                "penalties of the judge",
                SearchOptions {
                    penalty: None,
                    ..all
                },
            ),
            (
                "no relaxed problem",
                SearchOptions {
                    relaxed_share: 1.0,
                    ..all
                },
            ),
        ]);
    }
    variants
}

impl MissionText {
    /// A mission, or a scenario of the paper's kind, that was read from `path`.
    ///
    /// # Errors
    /// A text that is no good spec.
    pub fn parse(path: &Path, text: String) -> Result<Self, SpecError> {
        let (name, vehicles) = match Document::parse(path, text.clone())? {
            Document::Mission(file) => (file.spec.name, file.spec.vehicles.len()),
            Document::Scenario(scenario) => (scenario.name, scenario.vehicles.len()),
        };
        Ok(Self {
            name,
            file: path.display().to_string(),
            text,
            vehicles,
        })
    }

    /// The generated mission of a seed; difficulties take turns from 1 to the greatest.
    ///
    /// # Errors
    /// None, unless the generator writes what is no good spec.
    pub fn generated(seed: u64) -> Result<Self, SpecError> {
        let difficulty = 1 + seed.wrapping_sub(1) % u64::from(MOST_DIFFICULT);
        let difficulty = u8::try_from(difficulty).unwrap_or(MOST_DIFFICULT);
        let file = format!("scenario-{seed}-{difficulty}.yaml");
        Self::parse(Path::new(&file), scenario(seed, difficulty))
    }

    /// The paper's three maps with eight free control points.
    ///
    /// # Errors
    /// None, unless one of them is broken.
    pub fn paper() -> Result<Vec<Self>, SpecError> {
        [
            ("s1-8.yaml", include_str!("../../missions/paper/s1-8.yaml")),
            ("s2-8.yaml", include_str!("../../missions/paper/s2-8.yaml")),
            ("s3-8.yaml", include_str!("../../missions/paper/s3-8.yaml")),
        ]
        .into_iter()
        .map(|(file, text)| Self::parse(Path::new(file), text.to_owned()))
        .collect()
    }

    /// Loads it; the operational objective is searched, whatever it says.
    fn arena(&self) -> Result<Arena, SpecError> {
        match Document::parse(Path::new(&self.file), self.text.clone())? {
            Document::Mission(file) => {
                let world = world::load(&file)?;
                let mut spec = file.spec;
                spec.planner.objective = Objective::Operational;
                Ok(Arena { spec, world })
            }
            Document::Scenario(scenario) => Ok(Arena::of(*scenario)),
        }
    }
}

impl Arena {
    /// A scenario of the paper's kind under the operational objective.
    #[must_use]
    pub fn of(scenario: Scenario) -> Self {
        let setting = Setting::new(scenario, PaperOptions::default());
        let (mut spec, mut world) = (setting.spec, setting.world);
        // The objective reads the ground from a grid, which may lie a little above
        // the surface that starts and goals stand on.
        for stations in &mut world.stations {
            for end in [&mut stations.start, &mut stations.goal] {
                let least_m = world.ground.height_m(end.at) + world.min_agl.0 + 1e-3;
                end.amsl.0 = end.amsl.0.max(least_m);
            }
        }
        // All have one goal: who is there must be gone when the next arrives.
        for vehicle in &mut spec.vehicles {
            vehicle.finish = Finish::Land;
        }
        spec.planner.objective = Objective::Operational;
        Self { spec, world }
    }
}

impl PlannerStudy {
    /// The missions, loaded.
    ///
    /// # Errors
    /// Broken missions, two of one name, and numbers that make no study.
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

/// Makes runs, one on each thread, and hands each to `done` with the seconds it took, in
/// no certain order, until that says false.
pub fn run_planner(
    study: &PlannerStudy,
    arenas: &[Arena],
    jobs: &[PlannerJob],
    done: &(dyn Fn(PlannerRun, f64) -> bool + Sync),
) {
    let (variants, hash) = (variants(study.ablations), study.hash());
    let make = |job: &PlannerJob| {
        let (name, options) = variants[job.variant];
        let mut run = one(&arenas[job.mission], options, job);
        run.config.clone_from(&hash);
        name.clone_into(&mut run.variant);
        run.mission.clone_from(&study.missions[job.mission].name);
        run
    };
    spread(jobs, &make, done);
}

/// One run.
fn one(arena: &Arena, options: SearchOptions, job: &PlannerJob) -> PlannerRun {
    let mut spec = arena.spec.clone();
    spec.planner.evaluations = job.evaluations;
    let request = Request {
        seed: job.seed,
        margins: Vec::new(),
        extra_parameters: Vec::new(),
        progress: &|_| (),
    };
    let plan = plan_fleet_with(&spec, &arena.world, &request, options);
    let vehicles: Vec<f64> = plan.vehicles.iter().map(|of| of.terms.total()).collect();
    PlannerRun {
        config: String::new(),
        variant: String::new(),
        mission: String::new(),
        evaluations: job.evaluations,
        seed: job.seed,
        total: vehicles.iter().sum(),
        clean: plan.vehicles.iter().all(|of| of.terms.is_clean()),
        vehicles,
        spent: plan.vehicles.iter().map(|of| of.evaluations).collect(),
    }
}

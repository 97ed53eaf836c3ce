//! The missions of a study of the planner.

use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::cost::PaperOptions;
use crate::spec::{Buffers, Document, Finish, MissionSpec, Objective, Scenario, SpecError};
use crate::study::family::Family;
use crate::study::paper::{ConfigError, MAPS_8, read_text, unreadable};
use crate::study::scenario::{MAX_DIFFICULTY, scenario};
use crate::study::setting::Setting;
use crate::world::{self, World};

/// A mission as given.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MissionText {
    /// Its name.
    pub name: String,
    /// Its path, also the base of its terrain path.
    pub file: String,
    /// The spec, or a scenario of the paper's kind, YAML.
    pub text: String,
    /// Number of vehicles.
    pub vehicles: usize,
}

/// A loaded mission.
#[derive(Clone, Debug)]
pub struct Arena {
    /// The spec.
    pub spec: MissionSpec,
    /// The world.
    pub world: World,
}

impl MissionText {
    /// A mission or a scenario of the paper's kind, read from `path`.
    ///
    /// # Errors
    /// An invalid spec.
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

    /// The generated mission of a seed; difficulties take turns from 1 to the highest.
    ///
    /// # Errors
    /// None while the generator writes valid specs.
    pub fn generated(seed: u64) -> Result<Self, SpecError> {
        let difficulty = 1 + seed.wrapping_sub(1) % u64::from(MAX_DIFFICULTY);
        let difficulty = u8::try_from(difficulty).unwrap_or(MAX_DIFFICULTY);
        let file = format!("scenario-{seed}-{difficulty}.yaml");
        Self::parse(Path::new(&file), scenario(seed, difficulty))
    }

    /// The problem of a family and a seed.
    ///
    /// # Errors
    /// None while the generator writes valid specs.
    pub fn of_family(family: Family, seed: u64) -> Result<Self, SpecError> {
        let file = format!("{}-{seed}.yaml", family.name());
        Self::parse(Path::new(&file), family.problem(seed))
    }

    /// The paper's three maps with eight free control points.
    ///
    /// # Errors
    /// None with the shipped maps.
    pub fn paper() -> Result<Vec<Self>, SpecError> {
        let maps = MAPS_8.into_iter();
        maps.map(|(file, text)| Self::parse(Path::new(file), text.to_owned()))
            .collect()
    }

    /// The missions of a folder in the order of their names, except large fleets, which belong
    /// to `study fleet`.
    ///
    /// # Errors
    /// A folder or mission that cannot be read, an invalid mission.
    pub fn shipped(folder: &Path) -> Result<Vec<Self>, ConfigError> {
        const LARGE: usize = 10;
        let files = fs::read_dir(folder).map_err(unreadable(folder))?;
        let mut paths: Vec<PathBuf> = Vec::new();
        for file in files {
            let path = file.map_err(unreadable(folder))?.path();
            if path.extension().is_some_and(|end| end == "yaml") {
                paths.push(path);
            }
        }
        paths.sort();
        let mut all = Self::read(&paths)?;
        all.retain(|mission| mission.vehicles <= LARGE);
        Ok(all)
    }

    /// The missions of some files.
    ///
    /// # Errors
    /// A file that cannot be read, an invalid mission.
    pub fn read(paths: &[PathBuf]) -> Result<Vec<Self>, ConfigError> {
        let paths = paths.iter();
        paths
            .map(|path| Ok(Self::parse(path, read_text(path)?)?))
            .collect()
    }

    /// Loads the mission with the operational objective and without buffers, as the best known
    /// totals are.
    ///
    /// # Errors
    /// Broken terrain.
    pub(super) fn arena(&self) -> Result<Arena, SpecError> {
        match Document::parse(Path::new(&self.file), self.text.clone())? {
            Document::Mission(mut file) => {
                file.spec.buffers = Buffers::NONE;
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
        // The objective reads the ground from a grid, which may lie a little above the surface
        // under starts and goals.
        for sites in &mut world.sites {
            for end in [&mut sites.start, &mut sites.goal] {
                let min_m = world.ground.height_m(end.at) + world.min_agl.0 + 1e-3;
                end.amsl.0 = end.amsl.0.max(min_m);
            }
        }
        // All vehicles have one goal and must land before the next arrives.
        for vehicle in &mut spec.vehicles {
            vehicle.finish = Finish::Land;
        }
        spec.planner.objective = Objective::Operational;
        Self { spec, world }
    }
}

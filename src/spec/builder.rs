//! A mission made in code.

use std::path::Path;

use super::keys;
use super::positions::Positions;
use super::{Incomplete, MissionSpec, SpecError, SpecFile};

/// Makes a [`MissionSpec`] from [`keys`], with the checks and the issues that a file has.
///
/// ```
/// use sortie::spec::{Autopilot, Finish, MissionSpec, keys};
///
/// let (south_west, north_east) = (keys::Place::new(36.2, -84.4), keys::Place::new(36.4, -84.1));
/// let area = keys::Area::new(south_west, north_east, 60.0, 1500.0);
/// let copter = keys::Vehicle {
///     id: Some("alpha".to_owned()),
///     sysid: Some(1),
///     autopilot: Some(Autopilot::ArduPilot),
///     link: Some("sim".to_owned()),
///     start: Some(keys::EndPoint::above_ground(36.25, -84.35, 80.0).into()),
///     goal: Some(keys::EndPoint::above_ground(36.35, -84.15, 80.0).into()),
///     finish: Some(Finish::Land),
///     speed_mps: Some(15.0),
///     ..keys::Vehicle::default()
/// };
/// let mission = MissionSpec::builder("survey", area, keys::Terrain::flat(300.0));
/// let spec = mission.clone().vehicle(copter.clone()).build()?;
/// assert_eq!(spec.vehicles[0].id, "alpha");
///
/// let fast = keys::Vehicle { speed_mps: Some(1500.0), ..copter };
/// let error = mission.vehicle(fast).build().unwrap_err();
/// assert_eq!(error.to_string(), "survey: vehicles[0].speed_mps: 1500 (allowed: 0.5 to 100)");
/// # Ok::<(), sortie::spec::SpecError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Builder {
    keys: keys::Spec,
}

impl MissionSpec {
    /// A mission of version 1, without buffers and vehicles; every other key as where a file has
    /// none. [`crate::Mission::builder`] begins one of version 2.
    #[must_use]
    pub fn builder(name: &str, area: keys::Area, terrain: keys::Terrain) -> Builder {
        let keys = keys::Spec {
            sortie: 1,
            name: name.to_owned(),
            origin: None,
            area,
            terrain,
            threats: Vec::new(),
            no_fly: Vec::new(),
            zones: Vec::new(),
            airspace: Vec::new(),
            obstacles: Vec::new(),
            qnh_hpa: None,
            t0: None,
            rally: Vec::new(),
            vehicles: Vec::new(),
            fleet: None,
            tasks: Vec::new(),
            separation: super::Separation::default(),
            buffer_m: None,
            planner: keys::Planner::default(),
            mission: keys::MissionOptions::default(),
            wind: None,
            on_link_loss: super::OnLinkLoss::default(),
            on_alarm: super::OnAlarm::default(),
        };
        Builder { keys }
    }
}

impl From<keys::Spec> for Builder {
    fn from(keys: keys::Spec) -> Self {
        Self { keys }
    }
}

impl Builder {
    /// Adds a vehicle, behind the others in priority.
    #[must_use]
    pub fn vehicle(mut self, vehicle: keys::Vehicle) -> Self {
        self.keys.vehicles.push(vehicle);
        self
    }

    /// Changes any key.
    #[must_use]
    pub fn with(mut self, change: impl FnOnce(&mut keys::Spec)) -> Self {
        change(&mut self.keys);
        self
    }

    /// The name of the mission.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.keys.name
    }

    /// Checks the mission, as far as that needs no ground.
    ///
    /// # Errors
    /// Every problem, by its path.
    pub fn build(self) -> Result<MissionSpec, SpecError> {
        let name = self.keys.name.clone();
        self.file(Path::new(&name)).map(|file| file.spec)
    }

    /// Checks the mission as a file that would be at `path`. Its elevation and table are in that
    /// folder.
    ///
    /// # Errors
    /// Every problem, by its path.
    pub fn file(self, path: &Path) -> Result<SpecFile, SpecError> {
        Ok(self.file_known(path)?)
    }

    /// [`Self::file`], with what is known of the mission in spite of its problems.
    ///
    /// # Errors
    /// As for [`Self::file`].
    pub fn file_known(self, path: &Path) -> Result<SpecFile, Box<Incomplete>> {
        SpecFile::check(path, self.yaml(), self.keys.into(), Positions::default())
    }

    /// The mission as a file has it, without absent keys.
    #[must_use]
    pub fn yaml(&self) -> String {
        let value = serde_yaml::to_value(&self.keys).map(without_null);
        value
            .and_then(|value| serde_yaml::to_string(&value))
            .unwrap_or_default()
    }
}

fn without_null(value: serde_yaml::Value) -> serde_yaml::Value {
    use serde_yaml::Value;
    match value {
        Value::Mapping(keys) => keys
            .into_iter()
            .filter(|(_, value)| !value.is_null())
            .map(|(key, value)| (key, without_null(value)))
            .collect::<serde_yaml::Mapping>()
            .into(),
        Value::Sequence(values) => values.into_iter().map(without_null).collect(),
        value => value,
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::keys;
    use crate::spec::{MissionSpec, SpecFile};

    #[test]
    fn the_yaml_of_a_mission_reads_as_the_same_mission() {
        let text = include_str!("../../missions/jacksboro.yaml");
        let parsed = SpecFile::parse(Path::new("a.yaml"), text.to_owned()).expect("good");
        let keys: keys::Spec = serde_yaml::from_str(text).expect("good");
        let builder = MissionSpec::builder("", keys.area, keys::Terrain::default());
        let builder = builder.with(|own| *own = keys);
        let again = SpecFile::parse(Path::new("b.yaml"), builder.yaml()).expect("good");
        assert_eq!(again.spec, parsed.spec);
        assert_eq!(builder.build().expect("good"), parsed.spec);
    }

    #[test]
    fn a_mission_in_code_has_the_issues_of_a_file() {
        let text = include_str!("../../missions/jacksboro.yaml");
        let keys: keys::Spec = serde_yaml::from_str(text).expect("good");
        let broken = MissionSpec::builder("x", keys.area, keys.terrain.clone()).with(|own| {
            *own = keys;
            own.vehicles[0].goal = None;
            own.vehicles[1].sysid = own.vehicles[0].sysid;
            own.planner.samples = 3;
        });
        let error = broken.build().expect_err("three problems");
        let paths: Vec<&str> = error
            .issues
            .iter()
            .map(|issue| issue.path.as_str())
            .collect();
        assert_eq!(
            paths,
            ["planner.samples", "vehicles[1].sysid", "vehicles[0].goal"]
        );
    }
}

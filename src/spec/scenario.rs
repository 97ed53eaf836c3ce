//! A scenario of the study: Cartesian, for experiments on paper and never for flight.

use std::path::Path;

use super::check;
use super::file::{self, SpecFile};
use super::keys;
use super::positions::Positions;
use super::{Incomplete, Planner, SpecError};
use crate::geodesy::{Agl, Amsl, EastNorth, PlanPoint};

/// A spec with `frame: local`, checked: a flat world whose "up" is altitude.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Its name.
    pub name: String,
    /// South-west corner of the map.
    pub south_west: EastNorth,
    /// North-east corner of the map.
    pub north_east: EastNorth,
    /// Minimum height above ground, h_min.
    pub min_agl: Agl,
    /// Ceiling.
    pub max_amsl: Amsl,
    /// The ground.
    pub surface: Surface,
    /// Vertical cylinders of infinite height.
    pub threats: Vec<Cylinder>,
    /// The vehicles, in order of priority.
    pub vehicles: Vec<Mover>,
    /// The objective and its sampling; the study brings algorithms and budgets.
    pub planner: Planner,
}

/// Analytic ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Rolling ground, if any.
    pub waves: Option<Waves>,
    /// Peaks that are added to it.
    pub peaks: Vec<Peak>,
}

/// `height max(0, q)`, with x, y and r = sqrt(x^2 + y^2) in km and
/// `q = sin(0.3 y + a) + b sin(0.3 x) + c cos(d r) + e cos(0.3 y) + f sin(0.5 f r) + g cos(0.3 y)`,
/// the shape of Nikolos et al. 2003.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waves {
    /// Factor on q, metres.
    pub height_m: f64,
    /// a to g.
    pub shape: [f64; 7],
}

/// `height exp(-(east / width)^2 - (north / width)^2)` around its summit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Summit.
    pub at: EastNorth,
    /// Height, metres.
    pub height_m: f64,
    /// Distance east and north at which the height has fallen to 1/e, metres.
    pub width_m: [f64; 2],
}

/// A threat.
#[derive(Clone, Debug, PartialEq)]
pub struct Cylinder {
    /// Unique name.
    pub id: String,
    /// A label such as `radar`.
    pub kind: String,
    /// Axis.
    pub center: EastNorth,
    /// Radius, metres.
    pub radius_m: f64,
}

/// A vehicle.
#[derive(Clone, Debug, PartialEq)]
pub struct Mover {
    /// Unique name.
    pub id: String,
    /// Where its path begins.
    pub start: PlanPoint,
    /// Where its path ends.
    pub goal: PlanPoint,
    /// Speed, m/s.
    pub speed_mps: f64,
    /// Turn overload n_max; climb and descent follow Eq. 27.
    pub max_load_factor: f64,
}

impl Surface {
    /// Height of the ground above the sea, metres.
    #[must_use]
    pub fn height_m(&self, at: EastNorth) -> f64 {
        let waves = self.waves.map_or(0.0, |waves| waves.height_m(at));
        let peaks = self.peaks.iter().map(|peak| {
            let east = (at.east_m - peak.at.east_m) / peak.width_m[0];
            let north = (at.north_m - peak.at.north_m) / peak.width_m[1];
            peak.height_m * (-east * east - north * north).exp()
        });
        waves + peaks.sum::<f64>()
    }
}

impl Waves {
    fn height_m(&self, at: EastNorth) -> f64 {
        let [a, b, c, d, e, f, g] = self.shape;
        let (x, y) = (at.east_m * 1e-3, at.north_m * 1e-3);
        let r = x.hypot(y);
        let q = (0.3 * y + a).sin()
            + b * (0.3 * x).sin()
            + c * (d * r).cos()
            + e * (0.3 * y).cos()
            + f * (0.5 * f * r).sin()
            + g * (0.3 * y).cos();
        self.height_m * q.max(0.0)
    }
}

impl Scenario {
    /// Checks a scenario in memory; `path` is where it would be.
    ///
    /// # Errors
    /// The first structural problem, or else every semantic one, in file order.
    pub fn parse(path: &Path, text: &str) -> Result<Self, SpecError> {
        let error = |issues| SpecError {
            file: path.display().to_string(),
            issues,
        };
        let yaml = text.strip_prefix('\u{feff}').unwrap_or(text);
        let positions = Positions::read(yaml).map_err(|issue| error(vec![issue]))?;
        let keys: keys::Scenario = serde_yaml::from_str(yaml).map_err(|problem| {
            let schema = schemars::schema_for!(keys::Scenario).to_value();
            error(vec![file::structure::problem(&problem, &schema)])
        })?;
        check::scenario(&keys, positions).map_err(error)
    }

    /// Reads and checks a scenario.
    ///
    /// # Errors
    /// A file that cannot be read or is not text, and all that [`Self::parse`] finds.
    pub fn read(path: &Path) -> Result<Self, SpecError> {
        Self::parse(path, &file::read_text(path)?)
    }
}

/// Either kind of spec.
#[derive(Clone, Debug)]
pub enum Document {
    /// A mission to be flown.
    Mission(Box<SpecFile>),
    /// A scenario of the study.
    Scenario(Box<Scenario>),
}

impl Document {
    /// Reads a spec of either kind: a scenario has the key `frame`.
    ///
    /// # Errors
    /// As [`SpecFile::read`] and [`Scenario::read`].
    pub fn read(path: &Path) -> Result<Self, SpecError> {
        Self::parse(path, file::read_text(path)?)
    }

    /// Checks a spec of either kind that is already in memory; `path` is where it would be.
    ///
    /// # Errors
    /// As [`SpecFile::parse`] and [`Scenario::parse`].
    pub fn parse(path: &Path, text: String) -> Result<Self, SpecError> {
        Ok(Self::parse_known(path, text)?)
    }

    /// [`Self::read`], with what is known of a mission in spite of its problems.
    ///
    /// # Errors
    /// As for [`Self::read`].
    pub fn read_known(path: &Path) -> Result<Self, Box<Incomplete>> {
        Self::parse_known(path, file::read_text(path).map_err(file::nothing_known)?)
    }

    fn parse_known(path: &Path, text: String) -> Result<Self, Box<Incomplete>> {
        let yaml = text.strip_prefix('\u{feff}').unwrap_or(&text);
        if Positions::read(yaml).is_ok_and(|positions| positions.has("frame")) {
            let scenario = Scenario::parse(path, &text).map_err(file::nothing_known)?;
            Ok(Self::Scenario(Box::new(scenario)))
        } else {
            SpecFile::parse_known(path, text).map(|file| Self::Mission(Box::new(file)))
        }
    }
}

//! Autopilot parameters that Sortie writes, assumes or simulates: names, defaults, units.
//!
//! Names and defaults as in ArduCopter and ArduPlane 4.6 and PX4 1.16 to 1.18. A parameter that a
//! version renamed has a row for each name.

mod ardupilot;
mod fence;
mod judged;
mod landing;
mod px4;
mod renamed;

use super::version::VersionRange;
pub(super) use ardupilot::{ARDUCOPTER, ARDUPLANE, QUADPLANE};
pub use ardupilot::{COPTER_LEAN, SLOPE_MIN};
pub use fence::ParamFence;
pub(super) use fence::{ARDUCOPTER_FENCE, ARDUPLANE_FENCE, PX4_FENCE};
pub use judged::Judged;
pub(super) use judged::{
    COPTER_JUDGED, COPTER_RETURNS, PLANE_JUDGED, PLANE_RETURNS, PX4_JUDGED, PX4_RETURNS,
    QUADPLANE_JUDGED, WING_JUDGED,
};
pub use landing::LandingParameters;
pub(super) use landing::{ARDUCOPTER_LANDING, PX4_LANDING, QUADPLANE_LANDING};
pub use px4::PX4_LEAN;
pub(super) use px4::{PX4_COPTER, PX4_ROTORS, PX4_VTOL, PX4_WING};
pub use renamed::{in_unit_of, name_in, other_name};

/// The row of a parameter, of whichever autopilot.
#[must_use]
pub fn parameter(name: &str) -> Option<&'static ParameterRow> {
    let tables = [
        ARDUCOPTER, ARDUPLANE, QUADPLANE, PX4_ROTORS, PX4_WING, PX4_VTOL, PX4_COPTER,
    ];
    tables.into_iter().flatten().find(|row| row.name == name)
}

/// One parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterRow {
    /// Name in the autopilot.
    pub name: &'static str,
    /// The value that a vehicle comes with, in `unit`.
    pub default: f32,
    /// Unit of its values.
    pub unit: Unit,
    /// Whether PX4 stores it as `int32`.
    pub is_int32: bool,
    /// The versions that have it.
    pub versions: VersionRange,
}

impl ParameterRow {
    /// The default in SI units; degrees stay degrees.
    #[must_use]
    pub fn default_si(&self) -> f64 {
        f64::from(self.default) / self.unit.per_si()
    }
}

/// Unit of the number that an autopilot stores.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A number, a bit field or a choice.
    Number,
    /// m.
    M,
    /// cm.
    Cm,
    /// m/s.
    Mps,
    /// cm/s.
    CmPs,
    /// m/s^2.
    Mps2,
    /// cm/s^2.
    CmPs2,
    /// s.
    S,
    /// ms.
    Ms,
    /// Degrees.
    Deg,
    /// Hundredths of a degree.
    CDeg,
}

impl Unit {
    /// How many of it make one SI unit; degrees stay degrees.
    #[must_use]
    pub const fn per_si(self) -> f64 {
        match self {
            Self::Cm | Self::CmPs | Self::CmPs2 | Self::CDeg => 100.0,
            Self::Ms => 1000.0,
            Self::Number | Self::M | Self::Mps | Self::Mps2 | Self::S | Self::Deg => 1.0,
        }
    }
}

const fn p(name: &'static str, default: f32, unit: Unit) -> ParameterRow {
    ParameterRow {
        name,
        default,
        unit,
        is_int32: false,
        versions: VersionRange::ALL,
    }
}

const fn int32(row: ParameterRow) -> ParameterRow {
    ParameterRow {
        is_int32: true,
        ..row
    }
}

const fn of(versions: VersionRange, row: ParameterRow) -> ParameterRow {
    ParameterRow { versions, ..row }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `parameter` finds the first row of a name: another one must have the same unit and type.
    #[test]
    fn a_name_means_the_same_in_every_table() {
        let tables = [
            ARDUCOPTER, ARDUPLANE, QUADPLANE, PX4_ROTORS, PX4_WING, PX4_VTOL, PX4_COPTER,
        ];
        for row in tables.into_iter().flatten() {
            let found = parameter(row.name).expect("it is in a table");
            assert_eq!(
                (found.unit, found.is_int32),
                (row.unit, row.is_int32),
                "{}",
                row.name
            );
        }
    }
}

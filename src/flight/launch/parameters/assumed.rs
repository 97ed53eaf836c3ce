//! What the verdict assumes of one parameter, and what a vehicle says of it.

use crate::autopilot::{Judged, in_unit_of, other_name};
use crate::link::Time;
use crate::mission::{Parameter, VehicleMission, is_lean_limit};

/// What the verdict assumes of one parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Assumed<'a> {
    /// The plan sets it.
    Planned(&'a Parameter),
    /// The verdict knows how all of a mission is flown with these values alone. A vehicle may not have it.
    Judged(&'static str, Judged),
}

impl<'a> Assumed<'a> {
    /// Those of a mission. One that its plan sets is compared with the plan.
    pub(super) fn all_of(mission: &'a VehicleMission) -> Vec<Self> {
        let planned: Vec<Self> = mission.params.iter().map(Self::Planned).collect();
        let judged = mission.facts().judged_with.iter().copied().flatten();
        let mut all: Vec<Self> = Vec::new();
        for (name, judged) in judged {
            if !(planned.iter().chain(&all)).any(|of| of.is_named(name)) {
                all.push(Self::Judged(name, *judged));
            }
        }
        all.extend(planned);
        all
    }

    pub(super) fn name(self) -> &'a str {
        match self {
            Self::Planned(planned) => &planned.name,
            Self::Judged(name, _) => name,
        }
    }

    /// Its names in all versions.
    pub(super) fn names(self) -> impl Iterator<Item = &'a str> {
        std::iter::once(self.name()).chain(other_name(self.name()))
    }

    /// Whether a vehicle has it under this name, in whichever version.
    pub(super) fn is_named(self, name: &str) -> bool {
        self.name() == name || other_name(self.name()) == Some(name)
    }

    /// Whether a vehicle that does not have it flies as the verdict assumes.
    pub(super) fn is_optional(self) -> bool {
        matches!(self, Self::Judged(..))
    }

    /// The planned value, if one is, in the unit that the parameter has under this name.
    pub(super) fn planned(self, name: &str) -> Option<f32> {
        match self {
            Self::Planned(planned) => Some(value_as(planned, name)),
            Self::Judged(..) => None,
        }
    }

    /// Whether a value of the vehicle is as the verdict assumes it; a greater lean angle is as good.
    pub(super) fn suffices(self, name: &str, held: f32) -> bool {
        match self {
            Self::Planned(planned) => {
                let planned = value_as(planned, name);
                is_same(held, planned) || is_lean_limit(name) && held.is_finite() && held > planned
            }
            Self::Judged(_, judged) => judged.knows(f64::from(held)),
        }
    }

    /// What is assumed of it under this name.
    pub(super) fn value(self, name: &str) -> Value {
        match self {
            Self::Planned(planned) => Value::Planned(value_as(planned, name)),
            Self::Judged(_, judged) => Value::Judged(judged),
        }
    }

    /// That the vehicle has another value, in words.
    pub(super) fn difference(self, name: &str, value: f32) -> String {
        match self {
            Self::Planned(planned) => format!(
                "parameter {name} is {value}, the verdict assumes {} ({})",
                value_as(planned, name),
                planned.why
            ),
            Self::Judged(_, judged) => format!(
                "parameter {name} is {value} (judged: {judged}): the verdict does not know how it flies with that"
            ),
        }
    }
}

/// What the verdict assumes of a value, in the unit of the vehicle's name for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Value {
    Planned(f32),
    Judged(Judged),
}

/// A parameter that the vehicle says to have another value than the verdict assumes.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::flight) struct ParameterMismatch {
    /// As the vehicle names it.
    pub(in crate::flight) name: String,
    /// In its unit.
    pub(in crate::flight) value: f32,
    pub(super) assumed: Value,
    /// When it was first said to be another one.
    pub(super) since: Time,
    /// How often it was read again since then, and when it is next.
    pub(super) read: u8,
    pub(super) due: Time,
}

impl ParameterMismatch {
    pub(super) fn new(assumed: Assumed<'_>, name: &str, value: f32, now: Time) -> Self {
        Self {
            name: name.to_owned(),
            value,
            assumed: assumed.value(name),
            since: now,
            read: 0,
            due: now,
        }
    }

    /// Whether it says how high a vehicle returns, how, or where to.
    pub(super) fn is_of_return(&self) -> bool {
        self.name.contains("RTL_") || self.name.starts_with("RALLY_")
    }

    /// What an operator reads of it.
    pub(in crate::flight) fn words(&self) -> String {
        let (name, value) = (&self.name, self.value);
        match self.assumed {
            Value::Planned(planned) => format!("{name} is {value}, planned {planned}"),
            Value::Judged(judged) => format!("{name} is {value}, judged: {judged}"),
        }
    }

    /// What one who waits for T0 reads of it.
    pub(in crate::flight) fn changed(&self) -> String {
        let (name, value) = (&self.name, self.value);
        let instead = match self.assumed {
            Value::Planned(planned) => format!("and not {planned}"),
            Value::Judged(judged) => format!("(judged: {judged})"),
        };
        format!("it says that {name} is {value} {instead}, after it was checked")
    }
}

/// The planned value in the unit that the parameter has under this name.
#[expect(
    clippy::cast_possible_truncation,
    reason = "parameters are float32 on the wire"
)]
fn value_as(planned: &Parameter, name: &str) -> f32 {
    match planned.name == name {
        true => planned.value,
        false => in_unit_of(f64::from(planned.value), &planned.name, name) as f32,
    }
}

/// Equal as far as a float32 that went through centimetres can be.
pub(super) fn is_same(a: f32, b: f32) -> bool {
    a.is_finite() && b.is_finite() && (a - b).abs() <= 1e-4 * a.abs().max(b.abs()).max(1.0)
}

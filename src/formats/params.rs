//! Parameter files as ground stations load them.

use crate::autopilot::{self, Autopilot};
use crate::mission::{Parameter, VehicleMission};

/// The parameters that the verdict assumes, as text.
///
/// ArduPilot: `NAME,VALUE` lines with `#` comments. PX4: QGroundControl's table of
/// vehicle, component, name, value and `MAV_PARAM_TYPE` (6 int32, 9 float).
#[must_use]
pub fn write(mission: &VehicleMission) -> String {
    let mut text = String::from("# What the verdict on this mission assumes of the vehicle.\n");
    for note in &mission.notes {
        text.push_str(&format!("# Note: {}\n", note.replace(['\r', '\n'], " ")));
    }
    let is_px4 = mission.autopilot == Autopilot::Px4;
    if is_px4 {
        text.push_str("# Vehicle-Id Component-Id Name Value Type\n");
    }
    for parameter in &mission.params {
        let (name, value) = (&parameter.name, parameter.value);
        text.push_str(&format!("# {}\n", parameter.why));
        text.push_str(&if is_px4 {
            let is_int32 = autopilot::parameter(name).is_some_and(|row| row.is_int32);
            format!("1\t1\t{name}\t{value}\t{}\n", if is_int32 { 6 } else { 9 })
        } else {
            format!("{name},{value}\n")
        });
    }
    text
}

/// A line of a parameter file that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {text:?} is neither NAME,VALUE nor vehicle, component, name, value, type")]
pub struct ParamsError {
    /// From 1.
    pub line: usize,
    /// The line, cut to 80 characters.
    pub text: String,
}

/// Reads either form; the comment before a parameter becomes [`Parameter::why`].
///
/// # Errors
/// The first line of neither form.
pub fn read(text: &str) -> Result<Vec<Parameter>, ParamsError> {
    let mut params = Vec::new();
    let mut why = "";
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if let Some(comment) = line.strip_prefix('#') {
            why = comment.trim();
            continue;
        }
        if line.is_empty() {
            continue;
        }
        let fields: Vec<&str> = line
            .split(['\t', ',', ' '])
            .filter(|f| !f.is_empty())
            .collect();
        let found = match fields[..] {
            [name, value] | [_, _, name, value, _] => value
                .parse()
                .ok()
                .filter(|value: &f32| value.is_finite())
                .map(|value| Parameter {
                    name: name.to_owned(),
                    value,
                    why: why.to_owned(),
                }),
            _ => None,
        };
        params.push(found.ok_or_else(|| ParamsError {
            line: index + 1,
            text: line.chars().take(80).collect(),
        })?);
    }
    Ok(params)
}

//! Parameter files as ground stations load them.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use crate::autopilot::{self, Autopilot};
use crate::mission::{Parameter, VehicleMission};

/// The parameters that the verdict assumes of a plan with a seed, as text.
///
/// ArduPilot: `NAME,VALUE` lines with `#` comments. PX4: QGroundControl's table of
/// vehicle, component, name, value and `MAV_PARAM_TYPE` (6 int32, 9 float).
#[must_use]
pub fn write(mission: &VehicleMission, seed: u64) -> String {
    let mut text =
        format!("# What the verdict on this mission (seed {seed}) assumes of the vehicle.\n");
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
pub enum ParamsError {
    /// A line of neither form.
    #[error(
        "line {line}: {text:?} is neither NAME,VALUE nor vehicle, component, name, value, type"
    )]
    Line {
        /// From 1.
        line: usize,
        /// The line, cut to 80 characters.
        text: String,
    },
    /// Two names of one parameter, with values that differ.
    #[error(
        "{0} and {1} are names of one parameter in different versions, and their values differ"
    )]
    Ambiguous(String, String),
}

/// Reads either form; the comment before a parameter becomes [`Parameter::why`]. A byte order mark, comments and
/// annotations (`@READONLY`) at the end of lines are left out, and lines may end with carriage returns alone. Of a name
/// that stands there twice the last value counts, as for a vehicle that is given all of them.
///
/// # Errors
/// The first line of neither form; two names of one parameter that differ.
pub fn read(text: &str) -> Result<Vec<Parameter>, ParamsError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let params = lines(&text.replace("\r\n", "\n").replace('\r', "\n"))?;
    for param in &params {
        let Some(other) = autopilot::other_name(&param.name) else {
            continue;
        };
        let Some(found) = params.iter().find(|found| found.name == other) else {
            continue;
        };
        let same = autopilot::in_unit_of(f64::from(found.value), other, &param.name);
        let value = f64::from(param.value);
        if (same - value).abs() > 1e-3 * value.abs().max(1.0) {
            return Err(ParamsError::Ambiguous(
                param.name.clone(),
                found.name.clone(),
            ));
        }
    }
    Ok(params)
}

fn lines(text: &str) -> Result<Vec<Parameter>, ParamsError> {
    let mut params: Vec<Parameter> = Vec::new();
    let mut index_of: HashMap<String, usize> = HashMap::new();
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
            .split('#')
            .next()
            .unwrap_or_default()
            .split(['\t', ',', ' '])
            .filter(|field| !field.is_empty())
            .take_while(|field| !field.starts_with('@'))
            .collect();
        let found = match fields[..] {
            [name, value] | [_, _, name, value, _] => value
                .parse()
                .ok()
                .filter(|value: &f32| value.is_finite())
                .map(|value| Parameter {
                    name: name.to_ascii_uppercase(),
                    value,
                    why: why.to_owned(),
                }),
            _ => None,
        };
        let found = found.ok_or_else(|| ParamsError::Line {
            line: index + 1,
            text: line.chars().take(80).collect(),
        })?;
        match index_of.entry(found.name.clone()) {
            Entry::Occupied(index) => params[*index.get()] = found,
            Entry::Vacant(index) => {
                index.insert(params.len());
                params.push(found);
            }
        }
    }
    Ok(params)
}

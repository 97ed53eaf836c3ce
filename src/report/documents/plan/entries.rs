//! What `plan.json` says of a vehicle: stops, tasks, limits that are broken, costs and places.

use schemars::JsonSchema;
use serde::Serialize;

use crate::report::documents::{finite, rounded_against};
use crate::verify::Margin;

/// A task that a vehicle does.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PlannedTask {
    /// Name in the spec.
    pub id: String,
    /// When its vehicle is at its first place, seconds after T0.
    pub from_s: Option<f64>,
    /// When it has rested at the last one, seconds after T0.
    pub until_s: Option<f64>,
    /// Of an area, corridor or search pattern: the lines that it flies, from 1, in order; negative
    /// ones from their end to their begin.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub lines: Vec<i32>,
}

/// A task that no vehicle does.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LeftTask {
    /// Name in the spec.
    pub id: String,
    /// Why.
    pub why: String,
}

/// A stop of a planned vehicle.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PlannedStop {
    /// Name in the spec.
    pub id: String,
    /// Degrees north, WGS84.
    pub lat_deg: Option<f64>,
    /// Degrees east, WGS84.
    pub lon_deg: Option<f64>,
    /// Metres above mean sea level.
    pub amsl_m: Option<f64>,
    /// When the vehicle is there, seconds after T0.
    pub t_s: Option<f64>,
    /// How long it rests there, seconds.
    pub rest_s: f64,
    /// What it does there: keys of the spec, in order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub actions: Vec<&'static str>,
}

/// What a vehicle uses of its endurance, by the verdict.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct UsedEndurance {
    /// From takeoff to touchdown, late as it may be; null where that is not known.
    pub used: Option<f64>,
    /// What it may use: all but the reserve.
    pub limit: Option<f64>,
    /// Unit of both: `s`, `m` or `Wh`.
    pub unit: &'static str,
}

impl UsedEndurance {
    pub(super) fn of(margin: &Margin) -> Self {
        Self {
            used: rounded_against(margin.value, margin.bound),
            limit: finite(margin.bound),
            unit: margin.unit,
        }
    }
}

/// A zone or threat that is not in the fence of a vehicle.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LeftOut {
    /// Such as `zone town`.
    pub what: String,
    /// Least distance to the flight and to the straight ways back from it, metres.
    pub distance_m: Option<f64>,
}

/// A limit that the best path found violates.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct BlockEntry {
    /// The limit: a threat or zone by its id, the ground, a turn.
    pub what: String,
    /// By how much, in words.
    pub how: String,
    /// The worst place.
    pub at: ControlPoint,
}

/// The terms of the objective as they enter the total.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[expect(missing_docs, reason = "the names are those of `CostTerms`")]
pub struct Cost {
    pub total: Option<f64>,
    pub length: Option<f64>,
    pub altitude: Option<f64>,
    pub threat: Option<f64>,
    pub terrain: Option<f64>,
    pub turn: Option<f64>,
    pub climb: Option<f64>,
    pub collision: Option<f64>,
}

/// A control point; the path passes near it, at no defined time.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ControlPoint {
    /// Degrees north, WGS84.
    pub lat_deg: Option<f64>,
    /// Degrees east, WGS84.
    pub lon_deg: Option<f64>,
    /// Metres above mean sea level.
    pub amsl_m: Option<f64>,
}

/// A point of the path.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PathPoint {
    /// Degrees north, WGS84.
    pub lat_deg: Option<f64>,
    /// Degrees east, WGS84.
    pub lon_deg: Option<f64>,
    /// Metres above mean sea level.
    pub amsl_m: Option<f64>,
    /// Seconds after T0.
    pub t_s: Option<f64>,
}

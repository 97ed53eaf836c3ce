//! `review.json`: the verdict and every margin.

use schemars::JsonSchema;
use serde::Serialize;

use super::{DEGREE_DIGITS, METRE_DIGITS, finite, rounded, rounded_against, verdict};
use crate::verify::{Margin, Moment, Review};

/// The verdict and every margin: `review.json`.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ReviewDocument {
    /// `pass` or `fail`.
    pub verdict: &'static str,
    /// The seed of the plan, if Sortie made it; absent for other missions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// In the order of the review.
    pub margins: Vec<MarginEntry>,
    /// Assumptions of the flight model that were not measured on an autopilot.
    pub assumptions: Vec<String>,
}

/// One margin of `review.json`. A value that could not be judged is null.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MarginEntry {
    /// Id of the vehicle.
    pub vehicle: String,
    /// Id of the other vehicle, or null.
    pub other: Option<String>,
    /// Which limit, in words.
    pub what: String,
    /// The worst value, or null.
    pub value: Option<f64>,
    /// The limit of the value.
    pub limit: Option<f64>,
    /// What of the limit is the buffer of the spec; absent where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub buffer: Option<f64>,
    /// Unit of both.
    pub unit: &'static str,
    /// Where and when, or null.
    pub at: Option<Place>,
    /// Whether the limit is kept.
    pub ok: bool,
    /// Further remarks.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub note: String,
}

/// Where and when a margin is worst.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Place {
    /// Degrees north, WGS84.
    pub lat_deg: Option<f64>,
    /// Degrees east, WGS84.
    pub lon_deg: Option<f64>,
    /// Metres above mean sea level.
    pub amsl_m: Option<f64>,
    /// Seconds after T0.
    pub t_s: Option<f64>,
    /// Row of the `.waypoints` file: home is 0, the first item 1.
    pub item: usize,
}

/// The content of `review.json`, with the seed where the missions are a plan's.
#[must_use]
pub fn review_json(review: &Review, seed: Option<u64>) -> ReviewDocument {
    ReviewDocument {
        verdict: verdict(review.passes()),
        seed,
        margins: review.margins.iter().map(margin_entry).collect(),
        assumptions: review.assumptions.clone(),
    }
}

fn margin_entry(margin: &Margin) -> MarginEntry {
    MarginEntry {
        vehicle: margin.vehicle.clone(),
        other: margin.other.clone(),
        what: margin.limit.to_string(),
        value: rounded_against(margin.value, margin.bound),
        limit: rounded(margin.bound, 1e9),
        buffer: finite(margin.buffer).filter(|buffer| *buffer > 0.0),
        unit: margin.unit,
        at: margin.at.as_ref().map(place),
        ok: margin.ok,
        note: margin.note.clone(),
    }
}

pub(in crate::report) fn place(moment: &Moment) -> Place {
    Place {
        lat_deg: rounded(moment.place.lat_deg, DEGREE_DIGITS),
        lon_deg: rounded(moment.place.lon_deg, DEGREE_DIGITS),
        amsl_m: rounded(moment.amsl.0, METRE_DIGITS),
        t_s: rounded(moment.t_s, METRE_DIGITS),
        item: moment.item,
    }
}

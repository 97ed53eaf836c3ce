//! `plan.json`, `review.json` and others: plain documents for other programs.
//!
//! Keys stand in the order of the structs. Places are rounded to 1e-9 degrees
//! and metres to 1e-4, far below anything that can be flown, so that the same
//! facts give the same bytes.

mod check;
mod plan;
mod review;
mod timing;
mod upload;

use serde::Serialize;

use crate::numeric::text::escaped_json;

pub use check::{CheckDocument, CheckedVehicle, ImportEntry, IssueEntry};
pub(super) use plan::whole_path;
pub use plan::{
    ControlPoint, Cost, FleetCost, LeftOut, PathPoint, PlanDocument, PlannedVehicle,
    PlannedVehicles, UsedEndurance, WrittenPlan, plan_json,
};
pub(super) use review::place;
pub use review::{MarginEntry, Place, ReviewDocument, review_json};
pub use timing::TimingDocument;
pub use upload::{UploadDocument, UploadedVehicle};

const DEGREE_DIGITS: f64 = 1e9;
const METRE_DIGITS: f64 = 1e4;

/// The number, if it is finite.
pub(super) fn finite(value: f64) -> Option<f64> {
    // Adding 0 turns -0 into 0.
    value.is_finite().then_some(value + 0.0)
}

/// Rounds to the nearest multiple of `1 / per_unit`; none if not finite.
pub(super) fn rounded(value: f64, per_unit: f64) -> Option<f64> {
    finite((value * per_unit).round() / per_unit)
}

/// Rounded like metres, but never onto or across the limit it is compared with:
/// 59.99999 m of 60 m must not read as 60.
fn rounded_against(value: f64, limit: f64) -> Option<f64> {
    let near = rounded(value, METRE_DIGITS)?;
    if near.partial_cmp(&limit) == value.partial_cmp(&limit) {
        Some(near)
    } else {
        finite(value)
    }
}

/// A document as text: indented, with a newline at the end.
#[must_use]
pub fn json_text<D: Serialize>(document: &D) -> String {
    let mut text =
        serde_json::to_string_pretty(document).expect("documents have string keys and no maps");
    text.push('\n');
    escaped_json(&text).into_owned()
}

/// The verdict as the documents spell it.
pub(super) fn verdict(passes: bool) -> &'static str {
    if passes { "pass" } else { "fail" }
}

#[cfg(test)]
mod tests {
    use super::{rounded, rounded_against};

    #[test]
    fn rounding_neither_crosses_the_limit_nor_leaves_a_negative_zero() {
        assert_eq!(rounded_against(61.234_567_8, 60.0), Some(61.2346));
        assert_eq!(rounded_against(59.999_999, 60.0), Some(59.999_999));
        assert_eq!(rounded_against(60.0, 60.0), Some(60.0));
        assert_eq!(rounded_against(f64::NAN, 60.0), None);
        assert_eq!(rounded(f64::INFINITY, 1e4), None);
        let zero = rounded(-1e-9, 1e4).expect("finite");
        assert!(zero.is_sign_positive(), "{zero}");
    }
}

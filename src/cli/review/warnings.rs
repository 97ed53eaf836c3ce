//! What a review warns of beside its limits.

use crate::cli::print::console::note;
use crate::mission::{self, VehicleMission};
use crate::spec::MissionSpec;
use crate::verify::{self, Limit};

/// Prints what may not be as it was meant, and keeps it with the review.
pub(super) fn warn(review: &mut verify::Review, warnings: Vec<String>) {
    for text in &warnings {
        note(&format!("warning: {text}"));
    }
    review.assumptions.extend(warnings);
}

/// Prints what the review keeps of single vehicles besides their limits, such as a speed that needs more
/// lean than a stock vehicle has.
pub(super) fn warn_of_vehicles(spec: &MissionSpec, review: &verify::Review) {
    let is_of_one = |text: &&String| {
        let mut ids = spec.vehicles.iter().map(|vehicle| vehicle.id.as_str());
        ids.any(|id| {
            text.strip_prefix(id)
                .is_some_and(|rest| rest.starts_with(": "))
        })
    };
    for text in review.assumptions.iter().filter(is_of_one) {
        note(&format!("warning: {text}"));
    }
}

/// Prints which items of missions that pass are never flown.
pub(super) fn warn_of_items(review: &verify::Review) {
    let passed = review.margins.iter().filter(|margin| margin.ok);
    let noted = passed.filter(|margin| !margin.note.is_empty());
    for margin in noted.filter(|margin| margin.limit == Limit::ItemsJudged) {
        note(&format!("warning: {}: {}", margin.vehicle, margin.note));
    }
}

/// What autopilots store otherwise than it was sent, and is judged as stored.
pub(super) fn stored_otherwise(
    spec: &MissionSpec,
    missions: &[(usize, &VehicleMission)],
) -> Vec<String> {
    let of = |(vehicle, mission): &(usize, &VehicleMission)| {
        let id = &spec.vehicles[*vehicle].id;
        let all = mission::stored_otherwise(mission).into_iter();
        all.map(|text| format!("{id}: {text}; judged as stored"))
            .collect::<Vec<_>>()
    };
    missions.iter().flat_map(of).collect()
}

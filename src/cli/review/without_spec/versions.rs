//! Copters that a later version of their autopilot flies at other altitudes: without a spec nobody says which version
//! they have, and both ways are judged.

use crate::autopilot::Version;
use crate::mission::VehicleMission;
use crate::spec::{MissionSpec, Vehicle};
use crate::verify::{self, Limit, Margin, Review};
use crate::world::World;

/// The first version that flies a vehicle otherwise, if one does.
fn later(vehicle: &Vehicle) -> Option<Version> {
    let range = vehicle.facts().heights_at_once?;
    range.since.filter(|_| vehicle.autopilot_version.is_none())
}

/// Judges the missions as a later version of their autopilot flies them, too. Of each limit the worse margin counts.
pub(crate) fn judge_later(
    review: &mut Review,
    (spec, world): (&MissionSpec, &World),
    judged: &[(usize, &VehicleMission)],
) {
    let mut spec = spec.clone();
    let mut missions: Vec<(usize, VehicleMission)> = Vec::new();
    let mut is_other = false;
    for (index, mission) in judged {
        let version = later(&spec.vehicles[*index]);
        is_other |= version.is_some();
        let vehicle = &mut spec.vehicles[*index];
        vehicle.autopilot_version = vehicle.autopilot_version.or(version);
        let mission = (*mission).clone();
        let version = version.or(mission.autopilot_version);
        missions.push((*index, mission.for_version(version)));
    }
    if !is_other {
        return;
    }
    let judged: Vec<(usize, &VehicleMission)> =
        missions.iter().map(|(index, of)| (*index, of)).collect();
    for margin in verify::review(&spec, world, &judged).margins {
        // The items are judged for every version already.
        if margin.limit != Limit::Acceptance {
            take_worse(&mut review.margins, margin, &spec);
        }
    }
}

/// Puts a margin in the place of the same one of an earlier version, where it is worse.
fn take_worse(margins: &mut Vec<Margin>, mut margin: Margin, spec: &MissionSpec) {
    let is_same = |other: &&mut Margin| {
        other.vehicle == margin.vehicle
            && other.other == margin.other
            && other.limit == margin.limit
            && other.unit == margin.unit
    };
    let known = margins.iter_mut().find(is_same);
    if let Some(known) = &known {
        let is_worse = match known.ok == margin.ok {
            true => margin.slack() < known.slack(),
            false => !margin.ok,
        };
        if !is_worse {
            return;
        }
    } else if margin.ok {
        return;
    }
    let mut vehicles = spec.vehicles.iter();
    let is_later = |vehicle: &&Vehicle| margin.concerns(&vehicle.id) && later_of(vehicle);
    if let Some(vehicle) = vehicles.find(is_later) {
        let split = if margin.note.is_empty() { "" } else { "; " };
        let version = vehicle.autopilot_version.map(|of| of.to_string());
        margin.note = format!(
            "as {} {} and later flies it{split}{}",
            vehicle.autopilot.name(),
            version.unwrap_or_default(),
            margin.note
        );
    }
    match known {
        Some(known) => *known = margin,
        None => margins.push(margin),
    }
}

/// Whether a vehicle has its heights at once.
fn later_of(vehicle: &Vehicle) -> bool {
    vehicle
        .facts()
        .has_heights_at_once(vehicle.autopilot_version)
}

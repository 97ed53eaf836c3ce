//! What of a review was judged against a limit that was given.

use super::assumed::must_reach_its_speed;
use crate::cli::args::Limits;
use crate::mission::{Item, VehicleMission, command, frame};
use crate::spec::MissionSpec;
use crate::verify::{Basis, Landed, Limit, Margin, Review, landings};

/// The bases that a flag gives, in the order of the table.
const BY_FLAG: [Basis; 8] = [
    Basis::Terrain,
    Basis::Ceiling,
    Basis::Separation,
    Basis::ClimbAngle,
    Basis::DescentAngle,
    Basis::ClimbSpeed,
    Basis::DescentSpeed,
    Basis::TurnRadius,
];

/// Whether a basis was given, its name and its flag; none for a basis that no flag gives.
fn flag(basis: Basis, limits: &Limits) -> Option<(bool, &'static str, &'static str)> {
    Some(match basis {
        Basis::Terrain => (limits.terrain.is_some(), "terrain clearance", "--terrain"),
        Basis::Ceiling => (limits.max_amsl.is_some(), "ceiling", "--max-amsl"),
        Basis::Separation => (limits.separation.is_some(), "separation", "--separation"),
        Basis::ClimbAngle => (limits.max_climb.is_some(), "climb angle", "--max-climb"),
        Basis::DescentAngle => (
            limits.max_descent.is_some(),
            "descent angle",
            "--max-descent",
        ),
        Basis::ClimbSpeed => (limits.climb.is_some(), "climb speed", "--climb"),
        Basis::DescentSpeed => (limits.descent.is_some(), "descent speed", "--descent"),
        Basis::TurnRadius => (limits.load_factor.is_some(), "turn radius", "--load-factor"),
        Basis::Mission | Basis::HomeRow | Basis::Spec => return None,
    })
}

/// A spec and the missions of its vehicles.
type Judged<'a> = (&'a MissionSpec, &'a [(usize, &'a VehicleMission)]);

fn follows_ground(mission: &VehicleMission) -> bool {
    let mut frames = mission.items.iter().map(|item| item.frame);
    frames.any(|of| frame::canonical(of) == frame::GLOBAL_TERRAIN_ALT)
}

/// Whether a margin was judged against something that was given, or that a wing has.
fn is_judged(margin: &Margin, judged: Judged<'_>, limits: &Limits) -> bool {
    let (spec, missions) = judged;
    let is_rate = matches!(margin.limit, Limit::ClimbSpeed | Limit::DescentSpeed);
    let is_turn = margin.limit == Limit::TurnFit;
    let mut vehicles = spec.vehicles.iter();
    let vehicle = vehicles.find(|vehicle| vehicle.id == margin.vehicle);
    let has_wing = vehicle.is_some_and(|vehicle| vehicle.airframe.has_wing());
    // Of a copter that is slower than commanded nobody knows when it is where, nor of a wing whose turns
    // do not fit between its places: in time they are cut short, by half a leg where it turns back.
    let is_timed = limits.separation.is_some() && spec.vehicles.len() > 1 && !margin.ok;
    // Over ground that rises faster than it climbs a copter that follows it is lower than commanded.
    let sinks = is_rate
        && !margin.ok
        && missions.iter().any(|(index, mission)| {
            spec.vehicles[*index].id == margin.vehicle && follows_ground(mission)
        });
    if sinks
        || is_rate && vehicle.is_some() && (has_wing || is_timed)
        || is_turn && has_wing && is_timed
    {
        return true;
    }
    if margin.limit == Limit::Endurance {
        // No flag gives one: longer than any vehicle stays aloft.
        return true;
    }
    if margin.limit == Limit::FlyableSpeed {
        // Judged where times are, of those that are not as they come: see `without_spec::around`.
        return limits.separation.is_some()
            && missions.iter().any(|(index, mission)| {
                spec.vehicles[*index].id == margin.vehicle && must_reach_its_speed(mission)
            });
    }
    match (flag(margin.limit.basis(), limits), margin.limit.basis()) {
        (Some((is_given, ..)), _) => is_given,
        (None, Basis::HomeRow) => !margin.ok,
        (None, basis) => basis != Basis::Spec,
    }
}

/// Keeps the margins that were judged against something that was given. Returns the names and
/// flags of the limits that were not judged.
pub(crate) fn keep_given(review: &mut Review, judged: Judged<'_>, limits: &Limits) -> Vec<String> {
    let spec = judged.0;
    review
        .margins
        .retain(|margin| margin.limit != Limit::LandingPlace && is_judged(margin, judged, limits));
    fail_what_is_never_flown(review, judged);
    if let Some(separation_m) = limits.separation {
        // No file says that vehicles share a place on purpose.
        let found = landings(&review.tracks, Landed::Stay, separation_m);
        review.margins.extend(found);
    }
    if limits.terrain.is_none() && !limits.no_terrain {
        for vehicle in &spec.vehicles {
            review.margins.push(Margin::unjudged(
                &vehicle.id,
                Limit::TerrainClearance,
                "not judged: no elevation was given (--terrain FILE, or --no-terrain to go without)",
            ));
        }
    }
    let is_pair = spec.vehicles.len() > 1;
    let all_wings = spec
        .vehicles
        .iter()
        .all(|vehicle| vehicle.airframe.has_wing());
    let is_rate = |basis: &Basis| matches!(basis, Basis::ClimbSpeed | Basis::DescentSpeed);
    BY_FLAG
        .into_iter()
        .filter(|basis| *basis != Basis::Separation || is_pair)
        .filter(|basis| !(all_wings && is_rate(basis)))
        .filter_map(|basis| flag(basis, limits))
        .filter(|(is_given, ..)| !is_given)
        .map(|(_, name, flag)| format!("{name} ({flag})"))
        .collect()
}

/// Places behind a `NAV_LOITER_UNLIM` are never flown: no spec says that the mission is to end there.
fn fail_what_is_never_flown(review: &mut Review, (spec, missions): Judged<'_>) {
    let is_endless = |item: &&Item| item.command == command::NAV_LOITER_UNLIM;
    let moves = |item: &Item| item.command <= command::NAV_LAST && item.place().is_some();
    for (index, mission) in missions {
        let mut items = mission.items.iter();
        let goes_on = items.find(is_endless).is_some() && items.any(moves);
        let id = &spec.vehicles[*index].id;
        for margin in &mut review.margins {
            if goes_on && margin.limit == Limit::ItemsJudged && margin.vehicle == *id {
                margin.ok &= margin.value >= margin.bound;
            }
        }
    }
}

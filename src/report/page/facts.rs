//! The lines under the headline: how many fly, between which limits, what is done and how it ends.

use std::collections::BTreeMap;

use crate::report::ReviewInput;
use crate::report::scene::{Ending, Scene, VehicleShape};
use crate::report::words::{self, escaped};
use crate::verify::Limit;

/// More vehicles than this are counted instead of named.
const MAX_NAMED: usize = 5;

/// Each as an item of a list.
pub(super) fn facts(input: &ReviewInput<'_>, scene: &Scene) -> String {
    let spec = input.spec;
    let fleet = match spec.vehicles.len() {
        1 => "1 vehicle".to_owned(),
        many => format!("{many} vehicles"),
    };
    let mut facts = vec![
        fleet,
        format!(
            "{} × {} km",
            words::number(scene.bounds.width_m() / 1000.0, 1),
            words::number(scene.bounds.height_m() / 1000.0, 1)
        ),
    ];
    // A limit that was not judged is left out.
    let held = |limit: Limit| {
        let mut margins = input.review.margins.iter();
        margins.any(|margin| margin.limit == limit)
    };
    let clearance = held(Limit::TerrainClearance).then(|| {
        let min_m = words::number(spec.area.min_agl.0 + spec.buffers.terrain_m, 1);
        format!("{min_m} m or more above ground")
    });
    let ceiling = held(Limit::Ceiling)
        .then_some(spec.area.max_amsl.0 - spec.buffers.ceiling_m)
        .map(|max_m| format!("up to {} m AMSL", words::number(max_m, 1)));
    let tops = spec.vehicles.iter().filter_map(|of| of.altitudes.max_agl);
    let top_m = tops.map(|agl| agl.0 - spec.buffers.ceiling_m);
    let top_m = top_m.fold(f64::NEG_INFINITY, f64::max);
    let highest = held(Limit::MaxHeight)
        .then(|| format!("at most {} m above ground", words::number(top_m, 1)));
    let heights: Vec<String> = clearance
        .into_iter()
        .chain(highest)
        .chain(ceiling)
        .collect();
    if !heights.is_empty() {
        facts.push(heights.join(", "));
    }
    if held(Limit::Separation) {
        let apart = words::number(spec.buffered_separation().distance_m, 1);
        // A flown track has no other departure.
        let slack_s = spec.separation.time_slack_s;
        let shifted = if slack_s > 0.0 {
            format!(", departures ± {} s", words::number(slack_s, 1))
        } else {
            String::new()
        };
        facts.push(format!("{apart} m apart{shifted}"));
    }
    facts.extend(tasks(input));
    facts.extend(endings(&scene.vehicles));
    facts
        .iter()
        .map(|fact| format!("<li>{}</li>", escaped(fact)))
        .collect()
}

/// Who does which task; none where the spec has no tasks.
fn tasks(input: &ReviewInput<'_>) -> Option<String> {
    let mut done: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    let mut total = 0;
    for margin in &input.review.margins {
        if let Limit::Task(id) = &margin.limit {
            total += 1;
            if margin.ok {
                done.entry(&margin.vehicle).or_default().push(id);
            }
        }
    }
    let count: usize = done.values().map(Vec::len).sum();
    let areas: Vec<String> = (input.review.margins.iter())
        .filter_map(|margin| match &margin.limit {
            Limit::AreaCovered(id) => {
                Some(format!("{:.2} % of area {id} seen", floored(margin.value)))
            }
            _ => None,
        })
        .collect();
    let vehicles: Vec<String> = done
        .iter()
        .map(|(vehicle, ids)| match ids.len() > MAX_NAMED {
            true => format!("{vehicle}: {} tasks", ids.len()),
            false => format!("{vehicle}: {}", ids.join(", ")),
        })
        .collect();
    let named = match vehicles.len() {
        0 => String::new(),
        1..=MAX_NAMED => format!(" ({})", vehicles.join("; ")),
        many => format!(" by {many} vehicles"),
    };
    let tasks = (total > 0).then(|| format!("{count} of {total} tasks done{named}"));
    let facts: Vec<String> = tasks.into_iter().chain(areas).collect();
    (!facts.is_empty()).then(|| facts.join("; "))
}

/// Percent, cut off to two digits: less than all is not shown as all.
fn floored(percent: f64) -> f64 {
    (percent * 100.0).floor() / 100.0
}

/// The time of the last landing, and the vehicles that stay in the air; none without a track.
fn endings(vehicles: &[VehicleShape]) -> Option<String> {
    let mut down = Vec::new();
    let mut aloft = Vec::new();
    let mut last_s = f64::NEG_INFINITY;
    for vehicle in vehicles {
        match vehicle.end {
            Some(Ending::Down { t_s }) => {
                down.push(vehicle.id.as_str());
                last_s = last_s.max(t_s);
            }
            Some(Ending::Stays { .. }) => aloft.push(vehicle.id.as_str()),
            None => {}
        }
    }
    let named = |ids: &[&str]| {
        if ids.len() == vehicles.len() && ids.len() > 1 {
            "all".to_owned()
        } else if ids.len() > MAX_NAMED {
            format!("{} vehicles", ids.len())
        } else {
            ids.join(", ")
        }
    };
    let landed =
        (!down.is_empty()).then(|| format!("{} down after {}", named(&down), words::clock(last_s)));
    let stays = if aloft.len() == 1 { "stays" } else { "stay" };
    let hovering = (!aloft.is_empty()).then(|| format!("{} {stays} in the air", named(&aloft)));
    let endings: Vec<String> = landed.into_iter().chain(hovering).collect();
    (!endings.is_empty()).then(|| endings.join("; "))
}

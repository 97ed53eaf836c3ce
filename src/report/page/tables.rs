//! The tables of the page: margins and fleet.

use std::collections::{BTreeMap, BTreeSet};

use crate::mission::VehicleMission;
use crate::plan::VehiclePlan;
use crate::report::documents::finite;
use crate::report::scene::{FlownFacts, Scene, ServedFacts, VehicleShape};
use crate::report::words::{self, Ranked, escaped};
use crate::report::{COLOURS, ReviewInput};
use crate::spec::Vehicle;
use crate::verify::Moment;

/// Sort key of unknown values, behind all others.
const LAST: f64 = 1e15;

/// Rows of margins, in the order given.
pub(in crate::report) fn margins(shown: &[Ranked<'_>]) -> String {
    shown
        .iter()
        .enumerate()
        .map(|(row, entry)| margin_row(row, entry))
        .collect()
}

fn margin_row(row: usize, entry: &Ranked<'_>) -> String {
    let margin = entry.margin;
    let tight = if words::measures(margin) {
        entry.slack
    } else {
        LAST
    };
    let note = match words::note(margin) {
        "" => String::new(),
        note => format!("<small>{}</small>", escaped(note)),
    };
    format!(
        "<tr class=\"{class}\" data-row=\"{row}\" tabindex=\"0\">\
         <td class=\"mark\" data-sort=\"{row}\"><span>{word}</span></td>\
         <td class=\"who\">{who}</td><td class=\"what\">{what}{note}</td>\
         <td class=\"num\" data-sort=\"{value_order:e}\">{value}</td><td class=\"limit\">{limit}</td>\
         <td class=\"slack\" data-sort=\"{tight:.6e}\">{bar}</td>{at}</tr>\n",
        class = class(margin.ok),
        word = word(margin.ok),
        who = escaped(&words::who(margin)),
        what = escaped(&margin.limit.to_string()),
        value_order = finite(margin.value).unwrap_or(-LAST),
        value = escaped(&words::value(margin)),
        limit = escaped(&words::limit(margin)),
        bar = bar(entry.slack),
        at = when_and_where(margin.at.as_ref()),
    )
}

/// The slack to the right of the limit, or how far it is missed to the left.
fn bar(slack: f64) -> String {
    // Half a side is one limit's worth; no slack is too large for the bar.
    let width = (1.0 - 1.0 / (1.0 + slack.abs())) * 50.0;
    let left = if slack < 0.0 { 50.0 - width } else { 50.0 };
    format!("<span class=\"bar\"><i style=\"left:{left:.1}%;width:{width:.1}%\"></i></span>")
}

fn when_and_where(at: Option<&Moment>) -> String {
    let Some(at) = at else {
        return format!(
            "<td class=\"num\" data-sort=\"{LAST}\">–</td><td class=\"num\" data-sort=\"{LAST}\">–</td><td class=\"place\"></td>"
        );
    };
    format!(
        "<td class=\"num\" data-sort=\"{:.7e}\">{}</td><td class=\"num\" data-sort=\"{}\">{}</td><td class=\"place\">{}</td>",
        finite(at.t_s).unwrap_or(LAST),
        words::clock(at.t_s),
        at.item,
        at.item,
        words::place(at.place)
    )
}

fn class(ok: bool) -> &'static str {
    if ok { "ok" } else { "bad" }
}

fn word(ok: bool) -> &'static str {
    if ok { "kept" } else { "broken" }
}

/// Rows of vehicles, in the order of the spec.
pub(in crate::report) fn fleet(input: &ReviewInput<'_>, scene: &Scene) -> String {
    let broken: BTreeSet<&str> = input
        .review
        .margins
        .iter()
        .filter(|margin| !margin.ok)
        .flat_map(|margin| std::iter::once(&margin.vehicle).chain(&margin.other))
        .map(String::as_str)
        .collect();
    let missions: BTreeMap<usize, &VehicleMission> = input.missions.iter().copied().collect();
    let planned = |index: usize| input.plan.and_then(|plan| plan.vehicles.get(index));
    input
        .spec
        .vehicles
        .iter()
        .zip(&scene.vehicles)
        .enumerate()
        .map(|(index, (vehicle, shape))| {
            format!(
                "<tr data-vehicle=\"{index}\" tabindex=\"0\" class=\"{class}\"><td><i class=\"swatch v{colour}\"></i>{id}</td>\
                 <td class=\"mark\"><span>{word}</span></td><td>{autopilot}</td>{cost}{flight}<td class=\"num\">{items}</td></tr>\n",
                class = class(!broken.contains(vehicle.id.as_str())),
                word = word(!broken.contains(vehicle.id.as_str())),
                colour = index % COLOURS.len(),
                id = escaped(&vehicle.id),
                autopilot = autopilot(vehicle, planned(index)),
                cost = cost(planned(index)),
                flight = flight(departure_s(input, vehicle), shape),
                items = missions
                    .get(&index)
                    .map_or_else(|| "no mission".to_owned(), |mission| mission.items.len().to_string()),
            )
        })
        .collect()
}

/// The stops and tasks of each vehicle of a flight, no more than `most` rows; empty without any.
pub(in crate::report) fn served(
    input: &ReviewInput<'_>,
    flown: &[FlownFacts],
    most: usize,
) -> String {
    let of = |facts: &FlownFacts| facts.served.len();
    let count: usize = flown.iter().map(of).sum();
    if count == 0 {
        return String::new();
    }
    let index_of = |id: &str| {
        let mut fleet = input.spec.vehicles.iter();
        fleet.position(|vehicle| vehicle.id == id)
    };
    let rows = flown.iter().flat_map(|facts| {
        let colour = index_of(&facts.vehicle).unwrap_or(0) % COLOURS.len();
        let vehicle = escaped(&facts.vehicle);
        let row = move |of: &ServedFacts| served_row(of, colour, &vehicle);
        facts.served.iter().map(row)
    });
    let rows: String = rows.take(most).collect();
    let more = match count.saturating_sub(most) {
        0 => String::new(),
        1 => "<p class=\"note\">1 more is in flight.json.</p>".to_owned(),
        more => format!("<p class=\"note\">{more} more are in flight.json.</p>"),
    };
    format!(
        "<section id=\"served-section\">\n  <h2>Stops and tasks</h2>\n  <div class=\"scroll\">\n  <table id=\"served\">\n    \
         <thead><tr><th>Vehicle</th><th>What</th><th>Seen</th><th class=\"num\">From</th>\
         <th class=\"num\">Until</th></tr></thead>\n    <tbody>\n{rows}    </tbody>\n  </table>\n  </div>\n  \
         {more}\n</section>"
    )
}

fn served_row(of: &ServedFacts, colour: usize, vehicle: &str) -> String {
    let class = match of.state {
        "done" => "ok",
        "missed" => "bad",
        _ => "open",
    };
    let at = |t_s: Option<f64>| t_s.map_or_else(|| "–".to_owned(), words::clock);
    format!(
        "<tr class=\"{class}\"><td><i class=\"swatch v{colour}\"></i>{vehicle}</td><td>{label}</td>\
         <td class=\"mark\"><span>{state}</span></td><td class=\"num\">{from}</td><td class=\"num\">{until}</td></tr>\n",
        label = escaped(&of.label),
        state = of.state,
        from = at(of.from_s),
        until = at(of.until_s),
    )
}

fn cost(planned: Option<&VehiclePlan>) -> String {
    planned.map_or_else(
        || "<td class=\"num\">–</td>".to_owned(),
        |plan| {
            let above = plan.gap().map_or_else(String::new, |gap| {
                let percent = words::number(gap.max(0.0) * 100.0, 2);
                format!("<small>at most {percent} % above the best</small>")
            });
            let total = words::number(plan.terms.total(), 3);
            format!("<td class=\"num\">{total}{above}</td>")
        },
    )
}

/// The takeoff time of the mission, seconds after T0.
fn departure_s(input: &ReviewInput<'_>, vehicle: &Vehicle) -> f64 {
    let mut tracks = input.review.tracks.iter();
    let track = tracks.find(|track| track.vehicle == vehicle.id);
    let first = track.and_then(|track| track.moments.first());
    first.map_or(vehicle.depart_s, |first| first.t_s)
}

/// Length, departure and duration.
fn flight(departure_s: f64, shape: &VehicleShape) -> String {
    let length = if shape.length_m > 0.0 {
        format!("{} km", words::number(shape.length_m / 1000.0, 2))
    } else {
        "–".to_owned()
    };
    let duration = shape
        .duration_s()
        .map_or_else(|| "–".to_owned(), words::clock);
    let then = if shape.stays() {
        "<small>then loiters</small>"
    } else {
        ""
    };
    format!(
        "<td class=\"num\">{length}</td><td class=\"num\">{}</td><td class=\"num\">{duration}{then}</td>",
        words::clock(departure_s)
    )
}

fn autopilot(vehicle: &Vehicle, planned: Option<&VehiclePlan>) -> String {
    let autopilot = vehicle.autopilot.name();
    let airframe = vehicle.airframe.name();
    let speed = match (planned, vehicle.retiming.speed_mps) {
        (Some(plan), _) => words::number(plan.speed_mps, 1),
        (None, None) => words::number(vehicle.speed_mps, 1),
        (None, Some(range)) => format!(
            "{} to {}",
            words::number(range.least, 1),
            words::number(range.most, 1)
        ),
    };
    format!(
        "{autopilot} {airframe}<small>system {}, {speed} m/s</small>",
        vehicle.sysid
    )
}

//! `review.html`: one page that needs nothing else.
//!
//! The verdict, the tables and the plan view are written here and are there
//! without scripts and in print; the scripts move what time moves.

mod facts;
mod tables;

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::Serialize;

use crate::report::documents::{finite, rounded, verdict};
use crate::report::map::plan_view;
use crate::report::scene::{FlownFacts, Scene, VehicleShape};
use crate::report::words::{self, Ranked, escaped};
use crate::report::{COLOURS, ReviewInput, departures_that_pass};
use crate::verify::{Limit, Topic};

/// Rows of the table of margins; the rest is in `review.json`.
const MAX_ROWS: usize = 600;

/// Closest approaches that are drawn, the worst ones.
const MAX_APPROACHES: usize = 4000;

const TEMPLATE: &str = include_str!("page.html");
/// Colours and letters, which other pages share.
pub(crate) const BASE_STYLE: &str = include_str!("base.css");
const STYLE: &str = include_str!("page.css");
const JAVASCRIPT: [&str; 9] = [
    include_str!("state.js"),
    include_str!("labels.js"),
    include_str!("solids.js"),
    include_str!("shaders.js"),
    include_str!("map.js"),
    include_str!("scene.js"),
    include_str!("limits.js"),
    include_str!("charts.js"),
    include_str!("page.js"),
];

/// The data of the scripts.
#[derive(Serialize)]
struct Data<'a> {
    scene: &'a Scene,
    /// One for each row of the table, in the order it is written.
    margins: Vec<Jump>,
    /// The closest approach of every pair that has one, worst first.
    approaches: Vec<Approach>,
    colours: [[&'static str; 2]; COLOURS.len()],
}

/// The vehicles, place and time that a row of the table selects.
#[derive(Serialize)]
struct Jump {
    /// Indices of the vehicles in the spec.
    vehicles: Vec<usize>,
    /// East, north, altitude, time.
    at: Option<[Option<f64>; 4]>,
    what: String,
    /// Whether the profile of the vehicle marks it even where it holds.
    is_clearance: bool,
    value: Option<f64>,
    ok: bool,
}

/// The closest approach of two vehicles, by their indices in the spec.
#[derive(Serialize)]
struct Approach {
    vehicles: [usize; 2],
    t_s: Option<f64>,
    value: Option<f64>,
    ok: bool,
}

/// The page: HTML that opens from disk without a network.
#[must_use]
pub fn review_html(input: &ReviewInput<'_>) -> String {
    page(input, Scene::new(input), &[])
}

/// The page of a flight: the tracks of `input` are flown tracks, and `flown` has their plans.
#[must_use]
pub fn flight_html(input: &ReviewInput<'_>, flown: &[FlownFacts]) -> String {
    let mut scene = Scene::new(input);
    for facts in flown {
        scene.lay_under(facts);
    }
    page(input, scene, flown)
}

fn page(input: &ReviewInput<'_>, scene: Scene, flown: &[FlownFacts]) -> String {
    let ranked = words::ranked(input.review);
    let shown = &ranked[..ranked.len().min(MAX_ROWS)];
    let data = Data {
        scene: &scene,
        margins: shown.iter().map(|entry| jump(entry, input)).collect(),
        approaches: approaches(&ranked, input),
        colours: COLOURS,
    };
    let passes = input.review.passes();
    let part = |name: &str| match name {
        "style" => [BASE_STYLE, STYLE].concat(),
        "title" => escaped(&input.spec.name),
        "verdict" => verdict(passes).to_owned(),
        "headline" => words::headline(input.review),
        "facts" => facts::facts(input, &scene),
        "cards" => cards(shown),
        "map" => plan_view(input, &scene, true),
        "legend" => legend(&scene.vehicles),
        "coarse" => coarse(&scene),
        "infeasible" => infeasible(input),
        "served" => tables::served(input, flown, MAX_ROWS),
        "rows" => tables::margins(shown),
        "left-out" => left_out(ranked.len() - shown.len()),
        "fleet" => tables::fleet(input, &scene),
        "assumptions" => assumptions(&input.review.assumptions),
        "notes" => notes(input),
        "footer" => footer(input),
        "data" => json_in_html(&data),
        "script" => JAVASCRIPT.concat(),
        _ => String::new(),
    };
    fill(TEMPLATE, part)
}

/// Puts the parts in the places `{{name}}` of a template, in one pass: a part
/// that looks like a place is left alone.
fn fill(template: &str, part: impl Fn(&str) -> String) -> String {
    let mut page = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{") {
        let Some((name, after)) = after.split_once("}}") else {
            break;
        };
        page.push_str(before);
        page.push_str(&part(name));
        rest = after;
    }
    page.push_str(rest);
    page
}

/// JSON that cannot end the script element it stands in.
fn json_in_html(data: &Data<'_>) -> String {
    serde_json::to_string(data)
        .expect("scenes have string keys and no maps")
        .replace('<', "\\u003c")
}

fn jump(entry: &Ranked<'_>, input: &ReviewInput<'_>) -> Jump {
    let margin = entry.margin;
    let index_of = |id: &String| {
        let vehicles = &input.spec.vehicles;
        vehicles.iter().position(|vehicle| vehicle.id == *id)
    };
    Jump {
        vehicles: std::iter::once(&margin.vehicle)
            .chain(&margin.other)
            .filter_map(index_of)
            .collect(),
        at: margin.at.as_ref().map(|moment| {
            let at = input.world.frame.to_plan(moment.place);
            [at.east_m, at.north_m, moment.amsl.0, moment.t_s].map(|value| rounded(value, 100.0))
        }),
        what: margin.limit.to_string(),
        is_clearance: margin.limit.topic() == Topic::Clearance,
        value: finite(margin.value),
        ok: margin.ok,
    }
}

fn approaches(ranked: &[Ranked<'_>], input: &ReviewInput<'_>) -> Vec<Approach> {
    let vehicles = input.spec.vehicles.iter().enumerate();
    let indices: BTreeMap<&str, usize> = vehicles
        .map(|(index, vehicle)| (vehicle.id.as_str(), index))
        .collect();
    ranked
        .iter()
        .map(|entry| entry.margin)
        .filter(|margin| margin.limit == Limit::Separation)
        .filter_map(|margin| {
            let index = |id: &str| indices.get(id).copied();
            Some(Approach {
                vehicles: [index(&margin.vehicle)?, index(margin.other.as_ref()?)?],
                t_s: rounded(margin.at.as_ref()?.t_s, 100.0),
                value: rounded(margin.value, 100.0),
                ok: margin.ok,
            })
        })
        .take(MAX_APPROACHES)
        .collect()
}

fn moment(entry: &Ranked<'_>) -> String {
    entry.margin.at.as_ref().map_or_else(String::new, |at| {
        format!("{} · item {}", words::clock(at.t_s), at.item)
    })
}

/// A value, its unit smaller.
fn figure(value: &str, known: bool) -> String {
    match value.split_once(' ').filter(|_| known) {
        Some((number, unit)) => format!("{} <small>{}</small>", escaped(number), escaped(unit)),
        None => escaped(value),
    }
}

fn cards(shown: &[Ranked<'_>]) -> String {
    let mut html = String::new();
    for entry in words::most_important(shown, 4) {
        let margin = entry.margin;
        let row = shown
            .iter()
            .position(|other| std::ptr::eq(other.margin, margin))
            .unwrap_or(0);
        let known = margin.value.is_finite();
        let _ = write!(
            html,
            "<button type=\"button\" class=\"card {}\" data-row=\"{row}\"><span class=\"what\">{}</span>\
             <span class=\"value{}\">{}</span><span class=\"limit\">{}{}</span>\
             <span class=\"who\">{}</span><span class=\"when\">{}</span></button>",
            if margin.ok { "ok" } else { "bad" },
            escaped(&margin.limit.to_string()),
            if margin.unit == words::IN_WORDS {
                " words"
            } else {
                ""
            },
            figure(&words::value(margin), known),
            if margin.ok || !known { "" } else { "must be " },
            escaped(&if known {
                words::limit(margin)
            } else {
                words::note(margin).to_owned()
            }),
            escaped(&words::who(margin)),
            moment(entry),
        );
    }
    html
}

fn legend(vehicles: &[VehicleShape]) -> String {
    vehicles
        .iter()
        .enumerate()
        .map(|(index, vehicle)| {
            format!(
                "<button type=\"button\" class=\"chip\" data-vehicle=\"{index}\" aria-pressed=\"false\">\
                 <i class=\"swatch v{}\"></i>{}</button>",
                index % COLOURS.len(),
                escaped(&vehicle.id)
            )
        })
        .collect()
}

/// A note for a large fleet whose paths are drawn coarsely.
fn coarse(scene: &Scene) -> String {
    let worst_m = scene
        .vehicles
        .iter()
        .map(|vehicle| vehicle.drawn_within_m)
        .fold(0.0, f64::max);
    if worst_m < 2.0 {
        return String::new();
    }
    format!(
        "<p class=\"note\">With this many paths, each is drawn to within {} m. The margins are exact.</p>",
        words::number(worst_m.ceil(), 0)
    )
}

/// Why each vehicle without a path has none; empty if the plan passes.
fn infeasible(input: &ReviewInput<'_>) -> String {
    let reasons = input.infeasibilities();
    let reasons = reasons.iter().map(ToString::to_string);
    let helps = input.plan.filter(|_| !input.review.passes());
    let helps = helps.and_then(|plan| departures_that_pass(input.spec, plan));
    let items: String = reasons
        .chain(helps)
        .map(|reason| format!("<li>{}</li>", escaped(&reason)))
        .collect();
    if items.is_empty() {
        return String::new();
    }
    format!(
        "<section id=\"infeasible\"><h2>Why no path</h2><ul>{items}</ul>\
         <p class=\"note\">Crosses on the map mark the worst place of each violation.</p></section>"
    )
}

fn left_out(count: usize) -> String {
    if count == 0 {
        String::new()
    } else {
        let more = match count {
            1 => "1 more limit, wider than these, is".to_owned(),
            _ => format!("{count} more limits, wider than these, are"),
        };
        format!("<p class=\"note\">{more} in review.json.</p>")
    }
}

fn assumptions(assumptions: &[String]) -> String {
    if assumptions.is_empty() {
        return "<p class=\"note\">None.</p>".to_owned();
    }
    let items: String = assumptions
        .iter()
        .map(|assumption| format!("<li>{}</li>", escaped(assumption)))
        .collect();
    format!("<ul>{items}</ul>")
}

/// The notes on missions, each once, with its vehicles.
fn notes(input: &ReviewInput<'_>) -> String {
    let mut notes: Vec<(&str, Vec<&str>)> = Vec::new();
    for (index, mission) in input.missions {
        let id = input
            .spec
            .vehicles
            .get(*index)
            .map_or("–", |vehicle| vehicle.id.as_str());
        for note in &mission.notes {
            match notes.iter_mut().find(|(known, _)| known == note) {
                Some((_, ids)) => ids.push(id),
                None => notes.push((note, vec![id])),
            }
        }
    }
    if notes.is_empty() {
        return String::new();
    }
    let items: String = notes
        .iter()
        .map(|(note, ids)| {
            let whose = if ids.len() == input.missions.len() && ids.len() > 1 {
                "all vehicles".to_owned()
            } else {
                ids.join(", ")
            };
            format!(
                "<li>{} <small>{}</small></li>",
                escaped(note),
                escaped(&whose)
            )
        })
        .collect();
    format!("<section><h2>In the spec, but not in the missions</h2><ul>{items}</ul></section>")
}

fn footer(input: &ReviewInput<'_>) -> String {
    let seed = input
        .seed
        .map_or_else(String::new, |seed| format!("<span>seed {seed}</span>"));
    format!(
        "<span>sortie {}</span>{seed}<span>spec sha256 <code>{}</code></span>",
        escaped(input.version),
        escaped(input.spec_sha256)
    )
}

#[cfg(test)]
mod tests {
    use super::{fill, left_out};

    #[test]
    fn a_part_that_looks_like_a_place_is_left_alone() {
        let page = fill("<{{a}}|{{b}}|{{none}}>", |name| match name {
            "a" => "{{b}}".to_owned(),
            "b" => "two".to_owned(),
            _ => String::new(),
        });
        assert_eq!(page, "<{{b}}|two|>");
    }

    #[test]
    fn one_limit_that_is_left_out_is_no_plural() {
        assert!(left_out(1).contains("1 more limit, wider than these, is in"));
        assert!(left_out(2).contains("2 more limits, wider than these, are in"));
    }
}

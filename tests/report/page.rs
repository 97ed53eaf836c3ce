//! The page and the picture as text.

use std::fs;

use sortie::plan::{BlockingElement, Change, Relaxation, VehiclePlan};
use sortie::report::{FlownFacts, ServedFacts, infeasibilities};
use sortie::spec::{Stop, StopAction, Vehicle, Zone};
use sortie::verify::Limit;
use sortie::world::{Terrain, TerrainGrid};

use crate::facts::{HOSTILE, IDS, data_of, facts, hilly_spec, output};
use crate::support::place;
#[test]
fn the_page_asks_for_nothing_from_anywhere() {
    let html = facts(hilly_spec(IDS)).html();
    assert!(html.contains("content=\"default-src 'none';"));
    for address in [
        "http:",
        "https:",
        "src=",
        "@import",
        "fetch(",
        "XMLHttpRequest",
        "eval(",
    ] {
        assert!(!html.contains(address), "{address} in the page");
    }
    for (at, _) in html.match_indices("url(") {
        assert!(
            html[at..].starts_with("url(#hatch)"),
            "{}",
            &html[at..at + 40]
        );
    }
    for (at, _) in html.match_indices("href=") {
        assert!(
            html[at..].starts_with("href=\"data:image/png;base64,"),
            "{}",
            &html[at..at + 40]
        );
    }
}

#[test]
fn the_page_and_the_picture_are_well_formed_whatever_the_names() {
    for ids in [IDS, HOSTILE] {
        let mut spec = hilly_spec(ids);
        spec.name = ids[1].to_owned();
        spec.threats[0].id = ids[0].to_owned();
        spec.no_fly[0].id = ids[2].to_owned();
        let facts = facts(spec);
        assert_balanced(&facts.html());
        assert_balanced(&facts.svg());
    }
}

#[test]
fn the_spans_of_a_line_have_its_name_once() {
    let mut spec = hilly_spec(IDS);
    let part = |index: usize, whole: &str| Zone {
        id: format!("{whole} span {index}"),
        part_of: Some(whole.to_owned()),
        ..spec.no_fly[0].clone()
    };
    let parts: Vec<Zone> = (1..=3).map(|index| part(index, "110 kV")).collect();
    let mast = Zone {
        id: "mast".to_owned(),
        ..part(1, "mast")
    };
    spec.no_fly.extend(parts);
    spec.no_fly.push(mast);
    let zones = spec.no_fly.len();
    let facts = facts(spec);
    let svg = facts.svg();
    let names = svg.split("class=\"of-zone\"").skip(1);
    let names: Vec<&str> = names
        .filter_map(|name| name.split("</text>").next())
        .collect();
    assert_eq!(names.len(), zones - 2);
    let written = |text: &str| names.iter().filter(|name| name.contains(text)).count();
    assert_eq!(
        (written(">110 kV"), written("kV span"), written(">mast")),
        (1, 0, 1)
    );
    let data = data_of(&facts.html());
    let named = data["scene"]["zones"].as_array().expect("a list").iter();
    let named: Vec<&str> = named.filter_map(|zone| zone["name"].as_str()).collect();
    assert_eq!(named[named.len() - 2..], ["110 kV", "mast"]);
}

#[test]
fn the_page_and_the_picture_show_each_stop_with_what_is_done_there() {
    let mut spec = hilly_spec(IDS);
    let (start, goal) = (spec.vehicles[0].start, spec.vehicles[0].goal);
    let middle = |a: f64, b: f64| f64::midpoint(a, b);
    let mut end = goal;
    end.place = place(
        middle(start.place.lat_deg, goal.place.lat_deg),
        middle(start.place.lon_deg, goal.place.lon_deg),
    );
    spec.vehicles[0].stops = vec![Stop {
        hold_s: 7.0,
        actions: vec![StopAction::Photo],
        ..Stop::passing("mast <1>", end)
    }];
    let facts = facts(spec);
    let shown = "stop mast &lt;1&gt;: 7 s, photo</title>";
    for markup in [facts.html(), facts.svg()] {
        assert_balanced(&markup);
        assert_eq!(markup.matches(shown).count(), 2, "a square and its eye");
    }
}

#[test]
fn the_page_of_a_flight_lists_stops_and_tasks_and_others_have_no_such_list() {
    let facts = facts(hilly_spec(HOSTILE));
    let seen = |label: &str, state, from_s, until_s| ServedFacts {
        label: label.to_owned(),
        state,
        from_s,
        until_s,
    };
    let flown = [FlownFacts {
        vehicle: HOSTILE[0].to_owned(),
        served: vec![
            seen("stop mast <1>", "done", Some(61.0), Some(75.2)),
            seen("task roof (visit)", "missed", Some(90.0), None),
            seen("task yard (delivery)", "left", None, None),
        ],
        ..FlownFacts::default()
    }];
    let html = facts.flight(&flown);
    assert_balanced(&html);
    for cells in [
        "<td>stop mast &lt;1&gt;</td><td class=\"mark\"><span>done</span></td><td class=\"num\">1:01</td><td class=\"num\">1:15</td>",
        "<td>task roof (visit)</td><td class=\"mark\"><span>missed</span></td><td class=\"num\">1:30</td><td class=\"num\">–</td>",
        "<td>task yard (delivery)</td><td class=\"mark\"><span>left</span></td><td class=\"num\">–</td><td class=\"num\">–</td>",
    ] {
        assert!(html.contains(cells), "{cells}");
    }
    for page in [facts.html(), facts.flight(&[])] {
        assert!(!page.contains("Stops and tasks"));
    }
}

/// Every element that is opened is closed, in order, and no id is used twice.
fn assert_balanced(markup: &str) {
    const EMPTY: [&str; 3] = ["meta", "input", "!doctype"];
    let mut open: Vec<&str> = Vec::new();
    let mut ids: Vec<&str> = Vec::new();
    let mut rest = markup;
    while let Some((_, after)) = rest.split_once('<') {
        let (tag, after) = after.split_once('>').expect("a tag ends");
        assert!(!tag.contains('<'), "a tag in a tag: <{tag}>");
        let name = tag
            .trim_start_matches('/')
            .split([' ', '/'])
            .next()
            .expect("a name");
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name), "closed in order");
        } else if !tag.ends_with('/') && !EMPTY.contains(&name) {
            open.push(name);
        }
        ids.extend(
            tag.split(" id=\"")
                .skip(1)
                .filter_map(|rest| rest.split('"').next()),
        );
        // What stands in these is no markup.
        rest = match name {
            "script" | "style" if !tag.starts_with('/') => {
                &after[after.find(&format!("</{name}>")).expect("its end")..]
            }
            _ => after,
        };
    }
    assert!(open.is_empty(), "left open: {open:?}");
    let count = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), count, "an id is used twice");
}

#[test]
fn ground_without_data_is_a_hole_and_not_a_plain_at_sea_level() {
    let mut facts = facts(hilly_spec(IDS));
    let (rows, columns) = (40, 40);
    let mut heights_m = vec![500.0; rows * columns];
    heights_m[..columns * 10].fill(f32::NAN);
    facts.world.terrain = Terrain::Grid(TerrainGrid {
        raised_m: 0.0,
        north_west: place(36.40, -84.37),
        row_step_deg: 0.2 / 39.0,
        column_step_deg: 0.24 / 39.0,
        rows,
        columns,
        heights_m,
    });
    let html = facts.html();
    let scene = data_of(&html);
    let heights = scene["scene"]["relief"]["heights_dm"]
        .as_array()
        .expect("heights");
    let holes = heights.iter().filter(|height| height.is_null()).count();
    assert!(
        holes > heights.len() / 6 && holes < heights.len() / 3,
        "{holes} of {}",
        heights.len()
    );
    assert!(
        heights
            .iter()
            .all(|height| height.is_null() || height == 5000)
    );
    let ground = scene["scene"]["vehicles"][0]["ground"]["amsl_m"]
        .as_array()
        .expect("ground");
    assert!(
        ground.iter().any(serde_json::Value::is_null),
        "alpha ends over the void"
    );
}

#[test]
fn a_vehicle_that_loiters_is_not_said_to_be_down() {
    let mut facts = facts(hilly_spec(IDS));
    assert!(facts.html().contains("<li>all down after "));
    // Bravo stays where its path ends until long after the others are down.
    let moments = &mut facts.review.tracks[1].moments;
    moments.pop();
    let mut last = *moments.last().expect("a track");
    let flown_s = last.t_s - moments[0].t_s;
    last.t_s = 9000.0;
    moments.push(last);
    let html = facts.html();
    assert!(html.contains("<li>alpha, charlie down after "));
    assert!(html.contains("; bravo stays in the air</li>"));
    let (before, _) = html
        .split_once("<small>then loiters</small>")
        .expect("the row of bravo");
    let (minutes, seconds) = before[before.len() - 5..].split_once(':').expect("a clock");
    let told_s =
        60.0 * minutes.parse::<f64>().expect("minutes") + seconds.parse::<f64>().expect("seconds");
    assert!((told_s - flown_s).abs() < 1.0, "{told_s} {flown_s}");
    assert_eq!(html.matches("<small>then loiters</small>").count(), 1);
    assert!(!html.contains("2:30:00</td>"));
}

#[test]
fn the_page_of_a_failure_says_why_no_path_was_found() {
    let mut facts = facts(hilly_spec(IDS));
    let threat = facts.spec.threats[0].id.clone();
    let plan = &mut facts.plan.vehicles[0];
    plan.terms.threat = 0.2;
    plan.terms.collision = 0.1;
    plan.blocking_set = vec![BlockingElement::Threat(0), BlockingElement::Edge];
    facts.plan.vehicles[1].terms.threat = 0.2;
    facts.plan.vehicles[1].relaxations = Some(vec![Relaxation(vec![Change::Evaluations(80_000)])]);
    facts.review.margins[0].ok = false;
    let page = facts.html();
    let (_, reasons) = page
        .split_once("<section id=\"infeasible\">")
        .expect("reasons");
    let (reasons, _) = reasons.split_once("</section>").expect("an end");
    for part in [
        "alpha: no path was found from start to goal",
        "separation from earlier vehicles",
        &format!("every way is closed by threat {threat} and the edge of the area"),
        "bravo: no path was found",
        "one is found with",
    ] {
        assert!(reasons.contains(part), "{part}: {reasons}");
    }
    facts
        .review
        .margins
        .iter_mut()
        .for_each(|margin| margin.ok = true);
    assert!(!facts.html().contains("<section id=\"infeasible\">"));
}

/// What makes a plan fail for a reason.
type Made<'a> = &'a dyn Fn(&mut VehiclePlan);

/// Word for word, whatever the reason, and each violation as a cross on the map that says what it is.
#[test]
fn the_page_of_a_failure_has_every_sentence_of_the_terminal() {
    let failed = || {
        let mut facts = facts(hilly_spec(IDS));
        for plan in &mut facts.plan.vehicles {
            plan.terms.threat = 0.2;
            plan.terms.collision = 0.1;
        }
        facts.review.margins[0].ok = false;
        facts
    };
    let relaxed = |changes: &[Change]| {
        let one = |change: &Change| Relaxation(vec![*change]);
        Some(changes.iter().map(one).collect::<Vec<_>>())
    };
    let remedies = [Change::Evaluations(80_000), Change::ControlPoints(12)];
    let reasons: [(&str, Made<'_>); 5] = [
        ("every way is closed by", &|plan| {
            plan.blocking_set = vec![BlockingElement::Threat(0), BlockingElement::Edge];
        }),
        (
            "alone it would have one: alpha, bravo are in its way",
            &|plan| {
                plan.blocked_by = vec![0, 1];
            },
        ),
        ("; there may be none", &|plan| {
            plan.relaxations = Some(Vec::new())
        }),
        (", or with ", &|plan| plan.relaxations = relaxed(&remedies)),
        ("separation from earlier vehicles", &|_| ()),
    ];
    for (part, change) in reasons {
        let mut facts = failed();
        facts.plan.vehicles.iter_mut().for_each(change);
        let said = infeasibilities(&facts.spec, &facts.world, &facts.plan);
        assert_eq!(said.len(), 3);
        let page = facts.html();
        let mut crosses = 0;
        for reason in &said {
            let sentence = reason.to_string();
            assert!(sentence.contains(part), "{part}: {sentence}");
            assert!(page.contains(&format!("<li>{sentence}</li>")), "{sentence}");
            for at in &reason.violations {
                crosses += 1;
                let title = format!(
                    "<title>{}: {} ({})</title>",
                    reason.vehicle, at.what, at.how
                );
                assert!(page.contains(&title), "{title}");
            }
        }
        assert!(crosses > 0);
        assert_eq!(page.matches("class=\"violation\"").count(), crosses);
    }
}

#[test]
fn the_gap_is_to_the_bound_and_only_of_plans_that_it_holds_for() {
    let mut facts = facts(hilly_spec(IDS));
    assert!(facts.html().contains("at most 5.63 % above the best"));
    facts.plan.vehicles[0].terms.threat = 0.1;
    let page = facts.html();
    assert_eq!(page.matches("% above the best").count(), 2, "{page}");
}

#[test]
fn no_cost_is_said_to_be_below_its_bound() {
    let mut facts = facts(hilly_spec(IDS));
    for plan in &mut facts.plan.vehicles {
        plan.bound = plan.terms.total() * 1.0078;
    }
    let page = facts.html();
    assert_eq!(page.matches("at most 0 % above the best").count(), 3);
    assert!(!page.contains("at most -") && !page.contains("at most \u{2212}"));
}

#[test]
fn every_pair_is_on_the_timeline_once_worst_first() {
    let facts = facts(hilly_spec(IDS));
    let held = facts.review.margins.iter();
    let expected: Vec<f64> = held
        .filter(|margin| margin.limit == Limit::Separation)
        .map(|margin| margin.value)
        .collect();
    assert!(!expected.is_empty());
    let data = data_of(&facts.html());
    let told = data["approaches"].as_array().expect("a list");
    assert_eq!(told.len(), expected.len());
    let mut last = f64::NEG_INFINITY;
    for approach in told {
        let value = approach["value"].as_f64().expect("a distance");
        assert!(value >= last, "{value} after {last}");
        assert!(expected.iter().any(|held| (held - value).abs() < 0.01));
        let pair = approach["vehicles"].as_array().expect("a pair");
        assert!(pair.len() == 2 && pair[0] != pair[1], "{pair:?}");
        last = value;
    }
}

#[test]
fn the_page_of_a_thousand_vehicles_stays_under_3_mb() {
    let ids: Vec<String> = (0..1000).map(|number| format!("uav-{number:04}")).collect();
    let mut spec = hilly_spec(IDS);
    let three = spec.vehicles.clone();
    spec.vehicles = ids
        .iter()
        .zip(three.iter().cycle())
        .map(|(id, vehicle)| Vehicle {
            id: id.clone(),
            ..vehicle.clone()
        })
        .collect();
    let facts = facts(spec);
    let html = facts.html();
    fs::write(output().join("thousand.html"), &html).expect("a page");
    assert!(html.len() < 3_000_000, "{} bytes", html.len());
}

//! What the page shows where, in Chromium: nothing covers anything else.

use sortie::geodesy::Amsl;
use sortie::spec::{MissionSpec, Placement, Zone};
use sortie::verify::Limit;

use crate::browser::{TELL, in_chromium, root_of, told, with_script};
use crate::facts::{IDS, data_of, facts, hilly_spec};
use crate::support::place;

/// The widths of a desktop and of a phone.
const SIZES: [(&str, &str); 2] = [
    ("1280", "--window-size=1280,900"),
    ("390", "--window-size=390,844"),
];

/// A grid of 144 zones, of which every other one has a ceiling.
fn crowded() -> MissionSpec {
    let mut spec = hilly_spec(IDS);
    let side = |index: i32| f64::from(index) * 0.0125;
    spec.no_fly = (0..144)
        .map(|index| {
            let (south, west) = (36.225 + side(index / 12), -84.345 + side(index % 12) * 1.2);
            let corners = [
                (south, west),
                (south, west + 0.012),
                (south + 0.01, west + 0.012),
                (south + 0.01, west),
            ];
            Zone {
                id: format!("block-{index}"),
                polygon: corners.map(|(lat, lon)| place(lat, lon)).to_vec(),
                ceiling: (index % 2 == 0).then_some(Placement::Amsl(Amsl(900.0))),
                ..Zone::default()
            }
        })
        .collect();
    spec
}

#[test]
fn names_on_a_crowded_map_overlap_nowhere_and_the_tip_has_those_that_are_hidden() {
    let html = with_script(
        &facts(crowded()).html(),
        &format!(
            "{TELL} const texts = [...document.querySelectorAll('#plan text[data-at]')];
            const seen = texts.filter((text) => text.getAttribute('visibility') !== 'hidden');
            const boxes = seen.map((text) => text.getBoundingClientRect());
            const meet = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 3;
            const overlaps = boxes.flatMap((a, i) => boxes.slice(i + 1).filter((b) => meet(a, b))).length;
            const hidden = texts.filter((text) => !seen.includes(text));
            const figure = element('map').getBoundingClientRect(), matrix = element('plan').getScreenCTM();
            const named = hidden.filter((text) => {{
                const [x, y] = text.dataset.at.split(' ').map(Number), at = new DOMPoint(x, y).matrixTransform(matrix);
                element('map').dispatchEvent(new PointerEvent('pointermove', {{ clientX: at.x, clientY: at.y, pointerType: 'mouse' }}));
                return !element('tip').hidden && element('tip').textContent.split('\\n').includes(text.textContent);
            }}).length;
            tell({{ all: texts.length, seen: seen.length, overlaps, hidden: hidden.length, named }});"
        ),
    );
    for (width, size) in SIZES {
        let name = format!("crowded-{width}.html");
        let Some(dom) = in_chromium(&name, &html, &[size]) else {
            return;
        };
        assert!(!root_of(&dom).contains("data-error"), "{}", root_of(&dom));
        let told = told(&dom);
        assert_eq!(told["all"], 3 + 3 + 144, "{width}: {told}");
        assert_eq!(told["overlaps"], 0, "{width}: {told}");
        assert!(told["hidden"].as_u64() > Some(0), "{width}: {told}");
        assert_eq!(told["named"], told["hidden"], "{width}: {told}");
        assert!(told["seen"].as_u64() > Some(5), "{width}: {told}");
    }
}

#[test]
fn the_picture_has_the_names_of_the_obstacles_nearest_to_a_flight_and_titles_of_all() {
    let facts = facts(crowded());
    let svg = facts.svg();
    let written = svg.matches("data-obstacle=").count();
    assert!((5..147).contains(&written), "{written} names");
    for index in 0..144 {
        let title = format!(
            "<title>block-{index}{}</title>",
            match index % 2 {
                0 => " below 900 m AMSL",
                _ => "",
            }
        );
        assert_eq!(svg.matches(&title).count(), 1, "{title}");
    }
    assert_eq!(svg, facts.svg(), "the same bytes");
    let ordinary = crate::facts::facts(hilly_spec(IDS)).svg();
    assert_eq!(ordinary.matches("data-obstacle=").count(), 5);
    // The page places hidden ones after a zoom.
    assert_eq!(facts.html().matches("data-obstacle=").count(), 147);
}

#[test]
fn the_player_covers_neither_the_map_nor_the_model() {
    let html = with_script(
        &facts(hilly_spec(IDS)).html(),
        &format!(
            "{TELL} const box = (id) => element(id).getBoundingClientRect(), player = box('transport');
            const views = ['map', 'scene'].map(box).filter((view) => view.height);
            tell({{ covered: views.filter((view) => view.top < player.bottom && view.bottom > player.top).length,
                seen: views.length, height: player.height, wide: document.documentElement.scrollWidth - innerWidth }});"
        ),
    );
    for (width, size) in SIZES {
        let Some(dom) = in_chromium(&format!("player-{width}.html"), &html, &[size]) else {
            return;
        };
        let told = told(&dom);
        assert_eq!(told["covered"], 0, "{width}: {told}");
        assert!(told["seen"].as_u64() > Some(0), "{width}: {told}");
        assert!(told["height"].as_f64() > Some(20.0), "{width}: {told}");
        assert!(told["wide"].as_i64() <= Some(0), "{width}: {told}");
    }
}

#[test]
fn each_vehicle_has_its_three_tightest_limits_broken_ones_first_and_each_leads_to_its_moment() {
    let facts = facts(hilly_spec(IDS));
    let html = facts.html();
    let data = data_of(&html);
    let script = format!(
        "{TELL} const lists = [...document.querySelectorAll('.profile .tightest')].map((list) => [...list.querySelectorAll('button')].map((button) =>
            ({{ row: Number(button.dataset.row), bad: button.className === 'bad', text: button.textContent }})));
        const broken = document.querySelector('.tightest .bad');
        broken.click();
        tell({{ lists, t: state.t, mark: state.mark !== null, focus: state.focus, row: Number(broken.dataset.row) }});"
    );
    let Some(dom) = in_chromium("limits.html", &with_script(&html, &script), &[]) else {
        return;
    };
    assert!(!root_of(&dom).contains("data-error"), "{}", root_of(&dom));
    let told = told(&dom);
    let margins = data["margins"].as_array().expect("a list");
    let lists = told["lists"].as_array().expect("a list");
    assert_eq!(lists.len(), 3);
    for (vehicle, list) in lists.iter().enumerate() {
        let of_vehicle = |margin: &serde_json::Value| {
            let vehicles = margin["vehicles"].as_array().expect("indices");
            vehicles.iter().any(|of| *of == vehicle)
        };
        let rows = margins.iter().enumerate();
        let rows = rows.filter(|(_, margin)| of_vehicle(margin));
        let expected: Vec<usize> = rows.map(|(row, _)| row).take(3).collect();
        let shown = list.as_array().expect("buttons").iter();
        let shown: Vec<&serde_json::Value> = shown.map(|entry| &entry["row"]).collect();
        assert_eq!(shown, expected, "{told}");
    }
    let broken: Vec<_> = facts
        .review
        .margins
        .iter()
        .filter(|margin| !margin.ok)
        .collect();
    assert_eq!(broken[0].limit, Limit::TerrainClearance);
    let first = &lists[1][0];
    assert_eq!(first["bad"], true, "{told}");
    let text = first["text"].as_str().expect("text");
    assert!(
        text.starts_with("terrain clearance") && text.contains("at least"),
        "{text}"
    );
    assert_eq!(
        (&told["row"], &told["mark"], &told["focus"]),
        (&0.into(), &true.into(), &1.into())
    );
    let t_s = told["t"].as_f64().expect("a time");
    assert!(
        (t_s - broken[0].at.expect("a place").t_s).abs() < 0.01,
        "{told}"
    );
}

#[test]
fn entries_of_the_legend_stand_apart_whatever_their_length() {
    let long = "inspection-of-the-northern-lines-";
    let ids = [1, 2, 3].map(|number| format!("{long}{number}"));
    let svg = facts(hilly_spec(ids.each_ref().map(String::as_str))).svg();
    let (_, legend) = svg.rsplit_once("<g transform=").expect("a legend");
    let texts = legend.split("<text x=\"").skip(1);
    let ends: Vec<(f64, f64, f64)> = texts
        .map(|text| {
            let number = |text: &str| text.split('"').next().expect("a quote").parse::<f64>();
            let (x, y) = text.split_once(" y=\"").expect("y");
            let (before, _) = text.split_once("</text>").expect("an end");
            let letters = before
                .split('>')
                .skip(1)
                .filter_map(|part| part.split('<').next());
            let count = letters.map(|part| part.chars().count()).sum::<usize>();
            let count = f64::from(u16::try_from(count).expect("few"));
            let x = number(x).expect("a number");
            (x, number(y).expect("a number"), x + count * 8.5)
        })
        .collect();
    assert_eq!(ends.len(), 3);
    for pair in ends.windows(2) {
        let ((_, y, end), (x, next_y, _)) = (pair[0], pair[1]);
        assert!(next_y > y || x > end, "{ends:?}");
    }
}

//! The page in Chromium, without a network.

use std::fs;
use std::process::Command;

use sortie::geodesy::Amsl;
use sortie::spec::{Finish, TerrainSource};
use sortie::verify::{Limit, Margin, Moment, Review};

use crate::facts::{HOSTILE, IDS, data_of, facts, hilly_spec, output, passing};

/// What Chromium makes of a page: the document after its scripts ran, or none
/// where there is no Chromium (a failure with `SORTIE_REQUIRE_PEERS=1`).
pub(crate) fn in_chromium(name: &str, html: &str, flags: &[&str]) -> Option<String> {
    let page = output().join(name);
    fs::write(&page, html).expect("a page");
    let profile = tempfile::tempdir().expect("a folder for the profile");
    let run = Command::new("chromium")
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-background-networking",
        ])
        .args([
            "--use-gl=angle",
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
        ])
        .args(["--virtual-time-budget=3000", "--window-size=1280,900"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .args(flags)
        .arg("--dump-dom")
        .arg(format!("file://{}", page.display()))
        .output();
    match run {
        Ok(run) => {
            assert!(
                run.status.success(),
                "{}",
                String::from_utf8_lossy(&run.stderr)
            );
            Some(String::from_utf8(run.stdout).expect("UTF-8"))
        }
        Err(error) => {
            let required =
                std::env::var_os("SORTIE_REQUIRE_PEERS").is_some_and(|value| value == "1");
            assert!(!required, "chromium is required: {error}");
            #[expect(clippy::print_stdout, reason = "a skip must be seen")]
            {
                println!("skipped: no chromium ({error})");
            }
            None
        }
    }
}

/// The attributes of the root element of a dumped document.
pub(crate) fn root_of(dom: &str) -> &str {
    let (_, after) = dom.split_once("<html").expect("a root");
    after.split_once('>').expect("its end").0
}

pub(crate) fn with_script(html: &str, script: &str) -> String {
    html.replace(
        "</body>",
        &format!("<script>{{ {script} }}</script></body>"),
    )
}

/// Tells in the root element what was found.
pub(crate) const TELL: &str =
    "const tell = (found) => { document.documentElement.dataset.told = JSON.stringify(found); };";

pub(crate) fn told(dom: &str) -> serde_json::Value {
    let (_, after) = root_of(dom)
        .split_once("data-told=\"")
        .expect("the script told");
    let text = after
        .split_once('"')
        .expect("its end")
        .0
        .replace("&quot;", "\"");
    serde_json::from_str(&text).expect("JSON")
}

#[test]
fn the_page_draws_without_an_error_and_shows_the_relief() {
    let html = with_script(
        &facts(hilly_spec(IDS)).html(),
        &format!(
            "{TELL} scene3d.paint();
                const gl = element('gl').getContext('webgl2'), w = element('gl').width, h = element('gl').height;
                const pixels = new Uint8Array(w * h * 4);
                gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
                const colours = new Set();
                for (let i = 0; i < pixels.length; i += 4) colours.add(pixels[i] << 16 | pixels[i + 1] << 8 | pixels[i + 2]);
                tell({{ colours: colours.size, fault: gl.getError(),
                    charts: document.querySelectorAll('svg.chart').length }});"
        ),
    );
    let Some(dom) = in_chromium("draws.html", &html, &[]) else {
        return;
    };
    let root = root_of(&dom);
    assert!(
        root.contains("data-ready=\"3d\"") && !root.contains("data-error"),
        "{root}"
    );
    let told = told(&dom);
    assert!(told["colours"].as_u64().expect("a count") > 500, "{told}");
    assert_eq!(told["fault"], 0);
    assert_eq!(told["charts"], 4, "three profiles and the separation");
}

#[test]
fn a_profile_out_and_home_has_its_band_throughout_and_numbers_that_differ() {
    let mut spec = hilly_spec(IDS);
    spec.vehicles[0].finish = Finish::Return;
    spec.vehicles[0].home = spec.vehicles[0].start.place;
    let mut facts = facts(spec);
    // Home on the way it came, and nearer to the start than before.
    let moments = &mut facts.review.tracks[0].moments;
    moments.pop();
    let turn = moments[moments.len() - 1];
    let home: Vec<_> = moments.iter().rev().skip(1).copied().collect();
    moments.extend(home.into_iter().map(|moment| Moment {
        t_s: 2.0 * turn.t_s - moment.t_s,
        item: turn.item + 1,
        ..moment
    }));
    let html = with_script(
        &facts.html(),
        &format!(
            "{TELL} const profile = document.querySelector('.profile'), wide = (kind) => profile.querySelector(kind).getBBox().width;
            const numbers = [...profile.querySelectorAll('text[text-anchor=middle]')].map((text) => text.textContent).slice(0, 5);
            tell({{ band: wide('.band') / wide('.line'), distinct: new Set(numbers).size }});"
        ),
    );
    let Some(dom) = in_chromium("home.html", &html, &[]) else {
        return;
    };
    let told = told(&dom);
    assert!(told["band"].as_f64().expect("a share") > 0.95, "{told}");
    assert_eq!(told["distinct"], 5, "{told}");
}

#[test]
fn clicking_a_margin_leads_to_its_place_and_time() {
    let facts = facts(hilly_spec(IDS));
    let broken: Vec<&Margin> = facts
        .review
        .margins
        .iter()
        .filter(|margin| !margin.ok)
        .collect();
    assert_eq!(broken.len(), 1);
    let at = broken[0].at.expect("a place");
    let html = with_script(
        &facts.html(),
        &format!(
            "{TELL} const row = document.querySelector('#margins tbody tr');
            row.click();
            const jumped = {{ t: state.t, focus: state.focus, mark: state.mark, chosen: row.className }};
            const heads = document.querySelectorAll('#margins th button'), first = () => document.querySelector('#margins tbody tr').cells[1].textContent;
            heads[1].click();
            const up = first();
            heads[1].click();
            const down = first();
            element('broken-only').click();
            const shown = [...document.querySelectorAll('#margins tbody tr')].filter((row) => row.offsetHeight).length;
            document.querySelector('.chip').click();
            const before = element('exaggerate').textContent;
            element('exaggerate').click();
            element('play').click();
            tick(1000);
            tick(1500);
            tell({{ jumped, up, down, shown, focus: state.focus, moved: state.t - jumped.t,
                other: before !== element('exaggerate').textContent }});"
        ),
    );
    let Some(dom) = in_chromium("clicks.html", &html, &[]) else {
        return;
    };
    assert!(!root_of(&dom).contains("data-error"), "{}", root_of(&dom));
    let told = told(&dom);
    let t_s = told["jumped"]["t"].as_f64().expect("a time");
    assert!((t_s - at.t_s).abs() < 0.01, "{told}");
    assert_eq!(told["jumped"]["focus"], 1);
    let east_m = told["jumped"]["mark"]["e"].as_f64().expect("a place");
    assert!((east_m - facts.world.frame.to_plan(at.place).east_m).abs() < 0.01);
    assert_eq!(told["jumped"]["chosen"], "bad chosen");
    assert_eq!(
        (&told["up"], &told["down"]),
        (&"alpha".into(), &"charlie".into())
    );
    assert_eq!(
        (&told["shown"], &told["focus"], &told["other"]),
        (&1.into(), &0.into(), &true.into())
    );
    // Half a second at the default of 30 times.
    assert!(
        (told["moved"].as_f64().expect("seconds") - 15.0).abs() < 0.01,
        "{told}"
    );
}

#[test]
fn the_slider_moves_the_clock_and_every_cursor_and_no_limit_is_drawn_that_was_not_held() {
    let with_limit = facts(hilly_spec(IDS));
    let mut without = facts(hilly_spec(IDS));
    without
        .review
        .margins
        .retain(|margin| margin.limit != Limit::Separation);
    for (name, facts, limits) in [
        ("slider.html", with_limit, 1),
        ("no-limit.html", without, 0),
    ] {
        let html = with_script(
            &facts.html(),
            &format!(
                "{TELL} const seen = () => [...document.querySelectorAll('svg .cursor')].map((path) => path.getAttribute('d'));
                const slide = (share) => {{ const slider = element('time');
                    slider.value = state.first + (state.last - state.first) * share;
                    slider.dispatchEvent(new Event('input')); return [element('clock').textContent, ...seen()]; }};
                const early = slide(0.2), late = slide(0.6);
                tell({{ share: (state.t - state.first) / (state.last - state.first), cursors: early.length - 1,
                    still: early.filter((text, index) => text === late[index]).length,
                    limits: document.querySelectorAll('#separation .limit').length,
                    lines: document.querySelectorAll('#separation .line').length }});"
            ),
        );
        let Some(dom) = in_chromium(name, &html, &[]) else {
            return;
        };
        let root = root_of(&dom);
        assert!(!root.contains("data-error"), "{name}: {root}");
        let told = told(&dom);
        let share = told["share"].as_f64().expect("a share");
        assert!((share - 0.6).abs() < 1e-6, "{name}: {told}");
        assert_eq!((&told["cursors"], &told["still"]), (&4.into(), &0.into()));
        assert_eq!(told["limits"], limits, "{name}: {told}");
        assert_eq!(told["lines"], 6, "{name}: three pairs, two colours each");
    }
}

#[test]
fn without_webgl_the_map_and_the_charts_are_there_and_a_note_says_so() {
    let html = with_script(
        &facts(hilly_spec(IDS)).html(),
        &format!(
            "{TELL} tell({{ note: !element('no-gl').hidden, map: element('plan').getBoundingClientRect().width > 100,
                charts: document.querySelectorAll('svg.chart').length, moving: element('moving').children.length }});"
        ),
    );
    let Some(dom) = in_chromium("flat.html", &html, &["--disable-3d-apis"]) else {
        return;
    };
    let root = root_of(&dom);
    assert!(
        root.contains("data-ready=\"2d\"") && !root.contains("data-error"),
        "{root}"
    );
    let expected = serde_json::json!({ "note": true, "map": true, "charts": 4, "moving": 4 });
    assert_eq!(told(&dom), expected);
}

#[test]
fn hostile_names_stay_text() {
    let mut spec = hilly_spec(HOSTILE);
    spec.name = HOSTILE[1].to_owned();
    spec.threats[1].id = HOSTILE[0].to_owned();
    let mut facts = facts(spec);
    facts.review.assumptions.push(HOSTILE[2].to_owned());
    facts.review.margins[2].note = HOSTILE[0].to_owned();
    facts.review.margins[2].limit = Limit::Threat(HOSTILE[1].to_owned());
    let html = facts.html();
    assert_eq!(data_of(&html)["scene"]["vehicles"][0]["id"], HOSTILE[0]);
    let html = with_script(
        &html,
        &format!(
            "{TELL} tell({{ broken: window.broken ?? 0, images: document.images.length,
                name: document.querySelector('h1').textContent, chip: document.querySelector('.chip').textContent }});"
        ),
    );
    let Some(dom) = in_chromium("hostile.html", &html, &[]) else {
        return;
    };
    assert!(!root_of(&dom).contains("data-error"), "{}", root_of(&dom));
    let (_, after) = dom.split_once("data-told=").expect("the script told");
    assert!(
        after.starts_with("\"{&quot;broken&quot;:0,&quot;images&quot;:0,"),
        "{}",
        &after[..200]
    );
}

#[test]
fn pages_of_every_size_and_verdict_run_without_an_error() {
    let whole = facts(hilly_spec(IDS));
    fs::write(output().join("review.svg"), whole.svg()).expect("a picture");
    let mut empty = facts(hilly_spec(IDS));
    empty.review = Review::default();
    empty.plan.vehicles.clear();
    empty.missions.clear();
    let mut alone = hilly_spec(IDS);
    alone.vehicles.truncate(1);
    alone.threats.clear();
    alone.no_fly.clear();
    alone.terrain = TerrainSource::Flat(Amsl(400.0));
    let mut absurd = facts(hilly_spec(IDS));
    absurd.spec.name = "absurd".to_owned();
    absurd.review.margins[0].value = 1e308;
    absurd.review.margins[1].bound = -1e308;
    absurd.world.threats[0].radius_m = 1e300;
    absurd.spec.separation.distance_m = 1e308;
    let html = absurd.html();
    let digits = |text: &str| text.len() > 40 && text.bytes().all(|b| b.is_ascii_digit());
    assert!(
        !html.split(|c: char| !c.is_ascii_alphanumeric()).any(digits),
        "a number of hundreds of digits"
    );
    let pages = [
        ("absurd.html", absurd),
        ("fail.html", facts(hilly_spec(IDS))),
        ("pass.html", passing(whole)),
        ("empty.html", empty),
        ("alone.html", facts(alone)),
    ];
    for (name, facts) in pages {
        let Some(dom) = in_chromium(name, &facts.html(), &[]) else {
            return;
        };
        let root = root_of(&dom);
        assert!(
            root.contains("data-ready=\"3d\"") && !root.contains("data-error"),
            "{name}: {root}"
        );
    }
}

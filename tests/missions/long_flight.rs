//! What the page of a long flight shows of it.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss
)]

use std::fs;

use serde_json::Value;
use sortie::geodesy::{LatLon, LocalFrame};

use crate::support::command::{sortie, text};

/// East, north, altitude (m) at a time (s).
#[derive(Clone, Copy, Debug)]
struct Fix([f64; 3], f64);

fn between(from: Fix, to: Fix, share: f64) -> [f64; 3] {
    std::array::from_fn(|axis| from.0[axis] + share * (to.0[axis] - from.0[axis]))
}

fn apart_m(a: [f64; 3], b: [f64; 3]) -> f64 {
    let square = |axis: usize| (a[axis] - b[axis]).powi(2);
    (square(0) + square(1) + square(2)).sqrt()
}

fn to_leg_m(point: [f64; 3], from: Fix, to: Fix) -> f64 {
    let along: [f64; 3] = std::array::from_fn(|axis| to.0[axis] - from.0[axis]);
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let gone = std::array::from_fn(|axis| point[axis] - from.0[axis]);
    let share = dot(gone, along) / dot(along, along).max(1e-12);
    apart_m(point, between(from, to, share.clamp(0.0, 1.0)))
}

/// What is drawn, and what is flown, of one mission.
struct Shown {
    drawn: Vec<Fix>,
    /// The item at each fix that is drawn.
    items: Vec<u64>,
    within_m: f64,
    flown: Vec<[Fix; 2]>,
    /// The row of the vehicle in the table, and the caption of the picture.
    page: String,
}

impl Shown {
    fn of(file: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("m.waypoints"), file).expect("written");
        let output = sortie(
            folder.path(),
            &[
                "review",
                "m.waypoints",
                "--no-terrain",
                "--airframe",
                "copter",
                "--html",
                "p.html",
                "--trajectories",
                "t.json",
            ],
        );
        let said = text(&output.stdout) + &text(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{said}");
        let read = |name: &str| fs::read_to_string(folder.path().join(name)).expect("a file");
        let page = read("p.html");
        let data = data_of(&page);
        let scene = &data["scene"];
        let number = |value: &Value| value.as_f64().expect("a number");
        let origin = LatLon::new(number(&scene["origin"][0]), number(&scene["origin"][1]));
        let frame = LocalFrame::new(origin.expect("an origin"));
        let vehicle = &scene["vehicles"][0];
        let column = |name: &str| -> Vec<f64> {
            let values = vehicle["track"][name].as_array().expect("a column");
            values.iter().map(number).collect()
        };
        let [e, n, z, t] = ["e", "n", "z", "t"].map(column);
        let drawn = (0..e.len()).map(|at| Fix([e[at], n[at], z[at]], t[at]));
        let trajectories: Value = serde_json::from_str(&read("t.json")).expect("JSON");
        let segments = trajectories["vehicles"][0]["segments"].as_array();
        let fix = |at: &Value| {
            let place = LatLon::new(number(&at["lat_deg"]), number(&at["lon_deg"]));
            let at_plan = frame.to_plan(place.expect("a place"));
            let amsl_m = number(&at["amsl_m"]);
            Fix(
                [at_plan.east_m, at_plan.north_m, amsl_m],
                number(&at["t_s"]),
            )
        };
        // Others are where it may be instead.
        let flown = segments.expect("segments").iter();
        let flown = flown.filter(|segment| segment["flown"] == true);
        Self {
            drawn: drawn.collect(),
            items: column("item").into_iter().map(|item| item as u64).collect(),
            within_m: number(&vehicle["drawn_within_m"]),
            flown: flown
                .map(|segment| [fix(&segment["from"]), fix(&segment["to"])])
                .collect(),
            page: page.clone(),
        }
    }

    /// The largest distance of the flown motion from what is drawn about that time, metres.
    fn worst_m(&self) -> f64 {
        let mut at = 0;
        let mut worst_m: f64 = 0.0;
        for [from, to] in &self.flown {
            let steps = 1 + (apart_m(from.0, to.0) / 5.0) as usize;
            for step in 0..=steps {
                let share = step as f64 / steps as f64;
                let time_s = from.1 + share * (to.1 - from.1);
                while at + 2 < self.drawn.len() && self.drawn[at + 1].1 < time_s {
                    at += 1;
                }
                // Times are drawn in tenths of a second.
                let around = self.drawn[at.saturating_sub(2)..].windows(2).take(5);
                let flown = between(*from, *to, share);
                let near_m = around.map(|leg| to_leg_m(flown, leg[0], leg[1]));
                worst_m = worst_m.max(near_m.fold(f64::INFINITY, f64::min));
            }
        }
        worst_m
    }

    fn length_m(&self) -> f64 {
        self.flown
            .iter()
            .map(|[from, to]| apart_m(from.0, to.0))
            .sum()
    }

    fn highest_m(fixes: impl Iterator<Item = Fix>) -> f64 {
        fixes.map(|fix| fix.0[2]).fold(f64::NEG_INFINITY, f64::max)
    }

    fn hours(&self) -> f64 {
        self.flown.last().expect("segments")[1].1 / 3600.0
    }
}

/// What a page draws.
fn data_of(page: &str) -> Value {
    let (_, data) = page.split_once("id=\"data\">").expect("the data");
    let (data, _) = data.split_once("</script>").expect("its end");
    serde_json::from_str(data).expect("JSON")
}

fn rows(items: &[String]) -> String {
    let mut file = String::from(
        "QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t46.0\t8.0\t500\t1\n1\t0\t3\t22\t0\t0\t0\t0\t0\t0\t60\t1\n2\t0\t2\t178\t1\t5\t-1\t0\t0\t0\t0\t1\n",
    );
    for (index, item) in items.iter().enumerate() {
        file += &format!("{}\t0\t{item}\t1\n", index + 3);
    }
    file + &format!(
        "{}\t0\t3\t21\t0\t0\t0\t0\t46.001\t8.0\t0\t1\n",
        items.len() + 3
    )
}

fn waypoint(lat: f64, lon: f64, above_home_m: f64) -> String {
    format!("3\t16\t0\t0\t0\t0\t{lat:.7}\t{lon:.7}\t{above_home_m}")
}

/// Lines of 3 km, 25 m apart, one of them with a short peak.
fn survey() -> String {
    let mut items = Vec::new();
    for line in 0..118_u32 {
        let lat = 46.001 + f64::from(line) * 0.000_225;
        let lons = [8.001, 8.040];
        let [from, to] = if line % 2 == 0 {
            lons
        } else {
            [lons[1], lons[0]]
        };
        items.push(waypoint(lat, from, 60.0));
        if line == 61 {
            items.push(waypoint(lat, 8.02, 60.0));
            items.push(waypoint(lat, 8.019_9, 75.0));
            items.push(waypoint(lat, 8.019_8, 60.0));
        }
        items.push(waypoint(lat, to, 60.0));
    }
    rows(&items)
}

#[test]
fn a_survey_of_twenty_hours_is_drawn_with_every_item_corner_and_extreme() {
    let shown = Shown::of(&survey());
    assert!((19.0..24.0).contains(&shown.hours()), "{} h", shown.hours());
    let items = survey().lines().count() as u64 - 2;
    for item in 1..=items {
        // A change of speed takes no time and no place.
        assert!(item == 2 || shown.items.contains(&item), "item {item}");
    }
    let flown_m = Shown::highest_m(shown.flown.iter().flatten().copied());
    let drawn_m = Shown::highest_m(shown.drawn.iter().copied());
    assert!(
        (flown_m - drawn_m).abs() < 0.1 && flown_m > 570.0,
        "{flown_m} {drawn_m}"
    );
    let worst_m = shown.worst_m();
    assert!(worst_m <= shown.within_m, "{worst_m} {}", shown.within_m);
    assert!(shown.within_m < 0.5, "{}", shown.within_m);
    let length = format!("{:.2} km", shown.length_m() / 1000.0);
    assert!(shown.length_m() > 350_000.0, "{length}");
    assert!(shown.page.contains(&length), "{length}");
}

/// Turns by the thousand: more corners than a page has.
#[test]
fn a_drawing_that_has_to_be_coarse_says_how_coarse_it_is() {
    let mut items = Vec::new();
    for circle in 0..12_u32 {
        let lat = 46.002 + f64::from(circle) * 0.004;
        items.push(format!("3\t18\t100\t0\t120\t0\t{lat:.7}\t8.0000000\t60"));
    }
    let shown = Shown::of(&rows(&items));
    assert!(shown.flown.len() > 20_000, "{}", shown.flown.len());
    assert!(shown.drawn.len() < 7_000, "{}", shown.drawn.len());
    let worst_m = shown.worst_m();
    assert!(worst_m <= shown.within_m, "{worst_m} {}", shown.within_m);
    assert!(
        worst_m > 0.2 * shown.within_m,
        "{worst_m} {}",
        shown.within_m
    );
    let length = format!("{:.2} km", shown.length_m() / 1000.0);
    assert!(shown.page.contains(&length), "{length}");
}

#[test]
fn a_mission_whose_first_item_is_unknown_still_shows_its_waypoints() {
    let mut items: Vec<String> = survey().lines().skip(4).map(str::to_owned).collect();
    items.truncate(40);
    let file = format!(
        "QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t46.0\t8.0\t500\t1\n1\t0\t3\t31999\t0\t0\t0\t0\t0\t0\t0\t1\n2\t0\t3\t22\t0\t0\t0\t0\t46.0\t8.0\t60\t1\n{}\n",
        items.join("\n")
    );
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("m.waypoints"), file).expect("written");
    let flags = ["--no-terrain", "--airframe", "copter", "--html", "p.html"];
    let output = sortie(
        folder.path(),
        &[&["review", "m.waypoints"][..], &flags].concat(),
    );
    let said = text(&output.stdout) + &text(&output.stderr);
    assert_eq!(output.status.code(), Some(4), "{said}");
    assert!(said.contains("cannot judge from item 1 on"), "{said}");
    let page = fs::read_to_string(folder.path().join("p.html")).expect("a page");
    let data = data_of(&page);
    let vehicle = &data["scene"]["vehicles"][0];
    let shown = vehicle["waypoints"].as_array().expect("waypoints");
    assert_eq!(shown.len(), 41);
    assert_eq!(shown[40][3], 42);
    // On the picture, where nothing is flown, each waypoint has its dot.
    let (_, dots) = page.split_once("class=\"dots v0\"").expect("dots");
    let (dots, _) = dots.split_once("/>").expect("their end");
    assert_eq!(dots.matches("h0").count(), 41);
    let (_, fleet) = page.split_once("id=\"fleet\"").expect("the table");
    let (fleet, _) = fleet.split_once("</table>").expect("its end");
    assert!(fleet.contains(">42<"), "{fleet}");
}

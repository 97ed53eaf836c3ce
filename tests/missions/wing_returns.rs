//! Returns of wings, and turns back, against places that real ones flew.

use std::fs;

use serde_json::Value;

use crate::judged::judged;
use crate::support::command::{sortie, text};

/// Metres for a degree of latitude and of longitude, at 35.3633 degrees south.
const METRES: [f64; 2] = [110_950.0, 90_788.8];
const HOME: [f64; 3] = [-35.3633, 149.16, 584.0];

fn row(number: usize, command: u16, params: [f64; 4], at: [f64; 2], up_m: f64) -> String {
    let [east_m, north_m] = at;
    let (lat, lon) = (HOME[0] + north_m / METRES[0], HOME[1] + east_m / METRES[1]);
    let [a, b, c, d] = params;
    let (current, frame) = if number == 0 { (1, 0) } else { (0, 3) };
    format!(
        "{number}\t{current}\t{frame}\t{command}\t{a}\t{b}\t{c}\t{d}\t{lat:.7}\t{lon:.7}\t{up_m}\t1\n"
    )
}

/// East, north and up from home of both ends of all that is judged of a plane.
fn flown(mission: &str, params: &str) -> Vec<[[f64; 3]; 2]> {
    let judged = judged(mission, params, &["--airframe", "plane"]);
    assert_eq!(judged.code, Some(0), "{}", judged.said);
    let end = |segment: &Value, end: &str| {
        let value = |key: &str| segment[end][key].as_f64().expect("a number");
        [
            (value("lon_deg") - HOME[1]) * METRES[1],
            (value("lat_deg") - HOME[0]) * METRES[0],
            value("amsl_m") - HOME[2],
        ]
    };
    let segments = judged.segments.iter();
    segments.map(|s| [end(s, "from"), end(s, "to")]).collect()
}

/// How far beside a segment a place is, and the height of the segment there.
fn beside(place: [f64; 3], [from, to]: [[f64; 3]; 2]) -> (f64, f64) {
    let along = [to[0] - from[0], to[1] - from[1]];
    let gone = [place[0] - from[0], place[1] - from[1]];
    let square = along[0] * along[0] + along[1] * along[1];
    let share = ((gone[0] * along[0] + gone[1] * along[1]) / square.max(1e-9)).clamp(0.0, 1.0);
    let off = [gone[0] - share * along[0], gone[1] - share * along[1]];
    (off[0].hypot(off[1]), from[2] + share * (to[2] - from[2]))
}

/// `ArduPlane` 4.7.0-beta1, simulated, still air: from its turn it flies straight home and climbs at once, up to
/// 89 m beside the leg and 56 m above it.
#[test]
fn a_wing_returns_straight_from_its_turn_and_climbs_at_once() {
    let mission = [
        "QGC WPL 110\n".to_owned(),
        row(0, 16, [0.0; 4], [0.0, 0.0], HOME[2]),
        row(1, 22, [10.0, 0.0, 0.0, 0.0], [0.0, 300.0], 60.0),
        row(2, 16, [0.0; 4], [0.0, 1200.0], 80.0),
        row(3, 16, [0.0; 4], [600.0, 1800.0], 80.0),
        row(4, 20, [0.0; 4], [0.0, 0.0], 0.0),
    ];
    let params = "AIRSPEED_CRUISE,22\nAIRSPEED_MIN,10\nAIRSPEED_MAX,30\nROLL_LIMIT_DEG,45\nNAVL1_PERIOD,17\n\
         NAVL1_DAMPING,0.75\nWP_LOITER_RAD,100\nWP_RADIUS,60\nTECS_CLMB_MAX,5\nTECS_SINK_MAX,5\nRTL_ALTITUDE,150\nRTL_RADIUS,150\n";
    let judged = flown(&mission.concat(), params);
    for place in [
        [642.0, 1772.0, 89.0],
        [681.0, 1695.0, 105.0],
        [661.0, 1608.0, 124.0],
        [629.0, 1522.0, 142.0],
        [593.0, 1434.0, 149.0],
        [521.0, 1259.0, 151.0],
        [450.0, 1085.0, 150.0],
        [342.0, 824.0, 150.0],
        [234.0, 563.0, 150.0],
    ] {
        let near = judged.iter().map(|segment| beside(place, *segment));
        let heights = near
            .filter(|(beside_m, _)| *beside_m < 15.0)
            .map(|(_, up_m)| up_m);
        let (low_m, high_m) = heights
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), up_m| {
                (low.min(up_m), high.max(up_m))
            });
        assert!(
            low_m - 15.0 < place[2] && place[2] < high_m + 15.0,
            "{place:?}: {low_m} to {high_m}"
        );
    }
}

/// It turned back only at its place, where the verdict in time has it turn halfway along its leg: another one
/// that circles around that place was 1780 m away by that.
#[test]
fn wings_whose_turns_do_not_fit_are_not_passed_where_separation_is_judged() {
    let folder = tempfile::tempdir().expect("a folder");
    let back = [
        "QGC WPL 110\n".to_owned(),
        row(0, 16, [0.0; 4], [0.0, 0.0], HOME[2]),
        row(1, 22, [10.0, 0.0, 0.0, 0.0], [0.0, 300.0], 60.0),
        row(2, 16, [0.0; 4], [0.0, 1200.0], 80.0),
        row(3, 16, [0.0; 4], [1500.0, 2700.0], 80.0),
        row(4, 16, [0.0; 4], [0.0, 1200.0], 80.0),
        row(5, 17, [0.0, 0.0, 100.0, 0.0], [-1500.0, 1200.0], 80.0),
    ];
    let circling = [
        "QGC WPL 110\n".to_owned(),
        row(0, 16, [0.0; 4], [1500.0, 1600.0], HOME[2]),
        row(1, 22, [10.0, 0.0, 0.0, 0.0], [1500.0, 1900.0], 60.0),
        row(2, 17, [0.0, 0.0, 100.0, 0.0], [1500.0, 2700.0], 80.0),
    ];
    let params =
        "AIRSPEED_CRUISE,22\nAIRSPEED_MIN,10\nAIRSPEED_MAX,30\nROLL_LIMIT_DEG,45\nWP_RADIUS,60\n";
    for (name, rows) in [("a", &back[..]), ("b", &circling[..])] {
        let path = |ending: &str| folder.path().join(format!("{name}.{ending}"));
        fs::write(path("waypoints"), rows.concat()).expect("written");
        fs::write(path("params"), params).expect("written");
    }
    let always = ["review", "--no-terrain", "--airframe", "plane"];
    let reviewed = |more: &[&str]| {
        let output = sortie(folder.path(), &[&always[..], more].concat());
        let said = text(&output.stdout) + &text(&output.stderr);
        (output.status.code(), said)
    };
    let (code, said) = reviewed(&["a.waypoints", "b.waypoints", "--separation", "50"]);
    assert_eq!(code, Some(4), "{said}");
    assert!(said.contains("FAIL a: turn fit"), "{said}");
    // In space alone its turns are judged on the way that it flies.
    let (code, said) = reviewed(&["a.waypoints"]);
    assert_eq!(code, Some(0), "{said}");
}

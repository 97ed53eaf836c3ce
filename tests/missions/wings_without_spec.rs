//! `sortie review` of a wing's mission without a spec: by which altitudes and rates it is judged.

use serde_json::Value;

use crate::judged::{Judged, judged};

/// A plane's mission at 46 degrees north that climbs out to the north and goes round a square.
fn mission(takeoff_m: u32) -> String {
    let row = |number: u32, command: u32, north_m: f64, east_m: f64, up_m: u32| {
        let (lat, lon) = (46.0 + north_m / 111_147.0, 8.0 + east_m / 77_460.0);
        let (current, frame) = if number == 0 { (1, 0) } else { (0, 3) };
        format!(
            "{number}\t{current}\t{frame}\t{command}\t0\t0\t0\t0\t{lat:.7}\t{lon:.7}\t{up_m}\t1\n"
        )
    };
    [
        "QGC WPL 110\n".to_owned(),
        row(0, 16, 0.0, 0.0, 500),
        row(1, 22, 900.0, 0.0, takeoff_m),
        row(2, 16, 2000.0, 0.0, takeoff_m),
        row(3, 16, 2000.0, 1500.0, takeoff_m),
        row(4, 17, 500.0, 1500.0, takeoff_m),
    ]
    .concat()
}

fn plane(autopilot: &str, flags: &[&str]) -> Judged {
    let of = ["--airframe", "plane", "--autopilot", autopilot];
    judged(&mission(100), "", &[&of, flags].concat())
}

/// Metres climbed a second on the first motion that leaves the ground for 100 m.
fn climb_out_mps(judged: &Judged) -> f64 {
    let number = |segment: &Value, end: &str, key: &str| segment[end][key].as_f64();
    let climb = judged.segments.iter().find_map(|segment| {
        let [low_m, top_m] = ["from", "to"].map(|end| number(segment, end, "amsl_m"));
        let [from_s, to_s] = ["from", "to"].map(|end| number(segment, end, "t_s"));
        let (low_m, top_m, from_s, to_s) = (low_m?, top_m?, from_s?, to_s?);
        let is_climb = low_m < 501.0 && top_m > 599.0 && segment["flown"] == true;
        is_climb.then(|| (top_m - low_m) / (to_s - from_s))
    });
    climb.unwrap_or_else(|| panic!("no climb-out: {}", judged.said))
}

#[test]
fn a_wing_is_judged_at_the_speeds_of_the_highest_place_of_its_mission() {
    for autopilot in ["ardupilot", "px4"] {
        let (open, given) = (
            plane(autopilot, &[]),
            plane(autopilot, &["--max-amsl", "600"]),
        );
        assert!(!open.segments.is_empty(), "{autopilot}: {}", open.said);
        assert_eq!(open.segments, given.segments, "{autopilot}");
        // What is wider at a ceiling that the mission never comes to.
        let high = plane(autopilot, &["--max-amsl", "20000"]);
        assert_ne!(open.segments, high.segments, "{autopilot}");
    }
}

#[test]
fn a_plane_climbs_out_with_the_rate_of_its_parameters() {
    let ardupilot = plane("ardupilot", &[]);
    let mps = climb_out_mps(&ardupilot);
    assert!((4.5..=5.0).contains(&mps), "TECS_CLMB_MAX 5: {mps}");
    for flags in [&[][..], &["--max-amsl", "700"]] {
        let px4 = plane("px4", flags);
        let mps = climb_out_mps(&px4);
        assert!((2.7..=3.0).contains(&mps), "FW_T_CLMB_R_SP 3: {mps}");
        assert!(!px4.said.contains("FAIL m: climb speed"), "{}", px4.said);
    }
    let of = ["--airframe", "plane", "--autopilot", "px4"];
    let mps = climb_out_mps(&judged(&mission(100), "FW_T_CLMB_R_SP,2\n", &of));
    assert!((1.8..=2.0).contains(&mps), "FW_T_CLMB_R_SP 2: {mps}");
    let stated = plane("px4", &["--climb", "4"]);
    let mps = climb_out_mps(&stated);
    assert!((3.6..=4.0).contains(&mps), "--climb 4: {mps}");
}

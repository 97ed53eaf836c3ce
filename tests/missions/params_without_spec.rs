//! `sortie review` without a spec, of a mission with its parameters next to it.

use std::fs;

use serde_json::Value;

use crate::judged::judged;
use crate::support::command::{sortie, text};

const RETURN: &str = "QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t46.0\t8.0\t500\t1\n1\t0\t3\t22\t0\t0\t0\t0\t0\t0\t50\t1\n2\t0\t3\t16\t0\t0\t0\t0\t46.01\t8.0\t50\t1\n3\t0\t3\t20\t0\t0\t0\t0\t0\t0\t0\t1\n";

/// The return as PX4 takes it, from a place at this latitude.
fn for_px4(lat: &str) -> String {
    let mission = RETURN
        .replace("46.01", lat)
        .replace("3\t0\t3\t20", "3\t0\t2\t20");
    mission.replace(
        "1\t0\t3\t22\t0\t0\t0\t0\t0\t0",
        "1\t0\t3\t22\t0\t0\t0\t0\t46.0\t8.0",
    )
}

/// Exit code and all that is said of the return with these parameters and flags.
fn review(params: &str, flags: &[&str]) -> (Option<i32>, String) {
    let (code, said, _) = flown(params, flags);
    (code, said)
}

/// One motion of a trajectory, places in metres near 46 degrees north.
struct Segment {
    from_t_s: f64,
    to_t_s: Option<f64>,
    to_amsl_m: f64,
    run_m: [f64; 3],
    flown: bool,
}

impl Segment {
    fn of(segment: &Value) -> Self {
        let number = |end: &str, key: &str| segment[end][key].as_f64();
        let change = |key: &str| {
            let [from, to] = ["from", "to"].map(|end| number(end, key).expect("a number"));
            to - from
        };
        Self {
            from_t_s: number("from", "t_s").expect("a time"),
            to_t_s: number("to", "t_s"),
            to_amsl_m: number("to", "amsl_m").expect("an altitude"),
            run_m: [
                change("lat_deg") * 111_147.0,
                change("lon_deg") * 77_460.0,
                change("amsl_m"),
            ],
            flown: segment["flown"].as_bool().expect("whether"),
        }
    }

    fn length_m(&self) -> f64 {
        self.run_m
            .iter()
            .map(|run_m| run_m * run_m)
            .sum::<f64>()
            .sqrt()
    }
}

/// The same, with the trajectory that was judged.
fn flown(params: &str, flags: &[&str]) -> (Option<i32>, String, Vec<Segment>) {
    flown_from(RETURN, params, flags)
}

fn flown_from(mission: &str, params: &str, flags: &[&str]) -> (Option<i32>, String, Vec<Segment>) {
    let is_given = flags.contains(&"--airframe");
    let airframe: &[&str] = if is_given {
        &[]
    } else {
        &["--airframe", "copter"]
    };
    let judged = judged(mission, params, &[airframe, flags].concat());
    let segments = judged.segments.iter().map(Segment::of).collect();
    (judged.code, judged.said, segments)
}

#[test]
fn a_return_is_judged_at_the_altitude_of_the_parameters_next_to_the_mission() {
    let ceiling = ["--max-amsl", "600"];
    let (code, said) = review("RTL_ALT,30000\n", &ceiling);
    assert_eq!(code, Some(4), "{said}");
    assert!(said.contains("800.0 m"), "{said}");
    assert!(!said.contains("RTL_ALT 1500"), "{said}");
    let (code, said) = review("RTL_ALT,8000\n", &ceiling);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("580.0 m"), "{said}");
    // What the file does not hold is still assumed, and said.
    assert!(said.contains("RTL_LOIT_TIME 5000"), "{said}");
    let (code, said) = review("not a parameter\n", &ceiling);
    assert_eq!(code, Some(3), "{said}");
}

#[test]
fn a_return_is_judged_by_the_names_and_metres_of_arducopter_4_7() {
    let ceiling = ["--max-amsl", "600"];
    let (code, said) = review("RTL_ALT_M,300\n", &ceiling);
    assert_eq!(code, Some(4), "{said}");
    assert!(
        said.contains("800.0 m") && !said.contains("RTL_ALT 1500"),
        "{said}"
    );
    let (code, said) = review("RTL_ALT_M,80\n", &ceiling);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("580.0 m"), "{said}");
}

/// `ModeRTL::compute_return_target`.
#[test]
fn a_return_climbs_by_the_least_climb_and_stays_below_the_fence_of_the_parameters() {
    let ceiling = ["--max-amsl", "900"];
    for (params, top) in [
        ("RTL_ALT,1000\nRTL_CLIMB_MIN,10000\n", "650.0 m"),
        ("RTL_ALT_M,10\nRTL_CLIMB_MIN_M,100\n", "650.0 m"),
        (
            "RTL_ALT,8000\nFENCE_ENABLE,1\nFENCE_ALT_MAX,60\nFENCE_TYPE,5\n",
            "558.0 m",
        ),
        (
            "RTL_ALT,8000\nFENCE_ENABLE,1\nFENCE_ALT_MAX,60\nFENCE_TYPE,4\n",
            "580.0 m",
        ),
        (
            "RTL_ALT,8000\nFENCE_ENABLE,0\nFENCE_ALT_MAX,60\n",
            "580.0 m",
        ),
    ] {
        let (code, said) = review(params, &ceiling);
        assert_eq!(code, Some(0), "{params}: {said}");
        assert!(said.contains(top), "{params}: {said}");
    }
}

#[test]
fn a_return_that_ends_elsewhere_by_its_parameters_is_not_judged_as_a_landing_at_home() {
    let (_, _, trajectory) = flown("RTL_ALT,8000\nRTL_ALT_FINAL,2000\n", &[]);
    let last = trajectory.last().expect("segments");
    assert!((last.to_amsl_m - 520.0).abs() < 0.01 && last.to_t_s.is_none());
    let (_, _, trajectory) = flown("RTL_ALT,8000\n", &[]);
    let last = trajectory.last().expect("segments");
    assert!((last.to_amsl_m - 500.0).abs() < 0.01 && last.to_t_s.is_some());
    let px4 = ["--autopilot", "px4"];
    let (ardupilot, of_px4) = ((RETURN.to_owned(), &[][..]), (for_px4("46.01"), &px4[..]));
    for (params, (mission, flags), passes) in [
        ("RTL_ALT_TYPE,0\n", &ardupilot, true),
        ("RTL_ALT_TYPE,1\n", &ardupilot, false),
        ("1\t1\tRTL_TYPE\t0\t6\n", &of_px4, true),
        ("1\t1\tRTL_TYPE\t2\t6\n", &of_px4, false),
        ("1\t1\tRTL_LAND_DELAY\t5\t9\n", &of_px4, true),
        ("1\t1\tRTL_LAND_DELAY\t-1\t9\n", &of_px4, false),
    ] {
        let (code, said, _) = flown_from(mission, params, flags);
        assert_eq!(code == Some(0), passes, "{params}: {said}");
        assert!(
            passes || said.contains("cannot judge from item 3 on: a return"),
            "{said}"
        );
    }
}

/// `RTL::computeReturnAltitude`: the cone ends `RTL_MIN_DIST` (10 m) from home.
#[test]
fn a_px4_copter_near_home_returns_at_its_return_altitude() {
    let px4 = ["--autopilot", "px4", "--max-amsl", "900"];
    for (lat, params, top) in [
        ("46.0003", "", "560.0 m"),
        ("46.0003", "1\t1\tRTL_MIN_DIST\t50\t9\n", "550.0 m"),
        ("46.00005", "", "550.0 m"),
    ] {
        let params = format!("1\t1\tRTL_RETURN_ALT\t60\t9\n{params}");
        let (code, said, _) = flown_from(&for_px4(lat), &params, &px4);
        assert_eq!(code, Some(0), "{lat}: {said}");
        assert!(said.contains(top), "{lat} {params}: {said}");
    }
}

#[test]
fn a_copter_climbs_and_descends_and_accelerates_as_the_parameters_next_to_it_say() {
    let end_s = |params: &str| {
        let (_, _, trajectory) = flown(params, &[]);
        trajectory
            .last()
            .expect("segments")
            .to_t_s
            .expect("a landing")
    };
    let stock_s = end_s("RTL_ALT,3000\n");
    // 50 m up with 1 instead of 2.5 m/s.
    for slow in ["WPNAV_SPEED_UP,100\n", "WP_SPD_UP,1\n"] {
        let late_s = end_s(&format!("RTL_ALT,3000\n{slow}")) - stock_s;
        assert!((late_s - 30.0).abs() < 0.01, "{slow} {late_s}");
    }
    // 40 m down with 0.5 instead of 1.5 m/s.
    let late_s = end_s("RTL_ALT,3000\nWPNAV_SPEED_DN,50\n") - stock_s;
    assert!((late_s - 40.0 * (2.0 - 1.0 / 1.5)).abs() < 0.01, "{late_s}");
    // Four ramps between rest and 10 m/s, each 10^2 / 2 / accel longer on the way.
    let late_s = end_s("RTL_ALT,3000\nWPNAV_ACCEL,100\n") - stock_s;
    assert!((late_s - 4.0 * (5.0 - 2.0)).abs() < 0.5, "{late_s}");
    // The 1112 m back with 5 instead of 10 m/s.
    for slow in ["RTL_SPEED,500\n", "RTL_SPEED_MS,5\n"] {
        let late_s = end_s(&format!("RTL_ALT,3000\n{slow}")) - stock_s;
        assert!((late_s - 111.2).abs() < 3.0, "{slow} {late_s}");
    }
}

#[test]
fn a_mission_beyond_the_fence_of_its_parameters_is_not_accepted() {
    let land = RETURN.replace(
        "3\t0\t3\t20\t0\t0\t0\t0\t0\t0",
        "3\t0\t3\t21\t0\t0\t0\t0\t46.01\t8.0",
    );
    let plane = ["--airframe", "plane", "--takeoff-heading", "0"];
    let on = "FENCE_ENABLE,1\n";
    for (params, flags, passes) in [
        (
            format!("{on}FENCE_ALT_MAX,40\nFENCE_RADIUS,2000\n"),
            &[][..],
            false,
        ),
        (
            format!("{on}FENCE_ALT_MAX,60\nFENCE_RADIUS,2000\n"),
            &[],
            true,
        ),
        (format!("{on}FENCE_RADIUS,1000\n"), &[], false),
        // 300 m by default.
        (on.to_owned(), &[], false),
        (format!("{on}FENCE_TYPE,4\n"), &[], true),
        (format!("{on}FENCE_ACTION,0\n"), &[], true),
        ("FENCE_AUTOENABLE,1\n".to_owned(), &[], false),
        ("FENCE_ENABLE,0\nFENCE_ALT_MAX,40\n".to_owned(), &[], true),
        (
            format!("{on}FENCE_TYPE,3\nFENCE_ALT_MAX,40\n"),
            &plane,
            false,
        ),
        (on.to_owned(), &plane, true),
    ] {
        let mission = if flags.is_empty() { &land } else { RETURN };
        let (code, said, _) = flown_from(mission, &params, flags);
        assert_eq!(code == Some(0), passes, "{params} {flags:?}: {said}");
        assert!(passes || said.contains("fence of the parameters"), "{said}");
    }
    let px4 = ["--autopilot", "px4"];
    for (params, passes) in [
        ("1\t1\tGF_MAX_VER_DIST\t40\t9\n", false),
        ("1\t1\tGF_MAX_VER_DIST\t0\t9\n", true),
        ("1\t1\tGF_MAX_HOR_DIST\t1000\t9\n", false),
        (
            "1\t1\tGF_MAX_HOR_DIST\t1000\t9\n1\t1\tGF_ACTION\t0\t6\n",
            true,
        ),
    ] {
        let (code, said, _) = flown_from(&for_px4("46.01"), params, &px4);
        assert_eq!(code == Some(0), passes, "{params}: {said}");
    }
}

/// What `ArduCopter` 4.7 flew: at the height of its ceiling, below its floor and on a circle beyond its radius
/// it left the mission.
#[test]
fn a_way_that_comes_to_the_fence_of_its_parameters_between_its_places_is_not_accepted() {
    let land = |items: &str| {
        let takeoff = "QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t46.0\t8.0\t500\t1\n1\t0\t3\t22\t0\t0\t0\t0\t0\t0\t50\t1\n";
        format!("{takeoff}{items}4\t0\t3\t21\t0\t0\t0\t0\t46.005\t8.0\t0\t1\n")
    };
    let low = land(
        "2\t0\t3\t16\t0\t0\t0\t0\t46.003\t8.0\t50\t1\n3\t0\t3\t16\t0\t0\t0\t0\t46.005\t8.0\t20\t1\n",
    );
    let circle = land(
        "2\t0\t3\t16\t0\t0\t0\t0\t46.003\t8.0\t50\t1\n3\t0\t3\t18\t2\t0\t60\t1\t46.005\t8.0\t50\t1\n",
    );
    let plane = ["--airframe", "plane", "--takeoff-heading", "0"];
    let on = "FENCE_ENABLE,1\n";
    for (mission, params, flags, passes) in [
        (
            &low,
            format!("{on}FENCE_TYPE,1\nFENCE_ALT_MAX,50\n"),
            &[][..],
            false,
        ),
        (
            &low,
            format!("{on}FENCE_TYPE,1\nFENCE_ALT_MAX,51\n"),
            &[],
            true,
        ),
        (
            &low,
            format!("{on}FENCE_TYPE,8\nFENCE_ALT_MIN,30\n"),
            &[],
            false,
        ),
        (
            &low,
            "FENCE_AUTOENABLE,3\nFENCE_TYPE,8\nFENCE_ALT_MIN,30\n".to_owned(),
            &[],
            false,
        ),
        (
            &low,
            format!("{on}FENCE_TYPE,8\nFENCE_ALT_MIN,15\n"),
            &[],
            true,
        ),
        // It is never so high that its floor begins to count, 2 m above that.
        (
            &low,
            format!("{on}FENCE_TYPE,8\nFENCE_ALT_MIN,49\n"),
            &[],
            true,
        ),
        // 555.7 m away and a circle of 60 m.
        (
            &circle,
            format!("{on}FENCE_TYPE,2\nFENCE_RADIUS,600\n"),
            &[],
            false,
        ),
        (
            &circle,
            format!("{on}FENCE_TYPE,2\nFENCE_RADIUS,630\n"),
            &[],
            true,
        ),
        // Its climb-out ends up to 14 m too high.
        (
            &RETURN.to_owned(),
            format!("{on}FENCE_TYPE,1\nFENCE_ALT_MAX,60\n"),
            &plane,
            false,
        ),
        // It returns at 100 m: there the fence has no more to say.
        (
            &RETURN.to_owned(),
            format!("{on}FENCE_TYPE,1\nFENCE_ALT_MAX,90\n"),
            &plane,
            true,
        ),
        (
            &RETURN.replace("3\t0\t3\t20\t0\t0\t0\t0\t0\t0\t0\t1\n", ""),
            format!("{on}FENCE_TYPE,1\nFENCE_ALT_MAX,90\n"),
            &plane,
            true,
        ),
    ] {
        let (code, said, _) = flown_from(mission, &params, flags);
        assert_eq!(code == Some(0), passes, "{params} {flags:?}: {said}");
        assert!(passes || said.contains("fence of the parameters"), "{said}");
    }
}

#[test]
fn of_a_parameter_that_stands_twice_the_last_value_counts_and_two_names_must_agree() {
    let ceiling = ["--max-amsl", "600"];
    let (code, said) = review("RTL_ALT,1500\nRTL_ALT,30000\n", &ceiling);
    assert_eq!(code, Some(4), "{said}");
    let (code, said) = review("rtl_alt,30000\n", &ceiling);
    assert_eq!(code, Some(4), "{said}");
    let (code, said) = review("RTL_ALT,8000\nRTL_ALT_M,80\n", &ceiling);
    assert_eq!(code, Some(0), "{said}");
    let (code, said) = review("RTL_ALT,1500\nRTL_ALT_M,300\n", &ceiling);
    assert_eq!(code, Some(3), "{said}");
    assert!(
        said.contains("RTL_ALT and RTL_ALT_M are names of one parameter"),
        "{said}"
    );
}

#[test]
fn parameters_are_found_next_to_a_mission_by_the_names_that_ground_stations_give() {
    for name in ["m.params", "m.param", "m.parm"] {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("m.waypoints"), RETURN).expect("written");
        fs::write(folder.path().join(name), "RTL_ALT,30000\n").expect("written");
        let flags = ["--no-terrain", "--airframe", "copter", "--max-amsl", "600"];
        let output = sortie(
            folder.path(),
            &[&["review", "m.waypoints"][..], &flags].concat(),
        );
        let said = text(&output.stdout) + &text(&output.stderr);
        assert_eq!(output.status.code(), Some(4), "{name}: {said}");
        assert!(!said.contains("no parameters"), "{said}");
    }
}

/// The second file was ignored, whatever it held.
#[test]
fn parameters_that_stand_twice_next_to_a_mission_must_be_the_same() {
    let flags = ["--no-terrain", "--airframe", "copter", "--max-amsl", "600"];
    for (second, code) in [
        ("RTL_ALT 8000.0\n", 0),
        ("RTL_ALT,30000\n", 3),
        ("\u{1}", 3),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("m.waypoints"), RETURN).expect("written");
        fs::write(folder.path().join("m.params"), "RTL_ALT,8000\n").expect("written");
        fs::write(folder.path().join("m.param"), second).expect("written");
        let arguments = [&["review", "m.waypoints"][..], &flags].concat();
        let output = sortie(folder.path(), &arguments);
        let said = text(&output.stdout) + &text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{second:?}: {said}");
        assert_eq!(
            said.contains("m.param have") || said.contains("m.param:"),
            code == 3,
            "{second:?}: {said}"
        );
    }
}

#[test]
fn a_wing_that_its_parameters_lead_elsewhere_is_not_judged() {
    let plane = ["--airframe", "plane", "--takeoff-heading", "0"];
    for (params, passes) in [
        (
            "WP_MAX_RADIUS,0\nTERRAIN_FOLLOW,0\nFLIGHT_OPTIONS,8\nRTL_AUTOLAND,0\n",
            true,
        ),
        ("WP_MAX_RADIUS,20\n", false),
        ("TERRAIN_FOLLOW,1\n", false),
        ("FLIGHT_OPTIONS,24\n", false),
        ("RTL_AUTOLAND,2\n", false),
        ("RTL_CLIMB_MIN,30\n", false),
    ] {
        let (code, said, _) = flown_from(RETURN, params, &plane);
        assert_eq!(code == Some(0), passes, "{params}: {said}");
        assert!(
            passes || said.contains("cannot judge from item"),
            "{params}: {said}"
        );
    }
    let vtol = "QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t46.0\t8.0\t500\t1\n1\t0\t3\t84\t0\t0\t0\t0\t46.0\t8.0\t50\t1\n2\t0\t3\t16\t0\t0\t0\t0\t46.01\t8.0\t50\t1\n3\t0\t3\t85\tSPIRAL\t0\t0\t0\t46.02\t8.0\t0\t1\n";
    for (param1, passes) in [("0", true), ("1", false)] {
        let mission = vtol.replace("SPIRAL", param1);
        let (code, said, _) = flown_from(&mission, "", &["--airframe", "vtol"]);
        assert_eq!(code == Some(0), passes, "{param1}: {said}");
    }
}

#[test]
fn a_px4_copter_flies_no_faster_than_its_greatest_speed() {
    let px4 = ["--autopilot", "px4"];
    let end_s = |params: &str| {
        let (_, _, trajectory) = flown_from(&for_px4("46.01"), params, &px4);
        trajectory
            .last()
            .expect("segments")
            .to_t_s
            .expect("a landing")
    };
    let held = end_s("1\t1\tMPC_XY_CRUISE\t9\t9\n1\t1\tMPC_XY_VEL_MAX\t4\t9\n");
    assert!((held - end_s("1\t1\tMPC_XY_CRUISE\t4\t9\n")).abs() < 1e-6);
    assert!(held > end_s("1\t1\tMPC_XY_CRUISE\t9\t9\n") + 100.0);
    // Of the two the default counts, where only the other is known: 5 and 12 m/s.
    let of = |name: &str, mps: &str| format!("1\t1\t{name}\t{mps}\t9\n");
    let alone = end_s(&of("MPC_XY_VEL_MAX", "2"));
    let both = of("MPC_XY_VEL_MAX", "2") + &of("MPC_XY_CRUISE", "5");
    assert!((alone - end_s(&both)).abs() < 1e-6 && alone > end_s("") + 100.0);
    let both = of("MPC_XY_VEL_MAX", "12") + &of("MPC_XY_CRUISE", "20");
    assert!((end_s(&of("MPC_XY_CRUISE", "20")) - end_s(&both)).abs() < 1e-6);
    // `MPC_Z_V_AUTO_UP` is lowered to it.
    let both = of("MPC_Z_VEL_MAX_UP", "0.5") + &of("MPC_Z_V_AUTO_UP", "0.5");
    let up_s = end_s(&of("MPC_Z_VEL_MAX_UP", "0.5"));
    assert!((up_s - end_s(&both)).abs() < 1e-6 && up_s > end_s("") + 30.0);
}

#[test]
fn altitudes_above_ground_need_the_terrain_of_the_vehicle() {
    let over_ground = RETURN.replace("2\t0\t3\t16", "2\t0\t10\t16");
    let (code, said, _) = flown_from(&over_ground, "TERRAIN_ENABLE,0\n", &[]);
    assert_eq!(code, Some(4), "{said}");
    assert!(said.contains("TERRAIN_ENABLE is 0"), "{said}");
}

/// `Plane::do_change_speed` ignores an airspeed beyond its limits, -2 is that of the parameters
/// again; TECS keeps the speed within them. On its way out, which is to the north: its return forgets what was commanded.
#[test]
fn a_plane_flies_the_airspeeds_that_its_parameters_allow() {
    let mps = |change: &str, params: &str| {
        let row = format!("2\t0\t3\t178\t0\t{change}\t-1\t0\t0\t0\t0\t1\n");
        let mission = RETURN
            .replace("2\t0\t3\t16", &format!("{row}3\t0\t3\t16"))
            .replace(
                "3\t0\t3\t20",
                "4\t0\t3\t16\t0\t0\t0\t0\t46.03\t8.0\t50\t1\n5\t0\t3\t20",
            );
        let flags = ["--airframe", "plane", "--takeoff-heading", "0"];
        let (code, said, trajectory) = flown_from(&mission, params, &flags);
        assert_eq!(code, Some(0), "{params}: {said}");
        let leg = trajectory
            .iter()
            .filter(|segment| segment.flown && segment.run_m[0] > 0.0)
            .max_by(|a, b| a.length_m().total_cmp(&b.length_m()));
        let leg = leg.expect("a leg");
        leg.length_m() / (leg.to_t_s.expect("a time") - leg.from_t_s)
    };
    for (change, params, expected_mps) in [
        ("18", "", 18.0),
        ("18", "AIRSPEED_MAX,15\n", 12.0),
        ("18", "ARSPD_FBW_MAX,15\nTRIM_ARSPD_CM,1300\n", 13.0),
        ("6", "AIRSPEED_MIN,9\nAIRSPEED_CRUISE,14\n", 14.0),
        ("18", "AIRSPEED_MAX,15\nAIRSPEED_CRUISE,17\n", 15.0),
        ("-2", "AIRSPEED_CRUISE,14\n", 14.0),
    ] {
        // At 550 m above the sea the true airspeed is 3 % higher.
        let flown_mps = mps(change, params) / 1.027;
        assert!(
            (flown_mps - expected_mps).abs() < 0.1,
            "{change} {params}: {flown_mps}"
        );
    }
}

/// The return with its way out at 4 m/s.
fn slow_outward(mission: &str) -> String {
    let slow = "2\t0\t2\t178\t1\t4\t-1\t0\t0\t0\t0\t1\n";
    mission
        .replace("2\t0\t3\t16", &format!("{slow}3\t0\t3\t16"))
        .replace("3\t0\t3\t20", "4\t0\t3\t20")
        .replace("3\t0\t2\t20", "4\t0\t2\t20")
}

/// Greatest speed over the ground of what is flown to the south, m/s.
fn homeward_mps(trajectory: &[Segment]) -> f64 {
    let speeds = trajectory
        .iter()
        .filter(|segment| segment.flown && segment.run_m[0] < -1.0)
        .filter_map(|segment| {
            let lasts_s = segment.to_t_s? - segment.from_t_s;
            Some(segment.run_m[0].hypot(segment.run_m[1]) / lasts_s)
        });
    speeds.fold(0.0, f64::max)
}

/// `ModeRTL::init` calls `AC_WPNav::wp_and_spline_init` with `RTL_SPEED`, `RtlDirect::on_activation` calls
/// `reset_cruising_speed`, `Mode::enter` of ArduPlane forgets `new_airspeed_cm`.
#[test]
fn a_return_forgets_the_speed_that_the_mission_commanded() {
    let px4 = ["--autopilot", "px4"];
    let plane = ["--airframe", "plane", "--takeoff-heading", "0"];
    let on_wing = slow_outward(RETURN).replace("178\t1\t4", "178\t0\t18");
    for (mission, params, flags, expected_mps) in [
        (slow_outward(RETURN), "", &[][..], 10.0),
        (slow_outward(RETURN), "WPNAV_SPEED,800\n", &[], 8.0),
        (slow_outward(RETURN), "WP_SPD,8\n", &[], 8.0),
        (
            slow_outward(RETURN),
            "WPNAV_SPEED,800\nRTL_SPEED,600\n",
            &[],
            6.0,
        ),
        (
            slow_outward(&for_px4("46.01")),
            "1\t1\tMPC_XY_CRUISE\t8\t9\n",
            &px4,
            8.0,
        ),
        (
            on_wing,
            "AIRSPEED_CRUISE,14\nAIRSPEED_MAX,22\n",
            &plane,
            14.0 * 1.027,
        ),
    ] {
        let (_, said, trajectory) = flown_from(&mission, params, flags);
        let flown_mps = homeward_mps(&trajectory);
        assert!(
            (flown_mps - expected_mps).abs() < 0.3,
            "{params} {flags:?}: {flown_mps}, {said}"
        );
    }
}

/// Mission Planner writes a byte order mark, MAVProxy and AP_Periph defaults annotate values, old files end lines with
/// carriage returns alone.
#[test]
fn a_parameter_file_is_read_as_ground_stations_write_it() {
    let ceiling = ["--max-amsl", "600"];
    for params in [
        "\u{feff}RTL_ALT,30000\n",
        "RTL_ALT,30000 # as high as the ridge\n",
        "RTL_ALT 30000# as high as the ridge\n",
        "RTL_ALT,30000 @READONLY\n",
        "WPNAV_SPEED,500\rRTL_ALT,30000\r",
        "\u{feff}# a comment\r\nRTL_ALT,30000\r\n",
    ] {
        let (code, said) = review(params, &ceiling);
        assert_eq!(code, Some(4), "{params:?}: {said}");
        assert!(said.contains("800.0 m"), "{params:?}: {said}");
        assert!(!said.contains("RTL_ALT 1500"), "{params:?}: {said}");
    }
    for params in ["RTL_ALT,30000 RTL_SPEED\n", "# 1\rRTL_ALT;30000\r"] {
        let (code, said) = review(params, &ceiling);
        assert_eq!(code, Some(3), "{params:?}: {said}");
    }
}

/// `Mode::land_run_vertical_control`, `FlightTaskAuto::_prepareLandSetpoints`.
#[test]
fn a_landing_is_as_fast_as_the_parameters_next_to_the_mission_say() {
    let end_s = |mission: &str, params: &str, flags: &[&str]| {
        let (_, said, trajectory) = flown_from(mission, params, flags);
        let last = trajectory.last().unwrap_or_else(|| panic!("{said}"));
        last.to_t_s.expect("a landing")
    };
    let land = RETURN.replace(
        "3\t0\t3\t20\t0\t0\t0\t0\t0\t0",
        "3\t0\t3\t21\t0\t0\t0\t0\t46.01\t8.0",
    );
    let px4 = ["--autopilot", "px4"];
    let of_px4 = land.replace(
        "1\t0\t3\t22\t0\t0\t0\t0\t0\t0",
        "1\t0\t3\t22\t0\t0\t0\t0\t46.0\t8.0",
    );
    // From 50 m: 40 m at 1.5 m/s, 10 m at 0.5 m/s (PX4 0.7 m/s).
    for (mission, flags, params, later_s) in [
        (&land, &[][..], "LAND_SPEED,25\n", 20.0),
        (&land, &[], "LAND_SPD_MS,0.25\n", 20.0),
        (&land, &[], "LAND_ALT_LOW,2000\n", 20.0 - 10.0 / 1.5),
        (&land, &[], "LAND_ALT_LOW_M,20\n", 20.0 - 10.0 / 1.5),
        // Never less than a metre.
        (&land, &[], "LAND_ALT_LOW,0\n", 9.0 / 1.5 - 18.0),
        (&land, &[], "LAND_SPEED_HIGH,100\n", 40.0 - 40.0 / 1.5),
        (&land, &[], "LAND_SPD_HIGH_MS,3\n", 40.0 / 3.0 - 40.0 / 1.5),
        (
            &land,
            &[],
            "LAND_SPEED,200\n",
            50.0 / 2.0 - 20.0 - 40.0 / 1.5,
        ),
        (
            &of_px4,
            &px4,
            "1\t1\tMPC_LAND_SPEED\t0.35\t9\n",
            10.0 / 0.35 - 10.0 / 0.7,
        ),
        (
            &of_px4,
            &px4,
            "1\t1\tMPC_LAND_ALT1\t20\t9\n",
            10.0 / 0.7 - 10.0 / 1.5,
        ),
        (
            &of_px4,
            &px4,
            "1\t1\tMPC_LAND_ALT2\t20\t9\n",
            10.0 / 0.7 - 10.0 / 1.5,
        ),
        (
            &of_px4,
            &px4,
            "1\t1\tMPC_Z_VEL_MAX_DN\t0.5\t9\n",
            50.0 / 0.5 - 40.0 / 1.5 - 10.0 / 0.7,
        ),
    ] {
        let late_s = end_s(mission, params, flags) - end_s(mission, "", flags);
        assert!((late_s - later_s).abs() < 0.01, "{params}: {late_s}");
    }
}

/// `AP_Mission::start_command_fence`: 1 enables what `FENCE_TYPE` has, 0 and 2 enable nothing.
#[test]
fn a_mission_that_switches_the_fence_of_its_parameters_on_is_judged_by_it() {
    let with = |switch: u8| {
        let row = format!("2\t0\t2\t207\t{switch}\t0\t0\t0\t0\t0\t0\t1\n");
        let landing = "4\t0\t3\t21\t0\t0\t0\t0\t46.01\t8.0";
        RETURN
            .replace("2\t0\t3\t16", &format!("{row}3\t0\t3\t16"))
            .replace("3\t0\t3\t20\t0\t0\t0\t0\t0\t0", landing)
    };
    for (switch, params, passes) in [
        (1, "FENCE_ENABLE,0\nFENCE_ALT_MAX,40\n", false),
        (1, "FENCE_ENABLE,0\nFENCE_TYPE,1\nFENCE_ALT_MAX,60\n", true),
        (0, "FENCE_ENABLE,0\nFENCE_ALT_MAX,40\n", true),
        (2, "FENCE_ENABLE,0\nFENCE_ALT_MAX,40\n", true),
    ] {
        let (code, said, _) = flown_from(&with(switch), params, &[]);
        assert_eq!(code == Some(0), passes, "{switch} {params}: {said}");
        assert!(passes || said.contains("fence of the parameters"), "{said}");
    }
}

/// `Navigator::get_default_acceptance_radius`.
#[test]
fn a_px4_copter_that_accepts_waypoints_from_afar_by_its_parameters_is_not_passed() {
    let px4 = ["--autopilot", "px4"];
    for (params, passes) in [
        ("1\t1\tNAV_ACC_RAD\t10\t9\n", true),
        ("1\t1\tNAV_ACC_RAD\t200\t9\n", false),
    ] {
        let (code, said, _) = flown_from(&for_px4("46.01"), params, &px4);
        assert_eq!(code == Some(0), passes, "{params}: {said}");
        assert!(passes || said.contains("acceptance radius"), "{said}");
    }
}

/// `AP_Landing::type`.
#[test]
fn a_plane_that_lands_in_a_deep_stall_is_not_judged() {
    let plane = ["--airframe", "plane", "--takeoff-heading", "0"];
    let land = RETURN.replace(
        "3\t0\t3\t20\t0\t0\t0\t0\t0\t0",
        "3\t0\t3\t21\t0\t0\t0\t0\t46.02\t8.0",
    );
    for (params, passes) in [("LAND_TYPE,0\n", true), ("LAND_TYPE,1\n", false)] {
        let (code, said, _) = flown_from(&land, params, &plane);
        assert_eq!(code == Some(0), passes, "{params}: {said}");
        assert!(
            passes || said.contains("cannot judge from item 3 on: a landing with LAND_TYPE 1"),
            "{said}"
        );
    }
}

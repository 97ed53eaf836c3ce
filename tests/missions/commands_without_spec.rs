//! `sortie review` without a spec, of commands that move no vehicle and of speeds beyond the limits that
//! parameters have by default.

use crate::judged::judged;

/// A takeoff from home, four legs and a landing, with `MIDDLE` after the takeoff and the first leg.
const ROUTE: [&str; 8] = [
    "0\t16\t0\t0\t0\t0\t-35.363262\t149.165237\t584",
    "3\t22\t15\t0\t0\t0\t-35.363262\t149.165237\t60",
    "3\t16\t0\t0\t0\t0\t-35.345\t149.1652\t100",
    "MIDDLE",
    "3\t16\t0\t0\t0\t0\t-35.345\t149.19\t100",
    "3\t16\t0\t0\t0\t0\t-35.37\t149.19\t100",
    "3\t16\t0\t0\t0\t0\t-35.37\t149.185\t60",
    "3\t21\t0\t0\t0\t0\t-35.37\t149.175\t0",
];

/// The route of an airframe, with an item in its middle.
fn route(airframe: &str, middle: &str) -> String {
    let rows = ROUTE
        .into_iter()
        .filter(|row| *row != "MIDDLE" || !middle.is_empty());
    let rows = rows.map(|row| {
        let row = row.replace("MIDDLE", middle);
        match airframe {
            "vtol" => row
                .replace("3\t22\t15", "3\t84\t0")
                .replace("3\t21\t", "3\t85\t"),
            "copter" => row.replace("3\t22\t15", "3\t22\t0"),
            _ => row,
        }
    });
    let rows = rows.enumerate().map(|(index, row)| {
        let current = u8::from(index == 0);
        format!("{index}\t{current}\t{row}\t1\n")
    });
    format!("QGC WPL 110\n{}", rows.collect::<String>())
}

/// What is said of a mission with parameters next to it: exit code, text, and when its last item ends.
fn review(mission: &str, params: &str, flags: &[&str]) -> (Option<i32>, String, f64) {
    let judged = judged(mission, params, flags);
    let ends = judged.segments.iter();
    let ends = ends.filter_map(|segment| segment["to"]["t_s"].as_f64());
    let last_s = ends.fold(0.0, f64::max);
    (judged.code, judged.said, last_s)
}

/// `ModeAuto::start_command` of ArduCopter does not know these commands, and goes on.
#[test]
fn commands_that_arducopter_stores_and_never_starts_move_nothing() {
    let copter = ["--airframe", "copter"];
    let (code, said, plain_s) = review(&route("copter", ""), "", &copter);
    assert_eq!(code, Some(0), "{said}");
    let here = "0\t0\t0\t0\t0\t0\t0";
    for command in [191, 193, 194, 210, 222] {
        let (code, said, end_s) = review(
            &route("copter", &format!("3\t{command}\t{here}")),
            "",
            &copter,
        );
        assert_eq!(code, Some(0), "{command}: {said}");
        assert!(
            (end_s - plain_s).abs() < 1e-6,
            "{command}: {end_s} {plain_s}"
        );
    }
    // Before a command that navigates and that it does not know it stops.
    let there = "0\t0\t0\t0\t-35.345\t149.19\t200";
    for middle in [
        format!("3\t30\t{there}"),
        format!("3\t83\t{here}"),
        format!("3\t92\t{here}"),
        format!("3\t213\t{here}"),
    ] {
        let (code, said, end_s) = review(&route("copter", &middle), "", &copter);
        assert_eq!(code, Some(0), "{middle}: {said}");
        assert!(end_s > plain_s + 0.5, "{middle}: {end_s} {plain_s}");
    }
    // It does not begin a mission from the ground with one of them.
    let first = route("copter", "").replace(
        "\n1\t0\t3\t22",
        "\n1\t0\t3\t83\t0\t0\t0\t0\t0\t0\t0\t1\n2\t0\t3\t22",
    );
    let (code, said, _) = review(&first, "", &copter);
    assert_eq!(code, Some(4), "{said}");
    let (code, said, _) = review(&route("copter", "3\t92\t1\t0\t0\t0\t0\t0\t0"), "", &copter);
    assert_eq!(code, Some(4), "{said}");
    for command in [30, 83, 210] {
        let (code, said, _) = review(
            &route("plane", &format!("3\t{command}\t{there}")),
            "",
            &["--airframe", "plane"],
        );
        assert!(
            code == Some(4) && said.contains("cannot judge from item 3"),
            "{command}: {said}"
        );
    }
}

#[test]
fn a_vtol_on_its_wing_stays_on_it_after_a_transition_to_forward_flight() {
    for autopilot in ["ardupilot", "px4"] {
        let flags = ["--airframe", "vtol", "--autopilot", autopilot];
        let (code, said, plain_s) = review(&route("vtol", ""), "", &flags);
        assert_eq!(code, Some(0), "{autopilot}: {said}");
        let forward = route("vtol", "2\t3000\t4\t0\t0\t0\t0\t0\t0");
        let (code, said, end_s) = review(&forward, "", &flags);
        assert_eq!(code, Some(0), "{autopilot}: {said}");
        assert!(
            (end_s - plain_s).abs() < 1e-6,
            "{autopilot}: {end_s} {plain_s}"
        );
        let (code, said, _) = review(&forward.replace("3000\t4", "3000\t3"), "", &flags);
        assert!(
            code == Some(4) && said.contains("DO_VTOL_TRANSITION"),
            "{autopilot}: {said}"
        );
        // On the ground it is on no wing.
        let grounded = forward.replace("3\t84\t0\t0", "2\t3000\t4\t0");
        let (code, said, _) = review(&grounded, "", &flags);
        assert_eq!(code, Some(4), "{autopilot}: {said}");
    }
}

/// `Plane::do_change_speed` and PX4's `FW_AIRSPD_MIN` and `FW_AIRSPD_MAX`.
#[test]
fn an_airspeed_beyond_the_limits_of_the_defaults_does_not_pass_in_silence() {
    let change = |mps: &str| format!("2\t178\t0\t{mps}\t-1\t0\t0\t0\t0");
    for (autopilot, mps, params, said_of) in [
        (
            "ardupilot",
            "5",
            "AIRSPEED_MIN,4\n",
            "AIRSPEED_MIN is 9 by default: ArduPilot ignores it",
        ),
        (
            "ardupilot",
            "25",
            "AIRSPEED_MAX,30\n",
            "AIRSPEED_MAX is 22 by default: ArduPilot ignores it",
        ),
        (
            "px4",
            "6",
            "1\t1\tFW_AIRSPD_MIN\t5\t9\n",
            "FW_AIRSPD_MIN is 10 by default: PX4 flies that",
        ),
        (
            "px4",
            "24",
            "1\t1\tFW_AIRSPD_MAX\t30\t9\n",
            "FW_AIRSPD_MAX is 20 by default: PX4 flies that",
        ),
    ] {
        for airframe in ["plane", "vtol"] {
            let flags = ["--airframe", airframe, "--autopilot", autopilot];
            let mission = route(airframe, &change(mps));
            let (code, said, _) = review(&mission, "", &flags);
            assert_eq!(code, Some(4), "{autopilot} {mps}: {said}");
            let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(
                said.contains("mission item 3: airspeed") && said.contains(said_of),
                "{said}"
            );
            let (_, said, _) = review(&mission, params, &flags);
            assert!(
                !said.contains("by default: "),
                "{autopilot} {mps} {params}: {said}"
            );
        }
    }
    for autopilot in ["ardupilot", "px4"] {
        let flags = ["--airframe", "plane", "--autopilot", autopilot];
        let (code, said, _) = review(&route("plane", &change("18")), "", &flags);
        assert_eq!(code, Some(0), "{autopilot}: {said}");
    }
}

/// `Navigator::set_cruising_speed`: of the rotors while it is on them. A ground speed is an airspeed.
#[test]
fn a_speed_before_the_takeoff_of_a_px4_vtol_is_not_that_of_its_wing() {
    let flags = ["--airframe", "vtol", "--autopilot", "px4"];
    let end_s = |mission: &str| {
        let (code, said, end_s) = review(mission, "", &flags);
        assert_eq!(code, Some(0), "{said}");
        end_s
    };
    let plain_s = end_s(&route("vtol", ""));
    let before = |kind: u8| {
        let home = "QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t-35.363262\t149.165237\t584\t1\n";
        let change = format!("1\t0\t2\t178\t{kind}\t19\t-1\t0\t0\t0\t0\t1\n");
        let rest = route("vtol", "");
        let rest = rest.lines().skip(2).enumerate().map(|(index, line)| {
            let fields = line.split_once('\t').expect("fields").1;
            format!("{}\t{fields}\n", index + 2)
        });
        format!("{home}{change}{}", rest.collect::<String>())
    };
    for kind in [0, 1] {
        let of_rotors_s = end_s(&before(kind));
        assert!(
            (of_rotors_s - plain_s).abs() < 1e-6,
            "{kind}: {of_rotors_s} {plain_s}"
        );
        let later = route("vtol", &format!("2\t178\t{kind}\t19\t-1\t0\t0\t0\t0"));
        let of_wing_s = end_s(&later);
        assert!(of_wing_s < plain_s - 20.0, "{kind}: {of_wing_s} {plain_s}");
    }
}

#[test]
fn a_px4_copter_without_parameters_flies_no_faster_than_the_default_allows() {
    let flags = ["--airframe", "copter", "--autopilot", "px4"];
    let review = |mps: &str| {
        let change = format!("2\t178\t1\t{mps}\t-1\t0\t0\t0\t0");
        review(&route("copter", &change), "", &flags)
    };
    let (code, said, faster_s) = review("18");
    assert_eq!(code, Some(0), "{said}");
    assert!(
        said.contains("flies no faster than MPC_XY_VEL_MAX 12"),
        "{said}"
    );
    let (_, said, max_s) = review("12");
    assert!(!said.contains("MPC_XY_VEL_MAX"), "{said}");
    assert!((faster_s - max_s).abs() < 1e-6, "{faster_s} {max_s}");
}

/// ArduPilot overwrites the first row with its home (`AP_Mission::write_home_to_storage`).
#[test]
fn a_takeoff_in_the_row_of_home_is_one_that_ardupilot_never_flies() {
    let mission = "QGC WPL 110\n0\t0\t3\t22\t0\t0\t0\t0\t46.0\t8.0\t50\t1\n\
        1\t0\t3\t16\t0\t0\t0\t0\t46.01\t8.0\t50\t1\n2\t0\t3\t21\t0\t0\t0\t0\t46.01\t8.0\t0\t1\n";
    let home = ["--home", "46.0,8.0,500", "--airframe", "copter"];
    let (code, said, _) = review(mission, "", &home);
    assert!(
        code == Some(4) && said.contains("command 22 stands in row 0"),
        "{said}"
    );
    let (code, said, _) = review(mission, "", &[&home[..], &["--autopilot", "px4"]].concat());
    assert_eq!(code, Some(0), "{said}");
    // Rows from 1 leave the row of home to ArduPilot.
    let from_one = mission
        .replace("\n2\t", "\n3\t")
        .replace("\n1\t", "\n2\t")
        .replace("\n0\t", "\n1\t");
    let (code, said, _) = review(&from_one, "", &home);
    assert_eq!(code, Some(0), "{said}");
}

/// `QuadPlane::do_vtol_takeoff`, `AP_Mission::get_landing_sequence_start`, `Location::initialised`.
#[test]
fn ardupilot_accepts_the_zeros_that_mission_planner_writes_for_no_place() {
    for (airframe, commands) in [
        ("copter", &[188, 195, 201][..]),
        ("plane", &[188, 189, 195, 201]),
        ("vtol", &[188, 189, 195, 201]),
    ] {
        for command in commands {
            let item = format!("3\t{command}\t0\t0\t0\t0\t0\t0\t0");
            let mission = route(airframe, &item);
            let mission = mission.replace("-35.363262\t149.165237\t60", "0\t0\t60");
            let (code, said, _) = review(&mission, "", &["--airframe", airframe]);
            assert_eq!(code, Some(0), "{airframe} {command}: {said}");
        }
    }
    let mission = route("vtol", "").replace("-35.363262\t149.165237\t60", "0\t0\t60");
    let flags = ["--airframe", "vtol", "--autopilot", "px4"];
    let (code, said, _) = review(&mission, "", &flags);
    assert!(code == Some(4) && said.contains("a real place"), "{said}");
}

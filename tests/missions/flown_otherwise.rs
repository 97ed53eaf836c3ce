//! Missions that an autopilot flies in another way than their items read, or not at all: `sortie review` without a spec.

use std::fs;

use crate::support::command::{sortie, text};
use crate::without_spec::{COPTER, HOME, Row, land, review, waypoint};

/// A takeoff and an order as both autopilots accept them.
pub(crate) fn up() -> Row {
    Row(22, 3, [0.0; 4], HOME.0, HOME.1, 50.0)
}
fn order(number: u16, params: [f32; 4]) -> Row {
    Row(number, 2, params, 0.0, 0.0, 0.0)
}

pub(crate) fn fails(rows: &[Row], flags: &[&str], why: &str) {
    let (code, out, errors) = review(HOME, rows, flags);
    assert_eq!(code, Some(4), "{out}{errors}");
    assert!(out.contains(why), "{out}");
}

fn passes(rows: &[Row], flags: &[&str]) {
    let (code, out, errors) = review(HOME, rows, flags);
    assert_eq!(code, Some(0), "{out}{errors}");
}

/// `ModeAuto::do_loiter_to_alt` takes 0 for the altitude: ArduCopter 4.7.0-beta1 descended from 50 m to 0.5 m above the ground.
#[test]
fn a_copter_that_loiters_to_an_altitude_of_0_descends_to_the_ground() {
    let to = |above_m| {
        [
            up(),
            Row(31, 3, [0.0; 4], 46.002, 8.0, above_m),
            land(46.003, 8.0),
        ]
    };
    passes(&to(50.0), &COPTER);
    fails(&to(0.0), &COPTER, "ArduCopter descends to 0 m");
}

/// ArduCopter 4.7.0-beta1 disarmed 10 s later, PX4 1.17 after 11 s ("Disarmed by auto preflight disarming").
#[test]
fn who_waits_longer_on_the_ground_than_it_stays_armed_does_not_take_off() {
    let after = |wait_s| {
        let wait = order(93, [wait_s, -1.0, -1.0, -1.0]);
        let way = waypoint(46.002, 8.0, 50.0);
        [wait, up(), way, land(46.003, 8.0)]
    };
    for (autopilot, name) in [("ardupilot", "DISARM_DELAY"), ("px4", "COM_DISARM_PRFLT")] {
        let flags = [COPTER.as_slice(), &["--autopilot", autopilot]].concat();
        passes(&after(8.0), &flags);
        let why = format!("disarms itself after 10 s there ({name}");
        fails(&after(60.0), &flags, &why);
    }
}

/// ArduCopter 4.7.0-beta1 obeyed the change of speed behind the jump as its last repetition began.
#[test]
fn a_command_behind_a_counted_jump_with_another_before_it_comes_a_lap_early() {
    let loops = |before: Option<Row>, between: Option<Row>| {
        let mut rows = vec![up(), waypoint(46.001, 8.0, 50.0)];
        rows.push(waypoint(46.002, 8.0, 50.0));
        rows.extend(before);
        rows.push(order(177, [2.0, 1.0, 0.0, 0.0]));
        rows.extend(between);
        rows.push(order(178, [1.0, 2.0, -1.0, 0.0]));
        rows.extend([waypoint(46.003, 8.0, 50.0), land(46.003, 8.0)]);
        rows
    };
    let picture = || Some(order(203, [0.0; 4]));
    fails(
        &loops(picture(), None),
        &COPTER,
        "obeys item 6 one repetition early",
    );
    passes(&loops(None, None), &COPTER);
    passes(
        &loops(picture(), Some(waypoint(46.0025, 8.0, 50.0))),
        &COPTER,
    );
    let px4 = [COPTER.as_slice(), &["--autopilot", "px4"]].concat();
    passes(&loops(picture(), None), &px4);
}

/// `rc.mc_defaults` of every multicopter: 1.17 said "return at 461 m (30 m above destination)".
#[test]
fn a_copter_of_px4_returns_30_m_above_home() {
    let rows = [up(), waypoint(46.002, 8.0, 20.0), order(20, [0.0; 4])];
    let flags = [COPTER.as_slice(), &["--autopilot", "px4"]].concat();
    let (code, out, errors) = review(HOME, &rows, &flags);
    assert_eq!(code, Some(0), "{out}{errors}");
    assert!(errors.contains("RTL_RETURN_ALT 30"), "{errors}");
}

/// A folder with flat ground at 500 m or a step in it, and missions.
fn over_ground(heights: &str, missions: &[(&str, String)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let put =
        |name: &str, bytes: &str| fs::write(folder.path().join(name), bytes).expect("written");
    let head = "ncols 4\nnrows 4\nxllcenter 7.98\nyllcenter 45.98\ncellsize 0.02\n";
    let row = format!("{heights}\n");
    put("ground.asc", &(head.to_owned() + &row.repeat(4)));
    put("ground.prj", "EPSG:4326");
    for (name, rows) in missions {
        put(
            name,
            &format!("QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t46.0\t8.0\t500\t1\n{rows}"),
        );
    }
    folder
}

fn reviewed(folder: &tempfile::TempDir, flags: &[&str]) -> (Option<i32>, String) {
    let ground = ["review", "--terrain", "ground.asc"];
    let output = sortie(folder.path(), &[&ground, flags].concat());
    let said = text(&output.stdout) + &text(&output.stderr);
    (output.status.code(), said)
}

/// The lag of a slope is nothing where the slope begins.
#[test]
fn a_plane_over_flat_ground_passes_without_a_least_height() {
    let rows = "1\t0\t3\t22\t10\t0\t0\t0\t46.0\t8.003\t80\t1\n2\t0\t3\t16\t0\t0\t0\t0\t46.0\t8.02\t80\t1\n3\t0\t3\t16\t0\t0\t0\t0\t46.015\t8.02\t80\t1\n4\t0\t3\t20\t0\t0\t0\t0\t0\t0\t0\t1\n";
    let folder = over_ground("500 500 500 500", &[("a.waypoints", rows.to_owned())]);
    for autopilot in ["ardupilot", "px4"] {
        for min_m in ["0", "5"] {
            let flags = [
                "a.waypoints",
                "--airframe",
                "plane",
                "--autopilot",
                autopilot,
            ];
            let (_, said) = reviewed(&folder, &[&flags[..], &["--min-agl", min_m]].concat());
            assert!(!said.contains("FAIL a: terrain clearance"), "{said}");
        }
    }
}

/// 25 m above terrain that rises by 150 m on 100 m ArduCopter 4.7.0-beta1 flew 14 m below it.
#[test]
fn a_copter_that_follows_ground_steeper_than_it_climbs_fails() {
    let rows = |frame: u8| {
        format!(
            "1\t0\t3\t22\t0\t0\t0\t0\t0\t0\t50\t1\n2\t0\t{frame}\t16\t0\t0\t0\t0\t46.0\t8.03\t50\t1\n3\t0\t{frame}\t16\t0\t0\t0\t0\t46.0\t8.035\t50\t1\n4\t0\t3\t20\t0\t0\t0\t0\t0\t0\t0\t1\n"
        )
    };
    // 1000 m up on 1500 m.
    let missions = [("a.waypoints", rows(10))];
    let folder = over_ground("500 500 1500 1500", &missions);
    let (code, said) = reviewed(&folder, &["a.waypoints", "--airframe", "copter"]);
    assert_eq!(code, Some(4), "{said}");
    assert!(said.contains("FAIL a: climb speed"), "{said}");
}

/// A stock ArduCopter made 10.2 m/s of 25 and was 155 s late at the crossing.
#[test]
fn a_speed_that_no_stock_copter_reaches_fails_where_times_are_judged() {
    let rows = |mps: u32, north: f64| {
        format!(
            "1\t0\t3\t22\t0\t0\t0\t0\t0\t0\t50\t1\n2\t0\t2\t178\t1\t{mps}\t-1\t0\t0\t0\t0\t1\n3\t0\t3\t16\t0\t0\t0\t0\t{north}\t8.02\t50\t1\n4\t0\t3\t21\t0\t0\t0\t0\t{north}\t8.02\t0\t1\n"
        )
    };
    let missions = [
        ("a.waypoints", rows(25, 46.01)),
        ("b.waypoints", rows(5, 45.99)),
    ];
    let folder = over_ground("500 500 500 500", &missions);
    let files = ["a.waypoints", "b.waypoints", "--airframe", "copter"];
    let apart = [&files[..], &["--separation", "1"]].concat();
    let (_, said) = reviewed(&folder, &apart);
    assert!(said.contains("FAIL a: airspeed"), "{said}");
    assert!(!said.contains("FAIL b: airspeed"), "{said}");
    // Where it is does not depend on when.
    let (code, said) = reviewed(&folder, &[files[0], files[2], files[3]]);
    assert_eq!(code, Some(0), "{said}");
}

/// Without `MPC_XY_CRUISE` and with less tilt it was judged at 5 m/s: only commanded speeds were.
#[test]
fn a_copter_that_may_not_lean_fails_at_its_default_speed_and_another_one_changes_nothing_for_it() {
    let rows = |change: &str, north: f64| {
        format!(
            "1\t0\t3\t22\t0\t0\t0\t0\t46\t8\t50\t1\n2\t0\t2\t178\t1\t{change}\t-1\t0\t0\t0\t0\t1\n3\t0\t3\t16\t0\t0\t0\t0\t{north}\t8.02\t50\t1\n4\t0\t3\t21\t0\t0\t0\t0\t{north}\t8.02\t0\t1\n"
        )
    };
    let said = |change: &str, params: &str, autopilot: &str| {
        let missions = [
            ("a.waypoints", rows(change, 46.01)),
            ("b.waypoints", rows("-1", 45.99)),
        ];
        let folder = over_ground("500 500 500 500", &missions);
        std::fs::write(folder.path().join("a.params"), params).expect("a file");
        let files = ["a.waypoints", "b.waypoints", "--airframe", "copter"];
        let flags = ["--separation", "1", "--autopilot", autopilot];
        reviewed(&folder, &[&files[..], &flags].concat()).1
    };
    let fails = "FAIL a: airspeed";
    assert!(said("-1", "MPC_TILTMAX_AIR,5\n", "px4").contains(fails));
    assert!(said("-1", "ANGLE_MAX,1000\n", "ardupilot").contains(fails));
    assert!(!said("-1", "", "ardupilot").contains(fails));
    // b, at 10 m/s by default, failed because a was commanded more.
    let both = said("10.1", "", "ardupilot");
    assert!(
        both.contains(fails) && !both.contains("FAIL b: airspeed"),
        "{both}"
    );
}

/// `AC_WPNav::set_speed_NE_cms` ignores the speed; places after `NAV_LOITER_UNLIM` passed as if they were flown.
#[test]
fn speeds_that_are_ignored_and_places_after_an_endless_circle_fail() {
    let up = || Row(22, 3, [0.0; 4], 46.0, 8.0, 50.0);
    let stay = || Row(17, 3, [0.0; 4], 46.002, 8.0, 50.0);
    let to = |north: f64| waypoint(north, 8.0, 50.0);
    let flags = ["--no-terrain", "--airframe", "copter"];
    let slow = |mps: f32| {
        let rows = [
            up(),
            to(46.001),
            order(178, [1.0, mps, -1.0, 0.0]),
            to(46.002),
            stay(),
        ];
        review(HOME, &rows, &flags)
    };
    let (code, out, _) = slow(0.1);
    assert!(code == Some(4) && out.contains("below 0.2 m/s"), "{out}");
    assert_eq!(slow(0.3).0, Some(0));
    let (code, out, errors) = review(HOME, &[up(), to(46.001), stay(), to(46.003)], &flags);
    assert_eq!(code, Some(4), "{out}");
    assert!((out + &errors).contains("stays at item 3 (NAV_LOITER_UNLIM) for ever"));
    assert_eq!(review(HOME, &[up(), to(46.001), stay()], &flags).0, Some(0));
}

/// "DO_LAND_START set and RTL_AUTOLAND disabled", said ArduPlane 4.7.0-beta1; PX4 1.17 denied arming.
#[test]
fn a_wing_that_is_not_armed_for_its_mission_with_stock_parameters_is_named() {
    let up = || Row(22, 3, [10.0, 0.0, 0.0, 0.0], 46.003, 8.0, 80.0);
    let circle = Row(17, 3, [0.0, 0.0, 100.0, 0.0], 46.03, 8.0, 80.0);
    let rows = [up(), waypoint(46.02, 8.0, 80.0), circle];
    let said = |autopilot: &str, rows: &[Row]| {
        let flags = [
            "--no-terrain",
            "--airframe",
            "plane",
            "--autopilot",
            autopilot,
        ];
        let (_, out, errors) = review(HOME, rows, &flags);
        out + &errors
    };
    assert!(said("px4", &rows).contains("MIS_TKO_LAND_REQ 2"));
    assert!(!said("ardupilot", &rows).contains("RTL_AUTOLAND"));
    let ends = [
        order(189, [0.0; 4]),
        waypoint(46.025, 8.0, 60.0),
        land(46.03, 8.0),
    ];
    let rows: Vec<Row> = [up(), waypoint(46.02, 8.0, 80.0)]
        .into_iter()
        .chain(ends)
        .collect();
    assert!(said("ardupilot", &rows).contains("RTL_AUTOLAND 0"));
    assert!(!said("px4", &rows).contains("MIS_TKO_LAND_REQ"));
}

/// The rows of a flight from one place to another, which begins after a delay, seconds.
fn between(from: f64, to: f64, delay_s: u32) -> String {
    let wait = match delay_s {
        0 => String::new(),
        _ => format!("0\t0\t2\t93\t{delay_s}\t-1\t-1\t-1\t0\t0\t0\t1\n"),
    };
    let rows = format!(
        "{wait}0\t0\t3\t22\t0\t0\t0\t0\t0\t0\t50\t1\n0\t0\t3\t16\t0\t0\t0\t0\t{to}\t8.0\t50\t1\n0\t0\t3\t21\t0\t0\t0\t0\t{to}\t8.0\t0\t1\n"
    );
    let rows = rows.lines().enumerate();
    let mut rows: String = rows
        .map(|(row, line)| format!("{}{}\n", row + 1, &line[1..]))
        .collect();
    rows.insert_str(
        0,
        &format!("0\t1\t0\t16\t0\t0\t0\t0\t{from}\t8.0\t500\t1\n"),
    );
    rows
}

/// Who waits on its pad for its departure, or has landed there, was landed on with a warning and exit code 0.
#[test]
fn a_copter_that_lands_where_another_one_stands_does_not_keep_its_distance() {
    let folder = tempfile::tempdir().expect("a folder");
    let put = |name: &str, text: &str| {
        fs::write(folder.path().join(name), text).expect("written");
    };
    let missions = |alpha: String, bravo: String| {
        put("alpha.waypoints", &format!("QGC WPL 110\n{alpha}"));
        put("bravo.waypoints", &format!("QGC WPL 110\n{bravo}"));
        put("alpha.params", "DISARM_DELAY,0\n");
        put("bravo.params", "DISARM_DELAY,0\n");
    };
    let judged = |more: &[&str]| {
        let flags = ["alpha.waypoints", "bravo.waypoints", "--airframe", "copter"];
        let ground = ["review", "--no-terrain"];
        let output = sortie(folder.path(), &[&ground, &flags[..], more].concat());
        (
            output.status.code(),
            text(&output.stdout) + &text(&output.stderr),
        )
    };
    let apart = ["--separation", "20"];
    // It waits there, and takes off from under alpha.
    missions(between(46.0, 46.01, 0), between(46.01, 46.02, 900));
    let (code, said) = judged(&apart);
    assert_eq!(code, Some(4), "{said}");
    assert!(
        said.contains("alpha lands 0.0 m from where bravo stands until T0+900 s"),
        "{said}"
    );
    assert!(!said.contains("warning: alpha lands"), "{said}");
    // It has landed there.
    missions(between(46.0, 46.01, 0), between(46.02, 46.01, 900));
    let (code, said) = judged(&apart);
    assert_eq!(code, Some(4), "{said}");
    assert!(
        said.contains("FAIL bravo and alpha: landing place"),
        "{said}"
    );
    // It has flown away before, and without a separation nobody says that they fly together.
    missions(between(46.0, 46.01, 900), between(46.01, 46.02, 0));
    assert_eq!(judged(&apart).0, Some(0), "{}", judged(&apart).1);
    missions(between(46.0, 46.01, 0), between(46.02, 46.01, 900));
    assert_eq!(judged(&[]).0, Some(0), "{}", judged(&[]).1);
}

/// ArduCopter 4.7.0-beta1 flew on behind 253 commands, stopped for good behind 254, 9 m past the waypoint before them, and began
/// the first of 255 again and again.
#[test]
fn arducopter_does_not_come_to_an_item_behind_254_commands() {
    let rows = |commands: usize| {
        let mut rows = vec![up(), waypoint(46.001, 8.0, 50.0)];
        rows.extend((0..commands).map(|_| order(203, [0.0; 4])));
        rows.extend([waypoint(46.002, 8.0, 50.0), land(46.003, 8.0)]);
        rows
    };
    passes(&rows(253), &COPTER);
    fails(
        &rows(254),
        &COPTER,
        "more than 253 commands without motion in a row",
    );
    let px4 = [COPTER.as_slice(), &["--autopilot", "px4"]].concat();
    passes(&rows(254), &px4);
}

/// "VTOL land too short, min 27m", said `AP_Arming_Plane::mission_checks` of ArduPlane 4.7.0-beta1.
#[test]
fn a_quadplane_with_a_landing_too_close_behind_a_waypoint_is_not_armed() {
    let rows = |lat: f64| {
        let up = Row(84, 3, [0.0; 4], HOME.0, HOME.1, 50.0);
        let ways = [waypoint(46.01, 8.0, 50.0), waypoint(46.02, 8.0, 50.0)];
        let down = Row(85, 3, [0.0; 4], lat, 8.0, 0.0);
        let [first, last] = ways;
        [up, first, last, down]
    };
    let vtol = ["--no-terrain", "--airframe", "vtol"];
    passes(&rows(46.0203), &vtol);
    fails(&rows(46.0202), &vtol, "at least 27.0 m");
}

/// Nothing that flies a mission hovers for eleven days: NAV_DELAY of 1e30 s passed as well.
#[test]
fn a_flight_longer_than_any_vehicle_stays_aloft_fails() {
    let rows = |wait_s: f32| {
        let wait = Row(93, 3, [wait_s, -1.0, -1.0, -1.0], 0.0, 0.0, 0.0);
        let way = waypoint(46.001, 8.0, 50.0);
        [up(), way, wait, land(46.001, 8.0)]
    };
    passes(&rows(600.0), &COPTER);
    for wait_s in [1e6, 1e30] {
        fails(&rows(wait_s), &COPTER, "nothing stays aloft for longer");
    }
}

/// Three PX4 1.18 on `missions/harbour.yaml` were up to 26 m below the line of a leg; of a mission without a spec nobody
/// knows the version, and it was judged as flown by 1.17 alone.
#[test]
fn a_copter_of_px4_without_a_version_is_judged_as_1_17_and_as_1_18_fly_it() {
    let rows = |above_m: u32| {
        format!(
            "1\t0\t3\t22\t0\t0\t0\t0\t46.0\t8.0\t100\t1\n2\t0\t3\t16\t0\t0\t0\t0\t46.0\t8.001\t100\t1\n3\t0\t3\t16\t0\t0\t0\t0\t46.0\t8.039\t{above_m}\t1\n4\t0\t3\t21\t0\t0\t0\t0\t46.0\t8.039\t0\t1\n"
        )
    };
    let missions = [("a.waypoints", rows(60)), ("b.waypoints", rows(80))];
    let folder = over_ground("500 500 560 500", &missions);
    let flags = |name: &'static str, autopilot: &'static str| {
        let of = ["--airframe", "copter", "--min-agl", "10", "--autopilot"];
        [&[name], &of[..], &[autopilot]].concat()
    };
    let (code, said) = reviewed(&folder, &flags("a.waypoints", "px4"));
    assert_eq!(code, Some(4), "{said}");
    assert!(said.contains("as PX4 1.18 and later flies it"), "{said}");
    for (name, autopilot) in [("a.waypoints", "ardupilot"), ("b.waypoints", "px4")] {
        let (code, said) = reviewed(&folder, &flags(name, autopilot));
        assert_eq!(code, Some(0), "{name} {autopilot}: {said}");
    }
}

/// Dunes of 16 m, 120 m apart: between posts 100 m apart ArduCopter 4.7.0-beta1 flew 1.4 m below their tops
/// where 11.5 m of clearance were passed.
#[test]
fn a_copter_that_follows_ground_finer_than_the_posts_of_its_autopilot_is_judged_with_what_they_are_off()
 {
    let folder = tempfile::tempdir().expect("a folder");
    let put = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("written");
    let row: Vec<String> = (0..340)
        .map(|column| {
            let east_m = (f64::from(column) - 110.0) * 0.00009 * 75_267.0;
            let phase = std::f64::consts::TAU * east_m / 120.0;
            format!("{:.2}", 430.0 + 8.0 * phase.cos())
        })
        .collect();
    let head = "ncols 340\nnrows 180\nxllcorner 8.51\nyllcorner 47.392\ncellsize 0.00009\n";
    put(
        "dune.asc",
        &(head.to_owned() + &(row.join(" ") + "\n").repeat(180)),
    );
    put("dune.prj", "EPSG:4326");
    let plan = |agl_m: f64| {
        put(
            "dune.yaml",
            &format!(
                "sortie: 2\nname: dune\narea: {{south_west: {{lat: 47.395, lon: 8.515}}, north_east: {{lat: 47.405, lon: 8.537}}, min_agl_m: 5, max_amsl_m: 900}}\nterrain: {{file: dune.asc}}\nvehicles:\n  - {{id: alpha, sysid: 1, autopilot: ardupilot, link: sim, speed_mps: 4, climb_mps: 2.5, descent_mps: 2.5, max_climb_deg: 30, max_descent_deg: 30, finish: land,\n     start: {{lat: 47.40, lon: 8.521, agl_m: {agl_m}}}, goal: {{lat: 47.40, lon: 8.534, agl_m: {agl_m}}}}}\nmission: {{altitude: terrain, fence: false}}\nplanner: {{evaluations: 500}}\n"
            ),
        );
        let output = sortie(folder.path(), &["plan", "dune.yaml"]);
        (
            output.status.code(),
            text(&output.stdout) + &text(&output.stderr),
        )
    };
    let (code, said) = plan(20.0);
    assert_eq!(code, Some(4), "{said}");
    let why = "FAIL alpha: terrain clearance: ";
    let min_m = said
        .split_once(why)
        .and_then(|(_, rest)| rest.split_once(" m,"));
    let min_m: f64 = min_m.expect(why).0.parse().expect("metres");
    assert!(min_m < 3.0, "{said}");
    // A second plan replaces the folder of the first, the grid's coordinate system in it.
    let (code, said) = plan(45.0);
    assert_eq!(code, Some(0), "{said}");
    let held = fs::read_to_string(folder.path().join("out/dune/alpha.params")).expect("parameters");
    assert!(held.contains("TERRAIN_SPACING,100"), "{held}");
}

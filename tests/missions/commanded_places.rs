//! `sortie review` of places that a vehicle is sent to and that a model of corners could hide.

use crate::without_spec::{COPTER, HOME, Row, command, land, review, waypoint};

/// A climb-out to the north and a landing approach from there, of a plane.
fn climb_out() -> Row {
    Row(22, 3, [15.0, 0.0, 0.0, 0.0], 46.0, 8.0, 60.0)
}

/// A takeoff at home, as PX4 wants its place.
fn takeoff_at_home() -> Row {
    Row(22, 3, [0.0; 4], HOME.0, HOME.1, 50.0)
}

#[test]
fn a_corner_does_not_hide_that_its_waypoint_is_below_home() {
    let copter = |autopilot, above_home_m: f64| {
        let rows = [
            takeoff_at_home(),
            waypoint(46.001, 8.0, 50.0),
            waypoint(46.0012, 8.0, above_home_m),
            waypoint(46.001, 8.0, 50.0),
            land(46.001, 8.0),
        ];
        review(
            HOME,
            &rows,
            &[&COPTER[..], &["--autopilot", autopilot]].concat(),
        )
    };
    for autopilot in ["ardupilot", "px4"] {
        for above_home_m in [-0.2, -1.0, -4.0] {
            let (code, out, errors) = copter(autopilot, above_home_m);
            assert_eq!(code, Some(4), "{autopilot} {above_home_m}: {out}{errors}");
            let value = format!("{above_home_m:.1} m");
            assert!(
                out.contains("altitude above home") && out.contains(&value),
                "{value}: {out}"
            );
        }
        let (code, out, errors) = copter(autopilot, 0.5);
        assert_eq!(code, Some(0), "{autopilot}: {out}{errors}");
    }
    // The first leg of a plane after its climb-out, with a reversal at the end.
    for (above_home_m, passes) in [(-20.0, false), (40.0, true)] {
        let rows = [
            climb_out(),
            waypoint(46.02, 8.0, above_home_m),
            waypoint(46.01, 8.0, 80.0),
            waypoint(46.01, 8.01, 80.0),
            waypoint(46.02, 8.01, 80.0),
            Row(21, 3, [0.0; 4], 46.035, 8.01, 0.0),
        ];
        let (code, out, errors) = review(HOME, &rows, &["--no-terrain", "--airframe", "plane"]);
        assert_eq!(code == Some(0), passes, "{above_home_m}: {out}{errors}");
        assert!(
            passes || out.contains("altitude above home"),
            "{out}{errors}"
        );
    }
}

/// `Plane::verify_nav_wp`: the waypoint is reached within `param2` metres of it, up to 255.
#[test]
fn a_wing_that_turns_where_a_waypoint_says_is_not_judged_as_turning_by_its_own_rule() {
    let fly = |radius_m: f32, autopilot| {
        let rows = [
            climb_out(),
            waypoint(46.01, 8.0, 60.0),
            Row(16, 3, [0.0, radius_m, 0.0, 0.0], 46.02, 8.0, 60.0),
            waypoint(46.02, 8.01, 60.0),
            Row(21, 3, [0.0; 4], 46.02, 8.03, 0.0),
        ];
        let flags = [
            "--no-terrain",
            "--airframe",
            "plane",
            "--autopilot",
            autopilot,
        ];
        review(HOME, &rows, &flags)
    };
    for autopilot in ["ardupilot", "px4"] {
        let (code, out, errors) = fly(0.0, autopilot);
        assert_eq!(code, Some(0), "{autopilot}: {out}{errors}");
        let (code, out, errors) = fly(200.0, autopilot);
        assert_eq!(code, Some(4), "{autopilot}: {out}{errors}");
        assert!(out.contains("item 3") && out.contains("200 m"), "{out}");
    }
    // ArduPlane keeps whole metres: half of one is none, and not accepted as such.
    let (code, out, errors) = fly(0.5, "ardupilot");
    assert_eq!(code, Some(4), "{out}{errors}");
    assert!(
        out.contains("whole numbers") && !out.contains("cannot judge"),
        "{out}"
    );
}

/// `type_slope_verify_land`: it flares at the altitude of the item, whatever is below.
#[test]
fn a_plane_that_lands_above_home_is_judged_to_its_end_and_fails_without_terrain() {
    let land_at = |above_home_m: f64| {
        let rows = [
            climb_out(),
            waypoint(46.01, 8.0, 60.0),
            waypoint(46.02, 8.0, 60.0),
            Row(21, 3, [0.0; 4], 46.03, 8.0, above_home_m),
        ];
        review(HOME, &rows, &["--no-terrain", "--airframe", "plane"])
    };
    for (above_home_m, words) in [(40.0, "40.0 m above home"), (-100.0, "100.0 m below home")] {
        let (code, out, errors) = land_at(above_home_m);
        assert_eq!(code, Some(4), "{out}{errors}");
        assert!(
            out.contains(words) && out.contains("--terrain") && !out.contains("cannot judge"),
            "{words}: {out}"
        );
    }
    let (code, out, errors) = land_at(5.0);
    assert_eq!(code, Some(0), "{out}{errors}");
}

#[test]
fn an_engine_that_is_started_changes_nothing_and_one_that_is_stopped_does() {
    for (start, passes) in [(1.0, true), (0.0, false)] {
        let rows = [
            climb_out(),
            command(223, [start, 0.0, 0.0, 0.0]),
            waypoint(46.01, 8.0, 60.0),
            waypoint(46.02, 8.0, 60.0),
            Row(21, 3, [0.0; 4], 46.03, 8.0, 0.0),
        ];
        let (code, out, errors) = review(HOME, &rows, &["--no-terrain", "--airframe", "plane"]);
        assert_eq!(code == Some(0), passes, "{start}: {out}{errors}");
        assert!(passes || out.contains("stops the engine"), "{out}");
    }
}

/// `ModeAuto::takeoff_start` and `Mission::calculate_takeoff_altitude`: 1 m above the ground, and
/// `MIS_TAKEOFF_ALT`, at least.
#[test]
fn a_takeoff_to_less_than_the_autopilot_climbs_is_judged_with_what_it_climbs() {
    for (autopilot, min_m) in [("ardupilot", 1.0), ("px4", 2.5)] {
        for above_home_m in [-10.0, 0.0, 0.5] {
            let rows = [
                Row(22, 3, [0.0; 4], 46.0, 8.0, above_home_m),
                waypoint(46.001, 8.0, 50.0),
                land(46.001, 8.0),
            ];
            let flags = [&COPTER[..], &["--autopilot", autopilot]].concat();
            let (code, out, errors) = review(HOME, &rows, &flags);
            let case = format!("{autopilot} {above_home_m}: {out}{errors}");
            // An altitude that is not above home stays a failure of acceptance.
            assert_eq!(code == Some(0), above_home_m > 0.0, "{case}");
            assert!(!out.contains("cannot judge"), "{case}");
            let lowest = format!("altitude above home  {min_m:.1} m");
            let squeezed = out.split_whitespace().collect::<Vec<_>>().join(" ");
            let lowest = lowest.split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(squeezed.contains(&lowest), "{case}");
        }
    }
}

/// `ModeAuto::takeoff_start`: to the altitude, but never down, over the present place.
#[test]
fn a_second_takeoff_of_a_copter_is_a_climb_where_it_is() {
    let rows = |second_m: f64| {
        [
            takeoff_at_home(),
            waypoint(46.001, 8.0, 50.0),
            Row(22, 3, [0.0; 4], 46.02, 8.0, second_m),
            waypoint(46.002, 8.0, 60.0),
            land(46.002, 8.0),
        ]
    };
    let ceiling = [&COPTER[..], &["--max-amsl", "600"]].concat();
    for (second_m, passes) in [(90.0, true), (120.0, false), (20.0, true)] {
        let (code, out, errors) = review(HOME, &rows(second_m), &ceiling);
        assert_eq!(code == Some(0), passes, "{second_m}: {out}{errors}");
        assert!(!out.contains("cannot judge"), "{out}");
    }
    let px4 = [&ceiling[..], &["--autopilot", "px4"]].concat();
    let (code, out, errors) = review(HOME, &rows(90.0), &px4);
    assert_eq!(code, Some(4), "{out}{errors}");
    assert!(out.contains("a second takeoff"), "{out}");
}

/// `Navigator::force_vtol`, with the default of `NAV_FORCE_VT`.
#[test]
fn a_vtol_of_px4_lands_on_rotors_at_a_landing_of_planes() {
    let rows = |landing: u16| {
        [
            Row(84, 3, [0.0; 4], HOME.0, HOME.1, 40.0),
            waypoint(46.01, 8.0, 60.0),
            waypoint(46.02, 8.01, 60.0),
            Row(landing, 3, [0.0; 4], 46.035, 8.01, 0.0),
        ]
    };
    let vtol = ["--no-terrain", "--airframe", "vtol", "--autopilot", "px4"];
    let (code, as_vtol, errors) = review(HOME, &rows(85), &vtol);
    assert_eq!(code, Some(0), "{as_vtol}{errors}");
    let (code, as_plane, errors) = review(HOME, &rows(21), &vtol);
    assert_eq!(code, Some(0), "{as_plane}{errors}");
    assert_eq!(as_plane, as_vtol);
    let (code, out, errors) = review(HOME, &rows(21), &vtol[..3]);
    assert_eq!(code, Some(4), "{out}{errors}");
}

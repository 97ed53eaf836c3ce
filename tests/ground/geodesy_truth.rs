//! Geodesy against PROJ (the numbers and their origin are in `data/geodesy_truth.csv` and
//! `data/geoid_truth.csv`; where the peers are installed PROJ is asked too), and its laws.

use crate::support;

use nalgebra::Vector3;
use proptest::prelude::*;
use sortie::geodesy::{Amsl, EastNorth, Geoid, LatLon, LocalFrame};

const TRUTH: &str = include_str!("../data/geodesy_truth.csv");
const GEOID_TRUTH: &str = include_str!("../data/geoid_truth.csv");
/// A millimetre is promised; PROJ prints micrometres, and those agree.
const REACHED_M: f64 = 2e-6;

struct Row {
    frame: LocalFrame,
    place: LatLon,
    height_m: f64,
    ecef_m: Vector3<f64>,
    enu_m: Vector3<f64>,
}

fn rows() -> Vec<Row> {
    let rows: Vec<Row> = TRUTH
        .lines()
        .filter(|line| !line.starts_with('#') && !line.starts_with("origin"))
        .map(|line| {
            let numbers = line.split(',');
            let numbers: Vec<f64> = numbers
                .map(|number| number.parse().expect("a number"))
                .collect();
            row(&numbers)
        })
        .collect();
    assert!(rows.len() >= 70, "{} rows", rows.len());
    rows
}

fn row(n: &[f64]) -> Row {
    Row {
        frame: LocalFrame::new(LatLon::new(n[0], n[1]).expect("an origin")),
        place: LatLon::new(n[2], n[3]).expect("a place"),
        height_m: n[4],
        ecef_m: Vector3::new(n[5], n[6], n[7]),
        enu_m: Vector3::new(n[8], n[9], n[10]),
    }
}

fn within(what: &str, ours: Vector3<f64>, truth: Vector3<f64>) {
    let off_m = (ours - truth).norm();
    assert!(off_m < REACHED_M, "{what}: {off_m} m off at {truth:?}");
}

#[test]
fn ecef_agrees_with_proj() {
    for row in rows() {
        within("to ECEF", row.place.to_ecef(row.height_m), row.ecef_m);
        let (place, height_m) = LatLon::from_ecef(&row.ecef_m);
        within("from ECEF", place.to_ecef(height_m), row.ecef_m);
        assert!(
            (height_m - row.height_m).abs() < REACHED_M,
            "height at {:?}",
            row.place
        );
        assert!(
            place.chord_m(row.place) < REACHED_M,
            "place at {:?}",
            row.place
        );
    }
}

#[test]
fn the_local_frame_agrees_with_proj() {
    for row in rows() {
        within(
            "to ENU",
            row.frame.to_enu(row.place, row.height_m),
            row.enu_m,
        );
        let (place, height_m) = row.frame.from_enu(&row.enu_m);
        assert!(
            place.chord_m(row.place) < REACHED_M,
            "place at {:?}",
            row.place
        );
        assert!(
            (height_m - row.height_m).abs() < REACHED_M,
            "height at {:?}",
            row.place
        );
    }
}

/// Height does not move a point in the plane, and at height 0 the plane is east and north of ENU.
#[test]
fn planning_coordinates_are_those_of_the_foot_of_the_vertical() {
    for row in rows() {
        let plan = row.frame.to_plan(row.place);
        if row.height_m.abs() < 1e-9 {
            let enu_m = Vector3::new(plan.east_m, plan.north_m, row.enu_m.z);
            within("to plan", enu_m, row.enu_m);
        }
        assert!(
            row.frame.from_plan(plan).chord_m(row.place) < REACHED_M,
            "{:?}",
            row.place
        );
    }
}

/// Asked anew, at places that the table does not hold.
#[test]
fn proj_itself_agrees_to_a_millimetre_in_both_directions() {
    let Some(python) = support::peers::python() else {
        return;
    };
    let answers = support::peers::run(&python, "proj.py", &["42", "300"]);
    let answers: Vec<Vec<f64>> = serde_json::from_value(answers).expect("rows of numbers");
    assert_eq!(answers.len(), 300);
    for row in answers.iter().map(|numbers| row(numbers)) {
        let near = |what: &str, ours: Vector3<f64>, truth: Vector3<f64>| {
            let off_m = (ours - truth).norm();
            assert!(off_m < 1e-3, "{what} of {:?}: {off_m} m off", row.place);
        };
        let ecef_m = row.place.to_ecef(row.height_m);
        near("ECEF", ecef_m, row.ecef_m);
        let enu_m = row.frame.to_enu(row.place, row.height_m);
        near("ENU", enu_m, row.enu_m);
        let (place, height_m) = LatLon::from_ecef(&row.ecef_m);
        near("the place of ECEF", place.to_ecef(height_m), ecef_m);
        let (place, height_m) = row.frame.from_enu(&row.enu_m);
        near("the place of ENU", place.to_ecef(height_m), ecef_m);
    }
}

#[test]
fn the_geoid_agrees_with_proj_to_a_centimetre() {
    let mut rows = 0;
    for line in GEOID_TRUTH
        .lines()
        .filter(|line| !line.starts_with(['#', 'l']))
    {
        let numbers = line.split(',');
        let numbers: Vec<f64> = numbers
            .map(|number| number.parse().expect("a number"))
            .collect();
        let place = LatLon::new(numbers[0], numbers[1]).expect("a place");
        let ours_m = Geoid::egm96().undulation_m(place);
        assert!((ours_m - numbers[2]).abs() < 0.01, "{ours_m} m: {line}");
        rows += 1;
    }
    assert!(rows > 1000, "{rows} rows");
}

/// NGA's own test output for EGM96 (`OUTINTPT.DAT` beside the grid): by splines over
/// the grid of 15 arc-minutes, hence not quite what is bilinear in it.
#[test]
fn the_geoid_has_the_heights_that_nga_published() {
    for (lat_deg, lon_deg, published_m) in [
        (38.628_155, 269.779_155, -31.628),
        (-14.621_217, 305.021_114, -2.969),
        (46.874_319, 102.448_729, -43.575),
        (-23.617_446, 133.874_712, 15.871),
        (38.625_473, 359.999_5, 50.066),
        (-0.466_744, 0.002_3, 17.329),
    ] {
        let ours_m = Geoid::egm96().undulation_m(LatLon { lat_deg, lon_deg });
        assert!(
            (ours_m - published_m).abs() < 0.06,
            "{ours_m}, published {published_m}"
        );
    }
}

#[test]
fn an_altitude_comes_back_from_the_ellipsoid() {
    let everest = LatLon::new(27.988_1, 86.925).expect("a place");
    let geoid = Geoid::egm96();
    let above = Amsl(8848.86).above_ellipsoid(geoid, everest);
    assert!((above.0 - (8848.86 - 28.86)).abs() < 0.2, "{above:?}");
    assert!((above.above_sea(geoid, everest).0 - 8848.86).abs() < 1e-9);
}

fn any_origin() -> impl Strategy<Value = LatLon> {
    let lat_deg = prop_oneof![8 => -90.0..=90.0, 1 => Just(90.0), 1 => Just(-90.0)];
    let lon_deg = prop_oneof![8 => -180.0..=180.0, 1 => Just(180.0), 1 => Just(-180.0)];
    (lat_deg, lon_deg).prop_map(|(lat_deg, lon_deg)| LatLon { lat_deg, lon_deg })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn planning_coordinates_come_back_from_the_earth(
        origin in any_origin(), azimuth_rad in 0.0..std::f64::consts::TAU, range_m in 0.0..=300_000.0,
    ) {
        let frame = LocalFrame::new(origin);
        let plan = EastNorth { east_m: range_m * azimuth_rad.sin(), north_m: range_m * azimuth_rad.cos() };
        let place = frame.from_plan(plan);
        prop_assert!(LatLon::new(place.lat_deg, place.lon_deg).is_ok());
        let back = frame.to_plan(place);
        prop_assert!(back.distance_m(plan) < 1e-7, "{} m", back.distance_m(plan));
        // A tenth of a millimetre is 1e-9 degrees.
        let again = frame.from_plan(back);
        prop_assert!(again.chord_m(place) < 1e-6);
    }

    #[test]
    fn far_planning_coordinates_come_back_too(
        origin in any_origin(), azimuth_rad in 0.0..std::f64::consts::TAU, range_m in 300_000.0..=2_000_000.0,
    ) {
        let frame = LocalFrame::new(origin);
        let plan = EastNorth { east_m: range_m * azimuth_rad.sin(), north_m: range_m * azimuth_rad.cos() };
        let back = frame.to_plan(frame.from_plan(plan));
        prop_assert!(back.distance_m(plan) < 1e-3, "{} m", back.distance_m(plan));
    }

    #[test]
    fn east_north_up_comes_back_from_the_earth(
        origin in any_origin(), east_m in -300_000.0..=300_000.0, north_m in -300_000.0..=300_000.0, up_m in -5000.0..=20_000.0,
    ) {
        let frame = LocalFrame::new(origin);
        let enu_m = Vector3::new(east_m, north_m, up_m);
        let (place, height_m) = frame.from_enu(&enu_m);
        let back_m = frame.to_enu(place, height_m);
        prop_assert!((back_m - enu_m).norm() < 1e-7, "{} m", (back_m - enu_m).norm());
    }

    #[test]
    fn degrees_come_back_from_planning_coordinates(
        lat_deg in -85.0..=85.0, lon_deg in -179.0..=179.0, up_deg in -2.5..=2.5, right_deg in -1.0..=1.0,
    ) {
        let frame = LocalFrame::new(LatLon { lat_deg, lon_deg });
        let place = LatLon { lat_deg: lat_deg + up_deg, lon_deg: lon_deg + right_deg };
        let back = frame.from_plan(frame.to_plan(place));
        prop_assert!((back.lat_deg - place.lat_deg).abs() < 1e-9, "{back:?}");
        prop_assert!((back.lon_deg - place.lon_deg).abs() < 1e-9, "{back:?}");
    }
}

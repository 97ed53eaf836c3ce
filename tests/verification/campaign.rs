//! What `tools/campaign` says of flights.

use crate::support::peers;

/// What it says of a vehicle that holds at a stop and comes back on its way out, late by some seconds.
fn there_and_back(hold_s: &str, late_s: &str) -> Option<(usize, Vec<f64>)> {
    let python = peers::python()?;
    let found = peers::run(&python, "there_and_back.py", &[hold_s, late_s]);
    let escapes = found["escapes"].as_array().expect("a list").len();
    let late_s = found["late_s"].as_array().expect("a list");
    Some((
        escapes,
        late_s
            .iter()
            .filter_map(serde_json::Value::as_f64)
            .collect(),
    ))
}

#[test]
fn a_way_back_over_the_way_out_is_neither_early_nor_late_for_the_other() {
    let Some((escapes, late_s)) = there_and_back("5", "0.5") else {
        return;
    };
    assert_eq!(escapes, 0);
    assert!(
        late_s.len() == 2 && late_s.iter().all(|late_s| (late_s - 0.5).abs() < 0.05),
        "{late_s:?}"
    );
}

#[test]
fn a_flight_that_is_later_than_allowed_escapes() {
    let Some((escapes, _)) = there_and_back("5", "1.5") else {
        return;
    };
    assert!(escapes > 0);
}

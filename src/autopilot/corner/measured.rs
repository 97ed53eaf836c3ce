//! What corners took on simulated copters, beyond the laws of their autopilots.

/// `ArduCopter` 4.6.3, flown 2026-11-23 (simulator, still air) at 10 m/s with 2.5 m/s^2 and default
/// jerk: change of course, degrees, and by how many seconds a leg of 200 m between two such corners took
/// longer than the overlapping profiles say. The mean of radius 2 and 5 m, where both slow down.
/// The entry of 180 degrees continues the line.
const MEASURED_MORE_S: [(f64, f64); 12] = [
    (0.0, 0.0),
    (20.0, 0.0),
    (30.0, -0.4),
    (45.0, -0.4),
    (60.0, -0.1),
    (75.0, 0.0),
    (90.0, 0.1),
    (105.0, 0.2),
    (120.0, 0.3),
    (135.0, 0.4),
    (150.0, 0.55),
    (180.0, 0.8),
];

/// PX4 1.17.0, flown 2026-11-26 (simulator, still air, `MPC_ACC_HOR` 3 m/s^2): change of course, degrees, and by how many
/// seconds longer a corner took than the legs through its waypoint, at each speed of [`MEASURED_AT_MPS`]. The mean of
/// four corners, of the slower acceptance radius of 3 or 4 m and 10 m. 1.18 beta lost at most four fifths of it.
const MEASURED_LATE_S: [(f64, [f64; 3]); 14] = [
    (0.0, [0.0, 0.0, 0.0]),
    (5.0, [0.5, 0.9, 1.2]),
    (10.0, [0.5, 1.0, 1.7]),
    (15.0, [0.9, 2.0, 2.5]),
    (20.0, [1.1, 2.1, 3.1]),
    (30.0, [1.6, 2.9, 4.0]),
    (45.0, [2.2, 3.7, 4.9]),
    (60.0, [3.0, 4.8, 5.6]),
    (75.0, [3.7, 5.4, 6.2]),
    (90.0, [5.0, 5.9, 7.1]),
    (105.0, [5.1, 6.9, 7.9]),
    (120.0, [6.3, 7.5, 8.7]),
    (150.0, [6.7, 8.0, 9.8]),
    (180.0, [6.7, 8.2, 10.5]),
];
/// The speeds of [`MEASURED_LATE_S`], m/s.
const MEASURED_AT_MPS: [f64; 3] = [5.0, 8.0, 10.0];
/// The acceleration with which it was flown, m/s^2.
pub(super) const MEASURED_AT_MPS2: f64 = 3.0;

/// What a leg between two such corners takes longer on `ArduCopter` than its law says, seconds.
pub(super) fn more_s(turn_deg: f64) -> f64 {
    at_turn(&MEASURED_MORE_S, turn_deg)
}

/// By how much longer a corner takes on PX4 than the legs through its waypoint, seconds. Below 5 m/s as at 5, above 10 as
/// from 8 to 10.
pub(super) fn lost_s(turn_deg: f64, speed_mps: f64) -> f64 {
    let at_mps = speed_mps.max(MEASURED_AT_MPS[0]);
    let faster = if at_mps < MEASURED_AT_MPS[1] { 1 } else { 2 };
    let (from_mps, to_mps) = (MEASURED_AT_MPS[faster - 1], MEASURED_AT_MPS[faster]);
    let share = (at_mps - from_mps) / (to_mps - from_mps);
    let rows = MEASURED_LATE_S.map(|(turn_deg, late_s)| {
        let (from_s, to_s) = (late_s[faster - 1], late_s[faster]);
        (turn_deg, from_s + share * (to_s - from_s))
    });
    at_turn(&rows, turn_deg)
}

/// What was measured by change of course, at one, degrees: linear in between.
fn at_turn(rows: &[(f64, f64)], turn_deg: f64) -> f64 {
    let after = rows.partition_point(|(at, _)| *at <= turn_deg);
    let after = after.clamp(1, rows.len() - 1);
    let (from, to) = (rows[after - 1], rows[after]);
    let share = ((turn_deg - from.0) / (to.0 - from.0)).clamp(0.0, 1.0);
    from.1 + (to.1 - from.1) * share
}

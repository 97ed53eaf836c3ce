//! Lines along a strip: those of each of its legs.

use super::line::{Spacing, SweepLine};
use super::survey::{at_least_long, beyond_m, offsets_m};
use crate::geodesy::EastNorth;
use crate::spec::Sensor;

/// The lines over a strip along `line`.
pub(super) fn lines(
    line: &[EastNorth],
    width_m: f64,
    (sensor, agl_m): (&Sensor, f64),
    spacing: Spacing,
) -> Vec<SweepLine> {
    let half_m = sensor.swath_m(agl_m) / 2.0;
    let offsets = offsets_m(width_m, half_m, sensor.lines(), spacing.lines_m);
    let beyond_m = beyond_m(sensor, agl_m, spacing);
    let course = |leg: usize| {
        let (from, to) = (line[leg], line[leg + 1]);
        (to.east_m - from.east_m).atan2(to.north_m - from.north_m)
    };
    let legs = line.len() - 1;
    // The outside of a corner is seen from both of its legs.
    let corner_m = |leg: usize, next: usize| {
        let turned = (course(next) - course(leg)).rem_euclid(std::f64::consts::TAU);
        let turned = turned.min(std::f64::consts::TAU - turned);
        width_m / 2.0 * (turned / 2.0).sin()
    };
    let mut lines = Vec::new();
    for leg in 0..legs {
        let (from, to) = (line[leg], line[leg + 1]);
        let before_m = if leg > 0 { corner_m(leg - 1, leg) } else { 0.0 };
        let after_m = if leg + 1 < legs {
            corner_m(leg, leg + 1)
        } else {
            0.0
        };
        let length_m = from.distance_m(to);
        let (first, last) = at_least_long(-beyond_m - before_m, length_m + beyond_m + after_m);
        let (sin, cos) = course(leg).sin_cos();
        for offset_m in &offsets {
            let right_m = offset_m - width_m / 2.0;
            let at = |along_m: f64| EastNorth {
                east_m: from.east_m + along_m * sin + right_m * cos,
                north_m: from.north_m + along_m * cos - right_m * sin,
            };
            lines.push(SweepLine {
                points: vec![at(first), at(last)],
                is_reversible: true,
            });
        }
    }
    lines
}

//! Whether a wing flies circles.

use std::f64::consts::{PI, TAU};

use crate::geodesy::EastNorth;
use crate::path::heading_rad;

/// A course is taken between places this far apart, metres.
const STEP_M: f64 = 2.0;

/// How far a wing has turned.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Orbit {
    /// The last place that was taken, and the course to it.
    at: Option<EastNorth>,
    course_rad: Option<f64>,
    /// To the right: now, and the least and the most of it so far.
    turned_rad: f64,
    span_rad: (f64, f64),
}

impl Orbit {
    /// Takes in where it is, and returns whether it has turned once around.
    pub(crate) fn is_whole_with(&mut self, at: EastNorth) -> bool {
        self.take(at);
        self.max_rad() >= TAU
    }

    /// The most that it has turned from one place to another, radians.
    pub(crate) fn max_rad(&self) -> f64 {
        self.span_rad.1 - self.span_rad.0
    }

    /// Takes in where it is.
    pub(crate) fn take(&mut self, at: EastNorth) {
        let Some(before) = self.at else {
            self.at = Some(at);
            return;
        };
        if before.distance_m(at) >= STEP_M {
            let course_rad = heading_rad(before, at);
            if let Some(last_rad) = self.course_rad {
                self.turned_rad += (course_rad - last_rad + PI).rem_euclid(TAU) - PI;
                let (min_rad, max_rad) = self.span_rad;
                self.span_rad = (min_rad.min(self.turned_rad), max_rad.max(self.turned_rad));
            }
            (self.at, self.course_rad) = (Some(at), Some(course_rad));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_ahead_is_no_orbit_and_a_circle_to_either_side_is_one() {
        let mut ahead = Orbit::default();
        let east = |east_m| EastNorth {
            east_m,
            north_m: 0.0,
        };
        assert!((0..500).all(|step| !ahead.is_whole_with(east(f64::from(step) * 4.0))));
        for side in [1.0, -1.0] {
            let mut orbit = Orbit::default();
            let on = |step: i32| {
                let (sin, cos) = (f64::from(step) * 0.05 * side).sin_cos();
                EastNorth {
                    east_m: 80.0 * sin,
                    north_m: 80.0 * cos,
                }
            };
            let done = (0..).find(|step| orbit.is_whole_with(on(*step)));
            assert!((126..=128).contains(&done.unwrap_or(0)), "{done:?}");
        }
    }
}

//! The steady wind of a spec.

/// A steady wind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wind {
    /// Direction it blows from, radians clockwise from north.
    pub from_rad: f64,
    /// Speed, m/s.
    pub speed_mps: f64,
}

/// Least ground speed at which a wing holds a course, m/s.
const MIN_GROUND_MPS: f64 = 1.0;

impl Wind {
    /// How the air moves, east and north, m/s.
    #[must_use]
    pub fn velocity_mps(&self) -> [f64; 2] {
        let (sin, cos) = self.from_rad.sin_cos();
        [-self.speed_mps * sin, -self.speed_mps * cos]
    }

    /// Ground speed of a vehicle that holds a course in the wind by crabbing, from the wind
    /// triangle: `sqrt(airspeed^2 - across^2) + along`, m/s. None where the wind is too strong
    /// to hold the course (radians clockwise from north) at 1 m/s.
    #[must_use]
    pub fn ground_speed_mps(&self, airspeed_mps: f64, course_rad: f64) -> Option<f64> {
        let off_rad = course_rad - self.from_rad;
        let (across_mps, against_mps) = (
            self.speed_mps * off_rad.sin(),
            self.speed_mps * off_rad.cos(),
        );
        let ahead = airspeed_mps * airspeed_mps - across_mps * across_mps;
        let ground_mps = ahead.max(0.0).sqrt() - against_mps;
        (ahead > 0.0 && ground_mps >= MIN_GROUND_MPS).then_some(ground_mps)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use proptest::prelude::*;

    use super::Wind;

    proptest! {
        /// Heads through the air where the track comes out on the course, found by bisection.
        #[test]
        fn the_velocities_through_the_air_and_of_the_air_add_up_to_the_track(
            airspeed_mps in 8.0..40.0_f64,
            share in 0.0..0.8_f64,
            from_rad in 0.0..TAU,
            course_rad in 0.0..TAU,
        ) {
            let wind = Wind { from_rad, speed_mps: share * airspeed_mps };
            let track = |crab_rad: f64| {
                let heading_rad = course_rad + crab_rad;
                let towards_rad = from_rad + PI;
                (
                    airspeed_mps * heading_rad.sin() + wind.speed_mps * towards_rad.sin(),
                    airspeed_mps * heading_rad.cos() + wind.speed_mps * towards_rad.cos(),
                )
            };
            // Positive: the track lies clockwise of the course.
            let off_course = |(east, north): (f64, f64)| {
                east * course_rad.cos() - north * course_rad.sin()
            };
            let (mut left, mut right) = (-0.5 * PI, 0.5 * PI);
            for _ in 0..60 {
                let middle = 0.5 * (left + right);
                if off_course(track(middle)) < 0.0 { left = middle } else { right = middle }
            }
            let (east, north) = track(0.5 * (left + right));
            let found = wind.ground_speed_mps(airspeed_mps, course_rad).expect("a weaker wind");
            prop_assert!((found - east.hypot(north)).abs() < 1e-6, "{found} {east} {north}");
        }
    }

    #[test]
    fn a_wing_is_as_fast_over_the_ground_as_the_wind_allows() {
        let wind = Wind {
            from_rad: 1.5 * PI,
            speed_mps: 6.0,
        };
        let on = |airspeed_mps, course_deg: f64| {
            wind.ground_speed_mps(airspeed_mps, course_deg.to_radians())
        };
        let near = |found: Option<f64>, expected: f64| {
            assert!(
                found.is_some_and(|mps| (mps - expected).abs() < 1e-9),
                "{found:?}"
            );
        };
        near(on(10.0, 90.0), 16.0);
        near(on(10.0, 270.0), 4.0);
        near(on(10.0, 0.0), 8.0);
        assert_eq!(on(5.5, 0.0), None, "across, and stronger");
        assert_eq!(
            on(6.5, 270.0),
            None,
            "half a metre a second against the wind"
        );
    }
}

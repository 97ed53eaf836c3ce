//! How fast a vehicle covers a distance at whose end it comes to rest.

/// Speed along a path of known length: constant acceleration to the cruise
/// speed, cruise, constant deceleration to rest; a triangle when the path is
/// too short to reach the cruise speed. A path that begins in motion is the rest of a longer one
/// that begins at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedProfile {
    /// From rest to rest.
    length_m: f64,
    /// Length and duration before the path begins, metres and seconds.
    before_m: f64,
    before_s: f64,
    accel_mps2: f64,
    peak_mps: f64,
    ramp_m: f64,
    duration_s: f64,
}

impl SpeedProfile {
    /// A profile over `length_m` (at least 0) with positive speed and acceleration.
    #[must_use]
    pub fn new(length_m: f64, cruise_mps: f64, accel_mps2: f64) -> Self {
        Self::from_speed(length_m, 0.0, cruise_mps, accel_mps2)
    }

    /// The same, begun at `initial_mps`, or the greatest speed up to that from which the vehicle
    /// comes to rest in time.
    #[must_use]
    pub fn from_speed(length_m: f64, initial_mps: f64, cruise_mps: f64, accel_mps2: f64) -> Self {
        let initial_mps = initial_mps
            .min(cruise_mps)
            .min((2.0 * length_m * accel_mps2).sqrt());
        let before_m = initial_mps * initial_mps / (2.0 * accel_mps2);
        let length_m = length_m + before_m;
        let peak_mps = cruise_mps.min((length_m * accel_mps2).sqrt());
        let duration_s = if peak_mps > 0.0 {
            length_m / peak_mps + peak_mps / accel_mps2
        } else {
            0.0
        };
        Self {
            length_m,
            before_m,
            before_s: initial_mps / accel_mps2,
            accel_mps2,
            peak_mps,
            ramp_m: peak_mps * peak_mps / (2.0 * accel_mps2),
            duration_s,
        }
    }

    /// Length of the path, metres.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.length_m - self.before_m
    }

    /// Seconds to the end of the path.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.duration_s - self.before_s
    }

    /// Metres needed to reach the peak speed from rest, and to come to rest again.
    #[must_use]
    pub fn ramp_m(&self) -> f64 {
        self.ramp_m
    }

    /// Seconds after which `distance_m` lies behind; clamped to the path.
    #[must_use]
    pub fn time_at_s(&self, distance_m: f64) -> f64 {
        if self.peak_mps <= 0.0 {
            return 0.0;
        }
        let distance_m = (distance_m + self.before_m).clamp(self.before_m, self.length_m);
        let left_m = self.length_m - distance_m;
        let since_rest_s = if distance_m <= self.ramp_m() {
            (2.0 * distance_m / self.accel_mps2).sqrt()
        } else if left_m <= self.ramp_m() {
            self.duration_s - (2.0 * left_m / self.accel_mps2).sqrt()
        } else {
            self.peak_mps / (2.0 * self.accel_mps2) + distance_m / self.peak_mps
        };
        since_rest_s - self.before_s
    }

    /// Metres covered after `time_s`; clamped to the path.
    #[must_use]
    pub fn distance_at_m(&self, time_s: f64) -> f64 {
        let duration_s = self.duration_s;
        let time_s = (time_s + self.before_s).clamp(self.before_s, duration_s);
        let ramp_s = self.peak_mps / self.accel_mps2;
        let from_rest_m = if time_s <= ramp_s {
            0.5 * self.accel_mps2 * time_s * time_s
        } else if time_s >= duration_s - ramp_s {
            let left_s = duration_s - time_s;
            self.length_m - 0.5 * self.accel_mps2 * left_s * left_s
        } else {
            self.ramp_m() + (time_s - ramp_s) * self.peak_mps
        };
        from_rest_m - self.before_m
    }
}

#[cfg(test)]
mod tests {
    use super::SpeedProfile;

    #[test]
    fn time_and_distance_are_inverse_and_a_long_path_takes_length_over_speed_plus_one_ramp() {
        for (length_m, cruise_mps, accel_mps2) in
            [(1000.0, 15.0, 2.5), (20.0, 15.0, 2.5), (0.0, 5.0, 1.0)]
        {
            let profile = SpeedProfile::new(length_m, cruise_mps, accel_mps2);
            for step in 0..=20 {
                let distance_m = length_m * f64::from(step) / 20.0;
                let back_m = profile.distance_at_m(profile.time_at_s(distance_m));
                assert!(
                    (back_m - distance_m).abs() < 1e-9,
                    "{distance_m} came back as {back_m}"
                );
            }
        }
        let profile = SpeedProfile::new(1000.0, 10.0, 2.0);
        assert!((profile.duration_s() - 105.0).abs() < 1e-12);
    }

    #[test]
    fn a_path_begun_in_motion_saves_half_a_ramp_and_never_begins_too_fast_to_stop() {
        let profile = SpeedProfile::from_speed(1000.0, 10.0, 10.0, 2.0);
        assert!((profile.duration_s() - 102.5).abs() < 1e-9);
        assert!((profile.time_at_s(500.0) - 50.0).abs() < 1e-9);
        assert!((profile.distance_at_m(profile.time_at_s(30.0)) - 30.0).abs() < 1e-9);
        let braking = SpeedProfile::from_speed(16.0, 30.0, 10.0, 2.0);
        assert!((braking.length_m() - 16.0).abs() < 1e-9);
        assert!((braking.duration_s() - 4.0).abs() < 1e-9);
    }
}

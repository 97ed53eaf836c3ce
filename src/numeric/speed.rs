//! How fast a vehicle covers a distance when it starts and ends at rest.

/// Speed along a path of known length: constant acceleration to the cruise
/// speed, cruise, constant deceleration to rest; a triangle when the path is
/// too short to reach the cruise speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedProfile {
    length_m: f64,
    accel_mps2: f64,
    peak_mps: f64,
    ramp_m: f64,
    duration_s: f64,
}

impl SpeedProfile {
    /// A profile over `length_m` (at least 0) with positive speed and acceleration.
    #[must_use]
    pub fn new(length_m: f64, cruise_mps: f64, accel_mps2: f64) -> Self {
        let peak_mps = cruise_mps.min((length_m * accel_mps2).sqrt());
        let duration_s = if peak_mps > 0.0 {
            length_m / peak_mps + peak_mps / accel_mps2
        } else {
            0.0
        };
        Self {
            length_m,
            accel_mps2,
            peak_mps,
            ramp_m: peak_mps * peak_mps / (2.0 * accel_mps2),
            duration_s,
        }
    }

    /// Length of the path, metres.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    /// Seconds from rest to rest.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Metres needed to reach the peak speed.
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
        let distance_m = distance_m.clamp(0.0, self.length_m);
        let left_m = self.length_m - distance_m;
        if distance_m <= self.ramp_m() {
            (2.0 * distance_m / self.accel_mps2).sqrt()
        } else if left_m <= self.ramp_m() {
            self.duration_s() - (2.0 * left_m / self.accel_mps2).sqrt()
        } else {
            self.peak_mps / (2.0 * self.accel_mps2) + distance_m / self.peak_mps
        }
    }

    /// Metres covered after `time_s`; clamped to the path.
    #[must_use]
    pub fn distance_at_m(&self, time_s: f64) -> f64 {
        let duration_s = self.duration_s();
        let time_s = time_s.clamp(0.0, duration_s);
        let ramp_s = self.peak_mps / self.accel_mps2;
        if time_s <= ramp_s {
            0.5 * self.accel_mps2 * time_s * time_s
        } else if time_s >= duration_s - ramp_s {
            let left_s = duration_s - time_s;
            self.length_m - 0.5 * self.accel_mps2 * left_s * left_s
        } else {
            self.ramp_m() + (time_s - ramp_s) * self.peak_mps
        }
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
}

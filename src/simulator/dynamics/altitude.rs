//! How the altitude of a wing follows what is asked for.

use crate::simulator::parameters::{Follows, WingLimits};

/// Where the demand has come to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Height {
    /// No faster than the vehicle climbs and sinks.
    limited_m: f64,
    /// Filtered.
    filtered_m: f64,
}

impl Height {
    /// At rest at an altitude.
    pub(crate) fn at(amsl_m: f64) -> Self {
        Self {
            limited_m: amsl_m,
            filtered_m: amsl_m,
        }
    }

    /// The climb that follows an altitude demand; on an approach ArduPlane makes good what its
    /// filter delays.
    pub(crate) fn climb_mps(
        &mut self,
        demand_m: f64,
        here_m: f64,
        on_approach: bool,
        limits: &WingLimits,
        dt_s: f64,
    ) -> f64 {
        let (up_m, down_m) = (limits.climb_mps * dt_s, limits.sink_mps * dt_s);
        let moved_m = (demand_m - self.limited_m).clamp(-down_m, up_m);
        self.limited_m += moved_m;
        let climb_mps = match limits.follows {
            Follows::Filtered { filter_s, error_s } => {
                let rate_mps = (self.limited_m - self.filtered_m) / filter_s;
                self.filtered_m += (self.limited_m - self.filtered_m) * dt_s / (dt_s + filter_s);
                let made_good_m = if on_approach {
                    filter_s * rate_mps
                } else {
                    0.0
                };
                rate_mps + (self.filtered_m + made_good_m - here_m) / error_s
            }
            Follows::Shared {
                error_s,
                rate_share,
            } => rate_share * moved_m / dt_s + (self.limited_m - here_m) / error_s,
        };
        climb_mps.clamp(-limits.sink_mps, limits.climb_mps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulator::parameters::Settings;
    use crate::simulator::profile::Profile;
    use crate::spec::Airframe;

    /// How far below a climb of 1 m/s it is after a while, metres.
    fn lag_m(profile: Profile) -> f64 {
        let limits = Settings::of(profile, Airframe::Plane).wing();
        let (mut height, mut here_m, dt_s) = (Height::at(0.0), 0.0, 0.05);
        for step in 1..=1200 {
            let demand_m = f64::from(step) * dt_s;
            here_m += height.climb_mps(demand_m, here_m, false, &limits, dt_s) * dt_s;
        }
        60.0 - here_m
    }

    #[test]
    fn a_wing_is_some_seconds_of_its_climb_below_a_slope() {
        // As measured on ArduPlane; by the gains of PX4, (1 - 0.3) * 5 s.
        assert!((lag_m(Profile::ArduPilot) - 3.0).abs() < 0.2);
        assert!((lag_m(Profile::Px4) - 3.5).abs() < 0.2);
    }
}

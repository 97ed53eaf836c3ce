//! The way that PX4 flies along legs: its `NPFG` (`DirectionalGuidance::guideToPath`) gives a course towards the leg, and
//! `AirspeedDirectionController` turns the heading to it.

use std::f64::consts::FRAC_PI_2;

use crate::autopilot::Version;
use crate::mission::VehicleMission;

use super::line::Line;

/// Acceleration across for an error of the heading, a share of the airspeed a second
/// (`AirspeedDirectionController::p_gain_`, which no parameter sets).
const HEADING_GAIN: f64 = 0.8885;
/// Since 1.18 the navigator has the switch distance of the guidance (`fw_guidance_status`); 1.17 lost it.
const SWITCHES_EARLY: Version = Version {
    major: 1,
    minor: 18,
};

/// What steers a wing of PX4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Npfg {
    /// `NPFG_PERIOD * NPFG_DAMPING`, seconds.
    time_s: f64,
    /// `NPFG_SW_DST_MLT`.
    switch_share: f64,
    /// `NAV_ACC_RAD`, metres.
    accept_m: f64,
    /// Takes the next leg within the switch distance already.
    early: bool,
}

impl Npfg {
    /// Of a mission; none where the autopilot has no such parameters.
    pub(super) fn of(mission: &VehicleMission) -> Option<Self> {
        let held = |name: &str| mission.param_si(name).filter(|value| *value > 0.0);
        let facts = mission.facts();
        let value = |name: &str| Some(held(name).unwrap_or(facts.parameter(name)?.default_si()));
        Some(Self {
            time_s: value("NPFG_PERIOD")? * value("NPFG_DAMPING")?,
            switch_share: value("NPFG_SW_DST_MLT")?,
            accept_m: value("NAV_ACC_RAD")?,
            early: false,
        })
    }

    /// The ways in which this version takes the next leg: 1.17 was flown, later ones may take it earlier.
    pub(super) fn variants(self, version: Option<Version>) -> [Option<Self>; 2] {
        let is_early = version.is_some_and(|version| version >= SWITCHES_EARLY);
        let early = Self {
            early: true,
            ..self
        };
        [Some(self), is_early.then_some(early)]
    }

    /// So far before a waypoint the next leg is turned onto, metres.
    pub(super) fn turn_distance_m(&self, ground_mps: f64) -> f64 {
        match self.early {
            true => self.accept_m.max(self.switch_m(ground_mps)),
            false => self.accept_m,
        }
    }

    fn switch_m(&self, ground_mps: f64) -> f64 {
        self.switch_share * self.bound_m(ground_mps)
    }

    /// From so far beside a leg the guidance flies straight onto it, metres.
    fn bound_m(&self, ground_mps: f64) -> f64 {
        self.time_s * ground_mps.max(1.0)
    }

    /// The acceleration across that it asks for, m/s^2, to the left, of a wing at a place that heads `heading_rad` through
    /// the air with `air_mps` and makes `ground_mps` over the ground.
    pub(super) fn demand_mps2(
        &self,
        (line, at): (&Line, [f64; 2]),
        (heading_rad, air_mps, ground_mps): (f64, f64, f64),
        [east_mps, north_mps]: [f64; 2],
    ) -> f64 {
        let gone = line.gone(at);
        let off_m = gone[0].hypot(gone[1]);
        let mut bearing = line.unit;
        if line.ahead(gone) < 0.0 && off_m > self.switch_m(ground_mps) {
            // Far before the leg it heads for its beginning.
            bearing = gone.map(|part| -part / off_m);
        } else {
            let right_m = line.right(gone);
            let share = (right_m.abs() / self.bound_m(ground_mps)).min(1.0);
            let (along, across) = (FRAC_PI_2 * (share - 1.0).powi(2)).sin_cos();
            let [east, north] = line.unit;
            let left = right_m.signum() * across;
            bearing = [
                along * bearing[0] - left * north,
                along * bearing[1] + left * east,
            ];
        }
        // The heading that makes that course in the wind.
        let across_mps = east_mps * bearing[1] - north_mps * bearing[0];
        let ahead_mps = (air_mps * air_mps - across_mps * across_mps)
            .max(0.0)
            .sqrt();
        let heading = [
            ahead_mps * bearing[0] - across_mps * bearing[1],
            across_mps * bearing[0] + ahead_mps * bearing[1],
        ];
        let (sin, cos) = heading_rad.sin_cos();
        let error_rad =
            (cos * heading[1] - sin * heading[0]).atan2(cos * heading[0] + sin * heading[1]);
        HEADING_GAIN * air_mps * error_rad.clamp(-FRAC_PI_2, FRAC_PI_2).sin()
    }
}

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

/// Where the heading is further off than this, PX4 may turn either way: in the wind it goes through 180 degrees, radians.
const EITHER_WAY_RAD: f64 = 150.0 * std::f64::consts::PI / 180.0;

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
    /// Turns to the left (1) or to the right (-1) where it may turn either way.
    side: f64,
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
            side: 1.0,
        })
    }

    /// The ways in which this version may take the next leg, turning to the left where it may turn either way: 1.17 was
    /// flown, later ones may take it earlier. Without a version it may be any of them.
    pub(super) fn variants(self, version: Option<Version>) -> impl Iterator<Item = Self> {
        let is_early = version.is_none_or(|version| version >= SWITCHES_EARLY);
        let earlier = Self {
            early: true,
            ..self
        };
        std::iter::once(self).chain(is_early.then_some(earlier))
    }

    pub(super) fn to_the_right(self) -> Self {
        Self { side: -1.0, ..self }
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
    /// the air with `air_mps` and makes `ground_mps` over the ground; and whether it might turn to the other side.
    pub(super) fn demand_mps2(
        &self,
        (line, at): (&Line, [f64; 2]),
        (heading_rad, air_mps, ground_mps): (f64, f64, f64),
        [east_mps, north_mps]: [f64; 2],
    ) -> (f64, bool) {
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
        let mut error_rad =
            (cos * heading[1] - sin * heading[0]).atan2(cos * heading[0] + sin * heading[1]);
        let is_either_way = error_rad.abs() > EITHER_WAY_RAD;
        if is_either_way {
            error_rad = self.side * error_rad.abs();
        }
        let demand_mps2 = HEADING_GAIN * air_mps * error_rad.clamp(-FRAC_PI_2, FRAC_PI_2).sin();
        (demand_mps2, is_either_way)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::guidance::{Guidance, Law, Way};
    use super::Npfg;
    use crate::autopilot::{Airframe, Autopilot, Version, facts};
    use crate::geodesy::EastNorth;
    use crate::verify::execute::legs::Knot;
    use crate::verify::measure::segment::Phase;

    const V1_17: Version = Version {
        major: 1,
        minor: 17,
    };

    pub(in crate::verify::execute::wing) fn guidance() -> Guidance {
        let behaviour = facts(Autopilot::Px4, Airframe::Plane).behaviour;
        let npfg = Npfg {
            time_s: 7.0,
            switch_share: 0.32,
            accept_m: 5.0,
            early: false,
            side: 1.0,
        };
        Guidance {
            law: Law::Npfg(npfg),
            pace: 1.0,
            faster_share: 0.0,
            slower_share: 0.0,
            bank_rad: (1.0_f64 / 1.2).acos(),
            turning_share: behaviour.turning_share.value(None),
            bank_lag_s: behaviour.bank_lag_s.value(None),
            wind_mps: None,
        }
    }

    fn knots(points: &[(f64, f64)]) -> Vec<Knot> {
        let knot = |&(east_m, north_m): &(f64, f64)| Knot {
            row: 1,
            at: EastNorth { east_m, north_m },
            amsl_m: 664.0,
            agl_m: None,
            speed_mps: 13.0,
            speed_is_known: true,
            phase: Phase::Route,
            slope_from_m: None,
            accept_m: 5.0,
        };
        points.iter().map(knot).collect()
    }

    /// Seed 814 of the campaign: places of its mission, and where 1.17 of January 2026 had its simulated plane in still air.
    const CORNERS: [(f64, f64); 7] = [
        (0.0, 682.0),
        (0.0, 726.0),
        (-59.0, 727.0),
        (-62.0, 523.0),
        (-7.0, 518.0),
        (0.0, 560.0),
        (88.0, 1092.0),
    ];
    const FLOWN: [(f64, f64); 13] = [
        (-9.0, 746.0),
        (-31.0, 750.0),
        (-61.0, 731.0),
        (-79.0, 717.0),
        (-81.0, 705.0),
        (-67.0, 672.0),
        (-60.0, 638.0),
        (-58.0, 507.0),
        (-37.0, 497.0),
        (-15.0, 506.0),
        (7.0, 517.0),
        (16.0, 539.0),
        (13.0, 551.0),
    ];

    #[test]
    fn corners_are_flown_as_a_simulated_plane_flew_them() {
        let fixes = guidance().follow(&knots(&CORNERS), &[13.4; 6]).fixes;
        let mut furthest_m = 0.0_f64;
        for (east_m, north_m) in FLOWN {
            let flown = EastNorth { east_m, north_m };
            let off_m = fixes.iter().map(|fix| fix.at.distance_m(flown));
            let off_m = off_m.fold(f64::INFINITY, f64::min);
            assert!(off_m < 12.0, "{flown:?}: {off_m} m");
            furthest_m = furthest_m.max(off_m);
        }
        // The planned speed is more than the flown one, so that the way of the verdict is the wider one.
        assert!(furthest_m > 1.0, "{furthest_m}");
        let aside_m = fixes
            .iter()
            .map(|fix| fix.cross_track_m)
            .fold(0.0, f64::max);
        assert!(aside_m > 25.0, "{aside_m}");
    }

    #[test]
    fn a_later_version_or_an_unknown_one_may_turn_earlier_and_both_ways_are_judged() {
        let knots = knots(&[(0.0, 0.0), (600.0, 0.0), (600.0, 600.0)]);
        let ways = |version| guidance().ways(version, |way| way.follow(&knots, &[13.4; 2]));
        assert_eq!(ways(None).len(), 2);
        assert_eq!(ways(Some(V1_17)).len(), 1);
        let later = ways(Some(Version { minor: 18, ..V1_17 }));
        assert_eq!(later.len(), 2);
        let furthest_m = |way: &Way| {
            way.fixes
                .iter()
                .map(|fix| fix.at.east_m)
                .fold(0.0, f64::max)
        };
        let (late_m, early_m) = (furthest_m(&later[0]), furthest_m(&later[1]));
        assert!(late_m > 625.0 && early_m < 615.0, "{late_m} {early_m}");
    }

    #[test]
    fn a_plane_that_turns_back_is_judged_turning_either_way() {
        let knots = knots(&[(0.0, 0.0), (0.0, 766.0), (-30.0, 600.0)]);
        let ways = guidance().ways(Some(V1_17), |way| way.follow(&knots, &[12.3, 12.3]));
        let [left, right] = [0, 1].map(|way: usize| {
            let east_m = ways[way].fixes.iter().map(|fix| fix.at.east_m);
            east_m.fold((0.0_f64, 0.0_f64), |(low, high), at| {
                (low.min(at), high.max(at))
            })
        });
        assert!(left.0 < -40.0 && left.1 < 1.0, "{left:?}");
        assert!(right.1 > 40.0, "{right:?}");
    }

    #[test]
    fn a_straight_leg_is_flown_straight_in_the_wind_too() {
        let windy = Guidance {
            wind_mps: Some([3.0, -5.0]),
            ..guidance()
        };
        let fixes = windy
            .follow(
                &knots(&[(0.0, 0.0), (800.0, 300.0), (1600.0, 600.0)]),
                &[12.0; 2],
            )
            .fixes;
        // The last step may lead past the end.
        let (_, on_legs) = fixes.split_last().expect("a way");
        assert!(on_legs.iter().all(|fix| fix.cross_track_m < 0.5));
    }
}

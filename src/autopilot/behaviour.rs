//! Measured behaviour: figures that the verdict assumes, with their sources.

use std::fmt;

use super::Version;

/// One measured figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The value that the verdict assumes: the worst of the samples, rounded to the safe side.
    pub value: f64,
    /// Its unit; empty for a share.
    pub unit: &'static str,
    /// The firmware that was measured.
    pub version: Version,
    /// Flights that were measured; 0: from the sources, or assumed.
    pub samples: u32,
    /// What was measured and how.
    pub source: &'static str,
}

/// Shorthand for tables: value and unit, version, samples, source.
pub(super) const fn measured(
    (value, unit): (f64, &'static str),
    version: Version,
    samples: u32,
    source: &'static str,
) -> Measured {
    Measured {
        value,
        unit,
        version,
        samples,
        source,
    }
}

impl fmt::Display for Measured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.value)?;
        if self.unit.is_empty() {
            Ok(())
        } else {
            write!(f, " {}", self.unit)
        }
    }
}

/// Measurements of one figure, of one or more versions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    /// One for each version that was measured.
    pub rows: &'static [Measured],
    worst: Worst,
}

/// Which value of a figure is the worst.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Worst {
    Greatest,
    Least,
}

impl Figure {
    /// A figure that is the worse the greater it is, like a lateness.
    pub(super) const fn greatest(rows: &'static [Measured]) -> Self {
        let worst = Worst::Greatest;
        Self { rows, worst }
    }

    /// One that is the worse the less it is, like a speed that is reached.
    pub(super) const fn least(rows: &'static [Measured]) -> Self {
        let worst = Worst::Least;
        Self { rows, worst }
    }

    /// The measurement that applies to a version: the worst of its own, or, where the version is
    /// not known or was not measured, the worst of all.
    #[must_use]
    pub fn of(self, version: Option<Version>) -> Option<&'static Measured> {
        let worst = |only: Option<Version>| {
            let applies = |figure: &&Measured| only.is_none_or(|only| figure.version == only);
            let figures = self.rows.iter().filter(applies);
            let size = |a: &&Measured, b: &&Measured| a.value.abs().total_cmp(&b.value.abs());
            match self.worst {
                Worst::Greatest => figures.max_by(size),
                Worst::Least => figures.min_by(size),
            }
        };
        version
            .and_then(|version| worst(Some(version)))
            .or_else(|| worst(None))
    }

    /// The value for a version; 0 without a measurement.
    #[must_use]
    pub fn value(self, version: Option<Version>) -> f64 {
        self.of(version).map_or(0.0, |figure| figure.value)
    }
}

impl fmt::Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.of(None) {
            Some(figure) => figure.fmt(f),
            None => f.write_str("nothing"),
        }
    }
}

/// No measurement: the verdict assumes 0.
pub(super) const NONE: Figure = Figure::greatest(&[]);

/// How one airframe of one autopilot deviates from straight legs flown on time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Behaviour {
    /// The vehicle may be this early from its takeoff on, seconds.
    pub takeoff_early_s: Figure,
    /// Since its takeoff the vehicle may have gained this share of the time, besides.
    pub early_share: Figure,
    /// The vehicle may be this late from its takeoff on, seconds. Two vehicles of one autopilot
    /// and airframe are equally late within 5.5 s, which `time_slack_s` covers.
    pub takeoff_late_s: Figure,
    /// It may have lost up to this much at the end of its climb, more or less than others of its kind, seconds.
    pub climb_late_s: Figure,
    /// A wing may fly faster through the air than planned by this share.
    pub faster_share: Figure,
    /// In wind, or slower by this share.
    pub slower_share: Figure,
    /// A stop may take this much longer than in the flight model, seconds.
    pub stop_late_s: Figure,
    /// A leg may take this much longer than in the flight model, seconds.
    pub leg_late_s: Figure,
    /// A leg may take this share of its time longer than in the flight model, besides, where heights are flown at once.
    pub late_share: Figure,
    /// A corner that the vehicle slows down for may take this much longer than in the flight
    /// model, seconds.
    pub corner_late_s: Figure,
    /// On a climbing leg the vehicle lags the commanded altitude by this time its climb rate,
    /// seconds.
    pub altitude_lag_s: Figure,
    /// On legs that descend from a climb on rotors the vehicle is above them by this time of their descent,
    /// seconds.
    pub transition_lag_s: Figure,
    /// A plane may reach the height of its takeoff after this share of the planned climb.
    pub climb_out_share: Figure,
    /// And after this share at the latest, as far as planes were flown.
    pub climb_out_last_share: Figure,
    /// A plane may exceed the height of its takeoff by this before it levels off, metres.
    pub climb_out_overshoot_m: Figure,
    /// During its planned climb the vehicle is driven off with this share of the speed of the wind:
    /// a plane downwind, a QuadPlane on its rotors to any side.
    pub drift_share: Figure,
    /// After the climb the wind carries a QuadPlane for this time, seconds.
    pub drift_s: Figure,
    /// In its descent the wind from behind drives a QuadPlane off to any side, as far as it goes in
    /// this time, seconds.
    pub landing_drift_s: Figure,
    /// A QuadPlane comes to rest within this of the place that it lands at, before it descends, metres.
    pub landing_overshoot_m: Figure,
    /// A QuadPlane is in forward flight this far from the end of its climb at most, where its nose
    /// points, and turns from there, metres.
    pub transition_m: Figure,
    /// The wind up to which these figures hold, m/s: in more the verdict fails.
    pub max_wind_mps: Figure,
    /// On a circle a wing is further out than its radius by up to this share of its turn radius.
    pub circle_wide_share: Figure,
    /// On a circle and the leg to it a wing is off its altitude by up to this, besides its lag, metres.
    pub circle_level_m: Figure,
    /// Share of `g tan(bank)` that turns the wing under the L1 law.
    pub turning_share: Figure,
    /// Time constant of the bank under the L1 law, seconds.
    pub bank_lag_s: Figure,
    /// The greatest speed that a stock copter reaches in still air at its lean limit, m/s: the
    /// least of what was measured.
    pub lean_speed_mps: Figure,
    /// The lean angle that a stock copter is limited to, degrees; 0 on a wing.
    pub lean_deg: f64,
    /// Speed below [`super::SLOW_LANDING_M`] in a landing on rotors, m/s. Every plan sets it
    /// (`LAND_SPEED`, `MPC_LAND_SPEED`, `Q_LAND_FINAL_SPD`).
    pub slow_landing_mps: f64,
}

/// The greatest lean angle that a plan asks of a copter, degrees: its thrust is then 1.56 times its
/// weight, and of a copter built for twice its weight a fifth is left for climbs and attitude.
pub const MAX_LEAN_DEG: f64 = 50.0;

impl Behaviour {
    /// The speed through the air that a copter reaches at a lean angle, m/s: from the measured one,
    /// with a drag that grows with the square of the speed. (Drag of rotors grows more slowly, so
    /// that the speed at a greater angle is underestimated.) None where none was measured.
    #[must_use]
    pub fn speed_at_lean_mps(&self, version: Option<Version>, lean_deg: f64) -> Option<f64> {
        let reached = self.lean_speed_mps.of(version)?;
        let drag = lean_deg.to_radians().tan() / self.lean_deg.to_radians().tan();
        Some(reached.value * drag.max(0.0).sqrt())
    }

    /// The lean angle that a copter needs for a speed through the air, whole degrees and no less
    /// than the stock one: the inverse of [`Self::speed_at_lean_mps`].
    #[must_use]
    pub fn lean_for_speed_deg(&self, version: Option<Version>, speed_mps: f64) -> Option<f64> {
        let reached = self.lean_speed_mps.of(version)?;
        let drag = (speed_mps / reached.value).powi(2);
        let lean_deg = (drag * self.lean_deg.to_radians().tan())
            .atan()
            .to_degrees();
        // A stock one that was measured at that very speed is not asked for more.
        Some((lean_deg - 1e-6).ceil().max(self.lean_deg))
    }

    /// Every measured figure with its name, for documents and tests.
    #[must_use]
    pub fn figures(&self) -> [(&'static str, Figure); 26] {
        [
            ("takeoff_early_s", self.takeoff_early_s),
            ("early_share", self.early_share),
            ("takeoff_late_s", self.takeoff_late_s),
            ("climb_late_s", self.climb_late_s),
            ("faster_share", self.faster_share),
            ("slower_share", self.slower_share),
            ("stop_late_s", self.stop_late_s),
            ("leg_late_s", self.leg_late_s),
            ("late_share", self.late_share),
            ("corner_late_s", self.corner_late_s),
            ("altitude_lag_s", self.altitude_lag_s),
            ("transition_lag_s", self.transition_lag_s),
            ("climb_out_share", self.climb_out_share),
            ("climb_out_last_share", self.climb_out_last_share),
            ("climb_out_overshoot_m", self.climb_out_overshoot_m),
            ("drift_share", self.drift_share),
            ("drift_s", self.drift_s),
            ("landing_drift_s", self.landing_drift_s),
            ("landing_overshoot_m", self.landing_overshoot_m),
            ("transition_m", self.transition_m),
            ("max_wind_mps", self.max_wind_mps),
            ("circle_wide_share", self.circle_wide_share),
            ("circle_level_m", self.circle_level_m),
            ("turning_share", self.turning_share),
            ("bank_lag_s", self.bank_lag_s),
            ("lean_speed_mps", self.lean_speed_mps),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::super::version::version;
    use super::*;

    #[test]
    fn a_speed_and_the_lean_angle_for_it_belong_together() {
        use crate::autopilot::{Airframe, Autopilot, facts};
        for (autopilot, stock_mps, max_mps) in [
            (Autopilot::ArduPilot, 9.5, 13.6),
            (Autopilot::Px4, 9.8, 10.7),
        ] {
            let behaviour = &facts(autopilot, Airframe::Copter).behaviour;
            let speed = |lean_deg| {
                behaviour
                    .speed_at_lean_mps(None, lean_deg)
                    .expect("measured")
            };
            let lean = |mps| behaviour.lean_for_speed_deg(None, mps).expect("measured");
            assert!((speed(behaviour.lean_deg) - stock_mps).abs() < 1e-9);
            assert!(
                (speed(MAX_LEAN_DEG) - max_mps).abs() < 0.1,
                "{}",
                speed(MAX_LEAN_DEG)
            );
            assert!((lean(stock_mps) - behaviour.lean_deg).abs() < 1e-9);
            assert!((lean(2.0) - behaviour.lean_deg).abs() < 1e-9);
            for tenths in 0..60_u32 {
                let mps = stock_mps + 0.1 * f64::from(tenths);
                assert!(speed(lean(mps)) >= mps - 1e-6, "{mps}");
                assert!(
                    lean(mps) <= behaviour.lean_deg || speed(lean(mps) - 1.0) < mps,
                    "{mps}"
                );
            }
        }
    }

    #[test]
    fn the_worst_value_of_a_version_or_of_all_applies() {
        static SAMPLES: [Measured; 3] = [sample(4, 6, 6.0), sample(4, 7, 12.0), sample(4, 7, 8.0)];
        const fn sample(major: u8, minor: u8, value: f64) -> Measured {
            Measured {
                value,
                unit: "s",
                version: version(major, minor),
                samples: 1,
                source: "",
            }
        }
        let figure = Figure::greatest(&SAMPLES);
        let of = |version| figure.of(version).map(ToString::to_string);
        assert_eq!(of(None).as_deref(), Some("12 s"));
        assert_eq!(of(Some(version(4, 6))).as_deref(), Some("6 s"));
        assert_eq!(of(Some(version(4, 8))).as_deref(), Some("12 s"));
        assert!(NONE.value(None).abs() <= 0.0);
        let least = Figure::least(&SAMPLES);
        assert!((least.value(None) - 6.0).abs() < 1e-9);
        assert!((least.value(Some(version(4, 7))) - 8.0).abs() < 1e-9);
    }
}

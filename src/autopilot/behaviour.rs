//! Measured behaviour: figures that the verdict assumes, with their sources.

use std::fmt;

use super::Version;

/// One measured figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The value that the verdict assumes: the worst of the samples, rounded up.
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
pub struct Figure(pub &'static [Measured]);

impl Figure {
    /// The measurement that applies to a version: the worst of its own, or, where the version is
    /// not known or was not measured, the worst of all.
    #[must_use]
    pub fn of(self, version: Option<Version>) -> Option<&'static Measured> {
        let worst = |only: Option<Version>| {
            let applies = |figure: &&Measured| only.is_none_or(|only| figure.version == only);
            let figures = self.0.iter().filter(applies);
            figures.max_by(|a, b| a.value.abs().total_cmp(&b.value.abs()))
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
pub(super) const NONE: Figure = Figure(&[]);

/// How one airframe of one autopilot deviates from straight legs flown on time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Behaviour {
    /// The vehicle may be this early from its takeoff on, seconds.
    pub takeoff_early_s: Figure,
    /// The vehicle may be this late from its takeoff on, seconds. Two vehicles of one autopilot
    /// and airframe are equally late within 5.5 s, which `time_slack_s` covers.
    pub takeoff_late_s: Figure,
    /// A stop may take this much longer than in the flight model, seconds.
    pub stop_late_s: Figure,
    /// A leg may take this much longer than in the flight model, seconds.
    pub leg_late_s: Figure,
    /// A corner that the vehicle slows down for may take this much longer than in the flight
    /// model, seconds.
    pub corner_late_s: Figure,
    /// On a climbing leg the vehicle lags the commanded altitude by this time its climb rate,
    /// seconds.
    pub altitude_lag_s: Figure,
    /// A plane may reach the height of its takeoff after this share of the planned climb.
    pub climb_out_share: Figure,
    /// A plane may exceed the height of its takeoff by this before it levels off, metres.
    pub climb_out_overshoot_m: Figure,
    /// During a climb on rotors the wind carries the vehicle with this share of its speed.
    pub drift_share: Figure,
    /// After the climb the wind carries the vehicle for this time, seconds.
    pub drift_s: Figure,
    /// Share of `g tan(bank)` that turns the wing under the L1 law.
    pub turning_share: Figure,
    /// Time constant of the bank under the L1 law, seconds.
    pub bank_lag_s: Figure,
    /// The greatest speed that a stock copter reaches in still air at its lean limit, m/s: the
    /// least of what was measured.
    pub lean_speed_mps: Figure,
    /// Speed below [`super::SLOW_LANDING_M`] in a landing on rotors, m/s. Every plan sets it
    /// (`LAND_SPEED`, `MPC_LAND_SPEED`, `Q_LAND_FINAL_SPD`).
    pub slow_landing_mps: f64,
}

impl Behaviour {
    /// Every measured figure with its name, for documents and tests.
    #[must_use]
    pub fn figures(&self) -> [(&'static str, Figure); 13] {
        [
            ("takeoff_early_s", self.takeoff_early_s),
            ("takeoff_late_s", self.takeoff_late_s),
            ("stop_late_s", self.stop_late_s),
            ("leg_late_s", self.leg_late_s),
            ("corner_late_s", self.corner_late_s),
            ("altitude_lag_s", self.altitude_lag_s),
            ("climb_out_share", self.climb_out_share),
            ("climb_out_overshoot_m", self.climb_out_overshoot_m),
            ("drift_share", self.drift_share),
            ("drift_s", self.drift_s),
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
        let figure = Figure(&SAMPLES);
        let of = |version| figure.of(version).map(ToString::to_string);
        assert_eq!(of(None).as_deref(), Some("12 s"));
        assert_eq!(of(Some(version(4, 6))).as_deref(), Some("6 s"));
        assert_eq!(of(Some(version(4, 8))).as_deref(), Some("12 s"));
        assert!(NONE.value(None).abs() <= 0.0);
    }
}

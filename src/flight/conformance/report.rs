//! How well a flight went.

use crate::flight::itinerary::state::Served;
use crate::verify::Margin;

/// What was flown against what was planned.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightReport {
    /// One for each vehicle, in the order of the spec.
    pub vehicles: Vec<VehicleReport>,
    /// Every limit with its worst value in flight.
    pub margins: Vec<Margin>,
}

/// One vehicle.
#[derive(Clone, Debug, PartialEq)]
pub struct VehicleReport {
    /// Id in the spec.
    pub vehicle: String,
    /// How its flight ended, in words.
    pub end: String,
    /// Whether it says that it ended as planned; whether its positions show that is among the margins.
    pub ended_as_planned: bool,
    /// Positions that were recorded.
    pub fixes: usize,
    /// Distance beside the planned legs, metres.
    pub cross_track_m: Option<ErrorPercentiles>,
    /// Height over or under them, without sign, metres.
    pub altitude_error_m: Option<ErrorPercentiles>,
    /// When it passed its waypoints.
    pub passages: Vec<Passage>,
    /// Of a flight that did not end as planned: how late it was at least, where it was last on its plan, for its place
    /// and for the first waypoint that it did not pass, seconds.
    pub overdue_s: Option<f64>,
    /// When it was at its stops, in the order of the spec.
    pub stops: Vec<MadeStop>,
    /// What was seen of its stops and tasks, in the order in which they begin.
    pub served: Vec<Served>,
}

/// A stop of the spec, and when the vehicle was nearest to it.
#[derive(Clone, Debug, PartialEq)]
pub struct MadeStop {
    /// Id in the spec.
    pub id: String,
    /// Seconds after T0.
    pub flown_s: f64,
    /// How near it came, metres.
    pub distance_m: f64,
}

/// Median, 95 % and worst of many values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorPercentiles {
    /// Half of the values are at most this.
    pub median: f64,
    /// 95 % of the values are at most this.
    pub p95: f64,
    /// The greatest.
    pub worst: f64,
}

/// A waypoint, and when it was passed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Row of the `.waypoints` file; home is 0.
    pub item: usize,
    /// As planned, seconds after T0.
    pub planned_s: f64,
    /// As flown: when it was nearest.
    pub flown_s: f64,
    /// How near it came, metres.
    pub distance_m: f64,
}

impl FlightReport {
    /// Whether every limit was kept and every vehicle ended as planned.
    #[must_use]
    pub fn passes(&self) -> bool {
        !self.vehicles.is_empty()
            && self.vehicles.iter().all(|v| v.ended_as_planned)
            && self.margins.iter().all(|margin| margin.ok)
    }
}

impl ErrorPercentiles {
    /// Of values in any order; none of no values.
    #[must_use]
    pub fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        let at = |share: usize| values.get((values.len() - 1) * share / 100).copied();
        if values.is_empty() {
            return None;
        }
        Some(Self {
            median: at(50)?,
            p95: at(95)?,
            worst: at(100)?,
        })
    }
}

impl VehicleReport {
    /// By how much it was later than planned at each waypoint, seconds; negative earlier.
    pub fn late_s(&self) -> impl Iterator<Item = f64> {
        let passed = self.passages.iter().map(Passage::late_s);
        passed.chain(self.overdue_s)
    }
}

impl Passage {
    /// Seconds later than planned; negative earlier.
    #[must_use]
    pub fn late_s(&self) -> f64 {
        self.flown_s - self.planned_s
    }
}

#[cfg(test)]
mod tests {
    use super::ErrorPercentiles;

    #[test]
    fn a_spread_is_the_middle_the_last_twentieth_and_the_end() {
        let spread =
            ErrorPercentiles::of((0..=100).rev().map(f64::from).collect()).expect("values");
        let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(
            close(spread.median, 50.0) && close(spread.p95, 95.0) && close(spread.worst, 100.0)
        );
        assert_eq!(ErrorPercentiles::of(Vec::new()), None);
    }
}

//! Whether a copter can fly its speed through the air at the lean angle that it is allowed.

use super::mission::MissionCheck;
use crate::mission::lean_limit_deg;
use crate::spec::Airframe;
use crate::verify::measure::segment::Segment;
use crate::verify::measure::worst::Worst;
use crate::verify::{Limit, Margin};

/// An encoded speed may be off by this, m/s.
const ENCODING_MPS: f64 = 0.05;
/// Shorter pieces have no course, metres.
const SHORTEST_M: f64 = 0.5;
/// The same of a circle: that of 1 m is cut into pieces of 0.4 m.
const SHORTEST_OF_ROUND_M: f64 = 0.01;

/// A motion slower than this is a hover, m/s.
const HOVER_MPS: f64 = 0.1;

/// Whether a copter stays over a place, or rises or descends there.
fn hovers(segment: &Segment) -> bool {
    let lasts_s = segment.to_s - segment.from_s;
    let run_m = segment.from.at.distance_m(segment.to.at);
    segment.flown && lasts_s > 0.0 && run_m <= HOVER_MPS * lasts_s
}

impl MissionCheck<'_> {
    /// The greatest speed through the air: on legs the commanded ground speed less the wind, on circles
    /// their own less the wind, and all of the wind where it hovers, rises or descends.
    /// Specs of version 1 have it as an assumption.
    pub(crate) fn flyable_speed(&self) -> Option<Margin> {
        if self.spec.version < 2 || self.vehicle.airframe != Airframe::Copter {
            return None;
        }
        let bound_mps = self.vehicle.flyable_mps(lean_limit_deg(self.mission))?;
        let wind_mps = self.spec.wind.map_or(0.0, |wind| wind.speed_mps);
        let (mut worst, mut over_ground_mps) = (Worst::default(), f64::INFINITY);
        let mut cruises = self.flight.cruises.iter().peekable();
        let mut speed_mps = self.vehicle.speed_mps;
        for (index, segment) in self.flight.segments.iter().enumerate() {
            while let Some(cruise) = cruises.next_if(|cruise| cruise.segment <= index) {
                speed_mps = cruise.speed_mps.unwrap_or(self.vehicle.speed_mps);
            }
            let mut offer = |through_mps: f64| {
                let is_same = (through_mps - bound_mps).abs() <= ENCODING_MPS;
                let value = if is_same { bound_mps } else { through_mps };
                worst.at_most(value, bound_mps, || segment.moment(&self.world.frame, 0.0));
            };
            if hovers(segment) {
                offer(wind_mps);
            }
            let mut rounds = self.flight.on_rotors.iter();
            let round = rounds.find(|round| round.segments.contains(&index));
            let (flown_mps, shortest_m) = match round {
                Some(round) => (round.speed_mps, SHORTEST_OF_ROUND_M),
                None => (speed_mps, SHORTEST_M),
            };
            let Some([along_mps, across_mps]) = self.wind_on(segment, shortest_m) else {
                continue;
            };
            offer((flown_mps - along_mps).hypot(across_mps));
            let forward_mps = (bound_mps.powi(2) - across_mps.powi(2)).max(0.0).sqrt();
            over_ground_mps = over_ground_mps.min((along_mps + forward_mps).max(0.0));
        }
        let mut margin = worst.margin(self.id(), Limit::FlyableSpeed, "m/s")?;
        if !margin.ok && wind_mps > bound_mps + ENCODING_MPS {
            margin.note = "through the air; it cannot hover in this wind".to_owned();
        } else if !margin.ok {
            // Down to what can be written with one decimal.
            let max_mps = (10.0 * over_ground_mps).floor() / 10.0;
            let wind = self.spec.wind.map_or("", |_| "in this wind ");
            margin.note = format!("through the air; {wind}speed_mps may be {max_mps:.1} at most");
        }
        Some(margin)
    }

    /// The wind along a piece of a leg and across it, m/s.
    fn wind_on(&self, segment: &Segment, shortest_m: f64) -> Option<[f64; 2]> {
        let (from, to) = (segment.from.at, segment.to.at);
        let length_m = from.distance_m(to);
        if length_m < shortest_m {
            return None;
        }
        let ahead = [
            (to.east_m - from.east_m) / length_m,
            (to.north_m - from.north_m) / length_m,
        ];
        let [east_mps, north_mps] = self.spec.wind.map_or([0.0; 2], |wind| wind.velocity_mps());
        Some([
            east_mps * ahead[0] + north_mps * ahead[1],
            north_mps * ahead[0] - east_mps * ahead[1],
        ])
    }
}

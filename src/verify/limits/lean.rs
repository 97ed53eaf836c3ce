//! Whether a copter can fly its speed through the air at the lean angle that it is allowed.

use super::mission::Contract;
use crate::mission::lean_limit_deg;
use crate::spec::Airframe;
use crate::verify::measure::segment::Chord;
use crate::verify::measure::worst::Worst;
use crate::verify::{Limit, Margin};

/// An encoded speed may be off by this, m/s.
const ENCODING_MPS: f64 = 0.05;
/// Shorter pieces have no course, metres.
const SHORTEST_M: f64 = 0.5;

impl Contract<'_> {
    /// The greatest speed through the air of all legs: the commanded ground speed, less the wind.
    /// Specs of version 1 have it as an assumption.
    pub(crate) fn flyable_speed(&self) -> Option<Margin> {
        if self.spec.version < 2 || self.vehicle.airframe != Airframe::Copter {
            return None;
        }
        let bound_mps = self.vehicle.flyable_mps(lean_limit_deg(self.mission))?;
        let chords = &self.flight.chords;
        let (mut worst, mut over_ground_mps) = (Worst::default(), f64::INFINITY);
        let cruises = self.flight.cruises.iter();
        let ends = cruises.clone().skip(1).map(|next| next.chord);
        for (cruise, end) in cruises.zip(ends.chain([chords.len()])) {
            let speed_mps = cruise.speed_mps.unwrap_or(self.vehicle.speed_mps);
            for chord in chords.get(cruise.chord..end).unwrap_or_default() {
                let Some([along_mps, across_mps]) = self.wind_on(chord) else {
                    continue;
                };
                let through_mps = (speed_mps - along_mps).hypot(across_mps);
                let forward_mps = (bound_mps.powi(2) - across_mps.powi(2)).max(0.0).sqrt();
                over_ground_mps = over_ground_mps.min((along_mps + forward_mps).max(0.0));
                let is_same = (through_mps - bound_mps).abs() <= ENCODING_MPS;
                let value = if is_same { bound_mps } else { through_mps };
                worst.at_most(value, bound_mps, || chord.moment(&self.world.frame, 0.0));
            }
        }
        let mut margin = worst.margin(self.id(), Limit::FlyableSpeed, "m/s")?;
        if !margin.ok {
            // Down to what can be written with one decimal.
            let most_mps = (10.0 * over_ground_mps).floor() / 10.0;
            let wind = self.spec.wind.map_or("", |_| "in this wind ");
            margin.note = format!("through the air; {wind}speed_mps may be {most_mps:.1} at most");
        }
        Some(margin)
    }

    /// The wind along a piece of a leg and across it, m/s.
    fn wind_on(&self, chord: &Chord) -> Option<[f64; 2]> {
        let (from, to) = (chord.from.at, chord.to.at);
        let length_m = from.distance_m(to);
        if length_m < SHORTEST_M {
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

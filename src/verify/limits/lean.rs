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
        let mut worst = Worst::default();
        let cruises = self.flight.cruises.iter();
        let ends = cruises.clone().skip(1).map(|next| next.chord);
        for (cruise, end) in cruises.zip(ends.chain([chords.len()])) {
            let speed_mps = cruise.speed_mps.unwrap_or(self.vehicle.speed_mps);
            for chord in chords.get(cruise.chord..end).unwrap_or_default() {
                let Some(through_mps) = self.through_air_mps(chord, speed_mps) else {
                    continue;
                };
                let is_same = (through_mps - bound_mps).abs() <= ENCODING_MPS;
                let value = if is_same { bound_mps } else { through_mps };
                worst.at_most(value, bound_mps, || chord.moment(&self.world.frame, 0.0));
            }
        }
        worst.margin(self.id(), Limit::FlyableSpeed, "m/s")
    }

    /// Its speed through the air on a piece of a leg that it flies at a ground speed.
    fn through_air_mps(&self, chord: &Chord, speed_mps: f64) -> Option<f64> {
        let (from, to) = (chord.from.at, chord.to.at);
        let length_m = from.distance_m(to);
        if length_m < SHORTEST_M {
            return None;
        }
        let course = [to.east_m - from.east_m, to.north_m - from.north_m];
        let wind = self.spec.wind.map_or([0.0; 2], |wind| wind.velocity_mps());
        let through = [0, 1].map(|axis| course[axis] / length_m * speed_mps - wind[axis]);
        Some(through[0].hypot(through[1]))
    }
}

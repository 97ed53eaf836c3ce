//! How a flight comes to its end: on the ground, or where it stays in the air.

use super::lap::Lap;
use super::{Craft, Stage, Told};
use crate::flight::end::End;
use crate::flight::modes;
use crate::flight::readiness::STANDS_M;
use crate::flight::record::Fix;
use crate::spec::Airframe;

/// A vehicle that stays for ever has come to its place this near, metres.
const ARRIVED_M: f64 = 5.0;
/// A plane that rolled out stands this near the place of its landing, metres.
const RUNS_OUT_M: f64 = 150.0;
/// Slower than this a vehicle stays where it is, m/s.
const STILL_MPS: f64 = 0.5;

impl Craft<'_> {
    /// It stopped its motors by itself: where it should, or elsewhere.
    pub(super) fn landing(&self) -> End {
        let planned = self.of.mission.items.iter().rev();
        let place = planned.filter_map(crate::mission::Item::place).next();
        let away_m = match (place, self.latest) {
            (Some(place), Some((_, fix))) => place.chord_m(fix.place),
            _ => f64::INFINITY,
        };
        let near_m = match self.of.mission.airframe {
            Airframe::Plane => RUNS_OUT_M,
            Airframe::Copter | Airframe::Vtol => STANDS_M,
        };
        if self.of.reference.lands && away_m <= near_m {
            End::Landed
        } else {
            End::Failed(format!(
                "stopped its motors {away_m:.0} m from the end of its mission"
            ))
        }
    }

    /// A plane comes down on the approach of its mission, the only one that was judged.
    pub(super) fn land_by_mission(&mut self) {
        if self.of.reference.lands {
            self.said
                .push_back("lands as planned, at the end of its mission".to_owned());
            self.told = None;
            if !self.in_mission {
                self.command([modes::start(self.of.mission)]);
            }
        } else {
            self.said
                .push_back("has no landing in its mission: it circles where it is".to_owned());
            self.tell(Told::Hold);
        }
    }

    /// Whether it stays at the end of its mission, or where it was told to.
    pub(in crate::flight) fn look_whether_it_stays(&mut self) {
        let Some((_, fix)) = self.latest else { return };
        if !matches!(self.stage, Stage::Flying) || !self.airborne {
            return;
        }
        if self.of.mission.airframe.has_wing() {
            return self.look_whether_it_circles(fix);
        }
        if fix.speed_mps > STILL_MPS {
            return;
        }
        if self.told == Some(Told::Hold) && self.asking.is_none() {
            return self.end(End::Held);
        }
        // Another mission may have been given to it meanwhile.
        let rows = self.total.unwrap_or(self.of.mission.items.len());
        let place = self
            .of
            .mission
            .items
            .last()
            .and_then(crate::mission::Item::place);
        let is_there = place.is_some_and(|place| place.chord_m(fix.place) < ARRIVED_M);
        if !self.of.reference.lands && self.in_mission && self.item >= rows && is_there {
            self.end(End::Loitering);
        }
    }

    /// A wing stays where it has flown a whole circle.
    fn look_whether_it_circles(&mut self, fix: Fix) {
        let Some((_, beat)) = self.vehicle else {
            return;
        };
        let is_held = self.told == Some(Told::Hold)
            && self.asking.is_none()
            && modes::is_circling(self.of.mission, beat.custom_mode);
        let rows = self.total.unwrap_or(self.of.mission.items.len());
        let reference = &self.of.reference;
        let stays = !reference.lands && self.in_mission && self.item >= rows;
        let at = reference.frame().to_plan(fix.place);
        let circles = is_held || stays && reference.is_on_circle(at);
        if !circles {
            self.lap = Lap::default();
        } else if self.lap.is_whole_with(at) {
            self.end(if is_held { End::Held } else { End::Loitering });
        }
    }
}

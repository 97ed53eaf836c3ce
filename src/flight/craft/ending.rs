//! How a flight comes to its end: on the ground, or where it stays in the air.

use super::{Craft, Stage, Told};
use crate::flight::arrival::{self, STILL_MPS};
use crate::flight::end::End;
use crate::flight::lap::Lap;
use crate::flight::modes;
use crate::flight::record::Fix;

impl Craft<'_> {
    /// It stopped its motors by itself: where it should, or elsewhere.
    pub(super) fn landing(&self) -> End {
        let reference = &self.of.reference;
        let away_m = self.latest.map_or(f64::INFINITY, |(_, fix)| {
            arrival::away_m(reference, fix.place)
        });
        let near_m = arrival::landing_m(self.of.mission.airframe);
        if reference.lands && away_m <= near_m {
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
        let is_there = arrival::hovers(&self.of.reference, &fix);
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

//! Waypoints of a plan that a flight did not pass.

use super::proof::{Tube, at_most};
use super::reference::{Waypoint, to_segment};
use super::{FlownTrack, GAP_S, Part};
use crate::spec::Airframe;
use crate::verify::{Flown, Margin, Moment};

/// A distance that is less by this much is another one, metres.
const NEARER_M: f64 = 1.0;

impl FlownTrack<'_> {
    /// Waypoints that were not passed.
    pub(super) fn missed(&self, tube: Tube) -> Margin {
        let parts: Vec<Part<'_>> = self.parts().collect();
        let mut missed: Vec<(&Waypoint, String)> = Vec::new();
        for (number, part) in parts.iter().enumerate() {
            let passages = self.passages(part);
            for waypoint in self.due(part, number + 1 == parts.len()) {
                let mut passed = passages.iter().filter(|p| p.item == waypoint.item);
                let limit_m = tube.across_m.max(tube.up_m);
                match passed.next() {
                    Some(passage) if passage.distance_m <= limit_m => {}
                    Some(passage) => {
                        let why = match self.gap_at(passage.flown_s) {
                            Some((from_s, to_s)) => format!(
                                "item {} not seen: nothing was recorded from {from_s:.0} to {to_s:.0} s",
                                waypoint.item
                            ),
                            None => self.passed_words(part, waypoint, passage.distance_m),
                        };
                        missed.push((waypoint, why));
                    }
                    None => missed.push((waypoint, format!("item {} not reached", waypoint.item))),
                }
            }
        }
        let required = at_most(Flown::WaypointsMissed, 0.0, "waypoints");
        let count = u32::try_from(missed.len()).unwrap_or(u32::MAX);
        let first = missed.into_iter().next();
        let frame = parts.first().map(|part| part.plan.frame());
        let at = first
            .as_ref()
            .zip(frame)
            .map(|((waypoint, _), frame)| Moment {
                place: frame.from_plan(waypoint.point.at),
                amsl: waypoint.point.amsl,
                t_s: waypoint.t_s,
                item: waypoint.item,
            });
        Margin {
            note: first.map_or_else(String::new, |(_, why)| why),
            ..required.margin(self.id(), f64::from(count), at)
        }
    }

    /// How far away a waypoint was passed, in words: while it flew to it or the next one, and where it came nearer at
    /// another time.
    fn passed_words(&self, part: &Part<'_>, waypoint: &Waypoint, away_m: f64) -> String {
        let item = waypoint.item;
        let last = part.fixes.end.saturating_sub(1);
        let pairs = part.fixes.start..last;
        let distances = pairs.map(|at| {
            let (distance_m, _) = to_segment(waypoint.point, self.points[at], self.points[at + 1]);
            ((distance_m - waypoint.radius_m).max(0.0), at)
        });
        let nearest = distances.min_by(|a, b| a.0.total_cmp(&b.0));
        match nearest.filter(|(min_m, _)| away_m - min_m >= NEARER_M) {
            Some((min_m, at)) => {
                let flown_to = self.fixes()[at].item;
                format!(
                    "item {item} passed {away_m:.0} m away in its turn, and {min_m:.0} m away on the way to item {flown_to}"
                )
            }
            None => format!("item {item} passed {away_m:.0} m away"),
        }
    }

    /// The time without positions that a time lies in, seconds after T0.
    fn gap_at(&self, t_s: f64) -> Option<(f64, f64)> {
        let mut pairs = self
            .fixes()
            .windows(2)
            .map(|pair| (pair[0].t_s, pair[1].t_s));
        pairs.find(|(from_s, to_s)| to_s - from_s > GAP_S && (*from_s..=*to_s).contains(&t_s))
    }

    /// The waypoints that had to be passed while a plan was flown: all that were ahead, of a plan
    /// that another took the place of those before the item that was flown to. Not the last
    /// item, which the last position shows, nor the place where a climb-out ends.
    fn due<'p>(&self, part: &Part<'p>, is_last: bool) -> impl Iterator<Item = &'p Waypoint> {
        let waypoints = part.plan.waypoints.iter();
        let last = waypoints.clone().next_back().map_or(0, |last| last.item);
        let fixes = &self.fixes()[part.fixes.clone()];
        let begun = fixes.iter().map(|fix| fix.item).max().unwrap_or(0);
        let until = if is_last { last } else { begun.min(last) };
        let climbs_out = self.airframe == Airframe::Plane && part.fixes.start == 0;
        let first = part.ahead + usize::from(climbs_out);
        waypoints
            .skip(first)
            .filter(move |waypoint| waypoint.item < until)
    }
}

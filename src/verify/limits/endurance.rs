//! What a flight uses from takeoff to touchdown, against what the vehicle has.

use crate::geodesy::{Amsl, PlanPoint};
use crate::numeric::digits;
use crate::path::{flight, longer_for_takeoff_s, route_ends};
use crate::spec::Endurance;
use crate::verify::execute::flight::End;
use crate::verify::limits::mission::MissionCheck;
use crate::verify::measure::segment::Segment;
use crate::verify::{Limit, Margin, Requirement};
use crate::world::Departure;

/// Nothing that flies such missions stays aloft for longer, seconds: a week.
const MAX_ALOFT_S: f64 = 7.0 * 86_400.0;
/// A motion that is shorter is none, metres.
const STILL_M: f64 = 1e-3;

impl MissionCheck<'_> {
    /// Time, distance through the air or energy from takeoff to touchdown, or until the vehicle
    /// stays for ever.
    pub(crate) fn endurance(&self) -> Option<Margin> {
        let Some(endurance) = self.vehicle.endurance.as_ref() else {
            return self.longest();
        };
        let (unit, usable) = (endurance.capacity.unit(), endurance.usable());
        let required = Requirement::at_most(Limit::Endurance, usable, unit);
        if self.flight.unknown.is_some() || self.flight.end == Some(End::Repeats) {
            return Some(Margin::unjudged(
                self.id(),
                Limit::Endurance,
                "the flight is not known to its end",
            ));
        }
        let stays = matches!(self.flight.end, Some(End::Stays(_)));
        let aloft = self.aloft(stays);
        let last = aloft.last()?;
        let before = self.used_before(endurance);
        let used: f64 = aloft
            .iter()
            .map(|segment| self.used(endurance, segment))
            .sum();
        let used = before + used;
        // A vehicle that is late hovers or circles for so long, where the air is thinnest.
        let late_s = last.late_s + longer_for_takeoff_s(self.vehicle, self.sites.departure);
        let wind_mps = self.spec.wind.map_or(0.0, |wind| wind.speed_mps);
        let tops = aloft
            .iter()
            .map(|segment| segment.from.amsl.0.max(segment.to.amsl.0));
        let top_m = tops.fold(f64::NEG_INFINITY, f64::max);
        let late = (self.vehicle).used_waiting(late_s, wind_mps, Amsl(top_m));
        let mut note = format!(
            "{} {unit} less a reserve of {} %",
            digits::plain(endurance.capacity.total()),
            digits::plain(100.0 * endurance.reserve)
        );
        if stays {
            note.push_str("; until it stays for ever");
        }
        let straight = before + self.used_straight(endurance);
        if used + late > usable && straight > usable {
            note.push_str(&format!(
                "; even straight from place to place it uses {straight:.0} {unit}: no path is short enough"
            ));
        }
        let at = last.moment(&self.world.frame, 1.0);
        Some(Margin {
            note,
            ..required.margin(self.id(), used + late, Some(at))
        })
    }

    /// Without an endurance: fails where the flight is longer than any.
    fn longest(&self) -> Option<Margin> {
        let aloft = self.aloft(matches!(self.flight.end, Some(End::Stays(_))));
        let finite = aloft.iter().filter(|segment| segment.to_s.is_finite());
        let last = finite.max_by(|a, b| a.to_s.total_cmp(&b.to_s))?;
        let aloft_s = last.to_s - aloft.first()?.from_s;
        let required = Requirement::at_most(Limit::Endurance, MAX_ALOFT_S, "s");
        let at = last.moment(&self.world.frame, 1.0);
        let margin = Margin {
            note: "no endurance is given, and nothing stays aloft for longer".to_owned(),
            ..required.margin(self.id(), aloft_s, Some(at))
        };
        (!margin.ok).then_some(margin)
    }

    /// What is flown, from the first motion on, without an endless stay.
    fn aloft(&self, stays: bool) -> Vec<&Segment> {
        let circle = self.flight.circle.map(|circle| circle.segment);
        let segments = self.flight.segments.iter().enumerate();
        let flown = segments.filter(|(index, segment)| segment.flown && circle != Some(*index));
        let moves = |segment: &Segment| segment.from.distance_m(segment.to) > STILL_M;
        let flown = flown.map(|(_, segment)| segment);
        let mut aloft: Vec<&Segment> = flown.skip_while(|segment| !moves(segment)).collect();
        while stays && aloft.last().is_some_and(|segment| !moves(segment)) {
            aloft.pop();
        }
        aloft
    }

    /// What a vehicle that begins in the air has used until then: since its departure, at its speed.
    fn used_before(&self, endurance: &Endurance) -> f64 {
        let Departure::Airborne { at_s, .. } = self.sites.departure else {
            return 0.0;
        };
        let since_s = (at_s - self.vehicle.depart_s).max(0.0);
        (endurance.capacity).used(since_s, self.vehicle.speed_mps, 0.0)
    }

    /// What a flight straight from start over its stops to its end would use, if nothing were in the way.
    fn used_straight(&self, endurance: &Endurance) -> f64 {
        let ends = route_ends(self.vehicle, self.sites);
        let routes: Vec<Vec<PlanPoint>> = ends.iter().map(|ends| vec![ends.0, ends.1]).collect();
        let points = flight(self.vehicle, self.sites, &routes).points;
        let moves = points
            .windows(2)
            .skip_while(|pair| pair[0].point == pair[1].point);
        let finite = moves.filter(|pair| pair[1].t_s.is_finite());
        finite
            .map(|pair| {
                let duration_s = pair[1].t_s - pair[0].t_s;
                self.used_between(endurance, (pair[0].point, pair[1].point), duration_s)
            })
            .sum()
    }

    /// What a segment uses.
    fn used(&self, endurance: &Endurance, segment: &Segment) -> f64 {
        self.used_between(
            endurance,
            (segment.from, segment.to),
            segment.to_s - segment.from_s,
        )
    }

    fn used_between(
        &self,
        endurance: &Endurance,
        (from, to): (PlanPoint, PlanPoint),
        duration_s: f64,
    ) -> f64 {
        if duration_s <= 0.0 {
            return 0.0;
        }
        let run_m = from.at.distance_m(to.at);
        let rise_m = to.amsl.0 - from.amsl.0;
        let wind = self.spec.wind;
        let [east_mps, north_mps] = wind.map_or([0.0; 2], |wind| wind.velocity_mps());
        let over_ground = |a: f64, b: f64| (b - a) / duration_s;
        let air_mps = (over_ground(from.at.east_m, to.at.east_m) - east_mps)
            .hypot(over_ground(from.at.north_m, to.at.north_m) - north_mps);
        // What stands still in the air circles there, if it is no column.
        let circles = run_m < STILL_M && rise_m.abs() < STILL_M;
        let air_mps = match circles {
            true => air_mps.max(self.circling_mps(from.amsl)),
            false => air_mps,
        };
        endurance
            .capacity
            .used(duration_s, air_mps, rise_m / duration_s)
    }

    /// Speed through the air of a vehicle that waits at an altitude without wind, m/s: a wing circles.
    fn circling_mps(&self, at: Amsl) -> f64 {
        match self.vehicle.wing {
            Some(_) => self.vehicle.through_air_mps(self.vehicle.speed_mps, at),
            None => 0.0,
        }
    }
}

//! New paths and the ways of those that return meanwhile: how fast an autopilot returns is not known.

use super::JointPlan;
use crate::flight::alarms::order_safety::{min_m, off_s, way_of_return};
use crate::flight::replan::activity::Doing;
use crate::flight::replan::state::VehicleState;
use crate::geodesy::PlanPoint;
use crate::numeric::approach::Segment;
use crate::path::TimedPoint;
use crate::verify::{Limit, Margin};

/// A vehicle stays at the end of its new path, or over its landing, for this long, seconds.
const STAYS_S: f64 = 600.0;
const LANDS_S: f64 = 60.0;

/// How long the longest way of a vehicle that returns takes, seconds; none where nobody does.
pub(super) fn longest_s(joint: &JointPlan<'_>) -> Option<f64> {
    let others = joint.given.others.iter();
    let ways = others.flat_map(|state| ways(joint, state));
    let lasts_s = ways.map(|way| way.last().map_or(0.0, |last| last.t1_s) - joint.given.now_s);
    lasts_s.reduce(f64::max)
}

/// The ways that a vehicle may return on: the climb, the leg, the descent, home and to each rally point.
fn ways(joint: &JointPlan<'_>, state: &VehicleState) -> Vec<Vec<Segment>> {
    let Doing::Returns(ends) = &state.doing else {
        return Vec::new();
    };
    let of_end = |end: &PlanPoint| {
        let ground = joint.world.terrain.height_at(&joint.world.frame, end.at);
        let amsl = ground.unwrap_or(state.here.amsl);
        let place = PlanPoint { at: end.at, amsl };
        let vehicle = joint.vehicle(state);
        way_of_return(vehicle, state.here, (end.amsl.0, place), joint.given.now_s)
    };
    ends.iter().map(of_end).collect()
}

impl JointPlan<'_> {
    /// How far times of new paths and of ways of return may be off each other, seconds; none where nobody returns.
    pub(super) fn return_slack_s(&self) -> Option<f64> {
        longest_s(self).map(off_s)
    }

    /// Names a new path that comes near a way on which another vehicle returns at about that time: from a time in
    /// seconds after T0 on.
    pub(super) fn check_returns(&mut self, state: &VehicleState, from_s: f64) {
        let path = self.plan.vehicles.last().map(|of| of.path());
        let own = segments(&path.unwrap_or_default(), from_s, state.lands);
        let limit = &self.spec.separation;
        let met = self.given.others.iter().find_map(|other| {
            let ways = ways(self, other).into_iter();
            let near = ways.filter_map(|way| min_m(&own, &way, limit));
            let away_m = near.reduce(f64::min).filter(|m| *m < limit.distance_m)?;
            let id = &self.vehicle(other).id;
            Some(format!(
                "it comes within {away_m:.0} m of the way on which {id} returns (at least {:.0} m)",
                limit.distance_m
            ))
        });
        let id = &self.vehicle(state).id;
        let met = met.map(|why| Margin::unjudged(id, Limit::Separation, why));
        self.returns_met.extend(met);
    }
}

/// A timed path from a time on, and what its vehicle does at its end.
fn segments(path: &[TimedPoint], from_s: f64, lands: bool) -> Vec<Segment> {
    let pairs = path.windows(2).filter(|pair| pair[1].t_s > from_s);
    let flown = pairs.map(|pair| Segment::between(pair[0].placed(), pair[1].placed()));
    let stays_s = if lands { LANDS_S } else { STAYS_S };
    let stays = path
        .last()
        .map(|last| Segment::between(last.placed(), (last.t_s + stays_s, last.point.axes_m())));
    flown.chain(stays).collect()
}

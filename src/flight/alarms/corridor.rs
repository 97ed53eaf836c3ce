//! Whether a vehicle is where and when the verdict has it: corridor, clearance, lateness.

use std::collections::VecDeque;

use super::breach::{Depth, error_m};
use super::{Alarms, Here, Watched};
use crate::autopilot::{Autopilot, command, facts};
use crate::flight::conformance::COLUMN_M;
use crate::flight::conformance::proof::Tube;
use crate::flight::conformance::reference::{Deviation, ReferenceTrajectory};
use crate::flight::conformance::takeoff::{TakeoffTube, landing_column_m};
use crate::flight::record::Fix;
use crate::path::stop_late_s;
use crate::spec::{Airframe, AlarmKind, Vehicle};

/// Error of lateness, seconds: positions are off, and plans linear between waypoints.
pub(super) const LATE_ERROR_S: f64 = 3.0;
/// How fast a vehicle gets on is measured over this time, seconds, and is at least this share of planned.
const PACE_S: f64 = 10.0;
const MIN_PACE: f64 = 0.1;
/// Legs this much farther than the nearest may be the one that is flown, metres.
const ALIKE_M: f64 = 10.0;
/// A vehicle that is nearer than this to a waypoint may stand still, metres.
const STOPS_M: f64 = 20.0;
/// Lower over the ground than this it may have landed, metres.
const LOW_M: f64 = 5.0;
/// On its last circle a wing is at most this many radii from the middle.
const WIDE_CIRCLE: f64 = 1.5;
/// Waypoints that a vehicle may hold at, for the seconds of their first parameter.
const HOLDS: [u16; 2] = [command::NAV_WAYPOINT, command::NAV_LOITER_TIME];
/// Slower than this a planned leg is none that a vehicle must be seen to move on, m/s.
const SLOW_MPS: f64 = 1.0;

/// What the verdict allows one vehicle around its plan.
#[derive(Clone, Debug)]
pub(super) struct TubeWatch {
    pub(super) tube: Tube,
    airframe: Airframe,
    /// By how much a plane may be off the legs until it has passed the place after its climb-out,
    /// metres.
    wide_m: f64,
    /// Where a QuadPlane may be before it is on its first leg.
    pub(super) takeoff: Option<TakeoffTube>,
    /// How far from its landing it may be in its descent, metres.
    landing_m: f64,
    /// How late it is, seconds, if it is on its plan.
    pub(super) late_s: Option<f64>,
    /// How it has fallen behind during the last seconds: times and lateness.
    fallen: VecDeque<(f64, f64)>,
    /// Whether its lateness is an alarm.
    is_late: bool,
    /// Whether it is outside of the tube.
    pub(super) is_off: bool,
    /// Its first position.
    first: Option<Fix>,
}

impl TubeWatch {
    pub(super) fn new(vehicle: &Vehicle, plan: &ReferenceTrajectory) -> Self {
        let climb_out_m = match plan.waypoints.as_slice() {
            [home, top, ..] => home.point.at.distance_m(top.point.at),
            _ => 0.0,
        };
        let behaviour = &facts(Autopilot::ArduPilot, vehicle.airframe).behaviour;
        let early_share = behaviour.climb_out_share.value(None);
        Self {
            tube: Tube::of(vehicle),
            airframe: vehicle.airframe,
            wide_m: (1.0 - early_share) * climb_out_m,
            takeoff: TakeoffTube::of(vehicle, plan),
            landing_m: landing_column_m(vehicle, plan),
            late_s: None,
            fallen: VecDeque::new(),
            is_late: false,
            is_off: false,
            first: None,
        }
    }

    /// By how much its own clock has slipped behind that of the fleet since its first position,
    /// seconds: a simulated vehicle does so where the machine stalls, and is not late on its way.
    pub(super) fn slip_s(&mut self, fix: &Fix) -> f64 {
        let first = self.first.get_or_insert(*fix);
        first.slip_s(fix)
    }

    /// How fast it gets on with its plan now, as a share of planned: of one that is late and falls behind, else 1.
    pub(super) fn pace(&self) -> f64 {
        let (Some(first), Some(last)) = (self.fallen.front(), self.fallen.back()) else {
            return 1.0;
        };
        let lasted_s = last.0 - first.0;
        if !self.is_late || lasted_s < 0.8 * PACE_S {
            return 1.0;
        }
        (1.0 - (last.1 - first.1) / lasted_s).clamp(MIN_PACE, 1.0)
    }

    fn remember(&mut self, t_s: f64, late_s: Option<f64>) {
        let Some(late_s) = late_s else {
            return self.fallen.clear();
        };
        self.fallen.push_back((t_s, late_s));
        while self.fallen.front().is_some_and(|of| t_s - of.0 > PACE_S) {
            self.fallen.pop_front();
        }
    }

    /// Whether it takes off or lands, where neither minimum height nor legs count.
    fn is_in_column(&self, plan: &ReferenceTrajectory, here: &Here) -> bool {
        let (Some(home), Some(last)) = (plan.waypoints.first(), plan.waypoints.last()) else {
            return true;
        };
        let top = plan.waypoints.get(1).unwrap_or(last);
        let away_m = |of: &crate::flight::Waypoint| of.point.at.distance_m(here.point.at);
        let near = |of: &crate::flight::Waypoint| away_m(of) < COLUMN_M;
        let is_down = here.fix.item >= last.item && away_m(last) < self.landing_m;
        match self.airframe {
            Airframe::Plane => {
                here.fix.item <= top.item || plan.lands && here.fix.item >= last.item
            }
            Airframe::Copter | Airframe::Vtol => {
                let takeoff = self.takeoff.as_ref();
                let climbs = takeoff.is_some_and(|of| of.climbs(here.fix.item, here.point.at));
                let puts_down = plan.dips_at(here.fix.item, here.point.at);
                near(home) || climbs || puts_down || plan.lands && (near(last) || is_down)
            }
        }
    }

    /// Until a plane has passed the place after its climb-out.
    fn climbs_out(&self, plan: &ReferenceTrajectory, here: &Here) -> bool {
        let next = plan.waypoints.get(2).map_or(usize::MAX, |next| next.item);
        self.airframe == Airframe::Plane && here.fix.item <= next
    }

    /// Where on its plan it is: of legs that are about as near, the one that fits its lateness.
    fn deviation(&self, plan: &ReferenceTrajectory, here: &Here) -> Option<Deviation> {
        let late_s = self.late_s.unwrap_or(0.0);
        let all = || plan.deviations(here.fix.item, here.point);
        let nearest_m = all()
            .map(|of| of.distance_m())
            .fold(f64::INFINITY, f64::min);
        let off_s = |of: &Deviation| (here.fix.t_s - of.t_s - late_s).abs();
        all()
            .filter(|of| of.distance_m() <= nearest_m + ALIKE_M)
            .min_by(|a, b| off_s(a).total_cmp(&off_s(b)))
    }

    /// How it is off the tube, in words.
    fn corridor(&self, plan: &ReferenceTrajectory, here: &Here) -> Option<String> {
        let of = plan.deviation(here.fix.item, here.point)?;
        let climbs_out = self.climbs_out(plan, here);
        let wide_m = if climbs_out { self.wide_m } else { 0.0 };
        let across_m = self.tube.across_m + wide_m + of.circle_m;
        let takeoff = self.takeoff.as_ref();
        let is_within = takeoff.is_some_and(|of| of.holds(here.fix.item, here.point.at));
        if of.cross_track_m > across_m && !is_within {
            let aside_m = of.cross_track_m;
            // One that skips items may still fly along the path to them.
            let part = match plan.whole_cross_track_m(here.point) <= across_m {
                true => format!(" to item {}", here.fix.item),
                false => String::new(),
            };
            return Some(format!(
                "{aside_m:.0} m beside its path{part} (at most {across_m:.0} m)"
            ));
        }
        let is_level = !climbs_out && !plan.follows_ground();
        let up_m = self.tube.up_m;
        (is_level && of.above_m.abs() > up_m).then(|| {
            let side = if of.above_m > 0.0 { "above" } else { "below" };
            let off_m = of.above_m.abs();
            format!("{off_m:.0} m {side} its path (at most {up_m:.0} m)")
        })
    }

    /// Whether it must be seen to move: it is in the middle of a leg.
    pub(super) fn should_move(&self, plan: &ReferenceTrajectory, here: &Here) -> bool {
        // A plane that rolled out stands until its motors stop.
        let is_low = here.agl_m <= LOW_M;
        let item = here.fix.item;
        let Some(next) = plan.waypoints.iter().position(|of| of.item >= item) else {
            return false;
        };
        let (Some(from), Some(to)) = (
            plan.waypoints.get(next.wrapping_sub(1)),
            plan.waypoints.get(next),
        ) else {
            return false;
        };
        let far = |of: &crate::flight::Waypoint| of.point.at.distance_m(here.point.at) > STOPS_M;
        let length_m = from.point.at.distance_m(to.point.at);
        !is_low && far(from) && far(to) && length_m > SLOW_MPS * (to.t_s - from.t_s)
    }
}

impl Watched<'_> {
    /// Whether it comes down at a rally point, as it was ordered to return.
    fn comes_down_at_rally(&self, here: &Here) -> bool {
        let mut points = self.mission.rally_points(self.plan.frame());
        !self.returns.is_empty() && points.any(|at| at.distance_m(here.point.at) < COLUMN_M)
    }
}

impl Alarms<'_> {
    /// Corridor, clearance and lateness at a position.
    pub(super) fn look_at_tube(&mut self, vehicle: usize, here: &Here) {
        let min_agl_m = self.spec.area.min_agl.0;
        let slack_s = self.spec.separation.time_slack_s;
        let of = &mut self.vehicles[vehicle];
        let is_in_column = of.tube.is_in_column(&of.plan, here) || of.comes_down_at_rally(here);
        let is_in_column = is_in_column || of.duty.lands;
        let is_due = of.duty.flies && of.duty.is_up && !is_in_column;
        let is_on_plan = of.is_on_plan();
        let slip_s = of.tube.slip_s(&here.fix);
        let (corridor, late) = if is_due && !of.duty.is_ordered {
            let found = of.tube.deviation(&of.plan, here);
            let found = found.filter(|found| !has_come(&of.plan, here, found));
            let late_s = found.map(|of| here.fix.t_s - of.t_s);
            of.tube.late_s = late_s.filter(|_| is_on_plan);
            let assumed_s = assumed_late_s(of, here.fix.item);
            let max_s = assumed_s + slack_s + LATE_ERROR_S;
            let own_s = of.tube.late_s.map(|late_s| late_s - slip_s);
            of.tube.remember(here.fix.t_s, own_s);
            let late = own_s.filter(|late_s| *late_s > max_s);
            let late = late.map(|late_s| {
                format!("{late_s:.0} s behind its plan (the verdict assumed at most {max_s:.0} s)")
            });
            (of.tube.corridor(&of.plan, here), late)
        } else {
            (None, None)
        };
        (of.tube.is_off, of.tube.is_late) = (corridor.is_some(), late.is_some());
        let is_below = |limit_m: f64| is_due && here.agl_m < limit_m;
        let depth = Depth::of(
            is_below(min_agl_m),
            is_below(min_agl_m - error_m(min_agl_m)),
        );
        let t_s = here.fix.t_s;
        let key = (AlarmKind::Clearance, vehicle, None, "");
        let is_low = self.breaches.take(t_s, key, depth);
        let agl_m = here.agl_m;
        let low =
            is_low.then(|| format!("{agl_m:.0} m over the ground (at least {min_agl_m:.0} m)"));
        self.set(t_s, (AlarmKind::Corridor, vehicle, None, ""), corridor);
        self.set(t_s, key, low);
        self.set(t_s, (AlarmKind::Late, vehicle, None, ""), late);
    }
}

/// Whether a vehicle has come to where it stays at the end of its plan, and time goes on: a place,
/// or a circle, on which it crosses the way there again and again.
fn has_come(plan: &ReferenceTrajectory, here: &Here, found: &Deviation) -> bool {
    let Some(last) = plan.waypoints.last().filter(|_| !plan.lands) else {
        return false;
    };
    let is_on_circle = last.radius_m > 0.0
        && last.point.at.distance_m(here.point.at) <= WIDE_CIRCLE * last.radius_m;
    is_on_circle || found.t_s >= last.t_s - LATE_ERROR_S
}

/// How late the verdict assumes a vehicle at most on its way to an item, seconds: what its takeoff may be, and what
/// stops, corners and legs add until the next waypoint. One stop more, and the hold of the last waypoint and of the next:
/// until it has left a waypoint, its place does not say for how long it has been there.
pub(super) fn assumed_late_s(of: &Watched<'_>, item: usize) -> f64 {
    let (vehicle, plan) = (of.vehicle, &of.plan);
    let behaviour = &vehicle.facts().behaviour;
    let takeoff_s = behaviour.takeoff_late_s.value(vehicle.autopilot_version);
    let next = plan.waypoints.iter().find(|next| next.item >= item);
    let way_s = next.or(plan.waypoints.last()).map_or(0.0, |of| of.late_s);
    let rows = of.mission.items.iter().take(item).rev();
    let nav = rows.filter(|item| item.command < command::NAV_LAST && item.place().is_some());
    let holds = nav.take(2).filter(|item| HOLDS.contains(&item.command));
    let hold_s = holds
        .map(|item| f64::from(item.params[0]))
        .fold(0.0, f64::max);
    takeoff_s + way_s + stop_late_s(vehicle) + hold_s
}

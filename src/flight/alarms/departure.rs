//! A vehicle that takes off before its time, or not by its time: separation was proven for its departure as planned.

use super::corridor::{LATE_ERROR_S, assumed_late_s};
use super::{Alarms, Here, STALE_S, Watched};
use crate::path::takeoff_lateness_s;
use crate::spec::AlarmKind;

/// Higher than this over its home it has taken off, metres: its height on the ground drifts while it waits.
const TAKEN_OFF_M: f64 = 5.0;

impl Watched<'_> {
    /// What is said of a vehicle that has not taken off by when the verdict assumes it on its way at
    /// the latest.
    pub(super) fn grounded(&mut self, t_s: f64, slack_s: f64) -> Option<String> {
        let is_due = self.duty.flies && !self.duty.is_up && !self.duty.is_ordered;
        let departs_s = self.plan.waypoints.first().filter(|_| is_due)?.t_s;
        let here = self.here;
        let (item, slip_s) = here.map_or((0, 0.0), |here| {
            (here.fix.item, self.tube.slip_s(&here.fix))
        });
        let max_s = assumed_late_s(self, item) + slack_s + LATE_ERROR_S;
        let late_s = t_s - departs_s - slip_s;
        let is_known = here.is_some() && self.silent_s <= STALE_S;
        let what = match is_known {
            true => "has not taken off",
            false => "is not known to have taken off:",
        };
        (late_s > max_s).then(|| {
            format!(
                "{what} {late_s:.0} s after its departure (the verdict assumed at most {max_s:.0} s)"
            )
        })
    }

    /// What is said of a vehicle that has taken off earlier than the verdict assumed, once.
    fn early(&mut self, here: &Here, slack_s: f64) -> Option<String> {
        let home = self.plan.waypoints.first()?;
        let is_off = here.point.amsl.0 - home.point.amsl.0 > TAKEN_OFF_M;
        let up_s = self.up_s.take_if(|_| is_off)?;
        let early_s = home.t_s - up_s;
        let assumed_s = 0.0 - takeoff_lateness_s(self.vehicle).least;
        let max_s = assumed_s + slack_s + LATE_ERROR_S;
        (early_s > max_s).then(|| {
            format!(
                "took off {early_s:.0} s before its departure (the verdict assumed at most {max_s:.0} s)"
            )
        })
    }
}

impl Alarms<'_> {
    /// Whether it departed too early, by the first position that shows it in the air.
    pub(super) fn look_at_departure(&mut self, vehicle: usize, here: &Here) {
        let slack_s = self.spec.separation.time_slack_s;
        let early = self.vehicles[vehicle].early(here, slack_s);
        if let Some(text) = early {
            let key = (AlarmKind::Late, vehicle, None, "early");
            self.push(here.fix.t_s, key, true, text);
        }
    }
}

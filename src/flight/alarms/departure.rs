//! A vehicle that takes off before its time: separation was proven for its departure as planned.

use super::tube::LATE_ERROR_S;
use super::{Alarms, Here, Watched};
use crate::path::takeoff_lateness_s;
use crate::spec::AlarmKind;

/// Higher than this over its home it has taken off, metres: its height on the ground drifts while it waits.
const TAKEN_OFF_M: f64 = 5.0;

impl Watched<'_> {
    /// What is said of a vehicle that has taken off earlier than the verdict assumed, once.
    fn early(&mut self, here: &Here, slack_s: f64) -> Option<String> {
        let home = self.plan.waypoints.first()?;
        let is_off = here.point.amsl.0 - home.point.amsl.0 > TAKEN_OFF_M;
        let up_s = self.up_s.take_if(|_| is_off)?;
        let early_s = home.t_s - up_s;
        let assumed_s = 0.0 - takeoff_lateness_s(self.vehicle).least;
        let most_s = assumed_s + slack_s + LATE_ERROR_S;
        (early_s > most_s).then(|| {
            format!(
                "took off {early_s:.0} s before its departure (the verdict assumed at most {most_s:.0} s)"
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

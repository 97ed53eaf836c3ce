//! The report.

use super::{Session, Stage};
use crate::geodesy::LatLon;
use crate::link::codec::Version;
use crate::link::message::{Body, MissionResult};
use crate::link::time::Time;
use crate::link::transfer::identity;
use crate::link::transfer::report::{TransferReport, Verdict, hash};
use crate::link::transfer::state_machine::Task;

impl Session<'_> {
    fn description(&self) -> String {
        let Some((_, heartbeat)) = self.vehicle else {
            return String::new();
        };
        let description = identity::describe(&heartbeat);
        match self.version {
            Version::One => format!("{description}, MAVLink 1: fence and rally cannot be asked"),
            Version::Two => description,
        }
    }

    pub(crate) fn end(&mut self, now: Time, verdict: Verdict) {
        if let (Stage::Working(Task::Upload(_)), Some(route)) = (&self.stage, self.route()) {
            // Lets PX4 go, instead of leaving it waiting for 5 s.
            self.outbox.push_back(route.message(Body::Ack {
                result: MissionResult::OPERATION_CANCELLED,
                opaque_id: 0,
            }));
        }
        let [mission, fence, rally] = &self.held;
        let verified = verdict == Verdict::Verified;
        #[expect(
            clippy::cast_precision_loss,
            reason = "milliseconds of one transfer fit into f64"
        )]
        let seconds = (now - self.began) as f64 / 1000.0;
        self.report = Some(TransferReport {
            autopilot: self.description(),
            version: std::mem::take(&mut self.software),
            plan_ids: self.plan_ids,
            items: mission.len(),
            fence: fence.len(),
            rally: rally.len(),
            attempts: self.attempts,
            retries: self.retries,
            seconds,
            hash: if verified {
                hash(mission, fence, rally)
            } else {
                String::new()
            },
            from_home_m: self.place.map(|place| {
                let home = &self.order.mission.home;
                LatLon::of_e7(home.x, home.y).chord_m(place)
            }),
            differences: std::mem::take(&mut self.differences),
            statustexts: std::mem::take(&mut self.texts),
            ..TransferReport::nothing(
                self.order.vehicle,
                self.vehicle
                    .map_or(self.order.sysid, |(address, _)| address.system),
                verdict,
            )
        });
    }
}

//! A fleet in the air whose ground station crashed is taken over from its record.

use super::vehicle::Assignment;
use super::{Event, Fleet, Options, Phase};
use crate::flight::conformance::reference::ReferenceTrajectory;
use crate::flight::record::Flight;
use crate::flight::record::interrupted::Interrupted;
use crate::link::{Address, Time};

/// The last plan of a vehicle, if it was not seen to fly it yet: when it was sent, seconds after T0, its number of items,
/// and how it is flown.
fn sent(recorded: &Flight) -> Option<(f64, (usize, ReferenceTrajectory))> {
    let flown = recorded.plan_of_each().last().copied().unwrap_or_default();
    let (last, plan) = recorded.plans.iter().enumerate().next_back()?;
    (last > flown).then(|| (plan.from_s, (plan.items, plan.reference.clone())))
}

impl<'a> Fleet<'a> {
    /// Takes over a flight from its record, in the name of `us`, at a time on the clock of the
    /// driver and in milliseconds since 1970, on a clock that was not set since T0. Each vehicle flies the plan of its last position, or is sent a later one;
    /// the time without a record is named as a stop.
    #[must_use]
    pub fn take_over(
        mut assignments: Vec<Assignment<'a>>,
        options: Options,
        us: Address,
        (now, unix_ms): (Time, u64),
        flight: &Interrupted,
    ) -> Self {
        for of in &mut assignments {
            let recorded = flight.flight(of.vehicle);
            let flown_by = recorded.and_then(|of| {
                let plan = of.plan_of_each().last().copied().unwrap_or_default();
                of.plans.get(plan)
            });
            if let Some(plan) = flown_by {
                of.reference = plan.reference.clone();
            }
        }
        let mut fleet = Self::new(assignments, options, us, now);
        #[expect(clippy::cast_precision_loss, reason = "milliseconds of one flight")]
        let since_ms = unix_ms.saturating_sub(flight.t0_unix_ms()) as f64 * options.speedup;
        let t0_ms = fleet.flight_ms(now) - since_ms;
        fleet.phase = Phase::Flying { t0_ms };
        fleet.since_s = since_ms / 1000.0;
        for vehicle in &mut fleet.vehicles {
            if let Some(recorded) = flight.flight(vehicle.of.vehicle) {
                vehicle.take_over(recorded, t0_ms);
                let (sent_s, next) = sent(recorded).unzip();
                (vehicle.total.sent_s, vehicle.total.next) = (sent_s, next);
            }
            if let Some(ended) = flight.ended(vehicle.of.vehicle) {
                vehicle.take_over_ended(ended);
            }
        }
        let (from_s, t_s) = (flight.until_s(), since_ms / 1000.0);
        fleet.stops.push_back((from_s.min(t_s), t_s));
        fleet.events.push_back(Event {
            t_s: Some(t_s),
            vehicle: None,
            text: format!(
                "the flight is taken over: nothing was recorded from {from_s:.1} to {t_s:.1} s"
            ),
            alarm: None,
        });
        let clock = flight
            .clock_words()
            .map(|text| Event::new(Some(t_s), None, text));
        fleet.events.extend(clock);
        let lost = flight.lost().map(|text| Event::new(Some(t_s), None, text));
        fleet.events.extend(lost);
        fleet
    }
}

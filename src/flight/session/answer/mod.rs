//! Alarms of a fleet in flight, and what is done at each.

use super::vehicle::{Instruction, Stage};
use super::{Fleet, Phase};
use crate::flight::alarms::{Alarm, Alarms, Duty, Watch};
use crate::flight::event::{AlarmMark, Event};
use crate::flight::record::Plan;
use crate::flight::record::lines::{PlanLine, ThreatLine};
use crate::link::{FlightMessage, Message, Time};
use crate::spec::{Action, AlarmKind, MissionSpec, Who};
use crate::world::World;

/// An order that could not be given is tried again after this time, milliseconds.
const AGAIN_MS: u64 = 5000;
/// So is one to a vehicle whose flight is taken over, and that was not heard yet, milliseconds.
const REJOINING_MS: u64 = 500;

/// An order that waits until its way is clear.
#[derive(Clone, Debug)]
pub(in crate::flight) struct Waiting {
    vehicle: usize,
    kind: AlarmKind,
    /// The alarm: its vehicles, and its cause.
    of: (usize, Option<usize>, &'static str),
    instruction: Instruction,
    again: Time,
}

impl<'a> Fleet<'a> {
    /// Watches the fleet for alarms against its spec.
    #[must_use]
    pub fn watched(mut self, spec: &'a MissionSpec, world: &'a World) -> Self {
        let of = |vehicle: &super::FlightVehicle<'a>| {
            let id = vehicle.of.vehicle;
            let vehicle_of = spec.vehicles.iter().find(|of| of.id == id)?;
            Some(Watch {
                vehicle: vehicle_of,
                mission: vehicle.of.mission,
                reference: vehicle.of.reference.clone(),
            })
        };
        let watches: Option<Vec<Watch<'a>>> = self.vehicles.iter().map(of).collect();
        let speedup = self.options.speedup;
        self.alarms = watches.map(|fleet| Alarms::new(spec, world, fleet, self.us, speedup));
        // What was sent before its flight was taken over.
        let t_s = self.t_s(self.last).unwrap_or(0.0);
        let vehicles = self.vehicles.iter().enumerate();
        for (index, vehicle) in vehicles {
            if let (Some(alarms), Some((items, reference))) =
                (&mut self.alarms, &vehicle.total.next)
            {
                let (items, reference) = (*items, reference.clone());
                let plan = Plan {
                    items,
                    reference,
                    from_s: t_s,
                };
                alarms.replan(t_s, index, plan);
            }
        }
        self
    }

    /// A vehicle is sent another plan. One that cannot be read is reported by the verdict.
    pub(super) fn heed_plan(&mut self, now: Time, vehicle: &str, (given_s, plan): (f64, PlanLine)) {
        let t_s = self.t_s(now).unwrap_or(0.0);
        let index = self.vehicles.iter().position(|of| of.of.vehicle == vehicle);
        let Some(index) = index else { return };
        let vehicle = &mut self.vehicles[index];
        let Ok(plan) = plan.plan(*vehicle.of.reference.frame(), given_s) else {
            return;
        };
        vehicle.progress.add_mission(&plan);
        vehicle.total.next = Some((plan.items, plan.reference.clone()));
        vehicle.total.sent_s = Some(given_s);
        if let Some(alarms) = &mut self.alarms {
            alarms.replan(t_s, index, plan);
        }
    }

    /// Says of a vehicle once that the time of a transfer is out, and that it does not hold the plan.
    pub(super) fn look_for_plans(&mut self, now: Time, t_s: f64) {
        for index in 0..self.vehicles.len() {
            let until_s = self.alarms.as_ref().and_then(|of| of.waits_until_s(index));
            let vehicle = &mut self.vehicles[index];
            if until_s.is_some_and(|until_s| t_s >= until_s)
                && let Some(sent_s) = vehicle.total.sent_s.take()
            {
                let id = vehicle.of.vehicle.to_owned();
                let text = format!(
                    "does not hold the plan that replan sent at T0+{sent_s:.0} s: it flies the one before"
                );
                self.say(now, Some(id), text);
            }
        }
    }

    /// A threat has come up.
    pub(super) fn heed_threat(&mut self, threat: ThreatLine, t_s: f64) {
        if let (Some(alarms), Ok(popup)) = (&mut self.alarms, threat.popup(t_s)) {
            alarms.threat(&popup.threat);
        }
    }

    /// Hands a message of a vehicle's autopilot, and the position that it led to, to the alarms.
    pub(super) fn hand_over(&mut self, now: Time, index: usize, message: &Message) {
        let t_s = self.t_s(now).unwrap_or(0.0);
        let flies = self.t0_ms().is_some();
        let (Some(alarms), Some(vehicle)) = (&mut self.alarms, self.vehicles.get_mut(index)) else {
            return;
        };
        if alarms.handle(t_s, index, message) {
            // The line of the alarm has the text.
            vehicle.unsay();
        }
        let fresh = std::mem::take(&mut vehicle.is_fresh);
        if let (Message::Flight(FlightMessage::Position(position)), Some((_, fix))) =
            (message, vehicle.latest)
            && fresh
            && flies
        {
            alarms.position(t_s, index, fix, position);
            vehicle.take_height(t_s, alarms.agl_m(index));
        }
    }

    /// Looks for alarms, and answers them.
    pub(super) fn look_for_alarms(&mut self, now: Time) {
        let (Phase::Flying { .. }, Some(t_s)) = (self.phase, self.t_s(now)) else {
            return;
        };
        let Some(mut alarms) = self.alarms.take() else {
            let vehicles = self.vehicles.iter_mut();
            return vehicles.for_each(|vehicle| vehicle.say_taken_back());
        };
        for (index, vehicle) in self.vehicles.iter().enumerate() {
            let duty = Duty {
                flies: matches!(vehicle.stage, Stage::Flying | Stage::Starting),
                is_up: vehicle.has_taken_off(),
                is_ordered: vehicle.instruction.is_some(),
                lands: vehicle.instruction == Some(Instruction::Land),
                returns: vehicle.instruction == Some(Instruction::Return),
                // One that may be armed may still fly.
                is_over: matches!(vehicle.stage, Stage::Ended) && vehicle.still_armed.is_none(),
                held: vehicle.total.ready,
            };
            alarms.note(t_s, index, duty);
            alarms.take_settings(index, vehicle.other_settings());
        }
        alarms.look(t_s);
        for (index, vehicle) in self.vehicles.iter_mut().enumerate() {
            if let Some(instruction) = vehicle.taken_back.take() {
                alarms.taken_back(t_s, index, instruction.verb());
            }
            if let Some(text) = vehicle.take_left_order() {
                alarms.left_order(t_s, index, text);
            }
        }
        let raised: Vec<Alarm> = std::iter::from_fn(|| alarms.poll()).collect();
        self.alarms = Some(alarms);
        for alarm in raised {
            self.announce(now, &alarm);
        }
        self.try_again(now);
    }

    /// Reports an alarm, and does what the spec says.
    pub(super) fn announce(&mut self, now: Time, alarm: &Alarm) {
        let id = |index: usize| self.vehicles.get(index).map(|of| of.of.vehicle.to_owned());
        let (kind, text) = (alarm.kind, &alarm.text);
        let text = if alarm.is_raised {
            format!("ALARM {kind}: {text}")
        } else {
            format!("{kind} alarm: {text}")
        };
        self.events.push_back(Event {
            t_s: Some(alarm.t_s),
            vehicle: id(alarm.vehicle),
            text,
            alarm: Some(AlarmMark {
                kind,
                other: alarm.other.and_then(id),
                is_raised: alarm.is_raised,
            }),
        });
        if alarm.is_raised {
            self.answer(now, alarm);
        } else {
            let (kind, of) = (alarm.kind, (alarm.vehicle, alarm.other, alarm.cause));
            self.waiting.retain(|w| (w.kind, w.of) != (kind, of));
        }
    }

    fn answer(&mut self, now: Time, alarm: &Alarm) {
        let answer = self.options.on_alarm.answer(alarm.kind);
        let instruction = match answer.action {
            Action::Continue => return,
            Action::Hold => Instruction::Hold,
            Action::Land => Instruction::Land,
            Action::Return => Instruction::Return,
        };
        let is_own = |index: usize| index == alarm.vehicle || Some(index) == alarm.other;
        let who: Vec<usize> = (0..self.vehicles.len())
            .filter(|&index| match answer.who {
                Who::Vehicle => is_own(index),
                Who::Others => !is_own(index),
                Who::All => true,
            })
            .collect();
        let verb = instruction.verb();
        let kind = alarm.kind;
        match answer.who {
            Who::All => self.say(now, None, format!("on_alarm {kind}: all {verb}")),
            Who::Others => self.say(now, None, format!("on_alarm {kind}: the others {verb}")),
            Who::Vehicle => {}
        }
        for vehicle in who {
            let waiting = Waiting {
                vehicle,
                kind,
                of: (alarm.vehicle, alarm.other, alarm.cause),
                instruction,
                again: now,
            };
            self.order(now, waiting, true);
        }
    }

    /// Gives an order, if its way is clear; else it waits.
    fn order(&mut self, now: Time, waiting: Waiting, is_first: bool) {
        let (index, instruction) = (waiting.vehicle, waiting.instruction);
        let t_s = self.t_s(now).unwrap_or(0.0);
        let Some(vehicle) = self.vehicles.get_mut(index) else {
            return;
        };
        // A vehicle that has not taken off stays on the ground.
        if matches!(vehicle.stage, Stage::Armed) {
            return vehicle.disarm(None);
        }
        let grounded = match vehicle.stays_on_ground(instruction) {
            true => Some("stays on the ground"),
            false => vehicle
                .stands()
                .then_some("is on the ground, and stays there"),
        };
        if let Some(what) = grounded {
            let text = format!("on_alarm {}: {what}", waiting.kind);
            let id = vehicle.of.vehicle.to_owned();
            return self.say(now, Some(id), text);
        }
        if matches!(vehicle.stage, Stage::Rejoining { .. }) {
            // Whether it flies is known soon.
            let again = now + REJOINING_MS;
            return self.waiting.push(Waiting { again, ..waiting });
        }
        let is_obeying =
            vehicle.instruction.is_some_and(|of| of >= instruction) || vehicle.lands_as_planned();
        if is_obeying || !matches!(vehicle.stage, Stage::Flying | Stage::Starting) {
            return;
        }
        let circles = instruction == Instruction::Hold
            || instruction == Instruction::Land && vehicle.lands_by_circling();
        let problem = self.alarms.as_ref().and_then(|alarms| match instruction {
            _ if circles => alarms.circle_problem(t_s, index),
            Instruction::Return => alarms.return_problem(t_s, index),
            Instruction::Hold | Instruction::Land => None,
        });
        let id = self.vehicles[index].of.vehicle.to_owned();
        let (kind, verb) = (waiting.kind, instruction.verb());
        let Some(why) = problem else {
            let text = format!("on_alarm {kind}: is ordered to {verb}");
            self.say(now, Some(id), text);
            if let Some(alarms) = &mut self.alarms {
                alarms.ordered(t_s, index, instruction == Instruction::Return);
            }
            self.given.retain(|given| given.vehicle != index);
            self.given.push(waiting);
            return self.vehicles[index].instruct(instruction);
        };
        if is_first {
            let text = format!("on_alarm {kind}: does not {verb}, it continues: {why}");
            self.say(now, Some(id), text);
        }
        let again = now + AGAIN_MS;
        self.waiting.push(Waiting { again, ..waiting });
    }

    /// A return that a vehicle has not obeyed yet is judged again from where it is now: it may have flown on
    /// without hearing the order.
    pub(super) fn judge_returns_again(&mut self, now: Time) {
        let t_s = self.t_s(now).unwrap_or(0.0);
        for index in 0..self.vehicles.len() {
            let vehicle = &self.vehicles[index];
            let (Some(alarms), true) = (&self.alarms, vehicle.is_to_return()) else {
                continue;
            };
            let problem = match vehicle.is_placed() {
                true => alarms.return_problem(t_s, index),
                false => continue,
            };
            let given = self.given.iter().position(|given| given.vehicle == index);
            let (Some(why), Some(given)) = (problem, given) else {
                // Others stay out of its way from here.
                if let Some(alarms) = &mut self.alarms {
                    alarms.ordered(t_s, index, true);
                }
                continue;
            };
            let given = self.given.swap_remove(given);
            self.vehicles[index].withdraw();
            if let Some(alarms) = &mut self.alarms {
                alarms.ordered(t_s, index, false);
            }
            let id = self.vehicles[index].of.vehicle.to_owned();
            let kind = given.kind;
            let text =
                format!("on_alarm {kind}: is not ordered to return any more, it continues: {why}");
            self.say(now, Some(id), text);
            let again = now + AGAIN_MS;
            self.waiting.push(Waiting { again, ..given });
        }
    }

    /// The wings whose circles are not clear where an operator holds them, and why.
    pub(super) fn circles_not_clear(
        &self,
        now: Time,
        instruction: Instruction,
    ) -> Vec<(String, String)> {
        let t_s = self.t_s(now).unwrap_or(0.0);
        let problem = |index: usize| {
            let vehicle = &self.vehicles[index];
            let holds = vehicle.instruction == Some(Instruction::Hold);
            let alarms = self.alarms.as_ref().filter(|_| holds)?;
            let why = alarms.circle_problem(t_s, index)?;
            Some((vehicle.of.vehicle.to_owned(), why))
        };
        let all = (0..self.vehicles.len()).filter(|_| instruction == Instruction::Hold);
        all.filter_map(problem).collect()
    }

    fn try_again(&mut self, now: Time) {
        let waiting = std::mem::take(&mut self.waiting);
        for one in waiting {
            if now >= one.again {
                self.order(now, one, false);
            } else {
                self.waiting.push(one);
            }
        }
    }
}

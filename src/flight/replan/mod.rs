//! New paths for a fleet in flight, around a threat that comes up.
//!
//! A vehicle goes on by its present mission while its new one is planned and sent. So its new
//! path branches off the present one as far ahead as the vehicle gets until it holds the new
//! mission, and the new mission holds the waypoints before that too: wherever the vehicle takes
//! the mission over, it goes on.

mod activity;
mod assessment;
mod diversions;
mod document;
mod in_column;
mod joint_plan;
mod new_mission;
mod observation;
mod path_distance;
mod state;

use std::collections::BTreeMap;

use super::clock::{Clock, steady_ms};
use super::error::FlightError;
use super::launch::plan::FlightPlan;
use super::record::handoff::Notice;
use super::record::lines::Line;
use crate::link::Links;
use crate::spec::{Airframe, Link, MissionSpec, Threat, Vehicle};
use crate::verify::Review;
use crate::world::Disc;

pub use activity::Doing;
use assessment::{Assessment, NoPath};
pub use assessment::{Unavoidable, sentence};
pub use document::{document, failure_document};
use joint_plan::{Replanned, replan};
pub use new_mission::NewMission;
use observation::{Observation, Observer};
use state::ThreatTime;
pub use state::VehicleState;

/// Time that planning may take at first, on the wall's clock, seconds.
const PLANNING_S: f64 = 0.8;
/// Allowance for sending all lists, in times that reading them took; and seconds besides.
const SENDING: f64 = 2.0;
const SENDING_S: f64 = 0.2;
/// A vehicle may be early or late on its path by this, seconds of its own time.
const SPARE_S: f64 = 3.0;
/// Attempts at a plan, each with more time than the one before.
const ATTEMPTS: usize = 3;

/// How each vehicle that was sent a new mission took it, by its index in the spec.
pub type Outcomes = BTreeMap<usize, Result<(), String>>;

/// The new missions, and from what they were planned.
#[derive(Debug)]
pub struct Decision {
    /// The state of every vehicle in flight.
    pub states: Vec<VehicleState>,
    /// The missions to send.
    pub missions: Vec<NewMission>,
    /// The verdict on all vehicles together.
    pub review: Review,
    /// The vehicles that cannot avoid a threat.
    pub unavoidable: Vec<Unavoidable>,
    /// Vehicles, by index in the spec, that fly something else and whose mission meets a threat.
    pub not_to_resume: Vec<usize>,
    /// Whether every limit holds that a new path could violate.
    pub is_sound: bool,
    /// Whether the new paths keep the buffers of the spec; else they keep its limits alone.
    pub has_buffers: bool,
    /// Time that observing and planning took, seconds.
    pub planned_s: f64,
    observation: Observation,
}

/// Plans new paths for a fleet in flight, and sends them.
pub struct Replanner<'a> {
    plan: &'a FlightPlan,
    /// Every threat that has come up.
    popups: &'a [Threat],
    notice: &'a Notice,
    threat_time: ThreatTime,
    links: Links,
    clock: Clock,
}

/// Refuses fleets that cannot be led onto new paths: planes, VTOL with an approach or with stops.
///
/// # Errors
/// [`FlightError::Verdict`]
pub fn refuse_unsupported(spec: &MissionSpec) -> Result<(), FlightError> {
    for vehicle in &spec.vehicles {
        let why = match vehicle.airframe {
            Airframe::Plane => "is a plane: only copters and VTOL are led onto new paths",
            Airframe::Vtol if has_given_approach(vehicle) => {
                "has an approach: only VTOL that land from anywhere are led onto new paths"
            }
            Airframe::Vtol if !vehicle.stops.is_empty() => {
                "is a VTOL with stops: those of copters alone are kept on new paths"
            }
            Airframe::Vtol | Airframe::Copter => continue,
        };
        let message = format!(
            "{} {why}; nothing was sent, and the flight of every vehicle is judged against the threat",
            vehicle.id
        );
        return Err(FlightError::Verdict(message));
    }
    Ok(())
}

/// Whether the spec gives the course on which a wing lands.
fn has_given_approach(vehicle: &Vehicle) -> bool {
    let landing = vehicle.wing.and_then(|wing| wing.landing);
    landing.is_some_and(|landing| landing.heading_rad.is_some())
}

/// Adds threats to the spec and the world of a plan: they hold for everything that is planned and
/// judged from now on.
pub fn add_threats(plan: &mut FlightPlan, popups: &[Threat]) {
    for threat in popups {
        let center = plan.world.frame.to_plan(threat.place);
        let radius_m = threat.radius_m + plan.spec().buffers.threats_m;
        plan.world.threats.push(Disc { center, radius_m });
        plan.file.spec.threats.push(threat.clone());
    }
}

impl<'a> Replanner<'a> {
    /// Opens the links, each with the index of its vehicle in the spec. The last threat counts
    /// since `threat_ms`, milliseconds on the steady clock.
    ///
    /// # Errors
    /// The link that cannot be opened, and why.
    pub fn open(
        plan: &'a FlightPlan,
        links: &[(usize, Link)],
        popups: &'a [Threat],
        notice: &'a Notice,
        threat_ms: u64,
    ) -> Result<Self, (String, std::io::Error)> {
        let vehicles = links.iter();
        let systems: Vec<(u8, &Link)> = vehicles
            .map(|(index, link)| (plan.vehicle(*index).sysid, link))
            .collect();
        Ok(Self {
            plan,
            popups,
            notice,
            threat_time: ThreatTime {
                steady_ms: threat_ms,
                speedup: notice.speedup,
            },
            links: Links::open(&systems)?,
            clock: Clock::start(),
        })
    }

    /// Observes the fleet and plans; again, with more time, when planning took longer than was
    /// allowed for. `note` is handed remarks for the operator.
    ///
    /// # Errors
    /// [`FlightError::Transfer`] for a vehicle that does not answer, [`FlightError::Verdict`] for
    /// a mission that cannot be replanned and for planning that takes too long.
    pub fn decide(&self, seed: Option<u64>, note: &dyn Fn(&str)) -> Result<Decision, FlightError> {
        let mut observer = Observer::read(&self.links, &self.clock, self.plan, &self.notice.ended)?;
        let mut planning_s = PLANNING_S;
        let mut no_path = NoPath::new();
        for _ in 0..ATTEMPTS {
            let observation = observer.observe()?;
            let sending_s = SENDING * observation.reading_s + SENDING_S;
            let lead_s = (planning_s + sending_s) * self.notice.speedup + SPARE_S;
            let states = self.states(&observation, note)?;
            let mut assessment = Assessment {
                plan: self.plan,
                popups: self.popups,
                others: Vec::new(),
                concerned: Vec::new(),
                unavoidable: Vec::new(),
                now_s: self.notice.t_s(observation.steady_ms),
                seed,
            };
            assessment.sort(&states, lead_s, &no_path);
            let Replanned {
                missions,
                review,
                has_buffers,
                ..
            } = replan(&mut assessment, &mut no_path);
            let planned_s = self.clock.seconds() - observation.at_s;
            let is_sound = assessment.is_sound(&review);
            let not_to_resume = states.iter().filter(|of| assessment.mission_is_met(of));
            let not_to_resume = not_to_resume.map(|of| of.vehicle).collect();
            if planned_s <= planning_s || !is_sound || assessment.concerned.is_empty() {
                return Ok(Decision {
                    states,
                    missions,
                    review,
                    unavoidable: assessment.unavoidable,
                    not_to_resume,
                    is_sound,
                    has_buffers,
                    planned_s,
                    observation,
                });
            }
            planning_s = 1.5 * planned_s;
        }
        Err(FlightError::Verdict(format!(
            "planning takes too long here ({:.1} s); nothing was sent",
            planning_s / 1.5
        )))
    }

    /// Lines for the record: the new plans.
    #[must_use]
    pub fn record_lines(&self, decision: &Decision) -> Vec<Line> {
        let since_s = self.notice.t_s(decision.observation.steady_ms);
        let missions = decision.missions.iter();
        missions
            .map(|new| Line::of_plan(&self.plan.vehicle(new.vehicle).id, since_s, &new.plan))
            .collect()
    }

    /// Lines for the record: how each vehicle took its new mission.
    #[must_use]
    pub fn outcome_lines(&self, outcomes: &Outcomes) -> Vec<Line> {
        let t_s = Some(self.notice.t_s(steady_ms()));
        let line = |(index, outcome): (&usize, &Result<(), String>)| Line::Event {
            t_s,
            vehicle: Some(self.plan.vehicle(*index).id.clone()),
            event: match outcome {
                Ok(()) => "is on the plan of replan".to_owned(),
                Err(why) => format!("is not on the plan of replan: {why}"),
            },
        };
        outcomes.iter().map(line).collect()
    }

    /// Transfers the new missions, and has the vehicles go on with them.
    #[must_use]
    pub fn send(&self, decision: &Decision) -> Outcomes {
        let missions = &decision.missions;
        diversions::divert(
            &self.links,
            &self.clock,
            self.plan,
            (missions, &decision.observation),
        )
    }

    /// Why a vehicle is neither led nor kept clear of.
    fn left_out(&self, id: &str, is_silent: bool) -> String {
        match self.notice.ended.get(id) {
            Some(ended) => format!("{id}: its flight is over ({}); it is left out", ended.end),
            None if is_silent => format!(
                "WARNING: {id} is not heard: where it is, is not known, and the new paths of the others do not keep clear of it"
            ),
            None => format!("{id}: does not fly; it is left out"),
        }
    }

    /// The state of each vehicle in flight.
    fn states(
        &self,
        observation: &Observation,
        note: &dyn Fn(&str),
    ) -> Result<Vec<VehicleState>, FlightError> {
        let mut states = Vec::new();
        for (index, mission) in &self.plan.missions {
            let id = &self.plan.vehicle(*index).id;
            let observed = observation.vehicles.get(index);
            let Some(observed) = observed.filter(|of| of.heartbeat.is_armed()) else {
                note(&self.left_out(id, observation.silent.contains(index)));
                continue;
            };
            let state = VehicleState::new(self.plan, *index, mission, observed, &self.threat_time);
            states.push(
                state.map_err(|why| {
                    FlightError::Verdict(format!("{id}: {why}; nothing was sent"))
                })?,
            );
        }
        Ok(states)
    }
}

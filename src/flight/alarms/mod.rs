//! Alarms in flight: a machine without sockets and clocks, as [`crate::link`] has them.
//!
//! Its driver hands in the decoded messages of each autopilot ([`Alarms::handle`]), each position
//! on the clock of the fleet ([`Alarms::position`]), what the session has each vehicle do
//! ([`Alarms::note`]), and the time ([`Alarms::look`]). It raises an [`Alarm`] once, and ends it
//! when its cause has been gone for some seconds.

mod breach;
mod corridor;
mod departure;
mod future;
mod health;
mod motion;
mod onboard;
pub(super) mod order_safety;
mod reports;
mod skips;
mod standing;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, VecDeque};

use super::conformance::reference::ReferenceTrajectory;
use super::launch::parameters::ParameterMismatch;
use super::record::{Fix, Plan};
use crate::geodesy::PlanPoint;
use crate::link::{Address, Message, Position};
use crate::mission::VehicleMission;
use crate::numeric::approach::Segment;
use crate::spec::{AlarmKind, MissionSpec, Threat, Vehicle};
use crate::world::{Disc, World};
use breach::Breaches;
use corridor::TubeWatch;
use health::HealthState;
use motion::Motion;
use onboard::Onboard;
use onboard::rate_limited::RateLimited;
use skips::Skips;
use standing::{Key, Stall, Standing};

/// A position that is older than this is stale: seconds of flight, and of the wall's clock.
const STALE_S: f64 = 1.5;
const STALE_WALL_S: f64 = 0.75;
/// Positions that come late by so much more, and for this long, are as bad, seconds.
const LAG_S: f64 = 1.0;
/// A report of battery, GPS or estimate that came before and does not come for this long has stopped: seconds of
/// flight, and of the wall's clock. It is requested twice a second, and again after 3 s.
const NO_REPORT_S: f64 = 10.0;
const NO_REPORT_WALL_S: f64 = 2.5;
/// More than this between two looks was a stall of this machine, in which nobody was heard,
/// seconds of the wall's clock.
const STALL_WALL_S: f64 = 0.1;
/// One of at least this is named by the alarms after it, seconds of flight.
const LONG_STALL_S: f64 = 5.0;
/// Between two looks into the future, seconds of flight.
const FUTURE_S: f64 = 0.5;

/// An alarm that was raised, or is over.
#[derive(Clone, Debug, PartialEq)]
pub struct Alarm {
    /// Seconds after T0.
    pub t_s: f64,
    /// Index of the vehicle.
    pub vehicle: usize,
    /// Index of the other vehicle of a separation.
    pub other: Option<usize>,
    /// What it is about.
    pub kind: AlarmKind,
    /// What is wrong, where alarms of one kind have several causes.
    pub cause: &'static str,
    /// Whether it begins; else it is over.
    pub is_raised: bool,
    /// In words.
    pub text: String,
}

/// What the session has a vehicle do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Duty {
    /// Whether it is in flight: its mission was started and its motors run.
    pub flies: bool,
    /// Whether it took off.
    pub is_up: bool,
    /// Whether it was ordered to leave its mission.
    pub is_ordered: bool,
    /// Whether it was ordered to land where it is.
    pub lands: bool,
    /// Whether it was ordered to return.
    pub returns: bool,
    /// Whether its flight is over.
    pub is_over: bool,
    /// Items that it said to hold when they were read.
    pub held: Option<usize>,
}

/// A vehicle and the plan that its flight is held against.
#[derive(Clone, Debug)]
pub struct Watch<'a> {
    /// As the spec has it.
    pub vehicle: &'a Vehicle,
    /// The mission on board.
    pub mission: &'a VehicleMission,
    /// The planned flight.
    pub reference: ReferenceTrajectory,
}

/// What is known of one vehicle.
#[derive(Debug)]
struct Watched<'a> {
    vehicle: &'a Vehicle,
    mission: &'a VehicleMission,
    plan: ReferenceTrajectory,
    duty: Duty,
    health: HealthState,
    motion: Motion,
    onboard: Onboard,
    tube: TubeWatch,
    /// The last position.
    here: Option<Here>,
    /// Where it may fly on an ordered return, whenever it does.
    returns: Vec<Segment>,
    /// Time since the last position in which somebody listened, seconds of flight.
    silent_s: f64,
    /// How late its last position came, and since when all came too late, seconds.
    lag: Option<(f64, f64)>,
    /// The last alarm of its mode, and of its parameters.
    mode_reports: RateLimited,
    settings_reports: RateLimited,
    /// When it left the ground, seconds after T0, until its departure was looked at.
    up_s: Option<f64>,
    skips: Skips,
}

/// A position, its velocity to the east, the north and up, m/s, and its height above the ground.
#[derive(Clone, Copy, Debug)]
struct Here {
    fix: Fix,
    point: PlanPoint,
    velocity_mps: [f64; 3],
    agl_m: f64,
}

/// A heartbeat that shows its mode comes within this time, seconds: one is sent each second, and two may be lost.
const HEARTBEATS_S: f64 = 3.0;

/// The alarms of a fleet in flight.
#[derive(Debug)]
pub struct Alarms<'a> {
    spec: &'a MissionSpec,
    /// Without buffers: a flight is held against the limits alone.
    world: World,
    us: Address,
    speedup: f64,
    vehicles: Vec<Watched<'a>>,
    standing: BTreeMap<Key, Standing>,
    /// How long separation and clearance have been broken.
    breaches: Breaches,
    popups: Vec<(Disc, String)>,
    out: VecDeque<Alarm>,
    /// When [`Alarms::look`] was last called, and looked into the future.
    looked_s: Option<f64>,
    future_s: f64,
    /// The last stall of this ground station.
    stall: Option<Stall>,
}

impl<'a> Alarms<'a> {
    /// Begins to watch a fleet, in the order of its assignments, in the name of `us`. `speedup`
    /// is how much faster than the wall's clock the time of the vehicles goes.
    #[must_use]
    pub fn new(
        spec: &'a MissionSpec,
        world: &World,
        fleet: Vec<Watch<'a>>,
        us: Address,
        speedup: f64,
    ) -> Self {
        let watched = |of: Watch<'a>| Watched {
            vehicle: of.vehicle,
            mission: of.mission,
            tube: TubeWatch::new(of.vehicle, &of.reference),
            onboard: Onboard::new(of.mission.items.len()),
            plan: of.reference,
            duty: Duty::default(),
            health: HealthState::of(of.vehicle),
            motion: Motion::default(),
            here: None,
            returns: Vec::new(),
            silent_s: 0.0,
            lag: None,
            mode_reports: RateLimited::default(),
            settings_reports: RateLimited::default(),
            up_s: None,
            skips: Skips::default(),
        };
        Self {
            spec,
            world: world.without_buffers(spec),
            us,
            speedup,
            vehicles: fleet.into_iter().map(watched).collect(),
            standing: BTreeMap::new(),
            breaches: Breaches::default(),
            popups: Vec::new(),
            out: VecDeque::new(),
            looked_s: None,
            future_s: f64::NEG_INFINITY,
            stall: None,
        }
    }

    /// The next alarm.
    pub fn poll(&mut self) -> Option<Alarm> {
        self.out.pop_front()
    }

    /// Takes in what the session has a vehicle do.
    pub fn note(&mut self, t_s: f64, vehicle: usize, duty: Duty) {
        if let Some(of) = self.vehicles.get_mut(vehicle) {
            if duty.flies && !of.duty.flies {
                of.silent_s = 0.0;
                of.onboard.begin(duty.held, &of.mission.home);
                if !duty.is_up {
                    of.skips.begin(t_s, of.here.as_ref());
                }
            }
            if !duty.returns && of.duty.is_ordered || duty.is_over {
                of.returns.clear();
            }
            if duty.is_up && !of.duty.is_up {
                // Of one that was in the air when its flight was taken over the departure is not known.
                of.up_s = duty.flies.then_some(t_s);
            }
            of.duty = duty;
            // A return that was ordered before its flight was taken over.
            if duty.returns && duty.flies && of.returns.is_empty() {
                self.ordered(t_s, vehicle, true);
            }
        }
    }

    /// T0 of a vehicle: the ids of its mission, fence and rally points when they were read, and whether its home was
    /// compared.
    pub(in crate::flight) fn set_checked(
        &mut self,
        vehicle: usize,
        checked: (Option<[u32; 3]>, bool),
    ) {
        if let Some(of) = self.vehicles.get_mut(vehicle) {
            of.onboard.set_checked(checked);
        }
    }

    /// By how much departures may be off, seconds.
    #[must_use]
    pub fn slack_s(&self) -> f64 {
        self.spec.separation.time_slack_s
    }

    /// How high a vehicle is above the ground, metres, where the ground is known and its height is not frozen.
    #[must_use]
    pub fn agl_m(&self, vehicle: usize) -> Option<f64> {
        let of = self.vehicles.get(vehicle)?;
        let here = of.here.filter(|_| !of.motion.is_height_frozen())?;
        Some(here.agl_m).filter(|agl_m| agl_m.is_finite())
    }

    /// Takes in another plan that a vehicle is sent from a time in seconds after T0 on: it flies it from when it holds
    /// as many items.
    pub fn replan(&mut self, t_s: f64, vehicle: usize, plan: Plan) {
        let speedup = self.speedup;
        if let Some(of) = self.vehicles.get_mut(vehicle) {
            of.onboard.expect_transfer((t_s, speedup), plan, of.mission);
        }
    }

    /// Until when a plan that a vehicle is sent is waited for, seconds after T0; none where none is.
    pub(in crate::flight) fn waits_until_s(&self, vehicle: usize) -> Option<f64> {
        self.vehicles.get(vehicle)?.onboard.waits_until_s()
    }

    /// Takes in the parameters that a vehicle says to be others than planned, and one that says how it returns.
    pub(in crate::flight) fn take_settings(
        &mut self,
        vehicle: usize,
        (others, of_return): (Vec<ParameterMismatch>, Option<&ParameterMismatch>),
    ) {
        if let Some(of) = self.vehicles.get_mut(vehicle) {
            of.onboard.take_settings(&others, of_return);
        }
    }

    /// Takes in a message of the autopilot of a vehicle, at a time in seconds after T0; whether it
    /// is a text that became an alarm.
    pub fn handle(&mut self, t_s: f64, vehicle: usize, message: &Message) -> bool {
        let Some(of) = self.vehicles.get_mut(vehicle) else {
            return false;
        };
        let (us, mission) = (self.us, of.mission);
        of.health.handle(t_s, message);
        of.onboard.handle(t_s, message, us, mission, of.duty.flies);
        if let Some(plan) = of.onboard.new_plan() {
            of.tube = TubeWatch::new(of.vehicle, &plan.reference);
            of.plan = plan.reference;
            of.skips = Skips::default();
        }
        self.look_at_items(t_s, vehicle, message);
        let of = &mut self.vehicles[vehicle];
        let Some(text) = of.health.take_text().filter(|_| of.duty.flies) else {
            return false;
        };
        self.push(t_s, (AlarmKind::Text, vehicle, None, ""), true, text);
        true
    }

    /// Takes in a position of a vehicle that came at `t_s`, with its time on the clock of the fleet.
    pub fn position(&mut self, t_s: f64, vehicle: usize, fix: Fix, position: &Position) {
        // Positions that waited during a stall come before the next look.
        self.note_stall(t_s);
        let frame = self.world.frame;
        let stale_s = self.stale_s();
        let Some(of) = self.vehicles.get_mut(vehicle) else {
            return;
        };
        let point = PlanPoint {
            at: frame.to_plan(fix.place),
            amsl: fix.amsl,
        };
        let [north, east, down] = position.velocity_cmps.map(|cmps| f64::from(cmps) / 100.0);
        let ground = self.world.terrain.height(fix.place);
        let here = Here {
            fix,
            point,
            velocity_mps: [east, north, -down],
            agl_m: ground.map_or(f64::NAN, |ground| fix.amsl.above_ground(ground).0),
        };
        of.silent_s = 0.0;
        let lag_s = t_s - fix.t_s;
        let since_s = of.lag.map_or(t_s, |(_, since_s)| since_s);
        of.lag = (lag_s > stale_s + LAG_S).then_some((lag_s, since_s));
        of.here = Some(here);
        let is_up = of.duty.flies && of.duty.is_up;
        let was_frozen =
            self.standing
                .contains_key(&(AlarmKind::Position, vehicle, None, "frozen"));
        let is_due = is_up || was_frozen;
        let moves = is_up && of.is_on_plan() && of.tube.should_move(&of.plan, &here);
        let (frozen, jumped) = of.motion.take(&here, position, (moves, is_up));
        let (frozen, jumped) = (frozen.filter(|_| is_due), jumped.filter(|_| is_up));
        self.set(
            fix.t_s,
            (AlarmKind::Position, vehicle, None, "frozen"),
            frozen,
        );
        self.set(
            fix.t_s,
            (AlarmKind::Position, vehicle, None, "jump"),
            jumped,
        );
        self.look_at_departure(vehicle, &here);
        self.look_at_waypoints(t_s, vehicle, &here);
        self.look_at_tube(vehicle, &here);
        self.look_at_distances(vehicle, &here);
        self.look_at_threats(vehicle, &here);
    }

    /// Does what is due at a time in seconds after T0.
    pub fn look(&mut self, t_s: f64) {
        let since_s = self.note_stall(t_s);
        self.looked_s = Some(t_s);
        // What a machine that stalls does not hear is no silence of a vehicle.
        let listened_s = since_s.clamp(0.0, STALL_WALL_S * self.speedup.max(1.0));
        let stale_s = self.stale_s();
        let old_s = NO_REPORT_S.max(NO_REPORT_WALL_S * self.speedup);
        for index in 0..self.vehicles.len() {
            let of = &mut self.vehicles[index];
            of.silent_s += listened_s;
            of.health.listen(listened_s, stale_s, old_s);
            let duty = of.duty;
            let silent_s = of.silent_s;
            let key = (AlarmKind::Position, index, None, "stale");
            // It is not over as long as nothing comes, though the flight is given up.
            let is_due = duty.flies || self.standing.contains_key(&key);
            let is_stale = is_due && silent_s > stale_s;
            let stale = is_stale.then(|| format!("no position for {silent_s:.1} s"));
            self.set(t_s, key, stale);
            // Those that waited while this program was stopped come at once.
            let lag = self.vehicles[index].lag;
            let lag = lag.filter(|(_, since_s)| duty.flies && t_s - since_s >= LAG_S);
            let lag = lag.map(|(lag_s, _)| format!("positions come {lag_s:.1} s late"));
            self.set(t_s, (AlarmKind::Position, index, None, "lag"), lag);
            let grounded = self.vehicles[index].grounded(t_s, self.spec.separation.time_slack_s);
            self.set(t_s, (AlarmKind::Late, index, None, "takeoff"), grounded);
            self.look_at_health(t_s, index);
        }
        if t_s - self.future_s >= FUTURE_S {
            self.future_s = t_s;
            self.look_ahead(t_s);
        }
    }

    /// A vehicle left what it was ordered to do for another mode.
    pub(super) fn left_order(&mut self, t_s: f64, vehicle: usize, text: String) {
        self.push(t_s, (AlarmKind::Mode, vehicle, None, ""), true, text);
    }

    /// Positions that do not come for this long are stale, seconds of flight.
    fn stale_s(&self) -> f64 {
        STALE_S.max(STALE_WALL_S * self.speedup)
    }

    /// A vehicle left what it was ordered to do, and flies its mission again.
    pub(super) fn taken_back(&mut self, t_s: f64, vehicle: usize, verb: &str) {
        let Some(of) = self.vehicles.get(vehicle) else {
            return;
        };
        let by = of.onboard.why_in_mission().unwrap_or("cause unknown");
        let text = format!("is on its mission again, although it was ordered to {verb}: {by}");
        self.push(t_s, (AlarmKind::Mode, vehicle, None, ""), true, text);
    }

    /// The alarms of a vehicle that stand.
    #[must_use]
    pub fn standing_of(&self, vehicle: usize) -> Vec<AlarmKind> {
        let is_its = |key: &&Key| key.1 == vehicle || key.2 == Some(vehicle);
        let standing = self.standing.keys().filter(is_its);
        let mut kinds: Vec<AlarmKind> = standing.map(|key| key.0).collect();
        kinds.dedup();
        kinds
    }

    /// Percent of its battery left and `GPS_FIX_TYPE` of a vehicle, as far as it says so.
    #[must_use]
    pub fn reported(&self, vehicle: usize) -> (Option<i8>, Option<u8>) {
        let of = self.vehicles.get(vehicle);
        let health = of.map(|of| &of.health);
        (
            health.and_then(HealthState::remaining),
            health.and_then(HealthState::fix),
        )
    }

    /// The threats of the world, with their ids.
    fn threats(&self) -> impl Iterator<Item = (Disc, &str)> {
        let ids = self.spec.threats.iter().map(|threat| threat.id.as_str());
        let popups = self.popups.iter();
        let known = self.world.threats.iter().copied().zip(ids);
        known.chain(popups.map(|(disc, id)| (*disc, id.as_str())))
    }

    /// Takes in a threat that has come up.
    pub fn threat(&mut self, threat: &Threat) {
        let center = self.world.frame.to_plan(threat.place);
        let radius_m = threat.radius_m;
        let disc = Disc { center, radius_m };
        self.popups.push((disc, threat.id.clone()));
    }
}

impl Watched<'_> {
    /// Whether it flies its mission, as far as its heartbeat shows.
    fn is_on_plan(&self) -> bool {
        self.duty.flies && !self.duty.is_ordered && self.onboard.flies_mission(self.mission)
    }

    /// When its mission is started, seconds after T0.
    fn starts_s(&self) -> f64 {
        self.plan.waypoints.first().map_or(0.0, |home| home.t_s)
    }

    /// Whether it is known to fly something else: a heartbeat from before its start does not show that.
    fn has_left_plan(&self, t_s: f64) -> bool {
        let is_shown = self.onboard.was_in_mission() || t_s - self.starts_s() > HEARTBEATS_S;
        self.duty.is_ordered || is_shown && !self.is_on_plan()
    }
}

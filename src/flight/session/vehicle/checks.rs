//! What is made sure of before a vehicle flies.

use super::{FlightVehicle, Stage};
use crate::flight::launch::parameters::{ParameterMismatch, SettingsCheck};
use crate::flight::launch::readiness;
use crate::flight::launch::readiness::STANDS_M;
use crate::link::{MissionMessage, Reading, Time, check_kind};

/// How long position and home are waited for, milliseconds.
const REPORTING_MS: u64 = 60_000;
/// A parameter that is said to be another one is read again for this long, milliseconds.
const OTHER_MS: u64 = 1000;

/// The ids of its mission, fence and rally points.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Checked {
    /// As it says them now; none where it says none.
    now: Option<[u32; 3]>,
    /// When it was read.
    ids: Option<[u32; 3]>,
    /// Whether they changed while it was checked: a vehicle may say that of its own list a little later.
    has_changed: bool,
    /// Whether it is read a second time, or was.
    is_read_again: bool,
    /// How long its last answer to a question for its time took, milliseconds.
    pub(super) round_trip_ms: u64,
}

impl FlightVehicle<'_> {
    /// Goes on with the transfer or the checks.
    pub(crate) fn work(&mut self, now: Time) {
        match &mut self.stage {
            Stage::Sending(session) => {
                session.handle_timeout(now);
                self.outbox
                    .extend(std::iter::from_fn(|| session.poll_transmit()));
                let Some(report) = session.report() else {
                    return;
                };
                if !report.is_verified() {
                    self.problems.push(report.verdict.why());
                }
                self.check(now);
            }
            Stage::Reading(reading) => {
                reading.handle_timeout(now);
                self.outbox
                    .extend(std::iter::from_fn(|| reading.poll_transmit()));
                let Some(outcome) = reading.outcome() else {
                    return;
                };
                match outcome {
                    Ok(onboard) => {
                        self.problems
                            .extend(readiness::list_problems(self.of.mission, onboard));
                        self.home = self.home.or(onboard.home);
                    }
                    Err(failure) => self.problems.push(failure.to_string()),
                }
                match self.checked.is_read_again {
                    true => self.conclude_again(now),
                    false => self.check(now),
                }
            }
            Stage::Checking { until } => {
                let until = *until;
                if self.set_params && !self.may_be_set(until) {
                    return;
                }
                let outcome = self.settings.as_ref().and_then(SettingsCheck::outcome);
                let is_known = self.home.is_some()
                    && self.latest.is_some()
                    && self.item_at.is_some()
                    && !self.lacks_version();
                if let Some(differences) = outcome
                    && (is_known || now >= until)
                {
                    let differences = differences.to_vec();
                    match self.may_have_changed() {
                        true => self.read_again(),
                        false => self.conclude(differences),
                    }
                }
            }
            _ => {}
        }
    }

    fn check(&mut self, now: Time) {
        if !self.problems.is_empty() {
            self.stage = Stage::Refused(std::mem::take(&mut self.problems));
            return;
        }
        // What it said while its mission was sent does not count.
        self.total.now = None;
        self.checked.now = None;
        self.request_disarm_parameter();
        if !self.set_params {
            self.begin_settings(now);
        }
        self.stage = Stage::Checking {
            until: now + REPORTING_MS,
        };
    }

    fn begin_settings(&mut self, now: Time) {
        let bytewise = self.autopilot().conventions().bytewise_parameters;
        let mission = self.of.mission;
        self.settings = Some(SettingsCheck::new(mission, self.set_params, bytewise, now));
    }

    /// Parameters are set of a vehicle only that stands disarmed at its home, and as long as it does: else it is
    /// refused.
    fn may_be_set(&mut self, until: Time) -> bool {
        let is_armed = self
            .heartbeat_now()
            .is_some_and(|heartbeat| heartbeat.is_armed());
        let mut problems = Vec::new();
        if is_armed {
            problems.push("it is armed: its parameters are not set".to_owned());
        }
        if self.settings.is_none() && self.latest.is_none() {
            match self.now < until {
                true if problems.is_empty() => return false,
                true => {}
                false => problems.push("it does not say where it is".to_owned()),
            }
        }
        if self.settings.is_none() && !self.force {
            problems.extend(self.place_problems());
        }
        if problems.is_empty() {
            if self.settings.is_none() {
                self.begin_settings(self.now);
            }
            return true;
        }
        if let Some(settings) = &mut self.settings {
            settings.stop();
        }
        self.stage = Stage::Refused(problems);
        false
    }

    /// What is waited for before it is ready or refused, in words.
    pub(in crate::flight::session) fn awaited(&self) -> Option<String> {
        let text = match &self.stage {
            _ if self.vehicle.is_none() => "its heartbeat".to_owned(),
            Stage::Sending(_) => "the transfer of its mission".to_owned(),
            Stage::Reading(_) => "its mission, fence and rally points".to_owned(),
            Stage::Checking { .. } if self.latest.is_none() => "its position".to_owned(),
            Stage::Checking { .. } => match self.settings.as_ref().and_then(SettingsCheck::awaited)
            {
                Some(parameter) => parameter,
                None if self.home.is_none() => "its home".to_owned(),
                None if self.item_at.is_none() => "which item it flies to".to_owned(),
                None => "its version".to_owned(),
            },
            _ => return None,
        };
        Some(text)
    }

    /// What was set of its parameters, in words.
    pub(in crate::flight::session) fn was_set(&self) -> Option<String> {
        self.settings.as_ref().and_then(SettingsCheck::was_set)
    }

    /// Whether its version matters and is not known yet.
    pub(super) fn lacks_version(&self) -> bool {
        let mission = self.of.mission;
        let matters =
            mission.autopilot_version.is_some() || mission.facts().heights_at_once.is_some();
        matters && self.version.is_none()
    }

    /// Decides by everything that the vehicle has reported.
    fn conclude(&mut self, differences: Vec<String>) {
        let mut soft = differences;
        soft.extend(self.changed_settings());
        match &self.home {
            None => soft.push("it does not say where its home is".to_owned()),
            Some(home) => soft.extend(readiness::home_problem(&self.of.mission.home, home)),
        }
        soft.extend(readiness::version_problem(self.of.mission, self.version));
        let unknown = readiness::unknown_version(self.of.mission, self.version);
        self.news.extend(unknown);
        let mut hard = Vec::new();
        if self.latest.is_none() {
            hard.push("it does not say where it is".to_owned());
        }
        if self.item_at.is_none() {
            soft.push("it does not say which item it flies to".to_owned());
        }
        soft.extend(self.place_problems());
        soft.extend(self.kind_problem());
        if self
            .vehicle
            .is_some_and(|(_, heartbeat)| heartbeat.is_armed())
        {
            hard.push("it is armed".to_owned());
        }
        if self.force {
            self.news.extend(
                soft.drain(..)
                    .map(|text| format!("flies all the same: {text}")),
            );
        }
        hard.extend(soft);
        if !hard.is_empty() {
            self.stage = Stage::Refused(hard);
            return;
        }
        self.total.ready = self.total.now;
        self.stage = Stage::Ready;
    }

    /// Whether no id says that what is on board is still what was read: everything else took its time.
    fn may_have_changed(&self) -> bool {
        let is_same = self.checked.ids.is_some() && !self.checked.has_changed;
        !is_same && !self.checked.is_read_again
    }

    /// Reads what is on board once more.
    fn read_again(&mut self) {
        self.checked.is_read_again = true;
        (self.checked.now, self.checked.ids) = (None, None);
        let reading = Reading::new(Some(self.of.sysid), self.us, self.now).in_the_air();
        self.stage = Stage::Reading(Box::new(reading));
    }

    /// It is ready if it holds what it held before.
    fn conclude_again(&mut self, now: Time) {
        if !self.problems.is_empty() {
            let problems = std::mem::take(&mut self.problems);
            let changed = |why: String| format!("{why}, after it was read: run `sortie fly` again");
            self.stage = Stage::Refused(problems.into_iter().map(changed).collect());
            return;
        }
        self.stage = Stage::Checking { until: now };
    }

    /// That its heartbeat is of another kind of vehicle than planned.
    fn kind_problem(&self) -> Option<String> {
        let (mission, heartbeat) = (self.of.mission, self.heartbeat_now()?);
        let refused = check_kind(&heartbeat, mission.autopilot, mission.airframe).err()?;
        Some(refused.to_string())
    }

    /// That it is not where its mission begins.
    fn place_problems(&self) -> Vec<String> {
        let Some((_, fix)) = self.latest else {
            return Vec::new();
        };
        let mut problems = Vec::new();
        let away_m = readiness::place(&self.of.mission.home).chord_m(fix.place);
        if away_m > STANDS_M {
            problems.push(format!(
                "it stands {away_m:.0} m from its home (allowed: {STANDS_M:.0} m)"
            ));
        }
        let above_m = fix.amsl.0 - f64::from(self.of.mission.home.amsl_m);
        if above_m.abs() > STANDS_M {
            let side = if above_m > 0.0 { "above" } else { "below" };
            let off_m = above_m.abs();
            problems.push(format!(
                "it is {off_m:.0} m {side} its home by its position (allowed: {STANDS_M:.0} m)"
            ));
        }
        problems
    }

    /// What has changed since it was checked, while others were not ready: nobody starts then. `battery` is what is
    /// wrong with its battery.
    pub(in crate::flight) fn changed_since_checked(&self, battery: Option<String>) -> Vec<String> {
        let mut problems = Vec::new();
        let is_armed = self
            .heartbeat_now()
            .is_some_and(|heartbeat| heartbeat.is_armed());
        if is_armed && matches!(self.stage, Stage::Ready) {
            problems.push("it was armed after it was checked, and not from here".to_owned());
        }
        if !self.force {
            problems.extend(self.place_problems());
            let moved_m = self
                .home
                .as_ref()
                .and_then(|home| readiness::home_moved_m(&self.of.mission.home, home));
            problems.extend(moved_m.map(|off_m| {
                format!("its home is {off_m:.0} m from where the plan has it, after it was checked")
            }));
            problems.extend(self.kind_problem());
            problems.extend(battery);
            problems.extend(self.changed_settings());
        }
        problems
    }

    /// What is on board is compared item by item once; by the ids of its lists that holds from then on.
    pub(super) fn heed_ids(&mut self, ids: [u32; 3], has_begun: bool) {
        // One that says no id at all says 0 of each.
        let reported = ids.iter().any(|id| *id != 0).then_some(ids);
        self.checked.now = reported;
        let is_read = matches!(
            self.stage,
            Stage::Checking { .. } | Stage::Ready | Stage::Arming | Stage::Armed
        );
        let (true, false, Some(now)) = (is_read, has_begun, reported) else {
            return;
        };
        let before = *self.checked.ids.get_or_insert(now);
        if matches!(self.stage, Stage::Checking { .. }) {
            (self.checked.ids, self.checked.has_changed) =
                (reported, self.checked.has_changed || before != now);
            return;
        }
        let is_other = |at: usize| now[at] != before[at];
        let what = if before[0] != 0 && now[0] != 0 && is_other(0) {
            "the mission on board is another one"
        } else if is_other(1) {
            "the fence on board is another one"
        } else if is_other(2) {
            "the rally points on board are others"
        } else {
            return;
        };
        self.stage = Stage::Refused(vec![format!(
            "{what} than when it was read (its id changed): run `sortie fly` again"
        )]);
    }

    /// The ids of its mission, fence and rally points when it was checked, and whether its home was compared then.
    pub(in crate::flight::session) fn checked(&self) -> (Option<[u32; 3]>, bool) {
        (self.checked.ids, !self.force)
    }

    /// Parameters that it says to be others than when they were read.
    fn changed_settings(&self) -> Vec<String> {
        let settings = self.settings.as_ref();
        let others = settings.map_or_else(Vec::new, |of| of.others(self.now, 0));
        others.iter().map(ParameterMismatch::changed).collect()
    }

    /// The same in flight, where an old answer that came late is not meant; and one of the return.
    pub(in crate::flight) fn other_settings(
        &self,
    ) -> (Vec<ParameterMismatch>, Option<&ParameterMismatch>) {
        let Some(settings) = &self.settings else {
            return (Vec::new(), None);
        };
        let others = settings.others(self.now, OTHER_MS);
        (others, settings.other_of_return())
    }

    /// Another station writes to it after it was read.
    pub(super) fn heed_writer(&mut self, list: &MissionMessage) {
        let is_read = match &self.stage {
            // What they hear until then is theirs.
            Stage::Sending(session) => session.report().is_some(),
            Stage::Reading(reading) => reading.outcome().is_some(),
            Stage::Checking { .. } | Stage::Ready | Stage::Arming | Stage::Armed => true,
            _ => false,
        };
        if let Some(system) = list.accepted_from_other(self.us).filter(|_| is_read) {
            let why = format!(
                "it acknowledged a mission, a fence or rally points to system {system} after they were read: run `sortie fly` again"
            );
            self.stage = Stage::Refused(vec![why]);
        }
    }
}

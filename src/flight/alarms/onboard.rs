//! What is on board, and in which mode: changed by whom.

pub(super) mod rate_limited;
mod return_targets;
mod settings;

use crate::flight::record::Plan;
use crate::flight::session::modes;
use crate::link::{
    Address, Command, CommandResult, FlightMessage, Heartbeat, Message, MissionType, as_line,
};
use crate::mission::{Home, VehicleMission};
use return_targets::ReturnTargets;
use settings::ParameterMismatches;

/// `MAV_STATE_CRITICAL`: from here on the autopilot acts in an emergency.
const STATE_CRITICAL: u8 = 5;
const STATE_EMERGENCY: u8 = 6;
/// `MAV_STATE`s of an emergency: the number, the name, and what it says in the words of MAVLink.
pub(super) const STATES: [(u8, &str, &str); 4] = [
    (
        STATE_CRITICAL,
        "MAV_STATE_CRITICAL",
        "it is in a failsafe, and can still navigate",
    ),
    (
        STATE_EMERGENCY,
        "MAV_STATE_EMERGENCY",
        "it lost control over parts or over the whole airframe: it is in mayday and going down",
    ),
    (
        7,
        "MAV_STATE_POWEROFF",
        "it has begun to power down, and shuts down now",
    ),
    (
        8,
        "MAV_STATE_FLIGHT_TERMINATION",
        "it terminates itself, by a failsafe or by command",
    ),
];
/// A change of mode is put down to what was heard at most this long before it, seconds.
const CAUSE_WINDOW_S: f64 = 3.0;
/// A mismatch is reported after this time, seconds: a `replan` may announce the new mission meanwhile.
const REPLAN_GRACE_S: f64 = 1.0;
/// An acknowledgement to another station is reported after this time, seconds: `MISSION_CURRENT` may show what was written.
const WRITE_GRACE_S: f64 = 1.5;

/// A transfer in flight is given up after this time and `ITEM_S` for each item, seconds of the wall's clock.
const TRANSFER_S: f64 = 30.0;
const ITEM_S: f64 = 2.0;

/// The mission and the mode of one vehicle.
#[derive(Debug)]
pub(super) struct Onboard {
    /// Items of the mission that it should hold, and the next one that it is sent.
    items: usize,
    next: Option<Plan>,
    new_plan: Option<Plan>,
    /// Items and id that it said first, with the mission that it should hold.
    total: Option<u16>,
    id: Option<u32>,
    checked: Option<(Option<[u32; 3]>, bool)>,
    /// What differs, and since when.
    differs: Option<(String, f64)>,
    /// The other station that it was heard to take a mission from.
    written_by: Option<(u8, f64)>,
    /// Where else it may return to.
    return_targets: ReturnTargets,
    settings: ParameterMismatches,
    /// Until when another plan may be under way to it, seconds after T0.
    sent_until_s: f64,
    heartbeat: Option<Heartbeat>,
    /// When a heartbeat showed its motors to run last, seconds after T0.
    armed_s: f64,
    /// Whether it was in its mission.
    was_in_mission: bool,
    /// What a change of mode is put down to, and when that was heard.
    cause: Option<(String, f64)>,
    /// Why it left its mission, as far as known.
    why: Option<String>,
    /// Who started its mission again, as far as known.
    why_in_mission: Option<String>,
}

impl Onboard {
    pub(super) fn new(items: usize) -> Self {
        Self {
            items,
            next: None,
            new_plan: None,
            total: None,
            id: None,
            checked: None,
            differs: None,
            written_by: None,
            return_targets: ReturnTargets::default(),
            settings: ParameterMismatches::default(),
            sent_until_s: f64::NEG_INFINITY,
            heartbeat: None,
            armed_s: f64::NEG_INFINITY,
            was_in_mission: false,
            cause: None,
            why: None,
            why_in_mission: None,
        }
    }

    /// What was found before T0: the ids of mission, fence and rally points, and whether home was compared.
    pub(super) fn set_checked(&mut self, checked: (Option<[u32; 3]>, bool)) {
        self.checked = Some(checked);
    }

    /// Its flight begins: how many items it said to hold when they were read.
    pub(super) fn begin(&mut self, held: Option<usize>, planned: &Home) {
        let held = held.filter(|held| *held == self.items);
        self.total = held.and_then(|held| u16::try_from(held).ok());
        let Some((ids, is_home_checked)) = self.checked.take() else {
            return;
        };
        self.id = ids.map(|ids| ids[0]).filter(|id| *id != 0).or(self.id);
        self.return_targets.begin(ids, is_home_checked, planned);
    }

    /// Another mission comes from a time in seconds after T0 on, with the lists of `mission`. One that did not come in
    /// the time of its transfer is not waited for, and is known all the same if it comes later. `speedup` is how much
    /// faster than the wall's clock the time of the vehicle goes.
    pub(super) fn expect_transfer(
        &mut self,
        (t_s, speedup): (f64, f64),
        plan: Plan,
        mission: &VehicleMission,
    ) {
        let items = plan.items + mission.fence.len() + mission.rally.len();
        #[expect(clippy::cast_precision_loss, reason = "some hundreds of items")]
        let transfer_s = TRANSFER_S + ITEM_S * items as f64;
        self.sent_until_s = t_s + transfer_s * speedup.max(1.0);
        self.next = Some(plan);
        // What it is heard to hold from now on says whether it is another one.
        (self.id, self.differs, self.checked) = (None, None, None);
    }

    /// Until when the plan that it is sent is waited for, seconds after T0; none where none is.
    pub(super) fn waits_until_s(&self) -> Option<f64> {
        self.next.as_ref().map(|_| self.sent_until_s)
    }

    /// Items of the mission that it should hold.
    pub(super) fn items(&self) -> usize {
        self.items
    }

    /// Whether it holds the mission that it should, as far as it says so, and no other one comes.
    pub(super) fn holds_its_plan(&self, t_s: f64) -> bool {
        let is_awaited = self.next.is_some() && self.is_sent(t_s);
        !is_awaited && self.differs.is_none()
    }

    /// Whether another plan may be under way to it.
    fn is_sent(&self, t_s: f64) -> bool {
        t_s < self.sent_until_s
    }

    /// The plan that it holds since the last call.
    pub(super) fn new_plan(&mut self) -> Option<Plan> {
        self.new_plan.take()
    }

    pub(super) fn handle(
        &mut self,
        t_s: f64,
        message: &Message,
        us: Address,
        mission: &VehicleMission,
        flies: bool,
    ) {
        if !flies {
            // What it holds before its flight was compared item by item.
            (self.total, self.id, self.differs) = (None, None, None);
            self.written_by = None;
        }
        let is_sent = self.is_sent(t_s);
        self.return_targets
            .handle(t_s, message, (us, mission), (flies, is_sent));
        match message {
            Message::Heartbeat(heartbeat) => self.heartbeat(t_s, *heartbeat, mission),
            Message::MissionCurrent {
                total, opaque_ids, ..
            } => self.current(t_s, *total, opaque_ids[0]),
            // It acknowledges what was written or cleared, not what was read.
            Message::Mission(message)
                if message.mission_type == MissionType::Mission.mission_type() =>
            {
                // What it has taken up already may be acknowledged after that.
                let is_known = is_sent && self.next.is_none();
                let written_by = message.accepted_from_other(us);
                let written_by = written_by.filter(|system| !is_known || *system != us.system);
                // Since the first of them: one who writes each second would put the alarm off for ever.
                self.written_by = (self.written_by).or(written_by.map(|system| (system, t_s)));
            }
            Message::StatusText { text, .. } if announces_mode_change(text) => {
                self.cause = Some((format!("the vehicle itself: {}", as_line(text)), t_s));
            }
            Message::Flight(FlightMessage::CommandAck {
                target,
                command,
                result: CommandResult::ACCEPTED,
            }) if target.system != 0 && !target.reaches(us) && changes_mode(*command) => {
                let (system, by) = (target.system, "commanded by system");
                self.cause = Some((format!("{by} {system}"), t_s));
            }
            _ => {}
        }
    }

    fn heartbeat(&mut self, t_s: f64, heartbeat: Heartbeat, mission: &VehicleMission) {
        if heartbeat.is_armed() {
            self.armed_s = t_s;
        }
        if !heartbeat.is_armed() && self.was_in_mission {
            // PX4 goes back to its last mode when its motors stop.
            return;
        }
        let before = self.heartbeat.replace(heartbeat);
        let is_new = before.is_none_or(|before| before.custom_mode != heartbeat.custom_mode);
        let is_in_mission = modes::is_mission(mission, heartbeat.custom_mode);
        self.was_in_mission |= is_in_mission;
        if is_in_mission {
            self.why = None;
            if is_new {
                let heard = self.cause.take();
                let cause = heard.filter(|(_, at_s)| t_s - at_s <= CAUSE_WINDOW_S);
                self.why_in_mission = cause.map(|(why, _)| why);
            }
        } else if is_new {
            let heard = self.cause.take();
            let cause = heard.filter(|(_, at_s)| t_s - at_s <= CAUSE_WINDOW_S);
            let in_emergency =
                (STATE_CRITICAL..=STATE_EMERGENCY).contains(&heartbeat.system_status);
            let itself = || in_emergency.then(|| "the vehicle itself, in an emergency".to_owned());
            let why = cause.map(|(why, _)| why).or_else(itself);
            self.why = Some(why.unwrap_or_else(|| "cause unknown".to_owned()));
        }
    }

    fn current(&mut self, t_s: f64, total: u16, id: u32) {
        let is_known = (1..u16::MAX).contains(&total);
        let is = |items: usize| usize::from(total) == items;
        if is_known && self.next.as_ref().is_some_and(|next| is(next.items)) {
            self.new_plan = self.next.take();
            self.items = usize::from(total);
            (self.id, self.written_by) = (None, None);
        }
        if is_known && is(self.items) && self.total.is_none() {
            self.total = Some(total);
        }
        if id != 0 && is(self.items) && self.id.is_none() {
            self.id = Some(id);
        }
        // A vehicle that never said how many items it holds does not say that it has none.
        let has_others =
            self.total.is_some() && !is(self.items) && !self.may_be_mid_transfer(t_s, total);
        let has_other_id = self.id.is_some_and(|known| id != 0 && id != known);
        let what = match (has_others, has_other_id) {
            (true, _) if total == 0 => Some("the mission on board was cleared".to_owned()),
            (true, _) => {
                let items = self.items;
                Some(format!(
                    "the mission on board has {total} items, the plan {items}"
                ))
            }
            (_, true) => Some("the mission on board is another one (its id changed)".to_owned()),
            _ => None,
        };
        self.differs = what.map(|what| {
            let since_s = self.differs.as_ref().map_or(t_s, |(_, since_s)| *since_s);
            (what, since_s)
        });
    }

    /// Whether as many items may be a part of a transfer under way: ArduPilot takes them one by one.
    fn may_be_mid_transfer(&self, t_s: f64, total: u16) -> bool {
        let next = self.next.as_ref().filter(|_| self.is_sent(t_s));
        next.is_some_and(|next| {
            let (least, most) = (self.items.min(next.items), self.items.max(next.items));
            (least.max(1)..=most).contains(&usize::from(total))
        })
    }

    /// What is wrong with the mission on board.
    pub(super) fn mission(&self, t_s: f64) -> Option<String> {
        let differs = self.differs.as_ref();
        let differs = differs.filter(|(_, since_s)| t_s - since_s >= REPLAN_GRACE_S);
        let differs = differs.map(|(what, _)| what.clone());
        let written = || {
            let (system, at_s) = self.written_by?;
            if t_s - at_s < WRITE_GRACE_S {
                return None;
            }
            let what = "acknowledged a mission, or that it was cleared, to system";
            Some(format!("{what} {system}: it may fly another one"))
        };
        differs.or_else(written)
    }

    /// Whether its motors were seen to run after a time in seconds after T0. ArduPilot begins its mission anew when they
    /// stop, and ArduPlane has its home where it stands then: both may be heard before the heartbeat that shows it.
    pub(super) fn armed_since(&self, since_s: f64) -> bool {
        self.armed_s > since_s
    }

    /// What is heard to be other than planned of home, of the rally points and of the fence.
    pub(super) fn others(&self, t_s: f64) -> [Option<&str>; 3] {
        let of = &self.return_targets;
        let moved = of.moved.as_ref();
        let moved = moved.filter(|(_, since_s)| self.armed_since(*since_s));
        let home = moved.map(|(text, _)| text.as_str());
        [home, of.list(1, t_s), of.list(0, t_s)]
    }

    /// Why it may return to another place, or on another way, than planned.
    pub(super) fn returns_elsewhere(&self, t_s: f64) -> Option<String> {
        let home = self.return_targets.moved.as_ref();
        let rally = self.return_targets.list(1, t_s);
        let changed = home.map(|(text, _)| text.as_str()).or(rally);
        let why = changed.map(|why| format!("{why}: where it would return to is not known"));
        why.or_else(|| self.returns_otherwise())
    }

    /// Who sent it on its mission, if that was heard.
    pub(super) fn why_in_mission(&self) -> Option<&str> {
        self.why_in_mission.as_deref()
    }

    /// Whether a heartbeat showed that it flew its mission.
    pub(super) fn was_in_mission(&self) -> bool {
        self.was_in_mission
    }

    /// Whether its heartbeat shows that it flies its mission.
    pub(super) fn flies_mission(&self, mission: &VehicleMission) -> bool {
        let heartbeat = self.heartbeat;
        heartbeat.is_some_and(|heartbeat| modes::is_mission(mission, heartbeat.custom_mode))
    }

    /// Whether its heartbeat says this `MAV_STATE`.
    pub(super) fn is_in_state(&self, state: u8) -> bool {
        self.heartbeat
            .is_some_and(|heartbeat| heartbeat.system_status == state)
    }

    /// The mode that it is in, if it is not the one of its mission any more.
    /// `is_due` says that it must be in it by now, whether that was seen or not.
    pub(super) fn mode(&self, mission: &VehicleMission, is_due: bool) -> Option<String> {
        let heartbeat = self.heartbeat.filter(|_| self.was_in_mission || is_due)?;
        let why = self.why.as_ref()?;
        let name = modes::name(mission, heartbeat.custom_mode);
        Some(format!("left its mission for {name}: {why}"))
    }
}

/// Whether a text says that the vehicle changes its mode by itself.
fn announces_mode_change(text: &str) -> bool {
    let text = text.to_ascii_lowercase();
    let is_over = ["clear", "resolved", "recovered"]
        .iter()
        .any(|word| text.contains(word));
    let begins = ["failsafe", "fence breached", "return to launch"];
    let mut words = text.split(|sign: char| !sign.is_ascii_alphanumeric());
    !is_over && (begins.iter().any(|word| text.contains(word)) || words.any(|word| word == "rtl"))
}

fn changes_mode(command: u16) -> bool {
    let commands = [
        Command::NAV_LOITER_UNLIM,
        Command::NAV_RETURN_TO_LAUNCH,
        Command::NAV_LAND,
        Command::DO_SET_MODE,
        Command::MISSION_START,
    ];
    commands.contains(&command)
}

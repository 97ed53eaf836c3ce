//! What is on board, and in which mode: changed by whom.

use crate::flight::launch::readiness;
use crate::flight::record::Plan;
use crate::flight::session::modes;
use crate::link::{
    Address, Command, CommandResult, FlightMessage, Heartbeat, List, Message, as_line,
};
use crate::mission::{Home, VehicleMission};

/// `MAV_STATE_CRITICAL`: from here on the autopilot acts in an emergency.
const STATE_CRITICAL: u8 = 5;
const STATE_EMERGENCY: u8 = 6;
/// What was heard this long before a change of the mode explains it, seconds.
const EXPLAINS_S: f64 = 3.0;
/// Another mission may be that of a `replan` that is heard of later, seconds.
const HEARD_OF_S: f64 = 1.0;
/// What is on board may say more about what was written, seconds.
const WRITTEN_S: f64 = 1.5;

/// Its fence and rally points are sent after a new mission, and are all on board after this time, seconds.
const SENT_S: f64 = 60.0;

/// Home moves by less than this where an autopilot gets a better position, metres.
const HOME_MOVES_M: f64 = 15.0;

/// What differs in flight of home, fence and rally points: a return was judged to those of the plan.
#[derive(Debug, Default)]
struct Elsewhere {
    /// Home as it was said last before the flight, and what it is now if that is another place.
    home: Option<Home>,
    moved: Option<String>,
    /// The ids of the fence and of the rally points, and since when they are others, seconds after T0.
    ids: [Option<u32>; 2],
    others_s: [Option<f64>; 2],
    /// What was heard of them otherwise.
    lists: [Option<String>; 2],
}

/// Lists, their names, and what is said of one with another id.
const LISTS: [(List, &str, &str); 2] = [
    (
        List::Fence,
        "fence",
        "the fence on board is another one (its id changed)",
    ),
    (
        List::Rally,
        "rally points",
        "the rally points on board are others (their id changed)",
    ),
];

impl Elsewhere {
    /// A list has the id that it has now where a `replan` sends it again (`is_sent`).
    fn handle(
        &mut self,
        t_s: f64,
        message: &Message,
        (us, mission): (Address, &VehicleMission),
        (flies, is_sent): (bool, bool),
    ) {
        if !flies {
            (self.moved, self.lists) = (None, [None, None]);
        }
        match message {
            Message::HomePosition { x, y, amsl_mm } => {
                #[expect(
                    clippy::cast_possible_truncation,
                    reason = "float32 is what missions have"
                )]
                let amsl_m = (f64::from(*amsl_mm) / 1000.0) as f32;
                let home = Home {
                    x: *x,
                    y: *y,
                    amsl_m,
                };
                if flies {
                    self.moved = moved(self.home.as_ref().unwrap_or(&mission.home), &home);
                } else {
                    self.home = Some(home);
                }
            }
            Message::MissionCurrent { opaque_ids, .. } => {
                let has_ids = opaque_ids.iter().any(|id| *id != 0);
                for at in 0..LISTS.len() {
                    // One that says no id at all says 0 of each.
                    let id = Some(opaque_ids[at + 1]).filter(|_| has_ids);
                    let is_learnt = !flies || is_sent;
                    let known = self.ids[at].filter(|_| !is_learnt).or(id);
                    let is_other = id.is_some() && id != known;
                    let since_s = self.others_s[at].unwrap_or(t_s);
                    self.others_s[at] = is_other.then_some(since_s);
                    self.ids[at] = known;
                }
            }
            Message::Mission(message) if flies => {
                let system = message.accepted_from_other(us);
                let Some(system) = system.filter(|_| !is_sent) else {
                    return;
                };
                for (at, (list, what, _)) in LISTS.iter().enumerate() {
                    if message.mission_type == list.mission_type() {
                        self.lists[at] = Some(format!(
                            "acknowledged {what}, or that they were cleared, to system {system}"
                        ));
                    }
                }
            }
            _ => {}
        }
    }
}

impl Elsewhere {
    /// What is wrong with a list, by its place in [`LISTS`].
    fn list(&self, at: usize, t_s: f64) -> Option<&str> {
        let is_other = self.others_s[at].is_some_and(|since_s| t_s - since_s >= HEARD_OF_S);
        let by_id = is_other.then_some(LISTS[at].2);
        self.lists[at].as_deref().or(by_id)
    }
}

/// In what a home differs from the one before, if it is another place.
fn moved(before: &Home, now: &Home) -> Option<String> {
    let across_m = readiness::place(before).chord_m(readiness::place(now));
    let up_m = f64::from(now.amsl_m) - f64::from(before.amsl_m);
    let off_m = across_m.max(up_m.abs());
    (off_m > HOME_MOVES_M).then(|| format!("its home was moved by {off_m:.0} m in flight"))
}

/// The mission and the mode of one vehicle.
#[derive(Debug)]
pub(super) struct Onboard {
    /// Items of the mission that it should hold, and the next one that it is sent.
    items: usize,
    next: Option<Plan>,
    taken_up: Option<Plan>,
    /// Items and id that it said first, with the mission that it should hold.
    total: Option<u16>,
    id: Option<u32>,
    /// What differs, and since when.
    differs: Option<(String, f64)>,
    /// The other station that it was heard to take a mission from.
    written_by: Option<(u8, f64)>,
    /// Where else it may return to.
    elsewhere: Elsewhere,
    /// When another plan was last under way to it, seconds after T0.
    sent_s: f64,
    beat: Option<Heartbeat>,
    /// Whether it was in its mission, and the name of the mode after it.
    was_in_mission: bool,
    /// Who explains a change of its mode, and when that was heard.
    cause: Option<(String, f64)>,
    /// The same for the present mode.
    why: Option<String>,
    /// And for its return to its mission.
    why_in_mission: Option<String>,
}

impl Onboard {
    pub(super) fn new(items: usize) -> Self {
        Self {
            items,
            next: None,
            taken_up: None,
            total: None,
            id: None,
            differs: None,
            written_by: None,
            elsewhere: Elsewhere::default(),
            sent_s: f64::NEG_INFINITY,
            beat: None,
            was_in_mission: false,
            cause: None,
            why: None,
            why_in_mission: None,
        }
    }

    /// Its flight begins: how many items it said to hold when they were read.
    pub(super) fn begin(&mut self, held: Option<usize>) {
        let held = held.filter(|held| *held == self.items);
        self.total = held.and_then(|held| u16::try_from(held).ok());
    }

    /// Another mission comes.
    pub(super) fn expect(&mut self, plan: Plan) {
        self.next = Some(plan);
        self.id = None;
    }

    /// Items of the mission that it should hold.
    pub(super) fn items(&self) -> usize {
        self.items
    }

    /// Whether it holds the mission that it should, as far as it says so, and no other one comes.
    pub(super) fn holds_its_plan(&self) -> bool {
        self.next.is_none() && self.differs.is_none()
    }

    /// The plan that it holds since the last call.
    pub(super) fn taken_up(&mut self) -> Option<Plan> {
        self.taken_up.take()
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
        if self.next.is_some() {
            self.sent_s = t_s;
        }
        let is_sent = t_s - self.sent_s < SENT_S;
        self.elsewhere
            .handle(t_s, message, (us, mission), (flies, is_sent));
        match message {
            Message::Heartbeat(beat) => self.beat(t_s, *beat, mission),
            Message::MissionCurrent {
                total, opaque_ids, ..
            } => self.current(t_s, *total, opaque_ids[0]),
            // It acknowledges what was written or cleared, not what was read.
            Message::Mission(message) if message.mission_type == List::Mission.mission_type() => {
                let written_by = message.accepted_from_other(us);
                self.written_by = written_by.map(|system| (system, t_s)).or(self.written_by);
            }
            Message::StatusText { text, .. } if explains(text) => {
                self.cause = Some((format!("the vehicle itself: {}", as_line(text)), t_s));
            }
            Message::Flight(FlightMessage::CommandAck {
                target,
                command,
                result: CommandResult::ACCEPTED,
            }) if target.system != 0 && !target.reaches(us) && changes_mode(*command) => {
                let (system, by) = (target.system, "ordered by system");
                self.cause = Some((format!("{by} {system}"), t_s));
            }
            _ => {}
        }
    }

    fn beat(&mut self, t_s: f64, beat: Heartbeat, mission: &VehicleMission) {
        if !beat.is_armed() && self.was_in_mission {
            // PX4 goes back to its last mode when its motors stop.
            return;
        }
        let before = self.beat.replace(beat);
        let is_new = before.is_none_or(|before| before.custom_mode != beat.custom_mode);
        let is_in_mission = modes::is_mission(mission, beat.custom_mode);
        self.was_in_mission |= is_in_mission;
        if is_in_mission {
            self.why = None;
            if is_new {
                let heard = self.cause.take();
                let cause = heard.filter(|(_, at_s)| t_s - at_s <= EXPLAINS_S);
                self.why_in_mission = cause.map(|(why, _)| why);
            }
        } else if is_new {
            let heard = self.cause.take();
            let cause = heard.filter(|(_, at_s)| t_s - at_s <= EXPLAINS_S);
            let in_emergency = (STATE_CRITICAL..=STATE_EMERGENCY).contains(&beat.system_status);
            let itself = || in_emergency.then(|| "the vehicle itself, in an emergency".to_owned());
            let why = cause.map(|(why, _)| why).or_else(itself);
            self.why = Some(why.unwrap_or_else(|| "nothing heard says by whom".to_owned()));
        }
    }

    fn current(&mut self, t_s: f64, total: u16, id: u32) {
        let is_known = (1..u16::MAX).contains(&total);
        let is = |items: usize| usize::from(total) == items;
        if is_known && self.next.as_ref().is_some_and(|next| is(next.items)) {
            self.taken_up = self.next.take();
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
        let has_others = self.total.is_some() && !is(self.items);
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

    /// What is wrong with the mission on board.
    pub(super) fn mission(&self, t_s: f64) -> Option<String> {
        let differs = self.differs.as_ref();
        let differs = differs.filter(|(_, since_s)| t_s - since_s >= HEARD_OF_S);
        let differs = differs.map(|(what, _)| what.clone());
        let written = || {
            let (system, at_s) = self.written_by?;
            if t_s - at_s < WRITTEN_S {
                return None;
            }
            let what = "acknowledged a mission, or that it was cleared, to system";
            Some(format!("{what} {system}: it may fly another one"))
        };
        differs.or_else(written)
    }

    /// What is heard to be other than planned of home, of the rally points and of the fence.
    pub(super) fn others(&self, t_s: f64) -> [Option<&str>; 3] {
        let of = &self.elsewhere;
        [of.moved.as_deref(), of.list(1, t_s), of.list(0, t_s)]
    }

    /// Why it may return to another place than planned.
    pub(super) fn returns_elsewhere(&self, t_s: f64) -> Option<String> {
        let [home, rally, _] = self.others(t_s);
        let why = home.or(rally)?;
        Some(format!("{why}: where it would return to is not known"))
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
        let beat = self.beat;
        beat.is_some_and(|beat| modes::is_mission(mission, beat.custom_mode))
    }

    /// The mode that it is in, if it is not the one of its mission any more.
    /// `is_due` says that it must be in it by now, whether that was seen or not.
    pub(super) fn mode(&self, mission: &VehicleMission, is_due: bool) -> Option<String> {
        let beat = self.beat.filter(|_| self.was_in_mission || is_due)?;
        let why = self.why.as_ref()?;
        let name = modes::name(mission, beat.custom_mode);
        Some(format!("left its mission for {name}: {why}"))
    }
}

/// Whether a text says that the vehicle changes its mode by itself.
fn explains(text: &str) -> bool {
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
        Command::LOITER,
        Command::RETURN,
        Command::LAND,
        Command::SET_MODE,
        Command::MISSION_START,
    ];
    commands.contains(&command)
}

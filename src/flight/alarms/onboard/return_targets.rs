//! Home, fence and rally points in flight: a return was judged to those of the plan.

use super::REPLAN_GRACE_S;
use crate::flight::launch::readiness;
use crate::link::{Address, Message, MissionType};
use crate::mission::{Home, VehicleMission};

/// What differs in flight of home, fence and rally points: a return was judged to those of the plan.
#[derive(Debug, Default)]
pub(super) struct ReturnTargets {
    /// Home as it was said last before the flight, and what it is now if that is another place, with since when.
    home: Option<Home>,
    pub(super) moved: Option<(String, f64)>,
    /// Whether it was compared with that of the plan before T0: then it is held against that one.
    is_checked: bool,
    /// The ids of the fence and of the rally points, and since when they are others, seconds after T0.
    ids: [Option<u32>; 2],
    others_s: [Option<f64>; 2],
    /// What was heard of them otherwise.
    lists: [Option<String>; 2],
}

/// Lists, their names, and what is said of one with another id.
const LISTS: [(MissionType, &str, &str); 2] = [
    (
        MissionType::Fence,
        "fence",
        "the fence on board is another one (its id changed)",
    ),
    (
        MissionType::Rally,
        "rally points",
        "the rally points on board are others (their id changed)",
    ),
];

impl ReturnTargets {
    /// A list has the id that it has now where a `replan` sends it again (`is_sent`): that acknowledges it to another
    /// process of ours.
    pub(super) fn handle(
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
                    let since_s = self.moved.take().map_or(t_s, |(_, since_s)| since_s);
                    let reported = self.home.as_ref().filter(|_| !self.is_checked);
                    let before = reported.unwrap_or(&mission.home);
                    self.moved = moved(before, &home).map(|text| (text, since_s));
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
                let Some(system) = system.filter(|system| !is_sent || *system != us.system) else {
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

impl ReturnTargets {
    /// Its flight begins, with the ids that its fence and its rally points had when they were read.
    pub(super) fn begin(&mut self, ids: Option<[u32; 3]>, is_home_checked: bool, planned: &Home) {
        if let Some([_, fence, rally]) = ids {
            self.ids = [Some(fence), Some(rally)];
        }
        self.is_checked = is_home_checked;
        if is_home_checked {
            let moved = self.home.as_ref().and_then(|now| moved(planned, now));
            self.moved = moved.map(|text| (text, f64::NEG_INFINITY));
        }
    }

    /// What is wrong with a list, by its place in [`LISTS`].
    pub(super) fn list(&self, at: usize, t_s: f64) -> Option<&str> {
        let is_other = self.others_s[at].is_some_and(|since_s| t_s - since_s >= REPLAN_GRACE_S);
        let by_id = is_other.then_some(LISTS[at].2);
        self.lists[at].as_deref().or(by_id)
    }
}

fn moved(before: &Home, now: &Home) -> Option<String> {
    let off_m = readiness::home_moved_m(before, now)?;
    Some(format!("its home was moved by {off_m:.0} m in flight"))
}

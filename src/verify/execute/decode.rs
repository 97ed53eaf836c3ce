//! The orders of a mission in the sequence in which the autopilot executes them.

use super::copter;
use super::item::Order;
use super::jumps::{Jumps, Next, is_jump, jump};
use super::wing::items;
use crate::autopilot::{Autopilot, Capacity};
use crate::geodesy::Amsl;
use crate::mission::{Item, VehicleMission, command, frame};

/// Commands with greater numbers do not navigate.
const NAV_LAST: u16 = command::NAV_LAST;

/// An order and the row it comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Step {
    /// Row of the `.waypoints` file, home being 0.
    pub(crate) row: usize,
    pub(crate) order: Order,
}

/// Why the flight is not known from a row on.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Unknown {
    pub(crate) row: usize,
    pub(crate) why: String,
}

impl Unknown {
    /// An error for a row.
    pub(crate) fn err<T>(row: usize, why: impl Into<String>) -> Result<T, Self> {
        let why = why.into();
        Err(Self { row, why })
    }
}

/// Most orders of a mission; each repetition of a jump counts. Twice what PX4 stores.
const MAX_ORDERS: usize = 20_000;
/// The orders of a mission in the sequence in which they are obeyed.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Orders {
    pub(crate) steps: Vec<Step>,
    /// From where on they cannot be read.
    pub(crate) unread: Option<Unknown>,
    /// The row of the DO_JUMP that repeats the mission for ever, and the first step of the repetition.
    pub(crate) repeats: Option<(usize, usize)>,
}

/// What is obeyed after an order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum After<'a> {
    /// This navigates.
    Step(&'a Step),
    /// Nothing: the mission ends.
    End,
    /// That is not known.
    Unread,
}

impl Orders {
    /// The next order after one that navigates.
    pub(crate) fn after(&self, index: usize, mission: &VehicleMission) -> After<'_> {
        let navigates = |step: &&Step| mission.items[step.row - 1].command <= NAV_LAST;
        let again = self.repeats.map_or(self.steps.len(), |(_, again)| again);
        let rest = self.steps[index + 1..].iter().chain(&self.steps[again..]);
        match (rest.into_iter().find(navigates), &self.unread) {
            (Some(step), _) => After::Step(step),
            (None, None) => After::End,
            (None, Some(_)) => After::Unread,
        }
    }
}

/// The orders of a mission in sequence, with its jumps executed, up to the first item that
/// cannot be read; of what repeats for ever one repetition more.
pub(crate) fn decode(mission: &VehicleMission, home: Amsl) -> Orders {
    let mut orders = Orders::default();
    orders.unread = read(mission, home, &mut orders);
    orders
}

/// Whether an item is above ground and ArduPilot has no terrain data, by the parameters.
fn needs_terrain(item: &Item, mission: &VehicleMission) -> bool {
    mission.autopilot == Autopilot::ArduPilot
        && frame::canonical(item.frame) == frame::GLOBAL_TERRAIN_ALT
        && item.command <= NAV_LAST
        && mission
            .param("TERRAIN_ENABLE")
            .is_some_and(|on| on.abs() < 0.5)
}

/// The commands without motion since the last item that moves the vehicle, and the jumps since the last item.
#[derive(Default)]
struct InARow {
    commands: usize,
    jumps: usize,
    /// Whether they wait for a condition while the vehicle flies on.
    waiting: bool,
}

impl InARow {
    /// Takes in a jump; says why the flight is not known from it on, if it is not.
    fn jump(&mut self, limits: &Capacity) -> Result<(), String> {
        self.jumps += 1;
        if self.jumps <= limits.jumps_in_a_row {
            return Ok(());
        }
        Err(format!(
            "more than {} jumps in a row: the mission ends there",
            limits.jumps_in_a_row
        ))
    }

    /// Takes in an item that is no jump; says why the flight is not known from it on, if it is not.
    fn next(&mut self, item: &Item, limits: &Capacity) -> Result<(), String> {
        self.jumps = 0;
        if item.command <= NAV_LAST {
            *self = Self::default();
            return Ok(());
        }
        self.commands += 1;
        if let Some(max) = limits.commands_in_a_row.filter(|&max| self.commands > max) {
            return Err(format!(
                "more than {max} commands without motion in a row: ArduPilot does not come to the next item"
            ));
        }
        match item.command {
            command::CONDITION_DELAY | command::CONDITION_DISTANCE | command::CONDITION_YAW => {
                self.waiting = true;
            }
            command::DO_CHANGE_SPEED if self.waiting => {
                let why = "a change of speed that waits for a condition comes at no known time";
                return Err(why.to_owned());
            }
            _ => {}
        }
        Ok(())
    }
}

fn read(mission: &VehicleMission, home: Amsl, orders: &mut Orders) -> Option<Unknown> {
    let steps = &mut orders.steps;
    let mut jumps = vec![Jumps::NotMet; mission.items.len()];
    let mut next = 0;
    // Each jump that is made for ever, and the first step after it.
    let mut begins = Vec::new();
    let limits = mission.facts().capacity;
    let mut in_a_row = InARow::default();
    for _ in 0..MAX_ORDERS {
        let item = mission.items.get(next)?;
        let row = next + 1;
        let unknown = |why: String| Some(Unknown { row, why });
        if needs_terrain(item, mission) {
            let why = "an altitude above ground, and TERRAIN_ENABLE is 0";
            return unknown(why.to_owned());
        }
        if is_jump(item, mission.autopilot) {
            if let Err(why) = in_a_row.jump(&limits) {
                return unknown(why);
            }
            match jump(item, next, mission, &mut jumps[next]) {
                Ok(Next::Item(index)) => next = index,
                Ok(Next::Again(index)) => {
                    begins.push((row, steps.len()));
                    next = index;
                }
                Ok(Next::Repeats) => {
                    orders.repeats = begins.into_iter().find(|(jump, _)| *jump == row);
                    return None;
                }
                Err(why) => return unknown(why),
            }
            continue;
        }
        if let Err(why) = in_a_row.next(item, &limits) {
            return unknown(why);
        }
        let order = if mission.airframe.has_wing() {
            items::read(item, mission, home)
        } else {
            copter::read(item, mission, home)
        };
        match order {
            Ok(order) => steps.push(Step { row, order }),
            Err(why) => return unknown(why),
        }
        next += 1;
    }
    let why = format!(
        "more than {MAX_ORDERS} items are flown, those that jumps repeat included (allowed: {MAX_ORDERS}): divide the mission"
    );
    Some(Unknown { row: next + 1, why })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mission::{Home, Item};
    use crate::spec::{Airframe, Autopilot};

    fn decoded(autopilot: Autopilot, items: Vec<Item>) -> (Vec<usize>, Option<String>) {
        let mission = VehicleMission {
            autopilot,
            autopilot_version: None,
            airframe: Airframe::Copter,
            home: Home {
                x: 363_000_000,
                y: -842_500_000,
                amsl_m: 400.0,
            },
            items,
            fence: Vec::new(),
            is_fence_known: false,
            rally: Vec::new(),
            params: Vec::new(),
            notes: Vec::new(),
        };
        let orders = decode(&mission, Amsl(400.0));
        let rows = orders.steps.iter().map(|step| step.row).collect();
        (rows, orders.unread.map(|unknown| unknown.why))
    }

    fn command(command: u16, param1: f32, param2: f32) -> Item {
        Item::without_place(command, [param1, param2, 0.0, 0.0])
    }

    fn delay() -> Item {
        command(command::NAV_DELAY, 1.0, 0.0)
    }

    #[test]
    fn a_jump_is_made_as_often_as_it_says_and_counted_as_the_autopilot_counts() {
        for (autopilot, second) in [(Autopilot::ArduPilot, 2.0), (Autopilot::Px4, 1.0)] {
            let jump = command(command::DO_JUMP, second, 2.0);
            let items = vec![delay(), delay(), jump, delay()];
            let (rows, unknown) = decoded(autopilot, items);
            assert_eq!((rows, unknown), (vec![1, 2, 2, 2, 4], None));
        }
    }

    #[test]
    fn jumps_without_end_or_target_and_loops_in_loops_are_not_known() {
        let why = |jump: Item| {
            let (_, unknown) = decoded(Autopilot::ArduPilot, vec![delay(), jump, delay()]);
            unknown.expect("not known")
        };
        let endless = vec![delay(), command(177, 0.0, -1.0), delay()];
        let (_, unread) = decoded(Autopilot::Px4, endless);
        assert!(unread.expect("not known").contains("-1 times"));
        assert!(why(command(177, 9.0, 1.0)).contains("item 9, which there is not"));
        assert!(why(command(177, 2.0, 1.0)).contains("to itself"));
        assert!(why(command(177, 1.0, 0.5)).contains("made 0.5 times"));
        assert!(why(command(177, f32::NAN, 1.0)).contains("which there is not"));
        let inner = command(177, 1.0, 1.0);
        let (rows, unknown) = decoded(Autopilot::ArduPilot, vec![delay(), inner, inner]);
        assert_eq!(rows, [1, 1, 1]);
        assert!(
            unknown
                .expect("a loop in a loop")
                .contains("loop of another")
        );
    }

    #[test]
    fn a_jump_without_end_is_made_once_and_what_follows_it_is_never_obeyed() {
        let items = vec![delay(), delay(), delay(), command(177, 2.0, -1.0), delay()];
        let (rows, unread) = decoded(Autopilot::ArduPilot, items);
        assert_eq!((rows, unread), (vec![1, 2, 3, 2, 3], None));
    }

    #[test]
    fn no_more_jumps_are_made_in_a_row_than_the_autopilot_reads() {
        let through = |autopilot, jumps: u16| {
            let jump = |item: u16| command(177, f32::from(item), 0.0);
            let first = 1 - i32::from(autopilot == Autopilot::Px4);
            let items = (0..jumps).map(|_| jump(u16::try_from(first).unwrap_or(0)));
            let items: Vec<Item> = [delay()]
                .into_iter()
                .chain(items)
                .chain([delay()])
                .collect();
            let (rows, unread) = decoded(autopilot, items);
            (rows.len(), unread.map(|why| why.contains("in a row")))
        };
        assert_eq!(through(Autopilot::Px4, 9), (2, None));
        assert_eq!(through(Autopilot::Px4, 10), (1, Some(true)));
        assert_eq!(through(Autopilot::ArduPilot, 64), (2, None));
        assert_eq!(through(Autopilot::ArduPilot, 65), (1, Some(true)));
    }

    #[test]
    fn a_jump_forward_without_end_is_met_once_and_repeats_nothing() {
        let items = vec![delay(), command(177, 4.0, -1.0), delay(), delay()];
        let (rows, unread) = decoded(Autopilot::ArduPilot, items);
        assert_eq!((rows, unread), (vec![1, 4], None));
    }

    #[test]
    fn a_speed_that_waits_for_a_condition_is_not_known() {
        let speed = command(178, 1.0, 8.0);
        let (_, none) = decoded(
            Autopilot::ArduPilot,
            vec![command(112, 5.0, 0.0), delay(), speed],
        );
        assert_eq!(none, None);
        let (rows, why) = decoded(Autopilot::ArduPilot, vec![command(112, 5.0, 0.0), speed]);
        assert_eq!(rows, [1]);
        assert!(why.expect("not known").contains("waits for a condition"));
    }
}

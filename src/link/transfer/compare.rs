//! Read-back against what was sent, item by item and field by field.

use std::fmt;

use crate::link::message::MissionType;
use crate::link::stored_form::stored_form;
use crate::mission::{Item, frame};
use crate::spec::{Airframe, Autopilot};

/// One field that was read back otherwise than it was sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Which list.
    pub list: MissionType,
    /// Row: for a mission that of the `.waypoints` file (home is 0), for fence and
    /// rally the position from 1. `None` when the number of items differs.
    pub row: Option<usize>,
    /// Which field.
    pub field: &'static str,
    /// What was sent.
    pub sent: String,
    /// What was read back.
    pub read: String,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.list)?;
        if let Some(row) = self.row {
            write!(f, " item {row}")?;
        }
        write!(
            f,
            ": {} sent {}, read back {}",
            self.field, self.sent, self.read
        )
    }
}

/// The differences of two lists, apart from those of the autopilot's stored form.
/// Both without the home row.
#[must_use]
pub fn differences(
    autopilot: Autopilot,
    airframe: Airframe,
    list: MissionType,
    sent: &[Item],
    read: &[Item],
) -> Vec<Difference> {
    let mut found = Vec::new();
    if sent.len() != read.len() {
        found.push(Difference {
            list,
            row: None,
            field: "number of items",
            sent: sent.len().to_string(),
            read: read.len().to_string(),
        });
    }
    for (index, (sent, read)) in sent.iter().zip(read).enumerate() {
        let stored = stored_form(autopilot, airframe, list, sent);
        for (field, fine) in fields(autopilot, list, sent, &stored, read) {
            if !fine {
                found.push(Difference {
                    list,
                    row: Some(index + 1),
                    field,
                    sent: text(sent, field),
                    read: text(read, field),
                });
            }
        }
    }
    found
}

/// Every field, and whether it was read back as sent or in its stored form.
fn fields(
    autopilot: Autopilot,
    list: MissionType,
    sent: &Item,
    stored: &Item,
    read: &Item,
) -> [(&'static str, bool); 10] {
    let is_packed = autopilot.conventions().packs_items;
    let either = |same: &dyn Fn(&Item) -> bool| same(sent) || same(stored);
    let param = |n: usize| either(&|item| near(autopilot, item.params[n], read.params[n]));
    // Fences are two-dimensional: neither reference nor altitude means anything.
    let flat = list == MissionType::Fence;
    let frame = |item: &Item| frame::canonical(item.frame) == frame::canonical(read.frame);
    let z = same(sent.z, read.z)
        || same(stored.z, read.z)
        // Altitudes are cut to centimetres: more than one of them is another altitude.
        || (is_packed
            && ((sent.z - read.z).abs() < 0.0101 || (stored.z - read.z).abs() < 0.001));
    [
        ("command", sent.command == read.command),
        ("frame", flat || either(&frame)),
        (
            "autocontinue",
            is_packed || sent.autocontinue == read.autocontinue,
        ),
        ("param1", param(0)),
        ("param2", param(1)),
        ("param3", param(2)),
        ("param4", param(3)),
        ("x", either(&|item| item.x == read.x)),
        ("y", either(&|item| item.y == read.y)),
        ("z", flat || z),
    ]
}

/// Equal bits, or both NaN, or both zero.
fn same(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()) || (a - b).abs() <= 0.0
}

/// Equal within the tolerance of the autopilot: PX4 stores angles in radians, so they come back
/// with a small error.
fn near(autopilot: Autopilot, a: f32, b: f32) -> bool {
    same(a, b) || (a - b).abs() <= autopilot.conventions().param_tolerance
}

fn text(item: &Item, field: &str) -> String {
    match field {
        "command" => item.command.to_string(),
        "frame" => item.frame.to_string(),
        "autocontinue" => item.autocontinue.to_string(),
        "param1" => item.params[0].to_string(),
        "param2" => item.params[1].to_string(),
        "param3" => item.params[2].to_string(),
        "param4" => item.params[3].to_string(),
        "x" => item.x.to_string(),
        "y" => item.y.to_string(),
        _ => item.z.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mission::command;

    fn item(z: f32) -> Item {
        Item {
            command: command::NAV_WAYPOINT,
            frame: frame::GLOBAL,
            autocontinue: true,
            params: [0.0, 0.0, 0.0, f32::NAN],
            x: 363_000_000,
            y: -842_500_000,
            z,
        }
    }

    fn mission(autopilot: Autopilot, sent: Item, read: Item) -> Vec<Difference> {
        differences(
            autopilot,
            Airframe::Copter,
            MissionType::Mission,
            &[sent],
            &[read],
        )
    }

    #[test]
    fn an_exact_read_back_is_equal_for_every_autopilot() {
        for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
            assert_eq!(mission(autopilot, item(80.2), item(80.2)), []);
        }
    }

    #[test]
    fn the_stored_form_is_equal_and_one_centimetre_more_is_not() {
        let held = Item {
            params: [0.0; 4],
            ..item(80.19)
        };
        assert_eq!(mission(Autopilot::ArduPilot, item(80.2), held), []);
        let other = Item { z: 80.18, ..held };
        let found = mission(Autopilot::ArduPilot, item(80.2), other);
        assert_eq!(found.len(), 1);
        assert_eq!(
            found[0].to_string(),
            "mission item 1: z sent 80.2, read back 80.18"
        );
        assert_eq!(mission(Autopilot::Px4, item(80.2), held).len(), 2);
    }

    #[test]
    fn another_altitude_reference_is_named() {
        let read = Item {
            frame: frame::GLOBAL_RELATIVE_ALT,
            ..item(80.0)
        };
        let found = mission(Autopilot::ArduPilot, item(80.0), read);
        assert_eq!(found.iter().map(|d| d.field).collect::<Vec<_>>(), ["frame"]);
    }

    #[test]
    fn a_missing_item_is_a_difference() {
        let found = differences(
            Autopilot::Px4,
            Airframe::Copter,
            MissionType::Fence,
            &[item(0.0); 4],
            &[item(0.0); 3],
        );
        assert_eq!(found[0].field, "number of items");
        assert_eq!((&*found[0].sent, &*found[0].read), ("4", "3"));
    }
}

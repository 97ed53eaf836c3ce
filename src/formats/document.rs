//! What a mission file says, whatever its format.

use std::fmt;

use super::FormatError;
use crate::mission::{Home, Item, VehicleMission, command};
use crate::spec::{Airframe, Autopilot};

/// What a mission file says.
///
/// Targets of DO_JUMP are rows as in a `.waypoints` file (home is 0), whatever the
/// autopilot counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Document {
    /// Where the vehicle stands, if the file says so.
    pub home: Option<Home>,
    /// Mission items; home is not among them.
    pub items: Vec<Item>,
    /// Fence items.
    pub fence: Vec<Item>,
    /// Whether the format can hold a fence, so that none means none.
    pub is_fence_known: bool,
    /// Rally items.
    pub rally: Vec<Item>,
    /// For which autopilot, if the file says so.
    pub autopilot: Option<Autopilot>,
    /// For what kind of airframe, if the file says so.
    pub airframe: Option<Airframe>,
    /// What the file holds beside what is flown, which no conversion keeps.
    pub beside: Vec<String>,
    /// What was read although the format does not allow it.
    pub repairs: Vec<Repair>,
}

/// Something a reader understood although the format does not allow it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Repair {
    /// Where.
    pub at: Spot,
    /// What was understood as what.
    pub what: String,
}

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Spot {
    /// Of a text.
    Text {
        /// Line, from 1.
        line: usize,
        /// Column in characters, from 1.
        column: usize,
    },
    /// Of a JSON document: a path such as `mission.items[2].params[4]`; empty for the whole.
    Json(String),
}

impl fmt::Display for Repair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.at {
            Spot::Text { line, column } => write!(f, "line {line}, column {column}: ")?,
            Spot::Json(path) if path.is_empty() => {}
            Spot::Json(path) => write!(f, "{path}: ")?,
        }
        f.write_str(&self.what)
    }
}

impl Document {
    /// The mission of one vehicle.
    ///
    /// Files have no parameters, so [`VehicleMission::params`] is empty. Repairs
    /// become notes.
    ///
    /// # Errors
    /// [`FormatError::NoHome`] without a home: set [`Document::home`] first if it is
    /// known from elsewhere. [`FormatError::OtherAutopilot`] when the file was made
    /// for another one: set [`Document::autopilot`] to `None` to convert it.
    pub fn into_mission(
        self,
        autopilot: Autopilot,
        airframe: Airframe,
    ) -> Result<VehicleMission, FormatError> {
        let home = self.home.ok_or(FormatError::NoHome)?;
        if let Some(file) = self.autopilot
            && file != autopilot
        {
            return Err(FormatError::OtherAutopilot {
                file,
                vehicle: autopilot,
            });
        }
        let items = self
            .items
            .into_iter()
            .map(|item| shift_jump(item, -row_shift(autopilot)))
            .collect();
        let other = self.airframe.filter(|file| *file != airframe).map(|file| {
            format!("the file is for a {file:?}: read as a mission of a {airframe:?}")
                .to_lowercase()
        });
        let repairs = self.repairs.iter().map(Repair::to_string);
        let notes = repairs.chain(other).collect();
        Ok(VehicleMission {
            autopilot_version: None,
            autopilot,
            airframe,
            home,
            items,
            fence: self.fence,
            is_fence_known: self.is_fence_known,
            rally: self.rally,
            params: Vec::new(),
            notes,
        })
    }

    /// Whether it is a fence or rally points and no mission.
    #[must_use]
    pub fn is_list(&self) -> bool {
        let lists = !self.fence.is_empty() || !self.rally.is_empty();
        lists && self.items.is_empty()
    }

    /// Puts an item into the list that its command belongs to.
    pub(super) fn add(&mut self, item: Item) {
        match item.command {
            command::FENCE_RETURN_POINT..=command::FENCE_CIRCLE_EXCLUSION => self.fence.push(item),
            command::RALLY_POINT => self.rally.push(item),
            _ => self.items.push(item),
        }
    }
}

/// The items of a mission with targets of DO_JUMP as rows (home is 0).
pub(super) fn rows(mission: &VehicleMission) -> impl Iterator<Item = Item> + '_ {
    let shift = row_shift(mission.autopilot);
    mission
        .items
        .iter()
        .map(move |&item| shift_jump(item, shift))
}

/// How much a row is above the number that the autopilot gives an item.
fn row_shift(autopilot: Autopilot) -> f32 {
    f32::from(autopilot.first_row())
}

fn shift_jump(mut item: Item, shift: f32) -> Item {
    if item.command == command::DO_JUMP && item.params[0].is_finite() {
        item.params[0] += shift;
    }
    item
}

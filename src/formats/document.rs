//! The content of a mission file of any format.

use std::fmt;

use super::FormatError;
use crate::geodesy::LatLon;
use crate::mission::{Home, Item, VehicleMission, command, frame, home_at};
use crate::spec::{Airframe, Autopilot};
use crate::world::Terrain;

/// The content of a mission file.
///
/// Targets of DO_JUMP are rows as in a `.waypoints` file (home is 0), whatever the
/// autopilot counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Document {
    /// Where the vehicle stands, if the file says so.
    pub home: Option<Home>,
    /// Where the vehicle stands, if the file gives the place without an altitude above
    /// mean sea level; [`Document::home`] is `None` then. See [`Document::home_on`].
    pub home_place: Option<LatLon>,
    /// The command of the first item, if that stands in the row of home: ArduPilot puts its home there
    /// and never flies it.
    pub in_home_row: Option<u16>,
    /// Mission items; home is not among them.
    pub items: Vec<Item>,
    /// Fence items.
    pub fence: Vec<Item>,
    /// Whether the format can hold a fence, so that an empty list means "no fence".
    pub is_fence_known: bool,
    /// Rally items.
    pub rally: Vec<Item>,
    /// For which autopilot, if the file says so.
    pub autopilot: Option<Autopilot>,
    /// For what kind of airframe, if the file says so.
    pub airframe: Option<Airframe>,
    /// Content that is not flown and that no conversion carries over, such as the drawing
    /// of a survey.
    pub dropped: Vec<String>,
    /// Deviations from the format that the reader resolved.
    pub repairs: Vec<Repair>,
}

/// A deviation from the format, and how the reader resolved it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Repair {
    /// Where.
    pub at: SourceLocation,
    /// What was found, and what it was taken as.
    pub what: String,
}

/// A location in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SourceLocation {
    /// In a text.
    Text {
        /// Line, from 1.
        line: usize,
        /// Column in characters, from 1.
        column: usize,
    },
    /// Path in a JSON document, such as `mission.items[2].params[4]`; empty for the whole.
    Json(String),
}

impl fmt::Display for Repair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.at {
            SourceLocation::Text { line, column } => write!(f, "line {line}, column {column}: ")?,
            SourceLocation::Json(path) if path.is_empty() => {}
            SourceLocation::Json(path) => write!(f, "{path}: ")?,
        }
        f.write_str(&self.what)
    }
}

impl Document {
    /// The mission of one vehicle.
    ///
    /// Mission files hold no parameters, so [`VehicleMission::params`] is empty. Repairs
    /// become notes.
    ///
    /// # Errors
    /// [`FormatError::NoHome`] without a home; set [`Document::home`] first if it is
    /// known from elsewhere. [`FormatError::OtherAutopilot`] for a file made for another
    /// autopilot; set [`Document::autopilot`] to `None` to convert it.
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
            let (file, airframe) = (file.name(), airframe.name());
            format!("the file is for a {file}: read as a mission of a {airframe}")
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

    /// Home at [`Document::home_place`], with the altitude of the ground there; `None`
    /// without a place, and where the terrain has no data.
    #[must_use]
    pub fn home_on(&self, terrain: &Terrain) -> Option<Home> {
        let place = self.home_place?;
        Some(home_at(place, terrain.height(place).ok()?))
    }

    /// Whether the file holds a fence or rally points and no mission.
    #[must_use]
    pub fn is_list(&self) -> bool {
        let lists = !self.fence.is_empty() || !self.rally.is_empty();
        lists && self.items.is_empty()
    }

    /// Puts an item into the list that its command belongs to.
    pub(super) fn add(&mut self, item: Item) {
        match item.command {
            command::NAV_FENCE_RETURN_POINT..=command::NAV_FENCE_CIRCLE_EXCLUSION => {
                self.fence.push(item)
            }
            command::NAV_RALLY_POINT => self.rally.push(item),
            _ => self.items.push(item),
        }
    }
}

/// A fence or rally item at a place in 1e-7 degrees, without an altitude.
pub(super) fn point_item(command: u16, param1: f32, (x, y): (i32, i32)) -> Item {
    Item {
        command,
        frame: frame::GLOBAL,
        autocontinue: false,
        params: [param1, 0.0, 0.0, 0.0],
        x,
        y,
        z: 0.0,
    }
}

/// A fence or rally item at an altitude above home.
pub(super) fn raised_item(command: u16, at: (i32, i32), above_home_m: f32) -> Item {
    Item {
        frame: frame::GLOBAL_RELATIVE_ALT,
        z: above_home_m,
        ..point_item(command, 0.0, at)
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

/// Rows minus item numbers: PX4 counts its items from 0, without home.
fn row_shift(autopilot: Autopilot) -> f32 {
    f32::from(autopilot.first_row())
}

fn shift_jump(mut item: Item, shift: f32) -> Item {
    if item.command == command::DO_JUMP && item.params[0].is_finite() {
        item.params[0] += shift;
    }
    item
}

//! Columns in which a vehicle goes straight down or up: it leaves them before it has a new path.

use crate::flight::conformance::reference::ReferenceTrajectory;
use crate::geodesy::PlanPoint;
use crate::mission::{Item, VehicleMission, command};

/// A vehicle this far below the upper end of a column is in it, metres.
const BELOW_M: f64 = 1.0;
/// A vehicle this near the place of its landing comes down there, metres.
const OVER_M: f64 = 5.0;

/// The column that a vehicle is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InColumn {
    /// It comes down to land.
    Landing,
    /// It places a load.
    Load,
    /// It comes down to a stop below the least height above ground, is there, or rises from it.
    Drop,
}

impl InColumn {
    /// By the row that a vehicle flies to and where it is.
    pub(super) fn of(
        held: &VehicleMission,
        reference: &ReferenceTrajectory,
        row: usize,
        here: PlanPoint,
    ) -> Option<Self> {
        let item = held.items.get(row - 1)?;
        if puts_down(item) {
            return Some(Self::Load);
        }
        let waypoints = &reference.waypoints;
        let next = waypoints
            .iter()
            .rposition(|waypoint| waypoint.item == row)?;
        let (to, from) = (waypoints[next].point, waypoints[next.checked_sub(1)?].point);
        if is_landing(item) {
            let is_down = here.amsl.0 < from.amsl.0 - BELOW_M;
            return (is_down && here.at.distance_m(to.at) < OVER_M).then_some(Self::Landing);
        }
        let rises = to.amsl.0 > from.amsl.0 + BELOW_M;
        let has_risen = rises && here.amsl.0 > to.amsl.0 - BELOW_M;
        (reference.dips_at(row, here.at) && !has_risen).then_some(Self::Drop)
    }

    /// Why a vehicle in it keeps its mission, in words.
    pub(super) fn why(self) -> &'static str {
        match self {
            Self::Landing => "it is in its landing descent",
            Self::Load => "it is placing its load: give the threat again when it goes on",
            Self::Drop => "it is in a drop: give the threat again when it rests above it",
        }
    }
}

/// Whether an item puts down a load.
pub(super) fn puts_down(item: &Item) -> bool {
    item.command == command::NAV_PAYLOAD_PLACE
}

fn is_landing(item: &Item) -> bool {
    [command::NAV_LAND, command::NAV_VTOL_LAND].contains(&item.command)
}

//! How the clearance of altitudes above home depends on the altitude of home.

use crate::geodesy::Amsl;
use crate::mission::{VehicleMission, command, frame};
use crate::verify::{Limit, Margin};

/// Whether a mission flies at altitudes above home; takeoff and landing alone do not count.
pub(crate) fn counts_from_home(mission: &VehicleMission) -> bool {
    let upright = [command::NAV_TAKEOFF, command::NAV_LAND];
    mission.items.iter().any(|item| {
        frame::canonical(item.frame) == frame::GLOBAL_RELATIVE_ALT
            && !upright.contains(&item.command)
    })
}

/// Notes at the smallest clearance of such a mission which altitude of home it assumes and what
/// an error of that altitude costs. The autopilot adds the altitude that it measures, so the
/// vehicle flies lower by as much as home is lower.
pub(crate) fn note_cost(margins: &mut [Margin], home: Amsl) {
    for margin in margins {
        if margin.limit == Limit::TerrainClearance
            && margin.value.is_finite()
            && margin.note.is_empty()
        {
            margin.note = format!(
                "altitudes are above home, assumed at {:.1} m: {:.1} m minus as much as it lies lower than that, {:.1} m to spare",
                home.0,
                margin.value,
                margin.slack().max(0.0),
            );
        }
    }
}

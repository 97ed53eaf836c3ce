//! Whether a vehicle is where and what the plan takes it to be.

use crate::autopilot::Version;
use crate::geodesy::LatLon;
use crate::link::{MissionType, Onboard, differences};
use crate::mission::{Home, VehicleMission};

/// A reported home may be this far from the assumed one, metres across and in height.
pub(crate) const HOME_ACROSS_M: f64 = 10.0;
pub(crate) const HOME_UP_M: f64 = 5.0;
/// A vehicle may stand this far from its home, metres.
pub(crate) const STANDS_M: f64 = 15.0;

/// Home moves by less than this where an autopilot gets a better position or takes where it stands, metres.
const HOME_MOVES_M: f64 = 15.0;

/// By how much a home is away from another one, metres, if it is another place.
pub(crate) fn home_moved_m(before: &Home, now: &Home) -> Option<f64> {
    let across_m = place(before).chord_m(place(now));
    let up_m = f64::from(now.amsl_m) - f64::from(before.amsl_m);
    let off_m = across_m.max(up_m.abs());
    (off_m > HOME_MOVES_M).then_some(off_m)
}

/// The place of a home.
pub(crate) fn place(home: &Home) -> LatLon {
    LatLon::of_e7(home.x, home.y)
}

/// In what the reported home differs from the assumed one, if that matters.
pub(crate) fn home_problem(assumed: &Home, reported: &Home) -> Option<String> {
    let across_m = place(assumed).chord_m(place(reported));
    let up_m = f64::from(reported.amsl_m) - f64::from(assumed.amsl_m);
    if across_m > HOME_ACROSS_M {
        return Some(format!(
            "home is {across_m:.0} m from where the plan has it (allowed: {HOME_ACROSS_M:.0} m)"
        ));
    }
    (up_m.abs() > HOME_UP_M).then(|| {
        format!(
            "home is at {:.1} m above the sea, the plan has it at {:.1} m (allowed: {HOME_UP_M:.0} m of difference)",
            reported.amsl_m, assumed.amsl_m
        )
    })
}

/// The difference between the version that a mission is for and that of the vehicle.
pub(crate) fn version_problem(mission: &VehicleMission, found: Option<Version>) -> Option<String> {
    let name = mission.autopilot.name();
    let Some(planned) = mission.autopilot_version else {
        let is_apart = mission.facts().has_heights_at_once(found);
        return found.filter(|_| is_apart).map(|found| {
            format!(
                "it runs {name} {found}, which is at the altitude of the end of each leg soon after its start: \
                 that is judged only with autopilot_version: \"{found}\" in the spec"
            )
        });
    };
    match found {
        Some(found) if found == planned => None,
        Some(found) => Some(format!(
            "it runs {name} {found}, the mission is for {planned} (autopilot_version)"
        )),
        None => Some(format!(
            "it does not report its version, the mission is for {name} {planned} (autopilot_version)"
        )),
    }
}

/// What an operator reads of a vehicle that may run another version than was judged, and does not say which it runs.
pub(crate) fn unknown_version(mission: &VehicleMission, found: Option<Version>) -> Option<String> {
    let range = mission.facts().heights_at_once?;
    let is_unknown = found.is_none() && mission.autopilot_version.is_none();
    let name = mission.autopilot.name();
    is_unknown.then(|| {
        format!(
            "WARNING: its version is unknown: {name} {range} climbs and descends at the start of each leg, which was not judged"
        )
    })
}

/// In what the lists on board differ from the plan's, in sentences.
pub(crate) fn list_problems(mission: &VehicleMission, onboard: &Onboard) -> Vec<String> {
    let autopilot = onboard.autopilot.unwrap_or(mission.autopilot);
    if autopilot != mission.autopilot {
        return vec![format!("it is a {}", onboard.description)];
    }
    let lists = [
        (MissionType::Mission, &mission.items, &onboard.mission),
        (MissionType::Fence, &mission.fence, &onboard.fence),
        (MissionType::Rally, &mission.rally, &onboard.rally),
    ];
    let mut problems = Vec::new();
    for (list, planned, held) in lists {
        let found = differences(autopilot, mission.airframe, list, planned, held);
        if let Some(first) = found.first() {
            let more = match found.len() {
                1 => String::new(),
                count => format!(", and {} more", count - 1),
            };
            problems.push(format!(
                "what is on board is not the plan: {list}{}: {} is {}, planned {}{more}",
                first
                    .row
                    .map_or_else(String::new, |row| format!(" item {row}")),
                first.field,
                first.read,
                first.sent
            ));
        }
    }
    problems
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::autopilot::{Airframe, Autopilot};

    fn version(text: &str) -> Option<Version> {
        text.parse().ok()
    }

    fn mission(
        autopilot: Autopilot,
        airframe: Airframe,
        autopilot_version: Option<Version>,
    ) -> VehicleMission {
        VehicleMission {
            autopilot,
            autopilot_version,
            airframe,
            home: Home {
                x: 0,
                y: 0,
                amsl_m: 0.0,
            },
            items: Vec::new(),
            fence: Vec::new(),
            is_fence_known: true,
            rally: Vec::new(),
            params: Vec::new(),
            notes: Vec::new(),
        }
    }

    #[test]
    fn a_mission_for_one_version_is_flown_by_that_version() {
        let mission = mission(Autopilot::ArduPilot, Airframe::Copter, version("4.7"));
        assert_eq!(version_problem(&mission, version("4.7")), None);
        let problem = version_problem(&mission, version("4.6"));
        let expected = "it runs ArduPilot 4.6, the mission is for 4.7 (autopilot_version)";
        assert_eq!(problem.as_deref(), Some(expected));
        assert!(version_problem(&mission, None).is_some());
        assert_eq!(version_problem(&mission.for_version(None), None), None);
    }

    #[test]
    fn a_version_that_flies_heights_at_once_must_be_named() {
        let unnamed = mission(Autopilot::Px4, Airframe::Copter, None);
        let problem = version_problem(&unnamed, version("1.18")).expect("refused");
        assert!(problem.contains("autopilot_version: \"1.18\""), "{problem}");
        assert_eq!(version_problem(&unnamed, version("1.17")), None);
        assert_eq!(version_problem(&unnamed, None), None);
        let warning = unknown_version(&unnamed, None).expect("a warning");
        assert!(
            warning.contains("version is unknown: PX4 1.18"),
            "{warning}"
        );
        assert_eq!(unknown_version(&unnamed, version("1.17")), None);
        let named = mission(Autopilot::Px4, Airframe::Copter, version("1.18"));
        assert_eq!(version_problem(&named, version("1.18")), None);
        let plane = mission(Autopilot::Px4, Airframe::Plane, None);
        assert_eq!(version_problem(&plane, version("1.18")), None);
        assert_eq!(unknown_version(&plane, None), None);
        assert_eq!(unknown_version(&named, None), None);
    }
}

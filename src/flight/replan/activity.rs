//! What a vehicle flies instead of its mission, by its mode: where it holds, lands or returns to.

use crate::flight::alarms::order_safety::rally_reach_m;
use crate::flight::launch::plan::FlightPlan;
use crate::flight::session::modes;
use crate::geodesy::{Amsl, PlanPoint};
use crate::mission::VehicleMission;

/// What a vehicle does.
#[derive(Clone, Debug, PartialEq)]
pub enum Doing {
    /// It flies its mission.
    Mission,
    /// It stays where it is.
    Holds,
    /// It lands where it is.
    Lands,
    /// It returns: home, and the rally points that it may return to instead, at the altitude of the way there.
    Returns(Vec<PlanPoint>),
    /// Something else: somebody flies it.
    Other,
}

impl Doing {
    /// By the mode of a vehicle that is here.
    pub(super) fn of(
        (plan, vehicle): (&FlightPlan, usize),
        held: &VehicleMission,
        custom_mode: u32,
        here: PlanPoint,
    ) -> Self {
        if modes::is_mission(held, custom_mode) {
            Self::Mission
        } else if modes::is_hold(held, custom_mode) {
            Self::Holds
        } else if modes::is_land(held, custom_mode) {
            Self::Lands
        } else if modes::is_return(held, custom_mode) {
            let home = plan.world.sites.get(vehicle).map(|of| of.home.at);
            let home_m = home.map_or(0.0, |home| home.distance_m(here.at));
            let reach_m = rally_reach_m(held.autopilot, held.airframe, home_m);
            let rally = held.rally_points(&plan.world.frame);
            let rally = rally.filter(|at| here.at.distance_m(*at) <= reach_m);
            let level = plan.vehicle(vehicle).return_amsl;
            let amsl = level.map_or(here.amsl, |level| Amsl(level.0.max(here.amsl.0)));
            let end = |at| PlanPoint { at, amsl };
            Self::Returns(home.into_iter().chain(rally).map(end).collect())
        } else {
            Self::Other
        }
    }

    /// In a word; none of one that flies its mission.
    #[must_use]
    pub fn word(&self) -> Option<&'static str> {
        match self {
            Self::Mission => None,
            Self::Holds => Some("holds"),
            Self::Lands => Some("lands"),
            Self::Returns(_) => Some("returns"),
            Self::Other => Some("holds, or somebody flies it"),
        }
    }

    /// Why it has no new path around what its way meets, in words.
    pub(super) fn why_not_led(&self) -> Option<&'static str> {
        match self {
            Self::Mission => None,
            Self::Holds => Some("it holds there"),
            Self::Lands => Some("it lands there"),
            Self::Returns(_) => Some("it returns, and its way leads into it"),
            Self::Other => Some("it does not fly its mission: it holds, or somebody flies it"),
        }
    }

    /// The ways that it may fly from here; none of one whose mission counts.
    pub(super) fn ways(&self, here: PlanPoint) -> Option<Vec<Vec<PlanPoint>>> {
        match self {
            Self::Mission | Self::Other => None,
            Self::Holds | Self::Lands => Some(vec![vec![here]]),
            Self::Returns(ends) => Some(ends.iter().map(|end| vec![here, *end]).collect()),
        }
    }

    /// Where it is led to in the plan of the fleet: a vehicle that does not fly its mission stays there.
    pub(super) fn stays_at(&self, here: PlanPoint) -> PlanPoint {
        match self {
            Self::Returns(ends) => ends.first().copied().unwrap_or(here),
            _ => here,
        }
    }
}

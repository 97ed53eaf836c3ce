//! Which vehicles meet a threat, and which of them can be led around it. A vehicle that cannot
//! keeps its present path and is named; it keeps no other vehicle from a new path.

use std::collections::BTreeMap;

use super::state::{Branch, VehicleState};
use crate::flight::launch::plan::FlightPlan;
use crate::geodesy::EastNorth;
use crate::spec::{Threat, Vehicle};
use crate::verify::{Limit, Margin, Review};

/// The fleet sorted by what a threat means to each vehicle.
pub(super) struct Assessment<'a> {
    pub(super) plan: &'a FlightPlan,
    /// Every threat that has come up.
    pub(super) popups: &'a [Threat],
    /// Vehicles that keep their present path.
    pub(super) others: Vec<VehicleState>,
    /// Vehicles that get a new path, and where it branches off.
    pub(super) concerned: Vec<(VehicleState, Branch)>,
    /// Vehicles among the others that fly through a threat.
    pub(super) unavoidable: Vec<Unavoidable>,
    /// Seconds after T0.
    pub(super) now_s: f64,
    pub(super) seed: Option<u64>,
}

/// Vehicles for which no path was found, by index in the spec, and why.
pub(super) type NoPath = BTreeMap<usize, String>;

/// A vehicle that flies through threats whatever is planned.
#[derive(Clone, Debug)]
pub struct Unavoidable {
    /// Its index in the spec.
    pub vehicle: usize,
    /// Ids of the threats that its path meets.
    pub threats: Vec<String>,
    /// Those of them for which it is named whatever the verdict on its path: it was inside of them
    /// since the last one came up, or does not fly its mission.
    certain: Vec<String>,
    /// Why it is not led around them, in words.
    pub why: String,
    /// Whether it flies its mission.
    in_mission: bool,
}

impl Unavoidable {
    /// The threats that it cannot avoid, in words.
    #[must_use]
    pub fn cannot(&self) -> String {
        format!("cannot avoid {}", self.threats.join(", "))
    }
}

/// The vehicles that cannot avoid a threat and why, in words; none without such vehicles.
#[must_use]
pub fn sentence(unavoidable: &[Unavoidable], fleet: &[Vehicle]) -> Option<String> {
    let of = |of: &Unavoidable| {
        let (id, cannot, why) = (&fleet[of.vehicle].id, of.cannot(), &of.why);
        let keeps = if of.in_mission {
            "it keeps its course, hold, land or disarm it"
        } else {
            "nothing was sent to it"
        };
        format!("{id} {cannot} ({why}): {keeps}")
    };
    let all: Vec<String> = unavoidable.iter().map(of).collect();
    (!all.is_empty()).then(|| all.join("; "))
}

impl Assessment<'_> {
    /// Sorts the vehicles into those that get a new path and those that keep theirs.
    pub(super) fn sort(&mut self, states: &[VehicleState], lead_s: f64, no_path: &NoPath) {
        for state in states {
            if let Some(threat) = self.crossed(state).first() {
                let id = &threat.id;
                let why = if self.is_inside(state.here.at, threat) {
                    format!("it is inside of {id} now")
                } else {
                    format!("it was inside of {id} after that came up")
                };
                self.add_unavoidable(state.clone(), why);
                continue;
            }
            let met = self.met(state);
            if met.is_empty() {
                self.others.push(state.clone());
                continue;
            }
            let no_path = no_path.get(&state.vehicle);
            let branch = match no_path {
                Some(why) => Err(why.clone()),
                None => self.branch(state, &met, lead_s),
            };
            match branch {
                Ok(branch) => self.concerned.push((state.clone(), branch)),
                Err(why) => self.add_unavoidable(state.clone(), why),
            }
        }
    }

    /// The threats that a vehicle was inside of since the last one came up.
    fn crossed(&self, state: &VehicleState) -> Vec<&Threat> {
        let was_inside = |threat: &&Threat| {
            let center = self.plan.world.frame.to_plan(threat.place);
            state.was_near(center, threat.radius_m)
        };
        self.popups.iter().filter(was_inside).collect()
    }

    fn is_inside(&self, at: EastNorth, threat: &Threat) -> bool {
        let center = self.plan.world.frame.to_plan(threat.place);
        center.distance_m(at) < threat.radius_m
    }

    /// Whether the mission of a vehicle that flies something else meets a threat that came up.
    pub(super) fn mission_is_met(&self, state: &VehicleState) -> bool {
        let tolerance_m = self.plan.spec().mission.tolerance_m;
        let meets = |threat: &Threat| {
            let center = self.plan.world.frame.to_plan(threat.place);
            state.mission_meets(center, threat.radius_m + tolerance_m)
        };
        !state.in_mission() && self.popups.iter().any(meets)
    }

    /// The threats that came up and that a path meets.
    fn met(&self, state: &VehicleState) -> Vec<Threat> {
        let tolerance_m = self.plan.spec().mission.tolerance_m;
        let meets = |threat: &&Threat| {
            let center = self.plan.world.frame.to_plan(threat.place);
            state.meets(center, threat.radius_m + tolerance_m)
        };
        self.popups.iter().filter(meets).cloned().collect()
    }

    /// Where the new path of a vehicle branches off, or why it cannot in time.
    fn branch(&self, state: &VehicleState, met: &[Threat], lead_s: f64) -> Result<Branch, String> {
        if state.stands {
            return Err("it stands on the ground".to_owned());
        }
        if let Some(why) = state.doing.why_not_led() {
            return Err(why.to_owned());
        }
        if !state.counts_items {
            let why = "it does not say how many items it holds: nobody would know whether it flies a new mission";
            return Err(why.to_owned());
        }
        if state.takes_off {
            let why =
                "it still climbs after its takeoff: give the threat again when it is on its way";
            return Err(why.to_owned());
        }
        if let Some(column) = state.column {
            return Err(column.why().to_owned());
        }
        let vehicle = &self.plan.spec().vehicles[state.vehicle];
        let lead_m = lead_s * vehicle.fastest_mps();
        let branch = state.branch_after(lead_m).ok_or_else(|| {
            format!(
                "it is at the end of its way within {lead_s:.0} s, before it can have a new one"
            )
        })?;
        if state.drops_at(&branch) {
            return Err(format!(
                "it is in a drop within {lead_s:.0} s, before it can have a new path: give the threat again when it rests above it"
            ));
        }
        for threat in met {
            let (id, radius_m) = (&threat.id, threat.radius_m);
            let center = self.plan.world.frame.to_plan(threat.place);
            if self.is_inside(state.here.at, threat) {
                return Err(format!("it is inside of {id} now"));
            }
            if state.meets_before(&branch, center, radius_m) {
                return Err(format!(
                    "it is inside of {id} within {lead_s:.0} s, before it can have a new path"
                ));
            }
            let mut goals = state.routes(&branch).into_iter().map(|(_, goal)| goal.at);
            if goals.any(|goal| self.is_inside(goal, threat)) {
                return Err(format!("its plan leads to a place inside of {id}"));
            }
        }
        Ok(branch)
    }

    fn add_unavoidable(&mut self, state: VehicleState, why: String) {
        let crossed = self.crossed(&state).into_iter();
        let mut threats: Vec<String> = crossed.map(|threat| threat.id.clone()).collect();
        let crossed = threats.len();
        for threat in self.met(&state) {
            if !threats.contains(&threat.id) {
                threats.push(threat.id);
            }
        }
        let certain = if state.in_mission() {
            crossed
        } else {
            threats.len()
        };
        self.unavoidable.push(Unavoidable {
            vehicle: state.vehicle,
            certain: threats[..certain].to_vec(),
            threats,
            why,
            in_mission: state.in_mission(),
        });
        self.others.push(state);
    }

    /// Whether every limit holds that a new path could violate.
    pub(super) fn is_sound(&self, review: &Review) -> bool {
        let fleet = &self.plan.spec().vehicles;
        let is_of_new_path = |margin: &Margin| {
            let mut concerned = self.concerned.iter();
            concerned.any(|(state, _)| margin.concerns(&fleet[state.vehicle].id))
        };
        let mut margins = review.margins.iter();
        // A verdict on no vehicle proves nothing.
        margins.len() > 0 && margins.all(|margin| margin.ok || !is_of_new_path(margin))
    }

    /// Of a vehicle that keeps its path, retains the margins to the threats that came up, to
    /// vehicles on new paths, and of what cannot be judged. The rest was verified before takeoff,
    /// and is not judged again from the middle of a leg or a turn.
    pub(super) fn drop_verified_limits(&self, review: &mut Review) {
        let fleet = &self.plan.spec().vehicles;
        let keeps = |id: &String| {
            let mut others = self.others.iter();
            others.any(|state| fleet[state.vehicle].id == *id)
        };
        review.margins.retain(|margin| {
            let all_keep = keeps(&margin.vehicle) && margin.other.iter().all(keeps);
            let is_known = margin.value.is_finite() && margin.limit != Limit::ItemsJudged;
            !all_keep || !is_known || self.popup_of(margin).is_some()
        });
    }

    /// The threat that came up and that a limit is about.
    fn popup_of(&self, margin: &Margin) -> Option<&Threat> {
        let mut popups = self.popups.iter();
        popups.find(|threat| margin.limit == Limit::Threat(threat.id.clone()))
    }

    /// Corrects the unavoidable threats by the verdict: a vehicle that keeps its path may miss a
    /// threat after all, or meet one.
    pub(super) fn correct_unavoidable(&mut self, review: &Review) {
        let fleet = &self.plan.spec().vehicles;
        let broken_by = |vehicle: usize| -> Vec<String> {
            let of = |m: &&Margin| !m.ok && m.vehicle == fleet[vehicle].id;
            let broken = review.margins.iter().filter(of);
            let threats = broken.filter_map(|margin| self.popup_of(margin));
            threats.map(|threat| threat.id.clone()).collect()
        };
        let mut unavoidable = self.unavoidable.clone();
        for of in &mut unavoidable {
            let (broken, certain) = (broken_by(of.vehicle), &of.certain);
            of.threats
                .retain(|id| certain.contains(id) || broken.contains(id));
        }
        unavoidable.retain(|of| !of.threats.is_empty());
        for state in &self.others {
            let vehicle = state.vehicle;
            let threats = broken_by(vehicle);
            let is_named = unavoidable.iter().any(|of| of.vehicle == vehicle);
            if !is_named && !threats.is_empty() {
                unavoidable.push(Unavoidable {
                    vehicle,
                    threats,
                    certain: Vec::new(),
                    why: "its path as flown meets it, its planned path does not".to_owned(),
                    in_mission: state.in_mission(),
                });
            }
        }
        self.unavoidable = unavoidable;
    }

    /// Takes the new path from one vehicle that violates a limit on it: one at a time, because
    /// those after it were planned around that path. Returns whether there was one.
    pub(super) fn give_up(&mut self, review: &Review, no_path: &mut NoPath) -> bool {
        let broken = review.margins.iter().filter(|margin| !margin.ok);
        let broken: Vec<&Margin> = broken.collect();
        let fleet = &self.plan.spec().vehicles;
        let of = |state: &VehicleState, is_alone: bool| {
            let id = &fleet[state.vehicle].id;
            let mut broken = broken.iter();
            broken.find(|m| m.concerns(id) && (!is_alone || m.other.is_none()))
        };
        let alone = self
            .concerned
            .iter()
            .position(|(c, _)| of(c, true).is_some());
        // Of two in conflict the later one was planned around the earlier one.
        let in_conflict = || {
            self.concerned
                .iter()
                .rposition(|(c, _)| of(c, false).is_some())
        };
        let Some(index) = alone.or_else(in_conflict) else {
            return false;
        };
        let found = of(&self.concerned[index].0, alone.is_some());
        let id = &fleet[self.concerned[index].0.vehicle].id;
        let why = found.map_or_else(String::new, |margin| why(margin, id));
        let (state, _) = self.concerned.remove(index);
        no_path.insert(state.vehicle, why.clone());
        self.add_unavoidable(state, why);
        true
    }
}

/// Why a new path of a vehicle does not pass, in words.
fn why(margin: &Margin, id: &str) -> String {
    let mut both = std::iter::once(&margin.vehicle).chain(&margin.other);
    let with = both.find(|one| *one != id);
    let with = with.map_or_else(String::new, |other| format!(" with {other}"));
    let (limit, unit) = (&margin.limit, margin.unit);
    let value = if !margin.note.is_empty() {
        format!(": {}", margin.note)
    } else if margin.value.is_finite() {
        format!(" {:.1} {unit}", margin.value)
    } else {
        String::new()
    };
    format!("no new path for it passes verification, {limit}{with}{value}")
}

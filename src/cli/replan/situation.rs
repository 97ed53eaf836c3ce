//! Who meets a threat, and can be led around it. Who cannot keeps its course, is named, and keeps
//! nobody else from a new path: what it breaks is broken, and the verdict says so.

use std::collections::BTreeMap;

use super::course::{Course, Parting};
use crate::cli::fly::Sorties;
use crate::geodesy::EastNorth;
use crate::spec::{Threat, Vehicle};
use crate::verify::{Limit, Margin, Review};

/// What is given: everyone's course, who is concerned and where each of those parts from
/// its course, who flies through a threat all the same, and how long after T0 it is now.
pub(super) struct Situation<'a> {
    pub(super) sorties: &'a Sorties,
    /// Every threat that has come up.
    pub(super) popups: &'a [Threat],
    pub(super) others: Vec<Course>,
    pub(super) concerned: Vec<(Course, Parting)>,
    /// They are among the others: they keep their course.
    pub(super) bound: Vec<Bound>,
    pub(super) now_s: f64,
    pub(super) seed: Option<u64>,
}

/// Vehicles for which no path was found, by their index in the spec, and why.
pub(super) type GivenUp = BTreeMap<usize, String>;

/// A vehicle that flies through threats whatever is planned.
#[derive(Clone, Debug)]
pub(super) struct Bound {
    /// Its index in the spec.
    pub(super) vehicle: usize,
    /// Ids of the threats that its course meets.
    pub(super) threats: Vec<String>,
    /// Those of them that it is named for whatever the verdict on its course: it was inside of them
    /// since the last one was told, or its course is not what it flies now.
    pub(super) certain: Vec<String>,
    /// Why it is not led around them, in words.
    pub(super) why: String,
    /// Whether it flies its mission.
    in_mission: bool,
}

impl Bound {
    /// What it cannot do.
    pub(super) fn cannot(&self) -> String {
        format!("cannot avoid {}", self.threats.join(", "))
    }
}

/// Who cannot be led around what, if anybody.
pub(super) fn sentence(bound: &[Bound], fleet: &[Vehicle]) -> Option<String> {
    let of = |of: &Bound| {
        let (id, cannot, why) = (&fleet[of.vehicle].id, of.cannot(), &of.why);
        let keeps = if of.in_mission {
            "it keeps its course, hold, land or disarm it"
        } else {
            "nothing was sent to it"
        };
        format!("{id} {cannot} ({why}): {keeps}")
    };
    let all: Vec<String> = bound.iter().map(of).collect();
    (!all.is_empty()).then(|| all.join("; "))
}

impl Situation<'_> {
    /// Sorts the courses: who is concerned and can be led away in time, who keeps its course.
    pub(super) fn sort(&mut self, courses: &[Course], lead_s: f64, given_up: &GivenUp) {
        for course in courses {
            if let Some(threat) = self.crossed(course).first() {
                let id = &threat.id;
                let why = if self.is_inside(course.here.at, threat) {
                    format!("it is inside of {id} now")
                } else {
                    format!("it was inside of {id} after that was told")
                };
                self.bind(course.clone(), why);
                continue;
            }
            let met = self.met(course);
            if met.is_empty() {
                self.others.push(course.clone());
                continue;
            }
            let given_up = given_up.get(&course.vehicle);
            let parting = match given_up {
                Some(why) => Err(why.clone()),
                None => self.part(course, &met, lead_s),
            };
            match parting {
                Ok(parting) => self.concerned.push((course.clone(), parting)),
                Err(why) => self.bind(course.clone(), why),
            }
        }
    }

    /// The threats that a vehicle was inside of since the last one was told.
    fn crossed(&self, course: &Course) -> Vec<&Threat> {
        let was_inside = |threat: &&Threat| {
            let center = self.sorties.world.frame.to_plan(threat.place);
            course.was_near(center, threat.radius_m)
        };
        self.popups.iter().filter(was_inside).collect()
    }

    fn is_inside(&self, at: EastNorth, threat: &Threat) -> bool {
        let center = self.sorties.world.frame.to_plan(threat.place);
        center.distance_m(at) < threat.radius_m
    }

    /// The threats that came up and that a course meets.
    fn met(&self, course: &Course) -> Vec<Threat> {
        let tolerance_m = self.sorties.file.spec.mission.tolerance_m;
        let meets = |threat: &&Threat| {
            let center = self.sorties.world.frame.to_plan(threat.place);
            course.meets(center, threat.radius_m + tolerance_m)
        };
        self.popups.iter().filter(meets).cloned().collect()
    }

    /// Where a concerned vehicle parts from its course, or why it cannot in time.
    fn part(&self, course: &Course, met: &[Threat], lead_s: f64) -> Result<Parting, String> {
        if course.stands {
            return Err("it stands on the ground".to_owned());
        }
        if course.takes_off {
            let why =
                "it still climbs after its takeoff: tell the threat again when it is on its way";
            return Err(why.to_owned());
        }
        let vehicle = &self.sorties.file.spec.vehicles[course.vehicle];
        let lead_m = lead_s * vehicle.fastest_mps();
        let parting = course.after(lead_m).ok_or_else(|| {
            format!(
                "it is at the end of its way within {lead_s:.0} s, before it can have a new one"
            )
        })?;
        for threat in met {
            let (id, radius_m) = (&threat.id, threat.radius_m);
            let center = self.sorties.world.frame.to_plan(threat.place);
            if self.is_inside(course.here.at, threat) {
                return Err(format!("it is inside of {id} now"));
            }
            if course.meets_before(&parting, center, radius_m) {
                return Err(format!(
                    "it is inside of {id} within {lead_s:.0} s, before it can have a new path"
                ));
            }
            let mut goals = course.legs(&parting).into_iter().map(|(_, goal)| goal.at);
            if goals.any(|goal| self.is_inside(goal, threat)) {
                return Err(format!("its plan leads to a place inside of {id}"));
            }
        }
        if !course.in_mission {
            return Err("it does not fly its mission: it holds, or somebody flies it".to_owned());
        }
        Ok(parting)
    }

    fn bind(&mut self, course: Course, why: String) {
        let crossed = self.crossed(&course).into_iter();
        let mut threats: Vec<String> = crossed.map(|threat| threat.id.clone()).collect();
        let crossed = threats.len();
        for threat in self.met(&course) {
            if !threats.contains(&threat.id) {
                threats.push(threat.id);
            }
        }
        let certain = if course.in_mission {
            crossed
        } else {
            threats.len()
        };
        self.bound.push(Bound {
            vehicle: course.vehicle,
            certain: threats[..certain].to_vec(),
            threats,
            why,
            in_mission: course.in_mission,
        });
        self.others.push(course);
    }

    /// Whether every limit is kept that a new path could break.
    pub(super) fn is_sound(&self, review: &Review) -> bool {
        let fleet = &self.sorties.file.spec.vehicles;
        let is_of_new_path = |margin: &Margin| {
            let mut concerned = self.concerned.iter();
            concerned.any(|(course, _)| margin.concerns(&fleet[course.vehicle].id))
        };
        let mut margins = review.margins.iter();
        // Of nobody nothing is proven.
        margins.len() > 0 && margins.all(|margin| margin.ok || !is_of_new_path(margin))
    }

    /// Who keeps its course is judged here by the threats that came up, by how near it comes to
    /// those on new paths, and by whether that can be known. What it flies besides was verified
    /// before it took off, and is not judged again from the middle of a leg or a turn.
    pub(super) fn leave_to_the_plan(&self, review: &mut Review) {
        let fleet = &self.sorties.file.spec.vehicles;
        let keeps = |id: &String| {
            let mut others = self.others.iter();
            others.any(|course| fleet[course.vehicle].id == *id)
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

    /// Who keeps its course, and misses the threats all the same, is not bound to meet them; who
    /// meets one all the same is.
    pub(super) fn name_what_is_broken(&mut self, review: &Review) {
        let fleet = &self.sorties.file.spec.vehicles;
        let broken_by = |vehicle: usize| -> Vec<String> {
            let of = |m: &&Margin| !m.ok && m.vehicle == fleet[vehicle].id;
            let broken = review.margins.iter().filter(of);
            let threats = broken.filter_map(|margin| self.popup_of(margin));
            threats.map(|threat| threat.id.clone()).collect()
        };
        let mut bound = self.bound.clone();
        for of in &mut bound {
            let (broken, certain) = (broken_by(of.vehicle), &of.certain);
            of.threats
                .retain(|id| certain.contains(id) || broken.contains(id));
        }
        bound.retain(|of| !of.threats.is_empty());
        for course in &self.others {
            let vehicle = course.vehicle;
            let threats = broken_by(vehicle);
            let is_named = bound.iter().any(|of| of.vehicle == vehicle);
            if !is_named && !threats.is_empty() {
                bound.push(Bound {
                    vehicle,
                    threats,
                    certain: Vec::new(),
                    why: "its way as flown meets it, its course does not".to_owned(),
                    in_mission: course.in_mission,
                });
            }
        }
        self.bound = bound;
    }

    /// Whoever breaks limits on its new path keeps its course: one at a time, because those after it
    /// were planned around that path. Whether there was anybody.
    pub(super) fn give_up(&mut self, review: &Review, given_up: &mut GivenUp) -> bool {
        let broken = review.margins.iter().filter(|margin| !margin.ok);
        let broken: Vec<&Margin> = broken.collect();
        let fleet = &self.sorties.file.spec.vehicles;
        let of = |course: &Course, is_alone: bool| {
            let id = &fleet[course.vehicle].id;
            let mut broken = broken.iter();
            broken.find(|m| m.concerns(id) && (!is_alone || m.other.is_none()))
        };
        let alone = self
            .concerned
            .iter()
            .position(|(c, _)| of(c, true).is_some());
        // Of two that come too near each other the later one was planned around the earlier.
        let beside = || {
            self.concerned
                .iter()
                .rposition(|(c, _)| of(c, false).is_some())
        };
        let Some(index) = alone.or_else(beside) else {
            return false;
        };
        let found = of(&self.concerned[index].0, alone.is_some());
        let id = &fleet[self.concerned[index].0.vehicle].id;
        let why = found.map_or_else(String::new, |margin| why(margin, id));
        let (course, _) = self.concerned.remove(index);
        given_up.insert(course.vehicle, why.clone());
        self.bind(course, why);
        true
    }
}

/// Why a new path of a vehicle is none.
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

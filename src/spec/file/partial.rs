//! What is known of a spec in spite of its problems: the ground shows more of it.

use std::path::Path;

use super::SpecFile;
use super::structure::{self, Unknown, is_of};
use crate::geodesy::LatLon;
use crate::spec::issue::MISSING;
use crate::spec::value_sources::in_order;
use crate::spec::{AltitudeLimits, EndPoint, Issue, SpecError};

/// A spec with problems, and what is known of it all the same.
#[derive(Debug)]
pub struct Incomplete {
    /// Its problems.
    pub error: SpecError,
    /// None where its ground or its area is not known.
    pub known: Option<Known>,
}

/// The part of a spec that is known.
#[derive(Debug)]
pub struct Known {
    /// The spec with the vehicles that have no problem alone; its tasks and rally points are among the
    /// places.
    pub file: SpecFile,
    /// Where each of these vehicles stands in the file, such as `vehicles[3]`.
    pub vehicles: Vec<String>,
    /// Places of the other vehicles, of tasks and rally points.
    pub sites: Vec<KnownPlace>,
    pub(super) unknown: Vec<Unknown>,
}

/// A place whose keys are good.
#[derive(Clone, Debug)]
pub struct KnownPlace {
    /// Where it stands in the file.
    pub path: String,
    /// What the place is of.
    pub kind: PlaceKind,
}

/// Kinds of places.
#[derive(Clone, Copy, Debug)]
pub enum PlaceKind {
    /// Where a vehicle takes off.
    Home(LatLon),
    /// A point of a plan.
    Airborne {
        /// What an operator calls it.
        what: &'static str,
        /// The point.
        end: EndPoint,
        /// Limits of altitude there.
        altitudes: AltitudeLimits,
        /// Whether the vehicle may come down to it from above.
        can_drop: bool,
    },
    /// A rally point and its height above ground, metres.
    Rally(LatLon, f64),
}

impl Known {
    /// Whether an issue is one of its own, and does not come of a problem that is reported already.
    #[must_use]
    pub fn is_known(&self, issue: &Issue) -> bool {
        !structure::is_unknown(issue, &self.unknown)
    }
}

impl Known {
    /// Leaves vehicles with a problem out: of these the places alone are known.
    fn with_whole_vehicles(mut self, issues: &[Issue]) -> Self {
        let is_broken = |vehicle: &str| {
            let made = self.file.is_made(vehicle);
            let mut issues = issues.iter();
            let in_issues = issues.any(|issue| match made {
                true => issue.table.is_some() || is_of(&issue.path, "fleet"),
                false => issue.table.is_none() && is_of(&issue.path, vehicle),
            });
            let mut unknown = self.unknown.iter();
            in_issues
                || unknown.any(|unknown| match unknown {
                    Unknown::At(path) | Unknown::Within(path) | Unknown::ButSites(path) => {
                        is_of(path, vehicle) || is_of(vehicle, path)
                    }
                })
        };
        let is_whole: Vec<bool> = self.vehicles.iter().map(|path| !is_broken(path)).collect();
        let mut whole = is_whole.iter();
        let next = |whole: &mut std::slice::Iter<'_, bool>| whole.next().is_some_and(|of| *of);
        self.file.spec.vehicles.retain(|_| next(&mut whole));
        let mut whole = is_whole.iter();
        self.vehicles.retain(|_| next(&mut whole));
        let vehicles = &self.vehicles;
        self.sites
            .retain(|place| !vehicles.iter().any(|of| is_of(&place.path, of)));
        self.file.spec.tasks.clear();
        self.file.spec.rally.clear();
        self
    }
}

impl From<Box<Incomplete>> for SpecError {
    fn from(incomplete: Box<Incomplete>) -> Self {
        incomplete.error
    }
}

/// An error of the problems of a spec, with what is known where these leave its heights.
pub(super) fn incomplete(path: &Path, issues: Vec<Issue>, known: Option<Known>) -> Box<Incomplete> {
    let known = known
        .filter(|known| !hides_ground(&issues, &known.unknown))
        .map(|known| known.with_whole_vehicles(&issues));
    let error = SpecError {
        file: path.display().to_string(),
        issues: in_order(issues),
    };
    Box::new(Incomplete { error, known })
}

/// Keys whose problems leave no ground to judge places by.
const GROUND: [&str; 5] = [
    "terrain",
    "buffer_m",
    "area.min_agl_m",
    "area.max_amsl_m",
    "area.max_agl_m",
];

/// Whether problems leave the heights of a spec unknown.
fn hides_ground(issues: &[Issue], unknown: &[Unknown]) -> bool {
    let in_issues = issues.iter().any(|issue| {
        let is_range = !issue.found.starts_with("unknown field");
        // What is filled in for a missing limit of the area is wide.
        let is_range = is_range && !issue.found.starts_with(MISSING);
        issue.table.is_none() && is_range && GROUND.iter().any(|key| is_of(&issue.path, key))
    });
    let in_unknown = unknown.iter().any(|unknown| match unknown {
        Unknown::Within(path) => ["terrain", "buffer_m"].iter().any(|key| is_of(path, key)),
        Unknown::At(_) | Unknown::ButSites(_) => false,
    });
    in_issues || in_unknown
}

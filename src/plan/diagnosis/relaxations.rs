//! Relaxations: changes with which a vehicle without a path has one.

use rayon::prelude::*;

use crate::cost::Margins;
use crate::geodesy::Amsl;
use crate::path::VehicleLimits;
use crate::plan::fleet::{Planning, Request};
use crate::spec::{MAX_CONTROL_POINTS, MissionSpec, Vehicle};
use crate::world::World;

/// Changes with which, all together and all else as it is, a path that keeps every limit was
/// found. Tried, not guessed; what is not named may help as well.
#[derive(Clone, Debug, PartialEq)]
pub struct Relaxation(pub Vec<Change>);

/// Something else in the spec.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// Number of control points.
    ControlPoints(usize),
    /// Number of evaluations.
    Evaluations(usize),
    /// Waypoints that stay so near to the path, metres.
    Tolerance(f64),
    /// Turns of so small a radius, metres.
    TurnRadius(f64),
    /// Climbs and descents as steep as these, radians.
    Slopes(f64, f64),
}

/// Evaluations that are tried in place of fewer, of all routes of a vehicle together.
const MORE_EVALUATIONS: usize = 160_000;
/// Evaluations of each trial, at most, where it is not their number that is tried; of all routes
/// together.
const EVALUATIONS: usize = 20_000;
/// Metres that waypoints are tried to keep to the path instead of more.
const TOLERANCES_M: [f64; 2] = [1.0, 0.1];
/// Turn radii that are tried, in units of the vehicle's; the first that helps is reported.
const RADII: [f64; 3] = [0.5, 0.2, 0.05];
/// Slopes that are tried, in units of the vehicle's.
const SLOPES: [f64; 3] = [1.5, 3.0, 10.0];

/// The relaxations that help a vehicle without a path of its own, perhaps none. `None` if it
/// finds a path with these `margins`, and so needs no relaxation.
pub(crate) fn relaxations(
    spec: &MissionSpec,
    world: &World,
    (seed, margins): (u64, Margins),
    index: usize,
) -> Option<Vec<Relaxation>> {
    let finds = |spec: &MissionSpec, margins: Margins| {
        let mut all = vec![Margins::default(); index + 1];
        all[index] = margins;
        let request = Request {
            margins: all,
            ..Request::new(seed)
        };
        let plan = Planning::new(spec, world, &request).plan_alone(index, 0.0);
        plan.terms.is_clean()
    };
    if finds(spec, margins) {
        return None;
    }
    let helps = |relaxation: &Relaxation| {
        let changed = relaxation.applied(spec, index);
        finds(&changed, of_tolerance(margins, spec, &changed))
    };
    // Where the widest of a kind does not help, no narrower one is tried.
    let narrowest = |kind: &Vec<Relaxation>| {
        let (widest, narrower) = kind.split_last()?;
        if !helps(widest) {
            return None;
        }
        let first = narrower.iter().find(|relaxation| helps(relaxation));
        first.or(Some(widest)).cloned()
    };
    let first = |kinds: Vec<Vec<Relaxation>>| kinds.iter().find_map(narrowest);
    let found: Vec<_> = trials(spec, index).into_par_iter().map(first).collect();
    let mut found: Vec<Relaxation> = found.into_iter().flatten().collect();
    // Where other control points are enough, nobody needs more than them.
    let alone = |relaxation: &Relaxation| matches!(relaxation.0[..], [Change::ControlPoints(_)]);
    if found.iter().any(alone) {
        found.retain(|relaxation| relaxation.0.len() == 1);
    }
    Some(found)
}

/// What is tried: of each list the first kind that helps, and each kind from narrow to wide.
fn trials(spec: &MissionSpec, index: usize) -> Vec<Vec<Vec<Relaxation>>> {
    let limits = VehicleLimits::of(&spec.vehicles[index]);
    let bends = spec.planner.control_points;
    let mut numbers = Vec::new();
    for count in [2 * bends, bends / 2] {
        let count = count.min(MAX_CONTROL_POINTS);
        if count > 2 && count != bends {
            numbers.push(vec![Relaxation(vec![Change::ControlPoints(count)])]);
        }
    }
    let mut trials = vec![numbers];
    let more = MORE_EVALUATIONS / routes(&spec.vehicles[index]);
    if spec.planner.evaluations < more {
        let more = Relaxation(vec![Change::Evaluations(more)]);
        trials.push(vec![vec![more]]);
    }
    let nearer = TOLERANCES_M.into_iter();
    let nearer = nearer.filter(|tolerance_m| *tolerance_m < spec.mission.tolerance_m);
    let nearer = nearer.map(|tolerance_m| Relaxation(vec![Change::Tolerance(tolerance_m)]));
    trials.push(vec![nearer.collect()]);
    // Tighter turns and steeper slopes are of use to who may bend often enough.
    let of_limits = |changes: &[Change]| -> Vec<Vec<Relaxation>> {
        let alone = changes.iter().map(|change| vec![*change]);
        let bent = changes
            .iter()
            .map(|change| vec![*change, Change::ControlPoints(MAX_CONTROL_POINTS)]);
        vec![
            alone.map(Relaxation).collect(),
            bent.map(Relaxation).collect(),
        ]
    };
    trials.push(of_limits(
        &RADII.map(|share| Change::TurnRadius(share * limits.turn_radius_m)),
    ));
    let (climb, descent) = (limits.climb.at(Amsl(0.0)), limits.descent.at(Amsl(0.0)));
    let steep_rad = |slope: f64, times: f64| (times * slope).atan();
    trials.push(of_limits(&SLOPES.map(|times| {
        Change::Slopes(steep_rad(climb, times), steep_rad(descent, times))
    })));
    trials
}

/// Number of routes of a vehicle.
fn routes(vehicle: &Vehicle) -> usize {
    vehicle.stops.len() + 1
}

/// Margins as they are with the tolerance of another spec.
fn of_tolerance(margins: Margins, spec: &MissionSpec, other: &MissionSpec) -> Margins {
    let share = other.mission.tolerance_m / spec.mission.tolerance_m;
    Margins {
        clearance_m: share * margins.clearance_m,
        under_m: share * margins.under_m,
        threat_m: share * margins.threat_m,
        separation_m: share * margins.separation_m,
        ..margins
    }
}

impl Relaxation {
    /// The change of the spec or of the vehicle, in words.
    #[must_use]
    pub fn words(&self, vehicle: &Vehicle) -> String {
        let changes: Vec<String> = self.0.iter().map(|change| change.words(vehicle)).collect();
        changes.join(" and ")
    }

    /// The spec with it.
    fn applied(&self, spec: &MissionSpec, index: usize) -> MissionSpec {
        let mut spec = spec.clone();
        let each = EVALUATIONS / routes(&spec.vehicles[index]);
        spec.planner.evaluations = spec.planner.evaluations.min(each);
        for change in &self.0 {
            change.apply(&mut spec, index);
        }
        spec
    }
}

impl Change {
    fn words(self, vehicle: &Vehicle) -> String {
        let limits = VehicleLimits::of(vehicle);
        let degrees = |slope: f64| slope.atan().to_degrees();
        match self {
            Self::ControlPoints(count) => format!("planner.control_points: {count}"),
            Self::Evaluations(count) => format!("planner.evaluations: {count}"),
            Self::Tolerance(tolerance_m) => format!("mission.tolerance_m: {tolerance_m}"),
            // Both limits of a turn grow with the square of the speed.
            Self::TurnRadius(radius_m) => format!(
                "turns of {radius_m:.0} m radius instead of {:.0} m (as at {:.1} m/s)",
                limits.turn_radius_m,
                vehicle.speed_mps * (radius_m / limits.turn_radius_m).sqrt()
            ),
            Self::Slopes(climb_rad, descent_rad) => format!(
                "climbs of {:.1} degrees instead of {:.1} (by angle and by climb_mps: {:.1}) and descents of {:.1} instead of {:.1} (descent_mps: {:.1})",
                climb_rad.to_degrees(),
                degrees(limits.climb.at(Amsl(0.0))),
                limits.fastest_mps * climb_rad.tan(),
                descent_rad.to_degrees(),
                degrees(limits.descent.at(Amsl(0.0))),
                limits.fastest_mps * descent_rad.tan()
            ),
        }
    }

    fn apply(self, spec: &mut MissionSpec, index: usize) {
        let (planner, vehicle) = (&mut spec.planner, &mut spec.vehicles[index]);
        match self {
            Self::ControlPoints(count) => planner.control_points = count,
            Self::Evaluations(count) => planner.evaluations = count,
            Self::Tolerance(tolerance_m) => spec.mission.tolerance_m = tolerance_m,
            Self::TurnRadius(radius_m) => {
                let share = radius_m / VehicleLimits::of(vehicle).turn_radius_m;
                vehicle.accel_mps2 /= share;
                let load = (vehicle.max_load_factor.powi(2) - 1.0).sqrt() / share;
                vehicle.max_load_factor = load.hypot(1.0);
            }
            Self::Slopes(climb_rad, descent_rad) => {
                let fastest_mps = vehicle.fastest_mps();
                vehicle.max_climb_rad = Some(climb_rad);
                vehicle.max_descent_rad = Some(descent_rad);
                vehicle.climb_mps = fastest_mps * climb_rad.tan();
                vehicle.descent_mps = fastest_mps * descent_rad.tan();
            }
        }
    }
}

//! From a spec file to its world: reads the terrain, then checks what needs ground.

mod altitudes;
mod incomplete;
mod takeoff_region;
mod tasks;
mod zones;

pub use incomplete::with_ground;

use std::path::PathBuf;

use super::{Bounds, NoData, Terrain, TerrainError, World};
use super::{read_terrain, terrain_files};
use crate::geodesy::{Agl, Amsl, LatLon, PlanPoint};
use crate::numeric::digits;
use crate::numeric::geometry::Ring;
use crate::spec::{
    AltitudeLimits, BufferedLimit, EndPoint, Finish, Issue, Placement, SpecError, SpecFile,
    TerrainSource, Vehicle,
};

/// The world of a spec file. Its terrain is read from a path relative to the spec.
///
/// # Errors
/// A terrain that cannot be used; or else every problem that shows only over the
/// ground: no data where a vehicle stands or where a rally point is, a start or goal
/// under ground, below the minimum altitude, above the ceiling or in a zone, an
/// approach to a landing that begins at such a place, in a threat or outside the area, a takeoff
/// around which a QuadPlane may be at such a place before it is on its first leg, two goals at which
/// vehicles loiter within each other's separation.
pub fn load(file: &SpecFile) -> Result<World, SpecError> {
    let terrain = terrain(file).map_err(|error| file.error(vec![unread(file, &error)]))?;
    let vehicles = 0..file.spec.vehicles.len();
    let vehicles: Vec<String> = vehicles.map(|index| format!("vehicles[{index}]")).collect();
    let mut check = Check {
        file,
        terrain: &terrain,
        issues: Vec::new(),
    };
    check.fleet(&vehicles);
    check.tasks();
    for (index, rally) in file.spec.rally.iter().enumerate() {
        check.rally(&format!("rally[{index}]"), rally.place, rally.agl.0);
    }
    let mut issues = check.issues;
    match World::new(&file.spec, terrain) {
        Ok(world) => {
            let blocked = super::approach::blocked(file, &world, &vehicles);
            // What is wrong with a vehicle may be why.
            let is_free = |of: &Issue| !issues.iter().any(|it| it.position == of.position);
            let blocked: Vec<Issue> = blocked.into_iter().filter(is_free).collect();
            issues.extend(blocked);
            match issues.is_empty() {
                true => Ok(world),
                false => Err(file.error(issues)),
            }
        }
        Err(error) => {
            if issues.is_empty() {
                issues.push(file.issue("terrain", error.to_string(), String::new()));
            }
            Err(file.error(issues))
        }
    }
}

/// What is wrong with a terrain that cannot be used.
fn unread(file: &SpecFile, error: &TerrainError) -> Issue {
    let path = match file.spec.terrain {
        TerrainSource::Folder(_) => "terrain.folder",
        _ => "terrain.file",
    };
    file.issue(path, error.to_string(), String::new())
}

fn terrain(file: &SpecFile) -> Result<Terrain, TerrainError> {
    match &file.spec.terrain {
        TerrainSource::Flat(amsl) => Ok(Terrain::Flat(*amsl)),
        TerrainSource::Analytic { base, hills } => Ok(Terrain::Analytic {
            base: *base,
            hills: hills.clone(),
        }),
        TerrainSource::File(name) | TerrainSource::Folder(name) => {
            let path = file.terrain_path().unwrap_or_else(|| name.clone());
            let is_folder = matches!(file.spec.terrain, TerrainSource::Folder(_));
            if path.is_dir() != is_folder {
                // The error of the system explains why.
                std::fs::read_dir(&path)?;
                return Err(TerrainError::UnknownKind);
            }
            read_terrain(&path, Some(Bounds::around(&file.spec.area))).map(Terrain::Grid)
        }
    }
}

/// The elevation files that a spec uses; none if its ground comes from no file.
///
/// # Errors
/// A folder whose files do not fit together or do not cover the area.
pub fn files(file: &SpecFile) -> Result<Vec<PathBuf>, TerrainError> {
    file.terrain_path().map_or(Ok(Vec::new()), |path| {
        terrain_files(&path, Some(Bounds::around(&file.spec.area)))
    })
}

/// Tolerance of legs by default, metres.
const USUAL_TOLERANCE_M: f64 = 5.0;

/// That a buffer is part of a distance, if there is one.
fn within(buffer_m: f64) -> String {
    match buffer_m > 0.0 {
        true => format!(" with its buffer of {} m", digits::plain(buffer_m)),
        false => String::new(),
    }
}

struct Check<'a> {
    file: &'a SpecFile,
    terrain: &'a Terrain,
    issues: Vec<Issue>,
}

impl Check<'_> {
    fn report(&mut self, path: &str, found: String, allowed: String) {
        self.issues.push(self.file.issue(path, found, allowed));
    }

    /// The ground at a place; without data it is reported.
    fn ground(&mut self, path: &str, place: LatLon) -> Option<Amsl> {
        match self.terrain.height(place) {
            Ok(ground) => Some(ground),
            Err(error @ NoData { .. }) => {
                self.report(
                    path,
                    error.to_string(),
                    "a place that the terrain covers".to_owned(),
                );
                None
            }
        }
    }

    /// All vehicles, by the paths that they have in the file.
    fn fleet(&mut self, paths: &[String]) {
        for (path, vehicle) in paths.iter().zip(&self.file.spec.vehicles) {
            self.vehicle(path, vehicle);
        }
        self.loiters(paths);
    }

    fn vehicle(&mut self, path: &str, vehicle: &Vehicle) {
        let home = format!("{path}.home");
        if let Some(ground) = self.ground(&home, vehicle.home) {
            self.zones(&home, "takeoff", vehicle.home, ground);
        }
        let start = format!("{path}.start");
        let never = (vehicle.altitudes, false);
        self.airborne((&start, "start"), vehicle.start, never);
        self.takeoff_region(path, vehicle);
        self.tolerance(vehicle);
        let goal = format!("{path}.goal");
        let can_drop = vehicle.can_drop();
        self.airborne((&goal, "goal"), vehicle.goal, (vehicle.altitudes, can_drop));
        for (index, stop) in vehicle.stops.iter().enumerate() {
            let path = format!("{path}.stops[{index}]");
            self.airborne((&path, "stop"), stop.end, never);
        }
        if vehicle.finish == Finish::Land
            && let Ok(ground) = self.terrain.height(vehicle.goal.place)
        {
            self.zones(&goal, "landing", vehicle.goal.place, ground);
        }
        self.approach(&format!("{path}.landing"), vehicle);
        let ceiling = self.ceiling();
        if let Some(amsl) = vehicle.return_amsl {
            let path = format!("{path}.return_amsl_m");
            if amsl.0 > ceiling.limit_m {
                let found = format!("{} m, above the ceiling", digits::plain(amsl.0));
                self.report(&path, found, format!("at most {} m", ceiling.limit_m));
            } else if amsl.0 > ceiling.buffered_m {
                let found = format!("{} m", digits::plain(amsl.0));
                self.report(&path, found, ceiling.allowed(amsl.0));
            }
        }
    }

    /// The path keeps the tolerance over the minimum height, because legs between waypoints
    /// cut corners, and must stay under the ceiling.
    fn tolerance(&mut self, vehicle: &Vehicle) {
        let path = "mission.tolerance_m";
        let tolerance_m = self.file.spec.mission.tolerance_m;
        // Without ground there that is reported already.
        let Ok(ground) = self.terrain.height(vehicle.start.place) else {
            return;
        };
        let layer_m =
            Amsl(self.ceiling().buffered_m).above_ground(ground).0 - self.min_agl().buffered_m;
        // A narrow layer may be meant, a wide tolerance in it not. Reported once for the fleet.
        let is_wide = tolerance_m > USUAL_TOLERANCE_M && tolerance_m > layer_m;
        if !is_wide || self.issues.iter().any(|issue| issue.path == path) {
            return;
        }
        let found = format!(
            "{} m, and from area.min_agl_m over the start of `{}` to the ceiling it is {} m",
            digits::plain(tolerance_m),
            vehicle.id,
            digits::distinct_from(layer_m, tolerance_m, 1)
        );
        let max_m = layer_m.max(USUAL_TOLERANCE_M);
        self.report(path, found, format!("at most {} m", digits::plain(max_m)));
    }

    /// A point of the plan: over ground, high enough but for a drop, under the ceiling, in no zone.
    fn airborne(
        &mut self,
        (path, what): (&str, &str),
        end: EndPoint,
        (altitudes, can_drop): (AltitudeLimits, bool),
    ) {
        let area = self.file.spec.area;
        let Some(ground) = self.ground(path, end.place) else {
            return;
        };
        let amsl = match end.altitude {
            Placement::Amsl(amsl) => amsl,
            Placement::Agl(agl) => agl.over(ground),
        };
        let agl_m = amsl.above_ground(ground).0;
        let over = format!("ground at {:.1} m", ground.0);
        if agl_m < 0.0 {
            let (at_m, deep_m) = (
                digits::distinct_from(amsl.0, ground.0, 1),
                digits::distinct_from(-agl_m, 0.0, 1),
            );
            let found = format!("{what} at {at_m} m is {deep_m} m under ground");
            self.report(
                path,
                found,
                format!("at least {} m above {over}", area.min_agl.0),
            );
        } else if can_drop && agl_m < area.min_agl.0 {
            // The route ends above it.
        } else if agl_m < area.min_agl.0 {
            let above_m = digits::distinct_from(agl_m, area.min_agl.0, 1);
            let found = format!("{what} is {above_m} m above {over}");
            self.report(path, found, min_height(area.min_agl, what, end));
        } else if agl_m < self.min_agl().buffered_m {
            let least = self.min_agl();
            let above_m = digits::distinct_from(agl_m, least.buffered_m, 1);
            let found = format!("{what} is {above_m} m above {over}");
            self.report(path, found, least.allowed(agl_m));
        }
        if amsl > area.max_amsl {
            let at_m = digits::distinct_from(amsl.0, area.max_amsl.0, 1);
            let found = format!("{what} is at {at_m} m, over {over}");
            self.report(
                path,
                found,
                format!("at most {} m (area.max_amsl_m)", area.max_amsl.0),
            );
        } else if amsl.0 > self.ceiling().buffered_m {
            let ceiling = self.ceiling();
            let at_m = digits::distinct_from(amsl.0, ceiling.buffered_m, 1);
            let found = format!("{what} is at {at_m} m, over {over}");
            self.report(path, found, ceiling.allowed(amsl.0));
        }
        self.within((path, what), altitudes, (amsl, ground));
        self.zones(path, what, end.place, amsl);
    }

    /// The least height over ground, with its buffer.
    fn min_agl(&self) -> BufferedLimit<'static> {
        let spec = &self.file.spec;
        BufferedLimit {
            key: "terrain",
            of: "area.min_agl_m",
            limit_m: spec.area.min_agl.0,
            buffered_m: spec.area.min_agl.0 + spec.buffers.terrain_m,
        }
    }

    /// The ceiling, with its buffer.
    fn ceiling(&self) -> BufferedLimit<'static> {
        let spec = &self.file.spec;
        BufferedLimit {
            key: "ceiling",
            of: "area.max_amsl_m",
            limit_m: spec.area.max_amsl.0,
            buffered_m: spec.area.max_amsl.0 - spec.buffers.ceiling_m,
        }
    }

    /// The planned path of a wing ends at the beginning of its approach. Glide, height and radius
    /// give its distance from the touchdown.
    fn approach(&mut self, path: &str, vehicle: &Vehicle) {
        let spec = &self.file.spec;
        let (touchdown, from) = match vehicle.finish {
            Finish::Loiter => return,
            Finish::Land => (vehicle.goal.place, vehicle.goal),
            Finish::Return => (vehicle.home, vehicle.start),
        };
        // Without ground there that is reported already.
        let (Ok(ground), Ok(high)) = (
            self.terrain.height(touchdown),
            super::resolve(&spec.frame, self.terrain, from),
        ) else {
            return;
        };
        let over = PlanPoint {
            at: spec.frame.to_plan(touchdown),
            ..high
        };
        let heading_rad = vehicle
            .wing
            .and_then(|wing| wing.landing)
            .and_then(|landing| landing.heading_rad);
        let Some(gate) = super::gate(vehicle, heading_rad, over, ground) else {
            return;
        };
        let away_m = gate.at.distance_m(over.at);
        let what = format!("the approach, which begins {away_m:.0} m before the touchdown,");
        let place = spec.frame.from_plan(gate.at);
        let outline = spec.frame.outline(&spec.area.outline());
        let edge_m = Ring::around(&outline).boundary_distance(super::point(gate.at));
        let by = "heading_deg, glide_deg, loiter_radius_m or the height";
        if !super::covers(&outline, gate.at) || edge_m < spec.buffers.area_m {
            let found = format!(
                "{what} begins outside the area{}",
                within(spec.buffers.area_m)
            );
            return self.report(path, found, format!("inside: by {by}"));
        }
        let buffer_m = spec.buffers.threats_m;
        let threat = spec.threats.iter().find(|threat| {
            let away_m = spec.frame.to_plan(threat.place).distance_m(gate.at);
            away_m <= threat.radius_m || away_m < threat.radius_m + buffer_m
        });
        if let Some(threat) = threat {
            let found = format!(
                "{what} begins inside threat `{}`{}",
                threat.id,
                within(buffer_m)
            );
            self.report(path, found, format!("outside: by {by}"));
        }
        let end = EndPoint {
            place,
            altitude: Placement::Amsl(gate.amsl),
        };
        self.airborne((path, &what), end, (vehicle.altitudes, false));
    }

    fn rally(&mut self, path: &str, place: LatLon, agl_m: f64) {
        let ceiling = self.ceiling();
        let Some(ground) = self.ground(path, place) else {
            return;
        };
        let amsl = Amsl(ground.0 + agl_m);
        if amsl.0 > ceiling.limit_m {
            let at_m = digits::distinct_from(amsl.0, ceiling.limit_m, 1);
            let found = format!("the rally point is at {at_m} m");
            let allowed = format!("at most {} m (area.max_amsl_m)", ceiling.limit_m);
            self.report(path, found, allowed);
        } else if amsl.0 > ceiling.buffered_m {
            let at_m = digits::distinct_from(amsl.0, ceiling.buffered_m, 1);
            let found = format!("the rally point is at {at_m} m");
            self.report(path, found, ceiling.allowed(amsl.0));
        }
        self.zones(path, "the rally point", place, amsl);
    }

    /// A loitering vehicle stays at its goal for ever.
    fn loiters(&mut self, paths: &[String]) {
        let spec = &self.file.spec;
        let stays: Vec<(usize, PlanPoint)> = spec
            .vehicles
            .iter()
            .enumerate()
            .filter(|(_, vehicle)| vehicle.finish == Finish::Loiter)
            .filter_map(|(index, vehicle)| {
                let goal = super::resolve(&spec.frame, self.terrain, vehicle.goal);
                Some((index, goal.ok()?))
            })
            .collect();
        let limit = spec.buffered_separation();
        let allowed = match limit.vertical_m {
            Some(vertical_m) => {
                format!("{} m across or {vertical_m} m in height", limit.distance_m)
            }
            None => format!("at least {} m", limit.distance_m),
        };
        let allowed = format!("{allowed}{}", within(spec.buffers.separation_m));
        for (position, (later, place)) in stays.iter().enumerate() {
            for (earlier, other) in &stays[..position] {
                let radius_m = |index: usize| {
                    let wing = spec.vehicles[index].wing;
                    wing.map_or(0.0, |wing| wing.loiter_radius_m)
                };
                let between_m = place.at.distance_m(other.at);
                let across_m = (between_m - radius_m(*later) - radius_m(*earlier)).max(0.0);
                let up_m = (place.amsl.0 - other.amsl.0).abs();
                if limit.is_conflict(across_m, up_m) {
                    let found = format!(
                        "loiters for ever {across_m:.1} m across and {up_m:.1} m in height from `{}`",
                        spec.vehicles[*earlier].id
                    );
                    self.report(&format!("{}.goal", paths[*later]), found, allowed.clone());
                }
            }
        }
    }
}

/// What is allowed where a place is too low.
fn min_height(min_agl: Agl, what: &str, end: EndPoint) -> String {
    let least = format!("at least {} m (area.min_agl_m)", min_agl.0);
    let is_stop = ["stop", "task"].contains(&what);
    match is_stop && matches!(end.altitude, Placement::Amsl(_)) {
        true => format!("{least}; a copter comes straight down to a lower `agl_m`"),
        false => least,
    }
}

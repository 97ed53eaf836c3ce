//! Those who keep their course, or their place, as the verdict on the new paths sees them.

use super::{Origin, Present, ground};
use crate::cli::replan::course::Course;
use crate::geodesy::{Amsl, PlanPoint};
use crate::mission::{self, Item, VehicleMission, command};
use crate::path::route_start_s;
use crate::spec::{Autopilot, Vehicle};
use crate::verify::Limit;

/// With less way than this before it a vehicle is at its end, metres.
const AT_END_M: f64 = 4.0;
/// A way to a circle begins so many radii before its middle.
const OUTSIDE: f64 = 3.0;

impl Present<'_> {
    /// A vehicle that is not concerned goes on as it does.
    pub(super) fn keep(&mut self, course: &Course) {
        let at_its_end;
        let course = if course.way_m() < AT_END_M.max(OUTSIDE * course.circle_m) {
            at_its_end = self.at_its_end(course);
            &at_its_end
        } else {
            course
        };
        let points = course.points();
        let last = points.last().copied().unwrap_or(course.here);
        let at_s = self.now_s + course.rises_s;
        self.add(
            self.vehicle(course),
            (course.here, last),
            course.lands,
            at_s,
        );
        let straight = self.route(course, &[course.here, last], at_s).path;
        let head = self.head(&[straight]);
        self.settle_kept(course, (&points, at_s), course.items_ahead(), head);
    }

    /// Takes the last vehicle that was added into the fleet with its way, with what begins its
    /// mission and the items of its own that follow, each with its row.
    fn settle_kept(
        &mut self,
        course: &Course,
        (way, at_s): (&[PlanPoint], f64),
        own: Vec<(usize, Item)>,
        begun: Result<VehicleMission, mission::MissionError>,
    ) {
        match begun {
            Ok(mut mission) => {
                hold_fence(&mut mission, course);
                let mut rows = vec![course.at + 1; mission.items.len()];
                for (row, item) in own {
                    rows.push(row);
                    mission.items.push(item);
                }
                let route = self.route(course, way, at_s);
                self.settle(vec![route], mission, Origin::new(course, at_s, rows));
            }
            Err(error) => {
                self.drop_last();
                self.problem(course, Limit::Encoding, error.to_string());
            }
        }
    }

    /// A vehicle that does not fly its mission stays where it is: what else it does nobody knows.
    pub(super) fn keep_place(&mut self, course: &Course) {
        let staying = Course {
            ahead: vec![(course.at, course.here)],
            circle_m: self
                .vehicle(course)
                .wing
                .map_or(0.0, |wing| wing.loiter_radius_m),
            ..course.clone()
        };
        let beside = self.at_its_end(&staying);
        let place = PlanPoint {
            amsl: beside.here.amsl,
            ..course.here
        };
        let (way, at_s) = ([beside.here, place], self.now_s);
        self.add(self.vehicle(course), way.into(), false, at_s);
        let index = self.spec.vehicles.len() - 1;
        let path = self.route(course, &way, at_s).path;
        let built = mission::build_course(&self.spec, &self.world, index, &[path], 1);
        self.settle_kept(course, (&way, at_s), Vec::new(), built);
    }

    /// A vehicle that stays at its end, or comes down there: for the verdict it begins a few
    /// metres beside, a wing outside of its circle, no lower than may be flown, so that there is a way to be judged and
    /// its whole column counts.
    fn at_its_end(&self, course: &Course) -> Course {
        let place = course.ahead.last().map_or(course.here, |(_, place)| *place);
        let least_m = ground(&self.world, place).0 + self.spec.area.min_agl.0;
        let amsl = Amsl(place.amsl.0.max(least_m + self.spec.mission.tolerance_m));
        let beside_m = AT_END_M.max(OUTSIDE * course.circle_m);
        let here = PlanPoint::new(place.at.east_m, place.at.north_m - beside_m, amsl);
        Course {
            here,
            ..course.clone()
        }
    }

    /// A vehicle that has not taken off will do so at its time.
    pub(super) fn keep_standing(&mut self, course: &Course) {
        let (spec, world) = (&self.given.sorties.file.spec, &self.given.sorties.world);
        let (Some(vehicle), Some(stations)) = (
            spec.vehicles.get(course.vehicle),
            world.stations.get(course.vehicle),
        ) else {
            return;
        };
        let waits_s = (vehicle.depart_s - self.given.now_s).max(0.0);
        let depart_s = self.now_s + waits_s;
        let mut mission = course.held.clone();
        hold_fence(&mut mission, course);
        let (mut rows, items): (Vec<usize>, Vec<Item>) = (1..)
            .zip(mission.items)
            .filter(|(_, item)| item.command != command::NAV_DELAY)
            .unzip();
        mission.items = items;
        // ArduPlane does not wait by itself: the verdict knows when it is launched.
        let is_launched = vehicle.airframe.has_wing() && vehicle.autopilot == Autopilot::ArduPilot;
        if !is_launched {
            #[expect(clippy::cast_possible_truncation, reason = "parameters are float32")]
            let delay_s = depart_s as f32;
            let wait = Item::without_place(command::NAV_DELAY, [delay_s, -1.0, -1.0, -1.0]);
            mission.items.insert(0, wait);
            rows.insert(0, 1);
        }
        let vehicle = Vehicle {
            depart_s,
            ..vehicle.clone()
        };
        let route_s = route_start_s(&vehicle, stations);
        self.spec.vehicles.push(vehicle);
        self.world.stations.push(*stations);
        let route = self.route(course, &course.points(), route_s);
        self.settle(vec![route], mission, Origin::new(course, 0.0, rows));
    }
}

/// Who keeps its course keeps its fence: nothing of what came up since is in it, nor has to be.
fn hold_fence(mission: &mut VehicleMission, course: &Course) {
    mission.fence.clone_from(&course.held.fence);
    mission.is_fence_known = false;
}

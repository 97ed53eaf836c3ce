//! One mission as points and outlines for a map.

use super::outline::{circumscribed, inscribed, ring};
use crate::formats::plan::corner_count;
use crate::geodesy::{AboveHome, Amsl, EastNorth, LatLon, LocalFrame, PlanPoint};
use crate::mission::{Item, VehicleMission, command, command_name, frame};
use crate::world::World;

/// Greatest command number of an item that is flown to (`MAV_CMD_NAV_LAST`).
const LAST_FLOWN: u16 = 95;
/// Largest radius that is drawn, metres.
const MAX_RADIUS_M: f64 = 1e6;

/// A mission as points and outlines for a map. Altitudes above terrain, and above an
/// unknown home, are never guessed: such points have no altitude.
#[derive(Debug)]
pub struct Drawing<'a> {
    pub(crate) home: Option<MapPoint>,
    pub(crate) items: Vec<DrawnItem<'a>>,
    pub(crate) rally: Vec<DrawnItem<'a>>,
    /// Return point of the fence, and other fence items without an outline.
    pub(crate) returns: Vec<DrawnItem<'a>>,
    pub(crate) outlines: Vec<Outline>,
    flat: Vec<usize>,
    lost: Vec<String>,
}

/// A point of a map; without an altitude it lies on the ground.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MapPoint {
    pub(crate) place: LatLon,
    pub(crate) amsl: Option<Amsl>,
}

impl MapPoint {
    pub(crate) fn of(world: &World, point: PlanPoint) -> Self {
        Self {
            place: world.frame.from_plan(point.at),
            amsl: Some(point.amsl),
        }
    }
}

/// An item, its number from 1 and its point.
#[derive(Debug)]
pub(crate) struct DrawnItem<'a> {
    pub(crate) number: usize,
    pub(crate) item: &'a Item,
    pub(crate) point: Option<MapPoint>,
}

/// A fence polygon or circle.
#[derive(Debug)]
pub(crate) struct Outline {
    pub(crate) name: String,
    /// Whether vehicles must stay inside; otherwise outside.
    pub(crate) inclusion: bool,
    /// Closed, counter-clockwise.
    pub(crate) ring: Vec<LatLon>,
}

impl DrawnItem<'_> {
    /// Number and command.
    pub(crate) fn name(&self) -> String {
        match command_name(self.item.command) {
            Some(name) => format!("{} {name}", self.number),
            None => format!("{} command {}", self.number, self.item.command),
        }
    }

    fn is_on_the_route(&self) -> bool {
        self.point.is_some() && self.item.command <= LAST_FLOWN
    }
}

impl<'a> Drawing<'a> {
    /// The drawing of a mission; latitude 0, longitude 0 means no home.
    #[must_use]
    pub fn of(mission: &'a VehicleMission) -> Self {
        let home = mission.home;
        let home_amsl = ((home.x, home.y) != (0, 0)).then_some(Amsl(f64::from(home.amsl_m)));
        let drawn = |items: &'a [Item]| -> Vec<DrawnItem<'a>> {
            let numbered = items.iter().zip(1..);
            let mut before = None;
            numbered
                .map(|(item, number)| {
                    let mut point = point_of(item, home_amsl);
                    if let Some(point) = point.as_mut().filter(|_| item.command <= LAST_FLOWN) {
                        if let Some(before) = before.filter(|_| stays_level(item, mission)) {
                            point.amsl = before;
                        }
                        before = Some(point.amsl);
                    }
                    DrawnItem {
                        number,
                        item,
                        point,
                    }
                })
                .collect()
        };
        let mut drawing = Self {
            home: home_amsl.and_then(|amsl| {
                let place = LatLon::new(f64::from(home.x) / 1e7, f64::from(home.y) / 1e7).ok()?;
                let amsl = Some(amsl);
                Some(MapPoint { place, amsl })
            }),
            items: drawn(&mission.items),
            rally: drawn(&mission.rally),
            returns: Vec::new(),
            outlines: Vec::new(),
            flat: Vec::new(),
            lost: Vec::new(),
        };
        let flat = drawing
            .items
            .iter()
            .filter(|item| item.point.is_some_and(|point| point.amsl.is_none()));
        drawing.flat = flat.map(|item| item.number).collect();
        drawing.fence(&mission.fence);
        drawing
    }

    /// The points flown to, in order; without altitudes if one of them has none.
    pub(crate) fn route(&self) -> Vec<MapPoint> {
        let on_it = self.items.iter().filter(|item| item.is_on_the_route());
        let mut points: Vec<MapPoint> = on_it.filter_map(|item| item.point).collect();
        if points.iter().any(|point| point.amsl.is_none()) {
            for point in &mut points {
                point.amsl = None;
            }
        }
        points
    }

    /// Items without a place on a map.
    #[must_use]
    pub fn without_place(&self) -> Vec<usize> {
        let lost = self.items.iter().filter(|item| item.point.is_none());
        lost.map(|item| item.number).collect()
    }

    /// Items with a place whose altitude above mean sea level is unknown.
    #[must_use]
    pub fn without_altitude(&self) -> &[usize] {
        &self.flat
    }

    /// Parts of the fence and the rally points that cannot be drawn, one sentence each.
    #[must_use]
    pub fn lost(&self) -> Vec<String> {
        let mut lost = self.lost.clone();
        for DrawnItem { number, point, .. } in &self.rally {
            match point.map(|point| point.amsl) {
                None => lost.push(format!("rally point {number} has no place")),
                Some(None) => lost.push(format!("the altitude of rally point {number}")),
                Some(Some(_)) => {}
            }
        }
        lost
    }

    fn fence(&mut self, fence: &'a [Item]) {
        let mut rest = fence;
        while let Some((first, others)) = rest.split_first() {
            let number = fence.len() - rest.len() + 1;
            rest = others;
            let drawn = match first.command {
                command::NAV_FENCE_POLYGON_VERTEX_INCLUSION
                | command::NAV_FENCE_POLYGON_VERTEX_EXCLUSION => {
                    let (corners, after) = others.split_at(corner_count(first, others) - 1);
                    rest = after;
                    polygon(first, corners)
                }
                command::NAV_FENCE_CIRCLE_INCLUSION | command::NAV_FENCE_CIRCLE_EXCLUSION => {
                    circle(first)
                }
                _ => {
                    self.returns.push(DrawnItem {
                        number,
                        item: first,
                        point: point_of(first, None),
                    });
                    continue;
                }
            };
            match drawn {
                Some((outline, inclusion, ring)) => self.outlines.push(Outline {
                    name: format!(
                        "fence {number}: {outline} to stay {}",
                        if inclusion { "in" } else { "out of" }
                    ),
                    inclusion,
                    ring,
                }),
                None => self
                    .lost
                    .push(format!("fence item {number} makes no outline")),
            }
        }
    }
}

/// Whether a copter flies to an item at the altitude that it has: ArduCopter where the item has none
/// (`ModeAuto::loc_from_cmd`). A landing is drawn on the ground.
fn stays_level(item: &Item, mission: &VehicleMission) -> bool {
    let is_unset = (f64::from(item.z) * 100.0).abs() < 1.0;
    is_unset
        && mission.autopilot.conventions().zero_is_unset
        && !mission.airframe.has_wing()
        && item.command != command::NAV_LAND
        && mission
            .facts()
            .acceptance
            .zero_is_here
            .contains(&item.command)
}

/// The point of an item, if its frame is global and its place valid.
fn point_of(item: &Item, home: Option<Amsl>) -> Option<MapPoint> {
    let place = item.place().filter(|_| (item.x, item.y) != (0, 0))?;
    let z = f64::from(item.z);
    let amsl = match frame::canonical(item.frame) {
        frame::GLOBAL => Some(Amsl(z)),
        frame::GLOBAL_RELATIVE_ALT => home.map(|home| AboveHome(z).over(home)),
        _ => None,
    };
    Some(MapPoint {
        place,
        amsl: amsl.filter(|amsl| amsl.0.is_finite()),
    })
}

type Shape = (&'static str, bool, Vec<LatLon>);

fn polygon(first: &Item, others: &[Item]) -> Option<Shape> {
    let corners = std::iter::once(first).chain(others);
    let corners: Option<Vec<LatLon>> = corners.map(Item::place).collect();
    let corners = corners.filter(|corners| corners.len() >= 3)?;
    let inclusion = first.command == command::NAV_FENCE_POLYGON_VERTEX_INCLUSION;
    Some(("polygon", inclusion, ring(corners)))
}

fn circle(item: &Item) -> Option<Shape> {
    let radius_m = f64::from(item.params[0]);
    let place = item.place()?;
    let drawable = radius_m > 0.0 && radius_m <= MAX_RADIUS_M;
    let center = EastNorth {
        east_m: 0.0,
        north_m: 0.0,
    };
    let inclusion = item.command == command::NAV_FENCE_CIRCLE_INCLUSION;
    // On the safe side: inclusion circles are drawn too small, exclusion circles too large.
    let outline = if inclusion { inscribed } else { circumscribed };
    drawable.then(|| {
        let ring = outline(&LocalFrame::new(place), center, radius_m);
        ("circle", inclusion, ring)
    })
}

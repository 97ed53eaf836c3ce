//! What a map shows of one mission: its places, and the altitudes that are known.

use super::shape::{around, ring, round};
use crate::formats::plan::corner_count;
use crate::geodesy::{AboveHome, Amsl, EastNorth, LatLon, LocalFrame};
use crate::mission::{Item, VehicleMission, command, command_name, frame};

/// Commands up to this are flown to (`MAV_CMD_NAV_LAST`).
const LAST_FLOWN: u16 = 95;
/// Circles beyond this are no fence of a vehicle, metres.
const MOST_RADIUS_M: f64 = 1e6;

/// A mission as a map shows it. Altitudes above terrain, and above a home that nothing
/// tells, are not known and never guessed: such places lie flat.
#[derive(Debug)]
pub struct Drawing<'a> {
    pub(crate) home: Option<Spot>,
    pub(crate) items: Vec<DrawnItem<'a>>,
    pub(crate) rally: Vec<DrawnItem<'a>>,
    /// Where a breach of the fence returns to, and what else of a fence is a point.
    pub(crate) returns: Vec<DrawnItem<'a>>,
    pub(crate) outlines: Vec<Outline>,
    flat: Vec<usize>,
    lost: Vec<String>,
}

/// A place, and how high.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spot {
    pub(crate) place: LatLon,
    pub(crate) amsl: Option<Amsl>,
}

/// An item by its number from 1, and where it is.
#[derive(Debug)]
pub(crate) struct DrawnItem<'a> {
    pub(crate) number: usize,
    pub(crate) item: &'a Item,
    pub(crate) spot: Option<Spot>,
}

/// A fence polygon or circle.
#[derive(Debug)]
pub(crate) struct Outline {
    pub(crate) name: String,
    /// To stay in, or to stay out of.
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
        self.spot.is_some() && self.item.command <= LAST_FLOWN
    }
}

impl<'a> Drawing<'a> {
    /// Draws a mission; a home at latitude 0, longitude 0 is none.
    #[must_use]
    pub fn of(mission: &'a VehicleMission) -> Self {
        let home = mission.home;
        let home_amsl = ((home.x, home.y) != (0, 0)).then_some(Amsl(f64::from(home.amsl_m)));
        let drawn = |items: &'a [Item]| -> Vec<DrawnItem<'a>> {
            let numbered = items.iter().zip(1..);
            numbered
                .map(|(item, number)| DrawnItem {
                    number,
                    item,
                    spot: spot(item, home_amsl),
                })
                .collect()
        };
        let mut drawing = Self {
            home: home_amsl.and_then(|amsl| {
                let place = LatLon::new(f64::from(home.x) / 1e7, f64::from(home.y) / 1e7).ok()?;
                let amsl = Some(amsl);
                Some(Spot { place, amsl })
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
            .filter(|item| item.spot.is_some_and(|spot| spot.amsl.is_none()));
        drawing.flat = flat.map(|item| item.number).collect();
        drawing.fence(&mission.fence);
        drawing
    }

    /// The places flown to, in order; none of them raised if one of them cannot be.
    pub(crate) fn route(&self) -> Vec<Spot> {
        let on_it = self.items.iter().filter(|item| item.is_on_the_route());
        let mut spots: Vec<Spot> = on_it.filter_map(|item| item.spot).collect();
        if spots.iter().any(|spot| spot.amsl.is_none()) {
            for spot in &mut spots {
                spot.amsl = None;
            }
        }
        spots
    }

    /// Items without a place on a map.
    #[must_use]
    pub fn without_place(&self) -> Vec<usize> {
        let lost = self.items.iter().filter(|item| item.spot.is_none());
        lost.map(|item| item.number).collect()
    }

    /// Items with a place whose altitude above the sea is not known.
    #[must_use]
    pub fn without_altitude(&self) -> &[usize] {
        &self.flat
    }

    /// What of the fence and the rally points cannot be drawn, one sentence each.
    #[must_use]
    pub fn lost(&self) -> Vec<String> {
        let mut lost = self.lost.clone();
        for point in &self.rally {
            match point.spot {
                None => lost.push(format!("rally point {} has no place", point.number)),
                Some(spot) if spot.amsl.is_none() => {
                    let text = format!("the altitude of rally point {}", point.number);
                    lost.push(text);
                }
                Some(_) => {}
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
                command::FENCE_POLYGON_INCLUSION | command::FENCE_POLYGON_EXCLUSION => {
                    let (corners, after) = others.split_at(corner_count(first, others) - 1);
                    rest = after;
                    polygon(first, corners)
                }
                command::FENCE_CIRCLE_INCLUSION | command::FENCE_CIRCLE_EXCLUSION => circle(first),
                _ => {
                    self.returns.push(DrawnItem {
                        number,
                        item: first,
                        spot: spot(first, None),
                    });
                    continue;
                }
            };
            match drawn {
                Some((shape, inclusion, ring)) => self.outlines.push(Outline {
                    name: format!(
                        "fence {number}: {shape} to stay {}",
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

/// Where an item is, if its frame is global and its place is one.
fn spot(item: &Item, home: Option<Amsl>) -> Option<Spot> {
    let place = item.place().filter(|_| (item.x, item.y) != (0, 0))?;
    let z = f64::from(item.z);
    let amsl = match frame::canonical(item.frame) {
        frame::GLOBAL => Some(Amsl(z)),
        frame::GLOBAL_RELATIVE_ALT => home.map(|home| AboveHome(z).over(home)),
        _ => None,
    };
    Some(Spot {
        place,
        amsl: amsl.filter(|amsl| amsl.0.is_finite()),
    })
}

type Shape = (&'static str, bool, Vec<LatLon>);

fn polygon(first: &Item, others: &[Item]) -> Option<Shape> {
    let corners = std::iter::once(first).chain(others);
    let places: Option<Vec<LatLon>> = corners.map(Item::place).collect();
    let places = places.filter(|places| places.len() >= 3)?;
    let inclusion = first.command == command::FENCE_POLYGON_INCLUSION;
    Some(("polygon", inclusion, ring(places)))
}

fn circle(item: &Item) -> Option<Shape> {
    let radius_m = f64::from(item.params[0]);
    let place = item.place()?;
    let drawable = radius_m > 0.0 && radius_m <= MOST_RADIUS_M;
    let center = EastNorth {
        east_m: 0.0,
        north_m: 0.0,
    };
    let inclusion = item.command == command::FENCE_CIRCLE_INCLUSION;
    // Drawn on the safe side of what it is.
    let outline = if inclusion { round } else { around };
    drawable.then(|| {
        let ring = outline(&LocalFrame::new(place), center, radius_m);
        ("circle", inclusion, ring)
    })
}

//! Planning coordinates to the integers and floats of an item.
//!
//! Altitudes are whole quarters of a metre, rounded up. A quarter is exact in
//! float32, in decimals and in the centimetres that ArduPilot keeps (which
//! truncates: 30.129 comes back as 30.12), so no step on the way to the vehicle
//! can lower it.

use crate::autopilot::{command, frame};
use crate::geodesy::{Amsl, LatLon, PlanPoint, straight_m};
use crate::mission::item::{Home, Item};
use crate::numeric::geometry::Offset;
use crate::path::TimedPoint;
use crate::spec::{AltitudeReference, EndPoint, Placement};
use crate::world::{NoData, PlanZone, World};

/// Furthest that encoding moves a point, metres: a quarter up, half of 1e-7 degrees aside;
/// more only where a height just below 0 becomes a quarter.
pub(crate) const ENCODING_M: f64 = 0.26;

/// Home of a vehicle that stands at a place on the ground.
///
/// Its altitude is rounded down to centimetres: altitudes above home that are
/// computed from it are then high enough.
#[must_use]
pub fn home_at(place: LatLon, ground: Amsl) -> Home {
    let (x, y) = degrees_e7(place);
    #[expect(
        clippy::cast_possible_truncation,
        reason = "float32 is what the wire has"
    )]
    let amsl_m = ((ground.0 * 100.0 + TOLERANCE).floor() / 100.0) as f32;
    Home { x, y, amsl_m }
}

/// Writes points of one vehicle's mission.
pub(crate) struct Encoder<'a> {
    world: &'a World,
    reference: AltitudeReference,
    home: Home,
}

impl<'a> Encoder<'a> {
    /// The longest leg that the map of ArduPilot does not bend, metres.
    pub(crate) fn straight_m(&self) -> f64 {
        straight_m(self.world.frame.origin().lat_deg)
    }

    /// An encoder for a vehicle with its home at a place on this ground, in the altitude reference of the spec.
    pub(crate) fn new(
        world: &'a World,
        reference: AltitudeReference,
        place: LatLon,
        ground: Amsl,
    ) -> Self {
        Self {
            world,
            reference,
            home: home_at(place, ground),
        }
    }

    /// Where the vehicle stands, as every item's altitude above home assumes.
    pub(crate) fn home(&self) -> Home {
        self.home
    }

    /// Whether a point encodes to the place of home.
    pub(crate) fn is_over_home(&self, point: PlanPoint) -> bool {
        degrees_e7(self.world.frame.from_plan(point.at)) == (self.home.x, self.home.y)
    }

    /// Height of a point in the reference of the mission, metres.
    pub(crate) fn height_m(&self, point: PlanPoint) -> Result<f64, NoData> {
        Ok(match self.reference {
            AltitudeReference::Amsl => point.amsl.0,
            AltitudeReference::Relative => point.amsl.above_home(self.home_amsl()).0,
            AltitudeReference::Terrain => point.amsl.above_ground(self.ground(point)?).0,
        })
    }

    /// How many times closer than a tolerance legs must stay to each point of a route, so that they
    /// do not cut what may be flown over and ends less than the tolerance below it: 1 elsewhere.
    pub(crate) fn strictness(&self, route: &[TimedPoint], tolerance_m: f64) -> Vec<f64> {
        /// Share of the height over a zone that legs may take: the rest is for rounding.
        const SHARE: f64 = 0.9;
        /// Nearer than this part of the tolerance is not asked for.
        const MAX: f64 = 20.0;
        let zones = self
            .world
            .zones
            .iter()
            .filter(|zone| zone.ceiling.is_some());
        let wider: Vec<(&PlanZone, Offset)> =
            zones.map(|zone| (zone, zone.wider(tolerance_m))).collect();
        let strictness = |timed: &TimedPoint| {
            let PlanPoint { at, amsl } = timed.point;
            let ground_m = self.world.ground.height_m(at);
            let over_m = |(zone, wider): &(&PlanZone, Offset)| {
                let over_m = amsl.0 - zone.closed_m(ground_m).1;
                let is_near = over_m > 0.0 && SHARE * over_m < tolerance_m;
                let at = [at.east_m, at.north_m];
                (is_near && !wider.is_far_from(at, at) && wider.contains(at)).then_some(over_m)
            };
            let min_m = wider
                .iter()
                .filter_map(over_m)
                .fold(tolerance_m / SHARE, f64::min);
            (tolerance_m / (SHARE * min_m)).clamp(1.0, MAX)
        };
        route.iter().map(strictness).collect()
    }

    /// Altitude of height 0 in the reference of the mission; the terrain's is not one altitude.
    pub(crate) fn zero(&self) -> Option<Amsl> {
        match self.reference {
            AltitudeReference::Amsl => Some(Amsl(0.0)),
            AltitudeReference::Relative => Some(self.home_amsl()),
            AltitudeReference::Terrain => None,
        }
    }

    /// An item at a point.
    ///
    /// A height of 0 becomes the next quarter: at a place that is flown to ArduPilot
    /// takes it for "as high as before". A landing goes down in any case.
    pub(crate) fn item(
        &self,
        command: u16,
        params: [f32; 4],
        point: PlanPoint,
    ) -> Result<Item, NoData> {
        let (x, y) = degrees_e7(self.world.frame.from_plan(point.at));
        Ok(Item {
            command,
            frame: match self.reference {
                AltitudeReference::Amsl => frame::GLOBAL,
                AltitudeReference::Relative => frame::GLOBAL_RELATIVE_ALT,
                AltitudeReference::Terrain => frame::GLOBAL_TERRAIN_ALT,
            },
            autocontinue: true,
            params,
            x,
            y,
            z: match quarter_up(self.height_m(point)?) {
                0.0 if ![command::NAV_LAND, command::NAV_VTOL_LAND].contains(&command) => 0.25,
                z => z,
            },
        })
    }

    /// An item at a place with an altitude of its own.
    pub(crate) fn place(&self, command: u16, end: EndPoint) -> Result<Item, NoData> {
        let amsl = match end.altitude {
            Placement::Amsl(amsl) => amsl,
            Placement::Agl(agl) => agl.over(self.world.terrain.height(end.place)?),
        };
        let at = self.world.frame.to_plan(end.place);
        self.item(command, [0.0; 4], PlanPoint { at, amsl })
    }

    /// The same item with its altitude above home, whatever the reference of the mission:
    /// a QuadPlane takes the altitude of its takeoff for a height above where it stands.
    pub(crate) fn above_home(&self, item: Item, amsl: Amsl) -> Item {
        Item {
            frame: frame::GLOBAL_RELATIVE_ALT,
            z: quarter_up(amsl.above_home(self.home_amsl()).0),
            ..item
        }
    }

    /// The point on the ground below.
    pub(crate) fn on_ground(&self, point: PlanPoint) -> Result<PlanPoint, NoData> {
        Ok(PlanPoint {
            at: point.at,
            amsl: self.ground(point)?,
        })
    }

    /// Altitude of home as it is encoded.
    pub(crate) fn home_amsl(&self) -> Amsl {
        Amsl(f64::from(self.home.amsl_m))
    }

    pub(crate) fn ground(&self, point: PlanPoint) -> Result<Amsl, NoData> {
        self.world.terrain.height_at(&self.world.frame, point.at)
    }
}

/// What arithmetic may add to an altitude that was meant to be whole: a micrometre is no height.
const TOLERANCE: f64 = 1e-6;

/// Up to the next quarter of a metre.
pub(crate) fn quarter_up(height_m: f64) -> f32 {
    up(height_m * 4.0) / 4.0
}

/// Up to the next whole number, unless it exceeds one by less than `TOLERANCE`.
pub(crate) fn up(value: f64) -> f32 {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "whole numbers below 2^24 are exact in float32"
    )]
    let whole = (value - TOLERANCE).ceil() as f32;
    // Not minus zero: it would be written as such.
    whole + 0.0
}

/// Latitude and longitude in 1e-7 degrees, nearest.
pub(crate) fn degrees_e7(place: LatLon) -> (i32, i32) {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "at most 1.8e9; the cast saturates"
    )]
    let whole = |degrees: f64| (degrees * 1e7).round() as i32;
    (whole(place.lat_deg), whole(place.lon_deg))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn altitudes_go_up_to_the_next_quarter_and_never_down() {
        for (height_m, encoded_m) in [
            (480.0, 480.0),
            (480.01, 480.25),
            (480.25, 480.25),
            (480.260_000_1, 480.5),
            (-5.557, -5.5),
            (-0.1, 0.0),
        ] {
            assert_eq!(
                quarter_up(height_m).to_bits(),
                f32::to_bits(encoded_m),
                "{height_m}"
            );
        }
    }

    #[test]
    fn a_height_whole_but_for_arithmetic_stays() {
        assert_eq!(
            quarter_up(0.1 + 0.2 - 0.3 + 480.0).to_bits(),
            480.0_f32.to_bits()
        );
    }
}

//! Altitudes carry their reference in their type, so that one can never be
//! taken for another: the mistake flies somebody into a hill.

use super::{Geoid, LatLon};

/// Metres above mean sea level (EGM96 where an ellipsoidal height is needed).
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Amsl(pub f64);

/// Metres above the terrain at the same place.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Agl(pub f64);

/// Metres above the home position of one vehicle.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct AboveHome(pub f64);

/// Metres above the WGS84 ellipsoid: what satellite navigation measures before a geoid is
/// subtracted. It differs from [`Amsl`] by up to 107 m, so only a [`Geoid`] converts them.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Ellipsoid(pub f64);

impl Agl {
    /// The same altitude above mean sea level, over ground of known height.
    #[must_use]
    pub fn over(self, ground: Amsl) -> Amsl {
        Amsl(ground.0 + self.0)
    }
}

impl AboveHome {
    /// The same altitude above mean sea level, for a home of known height.
    #[must_use]
    pub fn over(self, home: Amsl) -> Amsl {
        Amsl(home.0 + self.0)
    }
}

impl Amsl {
    /// Height above ground of known height.
    #[must_use]
    pub fn above_ground(self, ground: Amsl) -> Agl {
        Agl(self.0 - ground.0)
    }

    /// Height above a home of known height.
    #[must_use]
    pub fn above_home(self, home: Amsl) -> AboveHome {
        AboveHome(self.0 - home.0)
    }

    /// The same altitude above the ellipsoid, at a place.
    #[must_use]
    pub fn above_ellipsoid(self, geoid: &Geoid, place: LatLon) -> Ellipsoid {
        Ellipsoid(self.0 + geoid.undulation_m(place))
    }
}

impl Ellipsoid {
    /// The same altitude above mean sea level, at a place.
    #[must_use]
    pub fn above_sea(self, geoid: &Geoid, place: LatLon) -> Amsl {
        Amsl(self.0 - geoid.undulation_m(place))
    }
}

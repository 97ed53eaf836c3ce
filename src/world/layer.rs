//! The layer of altitudes that is open to a vehicle, besides `min_agl` and the ceiling.

use crate::spec::{AltitudeLimits, Buffers};

/// Limits of altitude on the routes of one vehicle, buffers included where the world has them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Greatest height above ground, metres; infinite where there is none.
    pub max_agl_m: f64,
    /// Least altitude, metres above mean sea level; minus infinity where there is none.
    pub min_amsl_m: f64,
}

impl Layer {
    /// No limits.
    pub const UNLIMITED: Self = Self {
        max_agl_m: f64::INFINITY,
        min_amsl_m: f64::NEG_INFINITY,
    };

    /// The limits of a vehicle: the buffer of the ceiling under the upper one, that of the terrain
    /// over the lower one.
    #[must_use]
    pub fn of(limits: AltitudeLimits, buffers: &Buffers) -> Self {
        let top_m = |agl: crate::geodesy::Agl| agl.0 - buffers.ceiling_m;
        let bottom_m = |amsl: crate::geodesy::Amsl| amsl.0 + buffers.terrain_m;
        Self {
            max_agl_m: limits.max_agl.map_or(f64::INFINITY, top_m),
            min_amsl_m: limits.min_amsl.map_or(f64::NEG_INFINITY, bottom_m),
        }
    }

    /// The same where the ground may be lower than the terrain has it, metres.
    #[must_use]
    pub fn over_lower_ground(self, by_m: f64) -> Self {
        Self {
            max_agl_m: self.max_agl_m - by_m,
            ..self
        }
    }

    /// Whether nothing is limited.
    #[must_use]
    pub fn is_unlimited(&self) -> bool {
        *self == Self::UNLIMITED
    }

    /// The least altitude over ground at a height, from that by the height above ground, metres.
    #[must_use]
    pub fn floor_m(&self, by_agl_m: f64) -> f64 {
        // Where the ground is unknown, so is its floor.
        match by_agl_m < self.min_amsl_m {
            true => self.min_amsl_m,
            false => by_agl_m,
        }
    }

    /// The greatest altitude over ground at a height, under a ceiling, metres.
    #[must_use]
    pub fn ceiling_m(&self, ground_m: f64, max_amsl_m: f64) -> f64 {
        max_amsl_m.min(ground_m + self.max_agl_m)
    }
}

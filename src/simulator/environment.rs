//! What a simulated vehicle flies in, and what it is set to.

use std::sync::Arc;

use crate::spec::Wind;
use crate::world::Terrain;

/// What is around a simulated vehicle, and how it is set up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// The ground; without it all of it is as high as home.
    pub terrain: Option<Arc<Terrain>>,
    /// Rotors hold against the steady part of it, a wing is carried by it; its gusts move both.
    pub wind: Option<Wind>,
    /// Where a plane points before it takes off, radians clockwise from north. `ArduPlane`
    /// takes off along it, whatever its mission says.
    pub heading_rad: f64,
    /// Standard deviation of its idea of where it is, metres.
    pub noise_m: f64,
    /// Seed of gusts and noise; every vehicle draws its own from it.
    pub seed: u64,
    /// Parameters other than those it comes with.
    pub params: Vec<(String, f32)>,
}

//! What a simulated vehicle flies in, and what it is set to.

use std::sync::Arc;

use crate::spec::Wind;
use crate::world::Terrain;

/// What is around a simulated vehicle, and how it is set up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// The ground; without it all of it is as high as home.
    pub terrain: Option<Arc<Terrain>>,
    /// The steady part of it is held against; its gusts are not.
    pub wind: Option<Wind>,
    /// Standard deviation of its idea of where it is, metres.
    pub noise_m: f64,
    /// Seed of gusts and noise; every vehicle draws its own from it.
    pub seed: u64,
    /// Parameters other than those it comes with.
    pub params: Vec<(String, f32)>,
}
